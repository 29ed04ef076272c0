//! What commands have besides their arguments: whether to be quiet, and the planners that were handed in.

use crate::planning::Planners;
use crate::scenario::MemoryLimit;
use crate::sim::RunOptions;

/// What commands have besides their arguments.
#[derive(Clone, Debug, Default)]
pub struct CommandContext {
    pub quiet: bool,
    /// Planners by name.
    pub planners: Planners,
}

impl CommandContext {
    /// Adds to the changes of a scenario that the planners that were handed in are known.
    pub fn with_own_names(&self, changes: &[String]) -> Vec<String> {
        let declared = self.planners.own_names().map(|name| format!("planner.{name}.command=[]"));
        declared.chain(changes.iter().cloned()).collect()
    }

    /// Returns the options of a run.
    pub fn run_options(&self, records_searches: bool, memory: MemoryLimit) -> RunOptions {
        RunOptions { planners: self.planners.clone(), records_searches, memory }
    }
}
