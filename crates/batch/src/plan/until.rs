//! The rule by which a batch stops before its last seed.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BatchPlan, PlannedRun, Seeds, Value};

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
}

impl StoppingRule {
    /// The error that all questions of a batch share.
    const ERROR: f64 = 0.05;

    /// Returns the error of each of so many questions.
    pub fn error_of_each(questions: usize) -> f64 {
        Self::ERROR / questions.max(1) as f64
    }

    /// Returns the pairs of variants that are compared, by their places: those with equal swept values, such as two planners
    /// at one coverage, or all if there are none of these.
    pub fn pairs(swept: &[&[Value]]) -> Vec<VariantPair> {
        let firsts = 0..swept.len();
        let all = firsts.flat_map(|first| (first + 1..swept.len()).map(move |second| VariantPair { first, second }));
        let (alike, others): (Vec<_>, Vec<_>) = all.partition(|pair| swept[pair.first] == swept[pair.second]);
        if alike.is_empty() { others } else { alike }
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
    /// The difference of each pair, or the mean of an only variant, to this much on each side.
    Within { half_width: f64 },
}

impl StoppingGoal {
    /// Returns whether its number can be one.
    pub fn is_valid(self) -> bool {
        match self {
            Self::Decided { margin } => margin >= 0.0 && margin.is_finite(),
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
        }
    }
}

impl BatchPlan {
    /// Returns the plan with its first seeds only.
    pub fn shortened(&self, seeds: u64) -> Self {
        Self { seeds: self.seeds.first(seeds), ..self.clone() }
    }

    /// Returns the number that a run of this plan has in one with more seeds.
    pub fn number_among(&self, longer: &Self, run: &PlannedRun<'_>) -> u64 {
        let [variant, place] = [(run.number - 1) / self.seeds.count(), (run.number - 1) % self.seeds.count()];
        variant * longer.seeds.count() + place + 1
    }

    /// Names the rule by which the batch stops, or nothing.
    pub(super) fn rule_text(&self) -> String {
        self.until.as_ref().map_or("nothing".into(), ToString::to_string)
    }

    /// Says by what rule the batch stops, and after how many seeds it did: `saved decided, after 66 of at most 1000
    /// seeds`. `None` without a rule.
    pub fn stop_text(&self) -> Option<String> {
        let rule = self.until.as_ref()?;
        Some(format!("{rule}, after {} of at most {} seeds", self.seeds.count(), rule.max_seeds.count()))
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
