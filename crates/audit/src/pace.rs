//! Speeds along a leg: its pieces one by one and where they meet, from their own numbers.

use super::{Violation, ViolationKind};
use wildfire_base::geometry::{DVec2, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_base::vehicle::{STEERING_STEP_S, SteeringLimits};

/// Share of a limit that is noise.
const RELATIVE_NOISE: f64 = 1e-6;

/// A change of speed that is noise, in m/s: what 1000 m/s2 does within two nanometres.
const JUMP_MPS: f64 = 2e-3;

/// Time of turning wheels that is noise, in seconds.
const TURNING_NOISE_S: f64 = 1e-6;

/// One drive as its numbers say it: speeds in m/s, time in seconds.
#[derive(Clone, Copy, Debug)]
pub struct DriveProfile {
    entry_mps: f64,
    exit_mps: f64,
    change_mps2: f64,
    pub seconds: f64,
    stops_short: bool,
}

impl DriveProfile {
    /// `metres` are along the way, not negative.
    pub fn new(metres: f64, entry_mps: f64, change_mps2: f64) -> Self {
        // From v dv = a ds.
        let exit_squared = entry_mps * entry_mps + 2.0 * change_mps2 * metres;
        let exit_mps = exit_squared.max(0.0).sqrt();
        // Nothing driven at no speed would be 0 over 0.
        let seconds = if metres == 0.0 { 0.0 } else { 2.0 * metres / (entry_mps + exit_mps) };
        Self { entry_mps, exit_mps, change_mps2, seconds, stops_short: exit_squared < -JUMP_MPS * JUMP_MPS }
    }

    pub fn fastest_mps(&self) -> f64 {
        self.entry_mps.max(self.exit_mps)
    }

    /// Seconds until so many metres are driven.
    pub fn seconds_to(&self, metres: f64) -> f64 {
        Self::new(metres, self.entry_mps, self.change_mps2).seconds
    }
}

/// Front wheels, straight at first, that follow the curvature of a way.
struct Wheels {
    limits: SteeringLimits,
    angle_rad: f64,
    /// How long they still have to turn; negative for the time that they stood with nothing to do.
    behind_s: f64,
}

impl Wheels {
    fn new(limits: SteeringLimits) -> Self {
        Self { limits, angle_rad: 0.0, behind_s: 0.0 }
    }

    /// Sets a curvature in 1/m: an angle of the bicycle model.
    fn set(&mut self, curvature: f64, max_s: f64) -> Result<(), ViolationKind> {
        let angle_rad = ops::atan2(self.limits.wheelbase_m * curvature, 1.0);
        let turn_rad = (angle_rad - std::mem::replace(&mut self.angle_rad, angle_rad)).abs();
        // The remaining time at a stand is lost once the next curvature is set.
        self.behind_s = f64::max(0.0, self.behind_s + turn_rad / self.limits.rate_rad_s);
        let is_late = self.behind_s > max_s + TURNING_NOISE_S;
        if is_late { Err(ViolationKind::Steering { behind_s: self.behind_s, max_s }) } else { Ok(()) }
    }

    /// While the truck stands, they turn to what comes next.
    fn stand(&mut self, seconds: f64) {
        self.behind_s -= seconds;
    }

    fn drive(&mut self, seconds: f64) {
        self.behind_s = f64::max(0.0, self.behind_s - seconds);
    }
}

/// Holds the speeds of a leg against limits; the first violation is where and when its piece begins.
pub fn audit_pace(leg: &Trajectory, limits: &SpeedLimits) -> Result<(), Violation> {
    let mut elapsed_s = 0.0;
    // The speed so far, and whether it is in reverse; at rest there is no such thing.
    let (mut speed_mps, mut direction) = (0.0, None);
    let mut wheels = limits.steering.map(Wheels::new);
    for (start, piece) in leg.pieces_with_starts() {
        let at = |kind| violation(leg, elapsed_s, start.position(), kind);
        let Piece::Drive { segment, speed_mps: entry_mps, acceleration_mps2 } = *piece else {
            // Turning on the spot and waiting require a standstill.
            check_jump(limits, speed_mps, 0.0).map_err(at)?;
            (speed_mps, direction) = (0.0, None);
            elapsed_s += piece.duration_s();
            if let Some(wheels) = &mut wheels {
                wheels.stand(piece.duration_s());
            }
            continue;
        };
        let drive = DriveProfile::new(segment.length_m.abs(), entry_mps, acceleration_mps2);
        // Between forward and reverse a vehicle stands for an instant.
        if direction.is_some_and(|reverse| reverse != segment.is_reverse()) {
            // The stop needs brakes; the start in the other direction is checked below.
            check_jump(limits, speed_mps, 0.0).map_err(at)?;
            speed_mps = 0.0;
        }
        check_jump(limits, speed_mps, entry_mps).map_err(at)?;
        check_drive(limits, &drive, segment.curvature, segment.is_reverse()).map_err(at)?;
        if let Some(wheels) = &mut wheels {
            wheels.set(segment.curvature, STEERING_STEP_S).map_err(at)?;
            // The rest of the turn is made on the first part of the segment.
            wheels.drive(drive.seconds);
        }
        (speed_mps, direction) = (drive.exit_mps, Some(segment.is_reverse()));
        elapsed_s += drive.seconds;
    }
    let at_end = |kind| violation(leg, elapsed_s, leg.end().position(), kind);
    check_jump(limits, speed_mps, 0.0).map_err(at_end)?;
    // The next leg begins with straight wheels.
    wheels.map_or(Ok(()), |mut wheels| wheels.set(0.0, 0.0)).map_err(at_end)
}

fn check_drive(limits: &SpeedLimits, drive: &DriveProfile, curvature: f64, reverse: bool) -> Result<(), ViolationKind> {
    let fastest = drive.fastest_mps();
    let limit_mps = if reverse { limits.reverse_mps } else { limits.forward_mps };
    if exceeds(fastest, limit_mps) {
        return Err(ViolationKind::Speed { found_mps: fastest, limit_mps });
    }
    if let Some(limit_mps2) = limits.acceleration_mps2.filter(|&limit| exceeds(drive.change_mps2, limit)) {
        return Err(ViolationKind::Acceleration { found_mps2: drive.change_mps2, limit_mps2 });
    }
    if let Some(limit_mps2) = limits.braking_mps2.filter(|&limit| exceeds(-drive.change_mps2, limit)) {
        return Err(ViolationKind::Braking { found_mps2: -drive.change_mps2, limit_mps2 });
    }
    let lateral = fastest * fastest * curvature.abs();
    if let Some(limit_mps2) = limits.lateral_mps2.filter(|&limit| exceeds(lateral, limit)) {
        return Err(ViolationKind::Lateral { found_mps2: lateral, limit_mps2 });
    }
    if drive.stops_short { Err(ViolationKind::StopsShort) } else { Ok(()) }
}

/// Says whether a number is above a limit by more than rounding makes it.
fn exceeds(found: f64, limit: f64) -> bool {
    found > limit * (1.0 + RELATIVE_NOISE)
}

/// Speed changes at once only in a direction that has no limit.
fn check_jump(limits: &SpeedLimits, from_mps: f64, to_mps: f64) -> Result<(), ViolationKind> {
    let limit = if to_mps > from_mps { limits.acceleration_mps2 } else { limits.braking_mps2 };
    let is_jump = limit.is_some() && (to_mps - from_mps).abs() > JUMP_MPS;
    if is_jump { Err(ViolationKind::SpeedJump { from_mps, to_mps }) } else { Ok(()) }
}

fn violation(leg: &Trajectory, elapsed_s: f64, place: DVec2, kind: ViolationKind) -> Violation {
    Violation { time: leg.start_time() + SimTime::from_seconds(elapsed_s), agent: None, place, kind }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::Pose;
    use wildfire_base::vehicle::{Path, Segment};

    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: Some(1.0),
        braking_mps2: Some(3.0),
        lateral_mps2: Some(2.0),
        steering: None,
    };

    /// Length, speed and its change, one after the other on a straight.
    fn straight(drives: &[(f64, f64, f64)]) -> Trajectory {
        let piece = |&(length_m, speed_mps, acceleration_mps2): &(f64, f64, f64)| {
            let segment = Segment { curvature: 0.0, length_m };
            Piece::Drive { segment, speed_mps, acceleration_mps2 }
        };
        Trajectory::new(SimTime::from_seconds(7.0), Pose::default(), drives.iter().map(piece).collect())
    }

    fn kind(leg: &Trajectory) -> ViolationKind {
        audit_pace(leg, &LIMITS).expect_err("the damage is planted").kind
    }

    #[test]
    fn the_profile_of_a_winding_way_keeps_its_limits() {
        let segment = |curvature, length_m| Segment { curvature, length_m };
        let segments =
            vec![segment(1.0 / 13.0, 9.0), segment(-1.0 / 13.0, -6.0), segment(0.0, -3.0), segment(1.0 / 13.0, 50.0)];
        let path = Path { start: Pose::new(20.0, 20.0, 0.5), segments };
        let leg = Trajectory::from_path(&path, SimTime::ZERO, LIMITS);
        audit_pace(&leg, &LIMITS).expect("it was made for these limits");
        let cut = leg.stopping(SimTime::from_seconds(5.0), &LIMITS);
        audit_pace(&cut, &LIMITS).expect("nor does the brake exceed them");
        let harder = SpeedLimits { braking_mps2: Some(3.1), ..LIMITS };
        assert!(audit_pace(&leg.stopping(SimTime::from_seconds(5.0), &harder), &LIMITS).is_err());
        let at_once = SpeedLimits::new(8.0, 4.0);
        audit_pace(&Trajectory::from_path(&path, SimTime::ZERO, at_once), &at_once)
            .expect("so do those without limits");
        for tighter in [
            SpeedLimits { forward_mps: 5.0, ..LIMITS },
            SpeedLimits { reverse_mps: 1.0, ..LIMITS },
            SpeedLimits { acceleration_mps2: Some(0.9), ..LIMITS },
            SpeedLimits { braking_mps2: Some(2.9), ..LIMITS },
            SpeedLimits { lateral_mps2: Some(1.9), ..LIMITS },
        ] {
            assert!(audit_pace(&leg, &tighter).is_err(), "{tighter:?}");
        }
    }

    #[test]
    fn a_brake_harder_than_its_limit_is_found_where_it_begins() {
        let leg = straight(&[(8.0, 0.0, 1.0), (2.0, 4.0, -4.0)]);
        let violation = audit_pace(&leg, &LIMITS).expect_err("4 m/s2 are more than 3");
        assert_eq!(violation.kind, ViolationKind::Braking { found_mps2: 4.0, limit_mps2: 3.0 });
        assert_eq!((violation.time, violation.place), (SimTime::from_seconds(11.0), DVec2::new(8.0, 0.0)));
        assert!(matches!(kind(&straight(&[(8.0, 0.0, 1.01)])), ViolationKind::Acceleration { .. }));
        assert!(matches!(kind(&straight(&[(8.0, 0.0, 1.0), (2.0, 4.0, 0.0)])), ViolationKind::SpeedJump { .. }));
    }

    #[test]
    fn speeding_is_found_forward_and_reverse() {
        let limits = SpeedLimits::new(8.0, 4.0);
        let drive = |length_m, speed| audit_pace(&straight(&[(length_m, speed, 0.0)]), &limits);
        assert!(drive(10.0, 8.0).is_ok() && drive(-10.0, 4.0).is_ok());
        assert!(matches!(drive(10.0, 8.001).expect_err("too fast").kind, ViolationKind::Speed { .. }));
        assert!(matches!(drive(-10.0, 4.001).expect_err("too fast").kind, ViolationKind::Speed { .. }));
        let gains = audit_pace(&straight(&[(10.0, 7.0, 2.0)]), &limits).expect_err("it ends at more than 9 m/s");
        assert!(matches!(gains.kind, ViolationKind::Speed { found_mps, .. } if found_mps > 9.0));
    }

    #[test]
    fn a_cusp_driven_through_is_found() {
        let leg = straight(&[(2.0, 0.0, 1.0), (-2.0, 2.0, -1.0)]);
        assert_eq!(kind(&leg), ViolationKind::SpeedJump { from_mps: 2.0, to_mps: 0.0 });
        let waits = straight(&[(2.0, 0.0, 1.0), (2.0, 2.0, -1.0), (-2.0, 0.0, 1.0), (-2.0, 2.0, -1.0)]);
        audit_pace(&waits, &LIMITS).expect("it stands at the cusp");
    }

    #[test]
    fn wheels_that_turn_too_fast_are_found() {
        let steering = SteeringLimits { rate_rad_s: 0.35, wheelbase_m: 3.0 };
        let limits = SpeedLimits { steering: Some(steering), ..LIMITS };
        let segment = |curvature, length_m| Segment { curvature, length_m };
        let mut segments = vec![segment(0.0, 20.0)];
        segments.extend(steering.clothoid(0.0, 1.0 / 13.0, 1.0, 4.0));
        segments.extend([segment(1.0 / 13.0, 10.0), segment(-1.0 / 13.0, -6.0)]);
        let path = Path { start: Pose::new(20.0, 20.0, 0.5), segments };
        let leg = Trajectory::from_path(&path, SimTime::ZERO, limits);
        audit_pace(&leg, &limits).expect("it was made for these limits");
        for tenths in 0..=(10.0 * leg.duration_s()) as u32 {
            let cut = leg.stopping(SimTime::from_seconds(0.1 * f64::from(tenths)), &limits);
            audit_pace(&cut, &limits).expect("nor does a stop exceed them");
        }
        let slower = SteeringLimits { rate_rad_s: 0.34, ..steering };
        let slower = SpeedLimits { steering: Some(slower), ..limits };
        let at_once = Trajectory::from_path(&path, SimTime::ZERO, LIMITS);
        let pieces = leg.pieces();
        let ends_turned = Trajectory::new(SimTime::ZERO, path.start, pieces[..pieces.len() - 1].to_vec());
        for (leg, limits) in [(&leg, slower), (&at_once, limits), (&ends_turned, limits)] {
            let kind = audit_pace(leg, &limits).expect_err("its wheels are late").kind;
            assert!(matches!(kind, ViolationKind::Steering { behind_s, max_s } if behind_s > max_s), "{kind:?}");
        }
    }

    #[test]
    fn brakes_that_end_before_the_way_are_found() {
        assert_eq!(kind(&straight(&[(8.0, 0.0, 1.0), (8.0, 4.0, -3.0)])), ViolationKind::StopsShort);
    }
}
