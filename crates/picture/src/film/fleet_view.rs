//! The part of a field that a camera on the fleet keeps in view.
//!
//! Trucks take up their work and end it at instants, and a camera that changed with them would jump. So there is a box for
//! every few seconds, which holds all trucks that do something within half a minute of its time, and what is seen is the mean
//! of the boxes within half a minute, the nearer the heavier. Each of them holds the trucks that are at work now, and so does
//! their mean. It follows from the run and the time alone, whatever was shown before.

use glam::DVec2;

use super::RunView;
use wildfire_base::time::SimTime;
use wildfire_timeline::{Activity, AgentState};

/// The time between two boxes.
const STEP: SimTime = SimTime::from_nanos(5_000_000_000);
/// The boxes on either side that count, and the steps on either side that each of them looks at.
const STEPS: u64 = 6;

/// The margin about the trucks: a share of the longer side of their box, and metres, so that the fire beside a truck is seen.
const MARGIN: f64 = 0.08;
const MIN_MARGIN_M: f64 = 30.0;

/// A part of a field, from its south-west corner to its north-east corner, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldBox {
    pub low: DVec2,
    pub high: DVec2,
}

impl FieldBox {
    fn around(point: DVec2) -> Self {
        Self { low: point, high: point }
    }

    fn joined(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn with_margin(self) -> Self {
        let margin = MARGIN * (self.high - self.low).max_element() + MIN_MARGIN_M;
        Self { low: self.low - margin, high: self.high + margin }
    }
}

/// Returns the part of the field that holds all trucks that do something at a time, or all trucks where none does; `None` of a
/// run without trucks.
pub fn fleet_box(run: &RunView, time: SimTime) -> Option<FieldBox> {
    // Steps are numbered from the first that is looked at; the present one begins the second half of them.
    let present = time.as_nanos() / STEP.as_nanos();
    let begins = |number: u64| at_step((present + number).saturating_sub(2 * STEPS));
    let at_work: Vec<Option<FieldBox>> =
        (0..=4 * STEPS + 1).map(|number| box_of(run, begins(number), is_at_work)).collect();
    let mut sum = FieldBox { low: DVec2::ZERO, high: DVec2::ZERO };
    let mut weights = 0.0;
    // There is one box more than the weights reach, as the present time lies between two of them.
    for number in STEPS..=3 * STEPS + 1 {
        let index = number as usize;
        let from_now = number as f64 - 2.0 * STEPS as f64 - share_of_step(time);
        let weight = (1.0 - from_now.abs() / STEPS as f64).max(0.0);
        let near = at_work[index - STEPS as usize..=index + STEPS as usize].iter().flatten();
        let kept = near.copied().reduce(FieldBox::joined).or_else(|| box_of(run, begins(number), |_| true))?;
        (sum.low, sum.high) = (sum.low + weight * kept.low, sum.high + weight * kept.high);
        weights += weight;
    }
    let mean = FieldBox { low: sum.low / weights, high: sum.high / weights };
    // Between two steps a truck goes on, and may have worked for a moment.
    let now = box_of(run, time, is_at_work);
    Some(now.map_or(mean, |now| mean.joined(now)).with_margin())
}

fn at_step(number: u64) -> SimTime {
    SimTime::from_nanos(number.saturating_mul(STEP.as_nanos()))
}

/// Returns the part of a step that has passed since its beginning, 0 to 1.
fn share_of_step(time: SimTime) -> f64 {
    (time.as_nanos() % STEP.as_nanos()) as f64 / STEP.as_nanos() as f64
}

fn is_at_work(truck: &AgentState) -> bool {
    truck.activity != Activity::Standing
}

/// Returns the box of the centres of those trucks.
fn box_of(run: &RunView, time: SimTime, is_meant: impl Fn(&AgentState) -> bool) -> Option<FieldBox> {
    let agents = run.timeline().setting.agents.iter().enumerate().filter(|(_, start)| start.id.role.suppresses());
    let places = agents.filter_map(|(index, start)| {
        let state = run.agent_at(index, time);
        is_meant(&state).then(|| FieldBox::around(start.body.centre(state.pose)))
    });
    places.reduce(FieldBox::joined)
}
