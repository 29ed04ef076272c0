//! Edges of the box around a surface, with numbers of rows and columns and values.

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK};
use crate::legend::TEXT;
use crate::marks::to_f32;
use crate::surface::camera::{GROUND, SurfaceCamera};
use crate::text::{Align, draw_text, measure_text};
use crate::ticks::{Tick, indices};
use crate::values::ValueScale;

const ROWS: &str = "row";
const COLUMNS: &str = "column";
const TICK: f32 = 6.0;
/// Between an axis and its numbers, and between these and its name.
const GAP: f32 = 12.0;
/// The least distance between numbers of rows or columns, in widths of the widest.
const SPACING: f32 = 1.5;

/// The room that numbers and names take beyond the box.
pub struct AxesRoom {
    pub left: f32,
    pub right: f32,
    pub below: f32,
}

pub fn axes_room((rows, cols): (usize, usize), name: &str, heights: Option<&ValueScale>) -> AxesRoom {
    let values = ticks(heights).into_iter().map(|tick| measure_text(&tick.label, TEXT) + 1.5 * TICK);
    AxesRoom {
        left: values.fold(measure_text(name, TEXT), f32::max),
        right: 2.0 * GAP + widest(rows) + measure_text(ROWS, TEXT),
        below: 2.0 * GAP + widest(cols) + TEXT,
    }
}

/// The width of the widest number of a row or column.
fn widest(count: usize) -> f32 {
    measure_text(&count.saturating_sub(1).to_string(), TEXT)
}

fn ticks(heights: Option<&ValueScale>) -> Vec<Tick> {
    heights.map(|heights| heights.ticks(5)).unwrap_or_default()
}

/// The far walls with a line for every value; drawn before the surface, which may hide them.
pub fn draw_walls(canvas: &mut Canvas, camera: &SurfaceCamera, heights: Option<&ValueScale>, width: f32) {
    let levels = ticks(heights).into_iter().filter_map(|tick| Some(to_f32(heights?.fraction(tick.value))));
    for level in levels.chain([GROUND, 1.0]) {
        let line = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)].map(|(x, y)| camera.at(x, y, level));
        canvas.polyline(&line, width, FAINT_INK);
    }
    for (x, y) in [(0.0, 0.0), (1.0, 0.0)] {
        canvas.polyline(&[camera.at(x, y, GROUND), camera.at(x, y, 1.0)], width, FAINT_INK);
    }
}

/// The near edges, their numbers and names.
pub fn draw_axes(
    canvas: &mut Canvas,
    camera: &SurfaceCamera,
    size: (usize, usize),
    name: &str,
    heights: Option<&ValueScale>,
) {
    let left = camera.at(0.0, 1.0, GROUND);
    let front = camera.at(1.0, 1.0, GROUND);
    let right = camera.at(1.0, 0.0, GROUND);
    let back = camera.at(0.0, 0.0, GROUND);
    let columns = AxisEdge { from: left, to: front, outwards: direction(back, left) };
    columns.draw(canvas, size.1, COLUMNS);
    let rows = AxisEdge { from: right, to: front, outwards: direction(back, right) };
    rows.draw(canvas, size.0, ROWS);
    draw_values(canvas, camera, name, heights);
}

fn draw_values(canvas: &mut Canvas, camera: &SurfaceCamera, name: &str, heights: Option<&ValueScale>) {
    let Some(heights) = heights else { return };
    let top = camera.at(0.0, 1.0, 1.0);
    canvas.polyline(&[camera.at(0.0, 1.0, GROUND), top], 1.0, INK);
    for tick in heights.ticks(5) {
        let (x, y) = camera.at(0.0, 1.0, to_f32(heights.fraction(tick.value)));
        canvas.polyline(&[(x, y), (x - TICK, y)], 1.0, INK);
        let at = (x - 1.5 * TICK, y + 0.5 * TEXT);
        draw_text(canvas, &tick.label, at, Align::Right, TEXT, INK);
    }
    draw_text(canvas, name, (top.0, top.1 - 1.6 * TEXT), Align::Right, TEXT, INK);
}

/// An edge of the box that rows or columns are numbered along.
struct AxisEdge {
    from: Point,
    to: Point,
    /// Away from the box, 1 pixel long.
    outwards: Point,
}

impl AxisEdge {
    fn draw(&self, canvas: &mut Canvas, count: usize, name: &str) {
        canvas.polyline(&[self.from, self.to], 1.0, INK);
        let length = f64::from((self.to.0 - self.from.0).abs());
        let apart = f64::from(SPACING * widest(count) + GAP);
        for index in indices(count, count as f64 * apart / length) {
            let share = (index as f32 + 0.5) / count as f32;
            canvas.polyline(&[self.beside(share, 0.0), self.beside(share, TICK)], 1.0, INK);
            self.write(canvas, &index.to_string(), share, GAP);
        }
        self.write(canvas, name, 0.5, 2.0 * GAP + widest(count));
    }

    /// Writes words beside the edge, their nearer end `away` from it.
    fn write(&self, canvas: &mut Canvas, text: &str, share: f32, away: f32) {
        let (x, y) = self.beside(share, away + 0.5 * measure_text(text, TEXT));
        draw_text(canvas, text, (x, y + 0.5 * TEXT), Align::Centre, TEXT, INK);
    }

    fn beside(&self, share: f32, away: f32) -> Point {
        let along = |from: f32, to: f32| from + (to - from) * share;
        let x = along(self.from.0, self.to.0);
        let y = along(self.from.1, self.to.1);
        (x + self.outwards.0 * away, y + self.outwards.1 * away)
    }
}

fn direction(from: Point, to: Point) -> Point {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let length = (x * x + y * y).sqrt();
    (x / length, y / length)
}
