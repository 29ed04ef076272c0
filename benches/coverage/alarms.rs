//! How often a batch is said to differ from itself under other seeds.

use std::fmt::Write;

use wildfire::rng::Xoshiro256PlusPlus as Random;
use wildfire::stats::{PairedAnswers, SignedRanks, estimate_mean};

use crate::outcomes::{Contest, Contests, below};
use crate::{count, percent};

const SIZES: [usize; 3] = [5, 30, 200];
const LEVEL: f64 = 0.05;

type Pairs<'a> = [(&'a Contest, &'a Contest)];
type Test = fn(&Pairs, &mut Random) -> f64;

const TESTS: [(&str, Test); 5] = [
    ("contest: cells saved, mean", |pairs, random| of_mean(pairs, |run| run.saved, random)),
    ("contest: cells saved, ranks", |pairs, _| of_ranks(pairs, |run| run.saved)),
    ("contest: won, McNemar", |pairs, _| of_answers(pairs)),
    ("original-2024: response, mean", |pairs, random| of_mean(pairs, |run| run.response_s, random)),
    ("original-2024: response, ranks", |pairs, _| of_ranks(pairs, |run| run.response_s)),
];

pub fn rates(contests: &Contests, replications: u64) -> String {
    let mut text = format!("Alarms in percent: a batch against itself under other seeds, level 5 %\n{:40}", "");
    SIZES.iter().for_each(|n| write!(text, "{:>13}", format!("n = {n}")).expect("a string takes any text"));
    text.push('\n');
    for (name, test) in TESTS {
        let runs = if name.starts_with("original") { &contests.original } else { &contests.contest };
        write!(text, "{name:40}").expect("a string takes any text");
        for n in SIZES {
            let alarms = count(replications, "coverage/alarms", |random| {
                let pairs = pairs_of_strangers(runs, n, random);
                test(&pairs, random) <= LEVEL
            });
            write!(text, "{:>13}", percent(alarms, replications)).expect("a string takes any text");
        }
        text.push('\n');
    }
    text
}

/// Two runs of different seeds each, no run twice: what two batches of one scenario under other seeds look like.
fn pairs_of_strangers<'a>(runs: &'a [Contest], n: usize, random: &mut Random) -> Vec<(&'a Contest, &'a Contest)> {
    let mut order: Vec<usize> = (0..runs.len()).collect();
    for place in 0..2 * n {
        let other = place + below(runs.len() - place, random);
        order.swap(place, other);
    }
    order[..2 * n].chunks(2).map(|pair| (&runs[pair[0]], &runs[pair[1]])).collect()
}

fn differences(pairs: &Pairs, value: fn(&Contest) -> f64) -> Vec<f64> {
    pairs.iter().map(|(a, b)| value(b) - value(a)).collect()
}

fn of_mean(pairs: &Pairs, value: fn(&Contest) -> f64, random: &mut Random) -> f64 {
    let estimate = estimate_mean(&differences(pairs, value), random);
    estimate.and_then(|estimate| estimate.p_value).unwrap_or(1.0)
}

fn of_ranks(pairs: &Pairs, value: fn(&Contest) -> f64) -> f64 {
    SignedRanks::from_differences(&differences(pairs, value)).map_or(1.0, |ranks| ranks.p_value)
}

fn of_answers(pairs: &Pairs) -> f64 {
    let mut answers = PairedAnswers::default();
    pairs.iter().for_each(|(a, b)| answers.add(a.won, b.won));
    answers.mcnemar_p_value()
}
