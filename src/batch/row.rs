//! What a batch keeps of one run: its numbers, not its facts.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::batch::plan::{MAX_SWEPT_KEYS, planner_of};
use crate::batch::{CpuSplit, RunDetail, Value};
use crate::input_file::list_of_at_most;
use crate::scenario::Scenario;
use crate::sim::RunCost;
use crate::timeline::{AgentOutcome, Outcome};

/// How a run went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    Done,
    /// It could not take place, or not be recorded as asked; the message says why.
    Failed,
    /// The program has a fault; the message gives the command that shows it again.
    Panicked,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Panicked => "panicked",
        })
    }
}

/// Which run of a batch this is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunLabel {
    /// From 1, in the order of the plan.
    pub run: u64,
    pub scenario: String,
    pub seed: u64,
    /// Of the trucks; empty without any.
    pub planner: String,
    /// A value for each key that the batch sweeps.
    #[serde(deserialize_with = "list_of_at_most::<MAX_SWEPT_KEYS, _, _>")]
    pub swept: Vec<Value>,
}

impl RunLabel {
    /// Of a run that is none of a batch.
    pub fn alone(scenario: &Scenario, seed: u64) -> Self {
        let planner = planner_of(scenario);
        Self { run: 1, scenario: scenario.name.clone(), seed, planner, swept: Vec::new() }
    }
}

/// One run of a batch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunRow {
    pub label: RunLabel,
    pub status: Status,
    /// Empty of a run that is done.
    pub message: String,
    /// Of runs that are done.
    pub result: Option<RunResult>,
    /// Real time that the run took.
    pub wall: Duration,
    /// Empty unless it is asked for.
    #[serde(default)]
    pub detail: RunDetail,
}

impl RunRow {
    pub fn done(label: RunLabel, result: RunResult, wall: Duration) -> Self {
        Self {
            label,
            status: Status::Done,
            message: String::new(),
            result: Some(result),
            wall,
            detail: RunDetail::default(),
        }
    }

    /// A run without a result, and why.
    pub fn not_done(label: RunLabel, status: Status, message: String, wall: Duration) -> Self {
        Self { label, status, message, result: None, wall, detail: RunDetail::default() }
    }
}

/// Numbers of a run that is done.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Measured")]
pub struct RunResult {
    pub outcome: Outcome,
    pub cost: RunCost,
    /// Follows from the cost.
    #[serde(skip_serializing)]
    pub cpu: CpuSplit,
}

/// A result as it is read.
#[derive(Deserialize)]
struct Measured {
    outcome: Outcome,
    cost: RunCost,
}

impl From<Measured> for RunResult {
    fn from(measured: Measured) -> Self {
        Self::new(measured.outcome, measured.cost)
    }
}

impl RunResult {
    pub fn new(outcome: Outcome, cost: RunCost) -> Self {
        let cpu = CpuSplit::of(&cost);
        Self { outcome, cost, cpu }
    }

    pub fn trucks(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| agent.agent.role.suppresses())
    }

    pub fn wumpuses(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| agent.agent.role.lights())
    }
}
