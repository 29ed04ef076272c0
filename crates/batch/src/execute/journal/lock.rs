//! Journals that no other process writes as long as they are open.
//!
//! On Unix the file is locked. Locks of Windows keep readers away, too, even other handles of this process; there a file is
//! opened so that others can only read it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

use super::JournalError;
use crate::execute::{BatchError, Lock};
use wildfire_base::whole_file::sync_folder_of;

/// Opens a journal to be read, and written at its end, and creates it if need be.
pub fn open_to_append(path: &Path, lock: Lock) -> Result<File, BatchError> {
    let unwritable = |source| BatchError::unwritable(path, source);
    let mut options = OpenOptions::new();
    // On Windows a file opened to append cannot be shortened, so each append seeks the end first.
    options.read(true).write(true).append(cfg!(not(windows))).create(true).truncate(false);
    let file = open(path, &mut options, lock, File::try_lock, unwritable)?;
    sync_folder_of(path).map_err(unwritable)?;
    Ok(file)
}

/// Opens a journal for reading, and refuses one that a process is writing.
pub fn open_to_read(path: &Path, lock: Lock) -> Result<File, JournalError> {
    let unreadable = |source| JournalError::unreadable(path, source);
    open(path, OpenOptions::new().read(true), lock, File::try_lock_shared, unreadable)
}

fn open<E: From<JournalError>>(
    path: &Path,
    options: &mut OpenOptions,
    lock: Lock,
    lock_file: fn(&File) -> Result<(), TryLockError>,
    failed: impl FnOnce(io::Error) -> E,
) -> Result<File, E> {
    let is_locked = lock == Lock::Flock;
    #[cfg(windows)]
    if is_locked {
        const FILE_SHARE_READ: u32 = 1;
        std::os::windows::fs::OpenOptionsExt::share_mode(options, FILE_SHARE_READ);
    }
    const ERROR_SHARING_VIOLATION: i32 = 32;
    let file = match options.open(path) {
        Err(error) if cfg!(windows) && error.raw_os_error() == Some(ERROR_SHARING_VIOLATION) => {
            return Err(JournalError::Locked { path: path.to_owned() }.into());
        }
        opened => opened.map_err(failed)?,
    };
    match if is_locked && cfg!(not(windows)) { lock_file(&file) } else { Ok(()) } {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(JournalError::Locked { path: path.to_owned() }.into()),
        Err(TryLockError::Error(source)) => Err(JournalError::NoLock { path: path.to_owned(), source }.into()),
    }
}
