//! The data dictionary: every column of a table, as the JSON Schema of a row.

use serde_json::{Map, Value as Json, json};

use crate::decisions::DECISION_COLUMNS;
use crate::table::column::{Column, FileColumn, Kind, Unit};
use crate::table::columns::{CALL_COLUMNS, COLUMNS_BEFORE_SWEPT, RUN_COLUMNS, STATE_COLUMNS};

/// A table of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableOfRows {
    Runs,
    PlannerCalls,
    States,
    Decisions,
}

impl TableOfRows {
    pub const ALL: [Self; 4] = [Self::Runs, Self::PlannerCalls, Self::States, Self::Decisions];

    /// Returns the columns of the table's file, including those of swept keys.
    pub fn columns(self, swept: &[FileColumn]) -> Vec<FileColumn> {
        let label = RUN_COLUMNS[..COLUMNS_BEFORE_SWEPT].iter().map(Column::described);
        let columns_of_table: Vec<FileColumn> = match self {
            Self::Runs => RUN_COLUMNS[COLUMNS_BEFORE_SWEPT..].iter().map(Column::described).collect(),
            Self::PlannerCalls => CALL_COLUMNS.iter().map(Column::described).collect(),
            Self::States => STATE_COLUMNS.iter().map(Column::described).collect(),
            Self::Decisions => DECISION_COLUMNS.iter().map(Column::described).collect(),
        };
        label.chain(swept.iter().cloned()).chain(columns_of_table).collect()
    }
}

/// Returns the JSON Schema of a row of a table; columns of swept keys are known with the batch.
pub fn row_schema(table: TableOfRows) -> String {
    let schema = schema_of(table, &table.columns(&[]));
    serde_json::to_string_pretty(&schema).expect("words are JSON")
}

/// Returns the JSON Schema of a row of these columns, with a property for each.
pub fn schema_of(table: TableOfRows, columns: &[FileColumn]) -> Json {
    let title = match table {
        TableOfRows::Runs => "A run",
        TableOfRows::PlannerCalls => "A query to a planner",
        TableOfRows::States => "The bushes at a time",
        TableOfRows::Decisions => "A choice that an agent had and did not take",
    };
    let properties: Map<String, Json> = columns.iter().map(|it| (it.name.clone().into_owned(), property(it))).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "type": "object",
        "properties": properties,
    })
}

fn property(column: &FileColumn) -> Json {
    let kind = match column.kind {
        Kind::Count | Kind::LargeCount => "integer",
        Kind::Real => "number",
        Kind::Text => "string",
        Kind::Flag => "boolean",
    };
    let kind = if column.is_required { json!(kind) } else { json!([kind, "null"]) };
    match column.unit {
        Unit::None => json!({ "type": kind, "description": column.description }),
        unit => json!({ "type": kind, "description": column.description, "unit": unit.symbol() }),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::execute::{RunResult, RunRow, Status};
    use crate::plan::{RunLabel, Value};
    use crate::table::record::RunRecord;
    use wildfire_sim::RunCost;
    use wildfire_timeline::{AgentId, Outcome};

    #[test]
    fn every_column_has_words_and_a_name_of_its_own() {
        for table in TableOfRows::ALL {
            let columns = table.columns(&[]);
            let properties = schema_of(table, &columns)["properties"].as_object().expect("columns").clone();
            assert_eq!(properties.len(), columns.len(), "{table:?} has a column twice");
            assert!(columns.iter().all(|column| !column.description.is_empty()), "{table:?}");
        }
    }

    #[test]
    fn units_are_those_that_names_end_with() {
        let all = TableOfRows::ALL.map(|table| table.columns(&[]));
        for column in all.iter().flatten() {
            let expected = match column.name.rsplit('_').next() {
                _ if column.name == "burning_cell_s" => Unit::CellSeconds,
                Some("s") if column.name.starts_with("cpu_") => Unit::CpuSeconds,
                Some("s") if column.name.starts_with("wall_") => Unit::WallSeconds,
                Some("s") => Unit::Seconds,
                Some("m") => Unit::Metres,
                Some("ratio") => Unit::Share,
                _ => continue,
            };
            assert_eq!(column.unit, expected, "{}", column.name);
        }
    }

    #[test]
    fn kinds_of_columns_are_those_of_their_values() {
        let label = |planner: &str| {
            let scenario = String::new();
            let planner = planner.to_owned();
            let policies = vec![(AgentId::unimog(0), "oldest".to_owned())];
            RunLabel { run: 1, scenario, seed: 0, planner, policies, swept: Vec::new() }
        };
        // Between them they have a value in every column, except for times of what need not happen.
        let done = RunRow::done(label(""), RunResult::new(Outcome::default(), RunCost::default()), Duration::ZERO);
        let failed = RunRow::not_done(label("a planner"), Status::Failed, "a reason".into(), Duration::ZERO);
        for row in [done, failed] {
            for (column, value) in RUN_COLUMNS.iter().zip(RunRecord::from_row(&row).values()) {
                let kind = match value {
                    Value::Missing => {
                        assert!(!column.is_required, "{} is required", column.name);
                        continue;
                    }
                    Value::Count(_) => Kind::Count,
                    Value::Real(_) => Kind::Real,
                    Value::Text(_) => Kind::Text,
                    Value::Flag(_) => Kind::Flag,
                };
                assert_eq!(kind, column.kind, "{}", column.name);
            }
        }
    }

    #[test]
    fn columns_that_may_lack_a_value_say_so() {
        let schema: Json = serde_json::from_str(&row_schema(TableOfRows::Runs)).expect("a schema is JSON");
        let kind = |name: &str| schema["properties"][name]["type"].clone();
        assert_eq!(kind("seed"), "integer");
        assert_eq!(kind("status"), "string");
        assert_eq!(kind("wall_run_s"), "number");
        assert_eq!(kind("intact"), json!(["integer", "null"]));
        assert_eq!(kind("mean_response_s"), json!(["number", "null"]));
        assert_eq!(kind("message"), json!(["string", "null"]));
        assert_eq!(kind("planner"), json!(["string", "null"]));
    }
}
