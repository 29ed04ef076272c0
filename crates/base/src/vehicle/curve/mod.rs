//! Curves of a smallest turning radius: the common part of those of Dubins and of Reeds and Shepp.
//!
//! Such a curve is a word of [`Letter`]s, each an arc of the smallest radius or a straight, and a length for each letter.
//! Its first and last letters are arcs; `chord` and `circles` find them for a given middle. Poses are those of the
//! rear axle.

pub(super) mod chord;
pub(super) mod circles;
mod letter;

pub use letter::{Gear, Letter, Steering};

use super::{Path, Segment};
use crate::geometry::Pose;

/// Letters of the longest word, L+R-S-L-R+.
pub(super) const MAX_LETTERS: usize = 5;

/// Arcs and straights shorter than this many turning radii are rounding, and left out of a path.
const NEGLIGIBLE: f64 = 1e-12;

/// A sequence of letters that a vehicle can drive.
pub trait Letters {
    fn letters(&self) -> impl Iterator<Item = Letter> + Clone;
}

/// A word with the length of each of its letters: a way from one pose to another.
///
/// It knows neither pose; [`Curve::path`] lays it out from a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<W> {
    pub word: W,
    /// Driven distance in metres, forward and reverse alike.
    pub length_m: f64,
    radius_m: f64,
    /// In turning radii, one per letter, none negative.
    lengths: [f64; MAX_LETTERS],
}

impl<W: Letters> Curve<W> {
    /// `lengths` and their sum `total` are in turning radii.
    pub(super) fn new(word: W, total: f64, lengths: [f64; MAX_LETTERS], radius_m: f64) -> Self {
        Self { word, length_m: total * radius_m, radius_m, lengths }
    }

    /// The stretches of constant curvature, without those of no length.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + Clone {
        let lengths = self.word.letters().zip(self.lengths);
        let driven = lengths.filter(|&(_, length)| length > NEGLIGIBLE);
        driven.map(|(letter, length)| letter.segment(length * self.radius_m, self.radius_m))
    }

    /// The letters of the stretches of [`Self::segments`]: the word without letters of no length.
    pub fn driven_letters(&self) -> impl Iterator<Item = Letter> + Clone {
        self.word.letters().zip(self.lengths).filter(|&(_, length)| length > NEGLIGIBLE).map(|(letter, _)| letter)
    }

    /// Number of changes between forward and reverse.
    pub fn cusps(&self) -> u32 {
        let gears = self.segments().map(|segment| segment.is_reverse());
        gears.clone().zip(gears.skip(1)).filter(|(before, after)| before != after).count() as u32
    }

    /// The curve laid out from a pose of the rear axle.
    pub fn path(&self, start: Pose) -> Path {
        Path { start, segments: self.segments().collect() }
    }
}
