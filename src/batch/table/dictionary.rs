//! What every column means, as JSON Schema of a row.

use serde_json::{Map, Value as Json, json};

use crate::batch::table::{CALL_COLUMNS, FileColumn, Kind, STATE_COLUMNS, run_columns};

/// A table of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableOfRows {
    Runs,
    PlannerCalls,
    States,
}

/// The JSON Schema of a row of a table, a property for each column in its order; columns of what is swept come with the
/// batch.
pub fn row_schema(table: TableOfRows) -> String {
    let label = run_columns(&[]).into_iter().take(crate::batch::COLUMNS_BEFORE_SWEPT);
    let (title, columns): (&str, Vec<FileColumn>) = match table {
        TableOfRows::Runs => ("A run", run_columns(&[])),
        TableOfRows::PlannerCalls => ("A query to a planner", label.chain(CALL_COLUMNS).collect()),
        TableOfRows::States => ("The bushes at a time", label.chain(STATE_COLUMNS).collect()),
    };
    let property = |column: &FileColumn| {
        let description = words_of(table, &column.name).expect("a test sees to it that every column has its words");
        let kind = json_type(column.kind);
        let kind = if column.is_required { json!(kind) } else { json!([kind, "null"]) };
        (column.name.clone().into_owned(), json!({ "type": kind, "description": description }))
    };
    let properties: Map<String, Json> = columns.iter().map(property).collect();
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "type": "object",
        "properties": properties,
    });
    serde_json::to_string_pretty(&schema).expect("words are JSON")
}

fn json_type(kind: Kind) -> &'static str {
    match kind {
        Kind::Count | Kind::LargeCount => "integer",
        Kind::Real => "number",
        Kind::Text => "string",
        Kind::Flag => "boolean",
    }
}

fn words_of(table: TableOfRows, name: &str) -> Option<&'static str> {
    let own = match table {
        TableOfRows::Runs => RUN_WORDS,
        TableOfRows::PlannerCalls => CALL_WORDS,
        TableOfRows::States => STATE_WORDS,
    };
    own.iter().chain(LABEL_WORDS).find(|(column, _)| *column == name).map(|(_, words)| *words)
}

type Words = [(&'static str, &'static str)];

const LABEL_WORDS: &Words = &[
    ("scenario", "name of the scenario"),
    ("seed", "seed from which all that is random in the run follows"),
    ("run", "number of the run in the plan, from 1"),
    ("planner", "planner of the trucks; `;` between those of trucks that differ"),
];

