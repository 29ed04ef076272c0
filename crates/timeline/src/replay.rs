//! The state of a run at any time, derived from its facts.

use serde::Serialize;

use super::progress::{Activity, AgentProgress};
use super::{AgentId, BushState, Event, Fact, FireFact, GroundEvent, GroundFact, Timeline};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::MotionState;

impl Event {
    /// Returns the bush that the fact changes, if any, and its new state.
    pub fn bush_change(&self) -> Option<ChangedBush> {
        let (cell, state) = match self.fact {
            Fact::Fire(FireFact::Ignited { cell, .. }) => (cell, BushState::Burning { since: self.time }),
            Fact::Fire(FireFact::BurnedOut { cell }) => (cell, BushState::BurnedOut),
            Fact::Fire(FireFact::Extinguished { cell, .. }) => (cell, BushState::Extinguished),
            _ => return None,
        };
        Some(ChangedBush { cell, state })
    }
}

/// A bush that a fact changes, and its new state.
#[derive(Clone, Copy, Debug)]
pub struct ChangedBush {
    pub cell: Cell,
    pub state: BushState,
}

/// An agent at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AgentState {
    pub id: AgentId,
    pub pose: Pose,
    /// The speed, never negative, forward or reverse.
    pub speed_mps: f64,
    pub activity: Activity,
    /// The agent's goal: from the plan until the agent lights or extinguishes the cell, its suppression ends, the goal
    /// is dropped or given up at a local minimum, or the agent rests.
    pub goal: Option<Cell>,
}

/// The state of a whole run at one time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct State {
    pub time: SimTime,
    /// The states in the order of [`super::Setting::bushes`].
    pub bushes: Vec<BushState>,
    /// The agents in the order of [`super::Setting::agents`].
    pub agents: Vec<AgentState>,
}

/// The change of one bush by one fact, by the place of the bush in [`super::Setting::bushes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BushChange {
    pub bush: usize,
    pub from: BushState,
    pub to: BushState,
}

/// The next thing that happens in a replay.
#[derive(Clone, Copy, Debug)]
pub(super) enum Happening<'a> {
    /// A fact, with the change of a bush if it is one.
    Fact(&'a Event, Option<BushChange>),
    /// An agent lights or extinguishes ground. At one instant it precedes the facts, which include the agent's next
    /// goal.
    Deed(&'a GroundEvent),
}

/// A cursor in a timeline: the state at one time, moved cheaply to later ones. For the ground itself see
/// [`GroundIndex`](super::GroundIndex).
///
/// Moving forward costs the facts in between; moving back begins again at the start.
#[derive(Clone, Debug)]
pub struct Replay<'a> {
    timeline: &'a Timeline,
    end: SimTime,
    time: SimTime,
    /// Index of the first fact that has not yet happened.
    next: usize,
    /// From the next thing on that an agent did to ground.
    ground: &'a [GroundEvent],
    bushes: Vec<BushState>,
    agents: Vec<AgentProgress<'a>>,
}

impl<'a> Replay<'a> {
    /// Creates a replay at time zero, after all events of that instant.
    pub fn new(timeline: &'a Timeline) -> Self {
        let mut replay = Self::before_all(timeline);
        replay.seek(SimTime::ZERO);
        replay
    }

    /// The setting, before any fact.
    pub(super) fn before_all(timeline: &'a Timeline) -> Self {
        let setting = &timeline.setting;
        Self {
            timeline,
            end: timeline.end_time(),
            time: SimTime::ZERO,
            next: 0,
            ground: from_next_deed(&timeline.ground),
            bushes: vec![BushState::Intact; setting.bushes.len()],
            agents: setting.agents.iter().map(|agent| AgentProgress::standing(agent.pose)).collect(),
        }
    }

    /// Moves to the state after all events at `time`, before or after the present one, but not beyond the end of the
    /// run.
    pub fn seek(&mut self, time: SimTime) {
        let time = time.min(self.end);
        if time < self.time {
            *self = Self::before_all(self.timeline);
        }
        while self.step(time).is_some() {}
        self.time = time;
    }

    /// Moves to a later time before which no fact is due.
    pub(super) fn wait_until(&mut self, time: SimTime) {
        self.time = time;
    }

