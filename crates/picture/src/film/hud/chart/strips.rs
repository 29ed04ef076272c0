//! The strips of a chart over time: the four counts stacked, marks of events above them, and how the counts of two runs
//! differ.

use crate::Rgb;
use crate::canvas::{Canvas, Point};
use crate::colours::{BURNING, EXTINGUISHED, FAINT_INK, INK, PAPER, blend, bush_colour};
use crate::film::hud::chart::{ChartPen, ChartPlan, CountScale, MIN_HECTARES, RowRange, draw_value_axis};
use crate::film::lettering::{LetterStyle, fitted};
use crate::film::{RunView, Verdict};
use crate::font::Weight;
use crate::marks::to_f32;
use crate::text::{Align, measure_weighted};
use crate::ticks::round_step;
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;
use wildfire_timeline::{AgentFact, Fact, FireFact};

/// The parts from the bottom up: what is lost, what burns, what was saved, what nothing happened to.
const STACKED: [BushStateKind; 4] =
    [BushStateKind::BurnedOut, BushStateKind::Burning, BushStateKind::Extinguished, BushStateKind::Intact];

/// Draws the four counts one over the other, or those that are not intact; every column shows those at its middle.
pub fn draw_stacked_counts(pen: &mut ChartPen, (top, height): RowRange, run: &RunView) {
    let mut colours = STACKED.map(|kind| pen.shade(bush_colour(kind)));
    if pen.scale != CountScale::All {
        // A scale without the intact bushes leaves their part white.
        colours[3] = PAPER;
    }
    let (left, width) = pen.plan.columns;
    let max = pen.scale.max_of(run).max(f64::MIN_POSITIVE);
    for column in 0..width {
        let amounts = amounts_at(run, column_time(column, width, pen.end), pen.scale);
        let edges = edges(amounts, max, height);
        for row in 0..height {
            let [red, green, blue] = row_colour(row, &edges, &colours);
            pen.canvas.row_from((left + column) as usize, (top + row) as usize)[0] = [red, green, blue, 255];
        }
    }
}

/// Returns the time in the middle of a column.
fn column_time(column: u32, width: u32, end: SimTime) -> SimTime {
    SimTime::from_seconds(end.as_seconds() * (f64::from(column) + 0.5) / f64::from(width))
}

/// Returns what a run has of each part, from the bottom up: bushes, or hectares of ground.
pub fn amounts_at(run: &RunView, time: SimTime, scale: CountScale) -> [f64; 4] {
    match (scale, run.index().ground()) {
        (CountScale::Hectares { .. }, Some(ground)) => {
            let counts = ground.counts_at(time);
            [counts.burned_out, counts.burning, counts.extinguished, 0].map(|cells| run.hectares(cells))
        }
        _ => {
            let counts = run.counts_at(time);
            STACKED.map(|kind| f64::from(counts.count(kind)))
        }
    }
}

/// Returns how far down the upper edge of each part lies, in rows.
fn edges(amounts: [f64; 4], max: f64, height: u32) -> [f64; 4] {
    let mut below = 0.0;
    amounts.map(|amount| {
        below += amount;
        f64::from(height) * (1.0 - below / max)
    })
}

/// Says that the intact bushes are left out, and how many there are, or that the chart is in hectares.
pub fn draw_scale_note(pen: &mut ChartPen, (top, height): RowRange, run: &RunView) {
    let note = match pen.scale {
        CountScale::All => return,
        CountScale::WithoutIntact { .. } => {
            let counts = run.counts_at(run.end_time());
            let intact = counts.count(BushStateKind::Intact);
            format!("intact bushes left out: {intact} of {} at the end", counts.bushes())
        }
        CountScale::Hectares { .. } => "hectares of ground that burn, and that have burned".to_owned(),
    };
    let ChartPen { canvas, lettering, plan, .. } = pen;
    let style =
        LetterStyle { height: 0.85 * plan.text as f32, weight: Weight::Regular, colour: blend(PAPER, INK, 0.7) };
    let base = top as f32 + 1.3 * style.height;
    if height as f32 > 3.0 * style.height {
        let note = fitted(&note, style.height, style.weight, plan.columns.1 as f32);
        lettering.draw(canvas, &note, (plan.columns.0 as f32 + plan.length(0.6), base), Align::Left, style);
    }
}

