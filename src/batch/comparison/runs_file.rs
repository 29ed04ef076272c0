//! `runs.csv` as it is read: the columns that a comparison needs, by their names.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, Reader, ReaderBuilder};

use crate::batch::comparison::error::ComparisonError;
use crate::batch::comparison::words::shown;
use crate::batch::execute::{RUNS_FILE, expect_files};
use crate::batch::plan::MAX_RUNS;
use crate::input_file::{self, InputFile};
use crate::untrusted::bytes_of_cell;

/// The most bytes between the ends of two rows.
const MAX_ROW_BYTES: u64 = 1 << 20;

/// Numbers of larger size could overflow in sums of squares.
const LARGEST: f64 = 1e100;

/// The most values of a condition, and the most bytes of one.
const MAX_LEVELS: usize = 10_000;
const MAX_LEVEL_BYTES: usize = 1000;

/// What is read of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Field {
    /// The number in this column.
    Number(String),
    /// 1 if the column holds this word, else 0.
    Is(String, &'static str),
}

impl Field {
    fn column(&self) -> &str {
        match self {
            Self::Number(column) | Self::Is(column, _) => column,
        }
    }
}

/// A table of runs that is open; its header has been read.
pub struct RunsFile {
    path: PathBuf,
    reader: Reader<Rationed>,
    header: Vec<String>,
}

/// Runs, in the order of the file.
#[derive(Debug)]
pub struct RunsTable {
    pub path: PathBuf,
    pub seeds: Vec<u64>,
    /// Whether the run came to its end.
    pub done: Vec<bool>,
    pub conditions: Vec<Condition>,
    /// For each field that was asked for, the value of every run; NaN where there is none.
    pub values: Vec<Vec<f64>>,
}

/// What runs were made under: scenario, planner, or a key that a batch sweeps.
#[derive(Debug)]
pub struct Condition {
    pub name: String,
    /// In the order of their first runs.
    pub levels: Vec<String>,
    /// Of every run, an index into the levels.
    pub of_run: Vec<u32>,
}

impl RunsFile {
    /// Opens the table of a batch: its folder, or the file itself.
    pub fn open(path: &Path) -> Result<Self, ComparisonError> {
        let path = if path.is_dir() {
            expect_files(path)?;
            path.join(RUNS_FILE)
        } else {
            path.to_owned()
        };
        let file = input_file::open(&path).map_err(|source| match source.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => ComparisonError::NoBatch { path: path.clone() },
            _ => ComparisonError::Unreadable { path: path.clone(), source },
        })?;
        let file = Rationed { file, left: MAX_ROW_BYTES };
        let mut reader = ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(file);
        let header = reader.byte_headers().map_err(|error| damaged(&path, 1, &error))?;
        let header: Vec<String> =
            header.iter().map(|name| String::from_utf8_lossy(bytes_of_cell(name)).into_owned()).collect();
        let file = Self { path, reader, header };
        file.check_header()?;
        Ok(file)
    }

    fn check_header(&self) -> Result<(), ComparisonError> {
        let path = || self.path.clone();
        for column in ["seed", "status"] {
            if !self.has(column) {
                return Err(ComparisonError::NotATableOfRuns { path: path(), column });
            }
        }
        let mut sorted: Vec<&String> = self.header.iter().collect();
        sorted.sort();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(ComparisonError::ColumnTwice { path: path(), column: shown(pair[0]) }),
            None => Ok(()),
        }
    }

    pub fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    pub fn columns(&self) -> &[String] {
        &self.header
    }

    /// Reads all rows.
    pub fn read(mut self, fields: &[Field]) -> Result<RunsTable, ComparisonError> {
        let mut table = self.empty_table(fields);
        let layout = Layout::of(&self.header, fields);
        let mut levels: Vec<BTreeMap<Vec<u8>, u32>> = vec![BTreeMap::new(); table.conditions.len()];
        let mut row = ByteRecord::new();
        loop {
            self.reader.get_mut().left = MAX_ROW_BYTES;
            match self.reader.read_byte_record(&mut row) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => return Err(damaged(&self.path, self.reader.position().line(), &error)),
            }
            if table.seeds.len() as u64 == MAX_RUNS {
                return Err(ComparisonError::TooManyRows { path: self.path, limit: MAX_RUNS });
            }
            self.take_row(&row, &layout, fields, &mut table, &mut levels)?;
        }
        if table.seeds.is_empty() {
            return Err(ComparisonError::NoRows { path: self.path });
        }
        Ok(table)
    }

    fn empty_table(&self, fields: &[Field]) -> RunsTable {
        let condition = |name: &String| Condition { name: name.clone(), levels: Vec::new(), of_run: Vec::new() };
        RunsTable {
            path: self.path.clone(),
            seeds: Vec::new(),
            done: Vec::new(),
            conditions: conditions_in(&self.header).map(|(_, name)| condition(name)).collect(),
            values: vec![Vec::new(); fields.len()],
        }
    }

    fn take_row(
        &self,
        row: &ByteRecord,
        layout: &Layout,
        fields: &[Field],
        table: &mut RunsTable,
        levels: &mut [BTreeMap<Vec<u8>, u32>],
    ) -> Result<(), ComparisonError> {
        let seed = std::str::from_utf8(&row[layout.seed]).ok().and_then(|digits| digits.parse().ok());
        table.seeds.push(seed.ok_or_else(|| self.wrong_value(row, layout.seed, "a seed"))?);
        table.done.push(&row[layout.status] == b"done");
        for ((condition, levels), &column) in table.conditions.iter_mut().zip(levels).zip(&layout.conditions) {
            if row[column].len() > MAX_LEVEL_BYTES || levels.len() > MAX_LEVELS {
                return Err(self.wrong_value(row, column, "at most 1000 bytes, and 10000 values in all"));
            }
            condition.add(bytes_of_cell(&row[column]), levels);
        }
        for ((values, field), &column) in table.values.iter_mut().zip(fields).zip(&layout.fields) {
            let found = &row[column];
            values.push(match field {
                _ if found.is_empty() => f64::NAN,
                Field::Is(_, word) => f64::from(u8::from(found == word.as_bytes())),
                Field::Number(_) => {
                    number(found).ok_or_else(|| self.wrong_value(row, column, "a number, or nothing"))?
                }
            });
        }
        Ok(())
    }

    fn wrong_value(&self, row: &ByteRecord, column: usize, expected: &'static str) -> ComparisonError {
        ComparisonError::WrongValue {
            path: self.path.clone(),
            line: row.position().map_or(0, csv::Position::line),
            column: shown(&self.header[column]),
            found: shown(&String::from_utf8_lossy(&row[column])),
            expected,
        }
    }
}

