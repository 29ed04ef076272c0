//! Path improvement by Reeds-Shepp curves that keep the turning radius and the clearance.
//!
//! A path costs its length and a price for every cusp, cusps between an old part and a new one included, or the time that
//! it takes ([`CostModel`]). A change counts only if it makes the whole path cheaper and is free.
//! First the path is shortened from knot to knot, then between random places, after R. Geraerts, M. H. Overmars, "Creating high-quality paths for motion
//! planning", IJRR 26(8), 2007, section 4, with Reeds-Shepp curves in place of straight lines. Then its bends are pulled
//! tight: a pose in the middle of each is moved to and fro, with the way about it, as long as that makes the path cheaper.

use std::fmt;

use glam::DVec2;
use rand::{Rng, RngExt};

use crate::collision::CollisionChecker;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::{CurvePrice, Path, ReedsShepp, Segment};

use super::clearance_profile::ClearanceProfile;
use super::drive_cost::CostModel;

/// Shorter pieces are rounding, and left out.
const SHORTEST_M: f64 = 1e-9;
/// Distance between knots.
const KNOT_M: f64 = 8.0;
/// A shortcut must save at least this.
const WORTH_M: f64 = 1e-6;
/// The share of the tries that may fail in a row.
const PATIENCE: f64 = 0.5;
/// A shortcut between joints begins up to this far before or behind the joint, half of the time.
const JITTER_M: f64 = 5.0;

/// A path that costs no more than this above the cheapest curve between its ends is left as it is, where bends are pulled.
const NEAR_BEST_M: f64 = 0.05;
/// How far the middle of a bend is moved to a side at first. What gains nothing is tried with half of it, down to the least.
const FIRST_MOVE_M: f64 = 0.8;
const MIN_MOVE_M: f64 = 0.05;
/// How much it is turned, for every metre that it would be moved.
const TURN_PER_M: f64 = 0.12;
/// What decides between curves is far more than this, and what rounding adds to their costs far less.
const BOUND_SLACK_M: f64 = 1e-9;
/// The way is changed from this far before the middle of a bend to this far behind it.
const REACH_M: f64 = 25.0;

/// The effort spent on improving a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Improvement {
    /// The number of random shortcuts.
    pub shortcuts: u32,
    /// The number of rounds in which all bends are tightened.
    pub pulls: u32,
}

impl fmt::Display for Improvement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shortcuts, pulls } = self;
        write!(f, "{shortcuts} shortcuts")?;
        if *pulls > 0 { write!(f, " and {pulls} rounds of pulling bends tight") } else { Ok(()) }
    }
}

/// Improves paths of one body on one field.
#[derive(Clone, Debug)]
pub struct PathImprover {
    checker: CollisionChecker,
    curves: ReedsShepp,
    cost: CostModel,
    /// By which curves are chosen.
    price: CurvePrice,
    spliced: Vec<Segment>,
}

impl PathImprover {
    pub fn new(checker: &CollisionChecker, cost: CostModel) -> Self {
        Self {
            checker: checker.clone(),
            curves: ReedsShepp { radius_m: checker.body().turning_radius_m },
            price: cost.motion_price(checker.body()).curve_price(),
            cost,
            spliced: Vec::new(),
        }
    }

    /// Returns a path between the same poses that costs no more; its new parts keep the clearance.
    pub fn improve(
        &mut self,
        path: &Path,
        profile: &ClearanceProfile,
        improvement: Improvement,
        rng: &mut impl Rng,
    ) -> Path {
        let Improvement { shortcuts, pulls } = improvement;
        let mut way = ChangingPath::new(path.start, path.segments.iter().copied(), &self.cost);
        // Without pulls paths are those that shortcuts alone have always made.
        let best_m = if pulls > 0 { self.min_cost(&way) + NEAR_BEST_M } else { f64::NEG_INFINITY };
        if shortcuts > 0 && way.cost > best_m {
            self.cut_between_knots(&mut way, profile);
            if way.cost > best_m {
                self.cut_at_random(&mut way, profile, shortcuts, rng);
            }
        }
        if way.cost > best_m {
            self.pull_bends(&mut way, profile, pulls);
        }
        way.into_path()
    }

