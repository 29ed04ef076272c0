//! Cheapest paths where a diagonal step is longer than an orthogonal one.

use std::f64::consts::SQRT_2;

use super::astar::MOVES;
use super::bucket_queue::BucketQueue;
use super::open_list::{OpenList, Ranked};
use super::step_costs::StepCosts;
use super::wavefront::{descend_wavefront, wavefront};
use super::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, place};

/// For every cell a mask of the legal [`MOVES`].
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

/// A shortest path, orthogonal steps 1 and diagonal ones the square root of 2.
///
/// Of several, the one whose steps come first in [`TieOrder::CrossFirst`], the first step counting most. Memory: 8 bytes
/// a cell, which the system hands out where the search comes along, and 16 for every cell of its front; with four
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
        Connectivity::Eight => Ok(Backwards::new(occupied, corners, start, goal).search()),
    }
}

/// A* from the goal to the start, so that its lengths tell the way when walking forwards.
///
/// Hart, Nilsson, Raphael, "A formal basis for the heuristic determination of minimum cost paths" (1968), with the octile
/// distance as the estimate. Lengths are whole numbers of steps of either kind, so that equal lengths are equal numbers,
/// in whatever order they were added up. Along a step, length plus estimate stay the same or grow by at least
/// 2 - sqrt 2 and at most 2 sqrt 2, which lets [`BucketQueue`] do the work of a heap.
struct Backwards<'a> {
    occupied: &'a Grid<bool>,
    corners: CornerCutting,
    start: Place,
    goal: Place,
    to_go: Grid<Length>,
    open: BucketQueue<(u32, u32)>,
}

/// Orthogonal steps, counted from 1, and diagonal ones; [`UNSEEN`] before any.
type Length = (u32, u32);

const UNSEEN: Length = (0, 0);

fn metric((straight, diagonal): Length) -> f64 {
    f64::from(straight) + f64::from(diagonal) * SQRT_2
}

fn longer((straight, diagonal): Length, offset: (isize, isize)) -> Length {
    let is_diagonal = u32::from(offset.0 != 0 && offset.1 != 0);
    (straight + 1 - is_diagonal, diagonal + is_diagonal)
}

/// Length to go from `start` if the way from `place` is `to_go` and nothing is between the two.
fn by_way_of(place: Place, (straight, diagonal): Length, start: Place) -> Length {
    let (rows, cols) = (place.0.abs_diff(start.0) as u32, place.1.abs_diff(start.1) as u32);
    (straight + rows.abs_diff(cols), diagonal + rows.min(cols))
}

fn entry(place: Place) -> (u32, u32) {
    (place.0 as u32, place.1 as u32)
}

impl<'a> Backwards<'a> {
    fn new(occupied: &'a Grid<bool>, corners: CornerCutting, start: Place, goal: Place) -> Self {
        let mut to_go = Grid::filled(occupied.rows(), occupied.cols(), UNSEEN);
        to_go[goal] = (1, 0);
        let open = BucketQueue::new(metric(by_way_of(goal, to_go[goal], start)), entry(goal));
        Self { occupied, corners, start, goal, to_go, open }
    }

    fn search(mut self) -> Route {
        let mut bound = f64::INFINITY;
        while let Some((priority, entry)) = self.open.pop() {
            // Every cell of every shortest path is wanted, so that ties can be decided.
            if priority > bound {
                break;
            }
            let place = (entry.0 as usize, entry.1 as usize);
            if place == self.start {
                bound = priority;
            }
            if priority <= self.priority(place) {
                self.expand(place);
            }
        }
        if self.to_go[self.start] == UNSEEN { Route::Unreachable } else { Route::Found(self.walk()) }
    }

    fn expand(&mut self, from: Place) {
        let here = self.to_go[from];
        for &offset in TieOrder::CrossFirst.steps(Connectivity::Eight) {
            let length = longer(here, offset);
            let is_shorter = |to: &Place| self.to_go[*to] == UNSEEN || metric(length) < metric(self.to_go[*to]);
            // Asked before whether the step is legal, because it mostly spares that question.
            if let Some(to) = place::neighbour(self.occupied, from, offset).filter(is_shorter)
                && place::step(self.occupied, from, offset, self.corners).is_some()
            {
                self.reach(to, length);
            }
        }
    }

    fn reach(&mut self, place: Place, length: Length) {
        self.to_go[place] = length;
        self.open.push(self.priority(place), entry(place));
    }

    fn priority(&self, place: Place) -> f64 {
        metric(by_way_of(place, self.to_go[place], self.start))
    }

    fn walk(&self) -> Vec<Place> {
        let mut path = vec![self.start];
        let mut here = self.start;
        while here != self.goal {
            here = TieOrder::CrossFirst
                .steps(Connectivity::Eight)
                .iter()
                .filter_map(|&offset| Some((offset, place::step(self.occupied, here, offset, self.corners)?)))
                .find(|&(offset, to)| self.to_go[to] != UNSEEN && longer(self.to_go[to], offset) == self.to_go[here])
                .map(|(_, to)| to)
                .expect("a shortest path goes on");
            path.push(here);
        }
        path
    }
}

/// Cost of the cheapest walk from every cell to any of the goals; infinite where there is none. Every move can be made
/// back.
pub fn cost_to_go(moves: &Grid<u8>, goals: impl IntoIterator<Item = usize>, step_costs: impl StepCosts) -> Grid<f64> {
    let mut costs = Grid::filled(moves.rows(), moves.cols(), f64::INFINITY);
    let mut open = OpenList::default();
    for goal in goals {
        costs.values_mut()[goal] = 0.0;
        open.push(Reached { cost: 0.0, index: goal });
    }
    while let Some(Reached { cost, index }) = open.pop() {
        if cost > costs.values()[index] {
            continue;
        }
        for (k, &(row_step, col_step)) in MOVES.iter().enumerate() {
            if moves.values()[index] & (1 << k) == 0 {
                continue;
            }
            let next = index.wrapping_add_signed(row_step * moves.cols() as isize + col_step);
            let step = step_costs.of(k, next, index);
            if cost + step < costs.values()[next] {
                costs.values_mut()[next] = cost + step;
                open.push(Reached { cost: cost + step, index: next });
            }
        }
    }
    costs
}

struct Reached {
    cost: f64,
    index: usize,
}

impl Ranked for Reached {
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
