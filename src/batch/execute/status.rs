//! How far a batch is, whoever works on it.

use std::fs::File;
use std::io::ErrorKind;

use crate::batch::execute::journal::is_locked;
use crate::batch::execute::{BatchError, JournalError, JournalIndex, OutputFolder};
use crate::batch::plan::{BatchPlan, Slice};

/// A plan and its slices.
#[derive(Debug)]
pub struct BatchStatus {
    pub plan: BatchPlan,
    pub slices: Vec<(Slice, SliceState)>,
}

/// The progress of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SliceState {
    pub runs: u64,
    /// Runs in the journal.
    pub held: u64,
    /// Runs in the journal without a result.
    pub not_done: u64,
    /// True if a process is at work on it.
    pub is_running: bool,
}

/// Reads plan and journals of a folder; of slices that have not begun, that they have not.
///
/// # Errors
/// If there is no plan, or a journal cannot be read or is damaged.
pub fn batch_status(folder: &OutputFolder) -> Result<BatchStatus, BatchError> {
    let plan = BatchPlan::read(folder.path())?;
    let first = folder.journals()?.first().copied().unwrap_or(Slice::WHOLE);
    let states = first.all().map(|slice| Ok((slice, state_of(folder, slice, &plan)?)));
    let slices = states.collect::<Result<Vec<_>, JournalError>>()?;
    Ok(BatchStatus { plan, slices })
}

fn state_of(folder: &OutputFolder, slice: Slice, plan: &BatchPlan) -> Result<SliceState, JournalError> {
    let path = folder.journal(slice);
    let unreadable = |source| JournalError::Unreadable { path: path.clone(), source };
    let file = match File::open(&path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let runs = slice.count(plan.count());
            return Ok(SliceState { runs, held: 0, not_done: 0, is_running: false });
        }
        Err(error) => return Err(unreadable(error)),
    };
    let is_running = is_locked(&path).map_err(unreadable)?;
    let index = JournalIndex::read(&path, &file, plan, slice)?;
    let (held, not_done) = index.held();
    Ok(SliceState { runs: index.count(), held, not_done, is_running })
}
