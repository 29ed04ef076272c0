//! Where scenarios come from: files and the built-in ones.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::error::{Fault, ScenarioError, nearest_name};
use crate::input_file;

/// The scenarios that are part of the program, by name, with their text.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("contest", include_str!("../../scenarios/contest.toml")),
    ("report-2024", include_str!("../../scenarios/report-2024.toml")),
    ("coursework-2025", include_str!("../../scenarios/coursework-2025.toml")),
    ("original-2024", include_str!("../../scenarios/original-2024.toml")),
    ("dense", include_str!("../../scenarios/dense.toml")),
    ("cautious", include_str!("../../scenarios/cautious.toml")),
    ("wumpus-alone", include_str!("../../scenarios/wumpus-alone.toml")),
    ("local-minima", include_str!("../../scenarios/local-minima.toml")),
    ("unimog-alone", include_str!("../../scenarios/unimog-alone.toml")),
    ("fleet", include_str!("../../scenarios/fleet.toml")),
    ("smoke", include_str!("../../scenarios/smoke.toml")),
];

/// Longest scenario or plan file that is read, and the most brackets and braces that open in it. Reading TOML was
/// measured to take up to 80 bytes for a byte of text, and 2.4 KB for a table: together about 64 MiB.
pub const MAX_SCENARIO_BYTES: u64 = 350_000;
const MAX_BRACKETS: usize = 24_000;

/// Longest map that is read.
pub const MAX_MAP_BYTES: u64 = 16_000_000;

/// The text of a scenario and what to call it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioText {
    /// The source as it was asked for: a built-in name, or a path.
    pub source: String,
    /// As messages name it: the path, or the file's name in the program's `scenarios` folder.
    pub(super) name: String,
    /// The scenario's name unless its text gives one.
    pub(super) stem: String,
    pub text: String,
    /// The folder that paths in the text start from.
    pub folder: PathBuf,
}

impl ScenarioText {
    /// Reads a built-in scenario by its exact name, or else the input at this path.
    ///
    /// # Errors
    /// If there is none, or it cannot be read, or it is no text, or has more than [`MAX_SCENARIO_BYTES`].
    pub fn open(source: &str) -> Result<Self, Box<ScenarioError>> {
        if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == source) {
            let (name, stem) = (format!("scenarios/{name}.toml"), (*name).to_owned());
            let (source, text) = (source.to_owned(), (*text).to_owned());
            return Ok(Self { source, name, stem, text, folder: PathBuf::new() });
        }
        Self::from_bytes(source, input_file::read(Path::new(source), MAX_SCENARIO_BYTES))
    }

    /// Takes the bytes that were read at this path.
    ///
    /// # Errors
    /// If it could not be read, or is no text.
    pub fn from_bytes(source: &str, bytes: io::Result<Vec<u8>>) -> Result<Self, Box<ScenarioError>> {
        let path = Path::new(source);
        let text = bytes.and_then(within_limits).and_then(input_file::text).map_err(|error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => {
                let nearest = nearest_name(source, BUILT_IN.iter().map(|(name, _)| *name));
                Fault::NotFound { name: source.to_owned(), nearest }.nowhere()
            }
            _ => unreadable(path, &error).nowhere(),
        })?;
        let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { source: source.to_owned(), name: source.to_owned(), stem, text, folder })
    }
}

/// Refuses what would take too much memory to be parsed.
fn within_limits(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    if bytes.len() as u64 > MAX_SCENARIO_BYTES {
        return Err(input_file::too_large(MAX_SCENARIO_BYTES));
    }
    let brackets = bytes.iter().filter(|&&byte| byte == b'[' || byte == b'{').count();
    if brackets > MAX_BRACKETS {
        let reason = format!("{brackets} brackets and braces open in it; at most {MAX_BRACKETS} are expected");
        return Err(io::Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// Says whether the scenario of this name can be read once more: a built-in one, or a file. A pipe's text is gone.
pub fn can_be_read_again(source: &str) -> bool {
    BUILT_IN.iter().any(|(name, _)| *name == source) || fs::metadata(source).is_ok_and(|found| found.is_file())
}

/// The text of an input; one of more bytes than `most` is refused.
pub(super) fn read_text(path: &Path, most: u64) -> Result<String, Fault> {
    input_file::read_text(path, most).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &io::Error) -> Fault {
    Fault::Unreadable { path: path.display().to_string(), kind: error.kind(), reason: error.to_string() }
}
