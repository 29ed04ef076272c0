//! Batches that stop when enough is known: their seeds are played in rounds, and after each is a look at what is known.
//!
//! Looks are at fixed numbers of seeds, 20, 30, 40 and so on, so that they do not depend on workers. What is known at a
//! look is an interval of [`sequence_interval`], which holds at all looks together; several questions share its error
//! equally.

use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use thiserror::Error;

use crate::comparison::{Better, ComparisonError, Metric, USUAL_METRIC};
use crate::execute::{Batch, BatchError, RunEnd, RunScenario};
use crate::plan::{BatchPlan, EstimateOf, MAX_COMPARED, RunPlace, StoppingGoal, StoppingRule, Value, VariantPair};
use crate::stats::{Interval, Series, first_look, sequence_interval};
use crate::table::RunRecord;
use wildfire_base::document::number::{rounded, two_digits};

/// The seeds before the first look, and between two.
pub const FIRST_LOOK: u64 = 20;
pub const STEP: u64 = 10;

/// The most pairs of variants that a rule compares, each by its own share of the error.
const MAX_PAIRS: usize = 5000;

/// The most estimates that are listed.
const MAX_LISTED: usize = 30;

/// The seeds of which a batch with a rule plays the first, unless others are given.
pub const USUAL_MAX_SEEDS: &str = "1..1000";

/// What is to be known before a batch stops, as people write it: `decided`, `groups` or `saved=0.5`.
#[derive(Clone, Debug, PartialEq)]
pub enum Until {
    Decided,
    Groups,
    Within { metric: String, half_width: f64 },
}

/// A rule before its plan is known.
#[derive(Clone, Debug, PartialEq)]
pub struct StopRequest {
    pub until: Until,
    /// The metric, if it is not the usual one and `until` names none.
    pub metric: Option<String>,
    /// The margin within which variants are as good as equal, in the unit of the metric.
    pub equivalent: Option<f64>,
}

/// A reason for which a batch cannot have a rule.
#[derive(Debug, Error)]
pub enum StopError {
    #[error(transparent)]
    Metric(#[from] ComparisonError),
    #[error("`until` is `{until}`, which compares variants, and there is one")]
    OneVariant { until: &'static str },
    #[error(
        "`until` is `groups`, which compares entries, and there is one; expected planners, policies or settings of these that differ"
    )]
    OneEntry,
    #[error("a metric or a margin belongs to `decided` and `groups`; expected none beside METRIC=HALF-WIDTH")]
    NotDecided,
    #[error(
        "nothing says whether more or less of `{metric}` is better; expected a metric of the contest, such as saved"
    )]
    WhichIsBetter { metric: String },
    #[error("there are {count} variants; a rule is for at most {MAX_COMPARED}")]
    TooMany { count: usize },
    #[error("there are {count} pairs of variants to compare; a rule compares at most {MAX_PAIRS}")]
    TooManyPairs { count: usize },
    #[error("the margin is {margin}; expected a number above zero, in the unit of the metric")]
    Margin { margin: f64 },
}

impl StopError {
    /// Returns what would help.
    pub fn help(&self) -> Option<&'static str> {
        let of_one = "several planners, or a list for a key; of one variant the mean can be known: --until saved=0.5";
        matches!(self, Self::OneVariant { .. }).then_some(of_one)
    }
}

