//! A*, Dijkstra's search and greedy best-first search: one loop with different orders of the open list.
//!
//! P. Hart, N. Nilsson, B. Raphael, "A Formal Basis for the Heuristic Determination of Minimum Cost Paths" (IEEE
//! Transactions on Systems Science and Cybernetics 4(2), 1968); E. W. Dijkstra, "A note on two problems in connexion with
//! graphs" (Numerische Mathematik 1, 1959); J. Pearl, "Heuristics" (Addison-Wesley, 1984), section 2.3.1, for the greedy one.

use std::f64::consts::SQRT_2;

use super::{PathSearch, index_of, place_of};
use crate::astar::AStar;
use crate::octile::{START_LENGTH, StepLength, UNSEEN, legal_moves, length_from_start, longer};
use crate::parameter::BadParameter;
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, place};

/// An estimate of the cost from a cell to the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heuristic {
    Zero,
    /// The straight distance.
    Euclidean,
    /// The length of a shortest path with eight neighbours and no obstacles.
    Octile,
    /// The length of a shortest path with four neighbours and no obstacles.
    Manhattan,
}

/// The order of the open list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SearchOrder {
    /// The cost so far plus the estimate times the weight, which is not negative.
    AStar { heuristic: Heuristic, weight: f64 },
    /// The cost so far.
    Dijkstra,
    /// The estimate alone. A cell keeps the path by which it was first reached.
    Greedy { heuristic: Heuristic },
}

impl Heuristic {
    /// Returns the largest estimate that never exceeds the cost of a path.
    pub fn exact(connectivity: Connectivity) -> Self {
        match connectivity {
            Connectivity::Four => Self::Manhattan,
            Connectivity::Eight => Self::Octile,
        }
    }

    fn estimate(self, from: Place, to: Place) -> f64 {
        let rows = from.0.abs_diff(to.0);
        let cols = from.1.abs_diff(to.1);
        match self {
            Self::Zero => 0.0,
            Self::Euclidean => ((rows * rows + cols * cols) as f64).sqrt(),
            Self::Octile => rows.abs_diff(cols) as f64 + rows.min(cols) as f64 * SQRT_2,
            Self::Manhattan => (rows + cols) as f64,
        }
    }
}

impl SearchOrder {
    /// Accepts weights from 0 to 1000.
    pub fn check(self) -> Result<(), BadParameter> {
        let Self::AStar { weight, .. } = self else { return Ok(()) };
        BadParameter::unless((0.0..=1000.0).contains(&weight), "the weight", "a number from 0 to 1000", weight)
    }

    /// Returns the order of A* with weight 1 and the [exact](Heuristic::exact) estimate.
    pub fn astar(connectivity: Connectivity) -> Self {
        Self::AStar { heuristic: Heuristic::exact(connectivity), weight: 1.0 }
    }

    /// Returns a bound on the ratio of the path's cost to that of a shortest path; `None` if there is no bound.
    ///
    /// All estimates here are a factor times a consistent one, and with a consistent estimate times a weight of at least 1
    /// every cell is expanded at a cost of at most the weight times the least, although no cell is expanded twice (M.
    /// Likhachev, G. Gordon, S. Thrun, "ARA*: Anytime A* with Provable Bounds on Sub-Optimality", NIPS 2003, theorem 1).
    pub fn cost_bound(self, connectivity: Connectivity) -> Option<f64> {
        match self {
            Self::Dijkstra | Self::AStar { heuristic: Heuristic::Zero, .. } => Some(1.0),
            Self::AStar { heuristic, weight } => {
                // The city-block distance is at most the square root of 2 times the octile one, a diagonal step.
                let is_too_large = (heuristic, connectivity) == (Heuristic::Manhattan, Connectivity::Eight);
                Some(f64::max(1.0, if is_too_large { weight * SQRT_2 } else { weight }))
            }
            Self::Greedy { .. } => None,
        }
    }
}

/// Searches from start to goal.
///
/// A goal outside or in an obstacle is an error, and so is a start outside.
///
/// # Panics
/// If the map has more cells than 32 bits can number, or [`SearchOrder::check`] refuses the order.
pub fn search_best_first(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    order: SearchOrder,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<PathSearch, BadPlace> {
    order.check().expect("the order was checked");
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PathSearch::from_occupied_start(occupied));
    }
    let moves = legal_moves(occupied, connectivity, corners);
    let first = index_of(occupied, start);
    let last = index_of(occupied, goal);
    // Without costs of its own the search is ordered by the estimate, and no later way to a cell is a better one.
    let (step_costs, heuristic, weight) = match order {
        SearchOrder::AStar { heuristic, weight } => ((1.0, SQRT_2), heuristic, weight),
        SearchOrder::Dijkstra => ((1.0, SQRT_2), Heuristic::Zero, 1.0),
        SearchOrder::Greedy { heuristic } => ((0.0, 0.0), heuristic, 1.0),
    };
    let mut search = AStar::new(moves.values().len());
    let found = search.search(
        &moves,
        first,
        step_costs,
        |index| index == last,
        |index, _| weight * heuristic.estimate(place_of(occupied, index), goal),
    );

    // Counted in straight and diagonal steps: sums of roots would differ by rounding between paths of one length.
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
    // The goal is settled last, and the search ends without a step from there.
    let expanded = search.settled().filter(|[_, index]| *index != last).map(|[_, index]| index as u32).collect();
    let costs = lengths.values().iter().map(|&length| length_from_start(length)).collect();
    let costs = Grid::from_values(occupied.rows(), occupied.cols(), costs);
    let cost = found.path.as_ref().map(|_| costs[goal]);
    let route = found.path.map_or(Route::Unreachable, |path| {
        Route::Found(path.into_iter().map(|index| place_of(occupied, index)).collect())
    });
    Ok(PathSearch { costs, route, cost, expanded, touched, swept: None })
}

fn follow(lengths: &mut Grid<StepLength>, from: Place, to: Place) {
    let offset = (to.0 as isize - from.0 as isize, to.1 as isize - from.1 as isize);
    lengths[to] = longer(lengths[from], offset);
}
