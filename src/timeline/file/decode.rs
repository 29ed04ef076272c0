//! From the payload of a recording to a timeline, whatever its bytes say.

use super::FileError;
use super::check::{
    MAX_CELLS_OUT_OF_REACH, MAX_FACTS, MAX_PIECES, MAX_SEARCH_EDGES, MAX_SEARCH_PLACES, MAX_SIDE, limit,
};
use super::graphs::take_graph;
use super::numbers::NumberReader;
use super::records::{Leg, Origin, Payload, PieceKind, Record, Supplement, take};
use crate::geometry::{Cell, FieldFrame, Pose};
use crate::planning::SearchGraph;
use crate::time::SimTime;
use crate::timeline::{AgentFact, AgentId, Cause, Event, Fact, FireFact, Setting, Timeline};
use crate::trajectory::{Piece, Trajectory};
use crate::vehicle::Segment;

const NO_SUCH_BUSH: FileError = FileError::Damaged("it refers to a bush that it does not hold");
const NO_SUCH_AGENT: FileError = FileError::Damaged("it refers to an agent that it does not hold");
const NO_SUCH_LEG: FileError = FileError::Damaged("it refers to a leg that it does not hold");
const NO_SUCH_TIME: FileError = FileError::Damaged("it holds a time beyond all times");
const LEFT_OVER: FileError = FileError::Damaged("it holds more than its facts need");

/// The first format with a [`Supplement`].
const SUPPLEMENTED: u16 = 3;

/// The timeline of a payload of this format; its values are still to be checked.
pub fn decode(format: u16, mut bytes: &[u8]) -> Result<Timeline, FileError> {
    let payload: Payload<'_> = take(&mut bytes)?;
    limit("facts", payload.facts as usize, MAX_FACTS)?;
    let supplement = if format < SUPPLEMENTED { Supplement::default() } else { take(&mut bytes)? };
    let setting = setting(&payload, &supplement)?;
    let mut decoder = Decoder::new(&setting, &payload);
    let mut events = Vec::new();
    for _ in 0..payload.facts {
        let event = decoder.event(&events)?;
        events.push(event);
    }
    if !bytes.is_empty() || !decoder.is_finished() {
        return Err(LEFT_OVER);
    }
    Ok(Timeline { setting, events })
}

fn setting(payload: &Payload<'_>, supplement: &Supplement) -> Result<Setting, FileError> {
    let frame = payload.frame;
    limit("cells along a side", frame.cols.max(frame.rows).into(), MAX_SIDE)?;
    Ok(Setting {
        scenario: payload.scenario.into(),
        seed: payload.seed,
        program_version: payload.program_version.into(),
        frame,
        bushes: bushes(frame, &payload.bush_steps)?,
        agents: supplement.agents(&payload.agents),
        rules: supplement.rules(&payload.rules),
    })
}

fn bushes(frame: FieldFrame, steps: &[u32]) -> Result<Vec<Cell>, FileError> {
    let mut index = 0_usize;
    let bush = |&step: &u32| {
        index = index.checked_add(step as usize).filter(|&index| index < frame.cell_count()).ok_or(NO_SUCH_BUSH)?;
        Ok(frame.cell(index))
    };
    steps.iter().map(bush).collect()
}

struct Decoder<'a> {
    setting: &'a Setting,
    now: SimTime,
    delays: &'a [u8],
    records: &'a [u8],
    numbers: NumberReader<'a>,
    /// By place among the agents: the fact that holds the agent's last leg.
    last_legs: Vec<Option<usize>>,
    pieces: usize,
    cells_out_of_reach: usize,
    search_places: usize,
    search_edges: usize,
}

impl<'a> Decoder<'a> {
    fn new(setting: &'a Setting, payload: &'a Payload<'_>) -> Self {
        let numbers = NumberReader::new(&payload.recurring_numbers, &payload.single_numbers, payload.number_references);
        Self {
            setting,
            now: SimTime::ZERO,
            delays: payload.delays,
            records: payload.records,
            numbers,
            last_legs: vec![None; setting.agents.len()],
            pieces: 0,
            cells_out_of_reach: 0,
            search_places: 0,
            search_edges: 0,
        }
    }

