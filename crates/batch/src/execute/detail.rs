//! The details of a run in a batch, besides its numbers: every planner call, and the bushes over time.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_planning::{Effort, FoundBy, PlanFailure};
use wildfire_timeline::BushStateKind;
use wildfire_timeline::{AgentFact, AgentId, Event, Fact, RunIndex};

/// The number of intervals between the times at which bushes are counted, from the start to the end of the scenario.
pub const STATE_STEPS: u64 = 60;

/// The details of a run; empty for a run that is not done.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunDetail {
    /// The number of facts of the timeline.
    pub facts: u64,
    /// The planner calls in order.
    pub calls: Vec<PlannerCall>,
    /// The counts at every sixtieth of the scenario's duration.
    pub states: Vec<StateCount>,
}

/// A query to an agent's planner, and its answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "CallFields", into = "CallFields")]
pub struct PlannerCall {
    pub agent: AgentId,
    pub time: SimTime,
    /// Column and row of the agent's goal.
    pub goal: (u16, u16),
    pub answer: Result<Solution, PlanFailure>,
    pub effort: Effort,
    /// CPU time of the agent's planning since its previous call; measured. `None` in journals of older programs.
    pub cpu: Option<Duration>,
}

/// A plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    pub length_m: f64,
    pub segments: u32,
    pub cusps: u32,
    pub duration_s: f64,
    /// The means by which it was found; `None` for a Wumpus.
    pub found_by: Option<FoundBy>,
}

impl Solution {
    fn new(leg: &Trajectory, found_by: Option<FoundBy>) -> Self {
        Self {
            length_m: leg.distance_m(SimTime::MAX),
            segments: leg.pieces().iter().filter(|piece| piece.segment().is_some()).count() as u32,
            cusps: leg.cusps(),
            duration_s: leg.duration_s(),
            found_by,
        }
    }

    /// Returns whether it comes from the reachability flood, after the planner had failed.
    pub fn by_lattice(&self) -> bool {
        self.found_by.is_some_and(FoundBy::is_after_failure)
    }
}

/// A call as a journal holds it, where there are hundreds in every line: agent (twice its number, one more for a
/// truck), nanoseconds, column, row, failure (from 1; 0 of a plan), expansions in roadmap and local search, of a plan
/// metres, segments, cusps, seconds, and what found it, and nanoseconds of CPU time.
#[derive(Serialize, Deserialize)]
struct CallFields(
    u32,
    u64,
    u16,
    u16,
    usize,
    u32,
    u32,
    Option<(f64, u32, u32, f64, FoundByField)>,
    /// The time in nanoseconds; missing in journals of older programs.
    #[serde(default)]
    Option<u64>,
);

/// The means that found a plan, as a journal names them.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum FoundByField {
    Named(FoundBy),
    /// True if it comes from the flood, in journals that name no means; false for plans of a Wumpus.
    Flood(bool),
}

impl From<FoundByField> for Option<FoundBy> {
    fn from(field: FoundByField) -> Self {
        match field {
            FoundByField::Named(found_by) => Some(found_by),
            FoundByField::Flood(by_flood) => by_flood.then_some(FoundBy::Reachability),
        }
    }
}

impl From<Option<FoundBy>> for FoundByField {
    fn from(found_by: Option<FoundBy>) -> Self {
        found_by.map_or(Self::Flood(false), Self::Named)
    }
}

impl TryFrom<CallFields> for PlannerCall {
    type Error = &'static str;

    fn try_from(fields: CallFields) -> Result<Self, &'static str> {
        let CallFields(agent, nanos, col, row, failure, roadmap_expansions, local_expansions, plan, cpu) = fields;
        // Twice the number plus the role is one integer, see below; more agents than fit are a damaged line.
        let number = u16::try_from(agent / 2).map_err(|_| "its agent has too large a number")?;
        let answer = match (failure, plan) {
            (0, Some((length_m, segments, cusps, duration_s, found_by))) => {
                Ok(Solution { length_m, segments, cusps, duration_s, found_by: found_by.into() })
            }
            (number, None) => {
                // Failures are numbered from 1, since 0 stands for none.
                let failure = number.checked_sub(1).and_then(|index| PlanFailure::ALL.get(index));
                Err(*failure.ok_or("a call has a plan, or a reason why not")?)
            }
            (_, Some(_)) => return Err("a plan has no failure"),
        };
        Ok(Self {
            // One number for both roles, so that a call takes less of a journal's line.
            agent: if agent % 2 == 0 { AgentId::wumpus(number) } else { AgentId::unimog(number) },
            time: SimTime::from_nanos(nanos),
            goal: (col, row),
            answer,
            effort: Effort { roadmap_expansions, local_expansions },
            cpu: cpu.map(Duration::from_nanos),
        })
    }
}

