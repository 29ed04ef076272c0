//! Reads a map, whatever its format.

use std::io::{BufRead, BufReader, Cursor, ErrorKind, Read, Seek};
use std::path::Path;

use crate::grid::{Grid, occupancy};
use crate::input_file;
use crate::input_file::InputFile;
use crate::map_files::rows::without_mark;
use crate::map_files::{Fault, MAX_BYTES, MapError, moving_ai, png, pnm, text};

const BUFFER_BYTES: usize = 1 << 16;

/// Grey values this near to the tolerance could as well be on its other side.
pub const NEAR_TOLERANCE: u8 = 20;

/// More than this share of such pixels, or of occupied cells, is odd for a map.
const MANY_NEAR: f64 = 0.05;
const MANY_OCCUPIED: f64 = 0.60;

/// A map and what its file said.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    pub occupied: Grid<bool>,
    /// The grey values of an image, 0 black to 255 white.
    pub grey: Option<Grid<u8>>,
    /// Changes made on reading, in sentences.
    pub notes: Vec<String>,
}

impl MapFile {
    /// Share of the pixels of an image whose grey value is within [`NEAR_TOLERANCE`] of the tolerance; `None` for a map
    /// that is no image.
    pub fn share_near(&self, tolerance: u8) -> Option<f64> {
        let grey = self.grey.as_ref()?.values();
        let near = grey.iter().filter(|&&value| value.abs_diff(tolerance) <= NEAR_TOLERANCE).count();
        Some(near as f64 / grey.len() as f64)
    }

    /// Returns sentences that say why an image may have been misread: obstacles that are not quite dark enough, or a
    /// drawing that is white on black.
    pub fn doubts(&self, tolerance: u8) -> Vec<String> {
        let Some(near) = self.share_near(tolerance) else { return Vec::new() };
        let cells = self.occupied.values();
        let occupied = cells.iter().filter(|&&occupied| occupied).count() as f64 / cells.len() as f64;
        let mut doubts = Vec::new();
        if near > MANY_NEAR {
            let percent = 100.0 * near;
            doubts.push(format!(
                "{percent:.1} % of the pixels are within {NEAR_TOLERANCE} grey levels of the tolerance, {tolerance}: \
                 with another --tolerance they may be obstacles, or none."
            ));
        }
        if occupied > MANY_OCCUPIED {
            let percent = 100.0 * occupied;
            doubts.push(format!(
                "{percent:.1} % of the cells are occupied: the image may be inverted, obstacles are dark."
            ));
        }
        doubts
    }
}

/// Reads a map; pixels of images are occupied where their grey value is at most `tolerance`.
///
/// The format is recognised by the content, never by the name: PNG; Netpbm images (P1 to P6); rows of 0 (free) and 1
/// (occupied); the same with commas; Moving AI maps, where `.` and `G` are free and everything else is occupied, swamp
/// (`S`) and water (`W`) too. Images that are not 8-bit grey are converted, which a note says: alpha over white,
/// colours by their luma, other ranges of values scaled to 0 to 255.
///
/// # Errors
/// If the file is no such map, or breaks off, or is larger than [`MAX_SIDE`](super::MAX_SIDE) or
/// [`MAX_CELLS`](super::MAX_CELLS) allow. What a header declares is checked before any memory is taken for it.
pub fn read(path: &Path, tolerance: u8) -> Result<MapFile, MapError> {
    let opened = input_file::open(path).map_err(not_opened);
    let read = opened.and_then(|input| match input {
        InputFile::Regular(_, 0) => Err(Fault::Empty),
        InputFile::Regular(_, bytes) if bytes > MAX_BYTES => Err(Fault::TooLarge { bytes }),
        InputFile::Regular(file, bytes) => read_file(BufReader::with_capacity(BUFFER_BYTES, file), bytes, tolerance),
        stream => read_stream(stream, tolerance),
    });
    read.map_err(|fault| MapError { path: path.to_owned(), fault })
}

fn not_opened(error: std::io::Error) -> Fault {
    if error.kind() == ErrorKind::IsADirectory { Fault::Folder } else { error.into() }
}

