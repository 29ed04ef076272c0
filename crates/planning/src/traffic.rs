//! Paths of trucks that meet others: around a truck in the way, and aside to let another truck pass.

use crate::collision::CollisionChecker;
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Path, Segment};

use super::kit::best_first::{AnalyticExpansion, Candidate, Never, Node, PoseSearch, SearchOf, SearchSpace, Step};
use super::kit::clearance_profile::ClearanceProfile;
use super::kit::lattice::Lattice;
use super::kit::local_search::{LocalSearch, PrimitiveSettings};
use super::memory::MemoryMeter;
use super::observer::Unobserved;
use super::{Effort, GoalDisc};

/// A new path leaves the old one this far before the place where that is blocked.
const LEAVE_M: f64 = 20.0;
/// Nodes that the search for a way round may expand.
const MAX_EXPANSIONS: u32 = 250;

/// Finds a path into a disc that begins like `path`, which is blocked after `free_m` metres; also returns the effort.
///
/// `checker` knows what stands in the way, for instance another truck. The new path leaves the old one shortly before
/// that or, if that leads nowhere, at its start. It is a motion-primitive search straight for the disc, short and without
/// a roadmap, because what stands in the way is somewhere else each time.
pub fn replan_around(checker: &CollisionChecker, path: &Path, free_m: f64, disc: GoalDisc) -> (Option<Path>, Effort) {
    let settings = PrimitiveSettings { max_expansions: MAX_EXPANSIONS, ..PrimitiveSettings::default() };
    let mut search = LocalSearch::new(checker, &MemoryMeter::unlimited(), &settings, None);
    let mut from = |metres: f64| {
        let (mut kept, _) = path.split_at(metres);
        let rest = search.drive(kept.end(), &[], disc.with_margin().into(), &mut Unobserved).ok()?;
        kept.segments.extend(rest.path.segments);
        Some(kept)
    };
    let late = (free_m > LEAVE_M).then(|| from(free_m - LEAVE_M)).flatten();
    let path = late.or_else(|| from(0.0));
    (path, Effort { roadmap_expansions: 0, local_expansions: search.expansions() })
}

/// The lattice of the search for a place to stand.
const LATTICE: Lattice = Lattice { bin_m: 1.25, headings: 36, step_m: 2.5 };
/// Metres that a change of direction counts as.
const CUSP_M: f64 = 2.0;
/// The clearances that the body keeps from everything; the second where the first leads nowhere.
const CLEARANCES_M: [f64; 2] = [0.3, 0.03];
/// Poses that one search may look at.
const MAX_NODES: usize = 3_000;

/// Finds the cheapest path from `start` to a pose at which `may_stand` holds, by a search in all directions, for a
/// truck that has to make room. `None` if there is none.
///
/// The path has segments, so that a truck which may stand where it is gets a path to another place.
pub fn find_yield_pose(
    checker: &CollisionChecker,
    start: Pose,
    mut may_stand: impl FnMut(Pose) -> bool,
) -> Option<Path> {
    let own_m = checker.clearance(start);
    if own_m <= 0.0 {
        return None;
    }
    CLEARANCES_M.into_iter().find_map(|clearance_m| {
        let profile = ClearanceProfile::new(clearance_m, [(start, own_m)]);
        let mut space = YieldSpace { checker, profile, may_stand: &mut may_stand };
        let mut search = PoseSearch::new(checker.body(), LATTICE, &MemoryMeter::unlimited());
        search.begin(&mut space, [start], ());
        search.run(&mut space, u32::MAX).ok().map(Path::joined)
    })
}

/// Uniform cost in all directions; metres count, and changes of direction.
struct YieldSpace<'a, F> {
    checker: &'a CollisionChecker,
    profile: ClearanceProfile,
    may_stand: &'a mut F,
}

