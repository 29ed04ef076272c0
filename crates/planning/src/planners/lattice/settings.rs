//! Settings of the planner `lattice`, and their ranges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::ranges;

/// Settings of the planner `lattice`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSettings {
    /// Poses from which the floods of one query may spread. The finest flood alone can take 2.9 million on 250 m x 250 m.
    pub max_expansions: u32,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for LatticeSettings {
    fn default() -> Self {
        Self { max_expansions: 4_000_000, seconds_per_expansion: 0.0 }
    }
}

ranges! { LatticeSettings { max_expansions: 1.0..=1e8, seconds_per_expansion: 0.0..=1e6 } }
