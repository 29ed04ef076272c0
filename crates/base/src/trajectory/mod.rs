//! A path with a clock: where a body is at any time, in closed form.
//!
//! A trajectory is a list of pieces, each with constant curvature and constant acceleration, that begin where and
//! when the last one ended. Nothing is stepped: [`Trajectory::pose_at`] computes.
//!
//! [`Trajectory::from_path`] gives a path its speeds, [`Trajectory::over_ground`] those on slow ground, [`Trajectory::stopping`] cuts a motion short,
//! [`Trajectory::after_waiting`] lets it begin later.

mod ground;
mod profile;
mod stopping;

pub use ground::GroundSpeed;
pub use profile::SpeedLimits;

use serde::{Deserialize, Serialize};

use crate::geometry::Pose;
use crate::time::SimTime;
use crate::vehicle::Segment;

/// Durations are sums of rounded numbers. What they exceed a whole nanosecond by, up to this many seconds, is noise
/// and does not cost a nanosecond more.
const DURATION_NOISE_S: f64 = 1e-11;

/// One closed-form stretch of motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Piece {
    /// Along a segment; speed in m/s at its start (not negative, the segment's sign says forward or reverse) and
    /// the change of that speed in m/s2.
    Drive { segment: Segment, speed_mps: f64, acceleration_mps2: f64 },
    /// A turn on the spot to a heading in radians, at once. Only the Wumpus, on legs, can do it.
    Turn { heading: f64 },
    /// Standing still for a time in seconds.
    Wait { seconds: f64 },
}

impl Piece {
    /// The stretch of path that this piece drives, if it drives.
    pub fn segment(&self) -> Option<Segment> {
        match *self {
            Self::Drive { segment, .. } => Some(segment),
            Self::Turn { .. } | Self::Wait { .. } => None,
        }
    }

    /// Seconds that this piece takes.
    pub fn duration_s(&self) -> f64 {
        match *self {
            Self::Drive { segment, speed_mps, acceleration_mps2 } => {
                let distance = segment.length_m.abs();
                if acceleration_mps2 == 0.0 {
                    distance / speed_mps
                } else {
                    // The mean speed is exact under constant acceleration, and nothing is divided by a small one.
                    2.0 * distance / (speed_mps + speed_after(speed_mps, acceleration_mps2, distance))
                }
            }
            Self::Turn { .. } => 0.0,
            Self::Wait { seconds } => seconds,
        }
    }

    /// Metres covered `elapsed_s` into this piece.
    fn covered_m(&self, elapsed_s: f64) -> f64 {
        match *self {
            Self::Drive { segment, speed_mps, acceleration_mps2 } => {
                // A time that is rounded must not lead beyond either end of the piece.
                (elapsed_s * (speed_mps + 0.5 * acceleration_mps2 * elapsed_s)).clamp(0.0, segment.length_m.abs())
            }
            Self::Turn { .. } | Self::Wait { .. } => 0.0,
        }
    }

    /// Metres from its start to its end, along the way.
    fn length_m(&self) -> f64 {
        match *self {
            Self::Drive { segment, .. } => segment.length_m.abs(),
            Self::Turn { .. } | Self::Wait { .. } => 0.0,
        }
    }

    fn state_at(&self, start: Pose, elapsed_s: f64) -> MotionState {
        match *self {
            Self::Drive { segment, speed_mps, acceleration_mps2 } => {
                let travelled = self.covered_m(elapsed_s).copysign(segment.length_m);
                // A brake that ends in a stop may end below zero by rounding.
                let speed_mps = (speed_mps + acceleration_mps2 * elapsed_s).max(0.0);
                MotionState { pose: segment.pose_at(start, travelled), speed_mps }
            }
            Self::Turn { heading } => MotionState::standing(Pose::new(start.x, start.y, heading)),
            Self::Wait { .. } => MotionState::standing(start),
        }
    }

