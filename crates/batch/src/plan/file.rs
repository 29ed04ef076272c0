//! Plan files: what a batch is asked to do, in TOML.
//!
//! ```toml
//! scenarios = ["contest", "mine.toml"]    # names, or paths from this file's folder
//! seeds = "1..1000"                       # or a list of numbers
//! planners = ["prm-rs", "hybrid-astar"]
//! set = { fire.relight = true }
//!
//! [[sweep]]
//! field.coverage = [0.05, 0.10, 0.20]
//!
//! [[sweep]]                               # times the other; these two take their values together
//! unimog.speed_mps = [6, 10]
//! wumpus.speed_mps = [1, 2]
//!
//! [[sweep]]                               # a column for each key, a row for each variant
//! from = "design.csv"
//! ```

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use toml::{Table, Value};

use super::design::{DesignError, read_design};
use super::request::PlanFileError;
use super::sweep::SweepError;
use super::{BatchRequest, Record, RequestError, Seeds, SeedsError, Setting, Sweep};
use wildfire_scenario::{BUILT_IN, ScenarioText, first_too_deep};

/// A plan file with comments, to begin with.
pub const PLAN_TEMPLATE: &str = include_str!("template.toml");

/// Keys that a plan file has at its top, and a scenario never has.
pub const PLAN_KEYS: [&str; 7] = ["scenarios", "seeds", "planners", "set", "sweep", "record", "memory"];

/// A plan file: the runs of a batch.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    /// Names of built-in scenarios, or paths from this file's folder; `contest` if there are none.
    scenarios: Option<Vec<String>>,
    /// 1 to 5 if there are none.
    seeds: Option<SeedList>,
    /// Planners of the trucks, one after the other.
    #[serde(default)]
    planners: Vec<String>,
    /// Values changed in all scenarios.
    #[serde(default)]
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    set: Table,
    /// Keys with lists of values, or `from` with the path of a CSV file that has a column for each key; keys of one table
    /// take their values together, tables are multiplied.
    #[serde(default)]
    #[schemars(with = "Vec<serde_json::Map<String, serde_json::Value>>")]
    sweep: Vec<Table>,
    record: Option<Record>,
    /// Memory limit of each run, such as `4GB` or `512MiB`; 2 GB by default.
    memory: Option<String>,
}

/// A text such as `1..1000` or `1,5,9`, ranges with both ends; or a list of numbers.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected seeds as a text such as \"1..1000\", or as a list of whole numbers")]
pub(super) enum SeedList {
    Text(String),
    Numbers(Vec<u64>),
}

/// The JSON Schema of plan files.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(PlanFile)
}

/// The request of a plan file; `None` if the text is no plan.
///
/// A text is a plan if it has one of the keys of plans at its top, which no scenario has.
fn read(source: &ScenarioText) -> Result<Option<BatchRequest>, PlanFileError> {
    // Text that nests too deep is left to the reader of scenarios, who refuses it with its place.
    if first_too_deep(&source.text).is_some()
        || !toml::from_str(&source.text).is_ok_and(|table: Table| PLAN_KEYS.iter().any(|key| table.contains_key(*key)))
    {
        return Ok(None);
    }
    let file: PlanFile = toml::from_str(&source.text).map_err(|error| syntax(&source.source, &source.text, &error))?;
    file.into_request(&source.folder).map(Some).map_err(|fault| fault.at(&source.source))
}

fn syntax(path: &str, text: &str, error: &toml::de::Error) -> PlanFileError {
    let at = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = 1 + text.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count();
    PlanFileError::Syntax { path: path.to_owned(), line, message: error.message().to_owned() }
}

enum PlanFileProblem {
    Wrong(String),
    Seeds(SeedsError),
    Sweep(SweepError),
    Design { path: String, source: DesignError },
}

impl From<SweepError> for PlanFileProblem {
    fn from(error: SweepError) -> Self {
        Self::Sweep(error)
    }
}

