//! The legend beside a picture: the bar of colours with its values, and the key of everything else.

use crate::canvas::{Canvas, Point};
use crate::colours::{EDGE, FAINT_INK, INK, Rgb};
use crate::marks;
use crate::marks::{Mark, to_f32};
use crate::text::{Align, draw_text, measure_text};
use crate::values::ValueScale;
use crate::way_lines::{PoseMark, draw_cusp, draw_run};

/// Lengths in pixels where capitals are [`TEXT`] pixels high; larger pictures scale all of them.
pub const TEXT: f32 = 10.0;
const LINE: f32 = 22.0;
const BAR_WIDTH: f32 = 20.0;
const TICK: f32 = 5.0;
const SYMBOL: f32 = 28.0;
const SHORTEST_BAR: f32 = 120.0;
const LONGEST_BAR: f32 = 420.0;

/// Bar and key, each of which may be missing.
pub struct Legend<'a> {
    pub values: Option<Bar<'a>>,
    pub key: Vec<(Symbol, &'a str)>,
}

/// The colours of a map's values.
pub struct Bar<'a> {
    pub name: &'a str,
    pub scale: &'a ValueScale,
}

/// The symbol of an entry of the key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symbol {
    Cell(Rgb),
    Path,
    /// An edge of a tree or a roadmap.
    Edge,
    Mark(Mark),
    Way(Rgb),
    Reverse,
    Cusp,
    Pose(PoseMark),
}

impl Legend<'_> {
    pub fn width(&self, unit: f32) -> f32 {
        let key = self.key.iter().map(|(_, name)| SYMBOL + measure_text(name, TEXT));
        let bar = self.values.iter().flat_map(|bar| {
            let labels =
                bar.scale.ticks(6).into_iter().map(|tick| BAR_WIDTH + 2.0 * TICK + measure_text(&tick.label, TEXT));
            labels.chain([measure_text(bar.name, TEXT)])
        });
        unit * key.chain(bar).fold(0.0, f32::max)
    }

    /// The height that it takes where there is room for `room` pixels; more if it needs more.
    pub fn height(&self, room: f32, unit: f32) -> f32 {
        let key = self.key.len() as f32 * LINE * unit;
        let bar = self.values.as_ref().map_or(0.0, |_| self.bar_height(room, unit) + 2.0 * LINE * unit);
        key + bar
    }

    fn bar_height(&self, room: f32, unit: f32) -> f32 {
        let rest = (self.key.len() as f32 + 2.0) * LINE * unit;
        (room - rest).clamp(SHORTEST_BAR * unit, LONGEST_BAR * unit).round()
    }

    pub fn draw(&self, canvas: &mut Canvas, (left, top): Point, room: f32, unit: f32) {
        let mut y = top;
        if let Some(bar) = &self.values {
            let height = self.bar_height(room, unit);
            draw_text(canvas, bar.name, (left, y + TEXT * unit), Align::Left, TEXT * unit, INK);
            bar.draw(canvas, (left, y + LINE * unit), height, unit);
            y += height + 2.0 * LINE * unit;
        }
        for (symbol, name) in &self.key {
            symbol.draw(canvas, (left, y), unit);
            draw_text(canvas, name, (left + SYMBOL * unit, y + 13.0 * unit), Align::Left, TEXT * unit, INK);
            y += LINE * unit;
        }
    }
}

impl Bar<'_> {
    fn draw(&self, canvas: &mut Canvas, (left, top): Point, height: f32, unit: f32) {
        let (low, high) = (self.scale.low, self.scale.high);
        let width = BAR_WIDTH * unit;
        canvas.fill_rect(left - 1.0, top - 1.0, width + 2.0, height + 2.0, FAINT_INK);
        let mut line = 0.0;
        while line < height {
            let share = 1.0 - f64::from((line + 0.5) / height);
            canvas.fill_rect(left, top + line, width, 1.0, self.scale.colour(low * (1.0 - share) + high * share));
            line += 1.0;
        }
        for tick in self.scale.ticks(6) {
            let y = top + height * (1.0 - to_f32(self.scale.fraction(tick.value)));
            let right = left + width;
            canvas.fill_rect(right + 1.0, y - 0.5 * unit, TICK * unit, unit, INK);
            let at = (right + 2.0 * TICK * unit, y + 0.5 * TEXT * unit);
            draw_text(canvas, &tick.label, at, Align::Left, TEXT * unit, INK);
        }
    }
}

impl Symbol {
    fn draw(self, canvas: &mut Canvas, (left, top): Point, unit: f32) {
        let centre = (left + 9.0 * unit, top + 8.0 * unit);
        let line = [(left, centre.1), (left + 18.0 * unit, centre.1)];
        match self {
            Self::Cell(colour) => {
                canvas.fill_rect(left + unit, top, 16.0 * unit, 16.0 * unit, FAINT_INK);
                canvas.fill_rect(left + 2.0 * unit, top + unit, 14.0 * unit, 14.0 * unit, colour);
            }
            Self::Path => {
                let ends = [(left + unit, top + 12.0 * unit), (left + 17.0 * unit, top + 4.0 * unit)];
                marks::draw_path(canvas, &ends, 3.0 * unit);
            }
            Self::Edge => canvas.polyline(&line, 1.6 * unit, EDGE),
            Self::Mark(mark) => mark.draw(canvas, centre, 7.0 * unit),
            Self::Way(colour) => draw_run(canvas, &line, 4.0 * unit, colour, false),
            Self::Reverse => draw_run(canvas, &line, 2.4 * unit, INK, true),
            Self::Cusp => draw_cusp(canvas, centre),
            Self::Pose(mark) => mark.draw(canvas, centre, 0.0, 7.0 * unit),
        }
    }
}
