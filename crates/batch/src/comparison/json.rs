//! A comparison as one JSON object. Members that do not exist are null; pairs of values are those of A and the other side.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::comparison::{
    Comparison, ComparisonToA, Difference, JudgedContrast, JudgedStrata, Pairs, PowerAnswer, SettingsDifference,
    SideSummary,
};
use crate::plan::PROGRAM_VERSION;
use crate::stats::{CONFIDENCE, Equivalence};
use wildfire_base::object;

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let sides = self.sides.iter().map(|side| {
            let SideSummary { letter, ref description, runs, failed, queries } = *side;
            object!(Side { side: letter, description: description.clone(), runs, failed, queries, notes: side.notes() })
        });
        let comparison = object!(Object {
            program_version: PROGRAM_VERSION,
            confidence: CONFIDENCE,
            sides: sides.collect::<Vec<_>>(),
            comparisons: self.against_a.iter().map(|against| against_a(self, against)).collect::<Vec<_>>(),
        });
        comparison.serialize(serializer)
    }
}

fn against_a(comparison: &Comparison, against: &ComparisonToA) -> impl Serialize {
    let ComparisonToA { letter, settings: differing, pairs, judged } = against;
    let [in_first, in_second, in_both] = pairs.failed;
    let strata = (0..pairs.strata.len())
        .map(|index| object!(Stratum { values: levels(pairs, index), pairs: pairs.strata[index].pairs }));
    let missing = comparison.missing.iter().filter(|(side, _)| side == letter);
    object!(Against {
        side: letter,
        against: 'A',
        settings: settings(differing, *letter, pairs),
        pairs: pairs.runs.len(),
        mean_over: (pairs.strata.len() > 1)
            .then(|| { object!(MeanOver { columns: &pairs.columns, strata: strata.collect::<Vec<_>>() }) }),
        without_partner: pairs.without_partner,
        failed_pairs: object!(Failed { in_first, in_second, in_both }),
        metrics: judged.iter().map(|judged| metric(judged, *letter, pairs)).collect::<Vec<_>>(),
        metrics_without_pairs: missing.map(|(_, name)| name).collect::<Vec<_>>(),
    })
}

fn settings(settings: &SettingsDifference, letter: char, pairs: &Pairs) -> impl Serialize {
    let differences = settings.differences.iter().map(|Difference { key, values, strata }| {
        object!(Setting {
            key: key.clone(),
            values: values.clone(),
            only_where: (!strata.is_empty())
                .then(|| strata.iter().map(|&index| levels(pairs, index)).collect::<Vec<_>>())
        })
    });
    let unknown = settings.unknown.iter().map(|(side, reason)| object!(UnknownSide { side, reason }));
    object!(Settings {
        sentence: settings.conclusion(letter),
        difference_is_the_planners: settings.is_the_planners(),
        differences: differences.collect::<Vec<_>>(),
        program_versions: &settings.program_versions,
        seeds: &settings.seeds,
        not_known: unknown.collect::<Vec<_>>(),
    })
}

/// Returns a value for each column that the strata differ in.
fn levels(pairs: &Pairs, stratum: usize) -> BTreeMap<&String, &String> {
    pairs.columns.iter().zip(pairs.levels(stratum)).collect()
}

fn metric(judged: &JudgedContrast, letter: char, pairs: &Pairs) -> impl Serialize {
    let strata = judged.by_stratum.as_ref();
    object!(Metric {
        #[serde(flatten)]
        figures: figures(judged, letter),
        // Without strata there is no member.
        #[serde(flatten)]
        strata: strata.map(|strata| object!(Strata { by_stratum: by_stratum(strata, letter, pairs) })),
        // Nor without a question.
        #[serde(flatten)]
        power: judged.power.map(|power| object!(PowerMember { power: power_of(power) })),
        #[serde(flatten)]
        equivalence: judged.equivalence.map(|it| object!(Tested { equivalence: equivalence_of(it) })),
    })
}

fn figures(judged: &JudgedContrast, letter: char) -> impl Serialize {
    let contrast = &judged.contrast;
    let wilcoxon = contrast.ranks.map(|ranks| {
        object!(Wilcoxon {
            above: ranks.above,
            below: ranks.below,
            zeros: ranks.zeros,
            p_value: ranks.p_value,
            p_adjusted: judged.ranks_p_adjusted,
            rank_biserial: ranks.rank_biserial(),
        })
    });
    object!(Figures {
        metric: &contrast.metric.name,
        verdict: judged.verdict.name(),
        sentence: judged.sentence(letter),
        pairs: contrast.pairs,
        seeds: contrast.seeds,
        means: contrast.means,
        difference: contrast.difference,
        interval: contrast.interval,
        method: contrast.method.name(),
        p_value: contrast.p_value,
        p_method: contrast.p_method.name(),
        p_adjusted: judged.p_adjusted,
        cohens_dz: contrast.effect_dz,
        wilcoxon,
        cut_off: &contrast.cut_off,
    })
}

fn power_of(answer: PowerAnswer) -> impl Serialize {
    let PowerAnswer { difference, power, seeds_needed, detectable } = answer;
    object!(Power { difference, power, seeds_needed, detectable })
}

/// The interval is of 90 %.
fn equivalence_of(found: Equivalence) -> impl Serialize {
    let Equivalence { margin, interval, p_value } = found;
    object!(Equivalent { margin, equivalent: found.is_equivalent(), interval_90: interval, p_value })
}

/// The test is the analysis of variance of repeated measures, with Greenhouse and Geisser's epsilon.
fn by_stratum(judged: &JudgedStrata, letter: char, pairs: &Pairs) -> impl Serialize {
    let strata = judged.strata.iter().map(|(index, judged)| {
        object!(Stratum {
            values: levels(pairs, *index),
            #[serde(flatten)]
            figures: figures(judged, letter),
        })
    });
    object!(ByStratum {
        differ: judged.differ(),
        seeds: judged.seeds,
        f: judged.test.map(|test| test.f),
        degrees: judged.test.map(|test| test.degrees),
        epsilon: judged.test.map(|test| test.epsilon),
        p_value: judged.test.map(|test| test.p_value),
        p_adjusted: judged.p_adjusted,
        strata: strata.collect::<Vec<_>>(),
    })
}
