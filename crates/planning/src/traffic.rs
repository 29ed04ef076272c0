//! Paths of trucks that meet others: around a truck in the way, among trucks that move, and aside to let another truck
//! pass.

use crate::collision::CollisionChecker;
use wildfire_base::geometry::Pose;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Path, Segment};

use super::kit::best_first::{AnalyticExpansion, Candidate, Never, Node, PoseSearch, SearchOf, SearchSpace, Step};
use super::kit::clearance_profile::ClearanceProfile;
use super::kit::lattice::Lattice;
use super::kit::local_search::{LocalSearch, PrimitiveSettings};
use super::memory::MemoryMeter;
use super::observer::NullObserver;
use super::{Effort, GoalDisc};

/// A new path leaves the old one this far before the place where that is blocked.
const LEAVE_M: f64 = 20.0;
/// Nodes that the search for a way round may expand.
const MAX_EXPANSIONS: u32 = 250;

/// Finds a path into a disc that begins like `path`, which is blocked after `free_m` metres; adds to the effort.
///
/// `checker` knows what stands in the way, for instance another truck. The new path leaves the old one shortly before
/// that or, if that leads nowhere, at its start. It is a motion-primitive search straight for the disc, short and without
/// a roadmap, because what stands in the way is somewhere else each time.
pub fn replan_around(
    checker: &CollisionChecker,
    path: &Path,
    free_m: f64,
    disc: GoalDisc,
    effort: &mut Effort,
) -> Option<Path> {
    let settings = PrimitiveSettings { max_expansions: MAX_EXPANSIONS, ..PrimitiveSettings::default() };
    // Without a limit of memory, as so few expansions take little.
    let mut search = LocalSearch::new(checker, &MemoryMeter::unlimited(), &settings, None);
    let mut from = |metres: f64| {
        let [mut kept, _] = path.split_at(metres);
        let rest = search.drive(kept.end(), &[], disc.with_margin().into(), &mut NullObserver).ok()?;
        kept.segments.extend(rest.path.segments);
        Some(kept)
    };
    let late = (free_m > LEAVE_M).then(|| from(free_m - LEAVE_M)).flatten();
    let path = late.or_else(|| from(0.0));
    effort.local_expansions += search.expansions();
    path
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
    let start_clearance_m = checker.clearance(start);
    if start_clearance_m <= 0.0 {
        return None;
    }
    CLEARANCES_M.into_iter().find_map(|clearance_m| {
        let profile = ClearanceProfile::new(clearance_m, [(start, start_clearance_m)]);
        let mut space = YieldSpace { checker, profile, may_stand: &mut may_stand };
        let mut search = PoseSearch::new(checker.body(), LATTICE, &MemoryMeter::unlimited());
        search.begin(&mut space, [start], ());
        // `has_room` ends it at `MAX_NODES`, so it needs no second limit.
        search.run(&mut space, u32::MAX).ok().map(Path::joined)
    })
}

/// Other bodies whose motions are known for all time.
pub trait PredictedMotions {
    /// Returns true if a body keeps clear of them on a segment from `from` between two times, in seconds.
    fn leave_free(&self, from: Pose, segment: Segment, seconds: [f64; 2]) -> bool;

    /// Returns true if a body that stands at a pose from a time on, in seconds, is never in their way.
    fn let_stand(&self, pose: Pose, from_s: f64) -> bool;
}

/// A path, the motion along it, and the time at which that meets another body.
#[derive(Clone, Copy, Debug)]
pub struct BlockedLeg<'a> {
    pub path: &'a Path,
    pub leg: &'a Trajectory,
    pub meets_at: SimTime,
}

/// A search among moving bodies leaves the blocked path this long before the meeting, if that is after its departure.
const LEAVES: [SimTime; 2] = [SimTime::from_nanos(4_000_000_000), SimTime::from_nanos(12_000_000_000)];
/// Nodes that each of these searches may expand: in a crowd a search with 600 fails three times as often.
const MAX_TIMED_EXPANSIONS: u32 = 2000;
/// The price of a change of direction, besides the time that it takes, seconds.
const CUSP_S: f64 = 0.25;
/// The weight of the estimate in these searches.
const TIMED_WEIGHT: f64 = 1.3;

