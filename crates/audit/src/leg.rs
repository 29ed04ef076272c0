//! One leg of an agent, sample by sample.
//!
//! The audit drives every piece by itself, in small steps of equal length, and compares where it gets with what the
//! timeline says in the middle and at the end of the piece.

use super::field::{AuditField, UnitPose};
use super::pace::{DriveProfile, audit_pace};
use super::tolerance::{SAME_POSE, Tolerance};
use super::{Audited, Violation, ViolationKind};
use wildfire_base::geometry::{DVec2, Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_base::vehicle::Segment;

/// Share of the largest curvature that is noise.
const RELATIVE_NOISE: f64 = 1e-9;

/// The work that one piece of a leg may take: poses, each with its share of the cells under the body.
const MAX_WORK: f64 = 1e10;

/// The work of a pose besides the cells under the body, in looks at a cell.
const WORK_OF_POSE: f64 = 16.0;

/// Steps that are added up before the next one is taken by a single long step from the start of its piece, so that
/// roundings do not add up along the way.
pub const STRIDE: u64 = 256;

/// No two samples of a leg are farther apart than this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleStep {
    pub metres: f64,
    pub degrees: f64,
}

impl Default for SampleStep {
    fn default() -> Self {
        Self { metres: 0.02, degrees: 0.2 }
    }
}

/// The limits of an agent's motion.
#[derive(Clone, Copy, Debug)]
pub struct MotionLimits {
    /// The smallest radius of its turns; without one it turns on the spot.
    pub turning_radius_m: Option<f64>,
    /// Without them no speed is checked.
    pub limits: Option<SpeedLimits>,
}

/// Finds the first violation of a leg: a sample that is not free, a turn that is too tight, a speed beyond its limits,
/// a state that its pieces do not lead to.
///
/// Between two samples a body could dip into a bush by a fraction of the step.
pub fn audit_leg(
    field: &AuditField,
    motion: &MotionLimits,
    leg: &Trajectory,
    step: SampleStep,
) -> Result<Audited, Violation> {
    // Speeds and shapes are independent; the violation that comes first in time is reported.
    let pace = motion.limits.map_or(Ok(()), |limits| audit_pace(leg, &limits));
    let tolerance = Tolerance::from_leg(leg);
    let moves = !leg.pieces().is_empty();
    let audited = Audited { legs: moves.into(), poses: 1, ..Audited::default() };
    let way = LegAudit { field, motion, leg, step, tolerance, audited }.drive().map_err(|broken| Violation {
        time: leg.start_time() + SimTime::from_seconds(broken.elapsed_s),
        agent: None,
        place: broken.place,
        kind: broken.kind,
    });
    match (pace, way) {
        (Err(of_pace), Err(of_way)) if of_way.time < of_pace.time => Err(of_way),
        (Err(of_pace), _) => Err(of_pace),
        (Ok(()), way) => way,
    }
}

/// A leg, the rules that it is held against, and how much of it was looked at.
struct LegAudit<'a> {
    field: &'a AuditField,
    motion: &'a MotionLimits,
    leg: &'a Trajectory,
    step: SampleStep,
    tolerance: Tolerance,
    audited: Audited,
}