/// Mixes the colours of the parts that a row cuts by how much it has of each.
fn row_colour(row: u32, edges: &[f64; 4], colours: &[Rgb; 4]) -> Rgb {
    let above = f64::from(row);
    let below = f64::from(row) + 1.0;
    let mut colour = colours[3];
    for (&edge, &part) in edges.iter().zip(colours).rev().skip(1) {
        colour = blend(colour, part, (below - edge).clamp(0.0, below - above));
    }
    colour
}

/// A kind of events.
struct EventLane {
    name: &'static str,
    colour: Rgb,
    /// Whether a run can have any.
    is_there: fn(&RunView) -> bool,
    belongs: fn(&Fact) -> bool,
}

const LANES: [EventLane; 3] = [
    EventLane {
        name: "ignitions",
        colour: BURNING,
        is_there: has_bushes,
        belongs: |fact| matches!(fact, Fact::Fire(FireFact::Ignited { .. })),
    },
    EventLane {
        name: "extinctions",
        colour: EXTINGUISHED,
        is_there: has_bushes,
        belongs: |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. })),
    },
    EventLane {
        name: "failed plans",
        colour: INK,
        is_there: |run| !run.timeline().setting.agents.is_empty(),
        belongs: |fact| matches!(fact, Fact::Agent(_, AgentFact::PlanFailed { .. })),
    },
];
/// Names are written where a lane is at least this high, in pixels.
const NAMED: u32 = 8;

/// Fires on the ground are too many for marks, and are not among the events.
fn has_bushes(run: &RunView) -> bool {
    !run.timeline().setting.bushes.is_empty()
}

/// Counts the lanes of a run.
pub fn lanes_of(run: &RunView) -> u32 {
    LANES.iter().filter(|lane| (lane.is_there)(run)).count() as u32 + u32::from(!run.verdicts().is_empty())
}

/// The columns of a lane's marks by colour.
type LaneMarks = Vec<(Rgb, Vec<u32>)>;

/// Draws one lane for each kind of events, and one mark in a column however many of them fall on it. Verdicts on decisions
/// have a lane of their own.
pub fn draw_event_lanes(pen: &mut ChartPen, (top, height): RowRange, run: &RunView) {
    let (width, end) = (pen.plan.columns.1, pen.end);
    let there = LANES.iter().filter(|lane| (lane.is_there)(run));
    let events = there.map(|lane| (lane.name, vec![(lane.colour, event_columns(run, width, end, lane))]));
    let verdicts = (!run.verdicts().is_empty()).then(|| ("decisions", verdict_columns(run, width, end)));
    let lanes: Vec<(&str, LaneMarks)> = events.chain(verdicts).collect();
    // Never 0, as a run may have no event with a lane.
    let pitch = height / (lanes.len() as u32).max(1);
    for (index, (name, marks)) in (0..).zip(lanes) {
        // One row of pixels stays free between two lanes.
        let (top, bottom) = (top + index * pitch, top + (index + 1) * pitch - 1);
        for (colour, columns) in marks {
            let colour = pen.shade(colour);
            draw_marks(&mut pen.canvas, &pen.plan, (top, bottom), &columns, colour);
        }
        let ChartPen { canvas, lettering, plan, .. } = &mut *pen;
        if bottom - top >= NAMED {
            let style = LetterStyle {
                height: 0.75 * plan.text as f32,
                weight: Weight::Regular,
                colour: blend(PAPER, INK, 0.7),
            };
            let at = (plan.columns.0 as f32 - plan.length(0.6), bottom as f32);
            lettering.draw(canvas, name, at, Align::Right, style);
        }
    }
}

/// Returns the columns in which such an event happens, ascending.
fn event_columns(run: &RunView, width: u32, end: SimTime, lane: &EventLane) -> Vec<u32> {
    let events = run.timeline().events.iter().filter(|event| event.time <= end && (lane.belongs)(&event.fact));
    let mut columns: Vec<u32> = events.map(|event| column_of(event.time, width, end)).collect();
    columns.dedup();
    columns
}

