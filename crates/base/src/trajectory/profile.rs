//! The fastest way along a path under limits of speed and acceleration, in closed form.
//!
//! A path is a row of stretches between stops; each is driven from standstill to standstill. A pass forwards bounds
//! the speed at every joint of segments by what acceleration allows, a pass backwards by what braking allows
//! (Bobrow, Dubowsky and Gibson, "Time-Optimal Control of Robotic Manipulators Along Specified Paths", International
//! Journal of Robotics Research 4(3), 1985, for constant bounds). Within a segment the speed rises, stays and falls.
//!
//! A truck whose front wheels take their time to turn stands wherever the curvature jumps, too, until they have turned.
//! Its drives begin and end with straight wheels.

use serde::{Deserialize, Serialize};

use super::{Piece, Trajectory, speed_after};
use crate::time::SimTime;
use crate::vehicle::{Path, Segment, SteeringLimits};

/// Limits of a body's speed, and of how fast that may change. Positive numbers; `None` is no limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimits {
    pub forward_mps: f64,
    pub reverse_mps: f64,
    /// Gain of speed; without a limit it is there at once.
    pub acceleration_mps2: Option<f64>,
    /// Loss of speed; without a limit it is gone at once.
    pub braking_mps2: Option<f64>,
    /// Across the way, in turns: speed squared times curvature.
    pub lateral_mps2: Option<f64>,
    /// How fast front wheels turn; without a limit at once.
    pub steering: Option<SteeringLimits>,
}

impl SpeedLimits {
    /// One speed each way, without limits of acceleration.
    pub fn new(forward_mps: f64, reverse_mps: f64) -> Self {
        Self {
            forward_mps,
            reverse_mps,
            acceleration_mps2: None,
            braking_mps2: None,
            lateral_mps2: None,
            steering: None,
        }
    }

    /// The greatest speed on a segment, in m/s.
    pub fn speed_on(&self, segment: &Segment) -> f64 {
        let speed = if segment.is_reverse() { self.reverse_mps } else { self.forward_mps };
        match self.lateral_mps2 {
            Some(lateral) if segment.curvature != 0.0 => speed.min((lateral / segment.curvature.abs()).sqrt()),
            _ => speed,
        }
    }

    /// Says whether a truck need not stand to go over from one curvature to another.
    fn steers_in_passing(&self, from: f64, to: f64) -> bool {
        self.steering.is_none_or(|steering| steering.is_step(from, to))
    }

    /// The wait for wheels that turn from one curvature to another, if it takes any time.
    fn turning(&self, from: f64, to: f64) -> Option<Piece> {
        let seconds = self.steering?.turning_s(from, to);
        (seconds > 0.0).then_some(Piece::Wait { seconds })
    }

    /// Seconds that [`Trajectory::from_path`] takes for a path of these segments.
    pub fn drive_s(&self, segments: &[Segment]) -> f64 {
        fastest_pieces(Paced::on_roads(segments), self).iter().map(Piece::duration_s).sum()
    }
}

impl Trajectory {
    /// Drives a path as fast as the limits allow, from standstill to standstill and through a standstill at cusps, and
    /// where wheels that take their time turn farther than they do in passing.
    ///
    /// Segments without length are left out.
    pub fn from_path(path: &Path, start_time: SimTime, limits: SpeedLimits) -> Self {
        Self::new(start_time, path.start, fastest_pieces(Paced::on_roads(&path.segments), &limits))
    }
}

/// A segment, and the share of its greatest speed that a body keeps on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paced {
    pub segment: Segment,
    pub share: f64,
}

impl Paced {
    fn on_roads(segments: &[Segment]) -> impl Iterator<Item = Self> {
        segments.iter().map(|&segment| Self { segment, share: 1.0 })
    }
}

/// Returns the pieces of the fastest drive along segments.
pub(super) fn fastest_pieces(segments: impl Iterator<Item = Paced>, limits: &SpeedLimits) -> Vec<Piece> {
    // A segment without length would count as one forward, before which a truck in reverse had to stop.
    let segments: Vec<Paced> = segments.filter(|paced| paced.segment.length_m != 0.0).collect();
    let mut pieces = Vec::with_capacity(segments.len());
    // The curvature for which the front wheels stand.
    let mut wheels = 0.0;
    for stretch in segments.chunk_by(|a: &Paced, b: &Paced| {
        let (a, b) = (a.segment, b.segment);
        a.is_reverse() == b.is_reverse() && limits.steers_in_passing(a.curvature, b.curvature)
    }) {
        pieces.extend(limits.turning(wheels, stretch[0].segment.curvature));
        let joints = joint_speeds(stretch, limits);
        for (index, ends) in joints.windows(2).enumerate() {
            let fastest_mps = fastest_on(stretch, index, limits);
            pieces.extend(drive_segment(stretch[index].segment, fastest_mps, ends[0], ends[1], limits));
        }
        wheels = stretch[stretch.len() - 1].segment.curvature;
    }
    // The next drive counts on wheels that stand straight.
    pieces.extend(limits.turning(wheels, 0.0));
    pieces
}

