//! Lines of text that are drawn repeatedly: every letter is drawn once and then stamped.

use tiny_skia::{PathBuilder, Transform};

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::Rgb;
use crate::font::{SizedFace, Weight, advance, glyph_index};
use crate::text::{Align, measure_weighted};

/// The style of a line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LetterStyle {
    /// The height of capitals in pixels.
    pub height: f32,
    pub weight: Weight,
    pub colour: Rgb,
}

/// Letters begin at whole pixels and this many places between.
const PLACES: usize = 4;

/// The share of each pixel that a letter covers.
#[derive(Debug)]
struct Stamp {
    /// Of the upper left pixel from where the letter begins on the base line.
    left: i32,
    top: i32,
    width: usize,
    coverage: Vec<u8>,
}

/// Stamps of one height and weight.
struct Case {
    height: f32,
    weight: Weight,
    face: SizedFace,
    /// By the place of the letter's drawing in the font, then by place between pixels; as long as it had to be so far.
    stamps: Vec<Option<Stamp>>,
}

/// Draws lines of text; keeps the stamps.
#[derive(Default)]
pub struct Lettering {
    cases: Vec<Case>,
}

impl Lettering {
    /// Draws a line of text on a base line.
    pub fn draw(&mut self, canvas: &mut Canvas, text: &str, (x, base): Point, align: Align, style: LetterStyle) {
        let mut at = align.left(x, measure_weighted(text, style.height, style.weight)).round();
        let case = self.case(style);
        for letter in text.chars() {
            // Rounded to quarters of a pixel: finer places look the same and would need more stamps.
            let (column, place) = split(at);
            case.stamp(letter, place).print(canvas, (column, whole(base)), style.colour);
            at += advance(letter, style.weight) * style.height;
        }
    }

    fn case(&mut self, style: LetterStyle) -> &mut Case {
        let index = self
            .cases
            .iter()
            .position(|case| case.height == style.height && case.weight == style.weight)
            .unwrap_or_else(|| {
                let LetterStyle { height, weight, .. } = style;
                self.cases.push(Case { height, weight, face: SizedFace::new(height, weight), stamps: Vec::new() });
                self.cases.len() - 1
            });
        &mut self.cases[index]
    }
}

impl Case {
    fn stamp(&mut self, letter: char, place: usize) -> &Stamp {
        let index = glyph_index(letter, self.weight) * PLACES + place;
        if self.stamps.len() <= index {
            self.stamps.resize_with(index + 1, || None);
        }
        self.stamps[index].get_or_insert_with(|| Stamp::cut(&self.face, letter, place))
    }
}

impl Stamp {
    /// Fills the outline of a letter in white on black, so that a channel of each pixel is its coverage.
    fn cut(face: &SizedFace, letter: char, place: usize) -> Self {
        let mut path = PathBuilder::new();
        face.push_letter(&mut path, letter, (place as f32 / PLACES as f32, 0.0));
        let Some(path) = path.finish() else { return Self { left: 0, top: 0, width: 1, coverage: Vec::new() } };
        let bounds = path.bounds();
        let left = bounds.left().floor();
        let top = bounds.top().floor();
        let mut canvas = Canvas::sized(bounds.right().ceil() - left, bounds.bottom().ceil() - top, [0; 3]);
        canvas.fill_shape(&path, Transform::from_translate(-left, -top), Ink::opaque([255; 3]));
        let (pixels, _) = canvas.bytes().as_chunks::<4>();
        let coverage = pixels.iter().map(|pixel| pixel[0]).collect();
        Self { left: whole(left), top: whole(top), width: canvas.width() as usize, coverage }
    }

    fn print(&self, canvas: &mut Canvas, (x, base): (i32, i32), colour: Rgb) {
        for (row, coverage) in self.coverage.chunks(self.width).enumerate() {
            let Ok(y) = usize::try_from(base + self.top + row as i32) else { continue };
            if y < canvas.height() as usize {
                print_row(canvas.row_from(0, y), x + self.left, coverage, colour);
            }
        }
    }
}

fn print_row(pixels: &mut [[u8; 4]], left: i32, coverage: &[u8], colour: Rgb) {
    let hidden = usize::try_from(-left).unwrap_or(0).min(coverage.len());
    let left = usize::try_from(left).unwrap_or(0).min(pixels.len());
    for (pixel, &covered) in pixels[left..].iter_mut().zip(&coverage[hidden..]).filter(|(_, covered)| **covered > 0) {
        for (under, &over) in pixel.iter_mut().zip(&colour) {
            *under = mixed(*under, over, covered);
        }
    }
}

