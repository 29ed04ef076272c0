//! Lines of text, measured and drawn.

use tiny_skia::PathBuilder;

use crate::picture::canvas::Canvas;
use crate::picture::colours::Rgb;
use crate::picture::font::{CAPITAL, Glyph, PenPoint, glyph};

/// Width of the pen in units of the font.
pub const PEN: f32 = 1.15;
/// The gap that an advance leaves between the pen's lines of two characters, in units of the font.
const GAP: f32 = 2.5;

/// The part of a line of text that is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Centre,
    Right,
}

/// Returns how far a line of text reaches from the left edge of its first character to the right edge of its last, in
/// pixels, if its capitals are `height` pixels high.
pub fn measure_text(text: &str, height: f32) -> f32 {
    let advances: f32 = text.chars().map(|letter| glyph(letter).advance).sum();
    ((advances - GAP + PEN) * height / CAPITAL).max(0.0)
}

/// Draws a line of text on a base line; capitals are `height` pixels high, tails reach 0.3 of that below.
///
/// The text is shifted by less than a pixel, so that its stems and bars fall on whole pixels as far as may be.
pub fn draw_text(canvas: &mut Canvas, text: &str, at: (f32, f32), align: Align, height: f32, colour: Rgb) {
    canvas.stroke(text_path(text, at, align, height), PEN * height / CAPITAL, colour);
}

/// Draws a line of text as [`draw_text`] does, in the first colour, with an edge in the second one that lifts it off what is
/// below.
pub fn draw_text_on(
    canvas: &mut Canvas,
    text: &str,
    at: (f32, f32),
    align: Align,
    height: f32,
    (colour, edge): (Rgb, Rgb),
) {
    let (path, pen) = (text_path(text, at, align, height), PEN * height / CAPITAL);
    canvas.stroke(path.clone(), pen + 0.4 * height, edge);
    canvas.stroke(path, pen, colour);
}

fn text_path(text: &str, (x, base): (f32, f32), align: Align, height: f32) -> PathBuilder {
    let unit = height / CAPITAL;
    let width = measure_text(text, height);
    let left = match align {
        Align::Left => x,
        Align::Centre => x - width / 2.0,
        Align::Right => x - width,
    };
    let mut pen = (left.round() + 0.5 * (PEN * unit).max(1.0), base.round() - 0.5);
    let mut path = PathBuilder::new();
    for letter in text.chars() {
        let glyph = glyph(letter);
        push_glyph(&mut path, glyph, pen, unit);
        pen.0 += glyph.advance * unit;
    }
    path
}

/// Adds the strokes of a character whose left end of the base line lies at a place; `unit` is pixels a unit of the
/// font.
pub fn push_glyph(path: &mut PathBuilder, glyph: &Glyph, (x, y): (f32, f32), unit: f32) {
    let place = |point: &PenPoint| (x + point.x * unit, y - point.y * unit);
    for stroke in glyph.strokes.iter().filter(|stroke| !stroke.is_empty()) {
        let start = place(&stroke[0]);
        path.move_to(start.0, start.1);
        let mut bend = None;
        for point in &stroke[1..] {
            let at = place(point);
            match (point.bends, bend.take()) {
                (true, _) => bend = Some(at),
                (false, Some((bend_x, bend_y))) => path.quad_to(bend_x, bend_y, at.0, at.1),
                (false, None) => path.line_to(at.0, at.1),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::colours::{INK, PAPER};

    /// The left-most and right-most columns with ink of a text drawn at (100, 30).
    fn inked_columns(text: &str, align: Align) -> (u32, u32) {
        let mut canvas = Canvas::new(200, 40, PAPER);
        draw_text(&mut canvas, text, (100.0, 30.0), align, 10.0, INK);
        let picture = canvas.finish();
        let is_inked = |x: &u32| (0..40).any(|y| picture.pixel(*x, y) != PAPER);
        let left = (0..200).find(is_inked).expect("text leaves ink");
        (left, (0..200).rev().find(is_inked).expect("text leaves ink"))
    }

    #[test]
    fn text_is_as_wide_as_measured() {
        for text in ["H", "HHH", "0 - 100", "HillH"] {
            let (left, right) = inked_columns(text, Align::Left);
            assert!((99..=101).contains(&left), "{text} begins at {left}");
            let inked = (right + 1 - left) as f32;
            assert!(
                (inked - measure_text(text, 10.0)).abs() <= 2.0,
                "{text}: {inked} for {}",
                measure_text(text, 10.0)
            );
        }
    }

    #[test]
    fn text_stands_where_it_is_aligned() {
        let (left, right) = inked_columns("HOH", Align::Centre);
        assert!((i64::from(100 - left) - i64::from(right - 100)).abs() <= 2);
        let (_, right) = inked_columns("HOH", Align::Right);
        assert!((98..=101).contains(&right));
    }

    #[test]
    fn stems_of_small_text_fall_on_whole_pixels() {
        let mut canvas = Canvas::new(20, 20, PAPER);
        draw_text(&mut canvas, "I", (5.0, 15.0), Align::Left, 10.0, INK);
        let picture = canvas.finish();
        assert!(picture.pixel(5, 10)[0] < 60, "{:?}", picture.pixel(5, 10));
        assert!(picture.pixel(3, 10)[0] > 240 && picture.pixel(7, 10)[0] > 240);
    }
}
