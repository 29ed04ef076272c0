//! The planner `lattice`: a flood over a lattice of poses, slow, and complete at its resolution.
//!
//! The flood of [`super::reachability`] spreads from the start over one lattice after the other until it meets the goal:
//! over bins of 10 m and 24 headings, of 5 m and 24 headings, and of 1.25 m and 72 headings. A goal disc is met by a
//! pose in it. A goal pose, or a disc too small to hold a pose of the lattice, is met by a Reeds-Shepp curve, or by a
//! turn and a straight, from a pose within 10 m of it, the cheapest first. A no means: not at the finest resolution, or
//! not through any passage as wide as the body. Paths are drivable, and not short.

mod settings;

pub use settings::{LatticeSettings, Maker};

use crate::collision::CollisionChecker;
use crate::geometry::{FieldFrame, Pose};
use crate::time::cpu::CpuStopwatch;
use crate::vehicle::Path;

use crate::planning::kit::clearance_profile::ClearanceFloor;
use crate::planning::kit::ends::{free_ends, has_free_pose};
use crate::planning::kit::heuristic::{Approach, Lookout};
use crate::planning::kit::local_search;
use crate::planning::memory::{MemoryMeter, PlannerMemory};
use crate::planning::reachability::{CLEARANCE_M, Flood, Floods, LATTICES};
use crate::planning::search_graph::{SearchPhase, SearchRecorder, Searched};
use crate::planning::{
    BuildReport, Effort, Found, FoundBy, Goal, GoalDisc, Plan, PlanFailure, QueryTime, TruckPlanner,
};

/// From so far beyond the goal it is approached by curves.
const NEAR_M: f64 = 10.0;

/// The planner for one body on one field.
///
/// It keeps the floods of the last start, so that more goals from there cost little more. Effort counts what a query
/// would have spread from on its own.
#[derive(Debug)]
pub struct LatticePlanner {
    checker: CollisionChecker,
    settings: LatticeSettings,
    memory: MemoryMeter,
    /// Finds the shortest approaches.
    lookout: Lookout,
    floods: Option<Floods>,
    /// Poses that may still be spread from.
    left: u32,
    recorder: SearchRecorder,
}

impl LatticePlanner {
    pub fn build(checker: &CollisionChecker, memory: &MemoryMeter, settings: &LatticeSettings) -> Self {
        Self {
            checker: checker.clone(),
            settings: settings.clone(),
            memory: memory.clone(),
            lookout: Lookout::new(0.0, checker.body()),
            floods: None,
            left: 0,
            recorder: SearchRecorder::default(),
        }
    }

    /// The most bytes that it takes.
    pub fn memory(frame: &FieldFrame, settings: &LatticeSettings) -> PlannerMemory {
        let floods = Floods::most_bytes(frame, LATTICES.len(), settings.max_expansions);
        PlannerMemory { floods, ..PlannerMemory::default() }
    }

    /// What the last query looked at, if that is recorded.
    pub fn take_searched(&mut self) -> Option<Searched> {
        self.recorder.take(SearchPhase::Local)
    }

    /// A path by one of the first few lattices that spreads from no more than `budget` poses, and from how many it did.
    pub fn find_within(
        &mut self,
        budget: u32,
        lattices: usize,
        start: Pose,
        goal: Goal,
    ) -> (Result<Path, PlanFailure>, u32) {
        self.left = budget;
        let path = self.find(start, goal, lattices);
        (path, budget - self.left)
    }

    fn find(&mut self, start: Pose, goal: Goal, lattices: usize) -> Result<Path, PlanFailure> {
        let floor = ClearanceFloor::new(CLEARANCE_M, free_ends(&self.checker, start, goal)?);
        let kept = self.floods.take().filter(|floods| floods.root() == start);
        let mut floods = kept.unwrap_or_else(|| Floods::new(&self.checker, &self.memory, start));
        let path = self.climb(&mut floods, goal, &floor, lattices);
        self.floods = Some(floods);
        path.map_err(|failure| match goal {
            Goal::Disc(disc) if !has_free_pose(&self.checker, disc) => PlanFailure::GoalBlocked,
            _ => failure,
        })
    }

    /// One lattice after the other, until a flood meets the goal.
    fn climb(
        &mut self,
        floods: &mut Floods,
        goal: Goal,
        floor: &ClearanceFloor,
        lattices: usize,
    ) -> Result<Path, PlanFailure> {
        let mut failure = PlanFailure::Disconnected;
        for rung in 0..lattices {
            if rung > 0 && floods.exclude(self.disc(goal)) {
                return Err(PlanFailure::Disconnected);
            }
            let flood = floods.on(rung);
            let left = self.left;
            let path = self.meet(flood, goal, floor);
            self.recorder.add(flood.reached(left - self.left));
            if let Some(path) = path {
                return Ok(path);
            }
            if self.left == 0 || flood.is_full() {
                failure = PlanFailure::BudgetSpent;
            }
        }
        Err(failure)
    }

