//! Deadlocks: a truck that cannot set out because others stand in the way which will not leave by themselves.
//!
//! Trucks that wait are served in the order of their numbers: all that stand on the way of the first drive aside, and it
//! sets out behind them. So of two that face each other the one with the larger number gives way, and whoever has
//! nothing to do gives way to everybody. Either all of them can, or nobody moves and the next one is served. Every
//! deadlock that is broken sends a truck on its way to a fire.

use bevy::prelude::Entity;

use crate::collision::{MovingBody, first_conflict};
use crate::planning::find_yield_pose;
use crate::sim::agenda::{Due, Rank};
use crate::sim::stage::Stage;
use crate::sim::truck::{self, Truck};
use crate::time::SimTime;
use crate::timeline::AgentId;
use crate::trajectory::Trajectory;
use crate::vehicle::Dimensions;

use super::{MARGIN_M, Reservation, Traffic};

/// Breaks the deadlocks of trucks that began to wait, or looked again in vain, at this instant.
pub fn break_deadlocks(mut stage: Stage) {
    let mut calls = Vec::new();
    while let Some(due) = stage.take(Rank::Standoff) {
        let Due::Standoff(call) = due else { unreachable!("ranks and events go together") };
        calls.push((stage.id_of(call.agent), call));
    }
    calls.sort_by_key(|&(id, _)| id);
    for (_, call) in calls {
        let is_valid = stage.agents.get(call.agent).expect("agents live for the whole run").0.revision == call.revision;
        if is_valid && let Some(plan) = Plan::for_truck(&stage, call.agent) {
            plan.carry_out(&mut stage);
        }
    }
}

/// Who drives where, so that one truck can set out.
struct Plan {
    first: Entity,
    leg: Trajectory,
    making_way: Vec<(Entity, Trajectory)>,
}

impl Plan {
    /// `None` where the truck is not blocked by trucks that stand idle, or one of them cannot leave.
    fn for_truck(stage: &Stage, first: Entity) -> Option<Self> {
        let now = stage.now();
        let truck = stage.truck(first);
        let wanted = &truck.blocked.first()?.drive;
        let wish = Trajectory::from_path(&wanted.path, now + truck.charge(&wanted.effort), truck.speed);
        let mut reservations = stage.reservations();
        let in_the_way = blocking(&reservations, first, truck, &wish)?;
        let mut making_way = Vec::new();
        for place in in_the_way {
            let entity = reservations[place].entity;
            let way = way_aside(stage.truck(entity), &reservations, place, (&truck.body, &wish), now)?;
            reservations[place].leg = way.clone();
            making_way.push((entity, way));
        }
        let leg = Traffic::new(&reservations, first).departure_within(SimTime::MAX, &truck.body, &wish).ok()?;
        Some(Self { first, leg, making_way })
    }

    fn carry_out(self, stage: &mut Stage) {
        let to = stage.id_of(self.first);
        for (entity, way) in self.making_way {
            stage.give_way(entity, to, way);
        }
        let now = stage.now();
        let (mut agent, _, truck) = stage.agents.get_mut(self.first).expect("agents live for the whole run");
        let mut truck = truck.expect("only trucks are blocked");
        let drive = std::mem::take(&mut truck.blocked).swap_remove(0).drive;
        truck::set_out((self.first, &mut agent, &mut truck), now, drive, self.leg, &mut stage.agenda, &mut stage.log);
        stage.call_blocked(self.first);
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
