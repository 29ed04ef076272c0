//! Events, fires and water.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::{AgentLabel, PoseObject, PrintedWord, pair};
use crate::{AgentFact, AgentId, Cause, EndReason, Event, Fact, FireFact, GroundFact, RestReason, RunIndex};
use wildfire_base::geometry::Cell;
use wildfire_base::query::{Effort, FoundBy, PlanFailure, SearchPhase};
use wildfire_base::time::SimTime;

/// Something that happened.
#[derive(Serialize, JsonSchema)]
pub struct EventObject<'a> {
    t_ns: u64,
    #[serde(flatten)]
    happened: Happened<'a>,
}

/// What happened, by the words that tables have for it.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum Happened<'a> {
    /// A blocked start was moved to the nearest free place before the run began.
    StartMoved { agent: AgentLabel, from: PoseObject },
    /// A truck's roadmap was built.
    RoadmapBuilt { agent: AgentLabel, samples: u32, edges: u32, components: u32 },
    /// The agent can never act on these cells.
    OutOfReach {
        agent: AgentLabel,
        #[schemars(with = "Vec<[u16; 2]>")]
        cells: &'a [Cell],
    },
    /// A bush caught fire.
    Ignited {
        cell: [u16; 2],
        #[serde(flatten)]
        cause: CauseObject,
    },
    /// The fire of a bush ended by itself.
    BurnedOut { cell: [u16; 2] },
    /// A truck put a bush out.
    Extinguished { cell: [u16; 2], agent: AgentLabel },
    /// The agent goes for a cell; its leg is the one at this place among the legs.
    Planned {
        agent: AgentLabel,
        goal: [u16; 2],
        leg: Option<u32>,
        #[serde(flatten)]
        effort: EffortObject,
        /// What found the path; null for a Wumpus.
        #[schemars(with = "Option<String>")]
        found_by: Option<PrintedWord<FoundBy>>,
    },
    /// What a search looked at, where that was recorded.
    Searched {
        agent: AgentLabel,
        #[schemars(with = "String")]
        phase: PrintedWord<SearchPhase>,
        /// In whole centimetres east and north.
        #[schemars(with = "Vec<[i32; 2]>")]
        places_cm: &'a [(i32, i32)],
        /// By their places in that list.
        #[schemars(with = "Vec<[u32; 2]>")]
        edges: &'a [(u32, u32)],
    },
    /// There is no plan for a goal; planning time is charged until then.
    PlanFailed {
        agent: AgentLabel,
        goal: [u16; 2],
        #[schemars(with = "String")]
        reason: PrintedWord<PlanFailure>,
        #[serde(flatten)]
        effort: EffortObject,
        until_ns: u64,
    },
    /// The agent gives its goal up under way and follows this leg to a stop.
    Dropped { agent: AgentLabel, goal: [u16; 2], leg: Option<u32> },
    /// A truck has arrived and begins to put a cell out.
    Suppressing {
        agent: AgentLabel,
        cell: [u16; 2],
        /// Portions of water that the stop takes, if several.
        #[serde(rename = "portions", skip_serializing_if = "Option::is_none")]
        water_units: Option<u32>,
    },
    /// Its cell burns no more before it is done.
    SuppressionEnded { agent: AgentLabel, cell: [u16; 2] },
    /// The agent has nothing to do.
    Rested {
        agent: AgentLabel,
        #[schemars(with = "String")]
        reason: PrintedWord<RestReason>,
    },
    /// A Wumpus's descent met a local minimum here.
    LocalMinimum { agent: AgentLabel, goal: [u16; 2], x_m: f64, y_m: f64 },
    /// Another truck is in the way to all that this one could go for.
    Blocked { agent: AgentLabel, goal: [u16; 2], by: AgentLabel },
    /// A truck drives aside so that another one can set out.
    GaveWay { agent: AgentLabel, to: AgentLabel, leg: Option<u32> },
    /// A truck sets out for a place where it is to wait, or where there is water.
    Relocated {
        agent: AgentLabel,
        x_m: f64,
        y_m: f64,
        leg: Option<u32>,
        #[serde(flatten)]
        effort: EffortObject,
        #[schemars(with = "String")]
        found_by: PrintedWord<FoundBy>,
    },
    /// It is called off on its way there and follows this leg to a stop.
    Halted { agent: AgentLabel, leg: Option<u32> },
    /// It stays, as there is no way to the place; without a reason, because other trucks are in the way.
    RelocationFailed {
        agent: AgentLabel,
        x_m: f64,
        y_m: f64,
        #[schemars(with = "Option<String>")]
        reason: Option<PrintedWord<PlanFailure>>,
        #[serde(flatten)]
        effort: EffortObject,
        until_ns: u64,
    },
    /// A truck fills its tank.
    Refilling { agent: AgentLabel, until_ns: u64 },
    /// The run is over.
    Ended {
        #[schemars(with = "String")]
        reason: PrintedWord<EndReason>,
    },
}

