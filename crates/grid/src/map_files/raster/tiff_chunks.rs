//! Decompression of strips and tiles of TIFF images that use LZW, Zstandard, or the older codes of faxes.
//!
//! The crate `tiff` undoes predictors and orders of bytes, but its reader of LZW refuses tiles that reach beyond the image
//! and strips without an end code, both of which GDAL writes or reads, its reader of Zstandard is not in Rust, and it knows
//! neither these faxes nor bytes whose lowest bit comes first. So the
//! file is written again in memory: behind its bytes come all chunks unpacked, and the tags point to these.
//!
//! Sources: Adobe Developers Association, "TIFF Revision 6.0", 1992, sections 13 (LZW) and 15 (tiles); number 50000 is that
//! of libtiff for Zstandard.

use std::borrow::Cow;
use std::io::{Cursor, Read};

use ruzstd::decoding::StreamingDecoder;
use tiff::TiffResult;
use tiff::decoder::{Decoder, Limits};

use super::tiff_fax::{self, Fax};
use super::tiff_header::{
    BITS, COMPRESSION, LENGTH, PLANAR, ROWS_PER_STRIP, SAMPLES, TILE_LENGTH, TILE_WIDTH, TiffHead, WIDTH,
};

/// Where strips and tiles begin, and their bytes.
const STRIPS: [u16; 2] = [273, 279];
const TILES: [u16; 2] = [324, 325];

/// The order of bits within bytes, and that in which the lowest bit comes first; the options of Group 3.
const FILL_ORDER: u16 = 266;
const LOWEST_FIRST: usize = 2;
const T4_OPTIONS: u16 = 292;

const NOT_PACKED: u32 = 1;
const MODIFIED_HUFFMAN: u64 = 2;
const GROUP_3: u64 = 3;
const LZW: u64 = 5;
const ZSTANDARD: u64 = 50_000;

/// Codes of LZW that stand for no string.
const CLEAR: usize = 256;
const END: usize = 257;
/// The number of strings that codes of at most 12 bits have.
const MAX_STRINGS: usize = 4096;

pub(in crate::map_files) type TiffDecoder<'a> = Decoder<Cursor<Cow<'a, [u8]>>>;

/// Opens an image whose strips and tiles the crate `tiff` can read, with buffers of at most `max` bytes.
///
/// # Errors
/// Returns a sentence with the place of a chunk that is damaged or ends early; inside, the error of the decoder.
pub(in crate::map_files) fn open(bytes: &[u8], max: usize) -> Result<TiffResult<TiffDecoder<'_>>, String> {
    let plain = unpack(bytes, 2 * max)?.map_or(Cow::Borrowed(bytes), Cow::Owned);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = max;
    limits.intermediate_buffer_size = max;
    Ok(Decoder::new(Cursor::new(plain)).map(|decoder| decoder.with_limits(limits)))
}

