//! A comparison as one JSON object.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::comparison::{
    AgainstA as Against, Comparison, Contrast, JudgedContrast, JudgedStrata, Pairs, SettingsDifference, Verdict,
};
use crate::stats::CONFIDENCE;
use crate::{PROGRAM_VERSION, QueryTally};

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
    queries: QueryTally,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct AgainstA<'a> {
    side: char,
    against: char,
    settings: Settings<'a>,
    pairs: usize,
    mean_over: Option<MeanOver<'a>>,
    without_partner: [usize; 2],
    failed_pairs: Failed,
    metrics: Vec<MetricObject<'a>>,
    metrics_without_pairs: Vec<&'a str>,
}

/// Values are in the order of A and the other side.
#[derive(Serialize)]
struct Settings<'a> {
    sentence: String,
    difference_is_the_planners: bool,
    differences: Vec<SettingDifference<'a>>,
    program_versions: &'a Option<[String; 2]>,
    seeds: &'a Option<[String; 2]>,
    not_known: Vec<NotKnown<'a>>,
}

#[derive(Serialize)]
struct SettingDifference<'a> {
    key: &'a str,
    values: &'a [Option<serde_json::Value>; 2],
    /// The strata in which they differ like this; null if they do in all.
    only_where: Option<Vec<Levels<'a>>>,
}

#[derive(Serialize)]
struct NotKnown<'a> {
    side: char,
    reason: &'a str,
}

/// A value for each column that the strata differ in.
type Levels<'a> = BTreeMap<&'a str, &'a str>;

#[derive(Serialize)]
struct MeanOver<'a> {
    columns: &'a [String],
    strata: Vec<StratumObject<'a>>,
}

#[derive(Serialize)]
struct StratumObject<'a> {
    values: Levels<'a>,
    pairs: usize,
}

#[derive(Serialize)]
struct Failed {
    in_first: usize,
    in_second: usize,
    in_both: usize,
}

/// Members that do not exist are null.
#[derive(Serialize)]
struct MetricObject<'a> {
    metric: &'a str,
    verdict: &'static str,
    sentence: String,
    pairs: usize,
    seeds: usize,
    means: [f64; 2],
    difference: f64,
    interval: Option<[f64; 2]>,
    method: &'static str,
    p_value: Option<f64>,
    /// The method of the p-value, and so of the adjusted one: Student's where the bootstrap cannot give so small a number.
    p_method: &'static str,
    p_adjusted: Option<f64>,
    cohens_dz: Option<f64>,
    wilcoxon: Option<Wilcoxon>,
    cut_off: Option<CutOff>,
    #[serde(skip_serializing_if = "Option::is_none")]
    by_stratum: Option<ByStratum<'a>>,
}

/// The test is the analysis of variance of repeated measures, with Greenhouse and Geisser's epsilon.
#[derive(Serialize)]
struct ByStratum<'a> {
    differ: bool,
    seeds: usize,
    f: Option<f64>,
    degrees: Option<[f64; 2]>,
    epsilon: Option<f64>,
    p_value: Option<f64>,
    p_adjusted: Option<f64>,
    strata: Vec<StratumMetric<'a>>,
}

#[derive(Serialize)]
struct StratumMetric<'a> {
    values: Levels<'a>,
    #[serde(flatten)]
    metric: MetricObject<'a>,
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

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let sides = self.sides.iter().map(|side| Side {
            side: side.letter,
            description: &side.description,
            runs: side.runs,
            failed: side.failed,
            queries: side.queries,
            notes: side.notes(),
        });
        let comparisons = self.against_a.iter().map(|against| {
            let missing = self.missing.iter().filter(|(letter, _)| *letter == against.letter);
            against_a(against, missing.map(|(_, name)| name.as_str()).collect())
        });
        let object = Object {
            program_version: PROGRAM_VERSION,
            confidence: CONFIDENCE,
            sides: sides.collect(),
            comparisons: comparisons.collect(),
        };
        object.serialize(serializer)
    }
}

