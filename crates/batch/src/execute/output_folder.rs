//! The output folder of a batch.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Deserialize;

use crate::execute::entries::{FILES, JOURNAL, MACHINES, is_chart, is_file_of_batch, is_leftover, is_recording, named};
use crate::execute::{BatchError, CHARTS_FOLDER, Lock, RECORDINGS_FOLDER, expect_files};
use crate::plan::{PLAN_FILE, PROGRAM, Slice};
use wildfire_base::whole_file::sync_folder_of;

/// The most folders of one name that are tried, the name itself and `-2`, `-3` ...
const MAX_NUMBERED: u32 = 100_000;

/// A folder that exists and either holds no results of another batch or may be overwritten.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFolder {
    path: PathBuf,
    keeping: JournalKeeping,
}

/// How the journals of a folder are kept, depending on its file system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JournalKeeping {
    pub lock: Lock,
    /// The longest time until a line is synced to the disk.
    pub sync_every: Duration,
    /// A folder on a local disk in which a journal is written until its process ends; then it is moved to its
    /// destination.
    pub local_folder: Option<PathBuf>,
}

impl Default for JournalKeeping {
    fn default() -> Self {
        Self { lock: Lock::default(), sync_every: Duration::from_secs(1), local_folder: None }
    }
}

impl OutputFolder {
    /// Creates `parent/name`, or the first of `parent/name-2`, `parent/name-3` ... that does not exist yet.
    ///
    /// The name is made fit for files by [`file_name_of`].
    pub fn next_free(parent: &Path, name: &str) -> Result<Self, BatchError> {
        create_folder(parent)?;
        for path in Self::numbered(parent, name) {
            match fs::create_dir(&path).and_then(|()| sync_folder_of(&path)) {
                Ok(()) => return Ok(Self::at(path)),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(BatchError::unwritable(&path, error)),
            }
        }
        let name = file_name_of(name);
        let full = io::Error::other(format!("{name} to {name}-{MAX_NUMBERED} already exist"));
        Err(BatchError::unwritable(parent, full))
    }

    /// Returns the path that [`Self::next_free`] would create now, and creates nothing.
    pub fn next_free_path(parent: &Path, name: &str) -> PathBuf {
        let free = Self::numbered(parent, name).find(|path| !path.exists());
        free.unwrap_or_else(|| parent.join(file_name_of(name)))
    }

    /// Lists `parent/name`, `parent/name-2`, `parent/name-3` ...
    fn numbered(parent: &Path, name: &str) -> impl Iterator<Item = PathBuf> {
        let name = file_name_of(name);
        (1..=MAX_NUMBERED)
            .map(move |number| parent.join(if number == 1 { name.clone() } else { format!("{name}-{number}") }))
    }

    fn at(path: PathBuf) -> Self {
        Self { path, keeping: JournalKeeping::default() }
    }

    /// Returns the same folder with journals that are kept in this way.
    #[must_use]
    pub fn with_keeping(self, keeping: JournalKeeping) -> Self {
        Self { keeping, ..self }
    }

    pub fn keeping(&self) -> &JournalKeeping {
        &self.keeping
    }

    /// Opens a folder requested by name, and creates it if necessary.
    ///
    /// A folder that holds results is refused, unless `overwrite` says that they may be replaced. Other files in it
    /// are of no concern and stay.
    pub fn named(path: &Path, overwrite: bool) -> Result<Self, BatchError> {
        // A file of this name is never replaced, not even with `overwrite`, as it is no batch's.
        if path.exists() && !path.is_dir() {
            return Err(BatchError::NotAFolder { path: path.to_owned() });
        }
        // A folder with foreign files is fine; only results of a batch must not be overwritten by accident.
        let existing = FILES.into_iter().chain([RECORDINGS_FOLDER]).find(|entry| path.join(entry).exists());
        if let (Some(entry), false) = (existing, overwrite) {
            return Err(BatchError::HoldsResults { path: path.to_owned(), entry: entry.to_owned() });
        }
        let folder = Self::shared(path)?;
        // Without a plan, a journal without a line is what is left of a batch that was killed before it began.
        let mut slices = folder.journals()?.into_iter();
        // With a line, it is a batch whose plan was lost; its runs may be hours of work.
        match slices.find(|&slice| fs::metadata(folder.journal(slice)).is_ok_and(|found| found.len() > 0)) {
            Some(slice) if !overwrite => {
                Err(BatchError::HoldsResults { path: path.to_owned(), entry: JOURNAL.name(slice) })
            }
            _ => Ok(folder),
        }
    }

