//! Forks and the worth of decisions, from the command line.

use std::fs;

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
    refuse(&story, &fork(&["--at", "99999"]), &["the run ends at"]);
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
