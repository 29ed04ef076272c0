//! The facts of a run: everything that can happen in it.
//!
//! A new kind of fact is a variant here, a record in [`super::file`], a row in [`super::export`], and the place in the
//! simulation that appends it; readers that it does not concern pass over it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::AgentId;
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::query::{Effort, FoundBy, PlanFailure, SearchGraph, SearchPhase};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;

/// The cause of an ignition, with its parent: the agent that lit the cell, or the fire that spread to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The agent that lit it.
    Agent(AgentId),
    /// The burning cell that it caught fire from. Where several burning cells reach it, that is the one whose spread
    /// comes due first; of those due at one instant, the one that was scheduled first, which is the one that itself
    /// caught fire earlier. Recordings of every format hold it.
    Spread(Cell),
    /// The burning cell whose ember landed here.
    Spotted(Cell),
    /// An `[[ignition]]` of the scenario.
    Scheduled,
}

/// The reason why an agent rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RestReason {
    /// A Wumpus with no intact cell left that it can approach; it rests for the rest of the run.
    NothingLeftToLight,
    /// A truck when no cell burns that is not another truck's goal.
    NothingBurns,
    /// A truck when no fire can be reached from where it can drive.
    NothingReachable,
    /// A Wumpus that descends into a local minimum from where it stands, whichever cell it goes for.
    LocalMinima,
    /// A truck whose planner failed on all fires, if no other planner takes over.
    NoPlan,
    /// Its policy chose to wait although it has options; it stands, and is not stuck.
    #[serde(rename = "Chosen")]
    PolicyWait,
    /// A truck whose tank is too empty for a stop, and that finds no path to water.
    NoWater,
    /// A truck when all that burns is too hot for its pump, or takes more water than its tank holds.
    TooHot,
    /// A truck before the time at which it is ready to set out.
    NotReady,
}

impl fmt::Display for RestReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingLeftToLight => "nothing left to light",
            Self::NothingBurns => "nothing burns that is not another truck's",
            Self::NothingReachable => "nothing reachable",
            Self::LocalMinima => "local minima wherever it goes",
            Self::NoPlan => "no plan for anything that burns",
            Self::PolicyWait => "its policy lets it wait",
            Self::NoWater => "no way to water",
            Self::TooHot => "all that burns is too hot for its water",
            Self::NotReady => "not ready yet",
        })
    }
}

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    Duration,
    /// Nothing burned, and nothing was left to light.
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

/// A fact: one thing that happened.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// An action of an agent, or a result of its planner.
    Agent(AgentId, AgentFact),
    /// The state of a bush changed.
    Fire(FireFact),
    /// The run is over.
    Ended { reason: EndReason },
}

/// A change of the state of a bush.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FireFact {
    /// The bush catches fire.
    Ignited { cell: Cell, cause: Cause },
    /// The bush burns out.
    BurnedOut { cell: Cell },
    /// A truck extinguishes the bush.
    Extinguished { cell: Cell, by: AgentId },
}

/// A change of a ground cell, or water on any cell.
///
/// Ground burns in far greater numbers than bushes, and what follows from an ignition by the rules alone is not recorded:
/// when it burns out, and when something wet is dry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroundEvent {
    pub time: SimTime,
    pub cell: Cell,
    pub fact: GroundFact,
}

impl GroundEvent {
    /// Returns the agent that lit, extinguished or wetted the cell, if any.
    pub fn agent(&self) -> Option<AgentId> {
        match self.fact {
            GroundFact::Ignited(Cause::Agent(by)) | GroundFact::Extinguished { by } | GroundFact::Wetted { by, .. } => {
                Some(by)
            }
            GroundFact::Ignited(_) | GroundFact::Cleared { .. } => None,
        }
    }
}

