//! Courses: a rules file that fixes everything but what it frees, and the files of entries.
//!
//! ```toml
//! free = ["unimog.planner", "planner.*"]   # what entries may set, and all below
//! seeds = "@seeds.txt"                     # a file beside this one, or the seeds themselves
//!
//! [limits]                                 # of every entry
//! seconds_per_expansion = 0.0005
//!
//! [scenario]
//! from = "contest"                         # or a file; other keys change it
//! ```
//!
//! An entry's file is the part of a scenario that is free. Each entry is a variant of the plan, with its name in the
//! column [`ENTRY_COLUMN`]: the scenario of the rules with the entry's values as changes, so that any run can be repeated
//! by itself. Under `[conditions]`, if there are any, each entry plays the scenario with the values of each of them, and the
//! name of the condition is in the column [`CONDITION_COLUMN`].

mod entry_file;
mod grading_rules;
mod rules_file;

use std::collections::BTreeSet;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde_json::Value as Json;
use thiserror::Error;
use toml::{Table, Value as TomlValue};

use super::request::{MAX_PLAN_BYTES, RUNS_WITHOUT_FORCE};
use super::{
    BatchPlan, ENTRY_COLUMN, FreeParameters, MAX_RUNS, Record, RequestError, Seeds, Value, Variant, kept_program,
    rules_of,
};
pub use entry_file::EntryCard;
pub(crate) use entry_file::EntryFile;
pub use grading_rules::GradingRules;
use rules_file::Condition;
pub(crate) use rules_file::Course;
pub use rules_file::schema as rules_schema;
use wildfire_scenario::{FieldPath, MAX_SCENARIO_BYTES, PathStep, first_too_deep, value_differences};

/// The column with the name of the condition under which an entry plays.
pub const CONDITION_COLUMN: &str = "condition";

/// The usual name of an entry's file, in a folder of its own.
pub(crate) const ENTRY_FILE: &str = "entry.toml";

/// The most entries of a course.
const MAX_ENTRIES: usize = 100;

/// A fault of a rules file, or of an entry's.
#[derive(Debug, Error)]
#[error("{}: {message}", RulesPlace(path, *line))]
pub struct CourseError {
    pub path: PathBuf,
    /// Counted from 1; `None` if the fault is not in a line.
    pub line: Option<usize>,
    pub message: String,
    /// The kind of error, if a file could not be read.
    pub unreadable: Option<ErrorKind>,
}

/// Reads the table `[entry]` of an entry's file; `None` if it has none.
pub fn read_card(path: &Path) -> Result<Option<EntryCard>, CourseRefusal> {
    EntryFile::read(path).map(|entry| entry.card).map_err(|error| CourseRefusal::Entries(vec![error]))
}

struct RulesPlace<'a>(&'a Path, Option<usize>);

impl fmt::Display for RulesPlace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.1 {
            Some(line) => write!(f, "{}:{line}", self.0.display()),
            None => write!(f, "{}", self.0.display()),
        }
    }
}

/// A reason for which a course makes no plan.
#[derive(Debug, Error)]
pub enum CourseRefusal {
    #[error(transparent)]
    Rules(CourseError),
    #[error("{} errors in entry files, the first: {}", .0.len(), .0[0])]
    Entries(Vec<CourseError>),
    #[error(transparent)]
    Request(RequestError),
    #[error("{count} entries are too many; expected at most {MAX_ENTRIES}")]
    TooManyEntries { count: usize },
}

/// A course and its entries as they are asked for.
#[derive(Clone, Debug, Default)]
pub struct CourseRequest {
    pub rules: PathBuf,
    pub entries: Vec<PathBuf>,
    /// Seeds in the place of those of the rules.
    pub seeds: Option<Seeds>,
    pub record: Option<Record>,
    /// True if entries whose files are refused are left out, and the others run.
    pub skips_refused: bool,
}

/// The plan of a course.
#[derive(Debug)]
pub struct CoursePlan {
    pub plan: BatchPlan,
    /// Faults of entries that are left out.
    pub left_out: Vec<CourseError>,
}

impl CourseRequest {
    /// Reads all files and makes the plan. More than [`RUNS_WITHOUT_FORCE`] runs must be insisted on.
    ///
    /// # Errors
    /// If the rules are refused, or all entries are, or one is and it may not be left out.
    pub fn resolve(&self, force: bool) -> Result<CoursePlan, CourseRefusal> {
        if self.entries.len() > MAX_ENTRIES {
            return Err(CourseRefusal::TooManyEntries { count: self.entries.len() });
        }
        self.resolve_by(&Course::read(&self.rules).map_err(CourseRefusal::Rules)?, &EntryFile::read, force)
    }

