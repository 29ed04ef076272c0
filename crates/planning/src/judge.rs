//! The rules that a path must keep before it is driven, and the figures of a path.
//!
//! A [`Judge`] refuses a path that a truck cannot or must not drive, with the place and the reason: a [`BadPath`]. It asks
//! `collision`, as planners do; the audit asks other shapes afterwards. World frame, metres, radians.

use std::fmt;

use glam::DVec2;

use super::{END_M, END_RAD, Goal, GoalDisc};
use crate::collision::{CollisionChecker, MIN_CLEARANCE_M, NearestObstacle, Obstacle};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path, ReedsShepp};

/// The maximum number of segments of a path.
pub const MAX_SEGMENTS: usize = 10_000;

/// The maximum length of a path, as a multiple of the sum of the field's sides.
pub const MAX_FIELDS_LONG: f64 = 100.0;

/// The distance between poses whose clearance is computed, in metres.
pub const SPACING_M: f64 = 0.02;

/// Judges paths of one truck on one field.
#[derive(Clone, Debug)]
pub struct Judge {
    checker: CollisionChecker,
}

/// A position on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPlace {
    /// The number of the segment, from 1; 0 if the path has none.
    pub segment: usize,
    /// The number of segments of the path.
    pub segments: usize,
    /// The metres driven up to this position.
    pub along_m: f64,
    /// The position of the rear axle.
    pub at: DVec2,
}

/// The reason why a path is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BadPath {
    /// More than [`MAX_SEGMENTS`].
    TooManySegments { found: usize },
    /// The path does not begin at the truck.
    OtherStart { found: Pose, truck: Pose },
    /// A curvature or a length that is not a finite number, or too small to compute with.
    NotANumber { place: PathPlace, what: &'static str, found: f64 },
    /// More than [`MAX_FIELDS_LONG`] times the sum of the field's sides.
    TooLong { found_m: f64, max_m: f64 },
    /// A turn that the truck cannot make.
    TooSharp { place: PathPlace, found: f64, max: f64 },
    /// Less than [`MIN_CLEARANCE_M`] from something; not above 0 on contact.
    TooNear { place: PathPlace, obstacle: Obstacle, found_m: f64 },
    /// The body's centre ends outside of the disc.
    MissesDisc { along_m: f64, centre: DVec2, disc: GoalDisc },
    /// The rear axle ends too far from the pose.
    MissesPose { along_m: f64, end: Pose, goal: Pose },
}

impl std::error::Error for BadPath {}

impl Judge {
    /// Creates the judge of a truck, whose body the checker has, on a field.
    pub fn new(checker: CollisionChecker) -> Self {
        Self { checker }
    }

