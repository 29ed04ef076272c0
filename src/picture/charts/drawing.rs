//! A chart as marks on a sheet, whatever they are drawn with.

use crate::picture::canvas::Point;
use crate::picture::colours::Rgb;
use crate::picture::text::Align;

/// Marks on a sheet, in the order in which they are drawn; places are in units to the right and down from the upper
/// left corner. A unit is a pixel of a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub width: f32,
    pub height: f32,
    pub(super) title: String,
    pub(super) marks: Vec<Mark>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// The inside of a closed line; opacity from 0 to 1.
    Area { corners: Vec<Point>, colour: Rgb, opacity: f32 },
    /// Straight pieces; lengths of dashes and gaps in units, none of a line without gaps.
    Line { points: Vec<Point>, width: f32, colour: Rgb, dashes: Vec<f32> },
    /// A line of text on a base line; capitals are `height` units high.
    Text { text: String, at: Point, align: Align, height: f32, colour: Rgb },
}

impl Drawing {
    pub fn new(width: f32, height: f32, title: &str) -> Self {
        Self { width, height, title: title.into(), marks: Vec::new() }
    }

    /// All lines of text on it.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.marks.iter().filter_map(|mark| match mark {
            Mark::Text { text, .. } => Some(text.as_str()),
            Mark::Area { .. } | Mark::Line { .. } => None,
        })
    }

    pub fn area(&mut self, corners: Vec<Point>, colour: Rgb, opacity: f32) {
        self.marks.push(Mark::Area { corners, colour, opacity });
    }

    pub fn rect(&mut self, (left, top): Point, (right, bottom): Point, colour: Rgb) {
        self.area(vec![(left, top), (right, top), (right, bottom), (left, bottom)], colour, 1.0);
    }

    pub fn line(&mut self, points: Vec<Point>, width: f32, colour: Rgb) {
        self.dashed(points, width, colour, &[]);
    }

    pub fn dashed(&mut self, points: Vec<Point>, width: f32, colour: Rgb, dashes: &[f32]) {
        self.marks.push(Mark::Line { points, width, colour, dashes: dashes.to_vec() });
    }

    pub fn text(&mut self, text: &str, at: Point, align: Align, height: f32, colour: Rgb) {
        self.marks.push(Mark::Text { text: text.into(), at, align, height, colour });
    }
}
