//! One run as one JSON object, with the names and values of the columns.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::execute::RunRow;
use crate::plan::{PROGRAM_VERSION, Value};
use crate::report::notes::notes;
use crate::table::{AGENT_COLUMNS, AgentRow, RUN_COLUMNS, RunRecord, is_measured};

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
        let agent = |agent: AgentRow<'_>| {
            let values = AGENT_COLUMNS.iter().map(|column| (column.name, (column.value)(&agent)));
            Object(values.filter(|(name, _)| !["scenario", "seed", "run"].contains(name)).collect())
        };
        let machine = RunRecord::from_row(row).queries().machine_sentence(&row.label.planner);
        Self {
            program_version: PROGRAM_VERSION,
            run: Object(columns().filter(|(name, _)| !is_measured(name)).collect()),
            agents: AgentRow::from_run(row).map(agent).collect(),
            notes: row.result.as_ref().map(notes).into_iter().flatten().chain(machine).collect(),
            measured: Object(columns().filter(|(name, _)| is_measured(name)).collect()),
        }
    }
}

/// An object whose members keep their order.
struct Object(Vec<(&'static str, Value)>);

impl Serialize for Object {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
