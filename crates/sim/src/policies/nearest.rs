//! Policies that go by distance, in a straight line from the middle of the agent's body to the cell's centre. Ties go to
//! the smaller cell index, since options come by index and the first of equals wins.

use glam::DVec2;

use super::{AgentView, Observation, Rule};
use wildfire_base::geometry::Cell;
use wildfire_fire::BushState;

/// Chooses the nearest: of fires for a truck, of what can be lit for a Wumpus.
#[derive(Clone, Copy, Debug)]
pub struct Nearest;

impl Rule for Nearest {
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell> {
        options.iter().copied().min_by(seen.fires.frame().by_distance(agent.place))
    }
}

/// Chooses the fire that has burned longest; of those that ignited together, the nearest.
#[derive(Clone, Copy, Debug)]
pub struct Oldest;

impl Rule for Oldest {
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell> {
        let since = |cell: &Cell| match seen.fires.state(*cell) {
            Some(BushState::Burning { since }) => Some(since),
            _ => None,
        };
        let nearest = seen.fires.frame().by_distance(agent.place);
        options.iter().copied().min_by(|a, b| since(a).cmp(&since(b)).then_with(|| nearest(a, b)))
    }
}

/// Chooses the option that is farthest from the truck nearest to it; the nearest option if there are no trucks.
#[derive(Clone, Copy, Debug)]
pub struct FarthestFromTruck;

impl Rule for FarthestFromTruck {
    fn best(&mut self, seen: &Observation<'_>, agent: &AgentView, options: &[Cell]) -> Option<Cell> {
        let trucks = seen.agents.iter().filter(|other| other.id.role.suppresses());
        let trucks: Vec<DVec2> = trucks.map(|truck| truck.place).collect();
        if trucks.is_empty() {
            return Nearest.best(seen, agent, options);
        }
        let to_truck = |cell: &Cell| {
            let centre = seen.fires.frame().centre(*cell);
            trucks.iter().map(|truck| (*truck - centre).length_squared()).fold(f64::INFINITY, f64::min)
        };
        options.iter().copied().min_by(|a, b| to_truck(b).total_cmp(&to_truck(a)))
    }
}
