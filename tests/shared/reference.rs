//! Answers of independent tools: those in `tests/data/reference`, which must be there, and a larger collection of the
//! same shape where the variable `WILDFIRE_REFERENCE` says. Its parts that are missing are named.

use std::iter;
use std::path::{Path, PathBuf};

/// Finds a file or a folder of this package's answers.
pub fn bundled(part: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference").join(part);
    assert!(path.exists(), "{} is missing; tests/data/reference/make.py makes it", path.display());
    path
}

/// Finds a file or a folder of the larger collection; `None`, after printing that it is left out, where it is not.
#[expect(clippy::print_stdout, reason = "says why nothing was compared")]
pub fn larger(part: &str) -> Option<PathBuf> {
    let Some(root) = std::env::var_os("WILDFIRE_REFERENCE") else {
        println!("left out: {part}, as WILDFIRE_REFERENCE is not set");
        return None;
    };
    let path = PathBuf::from(root).join(part);
    if !path.exists() {
        println!("left out: {part}, as {} does not exist", path.display());
        return None;
    }
    Some(path)
}

/// Finds a file or a folder in both.
pub fn both(part: &str) -> impl Iterator<Item = PathBuf> {
    iter::once(bundled(part)).chain(larger(part))
}
