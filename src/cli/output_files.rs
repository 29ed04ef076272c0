//! Files that are to be written: what can be checked of them before anything is computed, and writing them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::cli::failure::Failure;
use crate::cli::terminal;

/// A file that may have been asked for, and how it is written.
pub type Output<'a> = (Option<&'a Path>, &'a dyn Fn(&Path) -> io::Result<()>);

/// Refuses outputs that cannot be written, that are one file, or that are the input.
pub fn check<'a>(input: &'a Path, outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    check_beside([input], outputs)
}

/// Refuses outputs that cannot be written or that are one file.
pub fn check_outputs<'a>(outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    check_beside([], outputs)
}

/// Refuses outputs that cannot be written, that are one file, or that are one of the inputs.
pub fn check_beside<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let mut seen: Vec<PathBuf> = inputs.into_iter().map(resolved).collect();
    for path in outputs {
        if seen.contains(&resolved(path)) {
            let sentence = format_args!("{} cannot be two files at once", path.display()).to_string();
            return Err(Failure::bad_input(sentence, Some("the input and every output need names of their own")));
        }
        check_parent(path)?;
        seen.push(resolved(path));
    }
    Ok(())
}

/// The path without links and detours, as far as it exists: one name for one file.
fn resolved(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_parent = || Some(fs::canonicalize(parent).ok()?.join(path.file_name()?));
    fs::canonicalize(path).ok().or_else(in_parent).unwrap_or_else(|| path.to_owned())
}

fn check_parent(path: &Path) -> Result<(), Failure> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    match parent {
        Some(parent) if !parent.is_dir() => {
            Err(Failure::environment(format_args!("cannot write {}: there is no such folder", path.display())))
        }
        _ if path.is_dir() => {
            Err(Failure::bad_input(format_args!("{} is a folder; expected a file", path.display()), None))
        }
        _ => Ok(()),
    }
}

/// Tries to write all files that were asked for; the error is the first.
pub fn write_all(outputs: &[Output], quiet: bool) -> Result<(), Failure> {
    let mut all = Ok(());
    for (path, write) in outputs {
        let Some(path) = path else { continue };
        let written = write(path).map_err(|error| Failure::unwritable(path, &error));
        if written.is_ok() && !quiet {
            terminal::note(&format!("wrote {}", path.display()));
        }
        all = all.and(written);
    }
    all
}
