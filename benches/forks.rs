//! Forks of every built-in scenario at twenty instants: that each ends as its parent does, and what a fork costs, on the
//! thread's CPU clock.
//!
//! `cargo bench --bench forks`, or with names: `cargo bench --bench forks -- contest fleet`. Runs are cut off after ten
//! simulated minutes.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use wildfire::scenario::{self, BUILT_IN};
use wildfire::sim::{self, Simulation};
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::timeline::Timeline;

const INSTANTS: u32 = 20;
const LONGEST_S: f64 = 600.0;

fn ended(mut simulation: Simulation) -> Timeline {
    simulation.advance_to(SimTime::MAX);
    simulation.finish().timeline
}

fn main() {
    let requested: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    println!("{:18} {:>6} {:>10} {:>14} {:>10}", "", "forks", "us a fork", "us a copy over", "ms a run");
    for (name, _) in
        BUILT_IN.iter().filter(|(name, _)| requested.is_empty() || requested.iter().any(|word| word == name))
    {
        let mut scenario = scenario::load(name, &[]).expect("it is built in");
        scenario.duration_s = scenario.duration_s.min(LONGEST_S);
        let mut watch = CpuStopwatch::start();
        let expected = sim::run(&scenario, 1).expect("it takes place").timeline;
        let run = watch.elapsed_since_last();
        let mut parent = Simulation::new(&scenario, 1).expect("it takes place");
        let mut other = parent.fork().expect("its policies are built in");
        let (mut forks, mut forking, mut copying) = (Vec::new(), 0.0, 0.0);
        for instant in 0..INSTANTS {
            let share = f64::from(instant) / f64::from(INSTANTS);
            parent.advance_to(SimTime::from_seconds(expected.end_time().as_seconds() * share));
            watch.elapsed_since_last();
            forks.push(parent.fork().expect("its policies are built in"));
            forking += watch.elapsed_since_last().as_secs_f64();
            other.become_fork_of(&parent).expect("its policies are built in");
            copying += watch.elapsed_since_last().as_secs_f64();
        }
        assert_eq!(ended(parent), expected, "{name}");
        for fork in forks {
            assert_eq!(ended(fork), expected, "{name}");
        }
        let us = |seconds: f64| 1e6 * seconds / f64::from(INSTANTS);
        println!("{name:18} {INSTANTS:6} {:10.1} {:14.1} {:10.2}", us(forking), us(copying), 1e3 * run.as_secs_f64());
    }
}
