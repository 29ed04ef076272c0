//! The planner `prm-rs`: a probabilistic roadmap over poses, joined by Reeds-Shepp curves.
//!
//! After L. E. Kavraki, P. Svestka, J.-C. Latombe, M. H. Overmars, "Probabilistic roadmaps for path planning in
//! high-dimensional configuration spaces", IEEE Trans. Robotics and Automation 12(4), 1996. Milestones are poses: some
//! drawn evenly, with headings along the bushes that are near, some that pass the corners of bushes. Each is joined to its
//! nearest predecessors by curves that can be driven both ways. Curves are swept while the roadmap is built where they
//! would join components of it, and otherwise when a search first asks (R. Bohlin, L. E. Kavraki, "Path planning using lazy
//! PRM", ICRA 2000). About milestones that are not joined to the most, more poses are tried.
//!
//! A query searches the roadmap, and motions about the start, together: A* whose candidates wait at what the whole path
//! would cost, curves from the start and approaches into the goal among them. Where the wanted clearance leads nowhere,
//! less is asked for; where that serves neither, the planner `hybrid-astar` takes over. What the roadmap gives is
//! improved by shortcuts under the same clearance.
//!
//! Poses are those of the rear axle, places in a goal disc those of the body's centre; world frame, metres.

mod near;
mod roadmap;
mod sample;
mod search;
mod settings;
mod tree;

pub use settings::{Maker, PrmRsSettings};

use crate::collision::CollisionChecker;
use crate::geometry::{FieldFrame, Pose};
use crate::rng::Xoshiro256PlusPlus;
use crate::time::cpu::CpuStopwatch;
use crate::vehicle::Path;

use super::hybrid_astar::{HybridAstar, HybridSettings};
use crate::planning::kit::clearance_profile::ClearanceFloor;
use crate::planning::kit::ends::free_ends;
use crate::planning::kit::heuristic::Lookout;
use crate::planning::kit::shortcuts::Improver;
use crate::planning::memory::{MemoryMeter, PlannerMemory};
use crate::planning::search_graph::{SearchPhase, SearchRecorder, Searched};
use crate::planning::{BuildReport, Effort, Found, FoundBy, Goal, Plan, QueryTime, TruckPlanner};
use roadmap::{LEVELS, MAX_APART, Roadmap};
use sample::Sampler;
pub use sample::count_convex_corners;
use search::{Search, Task};

/// How often more poses are tried about milestones that are apart.
const BRIDGE_ROUNDS: u32 = 2;

/// The planner for one body on one field.
#[derive(Debug)]
pub struct PrmRs {
    checker: CollisionChecker,
    settings: PrmRsSettings,
    lookout: Lookout,
    roadmap: Roadmap,
    search: Search,
    improver: Improver,
    /// Where every query begins to draw its shortcuts.
    shortcuts: Xoshiro256PlusPlus,
    fallback: HybridAstar,
    report: BuildReport,
    effort: Effort,
    /// Of the roadmap and what is looked at along it.
    along: SearchRecorder,
    /// Of what is looked at off the roadmap.
    off: SearchRecorder,
}

impl PrmRs {
    /// `rng` decides where the roadmap's poses lie, `shortcuts` which shortcuts are tried.
    pub fn build(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: &PrmRsSettings,
        hybrid: &HybridSettings,
        mut rng: Xoshiro256PlusPlus,
        shortcuts: Xoshiro256PlusPlus,
    ) -> Self {
        let mut watch = CpuStopwatch::start();
        let mut sampler = Sampler::new(checker, settings.clearance_m, &mut rng);
        let mut poses = sampler.draw(settings.samples);
        poses.extend(sampler.at_corners(settings.corner_places));
        let sampling = watch.lap();
        let mut roadmap = Roadmap::new(checker, memory, settings);
        roadmap.add(poses);
        for _ in 0..BRIDGE_ROUNDS {
            roadmap.add(sampler.about(&roadmap.apart()));
        }
        roadmap.finish();
        let report = BuildReport {
            samples: roadmap.node_count() as u32,
            draws: sampler.draws,
            edges: roadmap.edge_count() as u32,
            components: roadmap.components(),
            sampling,
            connecting: watch.lap(),
        };
        Self {
            checker: checker.clone(),
            settings: settings.clone(),
            lookout: Lookout::new(settings.cusp_cost, checker.body()),
            search: Search::new(checker.body(), memory, &roadmap),
            roadmap,
            improver: Improver::new(checker, settings.cusp_cost),
            shortcuts: shortcuts.clone(),
            fallback: HybridAstar::build(checker, memory, hybrid, shortcuts),
            report,
            effort: Effort::default(),
            along: SearchRecorder::default(),
            off: SearchRecorder::default(),
        }
    }

