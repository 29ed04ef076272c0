//! The facts of a run as recordings store them.
//!
//! A fact is the number of its kind and its fields, as varints, in which agents and bushes are places in the setting's
//! lists, and cells without a bush count on after the bushes by their index; then what does not fit a varint: a leg, a list of cells, a graph. Times are differences and numbers of legs
//! are streams of their own. What can be computed again is left out.
//!
//! Numbers of kinds are never given twice. A new kind takes the next one, in [`FactWriter`] and in [`FactReader`].

use super::FileError;
use super::check::{MAX_CELLS_OUT_OF_REACH, MAX_PIECES, MAX_SEARCH_EDGES, MAX_SEARCH_PLACES, limit};
use super::graphs::{append_graph, take_graph};
use super::numbers::{NumberReader, NumberWriter};
use super::{append, take};
use crate::{AgentFact, AgentId, Cause, EndReason, Event, Fact, FireFact, RestReason, Setting};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::query::{Effort, FoundBy, PlanFailure, SearchGraph, SearchPhase};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, Trajectory};
use wildfire_base::vehicle::Segment;

/// The kinds of records. Formats 1 to 4 have them up to 14, 15, 17 and 18.
mod kind {
    pub const START_MOVED: u32 = 0;
    pub const ROADMAP_BUILT: u32 = 1;
    pub const OUT_OF_REACH: u32 = 2;
    pub const IGNITED_BY_AGENT: u32 = 3;
    pub const SPREAD: u32 = 4;
    pub const SCHEDULED: u32 = 5;
    pub const BURNED_OUT: u32 = 6;
    pub const EXTINGUISHED: u32 = 7;
    pub const PLANNED: u32 = 8;
    pub const PLAN_FAILED: u32 = 9;
    pub const DROPPED: u32 = 10;
    pub const SUPPRESSING: u32 = 11;
    pub const SUPPRESSION_ENDED: u32 = 12;
    pub const RESTED: u32 = 13;
    pub const ENDED: u32 = 14;
    pub const LOCAL_MINIMUM: u32 = 15;
    pub const BLOCKED: u32 = 16;
    pub const GAVE_WAY: u32 = 17;
    pub const SEARCHED: u32 = 18;
    /// Cells that catch fire from one cell at one instant, one fact after the other.
    pub const SPREAD_TOGETHER: u32 = 19;
    pub const SPOTTED: u32 = 20;
    pub const RELOCATED: u32 = 21;
    pub const HALTED: u32 = 22;
    pub const RELOCATION_FAILED: u32 = 23;
    pub const REFILLING: u32 = 24;
    /// As `SUPPRESSING`, with several portions of water.
    pub const SPRAYING: u32 = 25;
}

/// The ways in which a leg begins.
mod origin {
    /// Where the agent's last leg ended, at a time after the fact.
    pub const LAST_END: u32 = 0;
    /// Where and when the agent's last leg began, along some of its pieces.
    pub const LAST_START: u32 = 1;
    /// In a pose of its own, at a time after the fact or before it.
    pub const ELSEWHERE: u32 = 2;
}

/// The pieces of a leg, by how many numbers they have.
mod piece {
    /// Curvature, length, speed, acceleration.
    pub const DRIVE: u32 = 0;
    /// Heading.
    pub const TURN: u32 = 1;
    /// Seconds.
    pub const WAIT: u32 = 2;
}

