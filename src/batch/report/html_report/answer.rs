//! The answer of a batch in sentences: what was saved, or which of its variants is best in what, and how sure that is.
//!
//! Variants have runs of the same seeds, so that they are compared by paired differences. Where planners are compared,
//! the number of a seed is a mean over the variants of a planner, and differences are of these. The best is
//! compared with each of the others by Student's t; p-values are adjusted by Holm's method over these comparisons.

use std::collections::BTreeMap;

use super::collected::{Collected, Values, mean_of};
use super::figures::main_quantity;
use super::labels::Labels;
use super::quantities::{BURNED_AREA, BUSHES, PLANNING, Quantity, RESPONSE, SAVED};
use crate::batch::plan::{BatchPlan, planner_of};
use crate::batch::report::tally::Tally;
use crate::document::number::{count, rounded, short, two_digits};
use crate::picture::charts::Estimate;
use crate::stats::{holm, students_t};

/// The level of the tests.
const LEVEL: f64 = 0.05;

/// The most of those that are not told apart from the best that are named.
const MOST_NAMED: usize = 3;

/// Something that variants are compared in, with its words.
struct Aim {
    quantity: Quantity,
    is_higher_better: bool,
    /// What the best did: `saved the most bushes`.
    best: &'static str,
    /// What all did that are equal, before and after the amount.
    equal: [&'static str; 2],
    /// How it differs from another: `points more`.
    than: &'static str,
    unit: &'static str,
    scale: f64,
}

const AIMS: [Aim; 4] = [
    Aim {
        quantity: SAVED,
        is_higher_better: true,
        best: "saved the most bushes",
        equal: ["saved", " of the bushes"],
        than: "points more",
        unit: "%",
        scale: 100.0,
    },
    Aim {
        quantity: BURNED_AREA,
        is_higher_better: false,
        best: "lost the least area",
        equal: ["lost", " of area"],
        than: "ha less",
        unit: "ha",
        scale: 1.0,
    },
    Aim {
        quantity: RESPONSE,
        is_higher_better: false,
        best: "put fires out soonest",
        equal: ["put fires out after", ""],
        than: "s sooner",
        unit: "s",
        scale: 1.0,
    },
    Aim {
        quantity: PLANNING,
        is_higher_better: false,
        best: "planned in the least CPU time",
        equal: ["planned in", " of CPU time"],
        than: "ms less",
        unit: "ms",
        scale: 1.0,
    },
];

/// What a batch answers: one sentence, and more where variants are compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    pub sentence: String,
    pub more: Vec<String>,
}

impl Answer {
    pub fn new(plan: &BatchPlan, collected: &Collected) -> Self {
        let variants = &collected.report.variants;
        if let ([variant], [report], [values]) = (&plan.variants[..], &variants[..], &collected.variants[..]) {
            let sentence = of_one(&planner_of(&variant.scenario), values, &report.tally);
            return Self { sentence, more: Vec::new() };
        }
        let main = main_quantity(&collected.variants);
        let aims = AIMS.iter().filter(|aim| aim.quantity == main || ![SAVED, BURNED_AREA].contains(&aim.quantity));
        let mut sentences: Vec<String> = aims.filter_map(|aim| compared(aim, plan, &collected.variants)).collect();
        let tallies = variants.iter().map(|variant| &variant.tally);
        let (done, not_done, stuck) = tallies.fold((0, 0, 0), |(done, not_done, stuck), tally| {
            (done + tally.done, not_done + tally.not_done(), stuck + tally.stuck_runs)
        });
        let runs = format!("{done} of {} runs finished; {}.", done + not_done, stuck_words(stuck, done));
        if sentences.is_empty() {
            return Self { sentence: runs, more: Vec::new() };
        }
        let sentence = sentences.remove(0);
        Self { sentence, more: sentences.into_iter().chain([runs]).collect() }
    }
}

