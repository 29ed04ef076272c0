//! An index of a run for its readers, built in one pass over its facts.
//!
//! Films, tables, reports and the outcome read the same index, so that none of them goes through the facts by itself
//! and all of them say the same. A number at a time is that after all facts of the time; beyond the end of the run it
//! is that at the end.

mod agents;
mod bushes;
mod ground;

use std::borrow::Cow;
use std::cell::OnceCell;

pub use agents::{AgentStats, FollowedLeg, SuppressionSpan};
pub use bushes::{BushCounts, SpreadMoment};
pub use ground::{Burning, ClearedCell, GroundCounts, GroundIndex, Wetting};

use agents::{AgentHistory, AgentReader, Surroundings};
use bushes::{BushHistory, BushReader};

use super::clairvoyant;
use super::replay::Happening;
use super::{
    Activity, AgentFact, AgentState, BushState, Event, FLOCK_M, Fact, FireFact, GroundEvent, GroundFact, Outcome,
    Replay, State, Timeline,
};
use wildfire_base::geometry::Cell;
use wildfire_base::query::{SearchGraph, SearchPhase};
use wildfire_base::time::SimTime;

/// A run with everything that was derived from it once: states, counts, numbers of agents, legs, stops, searches,
/// changes, outcome.
///
/// Building it costs one pass over the facts, some microseconds for each; an answer is a binary search, or little more.
/// Agents and bushes are named by their places in the setting.
#[derive(Debug)]
pub struct RunIndex<'a> {
    timeline: Cow<'a, Timeline>,
    end: SimTime,
    /// When something happened, ascending.
    moments: Vec<SimTime>,
    bushes: BushHistory,
    spreads: Vec<SpreadMoment>,
    agents: Vec<AgentHistory>,
    ground: Option<GroundIndex>,
    outcome: Outcome,
}

/// A search, with its place among the facts.
#[derive(Clone, Copy, Debug)]
pub struct FoundSearch<'a> {
    pub fact: usize,
    pub graph: &'a SearchGraph,
}

/// A search of an agent, as a recording names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedSearch {
    /// When its agent planned.
    pub time: SimTime,
    pub phase: SearchPhase,
}

impl<'a> RunIndex<'a> {
    pub fn new(timeline: &'a Timeline) -> Self {
        Self::from_cow(Cow::Borrowed(timeline))
    }

    fn from_cow(timeline: Cow<'a, Timeline>) -> Self {
        let ground = GroundIndex::new(&timeline);
        let IndexPass { moments, bushes, agents, outcome } = Reader::new(&timeline, ground.as_ref()).read();
        let end = timeline.end_time();
        let spreads = bushes::spread_moments(&timeline);
        Self { timeline, end, moments, bushes, spreads, agents, ground, outcome }
    }

    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    pub fn into_outcome(self) -> Outcome {
        self.outcome
    }

    pub fn end_time(&self) -> SimTime {
        self.end
    }

    /// Returns the state at a time, as [`Timeline::state_at`] finds it by going through all earlier facts.
    pub fn state_at(&self, time: SimTime) -> State {
        let time = time.min(self.end);
        let agents = self.timeline.setting.agents.iter().zip(&self.agents);
        let agents = agents.map(|(start, agent)| agent.state_at(&self.timeline, start, time)).collect();
        State { time, bushes: self.bushes.states_at(time), agents }
    }

    /// Returns the state of one agent at a time; cheaper than that of all agents and bushes.
    pub fn agent_at(&self, agent: usize, time: SimTime) -> AgentState {
        self.agents[agent].state_at(&self.timeline, &self.timeline.setting.agents[agent], time.min(self.end))
    }

    pub fn counts_at(&self, time: SimTime) -> BushCounts {
        self.bushes.counts_at(time)
    }

    /// Returns the ground at all times; `None` where only bushes burn.
    pub fn ground(&self) -> Option<&GroundIndex> {
        self.ground.as_ref()
    }

    /// Returns the changes of the ground after `from` up to `to`.
    pub fn ground_between(&self, from: SimTime, to: SimTime) -> &[GroundEvent] {
        let log = &self.timeline.ground;
        let before = |time: SimTime| log.partition_point(|event| event.time <= time.min(self.end));
        // Nothing lies between a time and an earlier one, and a slice that ends before it begins panics.
        &log[before(from)..before(to).max(before(from))]
    }

