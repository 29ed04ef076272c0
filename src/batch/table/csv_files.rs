//! `runs.csv` and `agents.csv` as they grow, row by row, with cells that no spreadsheet computes.

use std::path::PathBuf;

use crate::batch::execute::{AGENTS_FILE, BatchError, Disk, OutputFolder, RUNS_FILE, RunRow, Whole};
use crate::batch::plan::Value;
use crate::batch::table::columns::{AGENT_COLUMNS, AgentRow, COLUMNS_BEFORE_SWEPT, RUN_COLUMNS, RunColumn};
use crate::batch::table::record::RunRecord;
use crate::untrusted::spreadsheet_cell;

/// Both files of rows; they appear when finished.
pub struct CsvFiles {
    runs: CsvFile,
    agents: CsvFile,
}

impl CsvFiles {
    /// Begins both files. Columns of the swept keys come after those that say which run it is.
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, swept_keys: &[String]) -> Result<Self, BatchError> {
        let (label, rest) = RUN_COLUMNS.split_at(COLUMNS_BEFORE_SWEPT);
        let name = |column: &RunColumn| column.name.to_owned();
        let names = label.iter().map(name).chain(swept_keys.iter().cloned()).chain(rest.iter().map(name));
        let runs = CsvFile::create(folder.path().join(RUNS_FILE), disk, names)?;
        let names = AGENT_COLUMNS.iter().map(|column| column.name.to_owned());
        let agents = CsvFile::create(folder.path().join(AGENTS_FILE), disk, names)?;
        Ok(Self { runs, agents })
    }

    /// Adds a run, whose record this is, and its agents.
    pub fn add(&mut self, row: &RunRow, record: &RunRecord) -> Result<(), BatchError> {
        let (label, rest) = record.values().split_at(COLUMNS_BEFORE_SWEPT);
        self.runs.add(label.iter().chain(&row.label.swept).chain(rest).map(Value::to_string))?;
        for agent in AgentRow::from_run(row) {
            self.agents.add(AGENT_COLUMNS.iter().map(|column| (column.value)(&agent).to_string()))?;
        }
        Ok(())
    }

    pub fn finish(self) -> Result<(), BatchError> {
        self.agents.finish()?;
        self.runs.finish()
    }
}

struct CsvFile {
    writer: csv::Writer<Box<dyn Whole>>,
    path: PathBuf,
}

impl CsvFile {
    fn create(path: PathBuf, disk: &dyn Disk, header: impl Iterator<Item = String>) -> Result<Self, BatchError> {
        let file = disk.whole_file(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let mut file = Self { writer: csv::Writer::from_writer(file), path };
        file.add(header)?;
        Ok(file)
    }

    fn add(&mut self, fields: impl Iterator<Item = String>) -> Result<(), BatchError> {
        self.writer
            .write_record(fields.map(|field| spreadsheet_cell(&field).into_owned()))
            .map_err(|error| BatchError::unwritable(&self.path, error.into()))
    }

    fn finish(self) -> Result<(), BatchError> {
        let file = self.writer.into_inner().map_err(|error| BatchError::unwritable(&self.path, error.into_error()))?;
        file.finish().map_err(|source| BatchError::unwritable(&self.path, source))
    }
}
