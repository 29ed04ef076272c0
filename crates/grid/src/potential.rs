//! Potential fields: attraction to a goal, repulsion from obstacles, and their sum.
//!
//! The laws are those of Khatib, "Real-time obstacle avoidance for manipulators and mobile robots" (1986), except that
//! repulsion is computed from the brushfire value. That, the scale and the defaults are from Akram and López Musito,
//! "Autonomous Systems, Lab 2" (Universitat de Girona, 2024), sections 2.2, 3.2 and 3.4.

use super::parameter::BadParameter;
use super::{Grid, Place};

/// The distance that determines attraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attraction {
    /// Half the square of the Euclidean distance in cells, times `zeta`.
    Squared { zeta: f64 },
    /// The city-block distance in cells.
    Manhattan,
}

/// The parameters of repulsion; `q` is the distance at which it ends, `eta` its strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion {
    pub q: f64,
    pub eta: f64,
    pub distance: RepulsionDistance,
}

/// The distance that determines repulsion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepulsionDistance {
    /// The brushfire value, 1 on obstacles.
    Brushfire,
    /// The brushfire value minus one: 0 on obstacles, whose repulsion is infinite.
    True,
}

impl Default for Attraction {
    fn default() -> Self {
        Self::Squared { zeta: 1.0 }
    }
}

impl Default for Repulsion {
    fn default() -> Self {
        Self { q: 5.0, eta: 15.0, distance: RepulsionDistance::Brushfire }
    }
}

impl Attraction {
    /// Accepts a `zeta` and a scale for which attraction is finite everywhere.
    pub fn check(&self, scale: Option<f64>) -> Result<(), BadParameter> {
        if let Self::Squared { zeta } = *self {
            BadParameter::unless_amount("zeta", zeta)?;
        }
        scale.map_or(Ok(()), |scale| BadParameter::unless_amount("the scale", scale))
    }

    /// Returns the attraction at a distance of this number of rows and columns from the goal.
    pub fn at(&self, rows: usize, cols: usize) -> f64 {
        let (rows, cols) = (rows as f64, cols as f64);
        match *self {
            Self::Squared { zeta } => 0.5 * zeta * (rows * rows + cols * cols),
            Self::Manhattan => rows + cols,
        }
    }

    /// Returns the greatest attraction on a map, that of the corner which is farthest from the goal.
    pub fn greatest(&self, rows: usize, cols: usize, goal: Place) -> f64 {
        let [down, across] =
            [(goal.0, rows), (goal.1, cols)].map(|(goal, side)| goal.max(side.saturating_sub(1).abs_diff(goal)));
        self.at(down, across)
    }
}

impl Repulsion {
    /// Accepts a `q` and an `eta` for which repulsion is finite everywhere except on obstacles.
    pub fn check(&self) -> Result<(), BadParameter> {
        BadParameter::unless_positive("q", self.q)?;
        BadParameter::unless_amount("eta", self.eta)
    }

    /// Returns the repulsion where the brushfire map holds `value`; 0 stands for a map without obstacles.
    pub fn at(&self, value: u16) -> f64 {
        let Some(from_obstacle) = value.checked_sub(1) else { return 0.0 };
        let distance = match self.distance {
            RepulsionDistance::Brushfire => f64::from(value),
            RepulsionDistance::True if from_obstacle == 0 => return f64::INFINITY,
            RepulsionDistance::True => f64::from(from_obstacle),
        };
        if distance > self.q {
            return 0.0;
        }
        let excess = 1.0 / distance - 1.0 / self.q;
        0.5 * self.eta * excess * excess
    }
}

/// Computes the attraction of every cell; with a `scale`, divided by its maximum and multiplied by the scale.
///
/// On a map of one cell the maximum is 0, and so is the scaled attraction.
pub fn attraction(rows: usize, cols: usize, goal: Place, kind: Attraction, scale: Option<f64>) -> Grid<f64> {
    let max = kind.greatest(rows, cols, goal);
    let scaled = |value: f64| match scale {
        Some(scale) if max > 0.0 => value / max * scale,
        _ => value,
    };
    let mut values = Grid::filled(rows, cols, 0.0);
    for row in 0..rows {
        for (col, value) in values.row_mut(row).iter_mut().enumerate() {
            *value = scaled(kind.at(row.abs_diff(goal.0), col.abs_diff(goal.1)));
        }
    }
    values
}

/// Computes the repulsion of every cell from a brushfire map (obstacle 1; all zeros if there is none).
pub fn repulsion(brushfire: &Grid<u16>, repulsion: &Repulsion) -> Grid<f64> {
    let values = brushfire.values().iter().map(|&value| repulsion.at(value)).collect();
    Grid::from_values(brushfire.rows(), brushfire.cols(), values)
}

