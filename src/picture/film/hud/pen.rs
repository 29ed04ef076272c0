//! Draws text and small shapes whose sizes are told in heights of ordinary text.

use super::super::lettering::{Lettering, Style};
use super::signs::Signs;
use crate::fire::BushStateKind;
use crate::picture::Rgb;
use crate::picture::canvas::{Canvas, Point};
use crate::picture::colours::{INK, PAPER, blend};
use crate::picture::text::{Align, measure};

/// How text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Height of capitals in heights of ordinary text.
    pub size: f32,
    pub is_bold: bool,
    pub colour: Rgb,
}

impl Face {
    pub const PLAIN: Self = Self { size: 0.9, is_bold: false, colour: INK };
    pub const STRONG: Self = Self { is_bold: true, ..Self::PLAIN };
    pub const TITLE: Self = Self { size: 1.2, is_bold: true, colour: INK };
    pub const CLOCK: Self = Self { size: 2.1, is_bold: true, colour: INK };

    pub fn faint() -> Self {
        Self { colour: blend(PAPER, INK, 0.6), ..Self::PLAIN }
    }
}

/// What draws on a sheet.
pub struct Pen<'a> {
    pub sheet: &'a mut Canvas,
    pub lettering: &'a mut Lettering,
    pub signs: &'a mut Signs,
    /// Height of ordinary text in pixels.
    pub text: f32,
}

impl Pen<'_> {
    /// A length in whole pixels.
    pub fn length(&self, texts: f32) -> f32 {
        (texts * self.text).round()
    }

    pub fn height(&self, face: Face) -> f32 {
        face.size * self.text
    }

    pub fn measure(&self, text: &str, face: Face) -> f32 {
        measure(text, self.height(face))
    }

    pub fn write(&mut self, text: &str, at: Point, align: Align, face: Face) {
        let style = Style { height: self.height(face), is_bold: face.is_bold, colour: face.colour };
        self.lettering.draw(self.sheet, text, at, align, style);
    }

    pub fn fill(&mut self, (left, top): Point, (width, height): (f32, f32), colour: Rgb) {
        let (right, bottom) = (left.round() + width.round(), top.round() + height.round());
        self.sheet.fill_pixels((whole(left), whole(top)), (whole(right), whole(bottom)), colour);
    }

    /// The sign of a state in the legend about a place, `side` pixels wide and high.
    pub fn sign(&mut self, kind: BushStateKind, (x, y): Point, side: f32) {
        let sign = self.signs.get(kind, side);
        let half = 0.5 * sign.width() as f32;
        if let (Ok(left), Ok(top)) = (u32::try_from(whole(x - half)), u32::try_from(whole(y - half))) {
            self.sheet.copy_from(sign, (left, top));
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a place on the sheet")]
fn whole(at: f32) -> i32 {
    at.round() as i32
}
