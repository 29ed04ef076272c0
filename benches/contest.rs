//! What a run of the contest costs: CPU time per run and per plan, and how it divides. One thread, no files.
//!
//! `cargo bench` runs 200 seeds after a warm-up; `cargo bench -- 1000` runs as many as it is told. Arguments with an
//! equals sign change the scenario: `cargo bench --bench contest -- unimog.planner=hybrid-astar`.

use std::process::ExitCode;

use wildfire::batch::execute::{CpuSplit, RunResult};
use wildfire::stats::Series;
use wildfire::timeline::Outcome;
use wildfire::{scenario, sim};

const WARM_UP_RUNS: u64 = 20;
const MEASURED_RUNS: u64 = 200;

type Part = (&'static str, fn(&CpuSplit) -> f64);

const PARTS: &[Part] = &[
    ("terrain", |cpu| cpu.terrain_s),
    ("clearance field", |cpu| cpu.clearance_field_s),
    ("sampling", |cpu| cpu.sampling_s),
    ("connecting", |cpu| cpu.map_generation_s),
    ("roadmap search", |cpu| cpu.roadmap_search_s),
    ("local search", |cpu| cpu.local_search_s),
    ("reachability", |cpu| cpu.reachability_s),
    ("Wumpus", |cpu| cpu.wumpus_s),
    ("rest", CpuSplit::rest_s),
];

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a benchmark prints its figures")]
fn main() -> ExitCode {
    let runs = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(MEASURED_RUNS);
    let changes: Vec<String> = std::env::args().filter(|argument| argument.contains('=')).collect();
    match measure(runs, &changes) {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(runs: u64, changes: &[String]) -> Result<String, String> {
    let contest = scenario::load("contest", changes).map_err(|error| error.to_string())?;
    let run = |seed| {
        let run = sim::run(&contest, seed).map_err(|error| format!("seed {seed}: {error}"))?;
        Ok::<_, String>(RunResult::new(Outcome::new(&run.timeline), run.cost))
    };
    for seed in 1..=WARM_UP_RUNS {
        run(seed)?;
    }
    let results = (1..=runs).map(run).collect::<Result<Vec<_>, _>>()?;
    Ok(report(&results))
}

fn report(results: &[RunResult]) -> String {
    let mut run_ms: Vec<f64> = results.iter().map(|result| result.cpu.run_s * 1e3).collect();
    run_ms.sort_by(f64::total_cmp);
    let mean = |of: &dyn Fn(&RunResult) -> f64| {
        let mut series = Series::default();
        results.iter().for_each(|result| series.add(of(result)));
        series.mean().unwrap_or(0.0)
    };
    let run = mean(&|result| result.cpu.run_s);
    let truck_plans = mean(&|result| result.trucks().map(|agent| f64::from(agent.plans)).sum());
    let wumpus_plans = mean(&|result| result.wumpuses().map(|agent| f64::from(agent.plans)).sum());
    let queries = mean(&|result| result.cpu.roadmap_search_s + result.cpu.local_search_s);
    let wumpus = mean(&|result| result.cpu.wumpus_s);
    let mut lines = vec![
        format!("contest, seeds 1..{}, one thread", results.len()),
        format!("CPU ms a run: median {:.3}, p95 {:.3}", quantile(&run_ms, 0.5), quantile(&run_ms, 0.95)),
        format!("plans a run: truck {truck_plans:.1}, Wumpus {wumpus_plans:.1}"),
        format!("CPU us a plan: truck {:.1}, Wumpus {:.1}", 1e6 * queries / truck_plans, 1e6 * wumpus / wumpus_plans),
        what_came_of_it(results),
        String::new(),
        format!("{:16} {:>9} {:>6}", "mean of a run", "ms", "%"),
    ];
    for (name, part) in PARTS {
        let seconds = mean(&|result| part(&result.cpu));
        lines.push(format!("{name:16} {:9.3} {:6.1}", seconds * 1e3, 100.0 * seconds / run));
    }
    let planners = mean(&|result| result.cpu.planners_s());
    lines.push(format!("{:16} {:9.3} {:6.1}", "planners", planners * 1e3, 100.0 * planners / run));
    lines.push(format!("{:16} {:9.3} {:6.1}", "whole run", run * 1e3, 100.0));
    lines.extend(peak_memory().map(|peak| format!("\npeak memory: {peak}")));
    lines.join("\n")
}

/// What the trucks did for the time that they planned.
fn what_came_of_it(results: &[RunResult]) -> String {
    let sum = |of: &dyn Fn(&RunResult) -> f64| results.iter().map(of).sum::<f64>();
    let share = sum(&|result| result.outcome.extinguished_ratio()) / results.len() as f64;
    let metres = sum(&|result| result.trucks().map(|agent| agent.distance_m).sum());
    let plans = sum(&|result| result.trucks().map(|agent| f64::from(agent.plans)).sum());
    format!("trucks: {:.2} % of the bushes extinguished, {:.2} m a plan", 100.0 * share, metres / plans)
}

/// The smallest value that at least this share of a sorted list does not exceed.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

/// The most memory that this process held at once, where the system tells.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().to_owned())
}
