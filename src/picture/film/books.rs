//! What each agent did so far, at any time.

use crate::geometry::Cell;
use crate::time::SimTime;
use crate::timeline::{Activity, AgentFact, AgentStart, AgentState, Event, Fact, FireFact, Replay, Timeline};

/// What an agent did until some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgentStats {
    pub activity: Activity,
    /// By activity, in the order of its variants.
    spent: [SimTime; 5],
    /// Queries for a plan, failed ones included.
    pub plans: u32,
    pub failures: u32,
    /// Index of the fact of the last failure.
    pub last_failure: Option<usize>,
    /// Nodes expanded by all queries.
    pub expansions: u64,
    /// Cells lit, or extinguished, by this agent.
    pub cells: u32,
    /// Driven or walked, in metres.
    pub distance_m: f64,
}

impl AgentStats {
    pub fn spent(&self, activity: Activity) -> SimTime {
        self.spent[activity as usize]
    }
}

/// What an agent did until a time at which something changed, and the leg that it follows from then on.
#[derive(Clone, Copy, Debug)]
struct Entry {
    time: SimTime,
    stats: AgentStats,
    goal: Option<Cell>,
    /// Index of the fact that the leg comes with.
    leg: Option<usize>,
}

/// What one agent did, over time.
#[derive(Debug)]
pub struct AgentHistory {
    /// Ascending in time, the first at zero.
    entries: Vec<Entry>,
}

impl AgentHistory {
    /// Of all agents of a run, in the order of its setting.
    pub fn from_timeline(timeline: &Timeline) -> Vec<Self> {
        let mut replay = Replay::new(timeline);
        let mut books: Vec<Self> = timeline.setting.agents.iter().map(|_| Self::opened()).collect();
        let mut seen = 0;
        for changes in changes(timeline).chunk_by(|one, other| one.0 == other.0) {
            let time = changes[0].0;
            replay.seek(time);
            for index in seen..replay.facts_so_far() {
                let event = &timeline.events[index];
                if let Some(agent) = event.fact.agent().and_then(|id| timeline.setting.agent_index(id)) {
                    books[agent].record(timeline, index, event);
                }
            }
            seen = replay.facts_so_far();
            for &(_, agent) in changes {
                books[agent].turn_to(timeline, time, (replay.activity(agent), replay.goal(agent)));
            }
        }
        books
    }

    /// Until `time`, which is not after the end.
    pub fn at(&self, timeline: &Timeline, time: SimTime) -> AgentStats {
        self.last_entry(time).later(timeline, time).stats
    }

    /// An agent as [`Timeline::state_at`] has it, at a time that is not after the end.
    pub fn state_at(&self, timeline: &Timeline, start: &AgentStart, time: SimTime) -> AgentState {
        let &Entry { stats, goal, leg, .. } = self.last_entry(time);
        let leg = leg.and_then(|index| timeline.events[index].fact.trajectory());
        let (pose, speed_mps) = leg.map_or((start.pose, 0.0), |leg| leg.state_at(time));
        AgentState { id: start.id, pose, speed_mps, activity: stats.activity, goal }
    }

    fn last_entry(&self, time: SimTime) -> &Entry {
        &self.entries[self.entries.partition_point(|entry| entry.time <= time) - 1]
    }

    fn opened() -> Self {
        let stats = AgentStats {
            activity: Activity::Standing,
            spent: [SimTime::ZERO; 5],
            plans: 0,
            failures: 0,
            last_failure: None,
            expansions: 0,
            cells: 0,
            distance_m: 0.0,
        };
        Self { entries: vec![Entry { time: SimTime::ZERO, stats, goal: None, leg: None }] }
    }

    /// The entry for a time that is not before the last one.
    fn entry(&mut self, timeline: &Timeline, time: SimTime) -> &mut Entry {
        let last = self.entries[self.entries.len() - 1];
        if last.time < time {
            self.entries.push(last.later(timeline, time));
        }
        self.entries.last_mut().expect("a book has an entry for time zero")
    }

    fn record(&mut self, timeline: &Timeline, index: usize, event: &Event) {
        let entry = self.entry(timeline, event.time);
        let stats = &mut entry.stats;
        match &event.fact {
            Fact::Agent(_, AgentFact::Planned { effort, .. })
            | Fact::Agent(_, AgentFact::PlanFailed { effort, .. }) => {
                stats.plans += 1;
                stats.expansions += u64::from(effort.roadmap_expansions) + u64::from(effort.local_expansions);
            }
            Fact::Fire(FireFact::Ignited { .. }) | Fact::Fire(FireFact::Extinguished { .. }) => stats.cells += 1,
            _ => {}
        }
        if let Fact::Agent(_, AgentFact::PlanFailed { .. }) = event.fact {
            stats.failures += 1;
            stats.last_failure = Some(index);
        }
        if event.fact.trajectory().is_some() {
            entry.leg = Some(index);
        }
    }

    fn turn_to(&mut self, timeline: &Timeline, time: SimTime, (activity, goal): (Activity, Option<Cell>)) {
        let last = &self.entries[self.entries.len() - 1];
        if (last.stats.activity, last.goal) != (activity, goal) {
            let entry = self.entry(timeline, time);
            (entry.stats.activity, entry.goal) = (activity, goal);
        }
    }
}

impl Entry {
    /// The same at a later time until which nothing changed.
    fn later(&self, timeline: &Timeline, time: SimTime) -> Self {
        let mut later = Self { time, ..*self };
        later.stats.spent[self.stats.activity as usize] += time.since(self.time);
        if let Some(leg) = self.leg.and_then(|index| timeline.events[index].fact.trajectory()) {
            later.stats.distance_m += leg.distance_m(time) - leg.distance_m(self.time);
        }
        later
    }
}

/// All times until the end at which a fact or an activity of an agent may change, with its place in the setting;
/// ascending.
fn changes(timeline: &Timeline) -> Vec<(SimTime, usize)> {
    let end = timeline.end_time();
    let mut changes = Vec::new();
    for event in &timeline.events {
        let Some(agent) = event.fact.agent().and_then(|id| timeline.setting.agent_index(id)) else { continue };
        let leg = event.fact.trajectory().map(|leg| [leg.start_time(), leg.sets_out_at(), leg.end_time()]);
        let times = leg.into_iter().flatten().chain([event.time]);
        changes.extend(times.map(|time| (time, agent)));
        if let Fact::Agent(_, AgentFact::PlanFailed { until, .. }) = event.fact {
            changes.push((until, agent));
        }
    }
    changes.retain(|&(time, _)| time <= end);
    changes.sort_unstable();
    changes.dedup();
    changes
}
