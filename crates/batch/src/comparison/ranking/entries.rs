//! The entries of a ranking: their runs, and the checks that all played the same fields by the same rules.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value as Json;

use crate::comparison::ComparisonError;
use crate::comparison::ranking::error::RankingError;
use crate::comparison::runs_table::{RunCondition, RunsTable};
use crate::comparison::settings::{RecordedSettings, merged, seeds_text, value_text};
use crate::comparison::sides::{Selection, whole};
use crate::comparison::wording::listed;
use crate::plan::{
    COLUMNS_OF_ENTRIES, ENTRY_COLUMN, FreeKeys, FreeParameters, LimitsOfPrograms, RecordedPlan, kept_program,
    limits_of_programs, rules_of,
};
use wildfire_base::untrusted::visible_start;
use wildfire_scenario::nearest_name;

/// The most differences that a refusal names.
const MAX_NAMED: usize = 5;

/// The runs of an entry.
#[derive(Debug)]
pub struct EntryRuns<'a> {
    pub name: String,
    pub table: &'a RunsTable,
    settings: &'a RecordedSettings,
    /// The columns of its own that vary in its table, with its values.
    levels: Vec<(String, String)>,
    /// The runs by seed and stratum, which are the same for all entries.
    pub runs: Vec<RankedRun>,
}

/// A run, with the values by which it is paired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RankedRun {
    pub seed: u64,
    pub stratum: usize,
    pub index: usize,
}

/// The seed and the stratum by which runs of different entries are paired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunKey {
    pub seed: u64,
    pub stratum: usize,
}

impl RankedRun {
    pub fn key(&self) -> RunKey {
        RunKey { seed: self.seed, stratum: self.stratum }
    }
}

/// The rules of which entries may be ranked together.
pub struct RankRules {
    pub freedom: FreeParameters,
    /// The names of entries that are left out.
    pub without: Vec<String>,
}

/// Entries that may be ranked together.
#[derive(Debug)]
pub struct Entries<'a> {
    pub entries: Vec<EntryRuns<'a>>,
    /// The columns that vary within an entry; every mean is taken over them.
    pub columns: Vec<String>,
    /// The number of combinations of their values.
    pub strata: usize,
}

impl<'a> Entries<'a> {
    /// Splits tables into entries, by the columns in which entries may differ, and refuses those that did not play the
    /// same fields.
    pub fn new(
        tables: &'a [RunsTable],
        settings: &'a [RecordedSettings],
        selection: &Selection,
        RankRules { freedom, without }: &RankRules,
    ) -> Result<Self, RankingError> {
        let free = &freedom.keys;
        let mut entries = Vec::new();
        for (table, settings) in tables.iter().zip(settings) {
            entries.extend(divided(table, settings, selection, free)?);
        }
        // Each pair of entries is tested, so the work grows with the square of their number.
        let limit = super::MAX_ENTRIES;
        if entries.len() > limit {
            return Err(RankingError::TooMany { count: entries.len(), limit });
        }
        name_entries(&mut entries)?;
        // This goes by name and so comes after naming; it comes before strata, as an entry that is left out must not add any.
        leave_out(&mut entries, without)?;
        let columns = varying_columns(&entries, free);
        let strata = number_strata(&mut entries, &columns)?;
        let found = Self { entries, columns, strata };
        found.refuse_impossible_rows()?;
        found.refuse_other_runs()?;
        found.refuse_reuse()?;
        found.refuse_other_rules(freedom)?;
        Ok(found)
    }

    /// The states of the bushes in each row add up.
    fn refuse_impossible_rows(&self) -> Result<(), RankingError> {
        for entry in &self.entries {
            let mut runs = entry.runs.iter();
            if let Some((run, reason)) = runs.find_map(|run| Some((run, entry.table.impossible.get(&run.index)?))) {
                let entry = entry.name.clone();
                let reason = reason.clone();
                return Err(RankingError::Impossible { entry, seed: run.seed, reason });
            }
        }
        Ok(())
    }

