//! Counts of bushes over the whole run, stacked, with marks of events above; of two runs, also how they differ. Fires on the
//! ground are shown in hectares.
//!
//! What lies ahead of the request's time is paler than what has passed. Both are drawn once and put together by
//! columns.

mod strips;

use strips::{draw_differences, draw_event_lanes, draw_scale_note, draw_stacked_counts, lanes_of};

use crate::Rgb;
use crate::canvas::Canvas;
use crate::colours::{FAINT_INK, INK, PAPER, blend};
use crate::film::hud::formatting;
use crate::film::lettering::{LetterStyle, Lettering};
use crate::film::{FrameLayout, FrameRequest, RunView, RunViewId};
use crate::font::Weight;
use crate::marks::to_f32;
use crate::text::Align;
use crate::ticks::{round_step, ticks};
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;

/// The share of its colour that the time ahead keeps.
const AHEAD: f64 = 0.35;

/// The intact bushes are left out of a chart where they would never take less of its height than this many fifths, and where
/// the bushes are so many that one of them is not seen: what one looks for would be a line at the lower edge.
const MAX_FIFTHS: u32 = 4;
const MIN_BUSHES: u32 = 1000;
/// The share of the height that what is left takes at most, so that the words above it have room.
const FILLED: f64 = 0.8;
/// The least height of a chart in hectares, for runs without fire.
const MIN_HECTARES: f64 = 1e-3;

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
        // Both drawings are kept: the pale one of what is to come, and over it the past up to the cursor.
        sheet.copy_from(&drawn.ahead, at);
        sheet.copy_columns(&drawn.past, x, at);
        draw_cursor(sheet, layout, x, request.runs);
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
    scale: CountScale,
    /// The end of the time axis.
    end: SimTime,
    /// The share of their colour that counts and events get.
    colourfulness: f64,
}

/// The scale on which counts are stacked, the same for all runs of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CountScale {
    /// All bushes of a run take the whole height.
    All,
    /// The intact ones are left out, and this many bushes take the whole height.
    WithoutIntact { max: f64 },
    /// Ground on fire and burned; this many hectares take the whole height.
    Hectares { max: f64 },
}

impl CountScale {
    pub fn new(runs: &[&RunView]) -> Self {
        if runs.iter().all(|run| run.is_of_ground()) {
            let burned = runs.iter().map(|run| strips::amounts_at(run, run.end_time(), Self::Hectares { max: 1.0 }));
            let max = burned.map(|amounts| amounts.iter().sum()).fold(0.0, f64::max);
            return Self::Hectares { max: round_up((max / FILLED).max(MIN_HECTARES)) };
        }
        // A bush that was lit once is never intact again.
        let counts = runs.iter().map(|run| run.counts_at(run.end_time()));
        let changed_and_all: Vec<(u32, u32)> =
            counts.map(|counts| (counts.bushes() - counts.count(BushStateKind::Intact), counts.bushes())).collect();
        let is_dwarfed = |&(changed, all): &(u32, u32)| {
            all >= MIN_BUSHES && u64::from(changed) * 5 <= u64::from(all) * u64::from(5 - MAX_FIFTHS)
        };
        let max = changed_and_all.iter().map(|&(changed, _)| changed).max().unwrap_or(0);
        // Where nothing is lit at all, intact bushes are all that there is to see.
        if max > 0 && changed_and_all.iter().all(is_dwarfed) {
            Self::WithoutIntact { max: round_up(f64::from(max) / FILLED) }
        } else {
            Self::All
        }
    }

    /// Returns how many bushes take the whole height, where the intact ones are left out.
    pub fn max(self) -> Option<f64> {
        match self {
            Self::All | Self::Hectares { .. } => None,
            Self::WithoutIntact { max } => Some(max),
        }
    }

    /// Returns the least distance between two numbers of the axis: bushes are whole.
    fn min_step(self) -> f64 {
        if matches!(self, Self::Hectares { .. }) { 0.0 } else { 1.0 }
    }

    /// Returns the bushes, or hectares, of a run that take the whole height.
    fn max_of(self, run: &RunView) -> f64 {
        match self {
            Self::All => f64::from(run.counts_at(SimTime::ZERO).bushes()),
            Self::WithoutIntact { max } | Self::Hectares { max } => max,
        }
    }
}

