//! A batch whose program is killed again and again.

use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use rand::RngExt;

use crate::children::end_of;
use crate::story::{Story, outcomes};

/// A field of a hundred cells on which a Wumpus lights what it can within a minute: a run takes some microseconds.
const TINY: &str = "duration_s = 60.0\nunimog = []\n[field]\nsize_m = 50.0\ncoverage = 0.1\n\
                    [[wumpus]]\nstart_m = [2.5, 2.5]\n";

const SEEDS: &str = "1..2000";

#[expect(clippy::disallowed_methods, reason = "a moment at which nothing is known of the program is what is wanted")]
fn wait(moment: Duration) {
    thread::sleep(moment);
}

fn assert_same(one: &Path, other: &Path) {
    for file in ["runs.csv", "agents.csv"] {
        assert!(outcomes(&one.join(file)) == outcomes(&other.join(file)), "{file} differs");
    }
}

#[test]
fn batch_that_is_killed_at_any_moment_loses_nothing_and_runs_nothing_twice() {
    kill(10);
}

#[test]
#[ignore = "tier 2: two hundred kills"]
fn batch_that_is_killed_two_hundred_times_loses_nothing_and_runs_nothing_twice() {
    kill(200);
}

/// Kills a batch this often, and compares what it writes in the end with that of one that was left alone.
fn kill(kills: usize) {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    story.tell(&["batch", "tiny.toml", "--seeds", SEEDS, "--out", "whole"]).expect_code(0);
    let mut rng = wildfire::rng::stream(1, "kills");
    let mut unfinished = 0;
    let mut arguments = vec!["batch", "tiny.toml", "--seeds", SEEDS, "--jobs", "2", "--out", "killed"];
    for _ in 0..kills {
        let mut command = story.command(&arguments);
        let mut child =
            command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program can be started");
        wait(Duration::from_micros(rng.random_range(0..40_000)));
        child.kill().expect("it can be killed");
        end_of(child);
        if story.path("killed/plan.json").exists() {
            arguments = vec!["batch", "--resume", "killed", "--jobs", "2"];
        } else {
            // It had not even begun; it left a folder, perhaps with an empty journal and part of a plan, which are
            // not in the way.
        }
        unfinished += usize::from(!story.path("killed/runs.csv").exists());
    }
    assert!(unfinished > kills / 10, "it was hardly ever killed before its end");
    story.tell(&arguments).expect_code(0);
    assert_same(&story.path("killed"), &story.path("whole"));
    let names = |folder: &str| {
        let entries = std::fs::read_dir(story.path(folder)).expect("it is there");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("readable").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names("killed"), names("whole"), "nothing half written is left");
    assert_eq!(outcomes(&story.path("killed/runs.csv")).len(), 2001);
}
