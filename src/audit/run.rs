//! A whole run: legs that join, and fires that went out beside a truck that stood.

use std::fmt;

use super::{Audited, Ground, Offence, Step, audit_leg};
use crate::geometry::{Cell, Pose, ops};
use crate::time::SimTime;
use crate::timeline::{AgentId, Body, Fact, Rules, Timeline};
use crate::trajectory::{SpeedLimits, Trajectory};
use crate::vehicle::Dimensions;

/// How far apart two poses may be that shall be one, in metres and radians.
const SAME_POSE: f64 = 1e-6;

/// A rule that a run broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunRule {
    /// Within a leg; the offence has its own time and place.
    Leg(Offence),
    /// A leg begins this far from where the last one ended, in metres and radians.
    Discontinuous { metres: f64, radians: f64 },
    /// A leg begins before the last one has ended.
    StillUnderWay { until: SimTime },
    /// The leg as driven, after its goal was dropped, is another one than planned.
    CutDiffers,
    /// A fire went out while its truck was moving, or had stood for less than the dwell.
    NotStanding { cell: Cell, since: SimTime },
    /// A fire went out beyond the reach of its truck.
    OutOfReach { cell: Cell, metres: f64, reach_m: f64 },
    /// A fact names a truck that the setting does not have.
    UnknownTruck,
}

/// The first offence of a run: who, when, which rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOffence {
    pub agent: AgentId,
    pub time: SimTime,
    pub rule: RunRule,
}

impl fmt::Display for RunOffence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, ", self.agent)?;
        match self.rule {
            RunRule::Leg(offence) => return write!(f, "{offence}"),
            _ => write!(f, "at {}: ", self.time)?,
        }
        match self.rule {
            RunRule::Leg(_) => Ok(()),
            RunRule::Discontinuous { metres, radians } => {
                write!(f, "a leg begins {metres:.6} m and {radians:.6} rad from where the last one ended")
            }
            RunRule::StillUnderWay { until } => write!(f, "a leg begins while the last one lasts until {until}"),
            RunRule::CutDiffers => write!(f, "the leg as driven is not the one that was planned"),
            RunRule::NotStanding { cell, since } => {
                write!(f, "the fire at cell {cell} goes out, but its truck stands only since {since}")
            }
            RunRule::OutOfReach { cell, metres, reach_m } => {
                write!(f, "the fire at cell {cell} goes out {metres:.3} m away, beyond the reach of {reach_m} m")
            }
            RunRule::UnknownTruck => write!(f, "no such truck"),
        }
    }
}

/// Holds a finished run against the rules: every leg of every truck as it was driven, that legs join, and that every
/// fire that went out had its truck standing within reach for the whole dwell.
///
/// `limits` says how fast each truck may go; a timeline does not. `SpeedLimits::of_speed` of infinity checks nothing.
pub fn audit_timeline(
    timeline: &Timeline,
    limits: impl Fn(AgentId) -> SpeedLimits,
    step: Step,
) -> Result<Audited, RunOffence> {
    let setting = &timeline.setting;
    let ground = Ground::new(setting.frame, &setting.bushes);
    let mut audited = Audited::default();
    let mut trucks: Vec<Truck> = Vec::new();
    for start in &setting.agents {
        if let Body::Truck(body) = start.body {
            let leg = Trajectory::new(SimTime::ZERO, start.pose, Vec::new());
            trucks.push(Truck { id: start.id, body, limits: limits(start.id), leg });
        }
    }
    for event in &timeline.events {
        let (id, time) = match event.fact {
            Fact::Planned { agent, .. } | Fact::Dropped { agent, .. } | Fact::GaveWay { agent, .. } => {
                (agent, event.time)
            }
            Fact::Extinguished { by, .. } => (by, event.time),
            _ => continue,
        };
        if !matches!(id, AgentId::Unimog(_)) {
            continue;
        }
        let offence = |rule| RunOffence { agent: id, time, rule };
        let truck = trucks.iter_mut().find(|truck| truck.id == id).ok_or(offence(RunRule::UnknownTruck))?;
        match &event.fact {
            Fact::Planned { trajectory, .. } | Fact::GaveWay { trajectory, .. } => {
                audited += truck.audit(&ground, step)?;
                truck.join(trajectory).map_err(offence)?;
                truck.leg = trajectory.clone();
            }
            Fact::Dropped { trajectory, .. } => {
                truck.check_cut(trajectory, time).map_err(offence)?;
                truck.leg = trajectory.clone();
            }
            Fact::Extinguished { cell, .. } => {
                truck.check_extinction(&ground, &setting.rules, *cell, time).map_err(offence)?;
                audited.extinctions += 1;
            }
            _ => {}
        }
    }
    for truck in &trucks {
        audited += truck.audit(&ground, step)?;
    }
    Ok(audited)
}

