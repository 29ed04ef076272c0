//! The first sentence about a finished batch: the winner, and how much was saved.

use crate::plan::BatchPlan;
use crate::report::html_report::Labels;
use crate::report::summary::{BatchReport, VariantReport};
use crate::report::tally::{Tally, sentence};
use crate::stats::Interval;
use crate::table::run_column;
use wildfire_base::document::number::{count, rounded, short, two_digits};

const OBSTACLES: usize = run_column("obstacles");
const BURNED_RATIO: usize = run_column("burned_ratio");
const BURNED_HA: usize = run_column("burned_ha");

impl BatchReport {
    /// Returns a sentence about the winner and how much was saved; for several variants, which saved the most and the
    /// least, and which had failed runs. Significance is left to other sentences.
    pub fn opening(&self, plan: &BatchPlan) -> String {
        let opening = self.result(plan);
        let stopped = plan.stop_text().map(|text| format!(" Stopping rule: {text}."));
        opening + &stopped.unwrap_or_default()
    }

    fn result(&self, plan: &BatchPlan) -> String {
        let several = match self.variants.as_slice() {
            [one] => return of_one(one),
            several => several,
        };
        match self.not_done() {
            0 => of_several(several),
            _ => of_several_with_failures(several, &Labels::new(plan)),
        }
    }
}

fn of_one(variant: &VariantReport) -> String {
    let tally = &variant.tally;
    if tally.done == 0 {
        return "No run finished.".into();
    }
    let won = winners(tally);
    let saved = Saved::new(variant).map(|saved| saved.text(variant));
    let trucks = tally.trucks_name();
    let text = match (won, saved) {
        // A winner that also saves bushes is named once.
        (Some(Won::Trucks(won)), Some(saved)) => format!("{won} and saved {saved}"),
        (Some(won), Some(saved)) => format!("{}; {trucks} saved {saved}", won.text()),
        (Some(won), None) => {
            format!("{}{}", won.text(), burned_area(variant).map_or(String::new(), |area| format!("; {area}")))
        }
        (None, Some(saved)) if tally.trucks == 0 => format!("without trucks, {saved} did not burn"),
        (None, Some(saved)) => format!("{trucks} saved {saved}"),
        (None, None) => burned_area(variant).unwrap_or_else(|| format!("{} finished", count_of(tally.done))),
    };
    sentence(&text) + "."
}

/// The side that won the most runs, in words.
enum Won {
    Trucks(String),
    Others(String),
}

impl Won {
    fn text(self) -> String {
        let (Self::Trucks(text) | Self::Others(text)) = self;
        text
    }
}

/// Says who won how many runs; `None` where no run has agents on both sides.
fn winners(tally: &Tally) -> Option<Won> {
    if tally.contested == 0 {
        return None;
    }
    let truck = tally.won_by_truck;
    let wumpus = tally.won_by_wumpus;
    let ties = tally.contested - truck - wumpus;
    let each = if truck == wumpus { " each" } else { "" };
    let won = |who: &str, runs: u64| {
        // Of a single run there is nothing to count.
        let what = if tally.done == 1 { String::new() } else { format!(" {}{each}", tally.part_of_runs(runs)) };
        let tied = if ties > 0 { format!(" ({ties} tied)") } else { String::new() };
        format!("{who} won{what}{tied}")
    };
    Some(match truck.cmp(&wumpus) {
        std::cmp::Ordering::Greater => Won::Trucks(won(tally.trucks_name(), truck)),
        std::cmp::Ordering::Less => Won::Others(won(tally.wumpuses_name(), wumpus)),
        std::cmp::Ordering::Equal if truck == 0 && tally.done == 1 => Won::Others("the run was tied".into()),
        std::cmp::Ordering::Equal if truck == 0 => Won::Others(format!("{} were tied", tally.part_of_runs(ties))),
        std::cmp::Ordering::Equal => {
            let both = format!("{} and {}", tally.trucks_name(), tally.wumpuses_name());
            Won::Others(won(&both, truck))
        }
    })
}

/// The share of bushes that were saved, over runs that are done.
struct Saved {
    mean: f64,
    interval: Option<Interval>,
}

impl Saved {
    /// `None` of a field without bushes.
    fn new(variant: &VariantReport) -> Option<Self> {
        variant.column(OBSTACLES).largest().filter(|&bushes| bushes > 0.0)?;
        Some(Self {
            mean: 1.0 - variant.column(BURNED_RATIO).mean()?,
            interval: variant
                .interval(BURNED_RATIO)
                .map(|Interval { low, high }| Interval { low: 1.0 - high, high: 1.0 - low }),
        })
    }

