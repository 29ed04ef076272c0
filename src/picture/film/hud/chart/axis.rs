//! Numbers along the edges of a chart.

use super::super::super::lettering::{Lettering, Style};
use super::super::words;
use super::plan::{Plan, Rows, Strip};
use crate::picture::canvas::Canvas;
use crate::picture::colours::{FAINT_INK, INK};
use crate::picture::marks::to_f32;
use crate::picture::text::Align;
use crate::picture::ticks::ticks;
use crate::time::SimTime;

/// Longer runs are told in minutes, in seconds.
const MINUTES_FROM_S: f64 = 300.0;
const SECONDS_PER_MINUTE: f64 = 60.0;
/// Distances between numbers, in heights of text.
const BETWEEN_TIMES: f32 = 7.0;
const BETWEEN_VALUES: f32 = 3.0;

fn style(plan: &Plan) -> Style {
    Style { height: 0.85 * plan.text as f32, is_bold: false, colour: INK }
}

/// Times under the chart.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few dozen numbers")]
pub fn draw_time(canvas: &mut Canvas, lettering: &mut Lettering, plan: &Plan, end: SimTime) {
    let (unit, unit_s) = if end.as_seconds() < MINUTES_FROM_S { ("s", 1.0) } else { ("min", SECONDS_PER_MINUTE) };
    let last = end.as_seconds() / unit_s;
    let (left, width) = (plan.columns.0 as f32, plan.columns.1 as f32);
    let base = plan.axis_base as f32;
    let most = (width / plan.length(BETWEEN_TIMES)) as usize;
    for tick in ticks(0.0, last, most.max(1), 0.0) {
        let x = left + width * to_f32(tick.value / last.max(f64::MIN_POSITIVE));
        let (mark, top) = (plan.length(0.35), base - plan.length(1.7));
        canvas.fill_rect(x, top, 1.0, mark, INK);
        lettering.draw(canvas, &tick.label, (x, base), Align::Centre, style(plan));
    }
    lettering.draw(canvas, unit, (left - plan.length(1.5), base), Align::Right, style(plan));
}

/// Numbers left of some rows, the lowest at their lower edge; lines where there are numbers, but not on them.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few dozen numbers")]
pub fn draw_values(
    canvas: &mut Canvas,
    lettering: &mut Lettering,
    plan: &Plan,
    (top, height): Rows,
    (low, high): (f64, f64),
) {
    let (top, height) = (top as f32, height as f32);
    let most = (height / plan.length(BETWEEN_VALUES)) as usize;
    let right = plan.columns.0 as f32 - 1.0;
    canvas.fill_rect(right, top, 1.0, height, FAINT_INK);
    for tick in ticks(low, high, most.max(1), 1.0) {
        let share = (tick.value - low) / (high - low).max(f64::MIN_POSITIVE);
        let y = top + height * (1.0 - to_f32(share));
        canvas.fill_rect(right - plan.length(0.3), y.min(top + height - 1.0), plan.length(0.3), 1.0, INK);
        let base = y + 0.42 * plan.text as f32;
        lettering.draw(canvas, &tick.label, (right - plan.length(0.6), base), Align::Right, style(plan));
    }
}

/// The name of a run of a comparison beside its counts.
pub fn name_run(canvas: &mut Canvas, lettering: &mut Lettering, plan: &Plan, strip: &Strip, run_index: usize) {
    let (top, height) = strip.area;
    let style = Style { height: 1.4 * plan.text as f32, is_bold: true, colour: INK };
    let base = top as f32 + 0.5 * height as f32 + 0.5 * style.height;
    lettering.draw(canvas, words::run_name(run_index), (plan.length(1.2), base), Align::Left, style);
}
