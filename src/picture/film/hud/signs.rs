//! Bushes of the legend, drawn once.

use crate::fire::BushStateKind;
use crate::picture::canvas::Canvas;
use crate::picture::colours::PAPER;
use crate::picture::colours::bush_colour;
use crate::picture::film::field::draw_sign;

/// A sheet is so many times wider than its bush, so that flames have room.
const ROOM: f32 = 1.4;
/// Smaller signs, in pixels, are flat, as cells are that are small.
const LEAST_DRAWN: f32 = 11.0;
const FLAT: f32 = 0.75;

/// Drawings of bushes by state, all for cells of one size.
#[derive(Default)]
pub struct Signs {
    side: f32,
    drawn: Vec<Canvas>,
}

impl Signs {
    /// A bush in the middle of a sheet, for cells of that side in pixels.
    pub fn get(&mut self, kind: BushStateKind, side: f32) -> &Canvas {
        if self.drawn.is_empty() || self.side != side {
            *self = Self { side, drawn: BushStateKind::ALL.map(|kind| draw(kind, side)).into() };
        }
        &self.drawn[kind as usize]
    }
}

fn draw(kind: BushStateKind, side: f32) -> Canvas {
    let mut sheet = Canvas::sized(ROOM * side, ROOM * side, PAPER);
    let middle = 0.5 * sheet.width() as f32;
    if side < LEAST_DRAWN {
        let (corner, flat) = (middle - 0.5 * FLAT * side, FLAT * side);
        sheet.fill_rect(corner, corner, flat, flat, bush_colour(kind));
    } else {
        draw_sign(&mut sheet, kind, (middle, middle), side);
    }
    sheet
}