/// Why a cell caught fire.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "cause", rename_all = "kebab-case")]
enum CauseObject {
    /// An agent lit it.
    Lit { agent: AgentLabel },
    /// From a burning cell.
    Spread { from: [u16; 2] },
    /// From an ember of a burning cell.
    Ember { from: [u16; 2] },
    /// The scenario asked for it.
    Schedule,
}

/// Nodes that were expanded for an answer.
#[derive(Serialize, JsonSchema)]
struct EffortObject {
    roadmap_expansions: u32,
    local_expansions: u32,
}

impl From<Effort> for EffortObject {
    fn from(Effort { roadmap_expansions, local_expansions }: Effort) -> Self {
        Self { roadmap_expansions, local_expansions }
    }
}

impl From<Cause> for CauseObject {
    fn from(cause: Cause) -> Self {
        match cause {
            Cause::Agent(agent) => Self::Lit { agent: AgentLabel(agent) },
            Cause::Spread(from) => Self::Spread { from: pair(from) },
            Cause::Spotted(from) => Self::Ember { from: pair(from) },
            Cause::Scheduled => Self::Schedule,
        }
    }
}

impl<'a> EventObject<'a> {
    /// Makes the object of an event that this leg begins with, if any does.
    pub fn new(event: &'a Event, leg: Option<u32>) -> Self {
        let happened = match &event.fact {
            Fact::Agent(agent, fact) => of_agent(AgentLabel(*agent), fact, leg),
            Fact::Fire(FireFact::Ignited { cell, cause }) => {
                Happened::Ignited { cell: pair(*cell), cause: (*cause).into() }
            }
            Fact::Fire(FireFact::BurnedOut { cell }) => Happened::BurnedOut { cell: pair(*cell) },
            Fact::Fire(FireFact::Extinguished { cell, by }) => {
                Happened::Extinguished { cell: pair(*cell), agent: AgentLabel(*by) }
            }
            Fact::Ended { reason } => Happened::Ended { reason: PrintedWord(*reason) },
        };
        Self { t_ns: event.time.as_nanos(), happened }
    }
}

fn of_agent(agent: AgentLabel, fact: &AgentFact, leg: Option<u32>) -> Happened<'_> {
    match fact {
        AgentFact::StartMoved { from } => Happened::StartMoved { agent, from: (*from).into() },
        &AgentFact::RoadmapBuilt { samples, edges, components } => {
            Happened::RoadmapBuilt { agent, samples, edges, components }
        }
        AgentFact::OutOfReach { cells } => Happened::OutOfReach { agent, cells },
        AgentFact::Planned { goal, effort, found_by, .. } => {
            let (goal, effort) = (pair(*goal), (*effort).into());
            Happened::Planned { agent, goal, leg, effort, found_by: found_by.map(PrintedWord) }
        }
        AgentFact::Searched { phase, graph } => {
            Happened::Searched { agent, phase: PrintedWord(*phase), places_cm: &graph.places, edges: &graph.edges }
        }
        AgentFact::PlanFailed { goal, reason, effort, until } => {
            let (goal, effort) = (pair(*goal), (*effort).into());
            Happened::PlanFailed { agent, goal, reason: PrintedWord(*reason), effort, until_ns: until.as_nanos() }
        }
        AgentFact::Dropped { goal, .. } => Happened::Dropped { agent, goal: pair(*goal), leg },
        // A stop takes one portion unless the fire's heat decides; runs without such fires leave the field out.
        &AgentFact::Suppressing { cell, water_units } => Happened::Suppressing {
            agent,
            cell: pair(cell),
            water_units: Some(water_units).filter(|&water_units| water_units > 1),
        },
        AgentFact::SuppressionEnded { cell } => Happened::SuppressionEnded { agent, cell: pair(*cell) },
        AgentFact::Rested { reason } => Happened::Rested { agent, reason: PrintedWord(*reason) },
        &AgentFact::LocalMinimum { goal, x_m, y_m } => Happened::LocalMinimum { agent, goal: pair(goal), x_m, y_m },
        AgentFact::Blocked { goal, by } => Happened::Blocked { agent, goal: pair(*goal), by: AgentLabel(*by) },
        AgentFact::GaveWay { to, .. } => Happened::GaveWay { agent, to: AgentLabel(*to), leg },
        &AgentFact::Relocated { x_m, y_m, effort, found_by, .. } => {
            Happened::Relocated { agent, x_m, y_m, leg, effort: effort.into(), found_by: PrintedWord(found_by) }
        }
        AgentFact::Halted { .. } => Happened::Halted { agent, leg },
        &AgentFact::RelocationFailed { x_m, y_m, reason, effort, until } => {
            let effort = effort.into();
            let until_ns = until.as_nanos();
            Happened::RelocationFailed { agent, x_m, y_m, reason: reason.map(PrintedWord), effort, until_ns }
        }
        AgentFact::Refilling { until } => Happened::Refilling { agent, until_ns: until.as_nanos() },
    }
}

/// A cell that burned, from when to when, and why.
#[derive(Serialize, JsonSchema)]
pub struct FireObject {
    cell: [u16; 2],
    /// Whether the cell is ground, and not a bush.
    ground: bool,
    ignited_ns: u64,
    #[serde(flatten)]
    cause: CauseObject,
    /// Null if it burned when the run ended.
    ended_ns: Option<u64>,
    /// The truck that put it out; null if none did.
    extinguished_by: Option<AgentLabel>,
}

