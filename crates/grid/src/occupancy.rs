//! Occupancy: which cells are occupied.

use super::Grid;

/// Marks cells as occupied whose grey value (0 black to 255 white) is at most `tolerance`.
pub fn from_grey(grey: &Grid<u8>, tolerance: u8) -> Grid<bool> {
    let occupied = grey.values().iter().map(|&value| value <= tolerance).collect();
    Grid::from_values(grey.rows(), grey.cols(), occupied)
}

/// Frees the first and the last `width` rows and columns; in a map of few rows or columns, all cells.
pub fn remove_edges(occupied: &mut Grid<bool>, width: usize) {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let edge = width.min(cols);
    for row in 0..rows {
        let cells = occupied.row_mut(row);
        if row < width || rows - row <= width {
            cells.fill(false);
        } else {
            cells[..edge].fill(false);
            cells[cols - edge..].fill(false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_of_the_tolerance_itself_is_occupied() {
        let grey = Grid::from_values(1, 5, vec![0, 49, 50, 51, 255]);
        assert_eq!(from_grey(&grey, 50).values(), [true, true, true, false, false]);
        assert_eq!(from_grey(&grey, 255), Grid::filled(1, 5, true));
    }

    #[test]
    fn edges_are_removed_from_maps_that_are_not_square_too() {
        for (rows, cols) in [(1, 1), (1, 7), (7, 1), (4, 9), (9, 4), (5, 5)] {
            for width in [0, 1, 2, 3, 8, usize::MAX] {
                let mut occupied = Grid::filled(rows, cols, true);
                remove_edges(&mut occupied, width);
                for row in 0..rows {
                    for col in 0..cols {
                        let from_edge = row.min(col).min(rows - 1 - row).min(cols - 1 - col);
                        assert_eq!(occupied[(row, col)], from_edge >= width, "{rows} x {cols}, {width}");
                    }
                }
            }
        }
    }
}