impl Condition {
    fn add(&mut self, level: &[u8], known: &mut BTreeMap<Vec<u8>, u32>) {
        let index = known.get(level).copied().unwrap_or_else(|| {
            let index = self.levels.len() as u32;
            self.levels.push(String::from_utf8_lossy(level).into_owned());
            known.insert(level.to_owned(), index);
            index
        });
        self.of_run.push(index);
    }

    pub fn level_of(&self, run: usize) -> &str {
        &self.levels[self.of_run[run] as usize]
    }
}

/// Where in a row things stand.
struct Layout {
    seed: usize,
    status: usize,
    conditions: Vec<usize>,
    fields: Vec<usize>,
}

impl Layout {
    /// The columns have been checked to be there.
    fn of(header: &[String], fields: &[Field]) -> Self {
        let place = |column: &str| header.iter().position(|name| name == column).expect("the column was looked for");
        Self {
            seed: place("seed"),
            status: place("status"),
            conditions: conditions_in(header).map(|(place, _)| place).collect(),
            fields: fields.iter().map(|field| place(field.column())).collect(),
        }
    }
}

/// What stands before the status, but for the names of the run itself.
fn conditions_in(header: &[String]) -> impl Iterator<Item = (usize, &String)> {
    let before_status = header.iter().enumerate().take_while(|(_, name)| *name != "status");
    before_status.filter(|(_, name)| *name != "seed" && *name != "run")
}

fn number(digits: &[u8]) -> Option<f64> {
    let number: f64 = std::str::from_utf8(digits).ok()?.parse().ok()?;
    (number.abs() <= LARGEST).then_some(number)
}

/// `line` is where the row begins that cannot be read.
fn damaged(path: &Path, line: u64, error: &csv::Error) -> ComparisonError {
    let path = path.to_owned();
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            ComparisonError::Damaged { path, line, complaint: format!("{len} fields; expected {expected_len}") }
        }
        csv::ErrorKind::Io(source) if source.kind() == ErrorKind::QuotaExceeded => {
            let complaint = format!("more than {MAX_ROW_BYTES} bytes; expected a row to end before");
            ComparisonError::Damaged { path, line, complaint }
        }
        csv::ErrorKind::Io(source) => {
            ComparisonError::Unreadable { path, source: io::Error::new(source.kind(), source.to_string()) }
        }
        _ => ComparisonError::Damaged { path, line, complaint: error.to_string() },
    }
}

/// A file of which only so many bytes are read at a time, so that a row without an end cannot fill the memory.
struct Rationed {
    file: InputFile,
    left: u64,
}

impl Read for Rationed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(ErrorKind::QuotaExceeded.into());
        }
        let read = self.file.read(buffer)?;
        self.left = self.left.saturating_sub(read as u64);
        Ok(read)
    }
}
