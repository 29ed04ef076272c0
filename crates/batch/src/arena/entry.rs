//! Entries: a folder with `entry.toml`, and what that needs.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::{ArenaError, Track};
use crate::plan::{BatchPlan, CourseRequest, ENTRY_FILE, EntryCard, EntryFile, Seeds, read_card};
use wildfire_base::input_file;

/// The most files of an entry, and the most bytes of all of them.
const MAX_FILES: usize = 100;
const MAX_BYTES: u64 = 64_000_000;

/// How the effort of an entry is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Counted, the same everywhere: built-in planners and policies, and modules.
    Counted,
    /// Told by a program that runs beside: time and machine may change its results.
    Timed,
}

wildfire_base::names! { Class { Counted: "counted", Timed: "timed" } }

/// An entry that was read.
#[derive(Clone, Debug)]
pub struct ArenaEntry {
    pub card: EntryCard,
    /// Its file.
    pub path: PathBuf,
    /// All of its files, relative to its folder, in the order of their names.
    pub files: Vec<PathBuf>,
    /// 16 hexadecimal digits of SHA-256 over its files and their names.
    pub hash: String,
}

impl ArenaEntry {
    /// Reads the entry in a folder, or the one whose file this is.
    ///
    /// # Errors
    /// If it lacks a table `[entry]` with a name and at least one track, or has too many or too large files.
    pub fn read(path: &Path) -> Result<Self, ArenaError> {
        let path = if path.is_dir() { path.join(ENTRY_FILE) } else { path.to_owned() };
        let wrong = |message: &str| ArenaError::Wrong { path: path.clone(), message: message.to_owned() };
        let card =
            read_card(&path)?.ok_or_else(|| wrong("there is no table [entry]; expected its name and its tracks"))?;
        if card.tracks.is_empty() {
            return Err(wrong("[entry] has no `tracks`; expected a list of the tracks that it enters"));
        }
        // An unknown track is reported before any run of the other tracks is played.
        card.tracks
            .iter()
            .try_for_each(|name| Track::named(name).map(|_| ()))
            .map_err(|error| wrong(&error.to_string()))?;
        let folder = folder_of(&path);
        let unreadable = |source| ArenaError::Unreadable { path: folder.to_owned(), source };
        let mut files = Vec::new();
        collect(folder, Path::new(""), &mut files).map_err(unreadable)?;
        // Folders list files in an order of their own; the hash must not depend on the file system.
        files.sort();
        let (mut hash, mut left) = (Sha256::new(), MAX_BYTES);
        for file in &files {
            // The limit is on the sum, so the reader stops within the file that exceeds it.
            let bytes = input_file::read(&folder.join(file), left).map_err(unreadable)?;
            left -= bytes.len() as u64;
            // The name and the length separate files: without them, moving bytes from one file to the next would keep the hash.
            hash.update(format!("{}\n{}\n", file.display(), bytes.len()));
            hash.update(&bytes);
        }
        let hash: String = hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { card, files, hash, path })
    }

    pub fn folder(&self) -> &Path {
        folder_of(&self.path)
    }

    /// The runs of entries on a track.
    ///
    /// # Errors
    /// If one of them sets what the rules fix.
    pub fn plan(entries: &[Self], track: &Track, seeds: Seeds) -> Result<BatchPlan, ArenaError> {
        let entries = entries.iter().map(|entry| entry.path.clone()).collect();
        let request = CourseRequest { entries, seeds: Some(seeds), ..CourseRequest::default() };
        Ok(request.resolve_by(&track.course(), &EntryFile::read, true)?.plan)
    }
}

/// Returns the class of the entry that plays these runs.
pub(super) fn class_of(plan: &BatchPlan, entry: &str) -> Class {
    let of_entry = plan.variants.iter().filter(|variant| variant.swept[0].to_string() == entry);
    let mut programs = of_entry.flat_map(|variant| variant.scenario.used_programs());
    if programs.any(|program| program.table.module.is_none()) { Class::Timed } else { Class::Counted }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Lists the files below a folder; links are not followed.
fn collect(root: &Path, below: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for found in fs::read_dir(root.join(below))? {
        let found = found?;
        let name = below.join(found.file_name());
        let kind = found.file_type()?;
        if kind.is_dir() {
            collect(root, &name, files)?;
        } else if kind.is_file() {
            files.push(name);
        }
        // The check stands in the loop: a home folder given by mistake has millions of files.
        if files.len() > MAX_FILES {
            let message = format!("more than {MAX_FILES} files; expected only those of the entry");
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
        }
    }
    Ok(())
}
