//! A truck's tank: the drive to water, and the refill.
//!
//! A truck whose tank does not suffice for a stop has nothing that it may go for, and drives to water by itself, whatever
//! its policy says. Its policy may send it there before.

use bevy_ecs::prelude::*;

use super::Fleet;
use super::decision::Conclusion;
use wildfire_base::time::SimTime;
use wildfire_fire::FireField;
use wildfire_planning::GoalDisc;
use wildfire_timeline::RestReason;

/// Places with water that a truck tries in one decision. Each may take a search for a way.
const PLACES_TRIED: usize = 3;

/// A drive to water ends with the middle of the truck within this share of the reach.
const WELL_IN_REACH: f64 = 0.9;

impl Fleet<'_, '_> {
    /// Returns true if a truck has too little water for another stop.
    pub fn is_out_of_water(&self, entity: Entity) -> bool {
        self.trucks.one(entity).0.stops_left == Some(0)
    }

    /// Lets a standing truck fill its tank, or sends it to the nearest water that it finds a path to.
    pub fn refill(&mut self, entity: Entity, fires: &FireField) -> Conclusion {
        let now = self.now();
        let (agent, truck) = self.trucks.one(entity);
        let (Some(water), Some(stops_left)) = (&truck.water, agent.stops_left) else { return Conclusion::Stays(None) };
        if stops_left == water.full_tank {
            return Conclusion::Stays(None);
        }
        let centre = agent.centre(now);
        if water.is_at_water(centre) {
            return Conclusion::Refills(now + water.fill_time(stops_left));
        }
        let radius_m = WELL_IN_REACH * water.reach_m;
        let (pose, places) = (agent.trajectory.start(), water.places_from(centre));
        let open = places.iter().filter(|&&place| truck.closed_until(pose, place, now).is_none());
        for place in open.take(PLACES_TRIED).copied().collect::<Vec<_>>() {
            match self.drive_to(entity, GoalDisc { centre: place, radius_m }, fires) {
                Conclusion::Stays(_) => {}
                conclusion => return conclusion,
            }
        }
        // It tries again where others were in the way, and at once where it has not tried yet.
        let (_, truck) = self.trucks.one(entity);
        let tried_again = places.iter().map(|&place| truck.closed_until(pose, place, now).unwrap_or(now)).min();
        match tried_again.filter(|&until| until != SimTime::MAX) {
            Some(until) => Conclusion::Stays(Some(until)),
            None => Conclusion::Rests(RestReason::NoWater),
        }
    }
}
