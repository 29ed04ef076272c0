//! One metric over the pairs of two sides.

use std::collections::BTreeMap;

use crate::batch::comparison::metric::{Metric, MetricKind};
use crate::batch::comparison::pairs::Pairs;
use crate::batch::comparison::sides::Side;
use crate::rng;
use crate::stats::{
    Interval, Lifetime, MeanMethod, PairedAnswers, RepeatedMeasures, Series, SignedRanks, SurvivalCurve, cohens_dz,
    estimate_mean,
};

/// Every comparison draws from the streams of this seed: the same files give the same figures.
const SEED: u64 = 1;

/// A metric on both sides, and how the second differs from the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Contrast {
    pub metric: Metric,
    /// Pairs that have the metric on both sides.
    pub pairs: usize,
    /// Mean of each side over these pairs; of yes or no, the rate.
    pub means: [f64; 2],
    pub difference: f64,
    /// The interval of the difference; `None` of fewer than two pairs or if all differ alike.
    pub interval: Option<Interval>,
    pub method: Method,
    /// That there is no difference; `None` if no pair differs.
    pub p_value: Option<f64>,
    pub effect_dz: Option<f64>,
    pub ranks: Option<SignedRanks>,
    pub cut_off: Option<CutOff>,
}

/// The method behind interval and p-value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    StudentisedBootstrap,
    StudentsT,
    /// All pairs differ by the same: Wilcoxon's test, no interval.
    Ranks,
    /// Adjusted Wald interval, McNemar's exact test.
    Answers,
}

/// Times of which some are cut off.
#[derive(Clone, Debug, PartialEq)]
pub struct CutOff {
    /// Times beyond this count as this much on both sides: where the first of the waits in vain ended.
    pub horizon: Option<f64>,
    /// The number of times that were cut off.
    pub counts: [usize; 2],
    pub medians: [Option<f64>; 2],
    /// Ends that are beyond what was seen are `None`.
    pub median_intervals: [(Option<f64>, Option<f64>); 2],
}

/// A metric in each stratum of the pairs by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ByStratum {
    /// The contrasts, each with the index of its stratum; strata in which no pair has the metric are left out.
    pub contrasts: Vec<(usize, Contrast)>,
    /// Seeds that have the metric in all of these strata, on both sides.
    pub seeds: usize,
    /// The test that the difference is the same in all strata; `None` for too few seeds, or if no seed's differences
    /// differ.
    pub test: Option<RepeatedMeasures>,
}

impl Contrast {
    /// `columns` are those of the tables' values that belong to the metric; `None` if no pair has it on both sides.
    /// The second value has the strata by themselves, if there are several.
    pub fn new(
        metric: &Metric,
        first: &Side<'_>,
        second: &Side<'_>,
        pairs: &Pairs,
        columns: &[usize],
    ) -> Option<(Self, Option<ByStratum>)> {
        let row = |side: &Side<'_>, run: usize| -> Vec<f64> {
            columns.iter().map(|&column| side.table.values[column][run]).collect()
        };
        let rows: Vec<_> = pairs.runs.iter().map(|&(ours, theirs)| [row(first, ours), row(second, theirs)]).collect();
        let cut_off = if matches!(metric.kind, MetricKind::Time { .. }) { Some(cut_off(&rows)) } else { None };
        let horizon = cut_off.as_ref().and_then(|it| it.horizon).unwrap_or(f64::INFINITY);
        let numbers: Vec<_> = rows.iter().map(|rows| numbers_of(metric, rows, horizon)).collect();
        let all: Vec<_> = numbers.iter().flatten().copied().collect();
        let contrast = Self { cut_off, ..contrast_of_pairs(metric, second.letter, &all)? };
        let seeds: Vec<u64> = pairs.runs.iter().map(|&(ours, _)| first.table.seeds[ours]).collect();
        let by_stratum = (pairs.strata.len() > 1).then(|| by_stratum(metric, second.letter, pairs, &seeds, &numbers));
        Some((contrast, by_stratum))
    }
}

/// Returns the metric of both runs of a pair; yes is 1, no is 0; times beyond the horizon count as the horizon. `None`
/// if it is missing on either side.
fn numbers_of(metric: &Metric, rows: &[Vec<f64>; 2], horizon: f64) -> Option<[f64; 2]> {
    let numbers = rows.each_ref().map(|row| number_of(metric, row, horizon));
    numbers.iter().all(|number| !number.is_nan()).then_some(numbers)
}

/// Returns the metric of a run from the values of its columns; NaN where there is none.
pub(super) fn number_of(metric: &Metric, row: &[f64], horizon: f64) -> f64 {
    match metric.kind {
        MetricKind::Sum(_) => row.iter().sum(),
        MetricKind::Answer { .. } => row[0],
        MetricKind::Time { .. } => lifetime(row).map_or(f64::NAN, |lifetime| lifetime.time.min(horizon)),
    }
}

/// Contrasts the numbers of pairs; `None` if there are none.
pub(in crate::batch) fn contrast_of_pairs(metric: &Metric, letter: char, pairs: &[[f64; 2]]) -> Option<Contrast> {
    match metric.kind {
        MetricKind::Answer { .. } => {
            contrast_answers(metric, pairs.iter().map(|[ours, theirs]| (*ours > 0.0, *theirs > 0.0)))
        }
        MetricKind::Sum(_) | MetricKind::Time { .. } => contrast_numbers(metric, letter, pairs),
    }
}

