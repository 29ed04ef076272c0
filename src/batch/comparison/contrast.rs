//! One metric over the pairs of two sides.

use crate::batch::comparison::metric::{Metric, MetricKind};
use crate::batch::comparison::pairs::Pairs;
use crate::batch::comparison::sides::Side;
use crate::rng;
use crate::stats::{
    Interval, Lifetime, MeanMethod, PairedAnswers, Series, SignedRanks, SurvivalCurve, cohens_dz, estimate_mean,
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
    /// Of the difference; `None` of fewer than two pairs or if all differ alike.
    pub interval: Option<Interval>,
    pub method: Method,
    /// That there is no difference; `None` if no pair differs.
    pub p_value: Option<f64>,
    pub effect_dz: Option<f64>,
    pub ranks: Option<SignedRanks>,
    pub cut_off: Option<CutOff>,
}

/// Where interval and p-value come from.
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
    /// How many were cut off.
    pub counts: [usize; 2],
    pub medians: [Option<f64>; 2],
    /// Ends that are beyond what was seen are `None`.
    pub median_intervals: [(Option<f64>, Option<f64>); 2],
}

impl Contrast {
    /// `columns` are those of the tables' values that belong to the metric; `None` if no pair has it on both sides.
    pub fn of(metric: &Metric, first: &Side<'_>, second: &Side<'_>, pairs: &Pairs, columns: &[usize]) -> Option<Self> {
        let rows = pairs.runs.iter().map(|&(ours, theirs)| {
            let row = |side: &Side<'_>, run: usize| -> Vec<f64> {
                columns.iter().map(|&column| side.table.values[column][run]).collect()
            };
            [row(first, ours), row(second, theirs)]
        });
        match metric.kind {
            MetricKind::Sum(_) => {
                let sums = rows.map(|rows| rows.map(|row| row.iter().sum()));
                of_numbers(metric, second.letter, &sums.filter(is_whole).collect::<Vec<_>>())
            }
            MetricKind::Answer { .. } => {
                let answers = rows.map(|rows| rows.map(|row| row[0])).filter(is_whole);
                of_answers(metric, answers.map(|[ours, theirs]| (ours > 0.0, theirs > 0.0)))
            }
            MetricKind::Time { .. } => {
                let lifetimes = rows.filter_map(|[ours, theirs]| Some([lifetime(&ours)?, lifetime(&theirs)?]));
                of_times(metric, second.letter, &lifetimes.collect::<Vec<_>>())
            }
        }
    }
}

fn is_whole(pair: &[f64; 2]) -> bool {
    pair.iter().all(|value| !value.is_nan())
}

/// From the time of the event, the end of the run, and when the event became possible.
fn lifetime(row: &[f64]) -> Option<Lifetime> {
    let &[event, end, begun] = row else { unreachable!("a time has three columns") };
    let is_cut_off = event.is_nan();
    let time = if is_cut_off { end } else { event };
    (!begun.is_nan() && !time.is_nan()).then_some(Lifetime { time, is_cut_off })
}

fn of_numbers(metric: &Metric, letter: char, pairs: &[[f64; 2]]) -> Option<Contrast> {
    let differences: Vec<f64> = pairs.iter().map(|[ours, theirs]| theirs - ours).collect();
    let random = &mut rng::stream(SEED, &format!("bootstrap/{letter}/{}", metric.name));
    let estimate = estimate_mean(&differences, random)?;
    let ranks = SignedRanks::of(&differences);
    let (p_value, method) = match (estimate.p_value, estimate.method) {
        (None, _) => (ranks.map(|ranks| ranks.p_value), Method::Ranks),
        (some, MeanMethod::StudentsT) => (some, Method::StudentsT),
        (some, MeanMethod::StudentisedBootstrap) => (some, Method::StudentisedBootstrap),
    };
    let mean_of = |side: usize| Series::of(&pairs.iter().map(|pair| pair[side]).collect::<Vec<_>>()).mean();
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

fn of_answers(metric: &Metric, pairs: impl Iterator<Item = (bool, bool)>) -> Option<Contrast> {
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

/// Differences are of times up to a horizon that both sides were watched until: of restricted means.
///
/// Royston, Parmar, "Restricted mean survival time", BMC Medical Research Methodology 13, 2013.
fn of_times(metric: &Metric, letter: char, pairs: &[[Lifetime; 2]]) -> Option<Contrast> {
    let cut_off = pairs.iter().flatten().filter(|lifetime| lifetime.is_cut_off);
    let horizon = cut_off.map(|lifetime| lifetime.time).reduce(f64::min);
    let restricted = |lifetime: Lifetime| lifetime.time.min(horizon.unwrap_or(f64::INFINITY));
    let numbers: Vec<_> = pairs.iter().map(|pair| pair.map(restricted)).collect();
    let curves = [0, 1].map(|side| {
        let lifetimes: Vec<_> = pairs.iter().map(|pair| pair[side]).collect();
        (lifetimes.iter().filter(|lifetime| lifetime.is_cut_off).count(), SurvivalCurve::of(&lifetimes))
    });
    let cut_off = CutOff {
        horizon,
        counts: curves.each_ref().map(|(count, _)| *count),
        medians: curves.each_ref().map(|(_, curve)| curve.median()),
        median_intervals: curves.each_ref().map(|(_, curve)| curve.median_interval()),
    };
    Some(Contrast { cut_off: Some(cut_off), ..of_numbers(metric, letter, &numbers)? })
}
