//! Errors of rasters.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::{MAX_BANDS, MAX_RASTER_CELLS, MAX_RASTER_SIDE};

/// The reason why a file could not be read as a raster: a sentence that begins with its path.
#[derive(Debug, Error)]
#[error("{}: {fault}", path.display())]
pub struct RasterError {
    pub path: PathBuf,
    pub fault: RasterFault,
}

/// The error itself. Rows and columns are those of the file, from 0 at its north-west corner.
#[derive(Debug, Error)]
pub enum RasterFault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the file is empty; expected an ESRI ASCII grid or a GeoTIFF")]
    Empty,
    #[error(
        "this is not a supported raster; expected an ESRI ASCII grid, which begins with `ncols`, or a GeoTIFF, which \
         `gdal_translate in out.tif` makes from most other formats"
    )]
    Foreign,
    #[error(
        "the raster has {rows} rows and {cols} columns; expected 1 to {MAX_RASTER_SIDE} each, and at most \
         {MAX_RASTER_CELLS} cells, which take 268 MB; cut out a part with gdal_translate -srcwin COL ROW COLS ROWS \
         in.tif out.tif"
    )]
    Size { rows: u64, cols: u64 },
    #[error(
        "{bands} bands of {rows} rows and {cols} columns are too many; expected up to {MAX_BANDS} bands, and at most \
         {} cells in all of them", 2 * MAX_RASTER_CELLS
    )]
    Bands { rows: u64, cols: u64, bands: u64 },
    #[error("the cell size is {found}; expected a side above 0 m and up to 1e9 m")]
    CellSize { found: f64 },
    #[error("cells of {x} by {y} are not square; gdalwarp -tr SIDE SIDE in.tif out.tif makes them square")]
    NotSquare { x: f64, y: f64 },
    #[error("its south-west corner is at ({west_m}, {south_m}), which is not a position in metres")]
    Place { west_m: f64, south_m: f64 },
    #[error(
        "its cells of {cell} at ({west}, {south}) are degrees in all likelihood, and it names no coordinate system; \
         {command} -s_srs EPSG:4326 in.tif out.tif converts it to a grid in metres, and if they are metres, gdal_translate \
         -a_srs EPSG:NUMBER in.tif out.tif says so"
    )]
    Degrees { cell: f64, west: f64, south: f64, command: String },
    #[error("{} beside it {says}; gdal_translate in.tif out.tif makes a file that contains it", path.display())]
    Sidecar { path: PathBuf, says: &'static str },
    #[error("line {line}: {message}")]
    Header { line: usize, message: String },
    #[error("the header lacks `{key}`")]
    NoKey { key: &'static str },
    #[error("row {row}, column {col}: found {found}, expected a number")]
    Cell { row: usize, col: usize, found: String },
    #[error("row {row}, column {col}: the file ends; its header declares {rows} rows and {cols} columns")]
    Ends { row: usize, col: usize, rows: usize, cols: usize },
    #[error("after row {row}, column {col}: the file continues; its header declares {rows} rows and {cols} columns")]
    GoesOn { row: usize, col: usize, rows: usize, cols: usize },
    #[error("the TIFF image is damaged: {message}")]
    Damaged { message: String },
    #[error("the TIFF image cannot be used: {message}")]
    Unfit { message: String },
    #[error("the landscape file cannot be used: {message}")]
    Landscape { message: String },
    #[error("{bytes} bytes cannot hold {rows} rows and {cols} columns: the file is cut off, or its header is wrong")]
    TooShort { bytes: usize, rows: usize, cols: usize },
    #[error("a raster of {cells} cells does not fit into the memory")]
    Memory { cells: usize },
}

impl RasterFault {
    /// Refuses several bands where one is expected.
    pub(super) fn one_of(bands: usize) -> Self {
        let message =
            format!("it has {bands} bands, expected one; gdal_translate -b NUMBER in.tif out.tif extracts one");
        Self::Unfit { message }
    }
}
