//! The header of a TIFF image, checked before a decoder sees it.
//!
//! A decoder multiplies and allocates what a head says. This reads the few tags that sizes follow from, in classic TIFF
//! and in BigTIFF, and refuses what no raster of ours can be.
//!
//! Source: Adobe Developers Association, "TIFF Revision 6.0", 1992, section 2.

use super::{RasterFault, check_bands, check_size};

pub(super) const WIDTH: u16 = 256;
pub(super) const LENGTH: u16 = 257;
pub(super) const BITS: u16 = 258;
pub(super) const COMPRESSION: u16 = 259;
const PHOTOMETRIC: u16 = 262;
pub(super) const SAMPLES: u16 = 277;
pub(super) const ROWS_PER_STRIP: u16 = 278;
pub(super) const PLANAR: u16 = 284;
pub(super) const TILE_WIDTH: u16 = 322;
pub(super) const TILE_LENGTH: u16 = 323;
const SAMPLE_FORMAT: u16 = 339;

/// The ways of packing that are read: none, Group 4, LZW, Deflate by either number, PackBits, Zstandard.
const READ_PACKINGS: [u64; 7] = [1, 4, 5, 8, 32_946, 32_773, 50_000];

/// The number of grey values among the photometric interpretations.
const GREY: u8 = 1;
/// The last of them whose numbers GDAL does not convert: white or black is 0, red, green and blue, a palette, a mask.
const MAX_PLAIN_COLOURS: u64 = 4;

/// The tag that says what an image of a file is: a smaller one of another, a mask.
const KIND: u16 = 254;
const IS_OVERVIEW: u64 = 1;
const IS_MASK: u64 = 4;

/// The most images of a file that are looked at.
const MAX_IMAGES: usize = 64;

/// The longest side of a tile.
const MAX_TILE_SIDE: u64 = 1 << 14;

/// Most bytes that one packed byte can stand for, by any of the ways of packing that are read: 128 KiB in a block of four
/// bytes (Collet, Kucherawy, "Zstandard Compression", RFC 8878, 2021, section 3.1.1.2).
const MAX_RATIO: usize = 1 << 15;

/// The most tags of a head.
const MAX_TAGS: u64 = 4096;

/// Returns whether a file begins as a TIFF image does, of the classic kind or a BigTIFF.
pub(in crate::map_files) fn is_start(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|signature| bytes.starts_with(*signature))
}

/// Rows, columns and bands of an image that a decoder may have.
pub(super) struct TiffSize {
    pub rows: usize,
    pub cols: usize,
    pub bands: usize,
    /// The bits of a number.
    pub bits: usize,
    /// The place in the file's list of an image of the same size that says where there are data.
    pub mask: Option<usize>,
}

