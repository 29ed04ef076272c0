//! Proofs that two moving bodies keep their distance.
//!
//! The distance of two bodies shrinks by no more than what the two cover together, so a place and a time at which they
//! are far apart prove all that comes until they can have covered the difference (conservative advancement: B. Mirtich,
//! "Impulse-based Dynamic Simulation of Rigid Body Systems", PhD thesis, Berkeley, 1996, section 2.3).

use super::rectangle::Rectangle;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Pace, Trajectory};
use wildfire_base::vehicle::Dimensions;

/// The distance in metres by which two bodies may undercut the margin between sampled instants.
pub const CONFLICT_TOLERANCE_M: f64 = 0.02;

const NANOS_PER_SECOND: f64 = 1e9;
const INSTANT: SimTime = SimTime::from_nanos(1);

/// A body and its motion, which has no turns on the spot. It stands before its start and, forever, after its end.
#[derive(Clone, Copy, Debug)]
pub struct MovingBody<'a> {
    pub body: &'a Dimensions,
    pub trajectory: &'a Trajectory,
}

impl MovingBody<'_> {
    fn rectangle_at(&self, time: SimTime) -> Rectangle {
        rectangle(self.body, self.trajectory.pose_at(time))
    }

    /// Bounds the speed of the body's fastest point, in m/s, and says until when.
    fn pace_at(&self, time: SimTime) -> (f64, SimTime) {
        let Pace { fastest_mps, curvature, until } = self.trajectory.pace_at(time);
        (fastest_mps * self.body.farthest_point_rate(curvature), until)
    }
}

/// Returns the time from `from` on at which two bodies first come nearer than `margin_m`; `None` if they never do.
///
/// Bodies that keep apart do so by the margin at every instant that is looked at, and when both have come to rest; in
/// between by the margin less [`CONFLICT_TOLERANCE_M`]. Bodies that face each other with their corners may be taken for
/// up to 30 % nearer than they are.
pub fn first_conflict(one: MovingBody<'_>, other: MovingBody<'_>, from: SimTime, margin_m: f64) -> Option<SimTime> {
    let end = one.trajectory.end_time().max(other.trajectory.end_time());
    let mut now = from;
    loop {
        let room_m = one.rectangle_at(now).gap_to(&other.rectangle_at(now)) - margin_m;
        // A place that is not a number counts as a conflict.
        if room_m < 0.0 || room_m.is_nan() {
            return Some(now);
        }
        // Both stand from here on, so nothing can come closer any more.
        if now >= end {
            return None;
        }
        now = safe_until(one, other, now, room_m + CONFLICT_TOLERANCE_M).min(end);
    }
}

/// Returns the distance in metres between two standing bodies, as [`first_conflict`] computes it; negative where they
/// overlap.
pub fn gap_between(one: &Dimensions, at: Pose, other: &Dimensions, other_at: Pose) -> f64 {
    rectangle(one, at).gap_to(&rectangle(other, other_at))
}

/// Returns until when two bodies cover less than `reach_m` together; at least the next instant.
fn safe_until(one: MovingBody<'_>, other: MovingBody<'_>, from: SimTime, reach_m: f64) -> SimTime {
    let (mut now, mut left_m) = (from, reach_m);
    while now < SimTime::MAX {
        let (pace, until) = one.pace_at(now);
        let (other_pace, other_until) = other.pace_at(now);
        let closing_mps = pace + other_pace;
        // A pace that ends at this very instant would hold the search here forever.
        let until = until.min(other_until).max(now + INSTANT);
        let covered_m = closing_mps * until.since(now).as_seconds();
        if closing_mps > 0.0 && covered_m >= left_m {
            // The cast truncates, so the span ends before the distance is used up.
            let span = SimTime::from_nanos((left_m / closing_mps * NANOS_PER_SECOND) as u64);
            return (now + span).max(from + INSTANT);
        }
        left_m -= covered_m;
        now = until;
    }
    now
}

fn rectangle(body: &Dimensions, pose: Pose) -> Rectangle {
    body.footprint(pose).into()
}

impl Rectangle {
    /// Returns a lower bound of the distance in metres to another rectangle; negative where they overlap.
    ///
    /// The widest gap that a line along a side of either leaves (the separating axis theorem): between two corners it
    /// may be less than their distance, by a factor of the square root of 2 at most. Far apart, the gap between the
    /// circles about them, which is more than half their distance.
    pub fn gap_to(&self, other: &Self) -> f64 {
        let offset = other.centre - self.centre;
        let radii = self.radius() + other.radius();
        let between = offset.length() - radii;
        // Far apart the circles around both are close enough, and cost no projection.
        if between > radii {
            return between;
        }
        let along = self.axis.dot(other.axis).abs();
        let across = self.axis.perp_dot(other.axis).abs();
        let beyond = |this: &Self, their: &Self| {
            let u = offset.dot(this.axis).abs();
            let v = this.axis.perp_dot(offset).abs();
            let lengthwise = this.half_length + their.half_length * along + their.half_width * across;
            let crosswise = this.half_width + their.half_length * across + their.half_width * along;
            (u - lengthwise).max(v - crosswise)
        };
        beyond(self, other).max(beyond(other, self))
    }

