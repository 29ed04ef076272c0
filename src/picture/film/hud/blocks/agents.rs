//! What each agent does and did.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;
use super::{heading, values};
use crate::picture::film::field::agent_colour;
use crate::picture::film::{AgentStats, RunView};
use crate::time::SimTime;
use crate::timeline::{Activity, AgentId, AgentState};

/// Rank of the first agent; later ones give way first.
const RANK: u8 = 10;
/// No panel has room for more.
const MOST: usize = 64;

pub fn blocks(moment: &Moment) -> Vec<Block> {
    if let (&[run], [state]) = (moment.runs, moment.states) {
        let tell = |(index, agent)| Block::new(rank(index), tell(run, index, agent, moment.time));
        state.agents.iter().take(MOST).enumerate().map(tell).collect()
    } else {
        ids(moment)
            .into_iter()
            .take(MOST)
            .enumerate()
            .map(|(index, id)| Block::new(rank(index), compare(moment, id)))
            .collect()
    }
}

fn rank(index: usize) -> u8 {
    RANK.saturating_add(u8::try_from(index).unwrap_or(u8::MAX))
}

fn name(agent: AgentId) -> Mark {
    Mark::left(agent.to_string(), Face { colour: agent_colour(agent), ..Face::STRONG })
}

/// What an agent did with the bushes.
pub fn cells_word(agent: AgentId) -> &'static str {
    if agent.role.lights() { "lit" } else { "put out" }
}

fn tell(run: &RunView, index: usize, agent: &AgentState, time: SimTime) -> Vec<Line> {
    let stats = run.stats_at(index, time);
    let goal = agent.goal.map_or("no goal".to_owned(), |goal| format!("goal {goal}"));
    let cells = format!("{} {}", stats.cells, cells_word(agent.id));
    let effort =
        run.cpu_of_agent_until(agent.id, time).map_or_else(|| format!("{} nodes", stats.expansions), words::cpu);
    vec![
        Line::new(vec![name(agent.id), Mark::right(words::doing(agent.id, agent.activity), Face::PLAIN)]),
        Line::new(vec![Mark::left(goal, Face::faint()), Mark::right(cells, Face::faint())]),
        Line::new(vec![
            Mark::left(format!("{} plans, {} failed", stats.plans, stats.failures), Face::faint()),
            Mark::right(effort, Face::faint()),
        ]),
    ]
}

/// The agents of all runs, each once.
fn ids(moment: &Moment) -> Vec<AgentId> {
    let mut ids: Vec<AgentId> = moment.states.iter().flat_map(|state| &state.agents).map(|agent| agent.id).collect();
    ids.sort_unstable();
    ids.dedup();
    ids
}

fn compare(moment: &Moment, id: AgentId) -> Vec<Line> {
    let runs = moment.runs.iter().zip(moment.states);
    let known = runs.map(|(run, state)| {
        let index = run.timeline().setting.agent_index(id)?;
        Some((state.agents[index].activity, run.stats_at(index, moment.time)))
    });
    let known: Vec<Option<(Activity, AgentStats)>> = known.collect();
    let line = |name: &str, tell: &dyn Fn(Activity, &AgentStats) -> String| {
        let told =
            |run: &Option<(Activity, AgentStats)>| run.map_or("-".to_owned(), |(activity, did)| tell(activity, &did));
        let marks = [Mark::left(name, Face::faint())].into_iter().chain(values(known.iter().map(told), Face::PLAIN));
        Line::new(marks.collect())
    };
    vec![
        heading(moment, name(id)),
        line("does", &|activity, _| words::doing(id, activity).to_owned()),
        line(cells_word(id), &|_, did| did.cells.to_string()),
        line("plans, failed", &|_, did| format!("{}, {}", did.plans, did.failures)),
    ]
}
