//! Rankings: all entries of a contest compared with each other, in one table with ranks and groups.
//!
//! An entry is a batch, or the runs of a batch with one planner, one policy, or one value of any other key in which
//! entries may differ. All have runs of the same seeds under the same rules; anything else is refused.
//!
//! The order is that of the means of a metric. A run that failed, or in which there is nothing to measure, counts as the
//! worst value that any run of any entry has; where higher is better, that is at most 0, where lower is better, at least
//! 0. So no run and no pair is left out. Differences are those of [`compare`](super::compare), pair by pair, their
//! p-values adjusted by Holm's method over all pairs of entries. From them follow the ranks that are possible and the
//! groups of entries that are not significantly different, see `groups.rs`.

mod document;
mod entries;
mod error;
mod groups;
mod json;

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::PathBuf;

use rayon::prelude::*;
use serde::Serialize;

pub use document::{decimals, ranks};
pub(crate) use entries::RunKey;
pub use error::RankingError;
pub use groups::MAX_ENTRIES;

use crate::comparison::contrast::{NumberPair, lifetime, number_of};
use crate::comparison::metric::{Metric, MetricKind};
use crate::comparison::runs_table::{self, RunsTable};
use crate::comparison::settings::{RecordedSettings, seeds_text};
use crate::comparison::sides::Selection;
use crate::comparison::wording::listed;
use crate::comparison::{Contrast, LEVEL, adjusted};
pub use crate::plan::USUALLY_FREE;
use crate::plan::{FreeParameters, RecordedPlan, StoppingGoal, StoppingRule};
use crate::stats::{Interval, Series};
use crate::table::Better;
use crate::table::QueryTally;
use entries::{Entries, EntryRuns, RankRules, RankedRun};
use groups::Significance;

/// The metric by which entries are ranked by default.
pub const USUAL_METRIC: &str = "saved";

/// The most runs that are kept for their bad values.
const MAX_WORST_RUNS: usize = 3;

/// The requested order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RankingRequest {
    /// The metric; [`USUAL_METRIC`] if there is none.
    pub metric: Option<String>,
    /// The side of the better values; by default that of the metric.
    pub better: Option<Better>,
    /// The keys in which entries may differ, besides [`USUALLY_FREE`].
    pub free: Vec<String>,
    /// Columns, with the value that runs must have in each.
    pub only: Vec<(String, String)>,
    /// The names of entries that are left out.
    pub without: Vec<String>,
}

/// Entries ordered by a metric.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    pub metric: Metric,
    pub better: Better,
    /// The number of runs per entry.
    pub runs: usize,
    /// The seeds of every entry, such as `1..5,9`.
    pub seeds: String,
    /// The columns that vary within each entry; every mean is taken over their combinations.
    pub columns: Vec<String>,
    /// The number of these combinations.
    pub strata: usize,
    /// The value assigned to runs without one; `None` if there is no such run.
    pub worst: Option<f64>,
    /// The rule that stopped the entries, and after how many seeds; `None` if their number was fixed before.
    pub stop: Option<String>,
    /// The entries, best first; entries of equal means in the order of their failures and names.
    pub entries: Vec<RankedEntry>,
    /// All pairs of entries, by their places in `entries`, better entry first.
    pub pairs: Vec<RankedPair>,
}

/// An entry and its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RankedEntry {
    pub name: String,
    /// The table that contains its runs, and the values that they share.
    pub description: String,
    /// The planner; empty if its runs differ in it.
    pub planner: String,
    /// The first and the last possible rank, from 1.
    pub ranks: [usize; 2],
    /// The letters of its groups; `None` if there are more groups than letters.
    pub groups: Option<String>,
    /// The mean of its runs; of an entry that stopped before others, that of the best entry with all runs and its difference
    /// from it.
    pub mean: f64,
    pub runs: usize,
    pub failed: usize,
    /// Finished runs without a value of the metric.
    pub without_value: usize,
    /// The queries of all of its runs.
    pub queries: QueryTally,
    /// Failed queries by reason, such as `timed_out`, without reasons that never occurred.
    pub failures: Vec<(String, u64)>,
    /// The reason of its first failed run.
    pub first_failure: Option<String>,
    /// The table that contains its runs.
    pub table: PathBuf,
    /// The numbers of its runs in their plan, best values of the metric first.
    pub run_numbers: Vec<u64>,
    /// Its runs with the worst values, worst first.
    pub worst_runs: Vec<WorstRun>,
    /// The audit of some of its runs, if requested.
    pub audit: Option<EntryAudit>,
}

