//! A* on an 8-connected lattice whose legal moves are given point by point.
//!
//! Hart, Nilsson, Raphael, "A formal basis for the heuristic determination of minimum cost paths" (1968). A point is
//! expanded once; with a consistent estimate the path is a cheapest one. Ties are decided by the larger cost so far
//! (deeper first), then by the smaller index, so that the same problem always has the same answer.

use crate::Grid;
use crate::layered_queue::{LayeredQueue, Waiting};

/// The eight moves as (row, column) steps; the first four are orthogonal. Bit `k` of a move mask stands for move `k`.
pub const MOVES: [(isize, isize); 8] = [(0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, -1), (-1, 1)];

/// Returns whether move `k` of [`MOVES`] is diagonal.
pub fn is_diagonal(k: usize) -> bool {
    k >= 4
}

/// The number of the start's arrival, which no move led to.
const NO_MOVE: usize = MOVES.len();

/// Moves that need not be looked at, by the move that led to a point and by the mask of legal moves of its parent: the move
/// back, and those to where the parent has a cheaper move of its own, which it made when it was expanded.
///
/// They are neighbours that D. Harabor, A. Grastien, "Online graph pruning for pathfinding on grid maps" (AAAI 2011) prune,
/// without those whose two ways cost the same: which of these is first decides ties. They hold where [`can_prune`].
static PRUNED: [[u8; 256]; NO_MOVE + 1] = pruned();

const fn pruned() -> [[u8; 256]; NO_MOVE + 1] {
    let mut table = [[0; 256]; NO_MOVE + 1];
    // Loops count by hand, as a constant function cannot use iterators.
    let mut arrival = 0;
    while arrival < MOVES.len() {
        let mut k = 0;
        while k < MOVES.len() {
            let rows = MOVES[arrival].0 + MOVES[k].0;
            let cols = MOVES[arrival].1 + MOVES[k].1;
            let mut mask = 0;
            while mask < 256 {
                let mut direct = 0;
                while direct < MOVES.len() {
                    // One legal step from the parent to the same point costs no more than two by way of this one.
                    if MOVES[direct].0 == rows && MOVES[direct].1 == cols && mask & (1 << direct) != 0 {
                        table[arrival][mask] |= 1 << k;
                    }
                    direct += 1;
                }
                // Back to the parent, which is closed before any of its neighbours is expanded.
                if rows == 0 && cols == 0 {
                    table[arrival][mask] |= 1 << k;
                }
                mask += 1;
            }
            k += 1;
        }
        arrival += 1;
    }
    table
}

/// Returns whether a move is cheaper than every two that lead to the same place, by more than sums of costs are
/// rounded.
fn can_prune((orthogonal, diagonal): (f64, f64)) -> bool {
    orthogonal > 0.0 && diagonal > 0.1 * orthogonal && diagonal < 1.9 * orthogonal
}

/// The outcome of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticePath {
    /// Indices (`row * cols + col`) from start to goal, both included; `None` if no goal can be reached.
    pub path: Option<Vec<usize>>,
    pub expansions: u32,
}

#[derive(Clone, Copy)]
struct LatticeNode {
    /// Infinite before the point is reached.
    cost: f64,
    parent: u32,
    /// The move that led here from the parent, or [`NO_MOVE`].
    arrival: u8,
    closed: bool,
}

/// The nodes of one search, in pages of consecutive points that are made when the search comes to them.
///
/// A query on a large lattice that stays near its start neither clears nor holds more than what it touches.
#[derive(Default)]
struct Pages {
    /// By page of the lattice: its number among those that are used, from 1; 0 if no point of it was reached.
    directory: Vec<u32>,
    /// The pages that are used, then those that earlier queries left. They are boxed, so that a list that grows moves none.
    #[expect(clippy::vec_box, reason = "a page is too large to be moved whenever the list grows")]
    pages: Vec<Box<[LatticeNode; Self::POINTS]>>,
    /// Where in the directory the pages that are used stand.
    used: Vec<u32>,
}

impl Pages {
    /// Points in a page. Lattices are wide, so that a page is a short piece of one row.
    const POINTS: usize = 64;

