//! A map cut into tiles, which exchange the steps at their sides.

use crate::wavefront::UNREACHED;
use crate::wavefront::cells::{SIDE, TileCell, TileSet};
use crate::wavefront::codes::{CodeRows, Codes, values};
use crate::wavefront::flood::{EAST, NORTH, SOUTH, SPAN, Sides, TileFlood, WEST, Window, along};
use crate::wavefront::moves::{FAR, Moves, WALL};
use crate::wavefront::records::TileRecords;
use crate::wavefront::tile_queue::TileQueue;
use crate::{Grid, Place};

/// The tiles of a map, row by row.
pub struct Tiles<'a> {
    rows: usize,
    cols: usize,
    records: TileRecords<'a>,
    /// The level at which the wave came to each tile, `FAR` if it did not, `OFTEN` if its flood took several windows.
    first: Vec<i32>,
    source: Place,
}

/// Marks a tile whose cells were reached in levels too far apart for one window; it is flooded again for its values.
const OFTEN: i32 = i32::MAX;

/// The codes of a window in a column of tiles.
struct TileCodes {
    col: usize,
    first: i32,
    rows: CodeRows,
}

impl<'a> Tiles<'a> {
    /// Cuts a map on which only the goal is reached.
    pub fn new(occupied: &Grid<bool>, goal: Place, values: &'a mut Grid<u32>) -> Self {
        let rows = occupied.rows().div_ceil(SIDE);
        let cols = occupied.cols().div_ceil(SIDE);
        let mut records = TileRecords::new(values);
        for row in 0..rows {
            for (col, free) in cut(occupied, row).into_iter().enumerate() {
                let mut record = records.get_mut((row, col));
                record.set_free(free);
                record.set_sides(&[NORTH, SOUTH, WEST, EAST].map(|side| unreached(along(free, side))));
            }
        }
        Self { rows, cols, records, first: vec![FAR; rows * cols], source: goal }
    }

    /// Lets the tiles exchange the steps at their sides until nothing improves.
    ///
    /// All that a side ever holds is the length of some path, and lengths only fall, so the order in which tiles come
    /// does not matter. That the tile with the earliest improvement comes first only saves work: most tiles come once.
    pub fn settle<M: Moves>(&mut self) {
        let mut agenda = TileQueue::new(self.first.len());
        let (row, col) = self.source_tile();
        agenda.put(row * self.cols + col, 0);
        while let Some((index, level)) = agenda.take() {
            let tile = (index / self.cols, index % self.cols);
            let sides = self.flood::<M>(tile, index, level);
            self.announce::<M>(tile, &sides, &mut agenda);
        }
    }

    /// Lets what is known along a tile's sides from `level` on run through it.
    fn flood<M: Moves>(&mut self, tile: Place, index: usize, level: i32) -> Sides {
        let previous = self.first[index];
        // Not again the levels before an improvement that comes too late for their window.
        let joins = level < previous.saturating_add(SPAN as i32);
        let first = if joins { previous.min(level) } else { level };
        let record = self.records.get(tile);
        let (free, arrivals) = (record.free(), record.sides());
        let mut sides = arrivals;
        let mut flood = TileFlood::new(free, self.source_in(tile, first), first, &arrivals);
        let mut only = None;
        let mut windows = 0;
        while let Some(window) = flood.next_window::<M>() {
            let codes = Codes::new(&window, free);
            codes.lower(window.first, &mut sides);
            only = Some((window.first, codes));
            windows += 1;
        }
        let mut record = self.records.get_mut(tile);
        record.set_sides(&sides);
        // Codes count from the first level of one window, and hold for the tile only if that window reached all of it.
        self.first[index] = match only {
            Some((first, codes)) if windows == 1 && joins && previous != OFTEN => {
                self.records.set_codes(tile, &codes);
                first
            }
            _ => OFTEN,
        };
        sides
    }

    /// Lowers the steps at the sides of a tile's neighbours, and puts those that this improves on the agenda.
    fn announce<M: Moves>(&mut self, tile: Place, sides: &Sides, agenda: &mut TileQueue) {
        // Cells beside a corner decide whether the diagonal step over it is legal.
        let mut walls = [[WALL; 2]; 4];
        for side in [NORTH, SOUTH, WEST, EAST] {
            if let Some(next) = self.next(tile, side) {
                let beside = self.records.get(next).side(side ^ 1);
                walls[side] = [beside[0], beside[SIDE - 1]];
                let arrivals = M::arrivals(&sides[side], &beside);
                let level = self.records.get_mut(next).lower_side(side ^ 1, &arrivals);
                agenda.put(next.0 * self.cols + next.1, level);
            }
        }
        for row_side in [NORTH, SOUTH] {
            for (end, column_side) in [WEST, EAST].into_iter().enumerate() {
                let cell = end * (SIDE - 1);
                let beside = [walls[row_side][end], walls[column_side][row_side - NORTH]];
                let arrival = M::diagonal_arrival(sides[row_side][cell], beside);
                let next = self.next(tile, row_side).and_then(|next| self.next(next, column_side));
                if let Some(next) = next
                    && arrival < FAR
                    && self.records.get_mut(next).lower_cell(row_side ^ 1, SIDE - 1 - cell, arrival)
                {
                    agenda.put(next.0 * self.cols + next.1, arrival);
                }
            }
        }
    }

