//! Numeric parameters and their ranges.

use thiserror::Error;

/// The largest accepted value of any parameter: products with squared distances stay far from the limit of an `f64`.
pub const LARGEST: f64 = 1e100;

/// A parameter out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{name} must be {expected}, not {}", shown(*found))]
pub struct BadParameter {
    /// The name of the parameter, such as "the safety distance".
    pub name: &'static str,
    pub expected: &'static str,
    pub found: f64,
}

impl BadParameter {
    /// Accepts numbers from 0 to [`LARGEST`].
    pub fn unless_amount(name: &'static str, found: f64) -> Result<(), Self> {
        Self::unless((0.0..=LARGEST).contains(&found), name, "a number from 0 to 1e100", found)
    }

    /// Accepts numbers above 0 and up to [`LARGEST`].
    pub fn unless_positive(name: &'static str, found: f64) -> Result<(), Self> {
        Self::unless(found > 0.0 && found <= LARGEST, name, "a number above 0 and up to 1e100", found)
    }

    pub fn unless(is_good: bool, name: &'static str, expected: &'static str, found: f64) -> Result<(), Self> {
        if is_good { Ok(()) } else { Err(Self { name, expected, found }) }
    }
}

/// A number as people write it: very large and very small ones with an exponent.
fn shown(number: f64) -> String {
    let is_plain = number == 0.0 || (1e-6..1e9).contains(&number.abs()) || !number.is_finite();
    if is_plain { number.to_string() } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_of_the_range_is_refused() {
        for found in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 2.0 * LARGEST] {
            assert!(BadParameter::unless_amount("it", found).is_err(), "{found}");
            assert!(BadParameter::unless_positive("it", found).is_err(), "{found}");
        }
        assert_eq!(BadParameter::unless_amount("it", 0.0), Ok(()));
        let refused = BadParameter::unless_positive("eta", 0.0).unwrap_err();
        assert_eq!(refused.to_string(), "eta must be a number above 0 and up to 1e100, not 0");
    }
    #[test]
    fn refused_number_is_written_short() {
        let written =
            [(-1.5, "-1.5"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e308, "1e308"), (-2e-300, "-2e-300")];
        for (found, expected) in written {
            let sentence = BadParameter::unless_amount("eta", found).unwrap_err().to_string();
            assert!(sentence.ends_with(&format!(", not {expected}")), "{sentence}");
        }
    }
}