    const UNSEEN: [LatticeNode; Self::POINTS] =
        [LatticeNode { cost: f64::INFINITY, parent: 0, arrival: NO_MOVE as u8, closed: false }; Self::POINTS];

    fn new(points: usize) -> Self {
        assert!(u32::try_from(points).is_ok(), "a lattice of {points} points has too many for their numbers");
        Self { directory: vec![0; points.div_ceil(Self::POINTS)], ..Self::default() }
    }

    /// Forgets all nodes and keeps their memory.
    fn clear(&mut self) {
        for place in self.used.drain(..) {
            self.directory[place as usize] = 0;
        }
    }

    fn node(&self, index: usize) -> &LatticeNode {
        let number = self.directory[index / Self::POINTS] as usize;
        &self.pages[number - 1][index % Self::POINTS]
    }

    fn node_mut(&mut self, index: usize) -> &mut LatticeNode {
        let number = &mut self.directory[index / Self::POINTS];
        if *number == 0 {
            self.used.push((index / Self::POINTS) as u32);
            *number = self.used.len() as u32;
            match self.pages.get_mut(self.used.len() - 1) {
                Some(page) => **page = Self::UNSEEN,
                None => self.pages.push(Box::new(Self::UNSEEN)),
            }
        }
        &mut self.pages[*number as usize - 1][index % Self::POINTS]
    }
}

/// A search with its memory, kept from query to query.
pub struct AStar {
    pages: Pages,
    open: LayeredQueue,
    /// Points that the last search settled, in order.
    settled: Vec<u32>,
}

impl AStar {
    /// Creates a search over lattices of `points` points.
    ///
    /// # Panics
    /// If their numbers do not fit into 32 bits.
    pub fn new(points: usize) -> Self {
        Self { pages: Pages::new(points), open: LayeredQueue::default(), settled: Vec::new() }
    }

    /// Returns a cheapest path from `start` to any point that `is_goal`.
    ///
    /// `moves` holds a mask of [`MOVES`] for every point. `estimate(point, parent)` is added to the cost so far for the
    /// order of expansion.
    pub fn search(
        &mut self,
        moves: &Grid<u8>,
        start: usize,
        step_costs: impl StepCosts,
        is_goal: impl Fn(usize) -> bool,
        estimate: impl Fn(usize, usize) -> f64,
    ) -> LatticePath {
        // Only pages that were used: a search of a few cells does not touch a whole field.
        self.pages.clear();
        // A layer is a fraction of a step: it holds what is alike, and a search goes through few layers without entries.
        let any_move = moves.values()[start].trailing_zeros() as usize;
        let step = MOVES.get(any_move).map_or(1.0, |&(row_step, col_step)| {
            let next = start.wrapping_add_signed(row_step * moves.cols() as isize + col_step);
            step_costs.cost(any_move, start, next)
        });
        self.open.clear(0.25 * step);
        self.settled.clear();
        // Pruning relies on detours costing no less, so step costs must be the same everywhere.
        let prunes = step_costs.uniform().is_some_and(can_prune);
        let offsets = MOVES.map(|(row_step, col_step)| row_step * moves.cols() as isize + col_step);
        self.reach(start, (start, NO_MOVE), 0.0, estimate(start, start));
        let mut expansions = 0;
        while let Some(Waiting { index, cost, .. }) = self.open.pop() {
            let index = index as usize;
            let node = self.pages.node_mut(index);
            // An older entry, with a higher cost, of a point that was expanded since.
            if node.closed {
                continue;
            }
            node.closed = true;
            let parent = node.parent as usize;
            let arrival = usize::from(node.arrival);
            self.settled.push(index as u32);
            // Asked when a goal is expanded, not when it is reached: only now is no cheaper way to it left.
            if is_goal(index) {
                return LatticePath { path: Some(self.path(start, index)), expansions };
            }
            // The goal is settled like the others, but nothing is expanded from it.
            expansions += 1;
            let mut mask = moves.values()[index];
            // The start arrives by no move, whose row of the table prunes nothing.
            if prunes {
                mask &= !PRUNED[arrival][usize::from(moves.values()[parent])];
            }
            // Legal moves stay on the grid, so offsets need no test of bounds.
            for (k, &offset) in offsets.iter().enumerate() {
                if mask & (1 << k) != 0 {
                    let next = index.wrapping_add_signed(offset);
                    let to_next = cost + step_costs.cost(k, index, next);
                    let node = self.pages.node_mut(next);
                    if !node.closed && to_next < node.cost {
                        self.reach(next, (index, k), to_next, estimate(next, index));
                    }
                }
            }
        }
        LatticePath { path: None, expansions }
    }

