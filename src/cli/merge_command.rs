//! `wildfire merge`: the tables of a batch whose slices were run one by one.

use std::process::ExitCode;

use crate::batch::{BatchError, OutputFolder, RealDisk, merge};
use crate::cli::args::FolderArguments;
use crate::cli::batch_command::{exit_code, note_leftovers, resume_command, summary};
use crate::cli::error::CliError;
use crate::cli::{interrupt, terminal};

pub fn run(arguments: &FolderArguments, quiet: bool) -> Result<ExitCode, CliError> {
    interrupt::set_resumable();
    let folder = OutputFolder::existing(&arguments.folder)?;
    let watch = interrupt::watch();
    let merged = merge(&folder, &RealDisk, watch.stop()).map_err(|error| failure(error, &folder))?;
    drop(watch);
    if !quiet {
        note_leftovers(&merged.leftovers);
    }
    terminal::print(&summary(&merged.plan, &folder, &merged.report))?;
    Ok(exit_code(merged.report.not_done()))
}

fn failure(error: BatchError, folder: &OutputFolder) -> CliError {
    let missing = match &error {
        BatchError::Incomplete { slice, .. } | BatchError::NotBegun { slice, .. } => Some(*slice),
        _ => None,
    };
    match missing {
        Some(slice) => {
            let command = resume_command(folder.path(), slice);
            CliError::bad_input(error, Some(&format!("run it with: {command}")))
        }
        None => CliError::from_batch_error(error, &format!("wildfire merge {}", folder.path().display())),
    }
}
