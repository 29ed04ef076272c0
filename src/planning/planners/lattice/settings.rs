use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a scenario may choose about the truck's planner `lattice`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSettings {
    /// Poses that the floods of one query may spread from. The finest flood alone can take 2.9 million on 250 m x 250 m.
    pub max_expansions: u32,
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

impl Default for LatticeSettings {
    fn default() -> Self {
        Self { max_expansions: 4_000_000, seconds_per_expansion: 0.0 }
    }
}