impl PlanFileProblem {
    fn at(self, path: &str) -> PlanFileError {
        let path = path.to_owned();
        match self {
            Self::Wrong(reason) => PlanFileError::Wrong { path, reason },
            Self::Seeds(source) => PlanFileError::Seeds { path, source },
            Self::Sweep(source) => PlanFileError::Sweep { path, source },
            Self::Design { path, source } => PlanFileError::Design { path, source },
        }
    }
}

impl BatchRequest {
    /// Reads the request of a plan file; `None` if the text is a scenario, or cannot be read as TOML at all.
    pub fn from_text(text: &ScenarioText) -> Result<Option<Self>, RequestError> {
        Ok(read(text)?)
    }
}

impl PlanFile {
    fn into_request(self, folder: &Path) -> Result<BatchRequest, PlanFileProblem> {
        let scenarios = self.scenarios.unwrap_or_else(|| vec!["contest".into()]);
        if scenarios.is_empty() {
            return Err(PlanFileProblem::Wrong("`scenarios` is empty; expected at least one name or path".into()));
        }
        let seeds = self.seeds.as_ref().map(SeedList::parse).transpose().map_err(PlanFileProblem::Seeds)?;
        let changes = leaves(self.set).into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        let sweeps = self.sweep.into_iter().map(|table| sweep_of(table, folder)).collect::<Result<_, _>>()?;
        let scenarios = scenarios.iter().map(|name| located(name, folder)).collect();
        let memory = self.memory.map(|size| size.parse().map_err(|reason| wrong_memory(&size, reason))).transpose()?;
        let mut request =
            BatchRequest { scenarios, changes, sweeps, seeds, record: self.record, memory, ..BatchRequest::default() };
        request.add_planners(&self.planners)?;
        Ok(request)
    }
}

impl SeedList {
    pub(super) fn parse(&self) -> Result<Seeds, SeedsError> {
        match self {
            Self::Text(text) => text.parse(),
            Self::Numbers(numbers) => numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(",").parse(),
        }
    }
}

fn wrong_memory(size: &str, reason: String) -> PlanFileProblem {
    PlanFileProblem::Wrong(format!("`memory` is {size:?}; {reason}"))
}

/// A built-in scenario's name as it is, a path from the plan's folder.
pub(super) fn located(name: &str, folder: &Path) -> String {
    let is_built_in = BUILT_IN.iter().any(|(existing, _)| *existing == name);
    if is_built_in { name.to_owned() } else { folder.join(name).to_string_lossy().into_owned() }
}

fn sweep_of(table: Table, folder: &Path) -> Result<Sweep, PlanFileProblem> {
    if let Some(Value::String(name)) = table.get("from") {
        // A design has its own columns; further keys beside it could mean a product or the same rows.
        if table.len() > 1 {
            let reason =
                "a [[sweep]] with `from` has other keys; expected them in the file's columns, or in a [[sweep]]";
            return Err(PlanFileProblem::Wrong(reason.into()));
        }
        let path = folder.join(name);
        let design = read_design(&path);
        return design.map_err(|source| PlanFileProblem::Design { path: path.display().to_string(), source });
    }
    let columns = leaves(table).into_iter().map(|(key, value)| match value {
        // A single value is no sweep; it belongs in `set`.
        Value::Array(values) => Ok((key, values.into_iter().map(Setting::from_toml).collect())),
        other => Err(PlanFileProblem::Wrong(format!("`{key}` of a sweep is {other}; expected a list of values"))),
    });
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    if columns.is_empty() {
        return Err(PlanFileProblem::Wrong("a [[sweep]] is empty; expected a key with a list of values".into()));
    }
    Ok(Sweep::together(columns)?)
}