    fn end(&self, start: Pose) -> Pose {
        match *self {
            Self::Drive { segment, .. } => segment.end(start),
            Self::Turn { heading } => Pose::new(start.x, start.y, heading),
            Self::Wait { .. } => start,
        }
    }
}

/// Pose and speed of a body at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionState {
    pub pose: Pose,
    /// Never negative, in reverse too.
    pub speed_mps: f64,
}

impl MotionState {
    pub fn standing(pose: Pose) -> Self {
        Self { pose, speed_mps: 0.0 }
    }
}

/// Motion from a start pose at a start time. Before its start a body stands at the start, after its end at the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "StoredTrajectory", into = "StoredTrajectory")]
pub struct Trajectory {
    start_time: SimTime,
    start: Pose,
    pieces: Vec<Piece>,
    /// Seconds from the start, and pose, at which each piece ends; derived.
    ends: Vec<(f64, Pose)>,
}

/// The speed and curvature of a body for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Never more, in m/s.
    pub fastest_mps: f64,
    pub curvature: f64,
    /// The next instant at which this may be another one; [`SimTime::MAX`] when the body stands forever.
    pub until: SimTime,
}

/// The part of a trajectory that a file holds: all that is not derived.
#[derive(Clone, Serialize, Deserialize)]
#[serde(rename = "Trajectory")]
struct StoredTrajectory {
    start_time: SimTime,
    start: Pose,
    pieces: Vec<Piece>,
}

impl From<StoredTrajectory> for Trajectory {
    fn from(stored: StoredTrajectory) -> Self {
        Self::new(stored.start_time, stored.start, stored.pieces)
    }
}

impl From<Trajectory> for StoredTrajectory {
    fn from(trajectory: Trajectory) -> Self {
        Self { start_time: trajectory.start_time, start: trajectory.start, pieces: trajectory.pieces }
    }
}

/// Speed in m/s after `distance` metres at constant acceleration; 0 where a brake has stopped the body before.
fn speed_after(speed: f64, acceleration: f64, distance: f64) -> f64 {
    (speed * speed + 2.0 * acceleration * distance).max(0.0).sqrt()
}

impl Trajectory {
    pub fn new(start_time: SimTime, start: Pose, pieces: Vec<Piece>) -> Self {
        let mut ends = Vec::with_capacity(pieces.len());
        let (mut elapsed, mut pose) = (0.0, start);
        for piece in &pieces {
            elapsed += piece.duration_s();
            pose = piece.end(pose);
            ends.push((elapsed, pose));
        }
        Self { start_time, start, pieces, ends }
    }

    pub fn start_time(&self) -> SimTime {
        self.start_time
    }

    /// Returns when the last piece ends, rounded up to the next nanosecond. From then on the body stands at
    /// [`Trajectory::end`].
    pub fn end_time(&self) -> SimTime {
        self.start_time + SimTime::from_seconds_up(self.duration_s() - DURATION_NOISE_S)
    }

    pub fn duration_s(&self) -> f64 {
        self.ends.last().map_or(0.0, |&(elapsed, _)| elapsed)
    }

    pub fn start(&self) -> Pose {
        self.start
    }

    pub fn end(&self) -> Pose {
        self.ends.last().map_or(self.start, |&(_, pose)| pose)
    }

    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The pieces with the pose at which each begins.
    pub fn pieces_with_starts(&self) -> impl Iterator<Item = (Pose, &Piece)> {
        let starts = std::iter::once(self.start).chain(self.ends.iter().map(|&(_, pose)| pose));
        starts.zip(&self.pieces)
    }

    pub fn pose_at(&self, time: SimTime) -> Pose {
        self.state_at(time).pose
    }

    /// At an instant where one piece ends and the next begins, the next one counts; a turn on the spot is done by then.
    pub fn state_at(&self, time: SimTime) -> MotionState {
        if time < self.start_time {
            return MotionState::standing(self.start);
        }
        match self.progress_at(time) {
            Some(progress) => self.pieces[progress.index].state_at(progress.start, progress.elapsed_s),
            None => MotionState::standing(self.end()),
        }
    }