    /// Iterates over the points that the last search settled, in order, each after its predecessor; the start after
    /// itself.
    pub fn settled(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.settled.iter().map(|&index| [self.pages.node(index as usize).parent as usize, index as usize])
    }

    /// Iterates over the points that the last search gave a cost, page by page, each after its predecessor on the
    /// cheapest path; the start after itself.
    pub fn reached(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let pages = self.pages.used.iter().zip(&self.pages.pages);
        pages.flat_map(|(&place, page)| {
            let reached = page.iter().enumerate().filter(|(_, node)| node.cost.is_finite());
            reached.map(move |(point, node)| [node.parent as usize, place as usize * Pages::POINTS + point])
        })
    }

    fn reach(&mut self, index: usize, (parent, arrival): (usize, usize), cost: f64, estimate: f64) {
        let (parent, arrival) = (parent as u32, arrival as u8);
        *self.pages.node_mut(index) = LatticeNode { cost, parent, arrival, closed: false };
        self.open.push(Waiting { priority: cost + estimate, cost, index: index as u32 });
    }

    fn path(&self, start: usize, goal: usize) -> Vec<usize> {
        let mut path = vec![goal];
        let mut index = goal;
        while index != start {
            index = self.pages.node(index).parent as usize;
            path.push(index);
        }
        path.reverse();
        path
    }
}

/// The cost of every move of a lattice; never negative.
pub trait StepCosts {
    /// Returns the cost of move `k` of [`MOVES`], which leads between these points.
    fn cost(&self, k: usize, from: usize, to: usize) -> f64;

    /// Returns the costs of all orthogonal moves and of all diagonal ones, if those of a kind are equal.
    fn uniform(&self) -> Option<(f64, f64)> {
        None
    }
}

/// One cost for all orthogonal moves, one for all diagonal ones.
impl StepCosts for (f64, f64) {
    fn cost(&self, k: usize, _: usize, _: usize) -> f64 {
        if is_diagonal(k) { self.1 } else { self.0 }
    }

