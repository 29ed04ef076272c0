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
//! the plan and the program that it is of, under the keys that they have in `plan.json`.

mod table;

use std::time::Duration;

use crate::batch::execute::{
    BatchError, CALLS_PARQUET, Disk, OutputFolder, PlannerCall, RUNS_PARQUET, RunResult, RunRow, STATES_PARQUET,
    StateCount, Status,
};
use crate::batch::plan::{BatchPlan, PROGRAM_VERSION, RunLabel, Value};
use crate::batch::table::{COLUMNS_BEFORE_SWEPT, RUN_COLUMNS, RunColumn};
use crate::planning::PlanFailure;
use crate::sim::RunCost;
use crate::timeline::{AgentId, Outcome};
use table::{Field, ParquetTable};
pub use table::{FileColumn, Kind};

/// Rows that are held in memory, of some seventy columns and of some fifteen.
const WIDE_ROWS: usize = 2048;
const LONG_ROWS: usize = 16_384;

/// All three files; they appear when finished.
pub struct ParquetFiles {
    runs: ParquetTable,
    calls: ParquetTable,
    states: ParquetTable,
    words: Words,
}

/// Columns of `planner_calls.parquet` behind those of the run.
pub const CALL_COLUMNS: [FileColumn; 13] = [
    FileColumn::required("agent", Kind::Text),
    FileColumn::required("t_s", Kind::Real),
    FileColumn::required("goal_col", Kind::Count),
    FileColumn::required("goal_row", Kind::Count),
    FileColumn::required("solved", Kind::Flag),
    FileColumn::required("status", Kind::Text),
    FileColumn::optional("solution_length_m", Kind::Real),
    FileColumn::optional("solution_segments", Kind::Count),
    FileColumn::optional("cusps", Kind::Count),
    FileColumn::optional("drive_s", Kind::Real),
    FileColumn::required("roadmap_expansions", Kind::Count),
    FileColumn::required("local_expansions", Kind::Count),
    FileColumn::optional("by_lattice", Kind::Flag),
];

/// Columns of `states.parquet` behind those of the run.
pub const STATE_COLUMNS: [FileColumn; 5] = [
    FileColumn::required("t_s", Kind::Real),
    FileColumn::required("intact", Kind::Count),
    FileColumn::required("burning", Kind::Count),
    FileColumn::required("burned_out", Kind::Count),
    FileColumn::required("extinguished", Kind::Count),
];

impl ParquetFiles {
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, plan: &BatchPlan) -> Result<Self, BatchError> {
        let metadata = [("program_version", PROGRAM_VERSION.to_owned()), ("content_sha256", plan.content_sha256())];
        let create = |name, columns: Vec<FileColumn>, rows| {
            ParquetTable::create(folder.path().join(name), disk, columns, &metadata, rows)
        };
        let swept = plan.swept_keys.iter().enumerate().map(|(index, key)| FileColumn {
            name: key.clone().into(),
            kind: swept_kind(plan, index),
            is_required: true,
        });
        let mut run_columns = run_columns(&swept.collect::<Vec<_>>());
        let seed = run_columns.iter_mut().find(|column| column.name == "seed").expect("every run has a seed");
        seed.kind = Kind::holding_up_to(plan.seeds.iter().max().expect("a plan has seeds"));
        let label_columns = &run_columns[..COLUMNS_BEFORE_SWEPT + plan.swept_keys.len()];
        let long = |own: &[FileColumn]| label_columns.iter().chain(own).cloned().collect::<Vec<_>>();
        let (call_columns, state_columns) = (long(&CALL_COLUMNS), long(&STATE_COLUMNS));
        Ok(Self {
            runs: create(RUNS_PARQUET, run_columns, WIDE_ROWS)?,
            calls: create(CALLS_PARQUET, call_columns, LONG_ROWS)?,
            states: create(STATES_PARQUET, state_columns, LONG_ROWS)?,
            words: Words::default(),
        })
    }

    pub fn add(&mut self, row: &RunRow) -> Result<(), BatchError> {
        let label = label_fields(row);
        let rest = RUN_COLUMNS[COLUMNS_BEFORE_SWEPT..].iter().map(|column| Field::from(&(column.value)(row)));
        self.runs.add(label.iter().cloned().chain(rest))?;
        for call in &row.detail.calls {
            self.calls.add(label.iter().cloned().chain(call_fields(call, &mut self.words)))?;
        }
        for state in &row.detail.states {
            self.states.add(label.iter().cloned().chain(state_fields(state)))?;
        }
        Ok(())
    }

    pub fn finish(self) -> Result<(), BatchError> {
        self.calls.finish()?;
        self.states.finish()?;
        self.runs.finish()
    }
}