// Words are written as their places in these lists, which only grow at the end.
const REST_REASONS: [RestReason; 9] = [
    RestReason::NothingLeftToLight,
    RestReason::NothingBurns,
    RestReason::NothingReachable,
    RestReason::LocalMinima,
    RestReason::NoPlan,
    RestReason::PolicyWait,
    RestReason::NoWater,
    RestReason::NotReady,
    RestReason::TooHot,
];
const END_REASONS: [EndReason; 2] = [EndReason::Duration, EndReason::NothingLeft];
const FAILURES: [PlanFailure; 8] = [
    PlanFailure::StartBlocked,
    PlanFailure::GoalBlocked,
    PlanFailure::Disconnected,
    PlanFailure::BudgetSpent,
    PlanFailure::LocalMinimum,
    PlanFailure::TimedOut,
    PlanFailure::Crashed,
    PlanFailure::BadAnswer,
];
const PHASES: [SearchPhase; 4] = [SearchPhase::Roadmap, SearchPhase::Query, SearchPhase::Local, SearchPhase::Walk];
const FOUND_BY: [Option<FoundBy>; 9] = [
    None,
    Some(FoundBy::Straight),
    Some(FoundBy::Roadmap),
    Some(FoundBy::Search),
    Some(FoundBy::Relaxed),
    Some(FoundBy::Lattice),
    Some(FoundBy::Reachability),
    Some(FoundBy::BackingOut),
    Some(FoundBy::WayHome),
];
pub const NO_SUCH_BUSH: FileError = FileError::Damaged("it refers to a bush that it does not contain");
pub const NO_SUCH_AGENT: FileError = FileError::Damaged("it refers to an agent that it does not contain");
const NO_SUCH_LEG: FileError = FileError::Damaged("it refers to a leg that it does not contain");
pub const NO_SUCH_TIME: FileError = FileError::Damaged("it contains a time out of range");
pub const NO_SUCH_WORD: FileError = FileError::Damaged("a record in it cannot be read");

fn number_of<T: PartialEq>(values: &[T], word: &T) -> u32 {
    values.iter().position(|other| other == word).expect("all words are listed") as u32
}

fn word_of<T: Copy>(values: &[T], number: u32) -> Result<T, FileError> {
    values.get(number as usize).copied().ok_or(NO_SUCH_WORD)
}

/// Writes facts.
pub struct FactWriter<'a> {
    setting: &'a Setting,
    now: SimTime,
    /// By record: nanoseconds since the one before it.
    pub delays: Vec<u8>,
    pub records: Vec<u8>,
    pub numbers: NumberWriter,
    /// By place among the agents.
    last_legs: Vec<Option<&'a Trajectory>>,
}

impl<'a> FactWriter<'a> {
    pub fn new(setting: &'a Setting) -> Self {
        Self {
            setting,
            now: SimTime::ZERO,
            delays: Vec::new(),
            records: Vec::new(),
            numbers: NumberWriter::default(),
            last_legs: vec![None; setting.agents.len()],
        }
    }

    /// Writes the facts of a timeline that has passed [`super::check::check`].
    pub fn write(&mut self, events: &'a [Event]) {
        let mut rest = events;
        while let Some(event) = rest.first() {
            // The facts are in order of time, so no delay is negative.
            append(&mut self.delays, &(event.time - self.now).as_nanos());
            self.now = event.time;
            let together = spread_together(rest);
            if together > 1 {
                self.spread(&rest[..together]);
            } else {
                self.fact(&event.fact);
            }
            rest = &rest[together.max(1)..];
        }
    }

    fn record(&mut self, kind: u32, fields: &[u32]) {
        append(&mut self.records, &kind);
        fields.iter().for_each(|field| append(&mut self.records, field));
    }

    fn spread(&mut self, events: &[Event]) {
        let Cause::Spread(from) = cause(&events[0]).expect("it spreads") else { unreachable!("it spreads") };
        self.record(kind::SPREAD_TOGETHER, &[self.cell(from), events.len() as u32]);
        self.cell_steps(events.iter().filter_map(|event| event.fact.cell()));
    }

    fn fact(&mut self, fact: &'a Fact) {
        match fact {
            Fact::Agent(agent, fact) => self.agent_fact(self.agent(*agent), fact),
            Fact::Fire(FireFact::Ignited { cell, cause }) => match *cause {
                Cause::Agent(agent) => self.record(kind::IGNITED_BY_AGENT, &[self.cell(*cell), self.agent(agent)]),
                Cause::Spread(from) => self.record(kind::SPREAD, &[self.cell(*cell), self.cell(from)]),
                Cause::Spotted(from) => self.record(kind::SPOTTED, &[self.cell(*cell), self.cell(from)]),
                Cause::Scheduled => self.record(kind::SCHEDULED, &[self.cell(*cell)]),
            },
            Fact::Fire(FireFact::BurnedOut { cell }) => self.record(kind::BURNED_OUT, &[self.cell(*cell)]),
            Fact::Fire(FireFact::Extinguished { cell, by }) => {
                self.record(kind::EXTINGUISHED, &[self.cell(*cell), self.agent(*by)]);
            }
            Fact::Ended { reason } => self.record(kind::ENDED, &[number_of(&END_REASONS, reason)]),
        }
    }