/// Adds the repulsion from a brushfire map (obstacle 1; all zeros if there is none) to an attraction, in place, which
/// saves memory on large maps.
///
/// # Panics
/// If the two are not of the same size.
pub fn total(mut attraction: Grid<f64>, brushfire: &Grid<u16>, repulsion: &Repulsion) -> Grid<f64> {
    let size = (brushfire.rows(), brushfire.cols());
    assert_eq!((attraction.rows(), attraction.cols()), size, "fields of one map are of one size");
    for (sum, &value) in attraction.values_mut().iter_mut().zip(brushfire.values()) {
        *sum += repulsion.at(value);
    }
    attraction
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARED: Attraction = Attraction::Squared { zeta: 1.0 };

    #[test]
    fn scaled_attraction_is_the_scale_at_the_farthest_corner() {
        for (goal, corner) in [((1, 2), (3, 8)), ((3, 8), (0, 0)), ((0, 8), (3, 0)), ((2, 1), (0, 8))] {
            for kind in [SQUARED, Attraction::Manhattan, Attraction::Squared { zeta: 7.0 }] {
                let values = attraction(4, 9, goal, kind, Some(10.0));
                assert_eq!(values.values().iter().copied().fold(0.0, f64::max), 10.0);
                assert_eq!((values[corner], values[goal]), (10.0, 0.0), "goal {goal:?}");
            }
        }
    }

    #[test]
    fn attraction_without_a_scale_is_the_formula() {
        let squared = attraction(2, 3, (0, 0), Attraction::Squared { zeta: 2.0 }, None);
        assert_eq!(squared.values(), [0.0, 1.0, 4.0, 1.0, 2.0, 5.0]);
        let manhattan = attraction(2, 3, (1, 2), Attraction::Manhattan, None);
        assert_eq!(manhattan.values(), [3.0, 2.0, 1.0, 2.0, 1.0, 0.0]);
    }

    #[test]
    fn a_map_of_one_cell_attracts_nothing() {
        assert_eq!(attraction(1, 1, (0, 0), SQUARED, Some(10.0)).values(), [0.0]);
    }

    #[test]
    fn repulsion_ends_at_q_and_follows_the_formula_before() {
        let repulsion = Repulsion::default();
        assert_eq!([5, 6, u16::MAX].map(|value| repulsion.at(value)), [0.0; 3]);
        assert!((repulsion.at(1) - 4.8).abs() < 1e-12);
        assert!((repulsion.at(2) - 0.675).abs() < 1e-12);
    }

    #[test]
    fn true_distance_makes_obstacles_infinite_and_shifts_the_rest() {
        let brushfire = Repulsion::default();
        let exact = Repulsion { distance: RepulsionDistance::True, ..brushfire };
        assert!((1..20).all(|value| exact.at(value + 1) == brushfire.at(value)));
        for odd in [exact, Repulsion { eta: 0.0, ..exact }, Repulsion { q: 1e-300, ..exact }] {
            assert_eq!(odd.at(1), f64::INFINITY);
            assert!((2..20).all(|value| odd.at(value).is_finite()));
        }
    }

    #[test]
    fn a_map_without_obstacles_repels_nothing() {
        for distance in [RepulsionDistance::Brushfire, RepulsionDistance::True] {
            let nothing = repulsion(&Grid::filled(2, 2, 0), &Repulsion { distance, ..Repulsion::default() });
            assert_eq!(nothing, Grid::filled(2, 2, 0.0));
        }
    }

    #[test]
    fn parameters_that_make_no_number_are_refused() {
        let sentence = |result: Result<(), BadParameter>| result.unwrap_err().to_string();
        let q = Repulsion { q: 0.0, ..Repulsion::default() }.check();
        assert_eq!(sentence(q), "q must be a number above 0 and up to 1e100, not 0");
        let eta = Repulsion { eta: -1.0, ..Repulsion::default() }.check();
        assert_eq!(sentence(eta), "eta must be a number from 0 to 1e100, not -1");
        let zeta = Attraction::Squared { zeta: f64::INFINITY }.check(None);
        assert_eq!(sentence(zeta), "zeta must be a number from 0 to 1e100, not inf");
        assert_eq!(sentence(SQUARED.check(Some(f64::NAN))), "the scale must be a number from 0 to 1e100, not NaN");
        assert_eq!(Attraction::Manhattan.check(Some(10.0)), Ok(()));
    }
}