    fn is_finished(&self) -> bool {
        self.delays.is_empty() && self.records.is_empty() && self.numbers.is_finished()
    }

    fn event(&mut self, past: &[Event]) -> Result<Event, FileError> {
        let delay_ns = take(&mut self.delays)?;
        self.now = self.later(delay_ns)?;
        Ok(Event { time: self.now, fact: self.fact(past)? })
    }

    fn fact(&mut self, past: &[Event]) -> Result<Fact, FileError> {
        Ok(match take(&mut self.records)? {
            Record::StartMoved { agent } => {
                Fact::Agent(self.agent(agent)?, AgentFact::StartMoved { from: self.pose()? })
            }
            Record::RoadmapBuilt { agent, samples, edges, components } => {
                Fact::Agent(self.agent(agent)?, AgentFact::RoadmapBuilt { samples, edges, components })
            }
            Record::OutOfReach { agent, count } => {
                Fact::Agent(self.agent(agent)?, AgentFact::OutOfReach { cells: self.cells(count)? })
            }
            Record::Lit { bush, agent } => {
                Fact::Fire(FireFact::Ignited { cell: self.bush(bush)?, cause: Cause::Lit(self.agent(agent)?) })
            }
            Record::Spread { bush, from } => {
                Fact::Fire(FireFact::Ignited { cell: self.bush(bush)?, cause: Cause::Spread(self.bush(from)?) })
            }
            Record::Scheduled { bush } => {
                Fact::Fire(FireFact::Ignited { cell: self.bush(bush)?, cause: Cause::Scheduled })
            }
            Record::BurnedOut { bush } => Fact::Fire(FireFact::BurnedOut { cell: self.bush(bush)? }),
            Record::Extinguished { bush, agent } => {
                Fact::Fire(FireFact::Extinguished { cell: self.bush(bush)?, by: self.agent(agent)? })
            }
            Record::Planned { agent, bush, effort, by_lattice } => {
                let (trajectory, goal) = (self.leg(agent, past)?, self.bush(bush)?);
                Fact::Agent(self.agent(agent)?, AgentFact::Planned { goal, trajectory, effort, by_lattice })
            }
            Record::PlanFailed { agent, bush, reason, effort, charged_ns } => {
                let (agent, goal, until) = (self.agent(agent)?, self.bush(bush)?, self.later(charged_ns)?);
                Fact::Agent(agent, AgentFact::PlanFailed { goal, reason, effort, until })
            }
            Record::Dropped { agent, bush } => {
                let (trajectory, goal) = (self.leg(agent, past)?, self.bush(bush)?);
                Fact::Agent(self.agent(agent)?, AgentFact::Dropped { goal, trajectory })
            }
            Record::Suppressing { agent, bush } => {
                Fact::Agent(self.agent(agent)?, AgentFact::Suppressing { cell: self.bush(bush)? })
            }
            Record::SuppressionEnded { agent, bush } => {
                Fact::Agent(self.agent(agent)?, AgentFact::SuppressionEnded { cell: self.bush(bush)? })
            }
            Record::Rested { agent, reason } => Fact::Agent(self.agent(agent)?, AgentFact::Rested { reason }),
            Record::Searched { agent, phase, places, edges } => {
                Fact::Agent(self.agent(agent)?, AgentFact::Searched { phase, graph: self.graph(places, edges)? })
            }
            Record::Ended { reason } => Fact::Ended { reason },
            Record::Blocked { agent, bush, by } => {
                Fact::Agent(self.agent(agent)?, AgentFact::Blocked { goal: self.bush(bush)?, by: self.agent(by)? })
            }
            Record::GaveWay { agent, to } => {
                let trajectory = self.leg(agent, past)?;
                Fact::Agent(self.agent(agent)?, AgentFact::GaveWay { to: self.agent(to)?, trajectory })
            }
            Record::LocalMinimum { agent, bush } => {
                let (x_m, y_m) = (self.numbers.next()?, self.numbers.next()?);
                Fact::Agent(self.agent(agent)?, AgentFact::LocalMinimum { goal: self.bush(bush)?, x_m, y_m })
            }
        })
    }

