//! `wildfire export`: runs in the forms that other tools read.

use std::fs;

use serde_json::Value as Json;

use crate::story::{Story, refuse};

fn object(story: &Story, arguments: &[&str]) -> Json {
    let args = [&["export"], arguments, &["--format", "json", "-o", "-"]].concat();
    let answer = story.tell(&args).expect_code(0);
    serde_json::from_str(&answer.stdout).expect("it is JSON")
}

#[test]
fn outcome_of_the_object_is_that_of_the_run() {
    let story = Story::begin();
    for (scenario, seed) in [("smoke", "7"), ("fleet", "2"), ("windy", "1")] {
        let short = ["--set", "duration_s=200", "--seed", seed];
        let run = story.tell(&[&["run", scenario, "--json"], &short[..]].concat()).expect_code(0);
        let run: Json = serde_json::from_str(&run.stdout).expect("it is JSON");
        let export = object(&story, &[&[scenario], &short[..]].concat());
        assert_eq!(export["winner"], run["run"]["winner"]);
        let outcome = export["outcome"].as_object().expect("it is an object");
        let mut shared = 0;
        for (name, value) in outcome.iter().filter(|(name, _)| run["run"].get(name.as_str()).is_some()) {
            assert_eq!(value, &run["run"][name], "{name} of {scenario}");
            shared += 1;
        }
        assert!(shared > 15, "only {shared} numbers have the names of columns");
        let agents = run["agents"].as_array().expect("a list");
        assert_eq!(export["outcome"]["agents"].as_array().expect("a list").len(), agents.len());
        for (found, expected) in export["outcome"]["agents"].as_array().expect("a list").iter().zip(agents) {
            for (name, value) in found.as_object().expect("an object") {
                if let Some(expected) = expected.get(name) {
                    assert_eq!(value, expected, "{name} of {} of {scenario}", found["agent"]);
                }
            }
        }
    }
}

#[test]
fn scenario_recording_and_batch_give_the_same_files() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "7", "--out", "run.wildfire"]).expect_code(0);
    story.tell(&["batch", "smoke", "--seeds", "3,7", "--out", "batch"]).expect_code(0);
    let sources: [&[&str]; 3] = [&["smoke", "--seed", "7"], &["run.wildfire"], &["batch", "--seed", "7"]];
    for ending in ["json", "npz", "mcap"] {
        let mut files = Vec::new();
        for source in sources {
            let name = format!("out.{ending}");
            story.tell(&[&["export"], source, &["-o", &name]].concat()).expect_code(0).expect_complaint(&[&name]);
            files.push(fs::read(story.path(&name)).expect("it was written"));
        }
        assert!(files[0] == files[1] && files[0] == files[2], "{ending} files differ");
    }
}

#[test]
fn tables_are_those_of_a_run() {
    let story = Story::begin();
    let tables = ["--events", "events.csv", "--trace", "trace.csv", "--step", "2", "--agent", "unimog/0"];
    story.tell(&[&["run", "smoke", "--seed", "7"], &tables[..]].concat()).expect_code(0);
    let export = ["export", "smoke", "--seed", "7", "-o", "out.csv", "--step", "2", "--agent", "unimog/0"];
    story.tell(&export).expect_code(0);
    assert_eq!(story.read("out-events.csv"), story.read("events.csv"));
    assert_eq!(story.read("out-trace.csv"), story.read("trace.csv"));
    let agents = story.read("trace.csv");
    assert!(agents.lines().skip(1).all(|line| line.contains(",unimog/0,")) && agents.lines().count() > 10);
    assert!(!story.path("out.csv").exists());
}

#[test]
fn searches_are_there_where_they_are_asked_for() {
    let story = Story::begin();
    let count = |run: &Json| {
        let events = run["events"].as_array().expect("a list").iter();
        events.filter(|event| event["event"] == "searched").count()
    };
    assert_eq!(count(&object(&story, &["smoke"])), 0);
    assert!(count(&object(&story, &["smoke", "--record-searches"])) > 0);
}

#[test]
fn object_has_the_members_of_its_schema() {
    let story = Story::begin();
    let schema: Json = serde_json::from_str(&story.tell(&["schema", "export"]).expect_code(0).stdout).expect("JSON");
    let run = object(&story, &["smoke"]);
    let required: Vec<&str> = schema["required"].as_array().expect("a list").iter().filter_map(Json::as_str).collect();
    let members: Vec<&String> = run.as_object().expect("an object").keys().collect();
    assert!(members.iter().all(|name| required.contains(&name.as_str())), "{members:?}, {required:?}");
    assert_eq!(members.len(), required.len());
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    refuse(&story, &["export", "smoke", "-o", "run.xml"], &["run.xml", "expected a name that ends in .json, .csv"]);
    refuse(&story, &["export", "smoke", "-o", "run"], &["expected a name that ends in .json"]);
    refuse(&story, &["export", "smoke", "-o", "-"], &["- (stdout) has no ending", "--format json"]);
    refuse(&story, &["export", "smoke", "--format", "csv", "-o", "-"], &["two tables"]);
    refuse(&story, &["export", "smoke", "--format", "npz", "-o", "run.json"], &["run.json", ".npz"]);
    refuse(&story, &["export", "smoke", "-o", "run.json", "--step", "1"], &["--every applies to samples"]);
    refuse(&story, &["export", "smoke", "-o", "run.json", "--agent", "unimog/0"], &["--agent applies to samples"]);
    refuse(&story, &["export", "smoke", "-o", "run.npz", "--step", "0"], &["expected seconds, at least 0.001"]);
    let stranger = "there is no unimog/9 in this run, only wumpus/0";
    refuse(&story, &["export", "run.wildfire", "-o", "run.npz", "--agent", "unimog/9"], &[stranger]);
    refuse(&story, &["export", "run.wildfire", "-o", "run.mcap", "--agent", "unimog/9"], &[stranger]);
    refuse(&story, &["export", "run.wildfire", "-o", "x.csv", "--agent", "unimog/9"], &[stranger]);
    refuse(&story, &["export", "run.wildfire", "--seed", "3", "-o", "run.npz"], &["expected no seed"]);
    refuse(&story, &["export", "nothing.wildfire", "-o", "run.npz"], &["nothing.wildfire does not exist"]);
    let trace = ["run", "smoke", "--trace", "trace.csv", "--agent", "unimog/9"];
    refuse(&story, &trace, &["--agent names unimog/9", "expected unimog/N with N below that"]);
}