impl LegAudit<'_> {
    fn drive(mut self) -> Result<Audited, LegViolation> {
        let mut now = LegMoment { elapsed_s: 0.0, pose: self.leg.start() };
        // The start itself: pieces below look at what comes after.
        if let Some(touch) = self.field.touch(UnitPose::new(now.pose)) {
            return Err(now.broken(ViolationKind::Touched(touch)));
        }
        for piece in self.leg.pieces() {
            now = match *piece {
                Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                    let drive = DriveProfile::new(segment.length_m.abs(), speed_mps, acceleration_mps2);
                    self.drive_segment(now, segment, drive)?
                }
                Piece::Turn { heading } => self.turn(now, heading)?,
                Piece::Wait { seconds } => now.after(seconds, now.pose),
            };
            self.check_moment(now)?;
        }
        Ok(self.audited)
    }

    /// Compares the state after a piece with the timeline's. A turn on the spot may be a nanosecond off, so whoever makes
    /// them has to be at the right place only.
    fn check_moment(&self, now: LegMoment) -> Result<(), LegViolation> {
        if !(now.elapsed_s.is_finite() && now.elapsed_s >= 0.0) {
            return Err(now.broken(ViolationKind::NotANumber));
        }
        let turns_on_the_spot = self.motion.turning_radius_m.is_none();
        let radians = if turns_on_the_spot { f64::INFINITY } else { self.tolerance.radians };
        check_state(self.leg, now.elapsed_s, UnitPose::new(now.pose), Tolerance { radians, ..self.tolerance })
    }

    fn turn(&self, now: LegMoment, heading: f64) -> Result<LegMoment, LegViolation> {
        let turned = ops::wrap_angle(heading - now.pose.heading).abs();
        match self.motion.turning_radius_m {
            Some(min_m) if turned > SAME_POSE => Err(now.broken(ViolationKind::Curvature { radius_m: 0.0, min_m })),
            _ => Ok(now.after(0.0, Pose::new(now.pose.x, now.pose.y, heading))),
        }
    }

    fn drive_segment(
        &mut self,
        now: LegMoment,
        segment: Segment,
        drive: DriveProfile,
    ) -> Result<LegMoment, LegViolation> {
        // A recording may hold any numbers, and NaN would pass the comparisons below.
        let numbers = [segment.curvature, segment.length_m, drive.seconds, drive.fastest_mps()];
        if !numbers.into_iter().all(f64::is_finite) {
            return Err(now.broken(ViolationKind::NotANumber));
        }
        self.check_curvature(&segment).map_err(|kind| now.broken(kind))?;
        let way = SteppedSegment::new(segment, self.step);
        // Before the first step, as a forged length could take forever.
        if way.count * work_of_pose(self.field) > MAX_WORK {
            return Err(now.broken(ViolationKind::Endless));
        }
        let start = UnitPose::new(now.pose);
        // Exact, as the work is bounded far below 2^53.
        let count = way.count as u64;
        let mut at = start;
        for step in 1..=count {
            at = way.advance(start, at, step);
            if let Some(touch) = self.field.touch(at) {
                let elapsed_s = now.elapsed_s + drive.seconds_to(way.metres(step));
                return Err(LegViolation { elapsed_s, place: at.place, kind: ViolationKind::Touched(touch) });
            }
            // The end of the piece is compared by whoever calls; a piece that bends the wrong way and back is found here.
            if step == count / 2 {
                check_state(self.leg, now.elapsed_s + drive.seconds_to(way.metres(step)), at, self.tolerance)?;
            }
        }
        self.audited.poses += count;
        self.audited.metres += segment.length_m.abs();
        let heading = now.pose.heading + segment.curvature * segment.length_m;
        Ok(now.after(drive.seconds, Pose::new(at.place.x, at.place.y, heading)))
    }

    fn check_curvature(&self, segment: &Segment) -> Result<(), ViolationKind> {
        let radius_m = 1.0 / segment.curvature.abs();
        match self.motion.turning_radius_m {
            Some(min_m) if radius_m < min_m * (1.0 - RELATIVE_NOISE) && segment.length_m != 0.0 => {
                Err(ViolationKind::Curvature { radius_m, min_m })
            }
            _ => Ok(()),
        }
    }
}

/// Returns the work of a pose, in looks at a cell.
pub fn work_of_pose(field: &AuditField) -> f64 {
    WORK_OF_POSE + field.cells_under_body()
}

/// A violation on a leg, in seconds after its start.
struct LegViolation {
    elapsed_s: f64,
    place: DVec2,
    kind: ViolationKind,
}

/// The state that the audit has come to, in seconds after the start of the leg.
#[derive(Clone, Copy)]
struct LegMoment {
    elapsed_s: f64,
    pose: Pose,
}