impl From<PlannerCall> for CallFields {
    fn from(call: PlannerCall) -> Self {
        let agent = 2 * u32::from(call.agent.number) + u32::from(call.agent.role.suppresses());
        let failure = call.answer.err().map_or(0, |failure| 1 + failure as usize);
        let plan = call.answer.ok();
        let plan = plan.map(|plan| (plan.length_m, plan.segments, plan.cusps, plan.duration_s, plan.found_by.into()));
        let Effort { roadmap_expansions, local_expansions } = call.effort;
        let (col, row) = call.goal;
        // Five centuries fit.
        let cpu = call.cpu.map(|cpu| cpu.as_nanos() as u64);
        Self(agent, call.time.as_nanos(), col, row, failure, roadmap_expansions, local_expansions, plan, cpu)
    }
}

/// The number of bushes in each state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "(SimTime, u32, u32, u32, u32)", into = "(SimTime, u32, u32, u32, u32)")]
pub struct StateCount {
    pub time: SimTime,
    pub intact: u32,
    pub burning: u32,
    pub burned_out: u32,
    pub extinguished: u32,
}

impl From<(SimTime, u32, u32, u32, u32)> for StateCount {
    fn from((time, intact, burning, burned_out, extinguished): (SimTime, u32, u32, u32, u32)) -> Self {
        Self { time, intact, burning, burned_out, extinguished }
    }
}

impl From<StateCount> for (SimTime, u32, u32, u32, u32) {
    fn from(count: StateCount) -> Self {
        (count.time, count.intact, count.burning, count.burned_out, count.extinguished)
    }
}

impl RunDetail {
    /// `answer_cpu` has the CPU time of each answer among the facts, in their order, where it is known.
    pub fn new(run: &RunIndex<'_>, answer_cpu: &[Duration]) -> Self {
        let timeline = run.timeline();
        let answers = timeline.events.iter().filter(|event| is_answer(event));
        let cpu = answer_cpu.iter().copied().map(Some).chain(std::iter::repeat(None));
        Self {
            facts: timeline.events.len() as u64,
            calls: answers
                .zip(cpu)
                .filter_map(|(event, cpu)| Some(PlannerCall { cpu, ..call_of(event, &timeline.setting.frame)? }))
                .collect(),
            states: states_of(run),
        }
    }

    /// Returns whether everything that is not measured is equal.
    pub fn has_same_outcome(&self, other: &Self) -> bool {
        let is_same =
            |(one, other): (&PlannerCall, &PlannerCall)| *one == PlannerCall { cpu: one.cpu, ..other.clone() };
        let has_same_calls = self.calls.len() == other.calls.len() && self.calls.iter().zip(&other.calls).all(is_same);
        has_same_calls && (self.facts, &self.states) == (other.facts, &other.states)
    }
}

/// Returns whether a fact is the answer to a query, or ends one.
fn is_answer(event: &Event) -> bool {
    let Fact::Agent(_, fact) = &event.fact else { return false };
    matches!(
        fact,
        AgentFact::Planned { .. }
            | AgentFact::Relocated { .. }
            | AgentFact::PlanFailed { .. }
            | AgentFact::RelocationFailed { .. }
    )
}

/// Returns the query that a fact is the answer to. A drive to a place goes for the cell there.
fn call_of(event: &Event, frame: &FieldFrame) -> Option<PlannerCall> {
    let Fact::Agent(agent, fact) = &event.fact else { return None };
    // A waiting place is written as its cell, so that all calls have a goal of one kind.
    let cell_at = |x_m: f64, y_m: f64| frame.cell_at(DVec2::new(x_m, y_m));
    let (goal, answer, effort) = match fact {
        AgentFact::Planned { goal, trajectory, effort, found_by } => {
            (*goal, Ok(Solution::new(trajectory, *found_by)), *effort)
        }
        AgentFact::Relocated { x_m, y_m, trajectory, effort, found_by } => {
            (cell_at(*x_m, *y_m)?, Ok(Solution::new(trajectory, Some(*found_by))), *effort)
        }
        AgentFact::PlanFailed { goal, reason, effort, .. } => (*goal, Err(*reason), *effort),
        AgentFact::RelocationFailed { x_m, y_m, reason: Some(reason), effort, .. } => {
            (cell_at(*x_m, *y_m)?, Err(*reason), *effort)
        }
        _ => return None,
    };
    Some(PlannerCall { agent: *agent, time: event.time, goal: (goal.col, goal.row), answer, effort, cpu: None })
}

