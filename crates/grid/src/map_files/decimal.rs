//! Numbers as decimal text.

/// Significant digits of floating-point values.
const DIGITS: usize = 12;

/// The powers of ten that a 53-bit mantissa can be multiplied by within 127 bits.
const POWERS_OF_TEN: [u128; 23] = {
    let mut powers = [1; 23];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = 10 * powers[k - 1];
        k += 1;
    }
    powers
};

/// Appends a whole number.
pub(super) fn append_integer(mut value: u32, text: &mut Vec<u8>) {
    let mut digits = [0; 10];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    text.extend_from_slice(&digits[at..]);
}

/// Appends a value as C's `printf` does for `%.12g`: 12 significant digits without trailing zeros, with an exponent of
/// at least two digits below 1e-4 and from 1e12 on; `inf`, `-inf`, and `nan` whatever its sign.
///
/// Source: ISO/IEC 9899:2018, "Programming languages - C", section 7.21.6.1, conversion `g`. Ties of the exact binary
/// value are rounded to even.
pub(super) fn append_float(value: f64, text: &mut Vec<u8>) {
    if value.is_sign_negative() && !value.is_nan() {
        text.push(b'-');
    }
    let magnitude = value.abs();
    if !magnitude.is_finite() || magnitude == 0.0 {
        let word: &[u8] = if magnitude.is_nan() {
            b"nan"
        } else if magnitude == 0.0 {
            b"0"
        } else {
            b"inf"
        };
        text.extend_from_slice(word);
        return;
    }
    let Decimal { digits, exponent } = Decimal::of_product(magnitude).unwrap_or_else(|| Decimal::of_any(magnitude));
    let end = digits.iter().rposition(|&digit| digit != b'0').expect("the first digit is not 0") + 1;
    let significant = &digits[..end];
    match exponent {
        0..12 => append_fixed(&digits, end, exponent as usize + 1, text),
        -4..0 => {
            text.extend_from_slice(&b"0.000"[..1 + exponent.unsigned_abs() as usize]);
            text.extend_from_slice(significant);
        }
        _ => append_scientific(significant, exponent, text),
    }
}

/// Digits of which the first `point` stand before the point, and those from `end` on are zeros.
fn append_fixed(digits: &[u8; DIGITS], end: usize, point: usize, text: &mut Vec<u8>) {
    text.extend_from_slice(&digits[..point]);
    if end > point {
        text.push(b'.');
        text.extend_from_slice(&digits[point..end]);
    }
}

fn append_scientific(significant: &[u8], exponent: i32, text: &mut Vec<u8>) {
    text.push(significant[0]);
    if significant.len() > 1 {
        text.push(b'.');
        text.extend_from_slice(&significant[1..]);
    }
    text.extend_from_slice(if exponent < 0 { b"e-" } else { b"e+" });
    let exponent = exponent.unsigned_abs();
    if exponent < 10 {
        text.push(b'0');
    }
    append_integer(exponent, text);
}

/// A positive value rounded to 12 significant digits: d.ddddddddddd times ten to the `exponent`.
#[derive(Debug, PartialEq, Eq)]
struct Decimal {
    digits: [u8; DIGITS],
    exponent: i32,
}

impl Decimal {
    /// Rounds a value from 1e-11 to 1e12 by one exact product; `None` of most others.
    ///
    /// A normal value is m 2^q with whole m. Times ten to the k, with k such that 12 digits stand before the point, it
    /// is a whole 128-bit number shifted right, whose rounding is exact.
    fn of_product(value: f64) -> Option<Self> {
        let bits = value.to_bits();
        let mantissa = u128::from(bits & ((1 << 52) - 1) | (1 << 52));
        let q = (bits >> 52) as i32 - 1075;
        // 78913 / 2^18 is the decimal logarithm of 2, a little low: the exponent is this or one more.
        let mut exponent = ((q + 52) * 78_913) >> 18;
        loop {
            let power = usize::try_from(DIGITS as i32 - 1 - exponent).ok().and_then(|k| POWERS_OF_TEN.get(k))?;
            let whole = shifted_right(mantissa * power, q.checked_neg()?.try_into().ok()?)?;
            if whole < POWERS_OF_TEN[DIGITS] {
                return Some(Self { digits: digits_of(whole as u64), exponent });
            }
            exponent += 1;
        }
    }

    /// Rounds any finite positive value, slowly.
    fn of_any(value: f64) -> Self {
        let text = format!("{value:.*e}", DIGITS - 1);
        let (number, exponent) = text.split_once('e').expect("scientific notation has an exponent");
        let mut digits = number.bytes().filter(u8::is_ascii_digit);
        Self {
            digits: std::array::from_fn(|_| digits.next().expect("there are 12 digits")),
            exponent: exponent.parse().expect("an exponent is a whole number"),
        }
    }
}

/// `number` / 2^`bits`, rounded to nearest, ties to even; `None` if all bits leave.
fn shifted_right(number: u128, bits: u32) -> Option<u128> {
    let half = 1u128.checked_shl(bits.checked_sub(1)?)?;
    let whole = number.checked_shr(bits)?;
    let rest = number & (2 * half - 1);
    let rounds_up = rest > half || (rest == half && whole % 2 == 1);
    Some(whole + u128::from(rounds_up))
}

fn digits_of(mut number: u64) -> [u8; DIGITS] {
    let mut digits = [0; DIGITS];
    for digit in digits.iter_mut().rev() {
        *digit = b'0' + (number % 10) as u8;
        number /= 10;
    }
    digits
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

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
    fn exact_product_agrees_with_the_standard_library() {
        let mut rng = rng::stream(1, "decimal");
        let mut by_product = 0;
        for _ in 0..20_000 {
            let wide = f64::from_bits(rng.next_u64() >> 1);
            let likely = rng.random_range(0.0..1.0) * [1e-9, 1e-3, 1.0, 1e3, 1e9][rng.random_range(0..5)];
            // Eighths have exact ties where 12 digits end before the point's third place.
            let tied = rng.random_range(1u64..8_000_000_000_000) as f64 / 8.0;
            for value in [wide, likely, tied] {
                if value.is_finite() && value > 0.0 {
                    let product = Decimal::of_product(value);
                    by_product += usize::from(product.is_some());
                    assert!(product.is_none_or(|product| product == Decimal::of_any(value)), "{value:e}");
                }
            }
        }
        assert!(by_product > 40_000, "the exact product serves usual values");
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

    #[test]
    fn integers_are_printed_whole() {
        for value in [0, 7, 10, 99, 100, 65_535, 1_000_000, u32::MAX] {
            let mut text = Vec::new();
            append_integer(value, &mut text);
            assert_eq!(text, value.to_string().into_bytes());
        }
    }
}
