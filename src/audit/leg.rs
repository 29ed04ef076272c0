//! One leg of a truck, sample by sample.

use std::fmt;

use super::{Audited, Ground, Touch};
use crate::geometry::{Pose, ops};
use crate::time::SimTime;
use crate::trajectory::{Piece, SpeedLimits, Trajectory};
use crate::vehicle::Dimensions;

/// Metres, and radians, that are noise: a nanosecond's way and the rounding of places.
const NOISE: f64 = 1e-7;

/// Share of a limit that is noise.
const RELATIVE_NOISE: f64 = 1e-5;

/// No two samples of a leg are farther apart than this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub metres: f64,
    pub degrees: f64,
}

impl Default for Step {
    fn default() -> Self {
        Self { metres: 0.02, degrees: 0.1 }
    }
}

/// A rule that a leg broke, by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Breach {
    Touched(Touch),
    /// The heading turned by `found` radians where the way allows `limit`.
    Curvature {
        found: f64,
        limit: f64,
    },
    /// The rear axle moved `metres` sideways.
    Slid {
        metres: f64,
    },
    /// It moved `found` metres within a time that allows `limit`.
    Speed {
        found: f64,
        limit: f64,
    },
    /// A time or a place that is not a number.
    NotANumber,
}

/// The first breach of a leg: when, and at which pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offence {
    pub time: SimTime,
    pub pose: Pose,
    pub breach: Breach,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Touched(Touch::Bush { cell, depth_m }) => {
                write!(f, "the body is {:.1} mm deep in the bush at cell {cell}", 1e3 * depth_m)
            }
            Self::Touched(Touch::Border { depth_m }) => {
                write!(f, "the body is {:.1} mm outside of the field", 1e3 * depth_m)
            }
            Self::Curvature { found, limit } => {
                write!(f, "the heading turns by {found:.6} rad where the turning radius allows {limit:.6} rad")
            }
            Self::Slid { metres } => write!(f, "the rear axle moves {metres:.6} m sideways"),
            Self::Speed { found, limit } => {
                write!(f, "it moves {found:.6} m in a time that its speed limit gives {limit:.6} m")
            }
            Self::NotANumber => write!(f, "its time or place is not a number"),
        }
    }
}

impl fmt::Display for Offence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Pose { x, y, heading } = self.pose;
        write!(f, "at {}, ({x:.3}, {y:.3}) m, heading {heading:.4} rad: {}", self.time, self.breach)
    }
}

/// Samples a truck's leg and holds every sample, and every pair of neighbours, against the rules.
///
/// Speeds are checked forward and reverse; infinite limits check nothing. Between two samples a body could dip into a
/// bush by a fraction of the step.
pub fn audit_leg(
    ground: &Ground,
    body: &Dimensions,
    limits: &SpeedLimits,
    leg: &Trajectory,
    step: Step,
) -> Result<Audited, Offence> {
    let mut audited = Audited { legs: 1, samples: 1, ..Audited::default() };
    let mut last = (leg.start_time(), leg.start());
    check_place(ground, body, last)?;
    let mut began_s = 0.0;
    for piece in leg.pieces() {
        let seconds = piece.duration_s();
        if !(seconds.is_finite() && seconds >= 0.0) {
            return Err(Offence { time: last.0, pose: last.1, breach: Breach::NotANumber });
        }
        let count = sample_count(piece, seconds, step);
        for sample in 1..=count {
            let elapsed = began_s + seconds * (sample as f64 / count as f64);
            let time = leg.start_time() + SimTime::from_seconds(elapsed);
            let here = (time, leg.pose_at(time));
            check_place(ground, body, here)?;
            check_motion(body, limits, last, here)?;
            audited.metres += (here.1.position() - last.1.position()).length();
            last = here;
        }
        audited.samples += count;
        began_s += seconds;
    }
    let end = (leg.end_time(), leg.pose_at(leg.end_time()));
    check_place(ground, body, end)?;
    check_motion(body, limits, last, end)?;
    Ok(audited)
}

