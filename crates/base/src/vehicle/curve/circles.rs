//! The turning circles at both ends of a curve, and the arcs on them.
//!
//! Reflection and time flip reduce every word to one that starts to the left and forward. Seen in the frame of the mean
//! heading, such a word leads from the left-hand turning circle at the start to the left-hand (or right-hand) one at the
//! end. The vector D between the centres of these two circles decides everything: its length says how long the middle
//! of the word must be, and its angle where the first arc must end. The last arc is what is left of the whole turn.
//!
//! Lengths are in turning radii, so that an arc is as long as it turns.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::chord::Chord;
use crate::geometry::ops;

/// Lengths and turns below this are rounding: some hundred times the precision of a number near 1, and what is left of the
/// coordinates of a wide field. It is no larger because moving sideways by `y` turning radii takes a way of `sqrt(8 y)`.
const SLACK: f64 = 3e-14;

/// The centres of the turning circles at both ends of a chord, against each other.
pub struct Circles {
    /// For each [`Ends`], of curves that start to the left and of those that start to the right.
    between: [[Between; 2]; 2],
    turn: f64,
    half: DVec2,
}

/// The side of the vehicle on which the last circle lies, compared to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    SameSide,
    OtherSide,
}

/// From the centre of the first circle to that of the last.
#[derive(Clone, Copy, Debug)]
struct Between {
    vector: DVec2,
    squared: f64,
    distance: f64,
    tangent: f64,
}

/// The two circles as a word sees them that starts to the left and forward, after reflection and time flip.
#[derive(Clone, Copy, Debug)]
pub struct View {
    vector: DVec2,
    /// D squared.
    pub squared: f64,
    /// The length of D.
    pub distance: f64,
    /// Length of the inner common tangent of the two circles; 0 where they overlap.
    pub tangent: f64,
    /// Change of heading from start to end.
    turn: f64,
    /// Cosine and sine of half of it.
    half: DVec2,
}

/// The part of a word between its first and its last arc.
#[derive(Clone, Copy, Debug)]
pub struct Middle {
    pub length: f64,
    /// Change of heading.
    pub turn: f64,
    /// A vector, of any length, at the angle from D to the heading at which the first arc ends.
    pub lean: DVec2,
    /// True if the last arc turns counter-clockwise, as the first does.
    pub turns_on: bool,
}

/// A word's outer arcs, and the length of the whole.
#[derive(Clone, Copy, Debug)]
pub struct OuterArcs {
    pub first: f64,
    pub last: f64,
    pub total: f64,
}

impl Circles {
    pub fn new(chord: &Chord) -> Self {
        let (along, across) = (chord.along, chord.across);
        let sin = 2.0 * chord.half_sin;
        let cos = 2.0 * chord.half_cos;
        Self {
            between: [
                [Between::new(along - sin, across), Between::new(along + sin, across)],
                [Between::new(along, across - cos), Between::new(along, across + cos)],
            ],
            turn: chord.turn,
            half: DVec2::new(chord.half_cos, chord.half_sin),
        }
    }

    #[inline(always)]
    pub fn view(&self, ends: Ends, reflected: bool, flipped: bool) -> View {
        let between = &self.between[ends as usize][usize::from(reflected)];
        let (side, gear) = (sign(reflected), sign(flipped));
        View {
            vector: DVec2::new(gear * between.vector.x, side * between.vector.y),
            squared: between.squared,
            distance: between.distance,
            tangent: between.tangent,
            turn: side * gear * self.turn,
            half: DVec2::new(self.half.x, side * gear * self.half.y),
        }
    }
}

fn sign(negative: bool) -> f64 {
    if negative { -1.0 } else { 1.0 }
}

impl Between {
    fn new(x: f64, y: f64) -> Self {
        let squared = x * x + y * y;
        Self { vector: DVec2::new(x, y), squared, distance: squared.sqrt(), tangent: (squared - 4.0).max(0.0).sqrt() }
    }
}

impl View {
    /// The arcs before and after `middle`, each in [0, 2 pi), if the whole is shorter than `bound`.
    #[inline(always)]
    pub fn outer_arcs(&self, middle: &Middle, bound: f64) -> Option<OuterArcs> {
        let rest = self.turn - middle.turn;
        // Two arcs in the same sense turn by `rest` together; two in opposite senses differ by it.
        let min = if middle.turns_on { full_turn(rest) } else { rest.abs().min(TAU - rest.abs()) };
        if middle.length + min >= bound {
            return None;
        }
        let heading = self.half.rotate(self.vector.rotate(middle.lean));
        // Below the axis the first arc turns by more than half a circle, and costs at least that much.
        let turns_far = heading.y < -SLACK * (1.0 + heading.x.abs());
        if turns_far && middle.length + PI >= bound {
            return None;
        }
        let first = full_turn(ops::atan2(heading.y, heading.x));
        let (first, last) = if middle.turns_on { self.share(first, min) } else { (first, full_turn(first - rest)) };
        let total = if middle.turns_on && first + last <= min + PI { min } else { first + last };
        Some(OuterArcs { first, last, total: middle.length + total })
    }

    /// Divides `turns`, or a full turn more, between two arcs in the same sense.
    ///
    /// An arc that moves the goal by no more than rounding does is left out. This matters where the circles coincide and any
    /// division leads to the goal, and where rounding takes the first arc a little beyond either end.
    #[inline(always)]
    fn share(&self, first: f64, turns: f64) -> (f64, f64) {
        let moves_goal = |angle: f64| angle * self.distance > SLACK;
        if !moves_goal((turns - first).abs()) {
            (turns, 0.0)
        } else if !moves_goal(first.min(TAU - first)) {
            (0.0, turns)
        } else if first <= turns {
            (first, turns - first)
        } else {
            (first, turns - first + TAU)
        }
    }
}

/// The counter-clockwise turn in [0, 2 pi) that ends where `angle` does; `angle` lies between -4 pi and 4 pi.
#[inline(always)]
fn full_turn(angle: f64) -> f64 {
    let turn = if angle < -TAU {
        angle + 2.0 * TAU
    } else if angle < 0.0 {
        angle + TAU
    } else if angle >= TAU {
        angle - TAU
    } else {
        angle
    };
    if turn > TAU - SLACK { 0.0 } else { turn }
}

/// `value`, raised to `min` where it lies below by rounding only; nothing where it lies farther below.
#[inline(always)]
pub fn at_least(min: f64, value: f64) -> Option<f64> {
    (value >= min - SLACK).then(|| value.max(min))
}

/// `value`, lowered to `max` where it lies above by rounding only; nothing where it lies farther above.
#[inline(always)]
pub fn at_most(max: f64, value: f64) -> Option<f64> {
    (value <= max + SLACK).then(|| value.min(max))
}