/// A round value, since a strip of little height has no number but those at its ends.
fn round_up(max: f64) -> f64 {
    let step = round_step(max / 20.0);
    step * (max / step).ceil()
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
    let plan = ChartPlan::new(layout, runs);
    let strips = plan.strips.clone();
    let difference = plan.difference;
    let scale = CountScale::new(runs);
    let mut pen = ChartPen { canvas, lettering, plan, scale, end: RunView::last_end(runs), colourfulness };
    pen.canvas.fill_rect(0.0, 0.0, layout.chart.width as f32, 1.0, FAINT_INK);
    for (run_index, (run, strip)) in runs.iter().zip(&strips).enumerate() {
        if let Some(rows) = strip.lanes {
            draw_event_lanes(&mut pen, rows, run);
        }
        draw_stacked_counts(&mut pen, strip.area, run);
        draw_value_axis(&mut pen, strip.area, (0.0, scale.max_of(run)), scale.min_step());
        draw_scale_note(&mut pen, strip.area, run);
        if runs.len() > 1 {
            draw_run_name(&mut pen, strip, run_index);
        }
    }
    if let (&[one, other], Some(rows)) = (runs, difference) {
        draw_differences(&mut pen, rows, one, other);
    }
    draw_time_axis(&mut pen);
    pen.canvas
}

