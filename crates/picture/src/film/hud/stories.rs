//! Stories: what each agent does and did, and what happened to the bush or agent that the viewer selected.

use crate::colours::agent_colour;
use crate::film::hud::blocks::{heading, values};
use crate::film::hud::fleet::fleet_blocks;
use crate::film::hud::formatting::{activity_name, format_clock, format_cpu, format_way};
use crate::film::hud::panel::{LineMark, PanelBlock, PanelLine};
use crate::film::hud::pen::TextFace;
use crate::film::hud::{HudView, formatting};
use crate::film::{RunView, Selected};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::{Activity, AgentFact, AgentId, AgentState, AgentStats, Cause, Event, Fact, FireFact, State};

/// Rank of the first agent; later ones give way first.
pub const FIRST_AGENT_RANK: u8 = 10;

/// A block for each agent, or where these are many one for each role.
pub fn agent_blocks(view: &HudView) -> Vec<PanelBlock> {
    if view.runs.iter().any(|run| run.is_crowded()) {
        return fleet_blocks(view);
    }
    if let (&[run], [state]) = (view.runs, view.states) {
        state
            .agents
            .iter()
            .enumerate()
            .map(|(index, agent)| PanelBlock::new(agent_rank(index), agent_lines(run, index, agent, view.time)))
            .collect()
    } else {
        agent_ids(view)
            .into_iter()
            .enumerate()
            .map(|(index, id)| PanelBlock::new(agent_rank(index), compared_agent_lines(view, id)))
            .collect()
    }
}

fn agent_rank(index: usize) -> u8 {
    FIRST_AGENT_RANK.saturating_add(u8::try_from(index).unwrap_or(u8::MAX))
}

fn agent_mark(agent: AgentId) -> LineMark {
    LineMark::left(agent.to_string(), TextFace { colour: agent_colour(agent), ..TextFace::STRONG })
}

/// Returns the word for what an agent does with bushes.
pub fn cells_word(agent: AgentId) -> &'static str {
    if agent.role.lights() { "lit" } else { "put out" }
}

fn agent_lines(run: &RunView, index: usize, agent: &AgentState, time: SimTime) -> Vec<PanelLine> {
    let stats = run.stats_at(index, time);
    let frame = run.timeline().setting.frame;
    let goal = agent
        .goal
        .map_or("no goal".to_owned(), |goal| format!("goal {}", format_way(&frame, agent.pose.position(), goal)));
    // Trucks put out ground, too, which is not theirs alone and is counted above.
    let noun = if run.is_of_ground() { " bushes" } else { "" };
    let cells = format!("{}{noun} {}", stats.cells, cells_word(agent.id));
    let effort =
        run.cpu_of_agent_until(agent.id, time).map_or_else(|| format!("{} search steps", stats.expansions), format_cpu);
    vec![
        PanelLine::new(vec![
            agent_mark(agent.id),
            LineMark::right(activity_name(agent.id, agent.activity), TextFace::PLAIN),
        ]),
        PanelLine::new(vec![LineMark::left(goal, TextFace::faint()), LineMark::right(cells, TextFace::faint())]),
        PanelLine::new(vec![
            LineMark::left(format!("{} routes, {} failed", stats.plans, stats.failures), TextFace::faint()),
            LineMark::right(effort, TextFace::faint()),
        ]),
    ]
}

/// The agents of all runs, each once.
fn agent_ids(view: &HudView) -> Vec<AgentId> {
    let mut ids: Vec<AgentId> = view.states.iter().flat_map(|state| &state.agents).map(|agent| agent.id).collect();
    ids.sort_unstable();
    ids.dedup();
    ids
}

fn compared_agent_lines(view: &HudView, id: AgentId) -> Vec<PanelLine> {
    let runs = view.runs.iter().zip(view.states);
    let activities = runs.map(|(run, state)| {
        let index = run.timeline().setting.agent_index(id)?;
        Some((state.agents[index].activity, run.stats_at(index, view.time)))
    });
    let activities: Vec<Option<(Activity, AgentStats)>> = activities.collect();
    let line = |name: &str, tell: &dyn Fn(Activity, &AgentStats) -> String| {
        let cell_text =
            |run: &Option<(Activity, AgentStats)>| run.map_or("-".to_owned(), |(activity, did)| tell(activity, &did));
        let marks = [LineMark::left(name, TextFace::faint())]
            .into_iter()
            .chain(values(activities.iter().map(cell_text), TextFace::PLAIN));
        PanelLine::new(marks.collect())
    };
    vec![
        heading(view, agent_mark(id)),
        line("does", &|activity, _| activity_name(id, activity).to_owned()),
        line(cells_word(id), &|_, did| did.cells.to_string()),
        line("routes, failed", &|_, did| format!("{}, {}", did.plans, did.failures)),
    ]
}

/// The number of last changes of a bush that are listed, those to come included.
const MAX_CHANGES: usize = 6;

