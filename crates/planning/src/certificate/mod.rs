//! Certificates: lower bounds on the length of all paths between two poses among bushes, as data that other code checks.
//!
//! Two relaxations are combined. The middle of the rear axle must keep away from bushes by the radius of the largest disc
//! about it in the body, plus the clearance: paths of a point among convex polygons inside these grown bushes are at least
//! as long as a taut string, which bends at corners of polygons only. And a path between two poses is at least as long as
//! the Reeds-Shepp curve. A cut across the line from the start to the goal has to be crossed at some pose; up to it and
//! from it on, a path is at least as long as the greater of both bounds. The least sum over all poses on the cut bounds the
//! whole path.
//!
//! A [`Certificate`] holds the lengths of taut strings from the start and from the goal to the corners, as potentials. To
//! check them takes no search: they differ by no more than the distance of two corners, or the line between these is
//! blocked. That is the dual of a shortest path (Ford and Fulkerson, Flows in Networks, 1962, section III.1).
//!
//! Poses on the cut are checked in small boxes. A box of half-width δ about a position at the distance ρ from the start is
//! bounded by a similarity about the start that moves a path's end to the box's centre: it turns and scales the path by no
//! more than ε = δ / (ρ - δ). Turning a pose by an angle where it is costs the angle times the turning radius, since three
//! arcs do it (Reeds and Shepp, Optimal paths for a car that goes both forwards and backwards, 1990).

mod check;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::collision::CollisionChecker;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::{Dimensions, ReedsShepp};

pub use check::BadCertificate;
use check::{MAX_CORNERS, MAX_POSITIONS};

/// A lower bound on the length of all paths from a start to a goal pose that keep a clearance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// x, y and heading of the rear axle.
    pub start: [f64; 3],
    pub goal: [f64; 3],
    /// The clearance in metres that the paths keep.
    pub clearance_m: f64,
    /// The lower bound in metres.
    pub bound_m: f64,
    /// The share of the straight line from the start to the goal at which the cut crosses it at a right angle.
    pub cut: f64,
    /// The distance in metres between the positions on the cut that stand for all.
    pub step_m: f64,
    /// x and y of the corners of grown bushes that a shorter path could touch, and their distances from the start and
    /// from the goal among bushes.
    pub corners: Vec<[f64; 4]>,
}

/// The chords that stand for the quarter of a circle at each corner of a grown bush.
const CHORDS: usize = 3;

/// The shares of the line from the start to the goal at which cuts are tried.
const CUTS: [f64; 19] =
    [0.05, 0.08, 0.11, 0.15, 0.2, 0.25, 0.3, 0.36, 0.43, 0.5, 0.57, 0.64, 0.7, 0.75, 0.8, 0.85, 0.89, 0.92, 0.95];

/// The distances of positions on a cut, in metres: to choose the cut, and to compute its bound. They are larger where the
/// positions would be too many.
const STEPS_M: [f64; 2] = [0.1, 0.02];

/// Intervals of heading are halved down to this half-width, in radians.
const MIN_TURN: f64 = 0.002;

/// The length in metres by which a certificate claims less than was computed, so that rounding does not refuse it.
const ROUNDING_M: f64 = 1e-3;

/// The least distance in metres of the cut from the start and the goal.
const MIN_GAP_M: f64 = 1.0;

/// Returns the radius of the largest disc about the middle of the rear axle that lies in the body.
fn inner_radius_m(body: &Dimensions) -> f64 {
    let ahead_m = body.length_m - body.rear_overhang_m;
    body.rear_overhang_m.min(0.5 * body.width_m).min(ahead_m).max(0.0)
}