    /// The most bytes that it takes on a field whose bushes have up to this number of corners.
    pub fn memory(
        frame: &FieldFrame,
        corners: u64,
        settings: &PrmRsSettings,
        hybrid: &HybridSettings,
    ) -> PlannerMemory {
        let drawn = u64::from(settings.samples) + Sampler::most_at_corners(corners, settings.corner_places);
        let nodes = drawn + u64::from(BRIDGE_ROUNDS) * Sampler::most_about(MAX_APART as u64);
        let edges = nodes * u64::from(settings.neighbours);
        let fallback = HybridAstar::memory(frame, hybrid);
        PlannerMemory {
            held: fallback.held + Roadmap::most_bytes(frame, nodes, edges) + Search::bytes(nodes),
            making: Sampler::most_bytes(drawn),
            grows: fallback.grows + Roadmap::most_bytes_of_curves(edges) + Search::most_bytes_at_work(nodes, edges),
            ..fallback
        }
    }

    /// A path by way of the roadmap, or straight away, and the floor that it keeps.
    fn find(&mut self, start: Pose, goal: Goal) -> Option<(Found, Option<ClearanceFloor>)> {
        let ends = free_ends(&self.checker, start, goal).ok()?;
        for level in 0..LEVELS {
            let floor = ClearanceFloor::new(self.roadmap.clearance_m(level), ends.iter().copied());
            if level == 0
                && let Some(path) = self.lookout.straight_away(&self.checker, start, goal, &floor)
            {
                return Some((Found { path, by: FoundBy::Straight }, None));
            }
            let task = Task { checker: &self.checker, lookout: &self.lookout, floor: &floor, level, start, goal };
            let path = self.search.run(&task, &mut self.roadmap);
            self.along.add(self.search.tree().lines(false));
            self.off.add(self.search.tree().lines(true));
            self.effort.roadmap_expansions += self.search.roadmap_expansions;
            self.effort.local_expansions += self.search.local_expansions;
            if let Some(path) = path {
                let by = match level {
                    0 if self.search.used_roadmap() => FoundBy::Roadmap,
                    0 => FoundBy::Search,
                    _ => FoundBy::Relaxed,
                };
                return Some((Found { path, by }, Some(floor)));
            }
        }
        None
    }

    fn take_searched(&mut self) -> Vec<Searched> {
        [self.along.take(SearchPhase::Query), self.off.take(SearchPhase::Local)].into_iter().flatten().collect()
    }

    fn improve(&mut self, path: &Path, goal: Goal, floor: &ClearanceFloor) -> Path {
        let mut rng = self.shortcuts.clone();
        let path = self.improver.improve(path, floor, self.settings.shortcuts, &mut rng);
        self.lookout.end_sooner(&self.checker, path, goal, floor)
    }
}

impl TruckPlanner for PrmRs {
    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn record_searches(&mut self) {
        self.along.switch_on();
        self.off.switch_on();
        self.fallback.record_searches();
    }

