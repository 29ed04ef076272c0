//! Rasters: a number for each cell of a map, and the position of the cells on earth.
//!
//! Read are ESRI ASCII grids and GeoTIFF images, distinguished by their content; written are both. In a file the north row
//! comes first. Here row 0 is the south edge, as everywhere in the simulation, and this module is where rows are turned
//! over. Faults count rows and columns as the file has them, from 0 at its north-west corner.

mod ascii;
pub mod crs;
mod error;
mod geotiff;
mod lcp;
mod sidecars;
pub(super) mod tiff_chunks;
mod tiff_fax;
pub(super) mod tiff_header;

use std::io;
use std::path::Path;

use crs::{Coordinates, SpatialReference};
pub use error::{RasterError, RasterFault};
use serde::{Deserialize, Serialize};

use wildfire_base::input_file;
use wildfire_base::whole_file::write_whole;

/// The maximum number of rows and of columns of a raster.
pub const MAX_RASTER_SIDE: usize = 16_384;
/// The maximum number of cells of a raster: 268 MB of values.
pub const MAX_RASTER_CELLS: usize = 1 << 26;
/// The maximum number of bands; those of one file have at most twice [`MAX_RASTER_CELLS`] cells together.
pub const MAX_BANDS: u64 = 64;
/// The maximum size of a raster file in bytes: about nine characters for each cell of the largest one.
pub const MAX_RASTER_BYTES: u64 = 600_000_000;

/// A raster: values of square cells, row 0 at the south edge, column 0 at the west edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    pub rows: usize,
    pub cols: usize,
    /// The west edge of the first column, metres in the coordinate system of the file.
    pub west_m: f64,
    /// The south edge of row 0.
    pub south_m: f64,
    /// The side of a cell, in metres.
    pub cell_m: f64,
    /// A value for each cell, `row * cols + col`.
    pub values: Vec<f32>,
    /// The value of cells without data; they keep it.
    pub nodata: Option<f32>,
    /// The coordinate system, as a GeoTIFF states it.
    pub crs: Option<GeoKeys>,
}

/// The coordinate system of a GeoTIFF: its geo keys, passed on unchanged.
///
/// Source: Open Geospatial Consortium, "OGC GeoTIFF Standard", version 1.1, 2019, section 7.1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeoKeys {
    /// Tag 34735: four words of a head, then four for each key.
    pub directory: Vec<u16>,
    /// Tag 34736.
    pub doubles: Vec<f64>,
    /// Tag 34737.
    pub ascii: String,
}

impl Raster {
    /// Returns the value of a cell, counted from the south-west.
    pub fn value(&self, row: usize, col: usize) -> f32 {
        self.values[row * self.cols + col]
    }

    /// Returns whether a value stands for missing data; NaN always does.
    pub fn is_nodata(&self, value: f32) -> bool {
        value.is_nan() || self.nodata == Some(value)
    }

    /// Returns the row in the file's numbering, from the north.
    pub fn file_row(&self, row: usize) -> usize {
        self.rows - 1 - row
    }

    /// Returns the north edge of the last row.
    pub fn north_m(&self) -> f64 {
        self.south_m + self.rows as f64 * self.cell_m
    }

    /// Returns the least and the greatest value, without cells that have none; `None` if no cell has one.
    pub fn range(&self) -> Option<(f32, f32)> {
        let mut values = self.values.iter().copied().filter(|&value| !self.is_nodata(value));
        let first = values.next()?;
        Some(values.fold((first, first), |(min, max), value| (min.min(value), max.max(value))))
    }
}

/// Reads a raster of one band; the format is detected from the content.
///
/// # Errors
/// Fails as [`read_bands`] does, and if there are several bands.
pub fn read(path: &Path) -> Result<Raster, RasterError> {
    read_bands(path).and_then(|bands| one_of(bands).map_err(|fault| RasterError { path: path.to_owned(), fault }))
}

/// Reads a raster of one band from the bytes of a file.
///
/// # Errors
/// Fails as [`read`] does.
pub fn parse(bytes: Vec<u8>) -> Result<Raster, RasterFault> {
    one_of(parse_bands(bytes, None)?)
}

fn one_of(mut bands: Vec<Band>) -> Result<Raster, RasterFault> {
    if bands.len() == 1 { Ok(bands.swap_remove(0).raster) } else { Err(RasterFault::one_of(bands.len())) }
}

/// A band of a file, with its name if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    pub name: Option<String>,
    /// The unit of the values, in the words of the file.
    pub unit: Option<String>,
    /// The unit of heights above sea level, where the coordinate system has one.
    pub height_unit: Option<String>,
    /// Scale, offset and mask are applied.
    pub raster: Raster,
}

