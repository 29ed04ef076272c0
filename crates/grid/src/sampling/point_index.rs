//! Nearest-neighbour search among points, by squares of the plane.
//!
//! Ties are decided by the smaller number of a point, whatever the squares are.

use crate::Grid;
use crate::segment::{GridPoint, UNITS};

/// Points in squares of the plane.
pub struct PointIndex {
    /// Side of a square in units.
    side: i64,
    squares: Grid<Vec<(u32, GridPoint)>>,
}

/// The number of points that a square is to hold when all have come.
const POINTS_A_SQUARE: usize = 8;

impl PointIndex {
    /// Creates an index for about `expected` points on the plane of a grid.
    pub fn new(occupied: &Grid<bool>, expected: usize) -> Self {
        let rows = occupied.rows() as i64 * UNITS;
        let cols = occupied.cols() as i64 * UNITS;
        let squares = (expected / POINTS_A_SQUARE).max(1) as i64;
        // Also where the plane is long and narrow there are no more squares than that, and one row of them.
        let side = (rows * cols / squares).isqrt().max(rows.max(cols) / squares).max(UNITS);
        Self { side, squares: Grid::filled((rows / side + 1) as usize, (cols / side + 1) as usize, Vec::new()) }
    }

    pub fn add(&mut self, number: u32, point: GridPoint) {
        let square = self.square_of(point);
        self.squares[square].push((number, point));
    }

    /// Returns the nearest point; `None` if there is none.
    pub fn nearest(&self, to: GridPoint) -> Option<u32> {
        self.nearest_of_many(to, 1, i64::MAX).first().copied()
    }

    /// Returns the `max` nearest points within a distance, whose square is given in units; nearest first.
    pub fn nearest_of_many(&self, to: GridPoint, max: usize, squared_radius: i64) -> Vec<u32> {
        let (row, col) = self.square_of(to);
        let mut found: Vec<(i64, u32)> = Vec::new();
        let mut ring = 0;
        loop {
            let mut is_outside = true;
            self.look_around(row, col, ring, &mut |points| {
                is_outside = false;
                found.extend(points.iter().map(|&(number, point)| (point.squared_units_to(to), number)));
            });
            let safe = self.room_around(to, ring);
            // What lies in rings farther out is farther than `safe`.
            if is_outside
                || safe >= squared_radius
                || found.iter().filter(|&&(square, _)| square <= safe).count() >= max
            {
                break;
            }
            ring += 1;
        }
        // The corners of a ring of squares are farther away than the radius.
        found.retain(|&(square, _)| square <= squared_radius);
        found.sort_unstable();
        found.truncate(max);
        found.into_iter().map(|(_, number)| number).collect()
    }

    /// Square of the distance within which all points lie in the rings up to this one.
    fn room_around(&self, point: GridPoint, ring: usize) -> i64 {
        let within = [point.row, point.col].map(|units| units.rem_euclid(self.side));
        let min = within.map(|units| units.min(self.side - units)).into_iter().min().unwrap_or(0);
        let room = min + ring as i64 * self.side;
        room * room
    }

    /// Hands out the points of every square of a ring that is on the plane.
    fn look_around(&self, row: usize, col: usize, ring: usize, take: &mut impl FnMut(&[(u32, GridPoint)])) {
        let top = row as i64 - ring as i64;
        let left = col as i64 - ring as i64;
        let (bottom, right) = (row + ring, col + ring);
        for row in top.max(0) as usize..=bottom.min(self.squares.rows() - 1) {
            let is_whole = row as i64 == top || row == bottom;
            if is_whole {
                for col in left.max(0) as usize..=right.min(self.squares.cols() - 1) {
                    take(&self.squares[(row, col)]);
                }
                continue;
            }
            // Between its first and its last row a ring has two squares only.
            if left >= 0 {
                take(&self.squares[(row, left as usize)]);
            }
            if right < self.squares.cols() {
                take(&self.squares[(row, right)]);
            }
        }
    }

    fn square_of(&self, point: GridPoint) -> (usize, usize) {
        ((point.row / self.side) as usize, (point.col / self.side) as usize)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::draw_point;
    use super::*;
    use wildfire_base::rng;

    #[test]
    fn nearest_points_are_those_of_brute_force() {
        let mut rng = rng::stream(1, "grid/point_index");
        for _ in 0..60 {
            let occupied = Grid::filled(rng.random_range(1..40), rng.random_range(1..40), false);
            let count = rng.random_range(0..300);
            let points: Vec<GridPoint> = (0..count).map(|_| draw_point(&occupied, &mut rng)).collect();
            let mut index = PointIndex::new(&occupied, rng.random_range(0..3000));
            (0..).zip(&points).for_each(|(number, &point)| index.add(number, point));
            for _ in 0..30 {
                let to = draw_point(&occupied, &mut rng);
                let max = rng.random_range(1..20);
                let radius = if rng.random_bool(0.5) { i64::MAX } else { (UNITS * rng.random_range(0..20)).pow(2) };
                let mut expected: Vec<_> = (0..).zip(&points).map(|(k, &at)| (at.squared_units_to(to), k)).collect();
                expected.retain(|&(square, _)| square <= radius);
                expected.sort_unstable();
                let expected: Vec<u32> = expected.into_iter().take(max).map(|(_, number)| number).collect();
                assert_eq!(index.nearest_of_many(to, max, radius), expected);
            }
        }
    }
}
