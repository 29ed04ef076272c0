//! A* over the lattice of a Wumpus.

use glam::DVec2;

use crate::{PlanningObserver, SearchPhase};
use wildfire_grid::astar::AStar;

use super::lattice::WalkLattice;
use super::query::{Walk, WalkCosts, WalkQuery};

/// The estimate of the cost-to-go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostToGoEstimate {
    /// The cost of the shortest lattice path on an empty field to the nearest point of reach: admissible and
    /// consistent.
    Octile,
    /// The straight distance in metres from the point's parent to the cell's centre, whatever a step costs.
    ParentEuclidean,
}

/// A* to any of the points of reach.
///
/// With weight 1 and [`CostToGoEstimate::Octile`] the walk is a cheapest one: factors of at least 1 keep the estimate below
/// the true cost.
pub fn walk(
    memory: &mut AStar,
    estimate: CostToGoEstimate,
    weight: f64,
    costs: &WalkCosts,
    query: &WalkQuery<'_>,
    observer: &mut dyn PlanningObserver,
) -> Walk {
    let WalkQuery { lattice, start, goals, centre } = *query;
    let octile = |from: DVec2, to: DVec2| octile(lattice, costs.steps, from, to);
    // The triangle inequality holds for octile distance: what the farthest point of reach is short of the centre,
    // taken off the distance to the centre, bounds the distance to each point of reach from below.
    let short = goals.iter().map(|&goal| octile(lattice.position(goal), centre)).fold(0.0, f64::max);
    let estimate = |point: usize, parent: usize| match estimate {
        CostToGoEstimate::Octile => weight * (octile(lattice.position(point), centre) - short).max(0.0),
        CostToGoEstimate::ParentEuclidean => weight * (lattice.position(parent) - centre).length(),
    };
    let found = memory.search(lattice.moves(), start, costs, |point| query.is_goal(point), estimate);
    observer.on_edges_examined(
        SearchPhase::Walk,
        &mut memory.settled().map(|ends| ends.map(|point| lattice.position(point))),
    );
    Walk::straight(found.path, found.expansions)
}

fn octile(lattice: &WalkLattice, (orthogonal, diagonal): (f64, f64), a: DVec2, b: DVec2) -> f64 {
    let steps = (a - b).abs() / lattice.step_m();
    let diagonals = steps.min_element();
    diagonals * diagonal.min(2.0 * orthogonal) + (steps.max_element() - diagonals) * orthogonal.min(diagonal)
}