/// Mixes in whole numbers, as this is done for every pixel of every frame's text.
fn mixed(under: u8, over: u8, covered: u8) -> u8 {
    let [under, over, covered] = [under, over, covered].map(u16::from);
    ((under * (255 - covered) + over * covered + 127) / 255) as u8
}

/// Whole pixels, and the nearest place after them.
fn split(at: f32) -> (i32, usize) {
    let places = whole(at * PLACES as f32);
    (places.div_euclid(PLACES as i32), places.rem_euclid(PLACES as i32) as usize)
}

#[expect(clippy::cast_possible_truncation, reason = "places on a sheet are some thousand pixels")]
fn whole(value: f32) -> i32 {
    value.round() as i32
}

/// The text, or as much of it as fits into a width, with dots for the rest.
pub fn fitted(text: &str, height: f32, weight: Weight, width: f32) -> String {
    if measure_weighted(text, height, weight) <= width {
        return text.to_owned();
    }
    let mut short = "...".to_owned();
    for (end, _) in text.char_indices() {
        let longer = text[..end].trim_end().to_owned() + "...";
        if measure_weighted(&longer, height, weight) > width {
            break;
        }
        short = longer;
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::{INK, PAPER};
    use crate::text::{draw_text, measure_text};

    const STYLE: LetterStyle = LetterStyle { height: 10.0, weight: Weight::Regular, colour: INK };

    const PLAIN: (f32, Weight) = (10.0, Weight::Regular);

    #[test]
    fn stamped_text_looks_like_drawn_text() {
        let mut stamped = Canvas::new(300, 30, PAPER);
        let mut drawn = Canvas::new(300, 30, PAPER);
        let line = "0:12:34.5 Wumpus leads by 17 (%)";
        Lettering::default().draw(&mut stamped, line, (5.0, 20.0), Align::Left, STYLE);
        draw_text(&mut drawn, line, (5.0, 20.0), Align::Left, STYLE.height, STYLE.colour);
        let ink = |canvas: &Canvas| canvas.bytes().iter().map(|&byte| f64::from(255 - byte)).sum::<f64>();
        let apart: f64 = stamped.bytes().iter().zip(drawn.bytes()).map(|(&a, &b)| f64::from(a.abs_diff(b))).sum();
        assert!(apart < 0.2 * ink(&drawn), "{apart} of {}", ink(&drawn));
    }

    #[test]
    fn text_at_the_edges_of_the_sheet_is_cut_off() {
        let mut lettering = Lettering::default();
        for at in [(-30.0, 5.0), (95.0, 38.0), (50.0, -200.0), (5000.0, 20.0)] {
            let mut small = Canvas::new(100, 40, PAPER);
            let mut large = Canvas::new(200, 80, PAPER);
            lettering.draw(&mut small, "Wumpus", at, Align::Left, STYLE);
            lettering.draw(&mut large, "Wumpus", at, Align::Left, STYLE);
            let pixel_bytes = small.bytes().len() / (100 * 40);
            let rows = large.bytes().chunks(200 * pixel_bytes).map(|row| &row[..100 * pixel_bytes]);
            assert!(small.bytes().chunks(100 * pixel_bytes).eq(rows.take(40)), "at {at:?}");
        }
    }

    #[test]
    fn long_text_is_cut_to_fit() {
        assert_eq!(fitted("contest", PLAIN.0, PLAIN.1, 500.0), "contest");
        let short = fitted("a scenario with a rather long name", PLAIN.0, PLAIN.1, 100.0);
        assert!(short.starts_with("a scen") && short.ends_with("..."), "{short}");
        assert!(measure_text(&short, 10.0) <= 100.0);
        let endless = "Wumpus".repeat(700);
        let kept = fitted(&endless, PLAIN.0, PLAIN.1, 100.0).len() - "...".len();
        assert!(
            measure_text(&format!("{}...", &endless[..=kept]), 10.0) > 100.0,
            "there was room for more than {kept}"
        );
        assert_eq!(fitted(&endless, PLAIN.0, PLAIN.1, 1.0), "...");
    }
}
