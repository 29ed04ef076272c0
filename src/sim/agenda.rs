//! What is due, and in which order at one instant.

use bevy::prelude::*;

use crate::event_queue::EventQueue;
use crate::fire::FireEvent;
use crate::time::SimTime;

/// What happens first at one instant. The order is part of the contest's rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    Extinction,
    BurnOut,
    Spread,
    Ignition,
    Arrival,
    PlanningDone,
    Decision,
    Standoff,
    End,
}

/// A call to an agent. It is void if the agent has changed its mind since, that is, has another revision.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    pub agent: Entity,
    pub revision: u32,
}

/// Something that is due at a time.
#[derive(Clone, Copy, Debug)]
pub enum Due {
    /// A truck's dwell ends.
    Extinction(Call),
    /// What the model of the fire forecast.
    Fire(FireEvent),
    /// The scenario's ignition of this number.
    Scheduled(usize),
    /// A Wumpus is within reach of its goal.
    Lighting(Call),
    /// A truck is where it will suppress.
    Arrival(Call),
    /// Charged planning time is over.
    PlanningDone(Call),
    Decision(Call),
    /// A truck is blocked by others.
    Standoff(Call),
    End,
}

impl Due {
    pub fn rank(&self) -> Rank {
        match self {
            Self::Extinction(_) => Rank::Extinction,
            Self::Fire(FireEvent::BurnOut { .. }) => Rank::BurnOut,
            Self::Fire(FireEvent::Arrival(_)) => Rank::Spread,
            Self::Scheduled(_) | Self::Lighting(_) => Rank::Ignition,
            Self::Arrival(_) => Rank::Arrival,
            Self::PlanningDone(_) => Rank::PlanningDone,
            Self::Decision(_) => Rank::Decision,
            Self::Standoff(_) => Rank::Standoff,
            Self::End => Rank::End,
        }
    }
}

/// The instant at which the world stands.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct SimClock(pub SimTime);

/// All that is due.
#[derive(Resource, Debug, Default)]
pub struct Agenda(EventQueue<Rank, Due>);

impl Agenda {
    pub fn add(&mut self, time: SimTime, due: Due) {
        self.0.push(time, due.rank(), due);
    }

    /// Takes the next entry if it is due now with this rank.
    pub fn take(&mut self, now: SimTime, rank: Rank) -> Option<Due> {
        self.0.pop_due(now, rank)
    }

    /// When something is due next.
    pub fn next_time(&self) -> Option<SimTime> {
        self.0.peek().map(|(time, _)| time)
    }
}
