//! The generated or given field of one run.
//!
//! Pieces are laid one by one. Each is drawn from the placements still legal: first a shape, uniformly among the shapes
//! of the list that still fit somewhere, then one of that shape's legal placements, uniformly over rotations and
//! places. So every shape is as likely as any other, however many rotations it has.
//!
//! A placement is drawn by rejection, which is uniform over the legal ones by construction and takes a few tries on a
//! field of usual coverage. After as many misses as the field has cells the legal placements are listed instead.

use std::sync::Arc;

use glam::DVec2;
use rand::{Rng, RngExt};
use thiserror::Error;

use super::landscape::{Ground, NoRiver, cover, ground, is_bare};
use super::tetromino::{Piece, extent};
use crate::{Overlaps, Scenario, Shape};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::rng;
use wildfire_fire::Landscape;
use wildfire_grid::Grid;

/// A field with its bushes.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    pub frame: FieldFrame,
    /// True where neither truck nor Wumpus can be: a value per cell, row 0 at the south edge.
    pub occupied: Grid<bool>,
    /// The cells with a bush by index, all of them occupied.
    pub bushes: Vec<Cell>,
    /// The occupied cells without a bush by index.
    pub blocked: Vec<Cell>,
    /// What burns between the bushes; `None` where nothing does.
    pub landscape: Option<Arc<Landscape>>,
    /// The number of the piece of each bush, where fire takes whole pieces; else nothing.
    pub pieces: Vec<u32>,
}

/// The reason why a run has no field.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TerrainError {
    #[error("no placement left for piece {piece} of {wanted}")]
    NoPlacementLeft { piece: u32, wanted: u32 },
    #[error("no place for the river at least `start_clearance_m` away from every start")]
    NoRiver,
}

impl Terrain {
    /// Makes a field on which all occupied cells are bushes, and nothing else burns.
    pub fn from_occupied(frame: FieldFrame, occupied: Grid<bool>) -> Self {
        let cells = occupied.values().iter().enumerate();
        let bushes = cells.filter(|(_, occupied)| **occupied).map(|(index, _)| frame.cell(index)).collect();
        Self { frame, occupied, bushes, blocked: Vec::new(), landscape: None, pieces: Vec::new() }
    }

    /// Iterates by index over the cells whose fuel burns, those with a bush and those without.
    pub fn with_fuel(&self) -> impl Iterator<Item = Cell> + '_ {
        self.landscape.iter().flat_map(|landscape| {
            let burns = landscape.burning_numbers();
            let fuels = landscape.fuel.iter().enumerate().filter(move |&(_, &fuel)| burns[usize::from(fuel)]);
            fuels.map(|(index, _)| self.frame.cell(index))
        })
    }

    /// Returns what Wumpuses and random ignitions may light, by index: the bushes, and all that burns if `ground` may be lit.
    pub fn lightable(&self, ground: bool) -> Vec<Cell> {
        if ground && self.landscape.is_some() { self.with_fuel().collect() } else { self.bushes.clone() }
    }

    /// Returns the field of the run with this seed: the given one, or pieces drawn from the stream `terrain`, which keep off
    /// water and roads.
    ///
    /// # Errors
    /// Fails if some piece of a generated field has no legal placement left, or a generated river no place.
    pub fn from_scenario(scenario: &Scenario, seed: u64) -> Result<Self, TerrainError> {
        let seed = scenario.landscape.as_ref().and_then(|landscape| landscape.seed).unwrap_or(seed);
        let cover = cover(scenario, seed, &scenario.field.frame()).map_err(|NoRiver| TerrainError::NoRiver)?;
        let bushes = Self::bushes_of(scenario, seed, cover.as_deref().unwrap_or_default())?;
        let Some(cover) = cover else { return Ok(bushes) };
        let Ground { landscape, blocked } = ground(scenario, seed, bushes.frame, cover, &bushes.occupied);
        let mut occupied = bushes.occupied;
        for cell in &blocked {
            occupied[(cell.row.into(), cell.col.into())] = true;
        }
        Ok(Self { occupied, blocked, landscape: Some(Arc::new(landscape)), ..bushes })
    }

    fn bushes_of(scenario: &Scenario, seed: u64, cover: &[u8]) -> Result<Self, TerrainError> {
        if let Some(imported) = &scenario.field.imported {
            let terrain = Self::from_occupied(imported.frame, imported.occupied.clone());
            let pieces = if scenario.fire.takes_pieces() { joined_along_sides(&terrain) } else { Vec::new() };
            return Ok(Self { pieces, ..terrain });
        }
        let field = &scenario.field;
        let mut layout = PieceLayout::new(field.frame(), field.overlaps);
        // A bush on a road would close it, and none grows on water.
        for (closed, &fuel) in layout.closed.values_mut().iter_mut().zip(cover) {
            *closed = is_bare(fuel);
        }
        for centre in scenario.start_centres() {
            layout.keep_free(centre, field.start_clearance_m);
        }
        // Another name of the stream would change the field of every seed.
        layout.fill(field.shapes.clone(), field.wanted_pieces(), &mut rng::stream(seed, "terrain"))?;
        let terrain = Self::from_occupied(field.frame(), layout.occupied);
        let mut pieces = Vec::new();
        // Only fire that takes whole pieces asks for them.
        if scenario.fire.takes_pieces() {
            pieces.extend(terrain.bushes.iter().map(|bush| layout.pieces[(bush.row.into(), bush.col.into())]));
        }
        Ok(Self { pieces, ..terrain })
    }
}

