//! Reads a map, whatever its format.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use super::lines::without_mark;
use super::{Fault, MAX_BYTES, MapError, moving_ai, png, pnm, text};
use crate::grid::{Grid, occupancy};

const BUFFER_BYTES: usize = 1 << 16;

/// A map and what its file said.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    pub occupied: Grid<bool>,
    /// The grey values of an image, 0 black to 255 white.
    pub grey: Option<Grid<u8>>,
    /// What was changed on reading, in sentences.
    pub notes: Vec<String>,
}

/// Reads a map; pixels of images are occupied where their grey value is at most `tolerance`.
///
/// The format is told by the content, never by the name: PNG; Netpbm images (P1 to P6); rows of 0 (free) and 1
/// (occupied); the same with commas; Moving AI maps, where `.` and `G` are free and everything else is occupied, swamp
/// (`S`) and water (`W`) too. Images that are not 8-bit grey are converted, which a note says: alpha over white,
/// colours by their luma, other ranges of values scaled to 0 to 255.
///
/// # Errors
/// If the file is no such map, or breaks off, or is larger than [`MAX_SIDE`](super::MAX_SIDE) or
/// [`MAX_CELLS`](super::MAX_CELLS) allow. What a header declares is checked before any memory is taken for it.
pub fn read(path: &Path, tolerance: u8) -> Result<MapFile, MapError> {
    let read = || {
        let (file, bytes) = open(path)?;
        read_from(BufReader::with_capacity(BUFFER_BYTES, file), bytes, tolerance)
    };
    read().map_err(|fault| MapError { path: path.to_owned(), fault })
}

/// The file and its size; opening a pipe could wait for ever and a device has no end, so both are refused.
fn open(path: &Path) -> Result<(File, u64), Fault> {
    let found = fs::metadata(path)?;
    match found.len() {
        _ if found.is_dir() => Err(Fault::Folder),
        _ if !found.is_file() => Err(Fault::NotAFile),
        0 => Err(Fault::Empty),
        bytes if bytes > MAX_BYTES => Err(Fault::TooLarge { bytes }),
        bytes => Ok((File::open(path)?, bytes)),
    }
}

fn read_from<R: BufRead + Seek>(mut source: R, bytes: u64, tolerance: u8) -> Result<MapFile, Fault> {
    match Format::of(source.fill_buf()?)? {
        Format::Png => png::read(source, bytes).map(|(grey, note)| from_grey(grey, tolerance, note)),
        Format::Pnm => pnm::read(source, bytes).map(|(grey, note)| from_grey(grey, tolerance, note)),
        Format::MovingAi => moving_ai::read(source, bytes).map(|(occupied, note)| from_cells(occupied, note)),
        Format::Csv => text::read_csv(source, bytes).map(|occupied| from_cells(occupied, None)),
        Format::Text => text::read_text(source, bytes).map(|occupied| from_cells(occupied, None)),
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
enum Format {
    Png,
    Pnm,
    MovingAi,
    Csv,
    Text,
}

/// How files begin that people may take for maps.
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

impl Format {
    /// Tells the format from the first bytes of a file.
    fn of(start: &[u8]) -> Result<Self, Fault> {
        if let Some((_, found)) = FOREIGN.iter().find(|(signature, _)| start.starts_with(signature)) {
            return Err(Fault::Foreign { found });
        }
        let text = without_mark(start);
        let first_line = text.split(|&byte| byte == b'\n').next().unwrap_or_default();
        Ok(if start.starts_with(png::SIGNATURE) {
            Self::Png
        } else if pnm::is_start(start) {
            Self::Pnm
        } else if first_line.starts_with(b"type ") {
            Self::MovingAi
        } else if first_line.contains(&b',') {
            Self::Csv
        } else {
            Self::Text
        })
    }
}
