//! Comparisons of batches, or of parts of one: runs of the same seed in pairs.
//!
//! Side A is what the others are compared with. A metric's difference is that of its means over the pairs, the other
//! side's minus A's; its interval and its test are those of [`estimate_mean`](crate::stats::estimate_mean), of yes and
//! no those of [`PairedAnswers`](crate::stats::PairedAnswers), and Wilcoxon's test is given beside them. Where several
//! metrics or sides are compared, p-values are adjusted by Holm's method over all of them, those of means and answers
//! as one family, those of ranks as another; intervals are not. There is evidence of a difference where the adjusted
//! p-value of the mean or the answers is at most 0.05.
//!
//! Where something else varies within the sides, such as the coverage in a comparison of planners, a difference is a
//! mean over its values, the strata. Its interval and tests go by seed, the strata fixed: they are of one number a seed,
//! the mean over its strata. Then every metric is also taken stratum by stratum, and tested for an interaction
//! of side and stratum ([`RepeatedMeasures`] of the differences, seed by seed). The
//! p-values of these tests are a family of their own for Holm's method, and so are those of the strata.
//!
//! The difference of the sides' settings is read from their plans, see [`SettingsDifference`].
//!
//! Pairs in which a run failed are left out, and counted.
//!
//! A comparison also answers how many seeds a difference needs, and whether sides are equal within a margin, see
//! [`Questions`].

mod contrast;
mod document;
mod error;
mod json;
mod metric;
mod pairs;
mod published;
mod published_document;
mod questions;
mod ranking;
mod runs_table;
mod settings;
mod sides;
mod wording;

use std::path::PathBuf;

pub use crate::table::Better;
pub(super) use contrast::contrast_of_pairs;
pub use contrast::{ByStratum, Contrast, CutOff, Method, NumberPair, UntestedContrast};
pub use error::ComparisonError;
pub use metric::{Metric, MetricKind, NAMED_METRICS, NamedMetric};
pub use pairs::{Pairs, Stratum};
pub use published::{PublishedComparison, PublishedState, PublishedTime};
pub use questions::{Amount, PowerAnswer, Questions};
pub use ranking::{
    EntryAudit, MAX_ENTRIES, RankedEntry, RankedPair, Ranking, RankingError, RankingRequest, USUAL_METRIC,
    USUALLY_FREE, WorstRun, decimals, rank, ranks,
};
pub(crate) use ranking::{RankBasis, RankInput, RunKey, SampleSize, ranked};
pub use settings::{Difference, SettingsDifference};
pub use sides::{MAX_SIDES, Selection};

use crate::stats::{Equivalence, Interval, RepeatedMeasures, holm};
use crate::table::QueryTally;
use runs_table::RunsTable;
use settings::RecordedSettings;
use sides::Side;
use wildfire_base::document::number::probability;
pub(crate) use wording::listed;
use wording::{interval_text, sentence};

/// The level of the tests behind a verdict.
const LEVEL: f64 = 0.05;

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The sides; A comes first.
    pub sides: Vec<SideSummary>,
    /// Every other side compared with A.
    pub against_a: Vec<ComparisonToA>,
    /// Metrics that no pair has on both sides, with the letter of the other side.
    pub missing: Vec<(char, String)>,
    /// The additional questions about all metrics.
    pub questions: Questions,
}

impl Comparison {
    /// Returns whether a rule chose the number of runs of a side.
    pub fn is_of_stopped_runs(&self) -> bool {
        self.against_a.iter().flat_map(|against| &against.judged).any(|it| it.contrast.method == Method::Sequence)
    }
}

/// A summary of a side's runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SideSummary {
    pub letter: char,
    pub description: String,
    pub runs: usize,
    pub failed: usize,
    pub queries: QueryTally,
}

impl SideSummary {
    /// Returns sentences about planners that were rescued or stopped by a clock.
    pub fn notes(&self) -> Vec<String> {
        self.queries.sentences(&self.letter.to_string())
    }
}

/// A side compared with A.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonToA {
    pub letter: char,
    pub settings: SettingsDifference,
    pub pairs: Pairs,
    pub judged: Vec<JudgedContrast>,
}