    fn agent_fact(&mut self, agent: u32, fact: &'a AgentFact) {
        match fact {
            AgentFact::StartMoved { from } => {
                self.record(kind::START_MOVED, &[agent]);
                self.pose(*from);
            }
            AgentFact::RoadmapBuilt { samples, edges, components } => {
                self.record(kind::ROADMAP_BUILT, &[agent, *samples, *edges, *components]);
            }
            AgentFact::OutOfReach { cells } => {
                self.record(kind::OUT_OF_REACH, &[agent, cells.len() as u32]);
                self.cell_steps(cells.iter().copied());
            }
            AgentFact::Planned { goal, trajectory, effort, found_by } => {
                let Effort { roadmap_expansions, local_expansions } = *effort;
                let found_by = number_of(&FOUND_BY, found_by);
                let fields = [agent, self.cell(*goal), roadmap_expansions, local_expansions, found_by];
                self.record(kind::PLANNED, &fields);
                self.leg(agent, trajectory);
            }
            AgentFact::PlanFailed { goal, reason, effort, until } => {
                let Effort { roadmap_expansions, local_expansions } = *effort;
                let reason = number_of(&FAILURES, reason);
                let fields = [agent, self.cell(*goal), reason, roadmap_expansions, local_expansions];
                self.record(kind::PLAN_FAILED, &fields);
                // Times are stored as what they add to now, because small numbers take fewer bytes.
                append(&mut self.records, &(*until - self.now).as_nanos());
            }
            AgentFact::Dropped { goal, trajectory } => {
                self.record(kind::DROPPED, &[agent, self.cell(*goal)]);
                self.leg(agent, trajectory);
            }
            // One portion is the usual amount of a stop, so that this kind of record needs no number.
            AgentFact::Suppressing { cell, water_units: 1 } => {
                self.record(kind::SUPPRESSING, &[agent, self.cell(*cell)]);
            }
            AgentFact::Suppressing { cell, water_units } => {
                self.record(kind::SPRAYING, &[agent, self.cell(*cell), *water_units]);
            }
            AgentFact::SuppressionEnded { cell } => self.record(kind::SUPPRESSION_ENDED, &[agent, self.cell(*cell)]),
            AgentFact::Rested { reason } => self.record(kind::RESTED, &[agent, number_of(&REST_REASONS, reason)]),
            AgentFact::LocalMinimum { goal, x_m, y_m } => {
                self.record(kind::LOCAL_MINIMUM, &[agent, self.cell(*goal)]);
                [*x_m, *y_m].into_iter().for_each(|number| self.numbers.push(number));
            }
            AgentFact::Blocked { goal, by } => {
                self.record(kind::BLOCKED, &[agent, self.cell(*goal), self.agent(*by)]);
            }
            AgentFact::GaveWay { to, trajectory } => {
                self.record(kind::GAVE_WAY, &[agent, self.agent(*to)]);
                self.leg(agent, trajectory);
            }
            AgentFact::Relocated { x_m, y_m, trajectory, effort, found_by } => {
                let Effort { roadmap_expansions, local_expansions } = *effort;
                let found_by = number_of(&FOUND_BY, &Some(*found_by));
                self.record(kind::RELOCATED, &[agent, roadmap_expansions, local_expansions, found_by]);
                [*x_m, *y_m].into_iter().for_each(|number| self.numbers.push(number));
                self.leg(agent, trajectory);
            }
            AgentFact::Halted { trajectory } => {
                self.record(kind::HALTED, &[agent]);
                self.leg(agent, trajectory);
            }
            AgentFact::RelocationFailed { x_m, y_m, reason, effort, until } => {
                let Effort { roadmap_expansions, local_expansions } = *effort;
                // Zero stands for no reason, so the words count from one.
                let reason = reason.map_or(0, |reason| 1 + number_of(&FAILURES, &reason));
                let fields = [agent, reason, roadmap_expansions, local_expansions];
                self.record(kind::RELOCATION_FAILED, &fields);
                append(&mut self.records, &(*until - self.now).as_nanos());
                [*x_m, *y_m].into_iter().for_each(|number| self.numbers.push(number));
            }
            AgentFact::Refilling { until } => {
                self.record(kind::REFILLING, &[agent]);
                append(&mut self.records, &(*until - self.now).as_nanos());
            }
            AgentFact::Searched { phase, graph } => {
                let places = graph.places.len() as u32;
                let edges = graph.edges.len() as u32;
                self.record(kind::SEARCHED, &[agent, number_of(&PHASES, phase), places, edges]);
                append_graph(&mut self.records, graph);
            }
        }
    }

