//! The project's own font: pen strokes for the printable characters of ASCII, read from `assets/font.txt`.

use std::sync::LazyLock;

const SOURCE: &str = include_str!("../../assets/font.txt");
const FIRST: char = ' ';
const LAST: char = '~';

/// The height of capitals and figures in units of the font.
pub const CAPITAL: f32 = 10.0;

/// A character in units of the font, x to the right from its left edge, y up from the base line.
#[derive(Clone, Debug, Default)]
pub struct Glyph {
    /// The distance from this character's left edge to the next one's.
    pub advance: f32,
    pub strokes: Vec<Vec<PenPoint>>,
}

/// A point of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenPoint {
    pub x: f32,
    pub y: f32,
    /// True if it only bends the line from the point before it to the point after it, as the control point of a
    /// quadratic curve.
    pub bends: bool,
}

static GLYPHS: LazyLock<Vec<Glyph>> = LazyLock::new(|| {
    let mut glyphs = vec![Glyph::default(); LAST as usize - FIRST as usize + 1];
    for line in SOURCE.lines().filter(|line| !line.is_empty() && !line.starts_with("//")) {
        let (letter, glyph) = read_line(line).expect("the font is part of the program, and a test reads all of it");
        glyphs[index(letter).expect("the font holds printable ASCII only")] = glyph;
    }
    glyphs
});

/// The strokes of a character; those that the font does not have are shown as a question mark.
pub fn glyph(letter: char) -> &'static Glyph {
    let index = index(letter).or(index('?')).expect("the question mark is a printable character");
    &GLYPHS[index]
}

/// Says whether the font has every character of a text, so that none is shown as a question mark.
pub fn has_all_of(text: &str) -> bool {
    text.chars().all(|letter| index(letter).is_some())
}

fn index(letter: char) -> Option<usize> {
    (FIRST..=LAST).contains(&letter).then(|| letter as usize - FIRST as usize)
}

fn read_line(line: &str) -> Option<(char, Glyph)> {
    let (name, rest) = line.split_once(' ')?;
    let letter = if name == "space" { ' ' } else { name.parse().ok()? };
    let (advance, strokes) = rest.split_once(' ').unwrap_or((rest, ""));
    let strokes = strokes.split('|').map(|stroke| stroke.split_whitespace().map(read_point).collect());
    let strokes: Option<Vec<Vec<PenPoint>>> = strokes.collect();
    Some((letter, Glyph { advance: advance.parse().ok()?, strokes: strokes? }))
}

fn read_point(text: &str) -> Option<PenPoint> {
    let inside = text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
    let (x, y) = inside.unwrap_or(text).split_once(',')?;
    Some(PenPoint { x: x.parse().ok()?, y: y.parse().ok()?, bends: inside.is_some() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_printable_character_is_drawn() {
        for letter in '!'..=LAST {
            let drawn = glyph(letter);
            assert!(drawn.strokes.iter().all(|stroke| stroke.len() >= 2), "'{letter}' has a stroke without length");
            assert!(!drawn.strokes.is_empty(), "'{letter}' has no strokes");
        }
        assert!(glyph(' ').advance > 0.0);
    }

    #[test]
    fn characters_stay_within_their_line_and_their_advance() {
        for letter in '!'..=LAST {
            for point in glyph(letter).strokes.iter().flatten() {
                assert!((-3.0..=CAPITAL + 1.5).contains(&point.y), "'{letter}' leaves its line at {point:?}");
                assert!((-1.0..glyph(letter).advance).contains(&point.x), "'{letter}' is too wide at {point:?}");
            }
        }
    }

    #[test]
    fn curves_are_bent_between_points() {
        for letter in '!'..=LAST {
            for stroke in &glyph(letter).strokes {
                assert!(!stroke[0].bends && !stroke[stroke.len() - 1].bends, "'{letter}' ends in a control point");
                assert!(!stroke.windows(2).any(|pair| pair[0].bends && pair[1].bends), "'{letter}' bends twice");
            }
        }
    }

    #[test]
    fn figures_are_equally_wide() {
        assert!(('0'..='9').all(|figure| glyph(figure).advance == glyph('0').advance));
    }

    #[test]
    fn the_font_knows_what_it_lacks() {
        assert!(has_all_of("") && has_all_of("contest, field.coverage=0.1 ~"));
        for text in ["Größe", "f\u{2026}", "a\tb", "\u{6a21}\u{578b}"] {
            assert!(!has_all_of(text), "{text}");
        }
    }

    #[test]
    fn unknown_characters_become_question_marks() {
        assert_eq!(glyph('\n').strokes, glyph('?').strokes);
        assert_eq!(glyph('\u{e9}').strokes, glyph('?').strokes);
    }
}