/// The greatest speed in m/s on a segment of a stretch, which lasts until the wheels have turned for it.
fn fastest_on(stretch: &[Paced], index: usize, limits: &SpeedLimits) -> f64 {
    let Paced { segment, share } = &stretch[index];
    let fastest_mps = limits.speed_on(segment) * share;
    match limits.steering {
        // On the way to the first the truck stood.
        Some(steering) if index > 0 => {
            let turning_s = steering.turning_s(stretch[index - 1].segment.curvature, segment.curvature);
            fastest_mps.min(segment.length_m.abs() / turning_s)
        }
        _ => fastest_mps,
    }
}

/// Speeds in m/s at both ends of a stretch, and where its segments meet.
fn joint_speeds(stretch: &[Paced], limits: &SpeedLimits) -> Vec<f64> {
    let acceleration = limits.acceleration_mps2.unwrap_or(f64::INFINITY);
    let braking = limits.braking_mps2.unwrap_or(f64::INFINITY);
    let mut speeds = vec![0.0; stretch.len() + 1];
    let mut before = fastest_on(stretch, 0, limits);
    for joint in 1..stretch.len() {
        let behind = fastest_on(stretch, joint, limits);
        let reached = speed_after(speeds[joint - 1], acceleration, stretch[joint - 1].segment.length_m.abs());
        speeds[joint] = before.min(behind).min(reached);
        before = behind;
    }
    // From the end backwards, as the speed at a joint is limited by what comes after it.
    for (joint, Paced { segment, .. }) in stretch.iter().enumerate().rev() {
        speeds[joint] = speeds[joint].min(speed_after(speeds[joint + 1], braking, segment.length_m.abs()));
    }
    speeds
}

/// Returns the pieces of one segment: speeding up, keeping the speed, braking; those that take no way are left out.
fn drive_segment(
    segment: Segment,
    fastest_mps: f64,
    entry: f64,
    exit: f64,
    limits: &SpeedLimits,
) -> impl Iterator<Item = Piece> + use<> {
    let length = segment.length_m.abs();
    // Metres per (m/s)^2 of difference; nothing without a limit.
    let per_gain = limits.acceleration_mps2.map_or(0.0, |acceleration| 0.5 / acceleration);
    let per_loss = limits.braking_mps2.map_or(0.0, |braking| 0.5 / braking);
    let mut peak = fastest_mps;
    if way_to_peak(peak, entry, per_gain) + way_to_peak(peak, exit, per_loss) > length {
        // Not both are zero: without limits a change of speed takes no way, and there would be enough.
        peak = ((length + per_gain * entry * entry + per_loss * exit * exit) / (per_gain + per_loss)).sqrt();
    }
    let gaining = way_to_peak(peak, entry, per_gain);
    let losing = way_to_peak(peak, exit, per_loss);
    let lengths = without_slivers([gaining, length - gaining - losing, losing], length);
    // Without a limit a phase has no length and is left out, so its acceleration does not matter.
    let phases = [
        (lengths[0], entry, limits.acceleration_mps2.unwrap_or(0.0)),
        (lengths[1], peak, 0.0),
        (lengths[2], peak, -limits.braking_mps2.unwrap_or(0.0)),
    ];
    phases.into_iter().filter(|&(metres, ..)| metres > 0.0).map(move |(metres, speed_mps, acceleration_mps2)| {
        Piece::Drive { segment: segment.with_length(metres), speed_mps, acceleration_mps2 }
    })
}

/// Returns the metres between the speed of a joint and a higher one, `per` of them for each square of speed.
fn way_to_peak(peak: f64, joint: f64, per: f64) -> f64 {
    (per * (peak * peak - joint * joint)).max(0.0)
}

/// Phases shorter than a nanometre are rounding noise: the longest phase takes them over, and all add up to `length`.
/// A whole segment so short is driven at one speed, for there is none to begin with where speed changes at once.
fn without_slivers(lengths: [f64; 3], length: f64) -> [f64; 3] {
    const SLIVER_M: f64 = 1e-9;
    let mut kept = lengths.map(|metres| if metres < SLIVER_M { 0.0 } else { metres });
    let longest = (0..3).fold(1, |longest, k| if kept[k] > kept[longest] { k } else { longest });
    kept[longest] = 0.0;
    kept[longest] = length - kept.iter().sum::<f64>();
    kept
}

