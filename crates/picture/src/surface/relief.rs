//! A map as tiles with levels.

use crate::marks::to_f32;
use crate::scene::MapScene;
use crate::surface::camera::GROUND;
use crate::values::ValueScale;
use crate::zoom::{BlockFace, DrawnBlock, Zoom};
use wildfire_grid::{Grid, Place};

/// The most tiles along a side; larger maps are drawn with tiles of several cells.
const MAX_TILES: usize = 256;

/// Tiles of one cell or a square of cells. Tiles with values join into a smooth surface; obstacles and tiles without
/// value lie flat at their own level, with steep sides.
pub struct Relief {
    pub tiles: Grid<Tile>,
    /// Levels of the surface where the corners of tiles meet.
    corners: Grid<f32>,
    cells: usize,
    /// Rows and columns of the map.
    size: (usize, usize),
}

/// A square of the map and its level, 0 to 1 from the lowest value to the highest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    pub face: BlockFace,
    pub level: f32,
}

/// Levels of a tile's corners, in the order NW, NE, SE, SW.
pub type Corners = [f32; 4];

impl Relief {
    /// `heights` spans the values of all cells, obstacles included.
    pub fn new(scene: &MapScene, heights: Option<&ValueScale>) -> Self {
        let size = (scene.occupied.rows(), scene.occupied.cols());
        let cells = size.0.max(size.1).div_ceil(MAX_TILES).max(1);
        let zoom = Zoom { cells, pixels: 1 };
        let rows = zoom.blocks(size.0);
        let cols = zoom.blocks(size.1);
        let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
        let tiles = places.map(|(row, col)| Tile::new(scene, &zoom.block(row, col, size), heights)).collect();
        let tiles = Grid::from_values(rows, cols, tiles);
        let corners = (0..=rows).flat_map(|row| (0..=cols).map(move |col| (row, col)));
        let corners = corners.map(|corner| corner_level(&tiles, corner)).collect();
        Self { corners: Grid::from_values(rows + 1, cols + 1, corners), tiles, cells, size }
    }

    pub fn corners(&self, (row, col): Place) -> Corners {
        let tile = self.tiles[(row, col)];
        match tile.face {
            BlockFace::Value(_) => {
                [(row, col), (row, col + 1), (row + 1, col + 1), (row + 1, col)].map(|at| self.corners[at])
            }
            BlockFace::Obstacle | BlockFace::WithoutValue => [tile.level; 4],
        }
    }

    /// Returns where the boundary before a row or column of tiles lies, 0 to 1.
    pub fn row_edge(&self, row: usize) -> f32 {
        (row * self.cells).min(self.size.0) as f32 / self.size.0 as f32
    }

    pub fn col_edge(&self, col: usize) -> f32 {
        (col * self.cells).min(self.size.1) as f32 / self.size.1 as f32
    }

    /// Returns where the centre of a cell lies, 0 to 1 along columns and rows.
    pub fn centre(&self, (row, col): Place) -> (f32, f32) {
        ((col as f32 + 0.5) / self.size.1 as f32, (row as f32 + 0.5) / self.size.0 as f32)
    }

    /// The level of the surface at a place of the map, 0 to 1 along columns and rows.
    pub fn level_at(&self, x: f32, y: f32) -> f32 {
        let ((row, down), (col, right)) = self.tile_at(x, y);
        let [nw, ne, se, sw] = self.corners((row, col));
        let north = nw + (ne - nw) * right;
        let south = sw + (se - sw) * right;
        north + (south - north) * down
    }

    pub fn face_at(&self, x: f32, y: f32) -> BlockFace {
        let ((row, _), (col, _)) = self.tile_at(x, y);
        self.tiles[(row, col)].face
    }

    /// Row and column of a tile, each with how far into it the place is, 0 to 1.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place on the map is in its tiles")]
    fn tile_at(&self, x: f32, y: f32) -> ((usize, f32), (usize, f32)) {
        let along = |share: f32, cells: usize, tiles: usize| {
            let tile = (share * cells as f32 / self.cells as f32).max(0.0);
            let index = (tile as usize).min(tiles - 1);
            (index, (tile - index as f32).min(1.0))
        };
        (along(y, self.size.0, self.tiles.rows()), along(x, self.size.1, self.tiles.cols()))
    }
}

