//! Deadlocks: a truck that cannot set out because others stand in the way which will not leave by themselves.
//!
//! Trucks that wait are served in the order of their numbers: all that stand on the way of the first drive aside, and it
//! sets out behind them. So of two that face each other the one with the larger number gives way, and whoever has
//! nothing to do gives way to everybody. Either all of them can, or nobody moves and the next one is served. Every
//! deadlock that is broken sends a truck on its way to a fire.

use bevy::prelude::*;

use crate::collision::{MovingBody, first_conflict};
use crate::planning::find_yield_pose;
use crate::time::SimTime;
use crate::timeline::AgentId;
use crate::trajectory::Trajectory;
use crate::vehicle::Dimensions;

use super::queue::{AgentEvent, Wake};
use super::schedule::{Pass, SimSystems};
use super::traffic::{MARGIN_M, Reservation, Traffic};
use super::truck::{Fleet, Truck};

/// Trucks that block one another find a way.
#[derive(Debug)]
pub struct TrafficPlugin;

impl Plugin for TrafficPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, break_deadlocks.in_set(SimSystems::Traffic));
    }
}

/// Breaks the deadlocks of trucks that began to wait, or looked again in vain, at this instant.
fn break_deadlocks(mut fleet: Fleet) {
    let mut waiting: Vec<(AgentId, Wake)> = Vec::new();
    while let Some(wake) = fleet.take(AgentEvent::Standoff) {
        waiting.extend(fleet.id_of(wake.agent).map(|id| (id, wake)));
    }
    waiting.sort_by_key(|&(id, _)| id);
    for (_, wake) in waiting {
        let is_valid = fleet.trucks.get(wake.agent).is_ok_and(|(agent, _)| agent.revision == wake.revision);
        if is_valid && let Some(way_out) = WayOut::for_truck(&fleet, wake.agent) {
            way_out.carry_out(&mut fleet);
        }
    }
}

/// Who drives where, so that one truck can set out.
struct WayOut {
    first: Entity,
    leg: Trajectory,
    making_way: Vec<(Entity, Trajectory)>,
}

impl WayOut {
    /// `None` where the truck is not blocked by trucks that stand idle, or one of them cannot leave.
    fn for_truck(fleet: &Fleet, first: Entity) -> Option<Self> {
        let now = fleet.now();
        let (_, truck) = fleet.trucks.get(first).ok()?;
        let wanted = &truck.blocked.first()?.drive;
        let wish = Trajectory::from_path(&wanted.path, now + truck.charge(&wanted.effort), truck.speed);
        let mut reservations = fleet.reservations();
        let in_the_way = blocking(&reservations, first, truck, &wish)?;
        let mut making_way = Vec::new();
        for place in in_the_way {
            let entity = reservations[place].entity;
            let (_, other) = fleet.trucks.get(entity).ok()?;
            let way = way_aside(other, &reservations, place, (&truck.body, &wish), now)?;
            reservations[place].leg = way.clone();
            making_way.push((entity, way));
        }
        let leg = Traffic::new(&reservations, first).departure_within(SimTime::MAX, &truck.body, &wish).ok()?;
        Some(Self { first, leg, making_way })
    }

    fn carry_out(self, fleet: &mut Fleet) {
        let Some(to) = fleet.id_of(self.first) else { return };
        for (entity, way) in self.making_way {
            fleet.give_way(entity, to, way);
        }
        let Ok((_, mut truck)) = fleet.trucks.get_mut(self.first) else { return };
        let drive = std::mem::take(&mut truck.blocked).swap_remove(0).drive;
        fleet.set_out(self.first, drive, self.leg);
        fleet.wake_blocked(self.first);
    }
}

/// Places among the reservations of those that stand in the way of a leg, the largest number first; `None` if there are
/// none or one of them will leave by itself.
fn blocking(reservations: &[Reservation], first: Entity, truck: &Truck, wish: &Trajectory) -> Option<Vec<usize>> {
    let on_the_way: Vec<AgentId> =
        Traffic::new(reservations, first).on_the_way(&truck.body, wish).map(|o| o.id).collect();
    let places = (0..reservations.len()).rev().filter(|&place| on_the_way.contains(&reservations[place].id));
    let places: Vec<usize> = places.collect();
    (!places.is_empty() && places.iter().all(|&place| reservations[place].is_idle)).then_some(places)
}

/// A leg of the truck at `place` to the nearest place that leaves another's way free.
fn way_aside(
    truck: &Truck,
    reservations: &[Reservation],
    place: usize,
    (body, wish): (&Dimensions, &Trajectory),
    now: SimTime,
) -> Option<Trajectory> {
    let own = &reservations[place];
    let traffic = Traffic::new(reservations, own.entity);
    let crowd = traffic.crowd(&truck.checker);
    let leaves_free = |pose| {
        let stand = Trajectory::new(now, pose, Vec::new());
        let stand = MovingBody { body: &own.body, trajectory: &stand };
        first_conflict(MovingBody { body, trajectory: wish }, stand, now, MARGIN_M).is_none()
    };
    let path = find_yield_pose(&crowd, own.leg.end(), leaves_free)?;
    traffic.departure(&own.body, &Trajectory::from_path(&path, now, truck.speed)).ok()
}