    fn agent(&self, id: AgentId) -> u32 {
        self.setting.agent_index(id).expect("the timeline was checked") as u32
    }

    fn cell(&self, cell: Cell) -> u32 {
        let Setting { bushes, frame, .. } = self.setting;
        self.setting.bush_index(cell).unwrap_or_else(|| bushes.len() + frame.index(cell)) as u32
    }

    fn cell_steps(&mut self, cells: impl Iterator<Item = Cell>) {
        let mut last = 0;
        for cell in cells {
            // Bushes and cells together are at most 2 * 4096 * 4096, which an `i32` holds.
            let number = self.cell(cell) as i32;
            append(&mut self.records, &(number - last));
            last = number;
        }
    }

    fn leg(&mut self, agent: u32, leg: &'a Trajectory) {
        let agent = agent as usize;
        let last = self.last_legs[agent].replace(leg);
        let stands = last.map_or(self.setting.agents[agent].pose, Trajectory::end);
        let mut pieces = leg.pieces();
        // A leg that is cut short repeats the beginning of the one that was planned.
        if let Some(last) = last.filter(|last| begin_alike(last, leg)) {
            let pairs = last.pieces().iter().zip(pieces);
            let shared = pairs.take_while(|(a, b)| pieces_equal(a, b)).count();
            pieces = &pieces[shared..];
            self.record(origin::LAST_START, &[shared as u32, pieces.len() as u32]);
        } else if bits(stands) == bits(leg.start()) && leg.start_time() >= self.now {
            // The usual case: no pose is stored, and the delay needs no sign.
            self.record(origin::LAST_END, &[]);
            append(&mut self.records, &(leg.start_time() - self.now).as_nanos());
            append(&mut self.records, &(pieces.len() as u32));
        } else {
            self.record(origin::ELSEWHERE, &[]);
            // A leg that is cut short began before the fact, so this delay has a sign.
            let delay_ns = leg.start_time().as_nanos().wrapping_sub(self.now.as_nanos()).cast_signed();
            append(&mut self.records, &delay_ns);
            append(&mut self.records, &(pieces.len() as u32));
            self.pose(leg.start());
        }
        for piece in pieces {
            let (kind, numbers) = piece_numbers(piece);
            append(&mut self.records, &kind);
            numbers.into_iter().flatten().for_each(|number| self.numbers.push(number));
        }
    }

    fn pose(&mut self, pose: Pose) {
        [pose.x, pose.y, pose.heading].into_iter().for_each(|number| self.numbers.push(number));
    }
}

fn cause(event: &Event) -> Option<Cause> {
    if let Fact::Fire(FireFact::Ignited { cause, .. }) = event.fact { Some(cause) } else { None }
}

/// Counts the facts, from the first on, that are cells which catch fire from one cell at one instant.
fn spread_together(events: &[Event]) -> usize {
    let first = cause(&events[0]).filter(|cause| matches!(cause, Cause::Spread(_)));
    if first.is_some() {
        events.iter().take_while(|event| event.time == events[0].time && cause(event) == first).count()
    } else {
        0
    }
}

fn begin_alike(last: &Trajectory, leg: &Trajectory) -> bool {
    last.start_time() == leg.start_time() && bits(last.start()) == bits(leg.start())
}

fn bits(pose: Pose) -> [u64; 3] {
    [pose.x, pose.y, pose.heading].map(f64::to_bits)
}

fn piece_numbers(piece: &Piece) -> (u32, [Option<f64>; 4]) {
    match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
            (piece::DRIVE, [segment.curvature, segment.length_m, speed_mps, acceleration_mps2].map(Some))
        }
        Piece::Turn { heading } => (piece::TURN, [Some(heading), None, None, None]),
        Piece::Wait { seconds } => (piece::WAIT, [Some(seconds), None, None, None]),
    }
}