/// How many steps of equal time a piece needs so that none is longer than asked.
fn sample_count(piece: &Piece, seconds: f64, step: Step) -> u64 {
    let Piece::Drive { segment, speed_mps, acceleration_mps2 } = *piece else { return 1 };
    let fastest = speed_mps.max(speed_mps + acceleration_mps2 * seconds);
    let way = fastest * seconds;
    let turns = way * segment.curvature.abs() / step.degrees.to_radians();
    (way / step.metres).max(turns).ceil().max(1.0) as u64
}

fn check_place(ground: &Ground, body: &Dimensions, (time, pose): (SimTime, Pose)) -> Result<(), Offence> {
    match ground.touch(body, pose) {
        Some(touch) => Err(Offence { time, pose, breach: Breach::Touched(touch) }),
        None => Ok(()),
    }
}

/// What may happen between two samples that no cusp lies between.
fn check_motion(
    body: &Dimensions,
    limits: &SpeedLimits,
    (earlier, from): (SimTime, Pose),
    (time, to): (SimTime, Pose),
) -> Result<(), Offence> {
    let offence = |breach| Err(Offence { time, pose: to, breach });
    let chord = to.position() - from.position();
    let turn = ops::wrap_angle(to.heading - from.heading);
    // The chord of an arc lies along the heading at its middle.
    let mean = from.heading + 0.5 * turn;
    let (sin, cos) = ops::sin_cos(mean);
    let (along, across) = (chord.x * cos + chord.y * sin, chord.y * cos - chord.x * sin);
    let speed = if along < 0.0 { limits.reverse_mps } else { limits.forward_mps };
    let allowed_way = speed * time.since(earlier).as_seconds() * (1.0 + RELATIVE_NOISE) + NOISE;
    let allowed_turn = along.abs() / body.turning_radius_m * (1.0 + RELATIVE_NOISE) + NOISE;
    if !(turn.is_finite() && chord.is_finite()) {
        return offence(Breach::NotANumber);
    }
    if chord.length() > allowed_way {
        return offence(Breach::Speed { found: chord.length(), limit: allowed_way });
    }
    if across.abs() > RELATIVE_NOISE * along.abs() + NOISE {
        return offence(Breach::Slid { metres: across.abs() });
    }
    if turn.abs() > allowed_turn {
        return offence(Breach::Curvature { found: turn.abs(), limit: allowed_turn });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Cell, FieldFrame};
    use crate::vehicle::{Path, Segment};

    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: None,
        braking_mps2: None,
        lateral_mps2: None,
    };

    fn ground() -> Ground {
        Ground::new(FieldFrame { cols: 20, rows: 20, cell_m: 5.0 }, &[Cell { col: 10, row: 10 }])
    }

    fn segment(curvature: f64, length_m: f64) -> Segment {
        Segment { curvature, length_m }
    }

    fn leg(start: Pose, segments: Vec<Segment>) -> Trajectory {
        Trajectory::along(&Path { start, segments }, SimTime::from_seconds(7.0), LIMITS)
    }

    fn audit(leg: &Trajectory) -> Result<Audited, Offence> {
        audit_leg(&ground(), &Dimensions::default(), &LIMITS, leg, Step::default())
    }

    fn winding() -> Vec<Segment> {
        vec![segment(1.0 / 13.0, 9.0), segment(-1.0 / 13.0, -6.0), segment(0.0, -3.0), segment(1.0 / 13.0, 5.0)]
    }

    #[test]
    fn a_proper_leg_passes_at_the_step_that_was_asked_for() {
        let audited = audit(&leg(Pose::new(20.0, 20.0, 0.5), winding())).expect("nothing is wrong with it");
        assert!(audited.samples >= 23 * 50, "{} samples", audited.samples);
        assert!((audited.metres - 23.0).abs() < 1e-3);
        let slow = SpeedLimits { acceleration_mps2: Some(1.0), braking_mps2: Some(3.0), ..LIMITS };
        let path = Path { start: Pose::new(20.0, 20.0, 0.5), segments: winding() };
        let leg = Trajectory::along(&path, SimTime::ZERO, slow);
        audit(&leg).expect("limits of acceleration break no rule");
        audit(&leg.stopping(SimTime::from_seconds(2.0), Some(2.0))).expect("nor does a brake");
    }

    #[test]
    fn a_bush_in_the_way_is_found_with_time_and_place() {
        let offence = audit(&leg(Pose::new(40.0, 52.5, 0.0), vec![segment(0.0, 20.0)])).expect_err("there is a bush");
        let Breach::Touched(Touch::Bush { cell, .. }) = offence.breach else { panic!("{offence}") };
        assert_eq!(cell, Cell { col: 10, row: 10 });
        assert!((offence.pose.x - 46.05).abs() < 0.025, "{offence}");
        assert!((offence.time.as_seconds() - (7.0 + 6.05 / 8.0)).abs() < 0.005, "{offence}");
        assert!(offence.to_string().contains("cell (10, 10)"));
    }

    #[test]
    fn a_corner_that_cuts_a_bush_in_passing_is_found() {
        let beside = |y| audit(&leg(Pose::new(30.0, y, 0.0), vec![segment(0.0, 40.0)]));
        assert!(beside(50.0 - 1.11).is_ok());
        assert!(beside(50.0 - 1.09).is_err());
    }

    #[test]
    fn the_field_ends_at_its_border() {
        let offence = audit(&leg(Pose::new(90.0, 20.0, 0.0), vec![segment(0.0, 10.0)])).expect_err("it leaves");
        assert!(matches!(offence.breach, Breach::Touched(Touch::Border { .. })), "{offence}");
    }

    #[test]
    fn a_turn_tighter_than_the_radius_is_found() {
        let offence = audit(&leg(Pose::new(20.0, 20.0, 0.0), vec![segment(1.0 / 12.99, 5.0)])).expect_err("too tight");
        assert!(matches!(offence.breach, Breach::Curvature { .. }), "{offence}");
        let spot = Trajectory::new(SimTime::ZERO, Pose::new(20.0, 20.0, 0.0), vec![Piece::Turn { heading: 0.01 }]);
        assert!(matches!(audit(&spot).expect_err("trucks do not spin").breach, Breach::Curvature { .. }));
    }

    #[test]
    fn speeding_is_found_forward_and_reverse() {
        let drive = |length_m, speed_mps| {
            let piece = Piece::Drive { segment: segment(0.0, length_m), speed_mps, acceleration_mps2: 0.0 };
            audit(&Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![piece]))
        };
        assert!(drive(10.0, 8.0).is_ok() && drive(-10.0, 4.0).is_ok());
        assert!(matches!(drive(10.0, 8.01).expect_err("too fast").breach, Breach::Speed { .. }));
        assert!(matches!(drive(-10.0, 4.01).expect_err("too fast").breach, Breach::Speed { .. }));
    }

    #[test]
    fn what_is_not_a_number_is_an_offence() {
        for segment in [segment(f64::NAN, 5.0), segment(0.0, f64::NAN), segment(0.0, f64::INFINITY)] {
            let piece = Piece::Drive { segment, speed_mps: 2.0, acceleration_mps2: 0.0 };
            assert!(audit(&Trajectory::new(SimTime::ZERO, Pose::new(30.0, 20.0, 0.0), vec![piece])).is_err());
        }
    }

    #[test]
    fn sideways_motion_is_found() {
        let samples = |from: Pose, to: Pose| {
            check_motion(&Dimensions::default(), &LIMITS, (SimTime::ZERO, from), (SimTime::from_seconds(0.1), to))
        };
        let from = Pose::new(10.0, 10.0, 1.0);
        let ahead = segment(1.0 / 13.0, 0.02).end(from);
        assert!(samples(from, ahead).is_ok());
        let beside = Pose { x: ahead.x + 1e-5, ..ahead };
        assert!(matches!(samples(from, beside).expect_err("it slid").breach, Breach::Slid { .. }));
    }
}
