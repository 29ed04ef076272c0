//! Numbers on the command line and in tables that it names.

use std::str::FromStr;

/// Reads a number; zero with a minus is zero, whether the number is whole or not.
///
/// Ranges that begin at 0 hold -0.0 too, and what is computed from it is not what is computed from 0: its inverse, its
/// sign, its place in a total order.
pub fn parse<T: FromStr>(text: &str) -> Option<T> {
    let is_zero = |digits: &&str| !digits.starts_with(['+', '-']) && digits.parse() == Ok(0.0);
    text.strip_prefix('-').filter(is_zero).unwrap_or(text).parse().ok()
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
