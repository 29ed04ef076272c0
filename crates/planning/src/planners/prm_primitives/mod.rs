//! The planner `prm+primitives`: a roadmap provides waypoints, and motion primitives turn them into a drivable path.

mod roadmap;
mod settings;

pub use settings::{ClearanceTo, PrmSettings, RoadmapGoal, RoadmapSearch};

use std::sync::Arc;

use glam::DVec2;

use crate::collision::CollisionChecker;
use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::vehicle::{Dimensions, Path};

use crate::kit::ends::{explain_failure, free_ends};
use crate::kit::local_search::LocalSearch;
use crate::kit::safety::Safety;
use crate::kit::target::Target;
use crate::observer::{NullObserver, PlanningObserver, PlanningWork};
use crate::registry::{BuiltInPlanner, Charge, PlannerContext, RoadmapSize, TruckPlannerSettings};
use crate::{BuildReport, Effort, Found, FoundBy, Goal, GoalDisc, Plan, PlanFailure, TruckPlanner};
use roadmap::{Roadmap, RoadmapRoute, RoadmapScratch};
use wildfire_base::query::SearchPhase;

/// The roadmap leads this near to a goal pose, and motion primitives and a curve from there on.
const NEAR_POSE_M: f64 = 10.0;

/// The planner for one body on one field.
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
    /// Builds the roadmap for a field and a body; the stream `prm` decides where the milestones lie.
    pub fn build(context: &PlannerContext<'_>) -> Self {
        let &PlannerContext { checker, memory, .. } = context;
        let TruckPlannerSettings { prm, primitives, safety, .. } = *context.settings;
        let mut rng = (context.stream)("prm");
        let mut watch = CpuStopwatch::start();
        let field = checker.field();
        let safety = Safety::new(*field.frame(), field.occupied(), safety);
        let safety = Safety::on_ground(safety, field, context.ground).map(Arc::new);
        // Milestones along roads come after the sampled ones, which so keep their numbers.
        let sampled = Roadmap::sampled(checker, prm, &mut rng).along_roads(context.ground).priced_by(safety.clone());
        let sampling = watch.elapsed_since_last();
        let roadmap = sampled.connected();
        let report = BuildReport {
            samples: roadmap.milestones().len() as u32,
            draws: roadmap.draws(),
            edges: roadmap.edge_count(),
            components: roadmap.component_count(),
            sampling,
            connecting: watch.elapsed_since_last(),
            ..BuildReport::default()
        };
        Self {
            checker: checker.clone(),
            roadmap,
            scratch: RoadmapScratch::default(),
            local: LocalSearch::new(checker, memory, primitives, safety),
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

    fn find(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Result<Found, PlanFailure> {
        free_ends(&self.checker, start, Target::from(&goal))?;
        let near = self.near(goal);
        let centre = self.checker.body().body_centre(start);
        let is_near = self.goal == RoadmapGoal::InReach && centre.distance(near.centre) <= near.radius_m;
        // A pose still has to be driven to, however near it is.
        if is_near && matches!(goal, Goal::Disc(_)) {
            return Ok(Found { path: Path::standing(start), by: FoundBy::Straight });
        }
        observer.begins(Some(PlanningWork::Roadmap));
        let route = if is_near { Ok(RoadmapRoute::default()) } else { self.route(centre, near, observer) };
        observer.begins(Some(PlanningWork::Local));
        let path = route.and_then(|route| {
            let end = match (self.goal, goal, route.waypoints.last()) {
                // The route ends at a milestone, so the drive has to end near it too, within the goal.
                (RoadmapGoal::NearestMilestone, Goal::Disc(disc), Some(&last)) => {
                    disc_about(last, self.waypoint_tolerance_m, disc).into()
                }
                _ => goal,
            };
            self.local.drive(start, &route.waypoints, end, observer)
        });
        let path = match path {
            // Near the goal there were no waypoints, and the same search would be made again.
            Err(PlanFailure::Disconnected | PlanFailure::BudgetSpent) if self.search_alone && !is_near => {
                self.local.drive(start, &[], goal, observer)
            }
            other => other,
        };
        observer.begins(None);
        path.map_err(|failure| explain_failure(&self.checker, Target::from(&goal), failure))
    }

    /// Returns where the roadmap's route is to lead.
    fn near(&self, goal: Goal) -> GoalDisc {
        let radius_m = match self.goal {
            RoadmapGoal::InReach => NEAR_POSE_M,
            // The drive goes on from that milestone to the pose, however far it is.
            RoadmapGoal::NearestMilestone => f64::INFINITY,
        };
        match goal {
            Goal::Disc(disc) => disc,
            Goal::Pose(end) => GoalDisc { centre: self.checker.body().body_centre(end), radius_m },
        }
    }

    fn route(
        &mut self,
        centre: DVec2,
        goal: GoalDisc,
        observer: &mut dyn PlanningObserver,
    ) -> Result<RoadmapRoute, PlanFailure> {
        let route = self.roadmap.route(centre, goal, &mut self.scratch);
        observer.on_edges_examined(SearchPhase::Query, &mut self.roadmap.examined(centre, &self.scratch));
        let mut route = route?;
        if self.thin_waypoints {
            self.roadmap.tighten(centre, &mut route);
        }
        Ok(route)
    }
}

/// Returns the largest disc of places within `tolerance_m` of a milestone and in the goal, which holds the milestone.
///
/// Two discs have the largest disc in common whose diameter is what they share of the line through their centres.
fn disc_about(milestone: DVec2, tolerance_m: f64, goal: GoalDisc) -> GoalDisc {
    let metres = milestone.distance(goal.centre);
    if metres + tolerance_m <= goal.radius_m {
        return GoalDisc { centre: milestone, radius_m: tolerance_m };
    }
    // Along the ray from the goal's centre through the milestone.
    let first = (metres - tolerance_m).max(-goal.radius_m);
    let last = goal.radius_m;
    let outwards = (milestone - goal.centre).normalize_or_zero();
    GoalDisc { centre: goal.centre + outwards * (0.5 * (first + last)), radius_m: 0.5 * (last - first) }
}

impl TruckPlanner for PrmPrimitives {
    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn show_roadmap(&mut self, observer: &mut dyn PlanningObserver) {
        observer.on_edges_examined(SearchPhase::Roadmap, &mut self.roadmap.lines());
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        self.scratch.expansions = 0;
        self.local.begin();
        let found = self.find(start, goal.with_margin(), observer);
        let effort = Effort { roadmap_expansions: self.scratch.expansions, local_expansions: self.local.expansions() };
        Plan::new(found, effort)
    }
}

/// Makes planners of the name `prm+primitives`.
pub struct PrmPrimitivesFactory;

impl BuiltInPlanner for PrmPrimitivesFactory {
    fn make(&self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner> {
        Box::new(PrmPrimitives::build(context))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["prm", "primitives", "safety"]
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: settings.prm.seconds_per_expansion, local_s: settings.primitives.seconds_per_expansion }
    }

    fn roadmap_size(&self, settings: &TruckPlannerSettings<'_>, frame: &FieldFrame, _: usize) -> Option<RoadmapSize> {
        let PrmSettings { neighbours, max_edge_m, .. } = *settings.prm;
        Some(RoadmapSize { milestones: settings.prm.samples_on(frame).into(), neighbours, max_edge_m })
    }

    fn warning(&self, settings: &TruckPlannerSettings<'_>, body: &Dimensions, truck: &str) -> Option<String> {
        let clearance_m = settings.prm.clearance_m;
        (clearance_m < 0.5 * body.width_m).then(|| {
            format!(
                "The roadmap of {truck} has a clearance of {clearance_m} m, less than half the truck's width: it may \
                 lead where the truck does not fit."
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::kit::ends::has_free_pose;
    use crate::kit::floods::{FloodQuery, FloodSearch};
    use crate::kit::local_search::MotionCost;
    use crate::kit::local_search::PrimitiveSettings;
    use crate::kit::safety::SafetyMap;
    use crate::kit::safety::SafetySettings;
    use crate::memory::MemoryMeter;
    use crate::planners::prm_primitives::{ClearanceTo, RoadmapSearch};
    use crate::registry::OwnedSettings;
    use crate::test_fields::{
        TestField, assert_drivable, assert_ends_in, drives_in_a_row, least_clearance, random_free_pose,
    };
    use wildfire_base::rng;

    fn planner(field: &TestField, seed: u64) -> PrmPrimitives {
        let prm = PrmSettings { samples: 200, ..PrmSettings::default() };
        field.make(&OwnedSettings { prm, ..OwnedSettings::default() }, seed, PrmPrimitives::build)
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_only_where_the_flood_says_no() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(12, walks, |field, seed| Box::new(planner(field, seed)));
            assert!(drives.solved + drives.unreachable >= 212 && drives.missed <= 4, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn drives_that_pay_for_nearness_to_bushes_are_drivable_and_found_as_often() {
        let (mut plain_found, mut safe_found) = (0, 0);
        for seed in 0..4 {
            let mut field = TestField::random(seed, 40);
            let safety = SafetySettings { map: SafetyMap::Cost, weight: 4.0, ..SafetySettings::default() };
            let prm = PrmSettings { samples: 200, ..PrmSettings::default() };
            let settings = OwnedSettings { prm, safety, ..OwnedSettings::default() };
            let mut safe = field.make(&settings, seed, PrmPrimitives::build);
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
    fn drives_to_poses_are_drivable_and_end_there() {
        let (mut solved, mut missed) = (0, 0);
        for seed in 0..8 {
            let mut field = TestField::random(seed, 40);
            let mut planner = planner(&field, seed);
            let mut oracle = FloodSearch::new(&field.checker, &MemoryMeter::unlimited());
            for _ in 0..10 {
                let start = field.start;
                let goal = Goal::Pose(random_free_pose(&mut field, 0.1));
                match planner.plan(start, goal).path {
                    Ok(path) => {
                        assert_ends_in(&field.checker, &path, goal);
                        assert!(least_clearance(&field.checker, &path) > 0.0);
                        solved += 1;
                    }
                    Err(_) => {
                        let query = FloodQuery::new(start, goal);
                        let found = oracle.find_within(&query, &mut NullObserver, &mut 0);
                        missed += u32::from(found.is_ok());
                    }
                }
            }
        }
        assert!(solved > 70 && missed <= 2, "{solved} solved, {missed} missed");
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
        let settings = OwnedSettings { primitives, ..OwnedSettings::default() };
        let mut planner = field.make(&settings, 9, PrmPrimitives::build);
        let mut spent = 0;
        for _ in 0..40 {
            let goal = field.random_goal();
            let plan = planner.plan(field.start, goal.into());
            assert!(plan.effort.local_expansions <= 10);
            spent += u32::from(plan.path == Err(PlanFailure::BudgetSpent));
        }
        assert!(spent > 0);
    }

    /// The settings of the original program.
    fn original() -> (PrmSettings, PrimitiveSettings) {
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
        (prm, primitives)
    }

    fn planner_of((prm, primitives): &(PrmSettings, PrimitiveSettings), field: &TestField, seed: u64) -> PrmPrimitives {
        let prm = prm.clone();
        let primitives = primitives.clone();
        field.make(&OwnedSettings { prm, primitives, ..OwnedSettings::default() }, seed, PrmPrimitives::build)
    }

    #[test]
    fn the_original_programs_way_drives_to_the_nearest_milestone() {
        let mut solved = 0;
        for seed in 0..10 {
            let mut field = TestField::random(seed, 15);
            let mut planner = planner_of(&original(), &field, seed);
            let mut pose = field.start;
            for _ in 0..10 {
                // Its rules know no reach.
                let goal = GoalDisc { radius_m: f64::INFINITY, ..field.random_goal() };
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

    #[test]
    fn drives_to_the_nearest_milestone_end_in_reach_whatever_the_tolerance() {
        let (mut solved, mut refused) = (0, 0);
        for (case, tolerance_m) in [0.01, 0.5, 4.0, 9.0, 30.0, 1000.0].into_iter().enumerate() {
            for (search_alone, aimed) in [(false, false), (false, true), (true, true)] {
                let mut settings = original();
                settings.1 = PrimitiveSettings {
                    waypoint_tolerance_m: tolerance_m,
                    search_alone,
                    aimed,
                    step_m: 4.0,
                    ..settings.1
                };
                let mut field = TestField::random(case as u64, 25);
                let mut planner = planner_of(&settings, &field, case as u64);
                let mut pose = field.start;
                for radius_m in [6.0, 8.0, 10.0, 15.0, 60.0, 6.0, 8.0, 10.0, 15.0, 60.0] {
                    let goal = GoalDisc { radius_m, ..field.random_goal() };
                    let milestones = planner.roadmap().milestones();
                    let nearest_m = milestones.iter().map(|m| m.distance(goal.centre)).fold(f64::INFINITY, f64::min);
                    match planner.plan(pose, goal.into()).path {
                        Ok(path) => {
                            assert_drivable(&field.checker, &path, pose, goal);
                            assert!(nearest_m <= radius_m);
                            pose = path.end();
                            solved += 1;
                        }
                        Err(reason) => {
                            assert!(reason == PlanFailure::GoalBlocked || nearest_m <= radius_m, "{reason}");
                            refused += u32::from(nearest_m > radius_m);
                        }
                    }
                }
            }
        }
        assert!(solved > 60 && refused > 20, "{solved} solved, {refused} refused");
    }

    #[test]
    fn nearest_milestone_beyond_reach_is_no_goal() {
        // The roadmap keeps 7.5 m from the bush's centre; the truck itself can come nearer.
        let field = TestField::drawn(
            &["..........", "..........", "..........", ".....#....", "..........", "..........", ".........."],
            Pose::new(10.0, 10.0, 0.0),
        );
        let bush = field.bushes[0];
        let (prm, primitives) = original();
        for search_alone in [false, true] {
            let settings = (prm.clone(), PrimitiveSettings { search_alone, ..primitives.clone() });
            let mut planner = planner_of(&settings, &field, 1);
            let goal = GoalDisc { centre: bush, radius_m: 7.0 };
            assert!(has_free_pose(&field.checker, goal));
            assert_eq!(planner.plan(field.start, goal.into()).path, Err(PlanFailure::GoalBlocked));
            let goal = GoalDisc { radius_m: 9.0, ..goal };
            let path = planner.plan(field.start, goal.into()).path.expect("milestones are in reach");
            assert_drivable(&field.checker, &path, field.start, goal);
        }
    }

    #[test]
    fn goal_poses_may_be_far_from_every_milestone() {
        let field = TestField::drawn(&["...................."; 8], Pose::new(10.0, 10.0, 0.0));
        let (prm, primitives) = original();
        let settings = (PrmSettings { samples: 3, ..prm }, PrimitiveSettings { search_alone: true, ..primitives });
        let mut planner = planner_of(&settings, &field, 1);
        for (x, y) in [(90.0, 30.0), (30.0, 35.0), (50.0, 8.0), (70.0, 20.0)] {
            let goal = Goal::Pose(Pose::new(x, y, 1.0));
            let path = planner.plan(field.start, goal).path.expect("an empty field");
            assert_ends_in(&field.checker, &path, goal);
        }
    }

    #[test]
    fn the_disc_about_a_milestone_is_in_the_goal_and_holds_the_milestone() {
        let mut rng = rng::stream(1, "disc_about");
        let near = |place: DVec2, disc: GoalDisc| place.distance(disc.centre) <= disc.radius_m + 1e-9;
        let mut cut = 0;
        for _ in 0..10_000 {
            let goal = GoalDisc { centre: DVec2::new(50.0, 50.0), radius_m: rng.random_range(0.0..30.0) };
            let place = |rng: &mut rng::Xoshiro256PlusPlus, disc: GoalDisc, share: f64| {
                let around = rng.random_range(0.0..std::f64::consts::TAU);
                disc.centre + DVec2::from(wildfire_base::geometry::ops::sin_cos(around)) * (disc.radius_m * share)
            };
            let share = rng.random_range(0.0..1.0);
            let milestone = place(&mut rng, goal, share);
            let tolerance_m = [0.01, 1.0, 10.0, 100.0][rng.random_range(0..4)] * rng.random_range(0.1..1.0);
            let disc = disc_about(milestone, tolerance_m, goal);
            assert!(near(milestone, disc) && disc.radius_m <= tolerance_m.min(goal.radius_m) + 1e-9);
            assert!(disc.radius_m >= 0.5 * tolerance_m.min(goal.radius_m) - 1e-9, "{disc:?}");
            for _ in 0..8 {
                let rim = place(&mut rng, disc, 1.0);
                assert!(near(rim, goal) && near(rim, GoalDisc { centre: milestone, radius_m: tolerance_m }));
            }
            cut += u32::from(disc.radius_m != tolerance_m);
        }
        assert!((2_000..9_000).contains(&cut), "{cut}");
    }
}
