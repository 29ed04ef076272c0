//! Lines of text that are drawn over and over: every character is stroked once and stamped from then on.

use crate::picture::canvas::{Canvas, Point};
use crate::picture::colours::Rgb;
use crate::picture::font::{CAPITAL, glyph};
use crate::picture::text::{Align, PEN, measure_text, push_glyph};

/// The style of a line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LetterStyle {
    /// The height of capitals in pixels.
    pub height: f32,
    pub is_bold: bool,
    pub colour: Rgb,
}

/// Width of the pen for bold text in units of the font.
const BOLD_PEN: f32 = 1.9;
/// Thinner lines would be too faint, in pixels.
const LEAST_PEN: f32 = 1.1;
/// Characters begin at whole pixels and this many places between.
const PLACES: usize = 4;
const LETTERS: usize = 128;

/// The share of each pixel that a character covers.
#[derive(Debug)]
struct Stamp {
    /// Of the upper left pixel from where the character begins on the base line.
    left: i32,
    top: i32,
    width: usize,
    coverage: Vec<u8>,
}

/// Stamps of one height and pen, by letter and place between pixels.
#[derive(Debug)]
struct Case {
    height: f32,
    is_bold: bool,
    stamps: Vec<Option<Stamp>>,
}

/// Draws lines of text; keeps the stamps.
#[derive(Debug, Default)]
pub struct Lettering {
    cases: Vec<Case>,
}

impl Lettering {
    /// Draws a line of text on a base line.
    pub fn draw(&mut self, canvas: &mut Canvas, text: &str, (x, base): Point, align: Align, style: LetterStyle) {
        let left = match align {
            Align::Left => x,
            Align::Centre => x - measure_text(text, style.height) / 2.0,
            Align::Right => x - measure_text(text, style.height),
        };
        let case = self.case(style);
        let unit = style.height / CAPITAL;
        let mut at = left.round();
        for letter in text.chars() {
            let letter = if letter.is_ascii() { letter } else { '?' };
            // Rounded to quarters of a pixel: finer places look the same and would need more stamps.
            let (column, place) = split(at);
            case.stamp(letter, place).print(canvas, (column, whole(base)), style.colour);
            at += glyph(letter).advance * unit;
        }
    }

    fn case(&mut self, style: LetterStyle) -> &mut Case {
        let is_right = |case: &Case| case.height == style.height && case.is_bold == style.is_bold;
        let index = self.cases.iter().position(is_right).unwrap_or_else(|| {
            let stamps = (0..LETTERS * PLACES).map(|_| None).collect();
            self.cases.push(Case { height: style.height, is_bold: style.is_bold, stamps });
            self.cases.len() - 1
        });
        &mut self.cases[index]
    }
}

impl Case {
    fn stamp(&mut self, letter: char, place: usize) -> &Stamp {
        let (height, is_bold) = (self.height, self.is_bold);
        let stamp = &mut self.stamps[letter as usize * PLACES + place];
        stamp.get_or_insert_with(|| Stamp::cut(letter, place, height, is_bold))
    }
}

impl Stamp {
    /// Strokes a character in white on black, so that a channel of each pixel is its coverage.
    fn cut(letter: char, place: usize, height: f32, is_bold: bool) -> Self {
        let unit = height / CAPITAL;
        let pen = (if is_bold { BOLD_PEN } else { PEN } * unit).max(LEAST_PEN);
        let margin = (2.0 * pen).ceil();
        let above = (1.2 * height).ceil() + margin;
        let width = (glyph(letter).advance * unit).ceil() + 2.0 * margin;
        let mut canvas = Canvas::sized(width, above + (0.4 * height).ceil() + margin, [0; 3]);
        let mut path = tiny_skia::PathBuilder::new();
        let x = margin + place as f32 / PLACES as f32 + 0.5 * pen.max(1.0);
        push_glyph(&mut path, glyph(letter), (x, above - 0.5), unit);
        canvas.stroke(path, pen, [255; 3]);
        let (pixels, _) = canvas.bytes().as_chunks::<4>();
        let coverage = pixels.iter().map(|pixel| pixel[0]).collect();
        Self { left: -whole(margin), top: -whole(above), width: canvas.width() as usize, coverage }
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
pub fn fitted(text: &str, height: f32, width: f32) -> String {
    if measure_text(text, height) <= width {
        return text.to_owned();
    }
    let mut short = "...".to_owned();
    for (end, _) in text.char_indices() {
        let longer = text[..end].trim_end().to_owned() + "...";
        if measure_text(&longer, height) > width {
            break;
        }
        short = longer;
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::colours::{INK, PAPER};
    use crate::picture::text::draw_text;

    const STYLE: LetterStyle = LetterStyle { height: 10.0, is_bold: false, colour: INK };

    #[test]
    fn stamped_text_looks_like_stroked_text() {
        let (mut stamped, mut stroked) = (Canvas::new(300, 30, PAPER), Canvas::new(300, 30, PAPER));
        let line = "0:12:34.5 Wumpus leads by 17 (%)";
        Lettering::default().draw(&mut stamped, line, (5.0, 20.0), Align::Left, STYLE);
        draw_text(&mut stroked, line, (5.0, 20.0), Align::Left, STYLE.height, STYLE.colour);
        let ink = |canvas: &Canvas| canvas.bytes().iter().map(|&byte| f64::from(255 - byte)).sum::<f64>();
        let apart: f64 = stamped.bytes().iter().zip(stroked.bytes()).map(|(&a, &b)| f64::from(a.abs_diff(b))).sum();
        assert!(apart < 0.2 * ink(&stroked), "{apart} of {}", ink(&stroked));
    }

    #[test]
    fn text_at_the_edges_of_the_sheet_is_cut_off() {
        let mut lettering = Lettering::default();
        for at in [(-30.0, 5.0), (95.0, 38.0), (50.0, -200.0), (5000.0, 20.0)] {
            lettering.draw(&mut Canvas::new(100, 40, PAPER), "Wumpus", at, Align::Left, STYLE);
        }
    }

    #[test]
    fn long_text_is_cut_to_fit() {
        assert_eq!(fitted("contest", 10.0, 500.0), "contest");
        let short = fitted("a scenario with a rather long name", 10.0, 100.0);
        assert!(short.starts_with("a scen") && short.ends_with("..."), "{short}");
        assert!(measure_text(&short, 10.0) <= 100.0);
        let endless = "Wumpus".repeat(700);
        let kept = fitted(&endless, 10.0, 100.0).len() - "...".len();
        assert!(
            measure_text(&format!("{}...", &endless[..=kept]), 10.0) > 100.0,
            "there was room for more than {kept}"
        );
        assert_eq!(fitted(&endless, 10.0, 1.0), "...");
    }
}
