//! The Parquet files, read back by the library that wrote them; other readers are tried where they can be installed.

use std::fs::File;
use std::path::Path;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet::schema::types::ColumnDescPtr;
use wildfire::batch::plan::{BatchPlan, BatchRequest, COMMIT, COMPILER, PROGRAM_VERSION, Record, Sweep};
use wildfire::sim;

use crate::made_up::{made_up_run, plan, rows, run_plan};

/// Names of the columns, and the rows as a CSV file would write them.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let reader = opened(path);
    let columns = reader.metadata().file_metadata().schema_descr().columns().iter();
    let names = columns.map(|column| column.name().to_owned()).collect();
    let written = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Long(count) => count.to_string(),
        // Only for seeds that are too large for the signed type.
        Field::ULong(count) => count.to_string(),
        Field::Double(number) => number.to_string(),
        Field::Str(text) => text.clone(),
        Field::Bool(flag) => flag.to_string(),
        other => panic!("{other:?} is of no kind that is written"),
    };
    let rows = reader.get_row_iter(None).expect("readable");
    let rows = rows.map(|row| row.expect("readable").get_column_iter().map(|(_, field)| written(field)).collect());
    (names, rows.collect())
}

const FILES: [&str; 3] = ["runs.parquet", "planner_calls.parquet", "states.parquet"];

fn opened(path: &Path) -> SerializedFileReader<File> {
    SerializedFileReader::new(File::open(path).expect("the file is there")).expect("it is Parquet")
}

/// Names of the columns for which the predicate holds.
fn columns(path: &Path, holds: impl Fn(&ColumnDescPtr) -> bool) -> Vec<String> {
    let reader = opened(path);
    let all = reader.metadata().file_metadata().schema_descr().columns();
    all.iter().filter(|column| holds(column)).map(|column| column.name().to_owned()).collect()
}

fn is_unsigned(column: &ColumnDescPtr) -> bool {
    matches!(column.logical_type_ref(), Some(LogicalType::Integer(it)) if !it.is_signed)
}

fn is_required(column: &ColumnDescPtr) -> bool {
    column.self_type().get_basic_info().repetition() == Repetition::REQUIRED
}

fn swept() -> BatchPlan {
    let request = BatchRequest {
        scenarios: vec!["smoke".into()],
        // A key whose values are of two kinds, one whose values are texts, and the planner.
        sweeps: vec![
            Sweep::parse("field.coverage", "0.05,0.1").expect("two values"),
            Sweep::parse("fire.burn_out_s", "30,none").expect("two values"),
        ],
        seeds: "1..3".parse().ok(),
        ..BatchRequest::default()
    };
    request.resolve(false).expect("a small batch")
}

#[test]
fn runs_are_those_of_the_csv_file() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    // Failed and panicked runs have fields without a value; more rows than are written at once.
    run_plan(scratch.path(), plan("1..5000", Record::None), 2, Box::new(made_up_run)).expect("the disk is fine");
    assert_eq!(table(&scratch.path().join("runs.parquet")), rows(&scratch.path().join("runs.csv")));
}

#[test]
fn swept_keys_are_columns_of_all_three() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_plan(scratch.path(), swept(), 2, Box::new(sim::run)).expect("the disk is fine");
    assert_eq!(table(&scratch.path().join("runs.parquet")), rows(&scratch.path().join("runs.csv")));
    for (file, next) in [("planner_calls.parquet", "agent"), ("states.parquet", "t_s")] {
        let names = table(&scratch.path().join(file)).0;
        let expected = ["scenario", "seed", "run", "planner", "policy", "field.coverage", "fire.burn_out_s", next];
        assert_eq!(names[..8], expected, "{file}");
    }
}

#[test]
fn long_tables_add_up_to_the_runs() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_plan(scratch.path(), swept(), 2, Box::new(sim::run)).expect("the disk is fine");
    let sum_of = |(names, rows): &(Vec<String>, Vec<Vec<String>>), name: &str| {
        let column = names.iter().position(|column| column == name).expect("the column is there");
        rows.iter().map(|row| row[column].parse::<f64>().expect("a number")).sum::<f64>()
    };
    let runs = rows(&scratch.path().join("runs.csv"));
    let calls = table(&scratch.path().join("planner_calls.parquet"));
    assert_eq!(calls.1.len() as f64, sum_of(&runs, "truck_plans") + sum_of(&runs, "wumpus_plans"));
    assert!(!calls.1.is_empty());
    let expansions = ["truck_roadmap_expansions", "truck_local_expansions", "wumpus_expansions"];
    let expected = expansions.iter().map(|name| sum_of(&runs, name)).sum::<f64>();
    assert_eq!(sum_of(&calls, "roadmap_expansions") + sum_of(&calls, "local_expansions"), expected);
    let states = table(&scratch.path().join("states.parquet"));
    assert_eq!(states.1.len(), 12 * 61);
    let bushes = ["intact", "burning", "burned_out", "extinguished"].map(|name| sum_of(&states, name));
    assert_eq!(bushes.iter().sum::<f64>(), 61.0 * sum_of(&runs, "obstacles"));
}