/// A bad run of an entry.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstRun {
    pub seed: u64,
    /// Its value of the metric, or the one assigned to it.
    pub value: f64,
    /// Its row in the table, from 0.
    pub row: usize,
}

/// The result of an audit of some runs of an entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryAudit {
    pub runs: u64,
    /// Runs that violate a rule, or whose rows differ from the runs.
    pub violations: u64,
    /// The first violation in words.
    pub first_violation: Option<String>,
}

/// Two entries compared.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedPair {
    /// Places in [`Ranking::entries`], the smaller one first.
    pub places: [usize; 2],
    /// The difference, second entry minus first.
    pub contrast: Contrast,
    /// The p-value adjusted by Holm's method over all pairs, 1 if no run differs; `None` if a rule stopped the runs.
    pub p_adjusted: Option<f64>,
    /// True if there is evidence that the entries differ.
    pub is_significant: bool,
}

/// The way in which the number of an entry's runs was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleSize {
    Fixed,
    /// By a rule that asked something of pairs of entries.
    ByPairs,
    /// By a rule that dropped entries that were worse than the best.
    ByElimination,
}

impl SampleSize {
    /// Says how the runs of plans were chosen.
    fn of_plans<'a>(plans: impl Iterator<Item = &'a RecordedPlan>) -> Self {
        let goals: Vec<_> = plans.filter_map(|plan| plan.until.as_ref().map(|rule| rule.goal)).collect();
        match goals[..] {
            [] => Self::Fixed,
            [StoppingGoal::Groups { .. }] => Self::ByElimination,
            _ => Self::ByPairs,
        }
    }

    /// Returns the error of the interval of a pair among this number of entries.
    fn error(self, places: [usize; 2], entries: usize) -> f64 {
        let is_with_best = self == Self::ByElimination && places[0] == 0;
        StoppingRule::error_of_each(if is_with_best { entries - 1 } else { entries * (entries - 1) / 2 })
    }
}

impl Ranking {
    /// Returns whether some entries stopped before others.
    pub(crate) fn has_stopped_entries(&self) -> bool {
        self.entries.iter().any(|entry| entry.runs < self.runs)
    }

    /// Returns the pair of an entry with a better one.
    pub fn pair(&self, better: usize, worse: usize) -> Option<&RankedPair> {
        self.pairs.iter().find(|pair| pair.places == [better, worse])
    }
}

