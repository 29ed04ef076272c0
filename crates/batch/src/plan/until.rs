//! The rule by which a batch stops before its last seed.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BatchPlan, FreeKeys, FreeParameters, RunLabel, Seeds, Value};

/// What must be known of a metric before a batch stops, and the seeds that it has at most.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StoppingRule {
    /// The metric, as `wildfire compare --metric` names it.
    pub metric: String,
    pub goal: StoppingGoal,
    /// All seeds, of which the batch plays the first.
    #[serde(with = "seeds_text")]
    #[schemars(with = "String")]
    pub max_seeds: Seeds,
    /// The number of seeds that each variant has played, where some stopped before others; else empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub played: Vec<u64>,
}

/// The most variants that a rule is for.
pub const MAX_COMPARED: usize = 1000;

/// Something that a rule wants to know: the mean of a variant, or the difference of the second variant of a pair from the
/// first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateOf {
    Variant(usize),
    Pair(VariantPair),
}

impl StoppingRule {
    /// The error that all questions of a batch share.
    const ERROR: f64 = 0.05;

    /// Returns the error of each of so many questions.
    pub fn error_of_each(questions: usize) -> f64 {
        Self::ERROR / questions.max(1) as f64
    }

    /// Returns the number of questions that share the error, of variants with these swept values.
    pub fn question_count(&self, swept: &[&[Value]]) -> usize {
        match self.goal {
            // Each with the best, whichever that is.
            StoppingGoal::Groups { .. } => swept.len() - 1,
            _ => self.estimates(swept).len(),
        }
    }

    /// Returns what is estimated of variants with these swept values: the differences of pairs with equal values, such as
    /// two planners at one coverage; without such pairs, the means of all variants, or the differences of all pairs.
    pub fn estimates(&self, swept: &[&[Value]]) -> Vec<EstimateOf> {
        let variants = 0..swept.len();
        let pairs = variants
            .clone()
            .flat_map(|first| (first + 1..swept.len()).map(move |second| VariantPair { first, second }));
        let (alike, others): (Vec<_>, Vec<_>) = pairs.partition(|pair| swept[pair.first] == swept[pair.second]);
        match self.goal {
            _ if !alike.is_empty() => alike.into_iter().map(EstimateOf::Pair).collect(),
            StoppingGoal::Within { .. } => variants.map(EstimateOf::Variant).collect(),
            _ => others.into_iter().map(EstimateOf::Pair).collect(),
        }
    }
}

/// Two variants of a plan by their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VariantPair {
    pub first: usize,
    pub second: usize,
}

/// What must be known, in the unit of the metric.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StoppingGoal {
    /// Of each pair of variants, that they differ; or, with a margin above zero, that they differ by less.
    Decided { margin: f64 },
    /// The difference of each pair, or the mean of each variant, to this much on each side.
    Within { half_width: f64 },
    /// The variants that are as good as the best: others are dropped once they are known to be worse. Those that are left may
    /// differ by less than a margin above zero, which ends the batch too.
    Groups { margin: f64 },
}

impl StoppingGoal {
    /// Returns whether its number can be one.
    pub fn is_valid(self) -> bool {
        match self {
            Self::Decided { margin } | Self::Groups { margin } => margin >= 0.0 && margin.is_finite(),
            Self::Within { half_width } => half_width > 0.0 && half_width.is_finite(),
        }
    }
}

/// `saved to within 0.5`, `saved decided`.
impl fmt::Display for StoppingRule {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let metric = &self.metric;
        match self.goal {
            StoppingGoal::Decided { margin: 0.0 } => write!(f, "{metric} decided"),
            StoppingGoal::Decided { margin } => write!(f, "{metric} decided, or equal to within {margin}"),
            StoppingGoal::Within { half_width } => write!(f, "{metric} to within {half_width}"),
            StoppingGoal::Groups { margin: 0.0 } => write!(f, "the best by {metric}"),
            StoppingGoal::Groups { margin } => write!(f, "the best by {metric}, to within {margin}"),
        }
    }
}

impl BatchPlan {
    /// Returns the plan with so many of its first seeds for each variant.
    pub fn shortened(&self, played: &[u64]) -> Self {
        let max = played.iter().copied().max().unwrap_or(0);
        let differ = played.iter().any(|&seeds| seeds != max);
        let played = if differ { played.to_vec() } else { Vec::new() };
        let until = self.until.clone().map(|rule| StoppingRule { played, ..rule });
        Self { seeds: self.seeds.first(max), until, ..self.clone() }
    }

    /// Returns the variants of each entry of a ranking: those of one planner, one policy, and equal values of the keys in
    /// which entries may differ. Means of an entry are over its variants.
    pub fn entries(&self) -> Vec<Vec<usize>> {
        let keys: Vec<&str> = self.free.iter().map(String::as_str).collect();
        let free = FreeParameters::parse(&keys).map_or_else(|_| FreeKeys::default(), |free| free.keys);
        let mut entries: Vec<(Vec<String>, Vec<usize>)> = Vec::new();
        for (index, variant) in self.variants.iter().enumerate() {
            // The seed is no part of an entry's name; a label just needs one.
            let label = RunLabel::from_scenario(&variant.scenario, 0);
            let swept = self.swept_keys.iter().zip(&variant.swept).filter(|(key, _)| free.belongs_to_entry(key));
            let values = swept.map(|(_, value)| value.to_string());
            let name: Vec<String> = [label.policy(), label.planner].into_iter().chain(values).collect();
            match entries.iter_mut().find(|(existing, _)| *existing == name) {
                Some((_, variants)) => variants.push(index),
                None => entries.push((name, vec![index])),
            }
        }
        entries.into_iter().map(|(_, variants)| variants).collect()
    }

    /// Returns how many seeds each variant has.
    pub fn played(&self) -> Vec<u64> {
        (0..self.variants.len()).map(|variant| self.seeds_of(variant)).collect()
    }

    /// Names the rule by which the batch stops, or nothing.
    pub(super) fn rule_text(&self) -> String {
        self.until.as_ref().map_or("nothing".into(), ToString::to_string)
    }

    /// Says by what rule the batch stops, and after how many seeds it did: `saved decided, after 66 of at most 1000
    /// seeds`. `None` without a rule.
    pub fn stop_text(&self) -> Option<String> {
        let rule = self.until.as_ref()?;
        Some(format!("{rule}, after {} of at most {} seeds", self.seeds_text(), rule.max_seeds.count()))
    }

    /// Returns how many seeds a variant has, or the range of that: `20 to 66`.
    pub fn seeds_text(&self) -> String {
        match self.played().iter().min() {
            Some(&min) if min < self.seeds.count() => format!("{min} to {}", self.seeds.count()),
            _ => self.seeds.count().to_string(),
        }
    }

    /// Returns whether these are the rule's: the first of its seeds, and at least one of them for each variant.
    pub(crate) fn has_seeds_of_rule(&self) -> bool {
        self.until.as_ref().is_none_or(|rule| {
            let possible = 1..=self.seeds.count();
            rule.max_seeds.first(self.seeds.count()) == self.seeds
                && (rule.played.is_empty() || rule.played.len() == self.variants.len())
                && rule.played.iter().all(|seeds| possible.contains(seeds))
        })
    }
}

mod seeds_text {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    use super::Seeds;

    pub fn serialize<S: Serializer>(seeds: &Seeds, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(seeds)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Seeds, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}