#[test]
fn calls_are_the_same_whatever_the_number_of_workers_but_for_their_cpu_time() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let calls = |jobs: usize| {
        let folder = scratch.path().join(jobs.to_string());
        run_plan(&folder, swept(), jobs, Box::new(sim::run)).expect("the disk is fine");
        table(&folder.join("planner_calls.parquet"))
    };
    let [one, three] = [1, 3].map(calls);
    let outcomes = |rows: &[Vec<String>]| rows.iter().map(|row| row[..row.len() - 1].to_vec()).collect::<Vec<_>>();
    assert_eq!(one.0.last().map(String::as_str), Some("cpu_query_s"));
    assert_eq!((&one.0, outcomes(&one.1)), (&three.0, outcomes(&three.1)));
    let cpu = one.1.iter().map(|row| row[row.len() - 1].parse::<f64>().expect("it is measured"));
    assert!(cpu.clone().all(|cpu| cpu >= 0.0) && cpu.sum::<f64>() > 0.0);
}

#[test]
fn differences_of_counts_do_not_wrap() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_plan(scratch.path(), swept(), 2, Box::new(sim::run)).expect("the disk is fine");
    for file in FILES {
        let path = scratch.path().join(file);
        assert!(columns(&path, |column| column.physical_type() == Physical::INT64).len() > 5, "{file}");
        assert_eq!(columns(&path, is_unsigned), Vec::<String>::new(), "{file}");
    }
    let reader = opened(&scratch.path().join("runs.parquet"));
    let count = |row: &parquet::record::Row, name: &str| {
        let found = row.get_column_iter().find(|(column, _)| *column == name);
        match found.expect("the column is there").1 {
            Field::Long(count) => *count,
            other => panic!("{name} is {other:?}"),
        }
    };
    let rows = reader.get_row_iter(None).expect("readable").map(|row| row.expect("readable"));
    let differences: Vec<i64> = rows.map(|row| count(&row, "intact") - count(&row, "extinguished")).collect();
    assert!(differences.iter().any(|&difference| difference < 0), "{differences:?}");
    assert!(differences.iter().all(|&difference| difference > -1000), "{differences:?}");
}

#[test]
fn column_is_required_unless_some_run_has_no_value() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    // Some of the runs are done, some fail, some panic.
    run_plan(scratch.path(), plan("1..20", Record::None), 2, Box::new(made_up_run)).expect("the disk is fine");
    let path = scratch.path().join("runs.parquet");
    let required = ["scenario", "seed", "run", "status", "wall_run_s"];
    assert_eq!(columns(&path, is_required), required);
    for row in opened(&path).get_row_iter(None).expect("readable") {
        let row = row.expect("readable");
        let value = |name: &str| row.get_column_iter().find(|(column, _)| *column == name).expect("it is there").1;
        let is_done = *value("status") == Field::Str("done".into());
        assert_eq!(*value("message") == Field::Null, is_done);
        for column in ["obstacles", "winner", "truck_plans", "truck_distance_m", "cpu_run_s"] {
            assert_eq!(*value(column) == Field::Null, !is_done, "{column}");
        }
        let texts = row.get_column_iter().map(|(_, value)| value);
        assert!(texts.into_iter().all(|value| *value != Field::Str(String::new())), "nothing is null, not empty");
    }
    let states = scratch.path().join("states.parquet");
    assert_eq!(columns(&states, |column| !is_required(column)), ["planner", "policy"]);
    let calls = scratch.path().join("planner_calls.parquet");
    let optional =
        ["planner", "policy", "solution_length_m", "solution_segments", "cusps", "drive_s", "by_lattice", "found_by"];
    let may_lack = columns(&calls, |column| !is_required(column));
    let expected: Vec<&str> = optional.into_iter().chain(["cpu_query_s"]).collect();
    assert_eq!(may_lack, expected);
}

#[test]
fn swept_keys_always_have_a_value() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_plan(scratch.path(), swept(), 2, Box::new(sim::run)).expect("the disk is fine");
    for file in FILES {
        let required = columns(&scratch.path().join(file), is_required);
        assert!(
            ["field.coverage", "fire.burn_out_s"].iter().all(|key| required.contains(&(*key).to_owned())),
            "{file}"
        );
    }
}

#[test]
fn seed_beyond_the_signed_range_stays_what_it_is() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let seeds = "1,9223372036854775807,9223372036854775808,18446744073709551615";
    run_plan(scratch.path(), plan(seeds, Record::None), 2, Box::new(made_up_run)).expect("the disk is fine");
    let path = scratch.path().join("runs.parquet");
    assert_eq!(table(&path), rows(&scratch.path().join("runs.csv")));
    for file in FILES {
        assert_eq!(columns(&scratch.path().join(file), is_unsigned), ["seed"], "{file}");
    }
    let written: Vec<String> = table(&path).1.into_iter().map(|row| row[1].clone()).collect();
    assert_eq!(written.join(","), seeds);
}

#[test]
fn every_file_names_its_plan_and_its_program() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let plan = swept();
    let hash = plan.content_sha256();
    run_plan(scratch.path(), plan, 2, Box::new(sim::run)).expect("the disk is fine");
    for file in FILES {
        let reader = opened(&scratch.path().join(file));
        let metadata = reader.metadata().file_metadata().key_value_metadata().expect("there is some");
        let value = |key: &str| metadata.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.clone());
        assert_eq!(value("content_sha256"), Some(hash.clone()), "{file}");
        assert_eq!(value("program_version").as_deref(), Some(PROGRAM_VERSION), "{file}");
        assert_eq!((value("compiler").as_deref(), value("commit").as_deref()), (Some(COMPILER), COMMIT), "{file}");
    }
}
