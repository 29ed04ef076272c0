//! What a batch is asked to do: variants of scenarios, each with the same seeds.
//!
//! A variant is a scenario with all its changes and one value of everything that is swept. The runs of a plan are
//! numbered from 1: all seeds of the first variant, then all of the second, and so on. So the number of a run follows
//! from the plan alone, and runs of different variants with one seed are pairs: they have the same field as far as
//! the variants let it be the same.

mod course;
mod design;
mod difference;
mod equal_rules;
mod file;
mod free;
mod frozen;
mod program;
mod recorded;
mod request;
mod seeds;
mod slice;
mod sweep;
mod until;
mod value;

pub use course::{
    CONDITION_COLUMN, CourseError, CoursePlan, CourseRefusal, CourseRequest, EntryCard, read_card, rules_schema,
};
pub(crate) use course::{Course, ENTRY_FILE, EntryFile, GradingRules, fault as course_fault};
pub use equal_rules::{
    COLUMNS_OF_ENTRIES, FreeParameters, LimitsOfPrograms, TABLES_OF_PROGRAMS, USUALLY_FREE, kept_program,
    limits_of_programs, rules_of,
};
pub use file::{PLAN_KEYS, PLAN_TEMPLATE, schema as plan_schema};
pub use free::{FreeKeys, FreeKeysError};
pub use frozen::{PLAN_FILE, PlanError};
pub(super) use program::PROGRAM;
pub use program::{COMMIT, COMPILER, LONG_VERSION, PROGRAM_VERSION, PlanWriter};
pub use recorded::{RecordedPlan, RecordedVariant};
pub use request::{BatchRequest, MAX_VARIANTS, RUNS_WITHOUT_FORCE, RequestError};
pub use seeds::{MAX_RUNS, MAX_SEEDS_BYTES, Seeds, SeedsError, range_text};
pub use slice::{MAX_SLICES, Slice, SliceError};
pub use sweep::{Setting, Sweep, SweepError, is_same_value};
pub use until::{EstimateOf, MAX_COMPARED, StoppingGoal, StoppingRule, VariantPair};
pub use value::Value;

use std::fmt::Write;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::input_file::list_of_at_most;
use wildfire_scenario::{Dispatch, MemoryLimit, Scenario};
use wildfire_timeline::AgentId;

/// The most keys that a batch sweeps, and the most changes of a scenario.
pub const MAX_SWEPT_KEYS: usize = 100;
const MAX_CHANGES: usize = 1_000;
/// The most agents of a run.
const MAX_AGENTS: usize = 2000;

/// The key of a scenario's planners, whose values have a column of their own.
pub const PLANNER_KEY: &str = "unimog.planner";

/// The most keys that a course frees.
const MAX_FREE_KEYS: usize = 100;

/// The column that names whose entry a run is of, in batches of several.
pub const ENTRY_COLUMN: &str = "entry";

/// Which runs leave a recording of their timeline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Record {
    All,
    /// Runs in which an agent got stuck. (A run that could not start has no timeline.)
    Failed,
    #[default]
    None,
}

/// Variants, and the seeds to run each of them with.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchPlan {
    pub variants: Vec<Variant>,
    /// The keys that are swept and have a column for it: all but that of the planner, which always has one.
    pub swept_keys: Vec<String>,
    pub seeds: Seeds,
    pub record: Record,
    /// The memory that each run may take.
    pub memory: MemoryLimit,
    /// The keys in which entries of a course may differ; none of other batches.
    pub free: Vec<String>,
    /// The rule by which the batch stops; once it has, [`Self::seeds`] are those that were played.
    pub until: Option<StoppingRule>,
}

