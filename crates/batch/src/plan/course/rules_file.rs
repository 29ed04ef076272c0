//! The rules file of a course.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use toml::{Table, Value as TomlValue};

use super::grading_rules::{GradingFault, GradingRules};
use super::{CourseError, Leaf, fault, leaves, message_of, read_toml, syntax};
use crate::plan::file::{SeedList, located};
use crate::plan::seeds::MAX_SEEDS_BYTES;
use crate::plan::{FreeKeys, MAX_FREE_KEYS, Record, Seeds};
use wildfire_base::input_file;
use wildfire_scenario::{FieldPath, LoadedScenario, MemoryLimit, Scenario, ScenarioError, ScenarioText};

/// The most conditions of a course.
const MAX_CONDITIONS: usize = 50;

/// The scenario that a rules file changes unless it names another: its values are all defaults.
const USUAL_SCENARIO: &str = "contest";

/// Wall clock of a query, in CPU seconds of it, where only these are limited; and the longest wall clock there is.
const WALL_OF_CPU: f64 = 10.0;
const LONGEST_WALL_S: f64 = 3600.0;

/// A rules file: the values that entries may set, and all fixed values.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RulesFile {
    /// Keys that entries may set, and all below them, such as `unimog.planner` and `planner.*`.
    free: Vec<String>,
    /// Seeds as a text or a list, or `@FILE` that holds them, from this file's folder.
    seeds: SeedList,
    #[serde(default)]
    limits: ProgramLimits,
    /// `from` is the name of a built-in scenario or a path from this file's folder, which the other keys change; without
    /// it, they are a whole scenario.
    #[serde(default)]
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    scenario: Table,
    /// Changes of the scenario by name; each entry plays under each of them.
    #[serde(default)]
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    conditions: Table,
    /// How `wildfire grade` marks entries.
    grading: Option<GradingRules>,
    record: Option<Record>,
    /// Memory limit of each run, such as `4GB`; 2 GB by default.
    memory: Option<String>,
}

/// Upper limits for an entry's program; lower limits for the charges `seconds_per_expansion` of every planner and
/// `expansions_per_query` of every program.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProgramLimits {
    start_limit_s: Option<f64>,
    query_limit_s: Option<f64>,
    query_cpu_s: Option<f64>,
    memory_limit_mb: Option<f64>,
    seconds_per_expansion: Option<f64>,
    expansions_per_query: Option<f64>,
    restarts: Option<f64>,
    query_instructions: Option<f64>,
    start_instructions: Option<f64>,
}

/// A limit of a course: the key of a program's table, and the value that it has unless an entry asks for less.
pub struct ProgramLimit {
    pub key: &'static str,
    pub value: f64,
    /// True if entries may ask for less and not for more; else it is the other way round.
    pub is_most: bool,
}

impl ProgramLimit {
    /// Says whether an entry may ask for a value.
    pub fn admits(&self, requested: f64) -> bool {
        if self.is_most { requested <= self.value } else { requested >= self.value }
    }
}

impl ProgramLimits {
    /// The limits that are given; where CPU time is limited, wall time is, at ten times it.
    pub fn configured(&self) -> Vec<ProgramLimit> {
        // Wall time is bounded too, as a program that sleeps takes no CPU time and would never be stopped.
        let wall = self.query_cpu_s.map(|cpu_s| (WALL_OF_CPU * cpu_s).min(LONGEST_WALL_S));
        let limits = [
            ("start_limit_s", self.start_limit_s, true),
            ("query_cpu_s", self.query_cpu_s, true),
            ("query_limit_s", self.query_limit_s.or(wall), true),
            ("memory_limit_mb", self.memory_limit_mb, true),
            // A price is a lower bound: who pays less for planning has an advantage.
            ("seconds_per_expansion", self.seconds_per_expansion, false),
            ("expansions_per_query", self.expansions_per_query, false),
            ("restarts", self.restarts, true),
            ("query_instructions", self.query_instructions, true),
            ("start_instructions", self.start_instructions, true),
        ];
        limits
            .into_iter()
            .filter_map(|(key, value, is_most)| Some(ProgramLimit { key, value: value?, is_most }))
            .collect()
    }
}

