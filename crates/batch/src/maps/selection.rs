//! The runs of a batch that a map includes.

use std::path::Path;

use crate::execute::panics;
use crate::maps::MapsError;
use crate::plan::{PlannedRun, RunPlace, Variant, is_same_value, planner_of};
use crate::table::FinishedBatch;
use wildfire_scenario::Scenario;
use wildfire_sim::{CustomRegistry, RunOptions};
use wildfire_timeline::{Timeline, file};

/// One variant of a batch.
#[derive(Debug)]
pub struct MapSource {
    batch: FinishedBatch,
    variant: usize,
}

impl MapSource {
    /// Opens the batch in a folder and selects the one variant with these values in these columns.
    ///
    /// # Errors
    /// If it cannot be read, if a column is unknown, or if not exactly one variant is left.
    pub fn open(folder: &Path, only: &[(String, String)]) -> Result<Self, MapsError> {
        let batch = FinishedBatch::open(folder)?;
        let columns = columns(&batch);
        if let Some((unknown, _)) = only.iter().find(|(column, _)| !columns.contains(column)) {
            return Err(MapsError::UnknownColumn {
                folder: folder.to_owned(),
                column: unknown.clone(),
                valid: columns.join(", "),
            });
        }
        let taken = (0..batch.plan().variants.len()).filter(|&index| {
            let values = values(&batch, &batch.plan().variants[index]);
            only.iter().all(|(column, value)| {
                let found = columns.iter().zip(&values).find(|(name, _)| *name == column);
                // Values are compared and not texts, as 0.10 in a command is the 0.1 of the plan.
                found.is_some_and(|(_, found)| is_same_value(found, value))
            })
        });
        let taken: Vec<usize> = taken.collect();
        match taken[..] {
            [variant] => Ok(Self { batch, variant }),
            ref several => {
                // Without a match all variants are listed, among them the one that was meant.
                let all = if several.is_empty() { (0..batch.plan().variants.len()).collect() } else { taken.clone() };
                let titles = all.iter().map(|&index| batch.plan().title(&batch.plan().variants[index]));
                Err(MapsError::WhichVariant {
                    folder: folder.to_owned(),
                    count: several.len(),
                    titles: titles.collect(),
                    columns: varying(&batch, &all).join(", "),
                })
            }
        }
    }

    pub fn batch(&self) -> &FinishedBatch {
        &self.batch
    }

    /// Returns the scenario of its runs.
    pub fn scenario(&self) -> &Scenario {
        &self.batch.plan().variants[self.variant].scenario
    }

    /// Returns the batch's folder as its name, with the variant if there are several.
    pub fn title(&self) -> String {
        let folder = self.batch.folder().display();
        let plan = self.batch.plan();
        match plan.variants.as_slice() {
            [_] => folder.to_string(),
            variants => format!("{folder}, {}", plan.title(&variants[self.variant])),
        }
    }

    /// Returns the number of its runs.
    pub fn count(&self) -> u64 {
        self.batch.plan().seeds_of(self.variant)
    }

    /// Iterates over its runs in the order of the plan.
    pub fn runs(&self) -> impl Iterator<Item = PlannedRun<'_>> {
        let plan = self.batch.plan();
        (0..self.count()).map(move |seed| plan.run(plan.number(RunPlace { variant: self.variant, seed })))
    }

    /// Returns the run of a seed, or the first one.
    ///
    /// # Errors
    /// If it has no such seed.
    pub fn run(&self, seed: Option<u64>) -> Result<PlannedRun<'_>, MapsError> {
        let mut runs = self.runs();
        let found = match seed {
            Some(seed) => runs.find(|run| run.seed == seed),
            None => runs.next(),
        };
        found.ok_or_else(|| MapsError::NoSuchSeed {
            folder: self.batch.folder().to_owned(),
            seed: seed.unwrap_or_default(),
            seeds: self.batch.plan().seeds.to_string(),
        })
    }
}