    /// Returns the cost of the cheapest curve between the ends of a way, free or not.
    fn min_cost(&self, way: &ChangingPath) -> f64 {
        self.curves.cheapest_word(way.start(), way.pose_at(way.length_m()), &self.price).price
    }

    /// Cuts from every knot straight to the farthest that can be reached more cheaply.
    fn cut_between_knots(&mut self, way: &mut ChangingPath, profile: &ClearanceProfile) {
        let mut from_m = 0.0;
        while from_m + KNOT_M < way.length_m() {
            let before_m = way.length_m();
            let knots = ((before_m - from_m) / KNOT_M).ceil() as u32;
            // The farthest first, since that shortcut can save the most.
            let ends = (2..=knots).rev().map(|knot| (from_m + f64::from(knot) * KNOT_M).min(before_m));
            from_m = match ends.into_iter().find(|&to_m| self.cut(way, profile, from_m, to_m)) {
                // The rest of the path is as long as before.
                Some(to_m) => way.length_m() - (before_m - to_m),
                None => from_m + KNOT_M,
            };
        }
    }

    fn cut_at_random(&mut self, way: &mut ChangingPath, profile: &ClearanceProfile, tries: u32, rng: &mut impl Rng) {
        let patience = (PATIENCE * f64::from(tries)) as u32;
        let mut failures = 0;
        // In turn, so that even a few tries are of all kinds.
        for kind in (0..tries).map(|number| number % 4) {
            let (from_m, to_m) = random_places(way, kind, rng);
            failures = if self.cut(way, profile, from_m, to_m) { 0 } else { failures + 1 };
            if failures > patience {
                return;
            }
        }
    }

    /// Pulls all bends tight, in rounds.
    fn pull_bends(&mut self, way: &mut ChangingPath, profile: &ClearanceProfile, rounds: u32) {
        let mut move_m = FIRST_MOVE_M;
        for _ in 0..rounds {
            let mut is_cheaper = false;
            // A bend that was pulled may have become several, which wait for the next round.
            for bend in 0..way.segments().len() {
                is_cheaper |= way.segments().get(bend).is_some_and(|segment| segment.curvature != 0.0)
                    && self.pull(way, profile, bend, move_m);
            }
            if !is_cheaper {
                move_m *= 0.5;
                if move_m < MIN_MOVE_M {
                    return;
                }
            }
        }
    }

    /// Moves the middle of a bend, with the way about it, if that makes the way cheaper and is free.
    fn pull(&mut self, way: &mut ChangingPath, profile: &ClearanceProfile, bend: usize, move_m: f64) -> bool {
        let middle_m = 0.5 * (way.joints[bend].1 + way.joints[bend + 1].1);
        let from_m = (middle_m - REACH_M).max(0.0);
        let to_m = (middle_m + REACH_M).min(way.length_m());
        let limit = way.cost - WORTH_M;
        let bound = self.bound_between(way, (from_m, to_m), limit);
        let from = way.pose_at(from_m);
        let to = way.pose_at(to_m);
        for middle in moved(way.pose_at(middle_m), move_m) {
            // The second curve costs at least its lower bound, so no more than the rest is left for the first.
            let bound_before = bound - self.min_between(middle, to) + BOUND_SLACK_M;
            let Some(before) = self.curves.cheapest_word_below(from, middle, &self.price, bound_before) else {
                continue;
            };
            let Some(behind) = self.curves.cheapest_word_below(middle, to, &self.price, bound - before.price) else {
                continue;
            };
            let changed = || before.curve.segments().chain(behind.curve.segments());
            way.splice((from_m, to_m), changed(), &mut self.spliced);
            if self.cost.of(&self.spliced) < limit && profile.way_is_free(&self.checker, from, changed()) {
                *way = ChangingPath::new(way.start(), self.spliced.iter().copied(), &self.cost);
                return true;
            }
        }
        false
    }

