//! Tables of numbers from other programs, whose columns are found by their names, in any order among others.

use std::borrow::Cow;
use std::io::{self, ErrorKind};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::cli::csv_rows::{CsvRows, LONGEST_LINE, RowFault};
use crate::cli::error::CliError;
use crate::cli::numbers;
use wildfire_base::whole_file::WholeFile;

/// The most characters that are shown of a field that is no number.
const SHOWN: usize = 40;

/// A column that is read.
#[derive(Clone, Debug)]
pub struct Column {
    pub name: &'static str,
    pub content: Content,
    /// The number of rows without it: where the table has no such column, or the field is empty; `None` if every row
    /// must have it.
    pub without: Option<f64>,
}

/// What the fields of a column hold.
#[derive(Clone, Debug)]
pub enum Content {
    Number(RangeInclusive<f64>),
    /// A whole number from 0 to this one.
    Class(u8),
    /// One of these words; its place among them is the number.
    Word(&'static [&'static str]),
    /// Anything, see [`NumberTable::text`]; the number is NaN.
    Text,
}

/// The columns of a kind of table, what a row is called, and the columns that are written after those that are there.
#[derive(Debug)]
pub struct Columns<'a, const N: usize> {
    pub read: [Column; N],
    pub row: &'static str,
    pub added: &'a [&'static str],
}

/// A fault of a table: a sentence to follow its path. Lines are counted from 1.
#[derive(Debug, Error)]
pub enum TableFault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the file is empty; expected a header with the columns {expected}")]
    Empty { expected: String },
    #[error("line {line}: the column {column} is missing; expected a header with {expected}")]
    Missing { line: u64, column: &'static str, expected: String },
    #[error("line {line}: the column {column} appears twice; expected it once")]
    Twice { line: u64, column: &'static str },
    #[error("line {line}: the column {column} already exists; expected a table without the columns to be added")]
    Taken { line: u64, column: &'static str },
    #[error("line {line}: the line is longer than {LONGEST_LINE} bytes; expected {row}")]
    TooLong { line: u64, row: &'static str },
    #[error("line {line}: found {found} columns, expected {expected} as in the header")]
    Ragged { line: u64, found: usize, expected: usize },
    #[error("line {line}, column {column}: found {found:?}, expected {expected}")]
    Number { line: u64, column: &'static str, found: String, expected: String },
}

impl TableFault {
    /// Returns the kind of error of an input that has this fault.
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => ErrorKind::InvalidData,
        }
    }
}

/// A table of numbers, of which one row is kept at a time.
pub struct NumberTable<'a, const N: usize> {
    path: PathBuf,
    rows: CsvRows,
    columns: Columns<'a, N>,
    /// The number of columns of the header.
    width: usize,
    /// The place of each column in a row.
    places: [Option<usize>; N],
}

impl<'a, const N: usize> NumberTable<'a, N> {
    /// Reads the header, which must have all columns that rows cannot do without, and none of those that are added.
    pub fn open(path: &Path, columns: Columns<'a, N>) -> Result<Self, CliError> {
        let rows = CsvRows::open(path).map_err(|error| refused(path, TableFault::Unreadable(error)))?;
        let mut table = Self { path: path.to_owned(), rows, columns, width: 0, places: [None; N] };
        table.read_header().map_err(|fault| refused(path, fault))?;
        Ok(table)
    }

    fn read_header(&mut self) -> Result<(), TableFault> {
        let needed = self.columns.read.iter().filter(|column| column.without.is_none()).map(|column| column.name);
        let expected = needed.collect::<Vec<_>>().join(",");
        if !self.advance()? {
            return Err(TableFault::Empty { expected });
        }
        self.width = self.rows.fields().count();
        let line = self.rows.line();
        // A table that already has an answer's column would have two of that name.
        if let Some(&column) = self.columns.added.iter().find(|column| !self.rows.places(column).is_empty()) {
            return Err(TableFault::Taken { line, column });
        }
        for index in 0..N {
            let Column { name: column, without, .. } = self.columns.read[index];
            self.places[index] = match self.rows.places(column)[..] {
                [place] => Some(place),
                [] if without.is_some() => None,
                [] => return Err(TableFault::Missing { line, column, expected }),
                _ => return Err(TableFault::Twice { line, column }),
            };
        }
        Ok(())
    }

    /// The numbers of the next row, in the order of the columns that are read; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<[f64; N]>, CliError> {
        self.next_numbers().map_err(|fault| refused(&self.path, fault))
    }

    fn next_numbers(&mut self) -> Result<Option<[f64; N]>, TableFault> {
        if !self.advance()? {
            return Ok(None);
        }
        let mut numbers = [f64::NAN; N];
        for (number, column) in numbers.iter_mut().zip(&self.columns.read) {
            *number = column.without.unwrap_or(f64::NAN);
        }
        let mut found = 0;
        for (place, field) in self.rows.fields().enumerate() {
            found += 1;
            if let Some(index) = self.places.iter().position(|&column| column == Some(place)) {
                let column = &self.columns.read[index];
                // An empty field of an optional column counts as a missing column, since tables of spreadsheets have holes.
                let empty = column.without.filter(|_| field.is_empty());
                numbers[index] = empty.map_or_else(|| self.number(field, column), Ok)?;
            }
        }
        // Fields are found by place, so a row of another width would give a column the numbers of its neighbour.
        if found != self.width {
            return Err(TableFault::Ragged { line: self.rows.line(), found, expected: self.width });
        }
        Ok(Some(numbers))
    }

    /// Says that a number of the row that was read last is none of those that may be there.
    pub fn refuse(&self, index: usize, expected: String) -> CliError {
        refused(&self.path, self.fault(self.field(index), self.columns.read[index].name, expected))
    }

    /// Returns a field of the row that was read last as it is in the file.
    pub fn text(&self, index: usize) -> Cow<'_, str> {
        String::from_utf8_lossy(self.field(index))
    }

    fn field(&self, index: usize) -> &[u8] {
        self.places[index].and_then(|place| self.rows.fields().nth(place)).unwrap_or_default()
    }

    fn advance(&mut self) -> Result<bool, TableFault> {
        self.rows.advance().map_err(|fault| match fault {
            RowFault::Unreadable(error) => TableFault::Unreadable(error),
            RowFault::TooLong { line } => TableFault::TooLong { line, row: self.columns.row },
        })
    }

    fn number(&self, field: &[u8], column: &Column) -> Result<f64, TableFault> {
        let text = std::str::from_utf8(field).ok();
        let number = match &column.content {
            Content::Number(range) => self.rows.number(field).filter(|number| range.contains(number)),
            Content::Class(last) => self.rows.number::<u8>(field).filter(|class| class <= last).map(f64::from),
            Content::Word(allowed) => allowed.iter().position(|word| Some(*word) == text).map(|place| place as f64),
            Content::Text => Some(f64::NAN),
        };
        number.ok_or_else(|| self.fault(field, column.name, expected(&column.content)))
    }

    fn fault(&self, field: &[u8], column: &'static str, expected: String) -> TableFault {
        let found = String::from_utf8_lossy(field).chars().take(SHOWN).collect();
        TableFault::Number { line: self.rows.line(), column, found, expected }
    }
}

