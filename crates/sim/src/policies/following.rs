//! The policies that the agents of a run follow, and the question that waits for an answer from outside.

use std::time::Duration;

use bevy_ecs::prelude::*;

use super::{AgentView, AskReport, Asking, Choice, Observation, OptionsOf, Policy};
use crate::run::{FailureMessages, PolicyTally};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::FireField;
use wildfire_planning::{PlanFailure, PlannerName};
use wildfire_timeline::AgentId;

/// The policy of the run that an agent follows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follows(usize);

/// A question to a policy, with what it may look at.
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

/// Agents that wait for an answer, and what they can see meanwhile.
#[derive(Debug)]
pub struct Question {
    pub asked: Vec<AgentId>,
    pub agents: Vec<AgentView>,
    /// The options of each asked agent, in the same order.
    pub options: Vec<Vec<Cell>>,
}

/// Counts and costs of questions to policies that are not built in.
#[derive(Debug, Default)]
pub struct OwnAsks {
    /// `None` where all policies are built in.
    pub tally: Option<PolicyTally>,
    pub messages: FailureMessages,
    /// CPU time, including that of other processes.
    pub cpu: Duration,
    pub elsewhere: Duration,
}

impl OwnAsks {
    fn add_cpu(&mut self, here: Duration, elsewhere: Duration) {
        self.cpu += here + elsewhere;
        self.elsewhere += elsewhere;
    }

    fn add(&mut self, name: &PlannerName, now: SimTime, report: AskReport) {
        let tally = self.tally.get_or_insert_default();
        tally.asked += 1;
        let who = format!("policy {name}");
        if let Some((reason, words)) = report.failure {
            match reason {
                PlanFailure::TimedOut => tally.timed_out += 1,
                PlanFailure::BadAnswer => tally.bad_answer += 1,
                _ => tally.crashed += 1,
            }
            self.messages.add(&who, now, reason, &words);
        }
        if let Some(words) = report.illegal {
            tally.illegal += 1;
            self.messages.add_words(&who, now, &format!("{ILLEGAL}: {words}"));
        }
    }
}

/// The reason of messages about answers that are none of the options.
pub const ILLEGAL: &str = "illegal";

/// A policy, and its name if it is not built in.
struct Followed {
    policy: Box<dyn Policy>,
    own: Option<PlannerName>,
}

/// The policies of a run, one for all agents of a name, and the question that waits for an answer from outside.
#[derive(Resource, Default)]
pub struct Following {
    policies: Vec<Followed>,
    of_agents: Vec<(AgentId, Follows)>,
    pub question: Option<Question>,
    /// Choices from outside that have not been carried out.
    pub answer: Vec<(AgentId, Choice)>,
    /// CPU time of the policies of teams.
    pub team_cpu: Duration,
    pub own: OwnAsks,
}

impl Following {
    pub fn add(&mut self, policy: Box<dyn Policy>) -> Follows {
        self.policies.push(Followed { policy, own: None });
        Follows(self.policies.len() - 1)
    }

    /// Adds a policy for these agents that is not built in, and what making it took.
    pub fn add_own(&mut self, agents: &[AgentId], name: &PlannerName, mut policy: Box<dyn Policy>, making: Duration) {
        self.own.tally.get_or_insert_default();
        self.own.add_cpu(making, policy.take_report().elsewhere);
        self.add_for(agents, policy);
        self.policies.last_mut().expect("it was just added").own = Some(name.clone());
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

    /// Returns how a policy is asked.
    pub fn asking(&self, policy: Follows) -> Asking {
        self.policies[policy.0].policy.asking()
    }

    /// Returns the simulated time that a policy's last choice costs.
    pub fn charge(&self, policy: Follows) -> SimTime {
        self.policies[policy.0].policy.charge()
    }

    /// Asks a policy, or takes the answer from outside. If the answer comes later, nothing is returned and the question
    /// is kept.
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
            let Followed { policy, own } = &mut self.policies[policy.0];
            let mut stopwatch = CpuStopwatch::start();
            choices = policy.choose(&seen, &ids);
            if let Some(name) = own {
                let mut report = policy.take_report();
                // The time of a team's policy is measured with what else its decision takes.
                let here = if policy.asking() == Asking::Each { stopwatch.lap() } else { Duration::ZERO };
                self.own.add_cpu(here, report.elsewhere);
                report.illegal = report.illegal.or(refuse_illegal(&mut choices, &by_name));
                self.own.add(name, now, report);
            }
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

/// Lets agents wait that were sent to what is no option of theirs; returns words about the first of them.
fn refuse_illegal(choices: &mut [(AgentId, Choice)], options: &OptionsByName<'_>) -> Option<String> {
    let mut words = None;
    for (agent, choice) in choices {
        if let Choice::Go(cell) = *choice
            && options.entity(*agent).is_some()
            && !options.list(*agent).contains(&cell)
        {
            *choice = Choice::Wait;
            words.get_or_insert_with(|| format!("{agent} cannot go for ({}, {})", cell.col, cell.row));
        }
    }
    words
}
