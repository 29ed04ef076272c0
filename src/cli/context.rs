//! What commands have besides their arguments: whether to be quiet, and the planners and policies that were handed in.

use crate::scenario::MemoryLimit;
use crate::sim::{Entrants, RunOptions};

/// What commands have besides their arguments.
#[derive(Clone, Debug, Default)]
pub struct CommandContext {
    pub quiet: bool,
    /// Planners and policies by name.
    pub entrants: Entrants,
}

impl CommandContext {
    /// Adds to the changes of a scenario that the planners and policies that were handed in are known.
    pub fn with_own_names(&self, changes: &[String]) -> Vec<String> {
        let Entrants { planners, policies } = &self.entrants;
        let declared = planners.own_names().map(|name| format!("planner.{name}.command=[]"));
        let declared = declared.chain(policies.own_names().map(|name| format!("policy.{name}.command=[]")));
        declared.chain(changes.iter().cloned()).collect()
    }

    /// Returns the options of a run.
    pub fn run_options(&self, records_searches: bool, memory: MemoryLimit) -> RunOptions {
        RunOptions { records_searches, memory, ..self.entrants.clone().into() }
    }
}
