//! Scales of maps: the colour of each value, and the labelled values.

use colorous::{INFERNO, RED_BLUE, SINEBOW, VIRIDIS};

use crate::colours::{Rgb, blend};
use crate::ticks::{Tick, round_step, ticks};
use wildfire_base::geometry::ops;
use wildfire_fire::surface::crown::FireType;

/// The quantity of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuantity {
    /// Seconds since the start.
    ArrivalTime,
    /// In kW/m.
    Intensity,
    /// In metres.
    FlameLength,
    /// In m/min.
    Rate,
    /// Compass azimuths in degrees.
    Direction,
    /// From 0 to 1.
    Probability,
    /// Seconds, more or less.
    TimeDifference,
    /// From -1 to 1.
    ProbabilityDifference,
    /// In kW/m, more or less.
    IntensityDifference,
    /// Numbers of [`FireType`].
    FireType,
}

/// How colours follow from values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shades {
    /// From yellow over green to dark violet: what is early is bright.
    Early,
    /// From light yellow over red to black: what is strong is dark.
    Strong,
    /// Round the compass.
    Around,
    /// Blue below zero, white at zero, red above.
    Diverging,
    /// One of [`FIRE_TYPES`].
    Kinds,
}

/// Colours of the kinds of fire, in the order of [`FireType::ALL`].
const FIRE_TYPES: [Rgb; 4] = [[246, 190, 80], [226, 96, 40], [150, 130, 110], [120, 20, 50]];

/// The range of a map's values, a colour for each, and the values written beside them.
#[derive(Clone, Debug)]
pub struct MapScale {
    pub low: f64,
    pub high: f64,
    /// Such as "arrival, min".
    pub name: String,
    pub ticks: Vec<Tick>,
    shades: Shades,
    is_logarithmic: bool,
}

/// The number of values that are written beside the colours, about.
const MAX_TICKS: usize = 8;
/// Intensities span powers of ten; the lowest one shown is at most this many times lower than the highest.
const SPAN: f64 = 1e4;

impl MapQuantity {
    fn shades(self) -> Shades {
        match self {
            Self::ArrivalTime => Shades::Early,
            Self::Intensity | Self::FlameLength | Self::Rate | Self::Probability => Shades::Strong,
            Self::Direction => Shades::Around,
            Self::TimeDifference | Self::ProbabilityDifference | Self::IntensityDifference => Shades::Diverging,
            Self::FireType => Shades::Kinds,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::ArrivalTime => "arrival",
            Self::Intensity => "fireline intensity, kW/m",
            Self::FlameLength => "flame length, m",
            Self::Rate => "rate of spread, m/min",
            Self::Direction => "direction of spread, compass",
            Self::Probability => "burn probability",
            Self::TimeDifference => "later (+) or earlier (-)",
            Self::ProbabilityDifference => "difference of burn probability",
            Self::IntensityDifference => "difference of intensity, kW/m",
            Self::FireType => "fire type",
        }
    }

    /// Returns the scale of a map with these finite values; `None` if there are none.
    ///
    /// Directions and kinds of fire always have the same scale, probabilities one from zero, differences one with zero in its middle.
    pub fn scale(self, values: impl Iterator<Item = f64>) -> Option<MapScale> {
        let mut range: Option<(f64, f64)> = None;
        for value in values.filter(|value| value.is_finite()) {
            range = Some(range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))));
        }
        let (low, high) = range?;
        let max = low.abs().max(high.abs());
        let (low, high) = match self {
            // The maximum is rounded up, so maps of similar runs have the same scale and can be laid side by side.
            Self::Probability => (0.0, round_step(high).clamp(0.1, 1.0)),
            Self::Direction => (0.0, 360.0),
            Self::FireType => (0.0, (FIRE_TYPES.len() - 1) as f64),
            Self::ArrivalTime => (low.min(0.0), high),
            Self::Intensity => (low.max(high / SPAN).min(high), high),
            Self::FlameLength | Self::Rate => (low.min(0.0), high),
            // Equal sides differ by 0 everywhere, and even then the scale needs a width.
            Self::ProbabilityDifference => (-max.max(0.01), max.max(0.01)),
            Self::TimeDifference | Self::IntensityDifference => (-max.max(1.0), max.max(1.0)),
        };
        // A logarithmic scale over less than a factor of four would have hardly a tick.
        let is_logarithmic = self == Self::Intensity && high > 4.0 * low && low > 0.0;
        let (ticks, unit) = match self {
            Self::ArrivalTime | Self::TimeDifference => time_ticks(low, high),
            Self::Direction => (compass_ticks(), ""),
            Self::FireType => {
                (FireType::ALL.map(|kind| Tick { value: f64::from(kind as u8), label: kind.name().into() }).into(), "")
            }
            Self::Intensity if is_logarithmic => (decade_ticks(low, high), ""),
            _ => (ticks(low, high, MAX_TICKS, 0.0), ""),
        };
        let name = if unit.is_empty() { self.name().to_owned() } else { format!("{}, {unit}", self.name()) };
        Some(MapScale { low, high, name, ticks, shades: self.shades(), is_logarithmic })
    }
}

