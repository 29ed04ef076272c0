//! Errors that stop a batch, or prevent its start.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::execute::{JournalError, UnexpectedFile};
use crate::plan::{PLAN_FILE, PlanError, Slice};

#[derive(Debug, Error)]
pub enum BatchError {
    #[error("{} already holds {entry} of an earlier batch", path.display())]
    HoldsResults { path: PathBuf, entry: String },
    #[error("{} is a file, or lies below one; expected a folder for the results", path.display())]
    NotAFolder { path: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Unwritable { path: PathBuf, source: io::Error },
    #[error("cannot write the recording {}: {source}", path.display())]
    Unrecordable { path: PathBuf, source: io::Error },
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("cannot start {jobs} worker threads: {reason}")]
    NoWorkers { jobs: usize, reason: String },
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Journal(#[from] JournalError),
    #[error(transparent)]
    Strange(#[from] UnexpectedFile),
    #[error("{} has no {PLAN_FILE}, but {leftover}, left by a killed process: the batch had not begun", path.display())]
    NotStarted { path: PathBuf, leftover: String },
    #[error(
        "the recording {} cannot be repeated: {difference}; another machine or program wrote the row",
        path.display()
    )]
    OtherOutcome { path: PathBuf, difference: String },
    #[error("the batch was stopped before its end")]
    Stopped,
    #[error("{} holds slice {found} of its batch, which does not fit {requested}", path.display())]
    OtherSlices { path: PathBuf, found: Slice, requested: Slice },
    #[error("{} is not a list of machines: {reason}; nothing depends on it, so you may remove it", path.display())]
    NoMachines { path: PathBuf, reason: String },
    #[error("{} holds no journal of a batch", path.display())]
    NoJournal { path: PathBuf },
    #[error("slice {slice} of the batch in {} has not begun", path.display())]
    SliceNotStarted { path: PathBuf, slice: Slice },
    #[error("slice {slice} lacks {missing} of its {of} runs")]
    Incomplete { slice: Slice, missing: u64, of: u64 },
}

impl BatchError {
    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Self {
        Self::Unwritable { path: path.to_owned(), source }
    }
}
