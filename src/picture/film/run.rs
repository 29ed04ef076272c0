//! A run prepared for being shown.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::books::{AgentHistory, AgentStats};
use super::courses::AgentTracks;
use super::expenses::CpuHistory;
use super::history::{BushCounts, CountHistory};
use super::vegetation::BushStateHistory;
use crate::time::SimTime;
use crate::timeline::{AgentFact, AgentId, CpuSample, Event, Fact, State, Timeline};

/// Tells the runs shown by one process apart, those that are gone included; renderers know by it what they may keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunViewId(u64);

impl RunViewId {
    fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// A run prepared for being shown: its timeline, and what is derived from it once.
#[derive(Debug)]
pub struct RunView {
    id: RunViewId,
    title: String,
    timeline: Timeline,
    end: SimTime,
    expenses: Option<CpuHistory>,
    history: CountHistory,
    vegetation: BushStateHistory,
    books: Vec<AgentHistory>,
    /// When something happened, ascending.
    moments: Vec<SimTime>,
    has_searches: bool,
    courses: AgentTracks,
}

impl RunView {
    /// `cpu_samples` in order of time, where the run was simulated just now and is known. The title is the scenario's name.
    pub fn new(timeline: Timeline, cpu_samples: Option<Vec<CpuSample>>) -> Self {
        Self {
            id: RunViewId::next(),
            title: timeline.setting.scenario.clone(),
            end: timeline.end_time(),
            expenses: cpu_samples.as_deref().map(CpuHistory::new),
            history: CountHistory::new(&timeline),
            vegetation: BushStateHistory::new(&timeline),
            books: AgentHistory::from_timeline(&timeline),
            moments: moments(&timeline),
            has_searches: timeline
                .events
                .iter()
                .any(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. }))),
            courses: AgentTracks::new(&timeline),
            timeline,
        }
    }

    /// The same run under another title, which tells it apart from others of its scenario and seed.
    pub fn with_title(self, title: String) -> Self {
        Self { id: RunViewId::next(), title, ..self }
    }

    /// What the run is called, without its seed.
    pub fn title(&self) -> &str {
        &self.title
    }

    pub fn id(&self) -> RunViewId {
        self.id
    }

    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    pub(super) fn courses(&self) -> &AgentTracks {
        &self.courses
    }

    /// Whether it holds what searches looked at.
    pub fn has_searches(&self) -> bool {
        self.has_searches
    }

    pub fn end_time(&self) -> SimTime {
        self.end
    }

    /// When the last of some runs ends; zero of none.
    pub fn last_end(runs: &[&Self]) -> SimTime {
        runs.iter().map(|run| run.end).max().unwrap_or_default()
    }

    /// What [`Timeline::state_at`] says, without a replay.
    pub fn state_at(&self, time: SimTime) -> State {
        let time = time.min(self.end);
        let agents = self.timeline.setting.agents.iter().zip(&self.books);
        let agents = agents.map(|(start, book)| book.state_at(&self.timeline, start, time)).collect();
        State { time, bushes: self.vegetation.at(time), agents }
    }

    /// Counts after all facts at `time`.
    pub fn counts_at(&self, time: SimTime) -> BushCounts {
        self.history.counts_at(time)
    }

    /// What an agent, by its place in the setting, did until `time`.
    pub fn stats_at(&self, agent: usize, time: SimTime) -> AgentStats {
        self.books[agent].at(&self.timeline, time.min(self.end))
    }

    /// The facts that changed a bush, by its place in the setting, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = &Event> {
        self.history.changes_of(bush).map(|index| &self.timeline.events[index])
    }

    /// CPU time of all decisions up to a time; `None` where it is not known.
    pub fn cpu_until(&self, time: SimTime) -> Option<Duration> {
        Some(self.expenses.as_ref()?.until(time))
    }

    /// CPU time of an agent's decisions up to a time; `None` where it is not known.
    pub fn cpu_of_agent_until(&self, agent: AgentId, time: SimTime) -> Option<Duration> {
        Some(self.expenses.as_ref()?.of_agent_until(agent, time))
    }

    /// The next time after `time` at which something happens.
    pub fn next_event(&self, time: SimTime) -> Option<SimTime> {
        self.moments.get(self.moments.partition_point(|&moment| moment <= time)).copied()
    }

    /// The last time before `time` at which something happened.
    pub fn previous_event(&self, time: SimTime) -> Option<SimTime> {
        let before = self.moments.partition_point(|&moment| moment < time);
        before.checked_sub(1).map(|last| self.moments[last])
    }
}

/// The times of facts until the end; what a search looked at is no event.
fn moments(timeline: &Timeline) -> Vec<SimTime> {
    let end = timeline.end_time();
    let events =
        timeline.events.iter().filter(|event| !matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. })));
    let mut moments: Vec<SimTime> = events.map(|event| event.time).filter(|&time| time <= end).collect();
    moments.dedup();
    moments
}
