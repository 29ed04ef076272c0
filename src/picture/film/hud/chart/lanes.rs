//! Marks of events above the counts: one lane a kind, one mark a column however many events fall on it.

use super::super::super::lettering::{Lettering, Style};
use super::plan::{Plan, Rows};
use crate::picture::Rgb;
use crate::picture::canvas::Canvas;
use crate::picture::colours::{BURNING, EXTINGUISHED, INK, PAPER, blend};
use crate::picture::film::RunView;
use crate::picture::text::Align;
use crate::time::SimTime;
use crate::timeline::{AgentFact, Fact, FireFact};

/// A kind of events.
struct Lane {
    name: &'static str,
    colour: Rgb,
    belongs: fn(&Fact) -> bool,
}

const LANES: [Lane; 3] = [
    Lane { name: "ignitions", colour: BURNING, belongs: |fact| matches!(fact, Fact::Fire(FireFact::Ignited { .. })) },
    Lane {
        name: "extinctions",
        colour: EXTINGUISHED,
        belongs: |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. })),
    },
    Lane {
        name: "failed plans",
        colour: INK,
        belongs: |fact| matches!(fact, Fact::Agent(_, AgentFact::PlanFailed { .. })),
    },
];
/// Names are written where a lane is at least this high, in pixels.
const NAMED: u32 = 8;

pub fn draw(
    canvas: &mut Canvas,
    lettering: &mut Lettering,
    plan: &Plan,
    (top, height): Rows,
    (run, end): (&RunView, SimTime),
    shade: &dyn Fn(Rgb) -> Rgb,
) {
    for (index, lane) in (0..).zip(&LANES) {
        let pitch = height / LANES.len() as u32;
        let (top, bottom) = (top + index * pitch, top + (index + 1) * pitch - 1);
        draw_marks(canvas, plan, (top, bottom), &columns(run, plan.columns.1, end, lane), shade(lane.colour));
        if bottom - top >= NAMED {
            let style = Style { height: 0.75 * plan.text as f32, is_bold: false, colour: blend(PAPER, INK, 0.7) };
            let at = (plan.columns.0 as f32 - plan.length(0.6), bottom as f32);
            lettering.draw(canvas, lane.name, at, Align::Right, style);
        }
    }
}

/// The columns in which such an event happens, ascending.
fn columns(run: &RunView, width: u32, end: SimTime, lane: &Lane) -> Vec<u32> {
    let events = run.timeline().events.iter().filter(|event| event.time <= end && (lane.belongs)(&event.fact));
    let mut columns: Vec<u32> = events.map(|event| column_of(event.time, width, end)).collect();
    columns.dedup();
    columns
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a column lies on the sheet")]
fn column_of(time: SimTime, width: u32, end: SimTime) -> u32 {
    let share = time.as_seconds() / end.as_seconds().max(f64::MIN_POSITIVE);
    ((share * f64::from(width)) as u32).min(width - 1)
}

fn draw_marks(canvas: &mut Canvas, plan: &Plan, (top, bottom): (u32, u32), columns: &[u32], colour: Rgb) {
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
