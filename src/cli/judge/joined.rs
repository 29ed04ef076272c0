//! Poses joined by arcs, and what is wrong with them.
//!
//! Between two poses the truck drives the arc whose chord and whose turn are theirs. Others compute in single precision,
//! by small steps or with curves of changing curvature, so the arcs are allowed a little more than the truck's own
//! planners are: a curvature above 1/radius by 1 % and [`CURVATURE_SLACK`], and a little way sideways, as a joint of
//! two turns between two poses makes. Clearance has no such slack.

use wildfire_audit::{AuditField, Outline, SampleStep, UnitPose, ViolationKind};
use wildfire_base::document::number::beside_limit;
use wildfire_base::geometry::{DVec2, Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path, Segment};
use wildfire_batch::drives::missed;
use wildfire_planning::collision::{ClearanceField, CollisionChecker};
use wildfire_planning::judge::{DriveFigures, Judge, MAX_FIELDS_LONG, lower_bound_ratio};
use wildfire_planning::{Goal, lower_bound_m};
use wildfire_scenario::Problem;
use wildfire_timeline::Body;

use super::path_table::TablePose;

/// The figures of a path, and its first violation in words.
#[derive(Debug)]
pub struct PathVerdict {
    pub figures: DriveFigures,
    pub violation: Option<String>,
}

/// The excess of curvature that is allowed: as a share, and in 1/m.
const CURVATURE_SHARE: f64 = 0.01;
pub const CURVATURE_SLACK: f64 = 1e-3;

/// The excess of a turn between two poses that is allowed, radians: rounding, where the poses are next to each other.
const TURN_ROUNDING_RAD: f64 = 1e-9;

/// The way sideways that is allowed on a metre, and beyond all that is allowed at once, metres.
const SLIP_SHARE: f64 = 1e-3;
const SLIP_ROUNDING_M: f64 = 1e-3;

/// Ways of less than this are none, metres: nothing can be computed with them.
const STANDING_M: f64 = 1e-12;

/// Turns of less than this are straight on, radians.
const STRAIGHT_RAD: f64 = 1e-12;

/// Judges paths on one field.
pub struct PathJudge<'a> {
    problem: &'a Problem,
    judge: Judge,
    audit_field: AuditField,
    limits: SpeedLimits,
}

/// Two poses joined by an arc.
#[derive(Clone, Copy, Debug)]
struct PoseArc {
    /// The line of the second pose.
    line: u64,
    start: Pose,
    segment: Segment,
    /// Radians, without sign.
    turn_rad: f64,
    /// The way between the poses that no arc from one heading to the other leads along, metres.
    slip_m: f64,
}

impl PoseArc {
    fn new(from: &TablePose, to: &TablePose) -> Self {
        let turn = ops::wrap_angle(to.pose.heading - from.pose.heading);
        // The chord of an arc has the heading halfway between those of its ends.
        let along = Pose { heading: from.pose.heading + 0.5 * turn, ..from.pose }.direction();
        let step = to.pose.position() - from.pose.position();
        let sense = if to.is_reverse { -1.0 } else { 1.0 };
        let ahead_m = Some(sense * step.dot(along)).filter(|ahead_m| ahead_m.abs() > STANDING_M).unwrap_or(0.0);
        let half_turn = 0.5 * turn.abs();
        let is_straight = turn.abs() < STRAIGHT_RAD;
        // This is the length of an arc over that of its chord; for small turns the quotient would be 0 / 0.
        let arc_over_chord = if is_straight { 1.0 } else { half_turn / ops::sin(half_turn) };
        let length_m = ahead_m.max(0.0) * arc_over_chord;
        let curvature = if is_straight || length_m == 0.0 { 0.0 } else { turn / (sense * length_m) };
        Self {
            line: to.line,
            start: from.pose,
            segment: Segment { curvature, length_m: sense * length_m },
            turn_rad: turn.abs(),
            slip_m: along.perp_dot(step).abs() + (-ahead_m).max(0.0),
        }
    }

    /// Poses after its start, up to its end, as closely as the audit looks.
    fn samples(&self) -> impl Iterator<Item = Pose> + '_ {
        let SampleStep { metres, degrees } = SampleStep::default();
        let steps = (self.segment.length_m.abs() / metres).max(self.turn_rad / degrees.to_radians()).ceil().max(1.0);
        (1..=steps as u32)
            .map(move |step| self.segment.pose_at(self.start, self.segment.length_m * (f64::from(step) / steps)))
    }
}