/// A scenario as it is run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variant {
    /// The scenario as it was named.
    pub source: String,
    /// The changes made to it, `key=value`, swept ones last.
    #[serde(deserialize_with = "list_of_at_most::<MAX_CHANGES, _, _>")]
    pub changes: Vec<String>,
    /// A value for each of [`BatchPlan::swept_keys`].
    #[serde(deserialize_with = "list_of_at_most::<MAX_SWEPT_KEYS, _, _>")]
    pub swept: Vec<Value>,
    pub scenario: Scenario,
}

/// A run of a plan.
#[derive(Clone, Copy, Debug)]
pub struct PlannedRun<'a> {
    /// From 1 to [`BatchPlan::count`].
    pub number: u64,
    pub seed: u64,
    pub variant: &'a Variant,
}

/// Where a run is in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunPlace {
    pub variant: usize,
    /// The index of the seed among those of the variant, from 0.
    pub seed: u64,
}

/// Names a run of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunLabel {
    /// From 1, in the order of the plan.
    pub run: u64,
    pub scenario: String,
    pub seed: u64,
    /// The planner of the trucks; empty without any.
    pub planner: String,
    /// Who chooses where each agent goes, in the order of timelines' agents.
    #[serde(default, deserialize_with = "list_of_at_most::<MAX_AGENTS, _, _>")]
    pub policies: Vec<(AgentId, String)>,
    /// A value for each key that the batch sweeps.
    #[serde(deserialize_with = "list_of_at_most::<MAX_SWEPT_KEYS, _, _>")]
    pub swept: Vec<Value>,
}

impl RunLabel {
    /// Returns the policy of the trucks, with `;` between those of trucks that differ; empty without any.
    pub fn policy(&self) -> String {
        let trucks = self.policies.iter().filter(|(agent, _)| agent.role.suppresses());
        let mut names: Vec<&str> = trucks.map(|(_, name)| name.as_str()).collect();
        names.dedup();
        names.join(";")
    }

    /// Names a run that belongs to no batch.
    pub fn from_scenario(scenario: &Scenario, seed: u64) -> Self {
        let planner = planner_of(scenario);
        let policies = policies_of(scenario);
        Self { run: 1, scenario: scenario.name.clone(), seed, planner, policies, swept: Vec::new() }
    }
}

impl BatchPlan {
    /// The plan of one scenario with nothing swept.
    pub fn from_scenario(source: &str, changes: &[String], scenario: Scenario, seeds: Seeds, record: Record) -> Self {
        let variant = Variant { source: source.into(), changes: changes.to_vec(), swept: Vec::new(), scenario };
        Self {
            variants: vec![variant],
            swept_keys: Vec::new(),
            seeds,
            record,
            memory: MemoryLimit::default(),
            free: Vec::new(),
            until: None,
        }
    }

    /// Number of runs.
    pub fn count(&self) -> u64 {
        match self.played_apart() {
            Some(played) => played.iter().sum(),
            None => self.variants.len() as u64 * self.seeds.count(),
        }
    }

    /// Number of runs of a variant, with as many of the first seeds.
    pub fn seeds_of(&self, variant: usize) -> u64 {
        self.played_apart().map_or(self.seeds.count(), |played| played[variant])
    }

    /// The seeds of each variant, where they differ.
    fn played_apart(&self) -> Option<&[u64]> {
        self.until.as_ref().map(|rule| &rule.played[..]).filter(|played| !played.is_empty())
    }

    /// The place of the run of this number, from 1 to [`Self::count`].
    pub fn place(&self, number: u64) -> RunPlace {
        let index = number.checked_sub(1).expect("runs are numbered from 1");
        let seeds = self.seeds.count();
        let Some(played) = self.played_apart() else {
            let variant = usize::try_from(index / seeds).expect("a plan's variants fit into memory");
            return RunPlace { variant, seed: index % seeds };
        };
        // A rule stopped the variants after different numbers of seeds.
        let mut seed = index;
        for (variant, &of_variant) in played.iter().enumerate() {
            if seed < of_variant {
                return RunPlace { variant, seed };
            }
            seed -= of_variant;
        }
        unreachable!("the plan has {} runs, and no run {number}", self.count())
    }

