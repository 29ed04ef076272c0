//! Which seeds a batch runs, as people write them: `1..5`, `1,5,9`, `1..100,200,300..400`.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use thiserror::Error;

/// The most runs of one batch.
pub const MAX_RUNS: u64 = 10_000_000;

/// The most bytes of a file of seeds; with the limit on their number it keeps the memory of reading them below 64 MiB.
pub const MAX_SEEDS_BYTES: u64 = 8_000_000;

/// The most seeds and ranges that are listed one by one; consecutive seeds are one range.
const MAX_PARTS: usize = 750_000;

/// Distinct seeds in the order in which they were written; ranges count upwards and include both ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seeds {
    ranges: Vec<RangeInclusive<u64>>,
    /// The number of seeds before each range.
    before: Vec<u64>,
}

/// A reason for which a list of seeds is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SeedsError {
    #[error("`{found}` is not a seed: expected whole numbers from 0 to {}, such as `7`, `1..5` or `1,5,9`", u64::MAX)]
    NotANumber { found: String },
    #[error("there are no seeds: expected whole numbers, such as `7`, `1..5` or `1,5,9`")]
    Nothing,
    #[error("the range `{found}` is empty: its first seed must not be greater than its last")]
    Backwards { found: String },
    #[error("seed {seed} is listed twice")]
    Twice { seed: u64 },
    #[error("{count} runs are too many: a batch takes at most {MAX_RUNS}")]
    TooMany { count: u128 },
    #[error("more than {MAX_PARTS} seeds and ranges are listed; expected ranges, such as `1..5`, of consecutive seeds")]
    TooManyParts,
}

impl Seeds {
    /// Number of seeds, from 1 to [`MAX_RUNS`].
    pub fn count(&self) -> u64 {
        self.ranges.iter().map(|range| range.end() - range.start() + 1).sum()
    }

    pub fn iter(&self) -> impl Iterator<Item = u64> + '_ {
        self.ranges.iter().cloned().flatten()
    }

    /// Returns the seed at this index, from 0 to [`Self::count`] - 1.
    pub fn nth(&self, index: u64) -> u64 {
        let range = self.before.partition_point(|&before| before <= index) - 1;
        self.ranges[range].start() + (index - self.before[range])
    }

    /// Returns the first ones, at least one and at most all.
    pub fn first(&self, count: u64) -> Self {
        let ranges = self.ranges.iter().zip(&self.before).filter(|(_, before)| **before < count.max(1));
        let cut = ranges.map(|(range, before)| {
            let more = (count.max(1) - before - 1).min(range.end() - range.start());
            *range.start()..=range.start() + more
        });
        Self::from_ranges(cut.collect())
    }

    fn from_ranges(ranges: Vec<RangeInclusive<u64>>) -> Self {
        let sizes = ranges.iter().map(|range| range.end() - range.start() + 1);
        let before = sizes.scan(0, |before, size| Some(std::mem::replace(before, *before + size))).collect();
        Self { ranges, before }
    }
}

/// 1 to 5, as many as the reports of the contest show.
impl Default for Seeds {
    fn default() -> Self {
        Self::from_ranges(vec![1..=5])
    }
}

impl FromStr for Seeds {
    type Err = SeedsError;

    fn from_str(text: &str) -> Result<Self, SeedsError> {
        Self::from_parts(text.split(','))
    }
}

impl Seeds {
    /// Takes the text of a file of seeds: they are between commas, blanks and lines, and `#` begins a comment.
    ///
    /// # Errors
    /// Fails as [`Self::from_parts`] does.
    pub fn from_file_text(text: &str) -> Result<Self, SeedsError> {
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let parts = lines.flat_map(|line| line.split([',', ' ', '\t'])).filter(|word| !word.is_empty());
        Self::from_parts(parts)
    }

    /// Takes seeds and ranges one after the other.
    ///
    /// # Errors
    /// If there is none, or one that makes no sense, or a seed twice, or more than a batch takes.
    pub fn from_parts<'a>(parts: impl Iterator<Item = &'a str>) -> Result<Self, SeedsError> {
        let mut ranges = Vec::new();
        for part in parts {
            // The length is checked before parsing, so the memory of a long list stays bounded.
            if ranges.len() == MAX_PARTS {
                return Err(SeedsError::TooManyParts);
            }
            ranges.push(parse_range(part)?);
        }
        if ranges.is_empty() {
            return Err(SeedsError::Nothing);
        }
        // Counts take 128 bits, as the range of all seeds alone holds 2^64.
        let count = ranges.iter().map(|range| u128::from(range.end() - range.start()) + 1).sum();
        if count > u128::from(MAX_RUNS) {
            return Err(SeedsError::TooMany { count });
        }
        match first_repeated(&ranges) {
            Some(seed) => Err(SeedsError::Twice { seed }),
            None => Ok(Self::from_ranges(ranges)),
        }
    }
}

