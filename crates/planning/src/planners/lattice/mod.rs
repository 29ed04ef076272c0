//! The planner `lattice`: a flood over a lattice of poses, slow, and complete at its resolution.
//!
//! The flood of [`crate::kit::floods`] spreads from the start over one lattice after the other until it meets
//! the goal: over bins of 10 m and 24 headings, of 5 m and 24 headings, and of 1.25 m and 72 headings. A no means: not at
//! the finest resolution, or not through any passage as wide as the body. Paths are drivable, and not short.

mod settings;

pub use settings::LatticeSettings;

use crate::kit::floods::{FloodQuery, FloodSearch};
use crate::observer::{NullObserver, PlanningObserver, PlanningWork};
use crate::registry::{BuiltInPlanner, Charge, PlannerContext, TruckPlannerSettings};
use crate::{BuildReport, Effort, Found, FoundBy, Goal, Plan, TruckPlanner};
use wildfire_base::geometry::Pose;

/// The planner for one body on one field.
#[derive(Debug)]
pub struct LatticePlanner {
    search: FloodSearch,
    max_expansions: u32,
}

impl LatticePlanner {
    pub fn build(context: &PlannerContext<'_>) -> Self {
        let search = FloodSearch::new(context.checker, context.memory);
        Self { search, max_expansions: context.settings.lattice.max_expansions }
    }
}

impl TruckPlanner for LatticePlanner {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        observer.begins(Some(PlanningWork::Local));
        let query = FloodQuery { budget: self.max_expansions, ..FloodQuery::new(start, goal.with_margin()) };
        let mut local_expansions = 0;
        let path = self.search.find_within(&query, observer, &mut local_expansions);
        observer.begins(None);
        let found = path.map(|path| Found { path, by: FoundBy::Lattice });
        Plan::new(found, Effort { roadmap_expansions: 0, local_expansions })
    }
}

/// Makes planners of the name `lattice`.
pub struct LatticeFactory;

impl BuiltInPlanner for LatticeFactory {
    fn make(&self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner> {
        Box::new(LatticePlanner::build(context))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["lattice"]
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: 0.0, local_s: settings.lattice.seconds_per_expansion }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::registry::{OwnedSettings, TruckPlannerKind};
    use crate::test_fields::{
        TestField, assert_ends_in, drives_in_a_row, least_clearance, random_free_pose, shut_court,
    };
    use crate::{GoalDisc, PlanFailure};

    fn planner(field: &TestField) -> LatticePlanner {
        with_budget(field, LatticeSettings::default().max_expansions)
    }

    fn with_budget(field: &TestField, max_expansions: u32) -> LatticePlanner {
        let lattice = LatticeSettings { max_expansions, ..LatticeSettings::default() };
        field.make(&OwnedSettings { lattice, ..OwnedSettings::default() }, 0, LatticePlanner::build)
    }

    #[test]
    fn drives_in_a_row_reach_whatever_the_flood_reaches() {
        let drives = drives_in_a_row(4, 45, |field, _| Box::new(planner(field)));
        assert!(drives.missed == 0 && drives.solved > 60, "{drives:?}");
    }

    #[test]
    fn poses_and_places_that_another_planner_reaches_are_reached() {
        let mut reached = 0;
        for seed in 0..6 {
            let mut field = TestField::random(seed, 40);
            let mut lattice = planner(&field);
            let other = TruckPlannerKind::HybridAstar.maker();
            let mut hybrid = field.make(&OwnedSettings::default(), seed, |context| other.make(context));
            for _ in 0..10 {
                let pose = random_free_pose(&mut field, 0.1);
                let place = GoalDisc { centre: field.checker.body().body_centre(pose), radius_m: 0.0 };
                for goal in [Goal::Pose(pose), Goal::Disc(place)] {
                    match lattice.plan(field.start, goal).path {
                        Ok(path) => {
                            assert_ends_in(&field.checker, &path, goal);
                            assert!(least_clearance(&field.checker, &path) > 0.0);
                            reached += 1;
                        }
                        Err(_) => assert!(hybrid.plan(field.start, goal).path.is_err(), "seed {seed}: {goal:?}"),
                    }
                }
            }
        }
        assert!(reached > 100, "{reached} of 120");
    }

    #[test]
    fn answers_and_effort_do_not_depend_on_previous_queries() {
        let mut field = TestField::random(3, 40);
        let mut goals: Vec<Goal> = (0..6).map(|_| Goal::Disc(field.random_goal())).collect();
        goals.extend((0..4).map(|_| Goal::Pose(random_free_pose(&mut field, 0.3))));
        let mut kept = planner(&field);
        for &goal in goals.iter().chain(goals.iter().rev()) {
            let plan = kept.plan(field.start, goal);
            let fresh = planner(&field).plan(field.start, goal);
            assert_eq!((plan.path, plan.effort), (fresh.path, fresh.effort));
        }
    }

    #[test]
    fn what_is_walled_in_is_disconnected_after_the_coarsest_flood() {
        let field = shut_court();
        let mut planner = planner(&field);
        let court = Pose::new(60.0, 25.0, 0.0);
        for goal in [Goal::Pose(court), Goal::Disc(GoalDisc { centre: court.position(), radius_m: 4.0 })] {
            let plan = planner.plan(field.start, goal);
            assert_eq!(plan.path, Err(PlanFailure::Disconnected));
            assert!((1..2_000).contains(&plan.effort.local_expansions), "{:?}", plan.effort);
        }
    }

    #[test]
    fn failures_have_their_reasons() {
        let field = shut_court();
        let mut planner = planner(&field);
        let bush = Pose::new(42.0, 40.0, 0.0);
        let disc = |centre, radius_m| Goal::Disc(GoalDisc { centre, radius_m });
        let mut reason = |start, goal| planner.plan(start, goal).path.err();
        assert_eq!(reason(bush, Goal::Pose(field.start)), Some(PlanFailure::StartBlocked));
        assert_eq!(reason(field.start, Goal::Pose(bush)), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, disc(bush.position(), 0.5)), Some(PlanFailure::GoalBlocked));
        for wild in [f64::NAN, f64::INFINITY, -1e300] {
            assert_eq!(reason(field.start, disc(DVec2::new(wild, 5.0), 3.0)), Some(PlanFailure::GoalBlocked));
            let pose = Pose { x: wild, y: 5.0, heading: 0.0 };
            assert_eq!(reason(field.start, Goal::Pose(pose)), Some(PlanFailure::GoalBlocked));
            assert_eq!(reason(pose, Goal::Pose(field.start)), Some(PlanFailure::StartBlocked));
        }
        let behind = Goal::Pose(Pose::new(88.0, 25.0, 1.0));
        let plan = with_budget(&field, 3).plan(field.start, behind);
        assert_eq!((plan.path, plan.effort.local_expansions), (Err(PlanFailure::BudgetSpent), 3));
    }

    #[test]
    fn a_budget_that_just_suffices_gives_the_same_path() {
        let mut field = TestField::random(5, 40);
        for _ in 0..8 {
            let goal = Goal::Disc(field.random_goal());
            let ample = planner(&field).plan(field.start, goal);
            let spent = ample.effort.local_expansions;
            if ample.path.is_err() || spent == 0 {
                continue;
            }
            let with = |budget| with_budget(&field, budget).plan(field.start, goal);
            assert_eq!(with(spent).path, ample.path);
            // A curve from near the goal may still lead into it.
            let less = with(spent - 1);
            assert_eq!(less.effort.local_expansions, spent - 1);
            assert!(less.path.is_ok() || less.path == Err(PlanFailure::BudgetSpent));
        }
    }
}