impl LegMoment {
    fn after(self, seconds: f64, pose: Pose) -> Self {
        Self { elapsed_s: self.elapsed_s + seconds, pose }
    }

    fn broken(self, kind: ViolationKind) -> LegViolation {
        LegViolation { elapsed_s: self.elapsed_s, place: self.pose.position(), kind }
    }
}

/// Checks that the timeline says the same.
fn check_state(leg: &Trajectory, elapsed_s: f64, at: UnitPose, tolerance: Tolerance) -> Result<(), LegViolation> {
    let reported = UnitPose::new(leg.pose_at(leg.start_time() + SimTime::from_seconds(elapsed_s)));
    let metres = (reported.place - at.place).length();
    let radians = (reported.facing - at.facing).length();
    if metres <= tolerance.metres && radians <= tolerance.radians {
        return Ok(());
    }
    Err(LegViolation { elapsed_s, place: at.place, kind: ViolationKind::Astray { metres, radians } })
}

/// A segment in steps of equal length: each turns the body by the same angle along a chord of the same length.
struct SteppedSegment {
    /// A whole number.
    count: f64,
    curvature: f64,
    step_m: f64,
    step: ArcStep,
}

impl SteppedSegment {
    fn new(segment: Segment, step: SampleStep) -> Self {
        let turned = (segment.curvature * segment.length_m).abs();
        let count = (segment.length_m.abs() / step.metres).max(turned / step.degrees.to_radians()).ceil().max(1.0);
        let step_m = segment.length_m / count;
        Self { count, curvature: segment.curvature, step_m, step: ArcStep::new(segment.curvature, step_m) }
    }

    /// Returns the stance after step number `step`, from the one before it; now and then from the start of the way
    /// instead.
    fn advance(&self, start: UnitPose, before: UnitPose, step: u64) -> UnitPose {
        if step.is_multiple_of(STRIDE) {
            return ArcStep::new(self.curvature, step as f64 * self.step_m).from(start);
        }
        self.step.from(before)
    }

    /// Metres along the way after a number of steps.
    fn metres(&self, steps: u64) -> f64 {
        steps as f64 * self.step_m.abs()
    }
}

/// A stretch of an arc: its chord, and the unit vector of the angle that it turns by, in the frame of its start.
struct ArcStep {
    chord: DVec2,
    turn: DVec2,
}

impl ArcStep {
    fn new(curvature: f64, metres: f64) -> Self {
        let half_turn = 0.5 * curvature * metres;
        let chord_m = if half_turn == 0.0 { metres } else { 2.0 * ops::sin(half_turn) / curvature };
        Self { chord: direction(half_turn) * chord_m, turn: direction(2.0 * half_turn) }
    }

    fn from(&self, at: UnitPose) -> UnitPose {
        UnitPose { place: at.place + at.facing.rotate(self.chord), facing: at.facing.rotate(self.turn) }
    }
}

/// Returns the unit vector of a heading.
fn direction(angle: f64) -> DVec2 {
    DVec2::new(ops::cos(angle), ops::sin(angle))
}