/// Computes the contrasts of the strata, and the test whether they differ: an analysis of variance of the paired
/// differences, whose subjects are the seeds and whose conditions are the strata.
fn by_stratum(metric: &Metric, letter: char, pairs: &Pairs, seeds: &[u64], numbers: &[Option<[f64; 2]>]) -> ByStratum {
    let mut of_stratum = vec![Vec::new(); pairs.strata.len()];
    let mut differences: BTreeMap<u64, Vec<(usize, f64)>> = BTreeMap::new();
    for ((&stratum, seed), pair) in pairs.stratum_of.iter().zip(seeds).zip(numbers) {
        if let Some(pair) = pair {
            of_stratum[stratum].push(*pair);
            differences.entry(*seed).or_default().push((stratum, pair[1] - pair[0]));
        }
    }
    let contrasts = of_stratum.iter().enumerate();
    let contrasts: Vec<_> =
        contrasts.filter_map(|(stratum, pairs)| Some((stratum, contrast_of_pairs(metric, letter, pairs)?))).collect();
    // Pairs are in the order of their seeds, but within a seed those of side A's runs; each stratum comes once.
    let whole = differences.into_values().filter(|of_seed| of_seed.len() == contrasts.len());
    let rows: Vec<Vec<f64>> = whole
        .map(|mut of_seed| {
            of_seed.sort_unstable_by_key(|&(stratum, _)| stratum);
            of_seed.into_iter().map(|(_, difference)| difference).collect()
        })
        .collect();
    ByStratum { contrasts, seeds: rows.len(), test: RepeatedMeasures::from_rows(&rows) }
}

/// From the time of the event, the end of the run, and when the event became possible.
pub(super) fn lifetime(row: &[f64]) -> Option<Lifetime> {
    let &[event, end, begun] = row else { unreachable!("a time has three columns") };
    let is_cut_off = event.is_nan();
    let time = if is_cut_off { end } else { event };
    (!begun.is_nan() && !time.is_nan()).then_some(Lifetime { time, is_cut_off })
}

fn contrast_numbers(metric: &Metric, letter: char, pairs: &[[f64; 2]]) -> Option<Contrast> {
    let differences: Vec<f64> = pairs.iter().map(|[ours, theirs]| theirs - ours).collect();
    let random = &mut rng::stream(SEED, &format!("bootstrap/{letter}/{}", metric.name));
    let estimate = estimate_mean(&differences, random)?;
    let ranks = SignedRanks::from_differences(&differences);
    let (p_value, method) = match (estimate.p_value, estimate.method) {
        (None, _) => (ranks.map(|ranks| ranks.p_value), Method::Ranks),
        (some, MeanMethod::StudentsT) => (some, Method::StudentsT),
        (some, MeanMethod::StudentisedBootstrap) => (some, Method::StudentisedBootstrap),
    };
    let mean_of = |side: usize| Series::from_values(&pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>()).mean();
    Some(Contrast {
        metric: metric.clone(),
        pairs: pairs.len(),
        means: [mean_of(0)?, mean_of(1)?],
        difference: estimate.mean,
        interval: estimate.interval,
        method,
        p_value,
        effect_dz: cohens_dz(&differences),
        ranks,
        cut_off: None,
    })
}

fn contrast_answers(metric: &Metric, pairs: impl Iterator<Item = (bool, bool)>) -> Option<Contrast> {
    let mut answers = PairedAnswers::default();
    pairs.for_each(|(ours, theirs)| answers.add(ours, theirs));
    let differ = answers.only_first + answers.only_second > 0;
    Some(Contrast {
        metric: metric.clone(),
        pairs: answers.pairs() as usize,
        means: [answers.first_yes(), answers.second_yes()].map(|yes| yes as f64 / answers.pairs() as f64),
        difference: answers.rate_difference()?,
        interval: answers.rate_difference_interval(),
        method: Method::Answers,
        p_value: differ.then(|| answers.mcnemar_p_value()),
        effect_dz: None,
        ranks: None,
        cut_off: None,
    })
}

/// Describes how times end. Differences are of restricted means: of times up to a horizon that both sides were watched
/// until.
///
/// Royston, Parmar, "Restricted mean survival time", BMC Medical Research Methodology 13, 2013.
fn cut_off(rows: &[[Vec<f64>; 2]]) -> CutOff {
    let pairs: Vec<_> = rows.iter().filter_map(|[ours, theirs]| Some([lifetime(ours)?, lifetime(theirs)?])).collect();
    let in_vain = pairs.iter().flatten().filter(|lifetime| lifetime.is_cut_off);
    let horizon = in_vain.map(|lifetime| lifetime.time).reduce(f64::min);
    let curves = [0, 1].map(|side| {
        let lifetimes: Vec<_> = pairs.iter().map(|pair| pair[side]).collect();
        (lifetimes.iter().filter(|lifetime| lifetime.is_cut_off).count(), SurvivalCurve::from_lifetimes(&lifetimes))
    });
    CutOff {
        horizon,
        counts: curves.each_ref().map(|(count, _)| *count),
        medians: curves.each_ref().map(|(_, curve)| curve.median()),
        median_intervals: curves.each_ref().map(|(_, curve)| curve.median_interval()),
    }
}
