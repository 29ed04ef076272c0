//! A batch over runs that are made up here, so that rows, files and workers can be judged without a simulation.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use wildfire::batch::{
    AGENT_COLUMNS, BatchError, BatchPlan, BatchReport, OutputFolder, RUN_COLUMNS, Record, Status, is_measured,
    run_batch_with,
};
use wildfire::geometry::{Cell, FieldFrame, Pose};
use wildfire::scenario::{Field, Fire, Scenario, Score, Suppression, Unimog, Wumpus};
use wildfire::sim::{AgentCost, Run, RunCost, RunError};
use wildfire::time::SimTime;
use wildfire::timeline::{AgentId, AgentStart, Body, Cause, EndReason, Event, Fact, Rules, Setting, Timeline};

fn scenario() -> Scenario {
    Scenario {
        name: "made-up".into(),
        duration_s: 100.0,
        field: Field::default(),
        fire: Fire::default(),
        suppression: Suppression::default(),
        score: Score::default(),
        wumpus: vec![Wumpus::default()],
        unimog: vec![Unimog::default()],
        ignition: Vec::new(),
    }
}

fn plan(seeds: &str, record: Record) -> BatchPlan {
    BatchPlan {
        source: "my file.toml".into(),
        overrides: vec!["fire.relight=true".into()],
        scenario: scenario(),
        seeds: seeds.parse().expect("these seeds are fine"),
        record,
    }
}

/// Ten bushes, of which the Wumpus lights some and the truck puts some of those out, as the seed says.
fn made_up_timeline(seed: u64) -> Timeline {
    let bushes: Vec<Cell> = (0..10).map(|col| Cell { col, row: 3 }).collect();
    let (wumpus, truck) = (AgentId::Wumpus(0), AgentId::Unimog(0));
    let start = |id, x, body| AgentStart { id, pose: Pose::new(x, 50.0, 0.0), body, limits: None };
    let lit = (seed % 7) as usize;
    let at = |second: usize, fact| Event { time: SimTime::from_seconds(second as f64), fact };
    let mut events = Vec::new();
    for (second, &cell) in bushes.iter().enumerate().take(lit) {
        events.push(at(second + 1, Fact::Ignited { cell, cause: Cause::Lit(wumpus) }));
    }
    for (second, &cell) in bushes.iter().enumerate().take(lit / 2) {
        events.push(at(second + 50, Fact::Extinguished { cell, by: truck }));
    }
    events.push(at(100, Fact::Ended { reason: EndReason::Duration }));
    Timeline {
        setting: Setting {
            scenario: "made-up".into(),
            seed,
            program_version: "0".into(),
            frame: FieldFrame { cols: 50, rows: 50, cell_m: 5.0 },
            bushes,
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
                relight: false,
                score_wumpus_ignited: 1.0,
                score_wumpus_burned_out: 1.0,
                score_truck_extinguished: 2.0,
            },
        },
        events,
    }
}

/// Seeds that end in 13 panic, those that end in 8 fail.
fn made_up_run(_: &Scenario, seed: u64) -> Result<Run, RunError> {
    assert!(seed % 100 != 13, "thirteen,\n\"unlucky\"");
    if seed % 10 == 8 {
        return Err(RunError::NoFreeStart { agent: AgentId::Wumpus(0) });
    }
    let part = Duration::from_micros(seed % 1000);
    let cost = |agent| AgentCost {
        agent,
        sampling: part,
        connecting: part,
        roadmap_search: part,
        local_search: part,
        reachability: part,
    };
    let cost = RunCost {
        terrain: part,
        clearance_field: part,
        agents: vec![cost(AgentId::Wumpus(0)), cost(AgentId::Unimog(0))],
        total: part * 20,
    };
    Ok(Run { timeline: made_up_timeline(seed), cost })
}

fn run(folder: &Path, seeds: &str, jobs: usize) -> BatchReport {
    let folder = OutputFolder::named(folder, true).expect("a scratch folder");
    run_batch_with(&plan(seeds, Record::None), &folder, jobs, made_up_run, |_| {}).expect("the disk is fine")
}

fn rows(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).expect("the file is there");
    let header = reader.headers().expect("readable").iter().map(str::to_owned).collect();
    let record =
        |record: Result<csv::StringRecord, csv::Error>| record.expect("readable").iter().map(str::to_owned).collect();
    (header, reader.records().map(record).collect())
}

/// The columns that must not differ between two runs of a seed.
fn outcomes(path: &Path) -> Vec<Vec<String>> {
    let (header, rows) = rows(path);
    let first_measured = header.iter().position(|name| is_measured(name)).expect("cpu columns are there");
    let all = [vec![header], rows].concat();
    all.into_iter().map(|row| row[..first_measured].to_vec()).collect()
}

