//! Whether the truck can get somewhere at all, and a way there when its planner knows none.
//!
//! A flood over a lattice of (x, y, heading) spreads from a root pose in arcs and straights, forward and reverse. Every
//! motion can be driven back, so one flood answers for every pose that the truck drives to from the root. A yes is
//! proven by a path. A no means: not at the resolution of the finest of the [`LATTICES`], or not through any passage as
//! wide as the body, or not within the finest lattice's limit of [`flood::MAX_POSES`] poses.
//!
//! Most questions are answered by the coarsest lattice, which grows only as far as it is asked. Where that says no, the
//! passages and then the finer lattices are asked, each some ten times as costly as the one before.

mod flood;
mod floods;
mod passages;

use crate::collision::CollisionChecker;
use crate::geometry::{FieldFrame, Pose};
use crate::planning::kit::local_search;
use crate::planning::kit::local_search::{Ending, Floor, Search, Task};
use crate::vehicle::Path;

use crate::planning::GoalDisc;
use crate::planning::kit::local_search::PrimitiveSettings;
use crate::planning::memory::MemoryMeter;
pub(super) use flood::Flood;
pub(super) use floods::Floods;

/// A lattice of poses: one pose a bin, joined by motions of one length.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    pub bin_m: f64,
    /// Bins a full turn.
    pub headings: u32,
    pub step_m: f64,
}

/// Lattices of the floods, coarsest first. The short motions of the last can turn the truck about in tight pockets.
pub const LATTICES: [Lattice; 3] = [
    Lattice { bin_m: 10.0, headings: 24, step_m: 14.0 },
    Lattice { bin_m: 5.0, headings: 24, step_m: 7.0 },
    Lattice { bin_m: 1.25, headings: 72, step_m: 1.5 },
];

/// What the body keeps from bushes and border.
pub(super) const CLEARANCE_M: f64 = 0.03;

/// Lattices for a search from any pose, with the expansions that each may cost.
const SEARCHES: [(Lattice, u32); 2] =
    [(Lattice { bin_m: 2.5, headings: 24, step_m: 4.0 }, 20_000), (LATTICES[2], 60_000)];
/// More greed than the planner has: these searches are the last resort, and large.
const SEARCH_WEIGHT: f64 = 2.0;

/// Answers for one truck on one field, worked out when asked and kept.
#[derive(Debug)]
pub struct Reachability {
    checker: CollisionChecker,
    memory: MemoryMeter,
    floods: Floods,
    /// One for each of the [`SEARCHES`], `None` until asked for.
    searches: [Option<Search>; SEARCHES.len()],
}

impl Reachability {
    /// Prepares to answer; `root` is a free pose of the truck, usually its start.
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, root: Pose) -> Self {
        let floods = Floods::new(checker, memory, root);
        Self { checker: checker.clone(), memory: memory.clone(), floods, searches: Default::default() }
    }

    pub fn root(&self) -> Pose {
        self.floods.root()
    }

    /// Whether the truck can drive from the root into a disc.
    pub fn reaches(&mut self, disc: GoalDisc) -> bool {
        self.pose_in(disc.inner()).is_some()
    }

    /// A path from the root into a disc, not a short one.
    pub fn path_to(&mut self, disc: GoalDisc) -> Option<Path> {
        self.pose_in(disc.inner()).map(|(rung, pose)| self.floods.on(rung).path_to(pose))
    }

    /// The coarsest flood that has a pose in the disc, and that pose.
    fn pose_in(&mut self, disc: GoalDisc) -> Option<(usize, u32)> {
        for rung in 0..LATTICES.len() {
            if rung == 1 && self.floods.exclude(disc) {
                return None;
            }
            if let Some(pose) = self.floods.on(rung).pose_in(disc, u32::MAX) {
                return Some((rung, pose));
            }
        }
        None
    }

    /// The most bytes that floods and searches take on a field.
    pub fn most_bytes(frame: &FieldFrame) -> u64 {
        let searches: u64 = SEARCHES.iter().map(|&(_, budget)| Search::most_bytes(budget)).sum();
        searches + Floods::most_bytes(frame, LATTICES.len(), u32::MAX)
    }

    /// A path from any free pose into a disc by a large search, and the nodes that it expanded.
    ///
    /// It may fail where the flood says yes; then the truck can go back to the root and take [`Self::path_to`].
    pub fn search(&mut self, from: Pose, disc: GoalDisc) -> (Option<Path>, u32) {
        let disc = disc.inner();
        let clearance = self.checker.clearance(from);
        let mut expansions = 0;
        if clearance <= 0.0 {
            return (None, expansions);
        }
        let floor = Floor::new(CLEARANCE_M, from, clearance);
        let task = Task { checker: &self.checker, floor, start: from, waypoints: &[], goal: disc.into() };
        for (search, (lattice, budget)) in self.searches.iter_mut().zip(SEARCHES) {
            let search = search.get_or_insert_with(|| search_on(&self.checker, &self.memory, lattice));
            let mut segments = Vec::new();
            let ending = search.run(&task, budget, &mut segments);
            expansions += search.expansions;
            if ending == Ending::Found {
                return (Some(Path { start: from, segments: local_search::join(&segments) }), expansions);
            }
        }
        (None, expansions)
    }
}

