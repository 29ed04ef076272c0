//! `wildfire status`: how far a batch is.

use std::path::Path;
use std::process::ExitCode;

use crate::batch::{OutputFolder, RUNS_FILE, Slice, SliceState, TextTable, batch_status};
use crate::cli::args::FolderArguments;
use crate::cli::batch_command::resume_command;
use crate::cli::error::CliError;
use crate::cli::terminal;

pub fn run(arguments: &FolderArguments) -> Result<ExitCode, CliError> {
    let folder = OutputFolder::existing(&arguments.folder)?;
    let status = batch_status(&folder)?;
    let plan = &status.plan;
    let (variants, seeds, runs) = (plan.variants.len(), &plan.seeds, plan.count());
    let mut text = format!("{}: {variants} variants, seeds {seeds}, {runs} runs\n\n", folder.path().display());
    text.push_str(&table(&status.slices).to_text());
    text.push_str(&next_step(&folder, &status.slices));
    terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn table(slices: &[(Slice, SliceState)]) -> TextTable {
    let headings = ["Slice", "Runs", "Over", "Not done", "State"].map(|heading| vec![heading.to_owned()]);
    let row = |(slice, state): &(Slice, SliceState)| {
        let name = if slice.is_whole() { "whole".to_owned() } else { slice.to_string() };
        let word = match state {
            SliceState { is_running: true, .. } => "running",
            SliceState { runs, held, .. } if runs == held => "complete",
            SliceState { held: 0, .. } => "not begun",
            _ => "stopped",
        };
        vec![name, state.runs.to_string(), state.held.to_string(), state.not_done.to_string(), word.to_owned()]
    };
    TextTable { headings: headings.to_vec(), rows: slices.iter().map(row).collect(), rules_before: Vec::new() }
}

fn next_step(folder: &OutputFolder, slices: &[(Slice, SliceState)]) -> String {
    let path: &Path = folder.path();
    let waiting = slices.iter().find(|(_, state)| state.held < state.runs && !state.is_running);
    match waiting {
        Some((slice, _)) => format!("\nContinue with: {}\n", resume_command(path, *slice)),
        None if slices.iter().any(|(_, state)| state.is_running) => String::new(),
        None if path.join(RUNS_FILE).exists() => "\nThe tables are written.\n".into(),
        None if slices.len() == 1 => format!("\nWrite the tables with: {}\n", resume_command(path, slices[0].0)),
        None => format!("\nWrite the tables with: wildfire merge {}\n", path.display()),
    }
}