    /// Returns the numbers of an agent up to a time.
    pub fn stats_at(&self, agent: usize, time: SimTime) -> AgentStats {
        self.agents[agent].stats_at(&self.timeline, time.min(self.end))
    }

    /// Iterates over the facts that changed a bush, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = &Event> {
        self.bushes.changes_of(bush).map(|fact| &self.timeline.events[fact])
    }

    /// Iterates over the times at which an agent's numbers, goal or leg changed, including the start, ascending.
    pub fn changes_of_agent(&self, agent: usize) -> impl Iterator<Item = SimTime> + '_ {
        self.agents[agent].change_times()
    }

    /// Returns the times at which something happens, ascending, as [`Self::next_event`] visits them.
    pub fn moments(&self) -> &[SimTime] {
        &self.moments
    }

    /// Returns all moments of spread, in order of time.
    pub fn spreads(&self) -> &[SpreadMoment] {
        &self.spreads
    }

    /// Returns the moments of spread after `from` up to `to`.
    pub fn spreads_between(&self, from: SimTime, to: SimTime) -> &[SpreadMoment] {
        let before = |time: SimTime| self.spreads.partition_point(|spread| spread.time <= time);
        &self.spreads[before(from)..before(to).max(before(from))]
    }

    /// Iterates over the legs that an agent followed between two times, both included, last first.
    pub fn legs_between(&self, agent: usize, from: SimTime, to: SimTime) -> impl Iterator<Item = FollowedLeg> + '_ {
        let legs = &self.agents[agent].legs;
        let started = legs.partition_point(|leg| leg.from <= to);
        legs[..started].iter().rev().take_while(move |leg| leg.until >= from).copied()
    }

    /// Returns all legs of an agent in order of time; of legs that begin at one instant the last is followed.
    pub fn legs_of(&self, agent: usize) -> &[FollowedLeg] {
        &self.agents[agent].legs
    }

    /// Returns the leg that an agent follows, or has followed to its end.
    pub fn leg_at(&self, agent: usize, time: SimTime) -> Option<FollowedLeg> {
        self.legs_between(agent, time, time).next()
    }

    /// Returns an agent's last suppression that began by that time.
    pub fn stop_at(&self, agent: usize, time: SimTime) -> Option<SuppressionSpan> {
        let stops = &self.agents[agent].stops;
        let stop = stops[..stops.partition_point(|(from, ..)| *from <= time)].last();
        let lasts = |water_units| self.timeline.setting.stop_time(water_units);
        stop.map(|&(since, cell, water_units)| SuppressionSpan { since, cell, lasts: lasts(water_units) })
    }

    /// Returns the last search of an agent and phase that was recorded up to a time, with its place among the facts.
    pub fn search_at(&self, agent: usize, phase: SearchPhase, time: SimTime) -> Option<FoundSearch<'_>> {
        let searches = self.agents[agent].searches.iter().rev().skip_while(|(at, _)| *at > time);
        searches.into_iter().find_map(|&(_, fact)| match &self.timeline.events[fact].fact {
            Fact::Agent(_, AgentFact::Searched { phase: found, graph }) if *found == phase => {
                Some(FoundSearch { fact, graph })
            }
            _ => None,
        })
    }

    /// Returns true if the timeline contains recorded searches.
    pub fn has_searches(&self) -> bool {
        self.agents.iter().any(|agent| !agent.searches.is_empty())
    }

    /// Returns when the first bush, or ground, caught fire; `None` if nothing ever burned.
    pub fn first_ignition(&self) -> Option<SimTime> {
        let mut events = self.timeline.events.iter();
        let bush = events.find(|event| matches!(event.fact, Fact::Fire(FireFact::Ignited { .. })));
        let mut ground = self.timeline.ground.iter();
        let ground = ground.find(|event| matches!(event.fact, GroundFact::Ignited(_)));
        bush.map(|event| event.time).into_iter().chain(ground.map(|event| event.time)).min()
    }

    /// Returns when a plan of an agent first failed; `None` if all succeeded.
    pub fn first_failure(&self) -> Option<SimTime> {
        let mut events = self.timeline.events.iter();
        let failed = events.find(|event| {
            matches!(event.fact, Fact::Agent(_, AgentFact::PlanFailed { .. } | AgentFact::RelocationFailed { .. }))
        });
        failed.map(|event| event.time)
    }

    /// Returns the recorded search for a path with the most edges, the first among equals; roadmaps are no searches.
    pub fn largest_search(&self) -> Option<RecordedSearch> {
        let mut largest: Option<(usize, RecordedSearch)> = None;
        for event in &self.timeline.events {
            let Fact::Agent(_, AgentFact::Searched { phase, graph }) = &event.fact else { continue };
            let edges = graph.edges.len();
            if *phase != SearchPhase::Roadmap && largest.is_none_or(|(max, _)| edges > max) {
                largest = Some((edges, RecordedSearch { time: event.time, phase: *phase }));
            }
        }
        largest.map(|(_, search)| search)
    }

    /// Returns the next time after `time` at which something happens; recorded searches do not count, nor does fire
    /// that spreads over ground, which would be too many events.
    pub fn next_event(&self, time: SimTime) -> Option<SimTime> {
        self.moments.get(self.moments.partition_point(|&moment| moment <= time)).copied()
    }

    /// Returns the last time before `time` at which something happened.
    pub fn previous_event(&self, time: SimTime) -> Option<SimTime> {
        let before = self.moments.partition_point(|&moment| moment < time);
        before.checked_sub(1).map(|last| self.moments[last])
    }
}