    /// Writes `64 % of 248 bushes (mean; 95 % interval 57 to 70 %)`.
    fn text(&self, variant: &VariantReport) -> String {
        let bushes = variant.column(OBSTACLES);
        // The mean equals the largest number only if all are equal.
        let are_equal = bushes.mean() == bushes.largest();
        let bushes = match bushes.largest().filter(|_| are_equal) {
            Some(1.0) => "the only bush".into(),
            Some(number) => format!("{} bushes", short(number)),
            None => "the bushes".into(),
        };
        let (percent, interval) = self.percent();
        let done = variant.tally.done;
        let not_done = variant.tally.not_done();
        let mean = match (not_done, done) {
            (0, 1) => String::new(),
            (0, _) => "mean".to_owned(),
            // With failed runs the mean is of a part, and the sentence must say of which.
            _ => format!("in the {done} of {} that finished", count_of(done + not_done)),
        };
        let about: Vec<String> = [mean, interval].into_iter().filter(|part| !part.is_empty()).collect();
        let about = if about.is_empty() { String::new() } else { format!(" ({})", about.join("; ")) };
        format!("{percent} of {bushes}{about}")
    }

    /// Returns the mean and its interval, which is empty if there is none.
    fn percent(&self) -> (String, String) {
        let decimals =
            self.interval.map_or(0, |interval| two_digits(50.0 * (interval.high - interval.low)).saturating_sub(1));
        let interval = self.interval.map_or_else(String::new, |Interval { low, high }| {
            format!("95 % interval {} to {} %", rounded(100.0 * low, decimals), rounded(100.0 * high, decimals))
        });
        (format!("{} %", rounded(100.0 * self.mean, decimals)), interval)
    }
}

/// Says how much ground burned, of a field without bushes.
fn burned_area(variant: &VariantReport) -> Option<String> {
    let mean = variant.column(BURNED_HA).mean()?;
    let interval = variant.interval(BURNED_HA);
    let decimals = interval.map_or_else(|| two_digits(mean).min(2), |it| two_digits(0.5 * (it.high - it.low)));
    let about = interval.map_or_else(String::new, |Interval { low, high }| {
        format!(" (mean; 95 % interval {} to {} ha)", rounded(low, decimals), rounded(high, decimals))
    });
    Some(format!("{} ha burned{about}", rounded(mean, decimals)))
}

/// Shares saved by the variants that have numbers.
fn saved_by_variant(variants: &[VariantReport]) -> Vec<(usize, Saved)> {
    variants.iter().enumerate().filter_map(|(index, variant)| Some((index, Saved::new(variant)?))).collect()
}

/// Returns those that saved the most and the least; of equal ones the first. `None` without any.
fn extremes(saved: &[(usize, Saved)]) -> Option<[&(usize, Saved); 2]> {
    let by_mean =
        |one: &&(usize, Saved), other: &&(usize, Saved)| one.1.mean.total_cmp(&other.1.mean).then(other.0.cmp(&one.0));
    Some([saved.iter().max_by(by_mean)?, saved.iter().min_by(by_mean)?])
}

/// Describes variants that have finished all of their runs.
fn of_several(variants: &[VariantReport]) -> String {
    let done: u64 = variants.iter().map(|variant| variant.tally.done).sum();
    let finished = format!("{} of {} variants finished", count_of(done), variants.len());
    let saved = saved_by_variant(variants);
    let Some([best, worst]) = extremes(&saved) else { return finished + "." };
    let name = |index: usize| format!("variant {} ({})", index + 1, variants[index].title);
    let (percent, interval) = best.1.percent();
    if best.1.mean == worst.1.mean {
        return format!("{finished}; in each, {percent} of the bushes were saved.");
    }
    let interval = if interval.is_empty() { interval } else { format!(" ({interval})") };
    let min = format!("{} the least, {}", name(worst.0), worst.1.percent().0);
    format!("{finished}; {} saved the most bushes, {percent}{interval}, and {min}.", name(best.0))
}

/// The most variants that are named one by one.
const MAX_NAMED: usize = 4;