/// A truck with the leg that it is on, or came to rest with.
struct Truck {
    id: AgentId,
    body: Dimensions,
    limits: SpeedLimits,
    leg: Trajectory,
}

impl Truck {
    fn audit(&self, ground: &Ground, step: Step) -> Result<Audited, RunOffence> {
        audit_leg(ground, &self.body, &self.limits, &self.leg, step).map_err(|offence| RunOffence {
            agent: self.id,
            time: offence.time,
            rule: RunRule::Leg(offence),
        })
    }

    fn join(&self, next: &Trajectory) -> Result<(), RunRule> {
        let until = self.leg.end_time();
        if next.start_time() < until {
            return Err(RunRule::StillUnderWay { until });
        }
        let (metres, radians) = gap(self.leg.end(), next.start());
        if is_small(metres) && is_small(radians) { Ok(()) } else { Err(RunRule::Discontinuous { metres, radians }) }
    }

    /// The cut leg begins where the planned one did, and has done the same until the goal was dropped.
    fn check_cut(&self, driven: &Trajectory, dropped: SimTime) -> Result<(), RunRule> {
        let same_at = |time| {
            let (metres, radians) = gap(self.leg.pose_at(time), driven.pose_at(time));
            is_small(metres) && is_small(radians)
        };
        let mut middles = self.leg.pieces().iter().scan(0.0, |began_s, piece| {
            *began_s += piece.duration_s();
            Some(self.leg.start_time() + SimTime::from_seconds(*began_s))
        });
        let same = same_at(self.leg.start_time().min(dropped))
            && same_at(dropped)
            && middles.all(|time| time > dropped || same_at(time));
        if same { Ok(()) } else { Err(RunRule::CutDiffers) }
    }

    fn check_extinction(&self, ground: &Ground, rules: &Rules, cell: Cell, time: SimTime) -> Result<(), RunRule> {
        let since = self.leg.end_time();
        if since + rules.suppression_dwell > time {
            return Err(RunRule::NotStanding { cell, since });
        }
        let pose = self.leg.end();
        let ahead = pose.direction() * (0.5 * self.body.length_m - self.body.rear_overhang_m);
        let metres = (pose.position() + ahead - ground.frame().centre(cell)).length();
        match rules.suppression_reach_m {
            Some(reach_m) if !is_small(metres - reach_m) => Err(RunRule::OutOfReach { cell, metres, reach_m }),
            _ => Ok(()),
        }
    }
}

fn gap(one: Pose, other: Pose) -> (f64, f64) {
    let turn = ops::wrap_angle(one.heading - other.heading);
    ((one.position() - other.position()).length(), turn.abs())
}

