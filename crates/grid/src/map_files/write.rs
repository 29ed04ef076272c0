//! Writing maps and paths for other tools; files appear whole or not at all.

use std::io::{self, Write};
use std::path::Path;

use super::decimal::append_float;
use crate::{Grid, Place};
use wildfire_base::npy::{NpyValue, npy_header};
use wildfire_base::whole_file::{WholeFile, write_whole};

/// A value that a map can hold: `bool` (as 0 and 1), `u8`, `u16`, `u32`, `f64`.
pub trait MapValue: NpyValue {
    /// Appends the value as text: integers as integers, others with 12 significant digits.
    fn append_text(self, text: &mut Vec<u8>);
}

impl MapValue for bool {
    fn append_text(self, text: &mut Vec<u8>) {
        text.push(b'0' + u8::from(self));
    }
}

impl MapValue for f64 {
    fn append_text(self, text: &mut Vec<u8>) {
        append_float(self, text);
    }
}

macro_rules! integer_map_value {
    ($($integer:ty),*) => {$(
        impl MapValue for $integer {
            fn append_text(self, text: &mut Vec<u8>) {
                write!(text, "{self}").expect("a list can be written to");
            }
        }
    )*};
}

integer_map_value!(u8, u16, u32);

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
    let [cols, rows] = [grey.cols(), grey.rows()].map(|cells| u32::try_from(cells).map_err(io::Error::other));
    let mut encoder = png::Encoder::new(&mut file, cols?, rows?);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(grey.values())?;
    writer.finish()?;
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
