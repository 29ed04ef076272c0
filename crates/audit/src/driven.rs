//! The legs of an agent as they were driven, one after the other.

use super::pace::DriveProfile;
use super::tolerance::Tolerance;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, Trajectory};
use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, Fact, Timeline};

/// The way of one agent through a run.
#[derive(Debug)]
pub struct DrivenLegs<'a> {
    pub id: AgentId,
    pub start: Pose,
    /// A turn on the spot may be a nanosecond off, so for a body that makes them only places are compared.
    turns_on_the_spot: bool,
    legs: Vec<Leg<'a>>,
}

/// A leg as it was planned, and as it was driven if its goal was dropped, each with the time of its fact.
#[derive(Debug)]
struct Leg<'a> {
    versions: Vec<(SimTime, &'a Trajectory)>,
}

/// Where an agent stands between two legs.
#[derive(Clone, Copy, Debug)]
struct RestPose {
    since: SimTime,
    pose: Pose,
    /// The distance from there within which the next leg has to begin.
    tolerance: Tolerance,
}

impl<'a> Leg<'a> {
    fn new(time: SimTime, trajectory: &'a Trajectory) -> Self {
        Self { versions: vec![(time, trajectory)] }
    }

    fn driven(&self) -> &'a Trajectory {
        self.versions.last().expect("there is one from the beginning").1
    }
}

impl<'a> DrivenLegs<'a> {
    pub fn new(agent: &AgentStart, timeline: &'a Timeline) -> Self {
        let mut legs: Vec<Leg<'a>> = Vec::new();
        for event in timeline.events.iter().filter(|event| event.fact.agent() == Some(agent.id)) {
            // A shortened drive replaces the last leg; any other trajectory is a leg of its own.
            match (&event.fact, legs.last_mut()) {
                (
                    Fact::Agent(_, AgentFact::Dropped { trajectory, .. } | AgentFact::Halted { trajectory }),
                    Some(leg),
                ) => {
                    leg.versions.push((event.time, trajectory));
                }
                (fact, _) => legs.extend(fact.trajectory().map(|leg| Leg::new(event.time, leg))),
            }
        }
        let turns_on_the_spot = !matches!(agent.body, Body::Truck(_));
        Self { id: agent.id, start: agent.pose, turns_on_the_spot, legs }
    }

    /// The legs as they were driven, in the order of their plans.
    pub fn legs(&self) -> impl Iterator<Item = &'a Trajectory> {
        self.legs.iter().map(Leg::driven)
    }

    /// Checks that every leg begins where and when the last one has ended, and that what was dropped was driven as
    /// planned until then.
    pub fn audit(&self) -> Result<(), Violation> {
        let mut stand = RestPose { since: SimTime::ZERO, pose: self.start, tolerance: Tolerance::STANDING };
        for leg in &self.legs {
            let (planned, first) = leg.versions[0];
            self.check_join(stand, first).map_err(|kind| self.violation(planned, first.start(), kind))?;
            for pair in leg.versions.windows(2) {
                let (time, driven) = pair[1];
                if !self.is_cut(pair[0].1, driven, time) {
                    return Err(self.violation(time, driven.pose_at(time), ViolationKind::CutDiffers));
                }
            }
            let driven = leg.driven();
            stand = RestPose { since: driven.end_time(), pose: driven.end(), tolerance: Tolerance::from_leg(driven) };
        }
        Ok(())
    }

    fn check_join(&self, stand: RestPose, next: &Trajectory) -> Result<(), ViolationKind> {
        if next.start_time() < stand.since {
            return Err(ViolationKind::StillUnderWay { until: stand.since });
        }
        if self.is_same(stand.pose, next.start(), stand.tolerance) {
            return Ok(());
        }
        let (metres, radians) = gap(stand.pose, next.start());
        Err(ViolationKind::Discontinuous { metres, radians })
    }

    /// Returns true if the leg as driven is the planned one until its goal was dropped, and stays on its way later.
    fn is_cut(&self, planned: &Trajectory, driven: &Trajectory, dropped: SimTime) -> bool {
        let tolerance = Tolerance::from_leg(planned);
        let same_at = |time| self.is_same(planned.pose_at(time), driven.pose_at(time), tolerance);
        let mut ends = planned.pieces().iter().scan(0.0, |elapsed_s, piece| {
            *elapsed_s += piece.duration_s();
            Some(planned.start_time() + SimTime::from_seconds(*elapsed_s))
        });
        same_at(planned.start_time().min(dropped))
            && same_at(dropped)
            && ends.all(|time| time > dropped || same_at(time))
            // From there on it brakes: it is later than planned, but nowhere beside the way.
            && self.is_same(pose_after(planned, driven.distance_m(SimTime::MAX)), driven.end(), tolerance)
    }

    /// Returns true if two poses are the same; what is not a number is never the same.
    fn is_same(&self, one: Pose, other: Pose, tolerance: Tolerance) -> bool {
        let (metres, radians) = gap(one, other);
        let max_radians = if self.turns_on_the_spot { f64::INFINITY } else { tolerance.radians };
        metres <= tolerance.metres && radians <= max_radians
    }

    fn violation(&self, time: SimTime, pose: Pose, kind: ViolationKind) -> Violation {
        Violation { time, agent: Some(self.id), place: pose.position(), kind }
    }

    /// Returns the place of the agent at a time.
    pub fn pose_at(&self, time: SimTime) -> Pose {
        let started_legs = self.started_legs(time);
        started_legs.checked_sub(1).map_or(self.start, |last| self.legs[last].driven().pose_at(time))
    }

    /// Returns until when the agent stays in place at a time: that time itself if it is under way, `MAX` if
    /// forever.
    pub fn stands_until(&self, time: SimTime) -> SimTime {
        let started_legs = self.started_legs(time);
        let is_under_way = started_legs > 0 && self.legs[started_legs - 1].driven().end_time() > time;
        if is_under_way {
            return time;
        }
        self.legs.get(started_legs).map_or(SimTime::MAX, |next| next.driven().start_time())
    }

    /// Returns how many legs have begun; legs that join begin in their order.
    fn started_legs(&self, time: SimTime) -> usize {
        self.legs.partition_point(|leg| leg.driven().start_time() <= time)
    }

    /// The greatest speed of its origin in m/s, and the greatest curvature of its way in 1/m.
    pub fn extremes(&self) -> (f64, f64) {
        let pieces = self.legs().flat_map(Trajectory::pieces);
        pieces.fold((0.0, 0.0), |(speed, curvature), piece| match *piece {
            Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                let drive = DriveProfile::new(segment.length_m.abs(), speed_mps, acceleration_mps2);
                (f64::max(speed, drive.fastest_mps()), f64::max(curvature, segment.curvature.abs()))
            }
            Piece::Turn { .. } | Piece::Wait { .. } => (speed, curvature),
        })
    }
}

/// Returns the pose on a leg after a number of metres, before turns on the spot at that place.
fn pose_after(leg: &Trajectory, metres: f64) -> Pose {
    let mut left = metres;
    for (start, piece) in leg.pieces_with_starts() {
        let Some(segment) = piece.segment() else { continue };
        let length_m = segment.length_m.abs();
        if left <= length_m {
            return segment.pose_at(start, left.copysign(segment.length_m));
        }
        left -= length_m;
    }
    leg.end()
}

/// Metres and radians between two poses.
fn gap(one: Pose, other: Pose) -> (f64, f64) {
    let turn = ops::wrap_angle(one.heading - other.heading);
    ((one.position() - other.position()).length(), turn.abs())
}
