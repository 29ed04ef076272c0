//! Differences between the settings of two sides, as possible causes of a difference of their runs.
//!
//! Settings are those that `plan.json` holds beside the table of runs, with every value filled in. The scenarios of
//! runs that make pairs are compared, whether or not these finished. The settings of a side are unknown if its plan is not there, or does not go with
//! its runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value as Json;

use crate::comparison::pairs::Pairs;
use crate::comparison::runs_table::RunsTable;
use crate::comparison::sides::Side;
use crate::comparison::wording::listed;
use crate::plan::{PLAN_FILE, PLANNER_KEY, PlanError, RecordedPlan, RecordedVariant, range_text};
use wildfire_base::untrusted::visible_start;
use wildfire_scenario::value_differences;

/// The name of a scenario, which says nothing of its runs.
const NAME_KEY: &str = "name";

/// The differences of a side's settings from those of side A.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SettingsDifference {
    /// Sides, by their letters, with unknown settings, and the reason. Differences are then empty.
    pub unknown: Vec<(char, String)>,
    pub differences: Vec<Difference>,
    /// The versions of A and of the other side, if they differ.
    pub program_versions: Option<[String; 2]>,
    /// The seeds of all runs of A and of the other side, such as `1..5,9`, if they differ.
    pub seeds: Option<[String; 2]>,
}

/// A value in which the resolved scenarios of two sides differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The key as `--set` takes it: `unimog.planner` where all trucks have the same difference.
    pub key: String,
    /// The values on side A and on the other; `None` where the scenario has no such value.
    pub values: [Option<Json>; 2],
    /// The indices of the strata with this difference; empty if all have it.
    pub strata: Vec<usize>,
}

/// A plan, and the scenario of each run of a table.
#[derive(Debug)]
pub struct RecordedSettings {
    plan: RecordedPlan,
    variant_of: Vec<usize>,
}

impl RecordedSettings {
    /// Reads the plan beside a table of runs, or returns why the settings of its runs are unknown.
    pub fn read(table: &RunsTable) -> Result<Self, String> {
        let folder = table.path.parent().unwrap_or(Path::new("."));
        let plan = RecordedPlan::read(folder).map_err(|error| match error {
            PlanError::Missing { .. } => format!("there is no {PLAN_FILE} beside {}", shown_path(table)),
            error => visible_start(&error.to_string()),
        })?;
        let mut index_of: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
        let mut variant_of = Vec::with_capacity(table.seeds.len());
        for run in 0..table.seeds.len() {
            let levels: Vec<u32> = table.conditions.iter().map(|condition| condition.of_run[run]).collect();
            // A scenario is looked for once for each combination of levels, as a table may have a million rows.
            let variant = match index_of.get(&levels) {
                Some(&variant) => variant,
                None => variant_of_run(&plan, table, run)?,
            };
            index_of.insert(levels, variant);
            variant_of.push(variant);
        }
        Ok(Self { plan, variant_of })
    }
}

/// Finds the variant that has the conditions of a run.
fn variant_of_run(plan: &RecordedPlan, table: &RunsTable, run: usize) -> Result<usize, String> {
    let mut found = plan.variants.iter().enumerate().filter(|(_, variant)| {
        let mut conditions = table.conditions.iter();
        conditions.all(|condition| value_of(plan, variant, &condition.name).as_deref() == Some(condition.level_of(run)))
    });
    let (first, variant) = found.next().ok_or_else(|| format!("{PLAN_FILE} does not go with {}", shown_path(table)))?;
    if found.any(|(_, other)| other.scenario != variant.scenario) {
        return Err(format!("{PLAN_FILE} has several scenarios for the same runs of {}", shown_path(table)));
    }
    Ok(first)
}

fn value_of(plan: &RecordedPlan, variant: &RecordedVariant, column: &str) -> Option<String> {
    match column {
        "scenario" => Some(variant.name.clone()),
        "planner" => Some(variant.planner.clone()),
        "policy" => Some(variant.policy.clone()),
        key => {
            let place = plan.swept_keys.iter().position(|swept| swept == key)?;
            Some(variant.swept.get(place)?.to_string())
        }
    }
}

impl RecordedSettings {
    pub fn plan(&self) -> &RecordedPlan {
        &self.plan
    }

    /// Returns the index of the variant of a run of the table.
    pub fn variant_of(&self, run: usize) -> usize {
        self.variant_of[run]
    }
}

