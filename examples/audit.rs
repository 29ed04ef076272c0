//! Plays a run, checks it with the audit, then damages it and checks it again: `cargo run --example audit`.

#![expect(clippy::print_stdout, reason = "an example prints what it finds")]

use std::error::Error;

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::scenario::load;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{Fact, FireFact};

fn main() -> Result<(), Box<dyn Error>> {
    let mut timeline = sim::run(&load("contest", &[])?, 7)?.timeline;
    let verdict = audit_timeline(&timeline, SampleStep::default());
    println!("{} legs, {:.0} m, {} poses", verdict.audited.legs, verdict.audited.metres, verdict.audited.poses);
    println!(
        "As it was played: {}",
        verdict.violation.map_or("nothing against the rules".to_owned(), |found| found.to_string())
    );

    // A fire that goes out ten seconds too early is extinguished by a truck that has not arrived yet.
    let extinguished =
        timeline.events.iter_mut().find(|event| matches!(event.fact, Fact::Fire(FireFact::Extinguished { .. })));
    if let Some(event) = extinguished {
        event.time = event.time - SimTime::from_seconds(10.0);
    }
    timeline.events.sort_by_key(|event| event.time);
    let verdict = audit_timeline(&timeline, SampleStep::default());
    println!(
        "After the damage: {}",
        verdict.violation.map_or("nothing was found".to_owned(), |found| found.to_string())
    );
    Ok(())
}
