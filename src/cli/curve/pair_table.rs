//! Reads a table of pairs of poses row by row.

use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use thiserror::Error;

use crate::cli::curve::limits::{self, NUMBERS};
use crate::cli::numbers;
use crate::geometry::Pose;
use crate::input_file::{self, InputFile};

/// Columns that are read, by their names in the header: metres and radians.
const COLUMNS: [&str; 6] = ["x0", "y0", "th0", "x1", "y1", "th1"];
/// The most bytes of a line: a broken file must not fill the memory.
const LONGEST_LINE: usize = 1 << 16;
/// The most characters that are shown of a field that is no number.
const SHOWN: usize = 40;
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// A fault of a table of pairs: a sentence to follow its path. Lines are counted from 1.
#[derive(Debug, Error)]
pub enum Fault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the file is empty; expected a header with the columns {}", COLUMNS.join(","))]
    Empty,
    #[error("line {line}: the column {column} is missing; expected a header with {}", COLUMNS.join(","))]
    Missing { line: u64, column: &'static str },
    #[error("line {line}: the column {column} is there twice; expected it once")]
    Twice { line: u64, column: &'static str },
    #[error("line {line}: the column {column} is there already; expected a table without the columns that are added")]
    Taken { line: u64, column: &'static str },
    #[error("line {line}: it is longer than {LONGEST_LINE} bytes; expected a pair of poses")]
    TooLong { line: u64 },
    #[error("line {line}: found {found} columns, expected {expected} as in the header")]
    Ragged { line: u64, found: usize, expected: usize },
    #[error("line {line}, column {column}: found {found:?}, expected a number {}", limits::shown(&NUMBERS))]
    Number { line: u64, column: &'static str, found: String },
}

impl Fault {
    /// Returns the kind of error of an input that has this fault.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => ErrorKind::InvalidData,
        }
    }
}

/// A table of pairs, of which one row is kept at a time.
///
/// Fields stand between commas; those in double quotes may hold commas, but no line ends. Blank lines are passed over.
pub struct PairTable {
    source: BufReader<InputFile>,
    /// The last line that was read, without its end.
    row: Vec<u8>,
    line: u64,
    /// The number of columns of the header.
    width: usize,
    /// The index of each of [`COLUMNS`] in a row.
    places: [usize; COLUMNS.len()],
}

impl PairTable {
    /// Reads the header, which must have all of [`COLUMNS`] and none of `taken`.
    pub fn open(path: &Path, taken: &[&'static str]) -> Result<Self, Fault> {
        let source = BufReader::new(input_file::open(path)?);
        let mut table = Self { source, row: Vec::new(), line: 0, width: 0, places: [0; COLUMNS.len()] };
        if !table.read_row()? {
            return Err(Fault::Empty);
        }
        table.width = fields(&table.row).count();
        let line = table.line;
        if let Some(&column) = taken.iter().find(|column| !table.named(column).is_empty()) {
            return Err(Fault::Taken { line, column });
        }
        for (index, column) in COLUMNS.into_iter().enumerate() {
            table.places[index] = match table.named(column)[..] {
                [place] => place,
                [] => return Err(Fault::Missing { line, column }),
                _ => return Err(Fault::Twice { line, column }),
            };
        }
        Ok(table)
    }

    /// The line that was read last, as it is in the file.
    pub fn row(&self) -> &[u8] {
        &self.row
    }

    /// The poses of the next row; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<(Pose, Pose)>, Fault> {
        if !self.read_row()? {
            return Ok(None);
        }
        let mut numbers = [None; COLUMNS.len()];
        let mut found = 0;
        for (place, field) in fields(&self.row).enumerate() {
            found += 1;
            if let Some(index) = self.places.iter().position(|&column| column == place) {
                numbers[index] = Some(self.number(field, COLUMNS[index])?);
            }
        }
        match numbers {
            [Some(x0), Some(y0), Some(th0), Some(x1), Some(y1), Some(th1)] if found == self.width => {
                Ok(Some((Pose::new(x0, y0, th0), Pose::new(x1, y1, th1))))
            }
            _ => Err(Fault::Ragged { line: self.line, found, expected: self.width }),
        }
    }

    /// Returns the indices of the columns of that name.
    fn named(&self, column: &str) -> Vec<usize> {
        let names = fields(&self.row).enumerate().filter(|(_, name)| *name == column.as_bytes());
        names.map(|(place, _)| place).collect()
    }

    fn number(&self, field: &[u8], column: &'static str) -> Result<f64, Fault> {
        let number = std::str::from_utf8(field).ok().and_then(numbers::parse);
        number.filter(|number| NUMBERS.contains(number)).ok_or_else(|| Fault::Number {
            line: self.line,
            column,
            found: String::from_utf8_lossy(field).chars().take(SHOWN).collect(),
        })
    }

    /// Reads the next line that is not blank; whether there is one.
    fn read_row(&mut self) -> Result<bool, Fault> {
        loop {
            self.row.clear();
            let mut limited = self.source.by_ref().take(LONGEST_LINE as u64 + 1);
            if limited.read_until(b'\n', &mut self.row)? == 0 {
                return Ok(false);
            }
            self.line += 1;
            if self.row.len() > LONGEST_LINE {
                return Err(Fault::TooLong { line: self.line });
            }
            if self.line == 1 && self.row.starts_with(BYTE_ORDER_MARK) {
                self.row.drain(..BYTE_ORDER_MARK.len());
            }
            self.row.truncate(self.row.trim_ascii_end().len());
            if !self.row.is_empty() {
                return Ok(true);
            }
        }
    }
}

/// The fields of a row, without spaces and double quotes around them.
fn fields(row: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut is_quoted = false;
    let fields = row.split(move |&byte| {
        is_quoted ^= byte == b'"';
        byte == b',' && !is_quoted
    });
    fields.map(|field| {
        let field = field.trim_ascii();
        field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_in_quotes_hold_commas() {
        let found: Vec<&[u8]> = fields(b"1, 2 ,\"a,\"\"b\",,\"3\"").collect();
        assert_eq!(found, [b"1".as_slice(), b"2", b"a,\"\"b", b"", b"3"]);
        assert_eq!(fields(b"\"never closed,1,2").count(), 1);
    }
}