    /// Lets what comes next happen if its time is not after `until`.
    pub(super) fn step(&mut self, until: SimTime) -> Option<Happening<'a>> {
        let event = self.timeline.events.get(self.next);
        if let Some(deed) =
            self.ground.first().filter(|deed| deed.time <= until && event.is_none_or(|event| deed.time <= event.time))
        {
            self.ground = from_next_deed(&self.ground[1..]);
            self.time = deed.time;
            let agent = deed.agent().and_then(|agent| self.timeline.setting.agent_index(agent));
            agent.into_iter().for_each(|agent| self.agents[agent].change_ground());
            return Some(Happening::Deed(deed));
        }
        let event = event.filter(|event| event.time <= until)?;
        self.next += 1;
        self.time = event.time;
        self.apply_to_agent(event);
        Some(Happening::Fact(event, self.apply_to_bush(event)))
    }

    /// The next time after the present one at which anything may change but poses and the ground: a fact, something that
    /// an agent does to ground, or an activity.
    pub(super) fn next_change(&self) -> Option<SimTime> {
        let fact = self.timeline.events.get(self.next).map(|event| event.time);
        let deed = self.ground.first().map(|deed| deed.time);
        self.agents.iter().filter_map(|agent| agent.next_change(self.time)).chain(fact).chain(deed).min()
    }

    pub fn time(&self) -> SimTime {
        self.time
    }

    /// Returns the number of facts so far.
    pub fn facts_so_far(&self) -> usize {
        self.next
    }

    /// Returns the states in the order of [`super::Setting::bushes`].
    pub fn bushes(&self) -> &[BushState] {
        &self.bushes
    }

    /// Returns the activity of an agent by its place in [`super::Setting::agents`].
    pub fn activity(&self, agent: usize) -> Activity {
        self.agents[agent].activity(self.time)
    }

    /// Returns the goal of an agent by its place in [`super::Setting::agents`].
    pub fn goal(&self, agent: usize) -> Option<Cell> {
        self.agents[agent].goal
    }

    /// Returns an agent by its place in [`super::Setting::agents`].
    pub fn agent(&self, agent: usize) -> AgentState {
        let MotionState { pose, speed_mps } = self.agents[agent].motion_at(self.time);
        let id = self.timeline.setting.agents[agent].id;
        AgentState { id, pose, speed_mps, activity: self.activity(agent), goal: self.goal(agent) }
    }

    pub fn state(&self) -> State {
        let agents = (0..self.agents.len()).map(|agent| self.agent(agent)).collect();
        State { time: self.time, bushes: self.bushes.clone(), agents }
    }

    fn apply_to_agent(&mut self, event: &'a Event) {
        let Some(agent) = event.fact.agent() else { return };
        let Some(index) = self.timeline.setting.agent_index(agent) else { return };
        self.agents[index].apply(&event.fact);
    }

    fn apply_to_bush(&mut self, event: &Event) -> Option<BushChange> {
        let ChangedBush { cell, state: to } = event.bush_change()?;
        let bush = self.timeline.setting.bush_index(cell)?;
        let from = std::mem::replace(&mut self.bushes[bush], to);
        Some(BushChange { bush, from, to })
    }
}

