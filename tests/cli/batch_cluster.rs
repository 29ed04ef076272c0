//! Batches on a cluster: the script that is printed, merging many slices, waiting for them, locks, threads of a task.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};

use crate::children::{self, end_of, output_of, send, wait_until};
use crate::story::{Answer, Story, outcomes, refuse};

/// A field of a hundred cells on which a Wumpus lights what it can within a minute: a run takes some microseconds.
const TINY: &str = "duration_s = 60.0\nunimog = []\n[field]\nsize_m = 50.0\ncoverage = 0.1\n\
                    [[wumpus]]\nstart_m = [2.5, 2.5]\n";

fn tiny() -> Story {
    let story = Story::begin();
    story.file("tiny.toml", TINY);
    story
}

/// Cuts the journal of the batch in the folder `whole` into slices of a folder `out`, as if each had been run by itself.
fn cut_into_slices(story: &Story, slices: usize) {
    fs::create_dir(story.path("out")).expect("writable");
    fs::copy(story.path("whole/plan.json"), story.path("out/plan.json")).expect("writable");
    let journal = story.read("whole/runs.journal");
    let mut lines = journal.lines();
    let head = &lines.next().expect("it has a first line")[9..];
    let mut rows: Vec<(usize, &str)> = lines.map(|line| (run_of(line), line)).collect();
    rows.sort_unstable();
    for slice in 1..=slices {
        let head = head.replacen("1/1", &format!("{slice}/{slices}"), 1);
        let of_slice =
            rows.iter().filter(|(run, _)| run % slices == slice % slices).map(|(_, line)| format!("{line}\n"));
        let text = format!("{:08x} {head}\n", crc32fast::hash(head.as_bytes())) + &of_slice.collect::<String>();
        story.file(&format!("out/runs-{slice}-of-{slices}.journal"), &text);
    }
}

fn run_of(line: &str) -> usize {
    let (_, number) = line.split_once("\"run\":").expect("a row names its run");
    number.split(',').next().expect("it is not empty").parse().expect("it is a number")
}

fn assert_like_the_whole(story: &Story, folder: &str) {
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&story.path(folder).join(file)), outcomes(&story.path("whole").join(file)), "{file}");
    }
}

#[test]
fn more_slices_are_merged_than_files_may_be_open() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..500", "--out", "whole"]).expect_code(0);
    cut_into_slices(&story, 200);
    let command = "ulimit -n 64; exec \"$0\" merge out --jobs 2";
    Answer::of(&output_of(&mut story.shell(command))).expect_code(0);
    assert_like_the_whole(&story, "out");
    for file in ["runs.parquet", "planner_calls.parquet", "states.parquet", "tables.md"] {
        assert!(story.path("out").join(file).exists(), "{file}");
    }
}

#[test]
fn missing_slices_are_all_named_with_the_array_that_runs_them() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    cut_into_slices(&story, 6);
    let third = story.read("out/runs-3-of-6.journal");
    story.file("out/runs-3-of-6.journal", &third.lines().take(9).map(|line| format!("{line}\n")).collect::<String>());
    for slice in [4, 6] {
        fs::remove_file(story.path(&format!("out/runs-{slice}-of-6.journal"))).expect("it is there");
    }
    for wait in ["--quiet", "--wait=0"] {
        let answer = story.tell(&["merge", "out", wait]).expect_code(2);
        answer.expect_complaint(&[
            "3 of 6 slices with missing runs: 3 lacks 2 of 10, 4 has not begun, 6 has not begun",
            "--array=3-4,6",
        ]);
    }
    for slice in ["3/6", "4/6", "6/6"] {
        story.tell(&["batch", "--resume", "out", "--shard", slice]).expect_code(0);
    }
    story.tell(&["merge", "out"]).expect_code(0);
    assert_like_the_whole(&story, "out");
}

