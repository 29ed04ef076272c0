//! `wildfire schema`: what files may say and what columns mean, as JSON Schema.

use std::process::ExitCode;

use crate::batch::{TableOfRows, plan_schema, row_schema};
use crate::cli::args::{SchemaArguments, SchemaOf};
use crate::cli::error::CliError;
use crate::cli::terminal;
use crate::scenario;

pub fn run(arguments: &SchemaArguments) -> Result<ExitCode, CliError> {
    let of_file = |schema| serde_json::to_string_pretty(&schema).expect("a schema is JSON");
    let schema = match arguments.of {
        SchemaOf::Scenario => of_file(scenario::schema()),
        SchemaOf::Plan => of_file(plan_schema()),
        SchemaOf::Runs => row_schema(TableOfRows::Runs),
        SchemaOf::PlannerCalls => row_schema(TableOfRows::PlannerCalls),
        SchemaOf::States => row_schema(TableOfRows::States),
    };
    terminal::print(&format!("{schema}\n"))?;
    Ok(ExitCode::SUCCESS)
}
