//! What trucks do about other trucks in their way.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::ranges;

/// What a truck tries before it waits for trucks that block all its goals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TrafficRules {
    /// Number of goals considered in one decision although other trucks block them.
    pub goals: u32,
    pub detours: Detours,
}

impl Default for TrafficRules {
    fn default() -> Self {
        Self { goals: 3, detours: Detours::First }
    }
}

/// Selects the goals to which a truck looks for a path around other trucks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Detours {
    /// To the first goal, and only after all others have been considered.
    First,
    /// To each goal, before the next is considered.
    Each,
}

ranges! { TrafficRules { goals: 1.0..=100.0 } }
