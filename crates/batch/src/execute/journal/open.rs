//! A journal that only this process writes.

use std::fs::{self, File, Metadata};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::mem;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::index::{LineStart, Lines, RowReader, read_line_at};
use super::line::{Entry, Head, decode, encode, encode_row};
use super::lock::open_to_append;
use super::{JournalError, JournalIndex};
use crate::execute::{Append, BatchError, Disk, Lock, OutputFolder, RealDisk, RunRow, Status, Whole};
use crate::plan::{BatchPlan, Slice};
use wildfire_base::time::wall::WallStopwatch;

/// The most bytes of a journal that are kept in memory.
const MAX_GUARDED_BYTES: usize = 1 << 28;

/// Bytes of a journal that are brought to their place at once.
const BROUGHT_BYTES: usize = 1 << 20;

/// A journal with its lock, which is held as long as this exists.
pub struct OpenJournal {
    path: PathBuf,
    file: File,
    writer: Box<dyn Append>,
    index: JournalIndex,
    /// The place of a journal that is written elsewhere.
    home: Option<FinalJournal>,
    sync_every: Duration,
    /// Since the first line that is not on the disk yet.
    unsynced: Option<WallStopwatch>,
    guard: Option<JournalGuard>,
}

/// What restores the files of a batch after a program has changed them.
struct JournalGuard {
    /// All lines of the journal.
    lines: Vec<u8>,
    /// Its file as this process left it.
    stamp: Option<FileStamp>,
    plan_path: PathBuf,
    plan: Vec<u8>,
}

/// What tells that a file was written to, even if it is as long as before.
#[derive(Clone, Copy, PartialEq)]
struct FileStamp {
    length: u64,
    modified: Option<SystemTime>,
    #[cfg(unix)]
    changed: (i64, i64),
}

impl FileStamp {
    fn new(metadata: &Metadata) -> Self {
        #[cfg(unix)]
        use std::os::unix::fs::MetadataExt;
        Self {
            length: metadata.len(),
            modified: metadata.modified().ok(),
            // A program cannot set this one.
            #[cfg(unix)]
            changed: (metadata.ctime(), metadata.ctime_nsec()),
        }
    }
}

/// The file that a journal on a local disk is brought to.
struct FinalJournal {
    path: PathBuf,
    file: File,
    writer: Box<dyn Append>,
    /// Its bytes, all of which the local file has too.
    end: u64,
}

/// The lock on a journal that has not been read yet.
pub struct LockedJournal {
    path: PathBuf,
    file: File,
    sync_every: Duration,
    local_folder: Option<PathBuf>,
}

impl LockedJournal {
    /// Opens a slice's journal, creates it if necessary, and locks it.
    pub fn take(folder: &OutputFolder, slice: Slice) -> Result<Self, BatchError> {
        let path = folder.journal(slice);
        let keeping = folder.keeping();
        let file = open_to_append(&path, keeping.lock)?;
        let sync_every = keeping.sync_every;
        let local_folder = keeping.local_folder.clone();
        Ok(Self { path, file, sync_every, local_folder })
    }

    /// Removes all lines.
    pub fn clear(&self) -> Result<(), BatchError> {
        self.file.set_len(0).map_err(|source| BatchError::unwritable(&self.path, source))
    }

    /// Reads the existing lines, drops a torn one, and begins the journal if it has no line yet.
    pub fn open(self, plan: &BatchPlan, slice: Slice, disk: &dyn Disk) -> Result<OpenJournal, BatchError> {
        let sha256 = plan.content_sha256();
        // Read under the lock, so that nobody adds lines meanwhile.
        let mut index = JournalIndex::read(&self.path, &self.file, plan, slice)?;
        // The next line would be appended to the torn one, and both would be lost.
        drop_torn_line(&index, &self.path, &self.file)?;
        let Self { mut path, mut file, sync_every, local_folder } = self;
        let mut home = None;
        if let Some(folder) = local_folder {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // The plan's digest is part of the name: another batch on this machine has another copy.
            let local_path = folder.join(format!("wildfire-{}-{name}", &sha256[..16]));
            let local = copy_to(&folder, &local_path, &file)?;
            let was_torn = index.is_torn();
            // A copy that an earlier process left may hold runs that the journal lacks.
            index = JournalIndex::read(&local_path, &local, plan, slice)?;
            drop_torn_line(&index, &local_path, &local)?;
            // The length is noted so that lines another process appends meanwhile are found before both are mixed.
            let end = file.metadata().map_err(|source| BatchError::unwritable(&path, source))?.len();
            home = Some(FinalJournal { writer: writer_of(disk, &path, &file)?, path, file, end });
            // The report of a torn line is about the journal, while the index is now that of the copy.
            index.note_torn(was_torn);
            (path, file) = (local_path, local);
        }
        let writer = writer_of(disk, &path, &file)?;
        let is_empty = index.end() == 0;
        let mut journal = OpenJournal { path, file, writer, index, home, sync_every, unsynced: None, guard: None };
        // The head is on disk before any run begins, so that the folder is known as begun.
        if is_empty {
            let head = encode(&Head::new(&sha256, slice));
            journal.write(&head)?;
            journal.index.append_head(head.len());
            journal.sync()?;
        }
        Ok(journal)
    }
}

