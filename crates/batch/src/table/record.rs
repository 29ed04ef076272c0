//! The numbers of a run as in `runs.csv`, computed or read back.

use crate::execute::{RunRow, Status};
use crate::plan::Value;
use crate::table::QueryTally;
use crate::table::columns::{COLUMNS_BEFORE_SWEPT, RUN_COLUMNS, is_measured, run_column};

const SEED: usize = run_column("seed");
const RUN: usize = run_column("run");
const STATUS: usize = run_column("status");
const MESSAGE: usize = run_column("message");

/// A value for each of [`RUN_COLUMNS`].
#[derive(Clone, Debug, PartialEq)]
pub struct RunRecord(Vec<Value>);

/// A row of a batch and its record.
#[derive(Debug)]
pub struct RecordedRow {
    pub row: RunRow,
    pub record: RunRecord,
}

impl RecordedRow {
    pub fn new(row: RunRow) -> Self {
        Self { record: RunRecord::from_row(&row), row }
    }

    /// Returns the values that identify the run, with those of swept keys.
    pub fn label_values(&self) -> impl Iterator<Item = &Value> + Clone {
        self.record.values()[..COLUMNS_BEFORE_SWEPT].iter().chain(&self.row.label.swept)
    }

    /// Returns all values, those that identify the run first.
    pub fn values(&self) -> impl Iterator<Item = &Value> {
        self.label_values().chain(&self.record.values()[COLUMNS_BEFORE_SWEPT..])
    }
}

impl RunRecord {
    pub fn from_row(row: &RunRow) -> Self {
        Self(RUN_COLUMNS.iter().map(|column| (column.value)(row)).collect())
    }

    /// Takes a value for each column, in their order.
    pub(super) fn from_values(values: Vec<Value>) -> Self {
        debug_assert_eq!(values.len(), RUN_COLUMNS.len());
        Self(values)
    }

    pub fn values(&self) -> &[Value] {
        &self.0
    }

    /// Returns the number in a column, see [`run_column`]; `None` if it is missing or not finite.
    pub fn number(&self, column: usize) -> Option<f64> {
        let number = match &self.0[column] {
            Value::Count(count) => *count as f64,
            Value::Real(number) => *number,
            Value::Missing | Value::Text(_) | Value::Flag(_) => return None,
        };
        number.is_finite().then_some(number)
    }

    /// Returns the word in a column; empty where there is none.
    pub fn text(&self, column: usize) -> &str {
        if let Value::Text(text) = &self.0[column] { text } else { "" }
    }

    pub fn seed(&self) -> u64 {
        if let Value::Count(seed) = self.0[SEED] { seed } else { 0 }
    }

    /// Returns the number of the run in its plan.
    pub fn number_in_plan(&self) -> u64 {
        if let Value::Count(number) = self.0[RUN] { number } else { 0 }
    }

    /// Returns the status of the run; an unknown word counts as failed.
    pub fn status(&self) -> Status {
        let word = self.text(STATUS);
        let parsed = [Status::Done, Status::Panicked].into_iter().find(|status| status.to_string() == word);
        parsed.unwrap_or(Status::Failed)
    }

    pub fn is_done(&self) -> bool {
        self.status() == Status::Done
    }

    /// Counts the queries of its trucks.
    pub fn queries(&self) -> QueryTally {
        let number = |name: &str| {
            let column = RUN_COLUMNS.iter().position(|column| column.name == name);
            match column.map(|column| &self.0[column]) {
                Some(Value::Count(count)) => *count,
                _ => 0,
            }
        };
        QueryTally::of_run(number, self.message())
    }

    pub fn message(&self) -> &str {
        self.text(MESSAGE)
    }

    /// Describes the first outcome column in which a run differs from this record; `None` if there is none.
    pub fn difference(&self, again: &Self) -> Option<String> {
        // What policies were asked is in no recording.
        let columns = RUN_COLUMNS.iter().zip(self.0.iter().zip(&again.0));
        let outcomes = columns.filter(|(it, _)| !is_measured(it.name) && !it.name.starts_with("policy_"));
        let (column, (stored, found)) = outcomes.into_iter().find(|(_, (stored, found))| stored != found)?;
        let [stored, found] = [stored, found].map(|value| match value.to_string() {
            word if word.is_empty() => "nothing".into(),
            word => word,
        });
        Some(format!("its row has {} {stored}, its run gives {found}", column.name))
    }
}
