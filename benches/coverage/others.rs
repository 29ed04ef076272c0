//! Coverage of the other intervals.

use std::fmt::Write;

use wildfire::rng::Xoshiro256PlusPlus as Random;
use wildfire::stats::{
    Interval, Lifetime, PairedAnswers, Series, SurvivalCurve, quantile_interval, welch_interval, wilson_interval,
};

use crate::outcomes::{Contests, Population, below, uniform};
use crate::{count, percent};

const SIZES: [usize; 3] = [5, 30, 200];

type Draw<'a> = Box<dyn Fn(usize, &mut Random) -> (Option<Interval>, f64) + Sync + 'a>;

pub fn coverage(contests: &Contests, replications: u64) -> String {
    let mut text = format!("Coverage in percent of other intervals, as shown\n{:40}", "");
    SIZES.iter().for_each(|n| write!(text, "{:>13}", format!("n = {n}")).expect("a string takes any text"));
    text.push('\n');
    for (name, draw) in cases(contests) {
        write!(text, "{name:40}").expect("a string takes any text");
        for n in SIZES {
            let hits = count(replications, "coverage/others", |random| {
                let (interval, truth) = draw(n, random);
                interval.is_some_and(|interval| interval.contains(truth))
            });
            write!(text, "{:>13}", percent(hits, replications)).expect("a string takes any text");
        }
        text.push('\n');
    }
    text
}

fn cases(contests: &Contests) -> Vec<(&'static str, Draw<'_>)> {
    vec![
        ("rate of 0.1, Wilson", rate(0.1)),
        ("rate of 0.5, Wilson", rate(0.5)),
        ("contest: rate of runs won, Wilson", rate(won(contests))),
        ("planner to planner: rate won", Box::new(|n, random| rate_difference(contests, n, random))),
        ("log-normal: median (none below n = 6)", median(Population::LogNormal)),
        ("contest: median of cells saved", median(saved(contests))),
        ("contest: mean saved, Welch, 5 against n", welch(saved(contests))),
        ("survival at the median, a third cut off", Box::new(survival)),
        ("median lifetime, a third cut off", Box::new(median_lifetime)),
    ]
}

fn saved(contests: &Contests) -> Population {
    Population::Numbers(contests.contest.iter().map(|run| run.saved).collect())
}

fn won(contests: &Contests) -> f64 {
    contests.contest.iter().filter(|run| run.won).count() as f64 / contests.contest.len() as f64
}

fn rate(truth: f64) -> Draw<'static> {
    Box::new(move |n, random: &mut Random| {
        let hits = (0..n).filter(|_| uniform(random) < truth).count();
        (wilson_interval(hits as u64, n as u64), truth)
    })
}

fn rate_difference(contests: &Contests, n: usize, random: &mut Random) -> (Option<Interval>, f64) {
    let answers = |pairs: &mut dyn Iterator<Item = usize>| {
        let mut answers = PairedAnswers::default();
        pairs.for_each(|seed| answers.add(contests.contest[seed].won, contests.hybrid[seed].won));
        answers
    };
    let truth = answers(&mut (0..contests.contest.len())).rate_difference().expect("there are pairs");
    let drawn = answers(&mut (0..n).map(|_| below(contests.contest.len(), random)));
    (drawn.rate_difference_interval(), truth)
}

fn median(population: Population) -> Draw<'static> {
    Box::new(move |n, random: &mut Random| {
        let mut sample = population.sample(n, random);
        sample.sort_by(f64::total_cmp);
        (quantile_interval(&sample, 0.5), population.median())
    })
}

fn welch(population: Population) -> Draw<'static> {
    Box::new(move |n, random: &mut Random| {
        let mut series = |n| Series::from_values(&population.sample(n, random));
        (welch_interval(&series(5), &series(n)), 0.0)
    })
}

/// Exponential lifetimes of mean 1 that are cut off by exponential times of mean 2.
fn lifetimes(n: usize, random: &mut Random) -> SurvivalCurve {
    let mut exponential = |mean: f64| -mean * libm::log(1.0 - uniform(random));
    let mut lifetime = |_| {
        let (event, end) = (exponential(1.0), exponential(2.0));
        Lifetime { time: event.min(end), is_cut_off: end < event }
    };
    SurvivalCurve::from_lifetimes(&(0..n).map(&mut lifetime).collect::<Vec<_>>())
}

/// The interval of the last step; before the first event it is all of 0 to 1, and after the last survivor too.
fn survival(n: usize, random: &mut Random) -> (Option<Interval>, f64) {
    let curve = lifetimes(n, random);
    let step = curve.steps.iter().rfind(|step| step.time <= std::f64::consts::LN_2);
    (step.and_then(|step| step.interval).or(Some(Interval { low: 0.0, high: 1.0 })), 0.5)
}

fn median_lifetime(n: usize, random: &mut Random) -> (Option<Interval>, f64) {
    let [low, high] = lifetimes(n, random).median_interval();
    let interval = Interval { low: low.unwrap_or(0.0), high: high.unwrap_or(f64::INFINITY) };
    (Some(interval), std::f64::consts::LN_2)
}
