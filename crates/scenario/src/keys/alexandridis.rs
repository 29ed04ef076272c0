//! The automaton of Alexandridis in a scenario: its probability, and what wind, slope and vegetation do to it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::ranges;
use wildfire_base::time::SimTime;
use wildfire_fire::models::{AlexandridisRules, Density, Vegetation};

/// The fire model `alexandridis`; see [`wildfire_fire::models::Alexandridis`] for what the numbers are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AlexandridisSettings {
    /// The probability that fire goes to a neighbour on level ground without wind.
    pub p0: f64,
    pub wind_c1: f64,
    pub wind_c2: f64,
    /// Per degree of slope.
    pub slope_a: f64,
    pub vegetation: Vegetation,
    pub density: Density,
    /// The length of a step, which the model leaves open.
    pub step_s: f64,
}

impl Default for AlexandridisSettings {
    fn default() -> Self {
        let AlexandridisRules { p0, wind_c1, wind_c2, slope_a, vegetation, density, step } =
            AlexandridisRules::default();
        Self { p0, wind_c1, wind_c2, slope_a, vegetation, density, step_s: step.as_seconds() }
    }
}

impl AlexandridisSettings {
    /// Returns the rules as runs have them.
    pub fn rules(&self) -> AlexandridisRules {
        let Self { p0, wind_c1, wind_c2, slope_a, vegetation, density, step_s } = *self;
        AlexandridisRules { p0, wind_c1, wind_c2, slope_a, vegetation, density, step: SimTime::from_seconds(step_s) }
    }
}

ranges! { AlexandridisSettings {
    p0: 0.0..=1.0, wind_c1: -1.0..=1.0, wind_c2: -1.0..=1.0, slope_a: -1.0..=1.0, step_s: 0.001..=1e6,
} }
