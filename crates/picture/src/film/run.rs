//! A run prepared for display.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use crate::Rgb;
use crate::colours::{BURNING, EXTINGUISHED, FAINT_INK};
use wildfire_base::time::SimTime;
use wildfire_timeline::{
    AgentId, AgentState, AgentStats, BushCounts, CpuHistory, CpuSample, Event, RunIndex, State, Timeline,
};

/// Tells the runs shown by one process apart, those that are gone included; renderers know by it what they may keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunViewId(u64);

impl RunViewId {
    fn next() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// Runs with more agents than this are told of by sums, since a panel has no room for all of them one by one, and their numbers
/// are written where there is room.
const MAX_ONE_BY_ONE: usize = 8;

/// The verdict on a decision of an agent, as `wildfire why` finds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No other choice is significantly better, and not all are worse.
    Neutral,
    /// Every other choice is significantly worse.
    Good,
    /// Another choice is significantly better.
    Mistake,
}

impl Verdict {
    /// All verdicts, in the order in which their marks are drawn: those that matter most lie on top.
    pub const ALL: [Self; 3] = [Self::Neutral, Self::Good, Self::Mistake];

    /// Returns the colour of its marks.
    pub fn colour(self) -> Rgb {
        match self {
            Self::Neutral => FAINT_INK,
            Self::Good => EXTINGUISHED,
            Self::Mistake => BURNING,
        }
    }
}

/// A run prepared for being shown: its state at any time, its title, and what its decisions cost.
#[derive(Debug)]
pub struct RunView {
    id: RunViewId,
    title: String,
    index: RunIndex<'static>,
    cpu: Option<CpuHistory>,
    verdicts: Vec<(SimTime, Verdict)>,
}

impl RunView {
    /// `cpu_samples` in order of time, where the run was simulated just now and is known. The title is the scenario's name.
    pub fn new(timeline: Timeline, cpu_samples: Option<Vec<CpuSample>>) -> Self {
        Self {
            id: RunViewId::next(),
            title: timeline.setting.scenario.clone(),
            index: timeline.into(),
            cpu: cpu_samples.as_deref().map(CpuHistory::new),
            verdicts: Vec::new(),
        }
    }

    /// The same run under another title, which tells it apart from others of its scenario and seed.
    pub fn with_title(self, title: String) -> Self {
        Self { id: RunViewId::next(), title, ..self }
    }

    /// The same run with verdicts on decisions, which are drawn above its counts; in order of time.
    pub fn with_verdicts(self, verdicts: Vec<(SimTime, Verdict)>) -> Self {
        Self { id: RunViewId::next(), verdicts, ..self }
    }

    /// Lists the verdicts on decisions, if there are any.
    pub fn verdicts(&self) -> &[(SimTime, Verdict)] {
        &self.verdicts
    }

    /// What the run is called, without its seed.
    pub fn title(&self) -> &str {
        &self.title
    }

    pub fn id(&self) -> RunViewId {
        self.id
    }

    /// The state of the run at any time.
    pub fn index(&self) -> &RunIndex<'static> {
        &self.index
    }

    pub fn timeline(&self) -> &Timeline {
        self.index.timeline()
    }

    /// Returns whether it has more agents than can be told of one by one.
    pub fn is_crowded(&self) -> bool {
        self.timeline().setting.agents.len() > MAX_ONE_BY_ONE
    }

    /// Returns whether ground burns and no arsonist lights bushes: such a run is told in hectares.
    pub fn is_of_ground(&self) -> bool {
        let setting = &self.timeline().setting;
        let has_arsonist = setting.agents.iter().any(|agent| agent.id.role.lights());
        self.index.ground().is_some() && (setting.bushes.is_empty() || !has_arsonist)
    }

    /// Returns the area of so many cells of its ground, in hectares.
    pub fn hectares(&self, cells: u32) -> f64 {
        let cell_m = self.timeline().setting.frame.cell_m;
        f64::from(cells) * cell_m * cell_m / 1e4
    }

    pub fn end_time(&self) -> SimTime {
        self.index.end_time()
    }

    /// When the last of some runs ends; zero of none.
    pub fn last_end(runs: &[&Self]) -> SimTime {
        runs.iter().map(|run| run.end_time()).max().unwrap_or_default()
    }

    pub fn state_at(&self, time: SimTime) -> State {
        self.index.state_at(time)
    }

    /// The state of one agent, by its place in the setting.
    pub fn agent_at(&self, agent: usize, time: SimTime) -> AgentState {
        self.index.agent_at(agent, time)
    }

    pub fn counts_at(&self, time: SimTime) -> BushCounts {
        self.index.counts_at(time)
    }

    /// What an agent, by its place in the setting, did until `time`.
    pub fn stats_at(&self, agent: usize, time: SimTime) -> AgentStats {
        self.index.stats_at(agent, time)
    }

    /// The facts that changed a bush, by its place in the setting, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = &Event> {
        self.index.changes_of(bush)
    }

    /// CPU time of all decisions up to a time; `None` where it is not known.
    pub fn cpu_until(&self, time: SimTime) -> Option<Duration> {
        Some(self.cpu.as_ref()?.until(time))
    }

    /// CPU time of an agent's decisions up to a time; `None` where it is not known.
    pub fn cpu_of_agent_until(&self, agent: AgentId, time: SimTime) -> Option<Duration> {
        Some(self.cpu.as_ref()?.of_agent_until(agent, time))
    }
}
