//! The walks of a Wumpus: a lattice of points for its square body, and planners on it.
//!
//! World frame, metres. The body keeps its sides parallel to the axes. A step is legal if the box about the body at
//! both its ends is free, which for diagonal steps means that no corner is cut. Every step can be walked back.
//!
//! Three planners share the lattice: A*, the exact cost-to-go of a wavefront, and gradient descent on a potential
//! field, which may end in a local minimum.

mod astar;

mod lattice;
mod potential;
mod query;
#[cfg(test)]
mod test_lattices;
mod wavefront;

pub use astar::CostToGoEstimate;
pub use lattice::{LatticeShape, WalkLattice};
pub use potential::PotentialSettings;
pub use query::{Walk, WalkCosts};

use crate::PlanningObserver;
use potential::PotentialField;
use query::WalkQuery;
use wildfire_base::geometry::Cell;
use wildfire_grid::astar::AStar;

/// The method by which a walk is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WalkMethod {
    Astar { estimate: CostToGoEstimate, weight: f64 },
    Wavefront,
    Potential(PotentialSettings),
}

/// A planner for one lattice, with what it keeps from query to query.
pub struct WalkPlanner {
    costs: WalkCosts,
    method: Prepared,
}

enum Prepared {
    Astar { memory: AStar, estimate: CostToGoEstimate, weight: f64 },
    Wavefront,
    Potential(PotentialField),
}

impl WalkPlanner {
    pub fn new(lattice: &WalkLattice, method: WalkMethod, costs: WalkCosts) -> Self {
        let method = match method {
            WalkMethod::Astar { estimate, weight } => {
                Prepared::Astar { memory: AStar::new(lattice.points()), estimate, weight }
            }
            WalkMethod::Wavefront => Prepared::Wavefront,
            WalkMethod::Potential(settings) => Prepared::Potential(PotentialField::new(lattice, settings)),
        };
        Self { costs, method }
    }

