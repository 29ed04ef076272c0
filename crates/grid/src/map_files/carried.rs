//! The map embedded in a picture of this program, so that pictures can be read as maps.
//!
//! A picture shows titles, numbers and legends beside the cells, which are drawn larger or smaller. Its cells therefore
//! follow the header of the PNG file, in a chunk of their own: rows and columns, each a number of 32 bits with its high
//! byte first, then a bit for each cell, row by row, packed by deflate. Other programs skip the chunk, and one that changes
//! the pixels drops it, as the case of its four letters demands ("Portable Network Graphics (PNG) Specification", W3C,
//! 2003, section 5.4).

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::error::{check_size, with_room};

/// Optional, private, and not to be copied to a picture with other pixels.
const NAME: [u8; 4] = *b"wfMP";

/// The bytes of a PNG file up to the end of its header.
pub const HEADER_BYTES: usize = 33;

/// Maps of millions of cells must not wait for the best packing.
const PACKING: u8 = 1;

/// Returns the chunk of a PNG file that holds a map.
pub fn chunk(occupied: &Grid<bool>) -> Vec<u8> {
    let mut bits = vec![0_u8; occupied.values().len().div_ceil(8)];
    for (byte, cells) in bits.iter_mut().zip(occupied.values().chunks(8)) {
        *byte = cells.iter().rev().fold(0, |byte, &cell| byte << 1 | u8::from(cell));
    }
    let packed = compress_to_vec(&bits, PACKING);
    let [rows, cols] = [occupied.rows(), occupied.cols()].map(|cells| (cells as u32).to_be_bytes());
    let named = [&NAME, &rows[..], &cols, &packed].concat();
    let length = (named.len() - NAME.len()) as u32;
    [&length.to_be_bytes(), &named[..], &crc32fast::hash(&named).to_be_bytes()].concat()
}

/// Returns the number of bytes of the map chunk after the header of a PNG file, given its first bytes; `None` if no map
/// follows the header.
pub fn length(start: &[u8]) -> Option<usize> {
    let [l3, l2, l1, l0, name @ ..] = start.get(HEADER_BYTES..HEADER_BYTES + 8)? else { return None };
    (name == NAME).then(|| u32::from_be_bytes([*l3, *l2, *l1, *l0]) as usize + 12)
}

/// Reads a map from its chunk.
pub fn read(chunk: &[u8]) -> Result<Grid<bool>, Fault> {
    let damaged = || Fault::Image { message: "the map in the picture is damaged".to_owned() };
    let (named, sum) = chunk.get(4..).and_then(|rest| rest.split_last_chunk()).ok_or_else(damaged)?;
    // Before any number in it is believed.
    if crc32fast::hash(named).to_be_bytes() != *sum {
        return Err(damaged());
    }
    let (head, packed) = named.split_first_chunk::<12>().ok_or_else(damaged)?;
    let [_, _, _, _, r3, r2, r1, r0, c3, c2, c1, c0] = *head;
    let rows = u32::from_be_bytes([r3, r2, r1, r0]) as usize;
    let cols = u32::from_be_bytes([c3, c2, c1, c0]) as usize;
    // Before anything is unpacked for the sides that the chunk claims.
    check_size(rows, cols)?;
    let expected = (rows * cols).div_ceil(8);
    let bits = decompress_to_vec_with_limit(packed, expected).map_err(|_| damaged())?;
    if bits.len() != expected {
        return Err(damaged());
    }
    let mut cells = with_room(rows * cols)?;
    cells.extend((0..rows * cols).map(|cell| bits[cell / 8] >> (cell % 8) & 1 == 1));
    Ok(Grid::from_values(rows, cols, cells))
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::drawn;
    use wildfire_base::rng;

    #[test]
    fn a_map_is_read_as_it_was_written_and_damage_is_noticed() {
        let mut rng = rng::stream(1, "carried");
        for _ in 0..100 {
            let rows = rng.random_range(1..40);
            let cols = rng.random_range(1..40);
            let map = drawn::random(rows, cols, 0.3, &mut rng);
            let mut written = chunk(&map);
            let file = [&[0; HEADER_BYTES], &written[..]].concat();
            assert_eq!(length(&file), Some(written.len()));
            assert_eq!(read(&written).ok(), Some(map));
            let place = rng.random_range(4..written.len());
            written[place] ^= 1 << rng.random_range(0..8);
            assert!(read(&written).is_err(), "byte {place}");
        }
        assert!(read(&[]).is_err() && length(b"\x89PNG").is_none());
    }
}
