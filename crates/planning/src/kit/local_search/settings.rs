//! Settings of the local search.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::kit::closed_set::check_bins;
use wildfire_base::ranges;

/// The local search with motion primitives.
///
/// Costs of turning and reversing are added per metre or per move, as [`MotionCost`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrimitiveSettings {
    /// Length of a lattice motion.
    pub step_m: f64,
    /// Side of a bin of the closed set.
    pub bin_m: f64,
    /// Bins per full turn.
    pub headings: u32,
    /// Clearance of the body from bushes and border; if no path is found, half of it, then a tenth, at least 1 cm.
    pub clearance_m: f64,
    pub cost: MotionCost,
    /// Added for motions that turn.
    pub turn_cost: f64,
    /// Added for motions in reverse.
    pub reverse_cost: f64,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// Weight of the estimated distance to the goal.
    pub heuristic_weight: f64,
    /// Besides lattice motions, offer turns of the right length followed by a straight to a waypoint or into the goal.
    pub aimed: bool,
    /// Leave out waypoints that need not be visited to keep the roadmap's clearance.
    pub thin_waypoints: bool,
    /// A waypoint counts as passed when the body's centre is this near, at any heading.
    pub waypoint_tolerance_m: f64,
    /// Start a new search at every waypoint passed, from the pose that passed it.
    pub restart_at_waypoints: bool,
    /// If the roadmap or the drive along it finds no path, search again without waypoints, directly for the goal.
    pub search_alone: bool,
    /// Nodes that one query may expand, over all its searches.
    ///
    /// The drive along the roadmap's route may spend half, and so may the one of `search_alone`; neither gets what the
    /// other leaves. Of the half, the clearances may spend 16, 30 and 54 percent in turn, rounded up to whole nodes as
    /// long as the query has nodes left.
    pub max_expansions: u32,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for PrimitiveSettings {
    fn default() -> Self {
        Self {
            step_m: 4.0,
            bin_m: 4.0,
            headings: 24,
            clearance_m: 0.5,
            cost: MotionCost::Metres,
            turn_cost: 0.02,
            reverse_cost: 0.05,
            cusp_cost: 1.0,
            heuristic_weight: 1.5,
            aimed: true,
            thin_waypoints: true,
            waypoint_tolerance_m: 4.0,
            restart_at_waypoints: false,
            search_alone: true,
            max_expansions: 2_000,
            seconds_per_expansion: 0.0,
        }
    }
}

/// The unit of the local search's costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MotionCost {
    /// Every metre driven costs 1.
    Metres,
    /// Every motion costs 1, as in the original program.
    Moves,
}

ranges! { PrimitiveSettings {
    step_m: 0.1..=1000.0, bin_m: 0.01..=1000.0, headings: 4.0..=360.0, clearance_m: 0.01..=100.0,
    turn_cost: 0.0..=1e6, reverse_cost: 0.0..=1e6, cusp_cost: 0.0..=1e6, heuristic_weight: 0.0..=1000.0,
    waypoint_tolerance_m: 0.01..=1000.0, max_expansions: 1.0..=1e6, seconds_per_expansion: 0.0..=1e6,
} and |settings, frame| check_bins(settings.bin_m, frame) }
