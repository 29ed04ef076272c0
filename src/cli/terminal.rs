//! Writing to stdout and stderr.
//!
//! All text that commands print comes through here or through [`CliError`]. Parts of it are names that users or
//! strangers chose, so whatever could act on a terminal or turn the direction of writing is printed as an escape.

use std::collections::BTreeSet;
use std::env::var_os;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::error::CliError;
use wildfire_base::time::wall::WallStopwatch;
use wildfire_base::untrusted::{visible, visible_lines};
use wildfire_picture::unknown_letters;

/// Prints lines of text to stdout, their control characters as escapes. A reader that has closed its end, such as
/// `head`, has seen enough: that is no error.
pub fn print(result: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(visible_lines(result).as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(CliError::environment(format_args!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a note of one line to stderr, its control characters as escapes.
pub fn note(text: &str) {
    // A note that nobody can read is no reason to stop.
    let _ = writeln!(io::stderr(), "{}", visible(text));
}

/// Asks the system to open a page, and returns whether it could be asked.
pub fn open_in_browser(path: &Path) -> bool {
    // Without a display `xdg-open` may start a browser within the terminal.
    let has_display = cfg!(any(windows, target_os = "macos"))
        || ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| var_os(name).is_some_and(|value| !value.is_empty()));
    let opener = if cfg!(windows) {
        "explorer"
    } else if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let mut command = Command::new(opener);
    command.arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    has_display && command.spawn().is_ok()
}

/// Letters that are named, of those that a font lacks.
const MAX_NAMED: usize = 8;

/// Notes, once for all texts that a command draws into pictures, which letters of them the font lacks.
pub fn note_unknown_letters<'a>(drawn: impl IntoIterator<Item = &'a str>, quiet: bool) {
    let unknown: BTreeSet<char> = drawn.into_iter().flat_map(unknown_letters).collect();
    if unknown.is_empty() || quiet {
        return;
    }
    let named = unknown.iter().take(MAX_NAMED).map(|&letter| format!("{letter} (U+{:04X})", u32::from(letter)));
    let mut named = named.collect::<Vec<_>>().join(", ");
    if let Some(more @ 1..) = unknown.len().checked_sub(MAX_NAMED) {
        named.push_str(&format!(" and {more} more"));
    }
    note(&format!("pictures show boxes for {named}: their font covers Latin, Greek and Cyrillic"));
}

/// Progress on stderr: a bar on a terminal, and elsewhere, as in the log of a job, a line now and then.
pub struct Progress {
    bar: ProgressBar,
    /// What is counted.
    things: &'static str,
    /// Where there were some before.
    resumed: u64,
    lines: Option<Mutex<WallStopwatch>>,
}

/// Where stderr is no terminal, a line says this often how far a command is.
const LINE_EVERY: Duration = Duration::from_secs(10);

impl Progress {
    /// Begins to count things of this name.
    pub fn new(count: u64, things: &'static str, quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(count), target);
        let template =
            format!("{{bar:30}} {{human_pos}}/{{human_len}} {things}, {{elapsed}} elapsed, {{eta}} left {{msg}}");
        bar.set_style(ProgressStyle::with_template(&template).expect("the template is well formed"));
        bar.enable_steady_tick(Duration::from_millis(200));
        let lines = (!quiet && !io::stderr().is_terminal()).then(|| Mutex::new(WallStopwatch::start()));
        Self { bar, things, resumed: 0, lines }
    }

    /// Says that there are some already.
    #[must_use]
    pub fn resumed(self, resumed: u64) -> Self {
        Self { bar: self.bar.with_position(resumed), resumed, ..self }
    }

    /// Says how many there will be.
    pub fn expect(&self, count: u64) {
        self.bar.set_length(count);
    }

    /// Counts one.
    pub fn advance(&self) {
        self.bar.inc(1);
        let Some(last) = &self.lines else { return };
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= LINE_EVERY {
            *last = WallStopwatch::start();
            note(&self.line());
        }
    }

    /// Says something behind the numbers.
    pub fn say(&self, message: String) {
        self.bar.set_message(message);
    }

    /// Prints a note above the bar.
    pub fn note(&self, text: &str) {
        self.bar.suspend(|| note(text));
    }

    /// Prints a preliminary result to standard error, unless nothing is shown there.
    pub fn preview(&self, result: &str) {
        if !self.bar.is_hidden() || self.lines.is_some() {
            self.bar.suspend(|| io::stderr().write_all(visible_lines(result).as_bytes()).unwrap_or_default());
        }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self) -> String {
        let done = self.bar.position();
        let count = self.bar.length().unwrap_or(0);
        let gone = self.bar.elapsed();
        let left = gone.mul_f64(count.saturating_sub(done) as f64 / done.saturating_sub(self.resumed).max(1) as f64);
        let message = self.bar.message();
        let space = if message.is_empty() { "" } else { " " };
        format!(
            "{done}/{count} {}, {} s elapsed, {} s left{space}{message}",
            self.things,
            gone.as_secs(),
            left.as_secs()
        )
    }
}
