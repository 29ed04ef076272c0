//! Theta*: A* whose paths turn at any angle.
//!
//! K. Daniel, A. Nash, S. Koenig, A. Felner, "Theta*: Any-Angle Path Planning on Grids", Journal of Artificial Intelligence
//! Research 39, 2010, section 4 (basic Theta*), between the centres of cells. A neighbour that the parent of the expanded
//! cell can see becomes a child of that parent.

use super::{PathSearch, index_of, place_of};
use crate::open_list::{OpenList, Ranked};
use crate::segment::{GridPoint, is_free_segment};
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, place};

#[derive(Clone, Copy)]
struct ThetaNode {
    /// Infinite before the cell is reached.
    cost: f64,
    parent: u32,
    closed: bool,
}

struct OpenCell {
    priority: f64,
    cost: f64,
    index: u32,
}

impl Ranked for OpenCell {
    type Tie = u32;

    fn priority(&self) -> f64 {
        self.priority
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> u32 {
        self.index
    }
}

/// Searches from start to goal over 8 neighbours; the route contains the ends and the cells where the path turns.
///
/// No path costs more than a cheapest one in steps: whatever a cell is reached by, the way over its neighbour is one of the
/// candidates, and the straight distance to the goal is a consistent estimate for steps too. The same rule for corners
/// holds for steps and for segments, see [`is_free_segment`]. Errors are those of [`super::search_best_first`].
///
/// # Panics
/// If the map has more cells than 32 bits can number.
pub fn theta_star(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    corners: CornerCutting,
) -> Result<PathSearch, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PathSearch::from_occupied_start(occupied));
    }
    let first = index_of(occupied, start) as u32;
    let last = index_of(occupied, goal) as u32;
    // The start is the parent of itself, so that its neighbours need no special case below.
    let unseen = ThetaNode { cost: f64::INFINITY, parent: first, closed: false };
    let mut nodes = Grid::filled(occupied.rows(), occupied.cols(), unseen);
    let mut open = OpenList::default();
    let mut expanded = Vec::new();
    let mut touched = 1;
    let mut is_found = false;
    nodes[start].cost = 0.0;
    open.push(OpenCell { priority: distance(start, goal), cost: 0.0, index: first });
    while let Some(OpenCell { index, .. }) = open.pop() {
        let here = place_of(occupied, index as usize);
        // An older entry of a cell that was expanded since.
        if nodes[here].closed {
            continue;
        }
        nodes[here].closed = true;
        if index == last {
            is_found = true;
            break;
        }
        expanded.push(index);
        let parent = place_of(occupied, nodes[here].parent as usize);
        for &offset in TieOrder::CrossFirst.steps(Connectivity::Eight) {
            let Some(to) = place::step(occupied, here, offset, corners).filter(|&to| !nodes[to].closed) else {
                continue;
            };
            // By the triangle inequality the way from the parent is no longer, so it is taken wherever it is free.
            let is_seen = is_free_segment(occupied, GridPoint::centre(parent), GridPoint::centre(to), corners);
            let by = if is_seen { parent } else { here };
            let cost = nodes[by].cost + distance(by, to);
            if cost < nodes[to].cost {
                touched += usize::from(nodes[to].cost.is_infinite());
                nodes[to] = ThetaNode { cost, parent: index_of(occupied, by) as u32, closed: false };
                let index = index_of(occupied, to) as u32;
                open.push(OpenCell { priority: cost + distance(to, goal), cost, index });
            }
        }
    }
    let costs = nodes.values().iter().map(|node| node.cost).collect();
    let costs = Grid::from_values(occupied.rows(), occupied.cols(), costs);
    let cost = is_found.then(|| costs[goal]);
    let route = if is_found { Route::Found(turns(&nodes, occupied, start, goal)) } else { Route::Unreachable };
    Ok(PathSearch { costs, route, cost, expanded, touched, swept: None })
}

/// Returns the distance of the centres of two cells.
fn distance(from: Place, to: Place) -> f64 {
    GridPoint::centre(from).distance(GridPoint::centre(to))
}

fn turns(nodes: &Grid<ThetaNode>, occupied: &Grid<bool>, start: Place, goal: Place) -> Vec<Place> {
    let mut cells = vec![goal];
    let mut here = goal;
    while here != start {
        here = place_of(occupied, nodes[here].parent as usize);
        cells.push(here);
    }
    cells.reverse();
    cells
}