impl<'a> PathJudge<'a> {
    pub fn new(problem: &'a Problem) -> Self {
        let field = ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied);
        let outline = Outline::new(&Body::Truck(problem.truck.vehicle));
        Self {
            problem,
            judge: Judge::new(CollisionChecker::new(field.into(), problem.truck.vehicle)),
            audit_field: AuditField::new(problem.terrain.frame, &problem.terrain.bushes, outline),
            limits: problem.truck.speed_limits(),
        }
    }

    fn body(&self) -> &Dimensions {
        &self.problem.truck.vehicle
    }

    /// Returns the figures of a path to a goal, and the first thing that is wrong with it.
    pub fn judge(&self, goal: Goal, poses: &[TablePose]) -> PathVerdict {
        let arcs: Vec<PoseArc> = poses.windows(2).map(|pair| PoseArc::new(&pair[0], &pair[1])).collect();
        let start = poses[0].pose;
        let end = poses[poses.len() - 1].pose;
        let segments = arcs.iter().map(|arc| arc.segment).collect();
        let path = Path { start, segments };
        // Adding 0 turns the -0 of an empty path into 0.
        let length_m = path.length_m() + 0.0;
        let bound_m = lower_bound_m(self.problem.start, goal, self.body());
        let changes = poses.windows(2).skip(1).filter(|pair| pair[0].is_reverse != pair[1].is_reverse);
        let frame = self.problem.terrain.frame;
        let max_m = MAX_FIELDS_LONG * (frame.width_m() + frame.height_m());
        // The way of a path without end is not looked at.
        let is_endless = length_m > max_m;
        let examined = arcs.iter().flat_map(PoseArc::samples).take(if is_endless { 0 } else { usize::MAX });
        let figures = DriveFigures {
            length_m,
            lower_bound_ratio: lower_bound_ratio(length_m, bound_m),
            min_clearance_m: self.judge.min_clearance_m(std::iter::once(start).chain(examined)),
            cusps: changes.count() as u32,
            drive_s: Trajectory::from_path(&path, SimTime::ZERO, self.limits).duration_s(),
        };
        if is_endless {
            let [found, limit] = beside_limit(length_m, max_m, 2);
            return PathVerdict { figures, violation: Some(format!("it is {found} m long; the limit is {limit} m")) };
        }
        let begins = missed(Goal::Pose(self.problem.start), start, self.body());
        let begins = begins.map(|by| format!("line {}: it begins {by} away from the start", poses[0].line));
        let touches = || {
            let touch = self.audit_field.touch(UnitPose::new(start))?;
            Some(located_message(poses[0].line, 0.0, start, ViolationKind::Touched(touch)))
        };
        let ends = || {
            let last = poses[poses.len() - 1].line;
            missed(goal, end, self.body()).map(|by| format!("line {last}: it ends {by} away"))
        };
        // The start comes first and the end last: the first thing that is wrong explains what follows.
        PathVerdict { figures, violation: begins.or_else(touches).or_else(|| self.violation(&arcs)).or_else(ends) }
    }

    /// Finds the first place where the arcs turn too sharply, do not lead on, or touch something.
    fn violation(&self, arcs: &[PoseArc]) -> Option<String> {
        let radius_m = self.body().turning_radius_m;
        let max = (1.0 + CURVATURE_SHARE) / radius_m + CURVATURE_SLACK;
        let (mut along_m, mut slipped_m) = (0.0, 0.0_f64);
        for arc in arcs {
            let length_m = arc.segment.length_m.abs();
            if arc.turn_rad > max * length_m + TURN_ROUNDING_RAD {
                let found = arc.turn_rad / length_m;
                let [found, limit] = beside_limit(found, max, 4);
                let turn = match length_m {
                    0.0 => format!("it turns by {:.4} rad on the spot", arc.turn_rad),
                    _ => format!("a curvature of {found} 1/m; the limit is {limit} 1/m (turning radius {radius_m} m)"),
                };
                return Some(located_message(arc.line, along_m, arc.start, turn));
            }
            // The first term is the way sideways of a joint of two turns at the allowed curvature.
            let is_allowed = 0.25 * max * length_m * length_m + SLIP_SHARE * length_m;
            // What was allowed and not used is not saved up, or a long path could jump sideways at its end.
            slipped_m = (slipped_m + arc.slip_m - is_allowed).max(0.0);
            if slipped_m > SLIP_ROUNDING_M {
                let found = format!("it moves {:.1} mm sideways on {:.3} m", 1e3 * arc.slip_m, length_m);
                let allowed = format!(
                    "the limit is {:.1} mm, plus {:.0} mm once per path",
                    1e3 * is_allowed,
                    1e3 * SLIP_ROUNDING_M
                );
                return Some(located_message(arc.line, along_m, arc.start, format!("{found}, {allowed}")));
            }
            for pose in arc.samples() {
                if let Some(touch) = self.audit_field.touch(UnitPose::new(pose)) {
                    let there_m = along_m + pose.position().distance(arc.start.position());
                    return Some(located_message(arc.line, there_m, pose, ViolationKind::Touched(touch)));
                }
            }
            along_m += length_m;
        }
        None
    }
}

fn located_message(line: u64, along_m: f64, pose: Pose, what: impl std::fmt::Display) -> String {
    let DVec2 { x, y } = pose.position();
    format!("line {line}, {along_m:.2} m along, at ({x:.2}, {y:.2}): {what}")
}
