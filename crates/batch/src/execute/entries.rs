//! Entries of a batch's folder: the names that a batch uses, and the check that they are files.

use std::ffi::OsStr;
use std::fs::{self, FileType};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::plan::{PLAN_FILE, Slice};

pub const RUNS_FILE: &str = "runs.csv";
pub const AGENTS_FILE: &str = "agents.csv";
pub const TABLES_FILE: &str = "tables.md";
pub const SUMMARY_FILE: &str = "summary.csv";
pub const RECORDINGS_FOLDER: &str = "recordings";
pub const RUNS_PARQUET: &str = "runs.parquet";
pub const CALLS_PARQUET: &str = "planner_calls.parquet";
pub const STATES_PARQUET: &str = "states.parquet";
pub const DECISIONS_PARQUET: &str = "decisions.parquet";
pub const REPORT_FILE: &str = "report.html";
pub const CHARTS_FOLDER: &str = "charts";
pub const MACHINES_FILE: &str = "machines.json";

/// The files that a batch may write into its folder, besides journals and lists of the machines of slices.
pub const FILES: [&str; 11] = [
    PLAN_FILE,
    RUNS_FILE,
    AGENTS_FILE,
    TABLES_FILE,
    SUMMARY_FILE,
    RUNS_PARQUET,
    CALLS_PARQUET,
    STATES_PARQUET,
    DECISIONS_PARQUET,
    REPORT_FILE,
    MACHINES_FILE,
];

/// A kind of file of which every slice has its own, by the parts of its name: that of the whole batch is `runs.journal`,
/// that of a slice `runs-2-of-5.journal`.
#[derive(Clone, Copy, Debug)]
pub struct SliceFile(&'static str, &'static str);

pub const JOURNAL: SliceFile = SliceFile("runs", ".journal");
/// The list of machines that worked on a slice.
pub const MACHINES: SliceFile = SliceFile("machines", ".json");

impl SliceFile {
    pub fn name(self, slice: Slice) -> String {
        let Self(stem, ending) = self;
        let of_slice = format!("-{}", slice.to_string().replace('/', "-of-"));
        format!("{stem}{}{ending}", if slice.is_whole() { "" } else { &of_slice })
    }

    /// Returns the slice of the file with this name; `None` for other names.
    pub fn slice(self, name: &str) -> Option<Slice> {
        let parts = name.strip_prefix(self.0)?.strip_suffix(self.1)?;
        let slice = parts.strip_prefix('-').map_or(Some(Slice::WHOLE), |it| it.replace("-of-", "/").parse().ok())?;
        (self.name(slice) == name).then_some(slice)
    }
}

/// An entry in a batch's folder that the batch did not write.
#[derive(Debug, Error)]
#[error("{} is {found}; expected a {expected}", path.display())]
pub struct UnexpectedFile {
    path: PathBuf,
    found: String,
    expected: &'static str,
}

/// Refuses a batch's folder in which a pipe, a device, a loop of links or a folder has the name of one of its files:
/// reading it might never end. Links to files are accepted.
pub fn expect_files(folder: &Path) -> Result<(), UnexpectedFile> {
    FILES.iter().try_for_each(|name| expect_file(&folder.join(name)))?;
    let is_of_slice =
        |name: &OsStr| name.to_str().is_some_and(|name| JOURNAL.slice(name).or(MACHINES.slice(name)).is_some());
    named(folder, is_of_slice).try_for_each(|path| expect_file(&path))?;
    for (name, is_expected) in [(RECORDINGS_FOLDER, is_recording as fn(&OsStr) -> bool), (CHARTS_FOLDER, is_chart)] {
        let inside = folder.join(name);
        expect(&inside, FileType::is_dir, "folder")?;
        named(&inside, is_expected).try_for_each(|path| expect_file(&path))?;
    }
    Ok(())
}

/// Refuses an entry that exists and is no file; an inaccessible one is left to the code that opens it.
pub fn expect_file(path: &Path) -> Result<(), UnexpectedFile> {
    expect(path, FileType::is_file, "file")
}

fn expect(path: &Path, is_expected: fn(&FileType) -> bool, expected: &'static str) -> Result<(), UnexpectedFile> {
    let found = match fs::metadata(path) {
        Ok(found) if is_expected(&found.file_type()) => return Ok(()),
        Ok(found) => word_for(found.file_type()).to_owned(),
        Err(error) if is_not_there(error.kind()) || error.kind() == ErrorKind::PermissionDenied => return Ok(()),
        Err(error) => format!("a link that cannot be followed ({error})"),
    };
    Err(UnexpectedFile { path: path.to_owned(), found, expected })
}

fn is_not_there(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::NotFound | ErrorKind::NotADirectory)
}

fn word_for(found: FileType) -> &'static str {
    // Opening a pipe would wait forever for a writer, so the kind is looked at before a file is opened.
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.is_fifo() {
            return "a pipe";
        }
        if found.is_socket() {
            return "a socket";
        }
        if found.is_char_device() || found.is_block_device() {
            return "a device";
        }
    }
    if found.is_dir() { "a folder" } else { "a file" }
}

/// Returns the paths of a folder's entries whose names meet the condition; none if the folder does not exist.
pub fn named(folder: &Path, is_so: impl Fn(&OsStr) -> bool) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter(move |entry| is_so(&entry.file_name())).map(|entry| entry.path())
}

