//! A*, Dijkstra's search and greedy best-first search: one loop that differs in what orders its open list.
//!
//! P. Hart, N. Nilsson, B. Raphael, "A Formal Basis for the Heuristic Determination of Minimum Cost Paths" (IEEE
//! Transactions on Systems Science and Cybernetics 4(2), 1968); E. W. Dijkstra, "A note on two problems in connexion with
//! graphs" (Numerische Mathematik 1, 1959); J. Pearl, "Heuristics" (Addison-Wesley, 1984), section 2.3.1, for the greedy one.

use std::f64::consts::SQRT_2;

use super::{PathSearch, index_of, place_of};
use crate::astar::AStar;
use crate::octile::{START_LENGTH, StepLength, UNSEEN, legal_moves, length_from_start, longer};
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, place};

/// What the open list is ordered by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchOrder {
    /// The cost so far plus the least cost that the rest can have: the octile distance, with four neighbours the city-block one.
    AStar,
    /// The cost so far.
    Dijkstra,
    /// The least cost that the rest can have, alone. A cell keeps the way that it was first reached by.
    Greedy,
}

/// Searches from start to goal.
///
/// A goal outside or in an obstacle is an error, and so is a start outside.
///
/// # Panics
/// If the map has more cells than 32 bits can number.
pub fn search_best_first(
    occupied: &Grid<bool>,
    (start, goal): (Place, Place),
    order: SearchOrder,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<PathSearch, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PathSearch::from_occupied_start(occupied));
    }
    let moves = legal_moves(occupied, connectivity, corners);
    let (first, last) = (index_of(occupied, start), index_of(occupied, goal));
    // Without costs of its own the search is ordered by the estimate, and no later way to a cell is a better one.
    let step_costs = if order == SearchOrder::Greedy { (0.0, 0.0) } else { (1.0, SQRT_2) };
    let estimate = |index: usize, _: usize| match order {
        SearchOrder::Dijkstra => 0.0,
        SearchOrder::AStar | SearchOrder::Greedy => least_length(place_of(occupied, index), goal, connectivity),
    };
    let mut search = AStar::new(moves.values().len());
    let found = search.search(&moves, first, step_costs, |index| index == last, estimate);

    let mut lengths = Grid::filled(occupied.rows(), occupied.cols(), UNSEEN);
    lengths[start] = START_LENGTH;
    let mut touched = 0;
    // Settled points in order first: whatever else was reached was reached from one of these.
    for [from, to] in search.settled().filter(|[from, to]| from != to) {
        follow(&mut lengths, place_of(occupied, from), place_of(occupied, to));
    }
    for [from, to] in search.reached() {
        touched += 1;
        if from != to {
            follow(&mut lengths, place_of(occupied, from), place_of(occupied, to));
        }
    }
    let is_expanded = |[_, index]: &[usize; 2]| *index != last;
    let expanded = search.settled().filter(is_expanded).map(|[_, index]| index as u32).collect();
    let costs = lengths.values().iter().map(|&length| length_from_start(length)).collect();
    let costs = Grid::from_values(occupied.rows(), occupied.cols(), costs);
    let cost = found.path.as_ref().map(|_| costs[goal]);
    let in_cells = |path: Vec<usize>| Route::Found(path.into_iter().map(|index| place_of(occupied, index)).collect());
    let route = found.path.map_or(Route::Unreachable, in_cells);
    Ok(PathSearch { costs, route, cost, expanded, touched, swept: None })
}

fn follow(lengths: &mut Grid<StepLength>, from: Place, to: Place) {
    let offset = (to.0 as isize - from.0 as isize, to.1 as isize - from.1 as isize);
    lengths[to] = longer(lengths[from], offset);
}

/// The length of a shortest way between two cells if nothing were between them.
fn least_length(from: Place, to: Place, connectivity: Connectivity) -> f64 {
    let (rows, cols) = (from.0.abs_diff(to.0), from.1.abs_diff(to.1));
    match connectivity {
        Connectivity::Four => (rows + cols) as f64,
        Connectivity::Eight => rows.abs_diff(cols) as f64 + rows.min(cols) as f64 * SQRT_2,
    }
}
