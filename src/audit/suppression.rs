//! Who acts on bushes, and from where: fires go out beside a truck that stands, and Wumpuses light where they arrived.

use super::field::{Outline, Stance};
use super::tolerance::SAME_POSE;
use super::{Violation, ViolationKind};
use crate::geometry::{Cell, Pose};
use crate::time::SimTime;
use crate::timeline::{AgentId, AgentStart, Cause, Event, Fact, FireFact, Setting, Timeline};

/// An agent that comes to a stand where its last leg ends.
struct Actor {
    id: AgentId,
    outline: Outline,
    pose: Pose,
    stands_since: SimTime,
    /// When this truck's last fire went out.
    served: Option<SimTime>,
}

/// Checks that every fire that went out had its truck standing within reach for the whole dwell, one dwell for each
/// stop, and every bush that was lit a Wumpus that stood; returns the number of extinctions.
pub fn audit_acts(timeline: &Timeline) -> Result<u64, Violation> {
    let mut actors: Vec<Actor> = timeline.setting.agents.iter().map(Actor::new).collect();
    let mut extinctions = 0;
    for event in &timeline.events {
        let Some(id) = event.fact.agent() else { continue };
        let place = |cell| timeline.setting.frame.centre(cell);
        let Some(actor) = actors.iter_mut().find(|actor| actor.id == id) else {
            let place = event.fact.cell().map(place).unwrap_or_default();
            return Err(Violation { time: event.time, agent: Some(id), place, kind: ViolationKind::WrongAgent });
        };
        let position = actor.pose.position();
        let violation = |kind| Violation { time: event.time, agent: Some(id), place: position, kind };
        match event.fact {
            Fact::Fire(FireFact::Extinguished { cell, .. }) => {
                actor.extinguish(&timeline.setting, cell, event.time).map_err(violation)?;
                extinctions += 1;
            }
            Fact::Fire(FireFact::Ignited { cell, cause: Cause::Lit(_) }) => {
                actor.light(cell, event.time).map_err(violation)?;
            }
            _ => actor.follow(event),
        }
    }
    Ok(extinctions)
}

impl Actor {
    fn new(start: &AgentStart) -> Self {
        let (outline, stands_since) = (Outline::new(&start.body), SimTime::ZERO);
        Self { id: start.id, outline, pose: start.pose, stands_since, served: None }
    }

    fn follow(&mut self, event: &Event) {
        if let Some(leg) = event.fact.trajectory() {
            (self.pose, self.stands_since) = (leg.end(), leg.end_time());
        }
    }

    fn light(&self, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        if !self.id.role.lights() {
            return Err(ViolationKind::WrongAgent);
        }
        if self.stands_since > time { Err(ViolationKind::LitInPassing { cell }) } else { Ok(()) }
    }

    fn extinguish(&mut self, setting: &Setting, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        if !self.id.role.suppresses() {
            return Err(ViolationKind::WrongAgent);
        }
        let (rules, dwell) = (&setting.rules, setting.rules.suppression_dwell);
        let is_same_stop = self.served == Some(time) && dwell > SimTime::ZERO;
        if is_same_stop && rules.extinguishes_all == Some(false) {
            return Err(ViolationKind::SecondFire { cell });
        }
        let since =
            if is_same_stop { self.stands_since } else { self.stands_since.max(self.served.unwrap_or_default()) };
        if since + dwell > time {
            return Err(ViolationKind::NotStanding { cell, since });
        }
        self.served = Some(time);
        let metres = (self.outline.centre(Stance::new(self.pose)) - setting.frame.centre(cell)).length();
        let is_within = |reach_m: f64| metres <= reach_m + SAME_POSE;
        match rules.suppression_reach_m {
            Some(reach_m) if !is_within(reach_m) => Err(ViolationKind::OutOfReach { cell, metres, reach_m }),
            _ => Ok(()),
        }
    }
}