/// Returns whether this is a recording's name: `seed-7.wildfire` or `run-12-seed-7.wildfire`.
pub fn is_recording(name: &OsStr) -> bool {
    let numbers = name.to_str().and_then(|name| {
        let rest = name.strip_suffix(".wildfire")?;
        let (run, seed) = rest.rsplit_once("seed-")?;
        // Batches of one variant leave the run out of names, and any number may stand for it.
        let run = if run.is_empty() { "0" } else { run.strip_prefix("run-")?.strip_suffix('-')? };
        Some([run, seed])
    });
    numbers.is_some_and(|numbers| numbers.iter().all(|number| number.parse::<u64>().is_ok()))
}

/// Returns whether this is the name of a chart, of its data, or of a page that plays a run.
pub fn is_chart(name: &OsStr) -> bool {
    const ENDINGS: [&str; 6] = ["svg", "png", "pdf", "pgf", "csv", "html"];
    Path::new(name).extension().is_some_and(|ending| ENDINGS.iter().any(|valid| ending == *valid))
}

/// Returns whether this is the name under which a slice writes the plan before it renames it: `plan.json.JOURNAL`.
fn is_plan_of_slice(name: &str) -> bool {
    let journal = name.strip_prefix(PLAN_FILE).and_then(|rest| rest.strip_prefix('.'));
    journal.is_some_and(|journal| JOURNAL.slice(journal).is_some())
}

/// Returns whether this is the name of a file that a batch writes into its folder, besides its journals.
pub fn is_file_of_batch(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| FILES.contains(&name) || is_plan_of_slice(name) || MACHINES.slice(name).is_some())
}

/// Returns whether this is a name under which a process writes a file aside, as `NAME.PROCESS.part`, or a slice its
/// plan, of which the name meets the condition: what is left when the process is killed.
pub fn is_leftover(name: &OsStr, is_expected: impl Fn(&OsStr) -> bool) -> bool {
    let Some(name) = name.to_str() else { return false };
    let parts = name.strip_suffix(".part").and_then(|name| name.rsplit_once('.'));
    is_plan_of_slice(name)
        || parts.is_some_and(|(name, process)| process.parse::<u32>().is_ok() && is_expected(OsStr::new(name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_batch_wrote_aside_is_left_over() {
        for name in [
            "runs.csv.12.part",
            "machines.json.3.part",
            "machines-1-of-2.json.3.part",
            "plan.json.1.part",
            "plan.json.runs-1-of-2.journal",
            "plan.json.runs-1-of-2.journal.7.part",
        ] {
            assert!(is_leftover(OsStr::new(name), is_file_of_batch), "{name}");
        }
        for name in ["seed-7.wildfire.12.part", "run-3-seed-7.wildfire.1.part"] {
            assert!(is_leftover(OsStr::new(name), is_recording), "{name}");
        }
        assert!(is_leftover(OsStr::new("states.csv.12.part"), is_chart));
        for name in ["runs.csv", "runs.csv.part", "mine.csv.12.part", "runs.csv.x.part", "runs.journal", "12.part"] {
            assert!(!is_leftover(OsStr::new(name), is_file_of_batch), "{name}");
        }
    }

    #[test]
    fn missing_entries_and_links_to_files_are_not_refused() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        expect_files(&scratch.path().join("not-there")).expect("nothing is strange");
        fs::write(scratch.path().join("elsewhere"), "").expect("writable");
        fs::create_dir(scratch.path().join(RECORDINGS_FOLDER)).expect("writable");
        #[cfg(unix)]
        for name in [PLAN_FILE, "runs-1-of-2.journal", "recordings/seed-1.wildfire"] {
            std::os::unix::fs::symlink(scratch.path().join("elsewhere"), scratch.path().join(name))
                .expect("links can be made");
        }
        expect_files(scratch.path()).expect("links to files are files");
    }

    #[test]
    #[cfg(unix)]
    fn loops_devices_and_folders_in_place_of_files_are_named() {
        use std::os::unix::fs::symlink;
        for (name, target, fragment) in [
            (PLAN_FILE, PLAN_FILE, "plan.json is a link that cannot be followed"),
            ("runs.journal", "/dev/zero", "runs.journal is a device; expected a file"),
            (RUNS_FILE, "/", "runs.csv is a folder; expected a file"),
            (RECORDINGS_FOLDER, "/dev/null", "recordings is a device; expected a folder"),
        ] {
            let scratch = tempfile::tempdir().expect("a scratch folder");
            symlink(target, scratch.path().join(name)).expect("links can be made");
            let refusal = expect_files(scratch.path()).expect_err("it is strange").to_string();
            assert!(refusal.contains(fragment), "{refusal}");
        }
    }

    #[test]
    fn journals_and_lists_of_machines_are_known_by_their_names() {
        for slice in [Slice::WHOLE, Slice::new(2, 5).expect("a slice")] {
            assert_eq!(JOURNAL.slice(&JOURNAL.name(slice)), Some(slice));
            assert_eq!(MACHINES.slice(&MACHINES.name(slice)), Some(slice));
        }
        for name in ["runs.json", "machines-1-of-1.json", "machines-6-of-5.json", "machines-mine.json"] {
            assert_eq!(MACHINES.slice(name), None, "{name}");
        }
        for name in ["runs.csv", "runs-1-of-1.journal", "runs-6-of-5.journal", "runs-01-of-5.journal", "runs-.journal"]
        {
            assert_eq!(JOURNAL.slice(name), None, "{name}");
        }
    }
}
