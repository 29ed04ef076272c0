//! The policies that the agents of a run follow, and the question that waits for an answer from outside.

use std::time::Duration;

use bevy_ecs::prelude::*;

use super::{Action, ActionMask, AgentView, FirelineContext, Observation, Policy, PolicyScope, QueryReport};
use crate::run::{FailureMessages, PolicyTally};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::FireField;
use wildfire_planning::{PlanFailure, PlannerName};
use wildfire_timeline::AgentId;

/// The policy of the run that an agent follows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolicyId(usize);

/// A question to a policy, with what it may look at.
pub struct PolicyQuery<'a> {
    pub now: SimTime,
    pub fires: &'a FireField,
    /// All agents of the run, in any order.
    pub agents: Vec<AgentView>,
    pub queried: Vec<(AgentId, Entity)>,
}

/// The options of those who are asked, for policies, who know agents by their names.
struct OptionsByName<'a> {
    queried: &'a [(AgentId, Entity)],
    options_of: &'a dyn ActionMask<Entity>,
}

impl OptionsByName<'_> {
    fn entity(&self, agent: AgentId) -> Option<Entity> {
        self.queried.iter().find(|&&(id, _)| id == agent).map(|&(_, entity)| entity)
    }
}

impl ActionMask<AgentId> for OptionsByName<'_> {
    fn list(&self, agent: AgentId) -> Vec<Cell> {
        self.entity(agent).map_or(Vec::new(), |entity| self.options_of.list(entity))
    }

    fn contains(&self, agent: AgentId, cell: Cell) -> bool {
        self.entity(agent).is_some_and(|entity| self.options_of.contains(entity, cell))
    }
}

/// Agents that wait for an answer, and what they can see meanwhile.
#[derive(Clone, Debug)]
pub struct PendingDecision {
    pub queried: Vec<AgentId>,
    pub agents: Vec<AgentView>,
    /// The options of each asked agent, in the same order.
    pub options: Vec<Vec<Cell>>,
}

/// Counts and costs of questions to policies that are not built in.
#[derive(Clone, Debug, Default)]
pub struct CustomPolicyStats {
    /// `None` where all policies are built in.
    pub tally: Option<PolicyTally>,
    pub messages: FailureMessages,
    /// CPU time, including that of other processes.
    pub cpu: Duration,
    pub elsewhere: Duration,
}

impl CustomPolicyStats {
    fn add_cpu(&mut self, here: Duration, elsewhere: Duration) {
        self.cpu += here + elsewhere;
        self.elsewhere += elsewhere;
    }

    /// Adds a message about an answer that nobody could carry out.
    fn add_illegal(&mut self, name: &PlannerName, now: SimTime, message: &str) {
        self.tally.get_or_insert_default().illegal += 1;
        self.messages.add_text(&format!("policy {name}"), now, &format!("{ILLEGAL}: {message}"));
    }

    fn add(&mut self, name: &PlannerName, now: SimTime, report: QueryReport) {
        let tally = self.tally.get_or_insert_default();
        tally.asked += 1;
        let who = format!("policy {name}");
        if let Some((reason, message)) = report.failure {
            match reason {
                PlanFailure::TimedOut => tally.timed_out += 1,
                PlanFailure::BadAnswer => tally.bad_answer += 1,
                _ => tally.crashed += 1,
            }
            self.messages.add(&who, now, reason, &message);
        }
        if let Some(message) = report.illegal {
            self.add_illegal(name, now, &message);
        }
    }
}

/// The reason of messages about answers that an agent cannot carry out.
pub const ILLEGAL: &str = "illegal";

/// A policy, and its name if it is not built in.
struct PolicyEntry {
    policy: Box<dyn Policy>,
    custom_name: Option<PlannerName>,
}

/// A choice that an agent gets instead of its policy's, from the instant at which it is asked next until it has set out
/// for it; at that instant its policy does not change its mind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActionOverride {
    agent: AgentId,
    choice: Action,
    /// The time at which the agent was asked first.
    queried_at: Option<SimTime>,
    /// The time at which it got the choice.
    pub applied_at: Option<SimTime>,
    is_over: bool,
}

impl ActionOverride {
    pub fn new(agent: AgentId, choice: Action) -> Self {
        Self { agent, choice, queried_at: None, applied_at: None, is_over: false }
    }

