//! The arsonist's random policy: any bush that it can light.
//!
//! Each Wumpus goes through one permutation of all bushes, from its own random stream, and takes the first that is an
//! option, from where it last found one. That is the law of a fresh draw, but two planners on one seed meet the same
//! arsonist, and bushes that can burn again wait for their next turn.
//!
//! A Wumpus comes to few of the bushes of a large field, so that only the beginning of its permutation is kept.

use std::collections::BTreeMap;

use super::{Action, Observation, Policy};
use wildfire_base::geometry::Cell;
use wildfire_base::rng::{self, ShuffledPrefix};
use wildfire_timeline::AgentId;

/// Chooses a random option.
#[derive(Clone, Debug)]
pub struct RandomIntact {
    bushes: Vec<Cell>,
    seed: u64,
    turns: BTreeMap<AgentId, Turns>,
}

/// The order of one Wumpus.
#[derive(Clone, Debug)]
struct Turns {
    permutation: ShuffledPrefix,
    /// Where the next one is looked for first.
    next: usize,
}

impl RandomIntact {
    pub fn new(bushes: Vec<Cell>, seed: u64) -> Self {
        Self { bushes, seed, turns: BTreeMap::new() }
    }

    /// Returns the next of an agent's options.
    fn draw(&mut self, seen: &Observation<'_>, agent: AgentId) -> Option<Cell> {
        let (bushes, seed) = (&self.bushes, self.seed);
        let Turns { permutation, next } = self.turns.entry(agent).or_insert_with(|| Turns {
            permutation: ShuffledPrefix::new(bushes.len(), move || rng::stream(seed, &agent.to_string())),
            next: 0,
        });
        let (place, bush) = (*next..bushes.len())
            .chain(0..*next)
            .map(|place| (place, bushes[permutation.at(place)]))
            .find(|&(_, bush)| seen.is_option(agent, bush))?;
        *next = place + 1;
        Some(bush)
    }
}

impl Policy for RandomIntact {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        let first = queried.first();
        first.map(|&agent| (agent, self.draw(seen, agent).map_or(Action::Wait, Action::Go))).into_iter().collect()
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }

    fn reseed(&mut self, seed: u64) {
        self.seed = seed;
        self.turns.clear();
    }
}