pub fn story_block(view: &HudView) -> Option<PanelBlock> {
    let (run_index, selected) = view.options.selected?;
    let run = *view.runs.get(run_index)?;
    let state = view.states.get(run_index)?;
    let lines = match selected {
        Selected::Bush(cell) => bush_story(run, cell, view.time)?,
        Selected::Agent(id) => agent_story(run, state, id, view.time)?,
    };
    Some(PanelBlock::new(4, [story_heading(view, run_index, selected)].into_iter().chain(lines).collect()))
}

fn story_heading(view: &HudView, run_index: usize, selected: Selected) -> PanelLine {
    let (name, colour) = match selected {
        Selected::Bush(cell) => (format!("bush in column {}, row {}", cell.col, cell.row), TextFace::STRONG.colour),
        Selected::Agent(id) => (id.to_string(), agent_colour(id)),
    };
    let mut marks = vec![LineMark::left(name, TextFace { colour, ..TextFace::STRONG })];
    if view.is_comparison() {
        marks.push(LineMark::right(format!("in {}", formatting::run_name(run_index)), TextFace::faint()));
    }
    PanelLine::new(marks)
}

/// Tells what happened to a bush and when; what is yet to come is faint.
fn bush_story(run: &RunView, cell: Cell, now: SimTime) -> Option<Vec<PanelLine>> {
    let bush = run.timeline().setting.bush_index(cell)?;
    let mut burns_since = None;
    let mut lines = vec![PanelLine::new(vec![
        LineMark::left("intact", TextFace::PLAIN),
        LineMark::right(format_clock(SimTime::ZERO), TextFace::PLAIN),
    ])];
    for event in run.changes_of(bush) {
        let face = if event.time <= now { TextFace::PLAIN } else { TextFace::faint() };
        let text = change_text(&event.fact, burns_since.is_some());
        lines.push(PanelLine::new(vec![LineMark::left(text, face), LineMark::right(format_clock(event.time), face)]));
        lines.extend(
            burned_for(event, burns_since)
                .map(|text| PanelLine::new(vec![LineMark::Left { from: 1.0, text, face: TextFace::faint() }])),
        );
        if let Fact::Fire(FireFact::Ignited { .. }) = event.fact {
            burns_since = Some(event.time);
        }
    }
    // Of many changes the last ones matter.
    let dropped = lines.len().saturating_sub(2 * MAX_CHANGES);
    Some(lines.split_off(dropped))
}

/// Tells what changed a bush.
pub fn change_text(fact: &Fact, burned_before: bool) -> String {
    match fact {
        Fact::Fire(FireFact::Ignited { cause, .. }) => {
            let again = if burned_before { " again" } else { "" };
            match cause {
                Cause::Agent(agent) => format!("lit{again} by {agent}"),
                Cause::Spread(from) => format!("caught fire{again} from {from}"),
                Cause::Spotted(from) => format!("caught fire{again} from an ember of {from}"),
                Cause::Scheduled => format!("lit{again} by schedule"),
            }
        }
        Fact::Fire(FireFact::Extinguished { by, .. }) => format!("put out by {by}"),
        _ => "burned out".to_owned(),
    }
}

/// Tells for how long a fire burned that ends with this event.
pub fn burned_for(event: &Event, since: Option<SimTime>) -> Option<String> {
    let ends = matches!(event.fact, Fact::Fire(FireFact::Extinguished { .. }) | Fact::Fire(FireFact::BurnedOut { .. }));
    since.filter(|_| ends).map(|since| format!("after {:.1} s", event.time.since(since).as_seconds()))
}

fn agent_story(run: &RunView, state: &State, id: AgentId, now: SimTime) -> Option<Vec<PanelLine>> {
    let index = run.timeline().setting.agent_index(id)?;
    let AgentState { pose, speed_mps, activity, goal, .. } = state.agents[index];
    let frame = run.timeline().setting.frame;
    let goal = goal.map_or("none".to_owned(), |goal| format_way(&frame, pose.position(), goal));
    let stats = run.stats_at(index, now);
    let mut lines = vec![
        PanelLine::pair(activity_name(id, activity), format!("{speed_mps:.1} m/s")),
        PanelLine::pair("goal", goal),
        PanelLine::pair("distance", format!("{:.0} m", stats.distance_m)),
        PanelLine::pair("cells", format!("{} {}", stats.cells, cells_word(id))),
        PanelLine::pair("routes planned", format!("{} ({} failed)", stats.plans, stats.failures)),
    ];
    // A relocation that failed has no goal, and is left out here.
    if let Some(Fact::Agent(_, AgentFact::PlanFailed { reason, goal, .. })) =
        stats.last_failure.map(|at| &run.timeline().events[at].fact)
    {
        lines.push(PanelLine::pair("last failure", reason.to_string()));
        lines.push(PanelLine::pair("", format!("for {goal}")));
    }
    let activities = [
        Activity::Driving,
        Activity::Planning,
        Activity::Suppressing,
        Activity::Refilling,
        Activity::Waiting,
        Activity::Standing,
    ];
    let spent = activities.map(|activity| (activity, stats.spent(activity)));
    let spent = spent.into_iter().filter(|(_, time)| *time > SimTime::ZERO);
    lines.extend(spent.map(|(activity, time)| PanelLine::pair(activity_name(id, activity), format_clock(time))));
    Some(lines)
}
