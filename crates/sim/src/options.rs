//! The options of a run, and the reasons why one cannot take place.

use std::fmt;
use std::sync::Arc;

use thiserror::Error;

use super::policies::Policies;
use wildfire_planning::{MakeError, PlannerName, Planners};
use wildfire_scenario::{MemoryExceeded, MemoryLimit, Scenario, TerrainError};
use wildfire_timeline::AgentId;

/// The options of a run. Apart from registered planners and policies, they do not change its outcome.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// The planners by name.
    pub planners: Planners,
    /// True if the timeline also holds what the searches examined, as
    /// [`AgentFact::Searched`](wildfire_timeline::AgentFact::Searched). CPU times then include the recording.
    pub records_searches: bool,
    /// The policies by name.
    pub policies: Policies,
    /// The starter of the programs that a scenario names; without it none is started.
    pub programs: Option<Arc<dyn StartPrograms>>,
    /// The memory limit. A run that would need more does not take place, or ends early, with [`RunError::Memory`].
    pub memory: MemoryLimit,
}

/// The registered planners and policies, besides the built-in ones.
#[derive(Clone, Debug, Default)]
pub struct CustomRegistry {
    pub planners: Planners,
    pub policies: Policies,
    /// The starter of the programs that a scenario names; without it none is started.
    pub programs: Option<Arc<dyn StartPrograms>>,
}

/// Makes planners and policies of the programs that a scenario's tables name.
pub trait StartPrograms: fmt::Debug + Send + Sync {
    /// Adds the planners and policies of a scenario's tables, for the run of a seed, to those that are known otherwise.
    ///
    /// # Errors
    /// If a name is taken, or somebody does not want a program to run; in words.
    fn add(
        &self,
        scenario: &Scenario,
        planners: Planners,
        policies: Policies,
    ) -> Result<(Planners, Policies), MakeError>;
}

impl From<Planners> for CustomRegistry {
    fn from(planners: Planners) -> Self {
        Self { planners, ..Self::default() }
    }
}

impl From<Policies> for CustomRegistry {
    fn from(policies: Policies) -> Self {
        Self { policies, ..Self::default() }
    }
}

impl RunOptions {
    /// Returns the planners and policies of a run, those of programs among them.
    pub(super) fn registry_of(&self, scenario: &Scenario) -> Result<(Planners, Policies), RunError> {
        let planners = self.planners.clone();
        let policies = self.policies.clone();
        match &self.programs {
            Some(programs) => {
                let added = programs.add(scenario, planners, policies);
                added.map_err(|reason| RunError::NoPrograms { reason })
            }
            None => Ok((planners, policies)),
        }
    }
}

impl From<CustomRegistry> for RunOptions {
    fn from(CustomRegistry { planners, policies, programs }: CustomRegistry) -> Self {
        Self { planners, policies, programs, ..Self::default() }
    }
}

/// The reason why a run could not take place.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    #[error(transparent)]
    Memory(#[from] MemoryExceeded),
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error(transparent)]
    NotForked(#[from] NotForked),
    #[error("`{key}` cannot change in the middle of a run; planners of trucks, their settings, and policies can")]
    FixedInRun { key: String },
    #[error("the policy `{name}` could not be made: {reason}")]
    NoPolicy { name: PlannerName, reason: MakeError },
    #[error("its programs could not be used: {reason}")]
    NoPrograms { reason: MakeError },
    #[error("{agent} cannot start: no free place was found for it on this field")]
    NoFreeStart { agent: AgentId },
    /// The run was stopped before its end. It has no result and has to be run again.
    #[error("the run was stopped before its end")]
    Stopped,
    #[error("{agent} has no planner: `{name}` could not be built: {reason}")]
    NoPlanner { agent: AgentId, name: PlannerName, reason: MakeError },
}

/// The reason why a run has no forks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the policy {0} runs outside this program and cannot be copied in the middle of a run")]
pub struct NotForked(pub(super) String);
