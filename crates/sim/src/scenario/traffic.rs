//! What trucks do about others that are in their way.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::ranges;

/// What a truck tries before it waits for others that are in the way of all that it goes for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TrafficRules {
    /// Goals that it looks at in one decision though others are in the way to them.
    pub goals: u32,
    pub detours: Detours,
}

impl Default for TrafficRules {
    fn default() -> Self {
        Self { goals: 3, detours: Detours::First }
    }
}

/// Says to which goals a truck looks for a way round others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Detours {
    /// To the first, and only once all others have been looked at too.
    First,
    /// To each, before it looks at the next.
    Each,
}

ranges! { TrafficRules { goals: 1.0..=100.0 } }