    fn roadmap_graph(&mut self) -> Option<Searched> {
        self.along.add(self.roadmap.free_lines());
        self.along.take(SearchPhase::Roadmap)
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut watch = CpuStopwatch::start();
        self.effort = Effort::default();
        let found = self.find(start, goal.inner());
        let mut effort = self.effort;
        let roadmap = watch.lap();
        match found {
            Some((Found { path, by }, floor)) => {
                let path = match floor {
                    Some(floor) => self.improve(&path, goal.inner(), &floor),
                    None => path,
                };
                let time = QueryTime { roadmap, local: watch.lap() };
                Plan::new(Ok(Found { path, by }), effort, time, self.take_searched())
            }
            None => {
                let plan = self.fallback.plan(start, goal);
                effort.local_expansions += plan.effort.local_expansions;
                self.off.add(plan.searched.iter().flat_map(|searched| searched.graph.lines()));
                let time = QueryTime { roadmap, local: watch.lap() };
                Plan { effort, time, searched: self.take_searched(), ..plan }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::MOTION_TOLERANCE_M;
    use crate::planning::reachability::Reachability;
    use crate::planning::test_fields::{
        TestField, assert_ends_in, drives_in_a_row, least_clearance, random_free_pose, random_pose, shut_court,
    };
    use crate::planning::{GoalDisc, PlanFailure};
    use crate::rng;
    use crate::vehicle::{Dimensions, ReedsShepp};
    use glam::DVec2;

    fn planner(field: &TestField, seed: u64) -> PrmRs {
        let settings = PrmRsSettings { samples: 100, ..PrmRsSettings::default() };
        let streams = (rng::stream(seed, "prm-rs"), rng::stream(seed, "shortcuts"));
        PrmRs::build(
            &field.checker,
            &MemoryMeter::unlimited(),
            &settings,
            &HybridSettings::default(),
            streams.0,
            streams.1,
        )
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_only_where_the_flood_says_no() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(8, walks, planner);
            assert!(drives.solved >= 140 && drives.missed == 0, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn dense_fields_are_served_as_far_as_the_flood_reaches() {
        let mut served = 0;
        for seed in 0..4 {
            let mut field = TestField::random(seed, 60);
            let mut planner = planner(&field, seed);
            let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for _ in 0..8 {
                let goal = field.random_goal();
                let is_solved = planner.plan(field.start, goal.into()).path.is_ok();
                assert!(is_solved || !reachability.reaches(goal), "seed {seed}: {goal:?} is in reach");
                served += u32::from(is_solved);
            }
        }
        assert!(served >= 25, "{served} of 32");
    }

    #[test]
    fn drives_to_poses_end_there_and_are_no_shorter_than_on_an_empty_field() {
        let curves = ReedsShepp { radius_m: Dimensions::default().turning_radius_m };
        let mut solved = 0;
        for seed in 0..8 {
            let mut field = TestField::random(seed, 40);
            let mut planner = planner(&field, seed);
            for _ in 0..10 {
                let (start, end) = (field.start, random_free_pose(&mut field, 0.3));
                let Ok(path) = planner.plan(start, Goal::Pose(end)).path else { continue };
                assert_eq!(path.start, start);
                assert_ends_in(&field.checker, &path, Goal::Pose(end));
                assert!(path.segments.iter().all(|segment| segment.curvature.abs() <= 1.0 / curves.radius_m));
                assert!(least_clearance(&field.checker, &path) > 0.0);
                assert!(path.length_m() >= curves.length_m(start, end) - 1e-9);
                solved += 1;
            }
        }
        assert!(solved >= 78, "{solved} of 80");
    }

    #[test]
    fn the_wanted_clearance_is_kept_where_start_and_goal_have_it() {
        let field = TestField::random(4, 15);
        let mut planner = planner(&field, 4);
        let wanted_m = planner.settings.clearance_m;
        let mut rng = rng::stream(4, "goals");
        let mut kept = 0;
        for _ in 0..40 {
            let goal = random_pose(&mut rng, 150.0);
            if field.checker.pose_is_free(goal, 1.0)
                && let Ok(path) = planner.plan(field.start, Goal::Pose(goal)).path
            {
                kept += u32::from(least_clearance(&field.checker, &path) > wanted_m - MOTION_TOLERANCE_M);
            }
        }
        assert!(kept > 15, "{kept} paths keep it");
    }

    #[test]
    fn a_place_is_met_with_the_middle_of_the_body() {
        let field = TestField::random(4, 15);
        let centre = DVec2::new(60.0, 75.0);
        let path = planner(&field, 4).plan(field.start, Goal::Disc(GoalDisc { centre, radius_m: 0.0 })).path;
        let end = path.expect("an open field").end();
        assert!(field.checker.body().body_centre(end).distance(centre) < 1e-6);
    }

    #[test]
    fn answers_do_not_depend_on_what_was_asked_before() {
        for seed in 0..3 {
            let mut field = TestField::random(seed, 40);
            let mut goals: Vec<Goal> = (0..8).map(|_| Goal::Disc(field.random_goal())).collect();
            goals.extend((0..8).map(|_| Goal::Pose(random_free_pose(&mut field, 0.3))));
            let (mut one, mut two) = (planner(&field, seed), planner(&field, seed));
            for &goal in goals.iter().rev() {
                let _ = two.plan(field.start, goal);
            }
            for &goal in &goals {
                let (a, b) = (one.plan(field.start, goal), two.plan(field.start, goal));
                assert_eq!((a.path, a.effort), (b.path, b.effort));
            }
        }
    }

    #[test]
    fn a_start_in_the_goal_stays_there() {
        let field = TestField::random(1, 25);
        let centre = field.checker.body().body_centre(field.start);
        for radius_m in [5.0, f64::INFINITY] {
            let plan = planner(&field, 1).plan(field.start, GoalDisc { centre, radius_m }.into());
            assert_eq!(plan.path, Ok(Path::standing(field.start)));
        }
    }

    #[test]
    fn failures_have_their_reasons() {
        let field = shut_court();
        let mut planner = planner(&field, 1);
        let (bush, court) = (Pose::new(42.0, 40.0, 0.0), Pose::new(60.0, 25.0, 0.0));
        let disc = |pose: Pose, radius_m| Goal::Disc(GoalDisc { centre: pose.position(), radius_m });
        let mut reason = |start, goal| planner.plan(start, goal).path.err();
        assert_eq!(reason(bush, disc(court, 4.0)), Some(PlanFailure::StartBlocked));
        assert_eq!(reason(Pose::new(f64::NAN, 20.0, 0.0), disc(court, 4.0)), Some(PlanFailure::StartBlocked));
        assert_eq!(reason(field.start, Goal::Pose(bush)), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, Goal::Pose(Pose::new(-5.0, 20.0, 0.0))), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, disc(bush, 1.0)), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, Goal::Pose(court)), Some(PlanFailure::Disconnected));
        assert_eq!(reason(field.start, disc(court, 4.0)), Some(PlanFailure::Disconnected));
    }

    #[test]
    fn goals_that_cannot_be_are_answered() {
        let field = TestField::random(2, 25);
        let mut planner = planner(&field, 2);
        for wild in [f64::NAN, f64::INFINITY, -1e300, 1e9, -5.0] {
            let disc = GoalDisc { centre: DVec2::new(wild, 20.0), radius_m: 3.0 };
            assert_eq!(planner.plan(field.start, disc.into()).path, Err(PlanFailure::GoalBlocked), "{wild}");
            let pose = Goal::Pose(Pose { x: wild, y: 5.0, heading: 0.0 });
            assert_eq!(planner.plan(field.start, pose).path, Err(PlanFailure::GoalBlocked), "{wild}");
            let turned = Goal::Pose(Pose { heading: if wild.is_finite() { f64::NAN } else { wild }, ..field.start });
            assert_eq!(planner.plan(field.start, turned).path, Err(PlanFailure::GoalBlocked), "{wild}");
        }
    }

    #[test]
    fn the_report_counts_what_was_built_and_the_same_seed_builds_the_same() {
        let field = TestField::random(3, 25);
        let (one, two) = (planner(&field, 3), planner(&field, 3));
        let counts = |planner: &PrmRs| {
            let BuildReport { samples, draws, edges, components, .. } = planner.build_report();
            [samples, draws, edges, components]
        };
        assert_eq!(counts(&one), counts(&two));
        let poses = |planner: &PrmRs| -> Vec<Pose> {
            (0..planner.roadmap.node_count() as u32).map(|node| planner.roadmap.pose(node)).collect()
        };
        assert_eq!(poses(&one), poses(&two));
        let [samples, draws, edges, components] = counts(&one);
        assert!(samples >= 100 && draws >= samples && edges >= samples && (1..samples / 10).contains(&components));
    }

    #[test]
    fn without_a_roadmap_motions_and_the_lattice_search_do_it() {
        let mut field = TestField::random(5, 25);
        let settings = PrmRsSettings { samples: 0, corner_places: 0, ..PrmRsSettings::default() };
        let streams = (rng::stream(5, "prm-rs"), rng::stream(5, "shortcuts"));
        let mut bare = PrmRs::build(
            &field.checker,
            &MemoryMeter::unlimited(),
            &settings,
            &HybridSettings::default(),
            streams.0,
            streams.1,
        );
        for _ in 0..10 {
            let goal = field.random_goal();
            let plan = bare.plan(field.start, goal.into());
            assert!(plan.path.is_ok() && plan.effort.roadmap_expansions == 0);
        }
    }

    #[test]
    fn a_full_field_builds_nothing() {
        let field = TestField::drawn(&["####", "####", "####"], Pose::new(9.0, 9.0, 0.0));
        let report = planner(&field, 1).build_report();
        assert_eq!((report.samples, report.edges, report.components), (0, 0, 0));
    }
}
