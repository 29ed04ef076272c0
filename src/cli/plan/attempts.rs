//! What every planner answers to every goal, and what that costs.

use std::sync::Arc;
use std::time::Duration;

use crate::cli::plan::drive::{Drive, Judge};
use crate::collision::{ClearanceField, CollisionChecker};
use crate::planning::{PlanFailure, TruckPlannerKind, truck_planner};
use crate::rng;
use crate::scenario::Problem;
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
pub fn attempts<'a>(problem: &'a Problem, planners: &[TruckPlannerKind], seed: u64) -> Vec<Attempt<'a>> {
    let mut stopwatch = CpuStopwatch::start();
    let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
    let checker = CollisionChecker::new(field, problem.truck.vehicle);
    let field_time = stopwatch.lap();
    let judge = Judge::new(problem, &checker);
    let all = planners.iter().map(|&planner| attempts_by(planner, problem, &checker, field_time, &judge, seed));
    let mut all: Vec<_> = all.map(Vec::into_iter).collect();
    (0..problem.goals.len()).flat_map(|_| all.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>()).collect()
}

fn attempts_by<'a>(
    planner: TruckPlannerKind,
    problem: &'a Problem,
    checker: &CollisionChecker,
    field_time: Duration,
    judge: &Judge,
    seed: u64,
) -> Vec<Attempt<'a>> {
    let stream = |use_of_chance: &str| rng::stream(seed, &format!("truck/0/{use_of_chance}"));
    let mut stopwatch = CpuStopwatch::start();
    let mut prepared = truck_planner(planner, checker, &problem.truck.planner_settings(), stream);
    let build = field_time + stopwatch.lap();
    let attempt = |(goal, &target)| {
        stopwatch.lap();
        let plan = prepared.plan(problem.start, target);
        let query = stopwatch.lap();
        let expansions = u64::from(plan.effort.roadmap_expansions) + u64::from(plan.effort.local_expansions);
        let drive = plan.path.map(|path| judge.drive(target, path));
        Attempt { problem, goal, planner, build, query, expansions, drive }
    };
    problem.goals.iter().enumerate().map(attempt).collect()
}
