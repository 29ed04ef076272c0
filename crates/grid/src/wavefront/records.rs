//! The records of all tiles while the wave runs.

use std::array;

use crate::wavefront::cells::{SIDE, TileSet};
use crate::wavefront::codes::Codes;
use crate::wavefront::flood::{Sides, reduce};
use crate::wavefront::moves::{FAR, SideSteps, far_if};
use crate::{Grid, Place};

/// Numbers that a record takes: steps at the cells along the sides, then the free cells.
const LENGTH: usize = FREE + 8;
const FREE: usize = 4 * SIDE;
/// Numbers that the codes of a tile take.
const CODES: usize = 64;

/// A tile's record: steps at the cells along its sides, and its free cells.
pub struct TileRecord<T>(T);

/// The records of all tiles, and the codes of all cells after the last flood of their tile.
///
/// The codes are kept in the grid that the values will be written to: the 16 rows of values that a row of tiles covers
/// have room for its codes, four to a value. Where fewer than 16 rows are left at the end of the map, a vector has
/// them.
pub struct TileRecords<'a> {
    values: &'a mut Grid<u32>,
    last_row: Vec<u32>,
    tiles: Vec<[u32; LENGTH]>,
}

impl<'a> TileRecords<'a> {
    /// Empty records and any codes, for tiles that cover `values`.
    pub fn new(values: &'a mut Grid<u32>) -> Self {
        let cols = values.cols().div_ceil(SIDE);
        let cut = if values.rows().is_multiple_of(SIDE) { 0 } else { cols };
        let tiles = vec![[0; LENGTH]; values.rows().div_ceil(SIDE) * cols];
        Self { values, last_row: vec![0; cut * CODES], tiles }
    }

    pub fn get(&self, tile: Place) -> TileRecord<&[u32; LENGTH]> {
        TileRecord(&self.tiles[tile.0 * self.cols() + tile.1])
    }

    pub fn get_mut(&mut self, tile: Place) -> TileRecord<&mut [u32; LENGTH]> {
        let index = tile.0 * self.cols() + tile.1;
        TileRecord(&mut self.tiles[index])
    }

    fn cols(&self) -> usize {
        self.values.cols().div_ceil(SIDE)
    }

    pub fn codes(&self, tile: Place) -> Codes {
        let words = self.values.values().get(self.start(tile.0)..self.start(tile.0 + 1)).unwrap_or(&self.last_row);
        let words: &[u32; CODES] = words[tile.1 * CODES..].first_chunk().expect("there is room for all codes");
        Codes::from_words(array::from_fn(|i| array::from_fn(|k| word(words, 8 * i + 2 * k))))
    }

    pub fn set_codes(&mut self, tile: Place, codes: &Codes) {
        let row = self.start(tile.0)..self.start(tile.0 + 1);
        let words = self.values.values_mut().get_mut(row).unwrap_or(&mut self.last_row);
        set_words(&mut words[tile.1 * CODES..], codes.words().as_flattened());
    }

    /// The values under the codes; writing them overwrites the codes of the same row of tiles, no others.
    pub fn values(&mut self) -> &mut Grid<u32> {
        self.values
    }

    fn start(&self, tile_row: usize) -> usize {
        tile_row * SIDE * self.values.cols()
    }
}

impl TileRecord<&[u32; LENGTH]> {
    pub fn sides(&self) -> Sides {
        let mut sides = [[FAR; SIDE]; 4];
        for (steps, &word) in sides.as_flattened_mut().iter_mut().zip(self.0) {
            *steps = word as i32;
        }
        sides
    }

    /// Steps at the cells along one side.
    #[inline(always)]
    pub fn side(&self, side: usize) -> SideSteps {
        let mut steps = [FAR; SIDE];
        for (steps, &word) in steps.iter_mut().zip(&self.0[side * SIDE..(side + 1) * SIDE]) {
            *steps = word as i32;
        }
        steps
    }

    pub fn free(&self) -> TileSet {
        TileSet::from_words(array::from_fn(|i| word(self.0, FREE + 2 * i)))
    }
}

fn word(words: &[u32], at: usize) -> u64 {
    u64::from(words[at]) | u64::from(words[at + 1]) << 32
}

fn set_words(pairs: &mut [u32], words: &[u64]) {
    for (pair, &word) in pairs.as_chunks_mut().0.iter_mut().zip(words) {
        *pair = [word as u32, (word >> 32) as u32];
    }
}

impl TileRecord<&mut [u32; LENGTH]> {
    pub fn set_sides(&mut self, sides: &Sides) {
        for (word, &steps) in self.0.iter_mut().zip(sides.as_flattened()) {
            *word = steps as u32;
        }
    }

    pub fn set_free(&mut self, free: TileSet) {
        set_words(&mut self.0[FREE..], &free.words());
    }

    /// Lowers the steps of the cells along a side to `arrivals`; the lowest that is an improvement, else `FAR` or more.
    pub fn lower_side(&mut self, side: usize, arrivals: &SideSteps) -> i32 {
        let line = self.0[side * SIDE..].first_chunk_mut::<SIDE>().expect("sides come first");
        reduce(&lower(line, arrivals), i32::min)
    }

    /// Lowers the steps of one cell of a side; whether that was an improvement.
    pub fn lower_cell(&mut self, side: usize, cell: usize, arrival: i32) -> bool {
        let word = &mut self.0[side * SIDE + cell];
        let improves = arrival < *word as i32;
        if improves {
            *word = arrival as u32;
        }
        improves
    }
}

/// Lowers the steps of a line; the arrivals that improve them, `FAR` or more in place of the others.
#[inline(always)]
fn lower(line: &mut [u32; SIDE], arrivals: &SideSteps) -> SideSteps {
    let mut improvements = [FAR; SIDE];
    for ((improvement, word), &arrival) in improvements.iter_mut().zip(line).zip(arrivals) {
        let current = *word as i32;
        *improvement = far_if(arrival >= current, arrival);
        *word = arrival.min(current) as u32;
    }
    improvements
}
