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
    pub plan: TrafficPlan,
}

impl Default for TrafficRules {
    fn default() -> Self {
        Self { goals: 3, detours: Detours::First, plan: TrafficPlan::Alone }
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

/// Selects how a truck plans a drive that would meet other trucks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TrafficPlan {
    /// Around the places where the others will stand.
    Alone,
    /// In space and time, among the motions of all others.
    Together,
}

ranges! { TrafficRules { goals: 1.0..=100.0 } }