/// Writes the journal of a whole batch in one go; finished, it takes the place of the one that is there.
pub fn written_journal(
    path: &Path,
    plan: &BatchPlan,
    disk: &dyn Disk,
    rows: impl Iterator<Item = Result<RunRow, JournalError>>,
) -> Result<Box<dyn Whole>, BatchError> {
    let unwritable = |source| BatchError::unwritable(path, source);
    let mut file = disk.whole_file(path).map_err(unwritable)?;
    file.write_all(&encode(&Head::new(&plan.content_sha256(), Slice::WHOLE))).map_err(unwritable)?;
    for row in rows {
        file.write_all(&encode_row(&row?)).map_err(unwritable)?;
    }
    Ok(file)
}

/// Returns the hash of the plan whose journal this is; `None` if its first line cannot be read.
pub fn plan_of_journal(path: &Path) -> Option<String> {
    let line = read_line_at(&File::open(path).ok()?, 0).ok()?;
    decode(&line).ok().map(|head: Head| head.plan_sha256)
}

/// Returns the seeds of the runs in a journal in the order of its lines, up to the first that cannot be read.
pub fn seeds_of_journal(path: &Path) -> Vec<u64> {
    let mut seeds = Vec::new();
    let Ok(file) = File::open(path) else { return seeds };
    let Ok(mut lines) = Lines::from(path, &file, LineStart::default()) else { return seeds };
    while let Ok(Some(LineStart { number, .. })) = lines.next() {
        match decode::<Entry>(&lines.line) {
            _ if number == 0 => {}
            Ok(entry) => seeds.push(entry.label.seed),
            Err(_) => break,
        }
    }
    seeds
}

fn writer_of(disk: &dyn Disk, path: &Path, file: &File) -> Result<Box<dyn Append>, BatchError> {
    file.try_clone().map(|file| disk.journal(file)).map_err(|source| BatchError::unwritable(path, source))
}

fn drop_torn_line(index: &JournalIndex, path: &Path, file: &File) -> Result<(), BatchError> {
    if !index.is_torn() {
        return Ok(());
    }
    file.set_len(index.end()).map_err(|source| BatchError::unwritable(path, source))
}

/// Opens the local file of a journal with all that its place holds. A process that was killed on this machine may have
/// left a file that holds more, which then stays as it is.
fn copy_to(folder: &Path, local_path: &Path, mut home: &File) -> Result<File, BatchError> {
    let unwritable = |source| BatchError::unwritable(local_path, source);
    fs::create_dir_all(folder).map_err(unwritable)?;
    let mut local = match open_to_append(local_path, Lock::Flock) {
        // Locks of local disks work; where they do not, the journal's own lock has to do.
        Err(BatchError::Journal(JournalError::NoLock { .. })) => open_to_append(local_path, Lock::None),
        opened => opened,
    }?;
    let rewind = |mut file: &File| file.seek(SeekFrom::Start(0)).map_err(unwritable);
    let length = rewind(home).and_then(|_| home.metadata().map_err(unwritable))?.len();
    rewind(&local)?;
    // A copy that goes on from the journal is kept; any other is replaced.
    if !begins_with(&local, home, length).map_err(unwritable)? {
        local.set_len(0).map_err(unwritable)?;
        rewind(&local)?;
        rewind(home)?;
        io::copy(&mut home, &mut local).map_err(unwritable)?;
    }
    Ok(local)
}

