//! Values by cell as a short text: bytes packed by deflate (Deutsch, "DEFLATE Compressed Data Format Specification", RFC 1951,
//! 1996) and written in base 64 (Josefsson, RFC 4648, 2006, section 4).
//!
//! Numbers come as differences of neighbours, the first byte of all of them before the second: heights that change little pack
//! well so.

use data_encoding::BASE64;
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde::{Deserialize, Serialize};

/// The effort of packing, as zlib counts it.
const PACKING: u8 = 6;

/// A value for each cell, packed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PackedLayer(String);

impl PackedLayer {
    pub(crate) fn from_bytes(bytes: &[u8]) -> Self {
        Self(BASE64.encode(&compress_to_vec(bytes, PACKING)))
    }

    pub(super) fn from_numbers(numbers: &[f32]) -> Self {
        let bits = numbers.iter().map(|number| number.to_bits());
        let before = std::iter::once(0).chain(bits.clone());
        Self::from_places(bits.zip(before).map(|(number, before)| number.wrapping_sub(before).to_be_bytes()).collect())
    }

    pub(crate) fn from_integers(integers: &[i16]) -> Self {
        let before = std::iter::once(0).chain(integers.iter().copied());
        let integers = integers.iter().zip(before);
        Self::from_places(integers.map(|(number, before)| number.wrapping_sub(before).to_be_bytes()).collect())
    }

    /// Packs the high bytes of all numbers before their lower ones.
    fn from_places<const N: usize>(numbers: Vec<[u8; N]>) -> Self {
        let bytes: Vec<u8> = (0..N).flat_map(|place| numbers.iter().map(move |bytes| bytes[place])).collect();
        Self::from_bytes(&bytes)
    }

    pub(crate) fn integers(&self, expected: usize) -> Option<Vec<i16>> {
        let bytes = self.bytes(2 * expected)?;
        let mut number = 0_i16;
        let integers = (0..expected).map(|index| {
            number = number.wrapping_add(i16::from_be_bytes([bytes[index], bytes[expected + index]]));
            number
        });
        Some(integers.collect())
    }

    pub(crate) fn bytes(&self, expected: usize) -> Option<Vec<u8>> {
        let bytes = decompress_to_vec_with_limit(&BASE64.decode(self.0.as_bytes()).ok()?, expected).ok()?;
        (bytes.len() == expected).then_some(bytes)
    }

    pub(super) fn numbers(&self, expected: usize) -> Option<Vec<f32>> {
        let bytes = self.bytes(4 * expected)?;
        let mut bits = 0_u32;
        let numbers = (0..expected).map(|index| {
            let difference = [0, 1, 2, 3].map(|place| bytes[place * expected + index]);
            bits = bits.wrapping_add(u32::from_be_bytes(difference));
            f32::from_bits(bits)
        });
        Some(numbers.collect())
    }
}
