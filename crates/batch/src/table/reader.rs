//! The reader of tables that this program wrote as CSV, in any version: rows whose columns are found by their names,
//! and whose fields are read as what they are. A file that is no such table cannot take memory without bounds.

use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, Reader, ReaderBuilder};
use thiserror::Error;

use crate::plan::Value;
use crate::table::column::Kind;
use wildfire_base::input_file::{self, InputFile, TextReader};
use wildfire_base::untrusted::{bytes_of_cell, visible_start};

/// The most bytes between the ends of two rows.
const MAX_ROW_BYTES: u64 = 1 << 20;

/// The reason why a table cannot be read. Messages name the file and show its contents in harmless characters.
#[derive(Debug, Error)]
pub enum TableError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{}: the column `{column}` appears twice", path.display())]
    ColumnTwice { path: PathBuf, column: String },
    #[error("{}: line {line}: {complaint}", path.display())]
    Damaged { path: PathBuf, line: u64, complaint: String },
    #[error("{}: line {line}: {column} is `{found}`; expected {expected}", path.display())]
    WrongValue { path: PathBuf, line: u64, column: String, found: String, expected: &'static str },
    #[error("{}: {complaint}", path.display())]
    Unfit { path: PathBuf, complaint: String },
}

/// An open table at one of its rows.
pub struct TableReader {
    path: PathBuf,
    reader: Reader<LimitedReader>,
    columns: Vec<String>,
    row: ByteRecord,
}

impl TableReader {
    /// Opens a table and reads the names of its columns.
    pub fn open(path: &Path) -> Result<Self, TableError> {
        let path = path.to_owned();
        let file = match input_file::open(&path) {
            Ok(file) => LimitedReader { file: TextReader::new(file), left: MAX_ROW_BYTES },
            Err(source) => return Err(TableError::Unreadable { path, source }),
        };
        let mut reader = ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(file);
        let columns = match reader.byte_headers() {
            Ok(names) => names.iter().map(|name| String::from_utf8_lossy(bytes_of_cell(name)).into_owned()).collect(),
            Err(error) => return Err(damaged(path, 1, &error)),
        };
        let table = Self { path, reader, columns, row: ByteRecord::new() };
        // Columns are found by name, so two of one name would be one of them by chance.
        let mut sorted: Vec<&String> = table.columns.iter().collect();
        sorted.sort();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(TableError::ColumnTwice { column: visible_start(pair[0]), path: table.path.clone() }),
            None => Ok(table),
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the names of the columns in their order.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Returns the place of a column in every row.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|name| name == column)
    }

    /// Moves to the next row; false if there is none.
    pub fn next_row(&mut self) -> Result<bool, TableError> {
        self.reader.get_mut().left = MAX_ROW_BYTES;
        let line = self.reader.position().line();
        self.reader.read_byte_record(&mut self.row).map_err(|error| damaged(self.path.clone(), line, &error))
    }

    /// Returns the field as it was before it was made safe for spreadsheets.
    pub fn bytes(&self, place: usize) -> &[u8] {
        bytes_of_cell(&self.row[place])
    }

    /// Returns the integer in a field.
    pub fn count(&self, place: usize, expected: &'static str) -> Result<u64, TableError> {
        let digits = std::str::from_utf8(&self.row[place]).ok().and_then(|digits| digits.parse().ok());
        digits.ok_or_else(|| self.wrong_value(place, expected))
    }

    /// Returns the number in a field; `None` if the field is empty.
    pub fn number(&self, place: usize) -> Result<Option<f64>, TableError> {
        let digits = &self.row[place];
        if digits.is_empty() {
            return Ok(None);
        }
        let number = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok());
        number.map(Some).ok_or_else(|| self.wrong_value(place, "a number, or nothing"))
    }

    /// Returns the value in a field of this kind.
    pub fn value(&self, place: usize, kind: Kind) -> Result<Value, TableError> {
        if self.row[place].is_empty() {
            return Ok(Value::Missing);
        }
        match kind {
            Kind::Count | Kind::LargeCount => Ok(Value::Count(self.count(place, "a whole number, or nothing")?)),
            Kind::Real => Ok(self.number(place)?.into()),
            Kind::Text => Ok(Value::Text(String::from_utf8_lossy(self.bytes(place)).into_owned())),
            Kind::Flag => match &self.row[place] {
                b"true" => Ok(Value::Flag(true)),
                b"false" => Ok(Value::Flag(false)),
                _ => Err(self.wrong_value(place, "true, false, or nothing")),
            },
        }
    }

    /// Returns the error of an invalid field in this row.
    pub fn wrong_value(&self, place: usize, expected: &'static str) -> TableError {
        TableError::WrongValue {
            path: self.path.clone(),
            line: self.row.position().map_or(0, csv::Position::line),
            column: visible_start(&self.columns[place]),
            found: visible_start(&String::from_utf8_lossy(&self.row[place])),
            expected,
        }
    }
}

/// `line` is where the row begins that cannot be read.
fn damaged(path: PathBuf, line: u64, error: &csv::Error) -> TableError {
    let complaint = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => format!("{len} fields; expected {expected_len}"),
        csv::ErrorKind::Io(source) if source.kind() == ErrorKind::QuotaExceeded => {
            format!("more than {MAX_ROW_BYTES} bytes; expected a row to end before")
        }
        csv::ErrorKind::Io(source) => {
            return TableError::Unreadable { path, source: io::Error::new(source.kind(), source.to_string()) };
        }
        _ => error.to_string(),
    };
    TableError::Damaged { path, line, complaint }
}

/// A file that gives a limited number of bytes at a time, so that a row without an end cannot fill the memory.
struct LimitedReader {
    file: TextReader<InputFile>,
    left: u64,
}

impl Read for LimitedReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(ErrorKind::QuotaExceeded.into());
        }
        let read = self.file.read(buffer)?;
        self.left = self.left.saturating_sub(read as u64);
        Ok(read)
    }
}