/// Beyond the end of a run its bushes stay as they are.
fn states_of(run: &RunIndex<'_>) -> Vec<StateCount> {
    let duration = run.timeline().setting.rules.duration.as_nanos();
    let states = (0..=STATE_STEPS).map(|step| {
        // A scenario's duration is far below the centuries at which this would overflow.
        // The product comes before the division, so the last step is the end itself and none is rounded off.
        let time = SimTime::from_nanos(duration.saturating_mul(step) / STATE_STEPS);
        let counts = run.counts_at(time);
        StateCount {
            time,
            intact: counts.count(BushStateKind::Intact),
            burning: counts.burning(),
            burned_out: counts.count(BushStateKind::BurnedOut),
            extinguished: counts.count(BushStateKind::Extinguished),
        }
    });
    states.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario as scenario;
    use wildfire_sim::Run;

    fn smoke() -> Run {
        let scenario = scenario::load("smoke", &[]).expect("it is built in");
        wildfire_sim::run(&scenario, 3).expect("it can take place")
    }

    #[test]
    fn calls_are_those_that_the_outcome_counts() {
        let Run { timeline, answer_cpu, cost, .. } = smoke();
        let run = RunIndex::new(&timeline);
        let outcome = run.outcome();
        let detail = RunDetail::new(&run, &answer_cpu);
        for agent in &outcome.agents {
            let calls: Vec<_> = detail.calls.iter().filter(|call| call.agent == agent.agent).collect();
            let failed = calls.iter().filter(|call| call.answer.is_err()).count() as u32;
            assert_eq!((calls.len() as u32, failed), (agent.plans, agent.failures.sum()), "{}", agent.agent);
            // What queries took is part of what the agent's planning took in all.
            let cpu: Duration = calls.iter().map(|call| call.cpu.expect("it is measured")).sum();
            let all = cost.agents.iter().find(|cost| cost.agent == agent.agent).expect("it has a cost").total();
            assert!(cpu > Duration::ZERO && cpu <= all, "{}: {cpu:?} of {all:?}", agent.agent);
        }
    }

    #[test]
    fn last_state_is_that_of_the_outcome_and_every_bush_is_in_one() {
        let Run { timeline, .. } = smoke();
        let run = RunIndex::new(&timeline);
        let outcome = run.outcome();
        let states = RunDetail::new(&run, &[]).states;
        let last = states.last().expect("there are states");
        assert_eq!((states.len(), last.time), (61, SimTime::from_seconds(300.0)));
        assert_eq!(last.intact, outcome.intact);
        assert_eq!((last.burned_out, last.extinguished), (outcome.burned_out, outcome.extinguished));
        let sum = |state: &StateCount| state.intact + state.burning + state.burned_out + state.extinguished;
        assert!(states.iter().all(|state| sum(state) == outcome.obstacles));
        assert!(states.iter().any(|state| state.burning > 0));
    }

    #[test]
    fn details_survive_a_journal() {
        let Run { timeline, answer_cpu, .. } = smoke();
        let detail = RunDetail::new(&RunIndex::new(&timeline), &answer_cpu);
        let json = serde_json::to_string(&detail).expect("numbers and words are JSON");
        assert_eq!(serde_json::from_str::<RunDetail>(&json).expect("it was just written"), detail);
    }

    #[test]
    fn outcomes_are_the_same_whatever_they_cost() {
        let Run { timeline, answer_cpu, .. } = smoke();
        let run = RunIndex::new(&timeline);
        let one = RunDetail::new(&run, &answer_cpu);
        let other = RunDetail::new(&run, &[]);
        assert!(one != other && one.has_same_outcome(&other));
        let shorter = RunDetail { calls: one.calls[1..].to_vec(), ..one.clone() };
        assert!(!one.has_same_outcome(&shorter));
    }

    #[test]
    fn journals_that_name_no_means_say_whether_the_flood_led_to_a_plan() {
        let found_by = |field: &str| {
            let call = format!("[1,0,2,3,0,4,5,[6.5,7,8,9.5,{field}]]");
            let call: PlannerCall = serde_json::from_str(&call).expect("it is a call");
            call.answer.expect("it has a plan").found_by
        };
        assert_eq!(found_by("true"), Some(FoundBy::Reachability));
        assert_eq!(found_by("false"), None);
        assert_eq!(found_by("\"way-home\""), Some(FoundBy::WayHome));
    }
}
