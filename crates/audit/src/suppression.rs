//! Who acts on bushes and on ground, and from where: fires go out beside a truck that stands, and Wumpuses light where they arrived.

use super::field::{Outline, UnitPose};
use super::tolerance::SAME_POSE;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_timeline::{
    AgentFact, AgentId, AgentStart, Cause, Event, Fact, FireFact, GroundEvent, GroundFact, Setting, Timeline,
    WaterRules,
};

/// An agent that comes to a stand where its last leg ends.
struct Actor {
    id: AgentId,
    outline: Outline,
    pose: Pose,
    stands_since: SimTime,
    /// When this truck's last fire went out.
    served: Option<SimTime>,
    /// The pieces of which a bush went out then, where they go out as a whole.
    served_pieces: Vec<u32>,
    /// The stops that its tank suffices for; `None` where water does not matter.
    stops_left: Option<u32>,
    /// Whether it has begun a stop where it stands, and put out nothing yet.
    stops_here: bool,
    /// When its tank is full, if it is being filled.
    refilled: SimTime,
}

/// Checks that every fire that went out had its truck standing within reach for the whole dwell, one dwell for each
/// stop, with water for it, and every bush that was lit a Wumpus that stood; returns the number of extinctions.
pub fn audit_acts(timeline: &Timeline) -> Result<u64, Violation> {
    let mut actors: Vec<Actor> =
        timeline.setting.agents.iter().map(|start| Actor::new(start, &timeline.setting)).collect();
    let mut extinctions = 0;
    let place = |cell| timeline.setting.frame.centre(cell);
    // Changes of ground by fire and crews are checked elsewhere.
    let mut ground = timeline.ground.iter().filter(|event| event.agent().is_some()).peekable();
    for event in &timeline.events {
        // A stop ends before its truck sets out again, at the same time.
        while let Some(event) = ground.next_if(|ground| ground.time <= event.time) {
            extinctions += u64::from(act_on_ground(&mut actors, &timeline.setting, event)?);
        }
        let Some(id) = event.fact.agent() else { continue };
        let Some(actor) = actors.iter_mut().find(|actor| actor.id == id) else {
            let place = event.fact.cell().map(place).unwrap_or_default();
            return Err(Violation { time: event.time, agent: Some(id), place, kind: ViolationKind::WrongAgent });
        };
        // Before the event, as following it moves the pose to the end of the leg.
        let position = actor.pose.position();
        let violation = |kind| Violation { time: event.time, agent: Some(id), place: position, kind };
        match event.fact {
            Fact::Fire(FireFact::Extinguished { cell, .. }) => {
                actor.extinguish(&timeline.setting, cell, event.time).map_err(violation)?;
                extinctions += 1;
            }
            Fact::Fire(FireFact::Ignited { cell, cause: Cause::Agent(_) }) => {
                actor.light(cell, event.time).map_err(violation)?;
            }
            _ => actor.follow(&timeline.setting, event).map_err(violation)?,
        }
    }
    // Stops may end after the last event.
    for event in ground {
        extinctions += u64::from(act_on_ground(&mut actors, &timeline.setting, event)?);
    }
    Ok(extinctions)
}

/// Checks what an agent did to ground; returns true if it put it out.
fn act_on_ground(actors: &mut [Actor], setting: &Setting, event: &GroundEvent) -> Result<bool, Violation> {
    let &GroundEvent { time, cell, fact } = event;
    let id = event.agent();
    let Some(actor) = actors.iter_mut().find(|actor| Some(actor.id) == id) else {
        let place = setting.frame.centre(cell);
        return Err(Violation { time, agent: id, place, kind: ViolationKind::WrongAgent });
    };
    let place = actor.pose.position();
    let acted = match fact {
        GroundFact::Ignited(_) => actor.light(cell, time),
        GroundFact::Extinguished { .. } => actor.extinguish(setting, cell, time),
        GroundFact::Wetted { .. } => actor.wet(setting, cell, time),
        GroundFact::Cleared { .. } => unreachable!("line is of no agent"),
    };
    acted.map_err(|kind| Violation { time, agent: id, place, kind })?;
    Ok(matches!(fact, GroundFact::Extinguished { .. }))
}

impl Actor {
    fn new(start: &AgentStart, setting: &Setting) -> Self {
        let outline = Outline::new(&start.body);
        let stands_since = SimTime::ZERO;
        let stops_left = setting.water.as_ref().map(|water| water.full_tank);
        let served = None;
        let served_pieces = Vec::new();
        let stops_here = false;
        let refilled = SimTime::ZERO;
        let pose = start.pose;
        Self { id: start.id, outline, pose, stands_since, served, served_pieces, stops_left, stops_here, refilled }
    }

