//! The font of pictures: Arimo, regular and bold, with letters of Latin, Greek and Cyrillic, punctuation, arrows and
//! mathematical signs.
//!
//! Its letters are as wide as those of Arial and Helvetica, in which charts are shown as SVG. Outlines are fitted to whole
//! pixels upwards only, so that small text is sharp and a line is as wide as its letters are by themselves.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use skrifa::charmap::Charmap;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{
    DrawSettings, Engine, GlyphStyles, HintingInstance, HintingOptions, OutlineGlyphCollection, OutlinePen, SmoothMode,
    Target,
};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use tiny_skia::PathBuilder;

use crate::canvas::Point;

static FACES: LazyLock<[Face; 2]> = LazyLock::new(|| {
    [include_bytes!("../assets/fonts/Arimo-Regular.ttf").as_slice(), include_bytes!("../assets/fonts/Arimo-Bold.ttf")]
        .map(Face::new)
});

/// The weight of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    Regular,
    Bold,
}

/// One weight of the font.
struct Face {
    letters: Charmap<'static>,
    outlines: OutlineGlyphCollection<'static>,
    styles: GlyphStyles,
    /// In units of the font.
    metrics: GlyphMetrics<'static>,
    /// Heights of capitals that an em has.
    em: f32,
    /// Heights of capitals that a unit of the font has.
    unit: f32,
}

impl Face {
    fn new(file: &'static [u8]) -> Self {
        let font = FontRef::new(file).expect("the font is part of the program");
        let size = Size::unscaled();
        let location = LocationRef::default();
        let metrics = font.metrics(size, location);
        // Heights of text are those of its capitals throughout.
        let unit = 1.0 / metrics.cap_height.expect("the font says how high its capitals are");
        let outlines = font.outline_glyphs();
        Self {
            letters: font.charmap(),
            styles: GlyphStyles::new(&outlines),
            outlines,
            metrics: font.glyph_metrics(size, location),
            em: f32::from(metrics.units_per_em) * unit,
            unit,
        }
    }

    /// Returns the drawing of a letter; of one that the font lacks, that of a box.
    fn glyph(&self, letter: char) -> GlyphId {
        self.letters.map(letter).unwrap_or(GlyphId::NOTDEF)
    }
}

fn face(weight: Weight) -> &'static Face {
    &FACES[weight as usize]
}

/// Returns the place of a letter's drawing in the font: from 0 on, the box of unknown letters first.
pub fn glyph_index(letter: char, weight: Weight) -> usize {
    face(weight).glyph(letter).to_u32() as usize
}

/// Returns how far to the right of a letter the next one begins, in heights of capitals.
pub fn advance(letter: char, weight: Weight) -> f32 {
    let face = face(weight);
    face.metrics.advance_width(face.glyph(letter)).unwrap_or(0.0) * face.unit
}

/// Returns the letters of a text, each once, that the font lacks and that are drawn as boxes.
pub fn unknown_letters(text: &str) -> BTreeSet<char> {
    let face = face(Weight::Regular);
    text.chars().filter(|&letter| face.letters.map(letter).is_none()).collect()
}

/// Letters of one weight and height.
pub struct SizedFace {
    face: &'static Face,
    fitting: HintingInstance,
}

impl SizedFace {
    /// Letters whose capitals are `height` pixels high, to a whole pixel.
    pub fn new(height: f32, weight: Weight) -> Self {
        let face = face(weight);
        let upwards_only =
            Target::Smooth { mode: SmoothMode::Light, symmetric_rendering: true, preserve_linear_metrics: true };
        let options = HintingOptions { engine: Engine::Auto(Some(face.styles.clone())), target: upwards_only };
        let size = Size::new(height * face.em);
        let fitting = HintingInstance::new(&face.outlines, size, LocationRef::default(), options)
            .expect("the font's outlines can be fitted at every size");
        Self { face, fitting }
    }

    /// Adds the outline of a letter whose left end of the base line lies at a place.
    pub fn push_letter(&self, path: &mut PathBuilder, letter: char, at: Point) {
        let glyph =
            self.face.outlines.get(self.face.glyph(letter)).expect("the font draws all that it maps letters to");
        glyph
            .draw(DrawSettings::hinted(&self.fitting, false), &mut PathPen { path, at })
            .expect("the font's outlines are well formed, and a test draws all of them");
    }
}

/// Turns outlines, y up, into a path on a sheet, y down.
struct PathPen<'a> {
    path: &'a mut PathBuilder,
    at: Point,
}