fn shown_path(table: &RunsTable) -> String {
    visible_start(&table.path.display().to_string())
}

impl SettingsDifference {
    /// Compares the settings of planned pairs of runs of both sides, each side with the settings of its table.
    // Planned pairs count and not finished ones: what makes runs fail is often the setting that differs.
    pub fn between(sides: [&Side<'_>; 2], settings: [&Result<RecordedSettings, String>; 2], pairs: &Pairs) -> Self {
        let seeds = sides.map(seeds_of);
        let seeds = (seeds[0] != seeds[1]).then_some(seeds);
        let [ours, theirs] = match settings {
            [Ok(ours), Ok(theirs)] => [ours, theirs],
            [ours, theirs] => {
                let reasons = [reason_unknown(sides[0], ours), reason_unknown(sides[1], theirs)];
                let unknown = reasons.into_iter().flatten().collect();
                return Self { unknown, seeds, ..Self::default() };
            }
        };
        let versions = [&ours.plan, &theirs.plan].map(|plan| plan.program_version.clone());
        Self {
            unknown: Vec::new(),
            differences: differences(ours, theirs, pairs),
            program_versions: (versions[0] != versions[1]).then_some(versions),
            seeds,
        }
    }

    /// Returns whether the planner of the trucks is the only difference.
    pub fn is_the_planners(&self) -> bool {
        let (_, planner) = PLANNER_KEY.split_once('.').expect("it is a key of the trucks");
        self.is_recorded_and_of_one_version()
            && self.effective().next().is_some()
            && self.effective().all(|difference| is_planner_key(&difference.key, planner))
    }

    fn is_recorded_and_of_one_version(&self) -> bool {
        self.unknown.is_empty() && self.program_versions.is_none()
    }

    /// Returns the differences that can make runs differ.
    fn effective(&self) -> impl Iterator<Item = &Difference> {
        self.differences.iter().filter(|difference| difference.key != NAME_KEY)
    }

    /// Returns a line for each difference, `unimog.speed_mps: 8.0 in A, 20.0 in B`.
    pub fn lines(&self, letter: char, pairs: &Pairs) -> Vec<String> {
        let both = |what: &str, [ours, theirs]: [&str; 2]| {
            format!("{}: {} in A, {} in {letter}", visible_start(what), visible_start(ours), visible_start(theirs))
        };
        let versions = self.program_versions.iter().map(|[a, b]| both("program version", [a, b]));
        let seeds = self.seeds.iter().map(|[a, b]| both("seeds", [a, b]) + "; only seeds of both are compared");
        let settings = self.differences.iter().map(|difference| {
            let [ours, theirs] = difference.values.each_ref().map(value_text);
            let line = both(&difference.key, [&ours, &theirs]);
            let strata: Vec<String> = difference.strata.iter().map(|&index| pairs.stratum_text(index)).collect();
            if strata.is_empty() { line } else { format!("{line}, where {}", strata.join(" or ")) }
        });
        versions.chain(settings).chain(seeds).collect()
    }

    /// Returns what these differences mean for the result of the comparison.
    pub fn conclusion(&self, letter: char) -> String {
        if !self.unknown.is_empty() {
            let sides: Vec<String> = self.unknown.iter().map(|(side, _)| side.to_string()).collect();
            // Two tables in one folder have one reason, which is given once.
            let mut reasons: Vec<&str> = self.unknown.iter().map(|(_, reason)| reason.as_str()).collect();
            reasons.dedup();
            let (of, why) = (listed(&sides), reasons.join("; "));
            return format!(
                "The settings of {of} are not known: {why}. A and {letter} may differ in more than is named here."
            );
        }
        match self.effective().count() {
            // Several keys may belong to one planner; that both sides differ in the planner is still one cause.
            _ if self.is_the_planners() => {
                "All other settings and the program are equal: the difference is the planner's.".into()
            }
            0 if self.program_versions.is_some() => "All settings are equal, the programs are not.".into(),
            0 => "All settings and the program are equal: only measured times can differ.".into(),
            // A single value is named as the cause only if the program is the same too.
            1 if self.program_versions.is_none() => {
                "All other settings and the program are equal: the difference is that of this value.".into()
            }
            _ => "All other settings are equal; which of these makes what difference, this comparison cannot tell."
                .into(),
        }
    }
}

fn is_planner_key(key: &str, planner: &str) -> bool {
    let mut steps = key.split('.');
    steps.next() == PLANNER_KEY.split('.').next() && steps.next_back() == Some(planner) && steps.count() <= 1
}

fn reason_unknown(side: &Side<'_>, settings: &Result<RecordedSettings, String>) -> Option<(char, String)> {
    settings.as_ref().err().map(|reason| (side.letter, reason.clone()))
}

/// Words a value that a scenario may not have.
pub(super) fn value_text(value: &Option<Json>) -> String {
    match value {
        None => "nothing".into(),
        Some(Json::String(word)) => word.clone(),
        Some(value) => value.to_string(),
    }
}

/// Lists the seeds of a side, each once, consecutive ones as ranges.
fn seeds_of(side: &Side<'_>) -> String {
    seeds_text(side.runs.iter().map(|&run| side.table.seeds[run]))
}

/// Lists seeds, each once, consecutive ones as ranges: `1..5,9`.
pub(super) fn seeds_text(seeds: impl Iterator<Item = u64>) -> String {
    let seeds: BTreeSet<u64> = seeds.collect();
    range_text(&seeds.into_iter().collect::<Vec<_>>(), "..")
}

/// Returns all values in which the scenarios of some pair differ, whether or not its runs finished.
fn differences(ours: &RecordedSettings, theirs: &RecordedSettings, pairs: &Pairs) -> Vec<Difference> {
    // Each pair of scenarios with the strata that it is in: by plan, these are few.
    let mut compared: BTreeMap<(usize, usize), BTreeSet<usize>> = BTreeMap::new();
    for &(our_run, their_run, stratum) in &pairs.planned {
        let variants = (ours.variant_of[our_run], theirs.variant_of[their_run]);
        compared.entry(variants).or_default().insert(stratum);
    }
    let mut found: Vec<Difference> = Vec::new();
    for ((our_variant, their_variant), strata) in compared {
        let scenarios = [scenario_json(ours, our_variant), scenario_json(theirs, their_variant)];
        for (key, values) in merged(scenarios.each_ref()) {
            match found.iter_mut().find(|difference| difference.key == key && difference.values == values) {
                Some(difference) => difference.strata.extend(&strata),
                None => found.push(Difference { key, values, strata: strata.iter().copied().collect() }),
            }
        }
    }
    for difference in &mut found {
        difference.strata.sort_unstable();
        difference.strata.dedup();
        // Without a list a difference holds everywhere; naming all strata would suggest an exception.
        if difference.strata.len() == pairs.strata.len() + pairs.unfinished_strata.len() {
            difference.strata.clear();
        }
    }
    found
}

fn scenario_json(settings: &RecordedSettings, variant: usize) -> Json {
    serde_json::from_str(&settings.plan.variants[variant].scenario).expect("it was written as JSON")
}

/// Returns the differences of two scenarios; one that all agents of a list share is given once, for the list.
pub(super) fn merged(scenarios: [&Json; 2]) -> Vec<(String, [Option<Json>; 2])> {
    let all = value_differences(scenarios[0], scenarios[1]);
    let mut merged: Vec<(String, [Option<Json>; 2])> = Vec::new();
    for difference in &all {
        let key = match parts_of_agent(&difference.key) {
            Some((list, step)) => {
                // The count must be that of both lists: with agents added on one side, the value is not common to all.
                let counts = scenarios.map(|scenario| scenario[list].as_array().map_or(0, Vec::len));
                let same = all.iter().filter(|other| {
                    parts_of_agent(&other.key) == Some((list, step)) && other.values == difference.values
                });
                let is_shared = counts == [same.count(); 2];
                if is_shared { format!("{list}.{step}") } else { difference.key.clone() }
            }
            None => difference.key.clone(),
        };
        if !merged.iter().any(|(existing, _)| *existing == key) {
            merged.push((key, difference.values.clone()));
        }
    }
    merged
}

/// Takes the key of an agent's value apart: `unimog` and `planner` of `unimog.2.planner`.
fn parts_of_agent(key: &str) -> Option<(&str, &str)> {
    let (list, rest) = key.split_once('.')?;
    let (index, step) = rest.split_once('.')?;
    index.chars().all(|letter| letter.is_ascii_digit()).then_some((list, step))
}
