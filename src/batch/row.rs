//! What a batch keeps of one run: its numbers, not its facts.

use std::fmt;
use std::time::Duration;

use crate::batch::CpuSplit;
use crate::sim::RunCost;
use crate::timeline::{AgentId, AgentOutcome, Outcome};

/// How a run went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Debug)]
pub struct RunRow {
    pub scenario: String,
    pub seed: u64,
    pub status: Status,
    /// Empty of a run that is done.
    pub message: String,
    /// Of runs that are done.
    pub result: Option<RunResult>,
    /// Real time that the run took.
    pub wall: Duration,
}

impl RunRow {
    pub fn done(scenario: &str, seed: u64, result: RunResult, wall: Duration) -> Self {
        Self {
            scenario: scenario.into(),
            seed,
            status: Status::Done,
            message: String::new(),
            result: Some(result),
            wall,
        }
    }

    /// A run without a result, and why.
    pub fn not_done(scenario: &str, seed: u64, status: Status, message: String, wall: Duration) -> Self {
        Self { scenario: scenario.into(), seed, status, message, result: None, wall }
    }
}

/// Numbers of a run that is done.
#[derive(Clone, Debug)]
pub struct RunResult {
    pub outcome: Outcome,
    pub cost: RunCost,
    pub cpu: CpuSplit,
}

impl RunResult {
    pub fn new(outcome: Outcome, cost: RunCost) -> Self {
        let cpu = CpuSplit::of(&cost);
        Self { outcome, cost, cpu }
    }

    pub fn trucks(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| matches!(agent.agent, AgentId::Unimog(_)))
    }

    pub fn wumpuses(&self) -> impl Iterator<Item = &AgentOutcome> {
        self.outcome.agents.iter().filter(|agent| matches!(agent.agent, AgentId::Wumpus(_)))
    }
}
