//! What a batch keeps of one run: its numbers, not its facts.

use std::fmt;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::execute::{CpuSplit, RunDetail};
use crate::plan::{RunLabel, value_differences};
use wildfire_sim::{PolicyTally, RunCost};
use wildfire_timeline::{AgentOutcome, Outcome};

/// The way in which a run ended.
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

/// One run of a batch.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunRow {
    pub label: RunLabel,
    pub status: Status,
    /// The reason why a run is not done, or messages of planners that are not built in about failed queries.
    pub message: String,
    /// The numbers of a run that is done.
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

    /// Says in what that is not measured another row of the same run differs from this one; `None` if in nothing.
    pub fn outcome_difference(&self, again: &Self) -> Option<String> {
        let is_other_detail =
            || (!self.detail.has_same_outcome(&again.detail)).then(|| "its planner calls or states differ".to_owned());
        self.difference(again).or_else(is_other_detail)
    }

    /// Says in which outcome another run of the same seed differs from this one; `None` if all are the same.
    pub fn difference(&self, again: &Self) -> Option<String> {
        let outcomes = [self, again].map(|row| {
            let outcome = row.result.as_ref().map(|result| &result.outcome);
            json!({ "status": row.status, "message": row.message, "outcome": outcome })
        });
        let first = value_differences(&outcomes[0], &outcomes[1]).into_iter().next()?;
        let [said, found] = first.values.map(|value| value.map_or("nothing".into(), |value| value.to_string()));
        let name = first.key.trim_start_matches("outcome.");
        Some(format!("its row has {name} {said}, its run gives {found}"))
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
    /// The asks of policies that are not built in; `None` where all are built in.
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
