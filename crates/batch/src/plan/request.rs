//! From what is asked for to a plan: every scenario with every combination of what is swept, checked.

use std::collections::BTreeMap;

use sha2::{Digest, Sha256};
use thiserror::Error;

use super::design::DesignError;
use super::sweep::{SweepError, check_sweeps, is_several};
use super::{
    BatchPlan, MAX_CHANGES, MAX_RUNS, MAX_SWEPT_KEYS, PLANNER_KEY, Record, Seeds, SeedsError, Setting, Sweep, Value,
    Variant,
};
use wildfire_scenario::{LoadedScenario, MemoryLimit, Scenario, ScenarioError, ScenarioText};

/// The most runs of a batch that is not insisted on.
pub const RUNS_WITHOUT_FORCE: u64 = 100_000;

/// The most variants of a batch.
pub const MAX_VARIANTS: u64 = 10_000;

/// The most bytes of all variants and seeds of a plan in its file; fields drawn as maps and many agents make
/// them large. In memory a variant takes less.
pub(super) const MAX_PLAN_BYTES: u64 = 60_000_000;

/// A request for a batch, from the command line or a plan file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BatchRequest {
    /// Names of built-in scenarios, or paths.
    pub scenarios: Vec<String>,
    /// The sources whose text is known already; the others are read. A pipe can be read only once.
    pub texts: Vec<ScenarioText>,
    /// Changes to all scenarios, `key=value`.
    pub changes: Vec<String>,
    pub sweeps: Vec<Sweep>,
    /// 1 to 5 if there are none.
    pub seeds: Option<Seeds>,
    pub record: Option<Record>,
    /// The memory that each run may take; 2 GB if there is none.
    pub memory: Option<MemoryLimit>,
}

/// A fault of a plan file.
#[derive(Debug, Error)]
pub enum PlanFileError {
    #[error("{path}:{line}: {message}")]
    Syntax { path: String, line: usize, message: String },
    #[error("{path}: {reason}")]
    Wrong { path: String, reason: String },
    #[error("{path}: {source}")]
    Seeds { path: String, source: SeedsError },
    #[error("{path}: {source}")]
    Sweep { path: String, source: SweepError },
    #[error("{path}: {source}")]
    Design { path: String, source: DesignError },
}

/// A reason for which a request makes no plan.
#[derive(Debug, Error)]
pub enum RequestError {
    #[error(transparent)]
    Scenario(#[from] Box<ScenarioError>),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    File(#[from] PlanFileError),
    #[error("{count} runs are many: without --force a batch takes at most {RUNS_WITHOUT_FORCE}")]
    ManyRuns { count: u128 },
    #[error("{count} runs are too many: a batch takes at most {MAX_RUNS}")]
    TooManyRuns { count: u128 },
    #[error("{count} combinations of swept values are too many: a batch takes at most {MAX_VARIANTS}")]
    TooManyVariants { count: u128 },
    #[error(
        "the plan would take more than {} MB; expected fewer combinations, smaller maps, or fewer agents",
        MAX_PLAN_BYTES / 1_000_000
    )]
    TooLarge,
    #[error("{count} {what} are too many: a batch takes at most {limit}")]
    TooManyChanges { count: usize, what: &'static str, limit: usize },
    #[error(
        "`{one}` and `{other}` are both named `{name}`; rename one of them, as their tables would be indistinguishable"
    )]
    SameName { one: String, other: String, name: String },
    #[error("{one} and {other} are the same scenario; expected all combinations to differ")]
    SameScenario { one: String, other: String },
}

impl BatchRequest {
    /// Takes an option of the command line: a change, or a sweep if there are several values.
    pub fn add_option(&mut self, option: &str) -> Result<(), SweepError> {
        match option.split_once('=') {
            Some((key, values)) if is_several(values) => self.sweeps.push(Sweep::parse(key, values)?),
            _ => self.changes.push(option.to_owned()),
        }
        Ok(())
    }

    /// Takes the planners of the trucks.
    pub fn add_planners(&mut self, planners: &[String]) -> Result<(), SweepError> {
        match planners {
            [] => Ok(()),
            [one] => {
                self.changes.push(format!("{PLANNER_KEY}={one}"));
                Ok(())
            }
            several => {
                let settings = several.iter().map(|planner| Setting::parse(planner)).collect();
                // The planner is what is compared most, so its values vary slowest after the scenarios.
                self.sweeps.insert(0, Sweep::together(vec![(PLANNER_KEY.to_owned(), settings)])?);
                Ok(())
            }
        }
    }

