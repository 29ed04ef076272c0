use std::sync::Arc;

use glam::DVec2;
use rand::Rng;

use crate::collision::{CollisionChecker, LEAST_CLEARANCE_M};
use crate::geometry::{Pose, ops};
use crate::time::cpu::CpuStopwatch;
use crate::vehicle::Path;

use super::primitives::LocalSearch;
use super::prm::{Roadmap, RoadmapScratch, Route};
use super::{
    BuildReport, Effort, Goal, GoalDisc, Plan, PlanFailure, PrimitiveSettings, PrmSettings, QueryTime, RoadmapGoal,
    Safety, SafetySettings, TruckPlanner,
};

/// The planner `prm+primitives`: a roadmap gives waypoints, motion primitives make a drivable path of them.
#[derive(Debug)]
pub struct PrmPrimitives {
    checker: CollisionChecker,
    roadmap: Roadmap,
    scratch: RoadmapScratch,
    local: LocalSearch,
    goal: RoadmapGoal,
    thin_waypoints: bool,
    search_alone: bool,
    waypoint_tolerance_m: f64,
    report: BuildReport,
}

impl PrmPrimitives {
    /// Builds the roadmap for a field and a body; `rng` decides where the milestones lie. `safety` prices its edges and
    /// the motions along them.
    pub fn build(
        checker: &CollisionChecker,
        prm: &PrmSettings,
        primitives: &PrimitiveSettings,
        safety: &SafetySettings,
        rng: &mut impl Rng,
    ) -> Self {
        let mut watch = CpuStopwatch::start();
        let field = checker.field();
        let safety = Safety::new(*field.frame(), field.occupied(), safety).map(Arc::new);
        let sampled = Roadmap::sampled(checker, prm, rng).priced_by(safety.clone());
        let sampling = watch.lap();
        let roadmap = sampled.connected();
        let report = BuildReport {
            samples: roadmap.milestones().len() as u32,
            draws: roadmap.draws(),
            edges: roadmap.edge_count(),
            components: roadmap.component_count(),
            sampling,
            connecting: watch.lap(),
        };
        Self {
            checker: checker.clone(),
            roadmap,
            scratch: RoadmapScratch::default(),
            local: LocalSearch::new(checker, primitives, safety),
            goal: prm.goal,
            thin_waypoints: primitives.thin_waypoints,
            search_alone: primitives.search_alone,
            waypoint_tolerance_m: primitives.waypoint_tolerance_m,
            report,
        }
    }

    pub fn roadmap(&self) -> &Roadmap {
        &self.roadmap
    }

    fn find(&mut self, start: Pose, goal: GoalDisc, time: &mut QueryTime) -> Result<Path, PlanFailure> {
        if self.checker.clearance(start) <= 0.0 {
            return Err(PlanFailure::StartBlocked);
        }
        let goal = goal.inner();
        let centre = self.checker.body().body_centre(start);
        if self.goal == RoadmapGoal::InReach && centre.distance(goal.centre) <= goal.radius_m {
            return Ok(Path::standing(start));
        }
        let mut watch = CpuStopwatch::start();
        let route = self.route(centre, goal);
        time.roadmap = watch.lap();
        let path = route.and_then(|route| {
            let last = *route.waypoints.last().expect("a route ends with a waypoint");
            let end = match self.goal {
                RoadmapGoal::InReach => goal,
                RoadmapGoal::NearestMilestone => GoalDisc { centre: last, radius_m: self.waypoint_tolerance_m },
            };
            self.local.drive(start, &route.waypoints, end)
        });
        let path = match path {
            Err(PlanFailure::Disconnected | PlanFailure::BudgetSpent) if self.search_alone => {
                self.local.drive(start, &[], goal)
            }
            other => other,
        };
        time.local = watch.lap();
        path.map_err(|failure| self.explain(failure, goal))
    }

    fn route(&mut self, centre: DVec2, goal: GoalDisc) -> Result<Route, PlanFailure> {
        let mut route = self.roadmap.route(centre, goal, &mut self.scratch)?;
        if self.thin_waypoints {
            self.roadmap.tighten(centre, &mut route);
        }
        Ok(route)
    }

    /// The reason of a failure: where the truck fits nowhere in the goal, that is the reason.
    fn explain(&self, failure: PlanFailure, goal: GoalDisc) -> PlanFailure {
        if has_free_pose(&self.checker, goal) { failure } else { PlanFailure::GoalBlocked }
    }
}