/// Says what a single variant came to.
fn of_one(planner: &str, values: &Values, tally: &Tally) -> String {
    let who = if planner.is_empty() { "Without a truck".into() } else { planner.replace(';', " and ") };
    let runs = count(usize::try_from(tally.done).unwrap_or(usize::MAX), "run");
    let rest = match tally.not_done() {
        0 => String::new(),
        1 => "; 1 run has no result".into(),
        many => format!("; {many} runs have no result"),
    };
    let ending = format!("in {runs}; {}{rest}.", stuck_words(tally.stuck_runs, tally.done));
    if tally.done == 0 {
        return format!("No run came to its end{rest}.");
    }
    let (shares, bushes) = (values.numbers(SAVED), values.numbers(BUSHES));
    let Some(share) = mean_of(&shares, SAVED.range()) else {
        let Some(area) = values.mean(BURNED_AREA) else { return format!("{who}: {ending}") };
        let decimals = decimals(&area, 1.0);
        let interval = interval_words(&area, 1.0, decimals);
        return format!("{who}: {} ha burned per run{interval} {ending}", rounded(area.value, decimals));
    };
    let saved: Vec<f64> = values
        .of_seeds(SAVED)
        .iter()
        .zip(values.of_seeds(BUSHES))
        .map(|(share, bushes)| share * bushes)
        .filter(|number| number.is_finite())
        .collect();
    let most = bushes.iter().copied().fold(0.0, f64::max);
    let Some(saved) = mean_of(&saved, (0.0, most)) else { return format!("{who}: {ending}") };
    let all = mean_of(&bushes, (0.0, f64::INFINITY)).map_or(0.0, |mean| mean.value);
    let all = if all == most { short(all) } else { format!("{} (in the mean)", rounded(all, 1)) };
    let decimals = decimals(&saved, 1.0);
    let mut percent = format!("{} %", rounded(100.0 * share.value, 0));
    if let Some((low, high)) = saved.interval.filter(|(low, high)| low < high) {
        let [low, high] = [low, high].map(|end| rounded(end, decimals));
        percent += &format!(", 95 % interval {low} to {high}");
    }
    let saved = rounded(saved.value, decimals);
    let verb = if planner.is_empty() { " were left" } else { "" };
    let who = if planner.is_empty() { format!("{who},") } else { format!("{who} saved") };
    format!("{who} {saved} of {all} bushes ({percent}){verb} {ending}")
}

fn stuck_words(stuck: u64, done: u64) -> String {
    match stuck {
        0 => "nobody got stuck".into(),
        _ if stuck == done => "an agent got stuck in each".into(),
        _ => format!("an agent got stuck in {stuck} of them"),
    }
}

/// Variants that are compared as one, with a number for each seed; NaN where one of them has none.
struct Group {
    name: String,
    of_seeds: Vec<f64>,
}

/// Returns planners, in the mean over all else that differs, or else the variants one by one.
fn groups(quantity: Quantity, labels: &Labels, variants: &[Values]) -> Vec<Group> {
    let all = labels.besides(&[]);
    let names_by = labels.crossed_planners().unwrap_or(all);
    let mut members: BTreeMap<String, Vec<&[f64]>> = BTreeMap::new();
    for (index, values) in variants.iter().enumerate() {
        members.entry(labels.label(index, &names_by)).or_default().push(values.of_seeds(quantity));
    }
    let group = |name: String| {
        let members = members.get(&name).map_or(&[][..], Vec::as_slice);
        let seeds = members.iter().map(|of_seeds| of_seeds.len()).min().unwrap_or(0);
        let mean = |seed: usize| members.iter().map(|of_seeds| of_seeds[seed]).sum::<f64>() / members.len() as f64;
        Group { of_seeds: (0..seeds).map(mean).collect(), name }
    };
    labels.distinct(&names_by).into_iter().map(group).collect()
}

/// The best against another group.
struct Against<'a> {
    name: &'a str,
    /// How much better the best is, in the unit of the aim.
    better_by: Estimate,
    /// `None` where no seed differs.
    p_adjusted: Option<f64>,
}

impl Against<'_> {
    fn is_told_apart(&self) -> bool {
        self.better_by.value > 0.0 && self.p_adjusted.is_some_and(|p| p <= LEVEL)
    }
}