    /// All entries have runs of the same seeds under the same conditions, or, if a rule stopped them, some of these.
    fn refuse_other_runs(&self) -> Result<(), RankingError> {
        let [first, others @ ..] = &self.entries[..] else { unreachable!("there is a table, and it has runs") };
        // A stopping rule plays seeds in order and drops entries, so the runs of each are the first of the longest.
        let longest = self.entries.iter().max_by_key(|entry| entry.runs.len()).unwrap_or(first);
        let longest: BTreeSet<_> = longest.runs.iter().map(RankedRun::key).collect();
        for other in others {
            let [ours, theirs] = [first, other].map(|it| it.runs.iter().map(RankedRun::key).collect::<BTreeSet<_>>());
            // Without a rule, an entry with fewer seeds would have chosen them.
            let were_stopped = [first, other].iter().all(|entry| entry.settings.plan().until.is_some());
            if ours == theirs || were_stopped && ours.is_subset(&longest) && theirs.is_subset(&longest) {
                continue;
            }
            let seeds = [first, other].map(|entry| seeds_text(entry.runs.iter().map(|run| run.seed)));
            let names = [first, other].map(|entry| entry.name.clone());
            // With equal seeds, only the conditions can be what differs.
            return Err(if seeds[0] == seeds[1] {
                RankingError::OtherConditions { names, columns: listed(&self.columns) }
            } else {
                RankingError::OtherSeeds { names, seeds: seeds.map(|text| visible_start(&text)) }
            });
        }
        Ok(())
    }

    /// No program of an entry is kept from run to run.
    fn refuse_reuse(&self) -> Result<(), RankingError> {
        for entry in &self.entries {
            for scenario in entry.scenarios() {
                if let Some(table) = kept_program(&scenario) {
                    let table = visible_start(&table);
                    return Err(RankingError::Reuse { entry: entry.name.clone(), table });
                }
            }
        }
        Ok(())
    }

    /// All entries ran by the same program, under the same limits, in scenarios that differ only in what is free.
    fn refuse_other_rules(&self, freedom: &FreeParameters) -> Result<(), RankingError> {
        let [first, others @ ..] = &self.entries[..] else { unreachable!("there is a table, and it has runs") };
        // The first entry stands for all: equal rules are equal for all, and a difference names two entries.
        let ours = first.rules(self.strata, &freedom.keys);
        let limits = first.limits_of_programs(&freedom.limits).into_iter();
        let mut limits: BTreeMap<_, _> = limits.map(|(key, found)| (key, (first.name.clone(), found))).collect();
        for other in others {
            let names = [first, other].map(|entry| entry.name.clone());
            let mut differences = program_differences([first, other].map(|entry| entry.settings.plan()));
            for (one, theirs) in ours.iter().zip(other.rules(self.strata, &freedom.keys)) {
                for (key, values) in merged([one, &theirs]) {
                    let [one, theirs] = values.map(|value| visible_start(&value_text(&value)));
                    differences.push(format!("{} is {one} and {theirs}", visible_start(&key)));
                }
            }
            // A difference that all strata have would otherwise be listed for each of them.
            differences.dedup();
            if !differences.is_empty() {
                let more = differences.len().saturating_sub(MAX_NAMED);
                differences.truncate(MAX_NAMED);
                differences.extend((more > 0).then(|| format!("and {more} more")));
                return Err(RankingError::OtherRules { names, differences: differences.join("; ") });
            }
            // Those without programs have no limits, so each is held against the first that has some.
            for (key, found) in other.limits_of_programs(&freedom.limits) {
                let (name, existing) = limits.entry(key.clone()).or_insert_with(|| (other.name.clone(), found.clone()));
                if *existing != found {
                    let [one, theirs] = [&*existing, &found].map(|values| {
                        visible_start(&values.iter().map(String::as_str).collect::<Vec<_>>().join(" or "))
                    });
                    let differences = format!("{key} of their programs is {one} and {theirs}");
                    return Err(RankingError::OtherRules { names: [name.clone(), other.name.clone()], differences });
                }
            }
        }
        Ok(())
    }
}

/// Differences between the programs that made two batches, and in the memory that each run might take.
fn program_differences(plans: [&RecordedPlan; 2]) -> Vec<String> {
    let [one, other] = plans;
    let mut differences = Vec::new();
    if one.program_version != other.program_version {
        let [one, other] = [one, other].map(|plan| visible_start(&plan.program_version));
        differences.push(format!("the program's version is {one} and {other}"));
    }
    if one.memory != other.memory {
        differences.push(format!("the memory of a run is {} and {}", one.memory, other.memory));
    }
    differences
}

