//! Execution: the workers that make the runs of a plan, the journal that loses none of them, and the batch's folder.
//!
//! What a run leaves is a [`RunRow`]: its numbers, not its facts.

mod cpu_split;
mod detail;
mod disk;
mod entries;
mod error;
mod journal;
mod lock;
mod machines;
mod output_folder;
pub(super) mod panics;
mod pilot;
mod row;
mod session;
mod status;
mod workers;

pub use cpu_split::CpuSplit;
pub use detail::{PlannerCall, RunDetail, STATE_STEPS, Solution, StateCount};
pub(super) use disk::write_whole;
pub use disk::{Append, Disk, RealDisk, Whole};
pub use entries::{
    AGENTS_FILE, CALLS_PARQUET, CHARTS_FOLDER, DECISIONS_PARQUET, MACHINES_FILE, RECORDINGS_FOLDER, REPORT_FILE,
    RUNS_FILE, RUNS_PARQUET, STATES_PARQUET, SUMMARY_FILE, TABLES_FILE, UnexpectedFile,
};
pub(super) use entries::{expect_file, expect_files};
pub use error::BatchError;
pub use journal::{FailedRuns, JournalError, JournalIndex};
pub(super) use journal::{RowReader, RowStream, StreamBudget};
pub use lock::Lock;
pub(super) use machines::merge_machines;
pub use machines::{Machine, Machines};
pub use output_folder::{JournalKeeping, OutputFolder, file_name_of};
pub use pilot::Pilot;
pub use row::{RunResult, RunRow, Status};
pub use session::{Batch, Found, LostRecording};
pub use status::{BatchStatus, JournalScan, MissingRuns, SliceState, batch_status, slices_of};
pub use workers::{RunEnd, RunScenario, limit_threads, with_threads};
