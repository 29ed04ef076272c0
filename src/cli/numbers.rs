//! Numbers on the command line and in tables that it names.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Reads a number; zero with a minus is zero, whether the number is whole or not.
///
/// Ranges that begin at 0 hold -0.0 too, and what is computed from it is not what is computed from 0: its inverse, its
/// sign, its place in a total order.
pub fn parse<T: FromStr>(text: &str) -> Option<T> {
    let is_zero = |digits: &&str| !digits.starts_with(['+', '-']) && digits.parse() == Ok(0.0);
    text.strip_prefix('-').filter(is_zero).unwrap_or(text).parse().ok()
}

/// Reads a number that lies in a range.
pub fn within<T: FromStr + PartialOrd>(text: &str, range: &RangeInclusive<T>) -> Option<T> {
    parse(text.trim()).filter(|number| range.contains(number))
}

/// Does the same for an option, whose error says what was expected: `expected metres from 0 to 5`.
pub fn parse_within<T: FromStr + PartialOrd + Display>(
    text: &str,
    range: &RangeInclusive<T>,
    what: &str,
) -> Result<T, String> {
    within(text, range).ok_or_else(|| format!("expected {what} {}", range_words(range)))
}

/// Words a range, as `from 0 to 5`.
pub fn range_words<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("from {} to {}", range.start(), range.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        for text in ["0", "-0", "-0.0", "-0e5", "-1e-999", "+0"] {
            assert_eq!(parse::<f64>(text).map(f64::to_bits), Some(0), "{text}");
        }
        assert_eq!((parse::<u64>("-0"), parse::<usize>("-00")), (Some(0), Some(0)));
        assert_eq!((parse::<f64>("-1.5"), parse::<i32>("-7"), parse::<u8>("-1")), (Some(-1.5), Some(-7), None));
        for text in ["", "-", "--0", "-+0", "- 0", "0x0", "a"] {
            assert_eq!(parse::<f64>(text), None, "{text}");
        }
    }
}
