//! What a scenario may choose about the roadmap of the truck's planner `prm+primitives`.
//!
//! Defaults are those of the scenario `contest`. Lengths are metres.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The probabilistic roadmap over the truck's body centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmSettings {
    /// Milestones to draw.
    pub samples: u32,
    /// Each milestone is joined to so many of its nearest ones, those to which the straight line is free.
    pub neighbours: u32,
    /// No edge is longer.
    pub max_edge_m: f64,
    /// Free radius about milestones and along edges.
    pub clearance_m: f64,
    pub clearance_to: ClearanceTo,
    pub search: RoadmapSearch,
    pub goal: RoadmapGoal,
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

impl Default for PrmSettings {
    fn default() -> Self {
        Self {
            samples: 500,
            neighbours: 10,
            max_edge_m: 30.0,
            clearance_m: 1.75,
            clearance_to: ClearanceTo::Cells,
            search: RoadmapSearch::Astar,
            goal: RoadmapGoal::InReach,
            seconds_per_expansion: 0.0,
        }
    }
}

/// From what milestones and edges keep their clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClearanceTo {
    /// From the nearest edge of a bush, and from the field's border.
    Cells,
    /// From the nearest centre of a bush cell, as the original program has it; the border only encloses them.
    CellCentres,
}

/// How the roadmap is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapSearch {
    Astar,
    Dijkstra,
    /// Best first by straight-line distance to the goal alone.
    Greedy,
}

/// Which milestones a query aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapGoal {
    /// Those from which the fire can be reached; the drive ends in the goal disc.
    InReach,
    /// The one nearest to the fire, of those from which it can be reached; the drive ends about that milestone, where
    /// the fire is in reach.
    NearestMilestone,
}
