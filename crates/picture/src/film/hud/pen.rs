//! Text, small shapes and signs of bushes, whose sizes are given in heights of ordinary text.

use crate::Rgb;
use crate::canvas::{Canvas, Point};
use crate::colours::{INK, PAPER, blend, bush_colour};
use crate::film::field::draw_sign;
use crate::film::lettering::{LetterStyle, Lettering};
use crate::font::Weight;
use crate::text::{Align, measure_weighted};
use wildfire_fire::BushStateKind;

/// The style of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextFace {
    /// Height of capitals in heights of ordinary text.
    pub size: f32,
    pub weight: Weight,
    pub colour: Rgb,
}

impl TextFace {
    pub const PLAIN: Self = Self { size: 0.9, weight: Weight::Regular, colour: INK };
    pub const STRONG: Self = Self { weight: Weight::Bold, ..Self::PLAIN };
    pub const TITLE: Self = Self { size: 1.2, weight: Weight::Bold, colour: INK };
    pub const CLOCK: Self = Self { size: 2.1, weight: Weight::Bold, colour: INK };

    pub fn faint() -> Self {
        Self { colour: blend(PAPER, INK, 0.6), ..Self::PLAIN }
    }
}

/// A pen for text and small shapes on a canvas.
pub struct TextPen<'a> {
    pub sheet: &'a mut Canvas,
    pub lettering: &'a mut Lettering,
    pub signs: &'a mut Signs,
    /// Height of ordinary text in pixels.
    pub text: f32,
}

impl TextPen<'_> {
    /// A length in whole pixels.
    pub fn length(&self, texts: f32) -> f32 {
        (texts * self.text).round()
    }

    pub fn height(&self, face: TextFace) -> f32 {
        face.size * self.text
    }

    pub fn measure(&self, text: &str, face: TextFace) -> f32 {
        measure_weighted(text, self.height(face), face.weight)
    }

    pub fn write(&mut self, text: &str, at: Point, align: Align, face: TextFace) {
        let style = LetterStyle { height: self.height(face), weight: face.weight, colour: face.colour };
        self.lettering.draw(self.sheet, text, at, align, style);
    }

    pub fn fill(&mut self, (left, top): Point, (width, height): (f32, f32), colour: Rgb) {
        let right = left.round() + width.round();
        let bottom = top.round() + height.round();
        self.sheet.fill_pixels((whole(left), whole(top)), (whole(right), whole(bottom)), colour);
    }

    /// The sign of a state in the legend about a place, `side` pixels wide and high.
    pub fn sign(&mut self, kind: BushStateKind, (x, y): Point, side: f32) {
        let sign = self.signs.get(kind, side);
        let half = 0.5 * sign.width() as f32;
        // A sign that begins outside of the sheet is left out, since `copy_from` takes no negative place.
        if let (Ok(left), Ok(top)) = (u32::try_from(whole(x - half)), u32::try_from(whole(y - half))) {
            self.sheet.copy_from(sign, (left, top));
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
fn whole(at: f32) -> i32 {
    at.round() as i32
}

/// The width of a sign's canvas in widths of its bush, so that flames have room.
const SIGN_ROOM: f32 = 1.4;
/// Smaller signs, in pixels, are flat, as cells are that are small.
const MIN_DRAWN: f32 = 11.0;
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
            *self = Self { side, drawn: BushStateKind::ALL.map(|kind| draw_sign_canvas(kind, side)).into() };
        }
        &self.drawn[kind as usize]
    }
}

fn draw_sign_canvas(kind: BushStateKind, side: f32) -> Canvas {
    let mut sheet = Canvas::sized(SIGN_ROOM * side, SIGN_ROOM * side, PAPER);
    let middle = 0.5 * sheet.width() as f32;
    if side < MIN_DRAWN {
        let corner = middle - 0.5 * FLAT * side;
        let flat = FLAT * side;
        sheet.fill_rect(corner, corner, flat, flat, bush_colour(kind));
    } else {
        draw_sign(&mut sheet, kind, (middle, middle), side);
    }
    sheet
}
