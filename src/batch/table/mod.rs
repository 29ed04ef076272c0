//! The tables of a batch: what their columns are, how they are written, and how they are read back.

mod columns;
mod dictionary;
mod finished;
mod parquet;
mod row_files;

pub use columns::{
    AGENT_COLUMNS, AgentColumn, AgentRow, COLUMNS_BEFORE_SWEPT, Column, RUN_COLUMNS, RunColumn, is_measured,
};
pub use dictionary::{TableOfRows, row_schema};
pub use finished::{FinishedBatch, FinishedError, recordings_in};
pub(super) use finished::{FinishedRow, FinishedRows};
pub(super) use parquet::ParquetFiles;
use parquet::{CALL_COLUMNS, FileColumn, Kind, STATE_COLUMNS, run_columns};
pub(super) use row_files::RowFiles;
