//! What is due, and in which order at one instant.

use bevy_ecs::prelude::*;

use wildfire_base::event_queue::EventQueue;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireEvent;
use wildfire_timeline::{AgentId, Cause};

/// What happens first at one instant. The order is part of the contest's rules; the first two see to it that everybody
/// has heard of a change before the next thing happens that was due at the same time.
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
    Standoff,
    End,
}

/// Whom an event is for. It is void if the agent has changed its mind since, that is, has another revision.
#[derive(Clone, Copy, Debug)]
pub struct Wake {
    pub agent: Entity,
    pub revision: u32,
}

/// What is due for one agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AgentEvent {
    /// Something has changed that it may want to answer with another decision.
    LookAgain,
    /// Its goal is no longer worth going for.
    GoalLost,
    /// A truck has stood at a fire for long enough.
    DwellEnd,
    /// A Wumpus is within reach of its goal.
    Lighting,
    /// A truck is where it will suppress.
    Arrival,
    /// Charged planning time is over.
    PlanningDone,
    Decision,
    /// A truck is blocked by others.
    Standoff,
}

/// What is to become of a cell at once, if it can.
#[derive(Clone, Copy, Debug)]
pub enum CellEvent {
    Ignite { cell: Cell, cause: Cause },
    Extinguish { cell: Cell, by: AgentId },
    BurnOut { cell: Cell },
    Wet { cell: Cell, until: SimTime, by: AgentId },
    Dry { cell: Cell },
}

/// Something that is due at a time.
#[derive(Clone, Copy, Debug)]
pub enum Due {
    Agent(AgentEvent, Wake),
    Cell(CellEvent),
    /// What the model of the fire expects.
    Fire(FireEvent),
    /// The scenario's ignition of this number.
    Scheduled(usize),
    End,
}

impl Due {
    fn rank(&self) -> Rank {
        match self {
            Self::Agent(AgentEvent::LookAgain | AgentEvent::GoalLost, _) => Rank::Woken,
            Self::Cell(_) => Rank::Change,
            Self::Agent(AgentEvent::DwellEnd, _) => Rank::Extinction,
            Self::Fire(FireEvent::BurnOut { .. }) => Rank::BurnOut,
            Self::Fire(FireEvent::Dry { .. }) => Rank::Drying,
            Self::Fire(FireEvent::Arrival(_)) => Rank::Spread,
            Self::Scheduled(_) | Self::Agent(AgentEvent::Lighting, _) => Rank::Ignition,
            Self::Agent(AgentEvent::Arrival, _) => Rank::Arrival,
            Self::Agent(AgentEvent::PlanningDone, _) => Rank::PlanningDone,
            Self::Agent(AgentEvent::Decision, _) => Rank::Decision,
            Self::Agent(AgentEvent::Standoff, _) => Rank::Standoff,
            Self::End => Rank::End,
        }
    }
}

/// The instant at which the world stands.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct SimClock(pub SimTime);

/// All that is due. Systems take what is next, and only at its time, so that none can act out of turn.
#[derive(Resource, Debug, Default)]
pub struct SimQueue(EventQueue<Rank, Due>);

impl SimQueue {
    pub fn push(&mut self, time: SimTime, due: Due) {
        self.0.push(time, due.rank(), due);
    }

    pub fn push_for(&mut self, time: SimTime, event: AgentEvent, wake: Wake) {
        self.push(time, Due::Agent(event, wake));
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

    /// Takes the next entry if it is due now and this event for one of the agents that `is_meant` accepts.
    pub fn take_for(&mut self, now: SimTime, event: AgentEvent, is_meant: impl Fn(Entity) -> bool) -> Option<Wake> {
        let wake = self.next_for(now, event, is_meant)?;
        self.drop_next();
        Some(wake)
    }

    /// Returns whom the next entry is for, on the same conditions, and leaves it where it is.
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

    /// Iterates over the decisions that are due now, if nothing comes before them.
    pub fn decisions(&self, now: SimTime) -> impl Iterator<Item = Wake> {
        self.0.due(now, Rank::Decision).filter_map(|due| match *due {
            Due::Agent(_, wake) => Some(wake),
            _ => None,
        })
    }

    /// Returns when something is due next.
    pub fn next_time(&self) -> Option<SimTime> {
        self.0.peek().map(|(time, _)| time)
    }
}