/// Finds a path into a disc among bodies that move, in space and time, and in the order in which bodies depart
/// (prioritised planning: M. Erdmann, T. Lozano-Perez, "On multiple moving objects", Algorithmica 2, 1987); adds to the
/// effort.
///
/// The new path leaves the blocked one before the meeting, or at its start, and ends where the body may stand for good.
/// Speeds are those of `speed`; where it limits acceleration, times are estimates, and the caller tests the drive.
pub fn plan_among(
    checker: &CollisionChecker,
    others: &dyn PredictedMotions,
    blocked: BlockedLeg<'_>,
    speed: &SpeedLimits,
    disc: GoalDisc,
    effort: &mut Effort,
) -> Option<Path> {
    let BlockedLeg { path, leg, meets_at } = blocked;
    let disc = disc.with_margin();
    let mut search = PoseSearch::new(checker.body(), LATTICE, &MemoryMeter::unlimited());
    // A change of direction brakes to a stop and speeds up again.
    let cusp_s = lag_s(speed, speed.acceleration_mps2) + lag_s(speed, speed.braking_mps2);
    let departs = leg.sets_out_at();
    // The latest place first, which keeps as much of the planned path as possible.
    let times = LEAVES.into_iter().map(|before| meets_at.since(before)).filter(|&time| time > departs);
    for leaves_at in times.chain([departs]) {
        let metres = leg.distance_m(leaves_at);
        let [mut kept, _] = path.split_at(metres);
        let start = kept.end();
        let start_clearance_m = checker.clearance(start);
        // From a contact no motion is free.
        if start_clearance_m <= 0.0 {
            continue;
        }
        // From a standstill it takes longer to be as fast as the search assumes.
        let lag_s = if metres > 0.0 { 0.0 } else { lag_s(speed, speed.acceleration_mps2) };
        let profile = ClearanceProfile::new(CLEARANCES_M[0], [(start, start_clearance_m)]);
        let mut space = TimedSpace { checker, profile, others, speed, disc, cusp_s };
        search.begin(&mut space, [start], leaves_at.as_seconds() + lag_s);
        let found = search.run(&mut space, MAX_TIMED_EXPANSIONS);
        effort.local_expansions += search.expansions;
        if let Ok(rest) = found {
            kept.segments.extend(rest.segments);
            return Some(kept.joined());
        }
    }
    None
}

/// Returns the seconds that a body loses because it gains or loses its speed at a limited rate.
fn lag_s(speed: &SpeedLimits, rate_mps2: Option<f64>) -> f64 {
    rate_mps2.map_or(0.0, |rate| 0.5 * speed.forward_mps / rate)
}

/// Seconds count; a motion is tested at the time at which it is driven.
struct TimedSpace<'a> {
    checker: &'a CollisionChecker,
    profile: ClearanceProfile,
    others: &'a dyn PredictedMotions,
    speed: &'a SpeedLimits,
    disc: GoalDisc,
    /// The time that a change of direction takes.
    cusp_s: f64,
}

impl TimedSpace<'_> {
    /// Returns the time that a motion takes.
    fn seconds(&self, motion: Segment, turns_back: bool) -> f64 {
        motion.length_m.abs() / self.speed.speed_on(&motion) + if turns_back { self.cusp_s } else { 0.0 }
    }

    /// Returns the metres from the body's centre to the disc; not positive inside.
    fn beyond_m(&self, pose: Pose) -> f64 {
        self.checker.body().body_centre(pose).distance(self.disc.centre) - self.disc.radius_m
    }
}

impl SearchSpace for TimedSpace<'_> {
    /// The time at which it is reached, in seconds.
    type Mark = f64;
    /// A motion of the lattice.
    type Custom = u8;

    fn has_room(&mut self, _: &mut SearchOf<Self>) -> bool {
        true
    }

    fn weight(&self) -> f64 {
        TIMED_WEIGHT
    }

    fn estimate(&mut self, node: &mut Node<f64>) -> Option<f64> {
        node.cost_to_go = self.beyond_m(node.pose).max(0.0) / self.speed.forward_mps;
        None
    }

    fn analytic_expansion(&self, _node: &Node<f64>) -> AnalyticExpansion {
        unreachable!("no expansions are offered")
    }

    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<u8>) {
        let node = *search.node(from.node);
        for (index, motion) in search.motions.into_iter().enumerate() {
            if node.is_undone_by(motion) {
                continue;
            }
            let turns_back = node.turns_back(motion.is_reverse());
            let cost = node.cost + self.seconds(motion, turns_back) + if turns_back { CUSP_S } else { 0.0 };
            let to_go = self.beyond_m(motion.end(node.pose)).max(0.0) / self.speed.forward_mps;
            search.push(cost + self.weight() * to_go, cost, from.node, Step::Custom(index as u8));
        }
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.profile.motion_is_free(self.checker, from, motion)
    }

    fn take(&mut self, search: &mut SearchOf<Self>, from: Candidate<u8>, index: u8) -> Option<u32> {
        let motion = search.motions[usize::from(index)];
        let node = *search.node(from.node);
        let (start, begins_s) = (node.pose, node.mark);
        let pose = motion.end(start);
        let reverse = motion.is_reverse();
        let seconds = [begins_s, begins_s + self.seconds(motion, node.turns_back(reverse))];
        // From cheap to costly: the closed set, the field, and the motions of all others.
        if search.is_dominated(pose, reverse, from.cost)
            || !self.motion_is_free(start, motion)
            || !self.others.leave_free(start, motion, seconds)
        {
            return None;
        }
        let (parent, cost) = (from.node, from.cost);
        let node = Node { pose, parent, motion, reverse: Some(reverse), cost, cost_to_go: 0.0, mark: seconds[1] };
        // A goal depends on the time here, which `is_goal` is not given.
        if self.beyond_m(pose) <= 0.0 && self.others.let_stand(pose, seconds[1]) {
            return Some(search.add(node));
        }
        search.reach(self, node)
    }
}

