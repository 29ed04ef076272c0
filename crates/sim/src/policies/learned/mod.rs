//! Policies with learned parts: small networks that correct what a rule reckons, or weigh what it counts.
//!
//! A network of zeros changes nothing, so a learned policy is a rule plus what training added to it. Weights come with the
//! program, trained by the scripts in `python/training`, or from the table `learned` of a scenario.

mod arsonist;

use std::sync::{Arc, LazyLock};

use wildfire_scenario::{Learned, Network};

pub use arsonist::LearnedArsonist;

/// The networks of a run's learned policies.
#[derive(Clone, Debug)]
pub struct Networks {
    /// Weigh bushes for the places where idle trucks wait.
    pub posts: Arc<Network>,
    /// Corrects the worth of a cell to an arsonist.
    pub lights: Arc<Network>,
}

/// The weights that come with the program.
static SHIPPED: LazyLock<Learned> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../../learned/weights.json")).expect("the weights are lists of numbers")
});

impl Networks {
    /// Takes the weights of a scenario, and those that come with the program for what it leaves out.
    pub fn new(custom: Option<&Learned>) -> Self {
        let pick = |weights: fn(&Learned) -> &Vec<f64>| {
            let custom = custom.map(weights).filter(|custom| !custom.is_empty());
            custom.unwrap_or_else(|| weights(&SHIPPED)).as_slice()
        };
        Self {
            posts: Arc::new(Network::new(Learned::STAGING_INPUTS.len(), pick(|learned| &learned.posts))),
            lights: Arc::new(Network::new(Learned::LIGHT_INPUTS.len(), pick(|learned| &learned.lights))),
        }
    }
}
