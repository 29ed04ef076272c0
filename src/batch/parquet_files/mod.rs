//! The tables for other tools: `runs.parquet`, `planner_calls.parquet`, `states.parquet`.
//!
//! `runs.parquet` has the columns and rows of `runs.csv`. The other two are long: a row for each call of a planner, and
//! for each time at which the bushes are counted; both begin with the columns that say which run it is. Names follow
//! those of OMPL's benchmarks (Moll, Sucan, Kavraki, "Benchmarking Motion Planning Algorithms", IEEE Robotics and
//! Automation Magazine, 2015) where the meaning is the same: `solved`, `status`, `solution_length_m`,
//! `solution_segments`.

mod table;

use std::time::Duration;

use crate::batch::disk::Disk;
use crate::batch::{
    BatchError, BatchPlan, COLUMNS_BEFORE_SWEPT, OutputFolder, PlannerCall, RUN_COLUMNS, RunLabel, RunResult, RunRow,
    StateCount, Value,
};
use crate::planning::PlanFailure;
use crate::sim::RunCost;
use crate::timeline::{AgentId, Outcome};
pub use table::Kind;
use table::{Field, ParquetTable};

pub const RUNS_PARQUET: &str = "runs.parquet";
pub const CALLS_PARQUET: &str = "planner_calls.parquet";
pub const STATES_PARQUET: &str = "states.parquet";

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
pub const CALL_COLUMNS: [(&str, Kind); 13] = [
    ("agent", Kind::Text),
    ("t_s", Kind::Real),
    ("goal_col", Kind::Count),
    ("goal_row", Kind::Count),
    ("solved", Kind::Flag),
    ("status", Kind::Text),
    ("solution_length_m", Kind::Real),
    ("solution_segments", Kind::Count),
    ("cusps", Kind::Count),
    ("drive_s", Kind::Real),
    ("roadmap_expansions", Kind::Count),
    ("local_expansions", Kind::Count),
    ("by_lattice", Kind::Flag),
];

/// Columns of `states.parquet` behind those of the run.
pub const STATE_COLUMNS: [(&str, Kind); 5] = [
    ("t_s", Kind::Real),
    ("intact", Kind::Count),
    ("burning", Kind::Count),
    ("burned_out", Kind::Count),
    ("extinguished", Kind::Count),
];

impl ParquetFiles {
    pub fn create(folder: &OutputFolder, disk: &dyn Disk, plan: &BatchPlan) -> Result<Self, BatchError> {
        let create = |name, columns: &[(String, Kind)], rows| {
            ParquetTable::create(folder.path().join(name), disk, columns, rows)
        };
        let swept: Vec<_> =
            plan.swept_keys.iter().enumerate().map(|(index, key)| (key.clone(), swept_kind(plan, index))).collect();
        let run_columns = run_columns(&swept);
        let label_columns = &run_columns[..COLUMNS_BEFORE_SWEPT + plan.swept_keys.len()];
        let long = |own: &[(&str, Kind)]| {
            let own = own.iter().map(|&(name, kind)| (name.to_owned(), kind));
            label_columns.iter().cloned().chain(own).collect::<Vec<_>>()
        };
        Ok(Self {
            runs: create(RUNS_PARQUET, &run_columns, WIDE_ROWS)?,
            calls: create(CALLS_PARQUET, &long(&CALL_COLUMNS), LONG_ROWS)?,
            states: create(STATES_PARQUET, &long(&STATE_COLUMNS), LONG_ROWS)?,
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

/// Names and kinds of the columns of runs, with those of what is swept.
pub fn run_columns(swept: &[(String, Kind)]) -> Vec<(String, Kind)> {
    let empty = RunRow::done(
        RunLabel { run: 1, scenario: String::new(), seed: 0, planner: String::new(), swept: Vec::new() },
        RunResult::new(Outcome::default(), RunCost::default()),
        Duration::ZERO,
    );
    let kind = |value: Value| match value {
        Value::Count(_) => Kind::Count,
        Value::Text(_) => Kind::Text,
        // What does not exist in a run in which nothing happens is a time.
        Value::Real(_) | Value::Missing => Kind::Real,
    };
    let mut columns: Vec<_> =
        RUN_COLUMNS.iter().map(|column| (column.name.to_owned(), kind((column.value)(&empty)))).collect();
    columns.splice(COLUMNS_BEFORE_SWEPT..COLUMNS_BEFORE_SWEPT, swept.iter().cloned());
    columns
}

/// The kind that holds all values of a swept key.
fn swept_kind(plan: &BatchPlan, index: usize) -> Kind {
    let values = || plan.variants.iter().map(|variant| &variant.swept[index]);
    match () {
        () if values().all(|value| matches!(value, Value::Count(_))) => Kind::Count,
        () if values().all(|value| matches!(value, Value::Count(_) | Value::Real(_))) => Kind::Real,
        () => Kind::Text,
    }
}
