//! Who goes where: policies, each for all agents that follow it.
//!
//! A [`Policy`] is asked about agents that are free, or that may think better of where they go, at one instant, and sees
//! the state of that instant. It may choose for all of them together, for some, whose choices are carried out before the
//! rest is asked again, or for nobody: then the world stands still until the choices are
//! [handed in](crate::sim::Simulation::answer). Planning and driving are not its business; when an agent fails to plan
//! its way to what was chosen, the policy is asked again without that option. Rules that know one agent at a time are
//! policies by [`OneByOne`].

mod largest_cluster;
mod nearest;
mod random_intact;

use std::fmt;

use bevy::prelude::*;
use glam::DVec2;

use crate::fire::FireField;
use crate::geometry::Cell;
use crate::scenario::{TruckGoal, WumpusGoal};
use crate::time::SimTime;
use crate::timeline::AgentId;

use largest_cluster::LargestCluster;
use nearest::{FarthestFromTruck, Nearest, Oldest};
use random_intact::RandomIntact;

/// What an agent is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// It goes for this cell, which is one of its options.
    Go(Cell),
    /// It stays where it is, or keeps its goal, until something wakes it.
    Wait,
}

/// An agent as policies see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgentView {
    pub id: AgentId,
    /// The middle of its body, in metres.
    pub place: DVec2,
}

/// What a policy may look at: the state at one instant.
pub struct Observation<'a> {
    pub now: SimTime,
    pub fires: &'a FireField,
    /// All agents of the run, by name.
    pub agents: &'a [AgentView],
    /// Lists the options of an agent that is asked.
    pub options_of: &'a dyn Fn(AgentId) -> Vec<Cell>,
}

impl fmt::Debug for Observation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observation").field("now", &self.now).field("agents", &self.agents).finish_non_exhaustive()
    }
}

impl Observation<'_> {
    /// Returns the cells that an agent who is asked may go for, by cell index: for a truck what burns, is not another
    /// truck's goal and is not known to be out of its reach; for a Wumpus what it can approach and light.
    pub fn options(&self, agent: AgentId) -> Vec<Cell> {
        (self.options_of)(agent)
    }
}

/// Chooses where agents go.
pub trait Policy: Send + Sync {
    /// Chooses for some or all of the agents that are `asked`, or for none if the answer comes later.
    fn choose(&mut self, seen: &Observation<'_>, asked: &[AgentId]) -> Vec<(AgentId, Choice)>;
}

/// Chooses for one agent at a time.
pub trait Rule: Send + Sync {
    /// Returns the best of its options, which come by cell index; `None` lets it wait.
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell>;
}

/// A rule for one agent as a policy: each agent chooses when those before it have acted.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne<R>(pub R);

impl<R: Rule> Policy for OneByOne<R> {
    fn choose(&mut self, seen: &Observation<'_>, asked: &[AgentId]) -> Vec<(AgentId, Choice)> {
        let first = asked.iter().find_map(|&id| seen.agents.iter().find(|agent| agent.id == id));
        let choice = first.map(|agent| {
            let best = self.0.best(seen, agent, &seen.options(agent.id));
            (agent.id, best.map_or(Choice::Wait, Choice::Go))
        });
        choice.into_iter().collect()
    }
}

/// The built-in policies, by what scenarios call them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    Truck(TruckGoal),
    Wumpus(WumpusGoal),
}

impl BuiltIn {
    /// Makes the policy for the field with these bushes in the run of a seed.
    pub fn make(self, bushes: &[Cell], seed: u64) -> Box<dyn Policy> {
        match self {
            Self::Truck(TruckGoal::NearestBurning) | Self::Wumpus(WumpusGoal::NearestIntact) => {
                Box::new(OneByOne(Nearest))
            }
            Self::Truck(TruckGoal::Oldest) => Box::new(OneByOne(Oldest)),
            Self::Truck(TruckGoal::LargestCluster) => Box::new(OneByOne(LargestCluster)),
            Self::Wumpus(WumpusGoal::RandomIntact) => Box::new(OneByOne(RandomIntact::new(bushes.to_vec(), seed))),
            Self::Wumpus(WumpusGoal::FarthestFromTruck) => Box::new(OneByOne(FarthestFromTruck)),
        }
    }
}

/// Which of the run's policies an agent follows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follows(usize);

/// What a policy is asked, and what it may look at.
pub struct Inquiry<'a> {
    pub now: SimTime,
    pub fires: &'a FireField,
    /// All agents of the run, in any order.
    pub agents: Vec<AgentView>,
    pub asked: Vec<(AgentId, Entity)>,
}

/// Agents that wait for an answer, and what there is to be seen meanwhile.
#[derive(Debug)]
pub struct Question {
    pub asked: Vec<AgentId>,
    pub agents: Vec<AgentView>,
    /// Of those that are asked, in the same order.
    pub options: Vec<Vec<Cell>>,
}

/// The policies of a run, and the question that waits for an answer from outside.
#[derive(Resource, Default)]
pub struct Policies {
    built_in: Vec<(BuiltIn, Follows)>,
    known: Vec<Box<dyn Policy>>,
    pub question: Option<Question>,
    /// Choices from outside that have not been carried out.
    pub answer: Vec<(AgentId, Choice)>,
}

impl Policies {
    pub fn add(&mut self, policy: Box<dyn Policy>) -> Follows {
        self.known.push(policy);
        Follows(self.known.len() - 1)
    }

    /// Returns the place of a built-in policy, and makes it if nobody followed it yet.
    pub fn follow(&mut self, built_in: BuiltIn, bushes: &[Cell], seed: u64) -> Follows {
        if let Some(&(_, follows)) = self.built_in.iter().find(|(known, _)| *known == built_in) {
            return follows;
        }
        let follows = self.add(built_in.make(bushes, seed));
        self.built_in.push((built_in, follows));
        follows
    }

    /// Asks a policy, or takes what was answered from outside. If the answer comes later nothing is returned, and the
    /// question is kept.
    pub fn ask(
        &mut self,
        policy: Follows,
        inquiry: Inquiry<'_>,
        options_of: &dyn Fn(Entity) -> Vec<Cell>,
    ) -> Vec<(Entity, Choice)> {
        let Inquiry { now, fires, mut agents, asked } = inquiry;
        agents.sort_by_key(|agent| agent.id);
        let entity_of = |id: AgentId| asked.iter().find(|&&(known, _)| known == id).map(|&(_, entity)| entity);
        let ids: Vec<AgentId> = asked.iter().map(|&(id, _)| id).collect();
        let mut choices = std::mem::take(&mut self.answer);
        if choices.is_empty() {
            let options_of = |id| entity_of(id).map_or(Vec::new(), options_of);
            let seen = Observation { now, fires, agents: &agents, options_of: &options_of };
            choices = self.known[policy.0].choose(&seen, &ids);
        }
        choices.retain(|(id, _)| ids.contains(id));
        if choices.is_empty() {
            let options = asked.iter().map(|&(_, entity)| options_of(entity)).collect();
            self.question = Some(Question { asked: ids, agents, options });
            return Vec::new();
        }
        choices.into_iter().filter_map(|(id, choice)| Some((entity_of(id)?, choice))).collect()
    }
}
