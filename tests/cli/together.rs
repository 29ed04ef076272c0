//! `wildfire plan --together` and `wildfire judge --together`: solutions that are found pass the check, foreign ones are
//! judged, and what is no instance is refused.

use std::fs;
use std::io::Read;

use flate2::read::GzDecoder;
use serde_json::Value;

use crate::reference::{bundled, larger};
use crate::story::{Story, refuse};

const CROSSING: &str = "agents:\n\
    - {name: a, start: [4, 15, 0], goal: [26, 15, 0]}\n\
    - {name: b, start: [26, 15, 3.14], goal: [4, 18, 3.14]}\n\
    - {name: c, start: [15, 4, -1.57], goal: [15, 26, -1.57]}\n\
    map:\n  dimensions: [30, 30]\n  obstacles:\n    - [15, 10.5]\n";

fn solve(story: &Story, options: &[&str]) -> Value {
    let answer = story.tell(&[&["plan", "--together"], options, &["--json"]].concat()).expect_code(0);
    serde_json::from_str(&answer.stdout).expect("one object")
}

#[test]
fn what_is_planned_passes_the_judge_and_what_is_changed_does_not() {
    let story = Story::begin();
    story.file("crossing.yaml", CROSSING);
    for mode in ["benchmark", "exact"] {
        let report = solve(&story, &["crossing.yaml", "--mode", mode, "--yaml", mode, "--polish", "2"]);
        assert_eq!((&report["rows"][0]["status"], &report["rows"][0]["violations"]), (&"solved".into(), &0.into()));
        let solution = format!("{mode}/crossing.yaml");
        let judge = ["judge", "--together", "crossing.yaml", &solution, "--mode", mode];
        story.tell(&judge).expect_code(0);
        let text = story.read(&solution);
        story.file(&solution, &text.replacen("x: 4\n", "x: 5\n", 1));
        story.tell(&judge).expect_code(4);
    }
}

#[test]
fn what_is_no_instance_is_refused() {
    let story = Story::begin();
    story.file("crossing.yaml", CROSSING);
    story.file("bad.yaml", &CROSSING.replace("[4, 15, 0]", "[4, 15]"));
    refuse(&story, &["plan", "--together", "bad.yaml"], &["bad.yaml", "start", "3"]);
    refuse(&story, &["plan", "--together", "none.yaml"], &["none.yaml", "does not exist"]);
    refuse(&story, &["plan", "--together", "crossing.yaml", "--yaml", "."], &["an instance and a solution"]);
    refuse(&story, &["plan", "--together", "crossing.yaml", "--goals", "3"], &["--together", "--goals"]);
    refuse(&story, &["judge", "--together", "crossing.yaml", "crossing.yaml"], &["crossing.yaml", "schedule"]);
}

/// Files of the benchmark, if they are there: their names in the archive and their texts.
fn reference_instances() -> Vec<(String, Vec<u8>)> {
    let Some(archive) = larger("clmapf/instances.tar.gz") else { return Vec::new() };
    let packed = fs::read(archive).expect("it can be read");
    let mut bytes = Vec::new();
    GzDecoder::new(&packed[..]).read_to_end(&mut bytes).expect("an archive");
    let mut rest = &bytes[..];
    let mut files = Vec::new();
    // Blocks of 512 bytes: a header with the name and, in octal digits at 124, the size; then the file.
    while let Some(header) = rest.first_chunk::<512>().filter(|header| header[0] != 0) {
        let word =
            |from: usize, to: usize| String::from_utf8_lossy(&header[from..to]).trim_matches(['\0', ' ']).to_owned();
        let size = usize::from_str_radix(&word(124, 136), 8).expect("octal digits");
        files.push((word(0, 100), rest[512..512 + size].to_vec()));
        rest = &rest[512 + size.div_ceil(512) * 512..];
    }
    files
}

/// Others say how long all drives are at least; at starts and goals nothing touches.
#[test]
fn instances_are_solved_and_bounded_as_others_say() {
    let story = Story::begin();
    let mut bounds = csv::Reader::from_path(bundled("clmapf/bounds.csv")).expect("it can be read");
    for row in bounds.records().map(|row| row.expect("a row")) {
        let instance = bundled(&format!("clmapf/{}", &row[0])).display().to_string();
        let bound_m: f64 = row[1].parse().expect("a number");
        for mode in ["benchmark", "exact"] {
            let report = solve(&story, &[&instance, "--mode", mode]);
            let row = &report["rows"][0];
            assert!(row["status"] == "solved" && row["violations"] == 0, "{row}");
            let number = |name: &str| row[name].as_f64().expect("a number");
            let found_m = number("flowtime_m") / number("flowtime_over_bound");
            assert!((found_m - bound_m).abs() < 1e-6, "{instance}: {found_m}, not {bound_m}");
        }
    }
}

#[test]
fn instances_of_the_benchmark_are_solved_without_a_violation() {
    let files = reference_instances();
    let story = Story::begin();
    let wanted = |name: &str| name.ends_with("_ex18.yaml") && !name.contains("map300by300");
    let mut names = Vec::new();
    for (name, text) in files.iter().filter(|(name, _)| wanted(name)).take(16) {
        let name = name.rsplit('/').next().expect("a name");
        fs::write(story.path(name), text).expect("the scratch folder is writable");
        names.push(name);
    }
    if names.is_empty() {
        return;
    }
    for mode in ["benchmark", "exact"] {
        let report = solve(&story, &[&names[..], &["--mode", mode]].concat());
        for row in report["rows"].as_array().expect("rows") {
            assert!(row["status"] != "unsolved" && row["violations"] == 0, "{row}");
            assert!(row["status"] == "blocked" || row["flowtime_over_bound"].as_f64() < Some(1.3), "{row}");
        }
    }
}