fn against_a<'a>(against: &'a Against, metrics_without_pairs: Vec<&'a str>) -> AgainstA<'a> {
    let Against { letter, settings: differing, pairs, judged } = against;
    let [in_first, in_second, in_both] = pairs.failed;
    let strata = (0..pairs.strata.len())
        .map(|index| StratumObject { values: levels(pairs, index), pairs: pairs.strata[index].pairs });
    AgainstA {
        side: *letter,
        against: 'A',
        settings: settings(differing, *letter, pairs),
        pairs: pairs.runs.len(),
        mean_over: (pairs.strata.len() > 1).then(|| MeanOver { columns: &pairs.columns, strata: strata.collect() }),
        without_partner: pairs.without_partner,
        failed_pairs: Failed { in_first, in_second, in_both },
        metrics: judged.iter().map(|judged| metric(judged, *letter, pairs)).collect(),
        metrics_without_pairs,
    }
}

fn settings<'a>(settings: &'a SettingsDifference, letter: char, pairs: &'a Pairs) -> Settings<'a> {
    let differences = settings.differences.iter().map(|difference| SettingDifference {
        key: &difference.key,
        values: &difference.values,
        only_where: (!difference.strata.is_empty())
            .then(|| difference.strata.iter().map(|&index| levels(pairs, index)).collect()),
    });
    Settings {
        sentence: settings.conclusion(letter),
        difference_is_the_planners: settings.is_the_planners(),
        differences: differences.collect(),
        program_versions: &settings.program_versions,
        seeds: &settings.seeds,
        not_known: settings.unknown.iter().map(|(side, reason)| NotKnown { side: *side, reason }).collect(),
    }
}

fn levels(pairs: &Pairs, stratum: usize) -> Levels<'_> {
    let columns = pairs.columns.iter().map(String::as_str);
    columns.zip(pairs.strata[stratum].levels.iter().map(String::as_str)).collect()
}

fn metric<'a>(judged: &'a JudgedContrast, letter: char, pairs: &'a Pairs) -> MetricObject<'a> {
    let Contrast { metric, pairs: count, seeds, means, difference, interval, .. } = &judged.contrast;
    MetricObject {
        metric: &metric.name,
        verdict: verdict(judged.verdict),
        sentence: judged.sentence(letter),
        pairs: *count,
        seeds: *seeds,
        means: *means,
        difference: *difference,
        interval: interval.map(|interval| [interval.low, interval.high]),
        method: judged.contrast.method.name(),
        p_value: judged.contrast.p_value,
        p_method: judged.contrast.p_method.name(),
        p_adjusted: judged.p_adjusted,
        cohens_dz: judged.contrast.effect_dz,
        wilcoxon: wilcoxon(judged),
        cut_off: cut_off(&judged.contrast),
        by_stratum: judged.by_stratum.as_ref().map(|strata| by_stratum(strata, letter, pairs)),
    }
}

fn by_stratum<'a>(judged: &'a JudgedStrata, letter: char, pairs: &'a Pairs) -> ByStratum<'a> {
    let stratum_metric = |(index, judged): &'a (usize, JudgedContrast)| StratumMetric {
        values: levels(pairs, *index),
        metric: metric(judged, letter, pairs),
    };
    ByStratum {
        differ: judged.differ(),
        seeds: judged.seeds,
        // JSON has no infinity.
        f: judged.test.map(|test| test.f).filter(|f| f.is_finite()),
        degrees: judged.test.map(|test| test.degrees),
        epsilon: judged.test.map(|test| test.epsilon),
        p_value: judged.test.map(|test| test.p_value),
        p_adjusted: judged.p_adjusted,
        strata: judged.strata.iter().map(stratum_metric).collect(),
    }
}

fn wilcoxon(judged: &JudgedContrast) -> Option<Wilcoxon> {
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
