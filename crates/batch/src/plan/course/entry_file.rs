//! The file of an entry: the part of a scenario that the rules leave free.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value as TomlValue};

use super::rules_file::{Course, ProgramLimits};
use super::{CourseChange, CourseError, Leaf, fault, leaves, message_of, parse_toml, read_toml};
use crate::plan::TABLES_OF_PROGRAMS;
use crate::plan::free::is_price;
use wildfire_scenario::{Fault, FieldPath, PathStep};

/// The table of an entry's file that is no part of a scenario.
const ENTRY_TABLE: &str = "entry";

/// The most bytes of a name, and of all other texts of a card.
const MAX_NAME: usize = 40;
const MAX_CARD_BYTES: usize = 4000;

/// The most values of a file.
const MAX_VALUES: usize = 500;

/// The table `[entry]` of an entry's file: who enters, for those who read a board.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntryCard {
    /// The name under which it is ranked.
    pub name: String,
    /// As they wish to be named.
    #[serde(default)]
    pub authors: Vec<String>,
    #[serde(default)]
    pub licence: String,
    /// What it does, in a few sentences.
    #[serde(default)]
    pub about: String,
    /// The tracks of an arena that it enters.
    #[serde(default)]
    pub tracks: Vec<String>,
}

/// An entry's file that was read.
pub struct EntryFile {
    pub path: PathBuf,
    pub card: Option<EntryCard>,
    text: String,
    table: Table,
}

impl EntryCard {
    fn from_value(value: TomlValue) -> Result<Self, String> {
        let card: Self = value.try_into().map_err(|error: toml::de::Error| format!("[entry]: {}", error.message()))?;
        // Names become those of files and folders, which must not be hidden or lead elsewhere.
        if !(1..=MAX_NAME).contains(&card.name.len())
            || !card.name.chars().all(|letter| letter.is_ascii_alphanumeric() || "-+._".contains(letter))
            || card.name.starts_with('.')
        {
            let letters = "expected 1 to 40 letters, digits, `-`, `+`, `_` and `.`, not beginning with a dot";
            return Err(format!("[entry]: `name` is {:?}; {letters}", card.name));
        }
        let texts = [&card.licence, &card.about].into_iter().chain(&card.authors).chain(&card.tracks);
        match texts.map(String::len).sum::<usize>() > MAX_CARD_BYTES {
            true => Err(format!("[entry] is too long; expected at most {MAX_CARD_BYTES} bytes")),
            false => Ok(card),
        }
    }
}

impl EntryFile {
    pub fn read(path: &Path) -> Result<Self, CourseError> {
        let (text, table) = read_toml(path)?;
        Self::new(path, text, table)
    }

    /// Takes the text that is or might be the file at this path.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, CourseError> {
        Self::new(path, text.to_owned(), parse_toml(path, text)?)
    }

    fn new(path: &Path, text: String, mut table: Table) -> Result<Self, CourseError> {
        // Swapping the two files is the usual slip, and without this check the error would be about a key.
        if table.get("free").is_some_and(TomlValue::is_array) {
            return Err(fault(path, None, "it is a rules file; expected an entry"));
        }
        let card = match table.remove(ENTRY_TABLE) {
            Some(card) => Some(EntryCard::from_value(card).map_err(|message| {
                let line = FieldPath(vec![PathStep::key(ENTRY_TABLE)]).line_in(&text);
                fault(path, Some(line), &message)
            })?),
            None => None,
        };
        if table.is_empty() {
            return Err(fault(
                path,
                None,
                "it is empty; expected values that the rules leave free, such as [unimog] \
                planner",
            ));
        }
        Ok(Self { path: path.to_owned(), card, text, table })
    }

    /// The changes that it makes to the scenario of the rules under its name, or every value that these do not allow.
    pub fn changes(&self, course: &Course, name: &str) -> Result<Vec<CourseChange>, Vec<CourseError>> {
        let found = leaves(self.table.clone());
        if found.len() > MAX_VALUES {
            let message = format!("{} values are too many; expected at most {MAX_VALUES}", found.len());
            return Err(vec![fault(&self.path, None, &message)]);
        }
        let mut changes = Vec::new();
        let mut faults = Vec::new();
        // All faults are collected, so that an author mends a file in one go.
        for leaf in found {
            let line = leaf.line_in(&self.text);
            match change(&leaf, course) {
                Ok(Some(option)) => changes.push(CourseChange { option, line }),
                Ok(None) => {}
                Err(message) => faults.push(fault(&self.path, Some(line), &message)),
            }
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        // Programs are completed only now, so the faults above are about what is written in the file.
        changes.extend(self.changes_of_programs(&course.limits, name).map_err(|fault| vec![fault])?);
        Ok(changes)
    }

    /// Returns the changes that complete its programs: the limits that the file does not ask for, its folder, its walls, and
    /// whose they are: all of a class may have one name.
    fn changes_of_programs(
        &self,
        limits: &ProgramLimits,
        name_of_entry: &str,
    ) -> Result<Vec<CourseChange>, CourseError> {
        // `canonicalize` refuses an empty path.
        let entry_folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut changes = Vec::new();
        for list in TABLES_OF_PROGRAMS {
            let tables = self.table.get(list).and_then(TomlValue::as_table).into_iter().flatten();
            for (name, table) in tables {
                let Some(table) = table.as_table() else { continue };
                // Only the keys matter, for which a leaf needs some value.
                let at = Leaf { keys: vec![list.into(), name.clone()], value: TomlValue::Boolean(true) };
                let line = at.line_in(&self.text);
                let Some(key) = at.key() else {
                    let message = format!(
                        "`{name}` is not a valid name: expected 1 to 40 of a-z 0-9 + - _ . with a letter \
                            first"
                    );
                    return Err(fault(&self.path, Some(line), &message));
                };
                let folder = entry_folder.join(table.get("folder").and_then(TomlValue::as_str).unwrap_or_default());
                // Absolute, since a batch may be resumed from another folder.
                let folder = fs::canonicalize(&folder).map_err(|error| {
                    fault(&self.path, Some(line), &format!("its folder {}: {error}", folder.display()))
                })?;
                let folder = TomlValue::String(folder.to_string_lossy().into_owned());
                changes.push(CourseChange { option: format!("{key}.folder={folder}"), line });
                // A module needs no sandbox, as it reaches nothing but what it is handed.
                if table.contains_key("command") {
                    let label = TomlValue::String(name_of_entry.to_owned());
                    changes.push(CourseChange { option: format!("{key}.sandbox=true"), line });
                    changes.push(CourseChange { option: format!("{key}.label={label}"), line });
                }
                for limit in limits.configured().into_iter().filter(|limit| !table.contains_key(limit.key)) {
                    changes.push(CourseChange { option: format!("{key}.{}={}", limit.key, limit.value), line });
                }
            }
        }
        Ok(changes)
    }
}

