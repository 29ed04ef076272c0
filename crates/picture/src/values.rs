//! Scales from values to fractions of their range and to colours.

use super::colours::{ColourMap, Rgb, blend};
use super::ticks::{Tick, ticks};

/// The number of colours that the range is divided into.
const SHADES: usize = 1024;

/// The range of a map's values, and a colour for each.
#[derive(Clone, Debug)]
pub struct ValueScale {
    pub low: f64,
    pub high: f64,
    /// True if all values are whole numbers.
    pub is_whole: bool,
    shades: Vec<Rgb>,
}

impl ValueScale {
    /// Makes a scale from the lowest to the highest finite value; `None` if there is none.
    pub fn from_values(values: impl Iterator<Item = f64>, colours: ColourMap) -> Option<Self> {
        let mut values = values.filter(|value| value.is_finite());
        let first = values.next()?;
        let mut low = first;
        let mut high = first;
        let mut is_whole = first.trunc() == first;
        for value in values {
            (low, high) = (low.min(value), high.max(value));
            is_whole = is_whole && value.trunc() == value;
        }
        let shades = (0..SHADES).map(|shade| colours.colour(shade as f64 / (SHADES - 1) as f64)).collect();
        Some(Self { low, high, is_whole, shades })
    }

    /// The same range, its colours laid over a ground.
    pub fn on(&self, ground: Rgb, opacity: f64) -> Self {
        let shades = self.shades.iter().map(|&shade| blend(ground, shade, opacity)).collect();
        Self { shades, ..*self }
    }

    /// Round values in the range, in steps of at least 1 where all values are whole numbers.
    pub fn ticks(&self, max: usize) -> Vec<Tick> {
        ticks(self.low, self.high, max, if self.is_whole { 1.0 } else { 0.0 })
    }

    /// Returns where a value lies in the range, 0 to 1; values outside count as its nearest end, and where all values
    /// are equal they lie in the middle.
    pub fn fraction(&self, value: f64) -> f64 {
        if self.half_span() <= 0.0 {
            return 0.5;
        }
        let value = value.clamp(self.low, self.high);
        (0.5 * value - 0.5 * self.low) / self.half_span()
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a fraction lies within 0 to 1")]
    pub fn colour(&self, value: f64) -> Rgb {
        self.shades[(self.fraction(value) * (SHADES - 1) as f64).round() as usize]
    }

    /// The span itself may be too large for a number.
    fn half_span(&self) -> f64 {
        0.5 * self.high - 0.5 * self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(values: &[f64]) -> Option<ValueScale> {
        ValueScale::from_values(values.iter().copied(), ColourMap::Viridis)
    }

    #[test]
    fn fractions_rise_from_the_lowest_to_the_highest_value() {
        let scale = scale(&[4.0, 2.0, 6.0]).expect("there are values");
        assert_eq!([2.0, 3.0, 4.0, 6.0].map(|value| scale.fraction(value)), [0.0, 0.25, 0.5, 1.0]);
        assert_eq!(scale.colour(2.0), ColourMap::Viridis.colour(0.0));
        assert_eq!(scale.colour(6.0), ColourMap::Viridis.colour(1.0));
    }

    #[test]
    fn infinite_values_count_as_the_ends_of_the_finite_ones() {
        let scale = scale(&[1.0, f64::INFINITY, 3.0, f64::NAN]).expect("there are values");
        assert_eq!((scale.low, scale.high), (1.0, 3.0));
        assert_eq!(scale.fraction(f64::INFINITY), 1.0);
        assert_eq!(scale.fraction(f64::NEG_INFINITY), 0.0);
    }

    #[test]
    fn equal_values_and_the_widest_range_have_fractions() {
        assert_eq!(scale(&[7.0, 7.0]).expect("there are values").fraction(7.0), 0.5);
        assert_eq!(scale(&[-f64::MAX, f64::MAX]).expect("there are values").fraction(0.0), 0.5);
        assert!(scale(&[f64::INFINITY, f64::NAN]).is_none());
    }
}
