//! `plan.json` as a record of what was run, whatever version of the program wrote it.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value as Json;

use super::frozen::{PLAN_FORMAT, open, read_head, read_json};
use super::{BatchPlan, MAX_FREE_KEYS, PROGRAM_VERSION, PlanError, RunLabel, Variant};
use super::{PLAN_FILE, StoppingRule, Value};
use wildfire_base::input_file::list_of_at_most;
use wildfire_scenario::MemoryLimit;

/// The longest plan of another version that is read: unlike this version's, its values are not known in advance, and
/// each may take some dozen times the memory of its text.
const MAX_BYTES_OF_OTHERS: u64 = 4 << 20;

/// The settings of a batch. A [`BatchPlan`] can be run and is therefore of this version only; this can be read.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPlan {
    pub program_version: String,
    /// The memory that each run might take.
    pub memory: MemoryLimit,
    /// The keys in which entries of a course might differ.
    pub free: Vec<String>,
    pub until: Option<StoppingRule>,
    /// By what rule the batch stopped, and when; `None` without a rule, or if another version wrote the plan.
    pub stop: Option<String>,
    pub swept_keys: Vec<String>,
    pub variants: Vec<RecordedVariant>,
}

/// A scenario as it was run.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedVariant {
    /// A value for each swept key.
    pub swept: Vec<Value>,
    /// The scenario's name.
    pub name: String,
    /// The planners of the trucks, as the column has them: a `;` is between those of trucks that differ.
    pub planner: String,
    /// The policies of the trucks, likewise.
    pub policy: String,
    /// The scenario with all values filled in, as compact JSON: the tree takes ten times as much memory, and few are
    /// needed at once.
    pub scenario: String,
}

#[derive(Deserialize)]
struct RecordedBody {
    /// Plans that were written before runs had a limit do not say it.
    #[serde(default)]
    memory_bytes: MemoryLimit,
    #[serde(default, deserialize_with = "list_of_at_most::<MAX_FREE_KEYS, _, _>")]
    free: Vec<String>,
    until: Option<StoppingRule>,
    swept_keys: Vec<String>,
    variants: Vec<OtherVariant>,
}

/// A variant of another version.
#[derive(Deserialize)]
struct OtherVariant {
    swept: Vec<Value>,
    scenario: Json,
}

impl RecordedPlan {
    /// Reads the plan of a batch's folder. The hash of one that another version wrote cannot be checked.
    ///
    /// # Errors
    /// If there is none, if it cannot be read, or if it was changed.
    pub fn read(folder: &Path) -> Result<Self, PlanError> {
        let path = folder.join(PLAN_FILE);
        let file = open(folder, &path)?;
        let head = read_head(&path, &file)?;
        let program_version = head.program_version;
        if head.format == PLAN_FORMAT && program_version == PROGRAM_VERSION {
            let plan = BatchPlan::read(folder)?;
            let stop = plan.stop_text();
            let BatchPlan { swept_keys, variants, memory, free, until, .. } = plan;
            let variants = variants.into_iter().map(RecordedVariant::from).collect();
            return Ok(Self { program_version, memory, free, until, stop, swept_keys, variants });
        }
        let bytes = file.metadata().map_err(|source| PlanError::Unreadable { path: path.clone(), source })?.len();
        if bytes > MAX_BYTES_OF_OTHERS {
            let reason =
                format!("version {program_version} wrote it, of which at most {MAX_BYTES_OF_OTHERS} bytes are read");
            return Err(PlanError::NotAPlan { path, reason });
        }
        let RecordedBody { memory_bytes: memory, free, until, swept_keys, variants } = read_json(&path, &file)?;
        let variants = variants.into_iter().map(RecordedVariant::from).collect();
        Ok(Self { program_version, memory, free, until, stop: None, swept_keys, variants })
    }
}

impl RecordedPlan {
    /// Returns the error of each question that the stopping rule asks; `None` without a rule.
    pub fn error_of_rule(&self) -> Option<f64> {
        let swept: Vec<&[Value]> = self.variants.iter().map(|variant| &variant.swept[..]).collect();
        self.until.as_ref().map(|rule| StoppingRule::error_of_each(rule.question_count(&swept)))
    }
}

impl From<Variant> for RecordedVariant {
    fn from(Variant { swept, scenario, .. }: Variant) -> Self {
        let label = RunLabel::from_scenario(&scenario, 0);
        let json = serde_json::to_string(&scenario).expect("scenarios hold names, numbers and lists only");
        let RunLabel { scenario: name, planner, .. } = &label;
        Self { swept, planner: planner.clone(), policy: label.policy(), name: name.clone(), scenario: json }
    }
}

impl From<OtherVariant> for RecordedVariant {
    fn from(OtherVariant { swept, scenario }: OtherVariant) -> Self {
        let trucks = scenario["unimog"].as_array().map_or(&[][..], Vec::as_slice);
        let names = |key: &str| {
            let mut names: Vec<&str> = trucks.iter().filter_map(|truck| truck[key].as_str()).collect();
            names.dedup();
            names.join(";")
        };
        let planner = names("planner");
        // As `Dispatch::label` writes it: a team with a policy follows no goals of its own.
        let dispatch = &scenario["dispatch"];
        let policy = match (dispatch["policy"].as_str(), dispatch["idle"].as_str()) {
            (Some(policy), None | Some("stay")) => policy.to_owned(),
            (Some(policy), Some(idle)) => format!("{policy}+{idle}"),
            (None, _) => names("goal"),
        };
        let name = scenario["name"].as_str().unwrap_or_default().to_owned();
        Self { swept, name, planner, policy, scenario: scenario.to_string() }
    }
}
