//! The contrast of one metric over the pairs of two sides.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::comparison::metric::{Metric, MetricKind};
use crate::comparison::pairs::Pairs;
use crate::comparison::sides::Side;
use crate::stats::{
    Interval, Lifetime, MeanMethod, PairedAnswers, RepeatedMeasures, Series, SignedRanks, SurvivalCurve, cohens_dz,
    estimate_mean, mean_rate_difference_interval, sequence_half_width,
};
use wildfire_base::document::number::rounded;
use wildfire_base::rng;
use wildfire_picture::charts::{Estimate, ForestRow};

/// Every comparison draws from the streams of this seed: the same files give the same figures.
const SEED: u64 = 1;

/// The letter in the names of these streams, that of the first side set against A: a pair has the same interval against
/// whatever else it is shown, and the mirrored one with its sides exchanged.
const LETTER: char = 'B';

/// A metric on both sides, and the difference of the second from the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Contrast {
    pub metric: Metric,
    /// Pairs that have the metric on both sides.
    pub pairs: usize,
    /// The independent pairs among them: seeds, if there are several strata.
    pub seeds: usize,
    /// The mean of each side over these pairs; for yes/no metrics, the rate.
    pub means: [f64; 2],
    pub difference: f64,
    /// The interval of the difference; `None` for fewer than two pairs or if all differences are equal.
    pub interval: Option<Interval>,
    /// The method behind the interval.
    pub method: Method,
    /// The p-value of no difference; `None` if no pair differs.
    pub p_value: Option<f64>,
    /// The method behind the p-value.
    pub p_method: Method,
    pub effect_dz: Option<f64>,
    /// The standard deviation of the independent differences, one per seed; `None` for fewer than two.
    pub spread: Option<f64>,
    pub ranks: Option<SignedRanks>,
    pub cut_off: Option<CutOff>,
}

/// The method behind an interval or a p-value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    StudentisedBootstrap,
    StudentsT,
    /// Wilcoxon's test without an interval, where all pairs differ by the same amount.
    Ranks,
    /// Adjusted Wald interval and McNemar's exact test.
    Answers,
    /// The interval of a confidence sequence, of batches that stopped by a rule; it is a test too.
    Sequence,
}

wildfire_base::names! { Method {
    StudentisedBootstrap: "studentised-bootstrap",
    StudentsT: "students-t",
    Ranks: "wilcoxon",
    Answers: "mcnemar",
    Sequence: "confidence-sequence",
} }

/// Censored times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CutOff {
    /// The time at which longer ones are censored on both sides: where the first unsuccessful wait ended.
    pub horizon: Option<f64>,
    /// The number of censored times.
    pub counts: [usize; 2],
    pub medians: [Option<f64>; 2],
    /// The intervals of the medians; ends beyond the observed times are `None`.
    pub median_intervals: [[Option<f64>; 2]; 2],
}

/// The numbers of two paired runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberPair {
    pub seed: u64,
    /// The index of the stratum; each has at most one pair per seed.
    pub stratum: usize,
    pub numbers: [f64; 2],
}

/// The contrasts of a metric by stratum.
#[derive(Clone, Debug, PartialEq)]
pub struct ByStratum {
    /// The columns in which the strata differ, in words.
    pub by: String,
    /// The contrasts, each with the index of its stratum; strata without a pair that has the metric are omitted.
    pub contrasts: Vec<(usize, Contrast)>,
    /// The seeds that have the metric in all of these strata, on both sides.
    pub seeds: usize,
    /// The test that the difference is equal in all strata; `None` for too few seeds, or if the differences of no seed
    /// differ.
    pub test: Option<RepeatedMeasures>,
}

/// A contrast before p-values are adjusted, and its strata by themselves if there are several.
#[derive(Clone, Debug)]
pub struct UntestedContrast {
    pub contrast: Contrast,
    pub by_stratum: Option<ByStratum>,
}

