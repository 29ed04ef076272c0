//! Signals that ask for an end: each gives an exit code, whatever the program is doing or waiting for.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use signal_hook::consts::SIGXFSZ;

use crate::children::{end_of, output_of, send, wait_until, writer_once_read};
use crate::story::{Answer, Story};

const TINY: &str = "duration_s = 60.0\nunimog = []\n[field]\nsize_m = 50.0\ncoverage = 0.1\n\
                    [[wumpus]]\nstart_m = [2.5, 2.5]\n";

fn spawn(story: &Story, arguments: &[&str]) -> Child {
    let mut command = story.command(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be started")
}

fn pipe(story: &Story, name: &str) {
    let made = Command::new("mkfifo").arg(story.path(name)).status();
    assert!(made.expect("there is a mkfifo").success());
}

fn answer(child: Child) -> Answer {
    Answer::of(&end_of(child))
}

/// Waits until the program catches all signals, which it does from its first statement on: this is the last of them.
fn wait_for_handlers(child: &Child) {
    wait_until("signals are caught", || {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("it is not waited for yet");
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).map(str::trim);
        let is_over = status.contains("\nState:\tZ");
        is_over
            || mask.is_some_and(|mask| u64::from_str_radix(mask, 16).expect("it is a mask") >> (SIGXFSZ - 1) & 1 == 1)
    });
}

#[expect(clippy::disallowed_methods, reason = "a moment at which nothing is known of the program is what is wanted")]
fn wait(moment: Duration) {
    thread::sleep(moment);
}

#[test]
fn signal_at_any_moment_gives_an_exit_code() {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    for (signal, millis) in (0..40).flat_map(|step| ["HUP", "INT", "TERM"].map(|signal| (signal, step))) {
        let out = format!("out-{signal}-{millis}");
        let child = spawn(&story, &["batch", "tiny.toml", "--seeds", "1..100000", "--out", &out]);
        wait_for_handlers(&child);
        wait(Duration::from_millis(millis));
        send(signal, &child);
        let code = answer(child).code;
        assert!(matches!(code, Some(130 | 75)), "{signal} after {millis} ms: {code:?}");
    }
}

#[test]
fn signal_to_a_batch_that_runs_leaves_it_resumable() {
    for signal in ["HUP", "INT", "TERM"] {
        let story = Story::begin();
        story.file("tiny.toml", TINY);
        let child = spawn(&story, &["batch", "tiny.toml", "--seeds", "1..100000", "--out", "out"]);
        wait_until("a run is written", || {
            story.path("out/runs.journal").metadata().is_ok_and(|file| file.len() > 5000)
        });
        send(signal, &child);
        answer(child).expect_code(75);
    }
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
            let mut child = spawn(&story, arguments);
            // Nothing ever comes from it.
            let writer = writer_once_read(&story.path("pipe"), &mut child);
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
    wait_until("the tables are written", || story.path("out/runs.csv").exists());
    send("INT", &child);
    let unread = (child.stdout.take(), child.stderr.take());
    assert_eq!(end_of(child).status.code(), Some(75), "nobody has read its output by then");
    drop(unread);
}

#[test]
fn hangup_that_nohup_keeps_off_ends_nothing() {
    let story = Story::begin();
    pipe(&story, "pipe");
    let mut command = story.shell("trap '' HUP; exec \"$0\" check pipe");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("there is a shell");
    let mut writer = writer_once_read(&story.path("pipe"), &mut child);
    send("HUP", &child);
    std::io::Write::write_all(&mut writer, TINY.as_bytes()).expect("it is read");
    drop(writer);
    answer(child).expect_code(0);
}

/// Runs the program where no file may have more than this number of blocks, and returns its answer.
fn limited(story: &Story, blocks: u32, arguments: &str) -> Answer {
    Answer::of(&output_of(&mut story.shell(&format!("ulimit -f {blocks}; exec \"$0\" {arguments}"))))
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