/// The change that a value asks for, none of one that is found elsewhere, or why the rules do not allow it.
fn change(leaf: &Leaf, course: &Course) -> Result<Option<String>, String> {
    let free = &course.free;
    let rules = course.path.display();
    let written = leaf.keys.join(".");
    let steps: Vec<&str> = leaf.keys.iter().map(String::as_str).collect();
    // The likely mistake is named, not only that the key is fixed.
    if let (TomlValue::Array(list), false) = (&leaf.value, free.has(&steps))
        && list.iter().any(TomlValue::is_table)
    {
        let kind = &leaf.keys[0];
        return Err(format!("`{written}` is a list of tables; expected a table [{kind}], which applies to all agents"));
    }
    // Keys that are not free are refused one by one, so nothing that the rules fix can be changed by accident.
    if !free.has(&steps) {
        if let Some(unknown) = unknown_key(leaf, course) {
            return Err(unknown);
        }
        let why = if is_price(&steps) { "a price, and " } else { "" };
        return Err(format!("`{written}` is {why}fixed by the rules in {rules}"));
    }
    let Some(key) = leaf.key() else {
        return Err(format!(
            "`{written}` is not a key of a scenario: expected letters, digits, `-`, `+`, `_` and `.` in its steps"
        ));
    };
    let is_of_program = TABLES_OF_PROGRAMS.contains(&steps[0]) && steps.len() == 3;
    match steps.last() {
        Some(&"sandbox") if is_of_program && leaf.value.as_bool() != Some(true) => {
            return Err(format!(
                "`{written}` is {}; in a course programs run in a sandbox where there is one",
                leaf.value
            ));
        }
        Some(&"reuse") if is_of_program && leaf.value.as_bool() != Some(false) => {
            return Err(format!("`{written}` is {}; in a course every run has its own process", leaf.value));
        }
        // Folders are made paths that hold wherever the batch is resumed, and labels are the names of entries.
        Some(&("folder" | "label")) if is_of_program && leaf.value.is_str() => return Ok(None),
        Some(last) if is_of_program => {
            let limit = course.limits.configured().into_iter().find(|limit| limit.key == *last);
            if let Some(limit) = limit {
                let requested = leaf.value.as_float().or_else(|| leaf.value.as_integer().map(|whole| whole as f64));
                // A limit may be stricter than the rules ask for, but not more generous.
                if !requested.is_some_and(|requested| limit.admits(requested)) {
                    let bound = if limit.is_most { "at most" } else { "at least" };
                    let requested = &leaf.value;
                    return Err(format!("`{written}` is {requested}; the rules allow {bound} {}", limit.value));
                }
            }
        }
        _ => {}
    }
    Ok(Some(leaf.change(&key)))
}

/// Says of a key that no scenario has that it is unknown, and which is near; `None` of one that the rules fix.
fn unknown_key(leaf: &Leaf, course: &Course) -> Option<String> {
    let changes: Vec<String> = course.changes.iter().cloned().chain([leaf.change(&leaf.key()?)]).collect();
    let error = course.scenario(&changes).err()?;
    matches!(error.fault, Fault::UnknownField { .. }).then(|| message_of(&error))
}
