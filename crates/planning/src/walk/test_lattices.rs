//! Random fields and lattices on them for the tests of the walk.

use glam::DVec2;
use rand::RngExt;

use super::{LatticeShape, WalkLattice};
use wildfire_base::geometry::FieldFrame;
use wildfire_grid::Grid;

pub const FRAME: FieldFrame = FieldFrame { cols: 24, rows: 20, cell_m: 5.0 };

/// A field on which this share of the cells is occupied.
pub fn field(seed: u64, share: f64) -> Grid<bool> {
    let mut rng = wildfire_base::rng::stream(seed, "walk test");
    let cells = (0..FRAME.cell_count()).map(|_| rng.random_bool(share)).collect();
    Grid::from_values(FRAME.rows.into(), FRAME.cols.into(), cells)
}

/// The lattice of the cells' centres.
pub fn on_cells(occupied: &Grid<bool>) -> WalkLattice {
    WalkLattice::new(FRAME, occupied, LatticeShape { anchor: DVec2::splat(2.5), step_m: 5.0, size_m: 3.0 })
}