/// Compares the first `length` bytes of two files that are at their beginnings.
fn begins_with(local: &File, home: &File, length: u64) -> io::Result<bool> {
    // The cheap test first; most copies are new and empty.
    if local.metadata()?.len() < length {
        return Ok(false);
    }
    let [local, home] = [local, home].map(|file| BufReader::with_capacity(BROUGHT_BYTES, file).take(length).bytes());
    let mut same = local.zip(home).map(|(local, home)| Ok(local? == home?));
    same.find(|same| !matches!(same, Ok(true))).unwrap_or(Ok(true))
}

impl OpenJournal {
    /// Keeps what restores the journal and the file of the plan, while programs run that might change them.
    pub fn guard(&mut self, plan_path: PathBuf) -> Result<(), BatchError> {
        // A journal on a local disk is out of reach, or as good as that.
        if self.home.is_some() {
            return Ok(());
        }
        let lines = fs::read(&self.path).map_err(|source| JournalError::unreadable(&self.path, source))?;
        let plan = fs::read(&plan_path).map_err(|source| JournalError::unreadable(&plan_path, source))?;
        let stamp = self.file.metadata().ok().map(|metadata| FileStamp::new(&metadata));
        self.guard = (lines.len() <= MAX_GUARDED_BYTES).then_some(JournalGuard { lines, stamp, plan_path, plan });
        Ok(())
    }

    /// Restores what a program has changed since the last call, and says what that was; `None` if nothing was changed, or
    /// nothing guards the journal.
    pub fn restore(&mut self) -> Result<Option<String>, BatchError> {
        let Some(guard) = &self.guard else { return Ok(None) };
        let mut change = None;
        // The plan first: without its folder the journal cannot be there.
        if fs::read(&guard.plan_path).ok().as_ref() != Some(&guard.plan) {
            change = Some(format!("{} was changed", name_of(&guard.plan_path)));
            fs::create_dir_all(guard.plan_path.parent().unwrap_or(Path::new(".")))
                .and_then(|()| wildfire_base::whole_file::write_whole(&guard.plan_path, &guard.plan))
                .map_err(|source| BatchError::unwritable(&guard.plan_path, source))?;
        }
        let stamp = self.file.metadata().ok().map(|metadata| FileStamp::new(&metadata));
        // Some network file systems date files again by themselves, so the lines decide.
        let is_rewritten = stamp != guard.stamp && fs::read(&self.path).ok().as_ref() != Some(&guard.lines);
        let found = match self.expect_unchanged() {
            Err(JournalError::Changed { change, .. }) => Some(change),
            Err(error) => return Err(error.into()),
            Ok(()) if is_rewritten => Some("its lines were rewritten".into()),
            Ok(()) => None,
        };
        self.guard.iter_mut().for_each(|guard| guard.stamp = stamp);
        if let Some(found) = found {
            change = Some(format!("{}: {found}", name_of(&self.path)));
            self.rewrite()?;
        }
        Ok(change)
    }

    /// Refuses lines that are not those that were written; a guarded journal is restored instead.
    pub fn restore_lines(&mut self) -> Result<(), BatchError> {
        if self.guard.is_some() && self.rows()?.expect_unchanged_lines().is_err() {
            self.rewrite()?;
        }
        Ok(())
    }

    /// Puts a new file with all lines in the place of the journal.
    fn rewrite(&mut self) -> Result<(), BatchError> {
        let Some(guard) = &mut self.guard else { return Ok(()) };
        // The program that changed the journal may have removed it already.
        let _ = fs::remove_file(&self.path);
        let file = open_to_append(&self.path, Lock::None)?;
        file.set_len(0).map_err(|source| BatchError::unwritable(&self.path, source))?;
        // Where files cannot be locked, the first lock was refused already, or not asked for.
        let _ = file.try_lock();
        self.writer = writer_of(&RealDisk, &self.path, &file)?;
        let written = self.writer.append(&guard.lines).and_then(|()| self.writer.sync());
        written.map_err(|source| BatchError::unwritable(&self.path, source))?;
        guard.stamp = file.metadata().ok().map(|metadata| FileStamp::new(&metadata));
        self.file = file;
        Ok(())
    }

    /// Writes the line of a run, and syncs it with all earlier lines if the oldest of them has waited long.
    pub fn add(&mut self, run: u64, status: Status, line: &[u8]) -> Result<(), BatchError> {
        self.expect_unchanged_unless_guarded()?;
        self.write(line)?;
        self.index.append(run, status, line);
        match self.unsynced.get_or_insert_with(WallStopwatch::start).elapsed() {
            waited if waited >= self.sync_every => self.sync(),
            _ => Ok(()),
        }
    }

