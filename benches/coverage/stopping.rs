//! How long a batch with a stopping rule plays, how often it decides what is not so, and how often the interval at which it
//! stops holds the truth.

use std::fmt::Write;

use rayon::prelude::*;
use wildfire::batch::stopping::{FIRST_LOOK, STEP};
use wildfire::rng::{self, Xoshiro256PlusPlus as Random};
use wildfire::stats::{Interval, Series, first_look, sequence_interval};

use crate::outcomes::{Contest, Contests, below};
use crate::percent;

/// The seeds of a batch that never decides.
const MOST: usize = 1000;
const LEVEL: f64 = 0.05;

/// Where a batch stopped, and its interval there.
struct Stop {
    seeds: usize,
    interval: Option<Interval>,
    is_decided: bool,
}

pub fn rates(contests: &Contests, replications: u64) -> String {
    let pairs_with = |others: &[Contest]| -> Vec<f64> {
        contests.contest.iter().zip(others).map(|(one, other)| other.saved - one.saved).collect()
    };
    let hybrid = pairs_with(&contests.hybrid);
    let between = contests.hybrid.iter().zip(&contests.prm_rs).map(|(one, other)| one.saved - other.saved).collect();
    let mut text = format!("Batches that stop when decided, of at most {MOST} seeds drawn from 1000\n");
    writeln!(text, "{:44}{:>10}{:>10}{:>14}{:>14}", "", "median", "90 %", "decided", "holds truth")
        .expect("a string takes any text");
    // The same planner on both sides: each difference has either sign.
    for (name, differences, is_equal) in [
        ("prm+primitives, hybrid-astar: saved", hybrid, false),
        ("prm-rs, hybrid-astar: saved", between, false),
        ("two equal planners: saved", strangers(&contests.contest, |run| run.saved), true),
        ("two equal planners: original, response", strangers(&contests.original, |run| run.response_s), true),
    ] {
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        let truth = if is_equal { 0.0 } else { mean };
        let draw = |random: &mut Random| {
            let sign = if is_equal && below(2, random) == 0 { -1.0 } else { 1.0 };
            sign * differences[below(differences.len(), random)]
        };
        let stop = |random: &mut Random| stop(|| draw(random));
        let stops = (0..replications).into_par_iter().map(|trial| stop(&mut rng::stream(trial, "coverage/stopping")));
        let mut stops: Vec<Stop> = stops.collect();
        let counted = |counts: fn(&Stop, f64) -> bool| stops.iter().filter(|stop| counts(stop, truth)).count() as u64;
        let decided = counted(|stop, _| stop.is_decided);
        let holds = counted(|stop, truth| stop.interval.is_none_or(|it| it.low <= truth && truth <= it.high));
        let [decided, holds] = [decided, holds].map(|hits| percent(hits, replications));
        stops.sort_by_key(|stop| stop.seeds);
        let [median, most] = [0.5, 0.9].map(|share| stops[(share * stops.len() as f64) as usize].seeds);
        writeln!(text, "{name:44}{median:>10}{most:>10}{decided:>14}{holds:>14}").expect("a string takes any text");
    }
    text
}

/// Plays until it is decided, as a batch does.
fn stop(mut draw: impl FnMut() -> f64) -> Stop {
    let mut differences = Vec::new();
    let mut series = Series::default();
    loop {
        let difference = draw();
        differences.push(difference);
        series.add(difference);
        let seeds = differences.len();
        if seeds < FIRST_LOOK as usize || !seeds.is_multiple_of(STEP as usize) {
            continue;
        }
        let interval = sequence_interval(&series, LEVEL);
        let is_late = first_look(&differences).is_some_and(|first| seeds >= first);
        let is_decided = is_late && interval.is_some_and(Interval::excludes_zero);
        if is_decided || seeds == MOST {
            return Stop { seeds, interval, is_decided };
        }
    }
}

/// Differences of runs of one scenario under other seeds.
fn strangers(runs: &[Contest], value: fn(&Contest) -> f64) -> Vec<f64> {
    runs.chunks_exact(2).map(|pair| value(&pair[0]) - value(&pair[1])).collect()
}
