//! The part of the field that a team sees.

use glam::DVec2;

use crate::policies::AgentView;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::{BushState, FireField};
use wildfire_scenario::{Sight, SightOfField};

/// The knowledge of a team about the field at one instant, by the scenario's `[sight]`.
pub struct TeamSight<'a> {
    sight: &'a Sight,
    frame: &'a FieldFrame,
    now: SimTime,
    fires: &'a FireField,
    /// The middles of the trucks.
    eyes: Vec<DVec2>,
}

impl<'a> TeamSight<'a> {
    pub fn new(
        sight: &'a Sight,
        frame: &'a FieldFrame,
        now: SimTime,
        fires: &'a FireField,
        agents: &[AgentView],
    ) -> Self {
        let trucks = agents.iter().filter(|agent| agent.id.role.suppresses());
        Self { sight, frame, now, fires, eyes: trucks.map(|truck| truck.place).collect() }
    }

    pub fn sees(&self, place: DVec2) -> bool {
        let Sight { field, radius_m, .. } = *self.sight;
        field != SightOfField::Radius
            || self.eyes.iter().any(|eye| (place - *eye).length_squared() <= radius_m * radius_m)
    }

    /// Returns true if the team sees an agent at a place: trucks know each other, a Wumpus is seen if the scenario says so.
    pub fn sees_agent(&self, agent: &AgentView) -> bool {
        !agent.id.role.lights() || self.sight.wumpuses && self.sees(agent.place)
    }

    /// Returns when a burning cell is reported.
    fn reported_at(&self, cell: Cell) -> Option<SimTime> {
        let Some(BushState::Burning { since }) = self.fires.state(cell) else { return None };
        self.sight.report_s.map(|report_s| since + SimTime::from_seconds(report_s))
    }

    /// Returns whether the state of a cell is seen, or reported.
    pub fn knows(&self, cell: Cell) -> bool {
        self.sees(self.frame.centre(cell)) || self.reported_at(cell).is_some_and(|time| time <= self.now)
    }

    /// Returns the time of the next report of a fire that is not known yet.
    pub fn next_report(&self) -> Option<SimTime> {
        let unknown = self.fires.burning().filter(|&cell| !self.knows(cell));
        unknown.filter_map(|cell| self.reported_at(cell)).min()
    }

    /// Returns whether the team takes a bush for intact.
    pub fn takes_for_intact(&self, cell: Cell) -> bool {
        if !self.fires.is_bush(cell) {
            return false;
        }
        match self.sight.field {
            SightOfField::Everything => self.fires.can_burn(cell),
            SightOfField::Burning => !self.fires.is_burning(cell),
            // Of what is out of sight there is the map.
            SightOfField::Radius => !self.knows(cell) || self.fires.can_burn(cell),
        }
    }
}