fn read_file<R: BufRead + Seek>(mut source: R, bytes: u64, tolerance: u8) -> Result<MapFile, Fault> {
    match MapFormat::from_first_bytes(source.fill_buf()?)? {
        MapFormat::Png => png::read(source, bytes).map(|(grey, note)| from_grey(grey, tolerance, note)),
        MapFormat::Sequential(format) => read_sequential(format, source, bytes, tolerance),
    }
}

/// Reads an input that has no way back, a pipe, a device or stdin: its first bytes are kept, as they show the format,
/// and those of a PNG image are all kept.
fn read_stream(mut stream: impl Read, tolerance: u8) -> Result<MapFile, Fault> {
    let mut start = Vec::new();
    stream.by_ref().take(BUFFER_BYTES as u64).read_to_end(&mut start)?;
    let bytes = start.len() as u64;
    if start.is_empty() {
        return Err(Fault::Empty);
    }
    match MapFormat::from_first_bytes(&start)? {
        MapFormat::Png => {
            let image = png::read_bytes(start, stream)?;
            let bytes = image.len() as u64;
            read_file(Cursor::new(image), bytes, tolerance)
        }
        MapFormat::Sequential(format) => {
            let rest = BufReader::with_capacity(BUFFER_BYTES, stream.take(MAX_BYTES - bytes));
            read_sequential(format, Cursor::new(start).chain(rest), bytes, tolerance)
        }
    }
}

/// Reads from front to end. `bytes` is how many bytes there are at least, which says how much room to make at first.
fn read_sequential(
    format: SequentialFormat,
    source: impl BufRead,
    bytes: u64,
    tolerance: u8,
) -> Result<MapFile, Fault> {
    match format {
        SequentialFormat::Pnm => pnm::read(source, bytes).map(|(grey, note)| from_grey(grey, tolerance, note)),
        SequentialFormat::MovingAi => moving_ai::read(source, bytes).map(|(occupied, note)| from_cells(occupied, note)),
        SequentialFormat::Csv => text::read_csv(source, bytes).map(|occupied| from_cells(occupied, None)),
        SequentialFormat::Text => text::read_text(source, bytes).map(|occupied| from_cells(occupied, None)),
    }
}

fn from_grey(grey: Grid<u8>, tolerance: u8, note: Option<String>) -> MapFile {
    let occupied = occupancy::from_grey(&grey, tolerance);
    MapFile { occupied, grey: Some(grey), notes: Vec::from_iter(note) }
}

fn from_cells(occupied: Grid<bool>, note: Option<String>) -> MapFile {
    MapFile { occupied, grey: None, notes: Vec::from_iter(note) }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MapFormat {
    Png,
    Sequential(SequentialFormat),
}

/// The formats that are read from front to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SequentialFormat {
    Pnm,
    MovingAi,
    Csv,
    Text,
}

/// The first bytes of files that people may take for maps.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"\xFF\xD8\xFF", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"BM", "a BMP image"),
    (b"II*\0", "a TIFF image"),
    (b"MM\0*", "a TIFF image"),
    (b"RIFF", "a WebP image or another RIFF file"),
    (b"%PDF", "a PDF document"),
    (b"P7\n", "a PAM image"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"\x1F\x8B", "a file packed by gzip"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\xFF\xFE", "UTF-16 text"),
    (b"\xFE\xFF", "UTF-16 text"),
];

impl MapFormat {
    /// Tells the format from the first bytes of a file.
    fn from_first_bytes(start: &[u8]) -> Result<Self, Fault> {
        if let Some((_, found)) = FOREIGN.iter().find(|(signature, _)| start.starts_with(signature)) {
            return Err(Fault::Foreign { found });
        }
        let text = without_mark(start);
        let first_line = text.split(|&byte| byte == b'\n').next().unwrap_or_default();
        Ok(if start.starts_with(png::SIGNATURE) {
            Self::Png
        } else if pnm::is_start(start) {
            Self::Sequential(SequentialFormat::Pnm)
        } else if first_line.starts_with(b"type ") {
            Self::Sequential(SequentialFormat::MovingAi)
        } else if first_line.contains(&b',') {
            Self::Sequential(SequentialFormat::Csv)
        } else {
            Self::Sequential(SequentialFormat::Text)
        })
    }
}