    /// Returns whether the agent, asked now with these options, gets the choice.
    fn applies(&mut self, agent: &AgentView, now: SimTime, options: &[Cell]) -> bool {
        let is_first_instant = *self.queried_at.get_or_insert(now) == now;
        let applies = match self.choice {
            Action::Go(cell) => {
                let has_set_out = self.applied_at.is_none() || agent.goal == Some(cell);
                options.contains(&cell) && (is_first_instant || !has_set_out)
            }
            // Waiting leaves no goal by which it could be seen to be carried out, so it is given once.
            _ => self.applied_at.is_none(),
        };
        self.is_over |= !applies && !is_first_instant;
        let applies = applies && !self.is_over;
        if applies {
            self.applied_at.get_or_insert(now);
        }
        applies
    }
}

/// A decision of an agent that had something to choose from.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    pub time: SimTime,
    pub agent: AgentView,
    /// By cell index.
    pub options: Vec<Cell>,
    /// The answer of its policy.
    pub choice: Action,
}

/// The policies of a run, one for all agents of a name, and the question that waits for an answer from outside.
#[derive(Resource, Default)]
pub struct PolicySet {
    policies: Vec<PolicyEntry>,
    of_agents: Vec<(AgentId, PolicyId)>,
    /// The policy that says where crews build line, if it is not built in.
    crews: Option<PolicyId>,
    pub question: Option<PendingDecision>,
    /// Choices from outside that have not been carried out.
    pub answer: Vec<(AgentId, Action)>,
    /// CPU time of the policies of teams.
    pub team_cpu: Duration,
    pub custom_stats: CustomPolicyStats,
    /// A choice that takes the place of the policy's.
    pub forced: Option<ActionOverride>,
    /// The decisions so far, if they are recorded.
    pub decisions: Option<Vec<Decision>>,
}

impl PolicySet {
    pub fn add(&mut self, policy: Box<dyn Policy>) -> PolicyId {
        self.policies.push(PolicyEntry { policy, custom_name: None });
        PolicyId(self.policies.len() - 1)
    }

    /// Adds a policy for these agents that is not built in, and what making it took.
    pub fn add_custom(
        &mut self,
        agents: &[AgentId],
        name: &PlannerName,
        mut policy: Box<dyn Policy>,
        making: Duration,
    ) {
        self.custom_stats.tally.get_or_insert_default();
        self.custom_stats.add_cpu(making, policy.take_report().elsewhere);
        self.add_for(agents, policy);
        self.policies.last_mut().expect("it was just added").custom_name = Some(name.clone());
    }

    /// Lets the policy that was added last say where crews build line.
    pub fn lead_crews(&mut self) {
        self.crews = self.policies.len().checked_sub(1).map(PolicyId);
    }

    /// Returns a copy in which everybody follows a copy of the same policy.
    ///
    /// # Errors
    /// The name of the first policy that cannot be copied.
    pub fn fork(&self) -> Result<Self, String> {
        let copy = |followed: &PolicyEntry| {
            let custom_name = followed.custom_name.clone();
            let name = custom_name.as_ref().map_or("that the program was given", PlannerName::name);
            let policy = followed.policy.fork().ok_or_else(|| name.to_owned())?;
            Ok::<_, String>(PolicyEntry { policy, custom_name })
        };
        Ok(Self {
            policies: self.policies.iter().map(copy).collect::<Result<_, _>>()?,
            of_agents: self.of_agents.clone(),
            crews: self.crews,
            question: self.question.clone(),
            answer: self.answer.clone(),
            team_cpu: self.team_cpu,
            custom_stats: self.custom_stats.clone(),
            forced: self.forced,
            decisions: self.decisions.clone(),
        })
    }

    /// Takes over the policies of another run, and returns what agents follow here that follow one of them there.
    pub fn adopt(&mut self, other: Self) -> impl Fn(PolicyId) -> PolicyId + use<> {
        let existing = self.policies.len();
        self.policies.extend(other.policies);
        self.custom_stats.tally = self.custom_stats.tally.or(other.custom_stats.tally);
        move |PolicyId(number)| PolicyId(existing + number)
    }

    /// Draws what policies leave to chance from now on by another seed.
    pub fn reseed(&mut self, seed: u64) {
        for PolicyEntry { policy, .. } in &mut self.policies {
            policy.reseed(seed);
        }
    }

