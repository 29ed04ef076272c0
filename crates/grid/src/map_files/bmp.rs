//! BMP images: what their headers say, and their pixels.
//!
//! Files of Windows since version 2 and of OS/2 version 1 are read: pixels of 1, 2, 4 and 8 bits with a palette, in runs or
//! not, and of 16, 24 and 32 bits, with masks of their colours or without.
//!
//! Sources: Microsoft, "Bitmap Header Types", "Bitmap Compression" and "BITMAPV5HEADER structure", Windows App Development,
//! 2021.

use std::ops::Range;

use crate::map_files::Fault;
use crate::map_files::decoded::damaged;

/// Where a header begins, which opens with its size, and where masks of colours are, within it or behind it.
const HEADER: usize = 14;
const MASKS: usize = 54;

/// The sizes of a header: of OS/2, and of Windows in its versions, which have a mask for alpha from `WITH_ALPHA` on.
const SIZES: [usize; 6] = [OS_2, 40, 52, WITH_ALPHA, 108, 124];
const OS_2: usize = 12;
const WITH_ALPHA: usize = 56;

/// The ways of packing pixels: none, runs of bytes, runs of half bytes, none but with masks.
const PLAIN: u32 = 0;
const RUNS_OF_8: u32 = 1;
const RUNS_OF_4: u32 = 2;
const MASKED: u32 = 3;

/// An image whose header was read.
pub(super) struct Bmp<'a> {
    pub rows: usize,
    pub cols: usize,
    is_top_down: bool,
    bits: usize,
    packing: u32,
    palette: [[u8; 3]; 256],
    /// The bits of a pixel that are red, green and blue, and those of its alpha if it has one.
    masks: Vec<u32>,
    packed: &'a [u8],
}

impl<'a> Bmp<'a> {
    pub fn parse(bytes: &'a [u8]) -> Result<Self, Fault> {
        let size = number(bytes, HEADER, 4)? as usize;
        if size > OS_2 && !SIZES.contains(&size) {
            return Err(unread(&format!("its header has {size} bytes")));
        }
        let is_windows = size > OS_2;
        if bytes.len() < HEADER + size.min(40) {
            return Err(cut_off());
        }
        let side = if is_windows { 4 } else { 2 };
        let cols = number(bytes, 18, side)? as i32;
        let rows = number(bytes, 18 + side, side)? as i32;
        let planes = number(bytes, 18 + 2 * side, 2)?;
        let bits = number(bytes, 20 + 2 * side, 2)?;
        let packing = if is_windows { number(bytes, 30, 4)? } else { PLAIN };
        match (packing, bits) {
            _ if size < OS_2 || cols < 0 || planes != 1 => return Err(damaged("its header makes no sense")),
            (RUNS_OF_8, 8) | (RUNS_OF_4, 4) if rows < 0 => return Err(damaged("runs of pixels go up, not down")),
            (PLAIN, 1 | 4 | 8 | 24) | (RUNS_OF_8, 8) | (RUNS_OF_4, 4) => {}
            (PLAIN, 2 | 16 | 32) | (MASKED, 16 | 32) if is_windows => {}
            (4, _) => return Err(unread("its pixels are compressed as JPEG")),
            (5, _) => return Err(unread("its pixels are compressed as PNG")),
            (11..=13, _) => return Err(unread("its colours are CMYK")),
            _ => return Err(damaged(format!("pixels of {bits} bits cannot be packed in way {packing}"))),
        }
        let masks = match (packing, bits) {
            (MASKED, _) => read_masks(bytes, if size >= WITH_ALPHA { 4 } else { 3 }, bits)?,
            (_, 16) => vec![0x7C00, 0x3E0, 0x1F],
            _ => vec![0xFF_0000, 0xFF00, 0xFF],
        };
        let mut palette = [[0; 3]; 256];
        if bits <= 8 {
            let stated = if is_windows { number(bytes, 46, 4)? as usize } else { 0 };
            let colours = if stated == 0 { 1 << bits } else { stated };
            if colours > 1 << bits {
                return Err(damaged(format!("{colours} colours are more than {bits} bits can tell apart")));
            }
            let entry = if is_windows { 4 } else { 3 };
            let entries = bytes.get(HEADER + size..HEADER + size + colours * entry).ok_or_else(cut_off)?;
            for (colour, entry) in palette.iter_mut().zip(entries.chunks_exact(entry)) {
                *colour = [entry[2], entry[1], entry[0]];
            }
        }
        Ok(Self {
            rows: rows.unsigned_abs() as usize,
            cols: cols as usize,
            is_top_down: rows < 0,
            bits: bits as usize,
            packing,
            palette,
            masks,
            packed: bytes.get(number(bytes, 10, 4)? as usize..).unwrap_or_default(),
        })
    }

    pub fn has_alpha(&self) -> bool {
        self.masks.len() == 4
    }

