//! Settings of the planner `prm-rs`, and their ranges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::kit::sample_density::{check_density, hectares, samples_on};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges;

/// Settings of the planner `prm-rs`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmRsSettings {
    /// Number of random poses, besides those at the corners of bushes.
    pub samples: u32,
    /// Number of random poses per hectare, instead of `samples`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples_per_hectare: Option<f64>,
    /// Number of places around every convex corner of a bush where the truck may pass it, in either direction.
    pub corner_places: u32,
    /// Number of nearest earlier poses to which each pose is joined.
    pub neighbours: u32,
    /// The largest cost of an edge.
    pub max_edge_m: f64,
    /// Clearance of the body from bushes and border; if no path is found, a third of it, then a twenty-fifth, at least
    /// 1 cm.
    pub clearance_m: f64,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// Shortcuts tried on the path found.
    pub shortcuts: u32,
    /// When disconnected components are joined, for roadmaps built in one go.
    pub join: Join,
    /// Rounds of tightening the bends of that path; 0: none. A path that is nearly the shortest curve between its ends
    /// is left unchanged.
    pub pulls: u32,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

/// Selects when the components of a roadmap are joined: by edges between them, and by more poses around small
/// components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Join {
    /// While the roadmap is built.
    AtOnce,
    /// When a query first finds no path on the roadmap. Its components are not counted.
    WhenNeeded,
}

impl Default for PrmRsSettings {
    fn default() -> Self {
        Self {
            samples: 200,
            samples_per_hectare: None,
            corner_places: 2,
            neighbours: 16,
            max_edge_m: 40.0,
            clearance_m: 0.6,
            cusp_cost: 2.0,
            shortcuts: 50,
            join: Join::AtOnce,
            pulls: 0,
            seconds_per_expansion: 0.0,
        }
    }
}

impl PrmRsSettings {
    /// Returns how many poses to draw on a field.
    pub(super) fn samples_on(&self, frame: &FieldFrame) -> u32 {
        self.samples_per_hectare.map_or(self.samples, |density| samples_on(frame, density))
    }

    /// Returns how many poses to draw for every hectare of a field.
    pub(super) fn samples_per_hectare_on(&self, frame: &FieldFrame) -> f64 {
        self.samples_per_hectare.unwrap_or(f64::from(self.samples) / hectares(frame))
    }
}

ranges! { PrmRsSettings {
    samples: 0.0..=100_000.0, corner_places: 0.0..=10.0, neighbours: 1.0..=100.0, max_edge_m: 0.01..=1e6,
    clearance_m: 0.01..=100.0, cusp_cost: 0.0..=1e6, shortcuts: 0.0..=1e6, pulls: 0.0..=1000.0,
    seconds_per_expansion: 0.0..=1e6,
} and |settings, frame| check_density(settings.samples_per_hectare, frame) }
