use glam::DVec2;

use crate::geometry::FieldFrame;
use crate::grid::Grid;

/// Touching is not overlapping; this much of a cell absorbs rounding.
pub const TOUCH: f64 = 1e-9;

/// Occupied cells in any box in constant time (a summed-area table: Crow, "Summed-area tables for texture mapping",
/// 1984).
pub struct OccupiedCount {
    frame: FieldFrame,
    /// (rows + 1) x (cols + 1): occupied cells south-west of each grid corner.
    sums: Grid<u32>,
}

impl OccupiedCount {
    pub fn new(frame: FieldFrame, occupied: &Grid<bool>) -> Self {
        let mut sums = Grid::filled(occupied.rows() + 1, occupied.cols() + 1, 0);
        for row in 0..occupied.rows() {
            for col in 0..occupied.cols() {
                sums[(row + 1, col + 1)] =
                    u32::from(occupied[(row, col)]) + sums[(row, col + 1)] + sums[(row + 1, col)] - sums[(row, col)];
            }
        }
        Self { frame, sums }
    }

    /// Bytes that it takes on a field.
    pub fn bytes(frame: &FieldFrame) -> u64 {
        (u64::from(frame.rows) + 1) * (u64::from(frame.cols) + 1) * size_of::<u32>() as u64
    }

    /// Whether a box lies in the field and overlaps no occupied cell.
    pub fn is_free(&self, low: DVec2, high: DVec2) -> bool {
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