impl From<Timeline> for RunIndex<'static> {
    fn from(timeline: Timeline) -> Self {
        Self::from_cow(Cow::Owned(timeline))
    }
}

/// The result of a pass over the facts.
struct IndexPass {
    moments: Vec<SimTime>,
    bushes: BushHistory,
    agents: Vec<AgentHistory>,
    outcome: Outcome,
}

/// Goes through a timeline once, instant by instant.
struct Reader<'a> {
    timeline: &'a Timeline,
    replay: Replay<'a>,
    moments: Vec<SimTime>,
    bushes: BushReader,
    agents: Vec<AgentReader<'a>>,
    ground: Option<&'a GroundIndex>,
    /// When the number of burning cells of ground changes while it is so small that it matters to somebody which.
    scarce: Vec<SimTime>,
}

impl<'a> Reader<'a> {
    fn new(timeline: &'a Timeline, ground: Option<&'a GroundIndex>) -> Self {
        Self {
            scarce: ground.map_or_else(Vec::new, |ground| scarce_times(timeline, ground)),
            ground,
            timeline,
            replay: Replay::before_all(timeline),
            moments: Vec::new(),
            bushes: BushReader::new(&timeline.setting),
            agents: timeline.setting.agents.iter().map(|start| AgentReader::new(start, timeline, ground)).collect(),
        }
    }

    fn read(mut self) -> IndexPass {
        let end = self.timeline.end_time();
        loop {
            self.read_instant();
            let now = self.replay.time();
            // A period ends where the ground has so few fires that another one decides whether a truck has a goal.
            let scarce = self.scarce.get(self.scarce.partition_point(|&time| time <= now)).copied();
            let until = self.replay.next_change().into_iter().chain(scarce).chain([end]).min().unwrap_or(end);
            let until = until.min(end);
            if until <= now {
                break;
            }
            self.account(now, until);
            self.replay.wait_until(until);
        }
        let (agents, outcomes): (Vec<_>, Vec<_>) = self.agents.into_iter().map(|agent| agent.finish(end)).unzip();
        let (bushes, outcome) = self.bushes.finish(&self.timeline.setting.rules);
        let stuck_s = |trucks: bool| {
            let of_role = outcomes.iter().filter(|outcome| outcome.agent.role.suppresses() == trucks);
            // Not `sum`, which makes -0 of nothing.
            of_role.fold(0.0, |total, outcome| total + outcome.stuck_s)
        };
        let outcome = Outcome {
            truck_stuck_s: stuck_s(true),
            wumpus_stuck_s: stuck_s(false),
            ended_s: end.as_seconds(),
            agents: outcomes,
            least_burned: clairvoyant::min_loss(self.timeline),
            ground: self.ground.map(|ground| ground.outcome(self.timeline)),
            ..outcome
        };
        IndexPass { moments: self.moments, bushes, agents, outcome }
    }