impl FireObject {
    fn new(cell: Cell, ground: bool, ignited: SimTime, cause: Cause) -> Self {
        let cell = pair(cell);
        let ignited_ns = ignited.as_nanos();
        Self { cell, ground, ignited_ns, cause: cause.into(), ended_ns: None, extinguished_by: None }
    }

    fn end(&mut self, time: SimTime, by: Option<AgentId>) {
        self.ended_ns = Some(time.as_nanos());
        self.extinguished_by = by.map(AgentLabel);
    }
}

/// Lists the fires until the end of a run in order of time; of one instant bushes first.
pub fn fires(index: &RunIndex<'_>) -> Vec<FireObject> {
    let mut fires = fires_of_bushes(index);
    fires.extend(fires_of_ground(index));
    // The sort is stable.
    fires.sort_by_key(|fire| fire.ignited_ns);
    fires
}

fn fires_of_bushes(index: &RunIndex<'_>) -> Vec<FireObject> {
    let mut fires: Vec<FireObject> = Vec::new();
    // Fires that burn, by their place in the list: they end in another order than they begin.
    let mut burning = BTreeMap::new();
    let events = index.timeline().events.iter().take_while(|event| event.time <= index.end_time());
    for event in events {
        match event.fact {
            Fact::Fire(FireFact::Ignited { cell, cause }) => {
                burning.insert(cell, fires.len());
                fires.push(FireObject::new(cell, false, event.time, cause));
            }
            Fact::Fire(FireFact::BurnedOut { cell }) => {
                burning.remove(&cell).into_iter().for_each(|fire| fires[fire].end(event.time, None));
            }
            Fact::Fire(FireFact::Extinguished { cell, by }) => {
                burning.remove(&cell).into_iter().for_each(|fire| fires[fire].end(event.time, Some(by)));
            }
            _ => {}
        }
    }
    fires
}

fn fires_of_ground(index: &RunIndex<'_>) -> impl Iterator<Item = FireObject> {
    let log = &index.timeline().ground;
    let end = index.end_time();
    let frame = index.timeline().setting.frame;
    // By cell and time, as a burning does not say who put it out.
    let extinctions: BTreeMap<(Cell, SimTime), AgentId> = log
        .iter()
        .filter_map(|event| match event.fact {
            GroundFact::Extinguished { by } => Some(((event.cell, event.time), by)),
            _ => None,
        })
        .collect();
    let cells = index.ground().into_iter().flat_map(move |ground| {
        let cells = (0..frame.cell_count()).map(move |index| frame.cell(index));
        cells.flat_map(move |cell| ground.burnings_of(cell).iter().map(move |burning| (cell, burning)))
    });
    cells.filter(move |(_, burning)| burning.ignited <= end).filter_map(move |(cell, burning)| {
        let GroundFact::Ignited(cause) = log[burning.event as usize].fact else { return None };
        let mut fire = FireObject::new(cell, true, burning.ignited, cause);
        if burning.ends <= end {
            fire.end(burning.ends, extinctions.get(&(cell, burning.ends)).copied().filter(|_| burning.is_extinguished));
        }
        Some(fire)
    })
}

/// A cell, bush or ground, that a truck wetted.
#[derive(Serialize, JsonSchema)]
pub struct WettingObject {
    cell: [u16; 2],
    from_ns: u64,
    until_ns: u64,
    by: AgentLabel,
}

/// A cell, bush or ground, in which crews finished line.
#[derive(Serialize, JsonSchema)]
pub struct LineObject {
    cell: [u16; 2],
    built_ns: u64,
    /// The flank: 0 or 1 of the first planned line, 2 or 3 of the next.
    flank: u8,
    /// The length of line on this flank up to the cell.
    along_m: f64,
    /// True if the cell cannot burn from then on; line that does not hold leaves it as it was.
    holds: bool,
}

/// Lists the line that crews built, in order of time.
pub fn line(index: &RunIndex<'_>) -> Vec<LineObject> {
    let log = index.timeline().ground.iter().take_while(|event| event.time <= index.end_time());
    let line = log.filter_map(|event| match event.fact {
        GroundFact::Cleared { flank, along_mm, holds } => {
            let cell = pair(event.cell);
            let built_ns = event.time.as_nanos();
            let along_m = f64::from(along_mm) / 1000.0;
            Some(LineObject { cell, built_ns, flank, along_m, holds })
        }
        _ => None,
    });
    line.collect()
}

/// Lists what trucks wetted, in order of time.
pub fn wettings(index: &RunIndex<'_>) -> Vec<WettingObject> {
    let log = index.timeline().ground.iter().take_while(|event| event.time <= index.end_time());
    let wetting = log.filter_map(|event| match event.fact {
        GroundFact::Wetted { until, by } => Some(WettingObject {
            cell: pair(event.cell),
            from_ns: event.time.as_nanos(),
            until_ns: until.as_nanos(),
            by: AgentLabel(by),
        }),
        _ => None,
    });
    wetting.collect()
}
