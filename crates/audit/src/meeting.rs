//! The bodies of trucks: at no time do two of them overlap.

use super::driven::DrivenLegs;
use super::field::{ALLOWED_M, Outline, UnitPose};
use super::{SampleStep, Violation, ViolationKind};
use wildfire_base::time::SimTime;

/// Looks that one pair of trucks may take.
const MAX_LOOKS: u64 = 1_000_000_000;

/// A truck on its way, and its body.
pub struct MovingTruck<'a> {
    pub driven: &'a DrivenLegs<'a>,
    pub outline: Outline,
}

/// Checks that no two trucks overlap until `end`; the violation is the first overlap of any two.
pub fn audit_meetings(drivers: &[MovingTruck<'_>], end: SimTime, step: SampleStep) -> Result<(), Violation> {
    let pairs = (0..drivers.len()).flat_map(|one| (one + 1..drivers.len()).map(move |other| (one, other)));
    let violations =
        pairs.filter_map(|(one, other)| MeetingPair::new(&drivers[one], &drivers[other], step).audit(end).err());
    violations.min_by_key(|violation| violation.time).map_or(Ok(()), Err)
}

struct MeetingPair<'a> {
    one: &'a MovingTruck<'a>,
    other: &'a MovingTruck<'a>,
    /// Sum of the radii of the circles about the bodies.
    radii_m: f64,
    /// Speed at which the centres can approach each other, in m/s.
    closing_mps: f64,
    /// In which neither moves farther than a step.
    shortest_s: f64,
}

impl<'a> MeetingPair<'a> {
    fn new(one: &'a MovingTruck<'a>, other: &'a MovingTruck<'a>, step: SampleStep) -> Self {
        let speeds = [one, other].map(|driver| {
            let (speed, curvature) = driver.driven.extremes();
            // The centre of the body swings about the origin that drives.
            (speed, speed * (1.0 + curvature * driver.outline.ahead_m.abs()))
        });
        let fastest = speeds[0].0.max(speeds[1].0);
        Self {
            one,
            other,
            radii_m: one.outline.radius_m() + other.outline.radius_m(),
            closing_mps: speeds[0].1 + speeds[1].1,
            shortest_s: step.metres / fastest,
        }
    }

    fn audit(&self, end: SimTime) -> Result<(), Violation> {
        let (mut time, mut looks) = (SimTime::ZERO, 0);
        while time <= end {
            let [at, other_at] = [self.one, self.other].map(|driver| UnitPose::new(driver.driven.pose_at(time)));
            let violation = |kind| Violation { time, agent: Some(self.one.driven.id), place: at.place, kind };
            let between = self.other.outline.centre(other_at) - self.one.outline.centre(at);
            // Circles first: the exact overlap is only computed where these meet.
            let gap_m = between.length() - self.radii_m;
            if gap_m <= 0.0 {
                let depth_m = self.one.outline.overlap_m(at, &self.other.outline, other_at);
                if depth_m > ALLOWED_M {
                    return Err(violation(ViolationKind::Overlap { other: self.other.driven.id, depth_m }));
                }
            }
            looks += 1;
            if looks > MAX_LOOKS {
                return Err(violation(ViolationKind::Endless));
            }
            // The gap and the speeds say how long nothing can happen.
            let Some(next) = self.next_look(time, gap_m) else { break };
            time = next;
        }
        Ok(())
    }

    /// When they may have come closer; `None` if nobody moves any more.
    fn next_look(&self, time: SimTime, gap_m: f64) -> Option<SimTime> {
        let stand_until = self.one.driven.stands_until(time).min(self.other.driven.stands_until(time));
        // Bodies that touch would be looked at in every nanosecond.
        let meet_s = (gap_m / self.closing_mps).max(self.shortest_s);
        let next = (time + SimTime::from_seconds(meet_s)).max(stand_until);
        // A step that rounds to nothing would look at this instant forever.
        (next < SimTime::MAX).then(|| next.max(time + SimTime::from_nanos(1)))
    }
}
