//! One run as one JSON object, with the names and values of the columns.

use serde::Serialize;

use crate::execute::RunRow;
use crate::plan::{PROGRAM_VERSION, Value};
use crate::report::notes::notes;
use crate::table::{AGENT_COLUMNS, AgentRow, RUN_COLUMNS, RunRecord, is_measured};
use wildfire_base::object::Members;

type Object = Members<&'static str, Value>;

/// A run as `{"program_version", "run": {outcome columns}, "agents": [{...}], "notes": [sentences], "measured": {cpu
/// and wall columns}}`.
#[derive(Serialize)]
pub struct RunObject {
    program_version: &'static str,
    run: Object,
    agents: Vec<Object>,
    notes: Vec<String>,
    measured: Object,
}

impl RunObject {
    pub fn new(row: &RunRow) -> Self {
        let columns = || RUN_COLUMNS.iter().map(|column| (column.name, (column.value)(row)));
        let agents = AgentRow::from_run(row).map(|agent| {
            let values = AGENT_COLUMNS.iter().map(|column| (column.name, (column.value)(&agent)));
            Members(values.filter(|(name, _)| !["scenario", "seed", "run"].contains(name)).collect())
        });
        let machine = RunRecord::from_row(row).queries().machine_sentence(&row.label.planner);
        Self {
            program_version: PROGRAM_VERSION,
            run: Members(columns().filter(|(name, _)| !is_measured(name)).collect()),
            agents: agents.collect(),
            notes: row.result.as_ref().map(notes).into_iter().flatten().chain(machine).collect(),
            measured: Members(columns().filter(|(name, _)| is_measured(name)).collect()),
        }
    }
}
