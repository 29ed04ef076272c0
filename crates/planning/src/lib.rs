#![doc = include_str!("../README.md")]
//!
//! Planners for the truck behind one interface: a query in; a path, the effort and a reason for failure out. The planners of
//! the Wumpus are in [`walk`].
//!
//! Effort is counted in samples and expansions and budgeted in the same units. Planners use no clock and keep no record of
//! their searches: the caller passes an [`observer`].
//!
//! # Modules
//! [`kit`] has the building blocks that planners share, [`planners`] the planners, which import the kit and never each other.
//! The [`registry`] lists them by name, together with custom planners; the [`gate`] around these rejects any path that the
//! truck could not drive, as decided by the [`judge`]. [`reachability`] decides whether the truck can reach a place at all,
//! `smooth_steering` adapts the paths of built-in planners to wheels that turn at a limited rate, [`memory`] counts memory
//! that grows during a run, and [`traffic`] is for trucks that meet.
//!
//! # The sequence of fallbacks
//! A planner that finds no path relaxes its demands before it gives up, and a truck whose planner gives up has further
//! fallbacks. [`Plan::found_by`] and the records of a run name the stage that found a path. In this order:
//!
//! 1. **`straight`**: the truck is already in the goal, or its shortest path there on an empty field (a Reeds-Shepp curve, or
//!    a turn and a straight) is free at the wanted clearance. `hybrid-astar` and `prm-rs` try this first; `prm+primitives`
//!    stays where it is if that is in the goal.
//! 2. **`roadmap`** or **`search`**: the planner's own method at the wanted clearance. The roadmap of `prm+primitives`
//!    gives waypoints to [`kit::local_search`], that of `prm-rs` is searched together with motions about the start; a path
//!    of `prm-rs` that leads over no milestone is a `search`, as are all of `hybrid-astar`. Where the roadmap of
//!    `prm+primitives` or the way along it leads nowhere, its local search goes straight for the goal
//!    (`unimog.primitives.search_alone`), which is a `search` too.
//! 3. **`relaxed`**: the same with less clearance, by a schedule of stages ([`kit::relaxation`]), each with a budget of
//!    its own:
//!    - the local search of `prm+primitives`: 1, 1/2, 1/10 of the wanted clearance, with 8, 15 and 27 percent of the
//!      budget, along the route and then, if need be, without it;
//!    - `prm-rs`: 1, 1/3, 1/25, on large fields 1 alone; then the whole of `hybrid-astar` follows, at that planner's
//!      settings;
//!    - `hybrid-astar` ([`kit::relaxed_search`]): 1, 2/3, 1/3, 1/25, the first from the start alone, the others from both
//!      ends in turn.
//!
//!    No stage keeps less than 1 cm. About a start or a goal pose that is tighter than that stage, the demand falls to nine
//!    tenths of what the pose itself has, and rises by 10 cm for every metre away from it ([`kit::clearance_profile`]); on the way to a
//!    tight goal pose the local search keeps no more than that anywhere.
//! 4. **`lattice`**: a flood over the coarsest lattice of poses, then searches from both ends on the finest, the last
//!    stages of `hybrid-astar`; and everything that the planner `lattice` finds, which floods three lattices in turn
//!    ([`kit::floods`]).
//!
//! Where a built-in planner gives up, a last resort follows (`last_resort`), at the least clearance, under the names above:
//! single curves; for a vehicle of another size than the contest's, `hybrid-astar` on a field that is scaled to it
//! ([`kit::vehicle_units`]); ways out of a tight start or goal.
//!
//! If all this fails on every goal that burns, and the scenario lets the truck be rescued (`unimog.rescue`: by default those
//! with a built-in planner), the simulation asks [`reachability`], which floods from the truck's start:
//!
//! 5. **`reachability`**: the flood says that the goal is in reach, and a large search from where the truck stands finds
//!    a path there, on two lattices in turn, with 3 cm of clearance;
//! 6. **`backing-out`**: that fails, and the truck drives back over its own tracks to where one of its last eight legs
//!    began, until its planner finds a path from there;
//! 7. **`way-home`**: that fails too, and it drives back over all its tracks to its start, and from there along the
//!    flood's own path, which is sure to be free.
//!
//! A goal that the flood does not reach is given up for the run. The first four are set here, the last three by the
//! simulation. Avoiding other trucks ([`traffic`]) changes a path, but not the name of the stage
//! that found it.

pub mod certificate;
pub mod collision;
pub mod gate;
pub mod judge;
pub mod kit;
mod last_resort;
#[cfg(test)]
mod laws;
pub mod memory;
mod nearest_by_drive;
pub mod observer;
pub mod planners;
pub mod reachability;
pub mod registry;
pub mod search_recorder;
pub mod smooth_steering;
#[cfg(test)]
mod test_fields;
pub mod together;
pub mod traffic;
pub mod walk;