impl Tile {
    /// An obstacle where at least half of the cells are, else the mean of the free cells' finite values.
    fn new(scene: &MapScene, block: &DrawnBlock, heights: Option<&ValueScale>) -> Self {
        let (mut cells, mut obstacles) = (0, 0);
        let mut free = Mean::default();
        let mut occupied = Mean::default();
        for place in block.places() {
            cells += 1;
            obstacles += usize::from(scene.occupied[place]);
            let mean = if scene.occupied[place] { &mut occupied } else { &mut free };
            if let Some((value, heights)) = scene.value_at(place).zip(heights) {
                // An infinite value is taken as the highest, so a wall of it has a height.
                mean.add(value.clamp(heights.low, heights.high));
            }
        }
        let level = |mean: Mean| heights.and_then(|heights| Some(to_f32(heights.fraction(mean.value()?))));
        let is_obstacle = 2 * obstacles >= cells;
        let face = match free.value() {
            _ if is_obstacle => BlockFace::Obstacle,
            Some(value) => BlockFace::Value(value),
            None => BlockFace::WithoutValue,
        };
        Self { face, level: level(if is_obstacle { occupied } else { free }).unwrap_or(GROUND) }
    }
}

#[derive(Clone, Copy, Default)]
struct Mean {
    value: f64,
    count: f64,
}

impl Mean {
    /// Moves the mean towards the value, since the sum of values may be too large for a number.
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.value += value / self.count - self.value / self.count;
    }

    fn value(self) -> Option<f64> {
        (self.count > 0.0).then_some(self.value)
    }
}

/// The mean level of the tiles with values that meet in a corner.
fn corner_level(tiles: &Grid<Tile>, (row, col): Place) -> f32 {
    let around = [
        (row.wrapping_sub(1), col.wrapping_sub(1)),
        (row.wrapping_sub(1), col),
        (row, col.wrapping_sub(1)),
        (row, col),
    ];
    let levels = around.into_iter().filter_map(|(row, col)| tiles.get(row, col));
    let levels = levels.filter(|tile| matches!(tile.face, BlockFace::Value(_))).map(|tile| tile.level);
    let (sum, count) = levels.fold((0.0, 0.0), |(sum, count), level| (sum + level, count + 1.0));
    if count > 0.0 { sum / count } else { GROUND }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::ColourMap;

    #[test]
    fn large_maps_are_sampled_and_keep_their_edges() {
        let occupied = Grid::filled(600, 3, false);
        let value = |(row, _): Place| Some(row as f64);
        let heights = ValueScale::from_values([0.0, 599.0].into_iter(), ColourMap::Viridis);
        let relief = Relief::new(&MapScene::new("", "", &occupied, &value), heights.as_ref());
        assert_eq!((relief.tiles.rows(), relief.tiles.cols()), (200, 1));
        assert_eq!((relief.row_edge(200), relief.col_edge(1)), (1.0, 1.0));
        assert!((relief.level_at(0.5, 0.5) - 0.5).abs() < 0.01);
    }

    #[test]
    fn obstacles_stand_at_their_value_or_on_the_ground() {
        let occupied = Grid::from_values(1, 4, vec![true, false, true, true]);
        let value = |(_, col): Place| [Some(8.0), Some(0.0), None, Some(f64::INFINITY)][col];
        let scene = MapScene::new("", "", &occupied, &value);
        let heights = ValueScale::from_values([0.0, 8.0].into_iter(), ColourMap::Viridis);
        let relief = Relief::new(&scene, heights.as_ref());
        assert_eq!(relief.tiles.values().iter().map(|tile| tile.level).collect::<Vec<_>>(), [1.0, 0.0, GROUND, 1.0]);
        assert_eq!(relief.corners((0, 1)), [0.0; 4], "obstacles do not lift the surface beside them");
    }

    #[test]
    fn means_of_huge_values_stay_finite() {
        let mut mean = Mean::default();
        [f64::MAX, f64::MAX, -f64::MAX].into_iter().for_each(|value| mean.add(value));
        assert!(mean.value().is_some_and(|value| value.is_finite() && value > 0.0));
    }
}