/// The facts of a run, and whether they were read from its recording.
pub type FoundRun = (Timeline, bool);

impl MapSource {
    /// Reads the recording of a run or repeats the run; `None` if it could not take place.
    ///
    /// # Errors
    /// If the recording cannot be read or is of another run.
    pub fn timeline(&self, run: &PlannedRun<'_>, registry: &CustomRegistry) -> Result<Option<FoundRun>, MapsError> {
        if let Some(path) = self.batch.recording(run) {
            let timeline = file::read(&path).map_err(|source| MapsError::Unreadable { path: path.clone(), source })?;
            let scenario = timeline.setting.scenario.clone();
            let seed = timeline.setting.seed;
            // A recording may have been replaced by one of another batch.
            if seed != run.seed || scenario != run.variant.scenario.name {
                return Err(MapsError::OtherRun { path, scenario, seed, expected: run.seed });
            }
            return Ok(Some((timeline, true)));
        }
        // Under the limit of the plan, by which a run may fail.
        let options = RunOptions { memory: self.batch.plan().memory, ..registry.clone().into() };
        let again = panics::catch(|| wildfire_sim::run_with_options(&run.variant.scenario, run.seed, &options));
        Ok(again.ok().and_then(Result::ok).map(|run| (run.timeline, false)))
    }
}

/// The columns by which variants can be distinguished, as tables name them.
fn columns(batch: &FinishedBatch) -> Vec<String> {
    let swept = batch.plan().swept_keys.iter().cloned();
    ["scenario", "planner"].map(str::to_owned).into_iter().chain(swept).collect()
}

fn values(batch: &FinishedBatch, variant: &Variant) -> Vec<String> {
    debug_assert_eq!(variant.swept.len(), batch.plan().swept_keys.len(), "a plan has a value for each key");
    let swept = variant.swept.iter().map(ToString::to_string);
    [variant.scenario.name.clone(), planner_of(&variant.scenario)].into_iter().chain(swept).collect()
}

/// The columns in which some variants differ.
fn varying(batch: &FinishedBatch, variants: &[usize]) -> Vec<String> {
    let all: Vec<Vec<String>> = variants.iter().map(|&index| values(batch, &batch.plan().variants[index])).collect();
    let columns = columns(batch).into_iter().enumerate();
    let differing = columns.filter(|(column, _)| all.iter().any(|values| values[*column] != all[0][*column]));
    differing.map(|(_, name)| name).collect()
}

/// Runs of equal seeds, one of each source.
pub struct RunGroups<'a> {
    pub groups: Vec<Vec<PlannedRun<'a>>>,
    /// The number of seeds without a partner.
    pub unpaired: u64,
}

/// Groups runs of equal seeds in the order of the first source.
pub fn groups<'a>(sources: &[&'a MapSource]) -> Result<RunGroups<'a>, MapsError> {
    let [first, second] = sources else {
        return Ok(RunGroups { groups: sources[0].runs().map(|run| vec![run]).collect(), unpaired: 0 });
    };
    let mut partners: Vec<PlannedRun<'a>> = second.runs().collect();
    // With one side sorted, each partner is found by bisection; seeds may be listed in another order on either side.
    partners.sort_by_key(|run| run.seed);
    let pairs: Vec<Vec<PlannedRun<'a>>> = first
        .runs()
        .filter_map(|run| {
            let partner = partners.binary_search_by_key(&run.seed, |partner| partner.seed).ok()?;
            Some(vec![run, partners[partner]])
        })
        .collect();
    if pairs.is_empty() {
        let [first, second] = [first, second].map(|source| (source.title(), source.batch.plan().seeds.to_string()));
        return Err(MapsError::NoPairs { first, second });
    }
    let unpaired = first.count() + second.count() - 2 * pairs.len() as u64;
    Ok(RunGroups { groups: pairs, unpaired })
}