impl TruckPlanner for PrmPrimitives {
    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut time = QueryTime::default();
        self.scratch.expansions = 0;
        self.local.begin();
        let path = match goal {
            Goal::Disc(disc) => self.find(start, disc, &mut time),
            Goal::Pose(_) => Err(PlanFailure::Disconnected),
        };
        let effort = Effort { roadmap_expansions: self.scratch.expansions, local_expansions: self.local.expansions() };
        Plan { path, effort, time }
    }
}

/// Rings of places that are tried in a goal disc, and headings at each place.
const RINGS: u32 = 20;
const HEADINGS: u32 = 24;

/// Whether the body fits somewhere in a disc, centre inside: on rings of places half a metre apart in a disc of 10 m.
pub fn has_free_pose(checker: &CollisionChecker, disc: GoalDisc) -> bool {
    let reach = disc.radius_m.min(checker.field().frame().width_m() + checker.field().frame().height_m());
    let ahead = checker.body().centre_offset_m();
    // From the rim inwards: a bush stands in the middle.
    (0..=RINGS).rev().any(|ring| {
        let places = (6 * ring).max(1);
        (0..places).any(|place| {
            let around = f64::from(place) / f64::from(places) * std::f64::consts::TAU;
            let (sin, cos) = ops::sin_cos(around);
            let centre = disc.centre + DVec2::new(cos, sin) * (reach * f64::from(ring) / f64::from(RINGS));
            checker.field().at(centre) >= 0.5 * checker.body().width_m
                && (0..HEADINGS).any(|k| {
                    let heading = f64::from(k) / f64::from(HEADINGS) * std::f64::consts::TAU;
                    let facing = Pose::new(centre.x, centre.y, heading);
                    let axle = facing.transform(DVec2::new(-ahead, 0.0));
                    checker.pose_is_free(Pose::new(axle.x, axle.y, heading), LEAST_CLEARANCE_M)
                })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planning::MotionCost;
    use crate::planning::test_fields::{TestField, assert_drivable, drives_in_a_row, least_clearance};
    use crate::planning::{ClearanceTo, RoadmapSearch, SafetyMap};
    use crate::rng;

    fn planner(field: &TestField, seed: u64) -> PrmPrimitives {
        let prm = PrmSettings { samples: 200, ..PrmSettings::default() };
        let mut rng = rng::stream(seed, "prm");
        PrmPrimitives::build(&field.checker, &prm, &PrimitiveSettings::default(), &SafetySettings::default(), &mut rng)
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_only_where_the_flood_says_no() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(12, walks, planner);
            assert!(drives.solved + drives.unreachable >= 212 && drives.missed <= 4, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn a_drive_can_begin_anywhere_on_another() {
        let mut field = TestField::random(4, 25);
        let mut planner = planner(&field, 4);
        let mut pose = field.start;
        for _ in 0..60 {
            let goal = field.random_goal();
            let path = planner.plan(pose, goal.into()).path.expect("an open field");
            assert_drivable(&field.checker, &path, pose, goal);
            // Stop on the way, where the first segment is half driven.
            if let Some(first) = path.segments.first() {
                pose = first.pose_at(pose, 0.5 * first.length_m);
            }
        }
    }

    #[test]
    fn drives_that_pay_for_nearness_to_bushes_are_drivable_and_found_as_often() {
        let (mut plain_found, mut safe_found) = (0, 0);
        for seed in 0..4 {
            let mut field = TestField::random(seed, 40);
            let safety = SafetySettings { map: SafetyMap::Cost, weight: 4.0, ..SafetySettings::default() };
            let prm = PrmSettings { samples: 200, ..PrmSettings::default() };
            let mut rng = rng::stream(seed, "prm");
            let mut safe = PrmPrimitives::build(&field.checker, &prm, &PrimitiveSettings::default(), &safety, &mut rng);
            let mut plain = planner(&field, seed);
            for _ in 0..15 {
                let goal = field.random_goal();
                plain_found += u32::from(plain.plan(field.start, goal.into()).path.is_ok());
                if let Ok(path) = safe.plan(field.start, goal.into()).path {
                    assert_drivable(&field.checker, &path, field.start, goal);
                    safe_found += 1;
                }
            }
        }
        assert!(plain_found > 40 && safe_found + 2 >= plain_found, "{plain_found} and {safe_found} drives");
    }

    #[test]
    fn the_same_seed_gives_the_same_path_bit_for_bit() {
        for seed in 0..4 {
            let mut field = TestField::random(seed, 40);
            let goals: Vec<GoalDisc> = (0..10).map(|_| field.random_goal()).collect();
            let (mut one, mut two) = (planner(&field, seed), planner(&field, seed));
            // The second planner has answered other queries before: nothing may be left of them.
            for &goal in goals.iter().rev() {
                let _ = two.plan(field.start, goal.into());
            }
            for &goal in &goals {
                let (a, b) = (one.plan(field.start, goal.into()), two.plan(field.start, goal.into()));
                assert_eq!(a.path, b.path);
                assert_eq!(a.effort, b.effort);
            }
        }
    }

    #[test]
    fn a_start_in_the_goal_stays_there() {
        let field = TestField::random(1, 25);
        let centre = field.checker.body().body_centre(field.start);
        let plan = planner(&field, 1).plan(field.start, GoalDisc { centre, radius_m: 5.0 }.into());
        assert_eq!(plan.path, Ok(Path::standing(field.start)));
    }

    #[test]
    fn failures_have_their_reasons() {
        let picture = [
            "..............................",
            "..............................",
            "...................#######....",
            "...................#.....#....",
            "...................#.....#....",
            "...................#.....#....",
            "...................#.....#....",
            "...................#######....",
            "..............................",
            "..............................",
        ];
        let field = TestField::drawn(&picture, Pose::new(20.0, 20.0, 0.0));
        let mut planner = planner(&field, 1);
        let mut reason = |start, x, y, radius_m| {
            planner.plan(start, GoalDisc { centre: DVec2::new(x, y), radius_m }.into()).path.expect_err("no path")
        };
        let in_bush = Pose::new(96.0, 20.0, 0.0);
        assert_eq!(reason(in_bush, 20.0, 20.0, 5.0), PlanFailure::StartBlocked);
        assert_eq!(reason(Pose::new(-3.0, 20.0, 0.0), 20.0, 20.0, 5.0), PlanFailure::StartBlocked);
        assert_eq!(reason(field.start, 97.5, 12.5, 0.5), PlanFailure::GoalBlocked);
        let walled_in = reason(field.start, 112.0, 25.0, 4.0);
        assert!(matches!(walled_in, PlanFailure::Disconnected | PlanFailure::BudgetSpent), "{walled_in}");
    }

    #[test]
    fn a_small_budget_is_kept_and_reported() {
        let mut field = TestField::random(9, 45);
        let primitives = PrimitiveSettings { max_expansions: 10, ..PrimitiveSettings::default() };
        let rng = &mut rng::stream(9, "prm");
        let mut planner =
            PrmPrimitives::build(&field.checker, &PrmSettings::default(), &primitives, &SafetySettings::default(), rng);
        let mut spent = 0;
        for _ in 0..40 {
            let goal = field.random_goal();
            let plan = planner.plan(field.start, goal.into());
            assert!(plan.effort.local_expansions <= 10);
            spent += u32::from(plan.path == Err(PlanFailure::BudgetSpent));
        }
        assert!(spent > 0);
    }

    #[test]
    fn the_original_programs_way_drives_to_the_nearest_milestone() {
        let prm = PrmSettings {
            clearance_m: 7.5,
            clearance_to: ClearanceTo::CellCentres,
            search: RoadmapSearch::Greedy,
            goal: RoadmapGoal::NearestMilestone,
            ..PrmSettings::default()
        };
        let primitives = PrimitiveSettings {
            step_m: 8.0,
            clearance_m: 0.05,
            cost: MotionCost::Moves,
            turn_cost: 1.0,
            reverse_cost: 1.0,
            cusp_cost: 0.0,
            heuristic_weight: 4.0,
            aimed: false,
            thin_waypoints: false,
            waypoint_tolerance_m: 4.0,
            restart_at_waypoints: true,
            search_alone: false,
            ..PrimitiveSettings::default()
        };
        let mut solved = 0;
        for seed in 0..10 {
            let mut field = TestField::random(seed, 15);
            let mut planner = PrmPrimitives::build(
                &field.checker,
                &prm,
                &primitives,
                &SafetySettings::default(),
                &mut rng::stream(seed, "prm"),
            );
            let mut pose = field.start;
            for _ in 0..10 {
                let goal = field.random_goal();
                let Ok(path) = planner.plan(pose, goal.into()).path else { continue };
                let distance = |m: &&DVec2| m.distance(goal.centre);
                let milestones = planner.roadmap().milestones();
                let nearest = milestones.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let end = field.checker.body().body_centre(path.end());
                assert!(nearest.is_some_and(|milestone| milestone.distance(end) <= 4.0 + 1e-6));
                assert!(path.segments.iter().all(|s| (s.length_m / 8.0 - (s.length_m / 8.0).round()).abs() < 1e-9));
                assert!(least_clearance(&field.checker, &path) > 0.0);
                pose = path.end();
                solved += 1;
            }
        }
        assert!(solved >= 60, "only {solved}");
    }
}
