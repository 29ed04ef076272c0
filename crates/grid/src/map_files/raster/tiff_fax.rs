//! Fax-coded strips and tiles of TIFF images: modified Huffman rows (number 2) and Group 3 (number 3).
//!
//! A row is a list of runs, white first. Group 3 begins rows with an end-of-line code, and may code a row by its
//! differences from the one above.
//!
//! Sources: ITU-T Recommendation T.4, "Standardization of Group 3 facsimile terminals for document transmission", 2003,
//! tables 2 to 4; Adobe Developers Association, "TIFF Revision 6.0", 1992, sections 10 and 11.

use std::sync::LazyLock;

/// Codes of runs of 0 to 63 and of 64, 128 ... 1728 pixels. A 1 stands before the bits of each, so that zeros count.
#[rustfmt::skip]
const WHITE: [u16; 91] = [
    0x135, 0x47, 0x17, 0x18, 0x1b, 0x1c, 0x1e, 0x1f, 0x33, 0x34, 0x27, 0x28, 0x48, 0x43, 0x74, 0x75, 0x6a, 0x6b,
    0xa7, 0x8c, 0x88, 0x97, 0x83, 0x84, 0xa8, 0xab, 0x93, 0xa4, 0x98, 0x102, 0x103, 0x11a, 0x11b, 0x112, 0x113,
    0x114, 0x115, 0x116, 0x117, 0x128, 0x129, 0x12a, 0x12b, 0x12c, 0x12d, 0x104, 0x105, 0x10a, 0x10b, 0x152,
    0x153, 0x154, 0x155, 0x124, 0x125, 0x158, 0x159, 0x15a, 0x15b, 0x14a, 0x14b, 0x132, 0x133, 0x134, 0x3b, 0x32,
    0x57, 0xb7, 0x136, 0x137, 0x164, 0x165, 0x168, 0x167, 0x2cc, 0x2cd, 0x2d2, 0x2d3, 0x2d4, 0x2d5, 0x2d6, 0x2d7,
    0x2d8, 0x2d9, 0x2da, 0x2db, 0x298, 0x299, 0x29a, 0x58, 0x29b,
];
#[rustfmt::skip]
const BLACK: [u16; 91] = [
    0x437, 0xa, 0x7, 0x6, 0xb, 0x13, 0x12, 0x23, 0x45, 0x44, 0x84, 0x85, 0x87, 0x104, 0x107, 0x218, 0x417, 0x418,
    0x408, 0x867, 0x868, 0x86c, 0x837, 0x828, 0x817, 0x818, 0x10ca, 0x10cb, 0x10cc, 0x10cd, 0x1068, 0x1069, 0x106a,
    0x106b, 0x10d2, 0x10d3, 0x10d4, 0x10d5, 0x10d6, 0x10d7, 0x106c, 0x106d, 0x10da, 0x10db, 0x1054, 0x1055, 0x1056,
    0x1057, 0x1064, 0x1065, 0x1052, 0x1053, 0x1024, 0x1037, 0x1038, 0x1027, 0x1028, 0x1058, 0x1059, 0x102b, 0x102c,
    0x105a, 0x1066, 0x1067, 0x40f, 0x10c8, 0x10c9, 0x105b, 0x1033, 0x1034, 0x1035, 0x206c, 0x206d, 0x204a, 0x204b,
    0x204c, 0x204d, 0x2072, 0x2073, 0x2074, 0x2075, 0x2076, 0x2077, 0x2052, 0x2053, 0x2054, 0x2055, 0x205a, 0x205b,
    0x2064, 0x2065,
];
/// The same of 1792, 1856 ... 2560 pixels of either colour.
const LONG: [u16; 13] =
    [0x808, 0x80c, 0x80d, 0x1012, 0x1013, 0x1014, 0x1015, 0x1016, 0x1017, 0x101c, 0x101d, 0x101e, 0x101f];

/// Bits of the longest code of a run.
const LONGEST: u32 = 13;

/// The length of the code that 13 bits begin with, and its run; 0 bits for no code. White and black.
static RUNS: LazyLock<[Vec<(u8, u16)>; 2]> = LazyLock::new(|| {
    [WHITE, BLACK].map(|codes| {
        let mut runs = vec![(0, 0); 1 << LONGEST];
        let short = codes.into_iter().zip((0..64).chain((64..).step_by(64)));
        for (code, run) in short.chain(LONG.into_iter().zip((1792..).step_by(64))) {
            let bits = code.ilog2();
            let first = usize::from(code ^ 1 << bits) << (LONGEST - bits);
            runs[first..first + (1 << (LONGEST - bits))].fill((bits as u8, run));
        }
        runs
    })
});

/// The options of Group 3, the tag T4Options; modified Huffman rows have none.
#[derive(Clone, Copy)]
pub(super) enum Fax {
    ModifiedHuffman,
    Group3 { options: u64 },
}

