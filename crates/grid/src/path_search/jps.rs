//! Jump point search: A* over 8 neighbours that expands only cells at which some shortest path must turn.
//!
//! D. Harabor, A. Grastien, "Online Graph Pruning for Pathfinding on Grid Maps", AAAI 2011. Where corners may not be cut,
//! neighbours are forced beside the end of an obstacle, one cell behind it, and by straight moves alone (D. Harabor,
//! A. Grastien, "Improving Jump Point Search", ICAPS 2014, section 2). The map is scanned cell by cell.

use super::{PathSearch, index_of, place_of};
use crate::octile::{START_LENGTH, StepLength, UNSEEN, by_way_of, length_from_start, metric};
use crate::open_list::{OpenList, Ranked};
use crate::place::{self, Direction};
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder};

struct OpenJump {
    priority: f64,
    length: StepLength,
    index: u32,
}

impl Ranked for OpenJump {
    type Tie = u32;

    fn priority(&self) -> f64 {
        self.priority
    }

    fn cost(&self) -> f64 {
        metric(self.length)
    }

    fn tie(&self) -> u32 {
        self.index
    }
}

/// Searches from start to goal; the route contains every cell of the path.
///
/// Costs are known at jump points only; cells touched are those that jumps went through. Errors are those of
/// [`super::search_best_first`].
///
/// # Panics
/// If the map has more cells than 32 bits can number.
pub fn jump_point_search(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    corners: CornerCutting,
) -> Result<PathSearch, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PathSearch::from_occupied_start(occupied));
    }
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let mut jumps = Jumps { occupied, goal, corners, touched: Grid::filled(rows, cols, false) };
    jumps.touched[start] = true;
    let mut lengths = Grid::filled(rows, cols, UNSEEN);
    let mut parents = Grid::filled(rows, cols, index_of(occupied, start) as u32);
    let mut closed = Grid::filled(rows, cols, false);
    lengths[start] = START_LENGTH;
    let mut open = OpenList::default();
    let mut expanded = Vec::new();
    open.push(OpenJump {
        priority: metric(by_way_of(start, START_LENGTH, goal)),
        length: START_LENGTH,
        index: index_of(occupied, start) as u32,
    });
    while let Some(OpenJump { index, .. }) = open.pop() {
        let here = place_of(occupied, index as usize);
        // An older entry of a cell that was expanded since.
        if closed[here] {
            continue;
        }
        closed[here] = true;
        if here == goal {
            break;
        }
        expanded.push(index);
        let parent = place_of(occupied, parents[here] as usize);
        let arrival = (here != start).then(|| direction(parent, here));
        for towards in followed(occupied, here, arrival, corners) {
            let Some(to) = jumps.jump(here, towards).filter(|&to| !closed[to]) else { continue };
            // A jump keeps one direction, so the octile length between its ends is that of the cells it crosses.
            let length = by_way_of(here, lengths[here], to);
            // Strictly shorter, so that of equal paths the first found stays.
            if lengths[to] == UNSEEN || metric(length) < metric(lengths[to]) {
                lengths[to] = length;
                parents[to] = index;
                let priority = metric(by_way_of(to, length, goal));
                open.push(OpenJump { priority, length, index: index_of(occupied, to) as u32 });
            }
        }
    }
    let costs =
        Grid::from_values(rows, cols, lengths.values().iter().map(|&length| length_from_start(length)).collect());
    let route = if closed[goal] { Route::Found(cells(occupied, &parents, start, goal)) } else { Route::Unreachable };
    Ok(PathSearch {
        cost: closed[goal].then(|| costs[goal]),
        costs,
        route,
        expanded,
        touched: jumps.touched.values().iter().filter(|&&is_touched| is_touched).count(),
        swept: Some(jumps.touched),
    })
}

/// The way between two cells that lie on one line or diagonal.
fn direction(from: Place, to: Place) -> Direction {
    let sign = |from: usize, to: usize| (to as isize - from as isize).signum();
    (sign(from.0, to.0), sign(from.1, to.1))
}

/// Every cell of the way, by the jump points on it.
fn cells(occupied: &Grid<bool>, parents: &Grid<u32>, start: Place, goal: Place) -> Vec<Place> {
    let mut cells = vec![goal];
    let mut here = goal;
    while here != start {
        let parent = place_of(occupied, parents[here] as usize);
        let back = direction(here, parent);
        while here != parent {
            here = (here.0.wrapping_add_signed(back.0), here.1.wrapping_add_signed(back.1));
            cells.push(here);
        }
    }
    cells.reverse();
    cells
}

/// Jumps on one map, and the cells that they went through.
struct Jumps<'a> {
    occupied: &'a Grid<bool>,
    goal: Place,
    corners: CornerCutting,
    touched: Grid<bool>,
}

impl Jumps<'_> {
    /// Goes on in a direction to the next jump point: the goal, a cell with a forced neighbour, or a cell on a diagonal
    /// from which one lies straight ahead in a part of the direction.
    fn jump(&mut self, from: Place, towards: Direction) -> Option<Place> {
        let (row, col) = towards;
        let is_diagonal = row != 0 && col != 0;
        let mut here = from;
        loop {
            here = place::step(self.occupied, here, towards, self.corners)?;
            self.touched[here] = true;
            if here == self.goal || forced(self.occupied, here, towards, self.corners).next().is_some() {
                return Some(here);
            }
            // Straight jumps call no further ones.
            if is_diagonal && (self.jump(here, (row, 0)).is_some() || self.jump(here, (0, col)).is_some()) {
                return Some(here);
            }
        }
    }
}