    /// Returns the agent with a forced choice, if it is asked and gets the choice now.
    fn forced_among(
        &mut self,
        agents: &[AgentView],
        options: &OptionsByName<'_>,
        now: SimTime,
    ) -> Option<(AgentId, Action)> {
        let forced = self.forced.as_mut().filter(|forced| !forced.is_over)?;
        options.entity(forced.agent)?;
        let agent = agents.iter().find(|agent| agent.id == forced.agent)?;
        forced.applies(agent, now, &options.list(agent.id)).then_some((forced.agent, forced.choice))
    }

    /// Adds a policy for these agents.
    pub fn add_for(&mut self, agents: &[AgentId], policy: Box<dyn Policy>) {
        let follows = self.add(policy);
        self.of_agents.extend(agents.iter().map(|&agent| (agent, follows)));
    }

    /// Returns the policy of an agent at the start of the run.
    pub fn policy_of(&self, agent: AgentId) -> PolicyId {
        let of_agent = self.of_agents.iter().find(|&&(id, _)| id == agent);
        of_agent.expect("policies are made for all agents before these").1
    }

    /// Returns how a policy is asked.
    pub fn asking(&self, policy: PolicyId) -> PolicyScope {
        self.policies[policy.0].policy.asking()
    }

    /// Returns the simulated time that a policy's last choice costs.
    pub fn charge(&self, policy: PolicyId) -> SimTime {
        self.policies[policy.0].policy.charge()
    }

    /// Asks the policy of the crews where they build line; a bad answer has no points.
    pub fn ask_for_line(&mut self, seen: &Observation<'_>, line: &FirelineContext<'_>) -> Vec<DVec2> {
        let Some(PolicyId(number)) = self.crews else { return Vec::new() };
        let PolicyEntry { policy, custom_name } = &mut self.policies[number];
        let mut stopwatch = CpuStopwatch::start();
        let mut points = policy.line(seen, line);
        let mut report = policy.take_report();
        self.custom_stats.add_cpu(stopwatch.elapsed_since_last(), report.elsewhere);
        if let Err(message) = check_line(&points, seen.fires.frame()) {
            points.clear();
            // The policy's own report says more than that its points are no line.
            report.failure = report.failure.or(Some((PlanFailure::BadAnswer, message)));
        }
        if let Some(name) = custom_name {
            self.custom_stats.add(name, seen.now, report);
        }
        points
    }

    /// Asks a policy, or takes the answer from outside. If the answer comes later, nothing is returned and the question
    /// is kept.
    pub fn ask(
        &mut self,
        policy: PolicyId,
        inquiry: PolicyQuery<'_>,
        options_of: &dyn ActionMask<Entity>,
    ) -> Vec<(Entity, Action)> {
        let PolicyQuery { now, fires, mut agents, queried } = inquiry;
        // Views come in the order of the world's storage, which policies must not depend on.
        agents.sort_by_key(|agent| agent.id);
        let entity_of = |id: AgentId| queried.iter().find(|&&(other, _)| other == id).map(|&(_, entity)| entity);
        let ids: Vec<AgentId> = queried.iter().map(|&(id, _)| id).collect();
        let by_name = OptionsByName { queried: &queried, options_of };
        let mut choices = std::mem::take(&mut self.answer);
        let forced = self.forced_among(&agents, &by_name, now);
        if let Some(forced) = forced
            && self.asking(policy) == PolicyScope::Each
        {
            // Others are asked when it has acted.
            choices = vec![forced];
        } else if !choices.is_empty() {
            // The answer comes from outside.
            let is_team = self.asking(policy) != PolicyScope::Each;
            if let Some(name) = &self.policies[policy.0].custom_name
                && let Some(message) = refuse_illegal(&mut choices, &agents, &by_name, is_team)
            {
                self.custom_stats.add_illegal(name, now, &message);
            }
        } else {
            let seen = Observation { now, fires, agents: &agents, options_of: &by_name };
            let PolicyEntry { policy, custom_name } = &mut self.policies[policy.0];
            // The time of a team's policy is measured with what else its decision takes.
            let is_measured = custom_name.is_some() && policy.asking() == PolicyScope::Each;
            let stopwatch = is_measured.then(CpuStopwatch::start);
            choices = policy.choose(&seen, &ids);
            if let Some(name) = custom_name {
                let mut report = policy.take_report();
                let here = stopwatch.map_or(Duration::ZERO, |mut stopwatch| stopwatch.elapsed_since_last());
                self.custom_stats.add_cpu(here, report.elsewhere);
                let is_team = policy.asking() != PolicyScope::Each;
                let illegal = refuse_illegal(&mut choices, &agents, &by_name, is_team);
                report.illegal = report.illegal.or(illegal);
                self.custom_stats.add(name, now, report);
            }
        }
        // An answer from outside may name agents that were not asked.
        choices.retain(|(id, _)| ids.contains(id));
        if let Some(forced) = forced {
            force(&mut choices, forced);
        }
        if let Some(decisions) = &mut self.decisions {
            for &(id, choice) in &choices {
                let Some(&agent) = agents.iter().find(|agent| agent.id == id) else { continue };
                let options = by_name.list(id);
                // An agent with a goal that is not sent elsewhere decides nothing new.
                let goes_on = agent.goal.is_some_and(|goal| !matches!(choice, Action::Go(cell) if cell != goal));
                // Of several questions at one instant the first counts.
                let mut at_once = decisions.iter().rev().take_while(|decision| decision.time == now);
                if options.len() > 1 && !goes_on && !at_once.any(|decision| decision.agent.id == id) {
                    decisions.push(Decision { time: now, agent, options, choice });
                }
            }
        }
        if choices.is_empty() {
            let options = queried.iter().map(|&(_, entity)| options_of.list(entity)).collect();
            self.question = Some(PendingDecision { queried: ids, agents, options });
            return Vec::new();
        }
        choices.into_iter().filter_map(|(id, choice)| Some((entity_of(id)?, choice))).collect()
    }
}

