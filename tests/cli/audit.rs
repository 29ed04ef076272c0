//! `wildfire audit`: what passes, what does not, and what cannot be looked at.

use std::fs;

use crate::story::{Story, refuse, widest};
use wildfire::geometry::Pose;
use wildfire::timeline::{AgentFact, Fact, Timeline, file};
use wildfire::trajectory::Trajectory;

fn recorded(story: &Story, out: &str, seeds: &str) {
    story.tell(&["batch", "smoke", "--seeds", seeds, "--record", "all", "--out", out]).expect_code(0);
}

/// Changes a recording of a batch on purpose.
fn damage(story: &Story, path: &str, change: impl FnOnce(&mut Timeline)) {
    let path = story.path(path);
    let mut timeline = file::read(&path).expect("the batch has recorded it");
    change(&mut timeline);
    file::write(&timeline, &path).expect("the folder is writable");
}

/// Lets the first drive begin a centimetre from where the truck stands.
fn let_it_jump(timeline: &mut Timeline) {
    let drive = timeline.events.iter_mut().find_map(|event| match &mut event.fact {
        Fact::Agent(agent, AgentFact::Planned { trajectory, .. }) if agent.role.suppresses() => Some(trajectory),
        _ => None,
    });
    let drive = drive.expect("the truck drives");
    let start = Pose { x: drive.start().x + 0.01, ..drive.start() };
    *drive = Trajectory::new(drive.start_time(), start, drive.pieces().to_vec());
}

#[test]
fn runs_of_a_batch_pass_recorded_or_not() {
    let story = Story::begin();
    recorded(&story, "out", "1..4");
    fs::remove_file(story.path("out/recordings/seed-2.wildfire")).expect("it was recorded");
    let answer = story.tell(&["audit", "out"]).expect_code(0);
    for fragment in ["Runs: 3 recorded, 1 simulated again", "Checked: ", " extinctions.", "Violations: none."] {
        assert!(answer.stdout.contains(fragment), "`{fragment}` is missing:\n{}", answer.stdout);
    }
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
    let again = story.tell(&["audit", "out", "--jobs", "1"]).expect_code(0);
    assert_eq!(again.stdout, answer.stdout, "the number of threads changes nothing");
    let folder = story.tell(&["audit", "out/recordings"]).expect_code(0);
    assert!(folder.stdout.contains("Runs: 3 recorded, 0 simulated"), "{}", folder.stdout);
    let single = story.tell(&["audit", "out/recordings/seed-1.wildfire", "--step", "0.1"]).expect_code(0);
    assert!(single.stdout.contains("Runs: 1 recorded"), "{}", single.stdout);
}

#[test]
fn damaged_runs_end_in_exit_code_4_and_words() {
    let story = Story::begin();
    recorded(&story, "out", "1..3");
    damage(&story, "out/recordings/seed-2.wildfire", let_it_jump);
    for (jobs, path, name) in [
        ("1", "out", "out, seed 2: at "),
        ("2", "out", "out, seed 2: at "),
        ("2", "out/recordings", "out/recordings/seed-2.wildfire: at "),
    ] {
        let answer = story.tell(&["audit", path, "--jobs", jobs]).expect_code(4);
        assert!(answer.stdout.starts_with(&format!("Audit of 3 runs\n\n{name}")), "{}", answer.stdout);
        assert!(answer.stdout.contains("unimog/0: a leg begins 0.010000 m"), "{}", answer.stdout);
        assert!(answer.stdout.contains("Violations: in 1 of 3 runs."), "{}", answer.stdout);
    }
}

#[test]
fn row_that_says_something_else_is_a_violation() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "out"]).expect_code(0);
    let rows = story.read("out/runs.csv");
    let header: Vec<&str> = rows.lines().next().expect("a header").split(',').collect();
    let place = header.iter().position(|name| *name == "extinguished").expect("the column is there");
    let lines = rows.lines().enumerate().map(|(line, text)| {
        let mut fields: Vec<&str> = text.split(',').collect();
        if line == 2 {
            fields[place] = "999";
        }
        fields.join(",") + "\n"
    });
    story.file("out/runs.csv", &lines.collect::<String>());
    let answer = story.tell(&["audit", "out"]).expect_code(4);
    assert!(
        answer.stdout.starts_with("Audit of 3 runs\n\nout, seed 2: its row has extinguished 999, its run gives "),
        "{}",
        answer.stdout
    );
    assert!(answer.stdout.contains("Runs: 0 recorded, 3 simulated again"), "{}", answer.stdout);
}

#[test]
fn rows_that_are_not_those_of_the_plan_are_refused_and_missing_ones_said() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "out"]).expect_code(0);
    let rows = story.read("out/runs.csv");
    let lines: Vec<&str> = rows.lines().collect();
    story.file("out/runs.csv", &[lines[0], lines[2], lines[1], lines[3]].join("\n"));
    refuse(&story, &["audit", "out"], &["runs.csv", "seed 2; expected that of seed 1"]);
    story.file("out/runs.csv", &lines[..3].join("\n"));
    refuse(&story, &["audit", "out"], &["runs.csv", "ends before the row of seed 3"]);
    story.file("out/runs.csv", &rows[..lines[0].len() + 1 + lines[1].len() / 2]);
    refuse(&story, &["audit", "out"], &["runs.csv does not fit its plan", "line 2: ", "fields; expected"]);
    story.file("out/runs.csv", "seed,status\n1,done\n");
    refuse(&story, &["audit", "out"], &["runs.csv", "no column"]);
    fs::remove_file(story.path("out/runs.csv")).expect("it is there");
    let answer = story.tell(&["audit", "out"]).expect_code(0);
    assert!(answer.stdout.contains("3 of the runs have no row in runs.csv"), "{}", answer.stdout);
}

