//! A program as a policy.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::pool::Idle;
use super::process::Trouble;
use super::protocol::{AgentMessage, AskQuery, FromProgram, ToProgram};
use super::respondent::Respondent;
use crate::policies::{AskReport, Choice, Observation, Policy};
use wildfire_base::geometry::Cell;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::BushState;
use wildfire_timeline::AgentId;

/// Asks a program where agents are to go. While it fails to answer, they wait.
pub struct ProgramPolicy {
    /// `None` when it has been given back.
    respondent: Option<Respondent>,
    /// Where the program goes when the run is over, if it plays in other runs.
    idle: Option<Arc<Idle>>,
    /// Notes on the last ask.
    report: AskReport,
}

impl ProgramPolicy {
    /// Lets a program that knows its field decide; its start is the first thing to report.
    pub(super) fn new(respondent: Respondent, idle: Option<Arc<Idle>>) -> Self {
        let report = AskReport { elsewhere: respondent.built.unwrap_or_default(), ..AskReport::default() };
        Self { respondent: Some(respondent), idle, report }
    }
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
        self.report = AskReport { elsewhere: reply.cpu.unwrap_or_default(), ..AskReport::default() };
        let choices = match reply.answer {
            Ok(FromProgram::Answer(answer)) => answer.choices,
            Ok(_) => unreachable!("other answers are refused"),
            Err(Trouble { kind, words }) => {
                self.report.failure = Some((kind.into(), words));
                Vec::new()
            }
        };
        let names: BTreeSet<String> = seen.agents.iter().map(|agent| agent.id.to_string()).collect();
        let stranger = choices.iter().find(|choice| !names.contains(&choice.agent));
        self.report.illegal = stranger.map(|choice| format!("the run has no agent `{}`", visible_start(&choice.agent)));
        let chosen = |agent: AgentId| {
            let name = agent.to_string();
            let cell = choices.iter().rev().find(|choice| choice.agent == name).and_then(|choice| choice.cell);
            (agent, cell.map_or(Choice::Wait, |[col, row]| Choice::Go(Cell { col, row })))
        };
        options.iter().map(|&(agent, _)| chosen(agent)).collect()
    }

    fn take_report(&mut self) -> AskReport {
        std::mem::take(&mut self.report)
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
