//! The lattice that a Wumpus walks on: the points where its body fits, and the steps between them.

use std::f64::consts::SQRT_2;

use glam::DVec2;

use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_grid::astar::MOVES;
use wildfire_grid::{Grid, Place};

/// Touching is not overlapping; this much of a cell absorbs rounding.
const TOUCH: f64 = 1e-9;

/// West, north, east, south, then the diagonals from north-west on: the order in which neighbours that are equally
/// good are taken, as indices of [`MOVES`].
const WEST_FIRST: [usize; 8] = [2, 1, 0, 3, 5, 4, 7, 6];

/// The lattice as the user describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeShape {
    /// Any point of the lattice, free or not.
    pub anchor: DVec2,
    pub step_m: f64,
    /// The side of the square body.
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
    /// Returns the number of points of such a lattice, before any memory is allocated.
    pub fn point_count(frame: &FieldFrame, shape: &LatticeShape) -> f64 {
        let (west, east) = range(shape.anchor.x, shape.step_m, frame.width_m());
        let (south, north) = range(shape.anchor.y, shape.step_m, frame.height_m());
        (east - west + 1.0) * (north - south + 1.0)
    }

    /// `occupied` has a value per cell, row 0 at the south edge.
    pub fn new(frame: FieldFrame, occupied: &Grid<bool>, shape: LatticeShape) -> Self {
        let (west, east) = range(shape.anchor.x, shape.step_m, frame.width_m());
        let (south, north) = range(shape.anchor.y, shape.step_m, frame.height_m());
        let cols = (east - west) as usize + 1;
        let rows = (north - south) as usize + 1;
        let origin = shape.anchor + DVec2::new(west, south) * shape.step_m;
        let mut lattice = Self {
            frame,
            step_m: shape.step_m,
            origin,
            moves: Grid::filled(rows, cols, 0),
            free: vec![false; rows * cols],
        };
        lattice.open(&OccupiedCount::new(occupied), 0.5 * shape.size_m);
        lattice
    }

    /// Finds where the body can stand, and from there which steps are legal.
    fn open(&mut self, occupied: &OccupiedCount, half: f64) {
        let (rows, cols) = (self.rows(), self.cols());
        let cell_m = self.frame.cell_m;
        let span = |at: f64, cells: u16| CellSpan::from_metres(at - half, at + half, cell_m, cells);
        // Spans depend on the column or the row alone, so there is one for each of them and not for each point.
        let across: Vec<CellSpan> = (0..cols).map(|col| span(self.position(col).x, self.frame.cols)).collect();
        let along: Vec<CellSpan> = (0..rows).map(|row| span(self.position(row * cols).y, self.frame.rows)).collect();
        for (row, &rows_covered) in self.free.chunks_exact_mut(cols.max(1)).zip(&along) {
            for (free, &cols_covered) in row.iter_mut().zip(&across) {
                *free = occupied.is_free(cols_covered, rows_covered);
            }
        }
        // A step and the step back are legal together, so half of the moves are enough.
        for row in 0..rows {
            for col in (0..cols).filter(|col| self.free[row * cols + col]).collect::<Vec<_>>() {
                let index = row * cols + col;
                for (k, back) in [(0, 2), (1, 3), (4, 6), (5, 7)] {
                    let Some(next) = self.neighbour(index, k) else { continue };
                    if !self.free[next] {
                        continue;
                    }
                    let (next_row, next_col) = (next / cols, next % cols);
                    // The box about both ends holds all that the step sweeps, and the corners that a diagonal cuts.
                    let box_is_free = occupied.is_free(
                        across[col.min(next_col)].to(across[col.max(next_col)]),
                        along[row.min(next_row)].to(along[row.max(next_row)]),
                    );
                    if box_is_free {
                        self.moves.values_mut()[index] |= 1 << k;
                        self.moves.values_mut()[next] |= 1 << back;
                    }
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

    /// Returns a mask of [`MOVES`] for every point; row 0 is the south edge.
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

    /// Returns the legal steps from a point, west first: the move, and the point that it leads to.
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
        // Points have numbers of 32 bits, which are divided in half the time of larger ones.
        let point = point as u32;
        let cols = self.moves.cols() as u32;
        self.origin + DVec2::new(f64::from(point % cols), f64::from(point / cols)) * self.step_m
    }

    /// Returns the row and column of the point nearest to a place, free or not.
    pub fn nearest(&self, place: DVec2) -> Place {
        let steps = ((place - self.origin) / self.step_m).round().max(DVec2::ZERO);
        ((steps.y as usize).min(self.rows() - 1), (steps.x as usize).min(self.cols() - 1))
    }

    /// Returns the free point nearest to a place, ties by index.
    ///
    /// Looks at rings of points about the place, one farther out than the other, until none of the next can be nearer.
    pub fn nearest_free(&self, place: DVec2) -> Option<usize> {
        let squared = |point: usize| (self.position(point) - place).length_squared();
        let (row, col) = self.nearest(place);
        // A place outside is farther from all rings, so the bound holds for the point of the lattice next to it too.
        let min_squared = |ring: usize| {
            let min = (ring as f64 - 0.5 - TOUCH) * self.step_m;
            min.max(0.0) * min
        };
        let mut best: Option<usize> = None;
        for ring in 0..self.rows().max(self.cols()) {
            if best.is_some_and(|best| min_squared(ring) > squared(best)) {
                break;
            }
            let nearest_of_ring = self
                .ring((row, col), ring)
                .filter(|&point| self.free[point])
                .min_by(|&a, &b| squared(a).total_cmp(&squared(b)).then(a.cmp(&b)));
            best = best
                .into_iter()
                .chain(nearest_of_ring)
                .min_by(|&a, &b| squared(a).total_cmp(&squared(b)).then(a.cmp(&b)));
        }
        best
    }

    /// Returns the points of the lattice on the square ring of this many steps about a point.
    fn ring(&self, (row, col): Place, ring: usize) -> impl Iterator<Item = usize> + '_ {
        let (rows, cols) = (self.rows(), self.cols());
        let south = row.saturating_sub(ring);
        let north = (row + ring).min(rows - 1);
        let west = col.saturating_sub(ring);
        let east = (col + ring).min(cols - 1);
        (south..=north).flat_map(move |r| {
            let is_edge = r.abs_diff(row) == ring;
            // A row between the northern and the southern edge has only its ends on the ring.
            let ends = [(ring <= col).then(|| col - ring), (col + ring < cols && ring > 0).then_some(col + ring)];
            let whole = if is_edge { west..east + 1 } else { 0..0 };
            let ends = ends.into_iter().flatten().filter(move |_| !is_edge);
            whole.chain(ends).map(move |c| r * cols + c)
        })
    }

    /// Returns for every point whether it can be walked to from `start`, itself included.
    pub fn reachable_from(&self, start: usize) -> Vec<bool> {
        let mut reached = vec![false; self.points()];
        self.mark_part(start, &mut reached, true);
        reached
    }

    /// Marks the points that can be reached from `start`, including itself; none of them has the mark yet. Every step
    /// can be reversed, so these are all that are connected to it.
    pub fn mark_part<M: Copy + PartialEq>(&self, start: usize, marks: &mut [M], mark: M) {
        marks[start] = mark;
        let mut front = vec![start as u32];
        while let Some(point) = front.pop() {
            let point = point as usize;
            let mask = self.moves.values()[point];
            for (k, &(row_step, col_step)) in MOVES.iter().enumerate() {
                // For a step off the lattice this is no point at all, but then the mask forbids its use.
                let next = point.wrapping_add_signed(row_step * self.cols() as isize + col_step);
                if mask & (1 << k) != 0 && marks[next] != mark {
                    marks[next] = mark;
                    front.push(next as u32);
                }
            }
        }
    }

    /// Returns free points within `reach_m` of a cell's centre, inclusive, by index.
    pub fn points_of_reach(&self, cell: Cell, reach_m: f64) -> impl Iterator<Item = usize> + '_ {
        let centre = self.frame.centre(cell);
        // Points at the very edge of the reach count, whichever way their distance is rounded.
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

    /// Returns the length in metres of the step between two neighbouring points.
    pub fn step_length(&self, from: usize, to: usize) -> f64 {
        let cols = self.moves.cols();
        let is_orthogonal = from / cols == to / cols || from % cols == to % cols;
        if is_orthogonal { self.step_m } else { self.step_m * SQRT_2 }
    }

    fn neighbour(&self, point: usize, k: usize) -> Option<usize> {
        let row = point / self.moves.cols();
        let col = point % self.moves.cols();
        let row = row.checked_add_signed(MOVES[k].0).filter(|&row| row < self.moves.rows())?;
        let col = col.checked_add_signed(MOVES[k].1).filter(|&col| col < self.moves.cols())?;
        Some(row * self.moves.cols() + col)
    }
}

/// The cells, along one axis, that a span of metres overlaps: from the first, up to the one before the last; or none if
/// the span leaves the field.
#[derive(Clone, Copy, Debug)]
struct CellSpan {
    first: u32,
    /// [`Self::OUTSIDE`] if the span leaves the field.
    end: u32,
}

impl CellSpan {
    const OUTSIDE: u32 = u32::MAX;

    fn from_metres(low_m: f64, high_m: f64, cell_m: f64, cells: u16) -> Self {
        let low = low_m / cell_m + TOUCH;
        let high = high_m / cell_m - TOUCH;
        let is_inside = low >= 0.0 && high <= f64::from(cells);
        Self { first: low as u32, end: if is_inside { high.ceil() as u32 } else { Self::OUTSIDE } }
    }

    /// Returns the span from this one to one that does not begin before it.
    fn to(self, other: Self) -> Self {
        let is_inside = self.end != Self::OUTSIDE && other.end != Self::OUTSIDE;
        Self { first: self.first, end: if is_inside { other.end } else { Self::OUTSIDE } }
    }
}

/// Counts occupied cells in any box in constant time (a summed-area table: Crow, "Summed-area tables for texture mapping",
/// 1984).
struct OccupiedCount {
    /// (rows + 1) x (cols + 1): occupied cells south-west of each grid corner.
    sums: Grid<u32>,
}

impl OccupiedCount {
    fn new(occupied: &Grid<bool>) -> Self {
        let (rows, cols) = (occupied.rows(), occupied.cols());
        let mut sums = Grid::filled(rows + 1, cols + 1, 0);
        for row in 0..rows {
            let (above, here) = sums.values_mut()[row * (cols + 1)..(row + 2) * (cols + 1)].split_at_mut(cols + 1);
            let mut in_row = 0;
            for (col, &is_occupied) in occupied.row(row).iter().enumerate() {
                in_row += u32::from(is_occupied);
                here[col + 1] = above[col + 1] + in_row;
            }
        }
        Self { sums }
    }

    /// Returns whether a box lies in the field and overlaps no occupied cell.
    fn is_free(&self, across: CellSpan, along: CellSpan) -> bool {
        if across.end == CellSpan::OUTSIDE || along.end == CellSpan::OUTSIDE {
            return false;
        }
        let corner = |row: u32, col: u32| self.sums[(row as usize, col as usize)];
        let west = across.first;
        let east = across.end;
        let south = along.first;
        let north = along.end;
        corner(north, east) + corner(south, west) == corner(north, west) + corner(south, east)
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
    fn the_nearest_free_point_is_the_first_of_the_nearest_of_all() {
        for (seed, share) in [(4, 0.3), (5, 0.97), (6, 1.0)] {
            let occupied = field(seed, share);
            for (anchor, step_m) in [(DVec2::splat(2.5), 5.0), (DVec2::new(60.0, 50.0), 2.0)] {
                let lattice = WalkLattice::new(FRAME, &occupied, LatticeShape { anchor, step_m, size_m: 1.0 });
                // On points and between them, where ties are, and outside.
                for place in (0..60).flat_map(|x| (0..50).map(move |y| DVec2::new(f64::from(x), f64::from(y)) * 2.5)) {
                    let place = place - DVec2::splat(10.0);
                    let squared = |point: &usize| (lattice.position(*point) - place).length_squared();
                    let free = (0..lattice.points()).filter(|&point| lattice.is_free(point));
                    let expected = free.min_by(|a, b| squared(a).total_cmp(&squared(b)));
                    assert_eq!(lattice.nearest_free(place), expected, "{place}");
                }
            }
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
                    let a = lattice.position(point);
                    let b = lattice.position(next);
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
