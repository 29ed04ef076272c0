//! Crews that build line round a fire.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::check::{Check, TablePath};
use crate::{FireModelName, FuelName, LinePolicy, MAX_AGENTS, Scenario};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::input_file::list_of_at_most;
use wildfire_base::ranges;
use wildfire_fire::contain::Tactic;
use wildfire_planning::PlannerName;

/// The most places to protect.
const MAX_PLACES: usize = 100;

/// The order that all crews of a run follow together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LineSettings {
    pub policy: LinePolicy,
    /// The end of the fire at which `direct` and `parallel` begin.
    pub from: Tactic,
    /// Metres between the front and the line, for `parallel`.
    pub offset_m: f64,
    /// The places that `point-protection` builds line round.
    #[serde(deserialize_with = "list_of_at_most::<2_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub protect: Vec<ProtectedPlace>,
    pub holds: LineHolds,
    /// With `holds = "flame"`: flame length at which a kilometre of line holds in half of all cases, and scale of the logistic
    /// function, metres.
    pub flame_half_m: f64,
    pub flame_scale_m: f64,
    /// Metres of line for which chance is drawn once.
    pub section_m: f64,
}

impl Default for LineSettings {
    fn default() -> Self {
        let policy = LinePolicy::Direct;
        let from = Tactic::Rear;
        let holds = LineHolds::Always;
        let protect = Vec::new();
        Self { policy, from, offset_m: 20.0, protect, holds, flame_half_m: 1.2, flame_scale_m: 0.3, section_m: 20.0 }
    }
}

ranges! { LineSettings {
    offset_m: 0.0..=10_000.0, flame_half_m: 0.0..=100.0, flame_scale_m: 0.001..=100.0, section_m: 1.0..=1e6; protect,
} }

/// A place that fire is to be kept from: a house, a mast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProtectedPlace {
    pub x_m: f64,
    pub y_m: f64,
    /// The radius of the line round it.
    pub radius_m: f64,
}

ranges! { ProtectedPlace { x_m: -1e6..=1e6, y_m: -1e6..=1e6, radius_m: 1.0..=10_000.0 } }

/// Line stops all fire, or by chance: the longer the flames of the fire that comes to it, the less often.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LineHolds {
    Always,
    Flame,
}

/// People or machines that walk to the fire and build line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crew {
    /// The number of crews that this entry is.
    pub count: u32,
    /// Where they set out, metres, and when, seconds.
    pub x_m: f64,
    pub y_m: f64,
    #[serde(default)]
    pub at_s: f64,
    /// Speed at which they walk to where the line begins, in a straight line.
    pub speed_mps: f64,
    /// Metres of line that each builds in an hour, on both flanks together.
    pub rate_m_h: f64,
    /// Other rates by the code of the fuel model in which they build.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rate_by_fuel: BTreeMap<String, f64>,
}

ranges! { Crew {
    count: 0.0..=10_000.0, x_m: -1e6..=1e6, y_m: -1e6..=1e6, at_s: 0.0..=1e6, speed_mps: 0.01..=100.0, rate_m_h: 0.0..=1e6,
} }

impl Crew {
    /// Returns the metres of line that all of the entry build in a second on a fuel.
    pub fn rate_mps(&self, fuel: u8) -> f64 {
        let mut rates = self.rate_by_fuel.iter();
        let of_fuel = rates.find(|(code, _)| FuelName::parse(code).is_some_and(|name| name.number() == fuel));
        f64::from(self.count) * of_fuel.map_or(self.rate_m_h, |(_, &rate)| rate) / 3600.0
    }

    /// Returns the greatest of these rates.
    pub fn max_mps(&self) -> f64 {
        f64::from(self.count) * self.rate_by_fuel.values().copied().fold(self.rate_m_h, f64::max) / 3600.0
    }
}

impl Scenario {
    pub(crate) fn check_crews(&self, frame: &FieldFrame) -> Check {
        let top = TablePath::named("");
        let table = TablePath::named("line");
        if let Some(line) = &self.line {
            line.policy.check(&table, "policy", &self.policy)?;
            table.count("protect", line.protect.len(), MAX_PLACES)?;
            // This is the only policy that needs places, and the only one that uses any.
            if line.protect.is_empty() == (line.policy == LinePolicy::PointProtection) {
                let found = format!("{} places", line.protect.len());
                return table.refuse("protect", found, "places with the policy `point-protection` only".into());
            }
        }
        top.count("crew", self.crew.len(), MAX_AGENTS)?;
        for (number, crew) in self.crew.iter().enumerate() {
            let entry = TablePath::entry("crew", number);
            entry.settings(crew, frame)?;
            for (code, &rate) in &crew.rate_by_fuel {
                entry.inner("rate_by_fuel").number(code, rate, 0.0..=1e6)?;
                if FuelName::parse(code).is_none() {
                    let expected = "the code of a fuel model such as `GR2`".into();
                    return entry.inner("rate_by_fuel").refuse(code, "this name".into(), expected);
                }
            }
        }
        // Only the front of `rothermel` goes from cell to cell and can be stopped by line; other fire steps over it.
        if self.crew.is_empty() || self.fire.model == FireModelName::Rothermel {
            return Ok(());
        }
        let expected = "the model `rothermel` where there are crews, as other fire steps over line".into();
        TablePath::named("fire").refuse("model", "another one".into(), expected)
    }

    /// Returns the policy of the crews, if there are any and it is not built in.
    pub fn custom_line_policy(&self) -> Option<&PlannerName> {
        match &self.line.as_ref().filter(|_| !self.crew.is_empty())?.policy {
            LinePolicy::Policy(name) => Some(name),
            _ => None,
        }
    }
}