    /// Bounds the body's speed from a time on, until the piece that is under way ends.
    pub fn pace_at(&self, time: SimTime) -> Pace {
        let standing = |until| Pace { fastest_mps: 0.0, curvature: 0.0, until };
        if time < self.start_time {
            return standing(self.start_time);
        }
        let Some(progress) = self.progress_at(time) else { return standing(SimTime::MAX) };
        // Rounded up, so that the piece is over by then.
        let until = self.start_time + SimTime::from_seconds_up(self.ends[progress.index].0);
        match self.pieces[progress.index] {
            Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                let at_end = speed_after(speed_mps, acceleration_mps2, segment.length_m.abs());
                Pace { fastest_mps: speed_mps.max(at_end), curvature: segment.curvature, until }
            }
            Piece::Turn { .. } | Piece::Wait { .. } => standing(until),
        }
    }

    /// Returns the same motion after standing at its start for a while, counted from its start time.
    pub fn after_waiting(&self, seconds: f64) -> Self {
        let pieces = std::iter::once(Piece::Wait { seconds }).chain(self.pieces.iter().copied());
        Self::new(self.start_time, self.start, pieces.collect())
    }

    /// Returns when it begins to move: its start time, and the waits at its beginning.
    pub fn sets_out_at(&self) -> SimTime {
        let waits = self.pieces.iter().take_while(|piece| matches!(piece, Piece::Wait { .. })).count();
        match waits {
            0 => self.start_time,
            waits => self.start_time + SimTime::from_seconds(self.ends[waits - 1].0),
        }
    }

    /// Metres covered, forward and reverse alike, up to a time.
    pub fn distance_m(&self, until: SimTime) -> f64 {
        if until < self.start_time {
            return 0.0;
        }
        let progress = self.progress_at(until);
        let whole = progress.map_or(self.pieces.len(), |progress| progress.index);
        let partial_m = progress.map_or(0.0, |progress| self.pieces[progress.index].covered_m(progress.elapsed_s));
        self.pieces[..whole].iter().map(Piece::length_m).sum::<f64>() + partial_m
    }

    /// Changes between forward and reverse over the whole trajectory.
    pub fn cusps(&self) -> u32 {
        let mut last = None;
        let mut cusps = 0;
        for piece in &self.pieces {
            if let Piece::Drive { segment, .. } = piece {
                cusps += u32::from(last.is_some_and(|reverse| reverse != segment.is_reverse()));
                last = Some(segment.is_reverse());
            }
        }
        cusps
    }

    /// Returns the piece that is under way at a time that is not before the start; `None` when all have ended.
    fn progress_at(&self, time: SimTime) -> Option<PieceProgress> {
        if time >= self.end_time() {
            return None;
        }
        let elapsed = time.since(self.start_time).as_seconds();
        let index = self.ends.partition_point(|&(end, _)| end <= elapsed);
        let (began, start) = if index == 0 { (0.0, self.start) } else { self.ends[index - 1] };
        // The end is rounded up, so that within its last nanosecond all pieces may be over.
        (index < self.pieces.len()).then_some(PieceProgress { index, start, elapsed_s: elapsed - began })
    }
}

/// The progress of a motion: the piece under way, the pose at which it begins, and how long it has been under way.
#[derive(Clone, Copy)]
struct PieceProgress {
    index: usize,
    start: Pose,
    elapsed_s: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Path;

