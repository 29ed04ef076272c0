//! A batch's folder in which something is not as the batch left it.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::children::{end_of, wait_until};
use crate::story::{Answer, Story};

fn replace_by_pipe(path: &Path) {
    let _ = fs::remove_file(path);
    assert!(Command::new("mkfifo").arg(path).status().expect("there is a mkfifo").success());
}

fn replace_by_loop(path: &Path) {
    let _ = fs::remove_file(path);
    std::os::unix::fs::symlink(path, path).expect("links can be made");
}

fn replace_by_device(path: &Path) {
    let _ = fs::remove_file(path);
    std::os::unix::fs::symlink("/dev/zero", path).expect("links can be made");
}

fn replace_by_folder(path: &Path) {
    let _ = fs::remove_file(path);
    fs::create_dir(path).expect("writable");
}

#[test]
fn pipes_devices_loops_and_folders_among_the_files_of_a_batch_are_refused_at_once() {
    let batch = ["batch", "smoke", "--seeds", "1..2", "--record", "all", "--out"];
    let whole = ["plan.json", "runs.journal", "runs.csv", "runs.parquet", "report.html", "recordings/seed-1.wildfire"];
    let replacements: [fn(&Path); 4] = [replace_by_pipe, replace_by_loop, replace_by_device, replace_by_folder];
    let story = Story::begin();
    for (number, replace) in replacements.into_iter().enumerate() {
        for entry in whole {
            let folder = format!("{number}-{}", entry.replace('/', "-"));
            if number == 0 || entry == "plan.json" || entry == "runs.journal" {
                story.tell(&[&batch[..], &[&folder]].concat()).expect_code(0);
            } else {
                fs::create_dir_all(story.path(&folder).join("recordings")).expect("writable");
            }
            replace(&story.path(&folder).join(entry));
            for command in [
                ["batch", "--resume", &folder].as_slice(),
                &["batch", "smoke", "--out", &folder, "--force"],
                &["batch", "smoke", "--shard", "1/2", "--out", &folder],
                &["merge", &folder],
                &["status", &folder],
                &["report", &folder],
                &["compare", &folder, &folder],
                &["audit", &folder],
                &["render", &folder, "-o", "still.png"],
            ] {
                let is_batch = story.path(&folder).join("plan.json").symlink_metadata().is_ok();
                if is_batch || !matches!(command[0], "audit" | "render") {
                    story.tell(command).expect_code(2).expect_complaint(&[entry, "expected a file"]);
                }
            }
        }
    }
}

#[test]
fn links_to_files_are_files_of_a_batch() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..2", "--record", "all", "--out", "out"]).expect_code(0);
    for entry in ["plan.json", "runs.journal", "recordings/seed-1.wildfire"] {
        let (path, elsewhere) = (story.path("out").join(entry), story.path(&entry.replace('/', "-")));
        fs::rename(&path, &elsewhere).expect("it is there");
        std::os::unix::fs::symlink(&elsewhere, &path).expect("links can be made");
    }
    for command in [["batch", "--resume", "out"].as_slice(), &["status", "out"], &["audit", "out"]] {
        story.tell(command).expect_code(0);
    }
}

#[test]
fn batch_whose_folder_is_deleted_ends_and_says_so() {
    let story = Story::begin();
    let endless = ["--set", "duration_s=1000000", "--set", "fire.relight=true", "--set", "fire.burn_out_s=none"];
    let mut command =
        story.command(&[["batch", "contest", "--jobs", "1", "--out", "out"].as_slice(), &endless].concat());
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    let child = command.spawn().expect("the program can be started");
    let has = |file: &str| fs::metadata(story.path(file)).is_ok_and(|found| found.len() > 0);
    wait_until("the batch runs", || has("out/runs.journal") && has("out/machines.json"));
    fs::remove_dir_all(story.path("out")).expect("it is there");
    Answer::of(&end_of(child)).expect_code(3).expect_complaint(&["out/runs.journal", "removed or renamed"]);
}

#[test]
fn lost_recordings_are_made_again_and_named() {
    let story = Story::begin();
    let batch = ["batch", "contest", "--seeds", "1..4", "--set", "duration_s=300", "--record", "all", "--out", "out"];
    story.tell(&batch).expect_code(0);
    let recording = |seed: u64| story.path(&format!("out/recordings/seed-{seed}.wildfire"));
    let before: Vec<_> = (1..=4).map(|seed| fs::read(recording(seed)).expect("it is there")).collect();
    fs::remove_file(recording(2)).expect("it is there");
    fs::write(recording(3), "").expect("writable");
    let answer = story.tell(&["batch", "--resume", "out"]).expect_code(0);
    answer.expect_complaint(&[
        "repeating runs whose recordings are missing",
        "seed-2.wildfire (missing)",
        "seed-3.wildfire (truncated",
    ]);
    let after: Vec<_> = (1..=4).map(|seed| fs::read(recording(seed)).expect("it is there")).collect();
    assert!(after == before, "another recording");
    assert_eq!(story.tell(&["batch", "--resume", "out"]).expect_code(0).stderr, "");

    // No agent is stuck in any of these runs.
    story.tell(&["batch", "smoke", "--record", "failed", "--out", "failed"]).expect_code(0);
    assert_eq!(fs::read_dir(story.path("failed/recordings")).expect("it is there").count(), 0);
    assert_eq!(story.tell(&["batch", "--resume", "failed"]).expect_code(0).stderr, "");
}

#[test]
fn what_a_killed_batch_left_aside_is_named_when_it_goes_on() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--out", "out"]).expect_code(0);
    story.file("out/plan.json.123.part", "{");
    let fragments = ["removed files left by a killed process: out/plan.json.123.part"];
    story.tell(&["batch", "--resume", "out"]).expect_code(0).expect_complaint(&fragments);
    assert!(!story.path("out/plan.json.123.part").exists());

    fs::create_dir(story.path("begun")).expect("writable");
    story.file("begun/plan.json.123.part", "{");
    story.file("begun/runs.journal", "");
    let fragments = ["begun has no plan.json, but plan.json.123.part", "the batch had not begun", "--out"];
    story.tell(&["batch", "--resume", "begun"]).expect_code(2).expect_complaint(&fragments);
    let answer = story.tell(&["batch", "smoke", "--out", "begun"]).expect_code(0);
    answer.expect_complaint(&["removed files left by a killed process: begun/plan.json.123.part"]);
}
