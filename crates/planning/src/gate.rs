//! The gate, which checks the path of a custom planner before the truck drives it.
//!
//! A planner that is not built in may be wrong in any way. Whatever it answers, the truck only drives a path that the
//! [`Judge`] lets pass: one that begins where the truck stands, keeps the least clearance of all paths, turns no sharper
//! than the truck can, and ends in the goal. What does not pass is a failed query, with words that say where it is wrong.
//!
//! The gate also measures: the CPU time of the planner is what the thread's clock says around the call, unless the
//! planner says where else it was spent; the gate's own time is in neither.
//!
//! And it counts: a query counts for the expansions that the answer reports, or for the calls of the checker, whichever
//! is more, so that a planner which reports nothing is charged all the same.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use wildfire_base::geometry::Pose;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::vehicle::Path;

use super::judge::Judge;
use super::observer::PlanningObserver;
use super::registry::{MakeError, PlannerContext, PlannerFactory};
use super::{BuildReport, CpuSource, Effort, Goal, NullObserver, Plan, PlanFailure, QueryCpu, TruckPlanner};

/// The share by which a curvature may exceed the truck's before it counts as sharper: what single precision loses. It is
/// set to the truck's own.
const CURVATURE_ROUNDING: f64 = 1e-6;

/// A planner behind the gate.
pub struct ValidatedPlanner {
    planner: Box<dyn TruckPlanner>,
    report: BuildReport,
    judge: Judge,
    /// The sharpest curvature of the truck, 1/m.
    sharpest: f64,
    /// Calls of the checker that the planner has.
    calls: Arc<AtomicU64>,
}

impl ValidatedPlanner {
    /// Makes a planner and measures the time that it takes.
    ///
    /// # Errors
    /// If it cannot be built.
    pub fn build(maker: &dyn PlannerFactory, context: &PlannerContext<'_>) -> Result<Self, MakeError> {
        let mut stopwatch = CpuStopwatch::start();
        let calls = Arc::default();
        let checker = context.checker.counting(&calls);
        let planner = maker.make(&PlannerContext { checker: &checker, ..*context })?;
        let making = stopwatch.elapsed_since_last();
        let report = planner.build_report();
        // What it measured itself is part of that.
        let sampling = Duration::ZERO;
        let connecting = Duration::ZERO;
        let report = BuildReport { sampling, connecting, starting: making + report.elsewhere, ..report };
        // The judge has the checker that does not count: its queries are not the planner's effort.
        let judge = Judge::new(context.checker.clone());
        let sharpest = context.body.max_curvature();
        Ok(Self { planner, report, judge, sharpest, calls })
    }

    /// Lets a plan pass, or says why its path must not be driven.
    fn judged(&self, start: Pose, goal: Goal, mut plan: Plan) -> Plan {
        let Ok(path) = &mut plan.path else { return plan };
        // Before the judge, who allows no curvature beyond the truck's.
        self.forgive_rounding(path);
        match self.judge.check(start, goal, path) {
            Ok(()) => plan,
            Err(bad) => {
                Plan { path: Err(PlanFailure::BadAnswer), found_by: None, message: Some(bad.to_string()), ..plan }
            }
        }
    }

    /// Sets curvatures that exceed the truck's by rounding to the truck's.
    fn forgive_rounding(&self, path: &mut Path) {
        for segment in &mut path.segments {
            let curvature = segment.curvature.abs();
            if curvature > self.sharpest && curvature <= self.sharpest * (1.0 + CURVATURE_ROUNDING) {
                segment.curvature = self.sharpest.copysign(segment.curvature);
            }
        }
    }
}

impl TruckPlanner for ValidatedPlanner {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        let mut stopwatch = CpuStopwatch::start();
        let calls = self.calls.load(Ordering::Relaxed);
        // A planner of somebody else's costs a query when it panics, and never a run.
        let result = catch_unwind(AssertUnwindSafe(|| self.planner.plan_observed(start, goal, observer)));
        let mut plan = result.unwrap_or_else(|panic| Plan::failed(PlanFailure::Crashed, panic_message(&*panic)));
        let time = stopwatch.elapsed_since_last();
        plan.cpu.get_or_insert(QueryCpu { time, starting: Duration::ZERO, source: CpuSource::Thread });
        // What it says of its effort is charged and added up: a lie must not overflow.
        let calls = (self.calls.load(Ordering::Relaxed) - calls).div_ceil(CALLS_OF_EXPANSION);
        let counted = u32::try_from(calls).unwrap_or(u32::MAX).min(MAX_EXPANSIONS);
        plan.effort = Effort { roadmap_expansions: 0, local_expansions: total_expansions(plan.effort).max(counted) };
        self.judged(start, goal, plan)
    }

    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn show_roadmap(&mut self, observer: &mut dyn PlanningObserver) {
        self.planner.show_roadmap(observer);
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let message = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!("it panicked: {}", message.unwrap_or("without words"))
}

/// Calls of the checker that count as one expansion: those of `hybrid-astar`, which tries six motions for each.
const CALLS_OF_EXPANSION: u64 = 8;

/// The most expansions of one query that are believed.
const MAX_EXPANSIONS: u32 = 1_000_000_000;

fn total_expansions(effort: Effort) -> u32 {
    effort.roadmap_expansions.saturating_add(effort.local_expansions).min(MAX_EXPANSIONS)
}
