//! The arsonist's policy of chance: a random bush.
//!
//! Each Wumpus goes through one permutation of all bushes, from its own random stream, and takes the first that is an
//! option, from where it last found one. That is the law of a fresh draw, but two planners on one seed meet the same
//! arsonist, and bushes that can burn again wait for their next turn.

use std::collections::BTreeMap;

use rand::seq::SliceRandom;

use super::{AgentView, Observation, Rule};
use crate::geometry::Cell;
use crate::rng;
use crate::timeline::AgentId;

/// A random one of its options.
#[derive(Debug)]
pub struct RandomIntact {
    bushes: Vec<Cell>,
    seed: u64,
    turns: BTreeMap<AgentId, Turns>,
}

/// The order of one Wumpus.
#[derive(Debug)]
struct Turns {
    permutation: Vec<Cell>,
    /// Where the next one is looked for first.
    next: usize,
}

impl RandomIntact {
    pub fn new(bushes: Vec<Cell>, seed: u64) -> Self {
        Self { bushes, seed, turns: BTreeMap::new() }
    }
}

impl Rule for RandomIntact {
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell> {
        let Turns { permutation, next } = self.turns.entry(agent.id).or_insert_with(|| {
            let mut permutation = self.bushes.clone();
            permutation.shuffle(&mut rng::stream(self.seed, &agent.id.to_string()));
            Turns { permutation, next: 0 }
        });
        let index = |cell: &Cell| seen.fires.frame().index(*cell);
        let is_option = |cell: &Cell| options.binary_search_by_key(&index(cell), index).is_ok();
        let place = (*next..permutation.len()).chain(0..*next).find(|&place| is_option(&permutation[place]))?;
        *next = place + 1;
        Some(permutation[place])
    }
}
