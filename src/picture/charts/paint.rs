//! Drawings as pictures of pixels.

use super::drawing::{Drawing, Mark};
use crate::picture::canvas::{Canvas, Point};
use crate::picture::colours::PAPER;
use crate::picture::png::Picture;
use crate::picture::text;

/// Pixels of a unit: enough for print at the width of a column.
const PIXELS: f32 = 2.0;

impl Drawing {
    /// The drawing with two pixels for each unit.
    pub fn paint(&self) -> Picture {
        let mut canvas = Canvas::sized(self.width * PIXELS, self.height * PIXELS, PAPER);
        for mark in &self.marks {
            paint(&mut canvas, mark);
        }
        canvas.finish()
    }
}

fn paint(canvas: &mut Canvas, mark: &Mark) {
    let place = |&(x, y): &Point| (x * PIXELS, y * PIXELS);
    let places = |points: &[Point]| points.iter().map(place).collect::<Vec<_>>();
    match mark {
        Mark::Area { corners, colour, opacity } => canvas.fill_through(&places(corners), *colour, *opacity),
        Mark::Line { points, width, colour, dashes } if dashes.is_empty() => {
            canvas.polyline(&places(points), width * PIXELS, *colour);
        }
        Mark::Line { points, width, colour, dashes } => {
            let dashes = dashes.iter().map(|length| length * PIXELS).collect();
            canvas.dashed_by(&places(points), width * PIXELS, *colour, dashes);
        }
        Mark::Text { text, at, align, height, colour } => {
            text::draw(canvas, text, place(at), *align, height * PIXELS, *colour);
        }
    }
}