    fn later(&self, delay_ns: u64) -> Result<SimTime, FileError> {
        self.now.as_nanos().checked_add(delay_ns).map(SimTime::from_nanos).ok_or(NO_SUCH_TIME)
    }

    fn agent(&self, place: u32) -> Result<AgentId, FileError> {
        self.setting.agents.get(place as usize).map(|agent| agent.id).ok_or(NO_SUCH_AGENT)
    }

    fn bush(&self, place: u32) -> Result<Cell, FileError> {
        self.setting.bushes.get(place as usize).copied().ok_or(NO_SUCH_BUSH)
    }

    fn cells(&mut self, count: u32) -> Result<Vec<Cell>, FileError> {
        self.cells_out_of_reach += count as usize;
        limit("cells out of reach", self.cells_out_of_reach, MAX_CELLS_OUT_OF_REACH)?;
        let mut place = 0_u32;
        let mut cells = Vec::new();
        for _ in 0..count {
            place = place.checked_add_signed(take(&mut self.records)?).ok_or(NO_SUCH_BUSH)?;
            cells.push(self.bush(place)?);
        }
        Ok(cells)
    }

    fn graph(&mut self, places: u32, edges: u32) -> Result<SearchGraph, FileError> {
        self.search_places += places as usize;
        self.search_edges += edges as usize;
        limit("places of searches", self.search_places, MAX_SEARCH_PLACES)?;
        limit("edges of searches", self.search_edges, MAX_SEARCH_EDGES)?;
        take_graph(&mut self.records, places, edges)
    }

    /// The leg of the fact that is being read, which will come after those in `past`.
    fn leg(&mut self, agent: u32, past: &[Event]) -> Result<Trajectory, FileError> {
        let agent = agent as usize;
        let start = self.setting.agents.get(agent).ok_or(NO_SUCH_AGENT)?.pose;
        let last = self.last_legs[agent].replace(past.len()).and_then(|fact| past[fact].fact.trajectory());
        let Leg { origin, pieces } = take(&mut self.records)?;
        let (start_time, start, shared) = match origin {
            Origin::LastEnd { delay_ns } => (self.later(delay_ns)?, last.map_or(start, Trajectory::end), &[][..]),
            Origin::LastStart { shared } => {
                let last = last.ok_or(NO_SUCH_LEG)?;
                let shared = last.pieces().get(..shared as usize).ok_or(NO_SUCH_LEG)?;
                (last.start_time(), last.start(), shared)
            }
            Origin::Elsewhere { delay_ns } => {
                let start_time = self.now.as_nanos().wrapping_add_signed(delay_ns);
                (SimTime::from_nanos(start_time), self.pose()?, &[][..])
            }
        };
        self.pieces += shared.len() + pieces as usize;
        limit("pieces of legs", self.pieces, MAX_PIECES)?;
        let mut all = shared.to_vec();
        for _ in 0..pieces {
            all.push(self.piece()?);
        }
        Ok(Trajectory::new(start_time, start, all))
    }

    fn piece(&mut self) -> Result<Piece, FileError> {
        Ok(match take(&mut self.records)? {
            PieceKind::Drive => {
                let segment = Segment { curvature: self.numbers.next()?, length_m: self.numbers.next()? };
                let (speed_mps, acceleration_mps2) = (self.numbers.next()?, self.numbers.next()?);
                Piece::Drive { segment, speed_mps, acceleration_mps2 }
            }
            PieceKind::Turn => Piece::Turn { heading: self.numbers.next()? },
            PieceKind::Wait => Piece::Wait { seconds: self.numbers.next()? },
        })
    }

    fn pose(&mut self) -> Result<Pose, FileError> {
        Ok(Pose { x: self.numbers.next()?, y: self.numbers.next()?, heading: self.numbers.next()? })
    }
}
