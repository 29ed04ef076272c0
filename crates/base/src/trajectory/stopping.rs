//! Breaking a motion off on its way.

use super::{Piece, PieceProgress, SpeedLimits, Trajectory, speed_after};
use crate::time::SimTime;
use crate::vehicle::STEERING_STEP_S;

impl Trajectory {
    /// Returns the same motion, cut short: from `at` on the body brakes along its way as hard as its limits allow, until
    /// it stands. Without a limit of braking it stands at `at`. Wheels that take their time to turn are straight at its end.
    ///
    /// Start and all states before `at` stay the same. The braking body is never faster than it would have been at the
    /// same place, so it stops at the next cusp, turn or wait at the latest, where it would have stood anyway.
    pub fn stopping(&self, at: SimTime, limits: &SpeedLimits) -> Self {
        if at <= self.start_time {
            return Self::new(self.start_time, self.start, Vec::new());
        }
        let Some(progress) = self.progress_at(at) else { return self.clone() };
        let moves_on = self.pieces[progress.index..].iter().any(|piece| piece.segment().is_some());
        if limits.steering.is_some() && !moves_on {
            // Only its wheels have to turn.
            return self.clone();
        }
        let mut pieces = self.pieces[..progress.index].to_vec();
        let partial = self.pieces[progress.index].until(progress.elapsed_s);
        pieces.extend(partial);
        if let Some(braking) = limits.braking_mps2 {
            self.brake(progress, braking, &mut pieces);
        }
        if let (Some(steering), Some(last)) = (limits.steering, pieces.iter().rev().find_map(Piece::segment)) {
            // Its wheels may be as much as a step behind.
            let seconds = steering.turning_s(last.curvature, 0.0) + STEERING_STEP_S;
            pieces.push(Piece::Wait { seconds });
        }
        Self::new(self.start_time, self.start, pieces)
    }

    /// Adds the pieces of braking from there on.
    fn brake(&self, progress: PieceProgress, braking: f64, pieces: &mut Vec<Piece>) {
        let mut speed = self.pieces[progress.index].state_at(progress.start, progress.elapsed_s).speed_mps;
        let rest = self.pieces[progress.index].after(progress.elapsed_s);
        let mut reverse = None;
        for piece in rest.into_iter().chain(self.pieces[progress.index + 1..].iter().copied()) {
            let Piece::Drive { segment, .. } = piece else { return };
            // Beyond a stop, a cusp or a wait the body would have stood anyway.
            if speed == 0.0 || *reverse.get_or_insert(segment.is_reverse()) != segment.is_reverse() {
                return;
            }
            speed = brake_along(piece, speed, braking, pieces);
        }
    }
}

/// Brakes from `speed` along a piece and adds what that takes; returns the speed at its end, 0 after a stop.
fn brake_along(piece: Piece, speed: f64, braking: f64, pieces: &mut Vec<Piece>) -> f64 {
    let Piece::Drive { segment, speed_mps: planned, acceleration_mps2: change } = piece else { return 0.0 };
    let length = segment.length_m.abs();
    let speed = speed.min(planned);
    // From v^2 = 2 a s.
    let stop = 0.5 * speed * speed / braking;
    // Where the plan brakes harder than asked, it is slower from this place on.
    let overtaken =
        if change < -braking { 0.5 * (planned * planned - speed * speed) / (-change - braking) } else { f64::INFINITY };
    let braked = stop.min(overtaken).min(length);
    if braked > 0.0 {
        let segment = segment.with_length(braked);
        pieces.push(Piece::Drive { segment, speed_mps: speed, acceleration_mps2: -braking });
    }
    if stop <= braked {
        return 0.0;
    }
    let speed = speed_after(speed, -braking, braked);
    if braked < length {
        let segment = segment.with_length(length - braked);
        pieces.push(Piece::Drive { segment, speed_mps: speed, acceleration_mps2: change });
        return speed_after(speed, change, length - braked);
    }
    speed
}

