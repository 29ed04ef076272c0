//! Writing to stdout and stderr.
//!
//! All text that commands print comes through here or through [`CliError`]. Parts of it are names that users or
//! strangers chose, so whatever could act on a terminal or turn the direction of writing is printed as an escape.

use std::collections::BTreeSet;
use std::io::{self, ErrorKind, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::error::CliError;
use crate::picture::unknown_letters;
use crate::untrusted::{visible, visible_lines};

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

/// Letters that are named, of those that a font lacks.
const MOST_NAMED: usize = 8;

/// Notes, once for all texts that a command draws into pictures, which letters of them the font lacks.
pub fn note_unknown_letters<'a>(drawn: impl IntoIterator<Item = &'a str>, quiet: bool) {
    let unknown: BTreeSet<char> = drawn.into_iter().flat_map(unknown_letters).collect();
    if unknown.is_empty() || quiet {
        return;
    }
    let named = unknown.iter().take(MOST_NAMED).map(|&letter| format!("{letter} (U+{:04X})", u32::from(letter)));
    let mut named = named.collect::<Vec<_>>().join(", ");
    if let Some(more @ 1..) = unknown.len().checked_sub(MOST_NAMED) {
        named.push_str(&format!(" and {more} more"));
    }
    note(&format!("pictures show boxes for {named}: their font has letters of Latin, Greek and Cyrillic"));
}

/// A bar on stderr that counts runs, or other things of this name; it shows on a terminal only.
pub fn progress_bar(count: u64, things: &str, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(count), target);
    let template = format!("{{bar:30}} {{human_pos}}/{{human_len}} {things}, {{elapsed}} gone, {{eta}} left {{msg}}");
    bar.set_style(ProgressStyle::with_template(&template).expect("the template is well formed"));
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
