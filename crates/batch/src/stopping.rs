//! Batches that stop when enough is known: their seeds are played in rounds, and after each is a look at what is known.
//!
//! Looks are at fixed numbers of seeds, 20, 30, 40 and so on, so that they do not depend on workers. What is known at a
//! look is an interval of [`sequence_interval`], which holds at all looks together; several questions share its error
//! equally.

use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use thiserror::Error;

use crate::comparison::{ComparisonError, Metric, USUAL_METRIC};
use crate::execute::{Batch, BatchError, RunEnd, RunScenario};
use crate::plan::{BatchPlan, StoppingGoal, StoppingRule, VariantPair};
use crate::stats::{Interval, Series, first_look, sequence_interval};
use crate::table::RunRecord;
use wildfire_base::document::number::{rounded, two_digits};

/// The seeds before the first look, and between two.
pub const FIRST_LOOK: u64 = 20;
pub const STEP: u64 = 10;

/// The most variants that a rule compares, each pair by its own share of the error.
const MAX_VARIANTS: usize = 100;

/// The most estimates that are listed.
const MAX_LISTED: usize = 30;

/// The seeds of which a batch with a rule plays the first, unless others are given.
pub const USUAL_MAX_SEEDS: &str = "1..1000";

/// What is to be known before a batch stops, as people write it: `decided`, or `saved=0.5`.
#[derive(Clone, Debug, PartialEq)]
pub enum Until {
    Decided,
    Within { metric: String, half_width: f64 },
}

/// A rule before its plan is known.
#[derive(Clone, Debug, PartialEq)]
pub struct StopRequest {
    pub until: Until,
    /// The metric of [`Until::Decided`], if it is not the usual one.
    pub metric: Option<String>,
    /// The margin within which variants are as good as equal, in the unit of the metric.
    pub equivalent: Option<f64>,
}

/// A reason for which a batch cannot have a rule.
#[derive(Debug, Error)]
pub enum StopError {
    #[error(transparent)]
    Metric(#[from] ComparisonError),
    #[error("`until` is `decided`, which compares variants, and there is one")]
    OneVariant,
    #[error("a metric or a margin belongs to `decided`; expected none beside METRIC=HALF-WIDTH")]
    NotDecided,
    #[error("there are {count} variants to compare; a rule compares at most {MAX_VARIANTS}")]
    TooMany { count: usize },
    #[error("the margin is {margin}; expected a number above zero, in the unit of the metric")]
    Margin { margin: f64 },
}

impl StopError {
    /// Returns what would help.
    pub fn help(&self) -> Option<&'static str> {
        let of_one = "several planners, or a list for a key; of one variant the mean can be known: --until saved=0.5";
        matches!(self, Self::OneVariant).then_some(of_one)
    }
}

impl FromStr for Until {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let expected = "expected `decided`, or a metric and the half-width of its interval, such as `saved=0.5`";
        match word.split_once('=') {
            None if word == "decided" => Ok(Self::Decided),
            None => Err(expected.into()),
            Some((metric, number)) => {
                let half_width =
                    number.trim().parse().ok().filter(|&half_width| StoppingGoal::Within { half_width }.is_valid());
                let half_width = half_width.ok_or("expected a half-width above zero, in the unit of the metric")?;
                Ok(Self::Within { metric: metric.trim().to_owned(), half_width })
            }
        }
    }
}

impl StopRequest {
    /// Returns the rule for a plan, whose seeds are the most that it has.
    ///
    /// # Errors
    /// If the metric is unknown or a measured time, or if nothing can be decided.
    pub fn rule(&self, plan: &BatchPlan) -> Result<StoppingRule, StopError> {
        let (metric, goal) = match &self.until {
            Until::Decided if plan.variants.len() == 1 => return Err(StopError::OneVariant),
            _ if plan.variants.len() > MAX_VARIANTS => return Err(StopError::TooMany { count: plan.variants.len() }),
            Until::Decided => {
                let margin = self.equivalent.unwrap_or(0.0);
                (self.metric.as_deref().unwrap_or(USUAL_METRIC), StoppingGoal::Decided { margin })
            }
            Until::Within { .. } if self.metric.is_some() || self.equivalent.is_some() => {
                return Err(StopError::NotDecided);
            }
            Until::Within { metric, half_width } => (metric.as_str(), StoppingGoal::Within { half_width: *half_width }),
        };
        match goal {
            StoppingGoal::Decided { margin } if !goal.is_valid() => Err(StopError::Margin { margin }),
            _ => {
                let metric = Metric::of_outcomes(metric)?.name.into_owned();
                Ok(StoppingRule { metric, goal, max_seeds: plan.seeds.clone() })
            }
        }
    }
}

