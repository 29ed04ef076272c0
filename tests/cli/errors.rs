//! Bad input and bad disks: a sentence, an exit code, and nothing written.

use std::fs::File;
use std::process::Stdio;

use crate::children::end_of;
use crate::story::{Answer, Story, refuse};

#[test]
fn unknown_scenario_is_answered_with_the_known_ones() {
    let story = Story::begin();
    for command in ["run", "batch", "check"] {
        refuse(&story, &[command, "contst"], &["contst", "contest", "report-2024"]);
    }
    refuse(&story, &["scenarios", "--show", "nothing"], &["`nothing`", "contest"]);
}

#[test]
fn fault_in_a_scenario_is_shown_with_its_place() {
    let story = Story::begin();
    story.file("mine.toml", "wumpus = []\nunimog = []\n\n[fire]\nspread_radius = 30.0\n");
    for command in ["run", "batch", "check"] {
        refuse(&story, &[command, "mine.toml"], &["mine.toml:5:1", "spread_radius", "spread_radius_m"]);
    }
}

#[test]
fn fault_in_a_change_is_shown() {
    let story = Story::begin();
    refuse(&story, &["batch", "--set", "fire.burn_out=30"], &["burn_out", "burn_out_s"]);
    refuse(&story, &["batch", "--set", "fire.burn_out_s=-1"], &["burn_out_s", "-1"]);
    refuse(&story, &["run", "--set", "nonsense"], &["nonsense"]);
}

#[test]
fn seeds_that_make_no_sense_are_refused() {
    let story = Story::begin();
    refuse(&story, &["batch", "--seeds", "5..1"], &["`5..1`", "empty"]);
    refuse(&story, &["batch", "--seeds", "1,2,1"], &["seed 1", "twice"]);
    refuse(&story, &["batch", "--seeds", "1..x"], &["`1..x`", "whole numbers"]);
    refuse(&story, &["batch", "--seeds", "0..18446744073709551615"], &["too many"]);
    refuse(&story, &["run", "--seed=-1"], &["--seed"]);
}

#[test]
fn numbers_of_threads_that_make_no_sense_are_refused() {
    let story = Story::begin();
    for jobs in ["0", "-1", "two", "100000"] {
        let option = format!("--jobs={jobs}");
        refuse(&story, &["batch", &option], &["--jobs", "from 1 to 1024"]);
    }
}

#[test]
fn options_that_mean_nothing_alone_are_refused() {
    let story = Story::begin();
    refuse(&story, &["batch", "--shard", "1/2"], &["--out"]);
    refuse(&story, &["run", "--step", "0.1"], &["--trace"]);
    refuse(&story, &["batch", "--record", "some"], &["`all`", "`failed`", "`none`"]);
}

#[test]
fn steps_of_a_trace_that_make_no_sense_are_refused() {
    let story = Story::begin();
    for step in ["0", "-1", "nan", "inf", "1e-9"] {
        let option = format!("--step={step}");
        refuse(&story, &["run", "smoke", "--trace", "trace.csv", &option], &["--every", "seconds"]);
    }
}

#[test]
fn one_name_for_two_outputs_is_refused() {
    let story = Story::begin();
    refuse(&story, &["run", "smoke", "--events", "a.csv", "--trace", "a.csv"], &["a.csv", "two files"]);
}

#[test]
fn scenario_is_not_overwritten_by_an_output() {
    let story = Story::begin();
    let text = story.tell(&["scenarios", "--show", "smoke", "--all"]).expect_code(0).stdout;
    story.file("mine.toml", &text);
    refuse(&story, &["run", "mine.toml", "--events", "mine.toml"], &["mine.toml", "two files"]);
    assert_eq!(story.read("mine.toml"), text);
}

#[test]
fn folder_with_results_is_refused_without_force() {
    let story = Story::begin();
    std::fs::create_dir(story.path("out")).expect("writable");
    story.file("out/runs.csv", "precious");
    refuse(&story, &["batch", "smoke", "--out", "out"], &["out", "runs.csv", "--force"]);
    assert_eq!(story.read("out/runs.csv"), "precious");
}

#[test]
fn file_in_place_of_the_folder_is_refused() {
    let story = Story::begin();
    story.file("out", "precious");
    refuse(&story, &["batch", "smoke", "--out", "out", "--force"], &["out", "folder"]);
}

#[test]
fn places_in_no_folder_are_refused() {
    let story = Story::begin();
    story.file("file", "");
    refuse(&story, &["batch", "smoke", "--out", "file/below"], &["file/below", "expected a folder"]);
    refuse(&story, &["run", "smoke", "--events", "nowhere/e.csv"], &["nowhere/e.csv", "the folder does not exist"]);
    story.file("runs", "in the way");
    refuse(&story, &["batch", "smoke"], &["runs", "expected a folder"]);
}

#[test]
fn full_disk_under_stdout_is_the_environment() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let story = Story::begin();
    let output = end_of(story.command(&["scenarios"]).stdout(full).stderr(Stdio::piped()).spawn().expect("it starts"));
    Answer::of(&output).expect_code(3).expect_complaint(&["cannot write to stdout"]);
}