#[cfg(test)]
pub(super) mod tests {
    use rand::{Rng, RngExt};

    use super::*;
    use crate::geometry::Pose;
    use crate::rng;
    use crate::vehicle::STEERING_STEP_S;

    #[test]
    fn a_sliver_of_a_segment_takes_next_to_no_time() {
        let sliver = Segment { curvature: 0.05, length_m: 1e-12 };
        let path = Path { start: Pose::default(), segments: vec![sliver, Segment { curvature: 0.0, length_m: -9.0 }] };
        let some = SpeedLimits { acceleration_mps2: Some(2.0), braking_mps2: Some(4.0), ..SpeedLimits::new(9.0, 9.0) };
        for limits in [SpeedLimits::new(9.0, 9.0), some] {
            let trajectory = Trajectory::from_path(&path, SimTime::ZERO, limits);
            let without = Trajectory::from_path(
                &Path { segments: path.segments[1..].to_vec(), ..path.clone() },
                SimTime::ZERO,
                limits,
            );
            assert!((trajectory.duration_s() - without.duration_s()).abs() < 1e-5, "{}", trajectory.duration_s());
        }
    }

    pub fn random_path(rng: &mut impl Rng) -> Path {
        let mut segment = || Segment {
            curvature: [0.0, 1.0, -1.0][rng.random_range(0..3)] / rng.random_range(5.0..30.0),
            length_m: rng.random_range(-20.0..20.0),
        };
        let segments = (0..6).map(|_| segment()).collect();
        Path { start: Pose::new(100.0, 100.0, 0.4), segments }
    }

    pub fn random_limits(rng: &mut impl Rng) -> SpeedLimits {
        let mut maybe = |low, high| rng.random_bool(0.7).then(|| rng.random_range(low..high));
        SpeedLimits {
            acceleration_mps2: maybe(0.5, 4.0),
            braking_mps2: maybe(0.5, 6.0),
            lateral_mps2: maybe(0.5, 5.0),
            forward_mps: 9.0,
            reverse_mps: 4.0,
            steering: None,
        }
    }

