//! Pixels from a decoder: their maximum number, and their grey values.

use std::fmt::Display;

use crate::Grid;
use crate::map_files::error::with_room;
use crate::map_files::pixel::{PixelLayout, Pixels};
use crate::map_files::{Fault, MAX_CELLS};

/// Most bytes of the decoded pixels: 16-bit grey on every cell of the largest map.
pub(super) const MAX_DECODED: u64 = 2 * MAX_CELLS as u64;

/// Most bytes of what is no pixel: colour profiles, texts, a row in the making.
pub(super) const MAX_EXTRAS: u64 = 1 << 24;

/// Deflate packs at most 1032 bytes into one (Jean-loup Gailly, Mark Adler, "zlib Technical Details", section "Maximum
/// Compression Factor"), and a pixel of 1 bit may become 4 bytes. Other ways of packing beat that with blank images only.
const MAX_RATIO: u64 = 1032 * 32;

/// An image as grey values, and what was made of it on the way, in sentences.
pub(super) struct GreyImage {
    pub grey: Grid<u8>,
    /// The transparent pixels, if they are [unknown](Transparency::Unknown).
    pub is_unknown: Option<Grid<bool>>,
    pub notes: Vec<String>,
}

/// Accepts the bytes that a header promises, before memory is taken for them: at most `limit`, and no more than a file
/// of `bytes` bytes can hold.
pub(super) fn check_decoded(decoded: u64, limit: u64, bytes: u64, (rows, cols): (usize, usize)) -> Result<(), Fault> {
    if decoded > limit {
        return Err(Fault::ImageTooLarge { bytes: decoded, limit });
    }
    if decoded / MAX_RATIO > bytes {
        let message = format!("{bytes} bytes cannot hold a height of {rows} and a width of {cols}");
        return Err(Fault::Image { message });
    }
    Ok(())
}

/// Tells an image that is damaged from one of a kind that is not read, which decoders say in words.
pub(super) fn damaged(error: impl Display) -> Fault {
    // Some quote a sentence, or end a line with it.
    let message = error.to_string().trim_matches(['"', '\n']).to_owned();
    let text = message.to_lowercase();
    let of_unread = ["unsupported", "not supported", "unimplemented", "cannot yet decode"];
    let is_unread = of_unread.iter().any(|phrase| text.contains(phrase));
    if is_unread { Fault::Unread { format: "image", reason: message } } else { Fault::Image { message } }
}

/// The size of an image in pixels and the samples of a pixel, from its header.
#[derive(Clone, Copy)]
pub(super) struct ImageHeader {
    pub rows: usize,
    pub cols: usize,
    pub layout: PixelLayout,
}

impl ImageHeader {
    pub fn bytes_per_row(self) -> u64 {
        let bytes_per_sample = if self.layout.max > 255 { 2 } else { 1 };
        self.cols as u64 * self.layout.channels() as u64 * bytes_per_sample
    }

    /// The bytes of all pixels; the size need not have been checked.
    pub fn bytes(self) -> u64 {
        self.bytes_per_row().saturating_mul(self.rows as u64)
    }

    /// Takes memory for all pixels, whose bytes were checked, and decodes them.
    pub fn decode(self, read: impl FnOnce(&mut [u8]) -> Result<(), Fault>) -> Result<Vec<u8>, Fault> {
        let mut pixels = with_room(self.bytes() as usize)?;
        pixels.resize(self.bytes() as usize, 0);
        read(&mut pixels)?;
        Ok(pixels)
    }

    /// Replaces samples by those of a row, which are bytes, or words with the higher byte first.
    pub fn unpack(self, row: &[u8], samples: &mut Vec<u16>) {
        samples.clear();
        if self.layout.max > 255 {
            samples.extend(row.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])));
        } else {
            samples.extend(row.iter().map(|&byte| u16::from(byte)));
        }
    }

    /// Decodes all pixels, whose bytes were checked, as grey values.
    pub fn decode_grey(
        self,
        notes: Vec<String>,
        read: impl FnOnce(&mut [u8]) -> Result<(), Fault>,
    ) -> Result<GreyImage, Fault> {
        let data = self.decode(read)?;
        // The bytes of the commonest kind of image are its grey values already and need no second copy.
        if self.layout == PixelLayout::EIGHT_BIT_GREY {
            return Ok(GreyImage { grey: Grid::from_values(self.rows, self.cols, data), is_unknown: None, notes });
        }
        let mut pixels = Pixels::with_room(self.layout, self.rows * self.cols)?;
        let mut samples = Vec::new();
        for row in data.chunks_exact(self.bytes_per_row() as usize) {
            self.unpack(row, &mut samples);
            pixels.append(&samples);
        }
        Ok(pixels.into_image(self.rows, self.cols, notes))
    }
}

/// Turns an image as the tag of its camera or scanner says, so that it is read as programs show it; adds a note if that
/// changes it.
///
/// Source: Adobe Developers Association, "TIFF Revision 6.0", 1992, section 8, tag 274; Exif has the same.
pub(super) fn turned(mut image: GreyImage, orientation: Option<u64>) -> GreyImage {
    if let Some(orientation @ 2..=8) = orientation {
        image.notes.push("the image was turned as its orientation tag says".to_owned());
        image.grey = turned_grid(&image.grey, orientation);
        image.is_unknown = image.is_unknown.map(|is_unknown| turned_grid(&is_unknown, orientation));
    }
    image
}

fn turned_grid<T: Copy>(grid: &Grid<T>, orientation: u64) -> Grid<T> {
    let is_transposed = orientation >= 5;
    let is_from_below = matches!(orientation, 3 | 4 | 6 | 7);
    let is_from_right = matches!(orientation, 2 | 3 | 7 | 8);
    let [rows, cols] = if is_transposed { [grid.cols(), grid.rows()] } else { [grid.rows(), grid.cols()] };
    let mut values = Vec::with_capacity(rows * cols);
    for row in 0..rows {
        values.extend((0..cols).map(|col| {
            let [row, col] = if is_transposed { [col, row] } else { [row, col] };
            let row = if is_from_below { grid.rows() - 1 - row } else { row };
            let col = if is_from_right { grid.cols() - 1 - col } else { col };
            grid.row(row)[col]
        }));
    }
    Grid::from_values(rows, cols, values)
}