/// Equal bit for bit, so that a zero keeps its sign.
fn pieces_equal(a: &Piece, b: &Piece) -> bool {
    let (kind_a, a) = piece_numbers(a);
    let (kind_b, b) = piece_numbers(b);
    kind_a == kind_b && a.map(|number| number.map(f64::to_bits)) == b.map(|number| number.map(f64::to_bits))
}

/// Reads facts from any bytes.
pub struct FactReader<'a> {
    setting: &'a Setting,
    now: SimTime,
    delays: &'a [u8],
    records: &'a [u8],
    numbers: NumberReader<'a>,
    events: Vec<Event>,
    /// By place among the agents: the fact that holds the agent's last leg.
    last_legs: Vec<Option<usize>>,
    pieces: usize,
    cells_out_of_reach: usize,
    search_places: usize,
    search_edges: usize,
}

impl<'a> FactReader<'a> {
    pub fn new(setting: &'a Setting, delays: &'a [u8], records: &'a [u8], numbers: NumberReader<'a>) -> Self {
        Self {
            setting,
            now: SimTime::ZERO,
            delays,
            records,
            numbers,
            events: Vec::new(),
            last_legs: vec![None; setting.agents.len()],
            pieces: 0,
            cells_out_of_reach: 0,
            search_places: 0,
            search_edges: 0,
        }
    }

    /// Reads `count` facts, which must use up all bytes; their values have not been checked yet.
    pub fn read(mut self, count: usize) -> Result<Vec<Event>, FileError> {
        while self.events.len() < count {
            let delay_ns = take(&mut self.delays)?;
            self.now = self.later(delay_ns)?;
            let kind = self.number()?;
            if kind == kind::SPREAD_TOGETHER {
                self.spread(count)?;
            } else {
                let fact = self.fact(kind)?;
                self.push(fact);
            }
        }
        let all_read = self.delays.is_empty() && self.records.is_empty() && self.numbers.is_finished();
        if all_read { Ok(self.events) } else { Err(FileError::Damaged("it contains more than its facts need")) }
    }

    fn push(&mut self, fact: Fact) {
        self.events.push(Event { time: self.now, fact });
    }

    fn spread(&mut self, count: usize) -> Result<(), FileError> {
        let cause = Cause::Spread(self.cell()?);
        let together = self.number()?;
        // No more than the number of facts in all, which has been limited.
        if together as usize > count - self.events.len() {
            return Err(FileError::Damaged("more fires spread in it than it has facts"));
        }
        for cell in self.cells(together)? {
            self.push(Fact::Fire(FireFact::Ignited { cell, cause }));
        }
        Ok(())
    }

