//! Where a Wumpus can walk: a lattice of points for its square body, and searches on it.
//!
//! World frame, metres. The body keeps its sides parallel to the axes. A step is legal if the box about the body at
//! both its ends is free, which for diagonal steps means that no corner is cut. Every step can be walked back.

use std::f64::consts::SQRT_2;

use glam::DVec2;

use crate::geometry::{Cell, FieldFrame};
use crate::grid::Grid;
use crate::grid::astar::{AStar, MOVES};

/// Touching is not overlapping; this much of a cell absorbs rounding.
const TOUCH: f64 = 1e-9;

/// The lattice as the user describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeShape {
    /// Any point of the lattice; it is part of it whether free or not.
    pub anchor: DVec2,
    pub step_m: f64,
    /// Side of the body's square.
    pub size_m: f64,
}

/// How a search weighs steps and distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkSearch {
    /// Cost of a step: orthogonal, diagonal.
    pub step_costs: (f64, f64),
    pub estimate: Estimate,
    pub weight: f64,
}

/// What stands for the cost that is still to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimate {
    /// Cost of the shortest lattice path on an empty field to the nearest point of reach: admissible and consistent.
    Octile,
    /// Metres in a straight line from the point's parent to the cell's centre, whatever a step costs.
    ParentEuclidean,
}

/// Points that the body can stand on, and the legal steps between them.
#[derive(Clone, Debug)]
pub struct WalkLattice {
    frame: FieldFrame,
    step_m: f64,
    /// World position of point (0, 0), the south-west one.
    origin: DVec2,
    /// For every point a mask of [`MOVES`]; row 0 is the south edge.
    moves: Grid<u8>,
    free: Vec<bool>,
}

/// A search's answer.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkFound {
    /// Point indices from start to the point of reach; `None` if the cell cannot be approached.
    pub path: Option<Vec<usize>>,
    pub expansions: u32,
}

impl WalkLattice {
    /// How many points such a lattice has, before any memory is taken.
    pub fn point_count(frame: &FieldFrame, shape: &LatticeShape) -> f64 {
        let (west, east) = range(shape.anchor.x, shape.step_m, frame.width_m());
        let (south, north) = range(shape.anchor.y, shape.step_m, frame.height_m());
        (east - west + 1.0) * (north - south + 1.0)
    }

    /// `occupied` has a value per cell, row 0 at the south edge.
    pub fn new(frame: FieldFrame, occupied: &Grid<bool>, shape: LatticeShape) -> Self {
        let (west, east) = range(shape.anchor.x, shape.step_m, frame.width_m());
        let (south, north) = range(shape.anchor.y, shape.step_m, frame.height_m());
        let (cols, rows) = ((east - west) as usize + 1, (north - south) as usize + 1);
        let origin = shape.anchor + DVec2::new(west, south) * shape.step_m;
        let mut lattice = Self {
            frame,
            step_m: shape.step_m,
            origin,
            moves: Grid::filled(rows, cols, 0),
            free: vec![false; rows * cols],
        };
        lattice.open(&OccupiedCount::new(frame, occupied), 0.5 * shape.size_m);
        lattice
    }

    fn open(&mut self, occupied: &OccupiedCount, half: f64) {
        let box_is_free = |a: DVec2, b: DVec2| occupied.is_free(a.min(b) - half, a.max(b) + half);
        for index in 0..self.free.len() {
            let here = self.position(index);
            self.free[index] = box_is_free(here, here);
        }
        // A step and the step back are legal together, so half of the moves are enough.
        for index in (0..self.free.len()).filter(|&index| self.free[index]).collect::<Vec<_>>() {
            let here = self.position(index);
            for (k, back) in [(0, 2), (1, 3), (4, 6), (5, 7)] {
                let Some(next) = self.neighbour(index, k) else { continue };
                if self.free[next] && box_is_free(here, self.position(next)) {
                    self.moves.values_mut()[index] |= 1 << k;
                    self.moves.values_mut()[next] |= 1 << back;
                }
            }
        }
    }

    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    pub fn points(&self) -> usize {
        self.free.len()
    }