/// Keys with dots between their steps, whether they were written so or as tables.
fn leaves(table: Table) -> Vec<(String, Value)> {
    let leaves = table.into_iter().flat_map(|(key, value)| match value {
        Value::Table(inner) => {
            leaves(inner).into_iter().map(|(rest, value)| (format!("{key}.{rest}"), value)).collect()
        }
        plain => vec![(key, plain)],
    });
    leaves.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_plan(text: &str) -> Result<Option<BatchRequest>, PlanFileError> {
        read(&ScenarioText::from_bytes("plan.toml", Ok(text.into())).expect("it is text"))
    }

    fn refusal(text: &str) -> String {
        read_plan(text).expect_err("this plan is wrong").to_string()
    }

    #[test]
    fn plan_file_says_what_the_command_line_says() {
        let text = "scenarios = ['smoke']\nseeds = '1..9'\nplanners = ['hybrid-astar', 'prm+primitives']\n\
                    record = 'all'\nset = { fire.relight = true }\n[[sweep]]\nfield.coverage = [0.05, 0.1]\n";
        let found = read_plan(text).expect("it is fine").expect("it is a plan");
        let mut expected = BatchRequest {
            scenarios: vec!["smoke".into()],
            seeds: "1..9".parse().ok(),
            record: Some(Record::All),
            ..BatchRequest::default()
        };
        for option in ["fire.relight=true", "field.coverage=0.05,0.1"] {
            expected.add_option(option).expect("an option");
        }
        expected.add_planners(&["hybrid-astar".into(), "prm+primitives".into()]).expect("two planners");
        assert_eq!(found, expected);
    }

    #[test]
    fn keys_of_one_sweep_go_together_and_sweeps_are_multiplied() {
        let text = "scenarios = ['smoke']\n[[sweep]]\n'fire.burn_out_s' = [30, 40]\n'fire.spread_delay_s' = [5, 6]\n\
                    [[sweep]]\nduration_s = [100, 200, 300]\n";
        let request = read_plan(text).expect("it is fine").expect("it is a plan");
        let plan = request.resolve(false).expect("six variants");
        let fires: Vec<_> = plan.variants.iter().map(|variant| &variant.scenario.fire).collect();
        let pairs: Vec<_> = fires.iter().map(|fire| (fire.burn_out_s, fire.spread_delay_s)).collect();
        assert_eq!(pairs, [[(Some(30.0), 5.0); 3], [(Some(40.0), 6.0); 3]].concat());
    }

    #[test]
    fn template_is_a_plan_as_it_stands() {
        let request = read_plan(PLAN_TEMPLATE).expect("it is fine").expect("it is a plan");
        assert_eq!(request.resolve(false).expect("its scenarios are built in").count(), 400);
    }

    #[test]
    fn scenarios_are_no_plans() {
        for (name, text) in BUILT_IN {
            assert_eq!(read_plan(text).expect("it is no plan"), None, "{name}");
        }
        assert_eq!(read_plan("this is not TOML").expect("it is no plan"), None);
    }

    #[test]
    fn paths_start_from_the_plan() {
        assert_eq!(located("contest", Path::new("a")), "contest");
        assert_eq!(located("mine.toml", Path::new("a/b")), "a/b/mine.toml");
        assert_eq!(located("/mine.toml", Path::new("a/b")), "/mine.toml");
    }

    #[test]
    fn faults_are_said_with_file_and_line() {
        assert!(refusal("seeds = '1..9'\nscenario = 'contest'\n").contains("plan.toml:2: unknown field `scenario`"));
        assert!(refusal("seeds = true").contains("plan.toml:1: expected seeds as a text"));
        assert!(refusal("seeds = '5..1'").contains("the range `5..1` is empty"));
        assert!(refusal("seeds = []").contains("whole numbers"));
        assert!(refusal("scenarios = []").contains("at least one name"));
        assert!(refusal("[[sweep]]\nfield.coverage = 0.1\n").contains("expected a list of values"));
        assert!(refusal("[[sweep]]\nfield.coverage = []\n").contains("`field.coverage` has no values"));
        assert!(refusal("[[sweep]]\n[[sweep]]\na = [1]\n").contains("is empty"));
        assert!(refusal("[[sweep]]\nfrom = 'missing.csv'\n").contains("missing.csv: cannot be read"));
        assert!(refusal("[[sweep]]\nfrom = 'design.csv'\na = [1]\n").contains("has other keys"));
        assert!(refusal("[[sweep]]\na = [1, 2]\nb = [1]\n").contains("one has 2 values and the other 1"));
    }
}
