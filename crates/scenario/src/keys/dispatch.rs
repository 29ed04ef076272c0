//! Who goes to which fire, decided for all trucks together, and what the trucks know when that is decided.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::learned::warn_of_weights;
use crate::Scenario;
use wildfire_base::ranges;

/// The most rollouts of one decision: some seconds of CPU time.
const MAX_ROLLOUTS: f64 = 100_000.0;

/// One policy for the team of trucks, in place of their own goals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dispatch {
    pub policy: DispatchPolicy,
    pub idle: IdleRule,
    /// Number of futures that the policy `rollout` simulates for one decision.
    pub rollouts: u32,
    /// Simulated time that a team decision costs for each pair of truck and fire that it considers, or for each
    /// rollout; trucks with a new goal wait for it.
    pub seconds_per_evaluation: f64,
}

impl Default for Dispatch {
    fn default() -> Self {
        Self { policy: DispatchPolicy::Nearest, idle: IdleRule::Stay, rollouts: 40, seconds_per_evaluation: 0.0 }
    }
}

/// Selects which truck goes to which fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DispatchPolicy {
    /// Each truck to the nearest fire, in the order of truck numbers.
    Nearest,
    /// The same with the nearest fire by planned drive.
    NearestByDrive,
    /// The nearest fire that can still be extinguished, for the truck that gets there first.
    NearestSavable,
    /// The assignment of free trucks to fires with the lowest total cost.
    Hungarian,
    /// The fire that threatens the most bushes first.
    ThreatFirst,
    /// Routes with deadlines: each fire goes to the truck whose route it fits best, recomputed at each event.
    Auction,
    /// The best of several assignments, by their simulated futures.
    Rollout,
}

wildfire_base::names! { DispatchPolicy {
    Nearest: "nearest",
    NearestByDrive: "nearest-by-drive",
    NearestSavable: "nearest-savable",
    Hungarian: "hungarian",
    ThreatFirst: "threat-first",
    Auction: "auction",
    Rollout: "rollout",
} }

/// Selects where trucks without a goal wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IdleRule {
    /// Where they are.
    Stay,
    /// Spread over the bushes that are intact, each in the middle of its share.
    Centroids,
    /// In their regions of the field, which are those of their starts.
    Regions,
    /// Spread over the bushes, weighted by a small trained network that knows recent ignitions.
    Learned,
}

wildfire_base::names! { IdleRule { Stay: "stay", Centroids: "centroids", Regions: "regions", Learned: "learned" } }

impl Dispatch {
    /// Returns what tables call the policy of the trucks: the policy, and the idle rule where it moves anybody.
    pub fn label(&self) -> String {
        match self.idle {
            IdleRule::Stay => self.policy.to_string(),
            idle => format!("{}+{idle}", self.policy),
        }
    }
}

ranges! { Dispatch { rollouts: 1.0..=MAX_ROLLOUTS, seconds_per_evaluation: 0.0..=1000.0 } }

/// What the team of trucks knows of the field when its policy decides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sight {
    pub field: SightOfField,
    /// Sight radius from the middle of a truck's body; only for `field = "radius"`.
    pub radius_m: f64,
    /// With `field = "radius"`, seconds after which somebody else reports a burning cell; without it nobody does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report_s: Option<f64>,
    /// True if trucks see the Wumpuses, as far as they see the field; following an arsonist ends the contest.
    pub wumpuses: bool,
}

impl Default for Sight {
    fn default() -> Self {
        Self { field: SightOfField::Everything, radius_m: 100.0, report_s: None, wumpuses: false }
    }
}

/// The part of the field that trucks see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SightOfField {
    /// All fires and all intact bushes.
    Everything,
    /// All fires; bushes that do not burn are known from the map, but not their state.
    Burning,
    /// Everything within `radius_m` of a truck; the rest only from the map.
    Radius,
}

ranges! { Sight { radius_m: 0.0..=1e6, report_s: 0.0..=1e6 } }

/// Warns of values that do nothing.
pub(crate) fn warn_of_team(scenario: &Scenario, found: &mut Vec<String>) {
    warn_of_weights(scenario, found);
    let Some(dispatch) = &scenario.dispatch else {
        if scenario.sight.is_some() {
            found.push(
                "The table `sight` has no effect: without `dispatch` trucks follow their own goals and know all fires."
                    .into(),
            );
        }
        return;
    };
    if scenario.unimog.is_empty() {
        found.push("The table `dispatch` has no effect: there are no trucks.".into());
    }
    if dispatch.policy != DispatchPolicy::Rollout && dispatch.rollouts != Dispatch::default().rollouts {
        found.push(format!(
            "`dispatch.rollouts` has no effect: the policy `{}` does not use rollouts.",
            dispatch.policy
        ));
    }
    // Under `nearest` trucks still reconsider by their own `retarget`.
    let keeps = dispatch.policy != DispatchPolicy::Nearest;
    if keeps && scenario.unimog.iter().any(|truck| truck.retarget != crate::Retarget::Never) {
        found.push(format!(
            "`unimog.retarget` has no effect: the policy `{}` decides when trucks change their goals.",
            dispatch.policy
        ));
    }
    if dispatch.idle == IdleRule::Regions && scenario.unimog.len() == 1 {
        found.push("`dispatch.idle` \"regions\" equals \"stay\" for one truck: the whole field is its region.".into());
    }
    let Some(sight) = &scenario.sight else { return };
    let of_radius = [("radius_m", sight.radius_m != Sight::default().radius_m), ("report_s", sight.report_s.is_some())];
    for (key, _) in of_radius.iter().filter(|&&(_, is_set)| is_set && sight.field != SightOfField::Radius) {
        found.push(format!("`sight.{key}` has no effect: only `sight.field` \"radius\" uses it."));
    }
    if sight.wumpuses && scenario.wumpus.is_empty() {
        found.push("`sight.wumpuses` has no effect: there is no Wumpus.".into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadedScenario, MemoryLimit, explain};

    fn explained(changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let loaded = LoadedScenario::open("fleet", &changes).expect("this scenario is right");
        let text = explain(&loaded, MemoryLimit::default()).to_text();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn values_that_do_nothing_are_warned_of() {
        for (changes, expected) in [
            (&["sight.wumpuses=true"][..], "The table `sight` has no effect"),
            (&["dispatch.policy=auction", "dispatch.rollouts=7"], "`dispatch.rollouts` has no effect"),
            (&["dispatch.policy=auction", "unimog.retarget=on-event"], "`unimog.retarget` has no effect"),
            (&["dispatch.policy=auction", "sight.radius_m=7"], "`sight.radius_m` has no effect"),
            (&["dispatch.policy=auction", "sight.report_s=7"], "`sight.report_s` has no effect"),
        ] {
            let text = explained(changes);
            assert!(text.contains(expected), "`{expected}` is not in {text}");
        }
        assert!(!explained(&["dispatch.policy=auction", "dispatch.idle=centroids"]).contains("has no effect"));
    }

    #[test]
    fn every_name_reads_back() {
        for policy in DispatchPolicy::ALL {
            for idle in IdleRule::ALL {
                let table = toml::from_str::<Dispatch>(&format!("policy = '{policy}'\nidle = '{idle}'"));
                let dispatch = table.expect("these names are known");
                assert_eq!((dispatch.policy, dispatch.idle), (policy, idle));
            }
        }
    }
}