    /// Decodes all pixels, row by row from the upper one, red first.
    pub fn decode(&self, pixels: &mut [u8]) -> Result<(), Fault> {
        if self.packing == RUNS_OF_8 || self.packing == RUNS_OF_4 {
            return self.decode_runs(pixels);
        }
        let row_bytes = (self.bits * self.cols).div_ceil(32) * 4;
        let word = self.bits / 8;
        for row in 0..self.rows {
            let packed = self.packed.get(row * row_bytes..(row + 1) * row_bytes).ok_or_else(cut_off)?;
            if self.bits <= 8 {
                self.paint(pixels, row, 0..self.cols, packed);
                continue;
            }
            let samples = self.row_of(pixels, row).chunks_exact_mut(self.masks.len());
            for (samples, packed) in samples.zip(packed.chunks_exact(word)) {
                let word = number(packed, 0, word)?;
                samples.iter_mut().zip(&self.masks).for_each(|(sample, &mask)| *sample = masked(word, mask));
            }
        }
        Ok(())
    }

    /// Decodes runs: pairs of a count and a colour, or of 0 and a command. Pixels that are skipped stay black.
    fn decode_runs(&self, pixels: &mut [u8]) -> Result<(), Fault> {
        let mut rest = self.packed;
        let mut row = 0;
        let mut col = 0;
        while row < self.rows {
            let pair = rest.split_off(..2).ok_or_else(cut_off)?;
            let (count, packed) = match *pair {
                [0, 0] => {
                    row += 1;
                    col = 0;
                    continue;
                }
                [0, 1] => break,
                [0, 2] => {
                    let steps = rest.split_off(..2).ok_or_else(cut_off)?;
                    row += usize::from(steps[1]);
                    col += usize::from(steps[0]);
                    if row >= self.rows || col > self.cols && *steps != [0, 0] {
                        return Err(damaged("it skips more pixels than it has"));
                    }
                    continue;
                }
                [0, count] => {
                    let bytes = (usize::from(count) * self.bits).div_ceil(8).next_multiple_of(2);
                    (usize::from(count), rest.split_off(..bytes).ok_or_else(cut_off)?)
                }
                _ => (usize::from(pair[0]), &pair[1..]),
            };
            let end = col + count;
            // ImageMagick writes runs of bytes that are longer than their row, which programs cut off.
            let is_cut = pair[0] > 0 && self.packing == RUNS_OF_8;
            if end > self.cols && !is_cut {
                return Err(damaged("a run of pixels is longer than its row"));
            }
            self.paint(pixels, row, col..end.min(self.cols), packed);
            col = end;
        }
        Ok(())
    }

    /// Gives some pixels of a row their colours of the palette, whose numbers begin again where they end.
    fn paint(&self, pixels: &mut [u8], row: usize, cols: Range<usize>, packed: &[u8]) {
        let row = &mut self.row_of(pixels, row)[3 * cols.start.min(cols.end)..3 * cols.end];
        for (index, pixel) in row.chunks_exact_mut(3).enumerate() {
            let bit = index * self.bits;
            let colour = packed[bit / 8 % packed.len()] << (bit % 8) >> (8 - self.bits);
            pixel.copy_from_slice(&self.palette[usize::from(colour)]);
        }
    }

    /// The samples of a row, counted in the order of the file.
    fn row_of<'b>(&self, pixels: &'b mut [u8], row: usize) -> &'b mut [u8] {
        let row = if self.is_top_down { row } else { self.rows - 1 - row };
        let samples = self.cols * self.masks.len();
        &mut pixels[row * samples..(row + 1) * samples]
    }
}

/// Reads masks, of which alpha's may be empty and then is left out.
fn read_masks(bytes: &[u8], count: usize, bits: u32) -> Result<Vec<u32>, Fault> {
    let mut masks = Vec::new();
    for index in 0..count {
        let mask = number(bytes, MASKS + 4 * index, 4)?;
        let is_whole = mask.count_ones() + mask.leading_zeros() + mask.trailing_zeros() == u32::BITS;
        if mask == 0 && index == 3 {
            break;
        }
        if !is_whole || u64::from(mask) >> bits > 0 {
            return Err(damaged(format!("{mask:#X} is no mask of a colour in {bits} bits")));
        }
        masks.push(mask);
    }
    Ok(masks)
}

/// The bits below a mask, of which the 8 highest count, as a value from 0 to 255, rounded to the nearest.
fn masked(word: u32, mask: u32) -> u8 {
    let bits = mask.count_ones().min(8);
    let max = (1 << bits) - 1;
    let value = word >> (mask.trailing_zeros() + mask.count_ones() - bits) & max;
    ((value * 255 + max / 2) / max) as u8
}

fn number(bytes: &[u8], at: usize, size: usize) -> Result<u32, Fault> {
    let word = bytes.get(at..at + size).ok_or_else(cut_off)?;
    Ok(word.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
}

fn cut_off() -> Fault {
    damaged("the file ends before the image does")
}

fn unread(reason: &str) -> Fault {
    Fault::Unread { format: "BMP", reason: reason.to_owned() }
}
