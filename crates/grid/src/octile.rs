//! Cheapest paths on a grid where a diagonal step is longer than an orthogonal one.

use std::f64::consts::SQRT_2;

use crate::astar::{MOVES, StepCosts};
use crate::bucket_queue::BucketQueue;
use crate::open_list::{OpenList, Ranked};
use crate::wavefront::{descend_wavefront, wavefront};
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, place};

/// Computes a mask of the legal [`MOVES`] for every cell.
pub fn legal_moves(occupied: &Grid<bool>, connectivity: Connectivity, corners: CornerCutting) -> Grid<u8> {
    let mut moves = Grid::filled(occupied.rows(), occupied.cols(), 0u8);
    for row in 0..occupied.rows() {
        for col in (0..occupied.cols()).filter(|&col| !occupied[(row, col)]) {
            for (k, &offset) in MOVES.iter().enumerate().take(connectivity.count()) {
                let is_legal = place::step(occupied, (row, col), offset, corners).is_some();
                moves[(row, col)] |= u8::from(is_legal) << k;
            }
        }
    }
    moves
}

/// Finds a shortest path with orthogonal steps of 1 and diagonal steps of the square root of 2.
///
/// Of several, the one whose steps come first in [`TieOrder::CrossFirst`], the first step counting most. Memory: 8
/// bytes a cell, which the system hands out where the search comes along, and 16 for every cell of its front; with four
/// neighbours what [`wavefront`] takes. A goal outside or in an obstacle is an error, and so is a start outside.
pub fn shortest_path(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<Route, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(Route::StartOccupied);
    }
    match connectivity {
        // Where all steps are equally long, fewest steps are shortest, and the rule for ties is the same.
        Connectivity::Four => {
            let values = wavefront(occupied, goal, connectivity, corners)?;
            Ok(descend_wavefront(&values, start, connectivity, corners, TieOrder::CrossFirst))
        }
        Connectivity::Eight => Ok(search_backwards(occupied, corners, start, goal)),
    }
}

/// Orthogonal steps, counted from 1, and diagonal ones; [`UNSEEN`] before any.
///
/// Whole numbers of steps of either kind: equal lengths are equal numbers, in whatever order they were added up.
pub(super) type StepLength = (u32, u32);

pub(super) const UNSEEN: StepLength = (0, 0);

/// The length of a way that has not begun.
pub(super) const START_LENGTH: StepLength = (1, 0);

/// Length of a way in cells; infinite where there is none.
pub(super) fn length_from_start((straight, diagonal): StepLength) -> f64 {
    straight.checked_sub(1).map_or(f64::INFINITY, |straight| f64::from(straight) + f64::from(diagonal) * SQRT_2)
}

pub(super) fn metric((straight, diagonal): StepLength) -> f64 {
    f64::from(straight) + f64::from(diagonal) * SQRT_2
}

pub(super) fn longer((straight, diagonal): StepLength, offset: (isize, isize)) -> StepLength {
    let is_diagonal = u32::from(offset.0 != 0 && offset.1 != 0);
    (straight + 1 - is_diagonal, diagonal + is_diagonal)
}

/// Length to go from `start` if the way from `place` is `to_go` and nothing is between the two.
pub(super) fn by_way_of(place: Place, (straight, diagonal): StepLength, start: Place) -> StepLength {
    let rows = place.0.abs_diff(start.0) as u32;
    let cols = place.1.abs_diff(start.1) as u32;
    (straight + rows.abs_diff(cols), diagonal + rows.min(cols))
}