/// Ranks batches, given as folders or tables of runs.
///
/// # Errors
/// If one cannot be read, or if entries had other seeds or rules than others.
pub fn rank(paths: &[PathBuf], request: &RankingRequest) -> Result<Ranking, RankingError> {
    let files = paths.iter().map(|path| runs_table::open(path)).collect::<Result<Vec<_>, _>>()?;
    let name = request.metric.clone().unwrap_or_else(|| USUAL_METRIC.into());
    let metric = Metric::choose(&[name], &files)?.remove(0);
    // Metrics of the program know which way is better; a column of the user's may not.
    let better = request.better.or(metric.about.better);
    let better = better.ok_or_else(|| RankingError::WhichIsBetter { metric: metric.name.to_string() })?;
    let of_metric = metric.fields();
    // Only the columns of the metric are read: tables may have millions of rows.
    let tables =
        files.into_iter().map(|file| RunsTable::read(file, &of_metric)).collect::<Result<Vec<RunsTable>, _>>()?;
    let settings = tables.iter().map(|table| {
        let settings = RecordedSettings::read(table);
        settings.map_err(|reason| RankingError::RulesUnknown { path: table.path.clone(), reason })
    });
    let settings = settings.collect::<Result<Vec<_>, _>>()?;
    // A key that only one course frees was fixed for the entries of the others.
    // Entries may differ in a key that the rules of a course free, if all of them played by such rules.
    let of_courses =
        settings[0].plan().free.iter().filter(|key| settings.iter().all(|it| it.plan().free.contains(key)));
    let free_keys: Vec<&str> = request.free.iter().chain(of_courses).map(String::as_str).collect();
    let admission = RankRules { freedom: FreeParameters::parse(&free_keys)?, without: request.without.clone() };
    let selection = Selection { by: None, only: request.only.clone() };
    let entries = Entries::new(&tables, &settings, &selection, &admission)?;

    let (numbers, worst) = numbers(&entries.entries, &metric, of_metric.len(), better)?;
    let contenders = entries.entries.iter().zip(numbers).map(|(entry, numbers)| {
        let failed = failed(entry);
        let entry = RankedEntry {
            name: entry.name.clone(),
            description: entry.description(),
            planner: entry.planner().to_owned(),
            failed,
            runs: entry.runs.len(),
            // Failed runs have no value either, and are counted by themselves.
            without_value: without_value(entry, &metric, of_metric.len()) - failed,
            queries: queries_of(entry),
            failures: failures_of(entry),
            first_failure: entry.runs.iter().find_map(|run| entry.table.messages.get(&run.index).cloned()),
            table: entry.table.path.clone(),
            // Runs go in the order of goodness, so that a reader finds the best and the worst run of an entry to play.
            run_numbers: best_first(entry, &numbers, better),
            worst_runs: worst_runs(entry, &numbers, better),
            ..RankedEntry::default()
        };
        RankInput { entry, numbers }
    });
    // All entries played the same runs, or the first of them.
    let longest = entries.entries.iter().max_by_key(|entry| entry.runs.len()).expect("there are entries");
    let runs: Vec<RunKey> = longest.runs.iter().map(RankedRun::key).collect();
    let contenders = contenders.zip(&entries.entries).map(|(contender, entry)| contender.aligned(entry, &runs));
    let by = (entries.strata > 1).then(|| listed(&entries.columns));
    let counts = SampleSize::of_plans(settings.iter().map(RecordedSettings::plan));
    let (ranked, pairs) = ranked(contenders.collect(), &runs, by, RankBasis { metric: &metric, better, counts });
    Ok(Ranking {
        better,
        runs: longest.runs.len(),
        seeds: seeds_text(longest.runs.iter().map(|run| run.seed)),
        stop: settings.iter().find_map(|it| it.plan().stop.clone()),
        columns: entries.columns.clone(),
        strata: entries.strata,
        worst,
        entries: ranked,
        pairs,
        metric,
    })
}

/// Returns the numbers of an entry's runs in their plan, the best values first.
fn best_first(entry: &EntryRuns<'_>, values: &[f64], better: Better) -> Vec<u64> {
    let mut runs: Vec<(f64, u64)> =
        values.iter().copied().zip(entry.runs.iter().map(|run| entry.table.numbers[run.index])).collect();
    runs.sort_by(|(one, _), (other, _)| better.best_first(*one, *other));
    runs.into_iter().map(|(_, number)| number).collect()
}

fn queries_of(entry: &EntryRuns<'_>) -> QueryTally {
    let mut queries = QueryTally::default();
    entry.runs.iter().for_each(|run| queries += entry.table.queries[run.index]);
    queries
}

fn failures_of(entry: &EntryRuns<'_>) -> Vec<(String, u64)> {
    let sums = entry.table.failures.iter().map(|(reason, counts)| {
        let sum = entry.runs.iter().fold(0, |sum: u64, run| sum.saturating_add(counts[run.index]));
        (reason.clone(), sum)
    });
    sums.filter(|(_, sum)| *sum > 0).collect()
}

fn worst_runs(entry: &EntryRuns<'_>, numbers: &[f64], better: Better) -> Vec<WorstRun> {
    let runs = entry.runs.iter().zip(numbers);
    let mut runs: Vec<_> = runs.map(|(run, &value)| WorstRun { seed: run.seed, value, row: run.index }).collect();
    // Runs of equal values stay in the order of their seeds.
    runs.sort_by(|one, other| better.best_first(other.value, one.value));
    runs.truncate(MAX_WORST_RUNS);
    runs
}

fn failed(entry: &EntryRuns<'_>) -> usize {
    entry.runs.iter().filter(|run| !entry.table.done[run.index]).count()
}

/// Returns the values of a run in the columns of the metric; none of a run that failed.
fn row(entry: &EntryRuns<'_>, run: usize, columns: usize) -> Option<Vec<f64>> {
    entry.table.done[run].then(|| (0..columns).map(|column| entry.table.values[column][run]).collect())
}