    /// The number of the run at this place.
    pub fn number(&self, RunPlace { variant, seed }: RunPlace) -> u64 {
        let before = match self.played_apart() {
            Some(played) => played[..variant].iter().sum(),
            None => variant as u64 * self.seeds.count(),
        };
        before + seed + 1
    }

    /// The run of this number, from 1 to [`Self::count`].
    pub fn run(&self, number: u64) -> PlannedRun<'_> {
        let RunPlace { variant, seed } = self.place(number);
        PlannedRun { number, seed: self.seeds.nth(seed), variant: &self.variants[variant] }
    }

    /// All runs in the order of their numbers.
    pub fn runs(&self) -> impl Iterator<Item = PlannedRun<'_>> {
        (1..=self.count()).map(|number| self.run(number))
    }

    /// The name of a run's recording, in the folder of recordings.
    pub fn recording_name(&self, run: &PlannedRun<'_>) -> String {
        match self.variants.as_slice() {
            // With one variant the seed alone says which run it is.
            [_] => format!("seed-{}.wildfire", run.seed),
            _ => format!("run-{}-seed-{}.wildfire", run.number, run.seed),
        }
    }

    /// Returns the name of the entry that a variant is; `None` in batches without entries.
    pub fn entry(&self, variant: &Variant) -> Option<String> {
        let place = self.swept_keys.iter().position(|key| key == ENTRY_COLUMN)?;
        Some(variant.swept[place].to_string())
    }

    /// Names a variant by what differs between variants: scenario, planner if that differs, values that are swept.
    pub fn title(&self, variant: &Variant) -> String {
        self.title_of_all(&[variant])
    }

    /// Names variants by what [`Self::title`] says of all of them.
    pub fn title_of_all(&self, variants: &[&Variant]) -> String {
        let [first, others @ ..] = variants else { return String::new() };
        let planner = planner_of(&first.scenario);
        let mut parts = Vec::new();
        // A name is given only if all share it, as a title of several must be true of each.
        if others.iter().all(|other| other.scenario.name == first.scenario.name) {
            parts.push(first.scenario.name.clone());
        }
        if self.variants.iter().any(|other| planner_of(&other.scenario) != planner) {
            parts.push(format!("planner {planner}"));
        }
        for (place, key) in self.swept_keys.iter().enumerate() {
            let value = &first.swept[place];
            if others.iter().all(|other| other.swept[place] == *value) {
                parts.push(format!("{key} {value}"));
            }
        }
        parts.join(", ")
    }
}

impl PlannedRun<'_> {
    /// Returns what is known of the run before it takes place.
    pub fn label(&self) -> RunLabel {
        let Variant { scenario, swept, .. } = self.variant;
        let named = RunLabel::from_scenario(scenario, self.seed);
        RunLabel { run: self.number, swept: swept.clone(), ..named }
    }

    /// The command that shows the run again.
    pub fn repeating_command(&self) -> String {
        format!("wildfire run {}", self.repeating_args())
    }

    /// The arguments by which commands simulate the run again.
    pub fn repeating_args(&self) -> String {
        let mut command = format!("{} --seed {}", shell_word(&self.variant.source), self.seed);
        for change in &self.variant.changes {
            write!(command, " --set {}", shell_word(change)).expect("a string takes any text");
        }
        if self.variant.scenario.needs_trust() {
            command += " --trust";
        }
        command
    }
}

/// Returns the planner of a scenario's trucks, with `;` between the planners of trucks that differ.
pub fn planner_of(scenario: &Scenario) -> String {
    let mut names: Vec<&str> = scenario.unimog.iter().map(|truck| truck.planner.name()).collect();
    names.dedup();
    names.join(";")
}