impl Certificate {
    /// Computes a certificate for all paths that keep a clearance, given the length of a path or any other length beyond
    /// which nothing is asked; `None` if the poses are the same.
    ///
    /// Without a cut it says how long the Reeds-Shepp curve is: where that is more, the poses are too close together for a
    /// cut, or corners are too many.
    pub fn new(checker: &CollisionChecker, start: Pose, goal: Pose, clearance_m: f64, reach_m: f64) -> Option<Self> {
        let curve_m = ReedsShepp { radius_m: checker.body().turning_radius_m }.length_m(start, goal);
        let cut = Self::with_cut(checker, start, goal, clearance_m, reach_m);
        let [start, goal] = [start, goal].map(|pose| [pose.x, pose.y, pose.heading]);
        let bound_m = curve_m - ROUNDING_M;
        let step_m = STEPS_M[1].max(bound_m / MAX_POSITIONS);
        // The checker accepts it by the curve alone, so the cut and the step only have to be in range.
        let without = Self { start, goal, clearance_m, bound_m, cut: 0.5, step_m, corners: Vec::new() };
        cut.filter(|cut| cut.bound_m > bound_m).or_else(|| (bound_m > 0.0).then_some(without))
    }

    fn with_cut(checker: &CollisionChecker, start: Pose, goal: Pose, clearance_m: f64, reach_m: f64) -> Option<Self> {
        let terrain = GrownTerrain::new(checker, clearance_m);
        let (from, to) = (start.position(), goal.position());
        let span_m = from.distance(to);
        // Long reaches have longer steps, so that the number of positions stays bounded.
        let steps_m = STEPS_M.map(|step_m| step_m.max(reach_m / MAX_POSITIONS));
        let is_meant = reach_m.is_finite() && reach_m > span_m && clearance_m >= 0.0;
        // Seven of the coarser steps: the checker demands six of the step that is chosen below.
        let min_gap_m = MIN_GAP_M.max(7.0 * steps_m[0]);
        // Grown bushes are smaller by 0.65 steps on a cut and must not vanish there.
        if !is_meant || CUTS[0] * span_m < min_gap_m || terrain.radius_m < 1.1 * steps_m[0] {
            return None;
        }
        let corners = terrain.corners(from, to, reach_m);
        // The checker compares all pairs of corners, so it refuses longer lists.
        if corners.len() > MAX_CORNERS {
            return None;
        }
        let ends = [(start, to), (goal, from)].map(|(end, other)| {
            let lengths_m = terrain.taut_lengths_m(&corners, (end.position(), other), reach_m);
            TautEnd { pose: end, corners: &corners, lengths_m }
        });
        let curves = ReedsShepp { radius_m: checker.body().turning_radius_m };
        let bound = |share: f64, step_m: f64| {
            let cut = Cut { terrain: &terrain, ends: &ends, curves, step_m };
            cut.bound_m(from.lerp(to, share), (to - from).perp() / span_m, reach_m)
        };
        // Which cut is best shows coarsely; only that one is computed finely.
        let coarse = CUTS.map(|share| (share, bound(share, steps_m[0])));
        let (cut, _) = coarse.into_iter().max_by(|one, other| one.1.total_cmp(&other.1))?;
        let step_m = steps_m[1];
        // The checker adds up in another order.
        let bound_m = bound(cut, step_m) - ROUNDING_M;
        let listed = corners.iter().enumerate();
        let corners = listed.map(|(k, at)| [at.x, at.y, ends[0].lengths_m[k], ends[1].lengths_m[k]]).collect();
        let [start, goal] = [start, goal].map(|pose| [pose.x, pose.y, pose.heading]);
        (bound_m > 0.0).then_some(Self { start, goal, clearance_m, bound_m, cut, step_m, corners })
    }
}

/// Bushes grown for the middle of the rear axle.
struct GrownTerrain {
    centres: Vec<DVec2>,
    half_cell_m: f64,
    /// The distance that the middle of the rear axle keeps from bushes and border.
    radius_m: f64,
    size: DVec2,
}

