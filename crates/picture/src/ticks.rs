//! Round numbers along an axis.

use std::f64::consts::LOG10_2;

use wildfire_base::geometry::ops;

/// The distance, in steps, within which a value outside the range counts as its end: steps such as 0.1 are not exact.
const ROUNDING: f64 = 1e-9;
/// The most digits of a number that are shown.
const MAX_DIGITS: i32 = 6;
/// The most characters of a chosen value that is written as it is.
const LONGEST: usize = 8;

/// A round value and how it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    pub label: String,
}

/// Values from `low` to `high` in steps of 1, 2 or 5 times a power of ten, but at least `min`, so that there are
/// about `max` or fewer; the only value if `low` and `high` are equal.
pub fn ticks(low: f64, high: f64, max: usize, min: f64) -> Vec<Tick> {
    // The division comes before the subtraction, as the range itself may overflow.
    let step = round_step((high / max as f64 - low / max as f64).max(min));
    let first = (low / step - ROUNDING).ceil();
    let last = (high / step + ROUNDING).floor();
    let largest = low.abs().max(high.abs());
    // Ticks of 1 at a value of 1e9 differ in digits that no label shows.
    let is_readable = step > 0.0 && step.is_finite() && exponent(largest) - exponent(step) < MAX_DIGITS;
    if !is_readable || last <= first {
        return ends(low, high);
    }
    let mut ticks = Vec::new();
    let mut index = first;
    while index <= last && ticks.len() <= max {
        let value = index * step;
        ticks.push(Tick { value: value.clamp(low, high), label: label(value, step, largest) });
        index += 1.0;
    }
    // The count is bounded too, since rounding may let one more value in.
    ticks
}

/// Returns the ends, which are shown where no round values fit between.
fn ends(low: f64, high: f64) -> Vec<Tick> {
    let values = if low == high { vec![low] } else { vec![low, high] };
    values.into_iter().map(|value| Tick { value, label: shortest(value) }).collect()
}

/// A tick at a value that somebody chose, written as it is if that is short.
pub fn tick_at(value: f64) -> Tick {
    let written = [format!("{}", value + 0.0), format!("{value:e}")].into_iter().find(|label| label.len() <= LONGEST);
    Tick { value, label: written.unwrap_or_else(|| shortest(value)) }
}

/// Decimal logarithms from `low` to `high`, of powers of ten and, where there is room, of 2 and 5 times these; labels are
/// the numbers themselves. The ends if no such number lies between.
pub fn log_ticks(low: f64, high: f64, max: usize) -> Vec<Tick> {
    const FACTORS: [(f64, u8); 3] = [(0.0, 1), (LOG10_2, 2), (1.0 - LOG10_2, 5)];
    #[expect(clippy::cast_possible_truncation, reason = "logarithms of numbers lie from -324 to 309")]
    let first = low.floor() as i32;
    let last = high.ceil() as i32;
    let within = |tick: &Tick| (low - ROUNDING..=high + ROUNDING).contains(&tick.value);
    let tick = |power: i32, (aside, factor): (f64, u8)| {
        // The digits are parsed, as a product with a power of ten would differ in its last digit from the printed number.
        let number: f64 = format!("{factor}e{power}").parse().expect("a number");
        Tick { value: f64::from(power) + aside, label: shortest(number) }
    };
    let fine = (first..=last).flat_map(|power| FACTORS.map(|factor| tick(power, factor)));
    let fine: Vec<Tick> = fine.filter(within).collect();
    if (2..=max).contains(&fine.len()) {
        return fine;
    }
    let powers: Vec<Tick> = (first..=last).map(|power| tick(power, FACTORS[0])).filter(within).collect();
    let step = powers.len().div_ceil(max.max(1)).max(1);
    let powers: Vec<Tick> = powers.into_iter().step_by(step).collect();
    if powers.len() >= 2 {
        return powers;
    }
    let ends = [low, high].map(|end| Tick { value: end, label: shortest(ops::pow(10.0, end)) });
    if low == high { ends[..1].to_vec() } else { ends.to_vec() }
}

/// Rows or columns to be numbered, from 0 in steps of 1, 2 or 5 times a power of ten of at least `min`.
pub fn indices(count: usize, min: f64) -> impl Iterator<Item = usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "steps are a few thousand at most")]
    let step = round_step(min.max(1.0)) as usize;
    (0..count).step_by(step.max(1))
}

/// The least of 1, 2, 5 times a power of ten that is not less than `min`.
pub fn round_step(min: f64) -> f64 {
    let power = power_of_ten(exponent(min));
    let steps = [1.0, 2.0, 5.0].map(|factor| factor * power);
    steps.into_iter().find(|&step| step >= min).unwrap_or(10.0 * power)
}

/// The exponent of the first decimal digit; taken from the digits, since logarithms are rounded.
fn exponent(value: f64) -> i32 {
    let digits = format!("{value:e}");
    digits.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("a power of ten is a number")
}

