//! Whom the agents of one run follow, and the question that waits for an answer from outside.

use std::time::Duration;

use bevy::prelude::*;

use super::{AgentView, Asking, Choice, Observation, OptionsOf, Policy};
use crate::fire::FireField;
use crate::geometry::Cell;
use crate::time::SimTime;
use crate::timeline::AgentId;

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

/// The options of those who are asked, for policies, who know agents by their names.
struct OptionsByName<'a> {
    asked: &'a [(AgentId, Entity)],
    options_of: &'a dyn OptionsOf<Entity>,
}

impl OptionsByName<'_> {
    fn entity(&self, agent: AgentId) -> Option<Entity> {
        self.asked.iter().find(|&&(known, _)| known == agent).map(|&(_, entity)| entity)
    }
}

impl OptionsOf<AgentId> for OptionsByName<'_> {
    fn list(&self, agent: AgentId) -> Vec<Cell> {
        self.entity(agent).map_or(Vec::new(), |entity| self.options_of.list(entity))
    }

    fn contains(&self, agent: AgentId, cell: Cell) -> bool {
        self.entity(agent).is_some_and(|entity| self.options_of.contains(entity, cell))
    }
}

/// Agents that wait for an answer, and what there is to be seen meanwhile.
#[derive(Debug)]
pub struct Question {
    pub asked: Vec<AgentId>,
    pub agents: Vec<AgentView>,
    /// Of those that are asked, in the same order.
    pub options: Vec<Vec<Cell>>,
}

/// The policies of a run, one for all agents of a name, and the question that waits for an answer from outside.
#[derive(Resource, Default)]
pub struct Following {
    policies: Vec<Box<dyn Policy>>,
    of_agents: Vec<(AgentId, Follows)>,
    pub question: Option<Question>,
    /// Choices from outside that have not been carried out.
    pub answer: Vec<(AgentId, Choice)>,
    /// CPU time of the policies of teams.
    pub team_cpu: Duration,
}

impl Following {
    pub fn add(&mut self, policy: Box<dyn Policy>) -> Follows {
        self.policies.push(policy);
        Follows(self.policies.len() - 1)
    }

    /// Adds a policy for these agents.
    pub fn add_for(&mut self, agents: &[AgentId], policy: Box<dyn Policy>) {
        let follows = self.add(policy);
        self.of_agents.extend(agents.iter().map(|&agent| (agent, follows)));
    }

    /// Returns the policy of an agent at the start of the run.
    pub fn policy_of(&self, agent: AgentId) -> Follows {
        let of_agent = self.of_agents.iter().find(|&&(known, _)| known == agent);
        of_agent.expect("policies are made for all agents before these").1
    }

    /// Says whom a policy is asked about.
    pub fn asking(&self, policy: Follows) -> Asking {
        self.policies[policy.0].asking()
    }

    /// Returns the simulated time that a policy's last choice costs.
    pub fn charge(&self, policy: Follows) -> SimTime {
        self.policies[policy.0].charge()
    }

    /// Asks a policy, or takes what was answered from outside. If the answer comes later nothing is returned, and the
    /// question is kept.
    pub fn ask(
        &mut self,
        policy: Follows,
        inquiry: Inquiry<'_>,
        options_of: &dyn OptionsOf<Entity>,
    ) -> Vec<(Entity, Choice)> {
        let Inquiry { now, fires, mut agents, asked } = inquiry;
        agents.sort_by_key(|agent| agent.id);
        let entity_of = |id: AgentId| asked.iter().find(|&&(known, _)| known == id).map(|&(_, entity)| entity);
        let ids: Vec<AgentId> = asked.iter().map(|&(id, _)| id).collect();
        let mut choices = std::mem::take(&mut self.answer);
        if choices.is_empty() {
            let by_name = OptionsByName { asked: &asked, options_of };
            let seen = Observation { now, fires, agents: &agents, options_of: &by_name };
            choices = self.policies[policy.0].choose(&seen, &ids);
        }
        choices.retain(|(id, _)| ids.contains(id));
        if choices.is_empty() {
            let options = asked.iter().map(|&(_, entity)| options_of.list(entity)).collect();
            self.question = Some(Question { asked: ids, agents, options });
            return Vec::new();
        }
        choices.into_iter().filter_map(|(id, choice)| Some((entity_of(id)?, choice))).collect()
    }
}
