//! The choice of the goal that is nearest by drive.

use glam::DVec2;

use super::{Effort, GoalDisc, Plan, PlanningObserver, QueryCpu, TruckPlanner};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dimensions, Path};

/// A drive into one of some discs.
#[derive(Clone, Debug)]
pub struct NearestPlan {
    /// The disc's.
    pub index: usize,
    pub plan: Plan,
}

/// Plans a drive into whichever of some discs is nearest by drive; the effort and the CPU time of the plan are those of the
/// whole search. If no path leads into any of them, the plan is the failure of the nearest in a
/// straight line; without discs, `None`.
///
/// A planner that cannot search for several goals at once is asked for one after the other, the nearest in a straight line
/// first, until that line is longer than the shortest drive.
pub fn plan_to_nearest(
    planner: &mut dyn TruckPlanner,
    body: &Dimensions,
    start: Pose,
    discs: &[GoalDisc],
    observer: &mut dyn PlanningObserver,
) -> Option<NearestPlan> {
    if discs.is_empty() {
        return None;
    }
    if let Some(answer) = planner.plan_to_nearest(start, discs, observer) {
        return Some(answer);
    }
    let mut order: Vec<(f64, usize)> =
        discs.iter().enumerate().map(|(index, disc)| (min_m(body, start, disc), index)).collect();
    // A stable sort, so that discs at equal distances keep their order.
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<NearestPlan> = None;
    let (mut effort, mut cpu) = (Effort::default(), None);
    for (min_m, index) in order {
        if best.as_ref().and_then(|best| length_m(&best.plan)).is_some_and(|best_m| min_m >= best_m) {
            break;
        }
        let plan = planner.plan_observed(start, discs[index].into(), observer);
        effort += plan.effort;
        cpu = sum(cpu, plan.cpu);
        let is_better = match (&best, length_m(&plan)) {
            // A failure is kept until there is something better: that of the nearest is the answer if all fail.
            (None, _) => true,
            (Some(_), None) => false,
            (Some(best), Some(metres)) => length_m(&best.plan).is_none_or(|best_m| metres < best_m),
        };
        if is_better {
            best = Some(NearestPlan { index, plan });
        }
    }
    best.map(|NearestPlan { index, plan }| NearestPlan { index, plan: Plan { effort, cpu, ..plan } })
}

fn length_m(plan: &Plan) -> Option<f64> {
    plan.path.as_ref().ok().map(Path::length_m)
}

/// Returns what no drive into a disc is shorter than: the rear axle drives at least as far as it has to come nearer.
fn min_m(body: &Dimensions, start: Pose, disc: &GoalDisc) -> f64 {
    let gap = |from: DVec2| from.distance(disc.centre) - disc.radius_m;
    if gap(body.body_centre(start)) <= 0.0 { 0.0 } else { (gap(start.position()) - body.centre_offset_m()).max(0.0) }
}

/// Adds CPU times; the sum is worth as much as the one of the two that is worth less.
fn sum(one: Option<QueryCpu>, other: Option<QueryCpu>) -> Option<QueryCpu> {
    match (one, other) {
        (Some(one), Some(other)) => Some(QueryCpu {
            time: one.time + other.time,
            starting: one.starting + other.starting,
            source: one.source.max(other.source),
        }),
        (one, other) => one.or(other),
    }
}