/// Writes a value with as many digits as the step needs, and with an exponent if plain digits would be many.
fn label(value: f64, step: f64, largest: f64) -> String {
    let finest = exponent(step);
    let first = exponent(largest);
    if value == 0.0 {
        "0".to_owned()
    } else if first >= 6 || finest < -4 {
        format!("{:e}", rounded(value, usize::try_from(exponent(value) - finest).unwrap_or(0)))
    } else {
        format!("{value:.*}", usize::try_from(-finest).unwrap_or(0))
    }
}

/// Four digits or fewer of a value that is not round.
fn shortest(value: f64) -> String {
    let short = rounded(value, 3);
    if (-4..6).contains(&exponent(short)) { format!("{short}") } else { format!("{short:e}") }
}

/// A value with that many digits after its first one.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.digits$e}").parse().expect("a formatted number is a number")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        ticks(low, high, 6, 0.0).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_and_written_short() {
        assert_eq!(labels(0.0, 1000.0), ["0", "200", "400", "600", "800", "1000"]);
        assert_eq!(labels(1.0, 23.0), ["5", "10", "15", "20"]);
        assert_eq!(labels(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-0.3, 0.2), ["-0.3", "-0.2", "-0.1", "0", "0.1", "0.2"]);
        assert_eq!(labels(0.0, 4e6), ["0", "1e6", "2e6", "3e6", "4e6"]);
        assert_eq!(labels(0.0, 4e-7), ["0", "1e-7", "2e-7", "3e-7", "4e-7"]);
    }

    #[test]
    fn whole_numbers_are_not_divided() {
        let labels: Vec<_> = ticks(2.0, 4.0, 6, 1.0).into_iter().map(|tick| tick.label).collect();
        assert_eq!(labels, ["2", "3", "4"]);
    }

    #[test]
    fn ranges_without_round_values_show_their_ends() {
        assert_eq!(labels(7.0, 7.0), ["7"]);
        assert_eq!(labels(0.1 + 0.2, 0.1 + 0.2), ["0.3"]);
        assert_eq!(labels(1e17, 1e17 + 16.0), ["1e17", "1e17"]);
        assert_eq!(labels(-f64::MAX, f64::MAX), ["-1e308", "0", "1e308"]);
        assert!(labels(0.0, f64::MIN_POSITIVE).len() >= 2);
    }

    #[test]
    fn selected_values_are_written_as_they_are() {
        for (value, label) in
            [(0.05, "0.05"), (12345.0, "12345"), (-0.0, "0"), (1e300, "1e300"), (1.0 / 3.0, "0.3333"), (1e-7, "1e-7")]
        {
            assert_eq!(tick_at(value), Tick { value, label: label.into() });
        }
    }

    #[test]
    fn ticks_are_few_and_within_the_range() {
        for (low, high) in [(0.0, 1.0), (2.0, 581.0), (-3.7, 12.2), (999.0, 1001.0), (1e-9, 2e-9), (5e-324, 1e308)] {
            let ticks = ticks(low, high, 6, 0.0);
            assert!((2..=7).contains(&ticks.len()), "{low} to {high}: {ticks:?}");
            assert!(ticks.iter().all(|tick| (low..=high).contains(&tick.value)), "{low} to {high}: {ticks:?}");
            assert!(ticks.iter().all(|tick| tick.label.len() <= 8), "{low} to {high}: {ticks:?}");
        }
    }

    #[test]
    fn logarithms_are_labelled_with_their_numbers() {
        let labels = |low, high, max| log_ticks(low, high, max).into_iter().map(|tick| tick.label).collect::<Vec<_>>();
        assert_eq!(labels(-1.0, 1.0, 8), ["0.1", "0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(labels(-2.1, 3.2, 8), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert_eq!(labels(-6.0, 6.0, 5), ["1e-6", "0.001", "1", "1000", "1e6"]);
        assert_eq!(labels(0.1, 0.2, 5), ["1.259", "1.585"]);
        assert_eq!(labels(0.5, 0.5, 5).len(), 1);
        for (low, high) in [(-308.0, 308.0), (0.0, 0.3), (-4.7, -4.6)] {
            let ticks = log_ticks(low, high, 6);
            assert!((1..=7).contains(&ticks.len()), "{ticks:?}");
            assert!(ticks.iter().all(|tick| tick.value >= low - 1e-6 && tick.value <= high + 1e-6), "{ticks:?}");
        }
    }

    #[test]
    fn rows_are_numbered_from_zero_in_round_steps() {
        assert_eq!(indices(14, 1.4).collect::<Vec<_>>(), [0, 2, 4, 6, 8, 10, 12]);
        assert_eq!(indices(242, 31.0).collect::<Vec<_>>(), [0, 50, 100, 150, 200]);
        assert_eq!(indices(1, 0.01).collect::<Vec<_>>(), [0]);
        assert_eq!(indices(0, 1.0).count(), 0);
    }
}