/// Says which group is best and whether that is more than chance; `None` unless two have numbers.
fn compared(aim: &Aim, plan: &BatchPlan, variants: &[Values]) -> Option<String> {
    let labels = Labels::new(plan);
    let mut groups: Vec<(Group, Estimate)> = groups(aim.quantity, &labels, variants)
        .into_iter()
        .filter_map(|group| {
            let numbers: Vec<f64> = group.of_seeds.iter().copied().filter(|number| !number.is_nan()).collect();
            let mean = mean_of(&numbers, aim.quantity.range())?;
            Some((group, mean))
        })
        .collect();
    // Of equal ones the first in the plan.
    let sign = if aim.is_higher_better { -1.0 } else { 1.0 };
    groups.sort_by(|one, other| (sign * one.1.value).total_cmp(&(sign * other.1.value)));
    let [(best, mean), others @ ..] = &groups[..] else { return None };
    let (last, _) = others.last()?;
    let against = against(aim, best, others);
    let kind = if labels.crossed_planners().is_some() { "planners" } else { "variants" };
    let of_all = if others.len() > 1 { format!("Of {} {kind}, ", groups.len()) } else { String::new() };
    let over = match plan.variants.len() / groups.len() {
        0 | 1 => String::new(),
        several => format!(" in the mean over {several} variants"),
    };
    let amount = |estimate: &Estimate| amount(estimate, aim.unit, aim.scale);
    let subject = format!("{of_all}{} {}{over}: {}", best.name, aim.best, amount(mean));
    if against.iter().all(|other| other.better_by.value == 0.0 && !other.is_told_apart()) {
        let all = if others.len() > 1 { format!("all {} {kind}", groups.len()) } else { format!("both {kind}") };
        let [verb, of_what] = aim.equal;
        return Some(format!("No difference: {all} {verb} {}{of_what}.", amount(mean)));
    }
    let next = &against[0];
    let decimals = decimals(&next.better_by, aim.scale);
    let difference = format!(
        "{} {} than {}{}",
        rounded(aim.scale * next.better_by.value, decimals),
        aim.than,
        next.name,
        interval_words(&next.better_by, aim.scale, decimals)
    );
    let alike: Vec<&str> = against.iter().filter(|other| !other.is_told_apart()).map(|other| other.name).collect();
    let verdict = match &alike[..] {
        [] if others.len() == 1 => "more than chance explains".into(),
        [] => format!("and more than chance explains against all {} others; last is {}", others.len(), last.name),
        names if names.len() > MOST_NAMED => format!("no evidence of a difference from {} others", names.len()),
        names => format!("no evidence of a difference from {}", names.join("; ")),
    };
    let pairs = if others.len() > 1 { "paired by seed, p adjusted by Holm's method" } else { "paired by seed" };
    Some(format!("{subject}, {difference}, {verdict} ({pairs})."))
}

/// Compares the best with the others, seed by seed.
fn against<'a>(aim: &Aim, best: &Group, others: &'a [(Group, Estimate)]) -> Vec<Against<'a>> {
    let sign = if aim.is_higher_better { 1.0 } else { -1.0 };
    let estimate = |(other, _): &'a (Group, Estimate)| {
        let pairs = best.of_seeds.iter().zip(&other.of_seeds);
        let differences: Vec<f64> =
            pairs.map(|(best, other)| sign * (best - other)).filter(|number| number.is_finite()).collect();
        let mean = students_t(&differences).filter(|mean| mean.p_value.is_none_or(f64::is_finite));
        let interval = mean.and_then(|mean| mean.interval).map(|interval| (interval.low, interval.high));
        let better_by = Estimate { value: mean.map_or(0.0, |mean| mean.mean), interval };
        let p_value = mean.and_then(|mean| mean.p_value).or_else(|| sign_test(&differences));
        (other.name.as_str(), better_by, p_value)
    };
    let estimates: Vec<_> = others.iter().map(estimate).collect();
    let mut adjusted = holm(&estimates.iter().filter_map(|(_, _, p)| *p).collect::<Vec<_>>()).into_iter();
    let against = estimates.into_iter().map(|(name, better_by, p)| Against {
        name,
        better_by,
        p_adjusted: p.and_then(|_| adjusted.next()),
    });
    against.collect()
}