#[test]
fn tasks_of_an_array_of_any_scheduler_are_slices() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    let array =
        ["batch", "tiny.toml", "--seeds", "1..60", "--out", "out", "--array-env", "SGE_TASK_ID", "--slices", "3"];
    let task = |value: Option<&str>| {
        let mut command = story.command(&array);
        value.map(|value| command.env("SGE_TASK_ID", value));
        Answer::of(&output_of(&mut command))
    };
    for (value, found) in
        [(None, "not set"), (Some("undefined"), "`undefined`"), (Some("0"), "`0`"), (Some("4"), "`4`")]
    {
        let expected = format!("SGE_TASK_ID is {found}; expected the number of a task, from 1 to 3");
        task(value).expect_code(2).expect_complaint(&[&expected, "number them from 1 to 3"]);
    }
    for number in ["2", "1", "3"] {
        task(Some(number)).expect_code(0);
    }
    story.tell(&["merge", "out"]).expect_code(0);
    assert_like_the_whole(&story, "out");
    refuse(&story, &array[..8], &["--slices"]);
    refuse(&story, &[&array[..], &["--shard", "1/3"]].concat(), &["--shard"]);
    refuse(&story, &[&array[..8], &["--slices", "10001"]].concat(), &["10001"]);
}

/// As Kubernetes and AWS Batch count tasks, each of which has a disk of its own; afterwards somebody copies all slices into
/// one folder.
#[test]
fn tasks_that_count_from_zero_on_machines_without_a_shared_disk_are_slices() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    let task = |value: &str| {
        let folder = format!("machine-{value}");
        let array = ["--array-env", "JOB_COMPLETION_INDEX", "--first", "0", "--slices", "3"];
        let mut command =
            story.command(&[&["batch", "tiny.toml", "--seeds", "1..60", "--out", &folder][..], &array].concat());
        Answer::of(&output_of(command.env("JOB_COMPLETION_INDEX", value)))
    };
    for value in ["3", "18446744073709551615"] {
        let expected = format!("JOB_COMPLETION_INDEX is `{value}`; expected the number of a task, from 0 to 2");
        task(value).expect_code(2).expect_complaint(&[&expected]);
    }
    fs::create_dir(story.path("out")).expect("writable");
    for number in ["0", "1", "2"] {
        task(number).expect_code(0);
        for entry in fs::read_dir(story.path(&format!("machine-{number}"))).expect("the slice's folder") {
            let entry = entry.expect("readable");
            fs::copy(entry.path(), story.path("out").join(entry.file_name())).expect("copied");
        }
    }
    story.tell(&["merge", "out"]).expect_code(0);
    assert_like_the_whole(&story, "out");
}

#[test]
fn merge_waits_for_slices_that_others_are_working_on() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    fs::create_dir(story.path("out")).expect("writable");
    let mut command = story.command(&["merge", "out", "--wait=600"]);
    let merge = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be started");
    for slice in ["2/2", "1/2"] {
        story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "out", "--shard", slice]).expect_code(0);
    }
    Answer::of(&end_of(merge)).expect_code(0);
    assert_like_the_whole(&story, "out");
}

#[test]
fn unknown_ways_to_keep_a_journal_are_refused() {
    let story = Story::begin();
    let batch = |option: &'static str| ["batch", "smoke", "--out", "out", option];
    refuse(&story, &batch("--lock=lockf"), &["expected `flock` or `none`"]);
    refuse(&story, &batch("--sync-every=-1"), &["expected seconds from 0 to 3600"]);
    refuse(&story, &batch("--target-minutes=5"), &["--slurm"]);
    refuse(&story, &["batch", "--resume", "out", "--slurm"], &["--slurm"]);
    refuse(&story, &["batch", "-", "--slurm"], &["every task can read"]);
}

