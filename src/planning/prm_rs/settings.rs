use serde::{Deserialize, Serialize};

/// What a scenario may choose about the truck's planner `prm-rs`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PrmRsSettings {
    /// Poses to draw.
    pub samples: u32,
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

impl Default for PrmRsSettings {
    fn default() -> Self {
        Self { samples: 1_000, seconds_per_expansion: 0.0 }
    }
}
