//! `runs.csv` and `agents.csv` as they grow, row by row.

use std::io;
use std::path::{Path, PathBuf};

use crate::batch::{AGENT_COLUMNS, AGENTS_FILE, AgentRow, BatchError, OutputFolder, RUN_COLUMNS, RUNS_FILE, RunRow};
use crate::whole_file::WholeFile;

/// Both files of rows; they appear when finished.
pub struct RowFiles {
    runs: RowFile,
    agents: RowFile,
}

impl RowFiles {
    pub fn create(folder: &OutputFolder) -> Result<Self, BatchError> {
        let runs = RowFile::create(folder.path().join(RUNS_FILE), RUN_COLUMNS.iter().map(|column| column.name))?;
        let agents = RowFile::create(folder.path().join(AGENTS_FILE), AGENT_COLUMNS.iter().map(|column| column.name))?;
        Ok(Self { runs, agents })
    }

    pub fn add(&mut self, row: &RunRow) -> Result<(), BatchError> {
        self.runs.add(RUN_COLUMNS.iter().map(|column| (column.value)(row).to_string()))?;
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

struct RowFile {
    writer: csv::Writer<WholeFile>,
    path: PathBuf,
}

impl RowFile {
    fn create(path: PathBuf, header: impl Iterator<Item = &'static str>) -> Result<Self, BatchError> {
        let file = WholeFile::create(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let mut file = Self { writer: csv::Writer::from_writer(file), path };
        file.add(header.map(str::to_owned))?;
        Ok(file)
    }

    fn add(&mut self, fields: impl Iterator<Item = String>) -> Result<(), BatchError> {
        self.writer.write_record(fields).map_err(|error| unwritable(&self.path, error.into()))
    }

    fn finish(self) -> Result<(), BatchError> {
        let file = self.writer.into_inner().map_err(|error| unwritable(&self.path, error.into_error()))?;
        file.finish().map_err(|source| BatchError::unwritable(&self.path, source))
    }
}

fn unwritable(path: &Path, source: io::Error) -> BatchError {
    BatchError::unwritable(path, source)
}
