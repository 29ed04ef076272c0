//! Weights of the networks of learned policies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::network::Network;
use crate::Scenario;
use crate::faults::check::{Check, TablePath};
use wildfire_base::input_file::list_of_at_most;

/// The number of hidden units of each network.
pub const HIDDEN: usize = 8;

/// The weights of the networks of `learned` policies, instead of those that come with the program.
///
/// For each of 8 hidden units the weights of the inputs and its bias, then the weights of the units, and the last bias.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Learned {
    /// 41 weights of the network that weighs bushes for `dispatch.idle = "learned"`.
    #[serde(deserialize_with = "list_of_at_most::<1_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub posts: Vec<f64>,
    /// 73 weights of the network that corrects the worth of cells for `wumpus.goal = "learned"`.
    #[serde(deserialize_with = "list_of_at_most::<1_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<f64>,
}

/// The greatest weight, and the least with a minus sign.
const MAX: f64 = 1e6;

impl Learned {
    /// The inputs for a bush and a recent ignition.
    pub const STAGING_INPUTS: [&str; 3] = ["distance / 100 m", "age / 60 s", "share of trucks that are idle"];

    /// The inputs for a cell that a Wumpus may light.
    pub const LIGHT_INPUTS: [&str; 7] = [
        "distance / 100 m",
        "bushes within the spread radius / 10",
        "distance to the nearest truck / 100 m",
        "distance to the second nearest truck / 100 m",
        "distance to the nearest other agent or its goal / 100 m",
        "fires within 60 m / 10",
        "fires per truck / 10",
    ];

    pub(crate) fn check(&self, table: &TablePath) -> Check {
        for (key, weights, inputs) in
            [("posts", &self.posts, Self::STAGING_INPUTS.len()), ("lights", &self.lights, Self::LIGHT_INPUTS.len())]
        {
            let size = Network::size(inputs);
            if !weights.is_empty() && weights.len() != size {
                return table.refuse(key, format!("a list of {}", weights.len()), format!("{size} weights"));
            }
            if let Some(weight) = weights.iter().find(|weight| !weight.is_finite() || weight.abs() > MAX) {
                return table.refuse(key, weight.to_string(), format!("weights from -{MAX:e} to {MAX:e}"));
            }
        }
        Ok(())
    }
}

/// Warns of weights that no policy uses.
pub(crate) fn warn_of_weights(scenario: &Scenario, found: &mut Vec<String>) {
    let Some(learned) = &scenario.learned else { return };
    let dispatch = scenario.dispatch.as_ref();
    let is_used = [
        dispatch.is_some_and(|dispatch| dispatch.idle == crate::IdleRule::Learned),
        scenario.wumpus.iter().any(|wumpus| wumpus.goal == crate::WumpusGoal::Learned),
    ];
    let lists = [("posts", &learned.posts), ("lights", &learned.lights)];
    for ((key, weights), is_used) in lists.into_iter().zip(is_used) {
        if !weights.is_empty() && !is_used {
            found.push(format!("`learned.{key}` has no effect: no policy uses these weights."));
        }
    }
}