    /// Syncs if necessary; has to be called regularly during runs.
    ///
    /// # Errors
    /// If the disk cannot be written, or the journal is no longer as this process left it.
    pub fn sync_if_due(&mut self) -> Result<(), BatchError> {
        self.expect_unchanged_unless_guarded()?;
        match self.unsynced {
            Some(since) if since.elapsed() >= self.sync_every => self.sync(),
            _ => Ok(()),
        }
    }

    /// Syncs all lines to the disk.
    pub fn sync(&mut self) -> Result<(), BatchError> {
        self.expect_unchanged_unless_guarded()?;
        self.unsynced = None;
        self.writer.sync().map_err(|source| BatchError::unwritable(&self.path, source))
    }

    /// Moves a journal that is written on a local disk to its destination; from then on it is written there.
    pub fn bring_home(&mut self) -> Result<(), BatchError> {
        let Some(mut home) = self.home.take() else { return Ok(()) };
        let unwritable = |source| BatchError::unwritable(&home.path, source);
        let found = home.file.metadata().map_err(unwritable)?.len();
        // Another process wrote to the journal: appending would mix both.
        if found != home.end {
            let change = format!("it has {found} bytes, expected {} as when this process began", home.end);
            return Err(JournalError::Changed { path: home.path, change }.into());
        }
        // What the journal has already is the beginning of the copy.
        self.file.seek(SeekFrom::Start(home.end)).map_err(|source| JournalError::unreadable(&self.path, source))?;
        let mut part = vec![0; BROUGHT_BYTES];
        loop {
            let bytes = self.file.read(&mut part).map_err(|source| JournalError::unreadable(&self.path, source))?;
            if bytes == 0 {
                break;
            }
            home.writer.append(&part[..bytes]).map_err(unwritable)?;
        }
        // Before the copy is removed, which until then is the only one on disk.
        home.writer.sync().map_err(unwritable)?;
        let FinalJournal { path, file, writer, .. } = home;
        (self.file, self.writer) = (file, writer);
        // A copy that cannot be removed does no harm: the journal has all that is in it.
        let _ = fs::remove_file(mem::replace(&mut self.path, path));
        Ok(())
    }

    /// What guards restore, they need not refuse.
    fn expect_unchanged_unless_guarded(&mut self) -> Result<(), JournalError> {
        if self.guard.is_some() { Ok(()) } else { self.expect_unchanged() }
    }

    /// Refuses a journal that was removed, replaced or changed: lines written to it would be lost without a word. A second
    /// process that writes to it is found by this, too.
    fn expect_unchanged(&mut self) -> Result<(), JournalError> {
        let changed = |change: String| Err(JournalError::Changed { path: self.path.clone(), change });
        let metadata = self.file.metadata().map_err(|source| JournalError::unreadable(&self.path, source))?;
        match fs::metadata(&self.path) {
            // A journal that was replaced while it was open would lose all lines written since.
            Ok(found) if !is_same_file(&metadata, &found) => return changed("another file has its name".into()),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return changed("it, or its folder, was removed or renamed".into());
            }
            Err(error) => return Err(JournalError::unreadable(&self.path, error)),
        }
        let expected = self.index.end();
        match metadata.len() {
            found if found == expected => Ok(()),
            found => changed(format!("it has {found} bytes, expected the {expected} that were written")),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), BatchError> {
        self.writer.append(bytes).map_err(|source| BatchError::unwritable(&self.path, source))?;
        let Some(guard) = &mut self.guard else { return Ok(()) };
        guard.lines.extend_from_slice(bytes);
        guard.stamp = self.file.metadata().ok().map(|metadata| FileStamp::new(&metadata));
        if guard.lines.len() > MAX_GUARDED_BYTES {
            self.guard = None;
        }
        Ok(())
    }

    pub fn index(&self) -> &JournalIndex {
        &self.index
    }

    /// Reads the row of a run in the journal.
    pub fn row(&self, run: u64) -> Result<RunRow, JournalError> {
        self.rows()?.row(run)
    }

    /// Reads the rows.
    pub fn rows(&self) -> Result<RowReader<'_>, JournalError> {
        RowReader::new(self.path.clone(), &self.file, &self.index)
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
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
