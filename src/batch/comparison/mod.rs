//! Batches, or parts of one, set against each other: runs of the same seed in pairs.
//!
//! Side A is what the others are compared with. A metric's difference is that of its means over the pairs, the other
//! side's less A's; its interval and its test are those of [`estimate_mean`](crate::stats::estimate_mean), of yes and no
//! those of [`PairedAnswers`](crate::stats::PairedAnswers), and Wilcoxon's test stands beside them. Where several metrics
//! or sides are compared, p-values are adjusted by Holm's method over all of them, those of means and answers as one
//! family, those of ranks as another; intervals are not. There is evidence of a difference where the adjusted p-value
//! of the mean or the answers is at most 0.05.
//!
//! Pairs in which a run failed are left out, and counted.

mod contrast;
mod error;
mod metric;
mod pairs;
mod published;
mod runs_file;
mod sides;
mod words;

use std::path::PathBuf;

pub use contrast::{Contrast, CutOff, Method};
pub use error::ComparisonError;
pub use metric::{Metric, MetricKind, NAMED_METRICS};
pub use pairs::Pairs;
pub use published::{BesideReport, PublishedState, PublishedTime};
pub use sides::{MAX_SIDES, Selection};
pub use words::{decimals_of, probability, rounded, shown};

use crate::stats::holm;
use runs_file::{RunsFile, RunsTable};
use sides::Side;

/// The level of the tests behind a verdict.
const LEVEL: f64 = 0.05;

/// What a comparison found.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// A first.
    pub sides: Vec<SideSummary>,
    /// Every other side against A.
    pub against_a: Vec<AgainstA>,
    /// Metrics that no pair has on both sides, with the letter of the other side.
    pub missing: Vec<(char, String)>,
}

/// What stands on a side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideSummary {
    pub letter: char,
    pub description: String,
    pub runs: usize,
    pub failed: usize,
}

/// A side set against A.
#[derive(Clone, Debug, PartialEq)]
pub struct AgainstA {
    pub letter: char,
    pub pairs: Pairs,
    pub judged: Vec<Judged>,
}

/// A contrast with what is made of it among the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    pub contrast: Contrast,
    /// By Holm's method.
    pub p_adjusted: Option<f64>,
    pub ranks_p_adjusted: Option<f64>,
    pub verdict: Verdict,
}

/// What a contrast says, in short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Difference,
    NoEvidence,
    /// Evidence by itself, but not among as many tests as there are.
    NotAmongSoMany,
    /// No pair differs.
    Equal,
}

/// Compares batches, given as folders or as their tables of runs: each with the first, or the parts of a single one.
///
/// Without names, the usual metrics are compared.
pub fn compare(paths: &[PathBuf], selection: &Selection, metrics: &[String]) -> Result<Comparison, ComparisonError> {
    let (metrics, tables) = read(paths, metrics)?;
    let sides = Side::all_of(&tables, selection)?;
    let [a, others @ ..] = &sides[..] else { unreachable!("there is a table, and it has runs") };
    let mut missing = Vec::new();
    let mut against_a = Vec::new();
    for other in others {
        let pairs = Pairs::of(a, other)?;
        let mut contrasts = Vec::new();
        let mut first_column = 0;
        for metric in &metrics {
            let columns: Vec<usize> = (first_column..first_column + metric.fields().len()).collect();
            first_column += columns.len();
            match Contrast::of(metric, a, other, &pairs, &columns) {
                Some(contrast) => contrasts.push(contrast),
                None => missing.push((other.letter, metric.name.clone())),
            }
        }
        against_a.push((other.letter, pairs, contrasts));
    }
    Ok(Comparison { sides: sides.iter().map(summary).collect(), against_a: judged(against_a), missing })
}

