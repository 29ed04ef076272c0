//! The journal of a slice: a line for each run that is finished, in the order in which they were.
//!
//! A line is the CRC-32 of what follows it as eight hexadecimal digits, a space, and JSON. The first line says whose
//! journal it is; every other is a row of the batch with all its numbers, from which the tables are written in the end.
//! A line counts when it is whole, its newline included: what follows the last newline was being written when
//! the machine or the program stopped, and is dropped. Anything else that is not as it was written is an error.

mod index;
mod line;
mod open;

pub use index::{JournalIndex, RowReader};
pub use line::encode_row;
pub use open::{LockedJournal, OpenJournal, ReadJournal, is_locked};

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A reason for which a journal cannot be read or continued.
#[derive(Debug, Error)]
pub enum JournalError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{} is damaged in line {line}: {reason}", path.display())]
    Damaged { path: PathBuf, line: u64, reason: String },
    #[error("{} belongs to another plan: it names the plan {found}, expected {expected}", path.display())]
    OtherPlan { path: PathBuf, found: String, expected: String },
    #[error("{} was changed by another program: {change}", path.display())]
    Changed { path: PathBuf, change: String },
    #[error("another process is working on {}", path.display())]
    Locked { path: PathBuf },
}

impl JournalError {
    fn unreadable(path: &Path, source: io::Error) -> Self {
        Self::Unreadable { path: path.to_owned(), source }
    }
}
