//! The queue of events, and their order at one instant.

use bevy_ecs::prelude::*;

use wildfire_base::event_queue::EventQueue;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireEvent;
use wildfire_timeline::{AgentId, Cause};

/// The order of events at one instant. It is part of the contest's rules; the first two ranks make sure that every
/// agent has heard of a change before the next event of the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    Woken,
    Change,
    Extinction,
    BurnOut,
    Drying,
    Spread,
    Ignition,
    Arrival,
    PlanningDone,
    Decision,
    Deadlock,
    Line,
    End,
}

/// The addressee of an event. The event is void if the agent has changed its mind since, that is, has another revision.
#[derive(Clone, Copy, Debug)]
pub struct Wake {
    pub agent: Entity,
    pub revision: u32,
}

/// An event for one agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AgentEvent {
    /// Something has changed that the agent may respond to.
    Replan,
    /// The goal is no longer worth going for.
    GoalLost,
    /// A truck has stood at a fire long enough.
    DwellEnd,
    /// A Wumpus is within reach of its goal.
    Lighting,
    /// A truck has arrived where it will suppress.
    Arrival,
    /// Charged planning time is over.
    PlanningDone,
    Decision,
    /// A truck is blocked by others.
    Deadlock,
}

/// A change of a cell that takes place at once, if it can.
#[derive(Clone, Copy, Debug)]
pub enum CellEvent {
    Ignite { cell: Cell, cause: Cause },
    Extinguish { cell: Cell, by: AgentId },
    BurnOut { cell: Cell },
    Wet { cell: Cell, until: SimTime, by: AgentId },
    Dry { cell: Cell },
    Clear { cell: Cell, flank: u8, along_mm: u32, holds: bool },
}

/// An event that is due at a time.
#[derive(Clone, Copy, Debug)]
pub enum Due {
    Agent(AgentEvent, Wake),
    Cell(CellEvent),
    /// An event that the fire model expects.
    Fire(FireEvent),
    /// The scenario's ignition of this number.
    Scheduled(usize),
    /// Crews decide where to build line.
    Line,
    End,
}

impl Due {
    fn rank(&self) -> Rank {
        match self {
            Self::Agent(AgentEvent::Replan | AgentEvent::GoalLost, _) => Rank::Woken,
            Self::Cell(_) => Rank::Change,
            Self::Agent(AgentEvent::DwellEnd, _) => Rank::Extinction,
            Self::Fire(FireEvent::BurnOut { .. }) => Rank::BurnOut,
            Self::Fire(FireEvent::Dry { .. }) => Rank::Drying,
            Self::Fire(FireEvent::Arrival(_)) => Rank::Spread,
            Self::Scheduled(_) | Self::Agent(AgentEvent::Lighting, _) => Rank::Ignition,
            Self::Agent(AgentEvent::Arrival, _) => Rank::Arrival,
            Self::Agent(AgentEvent::PlanningDone, _) => Rank::PlanningDone,
            Self::Agent(AgentEvent::Decision, _) => Rank::Decision,
            Self::Agent(AgentEvent::Deadlock, _) => Rank::Deadlock,
            Self::Line => Rank::Line,
            Self::End => Rank::End,
        }
    }
}

/// The current instant of the world.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct SimClock(pub SimTime);

/// All events that are due. Systems take the next event only at its time, so that none can act out of turn.
#[derive(Resource, Clone, Debug, Default)]
pub struct SimQueue(EventQueue<Rank, Due>);

impl SimQueue {
    pub fn push(&mut self, time: SimTime, due: Due) {
        self.0.push(time, due.rank(), due);
    }

    pub fn push_for(&mut self, time: SimTime, event: AgentEvent, wake: Wake) {
        self.push(time, Due::Agent(event, wake));
    }

    /// Returns the same queue for agents that have other entities.
    pub fn for_agents(&self, other: impl Fn(Entity) -> Entity) -> Self {
        let mut queue = self.clone();
        for due in queue.0.events_mut() {
            if let Due::Agent(_, wake) = due {
                wake.agent = other(wake.agent);
            }
        }
        queue
    }

    /// Takes the next entry if it is due now with this rank.
    pub fn take(&mut self, now: SimTime, rank: Rank) -> Option<Due> {
        self.0.pop_due(now, rank)
    }

    /// Returns the next entry if it is due now.
    pub fn next(&self, now: SimTime) -> Option<&Due> {
        let (_, rank) = self.0.peek().filter(|&(time, _)| time == now)?;
        self.0.due(now, rank).next()
    }

    /// Takes the next entry if it is due now and is this event for an agent that `is_meant` accepts.
    pub fn take_for(&mut self, now: SimTime, event: AgentEvent, is_meant: impl Fn(Entity) -> bool) -> Option<Wake> {
        let wake = self.next_for(now, event, is_meant)?;
        self.drop_next();
        Some(wake)
    }

    /// Returns the addressee of the next entry under the same conditions, without taking it.
    pub fn next_for(&self, now: SimTime, event: AgentEvent, is_meant: impl Fn(Entity) -> bool) -> Option<Wake> {
        match self.next(now) {
            Some(&Due::Agent(next, wake)) if next == event && is_meant(wake.agent) => Some(wake),
            _ => None,
        }
    }

    pub fn drop_next(&mut self) {
        if let Some((time, rank)) = self.0.peek() {
            self.0.pop_due(time, rank);
        }
    }

    /// Iterates over the decisions that are due now, if no other event precedes them.
    pub fn decisions(&self, now: SimTime) -> impl Iterator<Item = Wake> {
        self.0.due(now, Rank::Decision).filter_map(|due| match *due {
            Due::Agent(_, wake) => Some(wake),
            _ => None,
        })
    }

    /// Returns the time of the next event.
    pub fn next_time(&self) -> Option<SimTime> {
        self.0.peek().map(|(time, _)| time)
    }
}
