//! The records of an unfinished run: its facts, and the CPU time of its decisions.

use std::time::Duration;

use bevy_ecs::prelude::*;

use wildfire_base::time::SimTime;
use wildfire_planning::PlanFailure;
use wildfire_planning::memory::{CapacityBytes, MemoryKind, MemoryMeter, MemoryShare};
use wildfire_planning::search_recorder::Searched;
use wildfire_timeline::{AgentFact, AgentId, CpuSample, Event, Fact, FireFact, GroundEvent};

use super::run::FailureMessages;

/// Places and edges of all searches of a run together; what searches look at after that is not kept, so that the run
/// fits the memory and a recording.
const MAX_RECORDED: usize = 4_000_000;

/// The facts so far.
#[derive(Resource, Clone, Debug)]
pub struct Recorder {
    pub events: Vec<Event>,
    pub ground: Vec<GroundEvent>,
    /// CPU time of each planner answer among the events, in their order.
    pub answer_cpu: Vec<Duration>,
    /// Notes on failed queries.
    pub messages: FailureMessages,
    /// True if searches are to be recorded.
    pub records_searches: bool,
    /// Places and edges of searches.
    searched: usize,
    /// Bytes of what facts hold beside themselves.
    beside: usize,
    memory: MemoryShare,
}

impl Recorder {
    pub fn new(memory: &MemoryMeter, records_searches: bool) -> Self {
        let memory = memory.holder(MemoryKind::Timeline);
        let messages = FailureMessages::default();
        Self {
            events: Vec::new(),
            ground: Vec::new(),
            answer_cpu: Vec::new(),
            messages,
            records_searches,
            searched: 0,
            beside: 0,
            memory,
        }
    }

    /// Counts its memory on another meter from now on.
    pub fn count_on(&mut self, memory: &MemoryMeter) {
        self.memory = memory.holder(MemoryKind::Timeline);
        self.memory.cover(self.events.bytes_after(0) + self.ground.bytes_after(0) + self.beside);
    }

    /// Adds a fact. If memory is exhausted, the fact is dropped and the run is over.
    pub fn record(&mut self, time: SimTime, fact: Fact) {
        let beside = self.beside + bytes_beside(&fact);
        if self.memory.cover(self.events.bytes_after(1) + self.ground.bytes_after(0) + beside) {
            self.beside = beside;
            self.events.push(Event { time, fact });
        }
    }

    pub fn record_agent(&mut self, time: SimTime, agent: AgentId, fact: AgentFact) {
        self.record(time, Fact::Agent(agent, fact));
    }

    /// Adds the answer to a planner query, and its cost.
    pub fn record_answer(&mut self, time: SimTime, agent: AgentId, fact: AgentFact, cpu: Duration) {
        let events = self.events.len();
        self.record_agent(time, agent, fact);
        // An answer without room is no event, so it has no cost either.
        self.answer_cpu.extend((self.events.len() > events).then_some(cpu));
    }

    pub fn record_fire(&mut self, time: SimTime, fact: FireFact) {
        self.record(time, Fact::Fire(fact));
    }

    /// Adds a change of a ground cell under the same conditions.
    pub fn record_ground(&mut self, event: GroundEvent) {
        if self.memory.cover(self.events.bytes_after(0) + self.ground.bytes_after(1) + self.beside) {
            self.ground.push(event);
        }
    }

    /// Keeps notes on a failed query, if there are any.
    pub fn note_failure(&mut self, time: SimTime, agent: AgentId, failure: PlanFailure, message: Option<&str>) {
        if let Some(message) = message {
            self.messages.add(&agent.to_string(), time, failure, message);
        }
    }

    /// Adds what the searches of a plan examined.
    pub fn record_searches(&mut self, time: SimTime, agent: AgentId, searched: impl IntoIterator<Item = Searched>) {
        for Searched { phase, graph } in searched {
            self.searched += graph.places.len() + graph.edges.len();
            if self.searched <= MAX_RECORDED {
                self.record_agent(time, agent, AgentFact::Searched { phase, graph });
            }
        }
    }
}

/// Bytes of what a fact holds beside itself; a leg twice, because whoever drives it has it too.
fn bytes_beside(fact: &Fact) -> usize {
    let Fact::Agent(_, fact) = fact else { return 0 };
    match fact {
        AgentFact::OutOfReach { cells, .. } => size_of_val(&cells[..]),
        AgentFact::Searched { graph, .. } => size_of_val(&graph.places[..]) + size_of_val(&graph.edges[..]),
        _ => fact.trajectory().map_or(0, |leg| 2 * size_of_val(leg.pieces())),
    }
}

/// CPU time spent on decisions so far.
#[derive(Resource, Clone, Debug, Default)]
pub struct CpuLog(pub Vec<CpuSample>);

impl CpuLog {
    /// Adds the CPU time of a decision, if it took any.
    pub fn add(&mut self, time: SimTime, agent: AgentId, cpu: Duration) {
        if !cpu.is_zero() {
            self.0.push(CpuSample { time, agent, cpu });
        }
    }
}
