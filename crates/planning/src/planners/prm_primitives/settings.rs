//! Settings of the planner `prm+primitives`, and their ranges.
//!
//! Defaults are those of the scenario `contest`. Lengths are metres.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::kit::sample_density::{check_density, samples_on};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges;

/// The probabilistic roadmap over the truck's body centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmSettings {
    /// Number of random milestones.
    pub samples: u32,
    /// Number of random milestones per hectare, instead of `samples`: the same density on fields of all sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples_per_hectare: Option<f64>,
    /// Number of nearest milestones to which each milestone is joined if the straight line is free.
    pub neighbours: u32,
    /// The longest edge.
    pub max_edge_m: f64,
    /// Free radius around milestones and along edges.
    pub clearance_m: f64,
    pub clearance_to: ClearanceTo,
    pub search: RoadmapSearch,
    pub goal: RoadmapGoal,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for PrmSettings {
    fn default() -> Self {
        Self {
            samples: 500,
            samples_per_hectare: None,
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

/// The obstacles from which milestones and edges keep their clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClearanceTo {
    /// From the nearest edge of a bush, and from the field's border.
    Cells,
    /// From the nearest centre of a bush cell, as the original program has it; the border only encloses them.
    CellCentres,
}

/// The search on the roadmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapSearch {
    Astar,
    Dijkstra,
    /// Best first by straight-line distance to the goal alone.
    Greedy,
}

/// The milestones that are the goals of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapGoal {
    /// All milestones within reach of the fire; the drive ends in the goal disc.
    InReach,
    /// The milestone nearest to the fire among those within reach; the drive ends near that milestone, with the fire in
    /// reach.
    NearestMilestone,
}

impl PrmSettings {
    /// Returns how many milestones to draw on a field.
    pub(super) fn samples_on(&self, frame: &FieldFrame) -> u32 {
        self.samples_per_hectare.map_or(self.samples, |density| samples_on(frame, density))
    }
}

ranges! { PrmSettings {
    samples: 0.0..=100_000.0, neighbours: 1.0..=100.0, max_edge_m: 0.01..=1e6, clearance_m: 0.0..=1000.0,
    seconds_per_expansion: 0.0..=1e6,
} and |settings, frame| check_density(settings.samples_per_hectare, frame) }