/// Returns the columns of decisions by verdict, with their colours.
fn verdict_columns(run: &RunView, width: u32, end: SimTime) -> LaneMarks {
    Verdict::ALL
        .map(|verdict: Verdict| {
            let those = run.verdicts().iter().filter(|(time, other)| *other == verdict && *time <= end);
            (verdict.colour(), those.map(|(time, _)| column_of(*time, width, end)).collect())
        })
        .to_vec()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column lies on the sheet")]
fn column_of(time: SimTime, width: u32, end: SimTime) -> u32 {
    let share = time.as_seconds() / end.as_seconds().max(f64::MIN_POSITIVE);
    // What happens at the very end belongs to the last column.
    ((share * f64::from(width)) as u32).min(width - 1)
}

fn draw_marks(canvas: &mut Canvas, plan: &ChartPlan, (top, bottom): (u32, u32), columns: &[u32], colour: Rgb) {
    let [red, green, blue] = colour;
    let (left, width) = plan.columns;
    let thickness = (plan.text / 8).max(1);
    for &column in columns {
        let wide = thickness.min(width - column) as usize;
        for row in top..bottom {
            canvas.row_from((left + column) as usize, row as usize)[..wide].fill([red, green, blue, 255]);
        }
    }
}

/// A count that is compared.
struct CountCurve {
    name: &'static str,
    colour: Rgb,
    /// Of the amounts from the bottom up.
    amount: fn([f64; 4]) -> f64,
}

const CURVES: [CountCurve; 2] = [
    CountCurve { name: "burned", colour: BURNING, amount: |[burned_out, burning, ..]| burned_out + burning },
    CountCurve { name: "extinguished", colour: EXTINGUISHED, amount: |amounts| amounts[2] },
];

/// Draws how much larger the counts of the first run are than those of the second.
pub fn draw_differences(pen: &mut ChartPen, rows: RowRange, one: &RunView, other: &RunView) {
    let curves = CURVES.map(|curve| (pen.shade(curve.colour), differences(pen, one, other, curve.amount)));
    let min_step = pen.scale.min_step();
    let values = curves.iter().flat_map(|(_, values)| values).map(|value| value.abs());
    let largest = round_step(values.fold(min_step.max(MIN_HECTARES), f64::max));
    draw_value_axis(pen, rows, (-largest, largest), min_step);
    let (top, height) = (rows.0 as f32, rows.1 as f32);
    let left = pen.plan.columns.0 as f32;
    let width = pen.plan.columns.1 as f32;
    pen.canvas.fill_rect(left, top + 0.5 * height, width, 1.0, FAINT_INK);
    for (colour, values) in &curves {
        let points = values.iter().zip(0_u16..).map(|(&value, column)| {
            let y = top + 0.5 * height * (1.0 - to_f32(value / largest));
            (left + f32::from(column) + 0.5, y)
        });
        pen.canvas.polyline(&points.collect::<Vec<Point>>(), pen.plan.length(0.18).max(1.5), *colour);
    }
    draw_key(pen, top);
}

/// Returns the difference in the middle of each column.
fn differences(pen: &ChartPen, one: &RunView, other: &RunView, amount: fn([f64; 4]) -> f64) -> Vec<f64> {
    let width = pen.plan.columns.1;
    let times = (0..width).map(|column| column_time(column, width, pen.end));
    times
        .map(|time| {
            let [one, other] = [one, other].map(|run| amount(amounts_at(run, time, pen.scale)));
            one - other
        })
        .collect()
}

/// Draws the names of the curves above them.
fn draw_key(ChartPen { canvas, lettering, plan, .. }: &mut ChartPen, top: f32) {
    let style = LetterStyle { height: 0.85 * plan.text as f32, weight: Weight::Bold, colour: INK };
    let mut x = plan.columns.0 as f32;
    let base = top - plan.length(0.6);
    for (name, colour) in [("A - B", INK)].into_iter().chain(CURVES.map(|curve| (curve.name, curve.colour))) {
        lettering.draw(canvas, name, (x, base), Align::Left, LetterStyle { colour, ..style });
        x += measure_weighted(name, style.height, style.weight) + plan.length(1.5);
    }
}