const RUN_WORDS: &Words = &[
    ("status", "done, failed or panicked"),
    ("message", "why a run is not done"),
    ("obstacles", "bush cells of the field"),
    ("intact", "cells that never burned, at the end"),
    ("burning", "cells that burn at the end"),
    ("burned_out", "cells that burned out"),
    ("extinguished", "cells that were put out"),
    ("intact_ratio", "share of all bush cells"),
    ("burned_ratio", "share of all bush cells that burn or have burned out"),
    ("extinguished_ratio", "share of all bush cells"),
    ("lit_by_wumpus", "ignitions by Wumpuses; a cell that is lit again counts again"),
    ("caught_by_spread", "ignitions by spread"),
    ("truck_stuck_s", "time in which trucks did nothing though there was a fire that they could reach"),
    ("wumpus_stuck_s", "time in which Wumpuses did nothing though there was something that they could light"),
    ("lit_by_schedule", "ignitions of the scenario"),
    ("ended_s", "simulated time at the end"),
    ("burning_cell_s", "number of burning cells integrated over time"),
    ("peak_burning", "most cells that burned at once"),
    ("mean_response_s", "from ignition to extinction, mean over the extinctions"),
    ("first_fire_s", "time of the first ignition"),
    ("all_out_s", "end of the last fire, if nothing burned at the end"),
    ("wumpus_score", "points of the Wumpuses by the scenario's rules"),
    ("truck_score", "points of the trucks by the scenario's rules"),
    ("winner", "wumpus, unimog or tie"),
    ("truck_plans", "queries of trucks for a plan, failed ones included"),
    ("truck_failed_start_blocked", "failed queries: the truck's own pose is not free"),
    ("truck_failed_goal_blocked", "failed queries: no free place from which the goal could be reached"),
    ("truck_failed_disconnected", "failed queries: start and goal are not connected"),
    ("truck_failed_budget_spent", "failed queries: the budget of expansions ran out"),
    ("truck_lattice_plans", "plans that the reachability flood found after the planner had failed"),
    ("truck_roadmap_samples", "milestones of the roadmaps"),
    ("truck_roadmap_edges", "edges of the roadmaps"),
    ("truck_roadmap_components", "connected components of the roadmaps"),
    ("truck_roadmap_expansions", "nodes expanded in the roadmaps"),
    ("truck_local_expansions", "nodes expanded in local searches"),
    ("truck_distance_m", "way driven"),
    ("truck_driving_s", "time spent driving"),
    ("truck_planning_s", "planning time that the scenario charges"),
    ("truck_suppressing_s", "time spent on putting fires out"),
    ("truck_standing_s", "time spent on nothing of these"),
    ("truck_waiting_s", "time spent on waiting for other trucks"),
    ("truck_deadlocks", "deadlocks of trucks that were broken"),
    ("truck_longest_idle_s", "longest stand of a truck while something burned"),
    ("truck_cusps", "changes between forward and reverse"),
    ("truck_wasted_drives", "drives that ended without an extinction"),
    ("wumpus_plans", "queries of Wumpuses for a plan, failed ones included"),
    ("wumpus_failed_plans", "failed queries of Wumpuses"),
    ("wumpus_local_minima", "local minima that descents on a potential field met"),
    ("wumpus_expansions", "nodes expanded by Wumpuses"),
    ("wumpus_distance_m", "way walked"),
    ("wumpus_walking_s", "time spent walking"),
    ("wumpus_planning_s", "planning time that the scenario charges"),
    ("wumpus_standing_s", "time spent standing"),
    ("wumpus_longest_idle_s", "longest stand of a Wumpus while something could be lit"),
    ("cpu_sampling_s", "CPU time: drawing the roadmaps' samples"),
    ("cpu_map_generation_s", "CPU time: connecting them"),
    ("cpu_roadmap_search_s", "CPU time: queries to the roadmaps"),
    ("cpu_local_search_s", "CPU time: local searches of trucks"),
    ("cpu_prm_total_s", "CPU time: clearance field, sampling, map generation and roadmap search"),
    ("cpu_unimog_total_s", "CPU time: all planning of the trucks"),
    ("cpu_wumpus_s", "CPU time: all planning of the Wumpuses"),
    ("cpu_clearance_field_s", "CPU time: distance field for collision checks"),
    ("cpu_reachability_s", "CPU time: reachability floods and the searches in them"),
    ("cpu_terrain_s", "CPU time: drawing the field"),
    ("cpu_run_s", "CPU time: the whole run"),
    ("wall_run_s", "real time: the whole run"),
];

const CALL_WORDS: &Words = &[
    ("agent", "who asks: unimog/0, wumpus/0 ..."),
    ("t_s", "simulated time of the query"),
    ("goal_col", "column of the cell that the agent goes for, from the west"),
    ("goal_row", "row of the cell that the agent goes for, from the south"),
    ("solved", "whether there is a plan"),
    ("status", "solved, or why there is no plan"),
    ("solution_length_m", "length of the way"),
    ("solution_segments", "straights and arcs of the way"),
    ("cusps", "changes between forward and reverse"),
    ("drive_s", "simulated time that the way takes, waits included"),
    ("roadmap_expansions", "nodes expanded in the roadmap"),
    ("local_expansions", "nodes expanded in the local search"),
    ("by_lattice", "whether the reachability flood found it after the planner had failed"),
];

const STATE_WORDS: &Words = &[
    ("t_s", "simulated time: sixtieths of the scenario's duration"),
    ("intact", "cells that never burned"),
    ("burning", "cells that burn"),
    ("burned_out", "cells that have burned out"),
    ("extinguished", "cells that were put out and do not burn"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_its_words_and_all_words_have_a_column() {
        for (table, own) in [
            (TableOfRows::Runs, RUN_WORDS),
            (TableOfRows::PlannerCalls, CALL_WORDS),
            (TableOfRows::States, STATE_WORDS),
        ] {
            let schema: Json = serde_json::from_str(&row_schema(table)).expect("a schema is JSON");
            let names: Vec<&String> = schema["properties"].as_object().expect("columns").keys().collect();
            for (name, _) in own.iter().chain(LABEL_WORDS) {
                assert!(names.iter().any(|column| column == name), "{table:?} has no column `{name}`");
            }
        }
    }

    #[test]
    fn kinds_of_columns_are_those_of_their_values() {
        let schema: Json = serde_json::from_str(&row_schema(TableOfRows::Runs)).expect("a schema is JSON");
        let kind = |name: &str| schema["properties"][name]["type"].clone();
        assert_eq!(kind("seed"), "integer");
        assert_eq!(kind("status"), "string");
        assert_eq!(kind("wall_run_s"), "number");
        // Values that a run may not have.
        assert_eq!(kind("intact"), json!(["integer", "null"]));
        assert_eq!(kind("mean_response_s"), json!(["number", "null"]));
        assert_eq!(kind("message"), json!(["string", "null"]));
        assert_eq!(kind("planner"), json!(["string", "null"]));
    }
}
