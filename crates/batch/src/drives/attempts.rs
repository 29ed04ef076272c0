//! Attempts: every planner's answer to every goal, and its cost.

use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;

use crate::drives::checked::{Drive, DriveAudit};
use crate::drives::query::{DriveFailure, DriveQuery, QueryCost};
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_planning::collision::{ClearanceField, CollisionChecker};
use wildfire_planning::{MakeError, PlanFailure, PlannerName, Planners};
use wildfire_scenario::{
    GroundKinds, MemoryEstimate, MemoryExceeded, MemoryLimit, Problem, Programs, TruckPlannerContext, Unimog,
};

/// A planner's answer to one goal of a problem.
#[derive(Debug)]
pub struct Attempt<'a> {
    pub problem: &'a Problem,
    /// Its place in the problem's list.
    pub goal: usize,
    pub planner: PlannerName,
    /// CPU time of the clearance field and of the planner's own preparation, equal for all goals of a problem.
    pub build: Duration,
    /// CPU time of the query.
    pub query: Duration,
    pub expansions: u64,
    pub drive: Result<Drive, PlanFailure>,
    /// A message about a failure besides its reason.
    pub message: Option<String>,
}

impl Attempt<'_> {
    /// Returns the attempt without its path.
    pub fn query(&self, seed: Option<u64>, variant: usize) -> DriveQuery {
        let drive = self.drive.as_ref();
        DriveQuery {
            seed,
            variant,
            field: self.problem.name.as_str().into(),
            goal: self.goal,
            planner: self.planner.name().into(),
            cost: Some(QueryCost {
                cpu_build_s: self.build.as_secs_f64(),
                cpu_query_s: self.query.as_secs_f64(),
                expansions: self.expansions,
            }),
            figures: drive.ok().map(|drive| drive.figures),
            failure: drive.err().copied().map(DriveFailure::Planner),
            violation: drive.ok().and_then(|drive| drive.violation.as_deref()).map(Into::into),
            certified_bound_m: None,
            message: self.message.as_deref().map(Into::into),
        }
    }
}

/// The planners of a query, and its conditions.
#[derive(Clone, Copy)]
pub struct AttemptSettings<'a> {
    pub planners: &'a [PlannerName],
    /// The makers of custom planners.
    pub makers: &'a Planners,
    /// The programs among them.
    pub programs: &'a Programs,
    pub seed: u64,
    pub limit: MemoryLimit,
}

/// The reason why no planner was asked.
#[derive(Debug, Error)]
pub enum AttemptError {
    #[error(transparent)]
    Memory(#[from] MemoryExceeded),
    #[error("the planner `{name}` could not be built: {reason}")]
    NoPlanner { name: PlannerName, reason: MakeError },
}

/// Asks all planners for all goals of a problem, goal by goal.
///
/// Random streams have the names that a run's first truck has, so that both plan alike.
///
/// # Errors
/// If they would take more memory than the limit, or one of them cannot be built.
pub fn attempts<'a>(problem: &'a Problem, question: &AttemptSettings<'_>) -> Result<Vec<Attempt<'a>>, AttemptError> {
    let &AttemptSettings { planners, makers, programs, seed, limit } = question;
    let estimate = MemoryEstimate::from_problem(problem, planners);
    // Refused before anything is built.
    estimate.meter(limit)?;
    let mut stopwatch = CpuStopwatch::start();
    // All planners share one field, as building it takes longer than most queries.
    let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
    let checker = CollisionChecker::new(field, problem.truck.vehicle);
    let field_time = stopwatch.elapsed_since_last();
    let opinion = DriveAudit::new(problem, &checker);
    let kinds = GroundKinds::new(&problem.terrain);
    let mut by_planner = Vec::new();
    for planner in planners {
        // A meter for each planner, as they are built one after the other.
        let memory = estimate.meter(limit)?;
        let truck = Unimog { planner: planner.clone(), ..problem.truck.clone() };
        let mut stopwatch = CpuStopwatch::start();
        let ground = truck.ground_speed(kinds.as_ref());
        let context = TruckPlannerContext {
            // The number of a run's first truck names the random streams, see above.
            truck: 0,
            seed,
            checker: &checker,
            ground: ground.as_ref(),
            memory: &memory,
            planners: makers,
            programs,
        };
        let mut prepared =
            truck.make_planner(&context).map_err(|reason| AttemptError::NoPlanner { name: planner.clone(), reason })?;
        // The field is built once, but every planner needs it.
        let build = field_time + stopwatch.elapsed_since_last();
        let mut attempts = Vec::new();
        for (goal, &target) in problem.goals.iter().enumerate() {
            // The time spent on measuring the last path is not part of this query.
            stopwatch.elapsed_since_last();
            let plan = prepared.plan(problem.start, target);
            let spent = stopwatch.elapsed_since_last();
            // A planner that is an external program measures its own time, which this process's clock does not see.
            let query = plan.cpu.map_or(spent, |cpu| cpu.time);
            let expansions = u64::from(plan.effort.roadmap_expansions) + u64::from(plan.effort.local_expansions);
            let drive = plan.path.map(|path| opinion.drive(target, path));
            let planner = planner.clone();
            let message = plan.message;
            attempts.push(Attempt { problem, goal, planner, build, query, expansions, drive, message });
        }
        by_planner.push(attempts.into_iter());
        // Each planner is gone when the next is made: its memory is no longer taken.
        drop(prepared);
        // A planner may exceed its estimate while it answers, and its memory is checked before the next one is built.
        estimate.overrun(&memory, limit).map_or(Ok(()), |exceeded| Err(AttemptError::from(exceeded)))?;
    }
    // Rows are by goal and then by planner, while planners were built one by one.
    Ok((0..problem.goals.len())
        .flat_map(|_| by_planner.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>())
        .collect())
}