    /// Checks that a path leads from the truck's pose to the goal, turns no more sharply than the truck can, and keeps
    /// [`MIN_CLEARANCE_M`] everywhere.
    ///
    /// Its cost is bounded, whatever the path: a path that is too long is refused before it is followed.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn check(&self, start: Pose, goal: Goal, path: &Path) -> Result<(), BadPath> {
        // Everything below goes through the segments, so their number is bounded first.
        if path.segments.len() > MAX_SEGMENTS {
            return Err(BadPath::TooManySegments { found: path.segments.len() });
        }
        // The truck's pose is not a number only if the path's is refused with it.
        if path.start != start {
            return Err(BadPath::OtherStart { found: path.start, truck: start });
        }
        // A length of NaN would pass the comparison with the limit below.
        check_numbers(path)?;
        let frame = self.checker.field().frame();
        let length_m = path.length_m();
        let max_m = MAX_FIELDS_LONG * (frame.width_m() + frame.height_m());
        if length_m > max_m {
            return Err(BadPath::TooLong { found_m: length_m, max_m });
        }
        self.check_segments(path)?;
        self.check_end(goal, path.end(), length_m)
    }

    fn check_segments(&self, path: &Path) -> Result<(), BadPath> {
        let max = self.checker.body().max_curvature();
        let mut along_m = 0.0;
        for (index, (start, segment)) in path.legs().enumerate() {
            let place = |travelled_m: f64| PathPlace {
                segment: index + 1,
                segments: path.segments.len(),
                along_m: along_m + travelled_m,
                at: segment.pose_at(start, travelled_m.copysign(segment.length_m)).position(),
            };
            if segment.curvature.abs() > max {
                return Err(BadPath::TooSharp { place: place(0.0), found: segment.curvature.abs(), max });
            }
            if let Some(travelled_m) = self.checker.refused_at(start, segment, MIN_CLEARANCE_M) {
                let pose = segment.pose_at(start, travelled_m.copysign(segment.length_m));
                let NearestObstacle { obstacle, gap_m: found_m } = self.checker.nearest_obstacle(pose);
                return Err(BadPath::TooNear { place: place(travelled_m), obstacle, found_m });
            }
            along_m += segment.length_m.abs();
        }
        // Without a segment nothing has looked at the body where it stands.
        if path.segments.is_empty() {
            return self.check_standing(path.start);
        }
        Ok(())
    }

    /// A truck may stay where it has less than the least clearance, but not where it touches something.
    fn check_standing(&self, pose: Pose) -> Result<(), BadPath> {
        let NearestObstacle { obstacle, gap_m: found_m } = self.checker.nearest_obstacle(pose);
        let place = PathPlace { segment: 0, segments: 0, along_m: 0.0, at: pose.position() };
        if found_m > 0.0 { Ok(()) } else { Err(BadPath::TooNear { place, obstacle, found_m }) }
    }

    fn check_end(&self, goal: Goal, end: Pose, along_m: f64) -> Result<(), BadPath> {
        let body = self.checker.body();
        if goal.is_met(end, body) {
            return Ok(());
        }
        Err(match goal {
            Goal::Disc(disc) => BadPath::MissesDisc { along_m, centre: body.body_centre(end), disc },
            Goal::Pose(goal) => BadPath::MissesPose { along_m, end, goal },
        })
    }

    /// Computes the figures of a path from a truck's pose to a goal, valid or not.
    pub fn figures(&self, start: Pose, goal: Goal, path: &Path, limits: SpeedLimits) -> DriveFigures {
        // The sum of no segments is -0.
        let length_m = path.length_m() + 0.0;
        let bound_m = lower_bound_m(start, goal, self.checker.body());
        DriveFigures {
            length_m,
            lower_bound_ratio: (bound_m > 0.0).then(|| length_m / bound_m),
            min_clearance_m: self.min_clearance_m(path.samples(SPACING_M).map(|(_, pose)| pose)),
            cusps: path.cusps(),
            drive_s: Trajectory::from_path(path, SimTime::ZERO, limits).duration_s(),
        }
    }

    /// Returns the least clearance of poses, as [`CollisionChecker::clearance`] computes it.
    pub fn min_clearance_m(&self, poses: impl Iterator<Item = Pose>) -> f64 {
        poses.map(|pose| self.checker.clearance(pose)).fold(f64::INFINITY, f64::min)
    }
}

/// The figures of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveFigures {
    /// The length driven, forward and in reverse.
    pub length_m: f64,
    /// The length divided by the lower bound of all paths, which rounding may make a little less than 1; `None` where that
    /// bound is 0.
    pub lower_bound_ratio: Option<f64>,
    /// The least clearance of poses every 2 cm, border included; exact below a metre, a lower bound above.
    pub min_clearance_m: f64,
    pub cusps: u32,
    /// The driving time, from standstill to standstill.
    pub drive_s: f64,
}

impl DriveFigures {
    /// Returns the ratio as it is printed: 1 where it is less by rounding only.
    pub fn printed_ratio(&self) -> Option<f64> {
        self.lower_bound_ratio.map(without_rounding)
    }
}

/// The share of a length that rounding may take from a path that is as short as any.
const RATIO_ROUNDING: f64 = 1e-12;

/// Returns a length over a lower bound, 1 where they differ by rounding only; `None` where the bound is 0.
pub fn lower_bound_ratio(length_m: f64, bound_m: f64) -> Option<f64> {
    (bound_m > 0.0).then(|| without_rounding(length_m / bound_m))
}

fn without_rounding(ratio: f64) -> f64 {
    if ratio < 1.0 && ratio > 1.0 - RATIO_ROUNDING { 1.0 } else { ratio }
}