impl GrownTerrain {
    fn new(checker: &CollisionChecker, clearance_m: f64) -> Self {
        let frame = checker.field().frame();
        let cells = 0..frame.cell_count();
        let bushes = cells.filter(|&index| checker.field().occupied().values()[index]);
        Self {
            centres: bushes.map(|index| frame.centre(frame.cell(index))).collect(),
            half_cell_m: 0.5 * frame.cell_m,
            radius_m: inner_radius_m(checker.body()) + clearance_m,
            size: DVec2::new(frame.width_m(), frame.height_m()),
        }
    }

    /// The corners of a polygon in a bush grown by a radius, relative to its centre, counter-clockwise.
    fn polygon(&self, radius_m: f64) -> Vec<DVec2> {
        let corner = |quarter: usize, chord: usize| {
            let axis = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y][quarter];
            let (sin, cos) = ops::sin_cos(chord as f64 / CHORDS as f64 * std::f64::consts::FRAC_PI_2);
            (axis + axis.perp()) * self.half_cell_m + axis.rotate(DVec2::new(cos, sin)) * radius_m
        };
        (0..4).flat_map(|quarter| (0..=CHORDS).map(move |chord| corner(quarter, chord))).collect()
    }

    fn is_outside(&self, at: DVec2, margin_m: f64) -> bool {
        at.min(self.size - at).min_element() < margin_m
    }

    /// Returns whether a segment passes through one of the polygons, which are a hair smaller than the bushes.
    fn blocks(&self, polygon: &[DVec2], from: DVec2, to: DVec2) -> bool {
        let along = to - from;
        let reach = DVec2::splat(self.half_cell_m + self.radius_m);
        let low = from.min(to) - reach;
        let high = from.max(to) + reach;
        // Boxes first, and then the distance from the line, before any polygon is clipped.
        let near = self.centres.iter().filter(|centre| centre.cmpge(low).all() && centre.cmple(high).all());
        near.filter(|&&centre| along.perp_dot(centre - from).abs() <= 1.5 * reach.x * along.length() + 1e-9).any(
            |&centre| {
                let (mut enters, mut leaves) = (0f64, 1f64);
                for (index, &corner) in polygon.iter().enumerate() {
                    let side = polygon[(index + 1) % polygon.len()] - corner;
                    // Positive on the inner side.
                    let inward = side.perp_dot(from - centre - corner);
                    let rate = side.perp_dot(along);
                    // Along this side the segment is inside of it everywhere or nowhere.
                    if rate.abs() < 1e-12 {
                        if inward <= 0.0 {
                            return false;
                        }
                    } else if rate > 0.0 {
                        enters = enters.max(-inward / rate);
                    } else {
                        leaves = leaves.min(-inward / rate);
                    }
                }
                // A string that only touches a corner is not blocked, or no string could bend anywhere.
                leaves > enters && (leaves - enters) * along.length() >= 1e-6
            },
        )
    }

    fn holds(&self, polygon: &[DVec2], at: DVec2) -> bool {
        let reach_m = self.half_cell_m + self.radius_m;
        let near = self.centres.iter().filter(|&&centre| (at - centre).abs().max_element() < reach_m);
        near.into_iter().any(|&centre| {
            (0..polygon.len())
                .map(|index| (polygon[index], polygon[(index + 1) % polygon.len()]))
                .all(|(corner, next)| (next - corner).perp_dot(at - centre - corner) > 0.0)
        })
    }

    /// The corners that a path of less than `reach_m` could touch.
    fn corners(&self, from: DVec2, to: DVec2, reach_m: f64) -> Vec<DVec2> {
        let polygon = self.polygon(self.radius_m);
        let inner = self.polygon(self.radius_m - 2.0 * SHRUNK_M);
        let corners = self.centres.iter().flat_map(|&centre| polygon.iter().map(move |&corner| centre + corner));
        // A corner too many does no harm, but the checker refuses a list that lacks one.
        let near = corners.filter(|at| from.distance(*at) + at.distance(to) < reach_m + ROUNDING_M);
        // A corner on the edge of another bush may seem inside it by rounding, so only those well inside are left out.
        near.filter(|&at| !self.is_outside(at, self.radius_m - 2.0 * SHRUNK_M) && !self.holds(&inner, at)).collect()
    }

    /// The lengths of taut strings from a place to corners, as far as a path through them to the other end may be of less
    /// than `reach_m`; elsewhere the least that this takes.
    fn taut_lengths_m(&self, corners: &[DVec2], (from, other): (DVec2, DVec2), reach_m: f64) -> Vec<f64> {
        let polygon = self.polygon(self.radius_m - 2.0 * SHRUNK_M);
        // No corner counts that a path within reach cannot pass.
        let mut lengths_m: Vec<f64> = corners.iter().map(|corner| reach_m - corner.distance(other)).collect();
        let mut open: Vec<usize> = (0..corners.len()).collect();
        let (mut at, mut length_m) = (from, 0.0);
        loop {
            for &index in &open {
                let through_m = length_m + at.distance(corners[index]);
                if through_m < lengths_m[index] && !self.blocks(&polygon, at, corners[index]) {
                    lengths_m[index] = through_m;
                }
            }
            // Dijkstra's search over all pairs, whose edges are tested only when they could shorten something.
            let next = (0..open.len()).min_by(|&one, &two| lengths_m[open[one]].total_cmp(&lengths_m[open[two]]));
            let Some(next) = next else { return lengths_m };
            let index = open.swap_remove(next);
            (at, length_m) = (corners[index], lengths_m[index]);
        }
    }
}

