//! The four counts stacked over time.

use super::plan::{Plan, Rows};
use crate::fire::BushStateKind;
use crate::picture::Rgb;
use crate::picture::canvas::Canvas;
use crate::picture::colours::blend;
use crate::picture::colours::bush_colour;
use crate::picture::film::{BushCounts, RunView};
use crate::time::SimTime;

/// From the bottom up: what is lost, what burns, what was saved, what nothing happened to.
const STACKED: [BushStateKind; 4] =
    [BushStateKind::BurnedOut, BushStateKind::Burning, BushStateKind::Extinguished, BushStateKind::Intact];

/// Every column shows the counts at its middle.
pub fn draw(
    canvas: &mut Canvas,
    plan: &Plan,
    (top, height): Rows,
    (run, end): (&RunView, SimTime),
    shade: &dyn Fn(Rgb) -> Rgb,
) {
    let colours = STACKED.map(|kind| shade(bush_colour(kind)));
    let (left, width) = plan.columns;
    for column in 0..width {
        let edges = edges(&run.counts_at(time_of(column, width, end)), height);
        for row in 0..height {
            let [red, green, blue] = colour_of(row, &edges, &colours);
            canvas.row_from((left + column) as usize, (top + row) as usize)[0] = [red, green, blue, 255];
        }
    }
}

/// The time in the middle of a column.
pub fn time_of(column: u32, width: u32, end: SimTime) -> SimTime {
    SimTime::from_seconds(end.as_seconds() * (f64::from(column) + 0.5) / f64::from(width))
}

/// How far down the upper edge of each part lies, in rows.
fn edges(counts: &BushCounts, height: u32) -> [f64; 4] {
    let (mut below, height) = (0, f64::from(height));
    STACKED.map(|kind| {
        below += counts.count(kind);
        height * (1.0 - f64::from(below) / f64::from(counts.bushes().max(1)))
    })
}

/// A row shows the parts that it cuts by how much it has of each.
fn colour_of(row: u32, edges: &[f64; 4], colours: &[Rgb; 4]) -> Rgb {
    let (above, below) = (f64::from(row), f64::from(row) + 1.0);
    let mut colour = colours[3];
    for (&edge, &part) in edges.iter().zip(colours).rev().skip(1) {
        colour = blend(colour, part, (below - edge).clamp(0.0, below - above));
    }
    colour
}
