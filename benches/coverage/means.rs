//! Coverage of intervals of a mean.

use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};

use wildfire::stats::{Interval, Series, estimate_mean, studentised_bootstrap};

use crate::outcomes::{Contest, Contests, Population};
use crate::{count, percent, rivals};

const SIZES: [usize; 5] = [5, 10, 20, 30, 200];
const METHODS: [&str; 6] = ["as shown", "Student's t", "studentised", "percentile", "BCa", "log scale"];

pub fn coverage(contests: &Contests, replications: u64) -> String {
    let mut text = format!("Coverage in percent of intervals of a mean\n{:34}{:>4}", "", "n");
    METHODS.iter().for_each(|method| write!(text, "{method:>13}").expect("a string takes any text"));
    text.push('\n');
    for (name, population) in populations(contests) {
        for n in SIZES {
            write!(text, "{name:34}{n:>4}").expect("a string takes any text");
            for hits in hits(&population, n, replications) {
                write!(text, "{:>13}", percent(hits, replications)).expect("a string takes any text");
            }
            text.push('\n');
        }
    }
    text
}

fn populations(contests: &Contests) -> Vec<(&'static str, Population)> {
    let of = |runs: &[Contest], value: fn(&Contest) -> f64| Population::Numbers(runs.iter().map(value).collect());
    let pairs = contests.contest.iter().zip(&contests.hybrid);
    vec![
        ("normal", Population::Normal),
        ("log-normal", Population::LogNormal),
        ("contest: cells saved", of(&contests.contest, |run| run.saved)),
        ("contest: expansions of planners", of(&contests.contest, |run| run.expansions)),
        ("original-2024: mean response", of(&contests.original, |run| run.response_s)),
        ("planner to planner: cells saved", Population::Numbers(pairs.map(|(a, b)| b.saved - a.saved).collect())),
    ]
}

/// How often the interval of each method holds the mean; an interval that does not exist holds nothing.
fn hits(population: &Population, n: usize, replications: u64) -> [u64; METHODS.len()] {
    let truth = population.mean();
    let hits = METHODS.map(|_| AtomicU64::new(0));
    count(replications, "coverage/means", |random| {
        let sample = population.sample(n, random);
        let [percentile, bca] = rivals::percentile_and_bca(&sample, random);
        let studentised = studentised_bootstrap(&sample, random).and_then(|estimate| estimate.interval);
        let shown = estimate_mean(&sample, random).and_then(|estimate| estimate.interval);
        // That of tables and charts for quantities that are not negative.
        let log_scale = Series::from_values(&sample).mean_interval_within((0.0, f64::INFINITY));
        let intervals = [shown, rivals::students_t(&sample), studentised, percentile, bca, log_scale];
        for (hits, interval) in hits.iter().zip(intervals) {
            let holds = interval.is_some_and(|interval: Interval| interval.contains(truth));
            hits.fetch_add(u64::from(holds), Ordering::Relaxed);
        }
        true
    });
    hits.map(AtomicU64::into_inner)
}