    /// Opens a folder that holds or may hold a batch, and creates it if necessary.
    pub fn shared(path: &Path) -> Result<Self, BatchError> {
        if path.exists() && !path.is_dir() {
            return Err(BatchError::NotAFolder { path: path.to_owned() });
        }
        expect_files(path)?;
        create_folder(path)?;
        Ok(Self::at(path.to_owned()))
    }

    /// Opens a folder of an existing batch.
    pub fn existing(path: &Path) -> Result<Self, BatchError> {
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                expect_files(path)?;
                Ok(Self::at(path.to_owned()))
            }
            Ok(_) => Err(BatchError::NotAFolder { path: path.to_owned() }),
            Err(source) => Err(BatchError::Unreadable { path: path.to_owned(), source }),
        }
    }

    /// Returns the slices that have a journal here, in order.
    pub fn journals(&self) -> Result<Vec<Slice>, BatchError> {
        let unreadable = |source| BatchError::Unreadable { path: self.path.clone(), source };
        let mut slices = Vec::new();
        for entry in fs::read_dir(&self.path).map_err(unreadable)? {
            let name = entry.map_err(unreadable)?.file_name();
            slices.extend(name.to_str().and_then(|name| JOURNAL.slice(name)));
        }
        slices.sort_unstable();
        Ok(slices)
    }

    /// Returns the path of a slice's journal.
    pub fn journal(&self, slice: Slice) -> PathBuf {
        self.path.join(JOURNAL.name(slice))
    }

    /// Creates the folder for recordings.
    pub fn prepare_recordings(&self) -> Result<(), BatchError> {
        create_folder(&self.path.join(RECORDINGS_FOLDER))
    }

    /// Removes the results of an earlier batch, so that an end before the last run leaves nothing of it that would
    /// pass for the new one's: tables, plan, journals and machines of slices and, where a batch's plan shows whose they are, all
    /// recordings and charts. The journal of a whole batch stays, since whoever asks for this holds it.
    pub fn remove_earlier_results(&self) -> Result<(), BatchError> {
        if self.holds_a_plan() {
            named(&self.path.join(RECORDINGS_FOLDER), is_recording).try_for_each(|path| remove_file(&path))?;
            named(&self.path.join(CHARTS_FOLDER), is_chart).try_for_each(|path| remove_file(&path))?;
        }
        let slices = self.journals()?.into_iter().filter(|slice| !slice.is_whole());
        let journals = slices.map(|slice| self.journal(slice));
        let files = FILES.iter().map(|name| self.path.join(name));
        let machines = named(&self.path, |name| name.to_str().and_then(|name| MACHINES.slice(name)).is_some());
        journals.chain(files).chain(machines.collect::<Vec<_>>()).try_for_each(|path| remove_file(&path))
    }

    /// Returns the files that a killed or running process has written aside, in order.
    pub fn leftovers(&self) -> Vec<PathBuf> {
        let mut paths: Vec<PathBuf> = Vec::new();
        paths.extend(named(&self.path, |name| is_leftover(name, is_file_of_batch)));
        paths.extend(named(&self.path.join(RECORDINGS_FOLDER), |name| is_leftover(name, is_recording)));
        paths.extend(named(&self.path.join(CHARTS_FOLDER), |name| is_leftover(name, is_chart)));
        paths.sort_unstable();
        paths
    }

    /// Removes what a killed process has written aside. The caller must be the only process that works on the batch.
    pub fn remove_leftovers(&self) -> Result<Vec<PathBuf>, BatchError> {
        let paths = self.leftovers();
        paths.iter().try_for_each(|path| remove_file(path))?;
        Ok(paths)
    }

    /// Returns whether the folder has the plan of a batch of this program.
    fn holds_a_plan(&self) -> bool {
        #[derive(Deserialize)]
        struct FolderPlan {
            program: String,
        }
        let json = fs::read(self.path.join(PLAN_FILE)).unwrap_or_default();
        serde_json::from_slice(&json).is_ok_and(|plan: FolderPlan| plan.program == PROGRAM)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the path of the recording of this name.
    pub fn recording(&self, name: &str) -> PathBuf {
        Self::recording_in(&self.path, name)
    }

    /// Returns the path of a recording in the folder of a batch.
    pub fn recording_in(folder: &Path, name: &str) -> PathBuf {
        folder.join(RECORDINGS_FOLDER).join(name)
    }
}