    pub fn is_free(&self, point: usize) -> bool {
        self.free[point]
    }

    pub fn position(&self, point: usize) -> DVec2 {
        let cols = self.moves.cols();
        self.origin + DVec2::new((point % cols) as f64, (point / cols) as f64) * self.step_m
    }

    /// The free point nearest to a place, ties by index.
    pub fn nearest_free(&self, place: DVec2) -> Option<usize> {
        let squared = |point: usize| (self.position(point) - place).length_squared();
        (0..self.points()).filter(|&p| self.free[p]).min_by(|&a, &b| squared(a).total_cmp(&squared(b)))
    }

    /// Every point that can be walked to from `start`, itself included.
    pub fn reachable_from(&self, start: usize) -> Vec<bool> {
        let mut reached = vec![false; self.points()];
        reached[start] = true;
        let mut front = vec![start];
        while let Some(point) = front.pop() {
            for k in 0..MOVES.len() {
                if self.moves.values()[point] & (1 << k) == 0 {
                    continue;
                }
                let next = self.neighbour(point, k).expect("a legal step stays on the lattice");
                if !reached[next] {
                    reached[next] = true;
                    front.push(next);
                }
            }
        }
        reached
    }

    /// Free points within `reach_m` of a cell's centre, inclusive, by index.
    pub fn points_of_reach(&self, cell: Cell, reach_m: f64) -> impl Iterator<Item = usize> + '_ {
        let centre = self.frame.centre(cell);
        let slack = reach_m * (1.0 + TOUCH);
        let low = ((centre - slack - self.origin) / self.step_m).ceil().max(DVec2::ZERO);
        let high = ((centre + slack - self.origin) / self.step_m).floor();
        let cols = self.moves.cols();
        let col_end = (high.x + 1.0).clamp(0.0, cols as f64) as usize;
        let row_end = (high.y + 1.0).clamp(0.0, self.moves.rows() as f64) as usize;
        (low.y as usize..row_end)
            .flat_map(move |row| (low.x as usize..col_end).map(move |col| row * cols + col))
            .filter(move |&point| self.free[point] && (self.position(point) - centre).length() <= slack)
    }

    /// A walk from a point to one within `reach_m` of a cell's centre.
    pub fn search(
        &self,
        memory: &mut AStar,
        start: usize,
        (cell, reach_m): (Cell, f64),
        settings: &WalkSearch,
    ) -> WalkFound {
        let goals: Vec<usize> = self.points_of_reach(cell, reach_m).collect();
        let centre = self.frame.centre(cell);
        // Octile distance obeys the triangle inequality: what the farthest point of reach is short of the centre,
        // taken off the distance to the centre, bounds the distance to each point of reach from below.
        let short = goals.iter().map(|&goal| self.octile(settings, self.position(goal), centre)).fold(0.0, f64::max);
        let estimate = |point: usize, parent: usize| match settings.estimate {
            Estimate::Octile => {
                settings.weight * (self.octile(settings, self.position(point), centre) - short).max(0.0)
            }
            Estimate::ParentEuclidean => settings.weight * (self.position(parent) - centre).length(),
        };
        let is_goal = |point: usize| goals.binary_search(&point).is_ok();
        let found = memory.search(&self.moves, start, settings.step_costs, is_goal, estimate);
        WalkFound { path: found.path, expansions: found.expansions }
    }

    /// Metres of the step between two neighbouring points.
    pub fn step_length(&self, from: usize, to: usize) -> f64 {
        let cols = self.moves.cols();
        let is_orthogonal = from / cols == to / cols || from % cols == to % cols;
        if is_orthogonal { self.step_m } else { self.step_m * SQRT_2 }
    }

    fn octile(&self, settings: &WalkSearch, a: DVec2, b: DVec2) -> f64 {
        let steps = (a - b).abs() / self.step_m;
        let (orthogonal, diagonal) = settings.step_costs;
        let diagonals = steps.min_element();
        diagonals * diagonal.min(2.0 * orthogonal) + (steps.max_element() - diagonals) * orthogonal.min(diagonal)
    }

    fn neighbour(&self, point: usize, k: usize) -> Option<usize> {
        let (row, col) = (point / self.moves.cols(), point % self.moves.cols());
        let row = row.checked_add_signed(MOVES[k].0).filter(|&row| row < self.moves.rows())?;
        let col = col.checked_add_signed(MOVES[k].1).filter(|&col| col < self.moves.cols())?;
        Some(row * self.moves.cols() + col)
    }
}

