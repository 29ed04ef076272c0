//! The planner `hybrid-astar`: a search over a lattice of poses with Reeds-Shepp curves as analytic expansions.
//!
//! All of it is the [`RelaxedSearch`] of the kit, which other planners fall back on.
//!
//! Poses are those of the rear axle, positions in a goal disc those of the body's centre; world frame, metres.

mod settings;

pub use settings::HybridSettings;

use crate::kit::drive_cost::{CostModel, DriveCost};
use crate::kit::lattice::Lattice;
use crate::kit::path_improvement::Improvement;
use crate::kit::relaxed_search::{RelaxedSearch, RelaxedSettings};
use crate::kit::target::Target;
use crate::observer::{NullObserver, PlanningObserver, PlanningWork};
use crate::registry::{BuiltInPlanner, Charge, PlannerContext, TruckPlannerSettings};
use crate::{BuildReport, Effort, Goal, GoalDisc, NearestPlan, Plan, TruckPlanner};
use wildfire_base::geometry::Pose;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::Path;

/// The planner for one body on one field.
#[derive(Debug)]
pub struct HybridAstar(RelaxedSearch);

impl HybridSettings {
    fn improvement(&self) -> Improvement {
        Improvement { shortcuts: self.shortcuts, pulls: self.pulls }
    }

    /// Returns the settings of the search for a truck.
    pub fn search(&self, cost: DriveCost, limits: &SpeedLimits) -> RelaxedSettings {
        RelaxedSettings {
            clearance_m: self.clearance_m,
            lattice: Lattice { bin_m: self.bin_m, headings: self.headings, step_m: self.step_m },
            cost: CostModel::new(cost, limits, self.cusp_cost),
            heuristic_weight: self.heuristic_weight,
            improvement: self.improvement(),
            first_expansions: self.first_expansions,
            max_expansions: self.max_expansions,
        }
    }
}

impl HybridAstar {
    /// The stream `shortcuts` decides which shortcuts are tried; every query draws the same numbers.
    pub fn build(context: &PlannerContext<'_>) -> Self {
        let settings = context.settings.hybrid.search(context.cost, context.limits);
        Self(RelaxedSearch::new(context.checker, context.memory, settings, (context.stream)("shortcuts")))
    }
}

impl TruckPlanner for HybridAstar {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        self.plan_into(start, Target::from(&goal.with_margin()), observer)
    }

    fn plan_to_nearest(
        &mut self,
        start: Pose,
        discs: &[GoalDisc],
        observer: &mut dyn PlanningObserver,
    ) -> Option<NearestPlan> {
        let discs: Vec<GoalDisc> = discs.iter().map(|disc| disc.with_margin()).collect();
        let plan = self.plan_into(start, Target::Discs(&discs), observer);
        let end = plan.path.as_ref().map_or(start, Path::end);
        Some(NearestPlan { index: Target::Discs(&discs).disc_of(end, self.0.body()), plan })
    }
}

impl HybridAstar {
    fn plan_into(&mut self, start: Pose, target: Target<'_>, observer: &mut dyn PlanningObserver) -> Plan {
        observer.begins(Some(PlanningWork::Local));
        let found = self.0.find(start, target, observer);
        observer.begins(None);
        Plan::new(found, Effort { roadmap_expansions: 0, local_expansions: self.0.expansions() })
    }
}

/// Makes planners of the name `hybrid-astar`.
pub struct HybridAstarFactory;

impl BuiltInPlanner for HybridAstarFactory {
    fn make(&self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner> {
        Box::new(HybridAstar::build(context))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["hybrid"]
    }

    fn knows_time(&self) -> bool {
        true
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: 0.0, local_s: settings.hybrid.seconds_per_expansion }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::holonomic::HolonomicHeuristic;
    use crate::memory::MemoryMeter;
    use crate::registry::OwnedSettings;
    use crate::test_fields::{TestField, drives_in_a_row, drives_to_poses, paths_that_keep, shut_court};
    use crate::{GoalDisc, PlanFailure};
    use glam::DVec2;

    fn planner(field: &TestField, seed: u64) -> HybridAstar {
        field.make(&OwnedSettings::default(), seed, HybridAstar::build)
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_hardly_where_the_flood_says_yes() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(8, walks, |field, seed| Box::new(planner(field, seed)));
            assert!(drives.solved + drives.unreachable >= 143 && drives.missed <= 1, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn drives_to_poses_end_there_and_are_no_shorter_than_on_an_empty_field() {
        let solved = drives_to_poses(8, 10, |field, seed| Box::new(planner(field, seed)));
        assert!(solved >= 76, "{solved} of 80");
    }

    #[test]
    fn the_wanted_clearance_is_kept_where_start_and_goal_have_it() {
        let kept = paths_that_keep(0.75, |field, seed| Box::new(planner(field, seed)));
        assert!(kept > 15, "{kept} paths keep it");
    }

    #[test]
    fn what_is_walled_in_is_disconnected_and_what_takes_too_long_spends_the_budget() {
        let field = shut_court();
        let mut planner = planner(&field, 1);
        let court = Pose::new(60.0, 25.0, 0.0);
        for goal in [Goal::Pose(court), Goal::Disc(GoalDisc { centre: court.position(), radius_m: 4.0 })] {
            assert_eq!(planner.plan(field.start, goal).path, Err(PlanFailure::Disconnected));
        }
        let hybrid = HybridSettings { max_expansions: 1, ..HybridSettings::default() };
        let mut hasty = field.make(&OwnedSettings { hybrid, ..OwnedSettings::default() }, 1, HybridAstar::build);
        let behind = Goal::Pose(Pose::new(88.0, 25.0, 1.0));
        let plan = hasty.plan(field.start, behind);
        assert_eq!((plan.path, plan.effort.local_expansions), (Err(PlanFailure::BudgetSpent), 1));
    }

    #[test]
    fn no_path_is_shorter_than_a_walker_is_promised() {
        for seed in 0..6 {
            let mut field = TestField::random(seed, 45);
            let mut planner = planner(&field, seed);
            for _ in 0..8 {
                let disc = field.random_goal();
                let start = field.checker.body().body_centre(field.start);
                let mut walk = HolonomicHeuristic::new(&MemoryMeter::unlimited());
                walk.begin(field.checker.field(), Target::Discs(&[disc]), start);
                let promised = walk.cost_to_go_m(field.checker.field(), start);
                if let Ok(path) = planner.plan(field.start, disc.into()).path {
                    assert!(promised <= path.length_m() + 1e-9, "{promised} m, but {} m", path.length_m());
                }
            }
        }
    }

    #[test]
    fn a_blocked_goal_takes_no_effort() {
        let field = TestField::random(2, 25);
        for wild in [f64::NAN, f64::INFINITY, -1e300, 1e9, -5.0] {
            let disc = GoalDisc { centre: DVec2::new(wild, 20.0), radius_m: 3.0 };
            let plan = planner(&field, 2).plan(field.start, disc.into());
            assert_eq!((plan.path, plan.effort), (Err(PlanFailure::GoalBlocked), Effort::default()), "{wild}");
        }
    }
}
