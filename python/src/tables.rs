//! The tables of runs, with the columns of `runs.csv`, `agents.csv`, `planner_calls.parquet` and `states.parquet`.

use pyo3::prelude::*;
use wildfire::batch::execute::RunRow;
use wildfire::batch::plan::Value;
use wildfire::batch::table::{
    AGENT_COLUMNS, AgentRow, CALL_COLUMNS, COLUMNS_BEFORE_SWEPT, Column, FileColumn, Kind, RUN_COLUMNS, STATE_COLUMNS,
    TableOfRows,
};

use crate::columns::TableBuilder;

/// One of the tables of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    Runs,
    Agents,
    Calls,
    States,
}

impl Table {
    /// Lists the columns, including swept ones; `largest_seed` determines the type of the seed column.
    fn columns(self, swept: &[FileColumn], largest_seed: u64) -> Vec<FileColumn> {
        let mut columns = match self {
            Self::Runs => TableOfRows::Runs.columns(swept),
            Self::Agents => AGENT_COLUMNS.iter().map(Column::described).collect(),
            Self::Calls => TableOfRows::PlannerCalls.columns(swept),
            Self::States => TableOfRows::States.columns(swept),
        };
        if let Some(seed) = columns.iter_mut().find(|column| column.name == "seed") {
            seed.kind = Kind::holding_up_to(largest_seed);
        }
        columns
    }

    /// Adds the rows of a run.
    fn add(self, table: &mut TableBuilder, row: &RunRow) {
        let record: Vec<Value> = RUN_COLUMNS.iter().map(|column| (column.value)(row)).collect();
        let (label, rest) = record.split_at(COLUMNS_BEFORE_SWEPT);
        // In the files, too, the swept columns stand between the two.
        let label = || label.iter().chain(&row.label.swept).cloned();
        match self {
            Self::Runs => table.push(label().chain(rest.iter().cloned())),
            Self::Agents => {
                for agent in AgentRow::from_run(row) {
                    table.push(AGENT_COLUMNS.iter().map(|column| (column.value)(&agent)));
                }
            }
            Self::Calls => {
                for call in &row.detail.calls {
                    table.push(label().chain(CALL_COLUMNS.iter().map(|column| (column.value)(call))));
                }
            }
            Self::States => {
                for state in &row.detail.states {
                    table.push(label().chain(STATE_COLUMNS.iter().map(|column| (column.value)(state))));
                }
            }
        }
    }

    /// Begins the table.
    pub fn begin(self, swept: &[FileColumn], largest_seed: u64) -> StartedTable {
        StartedTable { table: self, builder: TableBuilder::new(self.columns(swept, largest_seed)) }
    }

    /// Builds the table of a single run outside a batch.
    pub fn of_run<'py>(self, py: Python<'py>, row: &RunRow) -> PyResult<Bound<'py, PyAny>> {
        let mut table = self.begin(&[], row.label.seed);
        table.add(row);
        table.finish(py)
    }
}

/// A table under construction, to which runs are added.
pub struct StartedTable {
    table: Table,
    builder: TableBuilder,
}

impl StartedTable {
    pub fn add(&mut self, row: &RunRow) {
        self.table.add(&mut self.builder, row);
    }

    pub fn finish(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        self.builder.finish(py)
    }
}