/// What is known after so many seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    pub seeds: u64,
    pub estimates: Vec<SequenceEstimate>,
}

/// A batch all of whose runs are over.
pub struct PlayedBatch {
    /// The batch of the seeds that were played.
    pub batch: Batch,
    /// What is known after the last of them, if a rule asked for something.
    pub look: Option<Look>,
}

/// What is known of one question.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceEstimate {
    /// Two variants by their places in the plan, the difference of the second from the first; or one, its mean.
    pub of: EstimateOf,
    pub mean: f64,
    pub interval: Option<Interval>,
    /// True if the rule asks for no more.
    pub is_settled: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateOf {
    Variant(usize),
    Pair(VariantPair),
}

impl Look {
    /// Returns whether all questions are answered.
    pub fn is_over(&self) -> bool {
        self.estimates.iter().all(|estimate| estimate.is_settled)
    }

    /// Returns the estimates as sentences, and what their intervals mean.
    pub fn sentences(&self, plan: &BatchPlan) -> Vec<String> {
        let Some(StoppingRule { metric, .. }) = &plan.until else { return Vec::new() };
        let more = self.estimates.len().saturating_sub(MAX_LISTED);
        let more = (more > 0).then(|| format!("and {more} more; `wildfire compare` lists them"));
        let estimates = self.estimates.iter().take(MAX_LISTED).map(|estimate| {
            let what = match estimate.of {
                EstimateOf::Variant(variant) => format!("{metric}, {}", plan.title(&plan.variants[variant])),
                EstimateOf::Pair(VariantPair { first, second }) => {
                    let [first, second] = [first, second].map(|it| plan.title(&plan.variants[it]));
                    format!("{metric}, {second} minus {first}")
                }
            };
            format!("{what}: {}", estimate.amount())
        });
        let note = "These intervals hold at every number of seeds, 95 % for all together; those of tables are for a number \
                    that was fixed before.";
        let open = self.estimates.iter().filter(|estimate| !estimate.is_settled).count();
        let unsettled = (open > 0).then(|| format!("Not known after all seeds: {open} of {}.", self.estimates.len()));
        estimates.chain(more).chain(unsettled).chain([note.to_owned()]).collect()
    }

    /// Returns the widest interval in a few words, for a line of progress.
    pub fn progress(&self, plan: &BatchPlan) -> String {
        let open = self.estimates.iter().filter(|estimate| !estimate.is_settled);
        let metric = plan.until.as_ref().map_or("", |rule| &rule.metric);
        let widest = open.clone().max_by(|one, other| one.width().total_cmp(&other.width()));
        widest.map_or_else(String::new, |estimate| format!("({} open: {metric} {})", open.count(), estimate.amount()))
    }
}

impl SequenceEstimate {
    fn width(&self) -> f64 {
        self.interval.map_or(f64::INFINITY, |it| it.high - it.low)
    }

    /// `4.2 (2.9 to 5.4)`.
    fn amount(&self) -> String {
        let decimals = self.interval.map_or(2, |it| two_digits(0.5 * (it.high - it.low)));
        let [mean, low, high] = [Some(self.mean), self.interval.map(|it| it.low), self.interval.map(|it| it.high)]
            .map(|value| value.map_or("-".to_owned(), |value| rounded(value, decimals)));
        format!("{mean} ({low} to {high})")
    }
}

