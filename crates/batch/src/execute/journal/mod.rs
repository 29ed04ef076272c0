//! The journal of a slice: a line for each finished run, in the order in which runs finished.
//!
//! A line is the CRC-32 of what follows it as eight hexadecimal digits, a space, and JSON. The first line says whose
//! journal it is; every other is a row of the batch with all its numbers, from which the tables are written in the end.
//! A line counts when it is whole, its newline included: what follows the last newline was being written when
//! the machine or the program stopped, and is dropped. A run that is there twice, with rows that are equal in all that is
//! not measured, is taken once: two processes worked on the slice without knowing of each other. Anything else that is not
//! as it was written is an error. Programs that play could rewrite a line with its checksum: the process that writes a
//! journal keeps digests of all lines in memory, and believes no line that has another.

mod index;
mod line;
mod lock;
mod open;
mod row_stream;

pub use index::{FailedRuns, JournalIndex, RowReader, add_failed};
pub use line::{count_lines, encode_row};
pub use lock::open_to_read;
pub use open::{LockedJournal, OpenJournal, plan_of_journal, seeds_of_journal, written_journal};
pub use row_stream::{RowStream, StreamBudget};

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// The reason why a journal cannot be read or continued.
#[derive(Debug, Error)]
pub enum JournalError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{} is damaged in line {line}: {reason}", path.display())]
    Damaged { path: PathBuf, line: u64, reason: String },
    #[error("{} belongs to another plan: found the plan {found}, expected {expected}", path.display())]
    OtherPlan { path: PathBuf, found: String, expected: String },
    #[error("{} was changed by another program: {change}", path.display())]
    Changed { path: PathBuf, change: String },
    #[error(
        "{} was rewritten by another program: the row of run {run} differs from the one written; all its rows were \
         dropped",
        path.display()
    )]
    Rewritten { path: PathBuf, run: u64 },
    #[error("another process is working on {}", path.display())]
    Locked { path: PathBuf },
    #[error("cannot lock {}: {source}", path.display())]
    NoLock { path: PathBuf, source: io::Error },
}

impl JournalError {
    fn unreadable(path: &Path, source: io::Error) -> Self {
        Self::Unreadable { path: path.to_owned(), source }
    }
}
