//! The vocabulary of planning queries: where a drive is to end, why there is no path, what was expanded, what found the
//! path, and what was looked at.
//!
//! Planners answer in it; recordings, audits and pictures read it without knowing any planner.

mod search_graph;

use std::ops::{AddAssign, Index, IndexMut};

use glam::DVec2;
use serde::{Deserialize, Serialize};

pub use search_graph::{MAX_SEARCH_EDGES, SearchGraph, SearchPhase};

use crate::geometry::{Pose, ops};
use crate::vehicle::Dimensions;

/// The disc in which a drive ends: the body's centre within `radius_m` of `centre`, at any heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalDisc {
    /// In the world frame.
    pub centre: DVec2,
    /// 0 for a place.
    pub radius_m: f64,
}

/// Drives end this far inside the goal disc, at most half its radius, so that rounding leaves nobody outside.
const RIM_M: f64 = 0.01;

impl GoalDisc {
    /// Returns the disc that planners aim at, smaller by a margin for rounding.
    pub fn with_margin(self) -> Self {
        Self { radius_m: (self.radius_m - RIM_M).max(0.5 * self.radius_m), ..self }
    }
}

/// The place where a drive to somewhere in particular ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The rear axle in this pose.
    Pose(Pose),
    /// The body's centre in the disc; a disc of radius 0 is a place.
    Disc(GoalDisc),
}

impl From<GoalDisc> for Goal {
    fn from(disc: GoalDisc) -> Self {
        Self::Disc(disc)
    }
}

impl From<Pose> for Goal {
    fn from(pose: Pose) -> Self {
        Self::Pose(pose)
    }
}

/// A drive to a pose may end this far from it, in metres and radians.
pub const END_M: f64 = 1e-3;
pub const END_RAD: f64 = 1e-3;

/// The body's centre may be this far outside of a disc, in metres: rounding, which a disc of radius 0 needs.
const DISC_ROUNDING_M: f64 = 1e-6;

impl Goal {
    /// Says whether a drive that ends in this pose of the rear axle has reached the goal: within [`END_M`] and
    /// [`END_RAD`] of a pose, or with the body's centre in the disc.
    pub fn is_met(&self, pose: Pose, body: &Dimensions) -> bool {
        let (gap_m, turn_rad) = self.gap(pose, body);
        match self {
            Self::Pose(_) => gap_m <= END_M && turn_rad <= END_RAD,
            Self::Disc(disc) => gap_m <= disc.radius_m + DISC_ROUNDING_M,
        }
    }

    /// Returns metres and radians from a pose to the goal's, or metres from the body's centre to that of the disc.
    pub fn gap(&self, pose: Pose, body: &Dimensions) -> (f64, f64) {
        match *self {
            Self::Pose(end) => {
                (pose.position().distance(end.position()), ops::wrap_angle(pose.heading - end.heading).abs())
            }
            Self::Disc(disc) => (body.body_centre(pose).distance(disc.centre), 0.0),
        }
    }

    /// Returns the goal that planners aim at, smaller by a margin for rounding.
    pub fn with_margin(self) -> Self {
        match self {
            Self::Pose(_) => self,
            Self::Disc(disc) => Self::Disc(disc.with_margin()),
        }
    }

    /// Returns the goal as positions for the body's centre.
    pub fn disc(self, body: &Dimensions) -> GoalDisc {
        match self {
            Self::Disc(disc) => disc,
            Self::Pose(end) => GoalDisc { centre: body.body_centre(end), radius_m: 0.0 },
        }
    }
}

/// The reason why there is no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlanFailure {
    /// The truck's own pose is not free.
    StartBlocked,
    /// No free place from which the goal could be reached.
    GoalBlocked,
    /// The roadmap, or the search space, does not connect start and goal.
    Disconnected,
    /// The budget of expansions ran out first.
    BudgetSpent,
    /// A Wumpus's descent: no step leads downhill from where it is, and the goal is not in reach.
    LocalMinimum,
    /// A planner that is not built in did not answer within its limit of time.
    TimedOut,
    /// A planner that is not built in ended, or failed in a way of its own.
    Crashed,
    /// A planner that is not built in gave an answer that is no path, or one that the truck must not drive.
    BadAnswer,
}

crate::names! { PlanFailure {
    StartBlocked: "start blocked",
    GoalBlocked: "goal blocked",
    Disconnected: "disconnected",
    BudgetSpent: "budget spent",
    LocalMinimum: "local minimum",
    TimedOut: "timed out",
    Crashed: "crashed",
    BadAnswer: "bad answer",
} }

/// A number of failed queries for each reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailureCounts([u32; PlanFailure::ALL.len()]);

impl FailureCounts {
    pub fn sum(&self) -> u32 {
        self.0.iter().sum()
    }
}

impl Index<PlanFailure> for FailureCounts {
    type Output = u32;

    fn index(&self, reason: PlanFailure) -> &u32 {
        &self.0[reason as usize]
    }
}

impl IndexMut<PlanFailure> for FailureCounts {
    fn index_mut(&mut self, reason: PlanFailure) -> &mut u32 {
        &mut self.0[reason as usize]
    }
}

impl FromIterator<PlanFailure> for FailureCounts {
    fn from_iter<I: IntoIterator<Item = PlanFailure>>(reasons: I) -> Self {
        let mut counts = Self::default();
        reasons.into_iter().for_each(|reason| counts[reason] += 1);
        counts
    }
}

/// Nodes expanded by one query, by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    pub roadmap_expansions: u32,
    pub local_expansions: u32,
}

impl AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.roadmap_expansions += other.roadmap_expansions;
        self.local_expansions += other.local_expansions;
    }
}

/// The means that found a path: the wanted one of its planner, or one of those that it falls back on.
///
/// Planners name the first five. What simulation adds where a planner fails, it names itself: the last three.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FoundBy {
    /// The way that an empty field would allow is free, or the truck is there already.
    Straight,
    /// A roadmap, at the wanted clearance.
    Roadmap,
    /// A search over motions without a roadmap, at the wanted clearance.
    Search,
    /// A roadmap or a search, with less clearance than wanted.
    Relaxed,
    /// A flood over a lattice of poses, or a search on the finest lattice.
    Lattice,
    /// After the planner failed on a goal that the reachability flood reaches: its large search from where the truck is.
    Reachability,
    /// After that failed too: back along the truck's tracks, and from there by its planner.
    BackingOut,
    /// After all else failed: back along all tracks to the start, and from there by the path of the reachability flood.
    WayHome,
}

crate::names! { FoundBy {
    Straight: "straight",
    Roadmap: "roadmap",
    Search: "search",
    Relaxed: "relaxed",
    Lattice: "lattice",
    Reachability: "reachability",
    BackingOut: "backing-out",
    WayHome: "way-home",
} }

impl FoundBy {
    /// Says whether the planner had failed on the goal before.
    pub fn is_after_failure(self) -> bool {
        matches!(self, Self::Reachability | Self::BackingOut | Self::WayHome)
    }
}