impl UntestedContrast {
    /// Returns the contrast of runs whose number was chosen by a stopping rule with this error: with the interval of a
    /// confidence sequence, which holds at every number of seeds, and without p-values, which do not.
    pub fn of_stopped_runs(self, alpha: f64) -> Self {
        let strata = self.by_stratum.map(|strata| ByStratum {
            contrasts: strata
                .contrasts
                .into_iter()
                .map(|(it, contrast)| (it, contrast.of_stopped_runs(alpha)))
                .collect(),
            test: None,
            ..strata
        });
        Self { contrast: self.contrast.of_stopped_runs(alpha), by_stratum: strata }
    }
}

impl Contrast {
    fn of_stopped_runs(self, alpha: f64) -> Self {
        let half_width = self.spread.and_then(|spread| sequence_half_width(self.seeds as u64, spread, alpha));
        Self {
            interval: half_width.map(|half_width| Interval::about(self.difference, half_width)),
            method: Method::Sequence,
            p_value: None,
            p_method: Method::Sequence,
            ranks: None,
            ..self
        }
    }

    /// `columns` are those of the tables' values that belong to the metric; `None` if no pair has it on both sides.
    pub fn between(
        metric: &Metric,
        first: &Side<'_>,
        second: &Side<'_>,
        pairs: &Pairs,
        columns: &[usize],
    ) -> Option<UntestedContrast> {
        let row = |side: &Side<'_>, run: usize| -> Vec<f64> {
            columns.iter().map(|&column| side.table.values[column][run]).collect()
        };
        // The horizon is one for both sides: with two, the side that gave up earlier would have the shorter times.
        let rows: Vec<_> = pairs.runs.iter().map(|&(ours, theirs)| [row(first, ours), row(second, theirs)]).collect();
        let cut_off = if matches!(metric.kind, MetricKind::Time { .. }) { Some(cut_off(&rows)) } else { None };
        let horizon = cut_off.as_ref().and_then(|it| it.horizon).unwrap_or(f64::INFINITY);
        let numbers = rows.iter().map(|rows| numbers_of(metric, rows, horizon));
        let seeds = pairs.runs.iter().map(|&(ours, _)| first.table.seeds[ours]);
        let numbers = numbers
            .zip(seeds)
            .zip(&pairs.stratum_of)
            .filter_map(|((numbers, seed), &stratum)| numbers.map(|numbers| NumberPair { seed, stratum, numbers }));
        // One stratum is no mean over strata; its pairs are independent as they are.
        let by = (pairs.strata.len() > 1).then(|| pairs.stratified_by());
        let mut found = Self::from_numbers(metric, numbers.collect(), by)?;
        found.contrast.cut_off = cut_off;
        Some(found)
    }

    /// Contrasts pairs of runs, in any order; `None` if there are none. Where they are in several strata, `by` is what
    /// these differ in; then the contrast is a mean over the strata.
    ///
    /// Pairs of one seed in several strata are on related fields: seeds are independent, and strata are not a sample of
    /// anything. So the contrast is one of means by seed, over its strata.
    pub fn from_numbers(metric: &Metric, mut pairs: Vec<NumberPair>, by: Option<String>) -> Option<UntestedContrast> {
        // Sorted, so that the last bits of sums do not depend on the order in which pairs come.
        pairs.sort_unstable_by_key(|pair| (pair.seed, pair.stratum));
        let all: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.numbers).collect();
        let Some(by) = by else {
            return Some(UntestedContrast { contrast: contrast_of_pairs(metric, &all)?, by_stratum: None });
        };
        let strata = by_stratum(metric, &pairs, by);
        let differences = differences_by_seed(&pairs, &strata);
        let contrast = match metric.kind {
            MetricKind::Answer { .. } => contrast_rates(metric, &all, &differences, strata.contrasts.len()),
            _ => contrast_numbers(metric, &all, &differences),
        };
        Some(UntestedContrast { contrast: contrast?, by_stratum: Some(strata) })
    }
}

