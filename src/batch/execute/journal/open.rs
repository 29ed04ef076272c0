//! A journal that this process, and no other, writes.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::index::RowReader;
use super::line::{Head, encode};
use super::{JournalError, JournalIndex};
use crate::batch::execute::{Append, BatchError, Disk, OutputFolder, RunRow, Status};
use crate::batch::plan::{BatchPlan, Slice};
use crate::time::wall::WallStopwatch;
use crate::whole_file::sync_folder_of;

/// The longest time that a line waits to be brought to the disk.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// A journal with its lock, which lasts as long as this does.
pub struct OpenJournal {
    path: PathBuf,
    file: File,
    writer: Box<dyn Append>,
    index: JournalIndex,
    /// Since the first line that is not on the disk yet.
    unsynced: Option<WallStopwatch>,
}

/// The lock on a journal that is not read yet.
pub struct LockedJournal {
    path: PathBuf,
    file: File,
}

impl LockedJournal {
    /// Opens a slice's journal, creates it if need be, and locks it.
    pub fn take(folder: &OutputFolder, slice: Slice) -> Result<Self, BatchError> {
        let path = folder.journal(slice);
        let file = OpenOptions::new().read(true).append(true).create(true).open(&path);
        let file = file.and_then(|file| sync_folder_of(&path).map(|()| file));
        let file = file.map_err(|source| BatchError::unwritable(&path, source))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { path, file }),
            Err(TryLockError::WouldBlock) => Err(JournalError::Locked { path }.into()),
            Err(TryLockError::Error(source)) => Err(BatchError::unwritable(&path, source)),
        }
    }

    /// Removes all lines.
    pub fn clear(&self) -> Result<(), BatchError> {
        self.file.set_len(0).map_err(|source| BatchError::unwritable(&self.path, source))
    }

    /// Reads what is there, drops a torn line, and begins the journal if it has no line yet.
    pub fn open(self, plan: &BatchPlan, slice: Slice, disk: &dyn Disk) -> Result<OpenJournal, BatchError> {
        let Self { path, file } = self;
        let sha256 = plan.content_sha256();
        let index = JournalIndex::read(&path, &file, plan, slice)?;
        let unwritable = |source| BatchError::unwritable(&path, source);
        let (end, torn) = index.end();
        if torn {
            file.set_len(end).map_err(unwritable)?;
        }
        let writer = disk.journal(file.try_clone().map_err(unwritable)?);
        let mut journal = OpenJournal { path, file, writer, index, unsynced: None };
        if end == 0 {
            let head = encode(&Head::new(&sha256, slice));
            journal.write(&head)?;
            journal.index.append_head(head.len());
            journal.sync()?;
        }
        Ok(journal)
    }
}

impl OpenJournal {
    /// Writes the line of a run, and brings it to the disk with all before it if the oldest of them has waited long.
    pub fn add(&mut self, run: u64, status: Status, line: &[u8]) -> Result<(), BatchError> {
        self.expect_unchanged()?;
        self.write(line)?;
        self.index.append(run, status, line.len());
        match self.unsynced.get_or_insert_with(WallStopwatch::start).elapsed() {
            waited if waited >= SYNC_EVERY => self.sync(),
            _ => Ok(()),
        }
    }

    /// To be called at least every now and then while runs are going on.
    ///
    /// # Errors
    /// If the disk cannot be written, or the journal is no longer as this process left it.
    pub fn sync_if_due(&mut self) -> Result<(), BatchError> {
        self.expect_unchanged()?;
        match self.unsynced {
            Some(since) if since.elapsed() >= SYNC_EVERY => self.sync(),
            _ => Ok(()),
        }
    }

    /// Brings all lines to the disk.
    pub fn sync(&mut self) -> Result<(), BatchError> {
        self.expect_unchanged()?;
        self.unsynced = None;
        self.writer.sync().map_err(|source| BatchError::unwritable(&self.path, source))
    }

    /// Refuses a journal that was removed, replaced or changed: lines written to it would be lost without a word.
    fn expect_unchanged(&self) -> Result<(), JournalError> {
        let unreadable = |source| JournalError::unreadable(&self.path, source);
        let changed = |change: String| Err(JournalError::Changed { path: self.path.clone(), change });
        let own = self.file.metadata().map_err(unreadable)?;
        match fs::metadata(&self.path) {
            Ok(found) if !is_same_file(&own, &found) => return changed("another file has its name".into()),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return changed("it, or its folder, was removed or renamed".into());
            }
            Err(error) => return Err(unreadable(error)),
        }
        let (expected, _) = self.index.end();
        match own.len() {
            found if found == expected => Ok(()),
            found => changed(format!("it has {found} bytes, expected the {expected} that were written")),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), BatchError> {
        self.writer.append(bytes).map_err(|source| BatchError::unwritable(&self.path, source))
    }

    pub fn index(&self) -> &JournalIndex {
        &self.index
    }

    /// Reads the row of a run that the journal holds.
    pub fn row(&self, run: u64) -> Result<RunRow, JournalError> {
        self.rows()?.row(run)
    }

    /// Reads the rows.
    pub fn rows(&self) -> Result<RowReader<'_>, JournalError> {
        RowReader::new(self.path.clone(), &self.file, &self.index)
    }
}

#[cfg(unix)]
fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Says yes: elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// A journal that is read, and that no other process may write meanwhile.
pub struct ReadJournal {
    path: PathBuf,
    file: File,
    pub index: JournalIndex,
}

impl ReadJournal {
    /// Opens, locks and reads the journal of a slice.
    pub fn open(folder: &OutputFolder, slice: Slice, plan: &BatchPlan) -> Result<Self, JournalError> {
        let path = folder.journal(slice);
        let file = File::open(&path).map_err(|source| JournalError::unreadable(&path, source))?;
        match file.try_lock_shared() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(JournalError::Locked { path }),
            Err(TryLockError::Error(source)) => return Err(JournalError::unreadable(&path, source)),
        }
        let index = JournalIndex::read(&path, &file, plan, slice)?;
        Ok(Self { path, file, index })
    }

    pub fn rows(&self) -> Result<RowReader<'_>, JournalError> {
        RowReader::new(self.path.clone(), &self.file, &self.index)
    }
}

/// Says whether a process is at work on a journal.
pub fn is_locked(path: &Path) -> io::Result<bool> {
    match File::open(path)?.try_lock_shared() {
        Ok(()) => Ok(false),
        Err(TryLockError::WouldBlock) => Ok(true),
        Err(TryLockError::Error(error)) => Err(error),
    }
}
