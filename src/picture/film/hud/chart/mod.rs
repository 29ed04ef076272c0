//! Counts of bushes over the whole run, stacked, with marks of events above; of two runs, also how they differ.
//!
//! What lies ahead of the request's time is paler than what has passed. Both are drawn once and put together by
//! columns.

mod strips;

use strips::{draw_differences, draw_event_lanes, draw_stacked_counts};

use crate::picture::Rgb;
use crate::picture::canvas::Canvas;
use crate::picture::colours::{FAINT_INK, INK, PAPER, blend};
use crate::picture::film::hud::words;
use crate::picture::film::lettering::{LetterStyle, Lettering};
use crate::picture::film::{FrameLayout, FrameRequest, RunView, RunViewId};
use crate::picture::marks::to_f32;
use crate::picture::text::Align;
use crate::picture::ticks::ticks;
use crate::time::SimTime;

/// The share of its colour that the time ahead keeps.
const AHEAD: f64 = 0.35;

/// Draws the chart of a request; keeps it as long as the runs are the same.
#[derive(Default)]
pub struct ChartRenderer {
    drawn: Option<Drawn>,
}

struct Drawn {
    layout: FrameLayout,
    runs: Vec<RunViewId>,
    past: Canvas,
    ahead: Canvas,
}

impl ChartRenderer {
    pub fn paint(
        &mut self,
        sheet: &mut Canvas,
        lettering: &mut Lettering,
        layout: &FrameLayout,
        request: &FrameRequest,
    ) {
        self.drawn.take_if(|drawn| {
            drawn.layout != *layout || drawn.runs.iter().copied().ne(request.runs.iter().map(|run| run.id()))
        });
        let drawn = self.drawn.get_or_insert_with(|| Drawn::new(request.runs, layout, lettering));
        let x = cursor_x(layout, request.time, RunView::last_end(request.runs));
        let at = (layout.chart.left, layout.chart.top);
        sheet.copy_from(&drawn.ahead, at);
        sheet.copy_columns(&drawn.past, x, at);
        draw_cursor(sheet, layout, x, request.runs.len());
    }
}

impl Drawn {
    fn new(runs: &[&RunView], layout: &FrameLayout, lettering: &mut Lettering) -> Self {
        let past = draw_chart(runs, layout, lettering, 1.0);
        let ahead = draw_chart(runs, layout, lettering, AHEAD);
        Self { layout: layout.clone(), runs: runs.iter().map(|run| run.id()).collect(), past, ahead }
    }
}

/// A canvas on which a chart is drawn, and all that its parts have in common.
struct ChartPen<'a> {
    canvas: Canvas,
    lettering: &'a mut Lettering,
    plan: ChartPlan,
    /// The end of the time axis.
    end: SimTime,
    /// The share of their colour that counts and events get.
    colourfulness: f64,
}

impl ChartPen<'_> {
    fn shade(&self, colour: Rgb) -> Rgb {
        blend(PAPER, colour, self.colourfulness)
    }
}

/// The column of the chart at a time.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column lies on the sheet")]
fn cursor_x(layout: &FrameLayout, time: SimTime, end: SimTime) -> u32 {
    let share = if end > SimTime::ZERO { time.min(end).as_seconds() / end.as_seconds() } else { 0.0 };
    layout.timeline_x(share).round() as u32
}

fn draw_chart(runs: &[&RunView], layout: &FrameLayout, lettering: &mut Lettering, colourfulness: f64) -> Canvas {
    let canvas = Canvas::new(layout.chart.width, layout.chart.height, PAPER);
    let plan = ChartPlan::new(layout, runs.len());
    let (strips, difference) = (plan.strips.clone(), plan.difference);
    let mut pen = ChartPen { canvas, lettering, plan, end: RunView::last_end(runs), colourfulness };
    pen.canvas.fill_rect(0.0, 0.0, layout.chart.width as f32, 1.0, FAINT_INK);
    for (run_index, (run, strip)) in runs.iter().zip(&strips).enumerate() {
        if let Some(rows) = strip.lanes {
            draw_event_lanes(&mut pen, rows, run);
        }
        draw_stacked_counts(&mut pen, strip.area, run);
        draw_value_axis(&mut pen, strip.area, (0.0, f64::from(run.counts_at(SimTime::ZERO).bushes())));
        if runs.len() > 1 {
            draw_run_name(&mut pen, strip, run_index);
        }
    }
    if let (&[one, other], Some(rows)) = (runs, difference) {
        draw_differences(&mut pen, rows, (one, other));
    }
    draw_time_axis(&mut pen);
    pen.canvas
}