/// First and last lattice step from an anchor that lie within 0 and `extent`.
fn range(anchor: f64, step: f64, extent: f64) -> (f64, f64) {
    (((-anchor) / step).ceil(), ((extent - anchor) / step).floor())
}

/// Occupied cells in any box in constant time (a summed-area table: Crow, "Summed-area tables for texture mapping",
/// 1984).
struct OccupiedCount {
    frame: FieldFrame,
    /// (rows + 1) x (cols + 1): occupied cells south-west of each grid corner.
    sums: Grid<u32>,
}

impl OccupiedCount {
    fn new(frame: FieldFrame, occupied: &Grid<bool>) -> Self {
        let mut sums = Grid::filled(occupied.rows() + 1, occupied.cols() + 1, 0);
        for row in 0..occupied.rows() {
            for col in 0..occupied.cols() {
                sums[(row + 1, col + 1)] =
                    u32::from(occupied[(row, col)]) + sums[(row, col + 1)] + sums[(row + 1, col)] - sums[(row, col)];
            }
        }
        Self { frame, sums }
    }

    /// Whether a box lies in the field and overlaps no occupied cell.
    fn is_free(&self, low: DVec2, high: DVec2) -> bool {
        let low = low / self.frame.cell_m + TOUCH;
        let high = high / self.frame.cell_m - TOUCH;
        let inside = low.x >= 0.0
            && low.y >= 0.0
            && high.x <= f64::from(self.frame.cols)
            && high.y <= f64::from(self.frame.rows);
        if !inside {
            return false;
        }
        // What is not negative rounds up faster through integers than by a call of `ceil`.
        let round_up = |x: f64| x as usize + usize::from(x > (x as usize) as f64);
        let (west, south) = (low.x as usize, low.y as usize);
        let (east, north) = (round_up(high.x), round_up(high.y));
        let sums = &self.sums;
        sums[(north, east)] + sums[(south, west)] == sums[(north, west)] + sums[(south, east)]
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 24, rows: 20, cell_m: 5.0 };
    const METRES: WalkSearch = WalkSearch { step_costs: (5.0, 5.0 * SQRT_2), estimate: Estimate::Octile, weight: 1.0 };

    fn field(seed: u64, share: f64) -> Grid<bool> {
        let mut rng = crate::rng::stream(seed, "walk test");
        let cells = (0..FRAME.cell_count()).map(|_| rng.random_bool(share)).collect();
        Grid::from_values(FRAME.rows.into(), FRAME.cols.into(), cells)
    }

    fn on_cells(occupied: &Grid<bool>) -> WalkLattice {
        WalkLattice::new(FRAME, occupied, LatticeShape { anchor: DVec2::splat(2.5), step_m: 5.0, size_m: 3.0 })
    }

    fn overlaps(low: DVec2, high: DVec2, occupied: &Grid<bool>) -> bool {
        (0..FRAME.cell_count()).filter(|&i| occupied.values()[i]).any(|index| {
            let centre = FRAME.centre(FRAME.cell(index));
            let gap = (centre - 0.5 * (low + high)).abs() - 0.5 * (high - low) - 2.5;
            gap.max_element() < -1e-6
        })
    }

    #[test]
    fn on_cell_centres_the_points_are_the_cells() {
        let occupied = field(1, 0.3);
        let lattice = on_cells(&occupied);
        assert_eq!(lattice.points(), FRAME.cell_count());
        for index in 0..lattice.points() {
            assert_eq!(lattice.is_free(index), !occupied.values()[index]);
            assert_eq!(lattice.position(index), FRAME.centre(FRAME.cell(index)));
        }
    }

