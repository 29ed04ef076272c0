//! Where a batch puts its files.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::batch::BatchError;
use crate::batch::plan::PROGRAM;

pub const PLAN_FILE: &str = "plan.json";
pub const RUNS_FILE: &str = "runs.csv";
pub const AGENTS_FILE: &str = "agents.csv";
pub const TABLES_FILE: &str = "tables.md";
pub const RECORDINGS_FOLDER: &str = "recordings";

/// All that a batch may write into its folder.
const ENTRIES: [&str; 5] = [PLAN_FILE, RUNS_FILE, AGENTS_FILE, TABLES_FILE, RECORDINGS_FOLDER];

/// The most folders of one name that are tried, the name itself and `-2`, `-3` ...
const MAX_NUMBERED: u32 = 100_000;

/// A folder that exists and holds no results of another batch, or may lose them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Creates `parent/name`, or the first of `parent/name-2`, `parent/name-3` ... that does not exist yet.
    ///
    /// The name is made fit for files by [`file_name_of`].
    pub fn next_free(parent: &Path, name: &str) -> Result<Self, BatchError> {
        let name = file_name_of(name);
        create_folder(parent)?;
        for number in 1..=MAX_NUMBERED {
            let path = parent.join(if number == 1 { name.clone() } else { format!("{name}-{number}") });
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(BatchError::unwritable(&path, error)),
            }
        }
        let full = io::Error::other(format!("{name} to {name}-{MAX_NUMBERED} exist already"));
        Err(BatchError::unwritable(parent, full))
    }

    /// Takes a folder that was asked for by name, and creates it if need be.
    ///
    /// A folder that holds results is refused, unless `overwrite` says that they may be replaced. Other files in it
    /// are of no concern and stay.
    pub fn named(path: &Path, overwrite: bool) -> Result<Self, BatchError> {
        if path.exists() && !path.is_dir() {
            return Err(BatchError::NotAFolder { path: path.to_owned() });
        }
        let held = ENTRIES.into_iter().find(|entry| path.join(entry).exists());
        if let (Some(entry), false) = (held, overwrite) {
            return Err(BatchError::HoldsResults { path: path.to_owned(), entry });
        }
        create_folder(path)?;
        Ok(Self { path: path.to_owned() })
    }

    /// Creates the folder for recordings.
    pub fn prepare_recordings(&self) -> Result<(), BatchError> {
        create_folder(&self.path.join(RECORDINGS_FOLDER))
    }

    /// Removes the results of an earlier batch, so that an end before the last run leaves nothing of it that would
    /// pass for the new one's: the four files and, where a batch's plan shows whose they are, all recordings.
    pub fn remove_earlier_results(&self) -> Result<(), BatchError> {
        if self.holds_a_plan() {
            let entries = fs::read_dir(self.path.join(RECORDINGS_FOLDER)).into_iter().flatten().flatten();
            entries
                .filter(|entry| is_recording(&entry.file_name()))
                .try_for_each(|entry| remove_file(&entry.path()))?;
        }
        [PLAN_FILE, RUNS_FILE, AGENTS_FILE, TABLES_FILE].iter().try_for_each(|name| remove_file(&self.path.join(name)))
    }

    /// Whether the folder has the plan of a batch of this program.
    fn holds_a_plan(&self) -> bool {
        #[derive(Deserialize)]
        struct Plan {
            program: String,
        }
        let json = fs::read(self.path.join(PLAN_FILE)).unwrap_or_default();
        serde_json::from_slice(&json).is_ok_and(|plan: Plan| plan.program == PROGRAM)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where the recording of a run goes.
    pub fn recording(&self, seed: u64) -> PathBuf {
        Self::recording_in(&self.path, seed)
    }

    /// Where it is in the folder of a batch.
    pub fn recording_in(folder: &Path, seed: u64) -> PathBuf {
        folder.join(RECORDINGS_FOLDER).join(format!("seed-{seed}.wildfire"))
    }
}

fn create_folder(path: &Path) -> Result<(), BatchError> {
    fs::create_dir_all(path).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists => {
            BatchError::unwritable(path, io::Error::other("a file stands there; expected a folder, or nothing"))
        }
        _ => BatchError::unwritable(path, source),
    })
}

/// Whether this is a name that [`OutputFolder::recording`] gives.
fn is_recording(name: &OsStr) -> bool {
    let seed = name.to_str().and_then(|name| name.strip_prefix("seed-")?.strip_suffix(".wildfire"));
    seed.is_some_and(|seed| seed.parse::<u64>().is_ok())
}

/// Removes a file if it is there.
fn remove_file(path: &Path) -> Result<(), BatchError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(BatchError::unwritable(path, source)),
        _ => Ok(()),
    }
}

/// A scenario's name as a name of files: characters that do not belong into one become `-`.
pub fn file_name_of(name: &str) -> String {
    let keep = |letter: char| if letter.is_alphanumeric() || "-_.+".contains(letter) { letter } else { '-' };
    let kept: String = name.chars().take(100).map(keep).collect();
    match kept.trim_start_matches('.') {
        "" => "unnamed".into(),
        rest => rest.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(matches!(refusal, BatchError::HoldsResults { entry: RUNS_FILE, .. }));
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
        for path in [folder.recording(7), mine.clone(), scratch.path().join(RUNS_FILE)] {
            fs::write(path, "").expect("writable");
        }
        fs::write(scratch.path().join(PLAN_FILE), r#"{"program": "other"}"#).expect("writable");
        folder.remove_earlier_results().expect("removable");
        assert!(folder.recording(7).exists() && !scratch.path().join(RUNS_FILE).exists());
        fs::write(scratch.path().join(PLAN_FILE), r#"{"format": 1, "program": "wildfire"}"#).expect("writable");
        folder.remove_earlier_results().expect("removable");
        assert!(!folder.recording(7).exists() && mine.exists());
    }

    #[test]
    fn file_in_place_of_the_parent_is_named() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let parent = scratch.path().join("runs");
        fs::write(&parent, "").expect("writable");
        let refusal = OutputFolder::next_free(&parent, "contest").expect_err("it is in the way");
        assert!(refusal.to_string().contains("a file stands there"), "{refusal}");
    }
}