impl FromStr for Until {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let expected =
            "expected `decided`, `groups`, or a metric and the half-width of its interval, such as `saved=0.5`";
        match word.split_once('=') {
            None if word == "decided" => Ok(Self::Decided),
            None if word == "groups" => Ok(Self::Groups),
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
        let margin = self.equivalent.unwrap_or(0.0);
        let usual = self.metric.as_deref().unwrap_or(USUAL_METRIC);
        let (metric, goal) = match &self.until {
            // With one variant there is no pair to decide on.
            Until::Decided if plan.variants.len() == 1 => return Err(StopError::OneVariant { until: "decided" }),
            Until::Groups if plan.entries().len() == 1 => return Err(StopError::OneEntry),
            _ if plan.variants.len() > MAX_COMPARED => return Err(StopError::TooMany { count: plan.variants.len() }),
            Until::Decided => (usual, StoppingGoal::Decided { margin }),
            Until::Groups => (usual, StoppingGoal::Groups { margin }),
            // A width is about the metric that `--until` names, so a second one contradicts it.
            Until::Within { .. } if self.metric.is_some() || self.equivalent.is_some() => {
                return Err(StopError::NotDecided);
            }
            Until::Within { metric, half_width } => (metric.as_str(), StoppingGoal::Within { half_width: *half_width }),
        };
        let metric = Metric::of_outcomes(metric)?;
        let has_direction = metric.about.better.is_some();
        let metric = metric.name.into_owned();
        let rule = StoppingRule { metric, goal, max_seeds: plan.seeds.clone(), played: Vec::new() };
        match goal {
            _ if !goal.is_valid() => Err(StopError::Margin { margin }),
            StoppingGoal::Groups { .. } if !has_direction => Err(StopError::WhichIsBetter { metric: rule.metric }),
            StoppingGoal::Groups { .. } => Ok(rule),
            _ => {
                let count = rule.estimates(&swept(plan)).len();
                if count > MAX_PAIRS { Err(StopError::TooManyPairs { count }) } else { Ok(rule) }
            }
        }
    }
}

/// Returns a title for each variant; where a rule is about the best, the first variant of an entry has the entry's.
fn titles(plan: &BatchPlan) -> Vec<String> {
    let mut titles: Vec<String> = plan.variants.iter().map(|variant| plan.title(variant)).collect();
    if matches!(plan.until.as_ref().map(|rule| rule.goal), Some(StoppingGoal::Groups { .. })) {
        for variants in plan.entries() {
            let of_entry: Vec<_> = variants.iter().map(|&variant| &plan.variants[variant]).collect();
            titles[variants[0]] = plan.title_of_all(&of_entry);
        }
    }
    titles
}

/// Returns whether a difference is known to be within a margin above zero.
fn is_within(Interval { low, high }: Interval, margin: f64) -> bool {
    margin > 0.0 && -margin <= low && high <= margin
}