/// The length in metres by which polygons that block are smaller than those whose corners count.
const SHRUNK_M: f64 = 1e-6;

/// The start or the goal, with the lengths of taut strings to corners.
struct TautEnd<'a> {
    pose: Pose,
    corners: &'a [DVec2],
    lengths_m: Vec<f64>,
}

/// Poses on a line between the start and the goal.
struct Cut<'a> {
    terrain: &'a GrownTerrain,
    ends: &'a [TautEnd<'a>; 2],
    curves: ReedsShepp,
    step_m: f64,
}

impl Cut<'_> {
    /// The least length of paths that cross the cut, at most `reach_m`.
    fn bound_m(&self, middle: DVec2, along: DVec2, reach_m: f64) -> f64 {
        let half_m = 0.5 * self.step_m;
        let radius_m = self.terrain.radius_m - 1.3 * half_m;
        let polygon = self.terrain.polygon(radius_m - 2.0 * SHRUNK_M);
        let count = (0.5 * reach_m / self.step_m).ceil() as i32;
        let mut crossings = Vec::new();
        for number in -count..=count {
            let at = middle + along * (f64::from(number) * self.step_m);
            // Where even straight lines are too long, no string has to be found.
            let straight_m = self.ends.iter().map(|end| end.pose.position().distance(at) - half_m).sum::<f64>();
            let is_shut = straight_m >= reach_m
                || self.terrain.is_outside(at, self.terrain.radius_m - half_m - SHRUNK_M)
                || self.terrain.holds(&polygon, at);
            if !is_shut {
                let lengths = [0, 1].map(|end| self.taut_length_m(&self.ends[end], &polygon, at, reach_m) - half_m);
                crossings.push((lengths, at));
            }
        }
        // The shortest first, so that most of the rest are cut off by the bound.
        crossings.sort_by(|(one, _), (two, _)| (one[0] + one[1]).total_cmp(&(two[0] + two[1])));
        crossings.into_iter().fold(reach_m, |min_m, (lengths, at)| self.min_at(lengths, at, min_m))
    }

    fn taut_length_m(&self, end: &TautEnd<'_>, polygon: &[DVec2], at: DVec2, reach_m: f64) -> f64 {
        let last = end.corners.iter().zip(&end.lengths_m).map(|(&corner, &length_m)| (corner, length_m));
        let last = last.chain([(end.pose.position(), 0.0)]);
        let mut through: Vec<_> = last.map(|(corner, length_m)| (length_m + corner.distance(at), corner)).collect();
        // The first that is not blocked is the shortest, so most corners are never tested against the bushes.
        through.sort_by(|one, two| one.0.total_cmp(&two.0));
        let seen = through.into_iter().find(|&(_, corner)| !self.terrain.blocks(polygon, corner, at));
        seen.map_or(reach_m, |(length_m, _)| length_m)
    }

    /// The least sum of both parts' bounds over all headings at a position, or `min_m` if that is less.
    fn min_at(&self, lengths: [f64; 2], at: DVec2, mut min_m: f64) -> f64 {
        let floor_m = lengths[0] + lengths[1];
        if floor_m >= min_m {
            return min_m;
        }
        const PARTS: usize = 8;
        let half = std::f64::consts::PI / PARTS as f64;
        let mut open: Vec<(f64, f64)> = (0..PARTS).map(|part| ((2 * part + 1) as f64 * half, half)).collect();
        while let Some((heading, half)) = open.pop() {
            let pose = Pose::new(at.x, at.y, heading);
            let sum_m: f64 = (0..2).map(|end| lengths[end].max(self.curve_m(self.ends[end].pose, pose, half))).sum();
            // This range of headings has no shorter path.
            if sum_m >= min_m {
                continue;
            }
            // Halving must end somewhere: a range this narrow is believed to have as short a path as its bound.
            if half <= MIN_TURN {
                min_m = sum_m;
            } else {
                open.extend([(heading - 0.5 * half, 0.5 * half), (heading + 0.5 * half, 0.5 * half)]);
            }
        }
        min_m
    }

    /// A lower bound of Reeds-Shepp curves from an end to all poses of a box.
    fn curve_m(&self, end: Pose, pose: Pose, half_turn: f64) -> f64 {
        let half_m = 0.5 * self.step_m;
        let share = half_m / (end.position().distance(pose.position()) - half_m);
        let radius_m = self.curves.radius_m * (1.0 - share);
        let length_m = ReedsShepp { radius_m }.length_m(end, pose);
        (length_m - radius_m * (2.0 * 1.01 * share + half_turn)) / (1.0 + share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Goal;
    use crate::registry::{OwnedSettings, TruckPlannerKind};
    use crate::test_fields::{TestField, least_clearance, random_free_pose};

    fn curve_m(start: Pose, goal: Pose) -> f64 {
        ReedsShepp { radius_m: Dimensions::default().turning_radius_m }.length_m(start, goal)
    }

    /// A wall across the field with a gap at its south end, and the poses on both sides of it.
    fn walled() -> (TestField, (Pose, Pose)) {
        let mut picture = vec!["..........#.........."; 10];
        picture.extend(vec!["....................."; 5]);
        let ends = (Pose::new(20.0, 50.0, 0.0), Pose::new(85.0, 50.0, 0.0));
        (TestField::drawn(&picture, ends.0), ends)
    }

    #[test]
    fn no_planner_finds_a_path_shorter_than_its_certificate_and_the_check_accepts_it() {
        let (mut certified, mut better) = (0, 0);
        for seed in 0..3 {
            let mut field = TestField::random(seed, 40);
            let goals: Vec<Pose> = (0..2).map(|_| random_free_pose(&mut field, 0.3)).collect();
            for kind in TruckPlannerKind::ALL {
                let mut planner = field.make(&OwnedSettings::default(), seed, |context| kind.maker().make(context));
                for &goal in &goals {
                    let Ok(path) = planner.plan(field.start, Goal::Pose(goal)).path else { continue };
                    let clearance_m = (least_clearance(&field.checker, &path) - 0.01).clamp(0.0, 1.0);
                    let length_m = path.length_m();
                    let found = Certificate::new(&field.checker, field.start, goal, clearance_m, length_m + 1.0);
                    let Some(certificate) = found else { continue };
                    assert_eq!(certificate.check(&field.checker), Ok(()), "{kind}, field {seed}, {goal:?}");
                    assert!(certificate.bound_m <= length_m, "{kind}, field {seed}, {goal:?}");
                    certified += 1;
                    better += u32::from(certificate.bound_m > curve_m(field.start, goal));
                }
            }
        }
        assert!(certified > 12 && better > 4, "{certified} certified, {better} better than the curve");
    }

    #[test]
    fn an_open_field_gives_about_the_curve_and_a_wall_a_detour() {
        let open = TestField::drawn(&["...................."; 20], Pose::new(20.0, 50.0, 0.0));
        for (heading, goal) in [(0.0, Pose::new(80.0, 50.0, 0.0)), (2.0, Pose::new(70.0, 80.0, -1.0))] {
            let start = Pose::new(20.0, 50.0, heading);
            let length_m = curve_m(start, goal);
            let certificate = Certificate::new(&open.checker, start, goal, 0.3, length_m + 5.0).unwrap();
            assert_eq!(certificate.check(&open.checker), Ok(()));
            let gap_m = length_m - certificate.bound_m;
            assert!((0.0..0.01 * length_m).contains(&gap_m), "{length_m} m, {gap_m} m");
        }
        let (field, ends) = walled();
        let certificate = Certificate::new(&field.checker, ends.0, ends.1, 0.3, 100.0).unwrap();
        assert_eq!(certificate.check(&field.checker), Ok(()));
        // Round the wall's end at (52.5, 25): twice the hypotenuse of about 32 and 26 m, with the turns more.
        assert!(certificate.bound_m > 80.0, "{} m", certificate.bound_m);
    }

    #[test]
    fn a_certificate_that_was_changed_is_refused() {
        let (field, ends) = walled();
        let certificate = Certificate::new(&field.checker, ends.0, ends.1, 0.3, 100.0).unwrap();
        let refused = |change: &dyn Fn(&mut Certificate)| {
            let mut changed = certificate.clone();
            change(&mut changed);
            changed.check(&field.checker).expect_err("it was changed").to_string()
        };
        assert!(refused(&|it| it.bound_m += 0.01).starts_with("a path across ("));
        assert!(refused(&|it| it.bound_m = 99.0).starts_with("a path across ("));
        assert!(refused(&|it| it.goal[0] = 70.0).contains(" differ by "));
        assert!(refused(&|it| it.clearance_m = 0.0).contains(" is missing"));
        assert!(refused(&|it| it.corners.clear()).contains(" is missing"));
        assert!(refused(&|it| it.corners.iter_mut().for_each(|corner| corner[2] += 1.0)).contains(" differ by "));
        assert!(refused(&|it| it.corners.push([50.0, 20.0, 60.0, 60.0])).contains(" differ by "));
        assert_eq!(refused(&|it| it.step_m = 0.0), "`step_m` is out of range: expected 0.0001 to 0.5");
        assert_eq!(refused(&|it| it.cut = 0.001), "`cut` is out of range: expected six steps or more from both ends");
        assert!(refused(&|it| it.bound_m = f64::NAN).starts_with("`bound_m` is out of range"));
        assert!(refused(&|it| it.corners[0][1] = f64::INFINITY).starts_with("`corners` is out of range"));
        let bushier = TestField::random(1, 40);
        assert!(certificate.check(&bushier.checker).is_err());
    }

    #[test]
    fn a_pose_turns_where_it_is_for_the_angle_times_the_radius() {
        for hundredths in 1..=314 {
            let angle = 0.01 * f64::from(hundredths);
            let length_m = curve_m(Pose::new(3.0, 4.0, 0.3), Pose::new(3.0, 4.0, 0.3 + angle));
            assert!((length_m - 13.0 * angle).abs() < 1e-9, "{angle}: {length_m} m");
        }
    }
}