impl MapScale {
    /// Returns where a value lies in the range, 0 to 1; values outside count as its nearest end.
    pub fn fraction(&self, value: f64) -> f64 {
        let place = |value: f64| if self.is_logarithmic { ops::ln(value) } else { value };
        let value = value.clamp(self.low, self.high);
        let (low, high) = (place(self.low), place(self.high));
        if low == high { 0.5 } else { (place(value) - low) / (high - low) }
    }

    pub fn colour(&self, value: f64) -> Rgb {
        self.shade(self.fraction(value))
    }

    /// The colour at a fraction of the range, 0 to 1.
    pub fn shade(&self, fraction: f64) -> Rgb {
        match self.shades {
            // The darkest part of each is left out: it hides lines and marks.
            Shades::Early => VIRIDIS.eval_continuous(1.0 - 0.97 * fraction).into_array(),
            Shades::Strong => INFERNO.eval_continuous(0.98 - 0.92 * fraction).into_array(),
            Shades::Kinds => FIRE_TYPES[(fraction * (FIRE_TYPES.len() - 1) as f64).round() as usize],
            Shades::Around => SINEBOW.eval_continuous(fraction).into_array(),
            Shades::Diverging => {
                let strength = (2.0 * fraction - 1.0).abs();
                // The middle of the scheme is a light grey.
                blend([255; 3], RED_BLUE.eval_continuous(1.0 - fraction).into_array(), (3.0 * strength).min(1.0))
            }
        }
    }
}

const MINUTE: f64 = 60.0;
const HOUR: f64 = 60.0 * MINUTE;
const DAY: f64 = 24.0 * HOUR;

/// Steps that clocks know, in seconds.
const CLOCK_STEPS: [f64; 18] = [
    1.0,
    2.0,
    5.0,
    10.0,
    15.0,
    30.0,
    MINUTE,
    2.0 * MINUTE,
    5.0 * MINUTE,
    10.0 * MINUTE,
    15.0 * MINUTE,
    30.0 * MINUTE,
    HOUR,
    2.0 * HOUR,
    3.0 * HOUR,
    6.0 * HOUR,
    12.0 * HOUR,
    DAY,
];

/// Round times in a range of seconds, written in the unit that is named beside them.
fn time_ticks(low: f64, high: f64) -> (Vec<Tick>, &'static str) {
    let min = (high - low) / MAX_TICKS as f64;
    // Below a tenth of a second clocks have no steps of their own, and decimal ones are taken.
    let step = CLOCK_STEPS.into_iter().find(|&step| step >= min && min >= 0.1);
    let (unit_s, unit) = match step {
        Some(step) if step < MINUTE => (1.0, "s"),
        Some(step) if step < HOUR => (MINUTE, "min"),
        Some(step) if step < DAY => (HOUR, "h"),
        _ if high - low < MINUTE => (1.0, "s"),
        _ => (DAY, "days"),
    };
    let Some(step) = step else {
        let scaled = ticks(low / unit_s, high / unit_s, MAX_TICKS, 0.0);
        return (scaled.into_iter().map(|tick| Tick { value: tick.value * unit_s, ..tick }).collect(), unit);
    };
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    let tick = |index: i64| {
        let value = index as f64 * step;
        Tick { value, label: format!("{}", value / unit_s) }
    };
    ((first..=last).map(tick).collect(), unit)
}

