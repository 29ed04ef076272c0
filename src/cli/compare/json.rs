//! A comparison as one JSON object.

use serde::Serialize;

use crate::batch::PROGRAM_VERSION;
use crate::batch::comparison::{Comparison, Contrast, Judged, Method, Verdict};
use crate::stats::CONFIDENCE;

/// The members in their order.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    confidence: f64,
    sides: Vec<Side<'a>>,
    comparisons: Vec<AgainstA<'a>>,
}

#[derive(Serialize)]
struct Side<'a> {
    side: char,
    description: &'a str,
    runs: usize,
    failed: usize,
}

#[derive(Serialize)]
struct AgainstA<'a> {
    side: char,
    against: char,
    pairs: usize,
    without_partner: [usize; 2],
    failed_pairs: Failed,
    metrics: Vec<MetricObject<'a>>,
    metrics_without_pairs: Vec<&'a str>,
}

#[derive(Serialize)]
struct Failed {
    in_first: usize,
    in_second: usize,
    in_both: usize,
}

/// What does not exist is null.
#[derive(Serialize)]
struct MetricObject<'a> {
    metric: &'a str,
    verdict: &'static str,
    sentence: String,
    pairs: usize,
    means: [f64; 2],
    difference: f64,
    interval: Option<[f64; 2]>,
    method: &'static str,
    p_value: Option<f64>,
    p_adjusted: Option<f64>,
    cohens_dz: Option<f64>,
    wilcoxon: Option<Wilcoxon>,
    cut_off: Option<CutOff>,
}

#[derive(Serialize)]
struct Wilcoxon {
    above: f64,
    below: f64,
    zeros: usize,
    p_value: f64,
    p_adjusted: Option<f64>,
    rank_biserial: f64,
}

#[derive(Serialize)]
struct CutOff {
    horizon: Option<f64>,
    counts: [usize; 2],
    medians: [Option<f64>; 2],
    median_intervals: [[Option<f64>; 2]; 2],
}

/// The comparison on one line.
pub fn of(comparison: &Comparison) -> String {
    let sides = comparison.sides.iter().map(|side| Side {
        side: side.letter,
        description: &side.description,
        runs: side.runs,
        failed: side.failed,
    });
    let comparisons = comparison.against_a.iter().map(|against| {
        let [in_first, in_second, in_both] = against.pairs.failed;
        let missing = comparison.missing.iter().filter(|(letter, _)| *letter == against.letter);
        AgainstA {
            side: against.letter,
            against: 'A',
            pairs: against.pairs.runs.len(),
            without_partner: against.pairs.without_partner,
            failed_pairs: Failed { in_first, in_second, in_both },
            metrics: against.judged.iter().map(|judged| metric(judged, against.letter)).collect(),
            metrics_without_pairs: missing.map(|(_, name)| name.as_str()).collect(),
        }
    });
    let object = Object {
        program_version: PROGRAM_VERSION,
        confidence: CONFIDENCE,
        sides: sides.collect(),
        comparisons: comparisons.collect(),
    };
    serde_json::to_string(&object).expect("names, numbers and words are JSON") + "\n"
}

fn metric(judged: &Judged, letter: char) -> MetricObject<'_> {
    let Contrast { metric, pairs, means, difference, interval, .. } = &judged.contrast;
    MetricObject {
        metric: &metric.name,
        verdict: verdict(judged.verdict),
        sentence: judged.sentence(letter),
        pairs: *pairs,
        means: *means,
        difference: *difference,
        interval: interval.map(|interval| [interval.low, interval.high]),
        method: method(judged.contrast.method),
        p_value: judged.contrast.p_value,
        p_adjusted: judged.p_adjusted,
        cohens_dz: judged.contrast.effect_dz,
        wilcoxon: wilcoxon(judged),
        cut_off: cut_off(&judged.contrast),
    }
}

fn wilcoxon(judged: &Judged) -> Option<Wilcoxon> {
    let ranks = judged.contrast.ranks?;
    Some(Wilcoxon {
        above: ranks.above,
        below: ranks.below,
        zeros: ranks.zeros,
        p_value: ranks.p_value,
        p_adjusted: judged.ranks_p_adjusted,
        rank_biserial: ranks.rank_biserial(),
    })
}

fn cut_off(contrast: &Contrast) -> Option<CutOff> {
    let cut_off = contrast.cut_off.as_ref()?;
    Some(CutOff {
        horizon: cut_off.horizon,
        counts: cut_off.counts,
        medians: cut_off.medians,
        median_intervals: cut_off.median_intervals.map(|(low, high)| [low, high]),
    })
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Difference => "difference",
        Verdict::NoEvidence => "no-evidence",
        Verdict::NotAmongSoMany => "no-evidence-among-several-tests",
        Verdict::Equal => "equal",
    }
}

fn method(method: Method) -> &'static str {
    match method {
        Method::StudentisedBootstrap => "studentised-bootstrap",
        Method::StudentsT => "students-t",
        Method::Ranks => "wilcoxon",
        Method::Answers => "mcnemar",
    }
}
