//! Rows, tables and files of a batch.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use wildfire::batch::execute::{Batch, BatchError, OutputFolder, Status};
use wildfire::batch::plan::Record;
use wildfire::batch::report::VariantReport;
use wildfire::batch::table::{AGENT_COLUMNS, CALL_COLUMNS, RUN_COLUMNS, is_measured};
use wildfire::document::Document;
use wildfire::scenario::{Scenario, Unimog};
use wildfire::sim::RunError;
use wildfire::timeline::AgentId;

use crate::made_up::{made_up_run, outcomes, plan, rows, run, run_plan};

/// The tables of a variant, as a terminal shows them.
fn text_of(report: &VariantReport) -> String {
    Document::default().with(report.tables.blocks()).to_text()
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
    let without_its_number = |path: &Path, row: usize| {
        let mut fields = outcomes(path).swap_remove(row);
        fields.remove(2);
        fields
    };
    assert_eq!(without_its_number(&many.join("runs.csv"), 27), without_its_number(&alone.join("runs.csv"), 1));
}

#[test]
fn measured_columns_stand_last() {
    let measured_stand_last = |names: &[&str]| {
        let outcomes = names.iter().take_while(|name| !is_measured(name)).count();
        outcomes > 0 && names[outcomes..].iter().all(|name| is_measured(name))
    };
    assert!(measured_stand_last(&RUN_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>()));
    assert!(measured_stand_last(&AGENT_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>()));
    assert!(measured_stand_last(&CALL_COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>()));
}

#[test]
fn first_columns_are_those_that_readers_rely_on() {
    let promised = "scenario,seed,run,planner,policy,status,message,obstacles,intact,burning,burned_out,extinguished,intact_ratio,\
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
    let reason = RunError::NoFreeStart { agent: AgentId::wumpus(0) }.to_string();
    let planner = Unimog::default().planner;
    assert_eq!(rows[1][..7], ["made-up", "8", "2", planner.name(), "nearest-burning", "failed", &reason]);
    let (numbers, wall) = rows[1][7..].split_at(rows[1].len() - 8);
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
    assert_eq!(rows[2][5], "panicked");
    let message = &rows[2][6];
    assert!(message.starts_with("panicked: thirteen, \"unlucky\" (tests"), "{message}");
    assert!(message.ends_with("wildfire run 'my file.toml' --seed 13 --set fire.relight=true"), "{message}");
}

#[test]
fn statistics_are_of_all_runs_and_tables_fit_a_terminal() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let report = run(scratch.path(), "18446744073709551000..18446744073709551049", 2);
    let text = text_of(&report);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(text.contains("All 50 runs are in runs.csv, one row each."), "{text}");
    assert!(!text.contains("18446744073709551000"), "beyond twenty runs there are no rows of single ones: {text}");
    let first = Document::default().with(report.tables.first_rows()).to_text();
    assert!(first.contains("30 more runs are in runs.csv") && first.contains("18446744073709551019"), "{first}");
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
    let text = text_of(&run(scratch.path(), "5", 1));
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
    assert!(text_of(&report).contains("Mean"));
    assert_eq!(rows(&scratch.path().join("runs.csv")).1.len(), 3);
}

#[test]
fn every_run_is_reported_as_it_ends() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = OutputFolder::named(scratch.path(), false).expect("a scratch folder");
    let (mut done, mut others) = (0, 0);
    let count = |end: wildfire::batch::execute::RunEnd| {
        *(if end.status == Status::Done { &mut done } else { &mut others }) += 1;
    };
    let mut batch = Batch::begin(plan("1..100", Record::None), folder).expect("the disk is fine");
    batch.run_with(Box::new(made_up_run), 2, &Arc::default(), count).expect("the disk is fine");
    assert_eq!((done, others), (89, 11));
}

#[test]
fn files_appear_whole_and_nothing_else_is_left() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run(scratch.path(), "1..3", 1);
    let entries = fs::read_dir(scratch.path()).expect("readable");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("readable").file_name()).collect();
    names.sort();
    assert_eq!(
        names,
        [
            "agents.csv",
            "machines.json",
            "plan.json",
            "planner_calls.parquet",
            "runs.csv",
            "runs.journal",
            "runs.parquet",
            "states.parquet",
            "summary.csv",
            "tables.md",
        ]
    );
}

#[test]
fn plan_file_holds_the_whole_scenario_and_its_hash_covers_what_decides() {
    let one = plan("1..3", Record::None);
    let json: serde_json::Value = serde_json::from_str(&one.to_json()).expect("a plan is JSON");
    let scenario: Scenario =
        serde_json::from_value(json["variants"][0]["scenario"].clone()).expect("the scenario reads back");
    assert_eq!(scenario, one.variants[0].scenario);
    assert_eq!(json["content_sha256"].as_str().map(str::len), Some(64));
    assert_eq!(json["seeds"], "1..3");
    assert_eq!(one.content_sha256(), plan("1..3", Record::All).content_sha256());
    assert_ne!(one.content_sha256(), plan("1..4", Record::None).content_sha256());
    let mut other = plan("1..3", Record::None);
    other.variants[0].scenario.fire.relight = true;
    assert_ne!(one.content_sha256(), other.content_sha256());
}

#[test]
fn recordings_are_kept_when_asked_for() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_plan(scratch.path(), plan("1,2,8", Record::All), 1, Box::new(made_up_run)).expect("the disk is fine");
    let is_recorded = |seed: u64| scratch.path().join(format!("recordings/seed-{seed}.wildfire")).is_file();
    assert!(is_recorded(1) && is_recorded(2));
    assert!(!is_recorded(8), "a run that could not take place has no timeline");
}

#[test]
fn run_that_cannot_be_recorded_is_a_row_with_the_reason() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let run_with_a_stray = |scenario: &Scenario, seed| {
        let mut run = made_up_run(scenario, seed)?;
        if seed == 2 {
            run.timeline.setting.agents[0].pose.x = f64::NAN;
        }
        Ok(run)
    };
    let report = run_plan(scratch.path(), plan("1..3", Record::All), 2, Box::new(run_with_a_stray));
    let tally = report.expect("the disk is fine").tally;
    assert_eq!((tally.done, tally.failed), (2, 1));
    let (_, rows) = rows(&scratch.path().join("runs.csv"));
    let statuses: Vec<_> = rows.iter().map(|row| row[5].as_str()).collect();
    assert_eq!(statuses, ["done", "failed", "done"]);
    assert!(rows[1][6].starts_with("cannot be recorded: not a possible run: "), "{}", rows[1][6]);
    let recorded = [1, 2, 3].map(|seed| scratch.path().join(format!("recordings/seed-{seed}.wildfire")).is_file());
    assert_eq!(recorded, [true, false, true]);
}

#[test]
fn recording_that_the_disk_refuses_ends_the_batch() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let recordings = scratch.path().join("recordings");
    let run_without_a_place = move |scenario: &Scenario, seed| {
        fs::remove_dir(&recordings).expect("it is there and empty");
        made_up_run(scenario, seed)
    };
    let report = run_plan(scratch.path(), plan("1", Record::All), 1, Box::new(run_without_a_place));
    assert!(matches!(report, Err(BatchError::Unrecordable { .. })), "{report:?}");
}
