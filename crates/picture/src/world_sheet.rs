//! A sheet with a title, a part of the world to scale with metres along its edges, and a key beside it.

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK, PAPER, WITHOUT_VALUE};
use crate::legend::{Legend, Symbol, TEXT};
use crate::marks::to_f32;
use crate::text::{Align, draw_text, measure_text};
use crate::ticks::{Tick, ticks};

const EAST: &str = "east, m";
const NORTH: &str = "north, m";
/// Pixels of the longer side.
const LONGER_SIDE: f64 = 720.0;
/// The shorter side is at least this part of the longer one.
const SLENDEREST: f64 = 0.4;
/// The rim left free around all that is shown, as a part of the longer side.
const RIM: f64 = 0.06;
/// Pixels between numbers, at least.
const APART: f32 = 70.0;
const GAP: f32 = 8.0;

/// A rectangle of the world, in metres east and north, and where it lies on the sheet.
#[derive(Clone, Copy, Debug)]
pub struct WorldFrame {
    /// South-west corner.
    low: (f64, f64),
    /// North-east corner.
    high: (f64, f64),
    pixels_per_m: f64,
    /// The place of the north-west corner on the sheet.
    corner: Point,
}

/// The room that numbers and names need around a frame, in pixels.
pub struct FrameRoom {
    pub left: f32,
    pub above: f32,
    pub below: f32,
}

impl WorldFrame {
    /// Shows all places, with the longer side at least `min_m` (positive) long.
    pub fn fit(places: impl Iterator<Item = (f64, f64)>, min_m: f64) -> Self {
        let mut low = (f64::INFINITY, f64::INFINITY);
        let mut high = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (x, y) in places {
            (low, high) = ((low.0.min(x), low.1.min(y)), (high.0.max(x), high.1.max(y)));
        }
        // A path that goes straight has no width, and a point no extent at all.
        let longer = (high.0 - low.0).max(high.1 - low.1).max(min_m);
        let half = |low: f64, high: f64| 0.5 * (high - low).max(SLENDEREST * longer) + RIM * longer;
        let centre_x = 0.5 * (low.0 + high.0);
        let centre_y = 0.5 * (low.1 + high.1);
        let half_x = half(low.0, high.0);
        let half_y = half(low.1, high.1);
        Self {
            low: (centre_x - half_x, centre_y - half_y),
            high: (centre_x + half_x, centre_y + half_y),
            pixels_per_m: 0.5 * LONGER_SIDE / half_x.max(half_y),
            corner: (0.0, 0.0),
        }
    }

    /// Shows the rectangle that reaches from the origin that many metres east and north, both positive, and no more.
    pub fn from_size(east_m: f64, north_m: f64) -> Self {
        let pixels_per_m = LONGER_SIDE / east_m.max(north_m);
        Self { low: (0.0, 0.0), high: (east_m, north_m), pixels_per_m, corner: (0.0, 0.0) }
    }

