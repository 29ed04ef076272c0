//! The ranges of numbers that make sense: within these, a curve ends within 1e-8 m and 1e-11 turning radii of its goal.

use std::ops::RangeInclusive;

/// The range of coordinates in metres, and of headings in degrees or radians.
pub const NUMBERS: RangeInclusive<f64> = -1e6..=1e6;
/// The range of turning radii in metres.
pub const RADII_M: RangeInclusive<f64> = 1e-3..=1e6;

pub fn shown(range: &RangeInclusive<f64>) -> String {
    format!("from {} to {}", range.start(), range.end())
}
