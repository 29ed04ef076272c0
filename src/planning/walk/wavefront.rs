use crate::grid::octile::cost_to_go;
use crate::grid::step_costs::StepCosts;

use super::{Errand, Walk, WalkCosts};

/// Down the exact cost-to-go, which one sweep from all points of reach gives.
///
/// The sweep covers all that is connected with the goal, wherever the start is: every point that it settles is an
/// expansion. Among steps of equal worth the first in the order of [`super::WalkLattice::steps`] is taken.
pub fn walk(costs: &WalkCosts, errand: &Errand<'_>) -> Walk {
    let Errand { lattice, start, goals, .. } = *errand;
    let to_go = cost_to_go(lattice.moves(), goals.iter().copied(), costs);
    let to_go = to_go.values();
    let expansions = to_go.iter().filter(|cost| cost.is_finite()).count() as u32;
    if to_go[start].is_infinite() {
        return Walk { path: None, expansions, minimum: None };
    }
    let mut path = vec![start];
    let mut here = start;
    while to_go[here] > 0.0 {
        let by_way_of = |&(k, next): &(usize, usize)| costs.of(k, here, next) + to_go[next];
        let (_, next) = lattice
            .steps(here)
            .min_by(|a, b| by_way_of(a).total_cmp(&by_way_of(b)))
            .expect("a finite cost was reached over some step");
        here = next;
        path.push(here);
    }
    Walk { path: Some(path), expansions, minimum: None }
}