/// Returns the probability that differences without spread, for which there is no Student's t, all have one sign; `None` of
/// no differences, and of those that are zero.
fn sign_test(differences: &[f64]) -> Option<f64> {
    let all_differ = !differences.is_empty() && differences.iter().all(|difference| *difference != 0.0);
    all_differ.then(|| differences.iter().fold(2.0, |p, _| 0.5 * p))
}

/// Decimals that show the uncertainty with two digits, or the value where none is known.
fn decimals(estimate: &Estimate, scale: f64) -> usize {
    let half = estimate.interval.map(|(low, high)| 0.5 * scale * (high - low)).filter(|&half| half > 0.0);
    half.map_or(1, two_digits).min(4)
}

/// Writes a mean with its interval, `68.2 % (95 % interval 67.7 to 68.7)`.
fn amount(estimate: &Estimate, unit: &str, scale: f64) -> String {
    let decimals = decimals(estimate, scale);
    format!("{} {unit}{}", rounded(scale * estimate.value, decimals), interval_words(estimate, scale, decimals))
}

fn interval_words(estimate: &Estimate, scale: f64, decimals: usize) -> String {
    let Some((low, high)) = estimate.interval.filter(|(low, high)| low < high) else { return String::new() };
    let [low, high] = [low, high].map(|end| rounded(scale * end, decimals));
    format!(" (95 % interval {low} to {high})")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(name: &str, of_seeds: &[f64]) -> (Group, Estimate) {
        let mean = mean_of(of_seeds, (0.0, f64::INFINITY)).expect("there are numbers");
        (Group { name: name.into(), of_seeds: of_seeds.to_vec() }, mean)
    }

    #[test]
    fn paired_differences_tell_apart_what_means_do_not() {
        // Fields differ far more than the variants on them.
        let fields = [0.1, 0.9, 0.3, 0.7, 0.5, 0.2, 0.8];
        let (better, _) = group("better", &fields.map(|share| share + 0.01 + 0.001 * share));
        let others = [group("worse", &fields), group("same", &fields.map(|share| share + 0.01 + 0.001 * share))];
        let against = against(&AIMS[0], &better, &others);
        assert!(against[0].is_told_apart() && !against[1].is_told_apart());
        assert!((against[0].better_by.value - 0.0105).abs() < 1e-9);
        let (low, high) = against[0].better_by.interval.expect("they differ");
        assert!(low > 0.0 && high < 0.02);
        assert_eq!(against[1].better_by.value, 0.0);
    }

    #[test]
    fn lower_is_better_where_it_is_time() {
        let others = [group("slow", &[3.0, 4.0, 5.5])];
        let against = against(&AIMS[2], &group("fast", &[1.0, 2.0, 3.0]).0, &others);
        assert!(against[0].better_by.value > 2.0);
    }

    #[test]
    fn seeds_without_a_number_are_in_no_pair() {
        let others = [group("other", &[1.0, 2.0, 3.0])];
        let best = Group { name: "best".into(), of_seeds: vec![2.0, f64::NAN, 4.0] };
        let against = against(&AIMS[0], &best, &others);
        assert_eq!(against[0].better_by, Estimate { value: 1.0, interval: None });
        assert!(!against[0].is_told_apart(), "two pairs that differ by the same are no evidence");
    }

    #[test]
    fn differences_without_spread_are_evidence_where_they_are_many() {
        for (seeds, expected) in [(1, false), (5, false), (6, true)] {
            let others = [group("other", &vec![1.0; seeds])];
            let against = against(&AIMS[0], &group("best", &vec![2.0; seeds]).0, &others);
            assert_eq!(against[0].is_told_apart(), expected, "{seeds}");
        }
        assert_eq!(sign_test(&[0.0, 0.0]), None);
    }
}