/// A contrast with its verdict among all others.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedContrast {
    pub contrast: Contrast,
    /// The p-value adjusted by Holm's method.
    pub p_adjusted: Option<f64>,
    pub ranks_p_adjusted: Option<f64>,
    pub verdict: Verdict,
    /// The contrasts by stratum, if the difference is a mean over several strata.
    pub by_stratum: Option<JudgedStrata>,
    /// The answer to [`Questions::power`], if the metric has this question and its differences have a spread.
    pub power: Option<PowerAnswer>,
    /// The answer to [`Questions::equivalent`], likewise.
    pub equivalence: Option<Equivalence>,
}

/// A metric by stratum, judged together with all others.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedStrata {
    /// The columns in which the strata differ, in words.
    pub by: String,
    /// The contrasts, each with the index of its stratum in [`Pairs::strata`].
    pub strata: Vec<(usize, JudgedContrast)>,
    /// The number of seeds that the test uses.
    pub seeds: usize,
    pub test: Option<RepeatedMeasures>,
    /// The p-value adjusted by Holm's method, over the tests of all metrics and sides.
    pub p_adjusted: Option<f64>,
}

impl JudgedStrata {
    /// Returns whether there is evidence that the strata differ.
    pub fn differ(&self) -> bool {
        self.p_adjusted.is_some_and(|p| p <= LEVEL)
    }
}

/// The verdict on a contrast.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Difference,
    NoEvidence,
    /// Evidence by itself, but not after the adjustment for the number of tests.
    NotAmongSoMany,
    /// No pair differs.
    Equal,
}

wildfire_base::names! { Verdict {
    Difference: "difference",
    NoEvidence: "no-evidence",
    NotAmongSoMany: "no-evidence-among-several-tests",
    Equal: "equal",
} }

/// Compares batches, given as folders or tables of runs: each with the first one, or the parts of a single one.
///
/// Without names, the usual metrics are compared.
pub fn compare(paths: &[PathBuf], selection: &Selection, metrics: &[String]) -> Result<Comparison, ComparisonError> {
    let (metrics, tables) = read(paths, metrics)?;
    let sides = Side::from_tables(&tables, selection)?;
    let settings: Vec<_> = tables.iter().map(RecordedSettings::read).collect();
    let settings_of = |side: &Side<'_>| {
        // By address, as one folder may be given twice and its tables are then equal.
        let table = tables.iter().position(|table| std::ptr::eq(table, side.table));
        &settings[table.expect("a side is of one of the tables")]
    };
    // One stopped side is enough for the usual intervals to fail; the strictest of several errors holds for all sides.
    let error_of_rules =
        settings.iter().flatten().filter_map(|settings| settings.plan().error_of_rule()).reduce(f64::min);
    let [a, others @ ..] = &sides[..] else { unreachable!("there is a table, and it has runs") };
    let mut missing = Vec::new();
    let mut against_a = Vec::new();
    for other in others {
        let pairs = Pairs::new(a, other)?;
        let settings = SettingsDifference::between([a, other], [settings_of(a), settings_of(other)], &pairs);
        let mut contrasts = Vec::new();
        // The tables have the columns of all metrics one behind the other.
        let mut first_column = 0;
        for metric in &metrics {
            let columns: Vec<usize> = (first_column..first_column + metric.fields().len()).collect();
            first_column += columns.len();
            match Contrast::between(metric, a, other, &pairs, &columns) {
                Some(contrast) => contrasts.push(match error_of_rules {
                    Some(alpha) => contrast.of_stopped_runs(alpha),
                    None => contrast,
                }),
                None => missing.push((other.letter, metric.name.to_string())),
            }
        }
        against_a.push(Untested { letter: other.letter, settings, pairs, contrasts });
    }
    let sides = sides.iter().map(summary).collect();
    // All sides are judged at once, since Holm's adjustment is over all tests that the reader sees.
    Ok(Comparison { sides, against_a: judged(against_a), missing, questions: Questions::default() })
}

/// A side compared with A, before p-values are adjusted.
struct Untested {
    letter: char,
    settings: SettingsDifference,
    pairs: Pairs,
    contrasts: Vec<UntestedContrast>,
}