/// Lists the policies of a scenario's agents.
fn policies_of(scenario: &Scenario) -> Vec<(AgentId, String)> {
    let wumpuses =
        scenario.wumpus.iter().zip(0..).map(|(wumpus, number)| (AgentId::wumpus(number), wumpus.goal.name()));
    let dispatched = scenario.dispatch.as_ref().map(Dispatch::label);
    let trucks = scenario.unimog.iter().zip(0..).map(|(truck, number)| {
        (AgentId::unimog(number), dispatched.clone().unwrap_or_else(|| truck.goal.name().to_owned()))
    });
    wumpuses.map(|(agent, name)| (agent, name.to_owned())).chain(trucks).collect()
}

impl Record {
    /// Says whether a run in which agents were stuck for these times leaves a recording.
    pub fn keeps(self, truck_stuck_s: f64, wumpus_stuck_s: f64) -> bool {
        match self {
            Self::All => true,
            Self::Failed => truck_stuck_s > 0.0 || wumpus_stuck_s > 0.0,
            Self::None => false,
        }
    }
}

impl FromStr for Record {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "all" => Ok(Self::All),
            "failed" => Ok(Self::Failed),
            "none" => Ok(Self::None),
            _ => Err("expected `all`, `failed` or `none`".into()),
        }
    }
}

/// The word as a shell takes it for one word.
pub fn shell_word(word: &str) -> String {
    if !word.is_empty() && word.chars().all(|letter| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter)) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario as scenario;

    fn two_by_three() -> BatchPlan {
        let sweep = Sweep::parse("field.coverage", "0.05, 0.1").expect("two values");
        let request = BatchRequest {
            scenarios: vec!["smoke".into()],
            sweeps: vec![sweep],
            seeds: "7,1..2".parse().ok(),
            ..BatchRequest::default()
        };
        request.resolve(false).expect("a small batch")
    }

    #[test]
    fn args_survive_the_shell() {
        assert_eq!(shell_word("scenarios/a.toml"), "scenarios/a.toml");
        assert_eq!(shell_word("unimog.prm.samples=1000"), "unimog.prm.samples=1000");
        assert_eq!(shell_word("my file.toml"), "'my file.toml'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }

    #[test]
    fn every_variant_has_every_seed_one_variant_after_the_other() {
        let plan = two_by_three();
        let found: Vec<_> = plan.runs().map(|run| (run.number, run.seed, run.variant.swept[0].to_string())).collect();
        let expected = [(1, 7, "0.05"), (2, 1, "0.05"), (3, 2, "0.05"), (4, 7, "0.1"), (5, 1, "0.1"), (6, 2, "0.1")];
        assert_eq!(found, expected.map(|(number, seed, value)| (number, seed, value.to_owned())));
        assert_eq!(plan.count(), 6);
    }

    #[test]
    fn run_is_repeated_with_the_changes_of_its_variant() {
        let plan = two_by_three();
        assert_eq!(plan.run(4).repeating_command(), "wildfire run smoke --seed 7 --set field.coverage=0.1");
        assert_eq!(plan.run(4).variant.scenario.field.coverage, 0.1);
    }

    #[test]
    fn title_says_what_differs_and_nothing_else() {
        let plan = two_by_three();
        assert_eq!(plan.title(&plan.variants[1]), "smoke, field.coverage 0.1");
        let scenario = scenario::load("smoke", &[]).expect("it is built in");
        let one = BatchPlan::from_scenario("smoke", &[], scenario, "1".parse().expect("a seed"), Record::None);
        assert_eq!(one.title(&one.variants[0]), "smoke");
    }

    #[test]
    fn planners_of_unlike_trucks_are_all_named() {
        let changes = ["unimog.0.planner=hybrid-astar".to_owned()];
        let fleet = scenario::load("fleet", &changes).expect("it is built in");
        assert!(planner_of(&fleet).starts_with("hybrid-astar;"), "{}", planner_of(&fleet));
        assert_eq!(planner_of(&scenario::load("wumpus-alone", &[]).expect("it is built in")), "");
    }
}