    /// Returns what no curve between two poses costs less than.
    fn min_between(&self, from: Pose, to: Pose) -> f64 {
        let turn_m = self.curves.radius_m * ops::wrap_angle(to.heading - from.heading).abs();
        self.cost.min_per_metre() * from.position().distance(to.position()).max(turn_m)
    }

    /// Returns what a way must cost less than between two places for the whole to cost less than the limit: what remains of
    /// that after the rest of the way at the least price.
    fn bound_between(&self, way: &ChangingPath, (from_m, to_m): (f64, f64), limit: f64) -> f64 {
        let min = self.cost.min_per_metre();
        limit - min * from_m - min * (way.length_m() - to_m)
    }

    /// Replaces what lies between two places of a way by a curve, if that makes the way cheaper and is free.
    fn cut(&mut self, way: &mut ChangingPath, profile: &ClearanceProfile, from_m: f64, to_m: f64) -> bool {
        if from_m >= to_m {
            return false;
        }
        let limit = way.cost - WORTH_M;
        let bound = self.bound_between(way, (from_m, to_m), limit);
        let from = way.pose_at(from_m);
        let to = way.pose_at(to_m);
        let Some(best) = self.curves.cheapest_word_below(from, to, &self.price, bound) else { return false };
        // Most curves across a long way are blocked near where they begin: to see that takes less time than to put together
        // what the whole way would be.
        if !profile.way_is_free(&self.checker, from, best.curve.segments()) {
            return false;
        }
        way.splice((from_m, to_m), best.curve.segments(), &mut self.spliced);
        let is_better = self.cost.of(&self.spliced) < limit;
        if is_better {
            *way = ChangingPath::new(way.start(), self.spliced.iter().copied(), &self.cost);
        }
        is_better
    }
}

/// Returns the places to which the middle of a bend is moved.
fn moved(middle: Pose, move_m: f64) -> [Pose; 4] {
    let left = middle.direction().perp() * move_m;
    let turn = TURN_PER_M * move_m;
    [(left, 0.0), (-left, 0.0), (DVec2::ZERO, turn), (DVec2::ZERO, -turn)]
        .map(|(by, turn)| Pose::new(middle.x + by.x, middle.y + by.y, middle.heading + turn))
}

/// Returns two places of a way, the first before the second: a kind has one at the start, at the end, both near joints, or both
/// anywhere.
fn random_places(way: &ChangingPath, kind: u32, rng: &mut impl Rng) -> (f64, f64) {
    let length_m = way.length_m();
    let mut anywhere = || length_m * rng.random::<f64>();
    let (one, other) = match kind {
        0 => (0.0, anywhere()),
        1 => (anywhere(), length_m),
        2 => near_joints(way, rng),
        _ => (anywhere(), anywhere()),
    };
    (one.min(other), one.max(other))
}

fn near_joints(way: &ChangingPath, rng: &mut impl Rng) -> (f64, f64) {
    let mut joint_m = || way.joints_m().nth(rng.random_range(0..way.joints_m().len())).expect("in range");
    let (one, other) = (joint_m(), joint_m());
    let shift = if rng.random_bool(0.5) { JITTER_M * (2.0 * rng.random::<f64>() - 1.0) } else { 0.0 };
    ((one + shift).clamp(0.0, way.length_m()), other)
}

/// A path that is being changed, with the places of its joints.
#[derive(Clone, Debug)]
struct ChangingPath {
    segments: Vec<Segment>,
    /// Pose and metres driven at the start of every segment, and at the end.
    joints: Vec<(Pose, f64)>,
    cost: f64,
}

impl ChangingPath {
    /// Segments of no length are left out, and those that continue one another become one.
    fn new(start: Pose, way: impl IntoIterator<Item = Segment>, cost: &CostModel) -> Self {
        let mut segments = Vec::new();
        append(&mut segments, way);
        let mut joints = vec![(start, 0.0)];
        for segment in &segments {
            let (pose, driven_m) = joints[joints.len() - 1];
            joints.push((segment.end(pose), driven_m + segment.length_m.abs()));
        }
        let cost = cost.of(&segments);
        Self { segments, joints, cost }
    }

