//! What every system of an instant works on, and the changes that call other agents.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use glam::DVec2;

use crate::fire::{FireChange, FireEvent, FireField, FireModel};
use crate::geometry::{Cell, FieldFrame};
use crate::time::SimTime;
use crate::timeline::{AgentFact, AgentId, Cause, Fact, FireFact, RestReason};
use crate::trajectory::Trajectory;

use super::agenda::{Agenda, Due, Rank, SimClock};
use super::agent::{Activity, Agent, Ledger, Log, Roster};
use super::traffic::{Reservation, Traffic};
use super::truck::Truck;
use super::wumpus::{self, Wumpus};

/// The bushes, and the model by which they burn.
#[derive(Resource, Debug)]
pub struct Fires {
    pub field: FireField,
    pub model: Box<dyn FireModel>,
}

/// The field's cells in the stage.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Frame(pub FieldFrame);

type Agents<'w, 's> = Query<'w, 's, (&'static mut Agent, Option<&'static mut Wumpus>, Option<&'static mut Truck>)>;

/// The world as a system of one instant sees it.
#[derive(SystemParam)]
pub struct Stage<'w, 's> {
    pub clock: Res<'w, SimClock>,
    pub agenda: ResMut<'w, Agenda>,
    pub log: ResMut<'w, Log>,
    pub ledger: ResMut<'w, Ledger>,
    pub fires: ResMut<'w, Fires>,
    pub frame: Res<'w, Frame>,
    pub roster: Res<'w, Roster>,
    pub agents: Agents<'w, 's>,
}

impl Stage<'_, '_> {
    pub fn now(&self) -> SimTime {
        self.clock.0
    }

    pub fn take(&mut self, rank: Rank) -> Option<Due> {
        self.agenda.take(self.clock.0, rank)
    }

    pub fn goal_of(&self, entity: Entity) -> Option<Cell> {
        self.agents.get(entity).expect("agents live for the whole run").0.goal
    }

    /// Goals and body centres of the trucks besides this agent.
    pub fn other_trucks(&self, except: Entity) -> (Vec<Cell>, Vec<DVec2>) {
        let (mut goals, mut centres) = (Vec::new(), Vec::new());
        for &entity in self.roster.trucks.iter().filter(|&&entity| entity != except) {
            let (agent, _, truck) = self.agents.get(entity).expect("the roster lists living agents");
            let body = truck.expect("the roster knows its trucks").body;
            goals.extend(agent.goal);
            centres.push(body.body_centre(agent.trajectory.pose_at(self.now())));
        }
        (goals, centres)
    }

    pub fn id_of(&self, entity: Entity) -> AgentId {
        self.agents.get(entity).expect("agents live for the whole run").0.id
    }

    pub fn truck(&self, entity: Entity) -> &Truck {
        self.agents.get(entity).expect("agents live for the whole run").2.expect("it is a truck's")
    }

    /// Where all trucks are and will be; of a truck alone nothing, for nobody is there whom it concerns.
    pub fn reservations(&self) -> Vec<Reservation> {
        let trucks = if self.roster.trucks.len() > 1 { &self.roster.trucks[..] } else { &[] };
        let reservation = |&entity: &Entity| {
            let (agent, _, truck) = self.agents.get(entity).expect("the roster lists living agents");
            let truck = truck.expect("the roster knows its trucks");
            let is_idle = agent.activity == Activity::Idle && (agent.rests.is_some() || truck.is_blocked());
            Reservation { entity, id: agent.id, body: truck.body, leg: agent.trajectory.clone(), is_idle }
        };
        trucks.iter().map(reservation).collect()
    }

    /// A fire has become free: trucks that rest or are blocked look again.
    pub fn call_resting(&mut self, except: Entity) {
        self.call_trucks_that(except, |agent, truck| agent.rests.is_some() || truck.is_blocked());
    }

    /// A truck has changed its way, or stands for longer: those that are blocked look again.
    pub fn call_blocked(&mut self, except: Entity) {
        self.call_trucks_that(except, |_, truck| truck.is_blocked());
    }

    fn call_trucks_that(&mut self, except: Entity, are_called: impl Fn(&Agent, &Truck) -> bool) {
        let now = self.now();
        for &entity in self.roster.trucks.iter().filter(|&&entity| entity != except) {
            let (mut agent, _, truck) = self.agents.get_mut(entity).expect("the roster lists living agents");
            if are_called(&agent, &truck.expect("the roster knows its trucks")) {
                agent.reconsider(entity, now, &mut self.agenda);
            }
        }
    }

    /// A truck without a goal drives aside for another one.
    pub fn give_way(&mut self, entity: Entity, to: AgentId, way: Trajectory) {
        let now = self.now();
        let (mut agent, _, truck) = self.agents.get_mut(entity).expect("agents live for the whole run");
        let mut truck = truck.expect("only trucks are in the way");
        truck.blocked.clear();
        self.log.add(now, Fact::Agent(agent.id, AgentFact::GaveWay { to, trajectory: way.clone() }));
        agent.rests = None;
        agent.activity = Activity::Moving;
        agent.trajectory = way;
        let arrives = agent.trajectory.end_time();
        agent.reconsider(entity, arrives, &mut self.agenda);
    }

    /// A truck drops its goal and stops where it is in nobody's way.
    fn break_off(&mut self, entity: Entity) {
        let (now, reservations) = (self.now(), self.reservations());
        let (mut agent, _, truck) = self.agents.get_mut(entity).expect("agents live for the whole run");
        let truck = truck.expect("the roster knows its trucks");
        let traffic = Traffic::new(&reservations, entity);
        let cut = traffic.stopping(&truck.body, &agent.trajectory, now, truck.speed.braking_mps2);
        agent.break_off(entity, now, cut, &mut self.agenda, &mut self.log);
        self.call_blocked(entity);
    }

    /// Sets a cell on fire, if it can burn, and calls whom it concerns.
    pub fn ignite(&mut self, cell: Cell, cause: Cause) {
        let now = self.now();
        let lit = !matches!(cause, Cause::Spread(_));
        let Some(change) = self.fires.field.ignite(cell, now, lit) else { return };
        self.log.add(now, Fact::Fire(FireFact::Ignited { cell, cause }));
        self.follow(change);
        self.drop_goals_of_wumpuses(cell);
        self.call_trucks();
    }

    /// Lets the model of the fire forecast what follows from a change.
    pub fn follow(&mut self, change: FireChange) {
        let Fires { field, model } = &mut *self.fires;
        let mut expected = Vec::new();
        model.follow(field, self.clock.0, change, &mut expected);
        self.expect(expected);
    }

    pub fn expect(&mut self, expected: Vec<(SimTime, FireEvent)>) {
        for (time, event) in expected {
            self.agenda.add(time, Due::Fire(event));
        }
    }

    fn drop_goals_of_wumpuses(&mut self, cell: Cell) {
        let now = self.now();
        for &entity in &self.roster.wumpuses {
            let (mut agent, wumpus, _) = self.agents.get_mut(entity).expect("the roster lists living agents");
            let mut wumpus = wumpus.expect("the roster knows its wumpuses");
            if agent.goal == Some(cell) && !wumpus.keeps_goal {
                wumpus::drop_goal((entity, &mut agent, &mut wumpus), now, &mut self.agenda, &mut self.log);
            }
        }
    }

    /// Something ignited: trucks that rest look again, and so do those that reconsider on their way.
    fn call_trucks(&mut self) {
        let now = self.now();
        for &entity in &self.roster.trucks {
            let (mut agent, _, truck) = self.agents.get_mut(entity).expect("the roster lists living agents");
            let on_the_way = matches!(agent.activity, Activity::Moving | Activity::Planning) && agent.goal.is_some();
            if agent.activity == Activity::Idle {
                agent.reconsider(entity, now, &mut self.agenda);
            } else if on_the_way && truck.expect("the roster knows its trucks").retargets {
                self.agenda.add(now, Due::Decision(agent.call(entity)));
            }
        }
    }

    /// A fire is over: trucks that were after it decide anew, and a Wumpus that rests may find it fit to burn again.
    pub fn release(&mut self, cell: Cell) {
        let now = self.now();
        for place in 0..self.roster.trucks.len() {
            let entity = self.roster.trucks[place];
            let (mut agent, _, truck) = self.agents.get_mut(entity).expect("the roster lists living agents");
            let is_blocked = truck.is_some_and(|truck| truck.is_blocked());
            if agent.goal == Some(cell) && agent.activity == Activity::Suppressing {
                self.log.add(now, Fact::Agent(agent.id, AgentFact::SuppressionEnded { cell }));
                agent.goal = None;
                agent.activity = Activity::Idle;
                agent.reconsider(entity, now, &mut self.agenda);
            } else if agent.goal == Some(cell) {
                self.break_off(entity);
            } else if is_blocked {
                agent.reconsider(entity, now, &mut self.agenda);
            }
        }
        if self.fires.field.can_burn(cell) {
            self.call_resting_wumpuses(cell);
        }
    }

    /// A cell can be lit again: Wumpuses that rest look again, but for those that know that they fail to approach it.
    fn call_resting_wumpuses(&mut self, cell: Cell) {
        let now = self.now();
        for &entity in &self.roster.wumpuses {
            let (mut agent, wumpus, _) = self.agents.get_mut(entity).expect("the roster lists living agents");
            let has_failed = wumpus.expect("the roster knows its wumpuses").has_failed(cell);
            if agent.rests.is_some_and(|why| why != RestReason::LocalMinima || !has_failed) {
                agent.reconsider(entity, now, &mut self.agenda);
            }
        }
    }
}
