//! A truck's tank: the drive to water, and the refill.
//!
//! A truck whose tank does not suffice for a stop has nothing that it may go for, and drives to water by itself, whatever
//! its policy says. Its policy may send it there before.

use bevy_ecs::prelude::*;

use super::Fleet;
use super::decision::DecisionOutcome;
use crate::agent::Agent;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireField;
use wildfire_planning::GoalDisc;
use wildfire_timeline::RestReason;

/// Places with water that a truck tries in one decision. Each may take a search for a way.
const PLACES_TRIED: usize = 3;

/// A drive to water ends with the middle of the truck within this share of the reach.
const WELL_IN_REACH: f64 = 0.9;

impl Fleet<'_, '_> {
    /// Returns the portions of water that a burning cell takes.
    fn water_units(&self, cell: Cell) -> u32 {
        self.needs.as_ref().map_or(1, |needs| needs.water_units(cell))
    }

    /// Returns true if a truck has the water for a stop at a burning cell.
    pub fn has_water_for(&self, agent: &Agent, cell: Cell) -> bool {
        agent.stops_left.is_none_or(|left| self.water_units(cell) <= left)
    }

    /// Returns true if a truck has too little water for another stop, and a full tank would suffice.
    pub fn is_out_of_water(&self, entity: Entity, fires: &FireField) -> bool {
        match self.trucks.one(entity).0.stops_left {
            Some(0) => true,
            Some(left) if self.needs.is_some() => {
                self.min_water_units(entity, fires).is_some_and(|min| min > left && self.is_in_tank(entity, min))
            }
            _ => false,
        }
    }

    /// Returns true if not even a full tank suffices for any of the fires that a truck may go for.
    pub fn is_too_hot(&self, entity: Entity, fires: &FireField) -> bool {
        self.needs.is_some() && self.min_water_units(entity, fires).is_some_and(|min| !self.is_in_tank(entity, min))
    }

    fn min_water_units(&self, entity: Entity, fires: &FireField) -> Option<u32> {
        self.unclaimed(&[entity], fires).into_iter().map(|cell| self.water_units(cell)).min()
    }

    fn is_in_tank(&self, entity: Entity, water_units: u32) -> bool {
        self.trucks.one(entity).1.water.as_ref().is_none_or(|water| water_units <= water.full_tank)
    }

    /// Lets a standing truck fill its tank, or sends it to the nearest water that it finds a path to.
    pub fn refill(&mut self, entity: Entity, fires: &FireField) -> DecisionOutcome {
        let now = self.now();
        let (agent, truck) = self.trucks.one(entity);
        let (Some(water), Some(stops_left)) = (&truck.water, agent.stops_left) else {
            return DecisionOutcome::Stays(None);
        };
        if stops_left == water.full_tank {
            return DecisionOutcome::Stays(None);
        }
        let centre = agent.centre(now);
        if water.is_at_water(centre) {
            return DecisionOutcome::Refills(now + water.fill_time(stops_left));
        }
        let radius_m = WELL_IN_REACH * water.reach_m;
        let pose = agent.trajectory.start();
        let places = water.places_from(centre);
        let open = places.iter().filter(|&&place| truck.closed_until(pose, place, now).is_none());
        for place in open.take(PLACES_TRIED).copied().collect::<Vec<_>>() {
            match self.drive_to(entity, GoalDisc { centre: place, radius_m }, fires) {
                // No path, or others are in the way: the next place is tried.
                DecisionOutcome::Stays(_) => {}
                conclusion => return conclusion,
            }
        }
        // It tries again where others were in the way, and at once where it has not tried yet.
        let (_, truck) = self.trucks.one(entity);
        let tried_again = places.iter().map(|&place| truck.closed_until(pose, place, now).unwrap_or(now)).min();
        match tried_again.filter(|&until| until != SimTime::MAX) {
            Some(until) => DecisionOutcome::Stays(Some(until)),
            None => DecisionOutcome::Rests(RestReason::NoWater),
        }
    }
}
