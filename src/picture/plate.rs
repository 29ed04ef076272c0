//! A map from above with everything around it: title, numbers of rows and columns, legend.
//!
//! Sizes follow from the texts, so that nothing overlaps or is cut off whatever the shape of the map; where the map is
//! drawn more than 1000 pixels long, texts and marks grow with it.

use super::canvas::{Canvas, Point};
use super::colours::{FAINT_INK, INK, PAPER, Rgb};
use super::legend::{Legend, TEXT};
use super::marks::{self, marks};
use super::scene::MapScene;
use super::text::{self, Align};
use super::ticks::indices;
use super::zoom::{Block, Zoom};

const TITLE: f32 = 13.0;
const MARGIN: f32 = 24.0;
const GAP: f32 = 12.0;
/// How far marks may reach beyond the map, and so how far texts keep from it.
const OVERHANG: f32 = 10.0;
/// How long the longer side of a map is drawn before texts grow with it, in pixels.
const USUAL_LENGTH: f32 = 1000.0;

pub struct Plate<'a> {
    scene: &'a MapScene<'a>,
    zoom: Zoom,
    /// How much larger than usual texts and marks are.
    unit: f32,
    /// Where the map's upper left corner is.
    corner: Point,
    canvas: Canvas,
}

impl<'a> Plate<'a> {
    /// Everything but the map itself.
    pub fn around(scene: &'a MapScene<'a>, legend: &Legend) -> Self {
        let (rows, cols) = (scene.occupied.rows(), scene.occupied.cols());
        let zoom = Zoom::fit(rows, cols);
        let (width, height) = (zoom.length(cols) as f32, zoom.length(rows) as f32);
        let unit = (width.max(height) / USUAL_LENGTH).max(1.0);
        let numbers = |count: usize| text::measure(&count.saturating_sub(1).to_string(), TEXT) * unit;
        let left = (MARGIN * unit + numbers(rows).max(0.5 * numbers(cols)) + OVERHANG * unit).ceil();
        let top = ((MARGIN + TITLE + GAP + OVERHANG) * unit).ceil();
        let legend_at = (left + width + (OVERHANG + GAP) * unit + 0.5 * numbers(cols)).ceil();
        let title_ends = left + text::measure(scene.title, TITLE * unit);
        let right = title_ends.max(legend_at + legend.width(unit)) + MARGIN * unit;
        let below = height + (OVERHANG + TEXT) * unit;
        let bottom = top + below.max(legend.height(height, unit)) + MARGIN * unit;
        let mut canvas = Canvas::sized(right, bottom, PAPER);
        text::draw(&mut canvas, scene.title, (left, (MARGIN + TITLE) * unit), Align::Left, TITLE * unit, INK);
        legend.draw(&mut canvas, (legend_at, top), height, unit);
        canvas.fill_rect(left - 1.0, top - 1.0, width + 2.0, height + 2.0, FAINT_INK);
        let mut plate = Self { scene, zoom, unit, corner: (left, top), canvas };
        plate.draw_numbers(width, height);
        plate
    }

    fn draw_numbers(&mut self, width: f32, height: f32) {
        let (left, top) = self.corner;
        let (rows, cols) = (self.scene.occupied.rows(), self.scene.occupied.cols());
        let (size, away) = (TEXT * self.unit, OVERHANG * self.unit);
        let cell = f64::from(self.zoom.cell());
        let wide = text::measure(&cols.to_string(), size) + 2.0 * size;
        for row in indices(rows, f64::from(2.6 * size).max(f64::from(height) / 16.0) / cell) {
            let at = (left - away, top + self.zoom.centre(row) + 0.5 * size);
            text::draw(&mut self.canvas, &row.to_string(), at, Align::Right, size, INK);
        }
        for col in indices(cols, f64::from(wide).max(f64::from(width) / 16.0) / cell) {
            let at = (left + self.zoom.centre(col), top + height + away + size);
            text::draw(&mut self.canvas, &col.to_string(), at, Align::Centre, size, INK);
        }
    }

    /// Colours every block of cells.
    pub fn paint(&mut self, colour: &dyn Fn(&Block) -> Rgb) {
        let size = (self.scene.occupied.rows(), self.scene.occupied.cols());
        let pixels = self.zoom.pixels;
        let (left, top) = (whole(self.corner.0), whole(self.corner.1));
        let mut line = vec![[255; 4]; self.zoom.length(size.1)];
        for row in 0..self.zoom.blocks(size.0) {
            for (col, block) in line.chunks_exact_mut(pixels).enumerate() {
                let [red, green, blue] = colour(&self.zoom.block(row, col, size));
                block.fill([red, green, blue, 255]);
            }
            for copy in 0..pixels {
                let below = row * pixels + copy;
                self.canvas.row_from(left, top + below)[..line.len()].copy_from_slice(&line);
            }
        }
    }

    /// Draws path, start, goal and local minimum.
    pub fn mark(&mut self) {
        let cell = self.zoom.cell();
        let path: Vec<Point> = marks::corners(self.scene.path).into_iter().map(|place| self.centre(place)).collect();
        marks::draw_path(&mut self.canvas, &path, (0.2 * cell).clamp(1.8 * self.unit, 5.0 * self.unit));
        let radius = (0.32 * cell).clamp(5.5 * self.unit, 11.0 * self.unit);
        for (mark, place) in marks(self.scene).rev() {
            let at = self.centre(place);
            mark.draw(&mut self.canvas, at, radius);
        }
    }

    fn centre(&self, (row, col): (usize, usize)) -> Point {
        (self.corner.0 + self.zoom.centre(col), self.corner.1 + self.zoom.centre(row))
    }

    pub fn finish(self) -> super::Picture {
        self.canvas.finish()
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "corners lie on whole pixels of the sheet")]
fn whole(length: f32) -> usize {
    length as usize
}