/// What changes in the scenario while all else of the rules stays.
#[derive(Clone, Debug, Default)]
pub struct Condition {
    pub name: String,
    pub changes: Vec<String>,
}

/// A rules file that was read and checked.
pub struct Course {
    pub path: PathBuf,
    pub free: FreeKeys,
    /// The same as they are written.
    pub free_keys: Vec<String>,
    pub limits: ProgramLimits,
    pub grading: Option<GradingRules>,
    pub record: Option<Record>,
    pub memory: MemoryLimit,
    /// Changes that make the scenario of the rules of `base`.
    pub changes: Vec<String>,
    /// One without a name if the rules have none.
    pub conditions: Vec<Condition>,
    base: ScenarioText,
    seeds: CourseSeeds,
}

enum CourseSeeds {
    Listed(Seeds),
    File(PathBuf),
}

/// The JSON Schema of rules files.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(RulesFile)
}

impl Course {
    /// Reads and checks the rules; a file of seeds is not read yet.
    pub fn read(path: &Path) -> Result<Self, CourseError> {
        let (text, _) = read_toml(path)?;
        Self::from_text(path, &text, None)
    }

    /// Checks the text of rules. Where it is given, `base` is what `from` names.
    pub fn from_text(path: &Path, text: &str, base: Option<ScenarioText>) -> Result<Self, CourseError> {
        let mut file: RulesFile = toml::from_str(text).map_err(|error| syntax(path, text, &error))?;
        let at = |key: &str, message: &str| fault(path, Some(FieldPath::parse(key).line_in(text)), message);
        if file.free.is_empty() {
            return Err(at("free", "`free` is empty, so entries could set nothing; expected at least one key"));
        }
        if file.free.len() > MAX_FREE_KEYS {
            let message = format!("{} keys are free; expected at most {MAX_FREE_KEYS}", file.free.len());
            return Err(at("free", &message));
        }
        let free = FreeKeys::parse(&file.free).map_err(|error| at("free", &error.to_string()))?;
        for limit in file.limits.configured() {
            // Half a restart and half an expansion mean nothing.
            let is_whole = limit.value.fract() == 0.0
                || !["memory_limit_mb", "restarts", "expansions_per_query", "query_instructions", "start_instructions"]
                    .contains(&limit.key);
            if !limit.value.is_finite() || limit.value < 0.0 || !is_whole {
                let message = format!("`{}` is {}; expected a number of at least 0", limit.key, limit.value);
                return Err(at(&format!("limits.{}", limit.key), &message));
            }
        }
        let memory = match &file.memory {
            None => MemoryLimit::default(),
            Some(size) => {
                size.parse().map_err(|reason: String| at("memory", &format!("`memory` is {size:?}; {reason}")))?
            }
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let seeds = match &file.seeds {
            SeedList::Text(text) if text.starts_with('@') => CourseSeeds::File(folder.join(&text[1..])),
            seeds => CourseSeeds::Listed(seeds.parse().map_err(|error| at("seeds", &error.to_string()))?),
        };
        let (base, rules) = match base {
            Some(base) => {
                file.scenario.remove("from");
                (base, leaves(file.scenario).into_iter().map(|leaf| (leaf, true)).collect())
            }
            None => scenario_of(file.scenario, folder, path, &at)?,
        };
        let change = |table: &str, leaf: &Leaf, is_explicit: bool| {
            let line = format!("{table}.{}", leaf.keys.join("."));
            let key = leaf
                .key()
                .ok_or_else(|| at(&line, &format!("`{}` is not a key of a scenario", leaf.keys.join("."))))?;
            // An agent's value would silently replace that of the rules.
            if is_explicit && frees_within(&free, leaf) {
                let message = format!("`{key}` is both set by [{table}] and free; expected one of them");
                return Err(at(&line, &message));
            }
            Ok(leaf.change(&key))
        };
        let changes = rules.iter().map(|(leaf, is_explicit)| change("scenario", leaf, *is_explicit));
        let changes = changes.collect::<Result<Vec<String>, _>>()?;
        let mut conditions = Vec::new();
        for (name, values) in file.conditions {
            let table = format!("conditions.{name}");
            let TomlValue::Table(values) = values else {
                return Err(at(&table, &format!("`{table}` is {values}; expected a table of values of the scenario")));
            };
            let changes = leaves(values).iter().map(|leaf| change(&table, leaf, true)).collect::<Result<_, _>>()?;
            conditions.push(Condition { name, changes });
        }
        if conditions.len() > MAX_CONDITIONS {
            let message = format!("{} conditions are too many; expected at most {MAX_CONDITIONS}", conditions.len());
            return Err(at("conditions", &message));
        }
        // There is one condition without a name, so courses with and without conditions take the same path.
        if conditions.is_empty() {
            conditions.push(Condition::default());
        }
        if let Some(Err(GradingFault { key, message })) = file.grading.as_ref().map(GradingRules::check) {
            return Err(at(&format!("grading.{key}"), &message));
        }
        let (limits, record) = (file.limits, file.record);
        let mut course = Self {
            path: path.to_owned(),
            free,
            free_keys: file.free,
            limits,
            grading: file.grading,
            record,
            memory,
            changes,
            conditions,
            base,
            seeds,
        };
        // The rules are loaded now, so a fault of theirs is reported as theirs and not as every agent's.
        let scenario = course.scenario(&course.changes).map_err(|error| {
            let changed = course.changes.iter().zip(&rules);
            let key = changed
                .into_iter()
                .find(|(change, _)| error.location.as_ref().is_some_and(|place| place.is_in(change)))
                .map(|(_, (leaf, _))| leaf.keys.join("."));
            let line = key.map(|key| FieldPath::parse(&format!("scenario.{key}")).line_in(text));
            fault(path, line, &message_of(&error))
        })?;
        // Each condition is loaded too: it may contradict the scenario only together with its other values.
        for Condition { name, changes } in &course.conditions {
            let changes = [&course.changes[..], changes].concat();
            course.scenario(&changes).map_err(|error| at(&format!("conditions.{name}"), &message_of(&error)))?;
        }
        // Every planner pays alike, whichever table is its own.
        let charged = scenario.unimog.iter().map(|truck| truck.seconds_per_expansion);
        if let Some(min) = course.limits.seconds_per_expansion
            && charged.clone().any(|charge| charge < min)
        {
            // The highest price of the trucks holds for all, so that no table of the scenario becomes cheaper by the limit.
            let price = charged.fold(min, f64::max);
            course.changes.push(format!("unimog.seconds_per_expansion={price}"));
            course
                .scenario(&course.changes)
                .map_err(|error| at("limits.seconds_per_expansion", &message_of(&error)))?;
        }
        Ok(course)
    }

    /// The seeds, read from their file if they are in one.
    pub fn seeds(&self) -> Result<Seeds, CourseError> {
        let path = match &self.seeds {
            CourseSeeds::Listed(seeds) => return Ok(seeds.clone()),
            CourseSeeds::File(path) => path,
        };
        let text = input_file::read_text(path, MAX_SEEDS_BYTES).map_err(|error| {
            let seeds = path.display();
            let message = format!("its seeds in {seeds} cannot be read: {error}; --seeds takes others");
            CourseError { unreadable: Some(error.kind()), ..fault(&self.path, None, &message) }
        })?;
        Seeds::from_file_text(&text).map_err(|error| fault(path, None, &error.to_string()))
    }

    /// The scenario with these changes, which begin with those of the rules.
    pub fn scenario(&self, changes: &[String]) -> Result<Scenario, Box<ScenarioError>> {
        LoadedScenario::from_text(&self.base, changes).map(|loaded| loaded.scenario)
    }

    /// Whether entries play under conditions that have names.
    pub fn has_conditions(&self) -> bool {
        self.conditions.iter().any(|condition| !condition.name.is_empty())
    }

    /// The name or path of the scenario that the rules change.
    pub fn source(&self) -> &str {
        &self.base.source
    }
}

/// Says whether some value that a leaf of the rules sets is free. A list of agents is looked into.
fn frees_within(free: &FreeKeys, leaf: &Leaf) -> bool {
    fn within(free: &FreeKeys, steps: &mut Vec<String>, value: &TomlValue) -> bool {
        let path: Vec<&str> = steps.iter().map(String::as_str).collect();
        // This comes before looking inside: a free table frees all that is below it.
        if free.has(&path) {
            return true;
        }
        let inner: Vec<(String, &TomlValue)> = match value {
            TomlValue::Table(table) => table.iter().map(|(key, value)| (key.clone(), value)).collect(),
            TomlValue::Array(list) => list.iter().enumerate().map(|(at, value)| (at.to_string(), value)).collect(),
            _ => Vec::new(),
        };
        inner.into_iter().any(|(step, value)| {
            steps.push(step);
            let found = within(free, steps, value);
            steps.pop();
            found
        })
    }
    within(free, &mut leaf.keys.clone(), &leaf.value)
}

/// The scenario that `[scenario]` names, and the values that change it, each with whether the file gives it.
///
/// Without `from` it is a whole scenario: what it does not give has its default, and there are no other agents. So that a
/// command line can say the same, it is the usual scenario with everything replaced.
fn scenario_of(
    mut table: Table,
    folder: &Path,
    path: &Path,
    at: &dyn Fn(&str, &str) -> CourseError,
) -> Result<(ScenarioText, Vec<(Leaf, bool)>), CourseError> {
    // Paths of a file are from its folder, wherever the program is started.
    if let Some(TomlValue::String(map)) = table.get_mut("field").and_then(|field| field.get_mut("map")) {
        *map = folder.join(&*map).to_string_lossy().into_owned();
    }
    let open = |source: &str| ScenarioText::open(source).map_err(|error| at("scenario.from", &message_of(&error)));
    match table.remove("from") {
        Some(TomlValue::String(source)) => {
            Ok((open(&located(&source, folder))?, leaves(table).into_iter().map(|leaf| (leaf, true)).collect()))
        }
        Some(other) => Err(at("scenario.from", &format!("`from` is {other}; expected a name or a path as a text"))),
        None if table.is_empty() => Ok((open(USUAL_SCENARIO)?, Vec::new())),
        None => {
            let base = open(USUAL_SCENARIO)?;
            let replaced: Table = toml::from_str(&base.text).expect("a built-in scenario is TOML");
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            // Without a name of its own it would be called `contest` in every table.
            table.entry("name").or_insert(TomlValue::String(stem));
            let emptied =
                replaced.into_iter().filter(|(key, _)| !table.contains_key(key)).filter_map(|(key, value)| {
                    let nothing = match value {
                        TomlValue::Table(_) => TomlValue::Table(Table::new()),
                        TomlValue::Array(_) => TomlValue::Array(Vec::new()),
                        _ => return None,
                    };
                    Some((Leaf { keys: vec![key], value: nothing }, false))
                });
            let emptied: Vec<(Leaf, bool)> = emptied.collect();
            // Whole tables, so that nothing of the scenario that is replaced stays.
            let whole = table.into_iter().map(|(key, value)| (Leaf { keys: vec![key], value }, true));
            Ok((base, emptied.into_iter().chain(whole).collect()))
        }
    }
}