    /// The same with its north-west corner at a place of the sheet.
    pub fn moved(self, corner: Point) -> Self {
        Self { corner: (corner.0.round(), corner.1.round()), ..self }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> Point {
        let side = |low: f64, high: f64| to_f32((high - low) * self.pixels_per_m).round();
        (side(self.low.0, self.high.0), side(self.low.1, self.high.1))
    }

    /// Returns where a place of the world lies on the sheet.
    pub fn at(&self, (x, y): (f64, f64)) -> Point {
        let (east, south) = (x - self.low.0, self.high.1 - y);
        (self.corner.0 + to_f32(east * self.pixels_per_m), self.corner.1 + to_f32(south * self.pixels_per_m))
    }

    pub fn room(&self) -> FrameRoom {
        let numbers = self.northings().into_iter().map(|tick| measure_text(&tick.label, TEXT));
        FrameRoom {
            left: numbers.fold(0.0, f32::max) + GAP,
            above: 2.0 * TEXT + 2.0 * GAP,
            below: 2.0 * TEXT + 2.0 * GAP,
        }
    }

    fn eastings(&self) -> Vec<Tick> {
        ticks(self.low.0, self.high.0, fitting(self.size().0), 0.0)
    }

    fn northings(&self) -> Vec<Tick> {
        ticks(self.low.1, self.high.1, fitting(self.size().1), 0.0)
    }

    /// Draws the edges, a net of lines, and the numbers of these.
    pub fn draw(&self, canvas: &mut Canvas) {
        let (left, top) = self.corner;
        let (width, height) = self.size();
        for tick in self.eastings() {
            let (x, _) = self.at((tick.value, self.low.1));
            canvas.fill_rect(x, top, 1.0, height, WITHOUT_VALUE);
            let base = top + height + GAP + TEXT;
            draw_text(canvas, &tick.label, (x, base), Align::Centre, TEXT, INK);
        }
        for tick in self.northings() {
            let (_, y) = self.at((self.low.0, tick.value));
            canvas.fill_rect(left, y, width, 1.0, WITHOUT_VALUE);
            draw_text(canvas, &tick.label, (left - GAP, y + 0.5 * TEXT), Align::Right, TEXT, INK);
        }
        // After the net, or its lines would cross the edges.
        let edges = [
            (0.0, 0.0, width, 1.0),
            (0.0, height - 1.0, width, 1.0),
            (0.0, 0.0, 1.0, height),
            (width - 1.0, 0.0, 1.0, height),
        ];
        for (x, y, width, height) in edges {
            canvas.fill_rect(left + x, top + y, width, height, FAINT_INK);
        }
        draw_text(canvas, NORTH, (left, top - GAP), Align::Left, TEXT, INK);
        let below = top + height + 2.0 * (GAP + TEXT);
        draw_text(canvas, EAST, (left + width, below), Align::Right, TEXT, INK);
    }
}

/// Returns how many numbers fit along a length in pixels.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a side has some hundred pixels")]
fn fitting(pixels: f32) -> usize {
    (pixels / APART).max(2.0) as usize
}

const TITLE: f32 = 13.0;
const MARGIN: f32 = 24.0;

pub struct WorldSheet {
    pub canvas: Canvas,
    /// The place of the part of the world on it.
    pub frame: WorldFrame,
}

impl WorldSheet {
    /// Everything but what lies in the frame.
    pub fn new(title: &str, frame: WorldFrame, key: Vec<(Symbol, &str)>) -> Self {
        let legend = Legend { values: None, key };
        let room = frame.room();
        let corner = (MARGIN + room.left, MARGIN + TITLE + room.above);
        let frame = frame.moved(corner);
        let (width, height) = frame.size();
        let legend_at = (corner.0 + width + MARGIN, corner.1);
        let right = (corner.0 + measure_text(title, TITLE)).max(legend_at.0 + legend.width(1.0)) + MARGIN;
        let bottom = corner.1 + (height + room.below).max(legend.height(height, 1.0)) + MARGIN;

        let mut canvas = Canvas::sized(right, bottom, PAPER);
        draw_text(&mut canvas, title, (corner.0, MARGIN + TITLE), Align::Left, TITLE, INK);
        legend.draw(&mut canvas, legend_at, height, 1.0);
        frame.draw(&mut canvas);
        Self { canvas, frame }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> [(f64, f64); 2] {
        [(10.0, 20.0), (60.0, 40.0)]
    }

    #[test]
    fn everything_lies_inside_and_north_is_up() {
        let frame = WorldFrame::fit(corners().into_iter(), 1.0).moved((100.0, 50.0));
        let [south_west, north_east] = corners().map(|place| frame.at(place));
        let (width, height) = frame.size();
        assert!(south_west.0 < north_east.0 && south_west.1 > north_east.1);
        for (x, y) in [south_west, north_east] {
            assert!((100.0..=100.0 + width).contains(&x) && (50.0..=50.0 + height).contains(&y), "{x}, {y}");
        }
    }

    #[test]
    fn a_metre_east_is_as_long_as_a_metre_north() {
        for min_m in [1e-3, 1.0, 1e4] {
            let frame = WorldFrame::fit(corners().into_iter(), min_m);
            let [(left, bottom), (right, top)] = corners().map(|place| frame.at(place));
            let east = (right - left) / 50.0;
            let north = (bottom - top) / 20.0;
            assert!((east / north - 1.0).abs() < 1e-3, "{east} and {north}");
        }
    }

    #[test]
    fn a_single_place_and_far_ones_are_shown() {
        for (place, min_m) in [((1e6, -1e6), 1e-6), ((0.0, 0.0), 1e3), ((-5.0, 7.0), 1.0)] {
            let frame = WorldFrame::fit([place].into_iter(), min_m);
            let (width, height) = frame.size();
            let (x, y) = frame.at(place);
            assert!((x - 0.5 * width).abs() < 1.0 && (y - 0.5 * height).abs() < 1.0, "{x}, {y}");
        }
        let frame = WorldFrame::fit([(-1e6, 0.0), (1e6, 1.0)].into_iter(), 1e-3);
        assert_eq!(frame.size().0, 720.0);
    }
}
