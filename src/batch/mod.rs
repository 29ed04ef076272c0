//! Many runs of one scenario: workers, rows in the order of the seeds, tables, files.
//!
//! A batch holds in memory the rows of a few hundred runs at most; each row goes to the files as soon as all rows
//! before it have gone. What a row says never depends on the number of workers, except for its `cpu_` and `wall_`
//! columns. A run that fails, or panics, is a row like the others, with the reason.

mod audits;
mod columns;
pub mod comparison;
mod cpu_split;
mod finished;
mod json;
mod output_folder;
mod panics;
mod plan;
mod row;
mod row_files;
mod seeds;
mod tables;
mod tally;
mod text_table;
mod workers;

pub use audits::{AuditReport, AuditSource, AuditsError, TOLD_OFFENCES, audit_all};
pub use columns::{AGENT_COLUMNS, AgentColumn, AgentRow, Column, RUN_COLUMNS, RunColumn, Value, is_measured};
pub use cpu_split::CpuSplit;
pub use finished::{FinishedBatch, FinishedError, FinishedRun, recordings_in};
pub use json::run_json;
pub use output_folder::{
    AGENTS_FILE, OutputFolder, PLAN_FILE, RECORDINGS_FOLDER, RUNS_FILE, TABLES_FILE, file_name_of,
};
pub use plan::{BatchPlan, PROGRAM_VERSION, Record};
pub use row::{RunResult, RunRow, Status};
pub use seeds::{MAX_RUNS, Seeds, SeedsError};
pub use tables::{SHOWN_RUNS, Tables};
pub use tally::Tally;
pub use text_table::TextTable;
pub use workers::{run_batch, run_batch_with};

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a batch stops before its last run, or does not begin.
#[derive(Debug, Error)]
pub enum BatchError {
    #[error("{} already holds {entry} of an earlier batch", path.display())]
    HoldsResults { path: PathBuf, entry: &'static str },
    #[error("{} is a file; expected a folder for the results", path.display())]
    NotAFolder { path: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Unwritable { path: PathBuf, source: io::Error },
    #[error("cannot write the recording {}: {source}", path.display())]
    Unrecordable { path: PathBuf, source: io::Error },
    #[error("cannot start {jobs} worker threads: {reason}")]
    NoWorkers { jobs: usize, reason: String },
}

impl BatchError {
    fn unwritable(path: &Path, source: io::Error) -> Self {
        Self::Unwritable { path: path.to_owned(), source }
    }
}

/// What a finished batch reports, besides its files.
#[derive(Clone, Debug)]
pub struct BatchReport {
    pub tables: Tables,
    pub tally: Tally,
}