    /// Finds a walk from a point to one within `reach_m` of a cell's centre, on the lattice that the planner was made for.
    pub fn plan(
        &mut self,
        lattice: &WalkLattice,
        start: usize,
        cell: Cell,
        reach_m: f64,
        observer: &mut dyn PlanningObserver,
    ) -> Walk {
        let goals: Vec<usize> = lattice.points_of_reach(cell, reach_m).collect();
        let query = WalkQuery { lattice, start, goals: &goals, centre: lattice.centre(cell) };
        let Self { costs, method } = self;
        match method {
            Prepared::Astar { memory, estimate, weight } => {
                astar::walk(memory, *estimate, *weight, costs, &query, observer)
            }
            Prepared::Wavefront => wavefront::walk(costs, &query, observer),
            Prepared::Potential(field) => field.walk(costs, &query, observer),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use glam::DVec2;

    use super::test_lattices::{FRAME, field, on_cells};
    use super::*;
    use crate::NullObserver;
    use wildfire_grid::astar::StepCosts;
    use wildfire_grid::potential::{Attraction, Repulsion};
    use wildfire_grid::{Connectivity, CornerCutting, Grid, octile};

    const ASTAR: WalkMethod = WalkMethod::Astar { estimate: CostToGoEstimate::Octile, weight: 1.0 };
    const POTENTIAL: PotentialSettings = PotentialSettings {
        attraction: Attraction::Squared { zeta: 1.0 },
        scale: Some(10.0),
        repulsion: Repulsion { q: 5.0, eta: 15.0, distance: wildfire_grid::potential::RepulsionDistance::Brushfire },
        escapes: true,
    };

    fn metres() -> WalkCosts {
        WalkCosts { steps: (5.0, 5.0 * SQRT_2), factors: None }
    }

    fn price(lattice: &WalkLattice, costs: &WalkCosts, path: &[usize]) -> f64 {
        let step = |pair: &[usize]| {
            let (k, next) = lattice.steps(pair[0]).find(|&(_, next)| next == pair[1]).expect("steps are legal");
            costs.cost(k, pair[0], next)
        };
        path.windows(2).map(step).sum()
    }

    /// Walks from the field's upper middle to every ninth bush of 30 random fields.
    fn each_query(share: f64, mut with: impl FnMut(u64, &WalkLattice, usize, Cell)) {
        for seed in 0..30 {
            let occupied = field(seed, share);
            let lattice = on_cells(&occupied);
            let Some(start) = lattice.nearest_free(DVec2::new(100.0, 90.0)) else { continue };
            for index in (0..FRAME.cell_count()).filter(|&i| occupied.values()[i]).step_by(9) {
                with(seed, &lattice, start, FRAME.cell(index));
            }
        }
    }

    #[test]
    fn wavefront_and_astar_of_weight_one_cost_what_a_blind_search_costs() {
        let random_factors = |lattice: &WalkLattice| {
            Some((0..lattice.points()).map(|point| 1.0 + (point * 7919 % 101) as f64 / 25.0).collect())
        };
        let mut walks = 0;
        each_query(0.2, |_, lattice, start, cell| {
            let reached = lattice.reachable_from(start);
            for steps in [(5.0, 5.0 * SQRT_2), (1.0, 1.0)] {
                for factors in [None, random_factors(lattice)] {
                    let costs = WalkCosts { steps, factors };
                    let blind = WalkMethod::Astar { estimate: CostToGoEstimate::Octile, weight: 0.0 };
                    let paths = [ASTAR, blind, WalkMethod::Wavefront].map(|method| {
                        let mut planner = WalkPlanner::new(lattice, method, costs.clone());
                        planner.plan(lattice, start, cell, 6.25, &mut NullObserver).path
                    });
                    let approachable = lattice.points_of_reach(cell, 6.25).any(|point| reached[point]);
                    assert!(paths.iter().all(|path| path.is_some() == approachable));
                    let prices: Vec<f64> = paths.iter().flatten().map(|path| price(lattice, &costs, path)).collect();
                    assert!(prices.iter().all(|price| (price - prices[0]).abs() < 1e-9), "{prices:?}");
                    for path in paths.iter().flatten() {
                        let end = lattice.position(path[path.len() - 1]);
                        assert!(path[0] == start && (end - FRAME.centre(cell)).length() <= 6.25);
                        walks += 1;
                    }
                }
            }
        });
        assert!(walks > 1000, "{walks} walks");
    }

    #[test]
    fn a_greedier_search_expands_less_and_a_wavefront_settles_all_that_is_connected() {
        let (mut greedy_effort, mut exact_effort) = (0, 0);
        each_query(0.2, |_, lattice, start, cell| {
            let effort = |method| {
                WalkPlanner::new(lattice, method, metres()).plan(lattice, start, cell, 6.25, &mut NullObserver)
            };
            let greedy = effort(WalkMethod::Astar { estimate: CostToGoEstimate::Octile, weight: 4.0 });
            let exact = effort(ASTAR);
            let wave = effort(WalkMethod::Wavefront);
            greedy_effort += greedy.expansions;
            exact_effort += exact.expansions;
            let mut connected = vec![false; lattice.points()];
            for goal in lattice.points_of_reach(cell, 6.25) {
                let more = lattice.reachable_from(goal);
                connected.iter_mut().zip(more).for_each(|(is_connected, more)| *is_connected |= more);
            }
            assert_eq!(wave.expansions as usize, connected.iter().filter(|&&is_connected| is_connected).count());
        });
        assert!(greedy_effort < exact_effort, "{greedy_effort} expansions against {exact_effort}");
    }

    #[test]
    fn a_walled_in_cell_cannot_be_approached() {
        let mut occupied = Grid::filled(FRAME.rows.into(), FRAME.cols.into(), false);
        for row in 8..=10 {
            for col in 8..=10 {
                occupied[(row, col)] = true;
            }
        }
        let lattice = on_cells(&occupied);
        let middle = Cell { col: 9, row: 9 };
        assert_eq!(lattice.points_of_reach(middle, 6.25).count(), 0);
        for method in [ASTAR, WalkMethod::Wavefront, WalkMethod::Potential(POTENTIAL)] {
            let walk = WalkPlanner::new(&lattice, method, metres()).plan(&lattice, 0, middle, 6.25, &mut NullObserver);
            assert_eq!(walk.path, None, "{method:?}");
        }
    }

    #[test]
    fn the_steps_of_the_cell_lattice_are_those_of_a_grid_without_corner_cutting() {
        let occupied = field(3, 0.3);
        let lattice = on_cells(&occupied);
        assert_eq!(lattice.moves(), &octile::legal_moves(&occupied, Connectivity::Eight, CornerCutting::Forbidden));
    }

    #[test]
    fn a_descent_ends_in_reach_or_where_no_step_leads_down_and_an_escape_goes_on_to_the_goal() {
        let no_escape = PotentialSettings { escapes: false, ..POTENTIAL };
        let (mut stuck, mut arrived) = (0, 0);
        each_query(0.1, |seed, lattice, start, cell| {
            let plan = |settings| {
                let mut planner = WalkPlanner::new(lattice, WalkMethod::Potential(settings), metres());
                planner.plan(lattice, start, cell, 6.25, &mut NullObserver)
            };
            let walk = plan(no_escape);
            let escaped = plan(POTENTIAL);
            let path = walk.path.clone().expect("a walk without escape ends somewhere");
            let goals: Vec<usize> = lattice.points_of_reach(cell, 6.25).collect();
            let query = WalkQuery { lattice, start, goals: &goals, centre: FRAME.centre(cell) };
            let field = PotentialField::new(lattice, POTENTIAL);
            let potential = field.towards(&query);
            let falls = |pair: &[usize]| potential.at(pair[1]) < potential.at(pair[0]);
            assert!(path.windows(2).all(falls), "seed {seed}: a descent climbs");
            let last = path[path.len() - 1];
            assert_eq!(walk.is_stuck(), !query.is_goal(last));
            assert_eq!(walk.minimum, escaped.minimum);
            let Some(minimum) = walk.minimum else {
                assert_eq!(walk, escaped);
                arrived += 1;
                return;
            };
            stuck += 1;
            assert_eq!(minimum, last);
            let lowest = lattice.steps(last).map(|(_, next)| potential.at(next)).fold(f64::INFINITY, f64::min);
            assert!(lowest >= potential.at(last));
            assert!(!escaped.is_stuck());
            if let Some(onward) = escaped.path {
                assert_eq!(onward[..path.len()], path);
                assert!(query.is_goal(onward[onward.len() - 1]));
            }
        });
        assert!(stuck > 10 && arrived > 10, "{stuck} stuck, {arrived} arrived");
    }
}
