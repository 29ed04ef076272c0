//! Numbers as decimal text.

use std::io::Write;

/// Significant digits after the first of floating-point values.
const MORE_DIGITS: usize = 11;

/// Appends a value as C's `printf` does for `%.12g`: 12 significant digits without trailing zeros, with an exponent of
/// at least two digits below 1e-4 and from 1e12 on; `inf`, `-inf`, and `nan` whatever its sign.
///
/// Source: ISO/IEC 9899:2018, "Programming languages - C", section 7.21.6.1, conversion `g`. Ties of the exact binary
/// value are rounded to even, as the standard library does.
pub(super) fn append_float(value: f64, text: &mut Vec<u8>) {
    const WRITABLE: &str = "a list can be written to";
    if value.is_nan() {
        return text.extend_from_slice(b"nan");
    }
    // Infinities have no exponent, which is looked for below.
    if value.is_infinite() || value == 0.0 {
        return write!(text, "{value}").expect(WRITABLE);
    }
    let start = text.len();
    write!(text, "{value:.MORE_DIGITS$e}").expect(WRITABLE);
    let point_e = text.iter().rposition(|&letter| letter == b'e').expect("scientific notation has an exponent");
    let exponent = str::from_utf8(&text[point_e + 1..]).ok().and_then(|digits| digits.parse::<i32>().ok());
    let exponent = exponent.expect("an exponent is a whole number");
    text.truncate(point_e);
    // The exponent is that of the rounded value, so that both notations round alike.
    if (-4..=MORE_DIGITS as i32).contains(&exponent) {
        text.truncate(start);
        write!(text, "{value:.*}", (MORE_DIGITS as i32 - exponent) as usize).expect(WRITABLE);
    }
    // Zeros are dropped only after a point: those of 100 are part of the number.
    if text[start..].contains(&b'.') {
        while text.pop_if(|digit| *digit == b'0').is_some() {}
        text.pop_if(|point| *point == b'.');
    }
    if !(-4..=MORE_DIGITS as i32).contains(&exponent) {
        let sign = if exponent < 0 { '-' } else { '+' };
        write!(text, "e{sign}{:02}", exponent.unsigned_abs()).expect(WRITABLE);
    }
}

#[cfg(test)]
mod tests {
    use rand::Rng;

    use super::*;
    use wildfire_base::rng;

    fn text_of(value: f64) -> String {
        let mut text = Vec::new();
        append_float(value, &mut text);
        String::from_utf8(text).expect("decimals are ASCII")
    }

    /// Printed by another program, with `%.12g`.
    #[test]
    fn floats_are_printed_as_c_prints_them() {
        let printed = [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (-10.0, "-10"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.333333333333"),
            (-2.0 / 3.0, "-0.666666666667"),
            (200.0 / 3.0, "66.6666666667"),
            (1000.0, "1000"),
            (0.0001, "0.0001"),
            (0.000099999, "9.9999e-05"),
            (0.000_123_456_789_012_5, "0.000123456789013"),
            (999_999_999_999.0, "999999999999"),
            (999_999_999_999.5, "1e+12"),
            (1e12, "1e+12"),
            (0.999_999_999_999_6, "1"),
            (9.999_999_999_996, "10"),
            (123_456_789_012_345.0, "1.23456789012e+14"),
            (1_234_567_890_125.0, "1.23456789012e+12"),
            (1_234_567_890_135.0, "1.23456789014e+12"),
            (2.5e-7, "2.5e-07"),
            (1e100, "1e+100"),
            (-1.5e-300, "-1.5e-300"),
            (f64::MAX, "1.79769313486e+308"),
            (f64::MIN_POSITIVE, "2.22507385851e-308"),
            (5e-324, "4.94065645841e-324"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "nan"),
            (-f64::NAN, "nan"),
        ];
        for (value, expected) in printed {
            assert_eq!(text_of(value), expected, "{value:e}");
        }
    }

    #[test]
    fn printed_value_is_within_half_a_unit_of_the_twelfth_digit() {
        let mut rng = rng::stream(2, "decimal");
        for _ in 0..5_000 {
            let value = f64::from_bits(rng.next_u64());
            if value.is_normal() {
                let read: f64 = text_of(value).parse().expect("it is a number");
                assert!(((read - value) / value).abs() <= 5.001e-12, "{value:e}");
            }
        }
    }
}
