//! Inputs that are pipes or devices: they are read once, waited for until Ctrl-C, and bounded.
#![cfg(unix)]

use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};

use crate::children::{end_of, output_of, send, writer_once_read};
use crate::story::{Answer, Story};

/// Every way to name a file that is read, with `{}` for its name, and what is read there.
const INPUTS: [(&str, &str); 17] = [
    ("check {}", "smoke.toml"),
    ("run {}", "smoke.toml"),
    ("batch {} --planner prm-rs,lattice --seeds 1 --out out --force", "smoke.toml"),
    ("batch {} --seeds 1 --dry-run", "plan.toml"),
    ("batch smoke --seeds @{} --dry-run", "seeds"),
    ("render {} --with-set fire.burn_out_s=20 --size 320x240 -o out.png", "smoke.toml"),
    ("render {} --size 320x240 -o out.png", "run.wildfire"),
    ("render smoke --with {} --size 320x240 -o out.png", "run.wildfire"),
    ("plan {}", "field.json"),
    ("plan --goals 1 --scenario {}", "smoke.toml"),
    ("check --set field.map={}", "field.json"),
    ("map brushfire {}", "map.txt"),
    ("map timing {}", "map.pgm"),
    ("map brushfire {} --tolerance 90", "map.png"),
    ("curve --pairs {} --csv out.csv", "pairs.csv"),
    ("audit {}", "run.wildfire"),
    ("compare {} --by planner", "runs.csv"),
];

fn story() -> Story {
    let story = Story::begin();
    let smoke = story.tell(&["scenarios", "--show", "smoke", "--all"]).expect_code(0).stdout;
    story.file("smoke.toml", &smoke);
    story.file("plan.toml", "scenarios = ['smoke']\nseeds = '1..3'\n");
    story.file("seeds", "1..3 7\n");
    let field = r#"{"n": 100, "cell_m": 2.5, "cells_cr": [], "start": [12, 25, 0], "goals": [{"pose": [38, 25, 0]}]}"#;
    story.file("field.json", field);
    story.file("map.txt", "0100\n0000\n");
    story.file("map.pgm", "P2\n3 2\n255\n0 255 255\n255 255 255\n");
    image::GrayImage::from_fn(40, 30, |x, _| image::Luma([x as u8 * 6])).save(story.path("map.png")).expect("writable");
    story.file("pairs.csv", "x0,y0,th0,x1,y1,th1\n0,0,0,9,9,1\n");
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    let batch = ["batch", "smoke", "--planner", "prm-rs,lattice", "--seeds", "1..3", "--out", "batch"];
    story.tell(&batch).expect_code(0);
    fs::copy(story.path("batch/runs.csv"), story.path("runs.csv")).expect("writable");
    let made = Command::new("mkfifo").arg(story.path("pipe")).status().expect("mkfifo is there");
    assert!(made.success());
    story
}

fn with_input(command: &str, input: &str) -> Vec<String> {
    command.replace("{}", input).split_whitespace().map(str::to_owned).collect()
}

fn command(story: &Story, args: &[String]) -> Command {
    story.command(&args.iter().map(String::as_str).collect::<Vec<_>>())
}

fn remove_outputs(story: &Story) {
    for name in ["out.png", "out.csv"] {
        // It may not be there.
        let _ = fs::remove_file(story.path(name));
    }
}

#[test]
fn every_input_may_be_a_pipe() {
    let story = story();
    for (arguments, file) in INPUTS {
        let mut writer = Command::new("sh");
        let mut writer =
            writer.args(["-c", "cat \"$0\" > pipe", file]).current_dir(story.path(".")).spawn().expect("sh");
        let output = output_of(&mut command(&story, &with_input(arguments, "pipe")));
        // It would wait for ever if the pipe was never opened.
        let _ = writer.kill();
        end_of(writer);
        let answer = Answer::of(&output);
        assert_eq!(answer.code, Some(0), "{arguments}: {}", answer.stderr);
        remove_outputs(&story);
    }
}

#[test]
fn every_input_may_be_stdin() {
    let story = story();
    for (arguments, file) in INPUTS {
        let input = fs::File::open(story.path(file)).expect("it was just written");
        let mut cat = Command::new("cat").stdin(input).stdout(Stdio::piped()).spawn().expect("cat is there");
        let args = with_input(arguments, "-");
        let stdin = cat.stdout.take().expect("it is piped");
        let output = output_of(command(&story, &args).stdin(stdin));
        end_of(cat);
        let answer = Answer::of(&output);
        assert_eq!(answer.code, Some(0), "{arguments}: {}", answer.stderr);
        remove_outputs(&story);
    }
}

#[test]
fn batch_of_a_pipe_is_resumed_without_it() {
    let story = story();
    let mut child = story.command(&["batch", "-", "--seeds", "1..2", "--out", "piped"]);
    let mut child = child.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
    child.stdin.take().expect("piped").write_all(story.read("smoke.toml").as_bytes()).expect("it is read");
    assert!(end_of(child).status.success());
    story.tell(&["batch", "--resume", "piped"]).expect_code(0);
}