/// The most points of a line that a policy answers.
pub const MAX_LINE_POINTS: usize = 10_000;

/// Refuses points that are no line on the field, in words.
fn check_line(points: &[DVec2], frame: &FieldFrame) -> Result<(), String> {
    if !(2..=MAX_LINE_POINTS).contains(&points.len()) {
        let count = points.len();
        return Err(format!(
            "no line of {count} points can be built; expected 2 to {MAX_LINE_POINTS}; crews build none"
        ));
    }
    let width_m = frame.width_m();
    let height_m = frame.height_m();
    points.iter().find(|point| !((0.0..=width_m).contains(&point.x) && (0.0..=height_m).contains(&point.y))).map_or(
        Ok(()),
        |DVec2 { x, y }| {
            Err(format!("({x}, {y}) is not on the field of {width_m} x {height_m} m; crews build no line"))
        },
    )
}

/// Gives an agent another choice. A truck that was to go to the same cell swaps with it.
fn force(choices: &mut Vec<(AgentId, Action)>, (agent, choice): (AgentId, Action)) {
    let place = choices.iter().position(|&(id, _)| id == agent).unwrap_or_else(|| {
        choices.push((agent, Action::Wait));
        choices.len() - 1
    });
    let before = std::mem::replace(&mut choices[place].1, choice);
    if let Some((_, other)) =
        choices.iter_mut().find(|&&mut (id, other)| id != agent && matches!(choice, Action::Go(_)) && other == choice)
    {
        *other = before;
    }
}

/// Lets agents wait that cannot do what they were told; returns words about the first of them.
fn refuse_illegal(
    choices: &mut [(AgentId, Action)],
    agents: &[AgentView],
    options: &OptionsByName<'_>,
    is_team: bool,
) -> Option<String> {
    let mut message = None;
    for (agent, choice) in choices {
        // The caller drops answers for agents that have no question.
        let Some(view) = agents.iter().find(|view| view.id == *agent && options.entity(*agent).is_some()) else {
            continue;
        };
        let is_truck = agent.role.suppresses();
        let refused = match *choice {
            Action::Go(cell) if !options.list(*agent).contains(&cell) => format!("go for ({}, {})", cell.col, cell.row),
            Action::GoToNearest if !is_truck => "go to the nearest fire; only trucks can".to_owned(),
            Action::Move(place) if !(is_truck && is_team && place.is_finite()) => {
                format!("be sent to ({}, {}); only trucks of a team can, to places in metres", place.x, place.y)
            }
            Action::Refill if !is_truck || view.stops_left.is_none() => "refill; it has no tank".to_owned(),
            _ => continue,
        };
        *choice = Action::Wait;
        // One message is enough: the tally counts answers and not choices.
        message.get_or_insert_with(|| format!("{agent} cannot {refused}"));
    }
    message
}