/// A search without waypoints on a lattice of its own.
fn search_on(checker: &CollisionChecker, memory: &MemoryMeter, lattice: Lattice) -> Search {
    let settings = PrimitiveSettings {
        step_m: lattice.step_m,
        bin_m: lattice.bin_m,
        headings: lattice.headings,
        heuristic_weight: SEARCH_WEIGHT,
        ..PrimitiveSettings::default()
    };
    Search::new(checker, memory, &settings, None)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::planning::reachability::passages::Passages;
    use crate::planning::test_fields::{TestField, assert_drivable};

    #[test]
    fn a_disc_without_bounds_is_reached_where_the_truck_stands() {
        let field = TestField::random(1, 45);
        let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
        let everywhere = GoalDisc { centre: DVec2::new(50.0, 50.0), radius_m: f64::INFINITY };
        for _ in 0..2 {
            assert_eq!(reachability.path_to(everywhere), Some(Path::standing(field.start)));
        }
    }

    #[test]
    fn paths_of_the_flood_lead_from_the_root_into_the_disc() {
        let mut reached = 0;
        for seed in 0..10 {
            let mut field = TestField::random(seed, 45);
            let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for _ in 0..20 {
                let goal = field.random_goal();
                let path = reachability.path_to(goal);
                assert_eq!(path.is_some(), reachability.reaches(goal));
                if let Some(path) = path {
                    assert_drivable(&field.checker, &path, field.start, goal);
                    reached += 1;
                }
            }
        }
        assert!(reached >= 195, "only {reached}");
    }

    #[test]
    fn answers_do_not_depend_on_what_was_asked_before() {
        let mut field = TestField::random(3, 45);
        let goals: Vec<GoalDisc> = (0..12).map(|_| field.random_goal()).collect();
        let mut forth = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
        let mut back = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
        let mut paths: Vec<_> = goals.iter().map(|&goal| forth.path_to(goal)).collect();
        paths.reverse();
        assert_eq!(paths, goals.iter().rev().map(|&goal| back.path_to(goal)).collect::<Vec<_>>());
    }

    #[test]
    fn searches_from_anywhere_find_what_the_flood_reaches() {
        for seed in 0..6 {
            let mut field = TestField::random(seed, 45);
            let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            let mut pose = field.start;
            for _ in 0..6 {
                let goal = field.random_goal();
                if !reachability.reaches(goal) || in_disc(&field, pose, goal) {
                    continue;
                }
                let (path, expansions) = reachability.search(pose, goal);
                let path = path.expect("the flood reaches it");
                assert_drivable(&field.checker, &path, pose, goal);
                assert!(expansions > 0);
                pose = path.end();
            }
        }
    }

    #[test]
    fn searches_do_not_depend_on_what_was_searched_before() {
        let mut field = TestField::random(3, 45);
        let goals: Vec<GoalDisc> = (0..6).map(|_| field.random_goal()).collect();
        let mut kept = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
        for &goal in goals.iter().chain(goals.iter().rev()) {
            let mut fresh = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            assert_eq!(kept.search(field.start, goal), fresh.search(field.start, goal));
        }
    }

    fn in_disc(field: &TestField, pose: Pose, goal: GoalDisc) -> bool {
        field.checker.body().body_centre(pose).distance(goal.centre) <= goal.radius_m
    }

    /// A court with one gate: as wide as a cell, or shut, or open at a corner only.
    fn court(gate: &'static str) -> TestField {
        let picture = [
            "....................",
            "....................",
            "........########....",
            "........#......#....",
            "........#......#....",
            gate,
            "........#......#....",
            "........########....",
            "....................",
            "....................",
        ];
        TestField::drawn(&picture, Pose::new(12.0, 22.0, 0.0))
    }

    #[test]
    fn a_walled_in_place_is_out_of_reach_without_a_fine_flood() {
        let goal = GoalDisc { centre: DVec2::new(60.0, 25.0), radius_m: 4.0 };
        let shut = court("........#......#....");
        let mut reachability = Reachability::new(&shut.checker, &MemoryMeter::unlimited(), shut.start);
        assert!(!reachability.reaches(goal));
        assert!(!reachability.floods.has(1) && !reachability.floods.has(2));
        let open = court("...............#....");
        assert!(Reachability::new(&open.checker, &MemoryMeter::unlimited(), open.start).reaches(goal));
    }

    #[test]
    fn passages_exclude_nothing_that_the_flood_reaches() {
        for seed in 0..10 {
            let field = TestField::random(seed, 60);
            let mut flood =
                Flood::new(&field.checker, &MemoryMeter::unlimited(), field.start, LATTICES[1], CLEARANCE_M);
            let passages = Passages::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for &centre in &field.bushes {
                let goal = GoalDisc { centre, radius_m: 6.0 };
                assert!(!(passages.exclude(goal) && flood.pose_in(goal, u32::MAX).is_some()));
            }
        }
    }

    #[test]
    fn a_blocked_root_reaches_nothing() {
        let field = court("........#......#....");
        let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), Pose::new(42.0, 40.0, 0.0));
        assert!(!reachability.reaches(GoalDisc { centre: DVec2::new(42.0, 40.0), radius_m: 30.0 }));
        assert_eq!(
            reachability.search(Pose::new(42.0, 40.0, 0.0), GoalDisc { centre: DVec2::ZERO, radius_m: 30.0 }).1,
            0
        );
    }
}