/// A* from the goal to the start, so that its lengths tell the way when walking forwards.
///
/// Hart, Nilsson, Raphael, "A formal basis for the heuristic determination of minimum cost paths" (1968), with the
/// octile distance as the estimate. Along a step, length plus estimate stay the same or grow by at least 2 - sqrt 2 and
/// at most 2 sqrt 2, which lets [`BucketQueue`] do the work of a heap.
fn search_backwards(occupied: &Grid<bool>, corners: CornerCutting, start: Place, goal: Place) -> Route {
    let steps = TieOrder::CrossFirst.steps(Connectivity::Eight);
    // Backwards, so that lengths are those to the goal and the path can be read off forwards.
    let mut to_go = Grid::filled(occupied.rows(), occupied.cols(), UNSEEN);
    to_go[goal] = START_LENGTH;
    let mut open = BucketQueue::new(metric(by_way_of(goal, to_go[goal], start)), (goal.0 as u32, goal.1 as u32));
    let mut bound = f64::INFINITY;
    while let Some((priority, entry)) = open.pop() {
        // Not at the start already: every cell of every shortest path is wanted, so that ties can be decided.
        if priority > bound {
            break;
        }
        let from = (entry.0 as usize, entry.1 as usize);
        if from == start {
            bound = priority;
        }
        // A shorter way to this cell was found since the entry was made, and has been expanded.
        if priority > metric(by_way_of(from, to_go[from], start)) {
            continue;
        }
        let here = to_go[from];
        for &offset in steps {
            let Some(to) = place::neighbour(occupied, from, offset) else { continue };
            let length = longer(here, offset);
            // Asked before whether the step is legal, because it mostly spares that question.
            let is_shorter = to_go[to] == UNSEEN || metric(length) < metric(to_go[to]);
            if is_shorter && place::step(occupied, from, offset, corners).is_some() {
                to_go[to] = length;
                open.push(metric(by_way_of(to, length, start)), (to.0 as u32, to.1 as u32));
            }
        }
    }
    if to_go[start] == UNSEEN {
        return Route::Unreachable;
    }
    let mut path = vec![start];
    let mut here = start;
    while here != goal {
        // Lengths of shortest paths differ by exactly the step between them, so the first in order decides ties.
        here = steps
            .iter()
            .filter_map(|&offset| Some((offset, place::step(occupied, here, offset, corners)?)))
            .find(|&(offset, to)| to_go[to] != UNSEEN && longer(to_go[to], offset) == to_go[here])
            .map(|(_, to)| to)
            .expect("a shortest path goes on");
        path.push(here);
    }
    Route::Found(path)
}

/// Computes the cost of the cheapest path from every cell to any of the goals; infinite where there is none. Every move
/// can be reversed, so the search runs from the goals outwards (Dijkstra, "A note on two problems in connexion with
/// graphs", 1959).
pub fn cost_to_go(moves: &Grid<u8>, goals: impl IntoIterator<Item = usize>, step_costs: impl StepCosts) -> Grid<f64> {
    let mut costs = Grid::filled(moves.rows(), moves.cols(), f64::INFINITY);
    let mut open = OpenList::default();
    for goal in goals {
        costs.values_mut()[goal] = 0.0;
        open.push(ReachedPoint { cost: 0.0, index: goal });
    }
    while let Some(ReachedPoint { cost, index }) = open.pop() {
        // A cheaper way to this point was expanded since the entry was made.
        if cost > costs.values()[index] {
            continue;
        }
        for (k, &(row_step, col_step)) in MOVES.iter().enumerate() {
            if moves.values()[index] & (1 << k) == 0 {
                continue;
            }
            let next = index.wrapping_add_signed(row_step * moves.cols() as isize + col_step);
            // The walk goes the other way: from the neighbour to this point.
            let step = step_costs.cost(k, next, index);
            if cost + step < costs.values()[next] {
                costs.values_mut()[next] = cost + step;
                open.push(ReachedPoint { cost: cost + step, index: next });
            }
        }
    }
    costs
}

struct ReachedPoint {
    cost: f64,
    index: usize,
}

impl Ranked for ReachedPoint {
    type Tie = usize;

    fn priority(&self) -> f64 {
        self.cost
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> usize {
        self.index
    }
}
