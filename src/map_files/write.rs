//! Writes maps and paths for other tools; files appear whole.

use std::io::{self, Write};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::decimal::{append_float, append_integer};
use crate::grid::{Grid, Place};
use crate::whole_file::{WholeFile, write_whole};

/// A value that a map or an array can hold: `bool` (as 0 and 1), `u8`, `u16`, `u32`, `f64`.
pub trait MapValue: Copy {
    /// The value's type as NumPy writes it, little-endian.
    const NUMPY_TYPE: &'static str;

    /// Appends the value as text: integers as integers, others with 12 significant digits.
    fn append_text(self, text: &mut Vec<u8>);

    /// Appends the bytes of the value, the lowest first.
    fn append_bytes(self, bytes: &mut Vec<u8>);
}

impl MapValue for bool {
    const NUMPY_TYPE: &'static str = "|b1";

    fn append_text(self, text: &mut Vec<u8>) {
        text.push(b'0' + u8::from(self));
    }

    fn append_bytes(self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self));
    }
}

impl MapValue for f64 {
    const NUMPY_TYPE: &'static str = "<f8";

    fn append_text(self, text: &mut Vec<u8>) {
        append_float(self, text);
    }

    fn append_bytes(self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
}

macro_rules! integer_map_value {
    ($integer:ty, $numpy_type:literal) => {
        impl MapValue for $integer {
            const NUMPY_TYPE: &'static str = $numpy_type;

            fn append_text(self, text: &mut Vec<u8>) {
                append_integer(self.into(), text);
            }

            fn append_bytes(self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        }
    };
}

integer_map_value!(u8, "|u1");
integer_map_value!(u16, "<u2");
integer_map_value!(u32, "<u4");

/// Writes a map as CSV: commas, line feeds, no header; floating-point values as C's `%.12g` prints them.
pub fn write_csv<T: MapValue>(path: &Path, map: &Grid<T>) -> io::Result<()> {
    write_rows(path, map, &[], |row, text| {
        for &value in row {
            value.append_text(text);
            text.push(b',');
        }
        end_line(text);
    })
}

/// Writes an occupancy map as rows of 0 (free) and 1 (occupied) with nothing between them.
pub fn write_text(path: &Path, occupied: &Grid<bool>) -> io::Result<()> {
    write_rows(path, occupied, &[], |row, text| {
        text.extend(row.iter().map(|&cell| b'0' + u8::from(cell)));
        text.push(b'\n');
    })
}

/// Writes a map as a NumPy array of shape (rows, columns), C order, little-endian.
pub fn write_npy<T: MapValue>(path: &Path, map: &Grid<T>) -> io::Result<()> {
    let header = npy_header(T::NUMPY_TYPE, &[map.rows(), map.cols()]);
    write_rows(path, map, &header, |row, bytes| row.iter().for_each(|value| value.append_bytes(bytes)))
}

/// Writes grey values as an 8-bit PNG image.
pub fn write_png(path: &Path, grey: &Grid<u8>) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive);
    let side = |cells| u32::try_from(cells).map_err(io::Error::other);
    let written = encoder.write_image(grey.values(), side(grey.cols())?, side(grey.rows())?, ExtendedColorType::L8);
    written.map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })?;
    file.finish()
}

/// Writes a path, `row,col` per line, from start to goal.
pub fn write_path(path: &Path, cells: &[Place]) -> io::Result<()> {
    let text: String = cells.iter().map(|(row, col)| format!("{row},{col}\n")).collect();
    write_whole(path, text.as_bytes())
}

/// Writes a header and then row after row, so that never more than one of them is kept as bytes.
fn write_rows<T>(
    path: &Path,
    map: &Grid<T>,
    header: &[u8],
    mut append_row: impl FnMut(&[T], &mut Vec<u8>),
) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write_all(header)?;
    let mut bytes = Vec::new();
    for row in 0..map.rows() {
        bytes.clear();
        append_row(map.row(row), &mut bytes);
        file.write_all(&bytes)?;
    }
    file.finish()
}

/// Makes a comma after the last value the end of the line.
fn end_line(text: &mut Vec<u8>) {
    text.pop();
    text.push(b'\n');
}

/// Returns what stands before the values of a NumPy array in C order: magic, version, length and dictionary, padded with
/// spaces to a multiple of 64 bytes.
///
/// Source: "NEP 1 - A Simple File Format for NumPy Arrays", format version 1.0.
pub fn npy_header(numpy_type: &str, shape: &[usize]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side}, ")).collect();
    // A tuple of one needs its comma, longer ones end without.
    let shape = if shape.len() > 1 { sides.trim_end_matches(", ") } else { sides.trim_end() };
    let dictionary = format!("{{'descr': '{numpy_type}', 'fortran_order': False, 'shape': ({shape}), }}");
    let before = b"\x93NUMPY\x01\x00".len() + size_of::<u16>();
    let total = (before + dictionary.len() + 1).next_multiple_of(64);
    let length = u16::try_from(total - before).expect("a dictionary is short");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend_from_slice(&length.to_le_bytes());
    header.extend_from_slice(dictionary.as_bytes());
    header.resize(total - 1, b' ');
    header.push(b'\n');
    header
}
