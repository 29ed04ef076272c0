//! Two-dimensional search over cells as a heuristic: what bushes make of the way, whatever the steering.

use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::geometry::FieldFrame;
use crate::grid::astar::MOVES;
use crate::grid::octile::legal_moves;
use crate::grid::{Connectivity, CornerCutting, Grid};
use crate::planning::Goal;

/// A truck drives at least this share of a walk over cells, however it cuts the corners of the grid.
const SHARE: f64 = 0.94;

/// For every diagonal move the orthogonal ones beside it: nothing passes between two bushes that touch at a corner.
const BESIDE_DIAGONAL: [(u8, u8); 4] = [(4, 0b0011), (5, 0b0110), (6, 0b1100), (7, 0b1001)];

/// Costs of an orthogonal and of a diagonal move: 99 / 70 is the root of 2 to 0.005 %.
const MOVE_COSTS: (u32, u32) = (70, 99);
/// The number of buckets, more than a move costs.
const RING: usize = 128;
/// The cost of a cell that was not reached yet.
const UNREACHED: u32 = u32::MAX;

/// Walks over the cells of one field that are free of bushes.
#[derive(Debug)]
pub struct WalkableCells {
    frame: FieldFrame,
    moves: Grid<u8>,
    occupied: Grid<bool>,
}

impl WalkableCells {
    pub fn new(checker: &CollisionChecker) -> Self {
        let field = checker.field();
        let mut moves = legal_moves(field.occupied(), Connectivity::Eight, CornerCutting::Allowed);
        for mask in moves.values_mut() {
            for (k, beside) in BESIDE_DIAGONAL {
                *mask &= if *mask & beside == 0 { !(1 << k) } else { u8::MAX };
            }
        }
        Self { frame: *field.frame(), moves, occupied: field.occupied().clone() }
    }

    /// Returns the bytes that it takes on a field.
    pub fn bytes(frame: &FieldFrame) -> u64 {
        frame.cell_count() as u64 * (size_of::<u8>() + size_of::<bool>()) as u64
    }

    /// Returns the free cells that a goal touches.
    fn goal_cells(&self, goal: Goal) -> impl Iterator<Item = usize> + '_ {
        let (centre, radius_m) = match goal {
            Goal::Pose(pose) => (pose.position(), 0.0),
            Goal::Disc(disc) => (disc.centre, disc.radius_m),
        };
        let half = DVec2::splat(0.5 * self.frame.cell_m);
        let range = move |middle: f64, count: u16| {
            let index = |metres: f64| (metres / self.frame.cell_m) as usize;
            index(middle - radius_m).saturating_sub(1)..index(middle + radius_m).saturating_add(2).min(count.into())
        };
        let cols = range(centre.x, self.frame.cols);
        let indices = range(centre.y, self.frame.rows)
            .flat_map(move |row| cols.clone().map(move |col| row * usize::from(self.frame.cols) + col));
        indices.filter(move |&index| {
            let offset = (self.frame.centre(self.frame.cell(index)) - centre).abs();
            !self.occupied.values()[index] && (offset - half).max(DVec2::ZERO).length() <= radius_m
        })
    }
}

/// The holonomic heuristic: the distance to a goal for somebody who walks from cell to cell round the bushes.
///
/// It spreads from the goal as far as it is asked: Dijkstra's search with whole costs, in R. Dial's buckets ("Algorithm
/// 360: shortest-path forest with topological ordering", Communications of the ACM 12(11), 1969).
#[derive(Debug)]
pub struct HolonomicHeuristic {
    costs: Vec<u32>,
    /// Cells by their cost, modulo the ring.
    buckets: Vec<Vec<u32>>,
    /// Costs up to this are final.
    settled: u32,
    /// Entries in all buckets.
    waiting: usize,
}

impl Default for HolonomicHeuristic {
    fn default() -> Self {
        Self { costs: Vec::new(), buckets: vec![Vec::new(); RING], settled: 0, waiting: 0 }
    }
}

impl HolonomicHeuristic {
    /// Bounds the bytes that it takes on a field: a cost and an entry for every cell, in lists that double.
    pub fn most_bytes(frame: &FieldFrame) -> u64 {
        frame.cell_count() as u64 * 3 * size_of::<u32>() as u64
    }

