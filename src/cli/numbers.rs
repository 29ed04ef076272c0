//! Numbers on the command line and in tables that it names.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Reads a number; zero with a minus is zero, whether the number is whole or not.
///
/// Ranges that begin at 0 hold -0.0 too, and what is computed from it is not what is computed from 0: its inverse, its
/// sign, its place in a total order.
pub fn parse<T: FromStr>(text: &str) -> Option<T> {
    text.strip_prefix('-')
        .filter(|digits| !digits.starts_with(['+', '-']) && digits.parse() == Ok(0.0))
        .unwrap_or(text)
        .parse()
        .ok()
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
    within(text, range).ok_or_else(|| format!("expected {what} {}", range_text(range)))
}

/// Reads a time: a number of seconds, `m:ss`, or `h:mm:ss`, with decimals of seconds in each.
pub fn parse_time(text: &str) -> Option<f64> {
    let mut parts: Vec<&str> = text.trim().split(':').collect();
    let seconds = parse::<f64>(parts.pop()?)?;
    if parts.is_empty() {
        return Some(seconds);
    }
    let mut minutes = 0;
    for (place, part) in parts.iter().enumerate() {
        minutes = 60 * minutes + part.parse::<u16>().ok().filter(|number| place == 0 || *number < 60).map(u32::from)?;
    }
    (parts.len() < 3 && (0.0..60.0).contains(&seconds)).then(|| 60.0 * f64::from(minutes) + seconds)
}

/// Reads a time that lies in a range of seconds, for an option.
pub fn parse_time_within(text: &str, range: &RangeInclusive<f64>) -> Result<f64, String> {
    parse_time(text)
        .filter(|seconds| range.contains(seconds))
        .ok_or_else(|| format!("expected seconds {}, or h:mm:ss", range_text(range)))
}

/// Reads an instant of a run.
pub fn parse_instant(text: &str) -> Result<f64, String> {
    parse_time_within(text, &(0.0..=1e9))
}

/// Words a range, as `from 0 to 5`.
pub fn range_text<T: Display>(range: &RangeInclusive<T>) -> String {
    format!("from {} to {}", range.start(), range.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds_or_have_colons() {
        let times = [("90", 90.0), ("1:30", 90.0), ("0:01:30.5", 90.5), ("2:00:00", 7200.0), ("100:00", 6000.0)];
        for (text, seconds) in times {
            assert_eq!(parse_time(text), Some(seconds), "{text}");
        }
        for text in ["", ":", "1:", ":30", "1:60", "1:99:00", "1:2:3:4", "-1:00", "1:-1", "1.5:00", "1:nan", "a:00"] {
            assert_eq!(parse_time(text), None, "{text}");
        }
        assert_eq!(
            parse_time_within("1:00:01", &(0.0..=3600.0)),
            Err("expected seconds from 0 to 3600, or h:mm:ss".into())
        );
    }

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
