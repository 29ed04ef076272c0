//! Writing to stdout and stderr.
//!
//! All text that commands print comes through here or through [`CliError`]. Parts of it are names that users or
//! strangers chose, so whatever could act on a terminal or turn the direction of writing is printed as an escape.

use std::io::{self, ErrorKind, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::error::CliError;
use crate::picture::font_has_all_of;
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

/// Notes, once for all texts that a command draws into pictures, that the font lacks letters of one.
pub fn note_unknown_letters<'a>(drawn: impl IntoIterator<Item = &'a str>, quiet: bool) {
    let lacking = drawn.into_iter().find(|text| !font_has_all_of(text));
    if let (Some(text), false) = (lacking, quiet) {
        note(&format!("pictures show ? for letters of `{text}`: their font has those of ASCII only"));
    }
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
