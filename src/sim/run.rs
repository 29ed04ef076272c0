//! What goes into a run beside its scenario, and what comes out of it.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::scenario::{MemoryExceeded, MemoryLimit, TerrainError};
use super::policies::Policies;
use crate::timeline::{AgentId, CpuSample, Timeline};

/// CPU time of one agent's planning over a run. What does not concern its kind is zero.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AgentCost {
    pub agent: AgentId,
    /// The truck's roadmap: drawing samples, and connecting them.
    pub sampling: Duration,
    pub connecting: Duration,
    pub roadmap_search: Duration,
    /// The truck's local search, or the Wumpus's search.
    pub local_search: Duration,
    /// Reachability floods and the lattice searches that follow them.
    pub reachability: Duration,
}

impl AgentCost {
    /// Creates the account of an agent that has not planned anything.
    pub fn new(agent: AgentId) -> Self {
        let zero = Duration::ZERO;
        Self { agent, sampling: zero, connecting: zero, roadmap_search: zero, local_search: zero, reachability: zero }
    }

    pub fn total(&self) -> Duration {
        self.sampling + self.connecting + self.roadmap_search + self.local_search + self.reachability
    }
}

/// CPU time of a run; never part of its outcome.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RunCost {
    pub terrain: Duration,
    pub clearance_field: Duration,
    /// In the order of the timeline's agents.
    pub agents: Vec<AgentCost>,
    pub total: Duration,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// What happened.
    pub timeline: Timeline,
    /// CPU time, by part.
    pub cost: RunCost,
    /// The same by decision, in order of time: first one entry an agent for building its planner, then one for every
    /// decision that took some.
    pub cpu_samples: Vec<CpuSample>,
}

/// The options of a run. They change nothing that happens in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// True if the timeline also holds what the searches looked at, as
    /// [`AgentFact::Searched`](crate::timeline::AgentFact::Searched). CPU times include recording it.
    pub records_searches: bool,
    /// The policies by name.
    pub policies: Policies,
    /// The limit of memory. A run that would take more does not take place, or ends early, as [`RunError::Memory`].
    pub memory: MemoryLimit,
}

/// Why a run could not take place.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    #[error(transparent)]
    Memory(#[from] MemoryExceeded),
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error("the policy `{name}` could not be made: {reason}")]
    NoPolicy { name: PlannerName, reason: MakeError },
    #[error("{agent} cannot start: no free place was found for it on this field")]
    NoFreeStart { agent: AgentId },
}