/// Creates a folder, and those that it is in, so that they survive a crash of the machine.
fn create_folder(path: &Path) -> Result<(), BatchError> {
    let missing: Vec<&Path> = path.ancestors().take_while(|folder| !folder.exists()).collect();
    let created = fs::create_dir_all(path).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => BatchError::NotAFolder { path: path.to_owned() },
        _ => BatchError::unwritable(path, source),
    });
    created.and_then(|()| {
        missing
            .iter()
            .filter(|folder| folder.file_name().is_some())
            .try_for_each(|folder| sync_folder_of(folder).map_err(|source| BatchError::unwritable(folder, source)))
    })
}

/// Removes a file if it is there.
fn remove_file(path: &Path) -> Result<(), BatchError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(BatchError::unwritable(path, source)),
        _ => Ok(()),
    }
}

/// Returns a scenario's name as a file name: characters that do not belong in one become `-`.
pub fn file_name_of(name: &str) -> String {
    let kept: String = name
        .chars()
        .take(100)
        .map(|letter| if letter.is_alphanumeric() || "-_.+".contains(letter) { letter } else { '-' })
        .collect();
    match kept.trim_start_matches('.') {
        "" => "unnamed".into(),
        rest => rest.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execute::RUNS_FILE;

    #[test]
    fn next_free_name_is_counted_up() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let parent = scratch.path().join("runs");
        for expected in ["contest", "contest-2", "contest-3"] {
            let folder = OutputFolder::next_free(&parent, "contest").expect("free names are left");
            assert_eq!(folder.path(), parent.join(expected));
            assert!(folder.path().is_dir());
        }
    }

    #[test]
    fn names_cannot_leave_the_parent() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        for name in ["../out", "/etc", "..", ".", "", "a/b", "x\0y"] {
            let folder = OutputFolder::next_free(scratch.path(), name).expect("a name is made of anything");
            assert_eq!(folder.path().parent(), Some(scratch.path()), "{name:?}");
        }
    }

    #[test]
    fn folder_with_results_is_refused_unless_they_may_go() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("out");
        assert!(OutputFolder::named(&path, false).is_ok());
        fs::write(path.join("notes.txt"), "mine").expect("writable");
        assert!(OutputFolder::named(&path, false).is_ok(), "other files are no results");
        fs::write(path.join(RUNS_FILE), "").expect("writable");
        let refusal = OutputFolder::named(&path, false).expect_err("results are there");
        assert!(matches!(refusal, BatchError::HoldsResults { entry, .. } if entry == RUNS_FILE));
        assert!(OutputFolder::named(&path, true).is_ok());
        assert!(path.join("notes.txt").exists());
    }

    #[test]
    fn file_in_place_of_the_folder_is_named() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("out");
        fs::write(&path, "").expect("writable");
        assert!(matches!(OutputFolder::named(&path, true), Err(BatchError::NotAFolder { .. })));
    }

    #[test]
    fn earlier_recordings_go_only_where_a_plan_shows_a_batch() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let folder = OutputFolder::named(scratch.path(), false).expect("it is empty");
        folder.prepare_recordings().expect("writable");
        let mine = scratch.path().join(RECORDINGS_FOLDER).join("seed-notes.wildfire");
        let recording = folder.recording("run-12-seed-7.wildfire");
        for path in [recording.clone(), mine.clone(), scratch.path().join(RUNS_FILE)] {
            fs::write(path, "").expect("writable");
        }
        fs::write(scratch.path().join(PLAN_FILE), r#"{"program": "other"}"#).expect("writable");
        folder.remove_earlier_results().expect("removable");
        assert!(recording.exists() && !scratch.path().join(RUNS_FILE).exists());
        fs::write(scratch.path().join(PLAN_FILE), r#"{"format": 1, "program": "wildfire"}"#).expect("writable");
        folder.remove_earlier_results().expect("removable");
        assert!(!recording.exists() && mine.exists());
    }

    #[test]
    fn file_in_place_of_the_parent_is_named() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let parent = scratch.path().join("runs");
        fs::write(&parent, "").expect("writable");
        let refusal = OutputFolder::next_free(&parent, "contest").expect_err("it is in the way");
        assert!(refusal.to_string().contains("is a file, or lies below one"), "{refusal}");
    }
}
