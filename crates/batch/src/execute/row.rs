//! The row of a run in a batch: its numbers, not its facts.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::execute::{CpuSplit, RunDetail};
use crate::plan::RunLabel;
use wildfire_scenario::value_differences;
use wildfire_sim::{PolicyTally, RunCost};
use wildfire_timeline::{AgentOutcome, Outcome};

/// The result status of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    Done,
    /// The run could not take place, or not be recorded as requested; the message gives the reason.
    Failed,
    /// The program has a bug; the message gives the command that reproduces it.
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

/// One run of a batch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunRow {
    pub label: RunLabel,
    pub status: Status,
    /// The reason why a run is not done, or messages of custom planners about failed queries.
    pub message: String,
    /// The numbers of a run that is done.
    pub result: Option<RunResult>,
    /// The real time of the run.
    pub wall: Duration,
    /// The details; empty unless requested.
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

    /// Creates a run without a result, with the reason.
    pub fn not_done(label: RunLabel, status: Status, message: String, wall: Duration) -> Self {
        Self { label, status, message, result: None, wall, detail: RunDetail::default() }
    }

    /// Describes the first difference from another row of the same run in what is not measured; `None` if there is
    /// none.
    pub fn outcome_difference(&self, again: &Self) -> Option<String> {
        let is_other_detail =
            || (!self.detail.has_same_outcome(&again.detail)).then(|| "its planner calls or states differ".to_owned());
        self.difference(again).or_else(is_other_detail)
    }

    /// Describes the first difference in outcomes from another run of the same seed; `None` if there is none.
    pub fn difference(&self, again: &Self) -> Option<String> {
        let outcomes = [self, again].map(|row| {
            let outcome = row.result.as_ref().map(|result| &result.outcome);
            json!({ "status": row.status, "message": row.message, "outcome": outcome })
        });
        let first = value_differences(&outcomes[0], &outcomes[1]).into_iter().next()?;
        let [stored, found] = first.values.map(|value| value.map_or("nothing".into(), |value| value.to_string()));
        let name = first.key.trim_start_matches("outcome.");
        Some(format!("its row has {name} {stored}, its run gives {found}"))
    }
}

/// The numbers of a finished run.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Measured")]
pub struct RunResult {
    pub outcome: Outcome,
    pub cost: RunCost,
    /// The CPU time by phase, derived from the cost.
    #[serde(skip_serializing)]
    pub cpu: CpuSplit,
    /// The questions to custom policies; `None` where all are built in.
    pub asks: Option<PolicyTally>,
}

/// A result as it is read.
#[derive(Deserialize)]
struct Measured {
    outcome: Outcome,
    cost: RunCost,
    /// Missing in journals of older programs.
    #[serde(default)]
    asks: Option<PolicyTally>,
}

impl From<Measured> for RunResult {
    fn from(measured: Measured) -> Self {
        Self { asks: measured.asks, ..Self::new(measured.outcome, measured.cost) }
    }
}

impl RunResult {
    pub fn new(outcome: Outcome, cost: RunCost) -> Self {
        let cpu = CpuSplit::from_cost(&cost);
        Self { outcome, cost, cpu, asks: None }
    }

    pub fn trucks(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| agent.agent.role.suppresses())
    }

    pub fn wumpuses(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| agent.agent.role.lights())
    }
}
