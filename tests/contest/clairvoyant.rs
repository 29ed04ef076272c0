//! No run loses less than the bound for a dispatcher who knows all ignitions to come.

use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::Outcome;

fn outcome(name: &str, changes: &[&str], seed: u64) -> Outcome {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let scenario = scenario::load(name, &changes).expect("the built-in loads");
    let run = sim::run(&scenario, seed).unwrap_or_else(|error| panic!("{name}, seed {seed}: {error}"));
    Outcome::new(&run.timeline)
}

#[test]
fn no_policy_loses_less_than_the_bound() {
    let short = "duration_s=900";
    let variants: [(&str, &[&str]); 8] = [
        ("contest", &[short]),
        ("contest", &[short, "unimog.goal=oldest", "unimog.planner=hybrid-astar"]),
        // Too slow to be there in time: the bound is not zero.
        ("contest", &[short, "unimog.speed_mps=0.5", "unimog.reverse_speed_mps=0.5", "fire.burn_out_s=20"]),
        (
            "contest",
            &[
                short,
                "fire.spread_from=all",
                "unimog.speed_mps=0.5",
                "unimog.reverse_speed_mps=0.5",
                "fire.burn_out_s=20",
            ],
        ),
        ("coursework-2025", &[short]),
        ("fleet", &[short]),
        ("fleet", &[short, "unimog.goal=largest-cluster", "suppression.extinguishes=all-in-reach"]),
        ("unimog-alone", &[short]),
    ];
    let mut bounds = Vec::new();
    for (name, changes) in variants {
        let mut sum = 0;
        for seed in 1..=4 {
            let outcome = outcome(name, changes, seed);
            let bound = outcome.least_burned.expect("the rules are those of the radius");
            assert!(bound <= outcome.burned(), "{name} {changes:?}, seed {seed}: {bound} > {}", outcome.burned());
            assert_eq!(outcome.burned_beyond_bound(), Some(outcome.burned() - bound));
            sum += bound;
        }
        bounds.push(sum);
    }
    assert!(bounds[2] > 0 && bounds[3] > 0, "slow trucks lose something for sure: {bounds:?}");
}

#[test]
fn without_trucks_nothing_could_have_been_saved() {
    let outcome = outcome("wumpus-alone", &["duration_s=600"], 2);
    assert!(outcome.burned() > 0);
    assert_eq!((outcome.least_burned, outcome.burned_beyond_bound()), (Some(outcome.burned()), Some(0)));
}

#[test]
fn there_is_no_bound_where_what_was_put_out_burns_again() {
    let outcome = outcome("smoke", &["fire.relight=true"], 1);
    assert_eq!((outcome.least_burned, outcome.burned_beyond_bound()), (None, None));
}
