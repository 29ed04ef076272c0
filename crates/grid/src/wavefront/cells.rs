//! Sets of cells of a tile, one bit per cell.

use std::ops::{BitAnd, BitOr, BitOrAssign, BitXor, Not};

/// Cells along a side of a tile.
pub const SIDE: usize = 16;

/// Rows and columns of a tile are numbered from its north-west cell.
///
/// Even and odd rows lie apart, 16 bits a row, column 0 lowest: the rows north and south of all odd ones are the even
/// ones. All work is done on pairs of words, which the compiler turns into vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileSet {
    even: WordPair,
    odd: WordPair,
}

/// Eight rows, the northernmost in the lowest bits of the first word.
type WordPair = [u64; 2];

/// One cell of a tile.
#[derive(Clone, Copy)]
pub struct TileCell {
    word: u8,
    bit: u8,
}

const EVERY_ROW: u64 = 0x0001_0001_0001_0001;
const WEST_EDGE: u64 = EVERY_ROW;
const EAST_EDGE: u64 = EVERY_ROW << (SIDE - 1);

impl TileCell {
    pub const fn at(row: usize, col: usize) -> Self {
        Self { word: (row % 2 * 2 + row / 8) as u8, bit: (row % 8 / 2 * SIDE + col) as u8 }
    }
}

impl TileSet {
    pub const NONE: Self = Self { even: [0; 2], odd: [0; 2] };

    #[inline]
    pub fn is_empty(self) -> bool {
        self == Self::NONE
    }

    /// Returns the words that hold all cells: rows 0, 2, 4, 6, then 8, 10, 12, 14, and the odd ones alike.
    #[inline]
    pub fn words(self) -> [u64; 4] {
        [self.even[0], self.even[1], self.odd[0], self.odd[1]]
    }

    #[inline]
    pub fn from_words([a, b, c, d]: [u64; 4]) -> Self {
        Self { even: [a, b], odd: [c, d] }
    }

    /// A row's cells, column 0 lowest.
    #[inline]
    pub fn row(self, row: usize) -> u16 {
        let cell = TileCell::at(row, 0);
        (self.words()[usize::from(cell.word)] >> cell.bit) as u16
    }

    /// A column's cells, row 0 lowest.
    #[inline]
    pub fn column(self, col: usize) -> u16 {
        let halves = [0, 1].map(|half| {
            let [even, odd] = [self.even[half], self.odd[half]].map(|word| word >> col & EVERY_ROW);
            let by_twos = even | odd << 1;
            (by_twos | by_twos >> 14 | by_twos >> 28 | by_twos >> 42) & 0xff
        });
        (halves[0] | halves[1] << 8) as u16
    }

    #[inline]
    pub fn add(&mut self, cell: TileCell) {
        let Self { even: [a, b], odd: [c, d] } = self;
        *[a, b, c, d][usize::from(cell.word)] |= 1 << cell.bit;
    }

    /// Adds cells of a row, column 0 lowest.
    #[inline]
    pub fn add_row(&mut self, row: usize, cols: u16) {
        let half = row / 8;
        let pair = if row.is_multiple_of(2) { &mut self.even } else { &mut self.odd };
        pair[half] |= u64::from(cols) << (row % 8 / 2 * SIDE);
    }

    /// The cells north of these; those of row 0 leave the tile.
    #[inline]
    pub fn north(self) -> Self {
        let [first, second] = self.even;
        Self { even: self.odd, odd: either([first >> SIDE, second >> SIDE], [second << (64 - SIDE), 0]) }
    }

    /// The cells south of these; those of the last row leave the tile.
    #[inline]
    pub fn south(self) -> Self {
        let [first, second] = self.odd;
        Self { even: either([first << SIDE, second << SIDE], [0, first >> (64 - SIDE)]), odd: self.even }
    }

    /// The cells west of these; those of column 0 leave the tile.
    #[inline]
    pub fn west(self) -> Self {
        self.each(|word| (word & !WEST_EDGE) >> 1)
    }

    /// The cells east of these; those of the last column leave the tile.
    #[inline]
    pub fn east(self) -> Self {
        self.each(|word| (word & !EAST_EDGE) << 1)
    }

    #[inline]
    fn each(self, change: impl Fn(u64) -> u64) -> Self {
        let Self { even: [a, b], odd: [c, d] } = self;
        Self { even: [change(a), change(b)], odd: [change(c), change(d)] }
    }

    #[inline]
    fn pairwise(self, other: Self, join: impl Fn(WordPair, WordPair) -> WordPair) -> Self {
        Self { even: join(self.even, other.even), odd: join(self.odd, other.odd) }
    }
}

#[inline]
fn either(some: WordPair, others: WordPair) -> WordPair {
    [some[0] | others[0], some[1] | others[1]]
}

impl BitOr for TileSet {
    type Output = Self;
    #[inline]
    fn bitor(self, other: Self) -> Self {
        self.pairwise(other, either)
    }
}

impl BitOrAssign for TileSet {
    #[inline]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl BitAnd for TileSet {
    type Output = Self;
    #[inline]
    fn bitand(self, other: Self) -> Self {
        self.pairwise(other, |some, others| [some[0] & others[0], some[1] & others[1]])
    }
}

impl Not for TileSet {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        self.each(|word| !word)
    }
}

impl BitXor for TileSet {
    type Output = Self;
    #[inline]
    fn bitxor(self, other: Self) -> Self {
        self.pairwise(other, |some, others| [some[0] ^ others[0], some[1] ^ others[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(cells: impl IntoIterator<Item = (usize, usize)>) -> TileSet {
        let mut set = TileSet::NONE;
        for (row, col) in cells {
            set.add(TileCell::at(row, col));
        }
        set
    }

    fn places() -> impl Iterator<Item = (usize, usize)> {
        (0..SIDE).flat_map(|row| (0..SIDE).map(move |col| (row, col)))
    }

    #[test]
    fn a_moved_cell_arrives_or_leaves_the_tile() {
        for (row, col) in places() {
            let moved = |row: Option<usize>, col: Option<usize>| {
                set(row.zip(col).filter(|&(row, col)| row < SIDE && col < SIDE))
            };
            let cell = set([(row, col)]);
            assert_eq!(cell.north(), moved(row.checked_sub(1), Some(col)));
            assert_eq!(cell.south(), moved(Some(row + 1), Some(col)));
            assert_eq!(cell.west(), moved(Some(row), col.checked_sub(1)));
            assert_eq!(cell.east(), moved(Some(row), Some(col + 1)));
        }
    }

    #[test]
    fn rows_and_columns_hold_the_cells_that_lie_in_them() {
        let has = |(row, col): &(usize, usize)| (row * 7 + col * col) % 3 == 0;
        let cells = set(places().filter(has));
        for (row, col) in places() {
            assert_eq!(cells.row(row) >> col & 1 == 1, has(&(row, col)));
            assert_eq!(cells.column(col) >> row & 1 == 1, has(&(row, col)));
        }
    }

    #[test]
    fn a_row_that_is_added_is_read_back_and_nothing_else() {
        for row in 0..SIDE {
            let mut cells = set([]);
            cells.add_row(row, 0b1010_0000_0000_0011);
            assert_eq!(cells, set([(row, 0), (row, 1), (row, 13), (row, 15)]));
        }
    }
}