/// The values of a rule's metric so far.
struct Monitor {
    rule: StoppingRule,
    metric: Metric,
    pairs: Vec<VariantPair>,
    /// By variant and seed, in the order of the plan; NaN of runs without a value.
    values: Vec<Vec<f64>>,
}

impl Monitor {
    fn new(rule: StoppingRule, plan: &BatchPlan) -> Self {
        let values = vec![Vec::new(); plan.variants.len()];
        Self { metric: Metric::from_name(&rule.metric), rule, pairs: pairs(plan), values }
    }

    fn look(&self) -> Look {
        let of_pairs = self.pairs.iter().copied().map(EstimateOf::Pair);
        let questions: Vec<EstimateOf> =
            if self.pairs.is_empty() { vec![EstimateOf::Variant(0)] } else { of_pairs.collect() };
        let alpha = StoppingRule::error_of_each(questions.len());
        let estimates = questions.into_iter().map(|of| self.estimate(of, alpha)).collect();
        Look { seeds: self.values[0].len() as u64, estimates }
    }

    fn estimate(&self, of: EstimateOf, alpha: f64) -> SequenceEstimate {
        let values = match of {
            EstimateOf::Variant(variant) => self.values[variant].clone(),
            EstimateOf::Pair(VariantPair { first, second }) => {
                self.values[first].iter().zip(&self.values[second]).map(|(first, second)| second - first).collect()
            }
        };
        let values: Vec<f64> = values.into_iter().filter(|value| !value.is_nan()).collect();
        let series = Series::from_values(&values);
        let interval = sequence_interval(&series, alpha);
        let is_early = first_look(&values).is_none_or(|first| values.len() < first);
        let is_settled = !is_early
            && interval.is_some_and(|interval| match self.rule.goal {
                StoppingGoal::Decided { margin } => {
                    let Interval { low, high } = interval;
                    interval.excludes_zero() || margin > 0.0 && -margin <= low && high <= margin
                }
                StoppingGoal::Within { half_width } => interval.high - interval.low <= 2.0 * half_width,
            });
        SequenceEstimate { of, mean: series.mean().unwrap_or(f64::NAN), interval, is_settled }
    }
}

fn pairs(plan: &BatchPlan) -> Vec<VariantPair> {
    StoppingRule::pairs(&plan.variants.iter().map(|variant| &variant.swept[..]).collect::<Vec<_>>())
}

impl Batch {
    /// Executes the batch with this function until its rule stops it, or to its last seed, and leaves it with the seeds
    /// that were played; without a rule, executes all of it.
    ///
    /// # Errors
    /// As [`Batch::run`].
    pub fn run_until(
        mut self,
        run: Box<RunScenario>,
        jobs: usize,
        stop: &Arc<AtomicBool>,
        mut on_run: impl FnMut(RunEnd),
        mut on_look: impl FnMut(&Look),
    ) -> Result<PlayedBatch, BatchError> {
        let Some(rule) = self.plan().until.clone() else {
            self.run_with(run, jobs, stop, on_run)?;
            return Ok(PlayedBatch { batch: self, look: None });
        };
        let run = Arc::from(run);
        let max_seeds = self.plan().seeds.count();
        let mut monitor = Monitor::new(rule, self.plan());
        let mut played = 0;
        loop {
            let seeds = if played == 0 { FIRST_LOOK } else { played + STEP }.min(max_seeds);
            self.run_some(move |run| (run - 1) % max_seeds < seeds, &run, jobs, stop, &mut on_run)?;
            let mut rows = self.rows()?;
            for (variant, values) in (0..).zip(&mut monitor.values) {
                for place in played..seeds {
                    let row = rows.row(variant * max_seeds + place + 1)?;
                    values.push(monitor.metric.value(&RunRecord::from_row(&row)).unwrap_or(f64::NAN));
                }
            }
            played = seeds;
            let look = monitor.look();
            on_look(&look);
            if look.is_over() || played == max_seeds {
                let batch = if played < max_seeds { self.shorten(played)? } else { self };
                return Ok(PlayedBatch { batch, look: Some(look) });
            }
        }
    }
}