    fn fact(&mut self, kind: u32) -> Result<Fact, FileError> {
        Ok(match kind {
            kind::IGNITED_BY_AGENT => {
                let cell = self.cell()?;
                Fact::Fire(FireFact::Ignited { cell, cause: Cause::Agent(self.agent()?.1) })
            }
            kind::SPREAD => {
                let cell = self.cell()?;
                Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(self.cell()?) })
            }
            kind::SPOTTED => {
                let cell = self.cell()?;
                Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spotted(self.cell()?) })
            }
            kind::SCHEDULED => Fact::Fire(FireFact::Ignited { cell: self.cell()?, cause: Cause::Scheduled }),
            kind::BURNED_OUT => Fact::Fire(FireFact::BurnedOut { cell: self.cell()? }),
            kind::EXTINGUISHED => Fact::Fire(FireFact::Extinguished { cell: self.cell()?, by: self.agent()?.1 }),
            kind::ENDED => Fact::Ended { reason: word_of(&END_REASONS, self.number()?)? },
            kind => {
                let (place, agent) = self.agent()?;
                Fact::Agent(agent, self.agent_fact(kind, place)?)
            }
        })
    }

    /// A fact of the agent at that place.
    fn agent_fact(&mut self, kind: u32, place: usize) -> Result<AgentFact, FileError> {
        Ok(match kind {
            kind::START_MOVED => AgentFact::StartMoved { from: self.pose()? },
            kind::ROADMAP_BUILT => {
                let samples = self.number()?;
                let edges = self.number()?;
                let components = self.number()?;
                AgentFact::RoadmapBuilt { samples, edges, components }
            }
            kind::OUT_OF_REACH => {
                let count = self.number()?;
                // Counted over all facts, as many lists take as much memory as one long one.
                self.cells_out_of_reach += count as usize;
                limit("cells out of reach", self.cells_out_of_reach, MAX_CELLS_OUT_OF_REACH)?;
                AgentFact::OutOfReach { cells: self.cells(count)? }
            }
            kind::PLANNED => {
                let (goal, effort) = (self.cell()?, self.effort()?);
                let found_by = word_of(&FOUND_BY, self.number()?)?;
                AgentFact::Planned { goal, trajectory: self.leg(place)?, effort, found_by }
            }
            kind::PLAN_FAILED => {
                let goal = self.cell()?;
                let reason = word_of(&FAILURES, self.number()?)?;
                let effort = self.effort()?;
                let charged_ns = take(&mut self.records)?;
                AgentFact::PlanFailed { goal, reason, effort, until: self.later(charged_ns)? }
            }
            kind::DROPPED => AgentFact::Dropped { goal: self.cell()?, trajectory: self.leg(place)? },
            kind::SUPPRESSING => AgentFact::Suppressing { cell: self.cell()?, water_units: 1 },
            kind::SPRAYING => {
                let cell = self.cell()?;
                let water_units = self.number()?;
                // A stop without a tank takes one portion, which is a record of another kind.
                let full_tank = self.setting.water.as_ref().map_or(0, |water| water.full_tank);
                if water_units > full_tank {
                    return Err(FileError::Impossible("a stop takes more water than a tank holds".into()));
                }
                AgentFact::Suppressing { cell, water_units }
            }
            kind::SUPPRESSION_ENDED => AgentFact::SuppressionEnded { cell: self.cell()? },
            kind::RESTED => AgentFact::Rested { reason: word_of(&REST_REASONS, self.number()?)? },
            kind::LOCAL_MINIMUM => {
                let goal = self.cell()?;
                AgentFact::LocalMinimum { goal, x_m: self.numbers.next()?, y_m: self.numbers.next()? }
            }
            kind::BLOCKED => AgentFact::Blocked { goal: self.cell()?, by: self.agent()?.1 },
            kind::GAVE_WAY => AgentFact::GaveWay { to: self.agent()?.1, trajectory: self.leg(place)? },
            kind::RELOCATED => {
                let effort = self.effort()?;
                let found_by = word_of(&FOUND_BY, self.number()?)?.ok_or(NO_SUCH_WORD)?;
                let x_m = self.numbers.next()?;
                let y_m = self.numbers.next()?;
                AgentFact::Relocated { x_m, y_m, trajectory: self.leg(place)?, effort, found_by }
            }
            kind::HALTED => AgentFact::Halted { trajectory: self.leg(place)? },
            kind::RELOCATION_FAILED => {
                let reason = self.number()?.checked_sub(1).map(|number| word_of(&FAILURES, number)).transpose()?;
                let effort = self.effort()?;
                let charged_ns = take(&mut self.records)?;
                let until = self.later(charged_ns)?;
                let x_m = self.numbers.next()?;
                let y_m = self.numbers.next()?;
                AgentFact::RelocationFailed { x_m, y_m, reason, effort, until }
            }
            kind::REFILLING => {
                let busy_ns = take(&mut self.records)?;
                AgentFact::Refilling { until: self.later(busy_ns)? }
            }
            kind::SEARCHED => AgentFact::Searched { phase: word_of(&PHASES, self.number()?)?, graph: self.graph()? },
            _ => return Err(NO_SUCH_WORD),
        })
    }

    fn number(&mut self) -> Result<u32, FileError> {
        take(&mut self.records)
    }

    fn later(&self, delay_ns: u64) -> Result<SimTime, FileError> {
        self.now.as_nanos().checked_add(delay_ns).map(SimTime::from_nanos).ok_or(NO_SUCH_TIME)
    }

    /// The place of an agent among all, and its name.
    fn agent(&mut self) -> Result<(usize, AgentId), FileError> {
        let place = self.number()? as usize;
        self.setting.agents.get(place).map(|agent| (place, agent.id)).ok_or(NO_SUCH_AGENT)
    }

    fn cell(&mut self) -> Result<Cell, FileError> {
        let number = self.number()?;
        self.cell_numbered(number)
    }

    /// The bush at a place among all, or, counting on after the bushes, the cell of an index that has none.
    fn cell_numbered(&self, number: u32) -> Result<Cell, FileError> {
        let Setting { bushes, frame, .. } = self.setting;
        let number = number as usize;
        let ground = |index: usize| {
            let cell = (index < frame.cell_count()).then(|| frame.cell(index));
            cell.filter(|&cell| self.setting.bush_index(cell).is_none())
        };
        let bush = bushes.get(number).copied();
        bush.or_else(|| ground(number - bushes.len())).ok_or(NO_SUCH_BUSH)
    }

    fn cells(&mut self, count: u32) -> Result<Vec<Cell>, FileError> {
        let mut number = 0_u32;
        let mut cells = Vec::new();
        for _ in 0..count {
            number = number.checked_add_signed(take(&mut self.records)?).ok_or(NO_SUCH_BUSH)?;
            cells.push(self.cell_numbered(number)?);
        }
        Ok(cells)
    }

    fn effort(&mut self) -> Result<Effort, FileError> {
        Ok(Effort { roadmap_expansions: self.number()?, local_expansions: self.number()? })
    }

    fn graph(&mut self) -> Result<SearchGraph, FileError> {
        let (places, edges) = (self.number()?, self.number()?);
        self.search_places += places as usize;
        self.search_edges += edges as usize;
        limit("places of searches", self.search_places, MAX_SEARCH_PLACES)?;
        limit("edges of searches", self.search_edges, MAX_SEARCH_EDGES)?;
        take_graph(&mut self.records, places, edges)
    }

    /// The leg of the fact that is being read, which comes after those that were.
    fn leg(&mut self, agent: usize) -> Result<Trajectory, FileError> {
        // The fact that is being read takes that place among the events.
        let last = self.last_legs[agent].replace(self.events.len());
        let last = last.and_then(|fact| self.events[fact].fact.trajectory());
        let last_end = last.map(Trajectory::end);
        let stands = self.setting.agents[agent].pose;
        let mut pieces = Vec::new();
        let (start_time, start, count) = match take(&mut self.records)? {
            origin::LAST_END => {
                let delay_ns = take(&mut self.records)?;
                // Before its first leg an agent is where it was set down.
                (self.later(delay_ns)?, last_end.unwrap_or(stands), self.number()?)
            }
            origin::LAST_START => {
                let last = last.ok_or(NO_SUCH_LEG)?;
                let shared: u32 = take(&mut self.records)?;
                // The number of shared pieces is from the file, and may be anything.
                pieces.extend_from_slice(last.pieces().get(..shared as usize).ok_or(NO_SUCH_LEG)?);
                (last.start_time(), last.start(), take(&mut self.records)?)
            }
            origin::ELSEWHERE => {
                let delay_ns = take(&mut self.records)?;
                let count = self.number()?;
                (SimTime::from_nanos(self.now.as_nanos().wrapping_add_signed(delay_ns)), self.pose()?, count)
            }
            _ => return Err(NO_SUCH_WORD),
        };
        // Shared pieces count as well: they take memory, but no bytes of the file.
        self.pieces += pieces.len() + count as usize;
        limit("pieces of legs", self.pieces, MAX_PIECES)?;
        for _ in 0..count {
            pieces.push(self.piece()?);
        }
        Ok(Trajectory::new(start_time, start, pieces))
    }

    fn piece(&mut self) -> Result<Piece, FileError> {
        Ok(match self.number()? {
            piece::DRIVE => {
                let segment = Segment { curvature: self.numbers.next()?, length_m: self.numbers.next()? };
                let speed_mps = self.numbers.next()?;
                let acceleration_mps2 = self.numbers.next()?;
                Piece::Drive { segment, speed_mps, acceleration_mps2 }
            }
            piece::TURN => Piece::Turn { heading: self.numbers.next()? },
            piece::WAIT => Piece::Wait { seconds: self.numbers.next()? },
            _ => return Err(NO_SUCH_WORD),
        })
    }

    fn pose(&mut self) -> Result<Pose, FileError> {
        Ok(Pose { x: self.numbers.next()?, y: self.numbers.next()?, heading: self.numbers.next()? })
    }
}
