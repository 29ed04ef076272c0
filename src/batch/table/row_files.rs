//! `runs.csv` and `agents.csv` as they grow, row by row, with cells that no spreadsheet computes.

use std::io;
use std::path::{Path, PathBuf};

use crate::batch::execute::{AGENTS_FILE, BatchError, Disk, OutputFolder, RUNS_FILE, RunRow, Whole};
use crate::batch::table::{AGENT_COLUMNS, AgentRow, COLUMNS_BEFORE_SWEPT, RUN_COLUMNS};
use crate::untrusted::spreadsheet_cell;

/// Both files of rows; they appear when finished.
pub struct RowFiles {
    runs: RowFile,
    agents: RowFile,
}

impl RowFiles {
    /// Columns of the swept keys stand behind those that say which run it is.
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, swept_keys: &[String]) -> Result<Self, BatchError> {
        let names = RUN_COLUMNS.iter().map(|column| column.name.to_owned());
        let runs = RowFile::create(folder.path().join(RUNS_FILE), disk, with_swept(names, swept_keys.iter().cloned()))?;
        let names = AGENT_COLUMNS.iter().map(|column| column.name.to_owned());
        let agents = RowFile::create(folder.path().join(AGENTS_FILE), disk, names)?;
        Ok(Self { runs, agents })
    }

    pub fn add(&mut self, row: &RunRow) -> Result<(), BatchError> {
        let values = RUN_COLUMNS.iter().map(|column| (column.value)(row).to_string());
        self.runs.add(with_swept(values, row.label.swept.iter().map(ToString::to_string)))?;
        for agent in AgentRow::all_of(row) {
            self.agents.add(AGENT_COLUMNS.iter().map(|column| (column.value)(&agent).to_string()))?;
        }
        Ok(())
    }

    pub fn finish(self) -> Result<(), BatchError> {
        self.agents.finish()?;
        self.runs.finish()
    }
}

/// The fields with those of what is swept among them.
fn with_swept(
    mut fields: impl Iterator<Item = String>,
    swept: impl Iterator<Item = String>,
) -> impl Iterator<Item = String> {
    let first: Vec<_> = fields.by_ref().take(COLUMNS_BEFORE_SWEPT).collect();
    first.into_iter().chain(swept).chain(fields)
}

struct RowFile {
    writer: csv::Writer<Box<dyn Whole>>,
    path: PathBuf,
}

impl RowFile {
    fn create(path: PathBuf, disk: &dyn Disk, header: impl Iterator<Item = String>) -> Result<Self, BatchError> {
        let file = disk.whole_file(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let mut file = Self { writer: csv::Writer::from_writer(file), path };
        file.add(header)?;
        Ok(file)
    }

    fn add(&mut self, fields: impl Iterator<Item = String>) -> Result<(), BatchError> {
        self.writer
            .write_record(fields.map(|field| spreadsheet_cell(&field).into_owned()))
            .map_err(|error| unwritable(&self.path, error.into()))
    }

    fn finish(self) -> Result<(), BatchError> {
        let file = self.writer.into_inner().map_err(|error| unwritable(&self.path, error.into_error()))?;
        file.finish().map_err(|source| BatchError::unwritable(&self.path, source))
    }
}

fn unwritable(path: &Path, source: io::Error) -> BatchError {
    BatchError::unwritable(path, source)
}
