//! A program as a policy.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::external_client::{ExternalClient, Idle, Reply};
use super::launch::ProcessError;
use super::protocol::{FromProgram, question};
use crate::policies::{Action, FirelineContext, Observation, Policy, QueryReport};
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::untrusted::visible_start;
use wildfire_timeline::AgentId;

/// Asks a program where agents are to go. While it fails to answer, they wait.
pub struct ProgramPolicy {
    /// `None` when it has been given back.
    respondent: Option<ExternalClient>,
    /// Where the program goes when the run is over, if it plays in other runs.
    idle: Option<Arc<Idle>>,
    /// Notes on the last ask.
    report: QueryReport,
}

impl ProgramPolicy {
    /// Lets a program that knows its field decide; its start is the first thing to report.
    pub(super) fn new(respondent: ExternalClient, idle: Option<Arc<Idle>>) -> Self {
        let report = QueryReport { elsewhere: respondent.built.unwrap_or_default(), ..QueryReport::default() };
        Self { respondent: Some(respondent), idle, report }
    }

    /// Asks for an answer that a check lets pass, and takes notes.
    fn ask(
        &mut self,
        seen: &Observation<'_>,
        options: &[(AgentId, Vec<Cell>)],
        line: Option<&FirelineContext<'_>>,
        check: impl FnOnce(&FromProgram) -> Result<(), &'static str>,
    ) -> Option<FromProgram> {
        let respondent = self.respondent.as_mut().expect("it is given back when this is dropped");
        let Reply { answer, cpu, .. } = respondent.ask(|id| question(id, seen, options, line), check);
        self.report = QueryReport { elsewhere: cpu.unwrap_or_default(), ..QueryReport::default() };
        answer.map_err(|ProcessError { kind, message }| self.report.failure = Some((kind.into(), message))).ok()
    }
}

impl Policy for ProgramPolicy {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        let options: Vec<(AgentId, Vec<Cell>)> = queried.iter().map(|&agent| (agent, seen.options(agent))).collect();
        let answer = self.ask(seen, &options, None, |answer| match answer {
            FromProgram::Answer(_) => Ok(()),
            _ => Err("expected the type `answer`"),
        });
        let choices = match answer {
            Some(FromProgram::Answer(answer)) => answer.choices,
            _ => Vec::new(),
        };
        let names: BTreeSet<String> = seen.agents.iter().map(|agent| agent.id.to_string()).collect();
        let stranger = choices.iter().find(|choice| !names.contains(&choice.agent));
        self.report.illegal = stranger.map(|choice| format!("the run has no agent `{}`", visible_start(&choice.agent)));
        let selected = |agent: AgentId| {
            let name = agent.to_string();
            // Of several choices for an agent the last counts.
            let cell = choices.iter().rev().find(|choice| choice.agent == name).and_then(|choice| choice.cell);
            (agent, cell.map_or(Action::Wait, |[col, row]| Action::Go(Cell { col, row })))
        };
        options.iter().map(|&(agent, _)| selected(agent)).collect()
    }

    fn line(&mut self, seen: &Observation<'_>, line: &FirelineContext<'_>) -> Vec<DVec2> {
        let answer = self.ask(seen, &[], Some(line), |answer| match answer {
            FromProgram::Line(_) => Ok(()),
            _ => Err("expected the type `line`"),
        });
        match answer {
            Some(FromProgram::Line(line)) => line.points.into_iter().map(DVec2::from).collect(),
            _ => Vec::new(),
        }
    }

    fn take_report(&mut self) -> QueryReport {
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