impl Contrast {
    /// Returns the row of a chart of differences.
    pub(crate) fn forest_row(&self, name: String, decimals: usize, is_significant: bool) -> ForestRow {
        let interval = self.interval.map(|Interval { low, high }| (low, high));
        let ends = interval.map_or_else(String::new, |(low, high)| {
            format!(" ({} to {})", rounded(low, decimals), rounded(high, decimals))
        });
        let text = format!("{}{ends}", rounded(self.difference, decimals));
        ForestRow { name, difference: Some(Estimate { value: self.difference, interval }), text, is_significant }
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
        MetricKind::Column(_) | MetricKind::Sum(_) | MetricKind::Unknown => row.iter().sum(),
        MetricKind::Answer { .. } => row[0],
        MetricKind::Time { .. } => lifetime(row).map_or(f64::NAN, |lifetime| lifetime.time.min(horizon)),
    }
}

/// Contrasts the numbers of pairs; `None` if there are none.
pub(crate) fn contrast_of_pairs(metric: &Metric, pairs: &[[f64; 2]]) -> Option<Contrast> {
    match metric.kind {
        MetricKind::Answer { .. } => {
            contrast_answers(metric, pairs.iter().map(|[ours, theirs]| (*ours > 0.0, *theirs > 0.0)))
        }
        _ => {
            let differences: Vec<f64> = pairs.iter().map(|[ours, theirs]| theirs - ours).collect();
            contrast_numbers(metric, pairs, &differences)
        }
    }
}

/// Computes the contrasts of the strata, and the test whether they differ: an analysis of variance of the paired
/// differences, whose subjects are the seeds and whose conditions are the strata. Pairs are by seed and stratum.
fn by_stratum(metric: &Metric, pairs: &[NumberPair], by: String) -> ByStratum {
    let mut of_stratum: BTreeMap<usize, Vec<[f64; 2]>> = BTreeMap::new();
    pairs.iter().for_each(|pair| of_stratum.entry(pair.stratum).or_default().push(pair.numbers));
    let contrasts = of_stratum.iter();
    let contrasts: Vec<_> =
        contrasts.filter_map(|(&stratum, pairs)| Some((stratum, contrast_of_pairs(metric, pairs)?))).collect();
    let whole = of_seeds(pairs).filter(|of_seed| of_seed.len() == contrasts.len());
    let rows: Vec<Vec<f64>> = whole.map(|of_seed| of_seed.iter().map(NumberPair::difference).collect()).collect();
    ByStratum { by, contrasts, seeds: rows.len(), test: RepeatedMeasures::from_rows(&rows) }
}

/// Returns a difference for each seed: the mean over its strata. Their mean is that of all pairs.
///
/// A seed that is not in all strata would be far off only because of those that it misses. So if there is one, each seed has
/// the mean of all pairs, and beside it how its pairs differ from the means of their strata: the spread of these
/// numbers is that of a mean over fixed strata, whose weights are their pairs.
fn differences_by_seed(pairs: &[NumberPair], strata: &ByStratum) -> Vec<f64> {
    let seeds = of_seeds(pairs).count();
    // If each seed is in all strata, a mean over its strata has the same weight for each, and no correction is needed.
    if seeds == strata.seeds {
        let mean =
            |of_seed: &[NumberPair]| of_seed.iter().map(NumberPair::difference).sum::<f64>() / of_seed.len() as f64;
        return of_seeds(pairs).map(mean).collect();
    }
    let of_stratum: BTreeMap<usize, f64> =
        strata.contrasts.iter().map(|(stratum, contrast)| (*stratum, contrast.difference)).collect();
    let mean = pairs.iter().map(NumberPair::difference).sum::<f64>() / pairs.len() as f64;
    let share = seeds as f64 / pairs.len() as f64;
    // Deviations sum to zero in each stratum, which keeps the mean; the factor gives a sum over strata the scale of a mean.
    of_seeds(pairs)
        .map(|of_seed| {
            mean + share * of_seed.iter().map(|pair| pair.difference() - of_stratum[&pair.stratum]).sum::<f64>()
        })
        .collect()
}

fn of_seeds(pairs: &[NumberPair]) -> impl Iterator<Item = &[NumberPair]> {
    pairs.chunk_by(|one, next| one.seed == next.seed)
}

impl NumberPair {
    fn difference(&self) -> f64 {
        self.numbers[1] - self.numbers[0]
    }
}