    /// A walk with turns on the spot at its start, in its middle and at its end, and a wait.
    fn walk() -> Trajectory {
        let leg =
            Piece::Drive { segment: Segment { curvature: 0.0, length_m: 6.0 }, speed_mps: 2.0, acceleration_mps2: 0.0 };
        let pieces = vec![
            Piece::Turn { heading: 1.0 },
            leg,
            Piece::Turn { heading: 2.0 },
            Piece::Wait { seconds: 1.0 },
            leg,
            Piece::Turn { heading: -3.0 },
        ];
        Trajectory::new(SimTime::from_seconds(10.0), Pose::new(1.0, 2.0, 0.5), pieces)
    }

    fn at(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    #[test]
    fn turns_on_the_spot_are_done_at_their_instant() {
        let walk = walk();
        let heading = |seconds| walk.pose_at(at(seconds)).heading;
        assert_eq!([heading(9.999), heading(10.0), heading(12.9)], [0.5, 1.0, 1.0]);
        assert_eq!([heading(13.0), heading(13.5), heading(16.9)], [2.0, 2.0, 2.0]);
        assert_eq!([heading(17.0), heading(99.0)], [-3.0, -3.0]);
        assert_eq!(walk.end_time(), at(17.0));
    }

    #[test]
    fn a_turn_alone_waits_for_its_time() {
        let turn = Trajectory::new(at(5.0), Pose::default(), vec![Piece::Turn { heading: 1.0 }]);
        assert_eq!(turn.pose_at(at(4.0)).heading, 0.0);
        assert_eq!(turn.pose_at(at(5.0)).heading, 1.0);
        assert_eq!(turn.end_time(), at(5.0));
    }

    #[test]
    fn distance_and_speed_follow_the_pieces() {
        let walk = walk();
        let state = |seconds| (walk.distance_m(at(seconds)), walk.state_at(at(seconds)).speed_mps);
        assert_eq!([state(0.0), state(10.0), state(11.0)], [(0.0, 0.0), (0.0, 2.0), (2.0, 2.0)]);
        assert_eq!([state(13.5), state(14.0), state(15.0)], [(6.0, 0.0), (6.0, 2.0), (8.0, 2.0)]);
        assert_eq!([state(17.0), state(50.0)], [(12.0, 0.0), (12.0, 0.0)]);
    }

    #[test]
    fn a_body_stands_before_its_start_and_after_its_end_exactly_where_they_are() {
        for count in 1..60 {
            let segment = Segment { curvature: 1.0 / 13.0, length_m: 0.1 * f64::from(count) };
            let path = Path { start: Pose::new(50.0, 40.0, 0.3), segments: vec![segment; count as usize] };
            let drive = Trajectory::from_path(&path, at(0.3), SpeedLimits::new(7.3, 3.1));
            assert_eq!(drive.state_at(drive.end_time()), MotionState::standing(drive.end()));
            assert_eq!(drive.distance_m(drive.end_time()), drive.distance_m(SimTime::MAX));
            assert_eq!(drive.state_at(SimTime::ZERO), MotionState::standing(drive.start()));
            assert_eq!(drive.pose_at(drive.start_time()), drive.start());
            assert!((drive.end().position() - path.end().position()).length() < 1e-11);
            // The last nanosecond moves the body by no more than its speed allows.
            let before = drive.pose_at(SimTime::from_nanos(drive.end_time().as_nanos() - 1));
            assert!((before.position() - drive.end().position()).length() < 1e-8);
        }
    }

    #[test]
    fn a_duration_in_whole_nanoseconds_is_not_rounded_up_for_noise() {
        let wait = |seconds| Trajectory::new(SimTime::ZERO, Pose::default(), vec![Piece::Wait { seconds }; 3]);
        assert_eq!(wait(0.1).end_time().as_nanos(), 300_000_000);
        assert_eq!(wait(0.1 + 0.4e-9).end_time().as_nanos(), 300_000_002);
    }

    #[test]
    fn a_stored_trajectory_comes_back_whole() {
        let bytes = postcard::to_stdvec(&walk()).expect("trajectories serialise");
        assert_eq!(postcard::from_bytes::<Trajectory>(&bytes).expect("and come back"), walk());
    }
}
