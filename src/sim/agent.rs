//! What Wumpuses and trucks have in common: a body on a trajectory, a goal, a mind that can change.

use std::time::Duration;

use bevy::prelude::*;

use crate::geometry::{Cell, Pose};
use crate::planning::Searched;
use crate::planning::memory::{BytesAfter, Growing, Held, MemoryMeter};
use crate::time::SimTime;
use crate::timeline::{AgentFact, AgentId, CpuSample, Event, Fact, RestReason};
use crate::trajectory::Trajectory;

use super::agenda::{Agenda, Call, Due};

/// What an agent is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// It stands without a goal.
    Idle,
    /// It stands while planning time is charged.
    Planning,
    Moving,
    Suppressing,
}

/// An agent of the contest.
#[derive(Component, Debug)]
pub struct Agent {
    pub id: AgentId,
    /// Bumped whenever the agent changes its mind; calls that carry an older one are void.
    pub revision: u32,
    pub activity: Activity,
    pub goal: Option<Cell>,
    /// The last leg: it moves along it, or stands at its end.
    pub trajectory: Trajectory,
    /// Why it rests, if it does.
    pub rests: Option<RestReason>,
}

impl Agent {
    pub fn standing(id: AgentId, pose: Pose) -> Self {
        Self {
            id,
            revision: 0,
            activity: Activity::Idle,
            goal: None,
            trajectory: Trajectory::new(SimTime::ZERO, pose, Vec::new()),
            rests: None,
        }
    }

    pub fn call(&self, entity: Entity) -> Call {
        Call { agent: entity, revision: self.revision }
    }

    /// Voids what was planned and asks for a decision.
    pub fn reconsider(&mut self, entity: Entity, at: SimTime, agenda: &mut Agenda) {
        self.revision += 1;
        agenda.add(at, Due::Decision(self.call(entity)));
    }

    /// Gives up the goal on the way; the leg as it is really driven is `cut`, and the next decision falls at its end.
    pub fn break_off(&mut self, entity: Entity, now: SimTime, cut: Trajectory, agenda: &mut Agenda, log: &mut Log) {
        let goal = self.goal.take().expect("only an agent with a goal drops one");
        log.add(now, Fact::Agent(self.id, AgentFact::Dropped { goal, trajectory: cut.clone() }));
        let stands_at = cut.end_time().max(now);
        self.activity = if stands_at > now { Activity::Moving } else { Activity::Idle };
        self.trajectory = cut;
        self.reconsider(entity, stands_at, agenda);
    }

    /// Sets out for a goal; `trajectory` begins when planning time is over.
    pub fn set_out(&mut self, entity: Entity, now: SimTime, goal: Cell, trajectory: Trajectory, agenda: &mut Agenda) {
        self.revision += 1;
        self.goal = Some(goal);
        self.rests = None;
        self.activity = Activity::Moving;
        if trajectory.start_time() > now {
            self.activity = Activity::Planning;
            agenda.add(trajectory.start_time(), Due::PlanningDone(self.call(entity)));
        }
        self.trajectory = trajectory;
    }

    /// Stands for the planning time of a plan that failed, and decides again.
    pub fn think_until(&mut self, entity: Entity, time: SimTime, agenda: &mut Agenda) {
        self.revision += 1;
        self.rests = None;
        self.activity = Activity::Planning;
        agenda.add(time, Due::PlanningDone(self.call(entity)));
    }

    /// Rests without a goal until something wakes it.
    pub fn rest(&mut self, now: SimTime, reason: RestReason, log: &mut Log) {
        self.activity = Activity::Idle;
        self.goal = None;
        if self.rests != Some(reason) {
            self.rests = Some(reason);
            log.add(now, Fact::Agent(self.id, AgentFact::Rested { reason }));
        }
    }
}

/// Places and edges of all searches of a run together; what searches look at after that is not kept, so that the run
/// fits the memory and a recording.
const MAX_RECORDED: usize = 4_000_000;

/// The facts so far.
#[derive(Resource, Debug)]
pub struct Log {
    pub events: Vec<Event>,
    /// True if searches are to be recorded.
    pub records_searches: bool,
    /// Places and edges of searches.
    recorded: usize,
    /// Bytes of what facts hold beside themselves.
    beside: usize,
    memory: Held,
}

impl Log {
    pub fn new(memory: &MemoryMeter, records_searches: bool) -> Self {
        let memory = memory.holder(Growing::Timeline);
        Self { events: Vec::new(), records_searches, recorded: 0, beside: 0, memory }
    }

    /// Adds a fact. If there is no memory for it, it is left out and the run is over.
    pub fn add(&mut self, time: SimTime, fact: Fact) {
        let beside = self.beside + bytes_beside(&fact);
        if self.memory.cover(self.events.bytes_after(1) + beside) {
            self.beside = beside;
            self.events.push(Event { time, fact });
        }
    }

    /// Adds what the searches of a plan looked at.
    pub fn add_searches(&mut self, time: SimTime, agent: AgentId, searched: impl IntoIterator<Item = Searched>) {
        for Searched { phase, graph } in searched {
            self.recorded += graph.places.len() + graph.edges.len();
            if self.recorded <= MAX_RECORDED {
                self.add(time, Fact::Agent(agent, AgentFact::Searched { phase, graph }));
            }
        }
    }
}

/// Bytes of what a fact holds beside itself; a leg twice, because whoever drives it has it too.
fn bytes_beside(fact: &Fact) -> usize {
    match fact {
        Fact::Agent(_, AgentFact::Planned { trajectory, .. })
        | Fact::Agent(_, AgentFact::Dropped { trajectory, .. })
        | Fact::Agent(_, AgentFact::GaveWay { trajectory, .. }) => 2 * size_of_val(trajectory.pieces()),
        Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => size_of_val(&cells[..]),
        Fact::Agent(_, AgentFact::Searched { graph, .. }) => {
            size_of_val(&graph.places[..]) + size_of_val(&graph.edges[..])
        }
        _ => 0,
    }
}

/// CPU time spent on decisions so far.
#[derive(Resource, Debug, Default)]
pub struct Ledger(pub Vec<CpuSample>);

impl Ledger {
    /// Adds what a decision took, if anything.
    pub fn add(&mut self, time: SimTime, agent: AgentId, cpu: Duration) {
        if !cpu.is_zero() {
            self.0.push(CpuSample { time, agent, cpu });
        }
    }
}

/// The agents in the order in which loops visit them: by kind, then by number.
#[derive(Resource, Debug, Default)]
pub struct Roster {
    pub wumpuses: Vec<Entity>,
    pub trucks: Vec<Entity>,
}

impl Roster {
    pub fn all(&self) -> impl Iterator<Item = Entity> + '_ {
        self.wumpuses.iter().chain(&self.trucks).copied()
    }
}
