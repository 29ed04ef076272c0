//! Cells of a field, and where they lie in the world.

use std::cmp::Ordering;
use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A cell of the simulated field: column from the west edge, row from the south edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(from = "(u16, u16)", into = "(u16, u16)")]
pub struct Cell {
    pub col: u16,
    pub row: u16,
}

impl From<(u16, u16)> for Cell {
    fn from((col, row): (u16, u16)) -> Self {
        Self { col, row }
    }
}

impl From<Cell> for (u16, u16) {
    fn from(cell: Cell) -> Self {
        (cell.col, cell.row)
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", self.col, self.row)
    }
}

/// The layout of cells in the world: square cells of one size, cell (0, 0) at the south-west corner.
///
/// Indices run row by row from the south-west, `row * cols + col`, the same order as a
/// grid of `rows` by `cols` whose row 0 is the south edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldFrame {
    pub cols: u16,
    pub rows: u16,
    /// Side of a cell in metres.
    pub cell_m: f64,
}

impl FieldFrame {
    pub fn width_m(&self) -> f64 {
        f64::from(self.cols) * self.cell_m
    }

    pub fn height_m(&self) -> f64 {
        f64::from(self.rows) * self.cell_m
    }

    pub fn cell_count(&self) -> usize {
        usize::from(self.cols) * usize::from(self.rows)
    }

    pub fn index(&self, cell: Cell) -> usize {
        usize::from(cell.row) * usize::from(self.cols) + usize::from(cell.col)
    }

    /// The cell of an index below [`FieldFrame::cell_count`].
    pub fn cell(&self, index: usize) -> Cell {
        let cols = usize::from(self.cols);
        Cell { col: (index % cols) as u16, row: (index / cols) as u16 }
    }

    pub fn centre(&self, cell: Cell) -> DVec2 {
        DVec2::new((f64::from(cell.col) + 0.5) * self.cell_m, (f64::from(cell.row) + 0.5) * self.cell_m)
    }

    /// Compares cells by how near their centres are to a place, in metres.
    pub fn by_distance(&self, place: DVec2) -> impl Fn(&Cell, &Cell) -> Ordering {
        let squared_m = move |cell: &Cell| (self.centre(*cell) - place).length_squared();
        move |a, b| squared_m(a).total_cmp(&squared_m(b))
    }

    /// The cell that holds a point; `None` outside the field. A shared edge belongs to the cell in the north or east.
    pub fn cell_at(&self, point: DVec2) -> Option<Cell> {
        // The cast alone would put points just west or south of the field into its first column or row.
        let col = (point.x / self.cell_m).floor();
        let row = (point.y / self.cell_m).floor();
        let inside = col >= 0.0 && row >= 0.0 && col < f64::from(self.cols) && row < f64::from(self.rows);
        inside.then_some(Cell { col: col as u16, row: row as u16 })
    }

    /// The cell at an offset, if it lies in the field.
    pub fn offset(&self, cell: Cell, cols: i32, rows: i32) -> Option<Cell> {
        let col = i32::from(cell.col) + cols;
        let row = i32::from(cell.row) + rows;
        let inside = col >= 0 && row >= 0 && col < i32::from(self.cols) && row < i32::from(self.rows);
        inside.then_some(Cell { col: col as u16, row: row as u16 })
    }

    /// Distance in metres from a point to the border, negative outside.
    pub fn border_distance(&self, point: DVec2) -> f64 {
        point.x.min(point.y).min(self.width_m() - point.x).min(self.height_m() - point.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_cells_and_points_agree() {
        let frame = FieldFrame { cols: 7, rows: 4, cell_m: 5.0 };
        for index in 0..frame.cell_count() {
            let cell = frame.cell(index);
            assert_eq!(frame.index(cell), index);
            assert_eq!(frame.cell_at(frame.centre(cell)), Some(cell));
        }
        assert_eq!(frame.cell_at(DVec2::new(35.0, 1.0)), None);
        assert_eq!(frame.cell_at(DVec2::new(-0.1, 1.0)), None);
        assert_eq!(frame.cell_at(DVec2::new(5.0, 5.0)), Some(Cell { col: 1, row: 1 }));
        assert_eq!(frame.offset(Cell { col: 0, row: 0 }, -1, 0), None);
    }
}