/// The directions in which a jump point is left: those that cost no more by way of it than without it.
fn followed(occupied: &Grid<bool>, here: Place, arrival: Option<Direction>, corners: CornerCutting) -> Vec<Direction> {
    let is_legal = |&towards: &Direction| place::step(occupied, here, towards, corners).is_some();
    let Some((row, col)) = arrival else {
        return TieOrder::CrossFirst.steps(Connectivity::Eight).iter().copied().filter(is_legal).collect();
    };
    let natural: &[Direction] = if row != 0 && col != 0 { &[(row, 0), (0, col), (row, col)] } else { &[(row, col)] };
    natural.iter().copied().filter(is_legal).chain(forced(occupied, here, (row, col), corners)).collect()
}

/// Neighbours that a cell must be left for because an obstacle blocks the ways to them around it.
fn forced(
    occupied: &Grid<bool>,
    here: Place,
    (row, col): Direction,
    corners: CornerCutting,
) -> impl Iterator<Item = Direction> {
    let blocked = |offset: Direction| place::neighbour(occupied, here, offset).is_none_or(|place| occupied[place]);
    let if_blocked = |offset: Direction, towards: Direction| blocked(offset).then_some(towards);
    // The sides of a straight move.
    let (left, right) = ((-col, row), (col, -row));
    let ahead = |side: Direction| (side.0 + row, side.1 + col);
    let behind = |side: Direction| (side.0 - row, side.1 - col);
    let candidates = match (row != 0 && col != 0, corners) {
        // An obstacle beside the cell before hides the cell behind it, which is nearest by way of here.
        (true, CornerCutting::Allowed) => {
            [if_blocked((-row, 0), (-row, col)), if_blocked((0, -col), (row, -col)), None, None]
        }
        // A diagonal step needs both cells beside it free, so nothing is hidden behind them.
        (true, CornerCutting::Forbidden) => [None; 4],
        (false, CornerCutting::Allowed) => [if_blocked(left, ahead(left)), if_blocked(right, ahead(right)), None, None],
        // Corners may not be cut, so that the way turns one cell later, when it has passed the obstacle's end.
        (false, CornerCutting::Forbidden) => [
            if_blocked(behind(left), left),
            if_blocked(behind(left), ahead(left)),
            if_blocked(behind(right), right),
            if_blocked(behind(right), ahead(right)),
        ],
    };
    candidates.into_iter().flatten().filter(move |towards| place::step(occupied, here, *towards, corners).is_some())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;
    use crate::octile::{cost_to_go, legal_moves};

    /// The definition: a neighbour stays unless it can be reached from the parent without the cell as cheaply, or more
    /// cheaply after a diagonal move, within the 3 x 3 cells around.
    fn followed_by_definition(occupied: &Grid<bool>, arrival: Direction, corners: CornerCutting) -> Vec<Direction> {
        let here: Place = (1, 1);
        let parent = (here.0.wrapping_add_signed(-arrival.0), here.1.wrapping_add_signed(-arrival.1));
        let is_diagonal = arrival.0 != 0 && arrival.1 != 0;
        let mut moves = legal_moves(occupied, Connectivity::Eight, corners);
        // No way leads through the cell itself, whose freedom still counts for corners.
        moves[here] = 0;
        let around = cost_to_go(&moves, [parent.0 * 3 + parent.1], (1.0, SQRT_2));
        let step = |(row, col): Direction| if row != 0 && col != 0 { SQRT_2 } else { 1.0 };
        let stays = |&&offset: &&Direction| {
            let Some(to) = place::step(occupied, here, offset, corners) else { return false };
            let through = step(arrival) + step(offset);
            let is_pruned = if is_diagonal { around[to] < through - 1e-9 } else { around[to] <= through + 1e-9 };
            !is_pruned
        };
        let mut kept: Vec<_> = TieOrder::CrossFirst.steps(Connectivity::Eight).iter().filter(stays).copied().collect();
        kept.sort_unstable();
        kept
    }

    #[test]
    fn neighbours_are_pruned_as_their_definition_says() {
        let mut forced_ones = 0;
        for corners in [CornerCutting::Allowed, CornerCutting::Forbidden] {
            for mask in 0..1_u32 << 9 {
                let occupied = Grid::from_values(3, 3, (0..9).map(|cell| mask & (1 << cell) != 0).collect());
                for &arrival in TieOrder::CrossFirst.steps(Connectivity::Eight) {
                    let back = (-arrival.0, -arrival.1);
                    if occupied[(1, 1)] || place::step(&occupied, (1, 1), back, corners).is_none() {
                        continue;
                    }
                    let mut kept = followed(&occupied, (1, 1), Some(arrival), corners);
                    kept.sort_unstable();
                    assert_eq!(kept, followed_by_definition(&occupied, arrival, corners), "{occupied:?} {arrival:?}");
                    forced_ones += forced(&occupied, (1, 1), arrival, corners).count();
                }
            }
        }
        assert!(forced_ones > 500, "{forced_ones}");
    }
}
