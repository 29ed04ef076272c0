//! Bushes by themselves, as a legend shows them.

use super::{bushes, flames};
use crate::fire::BushStateKind;
use crate::picture::canvas::{Canvas, Point};

/// Draws a bush about a place, as large as in a cell of that side in pixels.
pub fn draw_sign(canvas: &mut Canvas, kind: BushStateKind, at: Point, side: f32) {
    bushes::draw_one(canvas, kind, 0, at, side);
    if kind == BushStateKind::Burning {
        flames::draw_tongues(canvas, at, (side, side), 0);
    }
}
