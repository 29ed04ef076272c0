//! Runs that would take more memory than their limit, and what the program says of memory beforehand.

use std::fs;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use super::story::{Answer, Story};
use crate::children::end_of;

/// Writes a scenario with `count` trucks in a grid, and five fires.
fn trucks(count: usize, size_m: f64, rest_of_truck: &str) -> String {
    let mut text = format!("duration_s = 60\nwumpus = []\n[field]\nsize_m = {size_m}\nstart_clearance_m = 1\n");
    text += "coverage = 0.02\n[[ignition]]\nat_s = 1\nrandom = 5\n";
    let across = (count as f64).sqrt().ceil() as usize;
    let place = |number: usize| size_m * (number as f64 + 0.5) / across as f64;
    for number in 0..count {
        let (x, y) = (place(number % across), place(number / across));
        text += &format!("[[unimog]]\nstart = {{ x_m = {x:.1}, y_m = {y:.1}, heading_deg = 0.0 }}\n{rest_of_truck}\n");
    }
    text
}

/// The most memory that a process held, as the kernel counts it, and its answer. It is looked at every millisecond, so
/// that what is taken in the last one may be missed.
#[cfg(target_os = "linux")]
#[expect(clippy::disallowed_methods, reason = "another process is at work meanwhile")]
fn peak_bytes(mut command: Command) -> (u64, Answer) {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be started");
    let status = format!("/proc/{}/status", child.id());
    let wait = thread::spawn(|| end_of(child));
    let mut peak = 0;
    while !wait.is_finished() {
        let status = fs::read_to_string(&status).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(1024 * kilobytes.unwrap_or(0));
        thread::sleep(Duration::from_millis(1));
    }
    (peak, Answer::of(&wait.join().expect("it was waited for")))
}

/// Reads the bytes that a run needs in any case from what `check` says.
fn estimated_bytes(story: &Story, scenario: &[&str]) -> u64 {
    let check = story.tell(&[&["check", "--all"], scenario].concat());
    let line = check
        .stdout
        .lines()
        .find(|line| line.contains("in total; the limit of a run is"))
        .unwrap_or_else(|| panic!("{}", check.stdout));
    let mut parts = line.split_whitespace();
    let number: f64 = parts.next().and_then(|number| number.parse().ok()).expect("a number");
    let units = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("TB", 1e12)];
    let unit = parts.next().and_then(|unit| units.iter().find(|(name, _)| *name == unit)).expect("a unit").1;
    (number * unit) as u64
}

#[cfg(target_os = "linux")]
#[test]
fn a_hundred_large_pose_roadmaps_are_refused_before_they_are_made() {
    let story = Story::begin();
    story.file("roadmaps.toml", &trucks(100, 250.0, "prm_rs = { samples = 100000, neighbours = 100 }"));
    let check = story.tell(&["check", "roadmaps.toml"]).expect_code(2);
    let check = check.expect_complaint(&["a run would be refused", "the limit is 2 GB"]).stdout;
    assert!(check.contains("No run can start") && check.contains("in total; the limit of a run is 2 GB"), "{check}");
    let (peak, run) = peak_bytes(story.command(&["run", "roadmaps.toml"]));
    let fragments =
        ["GB of memory", "for the planners of 100 trucks (prm-rs); the limit is 2 GB", "--memory sets another"];
    run.expect_code(1).expect_complaint(&fragments);
    assert!(peak < 100_000_000, "{peak}");
}