/// Whether a gap is noise; what is not a number is not.
fn is_small(gap: f64) -> bool {
    gap <= SAME_POSE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::FieldFrame;
    use crate::timeline::{AgentStart, Event, Setting};
    use crate::vehicle::{Path, Segment};

    const TRUCK: AgentId = AgentId::Unimog(0);
    const NEAR: Cell = Cell { col: 10, row: 10 };
    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 8.0,
        acceleration_mps2: None,
        braking_mps2: None,
        lateral_mps2: None,
    };

    fn seconds(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    fn drive(start_s: f64, start: Pose, lengths_m: &[f64]) -> Trajectory {
        let segments = lengths_m.iter().map(|&length_m| Segment { curvature: 0.0, length_m }).collect();
        Trajectory::along(&Path { start, segments }, seconds(start_s), LIMITS)
    }

    fn planned(time_s: f64, trajectory: Trajectory) -> Event {
        let effort = Default::default();
        let fact = Fact::Planned { agent: TRUCK, goal: NEAR, trajectory, effort, by_lattice: false };
        Event { time: seconds(time_s), fact }
    }

    fn dropped(time_s: f64, trajectory: Trajectory) -> Event {
        Event { time: seconds(time_s), fact: Fact::Dropped { agent: TRUCK, goal: NEAR, trajectory } }
    }

    fn extinguished(time_s: f64) -> Event {
        Event { time: seconds(time_s), fact: Fact::Extinguished { cell: NEAR, by: TRUCK } }
    }

    /// A truck that starts at (20, 46) m, facing east, on a field of 100 m with one bush from 50 m to 55 m.
    fn start() -> Pose {
        Pose::new(20.0, 46.0, 0.0)
    }

    fn run(events: Vec<Event>) -> Result<Audited, RunOffence> {
        let setting = Setting {
            scenario: "audit".into(),
            seed: 1,
            program_version: "0".into(),
            frame: FieldFrame { cols: 20, rows: 20, cell_m: 5.0 },
            bushes: vec![NEAR],
            agents: vec![AgentStart {
                id: TRUCK,
                pose: start(),
                body: Body::Truck(Dimensions::default()),
                limits: Some(LIMITS),
            }],
            rules: Rules {
                duration: seconds(100.0),
                suppression_reach_m: Some(10.0),
                suppression_dwell: seconds(5.0),
                extinguishes_all: None,
                fire: None,
                relight: false,
                score_wumpus_ignited: 1.0,
                score_wumpus_burned_out: 1.0,
                score_truck_extinguished: 2.0,
            },
        };
        audit_timeline(&Timeline { setting, events }, |_| LIMITS, Step::default())
    }

    /// To a place south of the bush in 3 s, 5 s beside it, a drive that is dropped under way, another one.
    fn proper_run() -> Vec<Event> {
        let there = drive(1.0, start(), &[24.0]);
        let away = drive(9.0, there.end(), &[-16.0]);
        let cut = away.stopping(seconds(10.0), None);
        let on = drive(10.0, cut.end(), &[4.0, -6.0]);
        vec![planned(0.5, there), extinguished(9.0), planned(9.0, away), dropped(10.0, cut), planned(10.0, on)]
    }

    fn rule(events: Vec<Event>) -> RunRule {
        run(events).expect_err("the damage is planted").rule
    }

    #[test]
    fn a_proper_run_passes_and_all_of_it_is_looked_at() {
        let audited = run(proper_run()).expect("nothing is wrong with it");
        assert_eq!((audited.legs, audited.extinctions), (4, 1));
        assert!((audited.metres - (24.0 + 8.0 + 10.0)).abs() < 1e-6);
    }

    #[test]
    fn a_leg_that_begins_elsewhere_is_found() {
        let mut events = proper_run();
        let moved = Pose { y: start().y - 0.001, ..start() };
        events[0] = planned(0.5, drive(1.0, moved, &[24.0]));
        assert!(matches!(rule(events), RunRule::Discontinuous { .. }));
        let turned = Pose { heading: 0.001, ..start() };
        assert!(matches!(rule(vec![planned(0.5, drive(1.0, turned, &[24.0]))]), RunRule::Discontinuous { .. }));
    }

    #[test]
    fn a_leg_that_begins_too_early_is_found() {
        let mut events = proper_run();
        events.remove(3);
        assert!(matches!(rule(events), RunRule::StillUnderWay { .. }));
    }

    #[test]
    fn a_cut_leg_that_is_not_the_planned_one_is_found() {
        let mut events = proper_run();
        let there = drive(1.0, start(), &[24.0]);
        events[3] = dropped(10.0, drive(9.0, there.end(), &[-7.9]));
        assert_eq!(rule(events), RunRule::CutDiffers);
    }

    #[test]
    fn a_fire_that_goes_out_too_early_is_found() {
        let mut events = proper_run();
        events[1] = extinguished(8.999_999_999);
        assert!(matches!(rule(events), RunRule::NotStanding { cell: NEAR, .. }));
        let mut events = proper_run();
        events[1] = extinguished(3.0);
        assert!(matches!(rule(events), RunRule::NotStanding { cell: NEAR, .. }));
    }

    #[test]
    fn a_fire_that_goes_out_too_far_away_is_found() {
        let offence = run(vec![extinguished(50.0)]).expect_err("the truck never left its start");
        assert!(matches!(offence.rule, RunRule::OutOfReach { cell: NEAR, .. }));
        assert!(offence.to_string().starts_with("unimog/0, at 50.000 s: the fire at cell (10, 10)"), "{offence}");
    }

    #[test]
    fn the_last_leg_is_looked_at_too() {
        let mut events = proper_run();
        let end = events.len() - 1;
        let Fact::Planned { trajectory, .. } = &events[end].fact else { panic!("the run ends with a leg") };
        events[end] = planned(10.0, drive(10.0, trajectory.start(), &[70.0]));
        let RunRule::Leg(offence) = rule(events) else { panic!("the leg leaves the field") };
        assert!(offence.to_string().contains("outside of the field"));
    }

    #[test]
    fn an_unknown_truck_is_found() {
        let cell = NEAR;
        let events = vec![Event { time: seconds(1.0), fact: Fact::Extinguished { cell, by: AgentId::Unimog(7) } }];
        assert_eq!(rule(events), RunRule::UnknownTruck);
    }
}
