//! The best variant of a batch compared with the others, with the methods of `wildfire compare`.
//!
//! Variants have runs of the same seeds, so that differences are paired. Where planners are compared, all else that varies
//! makes the strata; otherwise the variants are compared one by one. P-values are adjusted over all others.

use std::cmp::Ordering;

use super::collected::{Values, mean_of};
use super::labels::Labels;
use super::quantities::{BUSHES, SAVED};
use crate::comparison::{Contrast, JudgedContrast, Metric, NumberPair, Verdict, judge, listed};
use crate::plan::BatchPlan;
use crate::stats::Series;
use crate::table::{Aim, Better};
use wildfire_base::document::number::two_digits;
use wildfire_picture::charts::{Estimate, ForestChart, ForestRow, Titles};

/// The most rows of a chart of differences that is not over a key.
const MAX_ROWS: usize = 60;

/// The best variant of a batch and the others.
pub struct Compared {
    pub quantity: &'static Metric,
    pub aim: Aim,
    /// True if differences are in bushes: all have the same fields.
    is_in_bushes: bool,
    pub are_planners: bool,
    /// Number of variants in the plan, whether or not a run of theirs finished.
    pub planned: usize,
    /// The columns in which the strata differ; empty without several.
    pub by: String,
    /// Names of the strata.
    pub strata: Vec<String>,
    pub best: String,
    pub best_mean: Estimate,
    /// The others, best first.
    pub others: Vec<Other>,
}

/// Another variant.
pub struct Other {
    pub name: String,
    /// By stratum.
    variants: Vec<usize>,
    /// Its difference from the best; `None` without a seed that both have numbers of.
    judged: Option<JudgedContrast>,
}

/// Variants that are compared as one, with a variant for each stratum.
struct VariantGroup {
    name: String,
    variants: Vec<usize>,
    /// Stratum by stratum a number for each seed, NaN where there is none.
    numbers: Vec<f64>,
}

impl VariantGroup {
    /// Returns the mean over some of its places, which all groups have numbers at; without any over those of its own.
    fn mean(&self, common: &[usize]) -> f64 {
        let numbers: Vec<f64> = match common {
            [] => self.numbers.iter().copied().filter(|number| number.is_finite()).collect(),
            common => common.iter().map(|&place| self.numbers[place]).collect(),
        };
        Series::from_values(&numbers).mean().unwrap_or(f64::NAN)
    }
}