fn without_value(entry: &EntryRuns<'_>, metric: &Metric, columns: usize) -> usize {
    let has_none =
        |run: usize| row(entry, run, columns).is_none_or(|row| number_of(metric, &row, f64::INFINITY).is_nan());
    entry.runs.iter().filter(|run| has_none(run.index)).count()
}

/// Returns the metric of every run of every entry, and the number that was taken where there is none.
fn numbers(
    entries: &[EntryRuns<'_>],
    metric: &Metric,
    columns: usize,
    better: Better,
) -> Result<(Vec<Vec<f64>>, Option<f64>), RankingError> {
    let rows: Vec<Vec<Option<Vec<f64>>>> =
        entries.iter().map(|entry| entry.runs.iter().map(|run| row(entry, run.index, columns)).collect()).collect();
    // Times that were cut off are known up to the first cut only, for all entries alike.
    let cut_off = rows.iter().flatten().flatten().filter(|_| matches!(metric.kind, MetricKind::Time { .. }));
    let cut_off = cut_off.filter_map(|row| lifetime(row)).filter(|lifetime| lifetime.is_cut_off);
    let horizon = cut_off.map(|lifetime| lifetime.time).fold(f64::INFINITY, f64::min);
    let numbers = rows.iter().map(|rows| {
        let of_runs = rows.iter().map(Option::as_ref);
        of_runs.map(|row| row.map_or(f64::NAN, |row| number_of(metric, row, horizon))).collect()
    });
    let mut numbers: Vec<Vec<f64>> = numbers.collect();
    let finite = || numbers.iter().flatten().copied().filter(|number| !number.is_nan());
    // Where every run failed, all entries tie at the worst value; where runs finished without one, the metric is the wrong one.
    if finite().next().is_none() && rows.iter().flatten().any(Option::is_some) {
        return Err(RankingError::NoValues { metric: metric.name.to_string() });
    }
    // The worst answer is known without data, so a failed run is worse than one that answered well in any case.
    let worst = match (&metric.kind, better) {
        (MetricKind::Answer { .. }, Better::Lower) => 1.0,
        // It is at most 0: with a worst value above it, an entry that fails everywhere could tie with one that scores little.
        (_, Better::Higher) => finite().fold(0.0, f64::min),
        (_, Better::Lower) => finite().fold(0.0, f64::max),
    };
    let mut missing = numbers.iter_mut().flatten().filter(|number| number.is_nan()).peekable();
    let is_used = missing.peek().is_some();
    missing.for_each(|number| *number = worst);
    Ok((numbers, is_used.then_some(worst)))
}

/// An entry that is not ranked yet, and its number in each run; NaN in runs that it did not play.
pub(crate) struct RankInput {
    pub entry: RankedEntry,
    pub numbers: Vec<f64>,
}

impl RankInput {
    /// Puts the numbers, which are those of the entry's runs, to the places of all runs.
    fn aligned(self, entry: &EntryRuns<'_>, runs: &[RunKey]) -> Self {
        let number_of: BTreeMap<RunKey, f64> = entry.runs.iter().map(RankedRun::key).zip(self.numbers).collect();
        let numbers = runs.iter().map(|key| number_of.get(key).copied().unwrap_or(f64::NAN)).collect();
        Self { entry: self.entry, numbers }
    }

    fn has_all_runs(&self) -> bool {
        !self.numbers.iter().any(|number| number.is_nan())
    }
}

/// By what entries are put in order.
pub(crate) struct RankBasis<'a> {
    pub metric: &'a Metric,
    pub better: Better,
    pub counts: SampleSize,
}