/// A change of a ground cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroundFact {
    /// The cell catches fire.
    Ignited(Cause),
    /// A truck extinguishes the cell.
    Extinguished { by: AgentId },
    /// A truck wets the cell, bush or ground, so that it cannot burn before `until`.
    Wetted { until: SimTime, by: AgentId },
    /// Crews have finished line in the cell, bush or ground, so that it cannot burn. `along_mm` is the length of line up to
    /// it, on one of two flanks: 0 and 1 of the first planned line, 2 and 3 of the next. Line that does not hold leaves the
    /// cell as it was.
    Cleared { flank: u8, along_mm: u32, holds: bool },
}

/// An action of an agent, or a result of its planner.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentFact {
    /// A blocked start was moved to the nearest free place before the run began.
    StartMoved { from: Pose },
    /// A truck's planner was built, and its roadmap with it.
    RoadmapBuilt {
        /// Milestones of the roadmap.
        samples: u32,
        edges: u32,
        /// Connected components.
        components: u32,
    },
    /// Cells that this agent can never act on: a Wumpus has no lattice point to light them from; for a truck, the
    /// reachability flood connects no suitable pose to its start.
    OutOfReach { cells: Vec<Cell> },
    /// The agent, standing where `trajectory` begins, chose a goal and knows how to get there; while planning time is
    /// charged it stands until `trajectory.start_time()`. A truck that already stands in reach has a trajectory without
    /// pieces; one that lets another truck pass first begins with a wait.
    ///
    /// `found_by` is `None` for a Wumpus's walk, and for a truck's plan in a recording older than format 5, which does
    /// not say. If such a recording says that the flood led to a plan, it is [`FoundBy::Reachability`], even where the
    /// plan was one of those that come after the flood.
    Planned { goal: Cell, trajectory: Trajectory, effort: Effort, found_by: Option<FoundBy> },
    /// The graph that a search looked at, where that was to be recorded. The roadmap itself comes right after its
    /// `RoadmapBuilt`. The phases of a plan come in turn, right before what it led to, which is a `Planned`, a
    /// `PlanFailed`, with the `LocalMinimum` that goes before them, or, where another truck was in the way, the next
    /// plan or a `Blocked`.
    /// Detours round other trucks and plans that the reachability flood led to are not recorded.
    Searched { phase: SearchPhase, graph: SearchGraph },
    /// A plan for a goal failed. Planning time is charged until `until`, which is the time of this fact where planning
    /// costs none; it does not stop an agent that is under way.
    PlanFailed { goal: Cell, reason: PlanFailure, effort: Effort, until: SimTime },
    /// The agent drops its goal. `trajectory` is the leg as it is really driven: the same start, cut short, standing
    /// from its `end_time()` on; without pieces if the agent had not set out. A truck stops where it blocks nobody,
    /// which may be later than it could.
    Dropped { goal: Cell, trajectory: Trajectory },
    /// A truck arrived and begins to suppress, with this water: one stop's, or portions by the heat of the fire.
    Suppressing { cell: Cell, water_units: u32 },
    /// A suppression ended early because its cell stopped burning.
    SuppressionEnded { cell: Cell },
    /// The agent stands and has no option, for this reason.
    Rested { reason: RestReason },
    /// The descent of a Wumpus for a goal meets a local minimum at this place. A `Planned` follows if its walk leads
    /// there and escapes; if the Wumpus stands there and gives the goal up, a `PlanFailed`.
    LocalMinimum { goal: Cell, x_m: f64, y_m: f64 },
    /// A truck stands because other trucks block all its options: `by` blocks `goal`, its first choice. It waits until
    /// the others change something.
    Blocked { goal: Cell, by: AgentId },
    /// A truck that had no goal, or was blocked itself, drives aside so that `to` can set out: a deadlock is broken.
    GaveWay { to: AgentId, trajectory: Trajectory },
    /// A truck without a fire to go for sets out for a place where its policy wants it to wait, or where there is water, in
    /// metres in the frame of the field; its leg ends near there. It may be called off on the way.
    Relocated { x_m: f64, y_m: f64, trajectory: Trajectory, effort: Effort, found_by: FoundBy },
    /// A truck on its way to such a place is called off. `trajectory` is the leg as it is really driven, as that of
    /// [`Self::Dropped`].
    Halted { trajectory: Trajectory },
    /// A truck stays where it is because there is no way to the place where its policy wants it to wait, or, without a
    /// reason, because other trucks are in the way. Planning time is charged until `until`.
    RelocationFailed { x_m: f64, y_m: f64, reason: Option<PlanFailure>, effort: Effort, until: SimTime },
    /// A truck that stands at water fills its tank; the tank is full from now on, but the truck is busy until then.
    Refilling { until: SimTime },
}

