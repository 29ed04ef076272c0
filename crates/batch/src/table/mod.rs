//! The tables of a batch: their columns, writers and readers.
//!
//! `columns` has a line for every column of every file. [`RunRecord`] is a row of `runs.csv`, computed or read;
//! [`TableReader`] reads any table that this program wrote.

mod column;
mod columns;
mod csv_files;
mod dictionary;
mod finished;
mod parquet;
mod query_tally;
mod reader;
mod record;

pub(super) use column::{Aim, Phrase};
pub use column::{Better, Column, FileColumn, Kind, Unit};
pub use columns::{
    AGENT_COLUMNS, AgentColumn, AgentRow, CALL_COLUMNS, COLUMNS_BEFORE_SWEPT, CallColumn, RUN_COLUMNS, RunColumn,
    STATE_COLUMNS, StateColumn, is_measured, run_column,
};
pub(super) use columns::{about, columns};
pub(super) use csv_files::{CsvFiles, CsvLines};
pub use dictionary::{TableOfRows, row_schema};
pub(super) use finished::FinishedRows;
pub use finished::{FinishedBatch, FinishedError, recordings_in};
pub use parquet::swept_columns;
pub(super) use parquet::{ParquetFiles, ParquetReader, ParquetWriter, RowGroup, new_file};
pub use query_tally::QueryTally;
pub use reader::{TableError, TableReader};
pub(super) use record::RecordedRow;
pub use record::RunRecord;