impl PathPen<'_> {
    fn place(&self, x: f32, y: f32) -> Point {
        (self.at.0 + x, self.at.1 - y)
    }
}

impl OutlinePen for PathPen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, control_x: f32, control_y: f32, x: f32, y: f32) {
        let control = self.place(control_x, control_y);
        let end = self.place(x, y);
        self.path.quad_to(control.0, control.1, end.0, end.1);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let first = self.place(x1, y1);
        let second = self.place(x2, y2);
        let end = self.place(x, y);
        self.path.cubic_to(first.0, first.1, second.0, second.1, end.0, end.1);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WEIGHTS: [Weight; 2] = [Weight::Regular, Weight::Bold];

    /// The edges of a letter in heights of capitals: left, bottom, right, top; `None` of one without ink.
    fn edges(letter: char, weight: Weight, height: f32) -> Option<[f32; 4]> {
        let mut path = PathBuilder::new();
        SizedFace::new(height, weight).push_letter(&mut path, letter, (0.0, 0.0));
        let bounds = path.finish()?.bounds();
        Some([bounds.left(), -bounds.bottom(), bounds.right(), -bounds.top()].map(|edge| edge / height))
    }

    #[test]
    fn latin_greek_and_cyrillic_have_letters() {
        for text in
            ["contest, field.coverage=0.1 ~", "Größe, Ærø, Çalı, Łódź, Đặng", "Πυρκαγιά Ωω", "Пожар, Київ, Ћуприја"]
        {
            assert_eq!(unknown_letters(text), BTreeSet::new(), "{text}");
            for weight in WEIGHTS {
                let inked = text.chars().filter(|&letter| letter != ' ');
                assert!(inked.clone().all(|letter| edges(letter, weight, 10.0).is_some()), "{text}");
            }
        }
        assert_eq!(unknown_letters("a → b, ≤ 3 m², −5 °C … “x” € № ½"), BTreeSet::new());
    }

    #[test]
    fn the_font_knows_what_it_lacks() {
        assert_eq!(unknown_letters("a\tb 模型 模"), BTreeSet::from(['\t', '模', '型']));
        assert_eq!(unknown_letters(""), BTreeSet::new());
    }

    #[test]
    fn unknown_letters_are_boxes() {
        for weight in WEIGHTS {
            assert_eq!(glyph_index('模', weight), 0);
            let [left, bottom, right, top] = edges('模', weight, 10.0).expect("a box has edges");
            assert!(right - left > 0.3 && top - bottom > 0.7);
        }
    }

    #[test]
    fn both_weights_have_the_same_letters() {
        let [regular, bold] =
            WEIGHTS.map(|weight| face(weight).letters.mappings().map(|(letter, _)| letter).collect::<BTreeSet<u32>>());
        assert_eq!(regular, bold);
        assert!(regular.len() > 1000);
    }

    #[test]
    fn every_letter_can_be_drawn() {
        for weight in WEIGHTS {
            for height in [4.0, 9.7, 200.0] {
                let sized = SizedFace::new(height, weight);
                let letters = face(weight).letters.mappings().filter_map(|(letter, _)| char::from_u32(letter));
                letters.for_each(|letter| sized.push_letter(&mut PathBuilder::new(), letter, (0.0, 0.0)));
            }
        }
    }

    #[test]
    fn ordinary_letters_stay_within_their_line_and_their_advance() {
        for weight in WEIGHTS {
            for letter in ('!'..='~').chain('Α'..='Ρ').chain('А'..='я') {
                let [left, bottom, right, top] = edges(letter, weight, 10.0).expect("it has ink");
                assert!(bottom >= -0.35 && top <= 1.4, "'{letter}' leaves its line: {bottom} to {top}");
                let after = right - advance(letter, weight);
                assert!(left >= -0.1 && after <= 0.1, "'{letter}' leaves its advance: {left}, {after}");
            }
        }
    }

    #[test]
    fn capitals_are_as_high_as_requested_to_the_pixel() {
        for weight in WEIGHTS {
            for height in [6.0, 7.0, 8.1, 9.0, 11.3, 14.0, 25.0] {
                let [_, bottom, _, top] = edges('H', weight, height).expect("it has ink").map(|edge| edge * height);
                assert_eq!(bottom, 0.0);
                assert!((top - height).abs() <= 1.0 && top.fract() == 0.0, "{top} for {height}");
            }
        }
    }

    #[test]
    fn figures_are_equally_wide() {
        for weight in WEIGHTS {
            assert!(('0'..='9').all(|figure| advance(figure, weight) == advance('0', weight)));
        }
    }
}
