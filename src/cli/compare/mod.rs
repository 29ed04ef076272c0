//! `wildfire compare`: batches, or parts of one, in pairs by seed; or a batch beside published tables.

mod args;
mod beside;
mod document;
mod json;
mod tables;

use std::process::ExitCode;

pub use args::CompareArguments;

use document::Document;

use crate::batch::TableError;
use crate::batch::comparison::{BesideReport, ComparisonError, compare};
use crate::cli::error::CliError;
use crate::cli::terminal;

pub fn run(arguments: &CompareArguments) -> Result<ExitCode, CliError> {
    let text = match (arguments.with, &arguments.batches[..]) {
        (None, batches) => {
            let comparison = compare(batches, &arguments.selection(), &arguments.metric)?;
            if arguments.json { json::to_json(&comparison) } else { formed(&tables::document(&comparison), arguments) }
        }
        (Some(args::Published::Report), [batch]) => {
            let beside = BesideReport::of(batch, &arguments.selection())?;
            if arguments.json { beside::json(&beside) } else { formed(&beside::document(&beside), arguments) }
        }
        (Some(_), several) => {
            let sentence = format!("{} batches; expected a single one beside the report", several.len());
            return Err(CliError::bad_input(sentence, None));
        }
    };
    terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn formed(document: &Document, arguments: &CompareArguments) -> String {
    match arguments {
        CompareArguments { md: true, .. } => document.to_markdown(),
        CompareArguments { html: true, .. } => document.to_html(),
        _ => document.to_text(),
    }
}

impl From<ComparisonError> for CliError {
    fn from(error: ComparisonError) -> Self {
        match error {
            ComparisonError::Table(TableError::Unreadable { ref source, .. }) => {
                let kind = source.kind();
                Self::from_input_error(error, kind)
            }
            error => Self::bad_input(error, None),
        }
    }
}
