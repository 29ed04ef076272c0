//! The nearest place on which a truck may stand: a search in all directions, for a truck that shall leave the way free.
//!
//! Uniform cost over a lattice of poses, motions swept when their turn comes. Metres count, and a change of direction
//! counts as [`CUSP_M`].

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::grid::open_list::OpenList;
use crate::vehicle::{Path, Segment};

use super::kit::best_first::Candidate;
use super::kit::clearance_profile::ClearanceFloor;
use super::kit::closed_set::Bins;
use super::kit::{best_first, local_search};

const STEP_M: f64 = 2.5;
const BIN_M: f64 = 1.25;
const HEADINGS: u32 = 36;
const CUSP_M: f64 = 2.0;
/// What the body keeps from everything; the second where the first leads nowhere.
const CLEARANCES_M: [f64; 2] = [0.3, 0.03];
/// Poses that one search may look at.
const MAX_NODES: usize = 3_000;
const ROOT: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Node {
    pose: Pose,
    parent: u32,
    motion: Segment,
}

/// The cheapest path found from `start` to a pose at which `may_stand` holds; `None` where none is found.
///
/// It has segments, so that a truck which may stand where it is gets a path to another place.
pub fn nearest_place(checker: &CollisionChecker, start: Pose, mut may_stand: impl FnMut(Pose) -> bool) -> Option<Path> {
    let own_m = checker.clearance(start);
    if own_m <= 0.0 {
        return None;
    }
    let floors = CLEARANCES_M.map(|clearance_m| ClearanceFloor::new(clearance_m, [(start, own_m)]));
    floors.iter().find_map(|floor| search(checker, floor, start, &mut may_stand))
}

fn search(
    checker: &CollisionChecker,
    floor: &ClearanceFloor,
    start: Pose,
    may_stand: &mut impl FnMut(Pose) -> bool,
) -> Option<Path> {
    let motions = best_first::motions(checker.body(), STEP_M);
    let mut bins = Bins::new(BIN_M, HEADINGS);
    let mut open = OpenList::default();
    let mut nodes = vec![Node { pose: start, parent: ROOT, motion: Segment { curvature: 0.0, length_m: 0.0 } }];
    let mut sequence = 0;
    let (mut node, mut cost) = (0, 0.0);
    loop {
        for motion in motions {
            let last = nodes[node as usize].motion;
            let turns_back = last.length_m != 0.0 && last.is_reverse() != motion.is_reverse();
            let cost = cost + STEP_M + if turns_back { CUSP_M } else { 0.0 };
            open.push(Candidate { key: cost, cost, sequence, node, step: motion });
            sequence += 1;
        }
        let (pose, parent, motion) = loop {
            let next: Candidate<Segment> = open.pop()?;
            let from = nodes[next.node as usize].pose;
            let pose = next.step.end(from);
            let is_known = bins.dominates(pose, next.step.is_reverse(), next.cost);
            if !is_known && floor.motion_is_free(checker, from, next.step) {
                bins.improve(pose, next.step.is_reverse(), next.cost);
                cost = next.cost;
                break (pose, next.node, next.step);
            }
        };
        if nodes.len() == MAX_NODES {
            return None;
        }
        node = nodes.len() as u32;
        nodes.push(Node { pose, parent, motion });
        if may_stand(pose) {
            return Some(path_to(&nodes, node));
        }
    }
}

fn path_to(nodes: &[Node], mut index: u32) -> Path {
    let mut segments = Vec::new();
    while nodes[index as usize].parent != ROOT {
        let node = &nodes[index as usize];
        segments.push(node.motion);
        index = node.parent;
    }
    segments.reverse();
    Path { start: nodes[0].pose, segments: local_search::join(&segments) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planning::test_fields::{TestField, least_clearance};

    #[test]
    fn a_truck_finds_the_niche_beside_a_passage_and_none_where_there_is_none() {
        let with_niche =
            ["####################", "##########.....#####", "....................", "####################"];
        let without = ["####################", "####################", "....................", "####################"];
        let start = Pose::new(20.0, 7.5, 0.0);
        let off_the_lane = |pose: Pose| pose.y > 12.0;
        for (picture, found) in [(with_niche, true), (without, false)] {
            let field = TestField::drawn(&picture, start);
            let path = nearest_place(&field.checker, start, off_the_lane);
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
        assert!(nearest_place(&field.checker, start, east).is_some());
        let crowded = field.checker.with_obstacles([field.checker.body().footprint(Pose::new(25.0, 7.5, 0.0))]);
        assert!(nearest_place(&crowded, start, east).is_none());
        assert!(nearest_place(&crowded, start, |pose| pose.x < 6.0).is_some());
    }

    #[test]
    fn the_nearest_place_is_straight_ahead_where_nothing_is_in_the_way() {
        let field = TestField::drawn(&[".........."; 10], Pose::default());
        let start = Pose::new(10.0, 25.0, 0.0);
        let path = nearest_place(&field.checker, start, |pose| pose.x >= 20.0).expect("the field is empty");
        assert!((path.length_m() - 10.0).abs() < 1e-9 && path.cusps() == 0, "{path:?}");
    }
}