    /// The plan, with all scenarios loaded. More runs than [`RUNS_WITHOUT_FORCE`] must be insisted on.
    pub fn resolve(&self, force: bool) -> Result<BatchPlan, RequestError> {
        let changed: Vec<&str> = self.changes.iter().filter_map(|change| change.split('=').next()).collect();
        // The check comes before a scenario is loaded: a sweep that contradicts a change is a slip in the command itself.
        check_sweeps(&self.sweeps, &changed)?;
        let seeds = self.seeds.clone().unwrap_or_default();
        // The size follows from the lists alone, so a mistyped range is refused before any scenario is loaded.
        self.check_size(&seeds, force)?;
        self.check_changes()?;
        let plan = BatchPlan {
            variants: self.variants(seeds.to_string().len() as u64)?,
            swept_keys: self.sweeps.iter().flat_map(Sweep::keys).filter(|key| *key != PLANNER_KEY).cloned().collect(),
            seeds,
            record: self.record.unwrap_or_default(),
            memory: self.memory.unwrap_or_default(),
            free: Vec::new(),
            until: None,
        };
        check_distinct(&plan)?;
        Ok(plan)
    }

    fn check_size(&self, seeds: &Seeds, force: bool) -> Result<(), RequestError> {
        let combinations = self.sweeps.iter().map(|sweep| sweep.steps().len() as u128);
        let variants = combinations.fold(self.scenarios.len() as u128, u128::saturating_mul);
        let count = variants.saturating_mul(seeds.count().into());
        match () {
            () if variants > MAX_VARIANTS.into() => Err(RequestError::TooManyVariants { count: variants }),
            () if count > MAX_RUNS.into() => Err(RequestError::TooManyRuns { count }),
            () if count > RUNS_WITHOUT_FORCE.into() && !force => Err(RequestError::ManyRuns { count }),
            () => Ok(()),
        }
    }

    /// Refuses a variant that could not be read back.
    fn check_changes(&self) -> Result<(), RequestError> {
        let swept = self.sweeps.iter().flat_map(Sweep::keys).count();
        let changes = self.changes.len() + swept;
        for (count, what, limit) in [(swept, "swept keys", MAX_SWEPT_KEYS), (changes, "changes", MAX_CHANGES)] {
            if count > limit {
                return Err(RequestError::TooManyChanges { count, what, limit });
            }
        }
        Ok(())
    }

    /// Lists the variants: scenarios vary slowest, then the first sweep, the last sweep fastest. `bytes` is what all
    /// else of the plan takes.
    fn variants(&self, mut bytes: u64) -> Result<Vec<Variant>, RequestError> {
        let combinations = combinations(&self.sweeps);
        let mut variants = Vec::new();
        for source in &self.scenarios {
            // Each text is read once, as a pipe cannot be read again and a file may change between two variants.
            let text = match self.texts.iter().find(|text| text.source == *source) {
                Some(text) => text,
                None => &ScenarioText::open(source)?,
            };
            for combination in &combinations {
                let variant = self.variant(text, combination)?;
                // Sizes are added up as variants are made, so that a plan that is too large is refused before it fills memory.
                bytes += variant.bytes();
                if bytes > MAX_PLAN_BYTES {
                    return Err(RequestError::TooLarge);
                }
                variants.push(variant);
            }
        }
        Ok(variants)
    }

    fn variant(&self, text: &ScenarioText, combination: &[(&str, &Setting)]) -> Result<Variant, RequestError> {
        let swept_changes = combination.iter().map(|(key, setting)| format!("{key}={}", setting.written));
        let changes: Vec<String> = self.changes.iter().cloned().chain(swept_changes).collect();
        let scenario = LoadedScenario::from_text(text, &changes)?.scenario;
        let columns = combination.iter().filter(|(key, _)| *key != PLANNER_KEY);
        let swept: Vec<Value> = columns.map(|(_, setting)| setting.value.clone()).collect();
        Ok(Variant { source: text.source.clone(), changes, swept, scenario })
    }
}

/// Every combination of the sweeps' steps, as keys with their values; one empty combination if nothing is swept.
fn combinations(sweeps: &[Sweep]) -> Vec<Vec<(&str, &Setting)>> {
    let mut all: Vec<Vec<(&str, &Setting)>> = vec![Vec::new()];
    for sweep in sweeps {
        let steps = || sweep.steps().iter().map(|step| sweep.keys().iter().map(String::as_str).zip(step));
        all = all
            .iter()
            .flat_map::<Vec<_>, _>(|start| steps().map(|step| start.iter().copied().chain(step).collect()).collect())
            .collect();
    }
    all
}

