use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a scenario may choose about the truck's planner `hybrid-astar`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HybridSettings {
    /// What the body keeps from bushes and border; where that leads nowhere, two thirds of it, then a third, then a
    /// twenty-fifth, at least 1 cm.
    pub clearance_m: f64,
    /// Length of a lattice motion.
    pub step_m: f64,
    /// Side of a bin of the closed set.
    pub bin_m: f64,
    /// Bins a full turn.
    pub headings: u32,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// What the estimate of the metres still to drive is multiplied with.
    pub heuristic_weight: f64,
    /// Shortcuts tried on the path found.
    pub shortcuts: u32,
    /// Nodes that one query may expand, over all its searches.
    pub max_expansions: u32,
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

impl Default for HybridSettings {
    fn default() -> Self {
        Self {
            clearance_m: 0.75,
            step_m: 4.0,
            bin_m: 2.5,
            headings: 24,
            cusp_cost: 4.0,
            heuristic_weight: 1.5,
            shortcuts: 100,
            max_expansions: 30_000,
            seconds_per_expansion: 0.0,
        }
    }
}