    /// Returns the radius of the circle about it.
    pub fn radius(&self) -> f64 {
        ops::hypot(self.half_length, self.half_width)
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

    use super::super::brute_force::polygon_to_polygon;
    use super::*;
    use wildfire_base::rng;
    use wildfire_base::trajectory::{Piece, SpeedLimits};
    use wildfire_base::vehicle::{Path, Segment};

    const MARGIN_M: f64 = 0.2;

    fn random_pose(rng: &mut impl Rng, side_m: f64) -> Pose {
        Pose::new(rng.random_range(0.0..side_m), rng.random_range(0.0..side_m), rng.random_range(-3.1..3.1))
    }

    fn random_drive(rng: &mut impl Rng, body: &Dimensions) -> Trajectory {
        let mut segment = |_| Segment {
            curvature: f64::from(rng.random_range(-1..=1)) * body.max_curvature(),
            length_m: rng.random_range(-15.0..15.0),
        };
        let segments = (0..5).map(&mut segment).collect();
        let path = Path { start: random_pose(rng, 40.0), segments };
        let mut limits = SpeedLimits::new(8.0, 4.0);
        if rng.random_bool(0.5) {
            limits.acceleration_mps2 = Some(2.0);
            limits.braking_mps2 = Some(4.0);
        }
        let wait = Piece::Wait { seconds: rng.random_range(0.0..3.0) };
        let drive = Trajectory::from_path(&path, SimTime::ZERO, limits);
        let start_time = SimTime::from_seconds(rng.random_range(0.0..4.0));
        let pieces = [wait].into_iter().chain(drive.pieces().iter().copied()).collect();
        Trajectory::new(start_time, path.start, pieces)
    }

    /// The true distance of two bodies.
    fn distance((one, at): (&Dimensions, Pose), (other, other_at): (&Dimensions, Pose)) -> f64 {
        polygon_to_polygon(&one.footprint(at).corners(), &other.footprint(other_at).corners())
    }

    #[test]
    fn gaps_are_never_more_than_the_distance_and_rarely_much_less() {
        let mut rng = rng::stream(1, "collision/meeting");
        let large = Dimensions::default();
        let small = Dimensions { length_m: 2.5, width_m: 1.5, ..Dimensions::default() };
        let mut overlaps = 0;
        for _ in 0..20_000 {
            let at = random_pose(&mut rng, 20.0);
            let other_at = random_pose(&mut rng, 20.0);
            let gap = gap_between(&large, at, &small, other_at);
            let distance = distance((&large, at), (&small, other_at));
            assert_eq!(gap, gap_between(&small, other_at, &large, at));
            assert!(gap <= distance + 1e-9, "{gap} m instead of {distance} m");
            let radii = rectangle(&large, at).radius() + rectangle(&small, other_at).radius();
            let factor = if gap > radii { 2.0 } else { std::f64::consts::SQRT_2 };
            assert!(gap >= distance / factor - 1e-9 || distance == 0.0, "{gap} m instead of {distance} m");
            assert_eq!(gap <= 0.0, distance <= 1e-12, "{gap} {distance}");
            overlaps += u32::from(gap <= 0.0);
        }
        assert!(overlaps > 1000, "{overlaps} overlaps");
    }

    #[test]
    fn bodies_that_keep_apart_do_so_at_every_instant_and_others_meet_where_reported() {
        let mut rng = rng::stream(2, "collision/meeting");
        let body = Dimensions::default();
        let other_body = Dimensions { length_m: 6.0, ..Dimensions::default() };
        let (mut apart, mut met) = (0, 0);
        for _ in 0..300 {
            let drive = random_drive(&mut rng, &body);
            let other_drive = random_drive(&mut rng, &other_body);
            let one = MovingBody { body: &body, trajectory: &drive };
            let other = MovingBody { body: &other_body, trajectory: &other_drive };
            let meeting = first_conflict(one, other, SimTime::ZERO, MARGIN_M);
            assert_eq!(meeting.is_none(), first_conflict(other, one, SimTime::ZERO, MARGIN_M).is_none());
            let until =
                meeting.unwrap_or_else(|| drive.end_time().max(other_drive.end_time()) + SimTime::from_seconds(1.0));
            let gap_at = |time| distance((&body, drive.pose_at(time)), (&other_body, other_drive.pose_at(time)));
            for k in 0..until.as_nanos() / 20_000_000 {
                let gap = gap_at(SimTime::from_nanos(20_000_000 * k));
                assert!(gap >= MARGIN_M - CONFLICT_TOLERANCE_M, "{gap} m at {k} times 20 ms, told {meeting:?}");
            }
            match meeting {
                Some(time) => {
                    met += 1;
                    assert!(gap_at(time) < MARGIN_M * std::f64::consts::SQRT_2 + 1e-9);
                }
                None => apart += 1,
            }
        }
        assert!(apart > 50 && met > 50, "{apart} kept apart, {met} met");
    }

    #[test]
    fn what_stands_in_the_way_at_last_is_met_however_late() {
        let body = Dimensions::default();
        let stand = Trajectory::new(SimTime::ZERO, Pose::new(30.0, 10.0, 1.0), Vec::new());
        let way = Path { start: Pose::new(0.0, 10.0, 0.0), segments: vec![Segment { curvature: 0.0, length_m: 40.0 }] };
        for start_s in [0.0, 5.0, 3000.0] {
            let drive = Trajectory::from_path(&way, SimTime::from_seconds(start_s), SpeedLimits::new(8.0, 8.0));
            let [one, other] = [&drive, &stand].map(|trajectory| MovingBody { body: &body, trajectory });
            let met = first_conflict(one, other, SimTime::ZERO, MARGIN_M).expect("it stands in the way").as_seconds();
            assert!(met > start_s + 2.5 && met < start_s + 4.0, "{met}");
            assert_eq!(first_conflict(one, other, SimTime::from_seconds(start_s + 8.0), MARGIN_M), None);
        }
    }
}