    /// Lets all facts of the present instant happen; what agents do from then on is known after the last of them.
    fn read_instant(&mut self) {
        let now = self.replay.time();
        while let Some(happening) = self.replay.step(now) {
            let (event, change) = match happening {
                Happening::Fact(event, change) => (event, change),
                Happening::Deed(deed) => {
                    self.record_deed(deed);
                    continue;
                }
            };
            // The replay counts a fact before it hands it over.
            let fact = self.replay.facts_so_far() - 1;
            if !matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. })) && self.moments.last() != Some(&now) {
                self.moments.push(now);
            }
            self.bushes.record_fact(&event.fact);
            if let Some(change) = change {
                self.bushes.record_change(change, now, fact, self.replay.bushes());
                self.agents.iter_mut().for_each(|agent| agent.record_change(change));
            }
            if let Some(agent) = event.fact.agent().and_then(|id| self.timeline.setting.agent_index(id)) {
                self.agents[agent].record_fact(fact, event, self.replay.bushes());
                if let Fact::Agent(_, AgentFact::Planned { goal, .. }) = event.fact
                    && self.is_near_another_goal(agent, goal)
                {
                    self.agents[agent].record_flock();
                }
            }
        }
        // Peaks are those at the end of instants: a fire that is replaced by another at once does not count twice.
        self.bushes.end_instant();
        for (index, agent) in self.agents.iter_mut().enumerate() {
            agent.turn_to(now, self.replay.activity(index), self.replay.goal(index));
        }
    }

    /// Returns whether a truck's new goal is near the goal that another truck has.
    fn is_near_another_goal(&self, agent: usize, goal: Cell) -> bool {
        let frame = &self.timeline.setting.frame;
        let mut others = (0..self.agents.len()).filter(|&other| other != agent && self.agents[other].is_truck());
        self.agents[agent].is_truck()
            && others.any(|other| {
                self.replay
                    .goal(other)
                    .is_some_and(|other| (frame.centre(other) - frame.centre(goal)).length() <= FLOCK_M)
            })
    }

    /// Records what an agent did to ground.
    fn record_deed(&mut self, deed: &GroundEvent) {
        if self.moments.last() != Some(&deed.time) {
            self.moments.push(deed.time);
        }
        if let Some(agent) = deed.agent().and_then(|id| self.timeline.setting.agent_index(id)) {
            self.agents[agent].record_deed(deed);
        }
    }

    /// Records a stretch of time in which nothing changes that matters.
    fn account(&mut self, now: SimTime, until: SimTime) {
        let span = until - now;
        self.bushes.account(span);
        // Only trucks that stand need these, and all of them share one list.
        let burning_goals = OnceCell::new();
        for index in 0..self.agents.len() {
            let activity = self.replay.activity(index);
            let stands = activity == Activity::Standing;
            let matters = stands && self.agents[index].is_truck();
            let wet_bushes = if stands && !matters { self.wet_bushes(now) } else { Vec::new() };
            let ground = self.ground.filter(|_| matters);
            let burning_ground = ground.map_or(0, |ground| ground.counts_at(now).burning);
            let around = Surroundings {
                now,
                bushes: self.bushes.counts(),
                burning_ground,
                wet_bushes: &wet_bushes,
                burning_goals: if matters { burning_goals.get_or_init(|| self.burning_goals()) } else { &[] },
                agent_goal: self.replay.goal(index),
            };
            self.agents[index].account(span, activity, &around);
        }
    }

    /// Places of bushes that could be lit if they were not wet, each once.
    fn wet_bushes(&self, now: SimTime) -> Vec<usize> {
        let wettings = self.ground.map_or(&[][..], GroundIndex::wettings);
        let wet = wettings.iter().filter(|wetting| wetting.from <= now && now < wetting.until);
        let setting = &self.timeline.setting;
        let bushes = self.replay.bushes();
        let mut places: Vec<usize> = wet
            .filter_map(|wetting| setting.bush_index(wetting.cell))
            .filter(|&bush| bushes[bush].can_ignite(setting.rules.reignition))
            .collect();
        // Wettings are in the order of cells, so those of one bush are neighbours.
        places.dedup();
        places
    }

    /// Burning cells that trucks go for, each once, and how many trucks do.
    fn burning_goals(&self) -> Vec<(Cell, u32)> {
        let burns = |cell: Cell| match self.timeline.setting.bush_index(cell) {
            Some(bush) => self.replay.bushes()[bush].burns(),
            None => {
                let state = self.ground.and_then(|ground| ground.state_at(cell, self.replay.time()));
                state.is_some_and(BushState::burns)
            }
        };
        let mut goals: Vec<Cell> = (0..self.agents.len())
            .filter(|&agent| self.agents[agent].is_truck())
            .filter_map(|agent| self.replay.goal(agent))
            .collect();
        // Sorted, so that equal goals are neighbours.
        goals.sort_unstable_by_key(|goal| (goal.row, goal.col));
        let counted = goals.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u32));
        counted.filter(|&(cell, _)| burns(cell)).collect()
    }
}

