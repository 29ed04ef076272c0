//! Milestones of a large field, drawn by tiles of it when a search first comes near.
//!
//! Every tile has a random stream of its own, so that its milestones are the same whenever and after whatever others it
//! is opened.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::roadmap::Milestone;
use super::sample::{CellBlock, Sampler};
use crate::collision::CollisionChecker;
use crate::geometry::FieldFrame;
use crate::rng;

/// About the side of a tile: as long as edges are by default, so that the tiles round one hold all that is near.
const SIDE_M: f64 = 40.0;

/// What is drawn in a tile.
#[derive(Clone, Copy, Debug)]
pub struct TileSampling {
    /// The number that the streams of all tiles begin with.
    pub key: u64,
    /// Poses drawn evenly, on average.
    pub samples_per_hectare: f64,
    pub corner_places: u32,
    pub clearance_m: f64,
}

/// The tiles of a field, and the numbers of the milestones of those that were opened.
#[derive(Debug)]
pub struct Tiles {
    sampling: TileSampling,
    /// Cells along the side of a tile.
    side: usize,
    side_m: f64,
    cols: usize,
    rows: usize,
    opened: BTreeMap<u32, Range<u32>>,
    /// Of every milestone: its tile, and its place among those there. Numbers depend on what was asked before, ranks do
    /// not.
    ranks: Vec<u64>,
}

impl Tiles {
    pub fn new(frame: &FieldFrame, sampling: TileSampling) -> Self {
        let side = (SIDE_M / frame.cell_m).ceil().max(1.0) as usize;
        let [cols, rows] = [frame.cols, frame.rows].map(|cells| usize::from(cells).div_ceil(side));
        let side_m = side as f64 * frame.cell_m;
        Self { sampling, side, side_m, cols, rows, opened: BTreeMap::new(), ranks: Vec::new() }
    }

    /// Bounds the bytes that it takes besides the milestones, if the field has this number of them.
    pub fn most_bytes(frame: &FieldFrame, milestones: u64) -> u64 {
        let cells = frame.cell_count() as f64;
        let tiles = cells.min(frame.width_m() * frame.height_m() / (SIDE_M * SIDE_M)) as u64 + 1;
        2 * (tiles * size_of::<(u32, Range<u32>)>() as u64 + milestones * size_of::<u64>() as u64)
    }

    /// Returns the bytes that it takes.
    pub fn bytes(&self) -> usize {
        2 * self.opened.len() * size_of::<(u32, Range<u32>)>() + self.ranks.capacity() * size_of::<u64>()
    }

    /// Closes all tiles.
    pub fn clear(&mut self) {
        self.opened.clear();
        self.ranks.clear();
    }

    /// Returns the number by which milestones are put in order.
    pub fn rank(&self, milestone: u32) -> u64 {
        self.ranks[milestone as usize]
    }

    /// Replaces what `found` holds by the milestones within `reach_m` of a place, with their distances, in no particular
    /// order; opens the tiles that hold them.
    pub fn within(
        &mut self,
        checker: &CollisionChecker,
        milestones: &mut Vec<Milestone>,
        (place, reach_m): (DVec2, f64),
        found: &mut Vec<(f64, u32)>,
    ) {
        found.clear();
        let range = |middle: f64, count: usize| {
            // Casts clamp at 0.
            let (low, high) = ((middle - reach_m) / self.side_m, (middle + reach_m) / self.side_m);
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        let cols = range(place.x, self.cols);
        for row in range(place.y, self.rows) {
            for col in cols.clone() {
                let tile = (row * self.cols + col) as u32;
                let own = match self.opened.get(&tile) {
                    Some(own) => own.clone(),
                    None => self.open(checker, milestones, tile),
                };
                let distances = own.map(|number| (milestones[number as usize].pose.position().distance(place), number));
                found.extend(distances.filter(|&(distance, _)| distance <= reach_m));
            }
        }
    }

    /// Draws the milestones of a tile; returns their numbers.
    fn open(&mut self, checker: &CollisionChecker, milestones: &mut Vec<Milestone>, tile: u32) -> Range<u32> {
        let TileSampling { key, samples_per_hectare, corner_places, clearance_m } = self.sampling;
        let frame = checker.field().frame();
        let cells = |number: usize, count: u16| {
            let first = number * self.side;
            first..(first + self.side).min(count.into())
        };
        let (row, col) = (tile as usize / self.cols, tile as usize % self.cols);
        let block = CellBlock { rows: cells(row, frame.rows), cols: cells(col, frame.cols) };
        let wanted = block.hectares(frame.cell_m) * samples_per_hectare;
        let mut rng = rng::stream(key, &format!("tile/{col}/{row}"));
        let mut sampler = Sampler::of_block(checker, clearance_m, block, &mut rng);
        let mut poses = sampler.draw_about(wanted, &mut rng);
        poses.extend(sampler.corner_samples(corner_places));
        let first = milestones.len() as u32;
        self.ranks.extend((0..poses.len() as u64).map(|place| u64::from(tile) << 32 | place));
        milestones.extend(poses.into_iter().map(Milestone::new));
        let own = first..milestones.len() as u32;
        self.opened.insert(tile, own.clone());
        own
    }
}