fn label_fields(row: &RunRow) -> Vec<Field> {
    let first = RUN_COLUMNS[..COLUMNS_BEFORE_SWEPT].iter().map(|column| Field::from(&(column.value)(row)));
    first.chain(row.label.swept.iter().map(Field::from)).collect()
}

/// Texts that come in row after row, each made once.
#[derive(Default)]
struct Words {
    agents: Vec<(AgentId, Field)>,
    /// Of failed calls by their failure, and of those that are solved.
    statuses: Vec<(Option<PlanFailure>, Field)>,
}

impl Words {
    fn agent(&mut self, agent: AgentId) -> Field {
        word(&mut self.agents, agent, || agent.to_string())
    }

    fn status(&mut self, failure: Option<PlanFailure>) -> Field {
        word(&mut self.statuses, failure, || failure.map_or("solved".into(), |failure| failure.to_string()))
    }
}

fn word<K: PartialEq>(known: &mut Vec<(K, Field)>, key: K, spell: impl FnOnce() -> String) -> Field {
    if let Some((_, field)) = known.iter().find(|(other, _)| *other == key) {
        return field.clone();
    }
    let field = Field::text(&spell());
    known.push((key, field.clone()));
    field
}

fn call_fields(call: &PlannerCall, words: &mut Words) -> [Field; 13] {
    let solution = call.answer.as_ref().ok();
    let real = |number: Option<f64>| number.map_or(Field::Missing, Field::Real);
    let count = |number: Option<u32>| number.map_or(Field::Missing, |number| Field::Count(number.into()));
    [
        words.agent(call.agent),
        Field::Real(call.time.as_seconds()),
        Field::Count(call.goal.0.into()),
        Field::Count(call.goal.1.into()),
        Field::Flag(solution.is_some()),
        words.status(call.answer.err()),
        real(solution.map(|solution| solution.length_m)),
        count(solution.map(|solution| solution.segments)),
        count(solution.map(|solution| solution.cusps)),
        real(solution.map(|solution| solution.duration_s)),
        Field::Count(call.effort.roadmap_expansions.into()),
        Field::Count(call.effort.local_expansions.into()),
        solution.map_or(Field::Missing, |solution| Field::Flag(solution.by_lattice)),
    ]
}

fn state_fields(state: &StateCount) -> [Field; 5] {
    let counts = [state.intact, state.burning, state.burned_out, state.extinguished];
    let [intact, burning, burned_out, extinguished] = counts.map(|count| Field::Count(count.into()));
    [Field::Real(state.time.as_seconds()), intact, burning, burned_out, extinguished]
}

/// The columns of runs, with those of what is swept.
pub fn run_columns(swept: &[FileColumn]) -> Vec<FileColumn> {
    let label = |planner: &str| RunLabel {
        run: 1,
        scenario: String::new(),
        seed: 0,
        planner: planner.into(),
        swept: Vec::new(),
    };
    // Together they have a value of each kind, except for times of what need not happen; what both have, every run has.
    let result = RunResult::new(Outcome::default(), RunCost::default());
    let done = RunRow::done(label(""), result, Duration::ZERO);
    let failed = RunRow::not_done(label("a planner"), Status::Failed, "a reason".into(), Duration::ZERO);
    let column = |column: &RunColumn| {
        let values = [(column.value)(&done), (column.value)(&failed)];
        let is_required = values.iter().all(|value| *value != Value::Missing);
        let kind = match values.iter().find(|value| **value != Value::Missing) {
            Some(Value::Count(_)) => Kind::Count,
            Some(Value::Text(_)) => Kind::Text,
            Some(Value::Real(_) | Value::Missing) | None => Kind::Real,
        };
        FileColumn { name: column.name.into(), kind, is_required }
    };
    let mut columns: Vec<_> = RUN_COLUMNS.iter().map(column).collect();
    columns.splice(COLUMNS_BEFORE_SWEPT..COLUMNS_BEFORE_SWEPT, swept.iter().cloned());
    columns
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
