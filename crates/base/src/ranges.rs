//! Ranges of settings: what a scenario may say is decided beside the code that the settings are for, and a scenario asks.

use std::ops::RangeInclusive;

use crate::geometry::FieldFrame;

/// A value of a table of settings that is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutOfRange {
    /// The setting's name in its table.
    pub name: &'static str,
    pub found: String,
    pub expected: String,
}

/// A table of settings that a scenario may hold.
pub trait SettingsTable {
    /// Checks every number; some are bounded by the size of the field that they are used on.
    ///
    /// # Errors
    /// Returns the first setting that is out of its range.
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange>;
}

/// Checks that a number is in a range.
///
/// # Errors
/// Returns the number and its range, in the words of messages.
pub fn check_range(name: &'static str, number: f64, range: RangeInclusive<f64>) -> Result<(), OutOfRange> {
    if range.contains(&number) {
        return Ok(());
    }
    let expected = format!("a number from {} to {}", range.start(), range.end());
    Err(OutOfRange { name, found: number_text(number), expected })
}

/// Writes a number, with an exponent where it would be too long to read.
pub fn number_text(number: f64) -> String {
    let is_long = number != 0.0 && !(1e-6..1e15).contains(&number.abs());
    if is_long { format!("{number:e}") } else { number.to_string() }
}
