//! Batches of several scenarios, planners and values; in slices; stopped and resumed.

use std::fs;
#[cfg(target_os = "linux")]
use std::process::{Child, Stdio};

#[cfg(target_os = "linux")]
use crate::children::{end_of, send, wait_until};
use crate::story::{Story, outcomes, refuse};

fn column(story: &Story, name: &str) -> Vec<String> {
    let rows = outcomes(&story.path("out/runs.csv"));
    let index = rows[0].iter().position(|column| column == name).expect("the column is there");
    rows[1..].iter().map(|row| row[index].clone()).collect()
}

#[test]
fn everything_that_is_swept_has_a_column_and_seeds_are_paired() {
    let story = Story::begin();
    let arguments = ["batch", "smoke", "--planner", "prm+primitives,hybrid-astar", "--seeds", "3,1", "--out", "out"];
    let swept = ["--set", "field.coverage=0.05,0.10", "--set", "duration_s=60"];
    let answer = story.tell(&[arguments.as_slice(), &swept].concat()).expect_code(0);
    for fragment in ["1: smoke, planner prm+primitives, field.coverage 0.05\n", "Files: out"] {
        assert!(answer.stdout.contains(fragment), "`{fragment}` is missing:\n{}", answer.stdout);
    }
    let header = &outcomes(&story.path("out/runs.csv"))[0];
    assert_eq!(header[..7], ["scenario", "seed", "run", "planner", "policy", "field.coverage", "status"]);
    assert_eq!(column(&story, "run"), ["1", "2", "3", "4", "5", "6", "7", "8"]);
    assert_eq!(column(&story, "seed"), ["3", "1"].repeat(4));
    assert_eq!(column(&story, "planner"), [["prm+primitives"; 4], ["hybrid-astar"; 4]].concat());
    assert_eq!(column(&story, "field.coverage"), ["0.05", "0.05", "0.1", "0.1"].repeat(2));
    let obstacles = column(&story, "obstacles");
    assert_eq!(obstacles[..4], obstacles[4..], "both planners have the same fields");
    assert!(story.read("out/tables.md").contains("## smoke, planner hybrid-astar, field.coverage 0.1\n"));
}

#[test]
fn dry_run_says_what_would_be_run_and_writes_nothing() {
    let story = Story::begin();
    story.file(
        "plan.toml",
        "scenarios = ['smoke', 'contest']\nseeds = '1..10'\n[[sweep]]\nfire.burn_out_s = [30, 60]\n",
    );
    let before = story.entries();
    let answer = story.tell(&["batch", "plan.toml", "--dry-run"]).expect_code(0);
    assert!(answer.stdout.starts_with("4 variants x 10 seeds (1..10) = 40 runs\n"), "{}", answer.stdout);
    assert!(answer.stdout.contains("runs 31 to 40: contest, fire.burn_out_s 60\n"), "{}", answer.stdout);
    assert_eq!(story.entries(), before);
}