#[test]
fn rows_stand_in_the_order_of_the_seeds_whatever_the_number_of_workers() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let seeds = "500..700,1..300,1000";
    let (one, three) = (scratch.path().join("one"), scratch.path().join("three"));
    run(&one, seeds, 1);
    run(&three, seeds, 3);
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&one.join(file)), outcomes(&three.join(file)), "{file}");
    }
    let found: Vec<String> = rows(&one.join("runs.csv")).1.into_iter().map(|row| row[1].clone()).collect();
    let expected: Vec<String> = (500..=700).chain(1..=300).chain([1000]).map(|seed: u64| seed.to_string()).collect();
    assert_eq!(found, expected);
}

#[test]
fn a_seed_gives_the_same_row_alone_and_in_a_batch() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (many, alone) = (scratch.path().join("many"), scratch.path().join("alone"));
    run(&many, "1..40", 2);
    run(&alone, "27", 1);
    assert_eq!(outcomes(&many.join("runs.csv"))[27], outcomes(&alone.join("runs.csv"))[1]);
}

#[test]
fn measured_columns_stand_last() {
    let measured_stand_last = |names: &[&str]| {
        let outcomes = names.iter().take_while(|name| !is_measured(name)).count();
        outcomes > 0 && names[outcomes..].iter().all(|name| is_measured(name))
    };
    assert!(measured_stand_last(&RUN_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>()));
    assert!(measured_stand_last(&AGENT_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>()));
}

#[test]
fn first_columns_are_those_that_readers_rely_on() {
    let promised = "scenario,seed,status,message,obstacles,intact,burning,burned_out,extinguished,intact_ratio,\
                    burned_ratio,extinguished_ratio,lit_by_wumpus,caught_by_spread,truck_stuck_s,wumpus_stuck_s";
    let names: Vec<_> = RUN_COLUMNS.iter().map(|column| column.name).collect();
    assert!(names.join(",").starts_with(promised));
}

#[test]
fn column_names_are_distinct() {
    for names in [
        RUN_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>(),
        AGENT_COLUMNS.iter().map(|column| column.name).collect(),
    ] {
        let mut distinct = names.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), names.len());
    }
}

#[test]
fn failed_run_is_a_row_with_its_reason_and_without_numbers() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let report = run(scratch.path(), "7..9", 1);
    assert_eq!((report.tally.done, report.tally.failed, report.tally.panicked), (2, 1, 0));
    let (_, rows) = rows(&scratch.path().join("runs.csv"));
    let reason = RunError::NoFreeStart { agent: AgentId::Wumpus(0) }.to_string();
    assert_eq!(rows[1][..4], ["made-up", "8", "failed", &reason]);
    let (numbers, wall) = rows[1][4..].split_at(rows[1].len() - 5);
    assert!(numbers.iter().all(String::is_empty));
    assert!(!wall[0].is_empty(), "the time that it took is known");
    let agents = self::rows(&scratch.path().join("agents.csv")).1;
    assert_eq!(agents.len(), 4, "two agents in each of the runs that are done");
}

#[test]
fn panic_is_a_row_that_ends_with_the_command_that_shows_it_again() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let report = run(scratch.path(), "11..15", 2);
    assert_eq!((report.tally.done, report.tally.panicked), (4, 1));
    let (_, rows) = rows(&scratch.path().join("runs.csv"));
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[2][2], "panicked");
    let message = &rows[2][3];
    assert!(message.starts_with("panicked: thirteen, \"unlucky\" (tests"), "{message}");
    assert!(message.ends_with("wildfire run 'my file.toml' --seed 13 --set fire.relight=true"), "{message}");
}

#[test]
fn statistics_are_of_all_runs_and_tables_fit_a_terminal() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let report = run(scratch.path(), "18446744073709551000..18446744073709551049", 2);
    let text = report.tables.to_text();
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(text.contains("30 more runs are in runs.csv"), "{text}");
    let outcomes = outcomes(&scratch.path().join("runs.csv"));
    let column = outcomes[0].iter().position(|name| name == "extinguished").expect("it is promised");
    let numbers: Vec<f64> = outcomes[1..].iter().filter_map(|row| row[column].parse().ok()).collect();
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    let mean_row = text.lines().find(|line| line.starts_with("Mean")).expect("a row of means");
    assert_eq!(mean_row.split_whitespace().nth(6), Some(format!("{mean:.2}").as_str()), "{text}");
}

