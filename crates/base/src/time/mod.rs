//! Simulated time as an integer count of nanoseconds, and the clock for CPU cost.
//!
//! Simultaneous means equal: events at the same [`SimTime`] are ordered by rank, never by rounding noise.
//! Seconds enter and leave the simulation here and nowhere else.

pub mod cpu;
pub mod wall;

use std::fmt;
use std::ops::{Add, AddAssign, Sub};

use serde::{Deserialize, Serialize};

const NANOS_PER_SECOND: f64 = 1e9;

/// A point in simulated time, or a span of it, in whole nanoseconds since the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SimTime(u64);

impl SimTime {
    /// The start of a run, or no time at all.
    pub const ZERO: Self = Self(0);
    /// Later than any event.
    pub const MAX: Self = Self(u64::MAX);

    /// Creates a time from whole nanoseconds.
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// Returns whole nanoseconds.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// The nearest nanosecond to a duration in seconds; negative values and NaN become zero,
    /// values beyond 584 years become [`SimTime::MAX`].
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * NANOS_PER_SECOND).round() as u64)
    }

    /// The first nanosecond that is not before `seconds`: arrivals round up, so that nobody is early.
    pub fn from_seconds_up(seconds: f64) -> Self {
        Self((seconds * NANOS_PER_SECOND).ceil() as u64)
    }

    /// Returns seconds, rounded to the nearest number.
    pub fn as_seconds(self) -> f64 {
        self.0 as f64 / NANOS_PER_SECOND
    }

    /// Time since `earlier`, zero if `earlier` is later.
    pub fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl Add for SimTime {
    type Output = Self;
    fn add(self, span: Self) -> Self {
        Self(self.0.saturating_add(span.0))
    }
}

impl AddAssign for SimTime {
    fn add_assign(&mut self, span: Self) {
        *self = *self + span;
    }
}

impl Sub for SimTime {
    type Output = Self;
    fn sub(self, earlier: Self) -> Self {
        Self(self.0.checked_sub(earlier.0).expect("a span of time ends after it begins"))
    }
}

impl fmt::Display for SimTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} s", self.as_seconds())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_round_once_and_arrivals_round_up() {
        assert_eq!(SimTime::from_seconds(0.1).as_nanos(), 100_000_000);
        assert_eq!(SimTime::from_seconds(1.000_000_000_4).as_nanos(), 1_000_000_000);
        assert_eq!(SimTime::from_seconds_up(1.000_000_000_4).as_nanos(), 1_000_000_001);
        assert_eq!(SimTime::from_seconds(3600.0).as_seconds(), 3600.0);
    }

    #[test]
    fn nonsense_seconds_saturate() {
        assert_eq!(SimTime::from_seconds(f64::NAN), SimTime::ZERO);
        assert_eq!(SimTime::from_seconds(-1.0), SimTime::ZERO);
        assert_eq!(SimTime::from_seconds(f64::INFINITY), SimTime::MAX);
        assert_eq!(SimTime::MAX + SimTime::from_nanos(1), SimTime::MAX);
    }
}