/// Returns the file with unpacked chunks if they are packed in a way that is read here, at most `max` bytes of them, and
/// with the highest bit of each byte first.
///
/// `None` if there is nothing to do, or the head is damaged in a way that a decoder will name.
///
/// # Errors
/// Returns a sentence with the place of a chunk that is damaged or ends early.
fn unpack(bytes: &[u8], max: usize) -> Result<Option<Vec<u8>>, String> {
    let Some(head) = TiffHead::find(bytes) else { return Ok(None) };
    let number = |tag| head.entry(bytes, tag).and_then(|entry| entry.value).map(|number| number as usize);
    let packing = number(COMPRESSION).unwrap_or_default() as u64;
    let is_packed = [MODIFIED_HUFFMAN, GROUP_3, LZW, ZSTANDARD].contains(&packing);
    let is_lowest_first = number(FILL_ORDER) == Some(LOWEST_FIRST);
    let (Some(cols), Some(rows), true) = (number(WIDTH), number(LENGTH), is_packed || is_lowest_first) else {
        return Ok(None);
    };
    let (tags, width, height) = match (number(TILE_WIDTH), number(TILE_LENGTH)) {
        (Some(width), Some(height)) => (TILES, width, height),
        _ => (STRIPS, cols, number(ROWS_PER_STRIP).unwrap_or(rows).min(rows)),
    };
    let [Some(offsets), Some(counts)] = tags.map(|tag| head.numbers(bytes, tag)) else { return Ok(None) };
    // In planes, a chunk holds one band only.
    let samples = if number(PLANAR) == Some(2) { 1 } else { number(SAMPLES).unwrap_or(1) };
    // Checked, as a header may claim any size.
    let bits = width.checked_mul(samples).and_then(|samples| samples.checked_mul(number(BITS).unwrap_or(1)));
    let row_bytes = bits.map(|bits| bits.div_ceil(8));
    let is_sound = cols > 0 && rows > 0 && width > 0 && height > 0 && offsets.len() == counts.len();
    let (Some(row_bytes), true) = (row_bytes, is_sound) else { return Ok(None) };

    // Plain chunks are appended, so that all other offsets in the file stay right.
    let mut plain = bytes.to_vec();
    let across = cols.div_ceil(width);
    let down = rows.div_ceil(height);
    let (mut starts, mut sizes) = (Vec::new(), Vec::new());
    for (chunk, (&offset, &count)) in offsets.iter().zip(&counts).enumerate() {
        // Chunks of the next plane begin in the north-west again.
        let row = chunk / across % down * height;
        let col = chunk % across * width;
        let wrong = |reason: &str| Err(format!("row {row}, column {col}: {reason}"));
        let end = offset.checked_add(count).filter(|&end| end <= bytes.len() as u64);
        let Some(end) = end else { return wrong("its cells lie beyond the end of the file") };
        let mut packed = Cow::Borrowed(&bytes[offset as usize..end as usize]);
        if is_lowest_first {
            packed.to_mut().iter_mut().for_each(|byte| *byte = byte.reverse_bits());
        }
        // The last strip is shorter, tiles never are.
        let chunk_rows = if tags == STRIPS { height.min(rows - row) } else { height };
        let needed = match packed.len() {
            length if length == 0 || !is_packed => Some(length),
            _ => row_bytes.checked_mul(chunk_rows),
        };
        let start = plain.len();
        let limit = needed.map(|needed| start.saturating_add(needed));
        // Chunks are pointed to by numbers of 32 bits.
        let Some(limit) = limit.filter(|limit| limit - bytes.len() <= max && u32::try_from(*limit).is_ok()) else {
            return Err(format!("its cells take more than {max} bytes"));
        };
        match packing {
            _ if packed.is_empty() => {}
            LZW => unpack_lzw(&packed, limit, &mut plain),
            MODIFIED_HUFFMAN => tiff_fax::unpack(&packed, Fax::ModifiedHuffman, width, limit, &mut plain),
            GROUP_3 => {
                let options = number(T4_OPTIONS).unwrap_or_default() as u64;
                tiff_fax::unpack(&packed, Fax::Group3 { options }, width, limit, &mut plain);
            }
            ZSTANDARD => {
                // A cut at its end is found below.
                let stream = StreamingDecoder::new(&packed[..]).map_err(|error| error.to_string());
                let unpacked = stream.and_then(|stream| {
                    stream.take((limit - start) as u64).read_to_end(&mut plain).map_err(|error| error.to_string())
                });
                if let Err(reason) = unpacked {
                    return wrong(&reason);
                }
            }
            _ => plain.extend_from_slice(&packed),
        }
        if plain.len() < limit {
            return wrong("its compressed cells end early, or are damaged");
        }
        // A chunk without bytes was left out by GDAL, and must still look like that to the decoder.
        starts.push(if packed.is_empty() { 0 } else { start as u32 });
        sizes.push((limit - start) as u32);
    }
    if is_packed {
        head.put(&mut plain, COMPRESSION, &[NOT_PACKED]);
    }
    head.put(&mut plain, tags[0], &starts);
    head.put(&mut plain, tags[1], &sizes);
    Ok(Some(plain))
}

/// Appends what codes stand for, up to a length of the list, an end code or the first code that is wrong.
///
/// A string is one from before and the byte after it. Both were written one behind the other, so that a string is a range
/// of what is unpacked.
fn unpack_lzw(packed: &[u8], limit: usize, plain: &mut Vec<u8>) {
    let mut strings: Vec<(usize, usize)> = Vec::with_capacity(MAX_STRINGS);
    let mut before: Option<(usize, usize)> = None;
    // Bits that were read and not used yet, right-aligned.
    let mut kept = 0_u32;
    let mut kept_bits = 0;
    let mut rest = packed.iter();
    while plain.len() < limit {
        // Codes become longer one string before they have to.
        let bits = match END + 1 + strings.len() {
            ..511 => 9,
            511..1023 => 10,
            1023..2047 => 11,
            _ => 12,
        };
        while kept_bits < bits {
            let Some(&byte) = rest.next() else { return };
            (kept, kept_bits) = (kept << 8 | u32::from(byte), kept_bits + 8);
        }
        kept_bits -= bits;
        let code = (kept >> kept_bits) as usize;
        kept &= (1 << kept_bits) - 1;
        if code == CLEAR {
            strings.clear();
            before = None;
            continue;
        }
        // Added before the code is looked up: a code may stand for the very string that it completes.
        if let Some((start, length)) = before.filter(|_| strings.len() + END + 1 < MAX_STRINGS) {
            strings.push((start, length + 1));
        }
        let start = plain.len();
        let length = match code {
            END => return,
            0..=255 => {
                plain.push(code as u8);
                1
            }
            _ => {
                let Some(&(from, length)) = strings.get(code - END - 1) else { return };
                let length = length.min(limit - start);
                // One by one: a string may end with the byte that this one begins with.
                (from..from + length).for_each(|at| plain.push(plain[at]));
                length
            }
        };
        before = Some((start, length));
    }
}
