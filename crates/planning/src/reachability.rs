//! Reachability: whether the truck can get somewhere at all, and a path there when its planner finds none.
//!
//! The [`floods`](crate::kit::floods) from its start answer. Most questions are answered by the coarsest
//! lattice, which grows only as far as it is asked. Where that says no, the passages and then the finer lattices are
//! asked, each some ten times as costly as the one before.

pub use super::kit::floods::LATTICES;

use crate::collision::CollisionChecker;
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::Path;

use super::GoalDisc;
use super::kit::clearance_profile::ClearanceProfile;
use super::kit::floods::{CLEARANCE_M, Floods};
use super::kit::lattice::Lattice;
use super::kit::local_search::{PrimitiveQuery, PrimitiveSearch, PrimitiveSettings};
use super::kit::vehicle_units::VehicleUnits;
use super::memory::MemoryMeter;

/// Lattices for a search from any pose, with the expansions that each may cost.
const SEARCHES: [(Lattice, u32); 2] =
    [(Lattice { bin_m: 2.5, headings: 24, step_m: 4.0 }, 20_000), (LATTICES[2], 60_000)];
/// More greed than the planner has: these searches are the last resort, and large.
const SEARCH_WEIGHT: f64 = 2.0;

/// The reachability of goals for one truck on one field, computed on demand and kept.
#[derive(Debug)]
pub struct Reachability {
    checker: CollisionChecker,
    memory: MemoryMeter,
    floods: Floods,
    /// One for each of the [`SEARCHES`], `None` until asked for.
    searches: [Option<PrimitiveSearch>; SEARCHES.len()],
    /// The same in units of the vehicle, which is asked where this finds no way; `None` until then.
    scaled: Option<Option<Box<(VehicleUnits, Self)>>>,
}

impl Reachability {
    /// Creates a query object for floods from `root`, a free pose of the truck, usually its start.
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, root: Pose) -> Self {
        let floods = Floods::new(checker, memory, root);
        Self { checker: checker.clone(), memory: memory.clone(), floods, searches: Default::default(), scaled: None }
    }

    pub fn root(&self) -> Pose {
        self.floods.root()
    }

    /// Returns whether the truck can drive from the root into a disc.
    pub fn reaches(&mut self, disc: GoalDisc) -> bool {
        let disc = disc.with_margin();
        self.floods.reach(disc) || self.scaled().is_some_and(|(units, scaled)| scaled.floods.reach(units.disc(disc)))
    }

    /// Returns a path from the root into a disc, not necessarily a short one.
    pub fn path_to(&mut self, disc: GoalDisc) -> Option<Path> {
        let (root, disc) = (self.root(), disc.with_margin());
        self.floods.path_into(disc).or_else(|| {
            let (units, scaled) = self.scaled()?;
            Some(units.path_from(root, &scaled.floods.path_into(units.disc(disc))?))
        })
    }

    /// Returns the vehicle's units with the floods in them, unless it is as long as the contest's truck.
    fn scaled(&mut self) -> Option<&mut (VehicleUnits, Self)> {
        let root = self.root();
        let made = self.scaled.get_or_insert_with(|| {
            let units = VehicleUnits::new(&self.checker)?;
            let scaled = Self::new(&units.checker, &self.memory, units.pose(root));
            Some(Box::new((units, scaled)))
        });
        made.as_deref_mut()
    }

    /// Finds a path from any free pose into a disc by a large search; adds the nodes that it expanded to `expansions`.
    ///
    /// It may fail where the flood says yes; then the truck can go back to the root and take [`Self::path_to`].
    pub fn search(&mut self, from: Pose, disc: GoalDisc, expansions: &mut u32) -> Option<Path> {
        let clearance = self.checker.clearance(from);
        if clearance <= 0.0 {
            return None;
        }
        let profile = ClearanceProfile::from_start(CLEARANCE_M, from, clearance);
        let goal = disc.with_margin().into();
        let query = PrimitiveQuery { checker: &self.checker, profile: &profile, start: from, waypoints: &[], goal };
        // The coarse lattice first, which needs far fewer expansions for the same way.
        for (search, (lattice, budget)) in self.searches.iter_mut().zip(SEARCHES) {
            let search = search.get_or_insert_with(|| search_on(&self.checker, &self.memory, lattice));
            let found = search.run(&query, budget);
            *expansions += search.expansions();
            if let Ok(path) = found {
                return Some(path.joined());
            }
        }
        let (units, scaled) = self.scaled()?;
        let path = scaled.search(units.pose(from), units.disc(disc), expansions)?;
        Some(units.path_from(from, &path))
    }
}

/// Creates a search without waypoints on a lattice of its own.
fn search_on(checker: &CollisionChecker, memory: &MemoryMeter, lattice: Lattice) -> PrimitiveSearch {
    let settings = PrimitiveSettings {
        step_m: lattice.step_m,
        bin_m: lattice.bin_m,
        headings: lattice.headings,
        heuristic_weight: SEARCH_WEIGHT,
        ..PrimitiveSettings::default()
    };
    PrimitiveSearch::new(checker, memory, &settings, None)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::test_fields::{TestField, assert_drivable, court_with_gate};

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
    fn answers_do_not_depend_on_previous_queries() {
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
                let mut expansions = 0;
                let path = reachability.search(pose, goal, &mut expansions).expect("the flood reaches it");
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
            let (mut kept_expansions, mut fresh_expansions) = (0, 0);
            assert_eq!(
                kept.search(field.start, goal, &mut kept_expansions),
                fresh.search(field.start, goal, &mut fresh_expansions)
            );
            assert_eq!(kept_expansions, fresh_expansions);
        }
    }

    fn in_disc(field: &TestField, pose: Pose, goal: GoalDisc) -> bool {
        field.checker.body().body_centre(pose).distance(goal.centre) <= goal.radius_m
    }

    #[test]
    fn a_blocked_root_reaches_nothing() {
        let field = court_with_gate("........#......#....");
        let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), Pose::new(42.0, 40.0, 0.0));
        assert!(!reachability.reaches(GoalDisc { centre: DVec2::new(42.0, 40.0), radius_m: 30.0 }));
        let mut expansions = 0;
        let disc = GoalDisc { centre: DVec2::ZERO, radius_m: 30.0 };
        reachability.search(Pose::new(42.0, 40.0, 0.0), disc, &mut expansions);
        assert_eq!(expansions, 0);
    }
}
