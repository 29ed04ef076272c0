//! The descent of a wavefront from the goal.

use glam::DVec2;

use crate::{PlanningObserver, SearchPhase};
use wildfire_grid::astar::StepCosts;
use wildfire_grid::octile::cost_to_go;

use super::lattice::WalkLattice;
use super::query::{Walk, WalkCosts, WalkQuery};

/// Descends the exact cost-to-go, which one sweep from all points of reach computes.
///
/// The sweep covers all that is connected with the goal, wherever the start is: every point that it settles is an
/// expansion. Among steps of equal worth the first in the order of [`super::WalkLattice::steps`] is taken.
pub fn walk(costs: &WalkCosts, query: &WalkQuery<'_>, observer: &mut dyn PlanningObserver) -> Walk {
    let WalkQuery { lattice, start, goals, .. } = *query;
    let to_go = cost_to_go(lattice.moves(), goals.iter().copied(), costs);
    let to_go = to_go.values();
    observer.on_edges_examined(SearchPhase::Walk, &mut std::iter::once_with(|| wave(costs, lattice, to_go)).flatten());
    let expansions = to_go.iter().filter(|cost| cost.is_finite()).count() as u32;
    if to_go[start].is_infinite() {
        return Walk::straight(None, expansions);
    }
    let mut path = vec![start];
    let mut here = start;
    while to_go[here] > 0.0 {
        here = downhill(costs, lattice, to_go, here);
        path.push(here);
    }
    Walk::straight(Some(path), expansions)
}

/// The point that follows one at a finite cost which is no goal.
fn downhill(costs: &WalkCosts, lattice: &WalkLattice, to_go: &[f64], here: usize) -> usize {
    let by_way_of = |&(k, next): &(usize, usize)| costs.cost(k, here, next) + to_go[next];
    let next = lattice.steps(here).min_by(|a, b| by_way_of(a).total_cmp(&by_way_of(b)));
    next.expect("a finite cost was reached over some step").1
}

/// The points that the sweep settled, cheapest first, each after the one by way of which it did.
fn wave(costs: &WalkCosts, lattice: &WalkLattice, to_go: &[f64]) -> Vec<[DVec2; 2]> {
    let mut settled: Vec<usize> = (0..to_go.len()).filter(|&point| to_go[point].is_finite()).collect();
    settled.sort_by(|&a, &b| to_go[a].total_cmp(&to_go[b]));
    let steps = settled.into_iter().map(|point| {
        let before = if to_go[point] > 0.0 { downhill(costs, lattice, to_go, point) } else { point };
        [before, point].map(|point| lattice.position(point))
    });
    steps.collect()
}
