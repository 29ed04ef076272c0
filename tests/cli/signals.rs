//! Signals that ask for an end: each gives an exit code, whatever the program is doing or waiting for.

use std::fs::{self, OpenOptions};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::story::{Answer, Story};

const TINY: &str = "duration_s = 60.0\nunimog = []\n[field]\nsize_m = 50.0\ncoverage = 0.1\n\
                    [[wumpus]]\nstart_m = [2.5, 2.5]\n";

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
    assert!(sent.expect("there is a kill").success());
}

fn spawn(story: &Story, arguments: &[&str]) -> Child {
    let mut command = story.command(arguments);
    let command = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program can be started")
}

fn pipe(story: &Story, name: &str) {
    let made = Command::new("mkfifo").arg(story.path(name)).status();
    assert!(made.expect("there is a mkfifo").success());
}

fn answer(child: Child) -> Answer {
    Answer::of(&child.wait_with_output().expect("it ends"))
}

/// Waits until the program catches this signal, which it does from its first statement on.
fn wait_for_handler(child: &Child, number: u32) {
    let catches = || {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("it is not waited for yet");
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).map(str::trim);
        let is_over = status.contains("\nState:\tZ");
        is_over
            || mask.is_some_and(|mask| u64::from_str_radix(mask, 16).expect("it is a mask") >> (number - 1) & 1 == 1)
    };
    while !catches() {
        thread::yield_now();
    }
}

#[expect(clippy::disallowed_methods, reason = "a moment at which nothing is known of the program is what is wanted")]
fn wait(moment: Duration) {
    thread::sleep(moment);
}

#[test]
fn signal_at_any_moment_gives_an_exit_code() {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    let (mut interrupted, mut resumable) = (0, 0);
    for (index, millis) in (0..40).flat_map(|step| [(0, step), (1, step), (2, step)]) {
        let (signal, number) = [("HUP", 1), ("INT", 2), ("TERM", 15)][index];
        let out = format!("out-{signal}-{millis}");
        let child = spawn(&story, &["batch", "tiny.toml", "--seeds", "1..100000", "--out", &out]);
        wait_for_handler(&child, number);
        wait(Duration::from_millis(millis));
        send(signal, &child);
        match answer(child).code {
            Some(130) => interrupted += 1,
            Some(75) => resumable += 1,
            other => panic!("{signal} after {millis} ms: {other:?}"),
        }
    }
    assert!(interrupted > 0 && resumable > 0, "{interrupted} before the batches began, {resumable} while they ran");
}

#[test]
fn first_signal_ends_a_wait_for_a_pipe() {
    for arguments in [
        ["check", "pipe"].as_slice(),
        &["run", "pipe"],
        &["batch", "pipe", "--out", "out"],
        &["batch", "tiny.toml", "--seeds", "@pipe", "--out", "out"],
    ] {
        for signal in ["HUP", "INT", "TERM"] {
            let story = Story::begin();
            story.file("tiny.toml", TINY);
            pipe(&story, "pipe");
            let child = spawn(&story, arguments);
            // This waits until the program has opened the pipe, from which nothing ever comes.
            let writer = OpenOptions::new().write(true).open(story.path("pipe")).expect("it is a pipe");
            send(signal, &child);
            answer(child).expect_code(130);
            drop(writer);
        }
    }
}

#[test]
fn first_signal_ends_a_batch_whose_summary_nobody_reads() {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    // A line for each of many variants is more than a pipe holds.
    let values = (1..=1500).map(|value| format!("{}", f64::from(value) / 10.0)).collect::<Vec<_>>().join(",");
    let sweep = format!("fire.burn_out_s={values}");
    let mut child = spawn(&story, &["batch", "tiny.toml", "--seeds", "1", "--set", &sweep, "--out", "out"]);
    while !story.path("out/runs.csv").exists() {
        thread::yield_now();
    }
    send("INT", &child);
    assert_eq!(child.wait().expect("it ends").code(), Some(75), "nobody has read its output by then");
}

#[test]
fn hangup_that_nohup_keeps_off_ends_nothing() {
    let story = Story::begin();
    pipe(&story, "pipe");
    let program = env!("CARGO_BIN_EXE_wildfire");
    let mut command = Command::new("sh");
    command.args(["-c", &format!("trap '' HUP; exec {program} check pipe")]).current_dir(story.path(""));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("there is a shell");
    let mut writer = OpenOptions::new().write(true).open(story.path("pipe")).expect("it is a pipe");
    send("HUP", &child);
    std::io::Write::write_all(&mut writer, TINY.as_bytes()).expect("it is read");
    drop(writer);
    answer(child).expect_code(0);
}

/// Runs the program where no file may have more than this number of blocks, and returns its answer.
fn limited(story: &Story, blocks: u32, arguments: &str) -> Answer {
    let command = format!("ulimit -f {blocks}; exec {} {arguments}", env!("CARGO_BIN_EXE_wildfire"));
    let output = Command::new("sh").args(["-c", &command]).current_dir(story.path("")).output();
    Answer::of(&output.expect("there is a shell"))
}

#[test]
fn limit_on_the_size_of_files_is_told_and_is_no_signal() {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    limited(&story, 1, "run smoke --trace trace.csv").expect_code(3).expect_complaint(&["trace.csv", "too large"]);
    assert!(!story.path("trace.csv").exists());
    let answer = limited(&story, 64, "batch tiny.toml --seeds 1..2000 --out out").expect_code(3);
    answer.expect_complaint(&["runs.journal", "too large", "resume with: wildfire batch --resume out"]);
    story.tell(&["batch", "--resume", "out"]).expect_code(0);
    story.tell(&["batch", "tiny.toml", "--seeds", "1..2000", "--out", "whole"]).expect_code(0);
    let outcomes = |folder: &str| crate::story::outcomes(&story.path(folder).join("runs.csv"));
    assert!(outcomes("out") == outcomes("whole"), "the batch went on to another end");
}
