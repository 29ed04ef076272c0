//! The searches of a course on planning, each with the trace that a report shows: costs, order of expansion, touched
//! cells.
//!
//! Orthogonal steps cost 1 and diagonal ones the square root of 2. Costs along steps are counted in whole numbers of steps
//! of either kind and multiplied once, so that ways of equal length have equal costs in whatever order they were added up.
//! Ties are decided by the larger cost so far, then by the smaller index.

mod best_first;
mod jps;
mod theta;

pub use best_first::{Heuristic, SearchOrder, search_best_first};
pub use jps::jump_point_search;
pub use theta::theta_star;

use crate::{Grid, Place, Route};

/// The maximum number of cells of a map to search: a search takes up to about 50 bytes per cell.
pub const MAX_CELLS: usize = 1 << 25;

/// The result of a search, and its trace.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSearch {
    /// The cost of the cheapest known path from the start; infinite where none is known.
    pub costs: Grid<f64>,
    /// The cells from start to goal: all cells of the path, or those where an any-angle path turns.
    pub route: Route,
    /// The cost of the route; `None` without one.
    pub cost: Option<f64>,
    /// The expanded cells, in order, as `row * cols + col`. The goal ends the search and is not expanded.
    pub expanded: Vec<u32>,
    /// The number of cells that the search considered as successors.
    pub touched: usize,
    /// The cells that jumps passed, for a search that jumps.
    pub swept: Option<Grid<bool>>,
}

impl PathSearch {
    /// The answer to a start in an obstacle: nothing was searched.
    fn from_occupied_start(occupied: &Grid<bool>) -> Self {
        Self {
            costs: Grid::filled(occupied.rows(), occupied.cols(), f64::INFINITY),
            route: Route::StartOccupied,
            cost: None,
            expanded: Vec::new(),
            touched: 0,
            swept: None,
        }
    }
}

fn index_of(grid: &Grid<bool>, (row, col): Place) -> usize {
    row * grid.cols() + col
}

fn place_of(grid: &Grid<bool>, index: usize) -> Place {
    (index / grid.cols(), index % grid.cols())
}