#[test]
fn local_journals_leave_the_folder_as_others_do() {
    let story = tiny();
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    let options = ["--journal-dir", "disk", "--sync-every", "10"];
    let batch = ["batch", "tiny.toml", "--seeds", "1..60", "--out", "out"];
    story.tell(&[batch.as_slice(), &options].concat()).expect_code(0);
    assert_like_the_whole(&story, "out");
    let names = |folder: &str| {
        let entries = fs::read_dir(story.path(folder)).expect("it is there");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("readable").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names("out"), names("whole"));
    assert!(names("disk").is_empty());
}

/// A file system that refuses `flock`, as far as this program can tell.
#[test]
#[cfg(target_os = "linux")]
fn file_system_without_flock_is_named_and_no_lock_helps() {
    let story = tiny();
    story.file("shim.c", "#include <errno.h>\nint flock(int f, int o) { errno = ENOSYS; return -1; }\n");
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-o", "shim.so", "shim.c"]).current_dir(story.path(""));
    let is_compiled = compiler.status().is_ok_and(|status| status.success());
    if !is_compiled {
        println!("left out: there is no compiler for C");
        return;
    }
    let tell = |arguments: &[&str]| {
        let mut command = story.command(arguments);
        Answer::of(&output_of(command.env("LD_PRELOAD", "./shim.so")))
    };
    let slice = |number: &'static str, lock: &'static str| {
        tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "out", "--shard", number, "--lock", lock])
    };
    let hint = ["Function not implemented", "--lock none"];
    slice("1/2", "flock").expect_code(3).expect_complaint(&hint);
    for number in ["1/2", "2/2"] {
        slice(number, "none").expect_code(0);
    }
    for command in ["status", "merge"] {
        tell(&[command, "out"]).expect_code(3).expect_complaint(&hint);
    }
    let status = tell(&["status", "out", "--lock", "none"]).expect_code(0).stdout;
    assert!(status.contains("Write the tables with: wildfire merge out --lock none"), "{status}");
    tell(&["merge", "out", "--lock", "none"]).expect_code(0);
    story.tell(&["batch", "tiny.toml", "--seeds", "1..60", "--out", "whole"]).expect_code(0);
    assert_like_the_whole(&story, "out");
}

/// A program of the scratch folder that is found before others of its name.
fn program(story: &Story, name: &str, text: &str) {
    fs::create_dir_all(story.path("bin")).expect("writable");
    story.file(&format!("bin/{name}"), &format!("#!/bin/sh\n{text}\n"));
    let path = story.path("bin").join(name);
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("it is ours");
}