/// Numbers bushes by the group that they join along sides, in the order of the first bush of each.
fn joined_along_sides(terrain: &Terrain) -> Vec<u32> {
    let frame = terrain.frame;
    let mut pieces: Vec<Option<u32>> = vec![None; terrain.bushes.len()];
    let mut count = 0;
    for first in 0..terrain.bushes.len() {
        if pieces[first].is_some() {
            continue;
        }
        pieces[first] = Some(count);
        let mut front = vec![first];
        while let Some(bush) = front.pop() {
            let sides = [(1, 0), (-1, 0), (0, 1), (0, -1)];
            for (cols, rows) in sides {
                let beside = frame.offset(terrain.bushes[bush], cols, rows).map(|cell| frame.index(cell));
                // Bushes are in the order of their index, so a neighbour is found without a second grid.
                let next = beside.map(|cell| terrain.bushes.binary_search_by_key(&cell, |&bush| frame.index(bush)));
                if let Some(Ok(next)) = next
                    && pieces[next].is_none()
                {
                    pieces[next] = Some(count);
                    front.push(next);
                }
            }
        }
        count += 1;
    }
    // Every bush has a number by now, so that none is dropped.
    pieces.into_iter().flatten().collect()
}

/// A field while pieces are being laid.
struct PieceLayout {
    frame: FieldFrame,
    overlaps: Overlaps,
    occupied: Grid<bool>,
    /// Cells that no further piece may cover.
    closed: Grid<bool>,
    /// The number of the piece on each occupied cell, the first where several overlap.
    pieces: Grid<u32>,
}

impl PieceLayout {
    fn new(frame: FieldFrame, overlaps: Overlaps) -> Self {
        let open = Grid::filled(frame.rows.into(), frame.cols.into(), false);
        let pieces = Grid::filled(frame.rows.into(), frame.cols.into(), 0);
        Self { frame, overlaps, occupied: open.clone(), closed: open, pieces }
    }

    /// Closes the cells whose squares come within `clearance_m` of a point, inclusive.
    fn keep_free(&mut self, centre: DVec2, clearance_m: f64) {
        let cell_m = self.frame.cell_m;
        let index = |m: f64, cells: u16| (m / cell_m).floor().clamp(0.0, f64::from(cells) - 1.0) as u16;
        // A cell to the west or south may touch the box with its far edge.
        let low = centre - clearance_m - cell_m;
        let high = centre + clearance_m;
        for row in index(low.y, self.frame.rows)..=index(high.y, self.frame.rows) {
            for col in index(low.x, self.frame.cols)..=index(high.x, self.frame.cols) {
                let offset = (centre - self.frame.centre(Cell { col, row })).abs() - DVec2::splat(0.5 * cell_m);
                if offset.max(DVec2::ZERO).length_squared() <= clearance_m * clearance_m {
                    self.closed[(row.into(), col.into())] = true;
                }
            }
        }
    }

    fn fill(&mut self, mut shapes: Vec<Shape>, wanted: u32, rng: &mut impl Rng) -> Result<(), TerrainError> {
        for piece in 1..=wanted {
            let (rotation, corner) =
                self.draw(&mut shapes, rng).ok_or(TerrainError::NoPlacementLeft { piece, wanted })?;
            self.lay(rotation, corner, piece);
        }
        Ok(())
    }

    /// Draws a legal placement. Shapes without one leave the list: cells only ever close, so they cannot fit again.
    fn draw(&self, shapes: &mut Vec<Shape>, rng: &mut impl Rng) -> Option<(&'static Piece, Cell)> {
        while !shapes.is_empty() {
            let index = rng.random_range(0..shapes.len() as u32) as usize;
            if let Some(placement) = self.draw_placement(shapes[index].rotations(), rng) {
                return Some(placement);
            }
            shapes.remove(index);
        }
        None
    }