/// Uniform cost in all directions; metres count, and changes of direction.
struct YieldSpace<'a, F> {
    checker: &'a CollisionChecker,
    profile: ClearanceProfile,
    may_stand: &'a mut F,
}

impl<F: FnMut(Pose) -> bool> SearchSpace for YieldSpace<'_, F> {
    type Mark = ();
    type Custom = Never;

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
            search.push(cost, cost, from.node, Step::Motion { index: index as u8, alike: 0 });
        }
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.profile.motion_is_free(self.checker, from, motion)
    }

    fn take(&mut self, _: &mut SearchOf<Self>, _: Candidate<Never>, never: Never) -> Option<u32> {
        match never {}
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
    use wildfire_base::vehicle::Dimensions;

    #[test]
    fn a_detour_leads_round_what_stands_on_the_path_and_nowhere_through_it() {
        let start = Pose::new(10.0, 50.0, 0.0);
        let open = TestField::drawn(&["...................."; 20], start);
        let lane = TestField::drawn(&["####################", "....................", "####################"], start);
        let ahead = |metres: f64| Path { start, segments: vec![Segment { curvature: 0.0, length_m: metres }] };
        let disc = GoalDisc { centre: DVec2::new(90.0, 50.0), radius_m: 10.0 };
        let body = *open.checker.body();
        let crowded = open.checker.with_obstacles([body.footprint(Pose::new(60.0, 50.0, 1.5))]);
        let mut effort = Effort::default();
        let path = replan_around(&crowded, &ahead(75.0), 45.0, disc, &mut effort).expect("the field is wide");
        assert_drivable(&crowded, &path, start, disc);
        assert!(path.length_m() < 85.0 && effort.local_expansions > 0, "{path:?}");
        assert_eq!(path.pose_at(24.9), ahead(75.0).pose_at(24.9), "it leaves the path shortly before");

        let start = Pose::new(10.0, 7.5, 0.0);
        let crowded = lane.checker.with_obstacles([body.footprint(Pose::new(60.0, 7.5, 0.0))]);
        let disc = GoalDisc { centre: DVec2::new(90.0, 7.5), radius_m: 10.0 };
        let blocked = Path { start, ..ahead(75.0) };
        assert!(replan_around(&crowded, &blocked, 45.0, disc, &mut effort).is_none());
    }

    /// A wall across x = 60 that opens at a time, and a rule that nobody stays south of y = 50.
    struct Gate {
        body: Dimensions,
        opens_s: f64,
    }

    impl PredictedMotions for Gate {
        fn leave_free(&self, from: Pose, segment: Segment, [begins_s, _]: [f64; 2]) -> bool {
            let x = |pose: Pose| self.body.body_centre(pose).x;
            begins_s >= self.opens_s || (x(from) < 60.0 && x(segment.end(from)) < 60.0)
        }

        fn let_stand(&self, pose: Pose, _: f64) -> bool {
            pose.y >= 50.0
        }
    }

    #[test]
    fn a_path_among_moving_bodies_passes_where_they_are_gone_and_ends_where_it_may() {
        let start = Pose::new(10.0, 48.0, 0.0);
        let field = TestField::drawn(&["...................."; 20], start);
        let body = *field.checker.body();
        let path = Path { start, segments: vec![Segment { curvature: 0.0, length_m: 70.0 }] };
        let speed = SpeedLimits::new(8.0, 4.0);
        let disc = GoalDisc { centre: DVec2::new(90.0, 50.0), radius_m: 10.0 };
        for (departs_s, is_open) in [(0.0, false), (20.0, true)] {
            let leg = Trajectory::from_path(&path, SimTime::from_seconds(departs_s), speed);
            let blocked = BlockedLeg { path: &path, leg: &leg, meets_at: SimTime::from_seconds(departs_s + 5.5) };
            let gate = Gate { body, opens_s: 25.0 };
            let mut effort = Effort::default();
            let found = plan_among(&field.checker, &gate, blocked, &speed, disc, &mut effort);
            assert!(effort.local_expansions > 0);
            assert_eq!(found.is_some(), is_open);
            let Some(found) = found else { continue };
            assert_drivable(&field.checker, &found, start, disc);
            assert!(found.end().y >= 50.0 && found.length_m() < 85.0, "{found:?}");
        }
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
