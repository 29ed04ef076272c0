//! How the counts of two runs differ over time, the first less the second.

use super::super::super::lettering::{Lettering, Style};
use super::area::time_of;
use super::axis;
use super::plan::{Plan, Rows};
use crate::fire::BushStateKind;
use crate::picture::Rgb;
use crate::picture::canvas::{Canvas, Point};
use crate::picture::colours::{BURNING, EXTINGUISHED, FAINT_INK, INK};
use crate::picture::film::{BushCounts, RunView};
use crate::picture::marks::to_f32;
use crate::picture::text::{Align, measure};
use crate::picture::ticks::round_step;

/// What is compared.
struct Curve {
    name: &'static str,
    colour: Rgb,
    of: fn(&BushCounts) -> u32,
}

const CURVES: [Curve; 2] = [
    Curve { name: "burned", colour: BURNING, of: BushCounts::burned },
    Curve { name: "extinguished", colour: EXTINGUISHED, of: |counts| counts.count(BushStateKind::Extinguished) },
];

pub fn draw(
    canvas: &mut Canvas,
    lettering: &mut Lettering,
    plan: &Plan,
    rows: Rows,
    runs: (&RunView, &RunView),
    shade: &dyn Fn(Rgb) -> Rgb,
) {
    let curves = CURVES.map(|curve| (shade(curve.colour), differences(plan, runs, curve.of)));
    let largest = curves.iter().flat_map(|(_, values)| values).map(|value| value.abs()).fold(1.0, f64::max);
    let largest = round_step(largest);
    axis::draw_values(canvas, lettering, plan, rows, (-largest, largest));
    let (top, height) = (rows.0 as f32, rows.1 as f32);
    let (left, width) = (plan.columns.0 as f32, plan.columns.1 as f32);
    canvas.fill_rect(left, top + 0.5 * height, width, 1.0, FAINT_INK);
    for (colour, values) in &curves {
        let y = |value: f64| top + 0.5 * height * (1.0 - to_f32(value / largest));
        let points: Vec<Point> =
            values.iter().zip(0_u16..).map(|(&value, x)| (left + f32::from(x) + 0.5, y(value))).collect();
        canvas.polyline(&points, plan.length(0.18).max(1.5), *colour);
    }
    draw_key(canvas, lettering, plan, top);
}

/// In the middle of each column.
fn differences(plan: &Plan, (one, other): (&RunView, &RunView), of: fn(&BushCounts) -> u32) -> Vec<f64> {
    let (width, end) = (plan.columns.1, RunView::last_end(&[one, other]));
    let times = (0..width).map(|column| time_of(column, width, end));
    times.map(|time| f64::from(of(&one.counts_at(time))) - f64::from(of(&other.counts_at(time)))).collect()
}

/// What the curves are, above them.
fn draw_key(canvas: &mut Canvas, lettering: &mut Lettering, plan: &Plan, top: f32) {
    let style = Style { height: 0.85 * plan.text as f32, is_bold: true, colour: INK };
    let (mut x, base) = (plan.columns.0 as f32, top - plan.length(0.6));
    for (name, colour) in [("A - B", INK)].into_iter().chain(CURVES.map(|curve| (curve.name, curve.colour))) {
        lettering.draw(canvas, name, (x, base), Align::Left, Style { colour, ..style });
        x += measure(name, style.height) + plan.length(1.5);
    }
}
