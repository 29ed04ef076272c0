//! Bushes of the legend, drawn once.

use crate::picture::canvas::Canvas;
use crate::picture::colours::PAPER;
use crate::picture::film::Fate;
use crate::picture::film::field::draw_sign;

/// A sheet is so many times wider than its bush, so that flames have room.
const ROOM: f32 = 1.4;
/// Smaller signs, in pixels, are flat, as cells are that are small.
const LEAST_DRAWN: f32 = 11.0;
const FLAT: f32 = 0.75;

/// Drawings of bushes by fate, all for cells of one size.
#[derive(Default)]
pub struct Signs {
    side: f32,
    drawn: Vec<Canvas>,
}

impl Signs {
    /// A bush in the middle of a sheet, for cells of that side in pixels.
    pub fn get(&mut self, fate: Fate, side: f32) -> &Canvas {
        if self.drawn.is_empty() || self.side != side {
            *self = Self { side, drawn: Fate::ALL.map(|fate| draw(fate, side)).into() };
        }
        &self.drawn[fate as usize]
    }
}

fn draw(fate: Fate, side: f32) -> Canvas {
    let mut sheet = Canvas::sized(ROOM * side, ROOM * side, PAPER);
    let middle = 0.5 * sheet.width() as f32;
    if side < LEAST_DRAWN {
        let (corner, flat) = (middle - 0.5 * FLAT * side, FLAT * side);
        sheet.fill_rect(corner, corner, flat, flat, fate.colour());
    } else {
        draw_sign(&mut sheet, fate, (middle, middle), side);
    }
    sheet
}