#[test]
fn script_for_slurm_submits_itself_runs_every_slice_and_merges_them() {
    if Command::new("bash").arg("--version").output().is_err() {
        return;
    }
    let story = tiny();
    story.file("plan.toml", "scenarios = [\"tiny.toml\"]\n[[sweep]]\nfield.coverage = [0.1, 0.2]\n");
    story.tell(&["batch", "plan.toml", "--seeds", "1..30", "--out", "whole"]).expect_code(0);
    let before = story.entries();
    let args = ["batch", "plan.toml", "--seeds", "1..30", "--slurm", "--max-tasks", "4", "--target-minutes", "0.01"];
    let options = ["--out", "my runs", "--lock", "none", "--journal-dir", "$LOCAL/disk", "--jobs", "2"];
    let script = story.tell(&[args.as_slice(), &options].concat()).expect_code(0).stdout;
    assert_eq!(story.entries(), before, "it prints, and writes nothing");
    let array = script.lines().find_map(|line| line.strip_prefix("#SBATCH --array=1-")).expect("it is an array");
    let tasks: usize = array.parse().expect("a number of tasks");
    assert!((2..=4).contains(&tasks), "{script}");
    for line in ["--requeue", "--open-mode=append", "--signal=B:TERM@90", "--cpus-per-task=2"] {
        assert!(script.contains(&format!("#SBATCH {line}\n")), "{line}:\n{script}");
    }
    story.file("fleet.sh", &script);
    // Slurm's part: the first call submits the array, the second what is done behind it.
    program(&story, "sbatch", "printf '%s\\n' \"$*\" >> submitted; [ \"$1\" != --parsable ] || echo '4711;here'");
    let path = std::env::var("PATH").unwrap_or_default();
    let bash = |arguments: &[&str]| {
        let mut command = children::command("bash");
        command.args(arguments).current_dir(story.path("")).env("LOCAL", story.path("local"));
        command.env("PATH", format!("{}:{path}", story.path("bin").display()));
        command
    };
    Answer::of(&output_of(&mut bash(&["fleet.sh"]))).expect_code(0);
    let submitted = story.read("submitted");
    let submitted: Vec<&str> = submitted.lines().collect();
    assert!(submitted[0].starts_with("--parsable ") && submitted[0].ends_with("fleet.sh"), "{submitted:?}");
    assert!(submitted[1].contains("--dependency=afterany:4711 "), "{submitted:?}");
    let (_, merge) = submitted[1].split_once("--wrap=").expect("it runs a command");
    for task in 1..=tasks {
        let mut command = bash(&["fleet.sh"]);
        command.env("SLURM_ARRAY_TASK_ID", task.to_string()).env("SLURM_ARRAY_JOB_ID", "4711");
        Answer::of(&output_of(&mut command)).expect_code(0);
    }
    Answer::of(&output_of(&mut bash(&["-c", merge]))).expect_code(0);
    assert_like_the_whole(&story, "my runs");
    assert_eq!(fs::read_dir(story.path("local/disk")).expect("journals were here").count(), 0);
}

/// A task of a script that is told to end is queued again, and goes on where it was.
#[test]
#[cfg(target_os = "linux")]
fn task_that_is_told_to_end_is_queued_again() {
    let story = tiny();
    // A hundred thousand runs last long enough.
    let args = ["batch", "tiny.toml", "--seeds", "1..90000", "--slurm", "--out", "out", "--max-tasks", "2"];
    story.file("fleet.sh", &story.tell(&args).expect_code(0).stdout);
    program(&story, "scontrol", "printf '%s\\n' \"$*\" >> queued; exit 1");
    program(&story, "squeue", "echo RUNNING");
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = children::command("bash");
    command
        .arg("fleet.sh")
        .current_dir(story.path(""))
        .env("SLURM_ARRAY_TASK_ID", "2")
        .env("SLURM_ARRAY_JOB_ID", "4711");
    command.env("PATH", format!("{}:{path}", story.path("bin").display()));
    let task = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("there is bash");
    let journal = story.path("out/runs-2-of-2.journal");
    wait_until("it runs", || fs::metadata(&journal).map_or(0, |found| found.len()) >= 10_000);
    send("TERM", &task);
    let output = end_of(task);
    assert_eq!((output.status.code(), story.read("queued").trim_end()), (Some(75), "requeue 4711_2"));
    let status = story.tell(&["status", "out"]).expect_code(0).stdout;
    assert!(status.contains("stopped") && status.contains("--shard 1/2"), "{status}");
}

#[test]
#[cfg(target_os = "linux")]
fn batch_in_a_task_of_slurm_has_its_threads() {
    let endless = ["--set", "duration_s=1000000", "--set", "fire.relight=true", "--set", "fire.burn_out_s=none"];
    let story = Story::begin();
    let mut command =
        story.command(&[["batch", "contest", "--seeds", "1..50", "--out", "out"].as_slice(), &endless].concat());
    command.env("SLURM_CPUS_PER_TASK", "7").stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().expect("the program can be started");
    let threads = || fs::read_dir(format!("/proc/{}/task", child.id())).map_or(0, Iterator::count);
    // The main thread, one that waits for signals, and the workers.
    wait_until("seven workers have threads", || threads() >= 9);
    child.kill().expect("it can be killed");
    end_of(child);
}