#[test]
fn variant_whose_planner_does_not_start_is_named_with_the_reason_wherever_the_batch_is_shown() {
    let story = Story::begin();
    story.file("broken.sh", "echo hello there\n");
    let tell = |args: &[&str], code| {
        let answer = story.tell(args).expect_code(code);
        answer.stdout.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let planners = ["--planner", "broken,prm-rs", "--command", "broken=sh broken.sh"];
    let batch =
        tell(&[&["batch", "smoke", "--seeds", "1..2", "--jobs", "1", "--out", "both"], &planners[..]].concat(), 1);
    let answer = "2 of 4 runs finished: prm-rs saved 60 %, broken failed twice.";
    let reason = "unimog/0 has no planner: `broken` could not be built: answered `hello there`";
    assert!(batch.contains(answer), "{batch}");
    assert!(batch.contains(&format!("1: 2 of 2 runs failed; the first, seed 1: {reason}")), "{batch}");
    // The first variant has no run to watch.
    assert!(batch.contains("--set unimog.planner=prm-rs --page seed-1.html"), "{batch}");
    let status = tell(&["status", "both"], 0);
    assert!(status.contains(&format!("smoke, planner broken: 2 runs failed; the first, seed 1: {reason}")), "{status}");
    let status: serde_json::Value = serde_json::from_str(&tell(&["status", "both", "--json"], 0)).expect("JSON");
    assert_eq!((&status["failures"][0]["failed"], &status["failures"][0]["seed"]), (&2.into(), &1.into()));
    let compared = tell(&["compare", "both"], 0);
    for fragment in
        ["unimog.planner: broken in A, prm-rs in B", "No pair of runs finished", "saved: no seed has a value"]
    {
        assert!(compared.contains(fragment), "{compared}");
    }
    assert!(!compared.contains("only measured times can differ"), "{compared}");
    tell(&["report", "both"], 0);
    assert!(story.read("both/report.html").contains(answer));
}

#[test]
fn plans_that_make_no_sense_are_refused() {
    let story = Story::begin();
    story.file("plan.toml", "seeds = '1..10'\n");
    story.file("wrong.toml", "seeds = '1..10'\nplaners = ['lattice']\n");
    story.file("none", "# no seeds\n");
    let batch = |more: &[&'static str]| [&["batch", "smoke"], more].concat();
    refuse(&story, &batch(&["--planner", "prm+primitives,hybrid"]), &["`hybrid`", "hybrid-astar"]);
    refuse(&story, &batch(&["--set", "field.covrage=0.1,0.2"]), &["covrage", "coverage"]);
    refuse(&story, &batch(&["--set", "field.coverage=0.1,"]), &["field.coverage", "expected a value"]);
    refuse(&story, &batch(&["--set", "field.coverage=0.1,0.1"]), &["has the value 0.1 twice"]);
    let both = ["--planner", "prm+primitives,hybrid-astar", "--set", "unimog.0.planner=hybrid-astar"];
    refuse(&story, &batch(&both), &["contradict"]);
    refuse(&story, &batch(&["--seeds", "1..100001"]), &["100001 runs are many", "--force"]);
    refuse(&story, &batch(&["--seeds", "@none"]), &["none", "there are no seeds"]);
    refuse(&story, &batch(&["smoke"]), &["are the same scenario"]);
    refuse(&story, &batch(&["plan.toml"]), &["plan.toml is a plan", "expected no other inputs"]);
    refuse(&story, &["batch", "wrong.toml"], &["wrong.toml:2", "planers", "planners"]);
    refuse(&story, &batch(&["--shard", "3/2", "--out", "out"]), &["expected K/N"]);
    refuse(&story, &["batch", "smoke", "--resume", "out"], &["--resume"]);
    refuse(&story, &["batch", "--resume", "nowhere"], &["nowhere"]);
    refuse(&story, &["status", "nowhere"], &["nowhere"]);
}

#[test]
fn slices_in_one_folder_are_merged_into_the_rows_of_the_whole() {
    let story = Story::begin();
    let smoke = ["batch", "smoke", "--seeds", "1..7", "--set", "duration_s=30,60"];
    story.tell(&[smoke.as_slice(), &["--out", "whole"]].concat()).expect_code(0);
    let slice = |slice: &'static str| story.tell(&[smoke.as_slice(), &["--out", "out", "--shard", slice]].concat());
    let answer = slice("2/2").expect_code(0);
    assert!(answer.stdout.contains("wildfire merge out"), "{}", answer.stdout);
    story.tell(&["merge", "out"]).expect_code(2).expect_complaint(&["slice 1/2", "has not begun", "--shard 1/2"]);
    let status = story.tell(&["status", "out"]).expect_code(0).stdout;
    assert!(status.contains("Slice Planned Finished Failed     State\n"), "{status}");
    assert!(status.contains("1/2         7        0      0 not begun"), "{status}");
    assert!(status.contains("2/2         7        7      0  complete"), "{status}");
    assert!(status.contains("7 of 14 runs finished, 0 failed, 7 still to run."), "{status}");
    let needs_tables: [&[&str]; 4] =
        [&["batch", "--resume", "out"], &["report", "out"], &["compare", "out", "whole"], &["rank", "out", "whole"]];
    for command in needs_tables {
        refuse(&story, command, &["continue with: wildfire batch --resume out --shard 1/2"]);
    }
    slice("1/2").expect_code(0);
    for command in needs_tables {
        refuse(&story, command, &["write the tables with: wildfire merge out"]);
    }
    story.tell(&["merge", "out"]).expect_code(0);
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&story.path("out").join(file)), outcomes(&story.path("whole").join(file)));
    }
    let again = story.tell(&["batch", "contest", "--seeds", "1..7", "--out", "out", "--shard", "1/2"]);
    again
        .expect_code(2)
        .expect_complaint(&["differs from the requested plan", "the list of swept keys is duration_s there"]);
}

#[test]
fn torn_journal_is_said_and_gone_on_with() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--out", "out"]).expect_code(0);
    let journal = story.read("out/runs.journal");
    story.file("out/runs.journal", &journal[..journal.len() - 100]);
    story.tell(&["batch", "--resume", "out"]).expect_code(0).expect_complaint(&["dropped the incomplete last line"]);
    story.file("out/runs.journal", &journal.replacen("\"seed\":1", "\"seed\":2", 1));
    story.tell(&["batch", "--resume", "out"]).expect_code(2).expect_complaint(&["runs.journal is damaged in line"]);
}