    #[test]
    fn no_step_sweeps_over_a_bush() {
        let occupied = field(2, 0.15);
        for (anchor, step_m) in [(DVec2::splat(2.5), 5.0), (DVec2::new(60.0, 50.0), 2.0), (DVec2::new(3.1, 7.7), 3.3)] {
            let lattice = WalkLattice::new(FRAME, &occupied, LatticeShape { anchor, step_m, size_m: 3.0 });
            let mut steps = 0;
            for point in 0..lattice.points() {
                for k in 0..MOVES.len() {
                    if lattice.moves.values()[point] & (1 << k) == 0 {
                        continue;
                    }
                    steps += 1;
                    let next = lattice.neighbour(point, k).expect("legal steps have a neighbour");
                    let (a, b) = (lattice.position(point), lattice.position(next));
                    for t in 0..=20 {
                        let at = a.lerp(b, f64::from(t) / 20.0);
                        assert!(!overlaps(at - 1.5, at + 1.5, &occupied));
                        assert!(FRAME.border_distance(at) >= 1.5 - 1e-6);
                    }
                    let back = (0..8).find(|&other| lattice.neighbour(next, other) == Some(point));
                    let back = back.expect("the step back exists");
                    assert!(lattice.moves.values()[next] & (1 << back) != 0, "every step can be walked back");
                }
            }
            assert!(steps > 1000);
        }
    }

    #[test]
    fn weight_one_costs_what_dijkstra_costs() {
        let (mut greedy_effort, mut exact_effort) = (0, 0);
        for seed in 0..30 {
            let occupied = field(seed, 0.2);
            let lattice = on_cells(&occupied);
            let Some(start) = lattice.nearest_free(DVec2::new(100.0, 90.0)) else { continue };
            let reached = lattice.reachable_from(start);
            let mut memory = AStar::new(lattice.points());
            for index in (0..FRAME.cell_count()).filter(|&i| occupied.values()[i]).step_by(9) {
                let cell = FRAME.cell(index);
                let cost =
                    |path: &[usize]| -> f64 { path.windows(2).map(|step| lattice.step_length(step[0], step[1])).sum() };
                let exact = lattice.search(&mut memory, start, (cell, 6.25), &METRES);
                let blind = lattice.search(&mut memory, start, (cell, 6.25), &WalkSearch { weight: 0.0, ..METRES });
                let greedy = lattice.search(&mut memory, start, (cell, 6.25), &WalkSearch { weight: 4.0, ..METRES });
                let approachable = lattice.points_of_reach(cell, 6.25).any(|point| reached[point]);
                assert_eq!(exact.path.is_some(), approachable);
                let (Some(exact_path), Some(blind_path)) = (&exact.path, &blind.path) else { continue };
                assert!((cost(exact_path) - cost(blind_path)).abs() < 1e-9);
                let end = lattice.position(exact_path[exact_path.len() - 1]);
                assert!((end - FRAME.centre(cell)).length() <= 6.25);
                greedy_effort += greedy.expansions;
                exact_effort += exact.expansions;
            }
        }
        assert!(greedy_effort < exact_effort, "{greedy_effort} expansions against {exact_effort}");
    }

    #[test]
    fn a_walled_in_cell_cannot_be_approached() {
        let mut occupied = Grid::filled(FRAME.rows.into(), FRAME.cols.into(), false);
        for row in 8..=10 {
            for col in 8..=10 {
                occupied[(row, col)] = true;
            }
        }
        let lattice = on_cells(&occupied);
        let middle = Cell { col: 9, row: 9 };
        assert_eq!(lattice.points_of_reach(middle, 6.25).count(), 0);
        let found = lattice.search(&mut AStar::new(lattice.points()), 0, (middle, 6.25), &METRES);
        assert_eq!(found.path, None);
    }
}