/// Returns a lower bound of the length of paths: the length of the Reeds-Shepp curve, or the distance of the body's
/// centre to the disc divided by how much farther it can move than the rear axle; 0 where a pose is not a number.
pub fn lower_bound_m(start: Pose, goal: Goal, body: &Dimensions) -> f64 {
    match goal {
        Goal::Pose(goal) if !is_finite(start) || !is_finite(goal) => 0.0,
        Goal::Pose(goal) => ReedsShepp { radius_m: body.turning_radius_m }.length_m(start, goal),
        Goal::Disc(disc) => {
            let gap_m = body.body_centre(start).distance(disc.centre) - disc.radius_m;
            gap_m.max(0.0) / ops::hypot(1.0, body.centre_offset_m() * body.max_curvature())
        }
    }
}

fn is_finite(pose: Pose) -> bool {
    pose.position().is_finite() && pose.heading.is_finite()
}

/// Refuses numbers that nothing can be computed with. Of a curvature below the least normal number, half of a turn is
/// another number by up to a third, so that the end of the segment would be elsewhere than its clearance was looked at.
fn check_numbers(path: &Path) -> Result<(), BadPath> {
    let mut along_m = 0.0;
    for (index, (start, segment)) in path.legs().enumerate() {
        for (what, found) in [("curvature", segment.curvature), ("length", segment.length_m)] {
            if !found.is_finite() || found.is_subnormal() {
                let segments = path.segments.len();
                let at = start.position();
                let place = PathPlace { segment: index + 1, segments, along_m, at };
                return Err(BadPath::NotANumber { place, what, found });
            }
        }
        along_m += segment.length_m.abs();
    }
    Ok(())
}

impl fmt::Display for PathPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { segment, segments, along_m, at } = *self;
        if segments == 0 {
            return write!(f, "where it stays, at ({:.2}, {:.2})", at.x, at.y);
        }
        write!(f, "segment {segment} of {segments}, {along_m:.2} m along, at ({:.2}, {:.2})", at.x, at.y)
    }
}

impl fmt::Display for BadPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooManySegments { found } => write!(f, "it has {found} segments; the limit is {MAX_SEGMENTS}"),
            Self::OtherStart { found, truck } => {
                let (metres, radians) = apart(found, truck);
                let Pose { x, y, .. } = found;
                let Pose { x: truck_x, y: truck_y, .. } = truck;
                write!(f, "it begins at ({x:.2}, {y:.2}), {metres} m and {radians} rad from the truck's pose at ")?;
                write!(f, "({truck_x:.2}, {truck_y:.2}), where it must begin")
            }
            // See `check_numbers` for why a number this small is refused.
            Self::NotANumber { place, what, found } if found.is_subnormal() => {
                write!(f, "{place}: its {what} is {found:e}, which is too small to compute with; 0 is allowed")
            }
            Self::NotANumber { place, what, found } => {
                write!(f, "{place}: its {what} is {found}; expected a finite number")
            }
            Self::TooLong { found_m, max_m } => {
                let found = significant(found_m, max_m, 2);
                let max = max_m;
                write!(f, "it is {found} m long; the limit is {max} m, ")?;
                write!(f, "{MAX_FIELDS_LONG} times width and height of the field")
            }
            Self::TooSharp { place, found, max } => {
                // As radii, since that is how scenarios state the limit.
                let (radius_m, min_m) = (1.0 / found, 1.0 / max);
                write!(f, "{place}: a turn of radius {} m; the least is {min_m} m", significant(radius_m, min_m, 2))
            }
            Self::TooNear { place, obstacle, found_m } => {
                write!(f, "{place}: ")?;
                match obstacle {
                    // Only beyond the border is there a depth to report.
                    Obstacle::Border if found_m < 0.0 => write!(f, "{} outside the field", Gap(-found_m))?,
                    _ if found_m <= 0.0 => write!(f, "touching {}", NamedPath(obstacle))?,
                    _ => write!(f, "{} from {}", Gap(found_m), NamedPath(obstacle))?,
                }
                write!(f, ", the least is {}", Gap(MIN_CLEARANCE_M))
            }
            Self::MissesDisc { along_m, centre, disc } => {
                let DVec2 { x, y } = centre;
                let gap_m = centre.distance(disc.centre);
                let radius_m = disc.radius_m;
                write!(f, "its end, {along_m:.2} m along, with the body's centre at ({x:.2}, {y:.2}): ")?;
                write!(f, "{} m from the centre of the goal's disc, ", significant(gap_m, radius_m, 2))?;
                write!(f, "the most is {radius_m} m")
            }
            Self::MissesPose { along_m, end, goal } => {
                let (metres, radians) = apart(end, goal);
                write!(
                    f,
                    "its end, {along_m:.2} m along, at ({:.2}, {:.2}): {metres} m and {radians} rad ",
                    end.x, end.y
                )?;
                write!(f, "from the goal's pose, the most is {END_M} m and {END_RAD} rad")
            }
        }
    }
}

