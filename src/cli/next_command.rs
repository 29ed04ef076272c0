//! The command that brings a batch nearer to its tables: the next slice, merging, or resuming the whole.

use std::path::Path;

use wildfire_batch::execute::{BatchStatus, OutputFolder, SliceState, batch_status};
use wildfire_batch::plan::{Slice, shell_word};

/// The command that goes on with a slice of the batch in a folder.
pub fn resume_command(folder: &Path, slice: Slice) -> String {
    let folder = shell_word(&folder.display().to_string());
    let shard = if slice.is_whole() { String::new() } else { format!(" --shard {slice}") };
    format!("wildfire batch --resume {folder}{shard}")
}

/// A command and what it is for.
pub struct NextCommand {
    pub purpose: &'static str,
    pub command: String,
}

/// Returns the command that brings a batch nearer to its tables; `None` while processes work on all that is left.
pub fn next_command(folder: &Path, slices: &[(Slice, SliceState)], lock: &str) -> Option<NextCommand> {
    let waiting = slices.iter().find(|(_, state)| state.stored < state.runs && !state.is_running);
    let (purpose, command) = match waiting {
        Some((slice, _)) => ("Continue", resume_command(folder, *slice)),
        None if slices.iter().any(|(_, state)| state.is_running) => return None,
        None if slices.len() == 1 => ("Write the tables", resume_command(folder, slices[0].0)),
        None => ("Write the tables", format!("wildfire merge {}", shell_word(&folder.display().to_string()))),
    };
    Some(NextCommand { purpose, command: command + lock })
}

/// Returns what to do with a batch that has no tables yet: the next slice, merging them, or resuming the whole.
pub fn help_on_unfinished(path: &Path) -> Option<String> {
    let status = OutputFolder::existing(path).and_then(|folder| batch_status(&folder));
    let Ok(BatchStatus { slices, .. }) = status else { return None };
    match next_command(path, &slices, "") {
        Some(NextCommand { purpose, command }) => Some(format!("{} with: {command}", purpose.to_lowercase())),
        None => Some("its runs are still in progress: wildfire status shows how many are done".into()),
    }
}