/// A batch whose first run lasts longer than anybody waits.
#[cfg(target_os = "linux")]
fn long_batch(story: &Story) -> Child {
    let endless = ["--set", "duration_s=1000000", "--set", "fire.relight=true", "--set", "fire.burn_out_s=none"];
    let batch = [["batch", "contest", "--jobs", "1", "--out", "out"].as_slice(), &endless].concat();
    let mut command = story.command(&batch);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program can be started");
    // It is written when a first signal stops the batch and a second ends it at once.
    wait_until("the batch runs", || story.path("out/machines.json").exists());
    child
}

#[test]
#[cfg(target_os = "linux")]
fn first_interrupt_stops_a_batch_and_names_the_command_that_resumes_it() {
    let story = Story::begin();
    let child = long_batch(&story);
    send("INT", &child);
    let answer = crate::story::Answer::of(&end_of(child)).expect_code(75);
    answer.expect_complaint(&["stopping", "the batch was stopped", "resume with: wildfire batch --resume out"]);
    let status = story.tell(&["status", "out"]).expect_code(0).stdout;
    assert!(status.contains("Continue with: wildfire batch --resume out"), "{status}");
}

#[test]
#[cfg(target_os = "linux")]
fn second_interrupt_stops_a_batch_at_once() {
    let story = Story::begin();
    let child = long_batch(&story);
    // The batch may end at the first, so both come while it is stopped; of one kind they could become one.
    let both = format!("kill -STOP {0} && kill -INT {0} && kill -TERM {0} && kill -CONT {0}", child.id());
    let sent = std::process::Command::new("sh").args(["-c", &both]).status();
    assert!(sent.expect("there is a shell").success());
    assert_eq!(end_of(child).status.code(), Some(130));
}

#[test]
fn second_process_on_a_batch_is_refused() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--out", "out"]).expect_code(0);
    let journal = fs::File::open(story.path("out/runs.journal")).expect("it is there");
    journal.try_lock().expect("nobody has it");
    story.tell(&["batch", "--resume", "out"]).expect_code(3).expect_complaint(&["another process is working on"]);
    let status = story.tell(&["status", "out"]).expect_code(0).stdout;
    assert!(status.contains("running"), "{status}");
}

#[test]
fn templates_can_be_run_as_they_are_and_replace_nothing() {
    let story = Story::begin();
    story.tell(&["new", "scenario", "mine.toml"]).expect_code(0);
    story.tell(&["check", "mine.toml"]).expect_code(0);
    story.tell(&["new", "plan", "plan.toml"]).expect_code(0);
    story.tell(&["batch", "plan.toml", "--dry-run"]).expect_code(0);
    let text = story.read("plan.toml");
    refuse(&story, &["new", "plan", "plan.toml"], &["plan.toml", "already exists"]);
    assert_eq!(story.tell(&["new", "plan"]).expect_code(0).stdout, text);
}

#[test]
fn schemas_know_every_value_of_a_scenario_and_every_column() {
    let story = Story::begin();
    let schema = |of: &str| -> serde_json::Value {
        serde_json::from_str(&story.tell(&["schema", of]).expect_code(0).stdout).expect("a schema is JSON")
    };
    let scenario = schema("scenario");
    let fire = &scenario["$defs"]["Fire"]["properties"];
    assert_eq!(fire["burn_out_s"]["anyOf"][1]["const"], "none");
    assert_eq!(fire["spread_radius_m"]["default"], 30.0);
    assert!(
        fire["spread_radius_m"]["description"].as_str().is_some_and(|description| description.contains("cell centres"))
    );
    assert!(scenario["$defs"]["Field"]["properties"]["given"].is_null(), "it is none of the user's");
    assert!(schema("plan")["properties"]["sweep"].is_object());
    story.tell(&["batch", "smoke", "--seeds", "1", "--out", "out"]).expect_code(0);
    let columns = schema("runs")["properties"].as_object().expect("columns").clone();
    let header = story.read("out/runs.csv").lines().next().expect("a header").to_owned();
    let missing: Vec<_> = header.split(',').filter(|name| !columns.contains_key(*name)).collect();
    assert!(missing.is_empty() && columns.len() == header.split(',').count(), "{missing:?}");
}

#[test]
fn a_frozen_plan_makes_the_same_runs_again_and_nothing_of_it_changes() {
    let story = Story::begin();
    let first = ["batch", "smoke", "--seeds", "1..3", "--set", "field.coverage=0.05..0.10:0.05", "--out", "first"];
    story.tell(&first).expect_code(0);
    fs::copy(story.path("first/plan.json"), story.path("published.json")).expect("it was written");
    story.tell(&["batch", "published.json", "--out", "again"]).expect_code(0);
    let again = outcomes(&story.path("again/runs.csv"));
    assert_eq!((again.len(), &again), (7, &outcomes(&story.path("first/runs.csv"))));
    let refused = story.tell(&["batch", "published.json", "--seeds", "4"]).expect_code(2);
    assert!(refused.stderr.contains("--seeds would change published.json"), "{}", refused.stderr);
}
