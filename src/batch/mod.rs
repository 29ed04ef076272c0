//! Many runs: what is asked for, workers, a journal that loses nothing, tables in the order of the plan.
//!
//! A [`BatchPlan`] says which runs there are. A [`Batch`] runs them on several threads and keeps a journal with a line
//! for each that is over; when all are, the tables are written from the journal. So a batch can end at any moment and be
//! resumed, and what is in memory does not grow with the number of runs, but for a few bytes each. What a row says
//! never depends on the number of workers, on slices or on interruptions, except for its `cpu_` and `wall_` columns. A
//! run that fails, or panics, is a row like the others, with the reason.

mod audits;
mod columns;
pub mod comparison;
mod cpu_split;
mod detail;
mod dictionary;
mod disk;
mod entries;
mod error;
mod finish;
mod finished;
pub mod html;
mod html_report;
mod journal;
mod json;
mod notes;
mod output_folder;
mod panics;
mod parquet_files;
mod plan;
mod profile;
mod report;
mod row;
mod row_files;
mod seeds;
mod session;
mod slice;
mod status;
mod tables;
mod tally;
mod text_table;
mod workers;

pub use audits::{AuditReport, AuditSource, AuditsError, TOLD_VIOLATIONS, audit_all};
pub use columns::{
    AGENT_COLUMNS, AgentColumn, AgentRow, COLUMNS_BEFORE_SWEPT, Column, RUN_COLUMNS, RunColumn, Value, is_measured,
};
pub use cpu_split::CpuSplit;
pub use detail::{PlannerCall, RunDetail, STATE_STEPS, Solution, StateCount};
pub use dictionary::{TableOfRows, row_schema};
pub use disk::{Append, Disk, RealDisk, Whole};
pub use entries::{AGENTS_FILE, PLAN_FILE, RECORDINGS_FOLDER, RUNS_FILE, StrangeEntry, TABLES_FILE};
pub use error::BatchError;
pub use finish::{Merged, merge};
pub use finished::{FinishedBatch, FinishedError, recordings_in};
pub use html_report::{CHARTS_FOLDER, REPORT_FILE, ReportError, WrittenReport, write_report};
pub use journal::{JournalError, JournalIndex};
pub use json::run_json;
pub use notes::notes;
pub use output_folder::{OutputFolder, file_name_of};
pub use parquet_files::{CALLS_PARQUET, RUNS_PARQUET, STATES_PARQUET};
pub use plan::{
    BatchPlan, BatchRequest, MAX_VARIANTS, PLAN_TEMPLATE, PROGRAM_VERSION, PlanError, PlannedRun, RUNS_WITHOUT_FORCE,
    Record, RequestError, Setting, Sweep, SweepError, Variant, plan_schema, shell_word,
};
pub use report::{BatchReport, VariantReport};
pub use row::{RunLabel, RunResult, RunRow, Status};
pub use seeds::{MAX_RUNS, Seeds, SeedsError};
pub use session::{Batch, Found, LostRecording};
pub use slice::{Slice, SliceError};
pub use status::{BatchStatus, SliceState, batch_status};
pub use tables::{SHOWN_RUNS, Tables};
pub use tally::Tally;
pub use text_table::TextTable;
pub use workers::RunScenario;

use finish::write_tables;
