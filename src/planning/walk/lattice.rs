use std::f64::consts::SQRT_2;

use glam::DVec2;

use crate::geometry::{Cell, FieldFrame};
use crate::grid::astar::MOVES;
use crate::grid::{Grid, Place};

/// Touching is not overlapping; this much of a cell absorbs rounding.
const TOUCH: f64 = 1e-9;

/// West, north, east, south, then the diagonals from north-west on: the order in which neighbours that are equally
/// good are taken, as indices of [`MOVES`].
const WEST_FIRST: [usize; 8] = [2, 1, 0, 3, 5, 4, 7, 6];

/// The lattice as the user describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeShape {
    /// Any point of the lattice; it is part of it whether free or not.
    pub anchor: DVec2,
    pub step_m: f64,
    /// Side of the body's square.
    pub size_m: f64,
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

impl WalkLattice {
    /// Returns the number of points that such a lattice has, before any memory is taken.
    pub fn point_count(frame: &FieldFrame, shape: &LatticeShape) -> f64 {
        let (west, east) = range(shape.anchor.x, shape.step_m, frame.width_m());
        let (south, north) = range(shape.anchor.y, shape.step_m, frame.height_m());
        (east - west + 1.0) * (north - south + 1.0)
    }

    /// Bounds the bytes that it takes on a field with this number of points, while it is made and asked what can be
    /// reached.
    pub fn most_bytes(frame: &FieldFrame, points: u64) -> u64 {
        // A point's moves and whether it is free; free points, or those that wait, in a list that doubles; reached
        // points.
        let point = 2 * size_of::<u8>() + 2 * size_of::<usize>() + size_of::<bool>();
        points * point as u64 + OccupiedCount::bytes(frame)
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

    pub fn rows(&self) -> usize {
        self.moves.rows()
    }

    pub fn cols(&self) -> usize {
        self.moves.cols()
    }

    /// For every point a mask of [`MOVES`]; row 0 is the south edge.
    pub fn moves(&self) -> &Grid<u8> {
        &self.moves
    }

    /// Returns the points that the body cannot stand on.
    pub fn blocked(&self) -> Grid<bool> {
        Grid::from_values(self.rows(), self.cols(), self.free.iter().map(|free| !free).collect())
    }

    /// Returns the centre of a cell of the field.
    pub fn centre(&self, cell: Cell) -> DVec2 {
        self.frame.centre(cell)
    }

    /// Returns the legal steps from a point, west first: which move, and where it leads.
    pub fn steps(&self, point: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let mask = self.moves.values()[point];
        WEST_FIRST
            .into_iter()
            .filter(move |&k| mask & (1 << k) != 0)
            .map(move |k| (k, self.neighbour(point, k).expect("a legal step stays on the lattice")))
    }

    pub fn is_free(&self, point: usize) -> bool {
        self.free[point]
    }

    pub fn position(&self, point: usize) -> DVec2 {
        let cols = self.moves.cols();
        self.origin + DVec2::new((point % cols) as f64, (point / cols) as f64) * self.step_m
    }

    /// Returns row and column of the point nearest to a place, free or not.
    pub fn nearest(&self, place: DVec2) -> Place {
        let steps = ((place - self.origin) / self.step_m).round().max(DVec2::ZERO);
        ((steps.y as usize).min(self.rows() - 1), (steps.x as usize).min(self.cols() - 1))
    }

    /// Returns the free point nearest to a place, ties by index.
    pub fn nearest_free(&self, place: DVec2) -> Option<usize> {
        let squared = |point: usize| (self.position(point) - place).length_squared();
        (0..self.points()).filter(|&p| self.free[p]).min_by(|&a, &b| squared(a).total_cmp(&squared(b)))
    }

    /// Returns for every point whether it can be walked to from `start`, itself included.
    pub fn reachable_from(&self, start: usize) -> Vec<bool> {
        let mut reached = vec![false; self.points()];
        reached[start] = true;
        let mut front = vec![start];
        while let Some(point) = front.pop() {
            for (_, next) in self.steps(point) {
                if !reached[next] {
                    reached[next] = true;
                    front.push(next);
                }
            }
        }
        reached
    }

    /// Returns free points within `reach_m` of a cell's centre, inclusive, by index.
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

    /// Returns the metres of the step between two neighbouring points.
    pub fn step_length(&self, from: usize, to: usize) -> f64 {
        let cols = self.moves.cols();
        let is_orthogonal = from / cols == to / cols || from % cols == to % cols;
        if is_orthogonal { self.step_m } else { self.step_m * SQRT_2 }
    }

    fn neighbour(&self, point: usize, k: usize) -> Option<usize> {
        let (row, col) = (point / self.moves.cols(), point % self.moves.cols());
        let row = row.checked_add_signed(MOVES[k].0).filter(|&row| row < self.moves.rows())?;
        let col = col.checked_add_signed(MOVES[k].1).filter(|&col| col < self.moves.cols())?;
        Some(row * self.moves.cols() + col)
    }
}

/// Counts occupied cells in any box in constant time (a summed-area table: Crow, "Summed-area tables for texture mapping",
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

    /// Returns the bytes that it takes on a field.
    fn bytes(frame: &FieldFrame) -> u64 {
        (u64::from(frame.rows) + 1) * (u64::from(frame.cols) + 1) * size_of::<u32>() as u64
    }

    /// Says whether a box lies in the field and overlaps no occupied cell.
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

/// Returns the first and the last lattice step from an anchor that lie within 0 and `extent`.
fn range(anchor: f64, step: f64, extent: f64) -> (f64, f64) {
    (((-anchor) / step).ceil(), ((extent - anchor) / step).floor())
}

#[cfg(test)]
mod tests {
    use super::super::test_lattices::{FRAME, field, on_cells};
    use super::*;

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
                for (_, next) in lattice.steps(point) {
                    steps += 1;
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
}