/// Puts entries in order and gives them their means, ranks and groups; `runs` are the seeds and strata of all of them, and
/// `by` is what the strata differ in, if there are several.
pub(crate) fn ranked(
    mut contenders: Vec<RankInput>,
    runs: &[RunKey],
    by: Option<String>,
    basis: RankBasis<'_>,
) -> (Vec<RankedEntry>, Vec<RankedPair>) {
    let better = basis.better;
    // Means of entries that a rule stopped early are of easier or harder seeds than those of the others; they follow below.
    for RankInput { entry, numbers } in contenders.iter_mut().filter(|it| it.has_all_runs()) {
        entry.mean = Series::from_values(numbers).mean().expect("every entry has runs");
    }
    give_means_to_stopped(&mut contenders, better);
    contenders.sort_by(|one, other| {
        let (one, other) = (&one.entry, &other.entry);
        let by_mean = better.best_first(one.mean, other.mean);
        // Equal means go by failed runs and then by name, so the order of the arguments does not matter.
        by_mean.then_with(|| one.failed.cmp(&other.failed)).then_with(|| one.name.cmp(&other.name))
    });
    let pairs = pairs(&contenders, runs, by, &basis);
    let significance = Significance::new(
        contenders.len(),
        pairs.iter().filter(|it| it.is_significant).map(|it| (it.places[0], it.places[1])),
    );
    let letters = significance.letters();
    let entries = contenders.into_iter().enumerate().map(|(place, RankInput { entry, .. })| RankedEntry {
        ranks: significance.ranks(place, |one, other| one.cmp(&other) == Ordering::Less),
        groups: letters.as_ref().map(|letters| letters[place].clone()),
        ..entry
    });
    (entries.collect(), pairs)
}

/// Gives entries that stopped before others the mean of the best of those with all runs, and their differences from it:
/// fields differ more than entries, so that means over different seeds cannot be compared.
fn give_means_to_stopped(contenders: &mut [RankInput], better: Better) {
    let whole = contenders.iter().filter(|it| it.has_all_runs());
    let best = whole.min_by(|one, other| better.best_first(one.entry.mean, other.entry.mean));
    let best = best.expect("an entry has all runs");
    let best_mean = best.entry.mean;
    let of_best = best.numbers.clone();
    for RankInput { entry, numbers } in contenders.iter_mut().filter(|it| !it.has_all_runs()) {
        let differences = numbers.iter().zip(&of_best).map(|(number, best)| number - best);
        let differences: Vec<f64> = differences.filter(|difference| !difference.is_nan()).collect();
        entry.mean = best_mean + Series::from_values(&differences).mean().expect("every entry has runs");
    }
}

/// Contrasts all pairs of contenders in their order.
fn pairs(contenders: &[RankInput], runs: &[RunKey], by: Option<String>, basis: &RankBasis<'_>) -> Vec<RankedPair> {
    let RankBasis { metric, counts, .. } = *basis;
    let count = contenders.len();
    let places: Vec<[usize; 2]> =
        (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second])).collect();
    // 100 entries have 4950 pairs, each with its own bootstrap; they are collected in order, so that threads change nothing.
    let contrasts = places.par_iter().map(|places| {
        let [ours, theirs] = places.map(|place| &contenders[place].numbers);
        let numbers = ours.iter().zip(theirs);
        let pairs = runs.iter().zip(numbers).map(|(&RunKey { seed, stratum }, (&ours, &theirs))| NumberPair {
            seed,
            stratum,
            numbers: [ours, theirs],
        });
        // Runs that a stopped entry did not play are NaN, and are no pairs.
        let pairs = pairs.filter(|pair| !pair.numbers.iter().any(|number| number.is_nan())).collect();
        let found = Contrast::from_numbers(metric, pairs, by.clone()).expect("every entry has runs");
        match counts {
            SampleSize::Fixed => found.contrast,
            _ => found.of_stopped_runs(counts.error(*places, count)).contrast,
        }
    });
    let contrasts: Vec<Contrast> = contrasts.collect();
    let is_fixed = counts == SampleSize::Fixed;
    // A pair that is equal in all runs has no p-value, but counts among the tests that Holm's method adjusts for.
    let p_values = adjusted(contrasts.iter().map(|contrast| is_fixed.then(|| contrast.p_value.unwrap_or(1.0))));
    let pairs = places.into_iter().zip(contrasts).zip(p_values);
    pairs
        .map(|((places, contrast), p_adjusted)| {
            // An entry that the rule dropped is known to be worse than the best one of then.
            let was_dropped = counts == SampleSize::ByElimination
                && places[0] == 0
                && contenders[places[1]].entry.runs < contenders[0].entry.runs;
            let excludes_zero = !is_fixed && contrast.interval.is_some_and(Interval::excludes_zero);
            let is_significant = p_adjusted.is_some_and(|p| p <= LEVEL) || excludes_zero || was_dropped;
            RankedPair { places, contrast, p_adjusted, is_significant }
        })
        .collect()
}