fn read(paths: &[PathBuf], names: &[String]) -> Result<(Vec<Metric>, Vec<RunsTable>), ComparisonError> {
    let files = paths.iter().map(|path| RunsFile::open(path)).collect::<Result<Vec<_>, _>>()?;
    let metrics = Metric::choose(names, &files)?;
    let fields: Vec<_> = metrics.iter().flat_map(Metric::fields).collect();
    let tables = files.into_iter().map(|file| file.read(&fields)).collect::<Result<_, _>>()?;
    Ok((metrics, tables))
}

fn summary(side: &Side<'_>) -> SideSummary {
    SideSummary { letter: side.letter, description: side.description(), runs: side.runs.len(), failed: side.failed() }
}

/// Adjusts the p-values of all contrasts together.
fn judged(against_a: Vec<(char, Pairs, Vec<Contrast>)>) -> Vec<AgainstA> {
    let contrasts = || against_a.iter().flat_map(|(_, _, contrasts)| contrasts);
    let mut means = adjusted(contrasts().map(|contrast| contrast.p_value)).into_iter();
    let mut ranks = adjusted(contrasts().map(|contrast| Some(contrast.ranks?.p_value))).into_iter();
    let mut judge = |contrast: Contrast| {
        let (p_adjusted, ranks_p_adjusted) = (means.next().flatten(), ranks.next().flatten());
        let verdict = Verdict::of(contrast.p_value, p_adjusted);
        Judged { contrast, p_adjusted, ranks_p_adjusted, verdict }
    };
    let judge_all = |(letter, pairs, contrasts): (char, Pairs, Vec<Contrast>)| AgainstA {
        letter,
        pairs,
        judged: contrasts.into_iter().map(&mut judge).collect(),
    };
    against_a.clone().into_iter().map(judge_all).collect()
}

fn adjusted(p_values: impl Iterator<Item = Option<f64>>) -> Vec<Option<f64>> {
    let p_values: Vec<_> = p_values.collect();
    let mut adjusted = holm(&p_values.iter().copied().flatten().collect::<Vec<_>>()).into_iter();
    p_values.into_iter().map(|p_value| p_value.and_then(|_| adjusted.next())).collect()
}

impl Verdict {
    fn of(p_value: Option<f64>, p_adjusted: Option<f64>) -> Self {
        let is_evidence = |p: f64| p <= LEVEL;
        match (p_value, p_adjusted) {
            (Some(_), Some(adjusted)) if is_evidence(adjusted) => Self::Difference,
            (Some(alone), _) if is_evidence(alone) => Self::NotAmongSoMany,
            (Some(_), _) => Self::NoEvidence,
            (None, _) => Self::Equal,
        }
    }
}

impl Judged {
    /// The verdict as a sentence, without a full stop.
    pub fn sentence(&self, letter: char) -> String {
        let Contrast { metric, difference, interval, pairs, .. } = &self.contrast;
        let said = metric.phrase.sentence(&letter.to_string(), *difference, *interval);
        let of_interval = |interval| format!("95 % interval of {letter} less A: {}", metric.phrase.interval(interval));
        let not_sure = interval.map_or_else(|| said.clone(), of_interval);
        let by_ranks = self.by_ranks(letter);
        match self.verdict {
            Verdict::Difference => said,
            Verdict::NoEvidence => format!("no evidence of a difference ({not_sure}){by_ranks}"),
            Verdict::NotAmongSoMany => {
                format!("no evidence of a difference, as one of several tests ({not_sure}){by_ranks}")
            }
            Verdict::Equal => format!("equal in all {pairs} pairs"),
        }
    }

    /// What Wilcoxon's test has to add where the means do not differ for sure.
    fn by_ranks(&self, letter: char) -> String {
        let Some((ranks, p)) = self.contrast.ranks.zip(self.ranks_p_adjusted.filter(|&p| p <= LEVEL)) else {
            return String::new();
        };
        let side = if ranks.above > ranks.below { "higher" } else { "lower" };
        let p = probability(p);
        let p = if p.starts_with('<') { p } else { format!("= {p}") };
        format!("; by ranks {letter} is {side} more often than not, p {p}")
    }
}