#[test]
#[cfg(target_os = "linux")]
fn output_that_cannot_be_written_costs_neither_the_result_nor_the_other_outputs() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let story = Story::begin();
    let arguments = ["run", "smoke", "--events", "/sys/e.csv", "--trace", "trace.csv"];
    let answer =
        story.tell(&arguments).expect_code(3).expect_complaint(&["cannot write /sys/e.csv", "wrote trace.csv"]);
    assert!(answer.stdout.starts_with("smoke, seed 1: ended after"), "{}", answer.stdout);
    assert!(story.read("trace.csv").lines().count() > 1);
    let arguments = ["run", "smoke", "--events", "events.csv"];
    let output = end_of(story.command(&arguments).stdout(full).stderr(Stdio::piped()).spawn().expect("it starts"));
    Answer::of(&output).expect_code(3).expect_complaint(&["cannot write to stdout"]);
    assert!(story.read("events.csv").lines().count() > 1);
}

#[test]
fn reader_that_has_seen_enough_is_no_error() {
    let story = Story::begin();
    for arguments in [["scenarios"].as_slice(), &["check", "contest"], &["completions", "bash"]] {
        let (reader, writer) = std::io::pipe().expect("pipes are there");
        drop(reader);
        let output = end_of(story.command(arguments).stdout(writer).stderr(Stdio::piped()).spawn().expect("it starts"));
        let answer = Answer::of(&output).expect_code(0);
        assert!(answer.stderr.is_empty(), "{}", answer.stderr);
    }
}

#[test]
fn errors_have_no_colours_where_there_is_no_terminal() {
    let answer = Story::begin().tell(&["check", "contst"]).expect_code(2);
    assert!(!answer.stderr.contains('\u{1b}'), "{:?}", answer.stderr);
}

#[test]
fn negative_numbers_are_answered_with_what_was_expected() {
    let story = Story::begin();
    refuse(&story, &["run", "--seed", "-1"], &["'-1'", "from 0 to 18446744073709551615"]);
    refuse(&story, &["run", "smoke", "--trace", "t.csv", "--every", "-1"], &["--every is -1", "at least 0.001"]);
    refuse(&story, &["batch", "--seeds", "-1"], &["`-1`", "whole numbers from 0"]);
    refuse(&story, &["batch", "--jobs", "-1"], &["'-1'", "from 1 to 1024"]);
}

#[test]
fn line_of_megabytes_is_shown_in_part() {
    let story = Story::begin();
    let name = "x".repeat(250_000);
    story.file("name.toml", &format!("wumpus = []\nunimog = []\nname = \"{name}\"\n"));
    story.file("field.toml", &format!("wumpus = []\nunimog = []\n{name} = 1\n"));
    story.file("list.toml", &format!("unimog = []\nignition = [{}]\n", "{ at_s = 1, random = 1 },".repeat(10_000)));
    story.file("map.txt", &format!("..#\n{}é\n", ".".repeat(100_000)));
    story.file("map.toml", "wumpus = []\nunimog = []\nfield.map = \"map.txt\"\n");
    for (file, fragment) in [
        ("name.toml", "name.toml:3:8"),
        ("field.toml", "field.toml:3:1"),
        ("list.toml", "list.toml:1:1"),
        ("map.toml", "map.txt:2:100001"),
    ] {
        let answer = story.tell(&["check", file]).expect_code(2).expect_complaint(&[fragment]);
        assert!(answer.stderr.len() < 3000, "{file}: {} bytes\n{:.3000}", answer.stderr.len(), answer.stderr);
    }
}

#[test]
fn one_file_by_two_names_is_refused_for_two_outputs() {
    let story = Story::begin();
    refuse(&story, &["run", "smoke", "--events", "a.csv", "--trace", "./a.csv"], &["a.csv", "two files"]);
}

#[test]
fn recording_stays_in_its_folder_whatever_the_scenario_is_called() {
    let story = Story::begin();
    std::fs::create_dir_all(story.path("in/out")).expect("writable");
    for name in ["../../mine", "a/b"] {
        let change = format!("name={name}");
        story.tell(&["run", "smoke", "--set", &change, "--out", "in/out"]).expect_code(0);
    }
    assert_eq!(story.entries(), ["in"]);
    assert_eq!(std::fs::read_dir(story.path("in/out")).expect("it is there").count(), 2);
}

#[test]
fn batch_that_replaces_another_leaves_none_of_its_recordings() {
    let story = Story::begin();
    let batch = |more: &[&str]| story.tell(&[&["batch", "smoke", "--out", "out"], more].concat()).expect_code(0);
    batch(&["--seeds", "1..3", "--record", "all"]);
    batch(&["--seeds", "2", "--record", "all", "--force"]);
    let recordings = std::fs::read_dir(story.path("out/recordings")).expect("it is there");
    let names: Vec<_> = recordings.map(|entry| entry.expect("readable").file_name()).collect();
    assert_eq!(names, ["seed-2.wildfire"]);
}

#[test]
fn batch_of_failures_says_why_the_first_failed() {
    let story = Story::begin();
    let answer = story.tell(&["batch", "smoke", "--set", "field.start_clearance_m=300"]).expect_code(1);
    assert!(answer.stdout.contains("The first of these, seed 1: no placement left"), "{}", answer.stdout);
}
