//! The wave inside one tile, level by level, from the arrivals at its sides.

use crate::wavefront::cells::{SIDE, TileCell, TileSet};
use crate::wavefront::moves::{FAR, Moves, far_if};

/// North, south, west, east; `side ^ 1` is the opposite one.
pub const NORTH: usize = 0;
pub const SOUTH: usize = 1;
pub const WEST: usize = 2;
pub const EAST: usize = 3;

/// One number for each cell along each side, from west to east or from north to south. Corner cells lie on two sides.
pub type Sides = [[i32; SIDE]; 4];

/// The number of levels recorded together: as many as the bit planes can count, minus the last four.
///
/// Four, because the levels run in fours; less, because the place for other arrivals in [`TileFlood::sow`] makes the
/// table of a full 64 too long for the fast way to clear it.
pub const SPAN: usize = (1 << PLANES) - 4;
const PLANES: usize = 6;

/// A wave that has not yet run through (the rest of) a tile.
pub struct TileFlood<'a> {
    free: TileSet,
    /// Free cells that the wave has not reached.
    open: TileSet,
    arrivals: &'a Sides,
    /// The first level that has not run, and the cells known to be reached there.
    level: i32,
    pending: TileSet,
}

/// The cells reached in `SPAN` levels from `first` on.
pub struct Window {
    pub first: i32,
    pub reached: TileSet,
    /// Bit `k` of the number of levels after the first, for all cells.
    pub planes: [TileSet; PLANES],
}

impl Window {
    /// An empty window.
    pub const NONE: Self = Self { first: 0, reached: TileSet::NONE, planes: [TileSet::NONE; PLANES] };
}

impl<'a> TileFlood<'a> {
    /// Creates a wave from the cells `source` at `level` and from `arrivals` at their levels, unless they are earlier.
    pub fn new(free: TileSet, source: TileSet, level: i32, arrivals: &'a Sides) -> Self {
        Self { free, open: free, arrivals, level, pending: source }
    }

    /// Runs the next levels in which cells are reached.
    #[inline(always)]
    pub fn next_window<M: Moves>(&mut self) -> Option<Window> {
        if self.open.is_empty() {
            return None;
        }
        // With nothing pending, the empty levels up to the next arrival are skipped.
        let first = if self.pending.is_empty() { earliest(self.arrivals, self.level)? } else { self.level };
        // Place 0 takes the arrivals of other windows, so that `sow` need not branch.
        let mut seeds = [TileSet::NONE; SPAN + 1];
        let last = self.sow(first, &mut seeds);
        seeds[1] |= self.pending;
        let mut open = self.open;
        let mut front = TileSet::NONE;
        let mut planes = [TileSet::NONE; PLANES];
        // Four levels at a time, so that the two lowest planes need no questions.
        for (block, fronts) in seeds[1..].as_chunks_mut::<4>().0.iter_mut().enumerate() {
            for seeds in fronts.iter_mut() {
                front = (M::grow(front, self.free) | *seeds) & open;
                open = open ^ front;
                // In memory, because the compiler uses vectors where it sees stores.
                *seeds = front;
            }
            let [a, b, c, d] = *fronts;
            planes[0] |= b | d;
            planes[1] |= c | d;
            for (bit, plane) in planes[2..].iter_mut().enumerate() {
                // The number of the block has the higher bits of the level.
                if block >> bit & 1 == 1 {
                    *plane |= a | b | c | d;
                }
            }
            if front.is_empty() && 4 * (block + 1) >= last {
                break;
            }
        }
        self.level = first + SPAN as i32;
        let reached = self.open ^ open;
        self.open = open;
        self.pending = M::grow(front, self.free) & open;
        Some(Window { first, reached, planes })
    }

    /// Puts border cells at places 1 to `SPAN` by the level, from `first` on, at which arrivals come there, and tells
    /// the last such place.
    #[inline(always)]
    fn sow(&self, first: i32, seeds: &mut [TileSet; SPAN + 1]) -> usize {
        // Arrivals at other levels go to place 0, so that nothing branches.
        let mut places = [[0; SIDE]; 4];
        for (place, &arrival) in places.as_flattened_mut().iter_mut().zip(self.arrivals.as_flattened()) {
            let level = arrival - first;
            *place = if (0..SPAN as i32).contains(&level) { level + 1 } else { 0 };
        }
        let mut last = 0;
        for (places, cells) in places.iter().zip(&BORDER) {
            let last_here = reduce(places, i32::max);
            if last_here > 0 {
                for (&place, &cell) in places.iter().zip(cells) {
                    seeds[place as usize].add(cell);
                }
                last = last.max(last_here);
            }
        }
        last as usize
    }
}

/// The cells along each side.
const BORDER: [[TileCell; SIDE]; 4] = {
    let mut border = [[TileCell::at(0, 0); SIDE]; 4];
    let mut i = 0;
    while i < SIDE {
        border[NORTH][i] = TileCell::at(0, i);
        border[SOUTH][i] = TileCell::at(SIDE - 1, i);
        border[WEST][i] = TileCell::at(i, 0);
        border[EAST][i] = TileCell::at(i, SIDE - 1);
        i += 1;
    }
    border
};

/// Returns the cells along a side.
pub fn along(cells: TileSet, side: usize) -> u16 {
    match side {
        NORTH => cells.row(0),
        SOUTH => cells.row(SIDE - 1),
        WEST => cells.column(0),
        _ => cells.column(SIDE - 1),
    }
}

/// The lowest of the numbers from `floor` on, if one is below `FAR`.
fn earliest(starts: &Sides, floor: i32) -> Option<i32> {
    let mut all = [FAR; SIDE];
    for side in starts {
        for (lowest, &start) in all.iter_mut().zip(side) {
            // Without its sign a wall is far, too.
            *lowest = far_if(start < floor, start & i32::MAX).min(*lowest);
        }
    }
    Some(reduce(&all, i32::min)).filter(|&level| level < FAR)
}

/// Reduces all 16 numbers to one, in any order.
pub fn reduce(numbers: &[i32; SIDE], join: impl Fn(i32, i32) -> i32) -> i32 {
    // In lanes, for vector instructions.
    let (mut lanes, rest) = numbers.split_first_chunk::<4>().map(|(first, rest)| (*first, rest)).expect("16 is over 4");
    for chunk in rest.as_chunks::<4>().0 {
        for (lane, &number) in lanes.iter_mut().zip(chunk) {
            *lane = join(*lane, number);
        }
    }
    join(join(lanes[0], lanes[1]), join(lanes[2], lanes[3]))
}