fn expected(content: &Content) -> String {
    match content {
        Content::Number(range) => format!("a number {}", numbers::range_text(range)),
        Content::Class(last) => format!("a whole number from 0 to {last}"),
        Content::Word(allowed) => allowed.join(" or "),
        Content::Text => String::new(),
    }
}

/// Writes the rows of a table, each once with every one of its answers behind it, which `answer` computes from its numbers;
/// returns the number of rows that were read. A row is read, written and forgotten before the next.
pub fn write_answers<const N: usize>(
    input: &Path,
    output: &Path,
    columns: Columns<N>,
    mut answer: impl FnMut(&NumberTable<N>, &[f64; N]) -> Result<Vec<String>, CliError>,
) -> Result<u64, CliError> {
    let unwritable = |error: io::Error| CliError::unwritable(output, &error);
    let added = columns.added.join(",");
    let mut rows = NumberTable::open(input, columns)?;
    let mut table = WholeFile::create(output).map_err(unwritable)?;
    rows.rows.write_with(&mut table, &added).map_err(unwritable)?;
    let mut count = 0;
    while let Some(numbers) = rows.next()? {
        for answer in answer(&rows, &numbers)? {
            rows.rows.write_with(&mut table, &answer).map_err(unwritable)?;
        }
        count += 1;
    }
    table.finish().map_err(unwritable)?;
    Ok(count)
}

fn refused(path: &Path, fault: TableFault) -> CliError {
    CliError::from_input_error(format_args!("{}: {fault}", path.display()), fault.kind())
}