#[cfg(target_os = "linux")]
#[test]
fn twelve_lattice_trucks_on_five_kilometres_are_refused_before_they_flood() {
    let story = Story::begin();
    story.file("floods.toml", &trucks(12, 5000.0, "planner = \"lattice\""));
    let (peak, run) = peak_bytes(story.command(&["run", "floods.toml"]));
    run.expect_code(1).expect_complaint(&["for the floods of 12 trucks (lattice); the limit is 2 GB"]);
    assert!(peak < 100_000_000, "{peak}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_hundred_trucks_hold_less_than_check_says_and_are_refused_where_they_may_not() {
    let story = Story::begin();
    story.file("many.toml", &trucks(100, 125.0, ""));
    let needed = estimated_bytes(&story, &["many.toml"]);
    let (peak, run) = peak_bytes(story.command(&["run", "many.toml"]));
    run.expect_code(0);
    assert!(peak < needed && peak > 5_000_000, "{peak} of {needed}");
    let less = format!("{}kB", needed / 1_100);
    let refused = story.tell(&["run", "many.toml", "--memory", &less]);
    refused.expect_code(1).expect_complaint(&["for the planners of 100 trucks (prm-rs); the limit is"]);
}

#[cfg(target_os = "linux")]
#[test]
fn no_run_holds_more_than_was_estimated() {
    let story = Story::begin();
    let cases = [
        "contest",
        "dense",
        "fleet",
        "local-minima",
        "contest --set unimog.planner=prm+primitives --set unimog.prm.samples=5000",
        "contest --set unimog.prm_rs.samples=3000",
        "dense --set unimog.planner=hybrid-astar",
        "dense --set unimog.planner=lattice --set duration_s=300",
        "contest --set field.size_m=1000 --set duration_s=200",
        "wumpus-alone --set field.size_m=5000 --set duration_s=200",
        "wumpus-alone --set wumpus.planner=wavefront --set wumpus.lattice_m=0.5 --set duration_s=60",
        "wumpus-alone --set wumpus.planner=potential --set wumpus.lattice_m=0.5 --set duration_s=60",
    ];
    for case in cases {
        let scenario: Vec<&str> = case.split(' ').collect();
        // Drives are easy here, so that hardly anything grows.
        let needed = estimated_bytes(&story, &scenario);
        let (peak, run) = peak_bytes(story.command(&[&["run"], &scenario[..]].concat()));
        run.expect_code(0);
        assert!(peak < needed && peak > 5_000_000, "{case} held {peak} of {needed}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_hundred_equal_wumpuses_take_little_more_than_one() {
    let story = Story::begin();
    let write = |name: &str, count: usize, rest: &str| {
        let mut text = "duration_s = 20\nunimog = []\n[field]\nsize_m = 4000\n".to_owned();
        for number in 0..count {
            text += &format!("[[wumpus]]\nstart_m = [{}, 2002.5]\n{rest}\n", 37.5 + 35.0 * number as f64);
        }
        story.file(name, &text);
        estimated_bytes(&story, &[name])
    };
    let (one, hundred) = (write("one.toml", 1, ""), write("hundred.toml", 100, ""));
    assert!(hundred < one + 60_000_000, "{one} for one, {hundred} for a hundred");
    let (peak, run) = peak_bytes(story.command(&["run", "hundred.toml"]));
    run.expect_code(0);
    assert!(peak < hundred && peak > 5_000_000, "{peak} of {hundred}");
    // Lattices that begin at their own starts are a hundred.
    let separate = write("own.toml", 100, "lattice_m = 5.0");
    assert!(separate > 20 * one, "{separate} for a hundred lattices, {one} for one");
    let refused = story.tell(&["run", "own.toml"]).expect_code(1);
    refused.expect_complaint(&["for the planners of Wumpuses; the limit is 2 GB"]);
}

#[test]
fn a_variant_that_needs_too_much_is_a_failed_row_and_the_others_are_done() {
    let story = Story::begin();
    let sweep = "unimog.prm_rs.samples=50,100000";
    let batch = ["batch", "smoke", "--seeds", "1..2", "--memory", "500MB", "--out", "out", "--jobs", "2"];
    let answer = story.tell(&[&batch[..], &["--set", sweep, "--set", "unimog.prm_rs.neighbours=100"]].concat());
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    let rows = story.read("out/runs.csv");
    let statuses: Vec<bool> =
        rows.lines().skip(1).map(|row| row.contains("failed") && row.contains("of memory")).collect();
    assert_eq!(statuses, [false, false, true, true], "{rows}");
    assert!(rows.contains("for the planner of a truck (prm-rs); the limit is 500 MB"), "{rows}");
    assert!(story.read("out/plan.json").contains("\"memory_bytes\": 500000000"));
    let audit = story.tell(&["audit", "out"]);
    assert_eq!(audit.code, Some(0), "{}{}", audit.stdout, audit.stderr);
    assert!(audit.stdout.contains("2 more could not be run"), "{}", audit.stdout);
    let resumed = story.tell(&["batch", "--resume", "out", "--memory", "4GB"]);
    assert_eq!(resumed.code, Some(2), "the limit is part of the plan: {}", resumed.stderr);
}

#[test]
fn memory_raises_the_limit_and_changes_no_outcome() {
    let story = Story::begin();
    let outcome = |memory: &[&str]| {
        let answer = story.tell(&[&["run", "smoke", "--json"], memory].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        let outcome: serde_json::Value = serde_json::from_str(&answer.stdout).expect("it is JSON");
        let mut run = outcome["run"].as_object().expect("the run is an object").clone();
        run.retain(|name, _| !(name.starts_with("cpu_") || name.starts_with("wall_")));
        run
    };
    assert_eq!(story.tell(&["run", "smoke", "--memory", "10MB"]).code, Some(1));
    let usual = outcome(&[]);
    assert!(usual.contains_key("extinguished"), "{usual:?}");
    assert_eq!(outcome(&["--memory", "100MiB"]), usual);
    assert_eq!(outcome(&["--memory", "64 gib"]), usual);
}

#[test]
fn a_run_that_comes_to_its_limit_on_the_way_fails() {
    let story = Story::begin();
    let scenario = ["dense", "--set", "unimog.planner=hybrid-astar"];
    let limit = format!("{}kB", estimated_bytes(&story, &scenario) / 1_000 + 100);
    let run = story.tell(&[&["run"], &scenario[..], &["--seed", "3", "--memory", &limit]].concat());
    assert_eq!(run.stdout, "");
    run.expect_code(1).expect_complaint(&["it reached the memory limit", "for searches; --memory"]);
}

#[test]
fn every_command_that_simulates_has_the_limit() {
    let story = Story::begin();
    for command in [
        &["run", "smoke"][..],
        &["batch", "smoke", "--seeds", "1", "--out", "out"],
        &["render", "smoke", "-o", "still.png"],
        &["plan", "--goals", "1"],
    ] {
        let refused = story.tell(&[command, &["--memory", "10MB"]].concat());
        assert_eq!(refused.code, Some(1), "{command:?}: {}{}", refused.stdout, refused.stderr);
        let wrong = story.tell(&[command, &["--memory", "10"]].concat());
        assert_eq!(wrong.code, Some(2), "{command:?}: {}", wrong.stderr);
        assert!(wrong.stderr.contains("such as 2GB, 512MiB or 4G"), "{command:?}: {}", wrong.stderr);
    }
    assert!(story.read("out/runs.csv").contains("the limit is 10 MB"));
    story.file("plan.toml", "scenarios = [\"smoke\"]\nmemory = \"2\"\n");
    let wrong = story.tell(&["batch", "plan.toml"]);
    assert!(wrong.code == Some(2) && wrong.stderr.contains("`memory` is \"2\""), "{}", wrong.stderr);
}