/// From the time of the event, the end of the run, and when the event became possible.
pub(super) fn lifetime(row: &[f64]) -> Option<Lifetime> {
    let &[event, end, start] = row else { unreachable!("a time has three columns") };
    let is_cut_off = event.is_nan();
    let time = if is_cut_off { end } else { event };
    (!start.is_nan() && !time.is_nan()).then_some(Lifetime { time, is_cut_off })
}

/// Contrasts the numbers of pairs by independent differences.
fn contrast_numbers(metric: &Metric, pairs: &[[f64; 2]], differences: &[f64]) -> Option<Contrast> {
    // The stream has the metric's name, so that a metric has the same interval whichever others are compared beside it.
    let random = &mut rng::stream(SEED, &format!("bootstrap/{LETTER}/{}", metric.name));
    let estimate = estimate_mean(differences, random)?;
    let ranks = SignedRanks::from_differences(differences);
    let method = |method: MeanMethod| match (estimate.p_value, method) {
        // A t-test of equal differences divides by zero; the ranks still have a p-value.
        (None, _) => Method::Ranks,
        (Some(_), MeanMethod::StudentsT) => Method::StudentsT,
        (Some(_), MeanMethod::StudentisedBootstrap) => Method::StudentisedBootstrap,
    };
    Some(Contrast {
        metric: metric.clone(),
        pairs: pairs.len(),
        seeds: differences.len(),
        means: means(pairs),
        difference: estimate.mean,
        interval: estimate.interval,
        method: method(estimate.method),
        p_value: estimate.p_value.or(ranks.map(|ranks| ranks.p_value)),
        p_method: method(estimate.p_method),
        effect_dz: cohens_dz(differences),
        spread: Series::from_values(differences).standard_deviation(),
        ranks,
        cut_off: None,
    })
}

/// Contrasts answers yes or no in several strata by the differences of their rates, one for each seed.
fn contrast_rates(metric: &Metric, pairs: &[[f64; 2]], differences: &[f64], strata: usize) -> Option<Contrast> {
    let series = Series::from_values(differences);
    Some(Contrast {
        metric: metric.clone(),
        pairs: pairs.len(),
        seeds: differences.len(),
        means: means(pairs),
        difference: series.mean()?,
        // Differences of rates within a seed are not -1, 0 and 1, so McNemar's test does not apply to them.
        interval: mean_rate_difference_interval(differences, strata),
        method: Method::Answers,
        p_value: SignedRanks::from_differences(differences).map(|ranks| ranks.p_value),
        p_method: Method::Ranks,
        effect_dz: None,
        spread: series.standard_deviation(),
        ranks: None,
        cut_off: None,
    })
}

/// Returns the mean of each side; of no pairs NaN.
fn means(pairs: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|side| {
        let of_side: Vec<f64> = pairs.iter().map(|pair| pair[side]).collect();
        Series::from_values(&of_side).mean().unwrap_or(f64::NAN)
    })
}

fn contrast_answers(metric: &Metric, pairs: impl Iterator<Item = (bool, bool)>) -> Option<Contrast> {
    let mut answers = PairedAnswers::default();
    let mut differences = Series::default();
    pairs.for_each(|(ours, theirs)| {
        answers.add(ours, theirs);
        differences.add(f64::from(i8::from(theirs) - i8::from(ours)));
    });
    // McNemar's test is of the pairs that differ; of none it has no p-value.
    let differ = answers.only_first + answers.only_second > 0;
    Some(Contrast {
        metric: metric.clone(),
        pairs: answers.pairs() as usize,
        seeds: answers.pairs() as usize,
        means: [answers.first_yes(), answers.second_yes()].map(|yes| yes as f64 / answers.pairs() as f64),
        difference: answers.rate_difference()?,
        interval: answers.rate_difference_interval(),
        method: Method::Answers,
        p_value: differ.then(|| answers.mcnemar_p_value()),
        p_method: Method::Answers,
        effect_dz: None,
        spread: differences.standard_deviation(),
        // Differences of -1, 0 and 1 have equal ranks: the test of ranks would only approximate McNemar's, which is exact.
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
    let cut_off = pairs.iter().flatten().filter(|lifetime| lifetime.is_cut_off);
    let horizon = cut_off.map(|lifetime| lifetime.time).reduce(f64::min);
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