#[test]
fn one_interrupt_ends_the_wait_for_a_pipe_that_says_nothing() {
    let story = story();
    for (arguments, _) in INPUTS {
        let mut started = command(&story, &with_input(arguments, "pipe"));
        let mut child = started.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it can be started");
        let _writer = writer_once_read(&story.path("pipe"), &mut child);
        send("INT", &child);
        let status = end_of(child).status;
        assert!(status.code() == Some(130) || status.signal() == Some(2), "{arguments}: {status}");
    }
}

/// The memory that must be enough for what the program reads of any input, and for its errors, in kibibytes of addresses.
const READ_KIB: u64 = 65_536 + 1024;

/// The addresses that the program takes without reading anything, in kibibytes, most of them never touched: its own code
/// above all, whose size differs between builds.
fn addresses_without_input(story: &Story) -> u64 {
    let mut started = command(story, &with_input("audit {}", "pipe"));
    let mut child = started.env("MALLOC_ARENA_MAX", "1").stderr(Stdio::null()).spawn().expect("it can be started");
    let _writer = writer_once_read(&story.path("pipe"), &mut child);
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("it waits for the pipe");
    child.kill().expect("it can be ended");
    end_of(child);
    let peak = status.lines().find_map(|line| line.strip_prefix("VmPeak:")).expect("a process has a peak");
    peak.trim().trim_end_matches(" kB").parse().expect("it is a number")
}

/// Runs a command in bounded memory, which must end with the code of bad input.
fn refuse_in_bounded_memory(story: &Story, args: &[String], what: &str) {
    let limited = format!("ulimit -v {}; exec \"$0\" \"$@\"", READ_KIB + addresses_without_input(story));
    let mut shell = story.shell(&limited);
    // glibc reserves 64 MiB of addresses for a thread that allocates while another does, which depends on the moment.
    let answer = Answer::of(&output_of(shell.env("MALLOC_ARENA_MAX", "1").args(args)));
    assert_eq!(answer.code, Some(2), "{what}: {:.500}\n{:.500}", answer.stdout, answer.stderr);
}

#[test]
#[cfg(target_os = "linux")]
fn device_without_an_end_is_refused_at_the_limit() {
    let story = story();
    for (arguments, _) in INPUTS {
        refuse_in_bounded_memory(&story, &with_input(arguments, "/dev/zero"), arguments);
    }
}

/// Makes a text of about `bytes` bytes: a beginning, what is repeated, and an end.
fn text_of(bytes: usize, start: &str, repeated: &str, end: &str) -> String {
    format!("{start}{}{end}", repeated.repeat((bytes - start.len() - end.len()) / repeated.len()))
}

#[test]
#[cfg(target_os = "linux")]
fn worst_inputs_below_the_limits_are_refused_in_bounded_memory() {
    let story = story();
    let field = r#"{"n": 10, "cells_cr": [], "#;
    for (name, arguments, text) in [
        ("tables.toml", "check {}", text_of(167_000, "a = [", "{a=1},", "]")),
        ("trucks.toml", "check {}", text_of(71_000, "wumpus = []\nunimog = [", "{},", "]")),
        ("headers.toml", "check {}", text_of(120_000, "", "[[a]]\nb=1\n", "")),
        ("numbers.toml", "check {}", text_of(299_000, "a = [", "1,", "]")),
        ("seeds", "batch smoke --dry-run --seeds @{}", text_of(7_999_000, "", "1,", "1")),
        (
            "goals.json",
            "plan {}",
            text_of(15_900_000, &format!("{field} \"start\": [1, 1, 0], \"goals\": ["), "{},", "{}]}"),
        ),
        ("start.json", "plan {}", text_of(15_900_000, &format!("{field} \"start\": ["), "1,", "1]}")),
        ("name.json", "plan {}", text_of(15_900_000, &format!("{field} \"field\": ["), "[],", "1]}")),
    ] {
        story.file(name, &text);
        refuse_in_bounded_memory(&story, &with_input(arguments, name), name);
    }
    let plan = story.read("batch/plan.json");
    let (head, _) = plan.split_once("\"variants\"").expect("a plan has variants");
    let variants = format!("{head}\"variants\": [");
    let trucks = format!("{}{{}}", "{},".repeat(999));
    let truck_list = format!(
        "{{\"source\":\"x\",\"changes\":[],\"swept\":[],\"scenario\":{{\"wumpus\":[],\"unimog\":[{trucks}]}}}},"
    );
    let swept = format!("{variants}{{\"source\": \"x\", \"changes\": [], \"swept\": [");
    for (name, text) in [
        ("trucks", text_of(10_000_000, &variants, &truck_list, "1]}")),
        ("swept", text_of(10_000_000, &swept, "0,", "0]}]}")),
        ("nested", text_of(10_000_000, &swept, "[],", "0]}]}")),
    ] {
        story.file("batch/plan.json", &text);
        refuse_in_bounded_memory(&story, &with_input("status {}", "batch"), name);
    }
}
