//! The codes of a tile's cells after a flood, one byte a cell.

use crate::wavefront::GOAL;
use crate::wavefront::cells::{SIDE, TileSet};
use crate::wavefront::flood::{EAST, NORTH, SOUTH, Sides, WEST, Window};
use crate::wavefront::moves::far_if;

/// A byte per cell: `REACHED` plus levels after the first of a window, the value of an obstacle, or that of a cell not
/// reached.
///
/// Word `i`, byte `j` is, for each of the four words of [`TileSet`], the cell of bit `8 * j + i`.
#[derive(Clone, Copy)]
pub struct Codes([[u64; 4]; 8]);

/// The codes in order, row by row.
pub type CodeRows = [[u8; SIDE]; SIDE];

const REACHED: u8 = 0x80;

impl Codes {
    /// Encodes the cells that a window reached.
    pub fn new(window: &Window, free: TileSet) -> Self {
        let mut planes = [TileSet::NONE; 8];
        planes[..window.planes.len()].copy_from_slice(&window.planes);
        planes[0] |= !free;
        planes[7] = window.reached;
        let mut words = planes.map(TileSet::words);
        transpose_bits(&mut words);
        Self(words)
    }

    /// Codes that were kept as words.
    pub fn from_words(words: [[u64; 4]; 8]) -> Self {
        Self(words)
    }

    /// The codes as words, to be kept.
    pub fn words(&self) -> &[[u64; 4]; 8] {
        &self.0
    }

    /// Lowers the steps of the cells along the sides to what the codes say, with `first` for the first level.
    #[inline(always)]
    pub fn lower(&self, first: i32, sides: &mut Sides) {
        for (steps, code) in sides.as_flattened_mut().iter_mut().zip(self.sides().as_flattened()) {
            let level = i32::from(code & !REACHED);
            *steps = far_if(*code < REACHED, first + level).min(*steps);
        }
    }

    /// The codes along the sides, in the order of [`Sides`].
    #[inline(always)]
    fn sides(&self) -> [[u8; SIDE]; 4] {
        let mut sides = [[0; SIDE]; 4];
        for i in 0..8 {
            [sides[NORTH][i], sides[NORTH][i + 8], ..] = self.0[i][0].to_le_bytes();
            [.., sides[SOUTH][i], sides[SOUTH][i + 8]] = self.0[i][3].to_le_bytes();
        }
        for half in 0..2 {
            for parity in 0..2 {
                let west = self.0[0][2 * parity + half].to_le_bytes();
                let east = self.0[7][2 * parity + half].to_le_bytes();
                for quarter in 0..4 {
                    let row = 8 * half + 2 * quarter + parity;
                    sides[WEST][row] = west[2 * quarter];
                    sides[EAST][row] = east[2 * quarter + 1];
                }
            }
        }
        sides
    }

    /// The codes in order.
    pub fn rows(&self) -> CodeRows {
        let mut words = self.0;
        transpose_bytes(&mut words);
        let mut rows = [[0; SIDE]; SIDE];
        for quarter in 0..4 {
            for (k, parity) in [(0, 0), (1, 0), (2, 1), (3, 1)] {
                let row = &mut rows[k % 2 * 8 + quarter * 2 + parity];
                row[..8].copy_from_slice(&words[2 * quarter][k].to_le_bytes());
                row[8..].copy_from_slice(&words[2 * quarter + 1][k].to_le_bytes());
            }
        }
        rows
    }
}

/// Exchanges the number of a word with that of a bit in a byte.
fn transpose_bits(words: &mut [[u64; 4]; 8]) {
    exchange(words, 1, 1, 0x5555_5555_5555_5555);
    exchange(words, 2, 2, 0x3333_3333_3333_3333);
    exchange(words, 4, 4, 0x0f0f_0f0f_0f0f_0f0f);
}

/// Exchanges the number of a word with that of a byte in it.
fn transpose_bytes(words: &mut [[u64; 4]; 8]) {
    exchange(words, 1, 8, 0x00ff_00ff_00ff_00ff);
    exchange(words, 2, 16, 0x0000_ffff_0000_ffff);
    exchange(words, 4, 32, 0x0000_0000_ffff_ffff);
}

/// Exchanges the bits of words without `bit` in their number, `shift` above those of the mask, with the bits of the
/// mask in the words with it.
#[inline(always)]
fn exchange(words: &mut [[u64; 4]; 8], bit: usize, shift: u32, mask: u64) {
    for low in (0..8).filter(|number| number & bit == 0) {
        let [low, high] = words.get_disjoint_mut([low, low + bit]).expect("both are among eight");
        for (low, high) in low.iter_mut().zip(high) {
            let difference = (*low >> shift ^ *high) & mask;
            *high ^= difference;
            *low ^= difference << shift;
        }
    }
}

/// The values of a row's cells.
#[inline(always)]
pub fn values(codes: &[u8; SIDE], first: i32) -> [u32; SIDE] {
    let first = (first as u32 + GOAL).wrapping_sub(REACHED.into());
    codes.map(|code| {
        // All bits for a cell that was reached, else none. A choice would become a branch that nobody can predict.
        let mask = (i32::from(code as i8) >> 31) as u32;
        u32::from(code).wrapping_add(first & mask)
    })
}