fn read(paths: &[PathBuf], names: &[String]) -> Result<(Vec<Metric>, Vec<RunsTable>), ComparisonError> {
    let files = paths.iter().map(|path| runs_table::open(path)).collect::<Result<Vec<_>, _>>()?;
    let metrics = Metric::choose(names, &files)?;
    let fields: Vec<_> = metrics.iter().flat_map(Metric::fields).collect();
    let tables = files.into_iter().map(|file| RunsTable::read(file, &fields)).collect::<Result<_, _>>()?;
    Ok((metrics, tables))
}

fn summary(side: &Side<'_>) -> SideSummary {
    let mut queries = QueryTally::default();
    side.runs.iter().for_each(|&run| queries += side.table.queries[run]);
    SideSummary {
        letter: side.letter,
        description: side.description(),
        runs: side.runs.len(),
        failed: side.failed(),
        queries,
    }
}

/// Judges the contrasts of all sides together.
fn judged(against_a: Vec<Untested>) -> Vec<ComparisonToA> {
    let mut judged = judge(against_a.iter().flat_map(|against| against.contrasts.clone()).collect()).into_iter();
    let against_a = against_a.into_iter();
    against_a
        .map(|Untested { letter, settings, pairs, contrasts }| ComparisonToA {
            letter,
            settings,
            pairs,
            judged: judged.by_ref().take(contrasts.len()).collect(),
        })
        .collect()
}

/// Judges contrasts as one family: adjusts their p-values together, and those of all of their strata.
pub(crate) fn judge(contrasts: Vec<UntestedContrast>) -> Vec<JudgedContrast> {
    // The mean over all strata is what was asked; a family with the strata in it would cost it power.
    let mut overall = TestFamily::from_contrasts(contrasts.iter().map(|it| &it.contrast));
    let by_stratum = || contrasts.iter().filter_map(|it| it.by_stratum.as_ref());
    let mut within =
        TestFamily::from_contrasts(by_stratum().flat_map(|it| it.contrasts.iter().map(|(_, contrast)| contrast)));
    // The tests of interaction answer a third question, and are adjusted among themselves.
    let mut tests = adjusted(by_stratum().map(|it| Some(it.test?.p_value))).into_iter();
    contrasts
        .into_iter()
        .map(|UntestedContrast { contrast, by_stratum }| {
            let judged = overall.judge(contrast);
            JudgedContrast {
                by_stratum: by_stratum.map(|ByStratum { by, contrasts, seeds, test }| JudgedStrata {
                    by,
                    strata: contrasts
                        .into_iter()
                        .map(|(stratum, contrast)| (stratum, within.judge(contrast)))
                        .collect(),
                    seeds,
                    test,
                    p_adjusted: tests.next().flatten(),
                }),
                ..judged
            }
        })
        .collect()
}

/// Contrasts that are judged together, in their order: the adjusted p-values of means and answers, and of ranks.
struct TestFamily {
    means: std::vec::IntoIter<Option<f64>>,
    ranks: std::vec::IntoIter<Option<f64>>,
}

impl TestFamily {
    fn from_contrasts<'a>(contrasts: impl Iterator<Item = &'a Contrast> + Clone) -> Self {
        let ranks = contrasts.clone().map(|contrast| Some(contrast.ranks?.p_value));
        Self {
            means: adjusted(contrasts.map(|contrast| contrast.p_value)).into_iter(),
            ranks: adjusted(ranks).into_iter(),
        }
    }

    /// Judges the next contrast.
    fn judge(&mut self, contrast: Contrast) -> JudgedContrast {
        let p_adjusted = self.means.next().flatten();
        let ranks_p_adjusted = self.ranks.next().flatten();
        // Runs of a stopping rule have no p-values: the usual ones do not hold at a number of runs that the data chose.
        let verdict = match contrast.method {
            // The interval of a confidence sequence excludes zero exactly where its test rejects, at every number of seeds.
            Method::Sequence => Verdict::from_interval(contrast.interval),
            _ => Verdict::from_p_values(contrast.p_value, p_adjusted),
        };
        JudgedContrast {
            contrast,
            p_adjusted,
            ranks_p_adjusted,
            verdict,
            by_stratum: None,
            power: None,
            equivalence: None,
        }
    }
}

