//! A query without its path: all that tables, logs and benchmarks keep of an attempt.

use std::sync::Arc;

use crate::cli::plan::attempts::Attempt;
use crate::planning::PlanFailure;
use crate::planning::judge::DriveFigures;

/// A question to a planner, what the answer cost and what it is worth.
#[derive(Clone, Debug)]
pub struct Query {
    /// `None` in a table without seeds.
    pub seed: Option<u64>,
    /// Its place among the variants.
    pub variant: usize,
    pub field: Arc<str>,
    pub goal: usize,
    pub planner: Arc<str>,
    pub cpu_build_s: f64,
    pub cpu_query_s: f64,
    pub expansions: u64,
    pub outcome: Result<DriveFigures, PlanFailure>,
}

impl Query {
    pub fn new(attempt: &Attempt<'_>, seed: Option<u64>, variant: usize) -> Self {
        Self {
            seed,
            variant,
            field: attempt.problem.name.as_str().into(),
            goal: attempt.goal,
            planner: attempt.planner.name().into(),
            cpu_build_s: attempt.build.as_secs_f64(),
            cpu_query_s: attempt.query.as_secs_f64(),
            expansions: attempt.expansions,
            outcome: attempt.drive.as_ref().map(|drive| drive.figures).map_err(|reason| *reason),
        }
    }
}