fn swept(plan: &BatchPlan) -> Vec<&[Value]> {
    plan.variants.iter().map(|variant| &variant.swept[..]).collect()
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
    pub of: EstimateOf,
    pub seeds: u64,
    pub mean: f64,
    pub interval: Option<Interval>,
    /// True if the rule asks for no more.
    pub is_settled: bool,
    /// True if the rule has dropped the second variant, which is known to be worse than the best one.
    pub is_worse: bool,
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
        let titles = titles(plan);
        let estimates = self.estimates.iter().take(MAX_LISTED).map(|estimate| {
            let what = match estimate.of {
                EstimateOf::Variant(variant) => titles[variant].clone(),
                EstimateOf::Pair(VariantPair { first, second }) => {
                    format!("{} minus {}", titles[second], titles[first])
                }
            };
            let after =
                if estimate.seeds < self.seeds { format!(", after {} seeds", estimate.seeds) } else { String::new() };
            format!("{metric}, {what}: {}{after}", estimate.amount())
        });
        let note = "These intervals hold at every number of seeds, 95 % for all together; those of tables, too, each by itself.";
        let open = self.estimates.iter().filter(|estimate| !estimate.is_settled).count();
        let unsettled = (open > 0).then(|| format!("Not known after all seeds: {open} of {}.", self.estimates.len()));
        let best = self.best(plan).map(|best| {
            let titles: Vec<&str> = best.into_iter().map(|variant| &titles[variant][..]).collect();
            format!("The best, and those not known to be worse: {}.", titles.join("; "))
        });
        best.into_iter().chain(estimates).chain(more).chain(unsettled).chain([note.to_owned()]).collect()
    }

    /// Returns the best variant and all that are not known to be worse, if the rule asks for these.
    pub fn best(&self, plan: &BatchPlan) -> Option<Vec<usize>> {
        plan.until.as_ref().filter(|rule| matches!(rule.goal, StoppingGoal::Groups { .. }))?;
        let mut best: Vec<usize> = Vec::new();
        for estimate in &self.estimates {
            let EstimateOf::Pair(VariantPair { first, second }) = estimate.of else { continue };
            best.extend(Some(first).filter(|first| !best.contains(first)));
            best.extend(Some(second).filter(|_| !estimate.is_worse));
        }
        best.sort_unstable();
        Some(best)
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

/// The values of a rule's metric so far, and which variants play on.
pub struct Monitor {
    rule: StoppingRule,
    metric: Metric,
    /// The estimated means and differences; empty where the rule asks for the best.
    estimates: Vec<EstimateOf>,
    /// The variants of each entry, of which a rule about the best drops some.
    entries: Vec<Vec<usize>>,
    /// The error of each estimate.
    alpha: f64,
    /// By variant and seed, in the order of the plan; NaN of runs without a value.
    values: Vec<Vec<f64>>,
    /// Whether a variant plays on.
    is_active: Vec<bool>,
}

impl Monitor {
    /// Begins to watch a plan, none of whose runs is over.
    pub fn new(rule: StoppingRule, plan: &BatchPlan) -> Self {
        let entries = plan.entries();
        let (estimates, questions) = match rule.goal {
            // The best entry is compared with every other one.
            StoppingGoal::Groups { .. } => (Vec::new(), entries.len() - 1),
            _ => (rule.estimates(&swept(plan)), rule.question_count(&swept(plan))),
        };
        Self {
            metric: Metric::from_name(&rule.metric),
            estimates,
            entries,
            alpha: StoppingRule::error_of_each(questions),
            values: vec![Vec::new(); plan.variants.len()],
            is_active: vec![true; plan.variants.len()],
            rule,
        }
    }

    /// Adds the value of a variant's next seed; NaN of a run without one.
    pub fn add(&mut self, variant: usize, value: f64) {
        self.values[variant].push(value);
    }

    /// Returns which variants play on.
    pub fn active(&self) -> &[bool] {
        &self.is_active
    }

    /// Looks at what is known, and lets variants stop of which nothing more is asked.
    pub fn look(&mut self) -> Look {
        let seeds = self.values.iter().map(Vec::len).max().unwrap_or(0) as u64;
        let estimates = match self.rule.goal {
            StoppingGoal::Groups { margin } => self.look_at_groups(margin),
            _ => {
                let estimates: Vec<_> = self.estimates.iter().map(|&of| self.estimate(of, &self.values)).collect();
                // A variant plays on if any open question needs it, even where its other questions are settled.
                self.is_active.fill(false);
                for estimate in estimates.iter().filter(|estimate| !estimate.is_settled) {
                    match estimate.of {
                        EstimateOf::Variant(variant) => self.is_active[variant] = true,
                        EstimateOf::Pair(VariantPair { first, second }) => {
                            self.is_active[first] = true;
                            self.is_active[second] = true;
                        }
                    }
                }
                estimates
            }
        };
        Look { seeds, estimates }
    }

    /// Compares all entries with the best one of those that play on, and drops those that are known to be worse. Of an entry
    /// its first variant stands for all.
    fn look_at_groups(&mut self, margin: f64) -> Vec<SequenceEstimate> {
        // Anybody may write a plan with a metric that has no better side.
        let better = self.metric.about.better.unwrap_or(Better::Higher);
        let values = self.values_of_entries(better);
        let firsts: Vec<usize> = self.entries.iter().map(|variants| variants[0]).collect();
        let active = firsts.iter().copied().filter(|&first| self.is_active[first]);
        let means: Vec<f64> = values.iter().map(|values| Series::from_values(values).mean().unwrap_or(0.0)).collect();
        // Only those that play on are compared: an entry that was dropped has fewer seeds, and its mean is of others.
        let best = active.min_by(|&one, &other| better.best_first(means[one], means[other])).expect("one is the best");
        let others = firsts.into_iter().filter(|&first| first != best);
        let mut estimates: Vec<_> = others
            .map(|second| self.estimate(EstimateOf::Pair(VariantPair { first: best, second }), &values))
            .collect();
        for estimate in &mut estimates {
            let EstimateOf::Pair(VariantPair { second, .. }) = estimate.of else { unreachable!("these are pairs") };
            // An entry that is as good as the best plays on with it, since the best one may change.
            if estimate.is_settled && !estimate.interval.is_some_and(|it| is_within(it, margin)) {
                let variants = self.entries.iter().find(|variants| variants[0] == second).expect("it is an entry's");
                variants.iter().for_each(|&variant| self.is_active[variant] = false);
            }
            estimate.is_worse = !self.is_active[second];
            estimate.is_settled |= estimate.is_worse;
        }
        // One entry is left, or all that are left are equal within the margin.
        if estimates.iter().all(|estimate| estimate.is_settled) {
            self.is_active.fill(false);
        }
        estimates
    }

    /// Returns the means over the variants of each entry, seed by seed, at the place of its first variant. The worst of all
    /// values stands for those that are missing, as in rankings.
    fn values_of_entries(&self, better: Better) -> Vec<Vec<f64>> {
        let finite = self.values.iter().flatten().copied().filter(|value| !value.is_nan());
        let worst = finite.fold(0.0, if better == Better::Higher { f64::min } else { f64::max });
        let mut of_entries = vec![Vec::new(); self.values.len()];
        for variants in &self.entries {
            let seeds = 0..self.values[variants[0]].len();
            of_entries[variants[0]] = seeds
                .map(|seed| {
                    let values = variants.iter().map(|&variant| self.values[variant][seed]);
                    values.map(|value| if value.is_nan() { worst } else { value }).sum::<f64>() / variants.len() as f64
                })
                .collect();
        }
        of_entries
    }

    fn estimate(&self, of: EstimateOf, values: &[Vec<f64>]) -> SequenceEstimate {
        let values: Vec<f64> = match of {
            EstimateOf::Variant(variant) => values[variant].clone(),
            EstimateOf::Pair(VariantPair { first, second }) => {
                values[first].iter().zip(&values[second]).map(|(first, second)| second - first).collect()
            }
        };
        let seeds = values.len() as u64;
        // Pairs are formed before missing values go, or the values of one seed would meet those of another.
        let values: Vec<f64> = values.into_iter().filter(|value| !value.is_nan()).collect();
        let series = Series::from_values(&values);
        let interval = sequence_interval(&series, self.alpha);
        // The sequence holds asymptotically; of few or skewed numbers its first intervals are too narrow.
        let is_early = first_look(&values).is_none_or(|first| values.len() < first);
        let is_settled = !is_early
            && interval.is_some_and(|interval| match self.rule.goal {
                StoppingGoal::Decided { margin } | StoppingGoal::Groups { margin } => {
                    interval.excludes_zero() || is_within(interval, margin)
                }
                StoppingGoal::Within { half_width } => interval.high - interval.low <= 2.0 * half_width,
            });
        let mean = series.mean().unwrap_or(f64::NAN);
        SequenceEstimate { of, seeds, mean, interval, is_settled, is_worse: false }
    }

    /// Returns how many seeds each variant has played.
    pub fn played(&self) -> Vec<u64> {
        self.values.iter().map(|values| values.len() as u64).collect()
    }
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
        let shared_plan = Arc::new(self.plan().clone());
        let metric = Metric::from_name(&rule.metric);
        let mut monitor = Monitor::new(rule, self.plan());
        let mut played = 0;
        loop {
            let seeds = if played == 0 { FIRST_LOOK } else { played + STEP }.min(max_seeds);
            let plan = Arc::clone(&shared_plan);
            let is_active = monitor.active().to_vec();
            self.run_some(
                move |run: u64| {
                    let RunPlace { variant, seed } = plan.place(run);
                    is_active[variant] && seed < seeds
                },
                &run,
                jobs,
                stop,
                &mut on_run,
            )?;
            let mut rows = self.rows()?;
            let active = (0..self.plan().variants.len()).filter(|&variant| monitor.active()[variant]);
            for variant in active.collect::<Vec<_>>() {
                for seed in played..seeds.min(self.plan().seeds_of(variant)) {
                    let row = rows.row(self.plan().number(RunPlace { variant, seed }))?;
                    // A run without a value keeps its place, so all variants have the same seed at the same index.
                    monitor.add(variant, metric.value(&RunRecord::from_row(&row)).unwrap_or(f64::NAN));
                }
            }
            played = seeds;
            let look = monitor.look();
            on_look(&look);
            if look.is_over() || played == max_seeds {
                let played = monitor.played();
                // A batch that played all of its seeds is a whole batch already, and its files stay as they are.
                let batch = if played == self.plan().played() { self } else { self.shorten(&played)? };
                return Ok(PlayedBatch { batch, look: Some(look) });
            }
        }
    }
}