    fn follow(&mut self, setting: &Setting, event: &Event) -> Result<(), ViolationKind> {
        if let Some(leg) = event.fact.trajectory() {
            if leg.start_time() < self.refilled {
                return Err(ViolationKind::WrongRefill { due: self.refilled });
            }
            (self.pose, self.stands_since, self.stops_here) = (leg.end(), leg.end_time(), false);
        }
        match (&event.fact, &setting.water) {
            (&Fact::Agent(_, AgentFact::Suppressing { water_units, .. }), Some(_)) => self.take_water(water_units),
            (&Fact::Agent(_, AgentFact::Refilling { until }), Some(water)) => self.refill(water, event.time, until),
            (Fact::Agent(_, AgentFact::Refilling { .. }), None) => Err(ViolationKind::WrongAgent),
            _ => Ok(()),
        }
    }

    /// A stop takes its water when it begins.
    fn take_water(&mut self, water_units: u32) -> Result<(), ViolationKind> {
        let left = self.stops_left.unwrap_or_default();
        self.stops_left = Some(left.checked_sub(water_units).ok_or(ViolationKind::EmptyTank)?);
        self.stops_here = true;
        Ok(())
    }

    fn refill(&mut self, water: &WaterRules, time: SimTime, until: SimTime) -> Result<(), ViolationKind> {
        let centre = self.outline.centre(UnitPose::new(self.pose));
        let metres = water.places.iter().map(|place| (*place - centre).length()).fold(f64::INFINITY, f64::min);
        if metres > water.reach_m + SAME_POSE || self.stands_since > time {
            return Err(ViolationKind::NoWater { metres, reach_m: water.reach_m });
        }
        let missing = water.full_tank - self.stops_left.unwrap_or_default();
        let span_ns = water.fill_per_stop.as_nanos().saturating_mul(missing.into());
        // A second refill begins when the first is over.
        let due = time.max(self.refilled) + SimTime::from_nanos(span_ns);
        (self.stops_left, self.refilled) = (Some(water.full_tank), due);
        if until == due { Ok(()) } else { Err(ViolationKind::WrongRefill { due }) }
    }

    fn light(&self, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        if !self.id.role.lights() {
            return Err(ViolationKind::WrongAgent);
        }
        if self.stands_since > time { Err(ViolationKind::IgnitedInPassing { cell }) } else { Ok(()) }
    }

    fn extinguish(&mut self, setting: &Setting, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        if !self.id.role.suppresses() {
            return Err(ViolationKind::WrongAgent);
        }
        let rules = &setting.rules;
        let piece = setting.piece(cell);
        // Pieces go out together at one instant only.
        if self.served != Some(time) {
            self.served_pieces.clear();
        }
        // With the first bush of a piece, which obeys all rules, the others go out wherever they are.
        if piece.is_some_and(|piece| self.served_pieces.contains(&piece)) {
            return Ok(());
        }
        // Recordings without this rule get the benefit of the doubt.
        if self.is_same_stop(rules.suppression_dwell, time) && rules.extinguishes_all == Some(false) {
            return Err(ViolationKind::SecondFire { cell });
        }
        self.check_dwell(rules.suppression_dwell, cell, time)?;
        let is_same_instant = self.served == Some(time);
        // A stop is used up at the instant at which it puts something out.
        if setting.water.is_some() && !is_same_instant && !std::mem::take(&mut self.stops_here) {
            return Err(ViolationKind::EmptyTank);
        }
        self.served = Some(time);
        self.served_pieces.extend(piece);
        match self.beyond_reach(setting, cell) {
            Some((metres, reach_m)) => Err(ViolationKind::OutOfReach { cell, metres, reach_m }),
            None => Ok(()),
        }
    }

    /// A stop that puts fires out wets what it reaches, at its end.
    fn wet(&self, setting: &Setting, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        if !self.id.role.suppresses() {
            return Err(ViolationKind::WrongAgent);
        }
        self.check_dwell(setting.rules.suppression_dwell, cell, time)?;
        match self.beyond_reach(setting, cell) {
            Some((metres, reach_m)) => Err(ViolationKind::WaterFromAfar { cell, metres, reach_m }),
            None => Ok(()),
        }
    }

    fn is_same_stop(&self, dwell: SimTime, time: SimTime) -> bool {
        // Without a dwell two stops may end at one instant, which then does not say whose it is.
        self.served == Some(time) && dwell > SimTime::ZERO
    }

    fn check_dwell(&self, dwell: SimTime, cell: Cell, time: SimTime) -> Result<(), ViolationKind> {
        let since = if self.is_same_stop(dwell, time) {
            self.stands_since
        } else {
            self.stands_since.max(self.served.unwrap_or_default())
        };
        if since + dwell > time { Err(ViolationKind::NotStanding { cell, since }) } else { Ok(()) }
    }

    /// Returns how far away a cell is that is beyond reach, and the reach.
    fn beyond_reach(&self, setting: &Setting, cell: Cell) -> Option<(f64, f64)> {
        let metres = (self.outline.centre(UnitPose::new(self.pose)) - setting.frame.centre(cell)).length();
        let reach_m = setting.rules.suppression_reach_m.filter(|reach_m| metres > reach_m + SAME_POSE)?;
        Some((metres, reach_m))
    }
}
