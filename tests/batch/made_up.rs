//! Runs that are made up, so that rows, files and workers can be judged without a simulation.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use wildfire::batch::execute::{Batch, BatchError, OutputFolder, RunScenario};
use wildfire::batch::plan::{BatchPlan, Record};
use wildfire::batch::report::VariantReport;
use wildfire::batch::table::is_measured;
use wildfire::geometry::{Cell, FieldFrame, Pose};
use wildfire::scenario::Scenario;
use wildfire::sim::{AgentCost, FailureMessages, Run, RunCost, RunError};
use wildfire::time::SimTime;
use wildfire::timeline::{
    AgentId, AgentStart, Body, Cause, EndReason, Event, Fact, FireFact, Rules, Setting, Timeline,
};

fn scenario() -> Scenario {
    Scenario { name: "made-up".into(), duration_s: 100.0, ..Scenario::default() }
}

pub fn plan(seeds: &str, record: Record) -> BatchPlan {
    let seeds = seeds.parse().expect("these seeds are fine");
    BatchPlan::from_scenario("my file.toml", &["fire.relight=true".into()], scenario(), seeds, record)
}

/// Ten bushes, of which the Wumpus lights some and the truck puts some of those out, as the seed says.
fn made_up_timeline(seed: u64) -> Timeline {
    let bushes: Vec<Cell> = (0..10).map(|col| Cell { col, row: 3 }).collect();
    let (wumpus, truck) = (AgentId::wumpus(0), AgentId::unimog(0));
    let start = |id, x, body| AgentStart { id, pose: Pose::new(x, 50.0, 0.0), body, limits: None };
    let ignited = (seed % 7) as usize;
    let at = |second: usize, fact| Event { time: SimTime::from_seconds(second as f64), fact };
    let mut events = Vec::new();
    for (second, &cell) in bushes.iter().enumerate().take(ignited) {
        events.push(at(second + 1, Fact::Fire(FireFact::Ignited { cell, cause: Cause::Agent(wumpus) })));
    }
    for (second, &cell) in bushes.iter().enumerate().take(ignited / 2) {
        events.push(at(second + 50, Fact::Fire(FireFact::Extinguished { cell, by: truck })));
    }
    events.push(at(100, Fact::Ended { reason: EndReason::Duration }));
    Timeline {
        setting: Setting {
            scenario: "made-up".into(),
            seed,
            program_version: "0".into(),
            frame: FieldFrame { cols: 50, rows: 50, cell_m: 5.0 },
            bushes,
            blocked: Vec::new(),
            spread: None,
            water: None,
            ground_shares: Vec::new(),
            line: None,
            pieces: Vec::new(),
            agents: vec![
                start(wumpus, 200.0, Body::Square { size_m: 3.0 }),
                start(truck, 50.0, Body::Truck(wildfire::vehicle::Dimensions::default())),
            ],
            rules: Rules {
                duration: SimTime::from_seconds(100.0),
                suppression_reach_m: Some(10.0),
                suppression_dwell: SimTime::from_seconds(5.0),
                extinguishes_all: None,
                fire: None,
                reignition: false,
                score_wumpus_ignited: 1.0,
                score_wumpus_burned_out: 1.0,
                score_truck_extinguished: 2.0,
            },
        },
        events,
        ground: Vec::new(),
    }
}

/// Seeds that end in 13 panic, those that end in 8 fail.
pub fn made_up_run(_: &Scenario, seed: u64) -> Result<Run, RunError> {
    assert!(seed % 100 != 13, "thirteen,\n\"unlucky\"");
    if seed % 10 == 8 {
        return Err(RunError::NoFreeStart { agent: AgentId::wumpus(0) });
    }
    let part = Duration::from_micros(seed % 1000);
    let cost = |agent| AgentCost {
        agent,
        sampling: part,
        connecting: part,
        roadmap_search: part,
        local_search: part,
        reachability: part,
        ..AgentCost::new(agent)
    };
    let cost = RunCost {
        terrain: part,
        clearance_field: part,
        dispatch: part,
        agents: vec![cost(AgentId::wumpus(0)), cost(AgentId::unimog(0))],
        total: part * 20,
        ..RunCost::default()
    };
    let (cpu_samples, answer_cpu) = (Vec::new(), Vec::new());
    let (messages, asks) = (FailureMessages::default(), None);
    Ok(Run { timeline: made_up_timeline(seed), cost, cpu_samples, answer_cpu, messages, asks })
}

/// Makes runs up, and stops the batch when so many have begun. The callback of rows would be too late: workers may have
/// made all runs up before it is called.
pub fn made_up_runs_until(max: u64, stop: &Arc<AtomicBool>) -> Box<RunScenario> {
    let (started, stop) = (AtomicU64::new(0), Arc::clone(stop));
    Box::new(move |scenario: &Scenario, seed| {
        if started.fetch_add(1, Ordering::Relaxed) + 1 >= max {
            stop.store(true, Ordering::Relaxed);
        }
        made_up_run(scenario, seed)
    })
}

pub fn run(folder: &Path, seeds: &str, jobs: usize) -> VariantReport {
    run_plan(folder, plan(seeds, Record::None), jobs, Box::new(made_up_run)).expect("the disk is fine")
}

pub fn run_plan(
    folder: &Path,
    plan: BatchPlan,
    jobs: usize,
    run: Box<RunScenario>,
) -> Result<VariantReport, BatchError> {
    let folder = OutputFolder::named(folder, true).expect("a scratch folder");
    let stop = Arc::default();
    let mut batch = Batch::begin(plan, folder)?;
    batch.run_with(run, jobs, &stop, |_| {})?;
    Ok(batch.finish(&stop)?.variants.remove(0))
}

pub fn rows(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).expect("the file is there");
    let header = reader.headers().expect("readable").iter().map(str::to_owned).collect();
    let record =
        |record: Result<csv::StringRecord, csv::Error>| record.expect("readable").iter().map(str::to_owned).collect();
    (header, reader.records().map(record).collect())
}

/// The columns that must not differ between two runs of a seed.
pub fn outcomes(path: &Path) -> Vec<Vec<String>> {
    let (header, rows) = rows(path);
    let first_measured = header.iter().position(|name| is_measured(name)).expect("cpu columns are there");
    let all = [vec![header], rows].concat();
    all.into_iter().map(|row| row[..first_measured].to_vec()).collect()
}
