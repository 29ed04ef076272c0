//! Settings of the planner `hybrid-astar`, and their ranges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::kit::closed_set::check_bins;
use crate::kit::relaxed_search::MAX_FIRST_EXPANSIONS;
use wildfire_base::ranges;

/// Settings of the planner `hybrid-astar`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HybridSettings {
    /// Clearance of the body from bushes and border; if no path is found, two thirds of it, then a third, then a
    /// twenty-fifth, at least 1 cm.
    pub clearance_m: f64,
    /// Length of a lattice motion.
    pub step_m: f64,
    /// Side of a bin of the closed set.
    pub bin_m: f64,
    /// Bins per full turn.
    pub headings: u32,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// Weight of the estimated distance to the goal.
    pub heuristic_weight: f64,
    /// Shortcuts tried on the path found.
    pub shortcuts: u32,
    /// Rounds of tightening the bends of that path; 0: none. A path that is nearly the shortest curve between its ends
    /// is left unchanged.
    pub pulls: u32,
    /// Nodes expanded at the full clearance before it is reduced.
    pub first_expansions: u32,
    /// Nodes that one query may expand, over all its searches.
    pub max_expansions: u32,
    /// Simulated planning time charged, during which the truck stands still.
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
            pulls: 0,
            first_expansions: 250,
            max_expansions: 30_000,
            seconds_per_expansion: 0.0,
        }
    }
}

ranges! { HybridSettings {
    clearance_m: 0.01..=100.0, step_m: 0.1..=1000.0, bin_m: 0.01..=1000.0, headings: 4.0..=360.0,
    cusp_cost: 0.0..=1e6, heuristic_weight: 0.0..=1000.0, shortcuts: 0.0..=1e6, pulls: 0.0..=1000.0,
    first_expansions: 1.0..=MAX_FIRST_EXPANSIONS as f64, max_expansions: 1.0..=1e6, seconds_per_expansion: 0.0..=1e6,
} and |settings, frame| check_bins(settings.bin_m, frame) }
