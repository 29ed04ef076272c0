//! Bushes by themselves, as a legend shows them.

use super::{bushes, flames};
use crate::picture::canvas::{Canvas, Point};
use crate::picture::film::Fate;

/// Draws a bush about a place, as large as in a cell of that side in pixels.
pub fn draw_sign(canvas: &mut Canvas, fate: Fate, at: Point, side: f32) {
    bushes::draw_one(canvas, fate, 0, at, side);
    if fate == Fate::Burning {
        flames::draw_tongues(canvas, at, (side, side), 0);
    }
}