impl Compared {
    /// Finds the best; `None` unless two have numbers, and the quantity an aim.
    pub fn new(quantity: &'static Metric, plan: &BatchPlan, variants: &[Values]) -> Option<Self> {
        let aim = quantity.about.aim?;
        let labels = Labels::new(plan);
        let planners = labels.crossed_planners();
        let planner_dimensions = planners.clone().unwrap_or_else(|| labels.besides(&[]));
        let rest = planners.as_ref().map_or_else(Vec::new, |planners| labels.besides(planners));
        let strata = labels.distinct(&rest);
        // On fields with different numbers of bushes, a difference in bushes is no measure of the planner.
        let is_in_bushes = *quantity == *SAVED && are_on_equal_fields(&labels, &rest, variants);
        let numbers = |variant: usize| {
            let of_seeds = variants[variant].of_seeds(quantity);
            let bushes = variants[variant].of_seeds(&BUSHES);
            of_seeds
                .iter()
                .zip(bushes)
                // A share times a number of bushes is a whole number up to rounding errors, which are removed here.
                .map(move |(&number, &bushes)| if is_in_bushes { f64::round(number * bushes) } else { number })
        };
        let names = labels.distinct(&planner_dimensions);
        let planned = names.len();
        let groups = names.into_iter().filter_map(|name| {
            let of_strata: Vec<usize> = strata
                .iter()
                .filter_map(|stratum| {
                    (0..variants.len()).find(|&variant| {
                        labels.label(variant, &planner_dimensions) == name && labels.label(variant, &rest) == *stratum
                    })
                })
                .collect();
            // All go stratum by stratum in the same order, so equal places are equal conditions and seeds.
            let numbers: Vec<f64> = of_strata.iter().flat_map(|&variant| numbers(variant)).collect();
            let has_numbers = numbers.iter().any(|number| number.is_finite());
            // A planner whose runs all failed has no mean, and must not appear as the worst by a number.
            has_numbers.then_some(VariantGroup { name, variants: of_strata, numbers })
        });
        let mut groups: Vec<VariantGroup> = groups.collect();
        // Where runs failed, means are over what all have finished, or one that fails in hard runs would lead.
        let places = groups.iter().map(|group| group.numbers.len()).min().unwrap_or(0);
        let common: Vec<usize> =
            (0..places).filter(|place| groups.iter().all(|group| group.numbers[*place].is_finite())).collect();
        // Of equal ones the first in the plan.
        let sign = if is_higher_better(quantity) { -1.0 } else { 1.0 };
        groups.sort_by(|one, other| (sign * one.mean(&common)).total_cmp(&(sign * other.mean(&common))));
        if groups.len() < 2 {
            return None;
        }
        let best = groups.remove(0);
        let by = if strata.len() > 1 { listed(&labels.heads(&rest, plan)) } else { String::new() };
        // One whose differences have the same size.
        let metric = if *quantity == *SAVED && !is_in_bushes { "burned_ratio" } else { &quantity.name };
        let contrasts = groups.iter().map(|other| {
            let mut pairs = Vec::new();
            for (stratum, (&ours, &theirs)) in best.variants.iter().zip(&other.variants).enumerate() {
                let of_seeds = plan.seeds.iter().zip(numbers(ours).zip(numbers(theirs)));
                pairs.extend(of_seeds.map(|(seed, (ours, theirs))| NumberPair {
                    seed,
                    stratum,
                    numbers: [ours, theirs],
                }));
            }
            pairs.retain(|pair| pair.numbers.iter().all(|number| number.is_finite()));
            Contrast::from_numbers(&Metric::from_name(metric), pairs, (strata.len() > 1).then(|| by.clone()))
        });
        let contrasts: Vec<_> = contrasts.collect();
        // The tests are judged together, as all of them stand in one chart.
        let mut judged = judge(contrasts.iter().flatten().cloned().collect()).into_iter();
        let others = groups.into_iter().zip(contrasts).map(|(VariantGroup { name, variants, .. }, contrast)| Other {
            name,
            variants,
            judged: contrast.and_then(|_| judged.next()),
        });
        let others: Vec<Other> = others.collect();
        let best_mean = mean_by_seed(quantity, &best, variants)?;
        let are_planners = planners.is_some();
        Some(Self {
            quantity,
            aim,
            is_in_bushes,
            are_planners,
            planned,
            by,
            strata,
            best: best.name,
            best_mean,
            others,
        })
    }

    /// Returns the words for a difference from the best.
    pub fn than(&self) -> &'static str {
        if self.is_in_bushes { "more bushes per run" } else { self.aim.than }
    }

    /// Returns the factor of a difference in the words of [`Self::than`].
    pub fn scale(&self) -> f64 {
        if self.is_in_bushes { 1.0 } else { self.quantity.factor_in_text() }
    }

    /// Returns by how much the best is better than another.
    pub fn better_by(&self, other: &Other) -> Estimate {
        let Some(judged) = &other.judged else { return Estimate { value: 0.0, interval: None } };
        let Estimate { value, interval } = estimate(judged);
        match is_higher_better(self.quantity) {
            true => Estimate { value: -value, interval: interval.map(|(low, high)| (-high, -low)) },
            false => Estimate { value, interval },
        }
    }

    pub fn is_significant(&self, other: &Other) -> bool {
        other.judged.as_ref().is_some_and(|judged| self.side(judged) == Ordering::Greater)
    }

    /// Returns the verdict on the best against the other in a stratum: equal where there is no evidence.
    pub fn side_in(&self, other: &Other, stratum: usize) -> Ordering {
        let of_stratum = other.strata().find(|(index, _)| *index == stratum);
        of_stratum.map_or(Ordering::Equal, |(_, judged)| self.side(judged))
    }

    fn side(&self, judged: &JudgedContrast) -> Ordering {
        let side = judged.contrast.difference.total_cmp(&0.0);
        match judged.verdict {
            Verdict::Difference if is_higher_better(self.quantity) => side.reverse(),
            Verdict::Difference => side,
            _ => Ordering::Equal,
        }
    }

    /// Returns the difference from the best of a variant, which is one of the others' in one stratum.
    pub fn difference_of(&self, variant: usize) -> Option<Estimate> {
        self.others.iter().find_map(|other| {
            let stratum = other.variants.iter().position(|&it| it == variant)?;
            other.strata().find(|(index, _)| *index == stratum).map(|(_, judged)| estimate(judged))
        })
    }

    /// Returns the titles of a chart of differences from the best, which are along the y axis.
    pub fn titles(&self) -> Titles {
        let axis = if self.is_in_bushes { "bushes per run" } else { self.quantity.axis() };
        Titles {
            title: format!("{}, difference from {}", self.quantity.title(), self.best),
            note: "Marks are mean differences paired by seed, whiskers their 95 % intervals.".into(),
            x: String::new(),
            y: axis.into(),
        }
    }

    /// Returns a row for each of the others, and for each stratum where that matters.
    pub fn forest(&self) -> ForestChart {
        let rows = self.others.iter().flat_map(|other| {
            let strata = other.strata().filter(|_| other.varies_by_stratum());
            let strata = strata.map(|(index, judged)| forest_row(&self.strata[*index], judged));
            other.judged.iter().map(|judged| forest_row(&other.name, judged)).chain(strata)
        });
        let Titles { title, note, y, .. } = self.titles();
        let titles = Titles { title, note, x: y, y: String::new() };
        ForestChart { titles, rows: rows.take(MAX_ROWS).collect() }
    }
}