    fn draw_placement(&self, rotations: &'static [Piece], rng: &mut impl Rng) -> Option<(&'static Piece, Cell)> {
        // Guessing is quick while the field is open. Both ways draw all legal placements with the same chance.
        for _ in 0..self.frame.cell_count() {
            let rotation = &rotations[rng.random_range(0..rotations.len() as u32) as usize];
            let corner = Cell { col: rng.random_range(0..self.frame.cols), row: rng.random_range(0..self.frame.rows) };
            if self.is_legal(rotation, corner) {
                return Some((rotation, corner));
            }
        }
        let corners = (0..self.frame.cell_count()).map(|index| self.frame.cell(index));
        let placements = corners.flat_map(|corner| rotations.iter().map(move |rotation| (rotation, corner)));
        // Counted first and found afterwards: a list of all of them would take more memory than the rest of a large field.
        let legal = || placements.clone().filter(|(rotation, corner)| self.is_legal(rotation, *corner));
        let count = legal().count() as u32;
        if count == 0 { None } else { legal().nth(rng.random_range(0..count) as usize) }
    }

    fn is_legal(&self, piece: &Piece, corner: Cell) -> bool {
        let (cols, rows) = extent(piece);
        corner.col + cols <= self.frame.cols
            && corner.row + rows <= self.frame.rows
            && piece.iter().all(|&(col, row)| !self.closed[((corner.row + row).into(), (corner.col + col).into())])
    }