    fn uniform(&self) -> Option<(f64, f64)> {
        Some(*self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    use rand::RngExt;

    /// Moves between free points, diagonals only where both sides are free too.
    fn random_moves(rows: usize, cols: usize, seed: u64) -> Grid<u8> {
        let mut rng = wildfire_base::rng::stream(seed, "astar test");
        let free: Vec<bool> = (0..rows * cols).map(|_| rng.random_bool(0.7)).collect();
        let is_free = |row: isize, col: isize| {
            row >= 0
                && col >= 0
                && row < rows as isize
                && col < cols as isize
                && free[row as usize * cols + col as usize]
        };
        let mut moves = Grid::filled(rows, cols, 0u8);
        for row in 0..rows as isize {
            for col in 0..cols as isize {
                for (k, &(dr, dc)) in MOVES.iter().enumerate() {
                    let open = is_free(row, col)
                        && is_free(row + dr, col + dc)
                        && is_free(row + dr, col)
                        && is_free(row, col + dc);
                    moves[(row as usize, col as usize)] |= u8::from(open) << k;
                }
            }
        }
        moves
    }

    fn octile(cols: usize, a: usize, b: usize) -> f64 {
        let rows = (a / cols).abs_diff(b / cols) as f64;
        let columns = (a % cols).abs_diff(b % cols) as f64;
        rows.max(columns) + (SQRT_2 - 1.0) * rows.min(columns)
    }

    fn cost(cols: usize, path: &[usize]) -> f64 {
        path.windows(2).map(|pair| octile(cols, pair[0], pair[1])).sum()
    }

    #[test]
    fn astar_costs_what_dijkstra_costs_with_fewer_expansions() {
        let (rows, cols) = (23, 31);
        let mut solved = 0;
        let mut astar_effort = 0;
        let mut dijkstra_effort = 0;
        for seed in 0..60 {
            let moves = random_moves(rows, cols, seed);
            let start = seed as usize % 40;
            let goal = rows * cols - 1 - seed as usize % 60;
            let mut search = AStar::new(rows * cols);
            let at_goal = |index| index == goal;
            let astar = search.search(&moves, start, (1.0, SQRT_2), at_goal, |index, _| octile(cols, index, goal));
            let dijkstra = search.search(&moves, start, (1.0, SQRT_2), at_goal, |_, _| 0.0);
            assert_eq!(astar.path.is_some(), dijkstra.path.is_some(), "seed {seed}");
            astar_effort += astar.expansions;
            dijkstra_effort += dijkstra.expansions;
            if let (Some(a), Some(d)) = (astar.path, dijkstra.path) {
                solved += 1;
                assert!((cost(cols, &a) - cost(cols, &d)).abs() < 1e-9, "seed {seed}");
                assert_eq!((a[0], a[a.len() - 1]), (start, goal));
            }
        }
        assert!(solved > 20, "only {solved} of 60 problems have a path");
        assert!(astar_effort < dijkstra_effort);
    }

    /// Costs that do not say that they are uniform, so that no neighbour is pruned.
    struct Unpruned((f64, f64));

    impl StepCosts for Unpruned {
        fn cost(&self, k: usize, from: usize, to: usize) -> f64 {
            self.0.cost(k, from, to)
        }
    }

    #[test]
    fn pruned_neighbours_change_no_search() {
        let (rows, cols) = (23, 31);
        for seed in 0..60 {
            let moves = random_moves(rows, cols, seed);
            let goal = rows * cols - 1 - seed as usize;
            for costs in [(1.0, SQRT_2), (1.0, 1.0), (5.0, 9.0), (1.0, 3.0), (2.5, 0.1)] {
                // Consistent, then one that is not.
                for weight in [costs.1.min(costs.0), 3.0] {
                    let answers = |step_costs: &dyn Fn(&mut AStar) -> LatticePath| {
                        let mut search = AStar::new(rows * cols);
                        let found = step_costs(&mut search);
                        (found, search.settled().collect::<Vec<_>>())
                    };
                    let estimate = |index: usize, _: usize| weight * octile(cols, index, goal);
                    let pruned = answers(&|search| search.search(&moves, 3, costs, |index| index == goal, estimate));
                    let all =
                        answers(&|search| search.search(&moves, 3, Unpruned(costs), |index| index == goal, estimate));
                    assert_eq!(pruned, all, "seed {seed}, steps {costs:?}, weight {weight}");
                }
            }
        }
    }

    #[test]
    fn a_memory_that_was_used_before_gives_the_same_answer() {
        let moves = random_moves(20, 20, 5);
        let mut used = AStar::new(400);
        for goal in (0..400).step_by(7) {
            let query =
                |search: &mut AStar| search.search(&moves, 0, (1.0, SQRT_2), |i| i == goal, |i, _| octile(20, i, goal));
            assert_eq!(query(&mut used), query(&mut AStar::new(400)));
        }
    }

    #[test]
    fn a_start_that_is_a_goal_needs_no_expansion() {
        let moves = Grid::filled(3, 3, 0u8);
        let found = AStar::new(9).search(&moves, 4, (1.0, SQRT_2), |i| i == 4, |_, _| 0.0);
        assert_eq!(found, LatticePath { path: Some(vec![4]), expansions: 0 });
        let found = AStar::new(9).search(&moves, 4, (1.0, SQRT_2), |i| i == 5, |_, _| 0.0);
        assert_eq!(found, LatticePath { path: None, expansions: 1 });
    }
}