#[test]
fn recording_of_another_run_is_a_violation() {
    let story = Story::begin();
    recorded(&story, "out", "1..2");
    let of = |seed: u64| story.path(&format!("out/recordings/seed-{seed}.wildfire"));
    fs::copy(of(1), of(2)).expect("the folder is writable");
    let answer = story.tell(&["audit", "out"]).expect_code(4);
    assert!(
        answer.stdout.starts_with("Audit of 2 runs\n\nout, seed 2: its recording is of smoke, seed 1"),
        "{}",
        answer.stdout
    );
}

#[test]
fn runs_that_could_not_take_place_are_none_of_its_business() {
    let story = Story::begin();
    let no_room = ["batch", "smoke", "--set", "field.start_clearance_m=300", "--seeds", "1..2", "--out", "out"];
    story.tell(&no_room).expect_code(1);
    let answer = story.tell(&["audit", "out"]).expect_code(0);
    assert!(answer.stdout.contains("2 more could not be run."), "{}", answer.stdout);
}

#[test]
fn plan_of_another_version_is_said_and_only_recordings_are_audited() {
    let story = Story::begin();
    recorded(&story, "out", "1..2");
    fs::remove_file(story.path("out/recordings/seed-2.wildfire")).expect("it was recorded");
    let version = concat!("\"program_version\": \"", env!("CARGO_PKG_VERSION"), "\"");
    let plan = story.read("out/plan.json").replace(version, "\"program_version\": \"0.0.7\"");
    story.file("out/plan.json", &plan);
    let answer = story.tell(&["audit", "out"]).expect_code(0).expect_complaint(&["written by wildfire 0.0.7"]);
    assert!(answer.stdout.contains("Runs: 1 recorded, 0 simulated"), "{}", answer.stdout);
    fs::remove_file(story.path("out/recordings/seed-1.wildfire")).expect("it was recorded");
    story.tell(&["audit", "out"]).expect_code(2).expect_complaint(&["holds no recordings"]);
}

#[test]
fn recordings_before_format_3_are_audited_without_limits() {
    let story = Story::begin();
    recorded(&story, "out", "1");
    damage(&story, "out/recordings/seed-1.wildfire", |timeline| {
        timeline.setting.agents.iter_mut().for_each(|agent| agent.limits = None);
        timeline.setting.rules.fire = None;
    });
    let answer = story.tell(&["audit", "out/recordings"]).expect_code(0);
    assert!(answer.stdout.contains("lack speed limits"), "{}", answer.stdout);
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
}

#[test]
fn what_is_no_recording_is_refused_by_name() {
    let story = Story::begin();
    story.file("notes.wildfire", "not at all");
    refuse(&story, &["audit", "notes.wildfire"], &["notes.wildfire", "not a wildfire recording"]);
    refuse(&story, &["audit", "nothing.wildfire"], &["nothing.wildfire does not exist"]);
    fs::create_dir(story.path("empty")).expect("writable");
    refuse(&story, &["audit", "empty"], &["empty", "holds no recordings"]);
    fs::create_dir(story.path("other")).expect("writable");
    story.file("other/plan.json", "{}");
    refuse(&story, &["audit", "other"], &["plan.json", "program"]);
    refuse(&story, &["audit"], &["RUN|DIR"]);
    for step in ["0", "-1", "nan", "2"] {
        refuse(&story, &["audit", "notes.wildfire", &format!("--step={step}")], &["--step", "metres from 0.001 to 1"]);
    }
}

#[test]
fn damaged_and_newer_recordings_do_not_stop_the_others() {
    let story = Story::begin();
    recorded(&story, "out", "1..3");
    let path = story.path("out/recordings/seed-2.wildfire");
    let mut bytes = fs::read(&path).expect("it was recorded");
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(&path, &bytes).expect("writable");
    let answer = story.tell(&["audit", "out"]).expect_code(2).expect_complaint(&["seed-2.wildfire", "checksum"]);
    assert!(answer.stdout.contains("Runs: 2 recorded"), "{}", answer.stdout);
    bytes[8] = 99;
    fs::write(&path, &bytes).expect("writable");
    story.tell(&["audit", "out"]).expect_code(2).expect_complaint(&["written by a newer wildfire: format 99"]);
    damage(&story, "out/recordings/seed-3.wildfire", let_it_jump);
    let answer = story.tell(&["audit", "out"]).expect_code(4).expect_complaint(&["format 99"]);
    assert!(answer.stdout.contains("Violations: in 1 of 2 runs"), "a violation weighs more: {}", answer.stdout);
}

#[test]
fn recordings_with_searches_are_audited_like_others() {
    let story = Story::begin();
    let run = ["run", "smoke", "--record-searches"];
    story.tell(&run).expect_code(2).expect_complaint(&["--out"]);
    story.tell(&[&run[..], &["--out", "run.wildfire", "--events", "events.csv"]].concat()).expect_code(0);
    story.tell(&["audit", "run.wildfire"]).expect_code(0);
    let events = fs::read_to_string(story.path("events.csv")).expect("it was written");
    for phase in ["roadmap", "local", "walk"] {
        assert!(events.contains(&format!(",,,phase={phase}; places=")), "{phase} is missing:\n{events}");
    }
}
