//! Whole runs of every preset before the audit: no leg overlaps a bush or leaves the field, none bends more than the
//! turning radius allows, none jumps, and every fire went out beside a truck that stood; and nobody was ever stuck, but
//! where that is the scenario's point.
//!
//! `WILDFIRE_AUDIT_SEEDS=1..1000` audits these seeds (both ends) of the contest instead of a few.

use wildfire::audit::{Audited, SampleStep, audit_timeline};
use wildfire::scenario;
use wildfire::sim;
use wildfire::timeline::Outcome;

fn audit(name: &str, seeds: impl Iterator<Item = u64>) -> Audited {
    audit_changed(name, &[], seeds)
}

#[expect(clippy::print_stdout, reason = "says how much was looked at, to those who ask for many seeds")]
fn audit_changed(name: &str, changes: &[String], seeds: impl Iterator<Item = u64>) -> Audited {
    let scenario = scenario::load(name, changes).expect("built-in scenarios load");
    let mut audited = Audited::default();
    for seed in seeds {
        let run = sim::run(&scenario, seed).unwrap_or_else(|error| panic!("{name}, seed {seed}: {error}"));
        let verdict = audit_timeline(&run.timeline, SampleStep::default());
        assert_eq!(verdict.violation.map(|violation| violation.to_string()), None, "{name}, seed {seed}");
        assert!(verdict.knows_limits);
        audited += verdict.audited;
        let outcome = Outcome::new(&run.timeline);
        assert_eq!(outcome.truck_stuck_s, 0.0, "{name}, seed {seed}: stuck");
        assert!(outcome.wumpus_stuck_s == 0.0 || name == "local-minima", "{name}, seed {seed}: stuck");
    }
    println!("{name} {changes:?}: {audited:?}");
    audited
}

fn contest_seeds() -> std::ops::RangeInclusive<u64> {
    let Ok(text) = std::env::var("WILDFIRE_AUDIT_SEEDS") else { return 1..=4 };
    let (first, last) = text.split_once("..").expect("seeds are FIRST..LAST");
    let number = |text: &str| text.parse().expect("seeds are whole numbers");
    number(first)..=number(last)
}

#[test]
fn the_contest_passes_the_audit() {
    let audited = audit("contest", contest_seeds());
    assert!(audited.legs > 100 && audited.extinctions > 100, "{audited:?}");
}

#[test]
fn the_contest_of_a_hybrid_search_passes_the_audit() {
    let changes = ["unimog.planner=hybrid-astar".to_owned()];
    let audited = audit_changed("contest", &changes, contest_seeds());
    assert!(audited.legs > 100 && audited.extinctions > 100, "{audited:?}");
}

/// Presets of which a run with its audit takes longer than those of all others together.
const LARGE: [&str; 3] = ["brigade", "county", "duel"];

#[test]
fn every_other_preset_passes_the_audit() {
    for (name, _) in scenario::BUILT_IN.iter().filter(|(name, _)| *name != "contest" && !LARGE.contains(name)) {
        audit(name, 1..=1);
    }
}

#[test]
#[ignore = "tier 2: two runs of every preset, of which county's are large"]
fn every_other_preset_passes_the_audit_twice() {
    for (name, _) in scenario::BUILT_IN.iter().filter(|(name, _)| *name != "contest") {
        audit(name, 1..=2);
    }
}

#[test]
fn a_front_that_reaches_two_cells_at_one_instant_passes_the_audit() {
    // Cell (79, 33) of seed 49 catches fire between two cells at the instant at which the later of them does.
    audit_changed("landscape", &["unimog=[]".to_owned()], 49..=49);
}