    fn start(&self) -> Pose {
        self.joints[0].0
    }

    fn into_path(self) -> Path {
        Path { start: self.start(), segments: self.segments }
    }

    fn segments(&self) -> &[Segment] {
        &self.segments
    }

    fn length_m(&self) -> f64 {
        self.joints[self.joints.len() - 1].1
    }

    /// Metres driven at the start of every segment, and at the end.
    fn joints_m(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.joints.iter().map(|&(_, driven_m)| driven_m)
    }

    /// Returns the pose after these metres, from 0 to the length.
    fn pose_at(&self, driven_m: f64) -> Pose {
        let Some(index) = self.segment_at(driven_m) else { return self.start() };
        let (pose, before_m) = self.joints[index];
        let segment = self.segments[index];
        segment.pose_at(pose, (driven_m - before_m).copysign(segment.length_m))
    }

    /// Replaces what `way` holds by the segments of this way with those `between` two places of it exchanged.
    fn splice(&self, (from_m, to_m): (f64, f64), between: impl Iterator<Item = Segment>, way: &mut Vec<Segment>) {
        way.clear();
        append(way, self.part(0.0, from_m));
        append(way, between);
        append(way, self.part(to_m, self.length_m()));
    }

    /// The segments between two places.
    fn part(&self, from_m: f64, to_m: f64) -> impl Iterator<Item = Segment> + '_ {
        self.segments.iter().zip(self.joints.windows(2)).filter_map(move |(segment, joints)| {
            let length_m = to_m.min(joints[1].1) - from_m.max(joints[0].1);
            (length_m > 0.0).then(|| segment.with_length(length_m))
        })
    }

    fn segment_at(&self, driven_m: f64) -> Option<usize> {
        let last = self.segments.len().checked_sub(1)?;
        Some(self.joints.partition_point(|&(_, before_m)| before_m <= driven_m).saturating_sub(1).min(last))
    }
}

