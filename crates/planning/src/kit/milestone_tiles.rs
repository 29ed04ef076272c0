//! Tiles of a large field, whose milestones are sampled when a search first comes near.
//!
//! Every tile has a random stream of its own, so that its milestones are the same whenever and after whatever others it
//! is opened. World frame, metres.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::sample_density::SQUARE_METRES_PER_HECTARE;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::rng::{self, Xoshiro256PlusPlus};

/// Fields up to this size have roadmaps that are built at once; on larger ones they may grow. Square metres.
const LARGEST_WHOLE_M2: f64 = 500.0 * 500.0;

/// About the side of a tile: as long as edges are by default, so that the tiles round one hold all that is near.
const SIDE_M: f64 = 40.0;

/// Returns whether a field is so small that a roadmap of all of it is built at once.
pub fn is_small(frame: &FieldFrame) -> bool {
    frame.width_m() * frame.height_m() <= LARGEST_WHOLE_M2
}

/// A part of a field: cells, row 0 at the south edge.
#[derive(Clone, Debug)]
pub struct CellBlock {
    pub rows: Range<usize>,
    pub cols: Range<usize>,
}

impl CellBlock {
    /// Returns its area, for cells of this side.
    pub fn hectares(&self, cell_m: f64) -> f64 {
        self.rows.len() as f64 * self.cols.len() as f64 * cell_m * cell_m / SQUARE_METRES_PER_HECTARE
    }

    /// Returns the position at some shares of its width and height, for cells of this side.
    pub fn position(&self, x: f64, y: f64, cell_m: f64) -> DVec2 {
        let metres = |cells: usize| cells as f64 * cell_m;
        DVec2::new(
            metres(self.cols.start) + x * metres(self.cols.len()),
            metres(self.rows.start) + y * metres(self.rows.len()),
        )
    }
}

/// A list of milestones that grows by tiles.
pub trait SampleSink {
    /// Draws the milestones of a part of the field and puts them at the end of the list.
    fn draw(&mut self, block: CellBlock, rng: Xoshiro256PlusPlus);

    fn count(&self) -> usize;

    fn position(&self, milestone: u32) -> DVec2;
}

/// The tiles of a field, and the numbers of the milestones of opened tiles.
#[derive(Debug)]
pub struct MilestoneTiles {
    /// The number that the streams of all tiles begin with.
    key: u64,
    frame: FieldFrame,
    /// Cells along the side of a tile.
    side: usize,
    cols: usize,
    rows: usize,
    opened: BTreeMap<u32, Range<u32>>,
    /// The tile of every milestone, and its place among those there. Numbers depend on what was asked before, ranks do not.
    ranks: Vec<u64>,
}

impl MilestoneTiles {
    pub fn new(frame: &FieldFrame, key: u64) -> Self {
        let side = (SIDE_M / frame.cell_m).ceil().max(1.0) as usize;
        let [cols, rows] = [frame.cols, frame.rows].map(|cells| usize::from(cells).div_ceil(side));
        Self { key, frame: *frame, side, cols, rows, opened: BTreeMap::new(), ranks: Vec::new() }
    }

    /// Returns the bytes that it takes.
    pub fn bytes(&self) -> usize {
        2 * self.opened.len() * size_of::<(u32, Range<u32>)>() + self.ranks.capacity() * size_of::<u64>()
    }

    /// Closes all tiles.
    pub fn clear(&mut self) {
        (self.opened, self.ranks) = (BTreeMap::new(), Vec::new());
    }

    /// Returns the number by which milestones are sorted.
    pub fn rank(&self, milestone: u32) -> u64 {
        self.ranks[milestone as usize]
    }

    /// Replaces what `found` holds by the milestones within `reach_m` of a place, with their distances, in no particular
    /// order; opens the tiles that hold them.
    pub fn within(
        &mut self,
        milestones: &mut impl SampleSink,
        place: DVec2,
        reach_m: f64,
        found: &mut Vec<(f64, u32)>,
    ) {
        found.clear();
        let side_m = self.side as f64 * self.frame.cell_m;
        let range = |middle: f64, count: usize| {
            // Casts clamp at 0.
            let low = (middle - reach_m) / side_m;
            let high = (middle + reach_m) / side_m;
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        let cols = range(place.x, self.cols);
        for row in range(place.y, self.rows) {
            for col in cols.clone() {
                // Opened on demand, each from a stream of its own, so that the order of queries does not matter.
                let numbers = match self.opened.get(&((row * self.cols + col) as u32)) {
                    Some(numbers) => numbers.clone(),
                    None => self.open(milestones, [col, row]),
                };
                let distances = numbers.map(|number| (milestones.position(number).distance(place), number));
                found.extend(distances.filter(|&(distance, _)| distance <= reach_m));
            }
        }
    }

    /// Draws the milestones of a tile; returns their numbers.
    fn open(&mut self, milestones: &mut impl SampleSink, [col, row]: [usize; 2]) -> Range<u32> {
        let cells = |number: usize, count: u16| {
            let first = number * self.side;
            first..(first + self.side).min(count.into())
        };
        let block = CellBlock { rows: cells(row, self.frame.rows), cols: cells(col, self.frame.cols) };
        let first = milestones.count();
        // A stream for the place, so that it does not matter which tiles were opened before.
        milestones.draw(block, rng::stream(self.key, &format!("tile/{col}/{row}")));
        let tile = (row * self.cols + col) as u32;
        let drawn = milestones.count() - first;
        self.ranks.extend((0..drawn as u64).map(|place| u64::from(tile) << 32 | place));
        let numbers = first as u32..milestones.count() as u32;
        self.opened.insert(tile, numbers.clone());
        numbers
    }
}
