//! The arsonist's learned policy: the worth of density, corrected by a network that knows trucks, fires and other Wumpuses.

use std::sync::Arc;

use glam::DVec2;

use crate::policies::densest::Densest;
use crate::policies::nearest_intact::ring_around;
use crate::policies::{Action, AgentView, Observation, Policy, first_goes};
use wildfire_base::geometry::{Cell, FieldFrame, ops};
use wildfire_scenario::Network;
use wildfire_timeline::AgentId;

/// The cells that are looked at, nearest first by square rings.
const EXAMINED: usize = 300;

/// The distance beyond which others do not matter, metres.
const FAR_M: f64 = 300.0;

/// The radius within which fires count as near, metres.
const NEAR_M: f64 = 60.0;

/// Chooses the cell that is worth most: what can burn around it per metre of walk, as [`Densest`] counts, times the exponential
/// of a network's value. Ties go to the cell that is looked at first.
#[derive(Clone, Debug)]
pub struct LearnedArsonist {
    density: Densest,
    network: Arc<Network>,
}

impl LearnedArsonist {
    /// Creates the rule for a spread radius in metres.
    pub fn new(frame: &FieldFrame, spread_m: f64, network: Arc<Network>) -> Self {
        Self { density: Densest::new(frame, spread_m, true), network }
    }

    fn best(&self, seen: &Observation<'_>, agent: &AgentView) -> Option<Cell> {
        let frame = seen.fires.frame();
        let middle = (agent.place / frame.cell_m).floor();
        let rings = 0..i32::from(frame.cols.max(frame.rows));
        let cells = rings.flat_map(|ring| ring_around(frame, (middle.x as i32, middle.y as i32), ring));
        let options = cells.filter(|&cell| seen.is_option(agent.id, cell)).take(EXAMINED);
        let around = Around::new(seen, agent, &self.density);
        let mut best: Option<(f64, Cell)> = None;
        for cell in options {
            let place = frame.centre(cell);
            let thickness = self.density.thickness(seen, cell) as f64;
            let worth = self.density.worth(thickness, place, agent.place, &around.others);
            // An option can burn itself, so its worth is above zero.
            let value = ops::ln(worth) + self.network.value(&around.inputs(agent.place, place, thickness));
            if best.is_none_or(|(max, _)| value > max) {
                best = Some((value, cell));
            }
        }
        best.map(|(_, cell)| cell)
    }
}

impl Policy for LearnedArsonist {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        first_goes(seen, queried, |agent| self.best(seen, agent))
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(self.clone()))
    }
}

/// What an arsonist takes into account besides bushes.
struct Around {
    others: Vec<DVec2>,
    trucks: Vec<DVec2>,
    fires: Vec<DVec2>,
}

impl Around {
    fn new(seen: &Observation<'_>, agent: &AgentView, density: &Densest) -> Self {
        let frame = seen.fires.frame();
        let trucks = seen.agents.iter().filter(|other| other.id.role.suppresses());
        Self {
            others: density.others(seen, agent),
            trucks: trucks.map(|truck| truck.place).collect(),
            fires: seen.fires.burning().map(|cell| frame.centre(cell)).collect(),
        }
    }

    /// Lists the inputs of the network for a cell, in the order of [`wildfire_scenario::Learned::LIGHT_INPUTS`].
    fn inputs(&self, from: DVec2, place: DVec2, thickness: f64) -> [f64; 7] {
        // Where trucks are missing, they count as far away.
        let (mut first, mut second) = (FAR_M, FAR_M);
        for truck in &self.trucks {
            let metres = (*truck - place).length();
            (first, second) = if metres < first { (metres, first) } else { (first, second.min(metres)) };
        }
        let fires = self.fires.iter().filter(|fire| (**fire - place).length_squared() <= NEAR_M * NEAR_M).count();
        let per_truck = self.fires.len() as f64 / self.trucks.len().max(1) as f64;
        let other = self.others.iter().map(|other| (*other - place).length()).fold(FAR_M, f64::min);
        let way = (place - from).length().min(FAR_M);
        // Divisors that keep the inputs of the network near 1.
        [
            way / 100.0,
            thickness / 10.0,
            first / 100.0,
            second / 100.0,
            other / 100.0,
            fires as f64 / 10.0,
            per_truck / 10.0,
        ]
    }
}
