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

use crate::batch::execute::OutputFolder;
use crate::batch::plan::Slice;

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

const WHOLE_NAME: &str = "runs.journal";

/// The name of a slice's journal.
pub fn journal_name(slice: Slice) -> String {
    if slice.is_whole() {
        WHOLE_NAME.into()
    } else {
        format!("runs-{}.journal", slice.to_string().replace('/', "-of-"))
    }
}

/// The slice whose journal has this name; `None` of what is no journal.
pub fn slice_of_journal(name: &str) -> Option<Slice> {
    if name == WHOLE_NAME {
        return Some(Slice::WHOLE);
    }
    let slice = name.strip_prefix("runs-")?.strip_suffix(".journal")?.replace("-of-", "/").parse().ok()?;
    (journal_name(slice) == name).then_some(slice)
}

/// Returns the path of a slice's journal.
pub fn journal_path(folder: &OutputFolder, slice: Slice) -> PathBuf {
    folder.path().join(journal_name(slice))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn journals_are_known_by_their_names() {
        for slice in [Slice::WHOLE, Slice::new(2, 5).expect("a slice")] {
            assert_eq!(slice_of_journal(&journal_name(slice)), Some(slice));
        }
        for name in ["runs.csv", "runs-1-of-1.journal", "runs-6-of-5.journal", "runs-01-of-5.journal", "runs-.journal"]
        {
            assert_eq!(slice_of_journal(name), None, "{name}");
        }
    }
}