/// Writes ascending numbers, consecutive ones as a range with this word between its ends: `1..5,9`.
pub fn range_text(numbers: &[u64], to: &str) -> String {
    let ranges = numbers.chunk_by(|one, next| one + 1 == *next).map(|range| match range {
        [one] => one.to_string(),
        range => format!("{}{to}{}", range[0], range[range.len() - 1]),
    });
    ranges.collect::<Vec<_>>().join(",")
}

fn parse_range(part: &str) -> Result<RangeInclusive<u64>, SeedsError> {
    let seed = |digits: &str| {
        digits.trim().parse::<u64>().map_err(|_| SeedsError::NotANumber { found: part.trim().to_owned() })
    };
    let (first, last) = match part.split_once("..") {
        Some((first, last)) => (seed(first)?, seed(last.strip_prefix('=').unwrap_or(last))?),
        None => (seed(part)?, seed(part)?),
    };
    if first > last {
        return Err(SeedsError::Backwards { found: part.trim().to_owned() });
    }
    Ok(first..=last)
}

fn first_repeated(ranges: &[RangeInclusive<u64>]) -> Option<u64> {
    let mut sorted: Vec<_> = ranges.iter().map(|range| (*range.start(), *range.end())).collect();
    sorted.sort_unstable();
    // Sorted by their beginnings: where any two ranges overlap, two neighbours do.
    sorted.windows(2).find(|pair| pair[1].0 <= pair[0].1).map(|pair| pair[1].0)
}

impl fmt::Display for Seeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, range) in self.ranges.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            if range.start() == range.end() {
                write!(f, "{comma}{}", range.start())?;
            } else {
                write!(f, "{comma}{}..{}", range.start(), range.end())?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds(text: &str) -> Vec<u64> {
        text.parse::<Seeds>().expect("these seeds are fine").iter().collect()
    }

    fn refusal(text: &str) -> SeedsError {
        text.parse::<Seeds>().expect_err("these seeds are not fine")
    }

    #[test]
    fn numbers_are_written_as_ranges() {
        assert_eq!(range_text(&[1, 3, 4, 5, 9, 10], "-"), "1,3-5,9-10");
        assert_eq!(range_text(&[7], ".."), "7");
    }

    #[test]
    fn ranges_include_both_ends_and_lists_keep_their_order() {
        assert_eq!(seeds("1..5"), [1, 2, 3, 4, 5]);
        assert_eq!(seeds("1..=3"), [1, 2, 3]);
        assert_eq!(seeds("9,1,5"), [9, 1, 5]);
        assert_eq!(seeds("7..8, 1 ,3..4"), [7, 8, 1, 3, 4]);
        assert_eq!(seeds("0..0"), [0]);
        assert_eq!(seeds("18446744073709551615"), [u64::MAX]);
    }

    #[test]
    fn what_is_printed_is_read_back() {
        for text in ["1..5", "9,1,5", "7..8,1,3..4"] {
            assert_eq!(text.parse::<Seeds>().expect("fine").to_string(), text);
        }
    }

    #[test]
    fn count_is_the_number_of_seeds() {
        for text in ["4", "1..5", "7..8,1,3..4"] {
            let parsed: Seeds = text.parse().expect("fine");
            assert_eq!(parsed.count(), parsed.iter().count() as u64);
        }
    }

    #[test]
    fn nth_seed_is_that_of_the_list() {
        for text in ["4", "1..5", "7..8,1,3..4"] {
            let parsed: Seeds = text.parse().expect("fine");
            let found: Vec<_> = (0..parsed.count()).map(|index| parsed.nth(index)).collect();
            for count in 1..=parsed.count() {
                let first: Vec<u64> = parsed.first(count).iter().collect();
                assert_eq!(first, parsed.iter().take(count as usize).collect::<Vec<_>>());
            }
            assert_eq!(parsed.first(u64::MAX), parsed);
            assert_eq!(found, parsed.iter().collect::<Vec<_>>());
        }
    }

    #[test]
    fn repeated_seeds_are_refused() {
        assert_eq!(refusal("1,2,1"), SeedsError::Twice { seed: 1 });
        assert_eq!(refusal("5..9,1..5"), SeedsError::Twice { seed: 5 });
        assert_eq!(refusal("1..9,3..4"), SeedsError::Twice { seed: 3 });
    }

    #[test]
    fn more_than_the_limit_is_refused_without_counting_up() {
        assert_eq!(seeds("1..3").len(), 3);
        assert_eq!(refusal("1..10000001"), SeedsError::TooMany { count: 10_000_001 });
        assert_eq!(refusal("0..18446744073709551615"), SeedsError::TooMany { count: 1 << 64 });
    }

    #[test]
    fn what_is_no_seed_is_named() {
        for text in ["", "a", "1..", "..3", "1,,2", "-1", "1.5", "1e3", "18446744073709551616"] {
            assert!(matches!(refusal(text), SeedsError::NotANumber { .. }), "{text}");
        }
        assert_eq!(refusal("5..1"), SeedsError::Backwards { found: "5..1".into() });
    }
}
