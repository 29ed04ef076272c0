//! Reads a recording and prints the course of the fire: `cargo run --example read_recording [FILE.wildfire]`.
//!
//! `wildfire run contest --seed 7 --out run.wildfire` writes one. Without a file the example simulates that run.

#![expect(clippy::print_stdout, reason = "an example prints what it finds")]

use std::error::Error;
use std::path::Path;

use wildfire::fire::BushState;
use wildfire::scenario::load;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{Fact, FireFact, Outcome, Timeline, file};

fn main() -> Result<(), Box<dyn Error>> {
    let timeline: Timeline = match std::env::args().nth(1) {
        Some(name) => file::read(Path::new(&name))?,
        None => sim::run(&load("contest", &[])?, 7)?.timeline,
    };
    println!("{}, seed {}: {} facts", timeline.setting.scenario, timeline.setting.seed, timeline.events.len());

    // The state at any time is the state after all facts up to it.
    println!("\n minute  intact  burning");
    let minutes = timeline.end_time().as_seconds() / 60.0;
    for minute in (0..=minutes as u32).step_by(5) {
        let state = timeline.state_at(SimTime::from_seconds(f64::from(minute) * 60.0));
        let intact = state.bushes.iter().filter(|bush| **bush == BushState::Intact).count();
        let burning = state.bushes.iter().filter(|bush| matches!(bush, BushState::Burning { .. })).count();
        println!("{minute:7} {intact:7} {burning:8}");
    }

    // Facts are in chronological order; each describes an event and its agent.
    let first = timeline.events.iter().find(|event| matches!(event.fact, Fact::Fire(FireFact::Ignited { .. })));
    if let Some(event) = first {
        println!("\nThe first fire began at {:.1} s.", event.time.as_seconds());
    }
    let outcome = Outcome::new(&timeline);
    println!("{} of {} bushes were put out.", outcome.extinguished, outcome.obstacles);
    Ok(())
}