    fn lay(&mut self, piece: &Piece, corner: Cell, number: u32) {
        for &(col, row) in piece {
            let cell = ((corner.row + row).into(), (corner.col + col).into());
            if !self.occupied[cell] {
                self.pieces[cell] = number;
            }
            self.occupied[cell] = true;
            self.closed[cell] |= self.overlaps == Overlaps::Never;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Field, ImportedField, Unimog};

    fn scenario(field: Field) -> Scenario {
        Scenario { name: "test".into(), field, ..Scenario::default() }
    }

    fn bare(cells: u16) -> PieceLayout {
        PieceLayout::new(FieldFrame { cols: cells, rows: cells, cell_m: 5.0 }, Overlaps::Never)
    }

    #[test]
    fn pieces_never_overlap_at_any_coverage() {
        for percent in [5, 10, 20, 30, 40] {
            let field = Field { coverage: f64::from(percent) / 100.0, ..Field::default() };
            let wanted = field.wanted_pieces() as usize;
            let scenario = scenario(field);
            for seed in 0..10 {
                assert_eq!(Terrain::from_scenario(&scenario, seed).unwrap().bushes.len(), 4 * wanted);
            }
        }
    }

    #[test]
    fn bushes_keep_away_from_every_start() {
        let mut scenario = scenario(Field { coverage: 0.4, ..Field::default() });
        scenario
            .unimog
            .push(Unimog { start: crate::StartPose { x_m: 3.0, y_m: 120.0, heading_deg: 90.0 }, ..Unimog::default() });
        for overlaps in [Overlaps::Never, Overlaps::Dropped] {
            scenario.field.overlaps = overlaps;
            for seed in 0..20 {
                let terrain = Terrain::from_scenario(&scenario, seed).unwrap();
                for start in [(202.5, 202.5), (51.5, 50.0), (3.0, 121.5)] {
                    for &bush in &terrain.bushes {
                        let low = terrain.frame.centre(bush) - 2.5;
                        let nearest = DVec2::from(start).clamp(low, low + 5.0);
                        assert!(
                            (nearest - DVec2::from(start)).length() > 10.0,
                            "bush {bush} by {start:?}, seed {seed}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_field_and_another_seed_another() {
        let scenario = scenario(Field::default());
        assert_eq!(Terrain::from_scenario(&scenario, 7), Terrain::from_scenario(&scenario, 7));
        assert_ne!(
            Terrain::from_scenario(&scenario, 7).unwrap().bushes,
            Terrain::from_scenario(&scenario, 8).unwrap().bushes
        );
    }

    #[test]
    fn fields_are_frozen_by_their_seed() {
        let terrain = Terrain::from_scenario(&scenario(Field::default()), 1).unwrap();
        let first: Vec<_> = terrain.bushes.iter().take(6).map(|bush| (bush.col, bush.row)).collect();
        assert_eq!(first, [(33, 0), (34, 0), (35, 0), (34, 1), (4, 2), (4, 3)]);
    }

    #[test]
    fn overlapping_pieces_count_shared_cells_once() {
        let field = Field { pieces: Some(62), overlaps: Overlaps::Dropped, start_clearance_m: 0.0, ..Field::default() };
        let scenario = scenario(field);
        let sizes: Vec<usize> =
            (0..200).map(|seed| Terrain::from_scenario(&scenario, seed).unwrap().bushes.len()).collect();
        assert!(sizes.iter().all(|&size| (4..=248).contains(&size)));
        let mean = sizes.iter().sum::<usize>() as f64 / 200.0;
        // The original program, which lays its pieces so, covers 234.7 cells with a standard deviation of 4.5.
        assert!((mean - 234.7).abs() < 2.0, "mean {mean}");
    }

    #[test]
    fn shapes_are_equally_likely_whatever_their_rotations() {
        let mut rng = rng::stream(1, "terrain");
        let layout = bare(20);
        let mut counts = [0u32; 7];
        for _ in 0..7000 {
            let (piece, _) = layout.draw(&mut Shape::ALL.to_vec(), &mut rng).unwrap();
            let shape = Shape::ALL.iter().position(|shape| shape.rotations().contains(piece)).unwrap();
            counts[shape] += 1;
        }
        // 1000 each, standard deviation 29.
        assert!(counts.iter().all(|count| count.abs_diff(1000) < 130), "{counts:?}");
    }

    #[test]
    fn legal_placements_are_equally_likely() {
        let mut layout = bare(5);
        layout.lay(&Shape::O.rotations()[0], Cell { col: 2, row: 2 }, 1);
        let mut rng = rng::stream(1, "terrain");
        let mut counts = std::collections::BTreeMap::new();
        for _ in 0..20_000 {
            let (piece, corner) = layout.draw(&mut vec![Shape::I], &mut rng).unwrap();
            *counts.entry((extent(piece), corner)).or_insert(0_u32) += 1;
        }
        // Rows 0, 1, 4 and columns 0, 1, 4 have two places each: twelve placements, 1667 draws each, deviation 39.
        assert_eq!(counts.len(), 12);
        assert!(counts.values().all(|count| count.abs_diff(1667) < 180), "{counts:?}");
    }

    #[test]
    fn the_last_legal_placement_is_found() {
        let mut layout = bare(40);
        layout.closed.values_mut().fill(true);
        for col in 20..24 {
            layout.closed[(31, col)] = false;
        }
        let mut shapes = Shape::ALL.to_vec();
        let placement = layout.draw(&mut shapes, &mut rng::stream(3, "terrain"));
        assert_eq!(placement, Some((&Shape::I.rotations()[0], Cell { col: 20, row: 31 })));
        assert!(shapes.contains(&Shape::I));
    }

    #[test]
    fn a_full_field_is_reported_with_the_piece() {
        let four_cells = Field { size_m: 10.0, shapes: vec![Shape::O], start_clearance_m: 1.0, ..Field::default() };
        let scenario = scenario(Field { pieces: Some(2), ..four_cells });
        assert_eq!(Terrain::from_scenario(&scenario, 1), Err(TerrainError::NoPlacementLeft { piece: 2, wanted: 2 }));
        let too_small = bare(1).fill(Shape::ALL.to_vec(), 1, &mut rng::stream(1, "terrain"));
        assert_eq!(too_small, Err(TerrainError::NoPlacementLeft { piece: 1, wanted: 1 }));
    }

    #[test]
    fn fire_takes_the_pieces_that_were_laid_or_what_joins_along_sides() {
        let mut whole = scenario(Field::default());
        whole.fire.unit = crate::FireUnit::Piece;
        let terrain = Terrain::from_scenario(&whole, 3).unwrap();
        let mut sizes = std::collections::BTreeMap::new();
        terrain.pieces.iter().for_each(|piece| *sizes.entry(piece).or_insert(0) += 1);
        assert_eq!((terrain.pieces.len(), sizes.len()), (terrain.bushes.len(), 62));
        assert!(sizes.values().all(|&size| size == 4), "tetrominoes: {sizes:?}");
        assert_eq!(terrain.bushes, Terrain::from_scenario(&scenario(Field::default()), 3).unwrap().bushes);
        whole.field.imported = Some(ImportedField::parse("#.#\n##.\n..#", 5.0).unwrap());
        assert_eq!(Terrain::from_scenario(&whole, 1).unwrap().pieces, [0, 1, 1, 1, 2]);
    }

    #[test]
    fn an_imported_field_is_the_same_for_every_seed() {
        let map = ImportedField::parse("#..\n..#", 5.0).unwrap();
        let scenario = scenario(Field { imported: Some(map), ..Field::default() });
        let terrain = Terrain::from_scenario(&scenario, 1).unwrap();
        assert_eq!(terrain.bushes, [Cell { col: 2, row: 0 }, Cell { col: 0, row: 1 }]);
        assert_eq!(Terrain::from_scenario(&scenario, 2).unwrap(), terrain);
    }
}
