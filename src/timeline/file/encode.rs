//! From a timeline to the payload of a recording.

use super::graphs::append_graph;
use super::numbers::NumberWriter;
use super::records::{Leg, Origin, Payload, PieceKind, Record, Supplement, append};
use crate::geometry::{Cell, Pose};
use crate::time::SimTime;
use crate::timeline::{AgentFact, AgentId, Cause, Fact, FireFact, Setting, Timeline};
use crate::trajectory::{Piece, Trajectory};

/// The payload of a timeline that has passed [`super::check::check`].
pub fn encode(timeline: &Timeline) -> Vec<u8> {
    let mut encoder = Encoder::new(&timeline.setting);
    for event in &timeline.events {
        encoder.fact(event.time, &event.fact);
    }
    encoder.payload(timeline)
}

struct Encoder<'a> {
    setting: &'a Setting,
    now: SimTime,
    delays: Vec<u8>,
    records: Vec<u8>,
    numbers: NumberWriter,
    /// By place among the agents.
    last_legs: Vec<Option<&'a Trajectory>>,
}

impl<'a> Encoder<'a> {
    fn new(setting: &'a Setting) -> Self {
        Self {
            setting,
            now: SimTime::ZERO,
            delays: Vec::new(),
            records: Vec::new(),
            numbers: NumberWriter::default(),
            last_legs: vec![None; setting.agents.len()],
        }
    }

    fn fact(&mut self, time: SimTime, fact: &'a Fact) {
        append(&mut self.delays, &(time - self.now).as_nanos());
        self.now = time;
        let record = self.record(fact);
        append(&mut self.records, &record);
        match fact {
            Fact::Agent(_, AgentFact::StartMoved { from, .. }) => self.pose(*from),
            Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => self.cells(cells),
            Fact::Agent(_, AgentFact::LocalMinimum { x_m, y_m, .. }) => {
                [*x_m, *y_m].into_iter().for_each(|number| self.numbers.push(number));
            }
            Fact::Agent(agent, AgentFact::Planned { trajectory, .. })
            | Fact::Agent(agent, AgentFact::Dropped { trajectory, .. })
            | Fact::Agent(agent, AgentFact::GaveWay { trajectory, .. }) => self.leg(*agent, trajectory),
            Fact::Agent(_, AgentFact::Searched { graph, .. }) => append_graph(&mut self.records, graph),
            _ => {}
        }
    }