/// Returns the times at which the number of burning cells of ground changes while there are so few that all of them may
/// be another truck's or out of reach. Between others, each truck has something to go for, whichever cells burn.
fn scarce_times(timeline: &Timeline, ground: &GroundIndex) -> Vec<SimTime> {
    let ruled_out = timeline.events.iter().map(|event| match &event.fact {
        Fact::Agent(_, AgentFact::OutOfReach { cells }) => cells.iter().filter(|&&cell| ground.is_ground(cell)).count(),
        _ => 0,
    });
    // Each agent keeps at most one fire from the others.
    let enough = ruled_out.sum::<usize>() + timeline.setting.agents.len();
    let mut before = 0;
    let changes = ground.burning_counts().filter(|&(_, burning)| {
        // A change counts if there were few on either side of it.
        let fewest = burning.min(std::mem::replace(&mut before, burning));
        fewest as usize <= enough
    });
    changes.map(|(time, _)| time).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample::{self, A, B, C, D, TRUCK, at, ignited, leg, planned, seconds};
    use super::*;
    use crate::{AgentId, Cause, FireFact};

    /// All times at which facts, legs or charged planning begin or end, the end of the run last.
    fn instants(timeline: &Timeline) -> Vec<SimTime> {
        let end = timeline.end_time();
        let of_fact = |event: &Event| {
            let leg = event.fact.trajectory().map(|leg| [leg.start_time(), leg.end_time()]);
            let charge =
                if let Fact::Agent(_, AgentFact::PlanFailed { until, .. }) = event.fact { Some(until) } else { None };
            [event.time].into_iter().chain(leg.into_iter().flatten()).chain(charge).collect::<Vec<_>>()
        };
        let mut instants: Vec<_> = timeline.events.iter().flat_map(of_fact).filter(|&time| time <= end).collect();
        instants.extend([SimTime::ZERO, end]);
        instants.sort_unstable();
        instants.dedup();
        instants
    }

    #[test]
    fn the_outcome_agrees_with_a_look_at_every_state() {
        let stuck_s: f64 = (0..4).map(|seed| check_outcome(&sample::random(seed, seconds(400.0)))).sum();
        assert!(stuck_s > 0.0, "these runs cannot tell");
    }

    #[test]
    fn burning_ground_is_something_to_do_for_trucks() {
        for seed in 0..6 {
            let timeline = sample::random_on_ground(seed, seconds(900.0));
            let stuck_s = check_outcome(&timeline);
            let without = Timeline { ground: Vec::new(), ..timeline };
            assert!(stuck_s > Outcome::new(&without).truck_stuck_s, "this run cannot tell");
        }
    }

    /// Holds an outcome against the states at all times; returns how long trucks were stuck.
    fn check_outcome(timeline: &Timeline) -> f64 {
        let outcome = Outcome::new(timeline);
        let ruled_out = |agent: AgentId, cell: Cell, now: SimTime| {
            timeline.events.iter().take_while(|event| event.time <= now).any(|event| match &event.fact {
                Fact::Agent(of, AgentFact::OutOfReach { cells }) => *of == agent && cells.contains(&cell),
                _ => false,
            })
        };
        let ground = GroundIndex::new(timeline);
        let mut stuck_s = [0.0; 2];
        let mut idle_s = [0.0_f64; 2];
        let mut longest_idle_s = [0.0_f64; 2];
        let mut burning_cell_s = 0.0;
        let mut peak = 0;
        let mut instants = instants(timeline);
        let end = timeline.end_time();
        instants.extend(ground.iter().flat_map(GroundIndex::burning_counts).map(|(time, _)| time));
        instants.retain(|&time| time <= end);
        instants.sort_unstable();
        instants.dedup();
        for pair in instants.windows(2) {
            let state = timeline.state_at(pair[0]);
            let span_s = (pair[1] - pair[0]).as_seconds();
            let burning = state.bushes.iter().filter(|bush| bush.burns()).count();
            burning_cell_s += burning as f64 * span_s;
            peak = peak.max(burning);
            let bushes = || timeline.setting.bushes.iter().copied().zip(state.bushes.iter().copied());
            let burning_ground: Vec<Cell> = timeline
                .ground
                .iter()
                .map(|event| event.cell)
                .filter(|&cell| {
                    let state = ground.as_ref().and_then(|ground| ground.state_at(cell, pair[0]));
                    state.is_some_and(BushState::burns)
                })
                .collect();
            for (index, agent) in state.agents.iter().enumerate() {
                let wanted: Vec<Cell> = if agent.id.role.suppresses() {
                    let burning = bushes().filter(|(_, bush)| bush.burns()).map(|(cell, _)| cell);
                    burning.chain(burning_ground.iter().copied()).collect()
                } else {
                    bushes().filter(|(_, bush)| *bush == BushState::Intact).map(|(cell, _)| cell).collect()
                };
                let stands = agent.activity == Activity::Standing;
                if stands && wanted.iter().any(|&cell| !ruled_out(agent.id, cell, pair[0])) {
                    stuck_s[index] += span_s;
                }
                idle_s[index] = if stands && !wanted.is_empty() { idle_s[index] + span_s } else { 0.0 };
                longest_idle_s[index] = longest_idle_s[index].max(idle_s[index]);
            }
        }
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + b);
        assert!(close(outcome.burning_cell_s, burning_cell_s), "{} {burning_cell_s}", outcome.burning_cell_s);
        assert_eq!(outcome.peak_burning as usize, peak);
        for (index, agent) in outcome.agents.iter().enumerate() {
            assert!(close(agent.stuck_s, stuck_s[index]), "{agent:?} {stuck_s:?}");
            assert!(close(agent.longest_idle_s, longest_idle_s[index]), "{agent:?} {longest_idle_s:?}");
        }
        outcome.truck_stuck_s
    }

    #[test]
    fn distances_are_the_sums_of_what_was_driven() {
        for seed in 0..4 {
            let timeline = sample::random(seed, seconds(400.0));
            for agent in Outcome::new(&timeline).agents {
                let mut driven = vec![0.0];
                for event in timeline.events.iter().filter(|event| event.fact.agent() == Some(agent.agent)) {
                    match &event.fact {
                        Fact::Agent(_, AgentFact::Planned { trajectory, .. }) => {
                            driven.push(trajectory.distance_m(timeline.end_time()));
                        }
                        Fact::Agent(_, AgentFact::Dropped { trajectory, .. }) => {
                            *driven.last_mut().expect("it is never empty") = trajectory.distance_m(timeline.end_time());
                        }
                        _ => {}
                    }
                }
                let sum: f64 = driven.iter().sum();
                assert!((agent.distance_m - sum).abs() < 1e-6, "{} {sum}", agent.distance_m);
            }
        }
    }

    #[test]
    fn times_by_activity_add_up_to_the_whole_run() {
        for seed in 0..20 {
            let outcome = Outcome::new(&sample::random(seed, seconds(600.0)));
            for agent in &outcome.agents {
                let sum = [agent.driving_s, agent.planning_s, agent.suppressing_s, agent.standing_s, agent.waiting_s];
                let sum: f64 = sum.iter().sum();
                assert!((sum - outcome.ended_s).abs() < 1e-6, "{sum} of {}", outcome.ended_s);
                assert!(agent.stuck_s <= agent.standing_s && agent.longest_idle_s <= agent.standing_s);
            }
        }
    }

    #[test]
    fn states_and_numbers_at_any_time_are_those_of_a_replay() {
        for seed in 0..3 {
            let timeline = sample::random(seed, seconds(300.0));
            let run = RunIndex::new(&timeline);
            for time_s in [0.0, 17.3, 100.0, 299.999, 300.0, 1e6] {
                let time = seconds(time_s);
                let state = timeline.state_at(seconds(time_s));
                assert_eq!(run.state_at(time), state);
                let burning = state.bushes.iter().filter(|bush| bush.burns()).count();
                assert_eq!(run.counts_at(time).burning() as usize, burning, "at {time}");
                for (agent, state) in state.agents.iter().enumerate() {
                    assert_eq!(run.stats_at(agent, time).activity, state.activity);
                }
            }
            let end = run.end_time();
            for (agent, outcome) in run.outcome().agents.iter().enumerate() {
                let stats = run.stats_at(agent, end);
                assert_eq!(
                    (stats.distance_m, stats.plans, stats.cells),
                    (outcome.distance_m, outcome.plans, outcome.cells)
                );
            }
        }
    }

    fn caught(cell: Cell, from: Cell) -> Fact {
        Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(from) })
    }

    fn run(events: Vec<Event>) -> Timeline {
        Timeline { setting: sample::small_setting(&[TRUCK]), events, ground: Vec::new() }
    }

    #[test]
    fn what_burns_still_after_the_delay_spreads_once() {
        let timeline = run(vec![
            at(0.0, ignited(A)),
            at(1.0, ignited(B)),
            at(10.0, caught(C, A)),
            at(11.0, Fact::Fire(FireFact::Extinguished { cell: B, by: TRUCK })),
            at(40.0, Fact::Fire(FireFact::BurnedOut { cell: A })),
            at(89.0, ignited(D)),
        ]);
        let spread = |time_s: f64, from: Cell, caught: &[Cell]| SpreadMoment {
            time: seconds(time_s),
            from,
            caught: caught.to_vec(),
        };
        // What is put out at the very instant does not spread, nor does what caught fire; the last one lights nothing.
        let run = RunIndex::new(&timeline);
        assert_eq!(run.spreads, [spread(10.0, A, &[C]), spread(99.0, D, &[])]);
        assert_eq!(run.spreads_between(seconds(10.0), seconds(99.0)), &run.spreads[1..]);
        assert_eq!(run.spreads_between(seconds(5.0), seconds(10.0)), &run.spreads[..1]);
    }

    #[test]
    fn without_rules_only_what_ignited_something_has_spread() {
        let mut timeline =
            run(vec![at(0.0, ignited(A)), at(0.0, ignited(D)), at(7.0, caught(B, A)), at(7.0, caught(C, A))]);
        timeline.setting.rules.fire = None;
        let expected = SpreadMoment { time: seconds(7.0), from: A, caught: vec![B, C] };
        assert_eq!(RunIndex::new(&timeline).spreads, [expected]);
    }

    #[test]
    fn a_leg_is_followed_until_the_next_one() {
        let drive = |time_s: f64| at(time_s, planned(TRUCK, A, leg(time_s, Default::default(), 1.0, &[])));
        let timeline = run([5.0, 20.0, 40.0].map(drive).to_vec());
        let run = RunIndex::new(&timeline);
        assert!(run.leg_at(0, seconds(4.9)).is_none());
        for (time_s, from_s) in [(5.0, 5.0), (19.9, 5.0), (20.0, 20.0), (90.0, 40.0)] {
            assert_eq!(run.leg_at(0, seconds(time_s)).expect("there is one").from, seconds(from_s));
        }
        let between = run.legs_between(0, seconds(19.0), seconds(30.0)).map(|leg| leg.from);
        assert_eq!(between.collect::<Vec<_>>(), [seconds(20.0), seconds(5.0)]);
    }
}
