//! The story of a bush or an agent that the viewer asked about.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;
use super::agents;
use crate::geometry::Cell;
use crate::picture::film::field::agent_colour;
use crate::picture::film::{RunView, Selected};
use crate::time::SimTime;
use crate::timeline::{Activity, AgentFact, AgentId, AgentState, Cause, Event, Fact, FireFact, State};

/// The last changes of a bush that are told, those to come included.
const MOST_CHANGES: usize = 6;

pub fn block(moment: &Moment) -> Option<Block> {
    let (run_index, selected) = moment.options.selected?;
    let (run, state) = (*moment.runs.get(run_index)?, moment.states.get(run_index)?);
    let lines = match selected {
        Selected::Bush(cell) => tell_bush(run, cell, moment.time)?,
        Selected::Agent(id) => tell_agent(run, state, id, moment.time)?,
    };
    Some(Block::new(4, [heading(moment, run_index, selected)].into_iter().chain(lines).collect()))
}

fn heading(moment: &Moment, run_index: usize, selected: Selected) -> Line {
    let (name, colour) = match selected {
        Selected::Bush(cell) => (format!("bush {cell}"), Face::STRONG.colour),
        Selected::Agent(id) => (id.to_string(), agent_colour(id)),
    };
    let mut marks = vec![Mark::left(name, Face { colour, ..Face::STRONG })];
    if moment.is_comparison() {
        marks.push(Mark::right(format!("in {}", words::run_name(run_index)), Face::faint()));
    }
    Line::new(marks)
}

/// What happened to a bush and when; what is yet to come is faint.
fn tell_bush(run: &RunView, cell: Cell, now: SimTime) -> Option<Vec<Line>> {
    let bush = run.timeline().setting.bush_index(cell)?;
    let mut burns_since = None;
    let mut lines =
        vec![Line::new(vec![Mark::left("intact", Face::PLAIN), Mark::right(words::clock(SimTime::ZERO), Face::PLAIN)])];
    for event in run.changes_of(bush) {
        let face = if event.time <= now { Face::PLAIN } else { Face::faint() };
        let told = tell_change(&event.fact, burns_since.is_some());
        lines.push(Line::new(vec![Mark::left(told, face), Mark::right(words::clock(event.time), face)]));
        lines.extend(
            burned_for(event, burns_since)
                .map(|text| Line::new(vec![Mark::Left { from: 1.0, text, face: Face::faint() }])),
        );
        if let Fact::Fire(FireFact::Ignited { .. }) = event.fact {
            burns_since = Some(event.time);
        }
    }
    let dropped = lines.len().saturating_sub(2 * MOST_CHANGES);
    Some(lines.split_off(dropped))
}

fn tell_change(fact: &Fact, burned_before: bool) -> String {
    match fact {
        Fact::Fire(FireFact::Ignited { cause, .. }) => {
            let again = if burned_before { " again" } else { "" };
            match cause {
                Cause::Lit(agent) => format!("lit{again} by {agent}"),
                Cause::Spread(from) => format!("caught fire{again} from {from}"),
                Cause::Scheduled => format!("lit{again} by schedule"),
            }
        }
        Fact::Fire(FireFact::Extinguished { by, .. }) => format!("put out by {by}"),
        _ => "burned out".to_owned(),
    }
}

/// For how long a fire burned that ends with this event.
fn burned_for(event: &Event, since: Option<SimTime>) -> Option<String> {
    let ends = matches!(event.fact, Fact::Fire(FireFact::Extinguished { .. }) | Fact::Fire(FireFact::BurnedOut { .. }));
    since.filter(|_| ends).map(|since| format!("after {:.1} s", event.time.since(since).as_seconds()))
}

fn tell_agent(run: &RunView, state: &State, id: AgentId, now: SimTime) -> Option<Vec<Line>> {
    let index = run.timeline().setting.agent_index(id)?;
    let AgentState { speed_mps, activity, goal, .. } = state.agents[index];
    let stats = run.stats_at(index, now);
    let mut lines = vec![
        Line::pair(words::doing(id, activity), format!("{speed_mps:.1} m/s")),
        Line::pair("goal", goal.map_or("none".to_owned(), |goal| goal.to_string())),
        Line::pair("distance", format!("{:.0} m", stats.distance_m)),
        Line::pair("cells", format!("{} {}", stats.cells, agents::cells_word(id))),
        Line::pair("plans", format!("{} ({} failed)", stats.plans, stats.failures)),
    ];
    if let Some(Fact::Agent(_, AgentFact::PlanFailed { reason, goal, .. })) =
        stats.last_failure.map(|at| &run.timeline().events[at].fact)
    {
        lines.push(Line::pair("last failure", reason.to_string()));
        lines.push(Line::pair("", format!("for {goal}")));
    }
    let activities =
        [Activity::Driving, Activity::Planning, Activity::Suppressing, Activity::Waiting, Activity::Standing];
    let spent = activities.map(|activity| (activity, stats.spent(activity)));
    let told = spent.into_iter().filter(|(_, time)| *time > SimTime::ZERO);
    lines.extend(told.map(|(activity, time)| Line::pair(words::doing(id, activity), words::clock(time))));
    Some(lines)
}
