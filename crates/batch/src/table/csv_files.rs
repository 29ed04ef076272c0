//! `runs.csv` and `agents.csv`, written row by row, with cells that no spreadsheet evaluates.

use std::fmt::Write as _;
use std::path::PathBuf;

use rayon::prelude::*;

use crate::execute::{AGENTS_FILE, BatchError, Disk, OutputFolder, RUNS_FILE, Whole};
use crate::plan::Value;
use crate::table::columns::{AGENT_COLUMNS, AgentRow, COLUMNS_BEFORE_SWEPT, RUN_COLUMNS, RunColumn};
use crate::table::record::RecordedRow;
use wildfire_base::untrusted::spreadsheet_cell;

/// Rows whose lines are made at once, by one of several threads.
const ROWS_OF_A_PART: usize = 64;

/// Both files of rows, which appear when complete.
pub struct CsvFiles {
    runs: CsvFile,
    agents: CsvFile,
}

impl CsvFiles {
    /// Begins both files. Columns of the swept keys follow those that identify the run.
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, swept_keys: &[String]) -> Result<Self, BatchError> {
        let (label, rest) = RUN_COLUMNS.split_at(COLUMNS_BEFORE_SWEPT);
        let name = |column: &RunColumn| column.name.to_owned();
        let names = label.iter().map(name).chain(swept_keys.iter().cloned()).chain(rest.iter().map(name));
        let runs = CsvFile::create(folder.path().join(RUNS_FILE), disk, names)?;
        let names = AGENT_COLUMNS.iter().map(|column| column.name.to_owned());
        let agents = CsvFile::create(folder.path().join(AGENTS_FILE), disk, names)?;
        Ok(Self { runs, agents })
    }

    /// Adds runs and their agents.
    pub fn add(&mut self, rows: &[RecordedRow]) -> Result<(), BatchError> {
        let parts: Vec<[Vec<u8>; 2]> = rows.par_chunks(ROWS_OF_A_PART).map(lines_of).collect();
        for [runs, agents] in parts {
            self.runs.append(&runs)?;
            self.agents.append(&agents)?;
        }
        Ok(())
    }

    pub fn finish(self) -> Result<(), BatchError> {
        self.agents.finish()?;
        self.runs.finish()
    }
}

/// Returns the lines of runs, and those of their agents.
fn lines_of(rows: &[RecordedRow]) -> [Vec<u8>; 2] {
    let mut lines = [CsvLines::default(), CsvLines::default()];
    let [runs, agents] = &mut lines;
    for recorded in rows {
        recorded.values().for_each(|value| runs.add_field(value));
        runs.end();
        for agent in AgentRow::from_run(&recorded.row) {
            AGENT_COLUMNS.iter().for_each(|column| agents.add_field(&(column.value)(&agent)));
            agents.end();
        }
    }
    lines.map(CsvLines::into_bytes)
}

/// The lines of a file in memory, whose cells no spreadsheet evaluates.
pub struct CsvLines {
    writer: csv::Writer<Vec<u8>>,
    field: String,
}

impl Default for CsvLines {
    fn default() -> Self {
        Self { writer: csv::Writer::from_writer(Vec::new()), field: String::new() }
    }
}

impl CsvLines {
    pub fn add_field(&mut self, value: &Value) {
        // Numbers are no formulas, whatever they begin with.
        let written = match value {
            Value::Text(text) => self.writer.write_field(spreadsheet_cell(text).as_bytes()),
            Value::Missing => self.writer.write_field(b""),
            Value::Count(_) | Value::Real(_) | Value::Flag(_) => {
                self.field.clear();
                write!(self.field, "{value}").expect("a string takes any text");
                self.writer.write_field(&self.field)
            }
        };
        written.expect("memory takes everything");
    }

    pub fn end(&mut self) {
        self.writer.write_record(None::<&[u8]>).expect("memory takes everything");
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.writer.into_inner().expect("memory takes everything")
    }
}

struct CsvFile {
    file: Box<dyn Whole>,
    path: PathBuf,
}

impl CsvFile {
    fn create(path: PathBuf, disk: &dyn Disk, header: impl Iterator<Item = String>) -> Result<Self, BatchError> {
        let file = disk.whole_file(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let mut lines = CsvLines::default();
        header.for_each(|name| lines.add_field(&Value::Text(name)));
        lines.end();
        let mut file = Self { file, path };
        file.append(&lines.into_bytes())?;
        Ok(file)
    }

    fn append(&mut self, lines: &[u8]) -> Result<(), BatchError> {
        self.file.write_all(lines).map_err(|source| BatchError::unwritable(&self.path, source))
    }

    fn finish(self) -> Result<(), BatchError> {
        let Self { file, path } = self;
        file.finish().map_err(|source| BatchError::unwritable(&path, source))
    }
}
