//! A program as a policy.

use std::sync::Arc;

use super::pool::Idle;
use super::process::say;
use super::protocol::{AgentMessage, AskQuery, FromProgram, ToProgram};
use super::respondent::Respondent;
use crate::fire::BushState;
use crate::geometry::Cell;
use crate::sim::policies::{Choice, Observation, Policy};
use crate::timeline::AgentId;

/// The most failures that are reported in a run.
const MOST_COMPLAINTS: u32 = 20;

/// Asks a program where agents are to go. While it fails to answer, they wait.
pub struct ProgramPolicy {
    /// `None` when it has been given back.
    pub(super) respondent: Option<Respondent>,
    /// Where the program goes when the run is over, if it plays in other runs.
    pub(super) idle: Option<Arc<Idle>>,
    /// Failures that were reported.
    pub(super) complaints: u32,
}

impl Policy for ProgramPolicy {
    fn choose(&mut self, seen: &Observation<'_>, asked: &[AgentId]) -> Vec<(AgentId, Choice)> {
        let options: Vec<(AgentId, Vec<Cell>)> = asked.iter().map(|&agent| (agent, seen.options(agent))).collect();
        let respondent = self.respondent.as_mut().expect("it is given back when this is dropped");
        let query = |id| question(id, seen, &options);
        let reply = respondent.ask(query, |answer| match answer {
            FromProgram::Answer(_) => Ok(()),
            _ => Err("expected the type `answer`"),
        });
        let choices = match reply.answer {
            Ok(FromProgram::Answer(answer)) => answer.choices,
            Ok(_) => unreachable!("other answers are refused"),
            Err(trouble) => {
                self.complaints += 1;
                if self.complaints <= MOST_COMPLAINTS {
                    say(respondent.name(), &format!("it {}", trouble.words));
                }
                Vec::new()
            }
        };
        let chosen = |(agent, options): (AgentId, Vec<Cell>)| {
            let name = agent.to_string();
            let cell = choices.iter().rev().find(|choice| choice.agent == name).and_then(|choice| choice.cell);
            let cell = cell.map(|[col, row]| Cell { col, row }).filter(|cell| options.contains(cell));
            (agent, cell.map_or(Choice::Wait, Choice::Go))
        };
        options.into_iter().map(chosen).collect()
    }
}

impl Drop for ProgramPolicy {
    fn drop(&mut self) {
        if let (Some(idle), Some(respondent)) = (&self.idle, self.respondent.take()) {
            idle.give_back(respondent);
        }
    }
}

/// Writes the state that a policy sees, and what it is asked, as a line.
fn question(id: u64, seen: &Observation<'_>, options: &[(AgentId, Vec<Cell>)]) -> Vec<u8> {
    let (mut burning, mut intact, mut extinguished, mut burned_out) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for cell in seen.fires.with_fuel() {
        let place = [cell.col, cell.row];
        match seen.fires.state(cell) {
            Some(BushState::Burning { since }) => {
                burning.push((cell.col, cell.row, seen.now.since(since).as_seconds()));
            }
            Some(BushState::Intact) => intact.push(place),
            Some(BushState::Extinguished) => extinguished.push(place),
            Some(BushState::BurnedOut) => burned_out.push(place),
            None => {}
        }
    }
    let pair = |cell: &Cell| [cell.col, cell.row];
    let state = seen.agents.iter().map(|agent| AgentMessage {
        agent: agent.id.to_string(),
        pose: [agent.pose.x, agent.pose.y, agent.pose.heading],
        activity: agent.activity.name().to_owned(),
        goal: agent.goal.as_ref().map(pair),
        options: options
            .iter()
            .find(|(asked, _)| *asked == agent.id)
            .map(|(_, cells)| cells.iter().map(pair).collect()),
    });
    let ask = AskQuery {
        id,
        t_s: seen.now.as_seconds(),
        agents: options.iter().map(|(agent, _)| agent.to_string()).collect(),
        burning: &burning,
        intact: &intact,
        extinguished: &extinguished,
        burned_out: &burned_out,
        state: state.collect(),
    };
    ToProgram::Ask(ask).line()
}
