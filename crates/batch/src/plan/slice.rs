//! Slices of a plan that are run by themselves: `2/5` is the second of five.
//!
//! Slice K of N holds the runs K, K + N, K + 2N ..., so that each has its share of every variant.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// The most slices that a plan is cut into.
pub const MAX_SLICES: u64 = 10_000;

/// One of several slices of a plan, or the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Slice {
    number: u64,
    of: u64,
}

/// A text that names no slice.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("expected K/N, such as 2/5: slice K of N, K from 1 to N, N at most {MAX_SLICES}")]
pub struct SliceError;

impl Slice {
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Slice `number` of `of`; `None` unless `number` is from 1 to `of`, and `of` at most [`MAX_SLICES`].
    pub fn new(number: u64, of: u64) -> Option<Self> {
        ((1..=of).contains(&number) && of <= MAX_SLICES).then_some(Self { number, of })
    }

    pub fn is_whole(self) -> bool {
        self == Self::WHOLE
    }

    /// Returns which of the slices it is, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// Returns the number of slices that the plan is cut into.
    pub fn of(self) -> u64 {
        self.of
    }

    /// All slices that the plan is cut into.
    pub fn all(self) -> impl Iterator<Item = Self> {
        (1..=self.of).map(move |number| Self { number, of: self.of })
    }

    /// Returns how many of a plan's runs are in the slice.
    pub fn count(self, runs: u64) -> u64 {
        (runs + self.of - self.number) / self.of
    }

    /// The number of a run by its place in the slice, from 0.
    pub fn run_at(self, place: u64) -> u64 {
        self.number + place * self.of
    }

    /// The place in the slice of a run; `None` if it is in another.
    pub fn place_of(self, run: u64) -> Option<u64> {
        let after_first = run.checked_sub(self.number)?;
        (after_first % self.of == 0).then_some(after_first / self.of)
    }
}

impl fmt::Display for Slice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Slice {
    type Err = SliceError;

    fn from_str(text: &str) -> Result<Self, SliceError> {
        let (number, of) = text.split_once('/').ok_or(SliceError)?;
        Self::new(number.parse().map_err(|_| SliceError)?, of.parse().map_err(|_| SliceError)?).ok_or(SliceError)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_part_the_runs() {
        for (runs, of) in [(1, 1), (10, 1), (10, 3), (9, 3), (2, 5), (1000, 7)] {
            let slices: Vec<_> = (1..=of).map(|number| Slice::new(number, of).expect("it is one of them")).collect();
            assert_eq!(slices.iter().map(|slice| slice.count(runs)).sum::<u64>(), runs, "{runs} in {of}");
            for run in 1..=runs {
                let holders: Vec<_> = slices.iter().filter(|slice| slice.place_of(run).is_some()).collect();
                assert_eq!(holders.len(), 1, "run {run} of {runs} in {of}");
                let place = holders[0].place_of(run).expect("it was just found");
                assert_eq!(holders[0].run_at(place), run);
                assert!(place < holders[0].count(runs));
            }
        }
    }

    #[test]
    fn slices_are_read_as_they_are_written() {
        assert_eq!("2/5".parse::<Slice>().expect("a slice").to_string(), "2/5");
        assert_eq!("1/1".parse(), Ok(Slice::WHOLE));
        for text in ["", "1", "0/3", "4/3", "-1/3", "1/0", "a/b", "1/2/3", "1/10001"] {
            assert_eq!(text.parse::<Slice>(), Err(SliceError), "{text}");
        }
    }
}
