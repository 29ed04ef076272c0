//! Forks and the worth of decisions, from the command line.

use std::fs::{self, File};
use std::path::Path;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Row;
use serde_json::Value;

use crate::story::{Story, refuse};

#[test]
fn a_fork_that_changes_nothing_is_its_parent_and_one_from_the_start_the_changed_run() {
    let story = Story::begin();
    let fleet = ["fleet", "--seed", "4", "--set", "duration_s=250"];
    let bytes = |name: &str| fs::read(story.path(name)).expect("it was written");
    let fork = |more: &[&str]| story.tell(&[&["fork"], &fleet[..], more].concat()).expect_code(0).stdout;
    let same = fork(&["--at", "120", "--out", "same.wildfire", "--parent", "parent.wildfire"]);
    assert!(same.trim_end().ends_with("as many as without the change."), "{same}");
    let run = |more: &[&str]| story.tell(&[&["run"], &fleet[..], more].concat()).expect_code(0);
    run(&["--out", "run.wildfire"]);
    assert!(bytes("same.wildfire") == bytes("run.wildfire"));
    assert!(bytes("parent.wildfire") == bytes("run.wildfire"));
    let change = "dispatch.policy=nearest-savable";
    fork(&["--at", "0", "--then", change, "--out", "from-start.wildfire"]);
    run(&["--set", change, "--out", "changed.wildfire"]);
    assert!(bytes("from-start.wildfire") == bytes("changed.wildfire"));
    fork(&["--at", "120", "--then", change, "--then", "unimog.planner=hybrid-astar", "--out", "midway.wildfire"]);
    assert!(bytes("midway.wildfire") != bytes("run.wildfire"));
    story.tell(&["audit", "midway.wildfire"]).expect_code(0);
}