impl EntryRuns<'_> {
    /// Returns the conditions that the entry's runs share, such as `runs/a/runs.csv, planner prm-rs`.
    pub fn description(&self) -> String {
        let path = visible_start(&self.table.path.display().to_string());
        let levels =
            self.levels.iter().map(|(name, level)| format!(", {} {}", visible_start(name), visible_start(level)));
        path + &levels.collect::<String>()
    }

    /// Returns the planner of the entry's trucks; empty if its runs differ in it, or there is no such column.
    pub fn planner(&self) -> &str {
        let column = self.table.conditions.iter().find(|condition| condition.name == "planner");
        let mut levels = column.into_iter().flat_map(|column| self.runs.iter().map(|run| column.level_of(run.index)));
        let first = levels.next().unwrap_or_default();
        if levels.all(|level| level == first) { first } else { "" }
    }

    /// The scenarios of its runs, each once.
    fn scenarios(&self) -> impl Iterator<Item = Json> {
        let variants: BTreeSet<usize> = self.runs.iter().map(|run| self.settings.variant_of(run.index)).collect();
        variants.into_iter().map(|variant| self.scenario(variant))
    }

    fn scenario(&self, variant: usize) -> Json {
        serde_json::from_str(&self.settings.plan().variants[variant].scenario).expect("it was written as JSON")
    }

    /// The scenario of each stratum without what is an entry's own.
    fn rules(&self, strata: usize, free: &FreeKeys) -> Vec<Json> {
        let mut variants = vec![None; strata];
        self.runs.iter().for_each(|run| variants[run.stratum] = Some(self.settings.variant_of(run.index)));
        variants.into_iter().flatten().map(|variant| rules_of(self.scenario(variant), free)).collect()
    }

    /// The limits of the programs that play for it, except those that are free.
    fn limits_of_programs(&self, free: &FreeKeys) -> LimitsOfPrograms {
        let mut limits = LimitsOfPrograms::new();
        for scenario in self.scenarios() {
            for (key, values) in limits_of_programs(&scenario, free) {
                limits.entry(key).or_default().extend(values);
            }
        }
        limits
    }
}

/// The entries of a table: its runs by all that varies in it and may differ between entries.
fn divided<'a>(
    table: &'a RunsTable,
    settings: &'a RecordedSettings,
    selection: &Selection,
    free: &FreeKeys,
) -> Result<Vec<EntryRuns<'a>>, RankingError> {
    let side = whole(table, selection)?;
    let conditions: Vec<&RunCondition> =
        side.varying().into_iter().filter(|it| free.belongs_to_entry(&it.name)).collect();
    let mut index_of: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    let mut entries: Vec<EntryRuns<'a>> = Vec::new();
    for run in side.runs {
        let levels: Vec<u32> = conditions.iter().map(|condition| condition.of_run[run]).collect();
        let index = *index_of.entry(levels).or_insert_with(|| {
            let levels = conditions.iter().map(|it| (it.name.clone(), it.level_of(run).to_owned())).collect();
            // Named later, when it is seen in what the entries of all tables differ.
            entries.push(EntryRuns { name: String::new(), table, settings, levels, runs: Vec::new() });
            entries.len() - 1
        });
        // The check is part of reading: a column with another value in each run would make an entry of every row.
        if entries.len() > super::MAX_ENTRIES {
            return Err(RankingError::TooMany { count: entries.len(), limit: super::MAX_ENTRIES });
        }
        entries[index].runs.push(RankedRun { seed: table.seeds[run], stratum: 0, index: run });
    }
    Ok(entries)
}