fn append(segments: &mut Vec<Segment>, way: impl IntoIterator<Item = Segment>) {
    for segment in way.into_iter().filter(|segment| segment.length_m.abs() > SHORTEST_M) {
        match segments.last_mut() {
            Some(last) if last.curvature == segment.curvature && last.is_reverse() == segment.is_reverse() => {
                last.length_m += segment.length_m;
            }
            _ => segments.push(segment),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::MOTION_TOLERANCE_M;
    use crate::test_fields::{TestField, least_clearance};
    use wildfire_base::geometry::ops;
    use wildfire_base::rng;
    use wildfire_base::trajectory::SpeedLimits;

    const FLOOR_M: f64 = 0.3;
    const SHORTCUTS: Improvement = Improvement { shortcuts: 200, pulls: 0 };
    const PULLS: Improvement = Improvement { shortcuts: 200, pulls: 16 };
    /// A truck that takes its time to speed up and to stop, and is slow in reverse and in turns.
    const LADEN: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: Some(2.0),
        braking_mps2: Some(4.0),
        lateral_mps2: Some(3.0),
        steering: None,
    };
    const METRES: CostModel = CostModel::Length { cusp_m: 1.0 };

    /// A free path of many short arcs and straights, forward and reverse, from the field's start.
    fn random_path(field: &mut TestField, profile: &ClearanceProfile) -> Path {
        let mut path = Path::standing(field.start);
        for _ in 0..60 {
            let side = f64::from(field.rng.random_range(-1..=1));
            let sense = if field.rng.random_bool(0.85) { 1.0 } else { -1.0 };
            let length_m = sense * field.rng.random_range(1.0..6.0);
            let segment = Segment { curvature: side * field.checker.body().max_curvature(), length_m };
            if profile.motion_is_free(&field.checker, path.end(), segment) {
                path.segments.push(segment);
            }
        }
        path
    }

    #[test]
    fn improved_paths_are_cheaper_keep_their_ends_and_the_floor() {
        let (mut before, mut after) = (0.0, [0.0; 2]);
        for (seed, walks) in (0..12).zip([25, 25, 60].into_iter().cycle()) {
            let mut field = TestField::random(seed, walks);
            let profile = ClearanceProfile::new(FLOOR_M, []);
            let path = random_path(&mut field, &profile);
            before += METRES.of(&path.segments);
            let mut improver = PathImprover::new(&field.checker, METRES);
            for (after, improvement) in after.iter_mut().zip([SHORTCUTS, PULLS]) {
                let improved = improver.improve(&path, &profile, improvement, &mut rng::stream(seed, "improve"));
                assert_eq!(improved.start, path.start);
                assert!(improved.end().position().distance(path.end().position()) < 1e-6);
                assert!(ops::wrap_angle(improved.end().heading - path.end().heading).abs() < 1e-6);
                assert!(METRES.of(&improved.segments) <= METRES.of(&path.segments));
                let sharpest = field.checker.body().max_curvature();
                assert!(improved.segments.iter().all(|segment| segment.curvature.abs() <= sharpest));
                assert!(least_clearance(&field.checker, &improved) > FLOOR_M - MOTION_TOLERANCE_M - 1e-6);
                *after += METRES.of(&improved.segments);
            }
        }
        let [cut, pulled] = after;
        assert!(cut < 0.6 * before, "{cut} of {before} m are left");
        assert!(pulled < cut, "{pulled} of {cut} m are left");
    }

    #[test]
    fn where_time_counts_an_improved_drive_takes_no_longer() {
        let mut before_s = 0.0;
        let mut shorter_s = 0.0;
        let mut faster_s = 0.0;
        for (seed, walks) in (0..12).zip([25, 25, 60].into_iter().cycle()) {
            let mut field = TestField::random(seed, walks);
            let profile = ClearanceProfile::new(FLOOR_M, []);
            let path = random_path(&mut field, &profile);
            for improvement in [SHORTCUTS, PULLS] {
                let improve = |cost| {
                    let mut improver = PathImprover::new(&field.checker, cost);
                    improver.improve(&path, &profile, improvement, &mut rng::stream(seed, "improve"))
                };
                let shorter = improve(METRES);
                let faster = improve(CostModel::Time { limits: LADEN });
                let [of_path, of_shorter, of_faster] =
                    [&path, &shorter, &faster].map(|path| LADEN.drive_s(&path.segments));
                assert!(of_faster <= of_path + 1e-9, "{of_faster} s, {of_path} s before");
                assert!(faster.end().position().distance(path.end().position()) < 1e-6);
                assert!(least_clearance(&field.checker, &faster) > FLOOR_M - MOTION_TOLERANCE_M - 1e-6);
                (before_s, shorter_s, faster_s) = (before_s + of_path, shorter_s + of_shorter, faster_s + of_faster);
            }
        }
        assert!(faster_s < 0.99 * shorter_s, "{faster_s} s, {shorter_s} s the shorter ones, {before_s} s before");
    }

    #[test]
    fn without_tries_a_path_stays_as_it_is() {
        let mut field = TestField::random(1, 25);
        let profile = ClearanceProfile::new(FLOOR_M, []);
        let path = random_path(&mut field, &profile);
        let same = PathImprover::new(&field.checker, METRES).improve(
            &path,
            &profile,
            Improvement { shortcuts: 0, pulls: 0 },
            &mut rng::stream(1, "improve"),
        );
        assert!((same.length_m() - path.length_m()).abs() < 1e-9 && same.cusps() == path.cusps());
    }

    #[test]
    fn paths_of_nothing_or_of_one_piece_are_left_alone() {
        let field = TestField::random(1, 25);
        let profile = ClearanceProfile::new(FLOOR_M, []);
        let straight = Segment { curvature: 0.0, length_m: 6.0 };
        for segments in [vec![], vec![straight]] {
            let path = Path { start: field.start, segments };
            let improved = PathImprover::new(&field.checker, METRES).improve(
                &path,
                &profile,
                PULLS,
                &mut rng::stream(1, "improve"),
            );
            assert_eq!(improved, path);
        }
    }
}