fn compass_ticks() -> Vec<Tick> {
    let names = ["N", "E", "S", "W", "N"];
    names
        .iter()
        .zip(0u8..)
        .map(|(name, quarter)| Tick { value: 90.0 * f64::from(quarter), label: (*name).to_owned() })
        .collect()
}

/// Powers of ten in a range, and 2 and 5 times these where there are few.
fn decade_ticks(low: f64, high: f64) -> Vec<Tick> {
    let factors: &[f64] = if high > 200.0 * low { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let mut values = Vec::new();
    for exponent in -6..=12 {
        let power: f64 = format!("1e{exponent}").parse().expect("a power of ten is a number");
        values.extend(factors.iter().map(|factor| factor * power).filter(|value| (low..=high).contains(value)));
    }
    values.into_iter().map(|value| Tick { value, label: format!("{value}") }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(quantity: MapQuantity, values: &[f64]) -> MapScale {
        quantity.scale(values.iter().copied()).expect("there are values")
    }

    fn labels(quantity: MapQuantity, values: &[f64]) -> (String, String) {
        let scale = scale(quantity, values);
        let labels: Vec<String> = scale.ticks.into_iter().map(|tick| tick.label).collect();
        (scale.name, labels.join(" "))
    }

    #[test]
    fn times_are_written_in_the_unit_that_fits() {
        let labels = |high| labels(MapQuantity::ArrivalTime, &[0.0, high]);
        let pair = |name: &str, labels: &str| (name.to_owned(), labels.to_owned());
        assert_eq!(labels(50.0), pair("arrival, s", "0 10 20 30 40 50"));
        assert_eq!(labels(6600.0), pair("arrival, min", "0 15 30 45 60 75 90 105"));
        assert_eq!(labels(12.0 * 3600.0), pair("arrival, h", "0 2 4 6 8 10 12"));
        assert_eq!(labels(20.0 * 86400.0), pair("arrival, days", "0 5 10 15 20"));
        assert_eq!(labels(0.0), pair("arrival, s", "0"));
        assert_eq!(labels(0.5).0, "arrival, s");
    }

    #[test]
    fn differences_are_white_at_zero_and_alike_to_both_sides() {
        for quantity in [MapQuantity::ProbabilityDifference, MapQuantity::TimeDifference] {
            let scale = scale(quantity, &[-30.0, 70.0]);
            assert_eq!(scale.colour(0.0), [255; 3]);
            assert_eq!((scale.low, scale.high), (-70.0, 70.0));
            let [red, _, blue] = scale.colour(60.0);
            let [other_red, _, other_blue] = scale.colour(-60.0);
            assert!(red > blue && other_blue > other_red);
        }
    }

    #[test]
    fn strong_fires_are_dark_and_early_ones_bright() {
        let brightness = |colour: Rgb| colour.iter().map(|&channel| u32::from(channel)).sum::<u32>();
        for quantity in [MapQuantity::ArrivalTime, MapQuantity::Intensity, MapQuantity::Probability] {
            let scale = scale(quantity, &[1.0, 10.0, 5000.0]);
            let shades: Vec<u32> = (0..=20).map(|share| brightness(scale.shade(f64::from(share) / 20.0))).collect();
            assert!(shades.windows(2).all(|pair| pair[0] > pair[1]), "{quantity:?}: {shades:?}");
        }
    }

    #[test]
    fn intensities_have_powers_of_ten() {
        assert_eq!(labels(MapQuantity::Intensity, &[3.0, 20_000.0]).1, "10 100 1000 10000");
        assert_eq!(labels(MapQuantity::Intensity, &[90.0, 600.0]).1, "100 200 500");
        assert_eq!(scale(MapQuantity::Intensity, &[0.0, 700.0]).low, 0.07);
    }
}