/// Describes variants of which some have failed runs: what those with finished runs saved, and which failed.
fn of_several_with_failures(variants: &[VariantReport], labels: &Labels) -> String {
    let done: u64 = variants.iter().map(|variant| variant.tally.done).sum();
    let not_done: u64 = variants.iter().map(|variant| variant.tally.not_done()).sum();
    if done == 0 {
        return "No run finished.".into();
    }
    let all = labels.groups().concat();
    let saved = saved_by_variant(variants);
    let mut parts: Vec<String> = match extremes(&saved) {
        // More than four variants do not fit into one sentence, which then names the ends only.
        Some([best, worst]) if saved.len() > MAX_NAMED => vec![
            format!("{} saved the most bushes, {}", labels.label(best.0, &all), best.1.percent().0),
            format!("{} the least, {}", labels.label(worst.0, &all), worst.1.percent().0),
        ],
        _ => saved
            .iter()
            .map(|(index, saved)| format!("{} saved {}", labels.label(*index, &all), saved.percent().0))
            .collect(),
    };
    let failed: Vec<usize> = (0..variants.len()).filter(|&index| variants[index].tally.not_done() > 0).collect();
    parts.extend(failed.iter().take(MAX_NAMED).map(|&index| {
        let text = match (variants[index].tally.not_done(), variants[index].tally.done) {
            (1, 0) => "failed".to_owned(),
            (2, 0) => "failed twice".to_owned(),
            (failed, 0) => format!("failed in all {}", count_of(failed)),
            (failed, done) => format!("failed in {failed} of {}", count_of(failed + done)),
        };
        format!("{} {text}", labels.label(index, &all))
    }));
    if failed.len() > MAX_NAMED {
        let more = failed.len() - MAX_NAMED;
        parts.push(format!("{} failed too", count(more, "other variant")));
    }
    format!("{done} of {} finished: {}.", count_of(done + not_done), parts.join(", "))
}

fn count_of(runs: u64) -> String {
    count(usize::try_from(runs).unwrap_or(usize::MAX), "run")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{BatchRequest, Sweep};

    fn won(done: u64, won_by_truck: u64, won_by_wumpus: u64) -> String {
        let tally = Tally { done, contested: done, won_by_truck, won_by_wumpus, ..Tally::new(1, 1) };
        winners(&tally).map_or_else(String::new, Won::text)
    }

    #[test]
    fn winner_is_named_with_its_share_of_the_runs() {
        assert_eq!(won(5, 3, 2), "the Unimog won 3 of 5 runs");
        assert_eq!(won(5, 0, 5), "the Wumpus won all 5 runs");
        assert_eq!(won(5, 3, 1), "the Unimog won 3 of 5 runs (1 tied)");
        assert_eq!(won(5, 2, 2), "the Unimog and the Wumpus won 2 of 5 runs each (1 tied)");
        assert_eq!(won(5, 0, 0), "all 5 runs were tied");
        assert_eq!(
            [won(1, 1, 0), won(1, 0, 1), won(1, 0, 0)],
            ["the Unimog won", "the Wumpus won", "the run was tied"]
        );
        let fleet = Tally { done: 4, failed: 1, contested: 4, won_by_truck: 3, ..Tally::new(20, 2) };
        assert_eq!(winners(&fleet).map(Won::text).as_deref(), Some("the trucks won 3 of 4 finished runs (1 tied)"));
        assert!(winners(&Tally { done: 4, ..Tally::new(0, 1) }).is_none(), "no contest");
    }

    #[test]
    fn batch_without_a_finished_run_says_only_that() {
        let plan = plan("100,200,300");
        let report = |count| BatchReport { variants: vec![failing(2); count] };
        assert_eq!([report(1).opening(&plan), report(3).opening(&plan)], ["No run finished.", "No run finished."]);
    }

    fn plan(durations: &str) -> BatchPlan {
        let sweep = Sweep::parse("duration_s", durations).expect("values");
        let request = BatchRequest {
            scenarios: vec!["smoke".into()],
            sweeps: vec![sweep],
            seeds: "1..3".parse().ok(),
            ..BatchRequest::default()
        };
        request.resolve(false).expect("a small batch")
    }

    fn failing(runs: u64) -> VariantReport {
        VariantReport::of_numbers(Tally { failed: runs, ..Tally::new(1, 1) }, &[])
    }

    #[test]
    fn variants_with_failed_runs_are_named_with_their_number() {
        let done = |done: u64, failed: u64| {
            let tally = Tally { done, failed, ..Tally::new(1, 1) };
            VariantReport::of_numbers(tally, &[(OBSTACLES, 40.0), (BURNED_RATIO, 0.4)])
        };
        let opening = |variants: Vec<VariantReport>| {
            let durations: Vec<String> = (0..variants.len()).map(|number| (100 + number).to_string()).collect();
            BatchReport { variants }.opening(&plan(&durations.join(",")))
        };
        assert_eq!(
            opening(vec![failing(2), done(2, 0)]),
            "2 of 4 runs finished: duration_s 101 saved 60 %, duration_s 100 failed twice."
        );
        assert_eq!(
            opening(vec![done(1, 2), done(3, 0), failing(3)]),
            "4 of 9 runs finished: duration_s 100 saved 60 %, duration_s 101 saved 60 %, duration_s 100 failed in 2 of \
             3 runs, duration_s 102 failed in all 3 runs."
        );
        let many = opening((0..7).map(|_| done(2, 1)).collect());
        assert!(many.ends_with("duration_s 103 failed in 1 of 3 runs, 3 other variants failed too."), "{many}");
        assert_eq!(
            opening(vec![done(3, 0); 2]),
            "6 runs of 2 variants finished; in each, 60 % of the bushes were saved."
        );
    }
}