/// Draws a line through all of the chart with a handle at its upper end.
fn draw_cursor(sheet: &mut Canvas, layout: &FrameLayout, x: u32, runs: usize) {
    let plan = ChartPlan::new(layout, runs);
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

/// Rows of the chart: the first, and how many.
type RowRange = (u32, u32);

/// The rows of one run's counts.
#[derive(Clone, Debug)]
struct RunStrip {
    /// Rows for marks of events; left out where there is too little room.
    lanes: Option<RowRange>,
    area: RowRange,
}

/// The places of a chart's parts.
#[derive(Clone, Debug)]
struct ChartPlan {
    /// Height of ordinary text.
    text: u32,
    /// The columns of the canvas between the start and the end of time: the first, and how many.
    columns: (u32, u32),
    strips: Vec<RunStrip>,
    /// Rows for the difference of two runs; left out where there is too little room.
    difference: Option<RowRange>,
    /// The first row of the cursor, and the one after its last.
    cursor: (u32, u32),
    /// The base line of the words under the time axis.
    axis_base: u32,
}

impl ChartPlan {
    fn new(layout: &FrameLayout, runs: usize) -> Self {
        let text = layout.text;
        let part = |tenths: u32| tenths * text / 10;
        // Where there is no panel, a line above the strips tells the most important of it.
        let header = if layout.panel.is_none() { part(22) } else { 0 };
        let (top, bottom) = (header + part(9), layout.chart.height - part(24));
        let room = bottom.saturating_sub(top);
        let (strips_room, difference) = if runs > 1 && room > part(150) {
            let height = 3 * room / 10;
            (room - height - part(22), Some((bottom - height, height)))
        } else {
            (room, None)
        };
        let (each, gap) = (strips_room / runs as u32, part(5));
        let lanes_height = if runs == 1 { part(36) } else { part(24) };
        let strips = (0..runs as u32).map(|run_index| {
            let (top, height) =
                (top + run_index * each, if run_index + 1 == runs as u32 { each } else { each - gap.min(each) });
            if height >= lanes_height + part(30) {
                let area = (top + lanes_height, height - lanes_height);
                RunStrip { lanes: Some((top, lanes_height - part(6))), area }
            } else {
                RunStrip { lanes: None, area: (top, height) }
            }
        });
        Self {
            text,
            columns: (layout.timeline.left - layout.chart.left, layout.timeline.width),
            strips: strips.collect(),
            difference,
            cursor: (header + part(2), bottom + part(3)),
            axis_base: bottom + part(17),
        }
    }

    fn length(&self, texts: f32) -> f32 {
        (texts * self.text as f32).round()
    }
}

/// Runs of at least this many seconds have their axis in minutes.
const MINUTES_FROM_S: f64 = 300.0;
const SECONDS_PER_MINUTE: f64 = 60.0;
/// Distances between numbers, in heights of text.
const BETWEEN_TIMES: f32 = 7.0;
const BETWEEN_VALUES: f32 = 3.0;

fn axis_style(plan: &ChartPlan) -> LetterStyle {
    LetterStyle { height: 0.85 * plan.text as f32, is_bold: false, colour: INK }
}

/// Draws times under the chart.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few dozen numbers")]
fn draw_time_axis(ChartPen { canvas, lettering, plan, end, .. }: &mut ChartPen) {
    let (unit, unit_s) = if end.as_seconds() < MINUTES_FROM_S { ("s", 1.0) } else { ("min", SECONDS_PER_MINUTE) };
    let last = end.as_seconds() / unit_s;
    let (left, width) = (plan.columns.0 as f32, plan.columns.1 as f32);
    let base = plan.axis_base as f32;
    let most = (width / plan.length(BETWEEN_TIMES)) as usize;
    for tick in ticks(0.0, last, most.max(1), 0.0) {
        let x = left + width * to_f32(tick.value / last.max(f64::MIN_POSITIVE));
        let (mark, top) = (plan.length(0.35), base - plan.length(1.7));
        canvas.fill_rect(x, top, 1.0, mark, INK);
        lettering.draw(canvas, &tick.label, (x, base), Align::Centre, axis_style(plan));
    }
    lettering.draw(canvas, unit, (left - plan.length(1.5), base), Align::Right, axis_style(plan));
}

/// Draws numbers left of some rows, the lowest at their lower edge; lines where there are numbers, but not on them.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few dozen numbers")]
fn draw_value_axis(
    ChartPen { canvas, lettering, plan, .. }: &mut ChartPen,
    (top, height): RowRange,
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
        lettering.draw(canvas, &tick.label, (right - plan.length(0.6), base), Align::Right, axis_style(plan));
    }
}

/// Draws the name of a run of a comparison beside its counts.
fn draw_run_name(ChartPen { canvas, lettering, plan, .. }: &mut ChartPen, strip: &RunStrip, run_index: usize) {
    let (top, height) = strip.area;
    let style = LetterStyle { height: 1.4 * plan.text as f32, is_bold: true, colour: INK };
    let base = top as f32 + 0.5 * height as f32 + 0.5 * style.height;
    lettering.draw(canvas, words::run_name(run_index), (plan.length(1.2), base), Align::Left, style);
}
