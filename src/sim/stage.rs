//! What every system of an instant works on, and the changes that call other agents.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use glam::DVec2;

use crate::fire::Vegetation;
use crate::geometry::{Cell, FieldFrame};
use crate::time::SimTime;
use crate::timeline::{Cause, Fact, RestReason};
use crate::trajectory::Trajectory;

use super::agenda::{Agenda, Due, Rank, SimClock};
use super::agent::{Activity, Agent, Log, Roster};
use super::truck::Truck;
use super::wumpus::{self, Wumpus};

/// The vegetation.
#[derive(Resource, Debug)]
pub struct Fires(pub Vegetation);

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

    /// A fire has become free: trucks that rest look again.
    pub fn call_resting(&mut self, except: Entity) {
        let now = self.now();
        for &entity in self.roster.trucks.iter().filter(|&&entity| entity != except) {
            let (mut agent, ..) = self.agents.get_mut(entity).expect("the roster lists living agents");
            if agent.rests.is_some() {
                agent.reconsider(entity, now, &mut self.agenda);
            }
        }
    }

    /// Sets a cell on fire, if it can burn, and calls whom it concerns.
    pub fn ignite(&mut self, cell: Cell, cause: Cause) {
        let now = self.now();
        let lit = !matches!(cause, Cause::Spread(_));
        let Some(burn) = self.fires.0.ignite(cell, now, lit) else { return };
        self.log.add(now, Fact::Ignited { cell, cause });
        if let Some(time) = burn.spreads_at {
            self.agenda.add(time, Due::Spread { cell, episode: burn.episode });
        }
        if let Some(time) = burn.burns_out_at {
            self.agenda.add(time, Due::BurnOut { cell, episode: burn.episode });
        }
        self.drop_goals_of_wumpuses(cell);
        self.call_trucks();
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
        for &entity in &self.roster.trucks {
            let (mut agent, _, truck) = self.agents.get_mut(entity).expect("the roster lists living agents");
            if agent.goal == Some(cell) {
                let truck = truck.expect("the roster knows its trucks");
                match agent.activity {
                    Activity::Suppressing => {
                        self.log.add(now, Fact::SuppressionEnded { agent: agent.id, cell });
                        agent.goal = None;
                        agent.activity = Activity::Idle;
                        agent.reconsider(entity, now, &mut self.agenda);
                    }
                    Activity::Moving => {
                        let cut = agent.trajectory.stopping(now, truck.speed.braking_mps2);
                        agent.break_off(entity, now, cut, &mut self.agenda, &mut self.log);
                    }
                    Activity::Planning | Activity::Idle => {
                        let stand = Trajectory::new(now, agent.trajectory.start(), Vec::new());
                        agent.break_off(entity, now, stand, &mut self.agenda, &mut self.log);
                    }
                }
            }
        }
        if self.fires.0.can_burn(cell) {
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
