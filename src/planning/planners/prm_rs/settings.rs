use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a scenario may choose about the truck's planner `prm-rs`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmRsSettings {
    /// Poses to draw, besides those at the corners of bushes.
    pub samples: u32,
    /// Places about every convex corner of a bush at which the truck may pass it, in either direction.
    pub corner_places: u32,
    /// Each pose is joined to so many of the nearest ones before it.
    pub neighbours: u32,
    /// No edge costs more.
    pub max_edge_m: f64,
    /// What the body keeps from bushes and border; where that leads nowhere, a third of it, then a twenty-fifth, at least
    /// 1 cm.
    pub clearance_m: f64,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// Shortcuts tried on the path found.
    pub shortcuts: u32,
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

impl Default for PrmRsSettings {
    fn default() -> Self {
        Self {
            samples: 200,
            corner_places: 2,
            neighbours: 16,
            max_edge_m: 40.0,
            clearance_m: 0.6,
            cusp_cost: 2.0,
            shortcuts: 50,
            seconds_per_expansion: 0.0,
        }
    }
}