fn forest_row(name: &str, judged: &JudgedContrast) -> ForestRow {
    let half_width = judged.contrast.interval.map(|ends| 0.5 * (ends.high - ends.low));
    let decimals = half_width.map_or(2, |half| two_digits(half).min(6));
    judged.contrast.forest_row(name.to_owned(), decimals, judged.verdict == Verdict::Difference)
}

/// What does not say its better side, such as the burned area, is something lost.
fn is_higher_better(quantity: &'static Metric) -> bool {
    quantity.about.better == Some(Better::Higher)
}

/// Returns whether the variants of a stratum have the same number of bushes with each seed.
fn are_on_equal_fields(labels: &Labels, rest: &[usize], variants: &[Values]) -> bool {
    let of_variant = |variant: usize| (labels.label(variant, rest), variants[variant].of_seeds(&BUSHES));
    (1..variants.len()).all(|variant| {
        let (stratum, bushes) = of_variant(variant);
        let first = (0..variant).map(of_variant).find(|(other, _)| *other == stratum);
        first.is_none_or(|(_, first)| {
            bushes.iter().zip(first).all(|(one, other)| one == other || one.is_nan() || other.is_nan())
        })
    })
}

/// Estimates the mean over seeds, whose numbers are means over strata.
fn mean_by_seed(quantity: &'static Metric, group: &VariantGroup, variants: &[Values]) -> Option<Estimate> {
    let members: Vec<&[f64]> = group.variants.iter().map(|&variant| variants[variant].of_seeds(quantity)).collect();
    let means = (0..members.first()?.len())
        .map(|seed| members.iter().map(|of_seeds| of_seeds[seed]).sum::<f64>() / members.len() as f64)
        .filter(|number| !number.is_nan());
    mean_of(&means.collect::<Vec<_>>(), quantity.range(), variants[group.variants[0]].validity)
}

impl Other {
    /// Returns whether the strata say something else than the mean over them.
    pub fn varies_by_stratum(&self) -> bool {
        self.judged.as_ref().is_some_and(JudgedContrast::varies_by_stratum)
    }

    /// Returns the p-value of equal differences in all strata, if there is evidence against it.
    pub fn dependence(&self) -> Option<f64> {
        self.judged.as_ref()?.by_stratum.as_ref().filter(|strata| strata.differ())?.p_adjusted
    }

    fn strata(&self) -> impl Iterator<Item = &(usize, JudgedContrast)> {
        self.judged.iter().filter_map(|judged| judged.by_stratum.as_ref()).flat_map(|strata| &strata.strata)
    }
}

fn estimate(judged: &JudgedContrast) -> Estimate {
    let Contrast { difference, interval, .. } = judged.contrast;
    Estimate { value: difference, interval: interval.map(|ends| (ends.low, ends.high)) }
}
