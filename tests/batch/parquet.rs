//! The Parquet files, read back by the library that wrote them; other readers are tried where they can be installed.

use std::fs::File;
use std::path::Path;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use wildfire::batch::{BatchPlan, BatchRequest, Record, Sweep};
use wildfire::sim;

use crate::made_up::{made_up_run, plan, rows, run_plan};

/// Names of the columns, and the rows as a CSV file would write them.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let reader = SerializedFileReader::new(File::open(path).expect("the file is there")).expect("it is Parquet");
    let columns = reader.metadata().file_metadata().schema_descr().columns().iter();
    let names = columns.map(|column| column.name().to_owned()).collect();
    let written = |field: &Field| match field {
        Field::Null => String::new(),
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
        let expected = ["scenario", "seed", "run", "planner", "field.coverage", "fire.burn_out_s", next];
        assert_eq!(names[..7], expected, "{file}");
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