/// Returns metres and radians between two poses, as text.
fn apart(pose: Pose, other: Pose) -> (String, String) {
    let turn = ops::wrap_angle(pose.heading - other.heading).abs();
    let metres = pose.position().distance(other.position());
    (significant(metres, END_M, 4), significant(turn, END_RAD, 4))
}

/// Writes a number with as few decimals as show on which side of the limit it is, and no fewer than asked for.
fn significant(found: f64, limit: f64, decimals: usize) -> String {
    let shows_side =
        |text: &String| text.parse().is_ok_and(|shown: f64| shown.partial_cmp(&limit) == found.partial_cmp(&limit));
    let written = (decimals..=15).map(|decimals| format!("{found:.decimals$}"));
    written.into_iter().find(shows_side).unwrap_or_else(|| found.to_string())
}

/// A distance, in millimetres below a metre.
struct Gap(f64);

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 >= 1.0 {
            return write!(f, "{:.2} m", self.0);
        }
        write!(f, "{} mm", significant(1e3 * self.0, 1e3 * MIN_CLEARANCE_M, 0))
    }
}

/// An obstacle by its name.
struct NamedPath(Obstacle);

impl fmt::Display for NamedPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Obstacle::Bush(cell) => write!(f, "the bush at cell {cell}"),
            Obstacle::Border => f.write_str("the border"),
            Obstacle::Body => f.write_str("another body"),
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::test_fields::{TestField, least_clearance, random_pose};
    use super::*;
    use wildfire_base::rng;
    use wildfire_base::vehicle::Segment;

    const START: Pose = Pose { x: 20.0, y: 22.5, heading: 0.0 };

    fn segment(curvature: f64, length_m: f64) -> Segment {
        Segment { curvature, length_m }
    }

    fn path(segments: &[Segment]) -> Path {
        Path { start: START, segments: segments.to_vec() }
    }

    /// A field of 100 m by 50 m with one bush from (50, 20) to (55, 25).
    fn judge() -> Judge {
        let row = "....................";
        let picture = [row, row, row, row, row, "..........#.........", row, row, row, row];
        Judge::new(TestField::drawn(&picture, START).checker)
    }

    /// Returns the words with which a path to where it ends is refused.
    fn refusal(path: &Path) -> String {
        judge().check(START, Goal::Pose(path.end()), path).expect_err("something is wrong with it").to_string()
    }

    #[test]
    fn a_path_that_keeps_the_rules_passes() {
        for segments in [
            vec![segment(0.0, 25.0)],
            vec![segment(1.0 / 13.0, 12.0), segment(0.0, 3.0), segment(-1.0 / 13.0, -7.0)],
            vec![segment(0.0, 0.0), segment(0.0, 2.0)],
            // The front bumper is 3.95 m ahead of the rear axle: 11 mm are left.
            vec![segment(0.0, 50.0 - 3.95 - 0.011 - 20.0)],
            Vec::new(),
        ] {
            let path = path(&segments);
            assert_eq!(judge().check(START, Goal::Pose(path.end()), &path), Ok(()));
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for (bad, expected) in [
            (segment(f64::NAN, 5.0), "curvature is NaN"),
            (segment(f64::INFINITY, 5.0), "curvature is inf"),
            (segment(0.0, f64::NAN), "length is NaN"),
            (segment(0.0, f64::NEG_INFINITY), "length is -inf"),
            (segment(5e-324, 5.0), "curvature is 5e-324, which is too small"),
            (segment(0.0, 1e-310), "length is 1e-310, which is too small"),
        ] {
            let path = path(&[segment(0.0, 5.0), bad, segment(0.0, 1.0)]);
            let refused = judge().check(START, START.into(), &path).expect_err(expected).to_string();
            assert!(refused.starts_with("segment 2 of 3, 5.00 m along, at (25.00, 22.50): its "), "{refused}");
            assert!(refused.contains(expected), "{refused}");
        }
        let nowhere = Pose { x: f64::NAN, ..START };
        assert!(judge().check(nowhere, START.into(), &Path::standing(nowhere)).is_err());
        assert!(judge().check(START, nowhere.into(), &Path::standing(START)).is_err());
        let disc = GoalDisc { centre: DVec2::NAN, radius_m: 10.0 };
        assert!(judge().check(START, disc.into(), &Path::standing(START)).is_err());
    }

    #[test]
    fn paths_without_end_are_refused() {
        let many = path(&vec![segment(0.0, 1e-4); MAX_SEGMENTS + 1]);
        assert_eq!(refusal(&many), "it has 10001 segments; the limit is 10000");
        let round = [segment(1.0 / 13.0, 7500.0), segment(-1.0 / 13.0, -7500.01)];
        assert_eq!(
            refusal(&path(&round)),
            "it is 15000.01 m long; the limit is 15000 m, 100 times width and height of the field"
        );
        assert!(refusal(&path(&[segment(0.0, 1e308), segment(0.0, 1e308)])).contains("inf m long"));
    }

    #[test]
    fn a_start_elsewhere_than_at_the_truck_is_refused() {
        let elsewhere = Path { start: Pose { y: 22.51, ..START }, segments: vec![segment(0.0, 5.0)] };
        assert_eq!(
            refusal(&elsewhere),
            "it begins at (20.00, 22.51), 0.0100 m and 0.0000 rad from the truck's pose at (20.00, 22.50), where it \
             must begin"
        );
    }

    #[test]
    fn a_turn_that_is_too_sharp_is_refused() {
        for side in [1.0, -1.0] {
            assert_eq!(
                refusal(&path(&[segment(0.0, 3.0), segment(side / 12.9, 4.0)])),
                "segment 2 of 2, 3.00 m along, at (23.00, 22.50): a turn of radius 12.90 m; the least is 13 m"
            );
        }
        let hardly = 1.0 / 13.0 + f64::EPSILON;
        let message = refusal(&path(&[segment(hardly, 4.0)]));
        assert!(message.contains("radius 12.9999999999999"), "{message}");
    }

    #[test]
    fn what_comes_too_near_is_refused_where_it_does() {
        assert_eq!(
            refusal(&path(&[segment(0.0, 12.41), segment(0.0, 13.637), segment(0.0, -5.0)])),
            "segment 2 of 3, 26.05 m along, at (46.05, 22.50): 5 mm from the bush at cell (10, 4), the least is 10 mm"
        );
        assert!(refusal(&path(&[segment(0.0, 28.0)])).ends_with("from the bush at cell (10, 4), the least is 10 mm"));
        assert!(refusal(&path(&[segment(0.0, -19.05)])).contains(" from the border, the least is 10 mm"));
        let outside = Pose { x: 0.5, ..START };
        let verdict = judge().check(outside, START.into(), &Path { start: outside, segments: vec![segment(0.0, 9.0)] });
        assert_eq!(
            verdict.expect_err("it begins outside").to_string(),
            "segment 1 of 1, 0.00 m along, at (0.50, 22.50): 450 mm outside the field, the least is 10 mm"
        );
        let verdict = judge().check(outside, outside.into(), &Path::standing(outside)).expect_err("it stands outside");
        assert!(verdict.to_string().starts_with("where it stays, at (0.50, 22.50): 450 mm outside"), "{verdict}");
        let inside = Pose { x: 52.0, ..START };
        let verdict = judge().check(inside, START.into(), &Path { start: inside, segments: vec![segment(0.0, 9.0)] });
        assert!(
            verdict.expect_err("it begins in the bush").to_string().contains(": touching the bush at cell (10, 4), ")
        );
    }

    #[test]
    fn what_comes_hardly_too_near_is_reported_with_the_digits_that_show_it() {
        // Beside the bush, whose edge is at y = 25, with half of the body's width.
        let beside = Pose { y: 25.0 + 1.1 + 0.00999, ..START };
        let path = Path { start: beside, segments: vec![segment(0.0, 50.0)] };
        let message = judge().check(beside, path.end().into(), &path).expect_err("too near").to_string();
        assert!(message.contains("9.99 mm from the bush at cell (10, 4), the least is 10 mm"), "{message}");
    }

    #[test]
    fn an_end_that_misses_the_goal_is_refused() {
        let short = path(&[segment(0.0, 24.99)]);
        let refused = |goal: Goal| judge().check(START, goal, &short).map_err(|bad| bad.to_string());
        assert_eq!(
            refused(Pose { x: 45.0, ..START }.into()),
            Err(
                "its end, 24.99 m along, at (44.99, 22.50): 0.0100 m and 0.0000 rad from the goal's pose, the most is \
                 0.001 m and 0.001 rad"
                    .into()
            )
        );
        assert!(refused(Pose { x: 44.99, heading: 0.0011, ..START }.into()).is_err());
        assert_eq!(refused(Pose { x: 44.9909, heading: 0.0009, ..START }.into()), Ok(()));
        // The body's centre is 1.5 m ahead of the rear axle.
        let disc = |radius_m| GoalDisc { centre: DVec2::new(48.49, 22.5), radius_m };
        assert_eq!(refused(disc(2.0).into()), Ok(()));
        assert_eq!(
            refused(disc(1.9).into()),
            Err("its end, 24.99 m along, with the body's centre at (46.49, 22.50): 2.00 m from the centre of the goal's \
                 disc, the most is 1.9 m"
                .into())
        );
        assert_eq!(refused(GoalDisc { radius_m: f64::INFINITY, ..disc(0.0) }.into()), Ok(()));
        let place = GoalDisc { centre: DVec2::new(46.49, 22.5), radius_m: 0.0 };
        assert_eq!(refused(place.into()), Ok(()));
    }

    #[test]
    fn a_motion_is_refused_where_it_is_refused_by_the_checker_and_the_place_is_too_near() {
        let (mut refused, mut grazed) = (0, 0);
        for seed in 0..20 {
            let mut field = TestField::random(seed, 40);
            for _ in 0..300 {
                let start = random_pose(&mut field.rng, 150.0);
                let side = field.rng.random_range(-1..=1);
                let segment = segment(f64::from(side) / 13.0, field.rng.random_range(-30.0..30.0));
                let place = field.checker.refused_at(start, segment, MIN_CLEARANCE_M);
                assert_eq!(place.is_none(), field.checker.motion_is_free(start, segment, MIN_CLEARANCE_M));
                let Some(metres) = place else { continue };
                let pose = segment.pose_at(start, metres.copysign(segment.length_m));
                let gap_m = field.checker.nearest_obstacle(pose).gap_m;
                assert!(gap_m < MIN_CLEARANCE_M + 1e-9, "{start:?} {segment:?}: {gap_m} m at {metres} m");
                assert!((gap_m - field.checker.clearance(pose)).abs() < 1e-9);
                let before = Path { start, segments: vec![segment.with_length((metres - 1e-6).max(0.0))] };
                let min_m = least_clearance(&field.checker, &before);
                assert!(metres == 0.0 || min_m > 0.0, "{start:?} {segment:?}: {min_m} m before {metres} m");
                refused += 1;
                grazed += u32::from(metres > 0.0);
            }
        }
        assert!(refused > 1000 && grazed > 500, "{refused} refused, {grazed} of them on the way");
    }

    #[test]
    fn no_drive_into_a_disc_is_shorter_than_its_bound() {
        let body = Dimensions::default();
        // Round in a circle, the body's centre moves farther than the rear axle.
        for metres in [1.0, 5.0, 20.0] {
            let path = path(&[segment(body.max_curvature(), metres)]);
            let disc = GoalDisc { centre: body.body_centre(path.end()), radius_m: 0.0 };
            assert!(lower_bound_m(START, Goal::Disc(disc), &body) <= metres);
        }
        let nowhere = Pose { heading: f64::NAN, ..START };
        for (start, goal) in [(nowhere, START), (START, nowhere)] {
            assert_eq!(lower_bound_m(start, goal.into(), &body), 0.0);
        }
    }

    #[test]
    fn drawn_poses_are_free_and_a_full_field_has_none() {
        let mut rng = rng::stream(1, "planning/judge");
        let field = TestField::random(3, 40);
        let poses: Vec<Pose> = crate::kit::ends::free_poses(&field.checker, 0.5, &mut rng).take(50).collect();
        assert!(poses.len() == 50 && poses.iter().all(|&pose| field.checker.pose_is_free(pose, 0.5)));
        let full = TestField::drawn(&["####", "####", "####"], START);
        assert_eq!(crate::kit::ends::free_poses(&full.checker, 0.5, &mut rng).next(), None);
    }
}