    /// Speeds at the start and the end of each piece, with its segment.
    fn speeds(trajectory: &Trajectory) -> Vec<(f64, f64, Segment)> {
        let drives = trajectory.pieces().iter().map(|piece| match *piece {
            Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                (speed_mps, speed_after(speed_mps, acceleration_mps2, segment.length_m.abs()), segment)
            }
            _ => panic!("a profile holds drives only"),
        });
        drives.collect()
    }

    #[test]
    fn without_limits_of_acceleration_speed_is_constant() {
        let mut rng = rng::stream(1, "trajectory/profile");
        let path = random_path(&mut rng);
        let drive = Trajectory::from_path(&path, SimTime::ZERO, SpeedLimits::new(8.0, 4.0));
        let seconds = |s: &Segment| s.length_m.abs() / if s.is_reverse() { 4.0 } else { 8.0 };
        assert_eq!(drive.pieces().len(), path.segments.len());
        assert!((drive.duration_s() - path.segments.iter().map(seconds).sum::<f64>()).abs() < 1e-12);
    }

    #[test]
    fn a_straight_takes_what_the_trapezoid_says() {
        let limits =
            SpeedLimits { acceleration_mps2: Some(2.0), braking_mps2: Some(4.0), ..SpeedLimits::new(8.0, 8.0) };
        let seconds = |length_m: f64| {
            let path = Path { start: Pose::default(), segments: vec![Segment { curvature: 0.0, length_m }] };
            Trajectory::from_path(&path, SimTime::ZERO, limits).duration_s()
        };
        // Up to 8 m/s in 16 m and 4 s, down in 8 m and 2 s, the rest at 8 m/s.
        assert!((seconds(40.0) - (4.0 + 2.0 + 2.0)).abs() < 1e-9);
        assert!((seconds(-24.0) - 6.0).abs() < 1e-6);
        // 6 m: a triangle with peak p, 6 = p^2 / 4 + p^2 / 8.
        assert!((seconds(6.0) - (2.0 + 1.0)).abs() < 1e-6);
    }

    #[test]
    fn profiles_keep_their_limits_and_the_path() {
        let mut rng = rng::stream(2, "trajectory/profile");
        for _ in 0..300 {
            let path = random_path(&mut rng);
            let limits = random_limits(&mut rng);
            let drive = Trajectory::from_path(&path, SimTime::ZERO, limits);
            let speeds = speeds(&drive);
            for (piece, (entry, exit, segment)) in drive.pieces().iter().zip(&speeds) {
                assert!(entry.max(*exit) <= limits.speed_on(segment) + 1e-9, "{piece:?} under {limits:?}");
                let Piece::Drive { acceleration_mps2, .. } = *piece else { unreachable!("checked above") };
                assert!(acceleration_mps2 <= limits.acceleration_mps2.unwrap_or(0.0));
                assert!(-acceleration_mps2 <= limits.braking_mps2.unwrap_or(0.0));
            }
            for pair in speeds.windows(2) {
                let cusp = pair[0].2.is_reverse() != pair[1].2.is_reverse();
                let (out, into) = if cusp { (0.0, 0.0) } else { (pair[0].1, pair[1].0) };
                assert!(limits.acceleration_mps2.is_none() || into <= out + 1e-6, "{pair:?} under {limits:?}");
                assert!(limits.braking_mps2.is_none() || out <= into + 1e-6, "{pair:?} under {limits:?}");
                assert!(!cusp || limits.acceleration_mps2.is_none() || pair[1].0 == 0.0);
                assert!(!cusp || limits.braking_mps2.is_none() || pair[0].1 < 1e-6);
            }
            assert!((drive.end().position() - path.end().position()).length() < 1e-9);
            assert!((drive.distance_m(SimTime::MAX) - path.length_m()).abs() < 1e-9);
            assert_eq!(drive.cusps(), path.cusps());
            assert!((limits.drive_s(&path.segments) - drive.duration_s()).abs() < 1e-9);
        }
    }

    #[test]
    fn wheels_keep_up_or_the_truck_stands() {
        let steering = SteeringLimits { rate_rad_s: 0.35, wheelbase_m: 3.0 };
        let mut rng = rng::stream(5, "trajectory/profile");
        for _ in 0..300 {
            let limits = SpeedLimits { steering: Some(steering), ..random_limits(&mut rng) };
            let mut path = random_path(&mut rng);
            // A row of small steps, and a jump.
            path.segments.extend(steering.clothoid(0.0, 0.07, 1.0, rng.random_range(1.0..9.0)));
            path.segments.push(Segment { curvature: 0.07, length_m: 3.0 });
            let drive = Trajectory::from_path(&path, SimTime::ZERO, limits);
            let (mut wheels, mut behind_s) = (0.0, 0.0);
            for piece in drive.pieces() {
                let Some(segment) = piece.segment() else {
                    behind_s -= piece.duration_s();
                    continue;
                };
                behind_s = f64::max(0.0, behind_s + steering.turning_s(wheels, segment.curvature));
                assert!(behind_s <= STEERING_STEP_S + 1e-9, "wheels are {behind_s} s behind at {piece:?}");
                wheels = segment.curvature;
                // They do not know yet what comes next.
                behind_s = f64::max(0.0, behind_s - piece.duration_s());
            }
            assert!(behind_s + steering.turning_s(wheels, 0.0) < 1e-9);
            let without = SpeedLimits { steering: None, ..limits }.drive_s(&path.segments);
            assert!(drive.duration_s() > without);
            assert!((drive.distance_m(SimTime::MAX) - path.length_m()).abs() < 1e-9);
            assert!((limits.drive_s(&path.segments) - drive.duration_s()).abs() < 1e-9);
        }
    }

    #[test]
    fn profiles_waste_no_time() {
        // Somewhere in every segment the speed is at its limit, or the segment is all speeding up and braking.
        let mut rng = rng::stream(3, "trajectory/profile");
        for _ in 0..300 {
            let path = random_path(&mut rng);
            let limits = random_limits(&mut rng);
            let drive = Trajectory::from_path(&path, SimTime::ZERO, limits);
            for (piece, (entry, _, segment)) in drive.pieces().iter().zip(speeds(&drive)) {
                let Piece::Drive { acceleration_mps2, .. } = *piece else { unreachable!("profiles hold drives only") };
                assert!(
                    acceleration_mps2 != 0.0 || (entry - limits.speed_on(&segment)).abs() < 1e-9,
                    "{piece:?}, {limits:?}"
                );
            }
        }
    }

    #[test]
    fn position_and_speed_agree() {
        let mut rng = rng::stream(4, "trajectory/profile");
        for _ in 0..50 {
            let path = random_path(&mut rng);
            let limits = random_limits(&mut rng);
            let drive = Trajectory::from_path(&path, SimTime::ZERO, limits);
            let step = drive.duration_s() / 5000.0;
            let mut integrated = 0.0;
            for k in 0..5000 {
                let middle = drive.state_at(SimTime::from_seconds((f64::from(k) + 0.5) * step));
                integrated += middle.speed_mps * step;
            }
            assert!((integrated - path.length_m()).abs() < 0.05, "{integrated} m of {} m", path.length_m());
        }
    }
}
