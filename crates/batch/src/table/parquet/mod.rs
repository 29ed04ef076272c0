//! The tables for other tools: `runs.parquet`, `planner_calls.parquet`, `states.parquet`.
//!
//! `runs.parquet` has the columns and rows of `runs.csv`. The other two are long: a row for each call of a planner, and
//! for each time at which the bushes are counted; both begin with the columns that say which run it is. Names follow
//! those of OMPL's benchmarks (Moll, Sucan, Kavraki, "Benchmarking Motion Planning Algorithms", IEEE Robotics and
//! Automation Magazine, 2015) where the meaning is the same: `solved`, `status`, `solution_length_m`,
//! `solution_segments`.
//!
//! Whole numbers are signed, so that columns can be subtracted from one another. A seed is a label that may be any
//! unsigned number: its column is unsigned in a batch with a seed beyond [`i64::MAX`], and signed in every other. A
//! column in which a row may have no value says so, and has nulls there; no other column may have any. Every file names
//! the plan and the program that it is of, under the keys that they have in `plan.json`, and under `row_schema` it has
//! what its columns mean and their units, as `wildfire schema` prints it.

mod reader;
mod writer;

pub use reader::{ParquetReader, RowGroup};
pub use writer::ParquetWriter;

use std::path::PathBuf;

use crate::execute::{BatchError, CALLS_PARQUET, Disk, OutputFolder, RUNS_PARQUET, STATES_PARQUET};
use crate::plan::{BatchPlan, COMMIT, COMPILER, PROGRAM_VERSION, Value};
use crate::table::column::{FileColumn, Kind};
use crate::table::columns::{CALL_COLUMNS, STATE_COLUMNS};
use crate::table::dictionary::{TableOfRows, schema_of};
use crate::table::record::RecordedRow;

/// Rows that are held in memory, of some seventy columns and of some fifteen.
const WIDE_ROWS: usize = 2048;
const LONG_ROWS: usize = 16_384;

/// All three files, which appear when complete.
pub struct ParquetFiles {
    runs: ParquetWriter,
    calls: ParquetWriter,
    states: ParquetWriter,
}

impl ParquetFiles {
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, plan: &BatchPlan) -> Result<Self, BatchError> {
        let folder = folder.path();
        Ok(Self {
            runs: new_file(folder.join(RUNS_PARQUET), disk, plan, TableOfRows::Runs, WIDE_ROWS)?,
            calls: new_file(folder.join(CALLS_PARQUET), disk, plan, TableOfRows::PlannerCalls, LONG_ROWS)?,
            states: new_file(folder.join(STATES_PARQUET), disk, plan, TableOfRows::States, LONG_ROWS)?,
        })
    }

    /// Adds runs with their planner calls and states.
    pub fn add(&mut self, rows: &[RecordedRow]) -> Result<(), BatchError> {
        let Self { runs, calls, states } = self;
        let add_runs = || rows.iter().try_for_each(|recorded| runs.add(recorded.values()));
        let add_calls = || {
            rows.iter().try_for_each(|recorded| {
                let made = &recorded.row.detail.calls;
                calls.add_alike(recorded.label_values(), made.len(), |row, column| {
                    (CALL_COLUMNS[column].value)(&made[row])
                })
            })
        };
        let add_states = || {
            rows.iter().try_for_each(|recorded| {
                let counted = &recorded.row.detail.states;
                states.add_alike(recorded.label_values(), counted.len(), |row, column| {
                    (STATE_COLUMNS[column].value)(&counted[row])
                })
            })
        };
        // Each file has its own buffers, so that three threads fill them without a lock.
        let (runs, (calls, states)) = rayon::join(add_runs, || rayon::join(add_calls, add_states));
        runs.and(calls).and(states)
    }

    pub fn finish(self) -> Result<(), BatchError> {
        self.calls.finish()?;
        self.states.finish()?;
        self.runs.finish()
    }
}

/// Begins the file of a table of a batch; at most `rows_a_group` rows are held in memory.
pub fn new_file(
    path: PathBuf,
    disk: &dyn Disk,
    plan: &BatchPlan,
    table: TableOfRows,
    rows_a_group: usize,
) -> Result<ParquetWriter, BatchError> {
    let mut columns = table.columns(&swept_columns(plan));
    let seed = columns.iter_mut().find(|column| column.name == "seed").expect("every run has a seed");
    seed.kind = Kind::holding_up_to(plan.seeds.iter().max().expect("a plan has seeds"));
    // A build without a repository has no commit, and an empty text would look like one.
    let commit = COMMIT.map(|commit| ("commit", commit.to_owned()));
    let about = [
        ("program_version", PROGRAM_VERSION.to_owned()),
        ("compiler", COMPILER.to_owned()),
        ("content_sha256", plan.content_sha256()),
        ("row_schema", schema_of(table, &columns).to_string()),
    ];
    let metadata: Vec<_> = about.into_iter().chain(commit).collect();
    ParquetWriter::create(path, disk, columns, &metadata, rows_a_group)
}

/// Returns the columns of swept keys.
pub fn swept_columns(plan: &BatchPlan) -> Vec<FileColumn> {
    let swept = plan.swept_keys.iter().enumerate();
    swept.map(|(index, key)| FileColumn::swept(key, swept_kind(plan, index))).collect()
}

/// The kind that holds all values of a swept key.
fn swept_kind(plan: &BatchPlan, index: usize) -> Kind {
    let values = || plan.variants.iter().map(|variant| &variant.swept[index]);
    let counts: Option<Vec<u64>> =
        values().map(|value| if let Value::Count(count) = value { Some(*count) } else { None }).collect();
    match counts {
        Some(counts) => Kind::holding_up_to(counts.into_iter().max().unwrap_or(0)),
        None if values().all(|value| matches!(value, Value::Count(_) | Value::Real(_))) => Kind::Real,
        None => Kind::Text,
    }
}
