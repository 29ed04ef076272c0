//! What the audit of whole runs costs, on the thread's CPU clock, beside what the runs cost.
//!
//! `cargo bench --bench audit` takes `contest`, `dense` and `fleet`, twenty seeds each.

use wildfire::audit::{Audited, SampleStep, audit_timeline};
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::cpu::CpuStopwatch;

const SEEDS: u64 = 20;

#[expect(clippy::print_stdout, reason = "a benchmark prints its figures")]
fn main() {
    println!(
        "{:8} {:>12} {:>10} {:>12} {:>14} {:>16}",
        "", "poses a run", "km a run", "ns a pose", "ms an audit", "ms a simulation"
    );
    for name in ["contest", "dense", "fleet"] {
        let scenario = scenario::load(name, &[]).expect("it is built in");
        let (mut simulated_s, mut audited_s) = (0.0, 0.0);
        let mut audited = Audited::default();
        for seed in 1..=SEEDS {
            let mut watch = CpuStopwatch::start();
            let run = sim::run(&scenario, seed).expect("it takes place");
            simulated_s += watch.elapsed_since_last().as_secs_f64();
            let verdict = audit_timeline(&run.timeline, SampleStep::default());
            audited_s += watch.elapsed_since_last().as_secs_f64();
            assert!(verdict.violation.is_none(), "{name}, seed {seed}: {verdict:?}");
            audited += verdict.audited;
        }
        let runs = SEEDS as f64;
        println!(
            "{name:8} {:12.0} {:10.2} {:12.1} {:14.2} {:16.2}",
            audited.poses as f64 / runs,
            audited.metres / 1e3 / runs,
            1e9 * audited_s / audited.poses as f64,
            1e3 * audited_s / runs,
            1e3 * simulated_s / runs
        );
    }
}