    /// The same by rules that were read, with entries that `read` reads.
    pub(crate) fn resolve_by(
        &self,
        course: &Course,
        read: &dyn Fn(&Path) -> Result<EntryFile, CourseError>,
        force: bool,
    ) -> Result<CoursePlan, CourseRefusal> {
        let seeds = match &self.seeds {
            Some(seeds) => seeds.clone(),
            None => course.seeds().map_err(CourseRefusal::Rules)?,
        };
        let mut variants = Vec::new();
        let mut left_out = Vec::new();
        let mut bytes = 0;
        let mut shared: Vec<SharedRules> = course.conditions.iter().map(|_| SharedRules::default()).collect();
        for (path, name) in self.entries.iter().zip(self.names()) {
            let found = name.map_err(|error| vec![error]).and_then(|name| {
                let entry = read(path).map_err(|error| vec![error])?;
                let name = entry.card.as_ref().map_or(name, |card| card.name.clone());
                let variants = course.conditions.iter().zip(&mut shared).map(|(condition, shared)| {
                    // The whole scenario is built, as some values are valid only together with others.
                    let variant = course.variant(&entry, &name, condition)?;
                    let admitted = shared.admit(course, &variant, name.clone());
                    admitted.map_err(|message| vec![fault(path, None, &message)])?;
                    Ok(variant)
                });
                variants.collect::<Result<Vec<Variant>, _>>()
            });
            match found {
                Ok(found) => {
                    bytes += found.iter().map(Variant::bytes).sum::<u64>();
                    variants.extend(found);
                }
                Err(faults) => left_out.extend(faults),
            }
        }
        // Agents with faults are skipped only if that is asked for: a contest should not lose an entry silently.
        if variants.is_empty() || !self.skips_refused && !left_out.is_empty() {
            return Err(CourseRefusal::Entries(left_out));
        }
        // The product takes 128 bits: a range of seeds may reach to 2^64, and the variants would make it overflow.
        let count = u128::from(seeds.count()) * variants.len() as u128;
        let refused = match () {
            () if count > MAX_RUNS.into() => Some(RequestError::TooManyRuns { count }),
            // A larger number needs consent, since a mistyped range is easily a million runs.
            () if count > RUNS_WITHOUT_FORCE.into() && !force => Some(RequestError::ManyRuns { count }),
            () if bytes + seeds.to_string().len() as u64 > MAX_PLAN_BYTES => Some(RequestError::TooLarge),
            () => None,
        };
        if let Some(refusal) = refused {
            return Err(CourseRefusal::Request(refusal));
        }
        let record = self.record.or(course.record).unwrap_or_default();
        let mut swept_keys = vec![ENTRY_COLUMN.to_owned()];
        swept_keys.extend(course.has_conditions().then(|| CONDITION_COLUMN.to_owned()));
        Ok(CoursePlan {
            plan: BatchPlan {
                variants,
                swept_keys,
                seeds,
                record,
                memory: course.memory,
                free: course.free_keys.clone(),
                until: None,
            },
            left_out,
        })
    }

    /// Names the entries: by their files' names without the ending, those of `entry.toml` by their folders, or by their paths
    /// where those are not distinct.
    fn names(&self) -> Vec<Result<String, CourseError>> {
        let short_names: BTreeSet<String> = self.entries.iter().map(|path| short_name(path)).collect();
        let are_distinct = short_names.len() == self.entries.len();
        let names = self.entries.iter().enumerate().map(|(index, path)| {
            if self.entries[..index].contains(path) {
                return Err(fault(path, None, "it is named twice; expected every entry once"));
            }
            Ok(if are_distinct { short_name(path) } else { path.with_extension("").to_string_lossy().into_owned() })
        });
        names.collect()
    }
}

fn short_name(path: &Path) -> String {
    let folder = path.parent().and_then(Path::file_name).filter(|_| path.ends_with(ENTRY_FILE));
    folder.or(path.file_stem()).unwrap_or_default().to_string_lossy().into_owned()
}

impl Course {
    /// The variant of an entry under a condition, or all that its file is refused for.
    fn variant(&self, entry: &EntryFile, name: &str, condition: &Condition) -> Result<Variant, Vec<CourseError>> {
        let mut changes = [&self.changes[..], &condition.changes].concat();
        let changes_of_entry = entry.changes(self, name)?;
        changes.extend(changes_of_entry.iter().map(|change| change.option.clone()));
        let scenario = self.scenario(&changes).map_err(|error| {
            let line = changes_of_entry
                .iter()
                .find(|change| error.location.as_ref().is_some_and(|place| place.is_in(&change.option)))
                .map(|change| change.line);
            vec![fault(&entry.path, line, &message_of(&error))]
        })?;
        let mut swept = vec![Value::Text(name.to_owned())];
        swept.extend(self.has_conditions().then(|| Value::Text(condition.name.clone())));
        Ok(Variant { source: self.source().to_owned(), changes, swept, scenario })
    }
}

/// The first entry of a course, and the rules that it plays by, which all others must share to be ranked together.
#[derive(Default)]
struct SharedRules(Option<(String, Json)>);

