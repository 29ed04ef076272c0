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
use std::path::PathBuf;

use rayon::prelude::*;
use serde::Serialize;

pub use document::{decimals, ranks};
pub use error::RankingError;
pub use groups::MAX_ENTRIES;

use crate::comparison::contrast::{NumberPair, lifetime, number_of};
use crate::comparison::metric::{Metric, MetricKind};
use crate::comparison::runs_table::{self, RunsTable};
use crate::comparison::settings::{RecordedSettings, seeds_text};
use crate::comparison::sides::Selection;
use crate::comparison::wording::listed;
use crate::comparison::{Contrast, LEVEL, adjusted};
use crate::plan::FreeParameters;
pub use crate::plan::USUALLY_FREE;
use crate::stats::Series;
use crate::table::Better;
use crate::table::QueryTally;
use entries::{Entries, EntryRuns, RankRules};
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
    pub mean: f64,
    pub failed: usize,
    /// Finished runs without a value of the metric.
    pub without_value: usize,
    /// The queries of all of its runs.
    pub queries: QueryTally,
    /// Failed queries by reason, such as `timed_out`, without reasons that never occurred.
    pub failures: Vec<(String, u64)>,
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
    /// The p-value adjusted by Holm's method over all pairs; 1 if no run differs.
    pub p_adjusted: f64,
}

impl RankedPair {
    /// Returns whether there is evidence that the entries differ.
    pub fn is_significant(&self) -> bool {
        self.p_adjusted <= LEVEL
    }
}

impl Ranking {
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
            without_value: without_value(entry, &metric, of_metric.len()) - failed,
            queries: queries_of(entry),
            failures: failures_of(entry),
            table: entry.table.path.clone(),
            run_numbers: best_first(entry, &numbers, better),
            worst_runs: worst_runs(entry, &numbers, better),
            ..RankedEntry::default()
        };
        RankInput { entry, numbers }
    });
    // All entries played the same runs, so those of the first stand for all.
    let runs: Vec<(u64, usize)> = entries.entries[0].runs.iter().map(|run| (run.seed, run.stratum)).collect();
    let by = (entries.strata > 1).then(|| listed(&entries.columns));
    let (ranked, pairs) = ranked(contenders.collect(), &runs, by, &metric, better);
    let first = &entries.entries[0];
    Ok(Ranking {
        better,
        runs: first.runs.len(),
        seeds: seeds_text(first.runs.iter().map(|run| run.seed)),
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
    if finite().next().is_none() && rows.iter().flatten().any(Option::is_some) {
        return Err(RankingError::NoValues { metric: metric.name.to_string() });
    }
    let worst = match (&metric.kind, better) {
        (MetricKind::Answer { .. }, Better::Lower) => 1.0,
        (_, Better::Higher) => finite().fold(0.0, f64::min),
        (_, Better::Lower) => finite().fold(0.0, f64::max),
    };
    let mut missing = numbers.iter_mut().flatten().filter(|number| number.is_nan()).peekable();
    let is_used = missing.peek().is_some();
    missing.for_each(|number| *number = worst);
    Ok((numbers, is_used.then_some(worst)))
}

/// An entry that is not ranked yet, and its number in each run.
pub(crate) struct RankInput {
    pub entry: RankedEntry,
    pub numbers: Vec<f64>,
}

/// Puts entries in order and gives them their means, ranks and groups; `runs` are the seeds and strata of all of them, and
/// `by` is what the strata differ in, if there are several.
pub(crate) fn ranked(
    mut contenders: Vec<RankInput>,
    runs: &[(u64, usize)],
    by: Option<String>,
    metric: &Metric,
    better: Better,
) -> (Vec<RankedEntry>, Vec<RankedPair>) {
    for RankInput { entry, numbers } in &mut contenders {
        entry.mean = Series::from_values(numbers).mean().expect("every entry has runs");
    }
    contenders.sort_by(|one, other| {
        let (one, other) = (&one.entry, &other.entry);
        let by_mean = better.best_first(one.mean, other.mean);
        by_mean.then_with(|| one.failed.cmp(&other.failed)).then_with(|| one.name.cmp(&other.name))
    });
    let pairs = pairs(&contenders, runs, by, metric);
    let significance = Significance::new(
        contenders.len(),
        pairs.iter().filter(|it| it.is_significant()).map(|it| (it.places[0], it.places[1])),
    );
    let letters = significance.letters();
    let entries = contenders.into_iter().enumerate().map(|(place, RankInput { entry, .. })| RankedEntry {
        ranks: significance.ranks(place, |one, other| one.cmp(&other) == Ordering::Less),
        groups: letters.as_ref().map(|letters| letters[place].clone()),
        ..entry
    });
    (entries.collect(), pairs)
}

/// Contrasts all pairs of contenders in their order.
fn pairs(contenders: &[RankInput], runs: &[(u64, usize)], by: Option<String>, metric: &Metric) -> Vec<RankedPair> {
    let count = contenders.len();
    let places: Vec<[usize; 2]> =
        (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second])).collect();
    let contrasts = places.par_iter().map(|places| {
        let [ours, theirs] = places.map(|place| &contenders[place].numbers);
        let numbers = ours.iter().zip(theirs);
        let pairs = runs.iter().zip(numbers).map(|(&(seed, stratum), (&ours, &theirs))| NumberPair {
            seed,
            stratum,
            numbers: [ours, theirs],
        });
        Contrast::from_numbers(metric, pairs.collect(), by.clone()).expect("every entry has runs").contrast
    });
    let contrasts: Vec<Contrast> = contrasts.collect();
    let p_values = adjusted(contrasts.iter().map(|contrast| Some(contrast.p_value.unwrap_or(1.0))));
    let pairs = places.into_iter().zip(contrasts).zip(p_values);
    pairs
        .map(|((places, contrast), p)| RankedPair { places, contrast, p_adjusted: p.expect("all pairs have one") })
        .collect()
}