/// Scenarios that differ have names that differ, and no two variants are the same.
fn check_distinct(plan: &BatchPlan) -> Result<(), RequestError> {
    let mut names = BTreeMap::new();
    let mut contents = BTreeMap::new();
    for variant in &plan.variants {
        let name = &variant.scenario.name;
        let first: &Variant = names.entry(name).or_insert(variant);
        // Digests are compared, as the JSON of ten thousand scenarios takes more memory than the plan.
        let same_content = contents.insert(Sha256::digest(json_of(&variant.scenario)), variant);
        if let Some(other) = same_content {
            let [one, other] = [other, variant].map(|variant| format!("`{}`", described(variant)));
            return Err(RequestError::SameScenario { one, other });
        }
        // One file with several changes gives several variants of one name, whose swept values tell them from one another.
        if first.source != variant.source {
            let one = first.source.clone();
            let other = variant.source.clone();
            return Err(RequestError::SameName { one, other, name: name.clone() });
        }
    }
    Ok(())
}

/// A variant as its author asked for it.
fn described(variant: &Variant) -> String {
    let parts = std::iter::once(variant.source.as_str()).chain(variant.changes.iter().map(String::as_str));
    parts.collect::<Vec<_>>().join(" ")
}

fn json_of(scenario: &Scenario) -> String {
    serde_json::to_string(scenario).expect("scenarios hold names, numbers and lists only")
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario::Fault;

    fn request(scenarios: &[&str], options: &[&str], planners: &[&str]) -> Result<BatchPlan, RequestError> {
        let scenarios = scenarios.iter().map(|&name| name.to_owned()).collect();
        let mut request = BatchRequest { scenarios, ..BatchRequest::default() };
        for option in options {
            request.add_option(option)?;
        }
        request.add_planners(&planners.iter().map(|&name| name.to_owned()).collect::<Vec<_>>())?;
        request.resolve(false)
    }

    fn titles(plan: &BatchPlan) -> Vec<String> {
        plan.variants.iter().map(|variant| plan.title(variant)).collect()
    }

    #[test]
    fn everything_is_multiplied_scenarios_first_then_planners() {
        let options = ["field.coverage=0.05,0.1", "fire.relight=true"];
        let plan = request(&["smoke", "contest"], &options, &["hybrid-astar", "prm+primitives"]).expect("eight");
        assert_eq!(plan.variants.len(), 8);
        assert_eq!(
            titles(&plan)[..3],
            [
                "smoke, planner hybrid-astar, field.coverage 0.05",
                "smoke, planner hybrid-astar, field.coverage 0.1",
                "smoke, planner prm+primitives, field.coverage 0.05",
            ]
        );
        assert_eq!(plan.swept_keys, ["field.coverage"]);
        assert!(plan.variants.iter().all(|variant| variant.scenario.fire.relight));
        assert_eq!(plan.seeds.to_string(), "1..5");
    }

    #[test]
    fn unknown_planners_and_keys_are_answered_with_the_nearest_name() {
        let refusal = |options: &[&str], planners: &[&str]| match request(&["smoke"], options, planners) {
            Err(RequestError::Scenario(error)) => error.fault.clone(),
            other => panic!("{other:?}"),
        };
        let fault = refusal(&[], &["prm+primitives", "hybrid-astr"]);
        assert!(matches!(fault, Fault::UnknownName { nearest: Some(name), .. } if name == "hybrid-astar"));
        let fault = refusal(&["field.covrage=0.1,0.2"], &[]);
        assert!(matches!(fault, Fault::UnknownField { nearest: Some(name), .. } if name == "coverage"));
    }

    #[test]
    fn combinations_that_mean_the_same_are_refused() {
        let refusal = request(&["smoke"], &["duration_s=60,60.0"], &[]).expect_err("60 is 60.0");
        assert!(matches!(refusal, RequestError::SameScenario { .. }), "{refusal}");
        let refusal = request(&["smoke", "smoke"], &[], &[]).expect_err("it is named twice");
        assert!(matches!(refusal, RequestError::SameScenario { .. }), "{refusal}");
        let refusal = request(&["smoke", "contest"], &["name=one"], &[]).expect_err("both have the name");
        assert!(matches!(refusal, RequestError::SameName { .. }), "{refusal}");
    }

    #[test]
    fn sizes_are_checked_before_anything_is_loaded() {
        let mut request = BatchRequest { scenarios: vec!["nowhere".into()], ..BatchRequest::default() };
        request.seeds = "1..100001".parse().ok();
        assert!(matches!(request.resolve(false), Err(RequestError::ManyRuns { count: 100_001 })));
        assert!(matches!(request.resolve(true), Err(RequestError::Scenario(_))));
        let values: Vec<_> = (1..=2000).map(|value| value.to_string()).collect();
        for key in ["a", "b"] {
            request.add_option(&format!("{key}={}", values.join(","))).expect("values");
        }
        assert!(matches!(request.resolve(true), Err(RequestError::TooManyVariants { count: 4_000_000 })));
    }
}
