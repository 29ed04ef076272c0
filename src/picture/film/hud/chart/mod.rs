//! Counts of bushes over the whole run, stacked, with marks of events above; of two runs, also how they differ.
//!
//! What lies ahead of the request's time is paler than what has passed. Both are drawn once and put together by columns.

mod area;
mod axis;
mod difference;
mod lanes;
mod plan;

use super::super::lettering::Lettering;
use super::super::{FrameRequest, Layout, RunView, RunViewId};
use crate::picture::Rgb;
use crate::picture::canvas::Canvas;
use crate::picture::colours::{FAINT_INK, INK, PAPER, blend};
use crate::time::SimTime;
use plan::{Plan, Strip};

/// How much of its colour that keeps which lies ahead.
const AHEAD: f64 = 0.35;

/// Draws the chart of a request; keeps it as long as the runs are the same.
#[derive(Default)]
pub struct ChartRenderer {
    drawn: Option<Drawn>,
}

struct Drawn {
    layout: Layout,
    runs: Vec<RunViewId>,
    past: Canvas,
    ahead: Canvas,
}

impl ChartRenderer {
    pub fn paint(&mut self, sheet: &mut Canvas, lettering: &mut Lettering, layout: &Layout, request: &FrameRequest) {
        let is_right = |drawn: &Drawn| {
            drawn.layout == *layout && drawn.runs.iter().copied().eq(request.runs.iter().map(|run| run.id()))
        };
        if !self.drawn.as_ref().is_some_and(is_right) {
            self.drawn = Some(Drawn::new(request.runs, layout, lettering));
        }
        let Some(drawn) = &self.drawn else { return };
        let x = cursor_x(layout, request.time, RunView::last_end(request.runs));
        let at = (layout.chart.left, layout.chart.top);
        sheet.copy_from(&drawn.ahead, at);
        sheet.copy_columns(&drawn.past, x, at);
        draw_cursor(sheet, layout, x, request.runs.len());
    }
}

impl Drawn {
    fn new(runs: &[&RunView], layout: &Layout, lettering: &mut Lettering) -> Self {
        let mut draw = |share: f64| draw(runs, layout, lettering, &|colour| blend(PAPER, colour, share));
        let (past, ahead) = (draw(1.0), draw(AHEAD));
        Self { layout: layout.clone(), runs: runs.iter().map(|run| run.id()).collect(), past, ahead }
    }
}

/// The column of the chart at a time.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column lies on the sheet")]
fn cursor_x(layout: &Layout, time: SimTime, end: SimTime) -> u32 {
    let share = if end > SimTime::ZERO { time.min(end).as_seconds() / end.as_seconds() } else { 0.0 };
    layout.timeline_x(share).round() as u32
}

fn draw(runs: &[&RunView], layout: &Layout, lettering: &mut Lettering, shade: &dyn Fn(Rgb) -> Rgb) -> Canvas {
    let mut canvas = Canvas::new(layout.chart.width, layout.chart.height, PAPER);
    let plan = Plan::new(layout, runs.len());
    let end = RunView::last_end(runs);
    canvas.fill_rect(0.0, 0.0, layout.chart.width as f32, 1.0, FAINT_INK);
    for (run_index, (run, strip)) in runs.iter().zip(&plan.strips).enumerate() {
        draw_strip(&mut canvas, lettering, &plan, (run, strip), end, shade);
        if runs.len() > 1 {
            axis::name_run(&mut canvas, lettering, &plan, strip, run_index);
        }
    }
    if let (&[one, other], Some(rows)) = (runs, plan.difference) {
        difference::draw(&mut canvas, lettering, &plan, rows, (one, other), shade);
    }
    axis::draw_time(&mut canvas, lettering, &plan, end);
    canvas
}

fn draw_strip(
    canvas: &mut Canvas,
    lettering: &mut Lettering,
    plan: &Plan,
    (run, strip): (&RunView, &Strip),
    end: SimTime,
    shade: &dyn Fn(Rgb) -> Rgb,
) {
    if let Some(rows) = strip.lanes {
        lanes::draw(canvas, lettering, plan, rows, (run, end), shade);
    }
    area::draw(canvas, plan, strip.area, (run, end), shade);
    let bushes = f64::from(run.counts_at(SimTime::ZERO).bushes());
    axis::draw_values(canvas, lettering, plan, strip.area, (0.0, bushes));
}

/// A line through all of the chart with a handle at its upper end.
fn draw_cursor(sheet: &mut Canvas, layout: &Layout, x: u32, runs: usize) {
    let plan = Plan::new(layout, runs);
    let (top, bottom) = plan.cursor;
    let (x, top, bottom) = (x as f32 + 0.5, (layout.chart.top + top) as f32, (layout.chart.top + bottom) as f32);
    let (width, knob) = (layout.length(0.12).max(1.0), 0.55 * layout.text as f32);
    for (wider, colour) in [(2.0, PAPER), (0.0, INK)] {
        sheet.fill_rect(x - 0.5 * (width + wider), top, width + wider, bottom - top, colour);
        let (half, tip) = (knob + 0.5 * wider, top + 1.3 * knob + wider);
        let handle = [
            (x - half, top - 0.3 * wider),
            (x + half, top - 0.3 * wider),
            (x + half, top + 0.5 * knob),
            (x, tip),
            (x - half, top + 0.5 * knob),
        ];
        sheet.fill(&handle, colour);
    }
}
