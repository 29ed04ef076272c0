//! Deadlocks: a truck cannot set out because others that will not leave by themselves stand in the way.
//!
//! Trucks that wait are served in the order of their numbers: all that stand on the way of the first drive aside, and it
//! sets out after them. So of two that face each other the one with the larger number gives way, and one that has nothing
//! to do gives way to all. Either all that are in the way can leave, or nobody moves and the next truck is served. Every
//! deadlock that is broken sends a truck on its way to a fire.

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;

use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_planning::collision::{MovingBody, first_conflict};
use wildfire_planning::traffic::find_yield_pose;
use wildfire_timeline::AgentId;

use super::queue::{AgentEvent, Wake};
use super::schedule::{Pass, SimSystems};
use super::traffic::{MARGIN_M, Reservation, Traffic};
use super::truck::{Fleet, Truck};

/// The plugin in which trucks that block one another find a way out.
#[derive(Debug)]
pub struct TrafficPlugin;

impl Plugin for TrafficPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, break_deadlocks.in_set(SimSystems::Traffic));
    }
}

/// Breaks the deadlocks of trucks that began to wait, or looked again without success, at this instant.
fn break_deadlocks(mut fleet: Fleet) {
    let mut waiting: Vec<(AgentId, Wake)> = Vec::new();
    while let Some(wake) = fleet.take(AgentEvent::Deadlock) {
        waiting.push((fleet.id_of(wake.agent), wake));
    }
    waiting.sort_by_key(|&(id, _)| id);
    for (_, wake) in waiting {
        // A truck that was served before may have sent it aside or woken it.
        let is_valid = fleet.trucks.one(wake.agent).0.revision == wake.revision;
        if is_valid && let Some(way_out) = DeadlockResolution::for_truck(&fleet, wake.agent) {
            way_out.execute(&mut fleet);
        }
    }
}

/// Who drives where, so that one truck can set out.
struct DeadlockResolution {
    first: Entity,
    leg: Trajectory,
    making_way: Vec<(Entity, Trajectory)>,
}

impl DeadlockResolution {
    /// Finds a way out for a truck; `None` if it is not blocked by trucks that stand idle, or one of them cannot leave.
    fn for_truck(fleet: &Fleet, first: Entity) -> Option<Self> {
        let now = fleet.now();
        let (_, truck) = fleet.trucks.one(first);
        let wanted = &truck.blocked.first()?.drive;
        // The drive it was blocked on, so nothing is planned again.
        let wish = truck.leg(&wanted.path, now + truck.charge(&wanted.effort));
        let mut reservations = fleet.reservations();
        let in_the_way: Vec<Entity> =
            Traffic::new(&reservations, first).standing_on(&truck.body, &wish).map(|other| other.entity).collect();
        // The largest number first: it is served last, so it has the least to lose.
        let places = (0..reservations.len()).rev().filter(|&place| in_the_way.contains(&reservations[place].entity));
        let places: Vec<usize> = places.collect();
        // Trucks that will leave by themselves are waited for.
        if places.is_empty() || !places.iter().all(|&place| reservations[place].is_idle) {
            return None;
        }
        let mut making_way = Vec::new();
        for place in places {
            let entity = reservations[place].entity;
            let (_, other) = fleet.trucks.one(entity);
            let passing = MovingBody { body: &truck.body, trajectory: &wish };
            let way = way_aside(other, &reservations, place, passing, now)?;
            // The next one to leave finds this one where it goes.
            reservations[place].set_leg(way.clone());
            making_way.push((entity, way));
        }
        // However long it takes: all others have left its way by then, or the search has failed.
        let leg = Traffic::new(&reservations, first).departure_within(SimTime::MAX, &truck.body, &wish).ok()?;
        Some(Self { first, leg, making_way })
    }

    fn execute(self, fleet: &mut Fleet) {
        let to = fleet.id_of(self.first);
        for (entity, way) in self.making_way {
            fleet.give_way(entity, to, way);
        }
        let (_, mut truck) = fleet.trucks.one_mut(self.first);
        // The first is the one that `for_truck` has looked at.
        let drive = std::mem::take(&mut truck.blocked).swap_remove(0).drive;
        fleet.set_out(self.first, drive, self.leg);
        // Who has moved aside may have been in the way of others as well.
        fleet.wake_blocked(self.first);
    }
}

/// Returns a leg of the truck at `place` to the nearest place that leaves the way of a passing one free.
fn way_aside(
    truck: &Truck,
    reservations: &[Reservation],
    place: usize,
    passing: MovingBody<'_>,
    now: SimTime,
) -> Option<Trajectory> {
    let reservation = &reservations[place];
    let traffic = Traffic::new(reservations, reservation.entity);
    // Others count as standing where they will end, as making way takes longer than they drive.
    let path = find_yield_pose(&traffic.with_others_standing(&truck.checker), reservation.leg().end(), |pose| {
        let stand = Trajectory::new(now, pose, Vec::new());
        let stand = MovingBody { body: &reservation.body, trajectory: &stand };
        first_conflict(passing, stand, now, MARGIN_M).is_none()
    })?;
    traffic.departure(&reservation.body, &truck.leg(&path, now)).ok()
}