/// Passes over what happens to ground by itself, and over water.
fn from_next_deed(ground: &[GroundEvent]) -> &[GroundEvent] {
    &ground[ground
        .iter()
        .position(|event| event.agent().is_some() && !matches!(event.fact, GroundFact::Wetted { .. }))
        .unwrap_or(ground.len())..]
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::sample::{self, A, B, C, D, TRUCK, at, leg, planned, seconds};
    use super::*;
    use crate::AgentFact;
    use wildfire_base::rng;

    /// Finds what the last fact about a bush says, without a replay.
    fn bush_by_scanning(timeline: &Timeline, bush: Cell, time: SimTime) -> BushState {
        let past = timeline.events.iter().rev().filter(|event| event.time <= time);
        let reported = |event: &Event| match event.fact {
            Fact::Fire(FireFact::Ignited { cell, .. }) if cell == bush => {
                Some(BushState::Burning { since: event.time })
            }
            Fact::Fire(FireFact::BurnedOut { cell }) if cell == bush => Some(BushState::BurnedOut),
            Fact::Fire(FireFact::Extinguished { cell, .. }) if cell == bush => Some(BushState::Extinguished),
            _ => None,
        };
        past.filter_map(reported).next().unwrap_or(BushState::Intact)
    }

    /// Pose and speed by the last leg begun, and whether the agent moves along it.
    fn motion_by_scanning(timeline: &Timeline, agent: usize, time: SimTime) -> (Pose, f64, bool) {
        let start = timeline.setting.agents[agent];
        let leg_of = |event: &'_ Event| match &event.fact {
            Fact::Agent(agent, AgentFact::Planned { trajectory, .. })
            | Fact::Agent(agent, AgentFact::Dropped { trajectory, .. })
                if *agent == start.id =>
            {
                Some(trajectory.clone())
            }
            _ => None,
        };
        let leg = timeline.events.iter().rev().filter(|event| event.time <= time).find_map(leg_of);
        leg.map_or((start.pose, 0.0, false), |leg| {
            let MotionState { pose, speed_mps } = leg.state_at(time);
            (pose, speed_mps, leg.start_time() <= time && time < leg.end_time())
        })
    }

    fn times(timeline: &Timeline, seed: u64, count: usize) -> Vec<SimTime> {
        let mut rng = rng::stream(seed, "timeline/replay/tests");
        let drawn = (0..count).map(|_| {
            let event = &timeline.events[rng.random_range(0..timeline.events.len())];
            let near = event.time.as_nanos() + rng.random_range(0..3);
            let anywhere = rng.random_range(0..=timeline.end_time().as_nanos());
            SimTime::from_nanos(if rng.random_bool(0.5) { near.saturating_sub(1) } else { anywhere })
        });
        drawn.map(|time| time.min(timeline.end_time())).collect()
    }

    #[test]
    fn a_state_is_what_a_scan_of_the_facts_says() {
        for seed in 0..4 {
            let timeline = sample::random(seed, seconds(300.0));
            for time in times(&timeline, seed, 100) {
                let state = timeline.state_at(time);
                assert_eq!(state.time, time);
                for (&cell, &bush) in timeline.setting.bushes.iter().zip(&state.bushes) {
                    assert_eq!(bush, bush_by_scanning(&timeline, cell, time), "{cell} at {time}");
                }
                for (index, agent) in state.agents.iter().enumerate() {
                    let (pose, speed_mps, moves) = motion_by_scanning(&timeline, index, time);
                    assert_eq!((agent.pose, agent.speed_mps), (pose, speed_mps), "{} at {time}", agent.id);
                    assert_eq!(agent.activity == Activity::Driving, moves, "{} at {time}", agent.id);
                }
            }
        }
    }

    #[test]
    fn seeking_anywhere_in_any_order_gives_the_state_of_that_time() {
        let timeline = sample::random(9, seconds(300.0));
        let mut replay = Replay::new(&timeline);
        for time in times(&timeline, 9, 200) {
            replay.seek(time);
            assert_eq!(replay.state(), timeline.state_at(time));
        }
    }

    #[test]
    fn stepping_from_change_to_change_misses_nothing() {
        let timeline = sample::random(5, seconds(300.0));
        let mut replay = Replay::new(&timeline);
        while let Some(change) = replay.next_change().filter(|&change| change <= timeline.end_time()) {
            let just_before = SimTime::from_nanos(change.as_nanos() - 1);
            let [earlier, later] = [replay.state(), timeline.state_at(just_before)];
            assert_eq!(earlier.bushes, later.bushes);
            for (was, is) in earlier.agents.iter().zip(&later.agents) {
                assert_eq!((was.activity, was.goal), (is.activity, is.goal), "{} before {change}", was.id);
            }
            replay.seek(change);
        }
        assert_eq!(replay.facts_so_far(), timeline.events.len());
    }

    #[test]
    fn a_run_written_by_hand_passes_through_these_states() {
        let timeline = sample::by_hand();
        let story = |time_s: f64| {
            let agents = timeline.state_at(seconds(time_s)).agents;
            [0, 1].map(|agent: usize| (agents[agent].activity, agents[agent].goal))
        };
        use Activity::{Driving, Planning, Standing, Suppressing};
        assert_eq!(story(0.0), [(Driving, Some(A)), (Standing, None)]);
        assert_eq!(story(10.0), [(Driving, Some(B)), (Planning, Some(A))]);
        assert_eq!(story(12.0), [(Driving, Some(B)), (Driving, Some(A))]);
        assert_eq!(story(16.0), [(Driving, None), (Suppressing, Some(A))]);
        assert_eq!(story(17.0), [(Planning, None), (Suppressing, Some(A))]);
        assert_eq!(story(20.0), [(Standing, None), (Driving, Some(B))]);
        assert_eq!(story(23.5), [(Standing, None), (Driving, None)]);
        assert_eq!(story(24.0), [(Standing, None), (Standing, None)]);
        assert_eq!(story(83.0), [(Standing, None), (Suppressing, Some(C))]);
        assert_eq!(story(85.0), [(Standing, None), (Standing, None)]);
    }

    #[test]
    fn a_failed_plan_does_not_stop_an_agent_under_way() {
        let setting = sample::small_setting(&[TRUCK]);
        let start = setting.agents[0].pose;
        let failed = Fact::Agent(
            TRUCK,
            AgentFact::PlanFailed {
                goal: D,
                reason: wildfire_base::query::PlanFailure::GoalBlocked,
                effort: sample::effort(0, 0),
                until: seconds(5.0),
            },
        );
        let events = vec![at(0.0, planned(TRUCK, A, leg(0.0, start, 8.0, &[80.0]))), at(3.0, failed)];
        let state = Timeline { setting, events, ground: Vec::new() }.state_at(seconds(4.0)).agents[0];
        assert_eq!((state.activity, state.goal), (Activity::Driving, Some(A)));
    }

    #[test]
    fn beyond_the_end_nothing_moves() {
        let timeline = sample::by_hand();
        assert_eq!(timeline.state_at(seconds(1e6)), timeline.state_at(timeline.end_time()));
    }
}
