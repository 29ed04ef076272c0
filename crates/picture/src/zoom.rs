//! The number of pixels per cell, or of cells per pixel: always an integer, so that cells are squares of one size.

use std::ops::Range;

use crate::scene::MapScene;
use wildfire_grid::Place;

/// The approximate length in pixels at which the longer side of a small map is drawn.
const USUAL_SIDE: usize = 800;
/// The longest side of a map drawn, in pixels.
pub const LONGEST_SIDE: usize = 4096;

/// Blocks of `cells` by `cells` cells are drawn as squares of `pixels` by `pixels` pixels; one of the two is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Zoom {
    pub cells: usize,
    pub pixels: usize,
}

/// The cells that are drawn as one square.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnBlock {
    pub rows: Range<usize>,
    pub cols: Range<usize>,
}

/// The drawn face of a block of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockFace {
    Obstacle,
    Value(f64),
    /// Free, but without a value.
    WithoutValue,
}

impl Zoom {
    /// Up by a whole factor to sides of about 800 pixels, down by a whole factor to 4096.
    pub fn fit(rows: usize, cols: usize) -> Self {
        Self::fit_to(rows, cols, USUAL_SIDE, LONGEST_SIDE)
    }

    /// Up by a whole factor to sides of about 480 pixels, down by a whole factor to 1000.
    pub fn small(rows: usize, cols: usize) -> Self {
        Self::fit_to(rows, cols, 480, 1000)
    }

    /// Up by a whole factor to sides of about `usual` pixels, down by a whole factor to `longest`.
    pub fn fit_to(rows: usize, cols: usize, usual: usize, longest: usize) -> Self {
        let longer = rows.max(cols).max(1);
        if longer > longest {
            return Self { cells: longer.div_ceil(longest), pixels: 1 };
        }
        Self { cells: 1, pixels: ((usual + longer / 2) / longer).max(1) }
    }

    /// Returns the row or column in the middle of a block, of `end` of them.
    pub fn middle(self, index: usize, end: usize) -> usize {
        (index * self.cells + self.cells / 2).min(end - 1)
    }

    pub fn blocks(self, cells: usize) -> usize {
        cells.div_ceil(self.cells)
    }

    /// Returns how many pixels a side of that many cells takes.
    pub fn length(self, cells: usize) -> usize {
        self.blocks(cells) * self.pixels
    }

    /// Returns how many pixels a cell takes; less than 1 in maps drawn smaller.
    pub fn cell(self) -> f32 {
        self.pixels as f32 / self.cells as f32
    }

    /// Returns where the centre of a row or column lies, in pixels from the map's edge.
    pub fn centre(self, index: usize) -> f32 {
        (index as f32 + 0.5) * self.cell()
    }

    pub fn block(self, row: usize, col: usize, (rows, cols): (usize, usize)) -> DrawnBlock {
        let range = |index: usize, end: usize| index * self.cells..((index + 1) * self.cells).min(end);
        DrawnBlock { rows: range(row, rows), cols: range(col, cols) }
    }
}

impl DrawnBlock {
    pub fn places(&self) -> impl Iterator<Item = Place> {
        self.rows.clone().flat_map(|row| self.cols.clone().map(move |col| (row, col)))
    }

    /// An obstacle if any cell is one, so that no wall is lost; else the highest value; without value if no cell has
    /// one.
    pub fn face(&self, scene: &MapScene) -> BlockFace {
        let mut highest = None;
        for place in self.places() {
            if scene.occupied[place] {
                return BlockFace::Obstacle;
            }
            let value = scene.value_at(place);
            highest = if value > highest { value } else { highest };
        }
        highest.map_or(BlockFace::WithoutValue, BlockFace::Value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_grid::Grid;

    #[test]
    fn small_maps_are_drawn_at_a_readable_size() {
        assert_eq!(Zoom::fit(14, 20), Zoom { cells: 1, pixels: 40 });
        assert_eq!(Zoom::fit(1, 1), Zoom { cells: 1, pixels: 800 });
        for side in 1..=LONGEST_SIDE {
            let drawn = Zoom::fit(side, 1).length(side);
            assert!((534..=1066).contains(&drawn) || (side > 533 && drawn == side), "{side} is drawn as {drawn}");
        }
    }

    #[test]
    fn large_maps_fit_the_longest_side() {
        for side in [4097, 8192, 8193, 32_767] {
            let zoom = Zoom::fit(3, side);
            assert!(zoom.length(side) <= LONGEST_SIDE && zoom.pixels == 1 && zoom.cells > 1);
        }
    }

    #[test]
    fn blocks_cover_every_cell_once() {
        let zoom = Zoom { cells: 3, pixels: 1 };
        let mut seen = Grid::filled(7, 5, 0);
        for row in 0..zoom.blocks(7) {
            for col in 0..zoom.blocks(5) {
                zoom.block(row, col, (7, 5)).places().for_each(|place| seen[place] += 1);
            }
        }
        assert!(seen.values().iter().all(|&times| times == 1));
    }

    #[test]
    fn blocks_show_obstacles_before_values_and_the_highest_of_these() {
        let occupied = Grid::from_values(1, 6, vec![false, false, false, true, false, false]);
        let value = |(_, col): Place| [Some(2.0), Some(5.0), Some(9.0), None, None, None][col];
        let scene = MapScene::new("", "", &occupied, &value);
        let zoom = Zoom { cells: 2, pixels: 1 };
        let faces: Vec<_> = (0..3).map(|col| zoom.block(0, col, (1, 6)).face(&scene)).collect();
        assert_eq!(faces, [BlockFace::Value(5.0), BlockFace::Obstacle, BlockFace::WithoutValue]);
    }
}