    /// A path by one flood.
    fn meet(&mut self, flood: &mut Flood, goal: Goal, floor: &ClearanceFloor) -> Option<Path> {
        let budget = self.left;
        if let Goal::Disc(disc) = goal
            && let Some(pose) = flood.pose_in(disc, budget)
        {
            self.left -= flood.spreads_to(pose);
            return Some(flood.path_to(pose));
        }
        self.left -= flood.grow(budget);
        self.approach(flood, goal, floor, budget)
    }

    /// From a pose near the goal into it, by the cheapest curve that is free.
    fn approach(&self, flood: &Flood, goal: Goal, floor: &ClearanceFloor, budget: u32) -> Option<Path> {
        let disc = self.disc(goal);
        let near = GoalDisc { radius_m: disc.radius_m + NEAR_M, ..disc };
        let approach = |pose| self.lookout.without_bushes(pose, None, goal).approach;
        let ways = flood.known_in(near, budget).filter_map(|index| {
            let pose = flood.path_to(index).end();
            Some((index, pose, approach(pose)?))
        });
        let mut ways: Vec<(u32, Pose, Approach)> = ways.collect();
        ways.sort_by(|(index, _, one), (other, _, two)| one.cost.total_cmp(&two.cost).then(index.cmp(other)));
        let free = ways.into_iter().find(|(_, pose, way)| floor.way_is_free(&self.checker, *pose, way.segments()));
        free.map(|(index, _, way)| {
            let Path { start, mut segments } = flood.path_to(index);
            segments.extend(way.segments());
            Path { start, segments: local_search::join(&segments) }
        })
    }

    /// The goal as places for the body's centre.
    fn disc(&self, goal: Goal) -> GoalDisc {
        match goal {
            Goal::Disc(disc) => disc,
            Goal::Pose(end) => GoalDisc { centre: self.checker.body().body_centre(end), radius_m: 0.0 },
        }
    }
}

impl TruckPlanner for LatticePlanner {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn record_searches(&mut self) {
        self.recorder.switch_on();
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut watch = CpuStopwatch::start();
        let budget = self.settings.max_expansions;
        let (path, local_expansions) = self.find_within(budget, LATTICES.len(), start, goal.inner());
        let effort = Effort { roadmap_expansions: 0, local_expansions };
        let time = QueryTime { local: watch.lap(), ..QueryTime::default() };
        let found = path.map(|path| Found { path, by: FoundBy::Lattice });
        Plan::new(found, effort, time, Vec::from_iter(self.take_searched()))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::planning::planners::hybrid_astar::{HybridAstar, HybridSettings};
    use crate::planning::test_fields::{
        TestField, assert_ends_in, drives_in_a_row, least_clearance, random_free_pose, shut_court,
    };
    use crate::rng;

    fn planner(field: &TestField) -> LatticePlanner {
        LatticePlanner::build(&field.checker, &MemoryMeter::unlimited(), &LatticeSettings::default())
    }

    #[test]
    fn drives_in_a_row_reach_whatever_the_flood_reaches() {
        let drives = drives_in_a_row(4, 45, |field, _| planner(field));
        assert!(drives.missed == 0 && drives.solved > 60, "{drives:?}");
    }

    #[test]
    fn poses_and_places_that_another_planner_reaches_are_reached() {
        let mut reached = 0;
        for seed in 0..6 {
            let mut field = TestField::random(seed, 40);
            let mut lattice = planner(&field);
            let mut hybrid = HybridAstar::build(
                &field.checker,
                &MemoryMeter::unlimited(),
                &HybridSettings::default(),
                rng::stream(seed, "lattice"),
            );
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
    fn answers_and_effort_do_not_depend_on_what_was_asked_before() {
        let mut field = TestField::random(3, 40);
        let mut goals: Vec<Goal> = (0..6).map(|_| Goal::Disc(field.random_goal())).collect();
        goals.extend((0..4).map(|_| Goal::Pose(random_free_pose(&mut field, 0.3))));
        let mut kept = planner(&field);
        for &goal in goals.iter().chain(goals.iter().rev()) {
            let (plan, fresh) = (kept.plan(field.start, goal), planner(&field).plan(field.start, goal));
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
        let short = LatticeSettings { max_expansions: 3, ..LatticeSettings::default() };
        let plan = LatticePlanner::build(&field.checker, &MemoryMeter::unlimited(), &short).plan(field.start, behind);
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
            let with = |max_expansions| {
                let settings = LatticeSettings { max_expansions, ..LatticeSettings::default() };
                LatticePlanner::build(&field.checker, &MemoryMeter::unlimited(), &settings).plan(field.start, goal)
            };
            assert_eq!(with(spent).path, ample.path);
            // A curve from near the goal may still lead into it.
            let less = with(spent - 1);
            assert_eq!(less.effort.local_expansions, spent - 1);
            assert!(less.path.is_ok() || less.path == Err(PlanFailure::BudgetSpent));
        }
    }
}
