//! The part that `wildfire play` and `wildfire render` share: the runs to show and the view of them.

mod args;
mod films;
mod look;
mod source;

pub use args::{ShowArguments, parse_seconds, parse_speed, parse_within};
pub use films::shown_runs;
pub use look::look;
pub use source::{Searches, ShownRun};

use crate::cli::error::CliError;
use crate::picture::film::RunView;
use crate::time::SimTime;

/// A time of the option `name`, in seconds.
///
/// # Errors
/// If it is beyond the end of the last run.
pub fn time_within(name: &str, seconds: f64, films: &[&RunView]) -> Result<SimTime, CliError> {
    let (time, end) = (SimTime::from_seconds(seconds), RunView::last_end(films));
    if time > end {
        let sentence = format!("{name} is {seconds}; the run ends at {} s", end.as_seconds());
        return Err(CliError::bad_input(sentence, None));
    }
    Ok(time)
}
