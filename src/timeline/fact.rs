//! What can happen in a run.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::AgentId;
use crate::geometry::{Cell, Pose};
use crate::planning::{Effort, PlanFailure, SearchGraph, SearchPhase};
use crate::time::SimTime;
use crate::trajectory::Trajectory;

/// Who set a cell on fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cause {
    /// The agent that lit it.
    Lit(AgentId),
    /// The burning cell that it caught fire from.
    Spread(Cell),
    /// An `[[ignition]]` of the scenario.
    Scheduled,
}

/// Why an agent rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RestReason {
    /// A Wumpus with no intact cell left that it can approach; it rests for the rest of the run.
    NothingLeftToLight,
    /// A truck while no cell burns that is not another truck's.
    NothingBurns,
    /// A truck while all that burns cannot be reached from where it can go.
    NothingReachable,
    /// A Wumpus that descends into a local minimum from where it stands, whichever cell it goes for.
    LocalMinima,
}

impl fmt::Display for RestReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingLeftToLight => "nothing left to light",
            Self::NothingBurns => "nothing burns that is not another truck's",
            Self::NothingReachable => "nothing reachable",
            Self::LocalMinima => "local minima wherever it goes",
        })
    }
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    Duration,
    /// Nothing burned, nothing was to be lit.
    NothingLeft,
}

impl fmt::Display for EndReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Duration => "duration",
            Self::NothingLeft => "nothing left",
        })
    }
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fact {
    /// A blocked start was moved to the nearest free place before the run began.
    StartMoved {
        agent: AgentId,
        from: Pose,
    },
    /// A truck's planner was built: its roadmap has so many milestones, edges and connected components.
    RoadmapBuilt {
        agent: AgentId,
        samples: u32,
        edges: u32,
        components: u32,
    },
    /// Cells that this agent can never act on: no lattice point to light them from, or, for a truck, no pose that the
    /// reachability flood connects to its start.
    OutOfReach {
        agent: AgentId,
        cells: Vec<Cell>,
    },
    Ignited {
        cell: Cell,
        cause: Cause,
    },
    BurnedOut {
        cell: Cell,
    },
    Extinguished {
        cell: Cell,
        by: AgentId,
    },
    /// The agent, standing where `trajectory` begins, chose a goal and knows how to get there; while planning time is
    /// charged it stands until `trajectory.start_time()`. A truck that already stands in reach has a trajectory without
    /// pieces; one that lets another truck pass first begins with a wait.
    Planned {
        agent: AgentId,
        goal: Cell,
        trajectory: Trajectory,
        effort: Effort,
        by_lattice: bool,
    },
    /// What a search looked at, where that was to be recorded, with the roadmap itself right after its `RoadmapBuilt`:
    /// the phases of a plan in turn, right before what it led to, which is a `Planned`, a `PlanFailed`, with the
    /// `LocalMinimum` that goes before them, or, where another truck was in the way, the next plan or a `Blocked`.
    /// Nothing is told of detours round other trucks, nor of plans that the reachability flood led to (`by_lattice`).
    Searched {
        agent: AgentId,
        phase: SearchPhase,
        graph: SearchGraph,
    },
    /// A plan for a goal failed. Planning time is charged until `until`, which is the time of this fact where planning
    /// costs none; it does not stop an agent that is under way.
    PlanFailed {
        agent: AgentId,
        goal: Cell,
        reason: PlanFailure,
        effort: Effort,
        until: SimTime,
    },
    /// The agent drops its goal. `trajectory` is the leg as it is really driven: the same start, cut short, standing
    /// from its `end_time()` on; without pieces if the agent had not set out. A truck stops where it is in nobody's
    /// way, which may be later than it could.
    Dropped {
        agent: AgentId,
        goal: Cell,
        trajectory: Trajectory,
    },
    /// A truck arrived and suppresses.
    Suppressing {
        agent: AgentId,
        cell: Cell,
    },
    /// A suppression ended early because its cell stopped burning.
    SuppressionEnded {
        agent: AgentId,
        cell: Cell,
    },
    Rested {
        agent: AgentId,
        reason: RestReason,
    },
    /// The descent of a Wumpus for a goal meets a local minimum at this place. A `Planned` follows if its walk leads
    /// there and escapes; if the Wumpus stands there and gives the goal up, a `PlanFailed`.
    LocalMinimum {
        agent: AgentId,
        goal: Cell,
        x_m: f64,
        y_m: f64,
    },
    /// A truck stands because another one is in the way to all that it could go for: `by` is in the way to `goal`, its
    /// first choice. It waits until something of the others changes.
    Blocked {
        agent: AgentId,
        goal: Cell,
        by: AgentId,
    },
    /// A truck that had no goal, or was blocked itself, drives aside so that `to` can set out: a deadlock is broken.
    GaveWay {
        agent: AgentId,
        to: AgentId,
        trajectory: Trajectory,
    },
    Ended {
        reason: EndReason,
    },
}

/// A fact and its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub time: SimTime,
    pub fact: Fact,
}

impl Fact {
    /// The agent whose doing this is, if any.
    pub fn agent(&self) -> Option<AgentId> {
        match *self {
            Self::StartMoved { agent, .. }
            | Self::RoadmapBuilt { agent, .. }
            | Self::OutOfReach { agent, .. }
            | Self::Ignited { cause: Cause::Lit(agent), .. }
            | Self::Extinguished { by: agent, .. }
            | Self::Planned { agent, .. }
            | Self::Searched { agent, .. }
            | Self::PlanFailed { agent, .. }
            | Self::Dropped { agent, .. }
            | Self::Suppressing { agent, .. }
            | Self::SuppressionEnded { agent, .. }
            | Self::Rested { agent, .. }
            | Self::LocalMinimum { agent, .. }
            | Self::Blocked { agent, .. }
            | Self::GaveWay { agent, .. } => Some(agent),
            Self::Ignited { .. } | Self::BurnedOut { .. } | Self::Ended { .. } => None,
        }
    }

    /// The leg that begins, or is cut short, with this fact.
    pub fn trajectory(&self) -> Option<&Trajectory> {
        match self {
            Self::Planned { trajectory, .. } | Self::Dropped { trajectory, .. } | Self::GaveWay { trajectory, .. } => {
                Some(trajectory)
            }
            _ => None,
        }
    }

    /// The one cell that this concerns: what changed, or the agent's goal.
    pub fn cell(&self) -> Option<Cell> {
        match *self {
            Self::Ignited { cell, .. }
            | Self::BurnedOut { cell }
            | Self::Extinguished { cell, .. }
            | Self::Suppressing { cell, .. }
            | Self::SuppressionEnded { cell, .. } => Some(cell),
            Self::Planned { goal, .. }
            | Self::PlanFailed { goal, .. }
            | Self::Dropped { goal, .. }
            | Self::LocalMinimum { goal, .. }
            | Self::Blocked { goal, .. } => Some(goal),
            Self::StartMoved { .. }
            | Self::RoadmapBuilt { .. }
            | Self::OutOfReach { .. }
            | Self::Searched { .. }
            | Self::Rested { .. }
            | Self::GaveWay { .. }
            | Self::Ended { .. } => None,
        }
    }
}