/// Draws a line through all of the chart with a handle at its upper end.
fn draw_cursor(sheet: &mut Canvas, layout: &FrameLayout, x: u32, runs: &[&RunView]) {
    let plan = ChartPlan::new(layout, runs);
    let (top, bottom) = plan.cursor;
    let x = x as f32 + 0.5;
    let top = (layout.chart.top + top) as f32;
    let bottom = (layout.chart.top + bottom) as f32;
    let width = layout.length(0.12).max(1.0);
    let knob = 0.55 * layout.text as f32;
    for (wider, colour) in [(2.0, PAPER), (0.0, INK)] {
        sheet.fill_rect(x - 0.5 * (width + wider), top, width + wider, bottom - top, colour);
        let half = knob + 0.5 * wider;
        let tip = top + 1.3 * knob + wider;
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
    fn new(layout: &FrameLayout, shown: &[&RunView]) -> Self {
        let (text, runs) = (layout.text, shown.len());
        let part = |tenths: u32| tenths * text / 10;
        // Where there is no panel, a line above the strips tells the most important of it.
        let header = if layout.panel.is_none() { part(22) } else { 0 };
        let top = header + part(9);
        let bottom = layout.chart.height - part(24);
        let room = bottom.saturating_sub(top);
        // A third strip on a low chart would leave no room for the two that it compares.
        let (strips_room, difference) = if runs > 1 && room > part(150) {
            let height = 3 * room / 10;
            (room - height - part(22), Some((bottom - height, height)))
        } else {
            (room, None)
        };
        let (each, gap) = (strips_room / runs as u32, part(5));
        let lanes = shown.iter().copied().map(lanes_of).max().unwrap_or(0);
        // A chart without lanes keeps room for the highest number of its axis.
        let lanes_height = part((lanes * if runs == 1 { 12 } else { 8 }).max(6));
        let strips = (0..runs as u32).map(|run_index| {
            let top = top + run_index * each;
            let height = if run_index + 1 == runs as u32 { each } else { each - gap.min(each) };
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
    LetterStyle { height: 0.85 * plan.text as f32, weight: Weight::Regular, colour: INK }
}

/// Draws times under the chart.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few dozen numbers")]
fn draw_time_axis(ChartPen { canvas, lettering, plan, end, .. }: &mut ChartPen) {
    let (unit, unit_s) = if end.as_seconds() < MINUTES_FROM_S { ("s", 1.0) } else { ("min", SECONDS_PER_MINUTE) };
    let last = end.as_seconds() / unit_s;
    let left = plan.columns.0 as f32;
    let width = plan.columns.1 as f32;
    let base = plan.axis_base as f32;
    let max = (width / plan.length(BETWEEN_TIMES)) as usize;
    for tick in ticks(0.0, last, max.max(1), 0.0) {
        // A run may end at the time at which it begins.
        let x = left + width * to_f32(tick.value / last.max(f64::MIN_POSITIVE));
        let mark = plan.length(0.35);
        let top = base - plan.length(1.7);
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
    min_step: f64,
) {
    let (top, height) = (top as f32, height as f32);
    let max = (height / plan.length(BETWEEN_VALUES)) as usize;
    let right = plan.columns.0 as f32 - 1.0;
    canvas.fill_rect(right, top, 1.0, height, FAINT_INK);
    for tick in ticks(low, high, max.max(1), min_step) {
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
    let style = LetterStyle { height: 1.4 * plan.text as f32, weight: Weight::Bold, colour: INK };
    let base = top as f32 + 0.5 * height as f32 + 0.5 * style.height;
    lettering.draw(canvas, formatting::run_name(run_index), (plan.length(1.2), base), Align::Left, style);
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::{Cell, FieldFrame};
    use wildfire_timeline::{Timeline, sample};

    /// A run with that many bushes, so many of which catch fire one after the other.
    fn run(bushes: u16, ignited: u16) -> RunView {
        let mut setting = sample::small_setting(&[]);
        setting.frame = FieldFrame { cols: 100, rows: 100, cell_m: 5.0 };
        let cell = |index: u16| Cell { col: index % 100, row: index / 100 };
        setting.bushes = (0..bushes).map(cell).collect();
        let events =
            (0..ignited).map(|index| sample::at(0.001 * f64::from(index), sample::ignited(cell(index)))).collect();
        RunView::new(Timeline { setting, events, ground: Vec::new() }, None)
    }

    #[test]
    fn intact_bushes_are_left_out_where_they_would_take_most_of_the_height() {
        for (bushes, ignited, max) in [
            (2000, 400, Some(500.0)),
            (2000, 401, None),
            (2000, 0, None),
            (999, 10, None),
            (1000, 8, Some(10.0)),
            (10_000, 1671, Some(2200.0)),
        ] {
            let expected = max.map_or(CountScale::All, |max| CountScale::WithoutIntact { max });
            assert_eq!(CountScale::new(&[&run(bushes, ignited)]), expected, "{ignited} of {bushes}");
        }
        let (calm, wild) = (run(2000, 8), run(2000, 80));
        assert_eq!(CountScale::new(&[&calm, &wild]), CountScale::WithoutIntact { max: 100.0 });
        assert_eq!(CountScale::new(&[&calm, &run(2000, 1000)]), CountScale::All);
    }

    #[test]
    fn ground_is_shown_in_hectares_below_a_round_number() {
        let run = RunView::new(sample::ground_alone(&[]), None);
        let CountScale::Hectares { max } = CountScale::new(&[&run]) else { panic!("it has ground alone") };
        let amounts = strips::amounts_at(&run, run.end_time(), CountScale::Hectares { max });
        let burned: f64 = amounts.iter().sum();
        assert!(burned > 0.0 && (0.7 * max..=FILLED * max * (1.0 + 1e-9)).contains(&burned), "{burned} of {max}");
        assert_eq!(CountScale::new(&[&run, &self::run(10, 1)]), CountScale::All);
    }

    #[test]
    fn what_is_not_intact_fills_the_chart_and_the_text_says_what_is_left_out() {
        let layout = FrameLayout::new((1280, 800), 1);
        let mut lettering = Lettering::default();
        let picture = |run: &RunView, lettering: &mut Lettering| draw_chart(&[run], &layout, lettering, 1.0).finish();
        let few = picture(&run(2000, 40), &mut lettering);
        let (top, height) = ChartPlan::new(&layout, &[&run(2000, 40)]).strips[0].area;
        let column = layout.timeline.left + layout.timeline.width - 2;
        let colour_at =
            |picture: &crate::Picture, share: f32| picture.pixel(column, top + (height as f32 * (1.0 - share)) as u32);
        assert_eq!(colour_at(&few, 0.5), crate::bush_colour(BushStateKind::Burning));
        assert_eq!(colour_at(&few, 0.9), PAPER);
        let is_written = (0..layout.timeline.width / 4)
            .any(|x| (0..height / 5).any(|y| few.pixel(layout.timeline.left + x, top + y) != PAPER));
        assert!(is_written);
        let many = picture(&run(2000, 1000), &mut lettering);
        assert_eq!(colour_at(&many, 0.9), crate::bush_colour(BushStateKind::Intact));
    }
}
