//! Ignition, spread, burn-out and extinction, and the agents that each of them calls.

use bevy::prelude::*;
use glam::DVec2;

use crate::fire::{FireEvent, FireField, Spread};
use crate::geometry::Cell;
use crate::scenario::IgnitionCells;
use crate::time::SimTime;
use crate::timeline::{AgentId, Cause, Fact, FireFact};

use super::agenda::{Call, Due, Rank};
use super::agent::Activity;
use super::stage::{Fires, Stage};
use super::wumpus;

/// The scenario's own ignitions.
#[derive(Resource, Debug)]
pub struct Ignitions {
    pub entries: Vec<(SimTime, IgnitionCells)>,
    /// All bushes in the order in which random ignitions take them.
    pub permutation: Vec<Cell>,
    /// How many are still to come.
    pub pending: usize,
}

/// A stop whose dwell ends now.
struct Stop {
    by: AgentId,
    goal: Cell,
    /// Where the truck's body centre is, and how far it reaches around it, if it puts out all in reach.
    reaches: Option<(DVec2, f64)>,
}

/// Dwells that end put fires out. All that end at one instant count, even if one of them takes another's fire.
pub fn extinguish(mut stage: Stage) {
    let mut stops = Vec::new();
    while let Some(due) = stage.take(Rank::Extinction) {
        let Due::Extinction(call) = due else { unreachable!("ranks and events go together") };
        stops.extend(end_stop(&mut stage, call));
    }
    let now = stage.now();
    for stop in stops {
        let mut put_out = vec![stop.goal];
        if let Some((centre, reach_m)) = stop.reaches {
            let in_reach = |cell: &Cell| (stage.frame.0.centre(*cell) - centre).length() <= reach_m;
            put_out.extend(stage.fires.field.burning().filter(|&cell| cell != stop.goal).filter(in_reach));
        }
        for cell in put_out {
            if stage.fires.field.is_burning(cell) {
                let change = stage.fires.field.extinguish(cell);
                stage.log.add(now, Fact::Fire(FireFact::Extinguished { cell, by: stop.by }));
                stage.follow(change);
                stage.release(cell);
            }
        }
    }
}

/// Ends a truck's dwell, if the call is not void, and asks it for a decision.
fn end_stop(stage: &mut Stage, call: Call) -> Option<Stop> {
    let now = stage.now();
    let (mut agent, _, truck) = stage.agents.get_mut(call.agent).expect("agents live for the whole run");
    if agent.revision != call.revision {
        return None;
    }
    let truck = truck.expect("only trucks extinguish");
    let goal = agent.goal.take().expect("a truck that suppresses has a goal");
    agent.activity = Activity::Idle;
    agent.reconsider(call.agent, now, &mut stage.agenda);
    let centre = truck.body.body_centre(agent.trajectory.end());
    Some(Stop { by: agent.id, goal, reaches: truck.extinguishes_all.then_some((centre, truck.reach_m)) })
}

/// Fires that burned long enough end.
pub fn burn_out(mut stage: Stage) {
    while let Some(due) = stage.take(Rank::BurnOut) {
        let Due::Fire(FireEvent::BurnOut { cell, episode }) = due else { unreachable!("ranks and events go together") };
        if stage.fires.field.goes_on(cell, episode) {
            let change = stage.fires.field.burn_out(cell);
            let now = stage.now();
            stage.log.add(now, Fact::Fire(FireFact::BurnedOut { cell }));
            stage.follow(change);
            stage.release(cell);
        }
    }
}

/// Fires that burned for the delay set on fire what is near.
pub fn spread(mut stage: Stage) {
    while let Some(due) = stage.take(Rank::Spread) {
        let Due::Fire(FireEvent::Arrival(arrival)) = due else { unreachable!("ranks and events go together") };
        let now = stage.now();
        let Fires { field, model } = &mut *stage.fires;
        let mut expected = Vec::new();
        let spread = model.arrive(field, now, arrival, &mut expected);
        stage.expect(expected);
        for Spread { cell, from } in spread {
            stage.ignite(cell, Cause::Spread(from));
        }
    }
}

/// Wumpuses light their goals, and the scenario its cells.
pub fn ignite(mut stage: Stage, mut scheduled: ResMut<Ignitions>) {
    while let Some(due) = stage.take(Rank::Ignition) {
        match due {
            Due::Scheduled(number) => {
                scheduled.pending -= 1;
                for cell in scheduled.cells(number, &stage.fires.field) {
                    stage.ignite(cell, Cause::Scheduled);
                }
            }
            Due::Lighting(call) => light(&mut stage, call.agent, call.revision),
            _ => unreachable!("ranks and events go together"),
        }
    }
}

fn light(stage: &mut Stage, entity: Entity, revision: u32) {
    let now = stage.now();
    let (mut agent, wumpus, _) = stage.agents.get_mut(entity).expect("agents live for the whole run");
    if agent.revision != revision {
        return;
    }
    let mut wumpus = wumpus.expect("only wumpuses light cells");
    wumpus::arrive(&mut wumpus);
    if wumpus.is_stuck {
        wumpus::give_up((entity, &mut agent, &mut wumpus), now, &mut stage.agenda, &mut stage.log);
        return;
    }
    let goal = agent.goal.take().expect("a Wumpus walks to a goal");
    let id = agent.id;
    agent.activity = Activity::Idle;
    agent.reconsider(entity, now, &mut stage.agenda);
    stage.ignite(goal, Cause::Lit(id));
}

impl Ignitions {
    /// The cells that an ignition lights: those it names, or the first of the permutation that can burn.
    fn cells(&self, number: usize, fires: &FireField) -> Vec<Cell> {
        match &self.entries[number].1 {
            IgnitionCells::Cells(cells) => cells.clone(),
            IgnitionCells::Random(count) => {
                self.permutation.iter().copied().filter(|&cell| fires.can_burn(cell)).take(*count as usize).collect()
            }
        }
    }
}