impl Piece {
    /// The part of this piece before `elapsed_s`; nothing if that is its start.
    fn until(&self, elapsed_s: f64) -> Option<Self> {
        match *self {
            _ if elapsed_s <= 0.0 => None,
            Self::Drive { segment, speed_mps, acceleration_mps2 } => {
                let segment = segment.with_length(self.covered_m(elapsed_s));
                Some(Self::Drive { segment, speed_mps, acceleration_mps2 })
            }
            Self::Turn { .. } => None,
            Self::Wait { .. } => Some(Self::Wait { seconds: elapsed_s }),
        }
    }

    /// The part of a drive after `elapsed_s`; nothing of other pieces.
    fn after(&self, elapsed_s: f64) -> Option<Self> {
        let Self::Drive { segment, speed_mps, acceleration_mps2 } = *self else { return None };
        let left = segment.length_m.abs() - self.covered_m(elapsed_s);
        let speed_mps = (speed_mps + acceleration_mps2 * elapsed_s).max(0.0);
        (left > 0.0).then(|| Self::Drive { segment: segment.with_length(left), speed_mps, acceleration_mps2 })
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::profile::tests::{random_limits, random_path};
    use super::super::{MotionState, SpeedLimits};
    use super::*;
    use crate::geometry::Pose;
    use crate::rng;
    use crate::vehicle::{Path, Segment, SteeringLimits};

    /// The pose that a trajectory has after these metres.
    fn pose_after(trajectory: &Trajectory, metres: f64) -> Pose {
        let mut left = metres;
        for (start, piece) in trajectory.pieces_with_starts() {
            let Piece::Drive { segment, .. } = piece else { continue };
            if left <= segment.length_m.abs() {
                return segment.pose_at(start, left.copysign(segment.length_m));
            }
            left -= segment.length_m.abs();
        }
        trajectory.end()
    }

    /// The greatest speed planned within a millimetre of a place, in m/s.
    fn planned_speed(trajectory: &Trajectory, metres: f64) -> f64 {
        let (mut began, mut greatest) = (0.0, 0.0f64);
        for piece in trajectory.pieces() {
            let Piece::Drive { segment, speed_mps, acceleration_mps2 } = *piece else { continue };
            let length = segment.length_m.abs();
            if metres > began - 1e-3 && metres < began + length + 1e-3 {
                for place in [metres - 1e-3, metres + 1e-3] {
                    let inside = (place - began).clamp(0.0, length);
                    greatest = greatest.max(speed_after(speed_mps, acceleration_mps2, inside));
                }
            }
            began += length;
        }
        greatest
    }

    #[test]
    fn a_cut_motion_is_the_same_before_and_stays_on_its_way() {
        let mut rng = rng::stream(1, "trajectory/stopping");
        for _ in 0..300 {
            let limits = random_limits(&mut rng);
            let drive = Trajectory::from_path(&random_path(&mut rng), SimTime::from_seconds(3.0), limits);
            let end = drive.end_time().as_nanos();
            let at = SimTime::from_nanos(rng.random_range(0..end + end / 10));
            let braking = rng.random_bool(0.8).then(|| rng.random_range(0.5..8.0));
            let cut = drive.stopping(at, &SpeedLimits { braking_mps2: braking, ..limits });
            assert_eq!(cut.start_time(), drive.start_time());
            for _ in 0..20 {
                let before = SimTime::from_nanos(rng.random_range(0..at.as_nanos().max(1)));
                assert_eq!(cut.state_at(before), drive.state_at(before));
            }
            assert!(cut.end_time() <= drive.end_time() || braking.is_some());
            let from = at.as_nanos();
            let until = cut.end_time().as_nanos().max(at.as_nanos()) + 1;
            for _ in 0..20 {
                let after = SimTime::from_nanos(rng.random_range(from..until));
                let MotionState { pose, speed_mps: speed } = cut.state_at(after);
                let metres = cut.distance_m(after);
                let expected = pose_after(&drive, metres);
                assert!((pose.position() - expected.position()).length() < 1e-9);
                assert!(speed <= planned_speed(&drive, metres) + 1e-6, "{speed} m/s at {metres} m of {drive:?}");
            }
        }
    }

    #[test]
    fn without_a_limit_of_braking_it_stands_at_once() {
        let mut rng = rng::stream(2, "trajectory/stopping");
        for _ in 0..200 {
            let limits = random_limits(&mut rng);
            let drive = Trajectory::from_path(&random_path(&mut rng), SimTime::from_seconds(3.0), limits);
            let start = drive.start_time().as_nanos();
            let end = drive.end_time().as_nanos();
            let at = SimTime::from_nanos(rng.random_range(start + 1..end));
            let cut = drive.stopping(at, &SpeedLimits { braking_mps2: None, ..limits });
            assert_eq!(cut.end_time(), at);
            assert!((cut.end().position() - drive.pose_at(at).position()).length() < 1e-9);
            assert_eq!(cut.state_at(at).speed_mps, 0.0);
        }
    }

    fn braking(mps2: f64) -> SpeedLimits {
        SpeedLimits { braking_mps2: Some(mps2), ..SpeedLimits::new(8.0, 8.0) }
    }

    #[test]
    fn wheels_are_straight_wherever_a_motion_is_cut() {
        let steering = SteeringLimits { rate_rad_s: 0.3, wheelbase_m: 3.0 };
        let mut rng = rng::stream(3, "trajectory/stopping");
        for _ in 0..200 {
            let limits = SpeedLimits { steering: Some(steering), ..random_limits(&mut rng) };
            let drive = Trajectory::from_path(&random_path(&mut rng), SimTime::from_seconds(3.0), limits);
            let at = SimTime::from_nanos(rng.random_range(0..drive.end_time().as_nanos()));
            let cut = drive.stopping(at, &limits);
            assert_eq!(cut.pose_at(at), drive.pose_at(at));
            let driven = cut.pieces().iter().rposition(|piece| piece.segment().is_some());
            let Some(driven) = driven else { continue };
            let curvature = cut.pieces()[driven].segment().expect("it is a drive").curvature;
            let stands_s: f64 = cut.pieces()[driven + 1..].iter().map(Piece::duration_s).sum();
            assert!(stands_s >= steering.turning_s(curvature, 0.0), "{stands_s} s for a curvature of {curvature}");
        }
    }

    #[test]
    fn braking_takes_the_way_that_physics_says() {
        let path = Path {
            start: Pose::default(),
            segments: vec![Segment { curvature: 0.0, length_m: 30.0 }, Segment { curvature: 0.1, length_m: 30.0 }],
        };
        let drive = Trajectory::from_path(&path, SimTime::ZERO, SpeedLimits::new(8.0, 8.0));
        let cut = drive.stopping(SimTime::from_seconds(3.0), &braking(4.0));
        assert!((cut.distance_m(SimTime::MAX) - (24.0 + 8.0)).abs() < 1e-9);
        assert!((cut.duration_s() - 5.0).abs() < 1e-6);
        let late = drive.stopping(SimTime::from_seconds(7.0), &braking(4.0));
        assert!((late.distance_m(SimTime::MAX) - 60.0).abs() < 1e-9, "the way ends before the brake is done");
    }

    #[test]
    fn a_brake_ends_at_the_cusp() {
        let path = Path {
            start: Pose::default(),
            segments: vec![Segment { curvature: 0.0, length_m: 10.0 }, Segment { curvature: 0.1, length_m: -30.0 }],
        };
        let drive = Trajectory::from_path(&path, SimTime::ZERO, SpeedLimits::new(8.0, 8.0));
        let cut = drive.stopping(SimTime::from_seconds(1.0), &braking(1.0));
        assert!((cut.distance_m(SimTime::MAX) - 10.0).abs() < 1e-9);
        assert_eq!(cut.cusps(), 0);
    }

    #[test]
    fn a_motion_stopped_before_its_start_never_begins() {
        let path = Path { start: Pose::default(), segments: vec![Segment { curvature: 0.0, length_m: 10.0 }] };
        let drive = Trajectory::from_path(&path, SimTime::from_seconds(2.0), SpeedLimits::new(8.0, 8.0));
        let cut = drive.stopping(SimTime::from_seconds(1.0), &braking(1.0));
        assert_eq!((cut.end_time(), cut.end()), (drive.start_time(), drive.start()));
    }
}
