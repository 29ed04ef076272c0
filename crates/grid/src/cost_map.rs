//! The cost map with two zones: high near obstacles, falling slowly in a safety zone, then fast to zero.
//!
//! Jenkins, "ME 5751 Module 2: Cost Map with Brush Fire Algorithm" (2022), section III.

use super::Grid;
use super::parameter::BadParameter;

/// The parameters of a cost that falls with the city-block distance from the nearest obstacle, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoZones {
    pub form: Form,
    /// The cost of an obstacle.
    pub max_cost: f64,
    /// The cost at the inner edge of the safety zone, where the distance would be 0.
    pub safety_max: f64,
    /// The cost at the outer edge of the safety zone.
    pub safety_min: f64,
    /// Width of the safety zone in cells, at least 1.
    pub safety_distance: u16,
    /// The loss per cell beyond the safety zone.
    pub cost_rate: f64,
}

/// The position from which the cost falls in the outer zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// At the obstacle, as in the report's formula: the cost jumps at the edge of the safety zone.
    Literal,
    /// At the edge of the safety zone, as the report's text describes it.
    Continuous,
}

impl Default for TwoZones {
    fn default() -> Self {
        Self {
            form: Form::Literal,
            max_cost: 1000.0,
            safety_max: 800.0,
            safety_min: 500.0,
            safety_distance: 12,
            cost_rate: 15.0,
        }
    }
}

impl TwoZones {
    /// Accepts zones in which cost never rises with distance and never falls below 0.
    pub fn check(&self) -> Result<(), BadParameter> {
        BadParameter::unless_amount("the largest cost", self.max_cost)?;
        BadParameter::unless_amount("the cost at the inner edge of the safety zone", self.safety_max)?;
        BadParameter::unless_amount("the cost at the outer edge of the safety zone", self.safety_min)?;
        BadParameter::unless_amount("the cost rate", self.cost_rate)?;
        BadParameter::unless(
            self.safety_distance > 0,
            "the safety distance",
            "at least 1 cell",
            f64::from(self.safety_distance),
        )?;
        BadParameter::unless(
            self.safety_max <= self.max_cost,
            "the cost at the inner edge of the safety zone",
            "at most the largest cost",
            self.safety_max,
        )?;
        BadParameter::unless(
            self.safety_min <= self.safety_max,
            "the cost at the outer edge of the safety zone",
            "at most that at its inner edge",
            self.safety_min,
        )
    }

    /// Returns the cost at a distance from the nearest obstacle.
    pub fn cost(&self, distance: u16) -> f64 {
        if distance == 0 {
            return self.max_cost;
        }
        let distance = f64::from(distance);
        let width = f64::from(self.safety_distance);
        if distance < width {
            return self.safety_max - (self.safety_max - self.safety_min) / width * distance;
        }
        let beyond = match self.form {
            Form::Literal => distance,
            Form::Continuous => distance - width,
        };
        (self.safety_min - self.cost_rate * beyond).max(0.0)
    }
}

/// Computes the cost of every cell from a brushfire map with four neighbours.
///
/// Obstacles hold 1 there; a map of zeros, which has no obstacle, costs 0 everywhere. The zones are taken as they are,
/// see [`TwoZones::check`].
pub fn cost_map(brushfire: &Grid<u16>, zones: &TwoZones) -> Grid<f64> {
    let costs = brushfire
        .values()
        .iter()
        .map(|value| value.checked_sub(1).map_or(0.0, |distance| zones.cost(distance)))
        .collect();
    Grid::from_values(brushfire.rows(), brushfire.cols(), costs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTINUOUS: TwoZones = TwoZones {
        form: Form::Continuous,
        max_cost: 1000.0,
        safety_max: 800.0,
        safety_min: 500.0,
        safety_distance: 12,
        cost_rate: 15.0,
    };

    #[test]
    fn literal_form_jumps_at_the_edge_of_the_safety_zone_and_the_other_does_not() {
        let literal = TwoZones::default();
        let costs = |zones: TwoZones| [0, 1, 11, 12, 33, 34, 45, 46, u16::MAX].map(|distance| zones.cost(distance));
        assert_eq!(costs(literal), [1000.0, 775.0, 525.0, 320.0, 5.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(costs(CONTINUOUS), [1000.0, 775.0, 525.0, 500.0, 185.0, 170.0, 5.0, 0.0, 0.0]);
    }

    #[test]
    fn cost_never_rises_with_distance() {
        for zones in [TwoZones::default(), CONTINUOUS, TwoZones { safety_distance: 1, ..CONTINUOUS }] {
            assert_eq!(zones.check(), Ok(()));
            assert!((0..200).all(|distance| zones.cost(distance + 1) <= zones.cost(distance)), "{zones:?}");
        }
    }

    #[test]
    fn a_map_without_obstacles_costs_nothing() {
        let costs = cost_map(&Grid::filled(2, 3, 0), &TwoZones::default());
        assert_eq!(costs, Grid::filled(2, 3, 0.0));
    }

    #[test]
    fn zones_that_make_no_sense_are_refused_with_a_sentence() {
        let good = TwoZones::default();
        let refusals = [
            (TwoZones { safety_distance: 0, ..good }, "the safety distance must be at least 1 cell, not 0"),
            (
                TwoZones { safety_min: 801.0, ..good },
                "the cost at the outer edge of the safety zone must be at most that at its inner edge, not 801",
            ),
            (
                TwoZones { max_cost: 700.0, ..good },
                "the cost at the inner edge of the safety zone must be at most the largest cost, not 800",
            ),
            (TwoZones { cost_rate: f64::NAN, ..good }, "the cost rate must be a number from 0 to 1e100, not NaN"),
        ];
        for (zones, sentence) in refusals {
            assert_eq!(zones.check().unwrap_err().to_string(), sentence);
        }
    }
}