/// A fact and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When it happened.
    pub time: SimTime,
    /// The fact.
    pub fact: Fact,
}

/// A bush that catches fire, and why.
#[derive(Clone, Copy, Debug)]
pub struct BushIgnition {
    pub cell: Cell,
    pub cause: Cause,
}

impl Fact {
    /// Returns the agent of this event, if any; agents also light and extinguish.
    pub fn agent(&self) -> Option<AgentId> {
        match *self {
            Self::Agent(agent, _)
            | Self::Fire(
                FireFact::Ignited { cause: Cause::Agent(agent), .. } | FireFact::Extinguished { by: agent, .. },
            ) => Some(agent),
            Self::Fire(_) | Self::Ended { .. } => None,
        }
    }

    /// Returns the leg that begins, or is cut short, with this event.
    pub fn trajectory(&self) -> Option<&Trajectory> {
        match self {
            Self::Agent(_, fact) => fact.trajectory(),
            Self::Fire(_) | Self::Ended { .. } => None,
        }
    }

    /// Returns the bush that catches fire with this event, and the cause.
    pub fn ignition(&self) -> Option<BushIgnition> {
        if let Self::Fire(FireFact::Ignited { cell, cause }) = *self {
            Some(BushIgnition { cell, cause })
        } else {
            None
        }
    }

    /// Returns the one cell of this event: the cell that changed, or the agent's goal.
    pub fn cell(&self) -> Option<Cell> {
        match self {
            Self::Agent(_, fact) => fact.cell(),
            Self::Fire(fact) => Some(fact.cell()),
            Self::Ended { .. } => None,
        }
    }
}

impl Cause {
    /// Returns the burning cell that the fire came from, if it came from one.
    pub fn parent(self) -> Option<Cell> {
        match self {
            Self::Spread(from) | Self::Spotted(from) => Some(from),
            Self::Agent(_) | Self::Scheduled => None,
        }
    }
}

impl FireFact {
    /// Returns the cell that changed.
    pub fn cell(&self) -> Cell {
        match *self {
            Self::Ignited { cell, .. } | Self::BurnedOut { cell } | Self::Extinguished { cell, .. } => cell,
        }
    }
}

impl AgentFact {
    /// Returns the leg that begins, or is cut short, with this fact.
    pub fn trajectory(&self) -> Option<&Trajectory> {
        match self {
            Self::Planned { trajectory, .. }
            | Self::Dropped { trajectory, .. }
            | Self::GaveWay { trajectory, .. }
            | Self::Relocated { trajectory, .. }
            | Self::Halted { trajectory } => Some(trajectory),
            _ => None,
        }
    }

    /// Returns the agent's goal, or the cell that it suppresses.
    pub fn cell(&self) -> Option<Cell> {
        match *self {
            Self::Planned { goal: cell, .. }
            | Self::PlanFailed { goal: cell, .. }
            | Self::Dropped { goal: cell, .. }
            | Self::LocalMinimum { goal: cell, .. }
            | Self::Blocked { goal: cell, .. }
            | Self::Suppressing { cell, .. }
            | Self::SuppressionEnded { cell } => Some(cell),
            _ => None,
        }
    }
}