/// Names the entries: by their names in a course, by what varies in their table, by its folder if it is one of several, and by its path if that does
/// not tell them apart.
fn name_entries(entries: &mut [EntryRuns<'_>]) -> Result<(), RankingError> {
    let is_one_table = entries.windows(2).all(|both| std::ptr::eq(both[0].table, both[1].table));
    let by_levels: fn(&EntryRuns<'_>) -> String = if is_one_table { name_by_levels } else { name_by_entry };
    let ways: [fn(&EntryRuns<'_>) -> String; 4] = [name_by_entry, by_levels, name_by_folder, name_by_path];
    for way in ways {
        let names: Vec<String> = entries.iter().map(way).collect();
        let distinct: BTreeSet<&String> = names.iter().collect();
        if distinct.len() == names.len() && !names.iter().any(String::is_empty) {
            entries.iter_mut().zip(names).for_each(|(entry, name)| entry.name = name);
            return Ok(());
        }
    }
    // Even the paths are equal, so one table was given twice.
    let names: Vec<String> = entries.iter().map(name_by_path).collect();
    let twice = names.iter().enumerate().find(|(index, name)| names[..*index].contains(name));
    Err(RankingError::EntryTwice { name: twice.map_or_else(String::new, |(_, name)| name.clone()) })
}

fn levels_text(entry: &EntryRuns<'_>) -> String {
    if let Some((_, level)) = entry.levels.iter().find(|(name, _)| name == ENTRY_COLUMN) {
        return visible_start(level);
    }
    let texts = entry.levels.iter().map(|(name, level)| match COLUMNS_OF_ENTRIES.contains(&name.as_str()) {
        true => visible_start(level),
        false => format!("{} {}", visible_start(name), visible_start(level)),
    });
    texts.collect::<Vec<_>>().join(", ")
}

fn at_place(place: String, levels: String) -> String {
    if levels.is_empty() { place } else { format!("{place} {levels}") }
}

fn folder_name(entry: &EntryRuns<'_>) -> String {
    let path = entry.table.path.parent().and_then(Path::file_name);
    path.map_or_else(|| "runs.csv".into(), |name| visible_start(&name.to_string_lossy()))
}

/// The entry's name in a course, also of a batch with this entry only; empty if it has none.
fn name_by_entry(entry: &EntryRuns<'_>) -> String {
    let column = entry.table.conditions.iter().find(|condition| condition.name == ENTRY_COLUMN);
    let first = column.zip(entry.runs.first());
    first.map_or_else(String::new, |(column, run)| visible_start(column.level_of(run.index)))
}

fn name_by_levels(entry: &EntryRuns<'_>) -> String {
    match levels_text(entry) {
        text if text.is_empty() => visible_start(entry.planner()),
        text => text,
    }
}

fn name_by_folder(entry: &EntryRuns<'_>) -> String {
    at_place(folder_name(entry), levels_text(entry))
}

fn name_by_path(entry: &EntryRuns<'_>) -> String {
    at_place(visible_start(&entry.table.path.display().to_string()), levels_text(entry))
}

/// Leaves out the entries of these names.
fn leave_out(entries: &mut Vec<EntryRuns<'_>>, without: &[String]) -> Result<(), RankingError> {
    for name in without {
        if !entries.iter().any(|entry| entry.name == *name) {
            let names = entries.iter().map(|entry| entry.name.as_str());
            let nearest = nearest_name(name, names);
            return Err(RankingError::NoEntry { name: visible_start(name), nearest });
        }
    }
    entries.retain(|entry| !without.contains(&entry.name));
    if entries.is_empty() { Err(RankingError::NobodyLeft) } else { Ok(()) }
}

/// Columns that vary within an entry and are no entry's own; in the order of their names.
fn varying_columns(entries: &[EntryRuns<'_>], free: &FreeKeys) -> Vec<String> {
    let columns: BTreeSet<String> = entries
        .iter()
        .flat_map(|entry| {
            let varying = entry.table.conditions.iter().filter(|condition| varies(entry, condition));
            varying
                .map(|condition| condition.name.clone())
                .filter(|name| !free.belongs_to_entry(name))
                .collect::<Vec<_>>()
        })
        .collect();
    columns.into_iter().collect()
}

fn varies(entry: &EntryRuns<'_>, condition: &RunCondition) -> bool {
    let mut levels = entry.runs.iter().map(|run| condition.of_run[run.index]);
    let first = levels.next();
    levels.any(|level| Some(level) != first)
}

/// Numbers the combinations of the columns' values by their order as texts, whoever comes first, and sorts the runs of
/// each entry; every run once.
fn number_strata(entries: &mut [EntryRuns<'_>], columns: &[String]) -> Result<usize, RankingError> {
    let mut numbers: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for entry in entries.iter_mut() {
        let conditions = columns.iter().map(|column| {
            let found = entry.table.conditions.iter().find(|condition| condition.name == *column);
            found.ok_or_else(|| RankingError::NoColumn { entry: entry.name.clone(), column: visible_start(column) })
        });
        let conditions: Vec<&RunCondition> = conditions.collect::<Result<_, _>>()?;
        let mut index_of: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
        for run in &mut entry.runs {
            // As in pairs of a comparison, texts are looked up once for each combination and not once for each run.
            let levels: Vec<u32> = conditions.iter().map(|condition| condition.of_run[run.index]).collect();
            run.stratum = *index_of.entry(levels).or_insert_with(|| {
                let values = conditions.iter().map(|condition| condition.level_of(run.index).to_owned()).collect();
                let next = numbers.len();
                *numbers.entry(values).or_insert(next)
            });
        }
    }
    // Sums go by stratum: numbered by appearance, exchanging two entries would change their last bits.
    let mut by_text = vec![0; numbers.len()];
    numbers.values().enumerate().for_each(|(place, &number)| by_text[number] = place);
    for entry in entries.iter_mut() {
        entry.runs.iter_mut().for_each(|run| run.stratum = by_text[run.stratum]);
        entry.runs.sort_unstable();
        if let Some(both) =
            entry.runs.windows(2).find(|both| (both[0].seed, both[0].stratum) == (both[1].seed, both[1].stratum))
        {
            return Err(ComparisonError::SeedTwice { path: entry.table.path.clone(), seed: both[0].seed }.into());
        }
    }
    Ok(numbers.len())
}
