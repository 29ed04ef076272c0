//! Planners and policies that are not built in, as scenarios write them: tables `[planner.NAME]` and `[policy.NAME]`.
//!
//! A table with a `command` says how to start a program. One without says that the planner or policy of this name is
//! handed in by whoever runs the scenario, from Rust or from Python; its `settings` are passed on all the same. Reading
//! a scenario never starts anything.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::check::{Check, TablePath};
use super::goal::{TruckGoal, WumpusGoal};
use super::or_none;
use crate::input_file::list_of_at_most;
use crate::planning::PlannerName;
use crate::planning::registry::Charge;

/// The tables by the names that they give.
pub type Programs = BTreeMap<PlannerName, Program>;

/// The most tables of a scenario.
const MAX_PROGRAMS: usize = 100;

/// The most words of a command, and files of a table.
const MAX_WORDS: usize = 1000;

/// A planner or a policy that is not built in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Program {
    /// The program and its arguments; no shell is run. The program is found by `PATH`, or, if it has a slash, from the
    /// scenario's folder, which is also the program's working folder.
    #[serde(deserialize_with = "list_of_at_most::<MAX_WORDS, _, _>")]
    pub command: Vec<String>,
    /// Files whose contents belong to a batch's plan; those that `command` names always do.
    #[serde(deserialize_with = "list_of_at_most::<MAX_WORDS, _, _>")]
    pub files: Vec<PathBuf>,
    /// Handed on as they are.
    pub settings: Map<String, Value>,
    /// Wall clock from the start until it is ready, building included.
    pub start_limit_s: f64,
    /// Wall clock of a query.
    pub query_limit_s: f64,
    /// CPU seconds of its whole process group in a query; `"none"`: no limit.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub query_cpu_s: Option<f64>,
    /// Of its process group.
    pub memory_limit_mb: u32,
    /// Simulated planning time for each expansion that an answer reports.
    pub seconds_per_expansion: f64,
    /// How often it is started again in one run.
    pub restarts: u32,
    /// One process for all runs of a worker instead of one for each run.
    pub reuse: bool,
}

impl Default for Program {
    fn default() -> Self {
        Self {
            command: Vec::new(),
            files: Vec::new(),
            settings: Map::new(),
            start_limit_s: 30.0,
            query_limit_s: 10.0,
            query_cpu_s: None,
            memory_limit_mb: 2048,
            seconds_per_expansion: 0.0,
            restarts: 3,
            reuse: false,
        }
    }
}

impl Program {
    /// Returns the simulated time that its expansions cost.
    pub fn charge(&self) -> Charge {
        Charge { roadmap_s: self.seconds_per_expansion, local_s: self.seconds_per_expansion }
    }

    /// Describes it in a sentence; `kind` is planner or policy.
    pub(super) fn describe(&self, kind: &str, name: &PlannerName) -> String {
        if self.command.is_empty() {
            format!("Its {kind} `{name}` is handed in by whoever runs the scenario.")
        } else {
            format!("Its {kind} `{name}` is a program that only runs where it is trusted: {}.", self.command.join(" "))
        }
    }
}

/// Checks the tables of one kind, `planner` or `policy`.
pub(super) fn check_programs(kind: &str, programs: &Programs) -> Check {
    let all = TablePath::named(kind);
    TablePath::named("").count(kind, programs.len(), MAX_PROGRAMS)?;
    for (name, program) in programs {
        if kind == "planner" && name.built_in().is_some() {
            let expected = "a name of its own: this one is a built-in planner's".to_owned();
            return all.refuse(name.name(), "a table".into(), expected);
        }
        if kind == "policy" && (TruckGoal::is_built_in(name.name()) || WumpusGoal::is_built_in(name.name())) {
            let expected = "a name of its own: this one is a built-in policy's".to_owned();
            return all.refuse(name.name(), "a table".into(), expected);
        }
        let table = all.inner(name.name());
        if program.command.first().is_some_and(String::is_empty) {
            return table.refuse("command", "a list that begins with an empty text".into(), "a program's name".into());
        }
        table.number("start_limit_s", program.start_limit_s, 0.01..=3600.0)?;
        table.number("query_limit_s", program.query_limit_s, 0.01..=3600.0)?;
        table.optional("query_cpu_s", program.query_cpu_s, 0.001..=3600.0)?;
        table.number("memory_limit_mb", program.memory_limit_mb.into(), 1.0..=1e6)?;
        table.number("seconds_per_expansion", program.seconds_per_expansion, 0.0..=1000.0)?;
        table.number("restarts", program.restarts.into(), 0.0..=1000.0)?;
    }
    Ok(())
}