#[test]
fn what_cannot_be_forked_so_is_refused_with_its_name() {
    let story = Story::begin();
    let fork = |more: &[&'static str]| [&["fork", "smoke", "--seed", "1"], more].concat();
    refuse(&story, &fork(&["--at", "50", "--then", "field.coverage=0.2"]), &["`field.coverage` cannot change"]);
    refuse(&story, &fork(&["--at", "50", "--then", "unimog.0.speed_mps=5"]), &["`unimog.0.speed_mps` cannot change"]);
    refuse(&story, &fork(&["--at", "50", "--then", "wumpus.speed_mps=1"]), &["`wumpus.0.speed_mps` cannot change"]);
    let late = story.tell(&fork(&["--at", "99999"])).expect_code(0);
    assert!(late.stderr.contains("--at is 99999.000 s, but the run ends at"), "{}", late.stderr);
    assert!(late.stdout.ends_with("as many as without the change.\n"), "{}", late.stdout);
    refuse(&story, &fork(&["--at", "50", "--answer", "unimog/7=1,1"]), &["--answer names unimog/7"]);
    refuse(&story, &fork(&["--at", "50", "--answer", "unimog/0=0,0"]), &["which it could not go for"]);
    refuse(&story, &fork(&["--at", "50", "--answer", "unimog"]), &["expected AGENT=COLUMN,ROW"]);
    refuse(&story, &["why", "smoke", "--agent", "unimog/7"], &["--agent names unimog/7"]);
}

#[test]
fn the_worth_of_decisions_does_not_depend_on_threads_and_forks_are_its_futures() {
    let story = Story::begin();
    let why = ["why", "contest", "--seed", "7", "--set", "duration_s=300", "--sample", "4", "--futures", "8", "--json"];
    let one = story.tell(&[&why[..], &["--jobs", "1"]].concat()).expect_code(0).stdout;
    let two = story.tell(&[&why[..], &["--jobs", "2"]].concat()).expect_code(0).stdout;
    assert_eq!(one, two);
    let report: Value = serde_json::from_str(&one).expect("JSON");
    let decisions = report["decisions"].as_array().expect("a list");
    assert_eq!(decisions.len(), 4);
    for decision in decisions {
        let others = decision["others"].as_array().expect("a list");
        assert!(!others.is_empty() && others.len() < 5, "{decision}");
        for other in others {
            let gains: Vec<f64> = other["gains"]
                .as_array()
                .expect("a list")
                .iter()
                .map(|gain| gain.as_f64().expect("a number"))
                .collect();
            let mean = gains.iter().sum::<f64>() / gains.len() as f64;
            assert!((other["mean"].as_f64().expect("a number") - mean).abs() < 1e-9, "{other}");
            assert!(other["cell"] != decision["chosen"] && gains.len() <= 8, "{other}");
        }
    }
}

#[test]
fn verdicts_are_marked_in_pages_and_pictures_of_their_run_only() {
    let story = Story::begin();
    let smoke = ["contest", "--seed", "7", "--set", "duration_s=200"];
    let worth =
        story.tell(&[&["why"], &smoke[..], &["--sample", "3", "--futures", "4", "--json"]].concat()).expect_code(0);
    fs::write(story.path("worth.json"), worth.stdout).expect("writable");
    let render = |more: &[&str]| story.tell(&[&["render"], &smoke[..], more].concat()).expect_code(0);
    render(&["--out", "plain.png", "--page", "plain.html"]);
    render(&["--why", "worth.json", "--out", "marked.png", "--page", "marked.html"]);
    for name in ["png", "html"] {
        let [plain, marked] =
            ["plain", "marked"].map(|stem| fs::read(story.path(&format!("{stem}.{name}"))).expect("it was written"));
        assert!(plain != marked, "{name}");
    }
    let other = ["render", "contest", "--seed", "8", "--why", "worth.json", "--out", "x.png"];
    refuse(&story, &other, &["worth.json is about seed 7 of contest; expected seed 8 of contest"]);
    fs::write(story.path("other.json"), "{}").expect("writable");
    let no_worth = ["render", "contest", "--seed", "7", "--why", "other.json", "--out", "x.png"];
    refuse(
        &story,
        &no_worth,
        &["other.json: missing field `scenario`", "expected the output of `wildfire why --format json`"],
    );
}

#[test]
fn decisions_of_a_batch_are_a_table_with_a_row_for_each_choice() {
    let story = Story::begin();
    let sweep = ["--set", "dispatch.policy=nearest,auction", "--set", "duration_s=120"];
    let batch = [&["batch", "fleet", "--seeds", "1..2", "--why", "2", "--out", "judged"], &sweep[..]].concat();
    let printed = story.tell(&batch).expect_code(0).stdout;
    assert!(printed.contains("What decisions were worth"), "{printed}");
    let table = || fs::read(story.path("judged/decisions.parquet")).expect("it was written");
    let first = table();
    assert!(first.starts_with(b"PAR1") && first.windows(10).any(|bytes| bytes == b"is_mistake"));
    let again = story.tell(&["why", "judged", "--sample", "2", "--json"]).expect_code(0).stdout;
    let again: Value = serde_json::from_str(&again).expect("JSON");
    let variants = again["variants"].as_array().expect("a list");
    assert_eq!(variants.len(), 2);
    assert!(variants.iter().all(|variant| variant["runs"] == 2 && variant["decisions"] == 4), "{again}");
    assert!(table() == first, "the same decisions have the same worth");
    // One run of the batch is judged as that of its scenario.
    let one = story.tell(&["why", "judged", "--seed", "2", "--sample", "1", "--futures", "4", "--json"]).expect_code(0);
    let one: Value = serde_json::from_str(&one.stdout).expect("JSON");
    assert_eq!((&one["scenario"], &one["seed"]), (&Value::from("fleet"), &Value::from(2)));
    // It is forked so too.
    let fork =
        |source: &[&str]| story.tell(&[&["fork"], source, &["--seed", "2", "--at", "60"]].concat()).expect_code(0);
    let (of_batch, of_scenario) = (fork(&["judged"]), fork(&["fleet", "--set", "duration_s=120"]));
    assert_eq!(of_batch.stdout.lines().last(), of_scenario.stdout.lines().last());
    assert!(of_batch.stderr.contains("using the first, fleet"), "{}", of_batch.stderr);
    let change = ["fork", "judged", "--seed", "2", "--at", "60", "--then", "dispatch.policy=auction"];
    refuse(&story, &change, &["judged is a finished run; expected a scenario if values are changed"]);
}

/// The rows of one seed, without the number of the run, which depends on how many there are.
fn decisions_of_seed_1(path: &Path) -> Vec<String> {
    let table = SerializedFileReader::new(File::open(path).expect("the file is there")).expect("it is Parquet");
    let row = |row: Row| {
        let fields = row.get_column_iter().filter(|(name, _)| *name != "run");
        fields.map(|(name, field)| format!("{name}: {field}")).collect::<Vec<_>>().join(", ")
    };
    let rows = table.get_row_iter(None).expect("readable").map(|found| row(found.expect("readable")));
    rows.filter(|row| row.contains("seed: 1,")).collect()
}

#[test]
#[ignore = "tier 2: decisions of 16 runs"]
fn credit_bench_is_three_batches_whose_decisions_the_shipped_sample_has() {
    let story = Story::begin();
    story.tell(&["why", "--bench", "credit", "--seeds", "1..1", "--decisions", "2"]).expect_code(0);
    for (part, scenarios) in [("solo", 2), ("fleet", 1), ("duel", 1)] {
        let folder = story.path("credit").join(part);
        let rows = fs::read_to_string(folder.join("runs.csv")).expect("it was written");
        assert_eq!(rows.lines().count(), 1 + 4 * scenarios, "two ways of choosing fires, two arsonists");
        let made = decisions_of_seed_1(&folder.join("decisions.parquet"));
        let sample = format!("{}/assets/credit/sample/{part}/decisions.parquet", env!("CARGO_MANIFEST_DIR"));
        assert!(made.len() > 8 * scenarios, "{}", made.len());
        assert_eq!(made, decisions_of_seed_1(Path::new(&sample)), "{part}");
    }
}

#[test]
fn a_recording_is_not_judged_for_it_does_not_hold_its_scenario() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "1", "--out", "run.wildfire"]).expect_code(0);
    refuse(&story, &["fork", "run.wildfire", "--at", "5"], &["run.wildfire is a recording"]);
    refuse(&story, &["why", "run.wildfire"], &["run.wildfire is a recording, which does not hold its scenario"]);
}
