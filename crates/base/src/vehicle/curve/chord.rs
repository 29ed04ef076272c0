//! Two poses as a turning vehicle sees them: in the frame of their mean heading.
//!
//! Lengths are in turning radii. The x axis of the frame is the mean of the two headings, so the vehicle starts at the
//! heading `-turn / 2` and ends at `+turn / 2`, and the displacement between the poses is (`along`, `across`). In
//! this frame the symmetries of Reeds and Shepp are changes of sign:
//!
//! | | `along` | `across` | `turn` | the curve |
//! |---|---|---|---|---|
//! | time flip | - | + | - | forward becomes reverse |
//! | reflection | + | - | - | left becomes right |
//! | backwards | + | - | + | the letters in the opposite order |
//!
//! Together they make any signs of the three numbers, so that only pairs with three positive numbers remain to be
//! solved.

use std::f64::consts::PI;

use crate::geometry::{Pose, ops};

/// The displacement from one pose to another, in turning radii and the frame of the mean heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    pub along: f64,
    pub across: f64,
    /// Change of heading, in [-pi, pi].
    pub turn: f64,
    /// Sine and cosine of half the change of heading; the cosine is never negative except by rounding.
    pub half_sin: f64,
    pub half_cos: f64,
}

/// The symmetries that were applied to a chord, and have to be applied to its curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symmetry {
    pub flipped: bool,
    pub reflected: bool,
    pub backwards: bool,
}

impl Chord {
    /// The inverse pair, from `to` to `from`, gives the same numbers, bit for bit, with the opposite signs.
    pub fn between(from: Pose, to: Pose, radius_m: f64) -> Self {
        let start = ops::wrap_angle(from.heading);
        let end = ops::wrap_angle(to.heading);
        let turn = ops::wrap_angle(end - start);
        let (mean_sin, mean_cos) = ops::sin_cos(0.5 * (start + end));
        let (half_sin, half_cos) = ops::sin_cos(0.5 * turn);
        let dx = (to.x - from.x) / radius_m;
        let dy = (to.y - from.y) / radius_m;
        // Where the shorter turn passes the cut at pi, the mean of the two numbers points against the mean heading.
        let facing = if (end - start - turn).abs() < PI { 1.0 } else { -1.0 };
        Self {
            along: facing * (dx * mean_cos + dy * mean_sin),
            across: facing * (dy * mean_cos - dx * mean_sin),
            turn,
            half_sin,
            half_cos,
        }
    }

    /// The symmetries that lead to the image of this chord with no negative number, and back.
    pub fn symmetry(&self) -> Symmetry {
        let left_behind = self.along < 0.0;
        let to_the_right = self.across < 0.0;
        let clockwise = self.turn < 0.0;
        Symmetry {
            flipped: left_behind,
            reflected: left_behind != clockwise,
            backwards: left_behind != (to_the_right != clockwise),
        }
    }

    /// The image of this chord with no negative number.
    pub fn folded(&self) -> Self {
        Self {
            along: self.along.abs(),
            across: self.across.abs(),
            turn: self.turn.abs(),
            half_sin: self.half_sin.abs(),
            half_cos: self.half_cos.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;

    use super::*;

    const RADIUS_M: f64 = 4.0;

    fn poses() -> Vec<Pose> {
        let coordinates = [-7.0, -0.5, 0.0, 3.0];
        let headings = [-3.0, -1.7, 0.0, 0.2, 1.6, 2.9, PI];
        let places = coordinates.iter().flat_map(|&x| coordinates.map(|y| (x, y)));
        places.flat_map(|(x, y)| headings.map(|heading| Pose { x, y, heading })).collect()
    }

    #[test]
    fn a_chord_leads_to_the_goal() {
        for from in poses() {
            for to in poses() {
                let chord = Chord::between(from, to, RADIUS_M);
                let mean = Pose::new(from.x, from.y, from.heading + 0.5 * chord.turn);
                let end = mean.transform(RADIUS_M * DVec2::new(chord.along, chord.across));
                assert!(end.distance(to.position()) < 1e-12, "{from:?} to {to:?}");
                assert!(ops::wrap_angle(from.heading + chord.turn - to.heading).abs() < 1e-12);
                assert!((chord.half_sin - ops::sin(0.5 * chord.turn)).abs() < 1e-15 && chord.half_cos > -1e-15);
            }
        }
    }

    #[test]
    fn the_way_back_has_the_same_folded_chord() {
        for from in poses() {
            for to in poses() {
                let there = Chord::between(from, to, RADIUS_M).folded();
                let back = Chord::between(to, from, RADIUS_M).folded();
                assert_eq!(there, back);
                assert!(there.along >= 0.0 && there.across >= 0.0 && there.turn >= 0.0);
            }
        }
    }

    #[test]
    fn a_full_turn_of_a_heading_changes_nothing() {
        let from = Pose { x: 1.0, y: 2.0, heading: 3.0 };
        let to = Pose { x: -3.0, y: 4.0, heading: -2.5 };
        let chord = Chord::between(from, to, RADIUS_M);
        let turned = Chord::between(from, Pose { heading: to.heading + TAU, ..to }, RADIUS_M);
        assert!((chord.along - turned.along).abs() < 1e-14 && (chord.across - turned.across).abs() < 1e-14);
        assert!((chord.turn - turned.turn).abs() < 1e-14);
    }
}
