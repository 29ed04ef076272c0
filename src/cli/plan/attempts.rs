//! Every planner asked for every goal, with the cost of its answer.

use std::sync::Arc;
use std::time::Duration;

use crate::cli::plan::drive::{Drive, SecondOpinion};
use crate::collision::{ClearanceField, CollisionChecker};
use crate::planning::{PlanFailure, TruckPlannerKind};
use crate::scenario::{MemoryEstimate, MemoryExceeded, MemoryLimit, Problem, Unimog};
use crate::time::cpu::CpuStopwatch;

/// A planner's answer to one goal of a problem.
#[derive(Debug)]
pub struct Attempt<'a> {
    pub problem: &'a Problem,
    /// Its place in the problem's list.
    pub goal: usize,
    pub planner: TruckPlannerKind,
    /// CPU time of the clearance field and of the planner's own preparation, the same for all goals of a problem.
    pub build: Duration,
    /// CPU time of the query.
    pub query: Duration,
    pub expansions: u64,
    pub drive: Result<Drive, PlanFailure>,
}

/// All planners on all goals of a problem, goal by goal.
///
/// Random streams have the names that a run's first truck has, so that both plan alike.
///
/// # Errors
/// If they would take more memory than the limit.
pub fn attempts<'a>(
    problem: &'a Problem,
    planners: &[TruckPlannerKind],
    seed: u64,
    limit: MemoryLimit,
) -> Result<Vec<Attempt<'a>>, MemoryExceeded> {
    let estimate = MemoryEstimate::from_problem(problem, planners);
    estimate.meter(limit)?;
    let mut stopwatch = CpuStopwatch::start();
    let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
    let checker = CollisionChecker::new(field, problem.truck.vehicle);
    let field_time = stopwatch.lap();
    let opinion = SecondOpinion::new(problem, &checker);
    let mut by_planner = Vec::new();
    for &planner in planners {
        let memory = estimate.meter(limit)?;
        let truck = Unimog { planner, ..problem.truck.clone() };
        let mut stopwatch = CpuStopwatch::start();
        let mut prepared = truck.build_planner(&checker, &memory, seed, 0);
        let build = field_time + stopwatch.lap();
        let mut attempts = Vec::new();
        for (goal, &target) in problem.goals.iter().enumerate() {
            // The time spent on measuring the last path is not part of this query.
            stopwatch.lap();
            let plan = prepared.plan(problem.start, target);
            let query = stopwatch.lap();
            let expansions = u64::from(plan.effort.roadmap_expansions) + u64::from(plan.effort.local_expansions);
            let drive = plan.path.map(|path| opinion.drive(target, path));
            attempts.push(Attempt { problem, goal, planner, build, query, expansions, drive });
        }
        by_planner.push(attempts.into_iter());
        // Each planner is gone when the next is made: its memory is no longer taken.
        drop(prepared);
        estimate.overrun(&memory, limit).map_or(Ok(()), Err)?;
    }
    let next_of_each = |_| by_planner.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>();
    Ok((0..problem.goals.len()).flat_map(next_of_each).collect())
}