impl SharedRules {
    /// Admits an entry, or says why a ranking would refuse it beside the first.
    fn admit(&mut self, course: &Course, variant: &Variant, name: String) -> Result<(), String> {
        let rules = course.path.display();
        let freed: Vec<&str> = course.free_keys.iter().map(String::as_str).collect();
        let freedom = FreeParameters::parse(&freed).map_err(|error| error.to_string())?;
        let scenario = serde_json::to_value(&variant.scenario).expect("scenarios hold names, numbers and lists only");
        // See `change`: rules that share processes between runs would do the same.
        if let Some(table) = kept_program(&scenario) {
            return Err(format!("{rules} sets `{table}.reuse` to true; in a course every run has its own process"));
        }
        let ours = rules_of(scenario, &freedom.keys);
        // The first entry is the reference, so that the error names two entries and not an abstract rule.
        let (first, theirs) = self.0.get_or_insert_with(|| (name, ours.clone()));
        let Some(difference) = value_differences(theirs, &ours).into_iter().next() else { return Ok(()) };
        // Numbers of agents are left out: the difference is one of rules, whichever truck shows it first.
        let steps: Vec<&str> = difference.key.split('.').filter(|step| step.parse::<usize>().is_err()).collect();
        let [theirs, ours] = difference.values.map(|value| value.map_or("nothing".into(), |value| value.to_string()));
        Err(format!(
            "its `{}` is {ours}, but {theirs} in {first}; expected [scenario] in {rules} to fix it for all",
            steps.join(".")
        ))
    }
}

/// The sentence of a scenario's fault, with what may help.
fn message_of(error: &wildfire_scenario::ScenarioError) -> String {
    let advice = error.fault.advice().map_or(String::new(), |advice| format!("; {advice}"));
    format!("{error}{advice}")
}

/// A change as `--set` takes it, and the line of the file that asks for it.
pub(crate) struct CourseChange {
    option: String,
    line: usize,
}

/// A value of a table, with the keys that lead to it.
struct Leaf {
    keys: Vec<String>,
    value: TomlValue,
}

impl Leaf {
    /// The key as `--set` takes it; `None` if one of its steps cannot be written so.
    fn key(&self) -> Option<String> {
        let steps = self.keys.iter().map(|key| match key {
            key if key.is_empty() => None,
            key if key.chars().all(is_plain) => Some(key.clone()),
            // Names of planners and policies may have dots.
            key if key.chars().all(|letter| is_plain(letter) || letter == '.') => Some(format!("\"{key}\"")),
            _ => None,
        });
        Some(steps.collect::<Option<Vec<_>>>()?.join("."))
    }

    fn line_in(&self, text: &str) -> usize {
        FieldPath(self.keys.iter().map(|key| PathStep::key(key)).collect()).line_in(text)
    }

    fn change(&self, key: &str) -> String {
        format!("{key}={}", self.value)
    }
}

fn is_plain(letter: char) -> bool {
    letter.is_alphanumeric() || "_-+".contains(letter)
}

/// The values of a table. What is below [planner.NAME] and [policy.NAME] is a value whatever it is: settings are any keys.
fn leaves(table: Table) -> Vec<Leaf> {
    fn collect(keys: &[String], table: Table, found: &mut Vec<Leaf>) {
        for (key, value) in table {
            let keys = [keys, &[key]].concat();
            let is_below_program = keys.len() >= 3 && ["planner", "policy"].contains(&keys[0].as_str());
            match value {
                TomlValue::Table(inner) if !is_below_program && !inner.is_empty() => collect(&keys, inner, found),
                value => found.push(Leaf { keys, value }),
            }
        }
    }
    let mut found = Vec::new();
    collect(&[], table, &mut found);
    found
}

pub(crate) fn fault(path: &Path, line: Option<usize>, message: &str) -> CourseError {
    CourseError { path: path.to_owned(), line, message: message.to_owned(), unreadable: None }
}

/// Reads a file as TOML that does not nest too deep.
fn read_toml(path: &Path) -> Result<(String, Table), CourseError> {
    let text = wildfire_base::input_file::read_text(path, MAX_SCENARIO_BYTES).map_err(|error| {
        let message = match error.kind() {
            ErrorKind::NotFound => "the file does not exist".to_owned(),
            _ => format!("it cannot be read: {error}"),
        };
        CourseError { unreadable: Some(error.kind()), ..fault(path, None, &message) }
    })?;
    let table = parse_toml(path, &text)?;
    Ok((text, table))
}

fn parse_toml(path: &Path, text: &str) -> Result<Table, CourseError> {
    if let Some(at) = first_too_deep(text) {
        return Err(fault(path, Some(line_at(text, at)), "this is not TOML: too many brackets and braces are open"));
    }
    toml::from_str(text).map_err(|error: toml::de::Error| syntax(path, text, &error))
}

fn syntax(path: &Path, text: &str, error: &toml::de::Error) -> CourseError {
    let line = error.span().map(|span| line_at(text, span.start));
    fault(path, line, error.message())
}

fn line_at(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&byte| byte == b'\n').count()
}