    fn record(&self, fact: &Fact) -> Record {
        let agent = |id: AgentId| self.setting.agent_index(id).expect("the timeline was checked") as u32;
        let bush = |cell: Cell| self.bush(cell);
        match *fact {
            Fact::Agent(id, AgentFact::StartMoved { .. }) => Record::StartMoved { agent: agent(id) },
            Fact::Agent(id, AgentFact::RoadmapBuilt { samples, edges, components }) => {
                Record::RoadmapBuilt { agent: agent(id), samples, edges, components }
            }
            Fact::Agent(id, AgentFact::OutOfReach { ref cells }) => {
                Record::OutOfReach { agent: agent(id), count: cells.len() as u32 }
            }
            Fact::Fire(FireFact::Ignited { cell, cause: Cause::Lit(id) }) => {
                Record::Lit { bush: bush(cell), agent: agent(id) }
            }
            Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(from) }) => {
                Record::Spread { bush: bush(cell), from: bush(from) }
            }
            Fact::Fire(FireFact::Ignited { cell, cause: Cause::Scheduled }) => Record::Scheduled { bush: bush(cell) },
            Fact::Fire(FireFact::BurnedOut { cell }) => Record::BurnedOut { bush: bush(cell) },
            Fact::Fire(FireFact::Extinguished { cell, by }) => {
                Record::Extinguished { bush: bush(cell), agent: agent(by) }
            }
            Fact::Agent(id, AgentFact::Planned { goal, effort, by_lattice, .. }) => {
                Record::Planned { agent: agent(id), bush: bush(goal), effort, by_lattice }
            }
            Fact::Agent(id, AgentFact::PlanFailed { goal, reason, effort, until }) => {
                let charged_ns = (until - self.now).as_nanos();
                Record::PlanFailed { agent: agent(id), bush: bush(goal), reason, effort, charged_ns }
            }
            Fact::Agent(id, AgentFact::Dropped { goal, .. }) => Record::Dropped { agent: agent(id), bush: bush(goal) },
            Fact::Agent(id, AgentFact::Suppressing { cell }) => {
                Record::Suppressing { agent: agent(id), bush: bush(cell) }
            }
            Fact::Agent(id, AgentFact::SuppressionEnded { cell }) => {
                Record::SuppressionEnded { agent: agent(id), bush: bush(cell) }
            }
            Fact::Agent(id, AgentFact::Rested { reason }) => Record::Rested { agent: agent(id), reason },
            Fact::Agent(id, AgentFact::LocalMinimum { goal, .. }) => {
                Record::LocalMinimum { agent: agent(id), bush: bush(goal) }
            }
            Fact::Agent(id, AgentFact::Blocked { goal, by }) => {
                Record::Blocked { agent: agent(id), bush: bush(goal), by: agent(by) }
            }
            Fact::Agent(id, AgentFact::GaveWay { to, .. }) => Record::GaveWay { agent: agent(id), to: agent(to) },
            Fact::Agent(id, AgentFact::Searched { phase, ref graph }) => {
                let (places, edges) = (graph.places.len() as u32, graph.edges.len() as u32);
                Record::Searched { agent: agent(id), phase, places, edges }
            }
            Fact::Ended { reason } => Record::Ended { reason },
        }
    }

    fn bush(&self, cell: Cell) -> u32 {
        self.setting.bush_index(cell).expect("the timeline was checked") as u32
    }

    fn cells(&mut self, cells: &[Cell]) {
        let mut last = 0;
        for &cell in cells {
            let bush = self.bush(cell) as i32;
            append(&mut self.records, &(bush - last));
            last = bush;
        }
    }

    fn leg(&mut self, agent: AgentId, leg: &'a Trajectory) {
        let agent = self.setting.agent_index(agent).expect("the timeline was checked");
        let last = self.last_legs[agent].replace(leg);
        let origin = self.origin(self.setting.agents[agent].pose, last, leg);
        let shared = if let Origin::LastStart { shared } = origin { shared as usize } else { 0 };
        let pieces = &leg.pieces()[shared..];
        let elsewhere = matches!(origin, Origin::Elsewhere { .. });
        append(&mut self.records, &Leg { origin, pieces: pieces.len() as u32 });
        if elsewhere {
            self.pose(leg.start());
        }
        pieces.iter().for_each(|piece| self.piece(piece));
    }

    fn origin(&self, start: Pose, last: Option<&Trajectory>, leg: &Trajectory) -> Origin {
        if let Some(last) = last.filter(|last| begin_alike(last, leg)) {
            let pairs = last.pieces().iter().zip(leg.pieces());
            return Origin::LastStart { shared: pairs.take_while(|(a, b)| pieces_equal(a, b)).count() as u32 };
        }
        let stands = last.map_or(start, Trajectory::end);
        if bits(stands) == bits(leg.start()) && leg.start_time() >= self.now {
            return Origin::LastEnd { delay_ns: (leg.start_time() - self.now).as_nanos() };
        }
        let delay_ns = leg.start_time().as_nanos().wrapping_sub(self.now.as_nanos()).cast_signed();
        Origin::Elsewhere { delay_ns }
    }

    fn piece(&mut self, piece: &Piece) {
        let kind = match *piece {
            Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                let numbers = [segment.curvature, segment.length_m, speed_mps, acceleration_mps2];
                numbers.into_iter().for_each(|number| self.numbers.push(number));
                PieceKind::Drive
            }
            Piece::Turn { heading } => {
                self.numbers.push(heading);
                PieceKind::Turn
            }
            Piece::Wait { seconds } => {
                self.numbers.push(seconds);
                PieceKind::Wait
            }
        };
        append(&mut self.records, &kind);
    }

    fn pose(&mut self, pose: Pose) {
        [pose.x, pose.y, pose.heading].into_iter().for_each(|number| self.numbers.push(number));
    }

    fn payload(&self, timeline: &Timeline) -> Vec<u8> {
        let setting = self.setting;
        let numbers = self.numbers.coded();
        let indices = setting.bushes.iter().map(|&bush| setting.frame.index(bush) as u32);
        let mut last = 0;
        let bush_steps = indices.map(|index| index - std::mem::replace(&mut last, index)).collect();
        let mut bytes = Vec::new();
        let payload = Payload {
            scenario: &setting.scenario,
            seed: setting.seed,
            program_version: &setting.program_version,
            frame: setting.frame,
            bush_steps,
            agents: setting.agents.iter().map(Into::into).collect(),
            rules: setting.rules.into(),
            facts: timeline.events.len() as u32,
            delays: &self.delays,
            records: &self.records,
            recurring_numbers: numbers.recurring,
            single_numbers: numbers.single,
            number_references: &numbers.references,
        };
        append(&mut bytes, &payload);
        append(&mut bytes, &Supplement::from(setting));
        bytes
    }
}

fn begin_alike(last: &Trajectory, leg: &Trajectory) -> bool {
    last.start_time() == leg.start_time() && bits(last.start()) == bits(leg.start())
}

fn bits(pose: Pose) -> [u64; 3] {
    [pose.x, pose.y, pose.heading].map(f64::to_bits)
}

/// Equal bit for bit, so that a zero keeps its sign.
fn pieces_equal(a: &Piece, b: &Piece) -> bool {
    let bits = |piece: &Piece| match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
            [segment.curvature, segment.length_m, speed_mps, acceleration_mps2].map(f64::to_bits)
        }
        Piece::Turn { heading } => [heading.to_bits(), 0, 0, 0],
        Piece::Wait { seconds } => [seconds.to_bits(), 0, 0, 0],
    };
    std::mem::discriminant(a) == std::mem::discriminant(b) && bits(a) == bits(b)
}