pub use judge::lower_bound_m;
pub use nearest_by_drive::{NearestPlan, plan_to_nearest};
pub use observer::{NullObserver, PlanningObserver, PlanningWork, QueryMonitor, QueryRecord, QueryTime};
pub use registry::{
    MakeError, NameError, PlannerContext, PlannerFactory, PlannerName, Planners, TruckPlannerKind, TruckPlannerSettings,
};
pub use wildfire_base::query::{
    END_M, END_RAD, Effort, FoundBy, Goal, GoalDisc, MAX_SEARCH_EDGES, PlanFailure, SearchGraph, SearchPhase,
};

use std::time::Duration;

use serde::{Deserialize, Serialize};

use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::Path;

/// A path and the means that found it.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub path: Path,
    pub by: FoundBy,
}

/// A query's answer.
#[derive(Clone, Debug)]
pub struct Plan {
    /// From the start pose to the goal, or why there is none. A start inside a goal disc gives a path without segments.
    pub path: Result<Path, PlanFailure>,
    /// The means that found the path, if there is one.
    pub found_by: Option<FoundBy>,
    /// Nodes expanded.
    pub effort: Effort,
    /// CPU time of the query, if somebody else than the caller measured it; `None`: what the caller's own clock says.
    pub cpu: Option<QueryCpu>,
    /// Notes on a failure besides its reason.
    pub message: Option<String>,
}

/// CPU time of a query, and who says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueryCpu {
    pub time: Duration,
    /// The part of it in which a program started again.
    pub starting: Duration,
    pub source: CpuSource,
}

/// Where a CPU time comes from; the more a reader may trust it, the earlier it stands here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CpuSource {
    /// The clock of the thread that asked.
    Thread,
    /// The clock of the planner's own processes.
    Process,
    /// The planner itself.
    Reported,
}

wildfire_base::names! { CpuSource { Thread: "thread", Process: "process", Reported: "reported" } }

impl Plan {
    /// Creates an answer from what was found, or why nothing was.
    pub fn new(found: Result<Found, PlanFailure>, effort: Effort) -> Self {
        let (path, found_by) = match found {
            Ok(Found { path, by }) => (Ok(path), Some(by)),
            Err(failure) => (Err(failure), None),
        };
        Self { path, found_by, effort, cpu: None, message: None }
    }

    /// Creates the answer of a planner that failed, with words about it.
    pub fn failed(failure: PlanFailure, message: impl Into<String>) -> Self {
        Self { message: Some(message.into()), ..Self::from(Err(failure)) }
    }
}

impl From<Result<Path, PlanFailure>> for Plan {
    /// Creates an answer that does not say how much was searched, nor how; a path counts as found by a search.
    fn from(path: Result<Path, PlanFailure>) -> Self {
        Self::new(path.map(|path| Found { path, by: FoundBy::Search }), Effort::default())
    }
}

/// The cost and the result of building a planner for one field.
#[derive(Clone, Copy, Debug, Default)]
pub struct BuildReport {
    /// Milestones of the roadmap.
    pub samples: u32,
    /// Points drawn to get them.
    pub draws: u32,
    pub edges: u32,
    /// Connected components of the roadmap; 0 if they were not counted.
    pub components: u32,
    pub sampling: Duration,
    pub connecting: Duration,
    /// Making a planner that is not built in, the start of its program included.
    pub starting: Duration,
    /// The part of `starting` that other processes spent.
    pub elsewhere: Duration,
}

/// The fewest milestones that the components of a useful roadmap have on average.
const FEWEST_A_COMPONENT: u32 = 10;

/// Returns whether a roadmap has too many components to hold most routes across the field.
pub fn is_hardly_connected(milestones: u32, components: u32) -> bool {
    components > 1 && milestones < components.saturating_mul(FEWEST_A_COMPONENT)
}

/// A planner made for one body on one field.
pub trait TruckPlanner: Send + Sync {
    /// Finds a path from a pose of the rear axle to a goal, or says why there is none. Answers should not depend on
    /// earlier ones: whoever audits a run by simulating it again relies on it.
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan;

    /// Does the same and shows an observer the work. The answer does not depend on the observer.
    fn plan_observed(&mut self, start: Pose, goal: Goal, _observer: &mut dyn PlanningObserver) -> Plan {
        self.plan(start, goal)
    }

    /// Finds a path into whichever of some discs is the nearest by drive, in one search; says which, by its place among
    /// them. With no way into any of them the plan has the reason. A planner that knows one goal at a time answers `None`,
    /// and is asked for one after the other.
    fn plan_to_nearest(
        &mut self,
        _start: Pose,
        _discs: &[GoalDisc],
        _observer: &mut dyn PlanningObserver,
    ) -> Option<NearestPlan> {
        None
    }

    /// Returns what building it took and gave.
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    /// Shows an observer the edges of the roadmap that can be driven, if the planner has one.
    fn show_roadmap(&mut self, _observer: &mut dyn PlanningObserver) {}
}