    /// Writes the values of all cells after the tiles have settled.
    pub fn write<M: Moves>(mut self) {
        let mut sheets = Vec::new();
        for tile_row in 0..self.rows {
            sheets.clear();
            for tile_col in 0..self.cols {
                self.read::<M>((tile_row, tile_col), &mut sheets);
            }
            let values = self.records.values();
            for row in tile_row * SIDE..values.rows().min((tile_row + 1) * SIDE) {
                write_row(&sheets, row % SIDE, values.row_mut(row));
            }
        }
    }

    /// Appends all that was found out about a tile's cells.
    fn read<M: Moves>(&self, tile: Place, sheets: &mut Vec<TileCodes>) {
        let record = self.records.get(tile);
        let mut add = |first, codes: &Codes| sheets.push(TileCodes { col: tile.1, first, rows: codes.rows() });
        match self.first[tile.0 * self.cols + tile.1] {
            OFTEN => {
                let (free, sides) = (record.free(), record.sides());
                let mut flood = TileFlood::new(free, self.source_in(tile, 0), 0, &sides);
                while let Some(window) = flood.next_window::<M>() {
                    add(window.first, &Codes::new(&window, free));
                }
            }
            FAR => add(0, &Codes::new(&Window::NONE, record.free())),
            first => add(first, &self.records.codes(tile)),
        }
    }

    fn next(&self, (row, col): Place, side: usize) -> Option<Place> {
        let (row, col) = match side {
            NORTH => (row.wrapping_sub(1), col),
            SOUTH => (row + 1, col),
            WEST => (row, col.wrapping_sub(1)),
            _ => (row, col + 1),
        };
        (row < self.rows && col < self.cols).then_some((row, col))
    }

    fn source_tile(&self) -> Place {
        (self.source.0 / SIDE, self.source.1 / SIDE)
    }

    /// The source, if it lies in a tile whose flood begins at `level`.
    fn source_in(&self, tile: Place, level: i32) -> TileSet {
        let mut cells = TileSet::NONE;
        if level == 0 && tile == self.source_tile() {
            cells.add(TileCell::at(self.source.0 % SIDE, self.source.1 % SIDE));
        }
        cells
    }
}

/// The free cells of a row of tiles.
fn cut(occupied: &Grid<bool>, tile_row: usize) -> Vec<TileSet> {
    let mut tiles = vec![TileSet::NONE; occupied.cols().div_ceil(SIDE)];
    for row in tile_row * SIDE..occupied.rows().min((tile_row + 1) * SIDE) {
        let (whole, rest) = occupied.row(row).as_chunks::<SIDE>();
        for (tile, cells) in tiles.iter_mut().zip(whole) {
            tile.add_row(row % SIDE, free_bits(cells));
        }
        if let Some(last) = tiles.get_mut(whole.len()) {
            // What lies beyond the edge of the map is not free.
            let mut padded = [true; SIDE];
            padded[..rest.len()].copy_from_slice(rest);
            last.add_row(row % SIDE, free_bits(&padded));
        }
    }
    tiles
}

fn write_row(sheets: &[TileCodes], row: usize, line: &mut [u32]) {
    line.fill(UNREACHED);
    for sheet in sheets {
        let found = values(&sheet.rows[row], sheet.first);
        let line = &mut line[sheet.col * SIDE..];
        // Windows of one tile are joined by or: each has 0 for the cells that another one reached.
        match line.first_chunk_mut::<SIDE>() {
            Some(whole) => whole.iter_mut().zip(&found).for_each(|(value, found)| *value |= found),
            None => line.iter_mut().zip(&found).for_each(|(value, found)| *value |= found),
        }
    }
}

/// Steps at 16 cells of which those in `free` are free.
fn unreached(free: u16) -> [i32; SIDE] {
    let mut steps = [WALL; SIDE];
    for (i, steps) in steps.iter_mut().enumerate() {
        *steps = if free & 1 << i == 0 { WALL } else { FAR };
    }
    steps
}

/// The free cells among 16, the first lowest.
fn free_bits(occupied: &[bool; SIDE]) -> u16 {
    // The product moves the lowest bits of eight bytes to the highest byte.
    let pack = |start: usize| {
        let bytes = u64::from_le_bytes(std::array::from_fn(|i| u8::from(occupied[start + i])));
        (bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u16
    };
    !(pack(0) | pack(8) << 8)
}