/// Reads all bands of a raster: a GeoTIFF, a landscape file of FARSITE (`.lcp`), or an ESRI ASCII grid, with what files
/// beside it say of its coordinates.
///
/// # Errors
/// If the file is no raster of square cells measured in metres, breaks off, or is larger than [`MAX_RASTER_SIDE`],
/// [`MAX_RASTER_CELLS`], [`MAX_BANDS`] and [`MAX_RASTER_BYTES`] allow. What a header declares is checked against these and
/// against the bytes that there are before memory is taken for it.
pub fn read_bands(path: &Path) -> Result<Vec<Band>, RasterError> {
    let bytes = input_file::read(path, MAX_RASTER_BYTES).and_then(input_file::utf8).map_err(RasterFault::from);
    let bands = bytes.and_then(|bytes| parse_bands(bytes, Some(path)));
    bands.map_err(|fault| RasterError { path: path.to_owned(), fault })
}

fn parse_bands(bytes: Vec<u8>, path: Option<&Path>) -> Result<Vec<Band>, RasterFault> {
    path.map_or(Ok(()), sidecars::refuse_changes)?;
    if bytes.is_empty() {
        Err(RasterFault::Empty)
    } else if tiff_header::is_start(&bytes) {
        geotiff::parse_bands(bytes)
    } else if ascii::is_start(&bytes) || lcp::is_start(&bytes) {
        let SpatialReference { coordinates, height_unit_m } =
            path.map_or(SpatialReference::default(), sidecars::projection);
        let mut bands = if lcp::is_start(&bytes) {
            lcp::parse(&bytes, coordinates)?
        } else {
            vec![ascii::parse(&bytes, coordinates)?.into()]
        };
        for band in &mut bands {
            band.height_unit = height_unit_m.map(crs::unit_name);
        }
        Ok(bands)
    } else {
        Err(RasterFault::Foreign)
    }
}

impl From<Raster> for Band {
    fn from(raster: Raster) -> Self {
        Self { name: None, unit: None, height_unit: None, raster }
    }
}

/// Writes an ESRI ASCII grid: every value in the fewest digits that restore it bit for bit.
///
/// # Errors
/// Those of the disk.
pub fn write_asc(path: &Path, raster: &Raster) -> io::Result<()> {
    write_whole(path, ascii::to_text(raster).as_bytes())
}

/// Writes a GeoTIFF of 32-bit floating-point values, compressed by deflate.
///
/// # Errors
/// Those of the disk.
pub fn write_geotiff(path: &Path, raster: &Raster) -> io::Result<()> {
    write_whole(path, &geotiff::to_bytes(&[(None, raster)]).map_err(io::Error::other)?)
}

/// Writes a GeoTIFF of several bands of the same cells, with the names by which GDAL and QGIS list them: letters that are
/// not special in XML.
///
/// # Errors
/// Those of the disk.
pub fn write_geotiff_bands(path: &Path, bands: &[(&str, &Raster)]) -> io::Result<()> {
    let bands: Vec<_> = bands.iter().map(|&(name, raster)| (Some(name), raster)).collect();
    write_whole(path, &geotiff::to_bytes(&bands).map_err(io::Error::other)?)
}

/// Accepts the size that a header declares.
fn check_size(rows: u64, cols: u64) -> Result<(), RasterFault> {
    let sides_fit = [rows, cols].iter().all(|side| (1..=MAX_RASTER_SIDE as u64).contains(side));
    let fits = sides_fit && rows * cols <= MAX_RASTER_CELLS as u64;
    if fits { Ok(()) } else { Err(RasterFault::Size { rows, cols }) }
}

/// Accepts a number of bands, all of which are held at a time.
fn check_bands(rows: u64, cols: u64, bands: u64) -> Result<(), RasterFault> {
    let fits = (1..=MAX_BANDS).contains(&bands) && rows * cols * bands <= 2 * MAX_RASTER_CELLS as u64;
    if fits { Ok(()) } else { Err(RasterFault::Bands { rows, cols, bands }) }
}

/// Accepts the south-west corner, the columns and rows, and the side of cells, in coordinates that measure this, or nothing
/// that is known.
fn check_place(
    corner: [f64; 2],
    size: [usize; 2],
    cell_m: f64,
    coordinates: Option<Coordinates>,
) -> Result<(), RasterFault> {
    if let Some(message) = coordinates.and_then(|coordinates| coordinates.refusal(corner)) {
        return Err(RasterFault::Unfit { message });
    }
    let [west_m, south_m] = corner;
    // Larger cells leave no room for places in numbers.
    if !(cell_m > 0.0 && cell_m <= 1e9) {
        return Err(RasterFault::CellSize { found: cell_m });
    }
    if !corner.iter().all(|m| m.is_finite() && m.abs() <= 1e12) {
        return Err(RasterFault::Place { west_m, south_m });
    }
    let size_m = size.map(|cells| cells as f64 * cell_m);
    if coordinates.is_none() && crs::are_likely_degrees(corner, size_m, cell_m) {
        let command = crs::gdalwarp_at(corner);
        return Err(RasterFault::Degrees { cell: cell_m, west: west_m, south: south_m, command });
    }
    Ok(())
}

/// Takes memory for values, if there is some.
fn with_room(cells: usize) -> Result<Vec<f32>, RasterFault> {
    let mut values = Vec::new();
    values.try_reserve_exact(cells).map_err(|_| RasterFault::Memory { cells })?;
    Ok(values)
}

#[cfg(test)]
mod tests;
