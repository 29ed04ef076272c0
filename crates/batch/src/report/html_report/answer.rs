//! The answer of a batch in sentences: what was saved, or which variant is best in which respect, and how certain that
//! is.
//!
//! Differences, intervals and p-values are those of `wildfire compare`, see [`Compared`].

use std::cmp::Ordering;

use super::collected::{Collected, Values, mean_of};
use super::compared::{Compared, Other};
use super::figures::main_quantity;
use super::quantities::{BURNED_AREA, BUSHES, SAVED, aims};
use crate::comparison::{listed, p_text};
use crate::plan::{BatchPlan, planner_of};
use crate::report::tally::{Tally, sentence};
use wildfire_base::document::number::{count, rounded, short, two_digits};
use wildfire_picture::charts::Estimate;

/// The most of those that are not significantly different from the best that are named.
const MAX_NAMED: usize = 3;

/// The answer of a batch: one sentence, and more where variants are compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReportAnswer {
    pub sentence: String,
    pub more: Vec<String>,
}

impl ReportAnswer {
    pub fn new(plan: &BatchPlan, collected: &Collected) -> Self {
        let variants = &collected.report.variants;
        // A single variant has nothing to be compared with, so it is described.
        if let ([variant], [report], [values]) = (&plan.variants[..], &variants[..], &collected.variants[..]) {
            let sentence = of_one(&planner_of(&variant.scenario), values, &report.tally);
            return Self { sentence, more: Vec::new() };
        }
        let main = main_quantity(&collected.variants);
        let of_aims = aims(main).filter_map(|quantity| Compared::new(quantity, plan, &collected.variants));
        let mut sentences: Vec<String> = of_aims.map(|found| compared(&found)).collect();
        let tallies = variants.iter().map(|variant| &variant.tally);
        let (done, stuck) = tallies.fold((0, 0), |(done, stuck), tally| (done + tally.done, stuck + tally.stuck_runs));
        let runs = match collected.report.not_done() {
            0 => format!("{done} of {done} runs finished; {}.", stuck_text(stuck, done)),
            _ if done == 0 => "No run finished.".to_owned(),
            _ => format!("{} {}.", collected.report.opening(plan), sentence(&stuck_text(stuck, done))),
        };
        if sentences.is_empty() {
            return Self { sentence: runs, more: Vec::new() };
        }
        let first = sentences.remove(0);
        Self { sentence: first, more: sentences.into_iter().chain([runs]).collect() }
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
    let ending = format!("in {runs}; {}{rest}.", stuck_text(tally.stuck_runs, tally.done));
    if tally.done == 0 {
        // Without a finished run every mean below would be of nothing.
        return format!("No run finished{rest}.");
    }
    let shares = values.numbers(&SAVED);
    let bushes = values.numbers(&BUSHES);
    // Fields without bushes have no share that was saved, but may have burned area.
    let Some(share) = mean_of(&shares, SAVED.range(), values.validity) else {
        let Some(area) = values.mean(&BURNED_AREA) else { return format!("{who}: {ending}") };
        let decimals = decimals(&area, 1.0);
        let interval = interval_text(&area, 1.0, decimals);
        return format!("{who}: {} ha burned per run{interval} {ending}", rounded(area.value, decimals));
    };
    // Saved bushes are multiplied run by run: the product of two means is not the mean of the products.
    let saved: Vec<f64> = values
        .of_seeds(&SAVED)
        .iter()
        .zip(values.of_seeds(&BUSHES))
        .map(|(share, bushes)| share * bushes)
        .filter(|number| number.is_finite())
        .collect();
    let max = bushes.iter().copied().fold(0.0, f64::max);
    // No more bushes can be saved than a field has, so the interval ends there.
    let Some(saved) = mean_of(&saved, (0.0, max), values.validity) else { return format!("{who}: {ending}") };
    let all = mean_of(&bushes, (0.0, f64::INFINITY), values.validity).map_or(0.0, |mean| mean.value);
    let all = if all == max { short(all) } else { format!("{} (on average)", rounded(all, 1)) };
    let decimals = decimals(&saved, 1.0);
    let mut percent = format!("{} %", rounded(100.0 * share.value, 0));
    if let Some((low, high)) = saved.interval {
        let [low, high] = [low, high].map(|end| rounded(end, decimals));
        percent += &format!(", 95 % interval {low} to {high}");
    }
    let saved = rounded(saved.value, decimals);
    let verb = if planner.is_empty() { " were left" } else { "" };
    let who = if planner.is_empty() { format!("{who},") } else { format!("{who} saved") };
    format!("{who} {saved} of {all} bushes ({percent}){verb} {ending}")
}

fn stuck_text(stuck: u64, done: u64) -> String {
    match stuck {
        0 => "no agent got stuck".into(),
        _ if stuck == done => "an agent got stuck in each".into(),
        _ => format!("an agent got stuck in {stuck} of them"),
    }
}

/// Says which is best and whether that is more than chance.
fn compared(compared: &Compared) -> String {
    let Compared { quantity, aim, best, best_mean, others, strata, by, .. } = compared;
    // There are others: `Compared` is made of two or more.
    let next = &others[0];
    let last = &others[others.len() - 1];
    let count = others.len() + 1;
    let kind = if compared.are_planners { "planners" } else { "variants" };
    let kind = if count < compared.planned { format!("{kind} with finished runs") } else { kind.to_owned() };
    let of_all = if others.len() > 1 { format!("Of {count} {kind}, ") } else { String::new() };
    let over = match strata.len() {
        0 | 1 => String::new(),
        several if by.contains(' ') => format!(", averaged over {several} combinations of {by}"),
        several => format!(", averaged over {several} values of {by}"),
    };
    let amount = amount(best_mean, quantity.unit_in_text(), quantity.factor_in_text());
    // Equal means alone do not say that runs are equal, so the test must not find a difference either.
    if others.iter().all(|other| compared.better_by(other).value == 0.0 && !compared.is_significant(other)) {
        let all = if others.len() > 1 { format!("all {count} {kind}") } else { format!("both {kind}") };
        let [verb, of_what] = aim.equal;
        return format!("No difference: {all} {verb} {amount}{of_what}.");
    }
    let subject = format!("{of_all}{best} {}{over}: {amount}", aim.best);
    let better_by = compared.better_by(next);
    let scale = compared.scale();
    let decimals = decimals(&better_by, scale);
    let difference = format!(
        "{} {} than {}{}",
        rounded(scale * better_by.value, decimals),
        compared.than(),
        next.name,
        interval_text(&better_by, scale, decimals)
    );
    // Who is not significantly worse is named, as a winner by chance would otherwise be taken for one by merit.
    let alike: Vec<&str> =
        others.iter().filter(|other| !compared.is_significant(other)).map(|it| it.name.as_str()).collect();
    let verdict = match &alike[..] {
        [] if others.len() == 1 => "a significant difference".into(),
        [] if others.len() == 2 => format!("significantly ahead of both others; last is {}", last.name),
        [] => format!("significantly ahead of all {} others; last is {}", others.len(), last.name),
        names if names.len() > MAX_NAMED => format!("no evidence of a difference from {} others", names.len()),
        names => format!("no evidence of a difference from {}", names.join("; ")),
    };
    let pairs = if others.len() > 1 { "paired by seed, p adjusted by Holm's method" } else { "paired by seed" };
    let dependence = others.iter().filter_map(|other| dependence(compared, other));
    format!("{subject}, {difference}, {verdict} ({pairs}).{}", dependence.take(MAX_NAMED).collect::<String>())
}

/// Says where the difference from another is, if it is not the same in all strata, or not significant in all.
fn dependence(compared: &Compared, other: &Other) -> Option<String> {
    // A sentence for each stratum is worth its length only where the mean over them misleads.
    if !other.varies_by_stratum() {
        return None;
    }
    let Compared { by, strata, best, .. } = compared;
    let among = |side: Ordering| {
        let names = strata.iter().enumerate().filter(|(index, _)| compared.side_in(other, *index) == side);
        let names: Vec<String> = names.map(|(_, name)| name.clone()).collect();
        // The key once: `field.coverage 0.05 and 0.1`.
        let start = format!("{by} ");
        let rest = names.iter().skip(1).map(|name| name.strip_prefix(&start).unwrap_or(name).to_owned());
        (!names.is_empty()).then(|| listed(&names.iter().take(1).cloned().chain(rest).collect::<Vec<_>>()))
    };
    let sides = [
        among(Ordering::Greater).map(|names| format!("{best} is significantly ahead at {names}")),
        among(Ordering::Less).map(|names| format!("{} is significantly ahead at {names}", other.name)),
        among(Ordering::Equal).map(|names| format!("no evidence of a difference at {names}")),
    ];
    let sides: Vec<String> = sides.into_iter().flatten().collect();
    let text = match other.dependence() {
        Some(p) => format!("The difference from {} depends on {by}, {}", other.name, p_text(p)),
        None => format!("By {by}, compared with {}", other.name),
    };
    Some(format!(" {text}: {}.", sides.join("; ")))
}

/// Decimals that show the uncertainty with two digits, or the value where none is known.
fn decimals(estimate: &Estimate, scale: f64) -> usize {
    let half = estimate.interval.map(|(low, high)| 0.5 * scale * (high - low)).filter(|&half| half > 0.0);
    half.map_or(1, two_digits).min(4)
}

/// Writes a mean with its interval, `68.2 % (95 % interval 67.7 to 68.7)`.
fn amount(estimate: &Estimate, unit: &str, scale: f64) -> String {
    let decimals = decimals(estimate, scale);
    format!("{} {unit}{}", rounded(scale * estimate.value, decimals), interval_text(estimate, scale, decimals))
}

fn interval_text(estimate: &Estimate, scale: f64, decimals: usize) -> String {
    let Some((low, high)) = estimate.interval else { return String::new() };
    let [low, high] = [low, high].map(|end| rounded(scale * end, decimals));
    format!(" (95 % interval {low} to {high})")
}
