//! Where scenarios come from: files and the built-in ones.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{Fault, ScenarioError, nearest_name};

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

/// Longest scenario that is read; a hundred times its length is what reading TOML takes.
pub const MAX_SCENARIO_BYTES: u64 = 2_000_000;

/// Longest map that is read.
pub const MAX_MAP_BYTES: u64 = 16_000_000;

/// What some editors write before a text; nobody sees it, and it is no part of the text.
const BYTE_ORDER_MARK: char = '\u{FEFF}';

/// The text of a scenario and what to call it.
pub(super) struct Source {
    /// As messages name it: the path, or the file's name in the program's `scenarios` folder.
    pub name: String,
    /// The scenario's name unless its text gives one.
    pub stem: String,
    pub text: String,
    /// The folder that paths in the text start from.
    pub folder: PathBuf,
}

impl Source {
    /// A built-in scenario by its exact name, or else the file at this path.
    pub fn open(source: &str) -> Result<Self, Box<ScenarioError>> {
        if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == source) {
            let (name, stem) = (format!("scenarios/{name}.toml"), (*name).to_owned());
            return Ok(Self { name, stem, text: (*text).to_owned(), folder: PathBuf::new() });
        }
        let path = Path::new(source);
        if !path.exists() {
            let nearest = nearest_name(source, BUILT_IN.iter().map(|(name, _)| *name));
            return Err(Fault::NotFound { name: source.to_owned(), nearest }.nowhere());
        }
        let text = read_text(path, MAX_SCENARIO_BYTES).map_err(Fault::nowhere)?;
        let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { name: source.to_owned(), stem, text, folder })
    }
}

/// A file's text without a byte order mark; one of more bytes than `most` is refused.
pub(super) fn read_text(path: &Path, most: u64) -> Result<String, Fault> {
    let shown = path.display().to_string();
    let unreadable = |error: std::io::Error| Fault::Unreadable { path: shown.clone(), reason: error.to_string() };
    if fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(Fault::Folder { path: shown });
    }
    let mut bytes = Vec::new();
    // A device or pipe states no length, so the reading itself is bounded.
    File::open(path).map_err(unreadable)?.take(most + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > most {
        return Err(Fault::TooLarge { path: shown, megabytes: most / 1_000_000 });
    }
    let mut text = String::from_utf8(bytes)
        .map_err(|error| Fault::NotText { path: shown, byte: error.utf8_error().valid_up_to() })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.remove(0);
    }
    Ok(text)
}