impl<F: FnMut(Pose) -> bool> SearchSpace for YieldSpace<'_, F> {
    type Mark = ();
    type Own = Never;

    const IS_UNINFORMED: bool = true;

    fn has_room(&mut self, search: &mut SearchOf<Self>) -> bool {
        search.node_count() < MAX_NODES
    }

    fn weight(&self) -> f64 {
        0.0
    }

    fn estimate(&mut self, _node: &mut Node<()>) -> Option<f64> {
        None
    }

    fn analytic_expansion(&self, _node: &Node<()>) -> AnalyticExpansion {
        unreachable!("no expansions are offered")
    }

    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<Never>) {
        let node = *search.node(from.node);
        for (index, motion) in search.motions.into_iter().enumerate() {
            let turns_back = node.turns_back(motion.is_reverse());
            let cost = node.cost + LATTICE.step_m + if turns_back { CUSP_M } else { 0.0 };
            search.push(cost, cost, from.node, Step::Motion { index: index as u8 });
        }
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.profile.motion_is_free(self.checker, from, motion)
    }

    fn take(&mut self, _: &mut SearchOf<Self>, _: Candidate<Never>, own: Never) -> Option<u32> {
        match own {}
    }

    fn is_goal(&mut self, pose: Pose) -> bool {
        (self.may_stand)(pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_fields::{TestField, assert_drivable, least_clearance};
    use glam::DVec2;

    #[test]
    fn a_detour_leads_round_what_stands_on_the_path_and_nowhere_through_it() {
        let start = Pose::new(10.0, 50.0, 0.0);
        let open = TestField::drawn(&["...................."; 20], start);
        let lane = TestField::drawn(&["####################", "....................", "####################"], start);
        let ahead = |metres: f64| Path { start, segments: vec![Segment { curvature: 0.0, length_m: metres }] };
        let disc = GoalDisc { centre: DVec2::new(90.0, 50.0), radius_m: 10.0 };
        let body = *open.checker.body();
        let crowded = open.checker.with_obstacles([body.footprint(Pose::new(60.0, 50.0, 1.5))]);
        let (path, effort) = replan_around(&crowded, &ahead(75.0), 45.0, disc);
        let path = path.expect("the field is wide");
        assert_drivable(&crowded, &path, start, disc);
        assert!(path.length_m() < 85.0 && effort.local_expansions > 0, "{path:?}");
        assert_eq!(path.pose_at(24.9), ahead(75.0).pose_at(24.9), "it leaves the path shortly before");

        let start = Pose::new(10.0, 7.5, 0.0);
        let crowded = lane.checker.with_obstacles([body.footprint(Pose::new(60.0, 7.5, 0.0))]);
        let disc = GoalDisc { centre: DVec2::new(90.0, 7.5), radius_m: 10.0 };
        assert!(replan_around(&crowded, &Path { start, ..ahead(75.0) }, 45.0, disc).0.is_none());
    }

    #[test]
    fn a_truck_finds_the_niche_beside_a_passage_and_none_where_there_is_none() {
        let with_niche =
            ["####################", "##########.....#####", "....................", "####################"];
        let without = ["####################", "####################", "....................", "####################"];
        let start = Pose::new(20.0, 7.5, 0.0);
        let off_the_lane = |pose: Pose| pose.y > 12.0;
        for (picture, found) in [(with_niche, true), (without, false)] {
            let field = TestField::drawn(&picture, start);
            let path = find_yield_pose(&field.checker, start, off_the_lane);
            assert_eq!(path.is_some(), found);
            let Some(path) = path else { continue };
            assert!(off_the_lane(path.end()) && least_clearance(&field.checker, &path) > 0.0);
            assert_eq!(path.start, start);
        }
    }

    #[test]
    fn what_stands_in_the_way_is_not_driven_through() {
        let lane = ["##########", "..........", "##########"];
        let start = Pose::new(10.0, 7.5, 0.0);
        let field = TestField::drawn(&lane, start);
        let east = |pose: Pose| pose.x > 40.0;
        assert!(find_yield_pose(&field.checker, start, east).is_some());
        let crowded = field.checker.with_obstacles([field.checker.body().footprint(Pose::new(25.0, 7.5, 0.0))]);
        assert!(find_yield_pose(&crowded, start, east).is_none());
        assert!(find_yield_pose(&crowded, start, |pose| pose.x < 6.0).is_some());
    }

    #[test]
    fn the_nearest_place_is_straight_ahead_where_nothing_is_in_the_way() {
        let field = TestField::drawn(&[".........."; 10], Pose::default());
        let start = Pose::new(10.0, 25.0, 0.0);
        let path = find_yield_pose(&field.checker, start, |pose| pose.x >= 20.0).expect("the field is empty");
        assert!((path.length_m() - 10.0).abs() < 1e-9 && path.cusps() == 0, "{path:?}");
    }
}