/// Appends rows of 1-bit pixels, 1 for black, up to a length of the list or the first code that is wrong.
pub(super) fn unpack(packed: &[u8], form: Fax, width: usize, limit: usize, plain: &mut Vec<u8>) {
    const TWO_DIMENSIONAL: u64 = 1;
    let mut bits = Bits { bytes: packed, at: 0 };
    // The first row compares with an imaginary white one, which has no changes (ITU-T T.4).
    let mut above = Vec::new();
    while plain.len() < limit {
        let mut is_coded_alone = true;
        match form {
            // Rows of this form begin at whole bytes.
            Fax::ModifiedHuffman => bits.at = bits.at.next_multiple_of(8),
            Fax::Group3 { options } => {
                let has_end_of_line = bits.skip_end_of_line();
                if options & TWO_DIMENSIONAL != 0 && has_end_of_line {
                    is_coded_alone = bits.take(1) == 1;
                }
                // Two of them are behind the last row.
                if has_end_of_line && bits.peek(11) == 0 {
                    return;
                }
            }
        }
        let row = if is_coded_alone { bits.row(width) } else { bits.row_below(&above, width) };
        let Some(row) = row else { return };
        let start = plain.len();
        plain.resize(start + width.div_ceil(8), 0);
        // Changes alternate: the first black column, then the first white one behind it.
        for run in row.chunks(2) {
            let end = run.get(1).map_or(width, |&end| end);
            (run[0]..end).for_each(|col| plain[start + col / 8] |= 0x80 >> (col % 8));
        }
        above = row;
    }
}

/// Bits of bytes, the highest first, and zeros behind them.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    fn peek(&self, bits: u32) -> usize {
        let byte = |offset| self.bytes.get(self.at / 8 + offset).map_or(0, |&byte| usize::from(byte));
        let three = byte(0) << 16 | byte(1) << 8 | byte(2);
        three >> (24 - bits as usize - self.at % 8) & ((1 << bits) - 1)
    }

    fn take(&mut self, bits: u32) -> usize {
        let taken = self.peek(bits);
        self.at += bits as usize;
        taken
    }

    /// Skips fill bits and an end-of-line code, if they are next: no code of a run begins with eight zeros.
    fn skip_end_of_line(&mut self) -> bool {
        if self.peek(8) != 0 {
            return false;
        }
        while self.at < 8 * self.bytes.len() {
            if self.take(1) == 1 {
                return true;
            }
        }
        false
    }

    fn run(&mut self, is_black: bool) -> Option<usize> {
        let mut length = 0;
        loop {
            let (bits, run) = RUNS[usize::from(is_black)][self.peek(LONGEST)];
            self.at += usize::from(bits);
            length += usize::from(run);
            // No code begins with these bits, or they lie beyond the end.
            if bits == 0 || self.at > 8 * self.bytes.len() {
                return None;
            }
            // Runs of 64 pixels and more have a code for their multiple of 64, and one for the rest.
            if run < 64 {
                return Some(length);
            }
        }
    }

    /// Returns the columns at which the colour of a row changes, the first to black.
    fn row(&mut self, width: usize) -> Option<Vec<usize>> {
        let mut changes = ColourChanges::default();
        let mut col = 0;
        while col < width {
            col += self.run(changes.is_black)?;
            changes.push(col, width)?;
        }
        Some(changes.columns)
    }

    /// Does the same for a row that is coded by its differences from the one above.
    fn row_below(&mut self, above: &[usize], width: usize) -> Option<Vec<usize>> {
        /// The codes of a change 0, 1, 2 and 3 columns right of that above, and left: see [`WHITE`].
        const VERTICAL: [[usize; 4]; 2] =
            [[0b11, 0b1011, 0b100_0011, 0b1000_0011], [0b11, 0b1010, 0b100_0010, 0b1000_0010]];
        const PASS: usize = 0b10001;
        const HORIZONTAL: usize = 0b1001;
        let mut changes = ColourChanges::default();
        // The row begins left of its first pixel, so that a change above that pixel counts.
        let mut col: Option<usize> = None;
        while col.is_none_or(|col| col < width) {
            let next = above.partition_point(|&change| col.is_some_and(|col| change <= col));
            // Only changes away from the colour of this row count.
            let next = next + usize::from((next % 2 == 1) != changes.is_black);
            let change_above = |place: usize| above.get(place).map_or(width, |&change| change);
            // The leading 1 keeps zeros at the front of a code, which would be lost in a number.
            let mut code = 1;
            col = Some(loop {
                code = code << 1 | self.take(1);
                if code == PASS {
                    break change_above(next + 1);
                }
                if code == HORIZONTAL {
                    let middle = col.unwrap_or(0) + self.run(changes.is_black)?;
                    changes.push(middle, width)?;
                    let end = middle + self.run(changes.is_black)?;
                    changes.push(end, width)?;
                    break end;
                }
                let offset = |side: usize| VERTICAL[side].iter().position(|&vertical| vertical == code);
                let change = match (offset(0), offset(1)) {
                    (Some(right), _) => change_above(next) + right,
                    (None, Some(left)) => change_above(next).checked_sub(left)?,
                    // The longest code has seven bits after the 1 that stands before all codes.
                    (None, None) if code < 0x80 => continue,
                    (None, None) => return None,
                };
                changes.push(change, width)?;
                break change;
            });
        }
        Some(changes.columns)
    }
}

/// The columns at which the colour of a row changes, in ascending order.
#[derive(Default)]
struct ColourChanges {
    columns: Vec<usize>,
    is_black: bool,
}

impl ColourChanges {
    /// Appends a change; with one at the same column it is none. `None` if it lies left of the last or beyond the row.
    fn push(&mut self, col: usize, width: usize) -> Option<()> {
        self.is_black = !self.is_black;
        match self.columns.last() {
            Some(&last) if last > col => return None,
            Some(&last) if last == col => _ = self.columns.pop(),
            _ => self.columns.push(col),
        }
        (col <= width).then_some(())
    }
}
