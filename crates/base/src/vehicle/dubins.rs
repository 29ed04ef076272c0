//! Dubins curves: the shortest ways of a vehicle with a smallest turning radius that only drives forward.
//!
//! Source: L. E. Dubins, "On curves of minimal length with a constraint on average curvature, and with prescribed initial
//! and terminal positions and tangents", American Journal of Mathematics 79 (3), 1957: one of six words is the shortest.
//! The formulas are those of the forward words of Reeds and Shepp, and of an inner arc the long way round. Unlike a
//! Reeds-Shepp curve, a Dubins curve can become much longer when a pose moves by a hair.

use std::f64::consts::PI;

use glam::DVec2;

use super::curve::chord::Chord;
use super::curve::circles::{Circles, Ends, Middle, View, at_least, at_most};
use super::curve::{Gear, Letter, Letters, Steering};
use crate::geometry::{Pose, ops};

/// A way between two poses by one of the six words.
pub type Curve = super::curve::Curve<Word>;

/// One of the six words of Dubins, printed as in `LSR`: left, straight or right, always forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
    Lsl,
    Rsr,
    Lsr,
    Rsl,
    Lrl,
    Rlr,
}

/// The curves of a vehicle with this turning radius. Poses are finite and those of the rear axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dubins {
    /// Metres, positive.
    pub radius_m: f64,
}

impl Dubins {
    /// Length of the shortest curve.
    ///
    /// # Panics
    /// When a number of the poses is not finite, or too large to be squared.
    pub fn length_m(&self, from: Pose, to: Pose) -> f64 {
        self.shortest(from, to).length_m
    }

    /// The shortest curve; of equals the first in the order of [`Word::ALL`].
    ///
    /// # Panics
    /// When a number of the poses is not finite, or too large to be squared.
    pub fn shortest(&self, from: Pose, to: Pose) -> Curve {
        let circles = Circles::new(&Chord::between(from, to, self.radius_m));
        Word::ALL
            .into_iter()
            .fold(None, |best: Option<Curve>, word| {
                let bound = best.map_or(f64::INFINITY, |curve| curve.length_m / self.radius_m);
                self.solve(&circles, word, bound).or(best)
            })
            .expect("LSL leads anywhere")
    }

    /// The curves of all words that exist, in the order of [`Word::ALL`].
    pub fn curves(&self, from: Pose, to: Pose) -> impl Iterator<Item = Curve> {
        let circles = Circles::new(&Chord::between(from, to, self.radius_m));
        Word::ALL.into_iter().filter_map(move |word| self.solve(&circles, word, f64::INFINITY))
    }

    /// The curve of a word, if it exists and is shorter than `bound` turning radii.
    fn solve(&self, circles: &Circles, word: Word, bound: f64) -> Option<Curve> {
        let reflected = matches!(word, Word::Rsr | Word::Rsl | Word::Rlr);
        let view = circles.view(word.ends(), reflected, false);
        let middle = word.middle(&view)?;
        let outer = view.outer_arcs(&middle, bound)?;
        let lengths = [outer.first, middle.length, outer.last, 0.0, 0.0];
        (outer.total < bound).then(|| Curve::new(word, outer.total, lengths, self.radius_m))
    }
}

// The order decides between equals.
crate::names! { Word { Lsl: "LSL", Rsr: "RSR", Lsr: "LSR", Rsl: "RSL", Lrl: "LRL", Rlr: "RLR" } }

impl Word {
    fn ends(self) -> Ends {
        match self {
            Self::Lsl | Self::Rsr | Self::Lrl | Self::Rlr => Ends::SameSide,
            Self::Lsr | Self::Rsl => Ends::OtherSide,
        }
    }

    /// Returns what lies between the outer arcs, if their centres are neither too close nor too far apart.
    fn middle(self, view: &View) -> Option<Middle> {
        let &View { squared, distance, tangent, .. } = view;
        match self {
            Self::Lsl | Self::Rsr => {
                Some(Middle { length: distance, turn: 0.0, lean: DVec2::new(1.0, 0.0), turns_on: true })
            }
            Self::Lsr | Self::Rsl => {
                // Circles of radius 1 that are less than 2 apart have no inner tangent.
                at_least(4.0, squared)?;
                Some(Middle { length: tangent, turn: 0.0, lean: DVec2::new(tangent, 2.0), turns_on: false })
            }
            Self::Lrl | Self::Rlr => {
                // More than 4 apart, no third circle touches both.
                let sine = at_most(1.0, 0.25 * distance)?;
                // Shorter than a half turn, it would be in no shortest path (Dubins, 1957).
                let arc = PI + 2.0 * ops::acos(sine);
                let cosine = -(1.0 - sine * sine).sqrt();
                Some(Middle { length: arc, turn: -arc, lean: DVec2::new(cosine, sine), turns_on: true })
            }
        }
    }
}

impl Letters for Word {
    fn letters(&self) -> impl Iterator<Item = Letter> + Clone {
        self.name().bytes().map(|letter| {
            let steering = match letter {
                b'L' => Steering::Left,
                b'S' => Steering::Straight,
                _ => Steering::Right,
            };
            Letter { steering, gear: Gear::Forward }
        })
    }
}