#[cfg(test)]
mod tests {
    use super::super::field::{Contact, Outline};
    use super::*;
    use wildfire_base::geometry::{Cell, FieldFrame};
    use wildfire_base::vehicle::{Dimensions, Path};
    use wildfire_timeline::Body;

    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: None,
        braking_mps2: None,
        lateral_mps2: None,
        steering: None,
    };

    fn segment(curvature: f64, length_m: f64) -> Segment {
        Segment { curvature, length_m }
    }

    fn leg(start: Pose, segments: Vec<Segment>) -> Trajectory {
        Trajectory::from_path(&Path { start, segments }, SimTime::from_seconds(7.0), LIMITS)
    }

    fn audit(leg: &Trajectory) -> Result<Audited, Violation> {
        let frame = FieldFrame { cols: 20, rows: 20, cell_m: 5.0 };
        let truck = Outline::new(&Body::Truck(Dimensions::default()));
        let field = AuditField::new(frame, &[Cell { col: 10, row: 10 }], truck);
        let motion = MotionLimits { turning_radius_m: Some(13.0), limits: Some(LIMITS) };
        audit_leg(&field, &motion, leg, SampleStep::default())
    }

    fn winding() -> Vec<Segment> {
        vec![segment(1.0 / 13.0, 9.0), segment(-1.0 / 13.0, -6.0), segment(0.0, -3.0), segment(1.0 / 13.0, 5.0)]
    }

    #[test]
    fn a_proper_leg_passes_at_the_requested_step() {
        let audited = audit(&leg(Pose::new(20.0, 20.0, 0.5), winding())).expect("nothing is wrong with it");
        assert!(audited.poses >= 23 * 50, "{} poses", audited.poses);
        assert!((audited.metres - 23.0).abs() < 1e-9);
        let slow = SpeedLimits { acceleration_mps2: Some(1.0), braking_mps2: Some(3.0), ..LIMITS };
        let path = Path { start: Pose::new(20.0, 20.0, 0.5), segments: winding() };
        let leg = Trajectory::from_path(&path, SimTime::ZERO, slow);
        audit(&leg).expect("limits of acceleration break no rule");
        audit(&leg.stopping(SimTime::from_seconds(2.0), &SpeedLimits { braking_mps2: Some(2.0), ..slow }))
            .expect("nor does a brake");
    }

    #[test]
    fn steps_lead_where_the_closed_form_does() {
        let ways = [(1.0 / 13.0, 77.7), (-1.0 / 13.0, -40.0), (0.0, -9.99), (1e-9, 30.0), (0.2, 1e-7), (1e-3, 300.0)];
        for (curvature, length_m) in ways {
            let start = Pose::new(3.0, -2.0, 2.9);
            let segment = segment(curvature, length_m);
            let way = SteppedSegment::new(segment, SampleStep::default());
            let mut at = UnitPose::new(start);
            for step in 1..=way.count as u64 {
                at = way.advance(UnitPose::new(start), at, step);
            }
            let end = UnitPose::new(segment.end(start));
            assert!((end.place - at.place).length() < 1e-11 && (end.facing - at.facing).length() < 1e-12);
            assert!(way.step_m.abs() <= 0.02 && way.step.turn.y.abs() <= 0.2_f64.to_radians());
        }
    }

    #[test]
    fn roundings_of_steps_do_not_add_up_over_a_long_way() {
        for (curvature, length_m) in [(0.0, 60_000.0), (2e-5, -60_000.0), (1.0 / 13.0, 20_000.0)] {
            let start = Pose::new(20_000.0, 30_000.0, 0.7);
            let segment = segment(curvature, length_m);
            let leg = Trajectory::from_path(&Path { start, segments: vec![segment] }, SimTime::ZERO, LIMITS);
            let way = SteppedSegment::new(segment, SampleStep::default());
            let start = UnitPose::new(start);
            let at = (1..=way.count as u64).fold(start, |at, step| way.advance(start, at, step));
            let end = UnitPose::new(leg.end());
            let granted = Tolerance::from_leg(&leg);
            let metres = (end.place - at.place).length();
            let rounding = granted.metres - SAME_POSE;
            assert!(metres < rounding && rounding < 1e-6, "{curvature}: {metres} m of {rounding}");
            assert!((end.facing - at.facing).length() < granted.radians - SAME_POSE, "{curvature}");
        }
    }

    #[test]
    fn a_bush_in_the_way_is_found_with_time_and_place() {
        let violation = audit(&leg(Pose::new(40.0, 52.5, 0.0), vec![segment(0.0, 20.0)])).expect_err("there is a bush");
        let ViolationKind::Touched(Contact::Bush { cell, .. }) = violation.kind else { panic!("{violation}") };
        assert_eq!(cell, Cell { col: 10, row: 10 });
        assert!((violation.place.x - 46.05).abs() < 0.025, "{violation}");
        assert!((violation.time.as_seconds() - (7.0 + 6.05 / 8.0)).abs() < 0.005, "{violation}");
        assert!(violation.to_string().contains("cell (10, 10)"));
    }

    #[test]
    fn a_corner_that_cuts_a_bush_in_passing_is_found() {
        let beside = |y| audit(&leg(Pose::new(30.0, y, 0.0), vec![segment(0.0, 40.0)]));
        assert!(beside(50.0 - 1.11).is_ok());
        assert!(beside(50.0 - 1.09).is_err());
    }

    #[test]
    fn the_field_ends_at_its_border() {
        let violation = audit(&leg(Pose::new(90.0, 20.0, 0.0), vec![segment(0.0, 10.0)])).expect_err("it leaves");
        assert!(matches!(violation.kind, ViolationKind::Touched(Contact::Border { .. })), "{violation}");
    }

    #[test]
    fn a_turn_tighter_than_the_radius_is_found() {
        for curvature in [1.0 / 12.999, -1.0 / 12.999] {
            let tight = leg(Pose::new(20.0, 20.0, 0.0), vec![segment(0.0, 3.0), segment(curvature, 5.0)]);
            let violation = audit(&tight).expect_err("too tight");
            assert!(matches!(violation.kind, ViolationKind::Curvature { min_m: 13.0, .. }), "{violation}");
            assert!((violation.place - DVec2::new(23.0, 20.0)).length() < 1e-9, "{violation}");
        }
        let spot = Trajectory::new(SimTime::ZERO, Pose::new(20.0, 20.0, 0.0), vec![Piece::Turn { heading: 0.01 }]);
        assert!(matches!(audit(&spot).expect_err("trucks do not spin").kind, ViolationKind::Curvature { .. }));
    }

    #[test]
    fn speeding_is_a_violation_of_the_leg() {
        let piece = Piece::Drive { segment: segment(0.0, 9.0), speed_mps: 8.1, acceleration_mps2: 0.0 };
        let leg = Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![piece]);
        assert!(matches!(audit(&leg).expect_err("too fast").kind, ViolationKind::Speed { .. }));
    }

    #[test]
    fn of_two_violations_the_first_in_time_is_reported() {
        let drive = |length_m, speed_mps| {
            let segment = segment(0.0, length_m);
            Piece::Drive { segment, speed_mps, acceleration_mps2: 0.0 }
        };
        let into_the_bush = |pieces| Trajectory::new(SimTime::ZERO, Pose::new(40.0, 52.5, 0.0), pieces);
        let late = audit(&into_the_bush(vec![drive(7.0, 8.0), drive(7.0, 9.0)])).expect_err("it hits the bush");
        assert!(matches!(late.kind, ViolationKind::Touched(_)), "{late}");
        let early = audit(&into_the_bush(vec![drive(4.0, 9.0), drive(7.0, 8.0)])).expect_err("it speeds");
        assert!(matches!(early.kind, ViolationKind::Speed { .. }), "{early}");
    }

    #[test]
    fn what_is_not_a_number_is_a_violation() {
        for segment in [segment(f64::NAN, 5.0), segment(0.0, f64::NAN), segment(0.0, f64::INFINITY)] {
            let piece = Piece::Drive { segment, speed_mps: 2.0, acceleration_mps2: 0.0 };
            assert!(audit(&Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![piece])).is_err());
        }
        let never = Piece::Drive { segment: segment(0.0, 5.0), speed_mps: 0.0, acceleration_mps2: 0.0 };
        assert!(audit(&Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![never])).is_err());
    }

    #[test]
    fn a_way_without_end_is_not_driven_to_its_end() {
        let circling = Piece::Drive { segment: segment(1.0 / 13.0, 1e15), speed_mps: 8.0, acceleration_mps2: 0.0 };
        let leg = Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![circling]);
        assert_eq!(audit(&leg).expect_err("nobody can look at that").kind, ViolationKind::Endless);
    }
}