/// Checks the head of the first image, and makes colours grey, in its mask too: colours are for showing, the numbers are
/// what counts.
pub(super) fn check(bytes: &mut [u8]) -> Result<TiffSize, RasterFault> {
    let head = TiffHead::find(bytes).ok_or_else(cut_off)?;
    let number = |tag| head.number(bytes, tag);
    let required = |tag, name: &str| {
        number(tag)?.ok_or_else(|| RasterFault::Damaged { message: format!("its header does not give its {name}") })
    };
    let rows = required(LENGTH, "length")?;
    let cols = required(WIDTH, "width")?;
    check_size(rows, cols)?;
    let bands = number(SAMPLES)?.unwrap_or(1);
    check_bands(rows, cols, bands)?;
    if number(PLANAR)?.is_some_and(|planar| planar > 2) || number(ROWS_PER_STRIP)? == Some(0) {
        return Err(RasterFault::Damaged { message: "its header gives an unknown layout".into() });
    }
    for tag in [TILE_WIDTH, TILE_LENGTH] {
        if number(tag)?.is_some_and(|side| !(1..=MAX_TILE_SIDE).contains(&side)) {
            let message = format!("a side of its tiles is not 1 to {MAX_TILE_SIDE} cells");
            return Err(RasterFault::Damaged { message });
        }
    }
    if let (Some(width), Some(length)) = (number(TILE_WIDTH)?, number(TILE_LENGTH)?)
        && width * length > super::MAX_RASTER_CELLS as u64
    {
        return Err(RasterFault::Damaged { message: format!("tiles of {width} x {length} cells are too large") });
    }
    let packing = number(COMPRESSION)?.unwrap_or(1);
    if !READ_PACKINGS.contains(&packing) {
        let name = match packing {
            6 | 7 => "JPEG",
            34_887 => "LERC",
            34_925 => "LZMA",
            50_001 => "WebP",
            _ => "an unknown kind",
        };
        let message = format!(
            "its cells are compressed by {name} (number {packing}); gdal_translate -co COMPRESS=DEFLATE in.tif \
             out.tif makes a supported file"
        );
        return Err(RasterFault::Unfit { message });
    }
    let rows = rows as usize;
    let cols = cols as usize;
    let bands = bands as usize;
    let bits = number(BITS)?.unwrap_or(1).min(64) as usize;
    // Whole numbers with and without sign, floating-point numbers, and what is not said.
    if number(SAMPLE_FORMAT)?.is_some_and(|format| !(1..=4).contains(&format)) {
        let message = "its numbers are complex; gdal_translate -ot Float32 in.tif out.tif takes the real ones";
        return Err(RasterFault::Unfit { message: message.into() });
    }
    if !bits.is_power_of_two() {
        let message = format!("its numbers have {bits} bits; gdal_translate -ot Float32 in.tif out.tif converts them");
        return Err(RasterFault::Unfit { message });
    }
    // No packing that is read shrinks more, so a few bytes cannot claim memory for billions of cells.
    if rows * (cols * bands * bits).div_ceil(8) / MAX_RATIO > bytes.len() {
        return Err(RasterFault::TooShort { bytes: bytes.len(), rows, cols });
    }
    if number(PHOTOMETRIC)?.is_some_and(|kind| kind > MAX_PLAIN_COLOURS) {
        let message = "its numbers are colours for printing or for films; gdal_translate in.tif out.tif converts them";
        return Err(RasterFault::Unfit { message: message.into() });
    }
    head.make_grey(bytes);
    let mut mask = None;
    let mut offset = head.next;
    // Bounded, as a file may close its list of images to a circle.
    for place in 1..MAX_IMAGES {
        let Some(head) = TiffHead::at(bytes, offset) else { break };
        let is_mask = head.number(bytes, KIND)?.is_some_and(|kind| kind & IS_MASK != 0 && kind & IS_OVERVIEW == 0);
        let size = [head.number(bytes, LENGTH)?, head.number(bytes, WIDTH)?];
        if is_mask && size == [Some(rows as u64), Some(cols as u64)] {
            // Only the first image of a file is unpacked here, and the decoder lacks what these two need.
            if [5, 50_000].contains(&head.number(bytes, COMPRESSION)?.unwrap_or(1)) {
                let message = "its mask is packed by LZW or Zstandard; gdal_translate --config \
                     GDAL_TIFF_INTERNAL_MASK YES -co COMPRESS=DEFLATE in.tif out.tif makes a supported file";
                return Err(RasterFault::Unfit { message: message.into() });
            }
            head.make_grey(bytes);
            mask = Some(place);
            break;
        }
        offset = head.next;
    }
    Ok(TiffSize { rows, cols, bands, bits, mask })
}

fn cut_off() -> RasterFault {
    RasterFault::Damaged { message: "the file ends within its header".into() }
}

/// The place of the first list of tags.
pub(super) struct TiffHead {
    is_little: bool,
    is_big_tiff: bool,
    first: usize,
    tags: usize,
    /// Where the list of tags of the next image begins; 0 if there is none.
    next: usize,
}

/// A tag of numbers: their size and count, and the first of them with the places of it and of its lowest byte.
pub(super) struct TiffEntry {
    pub value: Option<u64>,
    at: usize,
    size: usize,
    count: u64,
    value_at: usize,
    low_byte: usize,
}

impl TiffHead {
    pub fn find(bytes: &[u8]) -> Option<Self> {
        let is_little = bytes.starts_with(b"II");
        let is_big_tiff = bytes.get(2..4)?.contains(&b'+');
        let head = Self { is_little, is_big_tiff, first: 0, tags: 0, next: 0 };
        let offset = if is_big_tiff { head.read(bytes, 8, 8)? } else { head.read(bytes, 4, 4)? };
        Self::at(bytes, usize::try_from(offset).ok()?)
    }

    /// Finds the list of tags that begins at an offset.
    fn at(bytes: &[u8], offset: usize) -> Option<Self> {
        let is_little = bytes.starts_with(b"II");
        let is_big_tiff = bytes.get(2..4)?.contains(&b'+');
        let mut head = Self { is_little, is_big_tiff, first: 0, tags: 0, next: 0 };
        let count_size = if is_big_tiff { 8 } else { 2 };
        let tags = head.read(bytes, Some(offset).filter(|&offset| offset > 0 && offset < bytes.len())?, count_size)?;
        if tags > MAX_TAGS {
            return None;
        }
        head.first = offset + count_size;
        head.tags = tags as usize;
        let end = head.first + head.tags * head.entry_size();
        let next = head.read(bytes, end, if is_big_tiff { 8 } else { 4 }).unwrap_or(0);
        head.next = usize::try_from(next).unwrap_or(0);
        (end <= bytes.len()).then_some(head)
    }