/// Adjusts the p-values of one family by Holm's method.
pub(crate) fn adjusted(p_values: impl Iterator<Item = Option<f64>>) -> Vec<Option<f64>> {
    let p_values: Vec<_> = p_values.collect();
    let mut adjusted = holm(&p_values.iter().copied().flatten().collect::<Vec<_>>()).into_iter();
    p_values.into_iter().map(|p_value| p_value.and_then(|_| adjusted.next())).collect()
}

impl Verdict {
    fn from_p_values(p_value: Option<f64>, p_adjusted: Option<f64>) -> Self {
        match (p_value, p_adjusted) {
            (Some(_), Some(adjusted)) if adjusted <= LEVEL => Self::Difference,
            (Some(alone), _) if alone <= LEVEL => Self::NotAmongSoMany,
            (Some(_), _) => Self::NoEvidence,
            (None, _) => Self::Equal,
        }
    }
}

impl Verdict {
    fn from_interval(interval: Option<Interval>) -> Self {
        match interval {
            None => Self::Equal,
            Some(interval) if interval.excludes_zero() => Self::Difference,
            Some(_) => Self::NoEvidence,
        }
    }
}

impl JudgedContrast {
    /// Returns the verdict as a sentence without a full stop.
    pub fn sentence(&self, letter: char) -> String {
        let Contrast { metric, difference, interval, pairs, .. } = &self.contrast;
        let found = sentence(&metric.name, metric.about.phrase, letter, *difference, *interval);
        let of_interval =
            |interval| format!("95 % interval for {letter} − A: {}", interval_text(metric.about.phrase, interval));
        let not_sure = interval.map_or_else(|| found.clone(), of_interval);
        let by_ranks = self.by_ranks(letter);
        let text = match self.verdict {
            Verdict::Difference => found,
            Verdict::NoEvidence => format!("no evidence of a difference ({not_sure}){by_ranks}"),
            Verdict::NotAmongSoMany => {
                format!("no evidence of a difference after adjustment for several tests ({not_sure}){by_ranks}")
            }
            Verdict::Equal => format!("equal in all {pairs} pairs"),
        };
        text + &self.dependence()
    }

    /// Says that the difference is not the same in all strata, where that is so.
    fn dependence(&self) -> String {
        match &self.by_stratum {
            Some(strata) if strata.differ() => {
                format!("; it depends on {}, {}", strata.by, p_text(strata.p_adjusted.unwrap_or(1.0)))
            }
            _ => String::new(),
        }
    }

    /// Returns whether the strata say something else than the mean over them: there is evidence that they differ, or
    /// the difference on average is none, or another, in some.
    pub fn varies_by_stratum(&self) -> bool {
        self.by_stratum.as_ref().is_some_and(|strata| {
            strata.differ()
                || self.verdict == Verdict::Difference
                    && !strata.strata.iter().all(|(_, of_stratum)| self.agrees_with_stratum(of_stratum))
        })
    }

    fn agrees_with_stratum(&self, of_stratum: &JudgedContrast) -> bool {
        let has_same_sign = of_stratum.contrast.difference.signum() == self.contrast.difference.signum();
        of_stratum.verdict == Verdict::Difference && has_same_sign
    }

    /// Returns what Wilcoxon's test adds where the means do not differ for sure.
    fn by_ranks(&self, letter: char) -> String {
        let Some((ranks, p)) = self.contrast.ranks.zip(self.ranks_p_adjusted.filter(|&p| p <= LEVEL)) else {
            return String::new();
        };
        let side = if ranks.above > ranks.below { "higher" } else { "lower" };
        format!("; by ranks {letter} is more often {side}, {}", p_text(p))
    }
}

/// `p = 0.012`, or `p < 0.001`.
pub fn p_text(p: f64) -> String {
    let p = probability(p);
    p.strip_prefix('<').map_or_else(|| format!("p = {p}"), |bound| format!("p < {bound}"))
}