#[test]
fn one_run_has_dashes_for_its_spread() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let text = run(scratch.path(), "5", 1).tables.to_text();
    for label in ["Std dev", "95% low", "95% high"] {
        let mut lines = text.lines().filter(|line| line.starts_with(label));
        assert!(lines.all(|line| line[label.len()..].split_whitespace().all(|cell| cell == "-")), "{text}");
    }
}

#[test]
fn batch_without_a_finished_run_still_has_its_tables() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let report = run(scratch.path(), "8,18,28", 1);
    assert_eq!(report.tally.not_done(), 3);
    assert!(report.tables.to_text().contains("Mean"));
    assert_eq!(rows(&scratch.path().join("runs.csv")).1.len(), 3);
}

#[test]
fn every_run_is_reported_as_it_ends() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(scratch.path(), false).expect("a scratch folder");
    let (done, others) = (AtomicU64::new(0), AtomicU64::new(0));
    let count = |status| {
        let counter = if status == Status::Done { &done } else { &others };
        counter.fetch_add(1, Ordering::Relaxed);
    };
    run_batch_with(&plan("1..100", Record::None), &folder, 2, made_up_run, count).expect("the disk is fine");
    assert_eq!((done.into_inner(), others.into_inner()), (89, 11));
}

#[test]
fn files_appear_whole_and_nothing_else_is_left() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run(scratch.path(), "1..3", 1);
    let entries = fs::read_dir(scratch.path()).expect("readable");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("readable").file_name()).collect();
    names.sort();
    assert_eq!(names, ["agents.csv", "plan.json", "runs.csv", "tables.md"]);
}

#[test]
fn plan_file_holds_the_whole_scenario_and_its_hash_covers_what_decides() {
    let one = plan("1..3", Record::None);
    let json: serde_json::Value = serde_json::from_str(&one.to_json()).expect("a plan is JSON");
    let scenario: Scenario = serde_json::from_value(json["scenario"].clone()).expect("the scenario reads back");
    assert_eq!(scenario, one.scenario);
    assert_eq!(json["content_sha256"].as_str().map(str::len), Some(64));
    assert_eq!(json["seeds"], "1..3");
    assert_eq!(one.content_sha256(), plan("1..3", Record::All).content_sha256());
    assert_ne!(one.content_sha256(), plan("1..4", Record::None).content_sha256());
    let mut other = plan("1..3", Record::None);
    other.scenario.fire.relight = true;
    assert_ne!(one.content_sha256(), other.content_sha256());
}

#[test]
fn recordings_are_kept_when_asked_for() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(scratch.path(), false).expect("a scratch folder");
    run_batch_with(&plan("1,2,8", Record::All), &folder, 1, made_up_run, |_| {}).expect("the disk is fine");
    assert!(folder.recording(1).is_file() && folder.recording(2).is_file());
    assert!(!folder.recording(8).exists(), "a run that could not take place has no timeline");
}

#[test]
fn run_that_cannot_be_recorded_is_a_row_with_the_reason() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(scratch.path(), false).expect("a scratch folder");
    let run_with_a_stray = |scenario: &Scenario, seed| {
        let mut run = made_up_run(scenario, seed)?;
        if seed == 2 {
            run.timeline.setting.agents[0].pose.x = f64::NAN;
        }
        Ok(run)
    };
    let report = run_batch_with(&plan("1..3", Record::All), &folder, 2, run_with_a_stray, |_| {});
    let tally = report.expect("the disk is fine").tally;
    assert_eq!((tally.done, tally.failed), (2, 1));
    let (_, rows) = rows(&scratch.path().join("runs.csv"));
    let statuses: Vec<_> = rows.iter().map(|row| row[2].as_str()).collect();
    assert_eq!(statuses, ["done", "failed", "done"]);
    assert!(rows[1][3].starts_with("cannot be recorded: not a possible run: "), "{}", rows[1][3]);
    let recorded = [1, 2, 3].map(|seed| folder.recording(seed).is_file());
    assert_eq!(recorded, [true, false, true]);
}

#[test]
fn recording_that_the_disk_refuses_ends_the_batch() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(scratch.path(), false).expect("a scratch folder");
    let run_without_a_place = |scenario: &Scenario, seed| {
        fs::remove_dir(scratch.path().join("recordings")).expect("it is there and empty");
        made_up_run(scenario, seed)
    };
    let report = run_batch_with(&plan("1", Record::All), &folder, 1, run_without_a_place, |_| {});
    assert!(matches!(report, Err(BatchError::Unrecordable { .. })), "{report:?}");
}
