//! Straight segments across cells: tests in exact integers whether all cells along them are free.
//!
//! A segment is followed from cell to cell (J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
//! Eurographics 1987). Which line between cells it crosses next is a comparison of two fractions, made exactly by
//! multiplying across, so that a segment through a corner is known as one.

use std::cmp::Ordering;

use crate::{CornerCutting, Grid, Place};

/// The number of units per side of a cell.
pub const UNITS: i64 = 1024;

/// A point of the plane of a grid, inside a cell and never on a line between cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridPoint {
    /// [`UNITS`] from the outer edge of row 0, and of column 0.
    pub(crate) row: i64,
    pub(crate) col: i64,
}

impl GridPoint {
    /// Returns the centre of a cell.
    pub fn centre((row, col): Place) -> Self {
        Self { row: row as i64 * UNITS + UNITS / 2, col: col as i64 * UNITS + UNITS / 2 }
    }

    /// Creates a point from [`UNITS`] to the outer edges of row 0 and column 0; a point on a line is moved off it by
    /// one unit.
    pub fn from_units(row: i64, col: i64) -> Self {
        Self { row: off_line(row), col: off_line(col) }
    }

    /// Returns the cell that contains the point.
    pub fn cell(self) -> Place {
        ((self.row / UNITS) as usize, (self.col / UNITS) as usize)
    }

    /// Returns row and column in cells, integers at the centres of cells.
    pub fn coordinates(self) -> (f64, f64) {
        let cells = |units: i64| (units - UNITS / 2) as f64 / UNITS as f64;
        (cells(self.row), cells(self.col))
    }

    /// Returns the square of the Euclidean distance in units.
    pub fn squared_units_to(self, other: Self) -> i64 {
        let rows = self.row - other.row;
        let cols = self.col - other.col;
        rows * rows + cols * cols
    }

    /// Returns the Euclidean distance in cells.
    pub fn distance(self, other: Self) -> f64 {
        (self.squared_units_to(other) as f64).sqrt() / UNITS as f64
    }
}

/// Moves what lies on a line between cells off it.
fn off_line(units: i64) -> i64 {
    units + i64::from(units.rem_euclid(UNITS) == 0)
}

/// Returns whether all cells that a segment enters are free.
///
/// A segment that passes through a corner exactly enters neither cell beside it; where [`CornerCutting::Forbidden`], both
/// must be free all the same, so that the segment touches no occupied cell, not even at its edge.
///
/// # Panics
/// If an end lies outside the grid.
pub fn is_free_segment(occupied: &Grid<bool>, from: GridPoint, to: GridPoint, corners: CornerCutting) -> bool {
    let rows = to.row - from.row;
    let cols = to.col - from.col;
    let mut to_row_line = gap(from.row, rows);
    let mut to_col_line = gap(from.col, cols);
    let (mut here, end) = (from.cell(), to.cell());
    if occupied[here] {
        return false;
    }
    while here != end {
        // May wrap around at the border, but then the segment ends before it would enter that cell.
        let next_row = here.0.wrapping_add_signed(rows.signum() as isize);
        let next_col = here.1.wrapping_add_signed(cols.signum() as isize);
        // The line at the smaller share of the way comes first, `to_row_line / |rows|` or `to_col_line / |cols|`.
        match (to_row_line * cols.abs()).cmp(&(to_col_line * rows.abs())) {
            Ordering::Less => {
                here.0 = next_row;
                to_row_line += UNITS;
            }
            Ordering::Greater => {
                here.1 = next_col;
                to_col_line += UNITS;
            }
            Ordering::Equal => {
                let is_narrow = occupied[(next_row, here.1)] || occupied[(here.0, next_col)];
                if is_narrow && corners == CornerCutting::Forbidden {
                    return false;
                }
                here = (next_row, next_col);
                to_row_line += UNITS;
                to_col_line += UNITS;
            }
        }
        if occupied[here] {
            return false;
        }
    }
    true
}

/// Returns the units to the next line between cells on a way.
fn gap(at: i64, way: i64) -> i64 {
    if way > 0 { UNITS - at.rem_euclid(UNITS) } else { at.rem_euclid(UNITS) }
}

/// Returns the length of a line through the centres of cells.
pub fn line_length(cells: &[Place]) -> f64 {
    cells.windows(2).map(|pair| GridPoint::centre(pair[0]).distance(GridPoint::centre(pair[1]))).sum()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::drawn;
    use wildfire_base::rng;

    /// Whether a segment has points in common with a square, the open one or the closed one, by the separating axes of
    /// both, in whole numbers.
    fn meets(from: GridPoint, to: GridPoint, (row, col): Place, closed: bool) -> bool {
        let top = row as i64 * UNITS;
        let left = col as i64 * UNITS;
        let apart = |low: i64, high: i64, first: i64, second: i64| {
            if closed {
                first.max(second) < low || first.min(second) > high
            } else {
                first.max(second) <= low || first.min(second) >= high
            }
        };
        let rows = to.row - from.row;
        let cols = to.col - from.col;
        let side = |row: i64, col: i64| rows * (col - from.col) - cols * (row - from.row);
        let corners = [(0, 0), (0, UNITS), (UNITS, 0), (UNITS, UNITS)].map(|(r, c)| side(top + r, left + c));
        let min = corners.iter().min().unwrap();
        let max = corners.iter().max().unwrap();
        let is_beside = if closed { *min > 0 || *max < 0 } else { *min >= 0 || *max <= 0 };
        let is_point = from == to;
        !apart(top, top + UNITS, from.row, to.row)
            && !apart(left, left + UNITS, from.col, to.col)
            && (is_point || !is_beside)
    }

    #[test]
    fn segments_are_free_if_no_occupied_square_is_met() {
        let mut rng = rng::stream(1, "grid/segment");
        let mut free = 0;
        for _ in 0..4000 {
            let rows = rng.random_range(1..9);
            let cols = rng.random_range(1..9);
            let occupied = drawn::random(rows, cols, 0.15, &mut rng);
            let on_lattice = rng.random_bool(0.5);
            let mut point = || {
                let place = (rng.random_range(0..rows), rng.random_range(0..cols));
                let units = |side: usize, draw: i64| draw % (side as i64 * UNITS);
                let draws = (rng.random_range(0..i64::MAX), rng.random_range(0..i64::MAX));
                let any = GridPoint::from_units(units(rows, draws.0), units(cols, draws.1));
                if on_lattice { GridPoint::centre(place) } else { any }
            };
            let (from, to) = (point(), point());
            for (corners, closed) in [(CornerCutting::Allowed, false), (CornerCutting::Forbidden, true)] {
                let mut places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
                let expected = !places.any(|place| occupied[place] && meets(from, to, place, closed));
                assert_eq!(is_free_segment(&occupied, from, to, corners), expected, "{from:?} {to:?} {occupied:?}");
                assert_eq!(is_free_segment(&occupied, to, from, corners), expected, "the other way");
                free += u32::from(expected);
            }
        }
        assert!((1000..7000).contains(&free), "{free} of 8000 segments are free");
    }

    #[test]
    fn points_lie_in_their_cells_and_have_coordinates_of_centres() {
        assert_eq!(GridPoint::centre((3, 17)).coordinates(), (3.0, 17.0));
        assert_eq!(GridPoint::from_units(2 * UNITS, 0).cell(), (2, 0));
        assert_eq!(line_length(&[(0, 0), (3, 4), (3, 5)]), 6.0);
    }
}
