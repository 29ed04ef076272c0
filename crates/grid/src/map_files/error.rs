//! Errors of map files.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::{MAX_BYTES, MAX_CELLS, MAX_SIDE};

/// The reason why a file could not be read as a map: a sentence that begins with its path.
///
/// Rows and columns are counted from 0, lines of a header from 1, as editors do.
#[derive(Debug, Error)]
#[error("{}: {fault}", path.display())]
pub struct MapError {
    pub path: PathBuf,
    pub fault: Fault,
}

/// The error itself, with its position in the map if it has one.
#[derive(Debug, Error)]
pub enum Fault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("this is a folder; expected a map file")]
    Folder,
    #[error("the file has {bytes} bytes; expected at most {MAX_BYTES}")]
    TooLarge { bytes: u64 },
    #[error("the file is empty; expected a map")]
    Empty,
    #[error(
        "this is {found}; expected an image (PNG, JPEG, WebP, GIF, BMP, TIFF, PBM, PGM, PPM or PAM), rows of 0 and 1 or of . and #, \
         a table or a NumPy array of 0 and 1, a Moving AI map, or the YAML file of a ROS map"
    )]
    Foreign { found: &'static str },
    #[error(
        "the height of the map is {rows} and its width {cols}; expected 1 to {MAX_SIDE} each, and at most {MAX_CELLS} cells"
    )]
    Size { rows: usize, cols: usize },
    #[error(
        "row {row}, column {col}: the map continues; expected at most {MAX_SIDE} rows, {MAX_SIDE} columns and \
         {MAX_CELLS} cells"
    )]
    Beyond { row: usize, col: usize },
    #[error("row {row}, column {col}: found {found}, expected {expected}")]
    Cell { row: usize, col: usize, found: String, expected: String },
    #[error("row {row}, column {}: the width of the row is {found}, expected {expected}", found.min(expected))]
    Ragged { row: usize, found: usize, expected: usize },
    #[error("row {row}, column 0: the line is blank; expected a row of cells")]
    Blank { row: usize },
    #[error("row {row}, column {col}: the file ends; its header declares a height of {rows} and a width of {cols}")]
    Ends { row: usize, col: usize, rows: usize, cols: usize },
    #[error("row {rows}, column 0: the file continues; its header declares a height of {rows}")]
    GoesOn { rows: usize },
    #[error("line {line}: {message}")]
    Line { line: usize, message: String },
    #[error("the image is damaged: {message}")]
    Image { message: String },
    #[error("this kind of {format} is not supported: {reason}; convert it, e.g. to PNG")]
    Unread { format: &'static str, reason: String },
    #[error("the file has more than {max} bytes, the limit for files of this kind")]
    GoesBeyond { max: u64 },
    #[error("the pixels of the image take {bytes} bytes, expected at most {limit}; 8-bit grey takes the least")]
    ImageTooLarge { bytes: u64, limit: u64 },
    #[error("this NumPy array {found}; expected {expected}")]
    Array { found: String, expected: &'static str },
    #[error("this is {found}; expected an image, as the YAML file of a ROS map names one")]
    NoImage { found: &'static str },
    #[error("a map of {cells} cells does not fit into the memory")]
    Memory { cells: usize },
}

/// Accepts the size that a header declares.
pub(super) fn check_size(rows: usize, cols: usize) -> Result<(), Fault> {
    // The sides come first, so that their product cannot overflow.
    let fits = [rows, cols].iter().all(|side| (1..=MAX_SIDE).contains(side)) && rows * cols <= MAX_CELLS;
    if fits { Ok(()) } else { Err(Fault::Size { rows, cols }) }
}

/// Makes an empty list with room for that many values, if the memory has it.
pub(super) fn with_room<T>(values: usize) -> Result<Vec<T>, Fault> {
    let mut list = Vec::new();
    list.try_reserve_exact(values).map_err(|_| Fault::Memory { cells: values })?;
    Ok(list)
}

/// Returns the first letter of some bytes, in quotes, or a description of what is there instead.
pub(super) fn shown_letter(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(4)];
    match String::from_utf8_lossy(start).chars().next() {
        None => "nothing".to_owned(),
        Some(char::REPLACEMENT_CHARACTER) => format!("byte 0x{:02X}", start[0]),
        Some(letter) => format!("{letter:?}"),
    }
}