    /// Forgets everything and begins at the goal.
    pub fn begin(&mut self, cells: &WalkableCells, goal: Goal) {
        self.costs.clear();
        self.costs.resize(cells.frame.cell_count(), UNREACHED);
        self.buckets.iter_mut().for_each(Vec::clear);
        (self.settled, self.waiting) = (0, 0);
        for cell in cells.goal_cells(goal) {
            self.reach(cell, 0);
        }
    }

    /// Returns about the least metres that are still to drive from a position in the field; infinite where no way leads.
    pub fn cost_to_go_m(&mut self, cells: &WalkableCells, place: DVec2) -> f64 {
        let Some(cell) = cells.frame.cell_at(place) else { return f64::INFINITY };
        let cost = self.cost_of(cells, cells.frame.index(cell));
        if cost == UNREACHED {
            return f64::INFINITY;
        }
        let cell_m = cells.frame.cell_m;
        (SHARE * cell_m * f64::from(cost) / f64::from(MOVE_COSTS.0) - cell_m).max(0.0)
    }

    /// Returns the cost of a cell; the search goes on until it is final.
    fn cost_of(&mut self, cells: &WalkableCells, index: usize) -> u32 {
        while self.costs[index] > self.settled && self.waiting > 0 {
            let Some(cell) = self.buckets[self.settled as usize % RING].pop() else {
                // All costs up to this are known, and no move costs as much as there are buckets: the next may be reused.
                self.settled += 1;
                continue;
            };
            self.waiting -= 1;
            let from = cell as usize;
            if self.costs[from] != self.settled {
                // It was reached more cheaply after it had been put here.
                continue;
            }
            let mask = cells.moves.values()[from];
            for (k, (rows, cols)) in MOVES.into_iter().enumerate() {
                if mask & (1 << k) != 0 {
                    let to = from.wrapping_add_signed(rows * cells.moves.cols() as isize + cols);
                    let cost = self.settled + if rows == 0 || cols == 0 { MOVE_COSTS.0 } else { MOVE_COSTS.1 };
                    if cost < self.costs[to] {
                        self.reach(to, cost);
                    }
                }
            }
        }
        self.costs[index]
    }

    fn reach(&mut self, cell: usize, cost: u32) {
        self.costs[cell] = cost;
        self.buckets[cost as usize % RING].push(cell as u32);
        self.waiting += 1;
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::grid::octile::cost_to_go;
    use crate::planning::test_fields::{TestField, random_free_pose};

    #[test]
    fn asked_in_any_order_it_tells_the_lengths_of_shortest_walks() {
        let mut compared = 0;
        for seed in 0..8 {
            let mut field = TestField::random(seed, 60);
            let cells = WalkableCells::new(&field.checker);
            let mut walk = HolonomicHeuristic::default();
            for goal in [Goal::Disc(field.random_goal()), Goal::Pose(random_free_pose(&mut field, 0.1))] {
                walk.begin(&cells, goal);
                let all = cost_to_go(&cells.moves, cells.goal_cells(goal), (1.0, std::f64::consts::SQRT_2));
                for _ in 0..200 {
                    let index = field.rng.random_range(0..all.values().len());
                    let (cost, length) = (walk.cost_of(&cells, index), all.values()[index]);
                    assert_eq!(cost == UNREACHED, length.is_infinite());
                    assert!(
                        cost == UNREACHED || (f64::from(cost) / 70.0 - length).abs() <= 1e-4 * length,
                        "{cost}, {length}"
                    );
                    compared += u32::from(cost != UNREACHED && cost > 0);
                }
            }
        }
        assert!(compared > 1_000, "{compared}");
    }

    #[test]
    fn a_goal_disc_begins_at_the_free_cells_that_it_meets() {
        let mut field = TestField::random(2, 40);
        let cells = WalkableCells::new(&field.checker);
        for _ in 0..20 {
            let disc = field.random_goal();
            let found: Vec<usize> = cells.goal_cells(disc.into()).collect();
            let corner = DVec2::splat(0.5 * cells.frame.cell_m);
            let meets = |index: &usize| {
                let centre = cells.frame.centre(cells.frame.cell(*index));
                disc.centre.clamp(centre - corner, centre + corner).distance(disc.centre) <= disc.radius_m
            };
            let expected = (0..cells.frame.cell_count()).filter(|index| !cells.occupied.values()[*index]);
            assert_eq!(found, expected.filter(meets).collect::<Vec<_>>());
        }
    }
}
