//! Lines of text, measured and drawn.

use tiny_skia::{Path, PathBuilder, Transform};

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::Rgb;
use crate::font::{SizedFace, Weight, advance};

/// The width of the line about letters that are lifted off what is below, in heights of capitals.
const EDGE: f32 = 0.4;

/// The part of a line of text that is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Centre,
    Right,
}

impl Align {
    /// Returns where a line of text begins that has this part at `x`.
    pub fn left(self, x: f32, width: f32) -> f32 {
        match self {
            Self::Left => x,
            Self::Centre => x - width / 2.0,
            Self::Right => x - width,
        }
    }
}

/// Returns the width of a line of text in pixels, if its capitals are `height` pixels high. A few letters, such as `j`, reach
/// beyond by up to a tenth of that height.
pub fn measure_text(text: &str, height: f32) -> f32 {
    measure_weighted(text, height, Weight::Regular)
}

/// Returns the same of letters of a weight.
pub fn measure_weighted(text: &str, height: f32, weight: Weight) -> f32 {
    text.chars().map(|letter| advance(letter, weight)).sum::<f32>() * height
}

/// Draws a line of text on a base line; capitals are `height` pixels high, tails reach 0.3 of that below.
///
/// The text is shifted by less than a pixel, so that its base line falls on whole pixels.
pub fn draw_text(canvas: &mut Canvas, text: &str, at: (f32, f32), align: Align, height: f32, colour: Rgb) {
    if let Some(path) = text_path(text, at, align, height) {
        canvas.fill_shape(&path, Transform::identity(), Ink::opaque(colour));
    }
}

/// Draws a line of text as [`draw_text`] does, in the first colour, with an edge in the second one that lifts it off what is
/// below.
pub fn draw_text_on(
    canvas: &mut Canvas,
    text: &str,
    at: (f32, f32),
    align: Align,
    height: f32,
    colour: Rgb,
    edge: Rgb,
) {
    if let Some(path) = text_path(text, at, align, height) {
        canvas.stroke_shape(&path, Transform::identity(), EDGE * height, Ink::opaque(edge));
        canvas.fill_shape(&path, Transform::identity(), Ink::opaque(colour));
    }
}

/// The outlines of a line of text as [`draw_text`] draws it; `None` of one without ink.
pub fn text_path(text: &str, (x, base): Point, align: Align, height: f32) -> Option<Path> {
    let face = SizedFace::new(height, Weight::Regular);
    let mut pen = (align.left(x, measure_text(text, height)).round(), base.round());
    let mut path = PathBuilder::new();
    for letter in text.chars() {
        face.push_letter(&mut path, letter, pen);
        pen.0 += height * advance(letter, Weight::Regular);
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::{INK, PAPER};

    /// The left-most and right-most columns with ink of a text drawn at (100, 30).
    fn inked_columns(text: &str, align: Align) -> (u32, u32) {
        let mut canvas = Canvas::new(400, 40, PAPER);
        draw_text(&mut canvas, text, (100.0, 30.0), align, 10.0, INK);
        let picture = canvas.finish();
        let is_inked = |x: &u32| (0..40).any(|y| picture.pixel(*x, y) != PAPER);
        let left = (0..400).find(is_inked).expect("text leaves ink");
        (left, (0..400).rev().find(is_inked).expect("text leaves ink"))
    }

    #[test]
    fn text_is_as_wide_as_measured() {
        for text in ["H", "HHH", "0 - 100", "HillH", "Πυρκαγιά", "Пожарище", "jWumpusj", "模型"] {
            let (left, right) = inked_columns(text, Align::Left);
            let first = left as f32 - 100.0;
            let last = right as f32 + 1.0 - 100.0;
            let width = measure_text(text, 10.0);
            assert!((-1.5..=2.5).contains(&first), "{text} begins at {first}");
            assert!((-2.5..=1.5).contains(&(last - width)), "{text} ends at {last}, not {width}");
        }
    }

    #[test]
    fn text_is_where_it_is_aligned() {
        let (left, right) = inked_columns("HOH", Align::Centre);
        assert!((i64::from(100 - left) - i64::from(right - 100)).abs() <= 2);
        let (_, right) = inked_columns("HOH", Align::Right);
        assert!((97..=100).contains(&right));
    }

    #[test]
    fn bars_of_small_text_fall_on_whole_pixels() {
        let mut canvas = Canvas::new(20, 20, PAPER);
        draw_text(&mut canvas, "E", (5.0, 15.0), Align::Left, 10.0, INK);
        let picture = canvas.finish();
        let row = |y: u32| picture.pixel(10, y)[0];
        assert!(row(14) < 60 && row(15) > 240, "the base line: {}, {}", row(14), row(15));
        assert!(row(5) < 60 && row(4) > 240, "the upper end: {}, {}", row(5), row(4));
    }

    #[test]
    fn the_same_text_has_the_same_pixels_on_every_machine() {
        let mut canvas = Canvas::new(240, 30, PAPER);
        draw_text(&mut canvas, "Größe Ωμέγα Жук 0:12.5 模", (5.0, 20.0), Align::Left, 9.0, INK);
        assert_eq!(crc32fast::hash(canvas.bytes()), 0xbdc3_5a26, "the font, or how it is drawn, has changed");
    }
}
