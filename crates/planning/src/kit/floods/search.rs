//! Paths to goals by floods, coarsest lattice first.

use crate::collision::CollisionChecker;
use crate::kit::best_first::AnalyticExpansion;
use crate::kit::clearance_profile::ClearanceProfile;
use crate::kit::drive_cost::CostModel;
use crate::kit::ends::{explain_failure, free_ends};
use crate::kit::heuristic::PoseHeuristic;
use crate::kit::target::Target;
use crate::memory::MemoryMeter;
use crate::observer::PlanningObserver;
use crate::{Goal, GoalDisc, PlanFailure};
use wildfire_base::geometry::Pose;
use wildfire_base::query::SearchPhase;
use wildfire_base::vehicle::Path;

use super::flood::Flood;
use super::passages::{CorridorGraph, lies_in_pocket};
use super::{CLEARANCE_M, LATTICES};

/// Curves into the goal begin no farther than this from it.
const NEAR_M: f64 = 10.0;

/// The floods from one root, each computed when it is first needed.
#[derive(Debug)]
pub struct Floods {
    checker: CollisionChecker,
    memory: MemoryMeter,
    root: Pose,
    /// One for each of the [`LATTICES`].
    floods: [Option<Flood>; LATTICES.len()],
    passages: Option<CorridorGraph>,
}

impl Floods {
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, root: Pose) -> Self {
        Self { checker: checker.clone(), memory: memory.clone(), root, floods: Default::default(), passages: None }
    }

    pub fn root(&self) -> Pose {
        self.root
    }

    /// Returns whether the floods lead into a disc.
    pub fn reach(&mut self, disc: GoalDisc) -> bool {
        self.pose_in(disc).is_some()
    }

    /// Returns a path from the root into a disc, not necessarily a short one.
    pub fn path_into(&mut self, disc: GoalDisc) -> Option<Path> {
        let (place, pose) = self.pose_in(disc)?;
        Some(self.on(place).path_to(pose))
    }

    /// Returns the coarsest flood that has a pose in the disc, and that pose.
    fn pose_in(&mut self, disc: GoalDisc) -> Option<(usize, u32)> {
        // Else all of a large field would be flooded before the finest lattice said no. A goal that the floods have
        // come to already needs no such proof.
        let is_reached = self.floods[0].as_ref().is_some_and(|flood| flood.found_in(disc, u32::MAX).next().is_some());
        if !is_reached && lies_in_pocket(&self.checker, self.root, disc) {
            return None;
        }
        for place in 0..LATTICES.len() {
            // The finer floods are some ten times as costly each, so that a proof is worth its time first.
            if place == 1 && self.exclude(disc) {
                return None;
            }
            if let Some(pose) = self.on(place).pose_in(disc, u32::MAX) {
                return Some((place, pose));
            }
        }
        None
    }

    /// Returns the flood on a lattice, by its place among the [`LATTICES`].
    fn on(&mut self, place: usize) -> &mut Flood {
        let Self { checker, memory, root, floods, .. } = self;
        floods[place].get_or_insert_with(|| Flood::new(checker, memory, *root, LATTICES[place]))
    }

    /// Returns whether no way for the body's centre leads into a disc: proof that no lattice has one.
    fn exclude(&mut self, disc: GoalDisc) -> bool {
        self.passages.get_or_insert_with(|| CorridorGraph::new(&self.checker, &self.memory, self.root)).exclude(disc)
    }
}

/// A query to floods.
#[derive(Clone, Copy, Debug)]
pub struct FloodQuery {
    pub start: Pose,
    pub goal: Goal,
    /// The maximum number of poses from which floods may spread.
    pub budget: u32,
    /// The number of lattices that are tried, coarsest first.
    pub lattices: usize,
}

impl FloodQuery {
    /// Creates a query of all lattices without a budget.
    pub fn new(start: Pose, goal: Goal) -> Self {
        Self { start, goal, budget: u32::MAX, lattices: LATTICES.len() }
    }
}

/// Finds paths to goals of any kind by floods from their starts.
///
/// A goal disc is met by a pose in it. A goal pose, or a disc too small to hold a pose of the lattice, is met by a
/// Reeds-Shepp curve, or by a turn and a straight, from a pose near it, the cheapest first.
///
/// It keeps the floods of the last start, so that more goals from there cost little more. Effort counts what a query
/// would have spread from on its own.
#[derive(Debug)]
pub struct FloodSearch {
    checker: CollisionChecker,
    memory: MemoryMeter,
    /// Finds the shortest ways into goals.
    heuristic: PoseHeuristic,
    floods: Option<Floods>,
    /// Poses that may still be spread from.
    left: u32,
}