    /// Turns whatever colours an image has into grey values, so that its numbers are read as they are.
    fn make_grey(&self, bytes: &mut [u8]) {
        if let Some(entry) = self.entry(bytes, PHOTOMETRIC).filter(|entry| entry.value.is_some_and(|it| it < 256)) {
            bytes[entry.low_byte] = GREY;
        }
    }

    fn entry_size(&self) -> usize {
        if self.is_big_tiff { 20 } else { 12 }
    }

    fn read(&self, bytes: &[u8], at: usize, size: usize) -> Option<u64> {
        let word = bytes.get(at..at.checked_add(size)?)?;
        let join = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        Some(if self.is_little { word.iter().rev().fold(0, join) } else { word.iter().fold(0, join) })
    }

    /// Finds a tag; of two with the same number the last counts, as in decoders.
    pub fn entry(&self, bytes: &[u8], tag: u16) -> Option<TiffEntry> {
        let places = (0..self.tags).rev().map(|index| self.first + index * self.entry_size());
        let at = places.into_iter().find(|&at| self.read(bytes, at, 2) == Some(tag.into()))?;
        // Types of whole numbers without a sign: bytes, shorts, longs, offsets, and those of 64 bits in a BigTIFF.
        let size = match self.read(bytes, at + 2, 2)? {
            1 => 1,
            3 => 2,
            4 | 13 => 4,
            16 | 18 => 8,
            _ => 0,
        };
        let (field, inline) = self.field(at);
        let count = self.read(bytes, at + 4, inline)?;
        let is_inline = count.checked_mul(size).is_some_and(|bytes| bytes <= inline as u64);
        let value_at = if is_inline { field } else { usize::try_from(self.read(bytes, field, inline)?).ok()? };
        let size = size as usize;
        let value = if size == 0 || count == 0 { None } else { self.read(bytes, value_at, size) };
        let low_byte = if self.is_little { value_at } else { value_at + size.saturating_sub(1) };
        Some(TiffEntry { value, at, size, count, value_at, low_byte })
    }

    /// Returns where an entry has its value, and the bytes that there are for it, as many as for its count.
    fn field(&self, at: usize) -> (usize, usize) {
        if self.is_big_tiff { (at + 12, 8) } else { (at + 8, 4) }
    }

    /// Returns all integers of a tag, if it exists and the file is long enough.
    pub fn numbers(&self, bytes: &[u8], tag: u16) -> Option<Vec<u64>> {
        let entry = self.entry(bytes, tag).filter(|entry| entry.value.is_some())?;
        let places = (0..usize::try_from(entry.count).ok()?).map(|place| entry.value_at + place * entry.size);
        places.map(|at| self.read(bytes, at, entry.size)).collect()
    }

    /// Replaces the numbers of an existing tag; they are appended to the file if they do not fit in place.
    pub fn put(&self, bytes: &mut Vec<u8>, tag: u16, numbers: &[u32]) {
        const LONG: u64 = 4;
        let Some(TiffEntry { at, .. }) = self.entry(bytes, tag) else { return };
        let (field, inline) = self.field(at);
        let list: Vec<u8> = numbers.iter().flat_map(|&number| self.word(number.into(), 4)).collect();
        let mut write = |at: usize, word: &[u8]| bytes[at..at + word.len()].copy_from_slice(word);
        write(at + 2, &self.word(LONG, 2));
        write(at + 4, &self.word(numbers.len() as u64, inline));
        if list.len() <= inline {
            write(field, &list);
        } else {
            let end = bytes.len();
            bytes[field..field + inline].copy_from_slice(&self.word(end as u64, inline));
            bytes.extend(list);
        }
    }

    /// Returns the bytes of a number.
    fn word(&self, number: u64, size: usize) -> Vec<u8> {
        if self.is_little { number.to_le_bytes()[..size].to_vec() } else { number.to_be_bytes()[8 - size..].to_vec() }
    }

    /// Returns the first number of a tag, `None` if there is no such tag.
    fn number(&self, bytes: &[u8], tag: u16) -> Result<Option<u64>, RasterFault> {
        let Some(entry) = self.entry(bytes, tag) else { return Ok(None) };
        entry
            .value
            .map(Some)
            .ok_or_else(|| RasterFault::Damaged { message: format!("its tag {tag} is not a whole number") })
    }
}