impl FloodSearch {
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter) -> Self {
        Self {
            checker: checker.clone(),
            memory: memory.clone(),
            heuristic: PoseHeuristic::new(CostModel::Length { cusp_m: 0.0 }, checker.body()),
            floods: None,
            left: 0,
        }
    }

    /// Finds a path within the budget; adds the number of poses from which the floods spread to `expansions`.
    pub fn find_within(
        &mut self,
        query: &FloodQuery,
        observer: &mut dyn PlanningObserver,
        expansions: &mut u32,
    ) -> Result<Path, PlanFailure> {
        self.left = query.budget;
        let path = self.find(query, observer);
        *expansions += query.budget - self.left;
        path
    }

    fn find(&mut self, query: &FloodQuery, observer: &mut dyn PlanningObserver) -> Result<Path, PlanFailure> {
        let &FloodQuery { start, goal, lattices, .. } = query;
        let profile = ClearanceProfile::new(CLEARANCE_M, free_ends(&self.checker, start, Target::from(&goal))?);
        // A flood is of one start: of another one it says nothing.
        let kept = self.floods.take().filter(|floods| floods.root() == start);
        let mut floods = kept.unwrap_or_else(|| Floods::new(&self.checker, &self.memory, start));
        let mut path = Err(PlanFailure::Disconnected);
        for place in 0..lattices {
            // The proof is cheap beside a finer flood, and only needed if the coarse one failed.
            if place > 0 && floods.exclude(goal.disc(self.checker.body())) {
                path = Err(PlanFailure::Disconnected);
                break;
            }
            let flood = floods.on(place);
            // A flood that is kept had spread already; only what this query would have spread from is counted.
            let left = self.left;
            let found = self.meet(flood, goal, &profile);
            observer.on_edges_examined(SearchPhase::Local, &mut flood.reached(left - self.left));
            if let Some(found) = found {
                path = Ok(found);
                break;
            }
            // An unfinished flood proves nothing about the goal.
            if self.left == 0 || flood.is_full() {
                path = Err(PlanFailure::BudgetSpent);
            }
        }
        self.floods = Some(floods);
        path.map_err(|failure| explain_failure(&self.checker, Target::from(&goal), failure))
    }

    /// Finds a path by one flood.
    fn meet(&mut self, flood: &mut Flood, goal: Goal, profile: &ClearanceProfile) -> Option<Path> {
        let budget = self.left;
        if let Goal::Disc(disc) = goal
            && let Some(pose) = flood.pose_in(disc, budget)
        {
            self.left -= flood.spreads_to(pose);
            return Some(flood.path_to(pose));
        }
        self.left -= flood.grow(budget);
        self.expand_analytically(flood, goal, profile, budget)
    }

    /// Goes from a pose near the goal into it, by the cheapest curve that is free.
    fn expand_analytically(&self, flood: &Flood, goal: Goal, profile: &ClearanceProfile, budget: u32) -> Option<Path> {
        let disc = goal.disc(self.checker.body());
        // A lattice pose is rarely in a small goal, but a short curve from beside it may end there.
        let near = GoalDisc { radius_m: disc.radius_m + NEAR_M, ..disc };
        let ways = flood.found_in(near, budget).filter_map(|index| {
            let pose = flood.path_to(index).end();
            Some((index, pose, self.heuristic.without_bushes(pose, None, Target::from(&goal)).expansion?))
        });
        let mut ways: Vec<(u32, Pose, AnalyticExpansion)> = ways.collect();
        // All are priced before any is swept, as sweeps cost the most; ties by index keep runs alike.
        ways.sort_by(|(index, _, one), (other, _, two)| one.cost.total_cmp(&two.cost).then(index.cmp(other)));
        let is_free = |pose, way: &AnalyticExpansion| profile.way_is_free(&self.checker, pose, way.segments());
        let (index, _, way) = ways.into_iter().find(|(_, pose, way)| is_free(*pose, way))?;
        let mut path = flood.path_to(index);
        path.segments.extend(way.segments());
        Some(path.joined())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_fields::{TestField, court_with_gate};
    use glam::DVec2;

    #[test]
    fn a_walled_in_place_is_out_of_reach_without_a_fine_flood() {
        let goal = GoalDisc { centre: DVec2::new(60.0, 25.0), radius_m: 4.0 };
        let shut = court_with_gate("........#......#....");
        let mut floods = Floods::new(&shut.checker, &MemoryMeter::unlimited(), shut.start);
        assert!(!floods.reach(goal));
        assert!(floods.floods[1].is_none() && floods.floods[2].is_none());
        let open = court_with_gate("...............#....");
        assert!(Floods::new(&open.checker, &MemoryMeter::unlimited(), open.start).reach(goal));
    }

    #[test]
    fn passages_exclude_nothing_that_the_flood_reaches() {
        for seed in 0..10 {
            let field = TestField::random(seed, 60);
            let mut flood = Flood::new(&field.checker, &MemoryMeter::unlimited(), field.start, LATTICES[1]);
            let passages = CorridorGraph::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for &centre in &field.bushes {
                let goal = GoalDisc { centre, radius_m: 6.0 };
                assert!(!(passages.exclude(goal) && flood.pose_in(goal, u32::MAX).is_some()));
            }
        }
    }

    #[test]
    fn small_pockets_are_those_that_the_passages_exclude() {
        let mut pockets = 0;
        for seed in 0..4 {
            let field = TestField::random(seed, 100);
            let passages = CorridorGraph::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for &centre in field.bushes.iter().step_by(3) {
                for radius_m in [0.0, 6.0] {
                    let goal = GoalDisc { centre, radius_m };
                    let is_pocket = lies_in_pocket(&field.checker, field.start, goal);
                    assert!(!is_pocket || passages.exclude(goal), "seed {seed}: {goal:?}");
                    pockets += u32::from(is_pocket && radius_m == 6.0);
                }
            }
        }
        assert!(pockets > 0, "{pockets}");
        let shut = court_with_gate("........#......#....");
        let goal = GoalDisc { centre: DVec2::new(60.0, 25.0), radius_m: 4.0 };
        assert!(lies_in_pocket(&shut.checker, shut.start, goal));
    }
}
