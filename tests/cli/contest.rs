//! The program from end to end: scenarios in, tables, rows and files out.

use std::path::Path;

use crate::story::{LARGE, Story, outcomes, widest};

/// A field on which no piece finds a place, since nothing may grow near the starts.
const NO_ROOM: [&str; 2] = ["--set", "field.start_clearance_m=300"];

fn column(path: &Path, name: &str) -> Vec<String> {
    let rows = outcomes(path);
    let index = rows[0].iter().position(|column| column == name).expect("the column is there");
    rows[1..].iter().map(|row| row[index].clone()).collect()
}

#[test]
fn batch_without_arguments_plays_the_contest_and_prints_both_tables() {
    let story = Story::begin();
    let answer = story.tell(&["batch"]).expect_code(0);
    for fragment in ["TABLE I.", "TABLE II.", "Champion: ", "5 finished, none failed", "Files: runs/contest"] {
        assert!(answer.stdout.contains(fragment), "`{fragment}` is missing:\n{}", answer.stdout);
    }
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
    assert!(answer.stderr.is_empty(), "no progress where there is no terminal: {}", answer.stderr);
    let runs = story.path("runs/contest/runs.csv");
    assert_eq!(column(&runs, "seed"), ["1", "2", "3", "4", "5"]);
    assert!(column(&runs, "status").iter().all(|status| status == "done"));
    assert!(column(&runs, "truck_stuck_s").iter().all(|stuck| stuck == "0"));
    assert!(column(&runs, "wumpus_stuck_s").iter().all(|stuck| stuck == "0"));
    assert_eq!(outcomes(&story.path("runs/contest/agents.csv")).len(), 1 + 2 * 5);
}

#[test]
fn states_add_up_to_the_obstacles() {
    let story = Story::begin();
    story.tell(&["batch", "--seeds", "11..13", "--out", "out"]).expect_code(0);
    let runs = story.path("out/runs.csv");
    let counts =
        |name| column(&runs, name).iter().map(|count| count.parse::<u32>().expect("a count")).collect::<Vec<_>>();
    let states = ["intact", "burning", "burned_out", "extinguished"].map(counts);
    for (run, obstacles) in counts("obstacles").into_iter().enumerate() {
        assert_eq!(states.iter().map(|state| state[run]).sum::<u32>(), obstacles);
    }
}

#[test]
fn same_seeds_give_the_same_rows_whatever_the_number_of_workers() {
    let story = Story::begin();
    for (jobs, out) in [("1", "one"), ("2", "two")] {
        story.tell(&["batch", "smoke", "--seeds", "1..20", "--jobs", jobs, "--out", out]).expect_code(0);
    }
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&story.path("one").join(file)), outcomes(&story.path("two").join(file)), "{file}");
    }
}

#[test]
fn one_run_says_what_its_row_in_a_batch_says() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "7,3", "--out", "out"]).expect_code(0);
    let rows = outcomes(&story.path("out/runs.csv"));
    let answer = story.tell(&["run", "smoke", "--seed", "7", "--json"]).expect_code(0);
    let json: serde_json::Value = serde_json::from_str(&answer.stdout).expect("stdout is one JSON object");
    for (name, field) in rows[0].iter().zip(&rows[1]) {
        let value = match &json["run"][name] {
            serde_json::Value::Null => String::new(),
            serde_json::Value::String(text) => text.clone(),
            number => number.as_f64().expect("a number").to_string(),
        };
        assert_eq!(value, *field, "{name}");
    }
}

#[test]
fn agents_that_can_do_nothing_are_told_by_the_check_the_run_and_the_batch() {
    let mute = ["smoke", "--set", "wumpus.reach_m=2.4"];
    let scattered = [
        "smoke",
        "--set",
        "unimog.planner=prm+primitives",
        "--set",
        "unimog.prm.samples=20",
        "--set",
        "unimog.prm.max_edge_m=1",
    ];
    let cases = [
        (
            &mute[..],
            "light none of the 40 bushes",
            "wumpus/0 can light nothing: none of the 40 bushes is in its reach.",
        ),
        (&scattered[..], "hardly connected: 20 milestones in 20", "unimog/0 is hardly connected: 20 milestones in 20"),
    ];
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let story = Story::begin();
    for (scenario, warning, note) in cases {
        let tell = |command: &[&str]| {
            let answer = story.tell(&[&command[..1], scenario, &command[1..]].concat()).expect_code(0);
            assert!(widest(&answer.stdout) <= 80 || command.contains(&"--json"), "{}", answer.stdout);
            answer.stdout
        };
        assert!(joined(&tell(&["check"])).contains(warning), "{warning}");
        let run = joined(&tell(&["run"]));
        assert!(run.contains("Note: ") && run.contains(note), "{run}");
        let json: serde_json::Value = serde_json::from_str(&tell(&["run", "--json"])).expect("one JSON object");
        assert!(json["notes"][0].as_str().is_some_and(|text| text.contains(note)), "{json}");
        let batch = joined(&tell(&["batch", "--seeds", "1..3"]));
        assert!(batch.contains("In 3 of 3 runs an agent could do almost nothing; seed 1:"), "{batch}");
        assert!(batch.contains(note), "{batch}");
    }
    let json = story.tell(&["run", "smoke", "--json"]).expect_code(0).stdout;
    assert!(json.contains("\"notes\":[]") && !story.tell(&["check", "smoke"]).stdout.contains("hardly connected"));
    let sweep = ["batch", "smoke", "--seeds", "1..2", "--set", "wumpus.reach_m=2.4,6.25"];
    let overview = story.tell(&sweep).expect_code(0).stdout;
    assert!(overview.contains("\n1: In 2 of 2 runs an agent could do almost nothing; seed 1:"), "{overview}");
    assert!(!overview.contains("\n2: In "), "{overview}");
}

#[test]
fn run_names_the_winner_and_where_the_time_went() {
    let answer = Story::begin().tell(&["run", "--seed", "2"]).expect_code(0);
    for fragment in ["contest, seed 2", "extinguished", "wins,", "unimog/0", "wumpus/0", "local search", "CPU per plan"]
    {
        assert!(answer.stdout.contains(fragment), "`{fragment}` is missing:\n{}", answer.stdout);
    }
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
}

#[test]
fn run_hands_its_facts_to_other_tools() {
    let story = Story::begin();
    let outputs = ["--out", "run.wildfire", "--events", "events.csv", "--trace", "trace.csv", "--step", "10"];
    let answer = story.tell(&[&["run", "--seed", "4", "--quiet"], outputs.as_slice()].concat()).expect_code(0);
    assert!(answer.stderr.is_empty(), "{}", answer.stderr);
    assert_eq!(story.entries(), ["events.csv", "run.wildfire", "trace.csv"]);
    assert!(story.read("events.csv").starts_with("t_s,event,agent,col,row,detail\n"));
    assert!(story.read("trace.csv").starts_with("t_s,agent,x_m,y_m,heading_rad,speed_mps,activity\n"));
    let bytes = std::fs::metadata(story.path("run.wildfire")).expect("it was written").len();
    assert!(bytes <= 50_000, "a recording has {bytes} bytes");
}

#[test]
fn recordings_of_a_batch_are_kept_when_asked_for() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..2", "--record", "all", "--out", "out"]).expect_code(0);
    story.tell(&["run", "smoke", "--seed", "2", "--out", "alone.wildfire"]).expect_code(0);
    let recorded = std::fs::read(story.path("out/recordings/seed-2.wildfire")).expect("it was kept");
    let alone = std::fs::read(story.path("alone.wildfire")).expect("it was written");
    assert!(recorded == alone, "the same run was recorded differently");
}

#[test]
fn later_batches_take_the_next_free_folder() {
    let story = Story::begin();
    for folder in ["runs/smoke", "runs/smoke-2", "runs/smoke-3"] {
        let answer = story.tell(&["batch", "smoke", "--seeds", "1"]).expect_code(0);
        assert!(answer.stdout.contains(&format!("\nFiles: {folder}\n")), "{}", answer.stdout);
    }
}

#[test]
fn force_replaces_the_files_of_a_batch_and_nothing_else() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "out"]).expect_code(0);
    story.file("out/notes.txt", "mine");
    story.tell(&["batch", "smoke", "--seeds", "4", "--out", "out", "--force"]).expect_code(0);
    assert_eq!(column(&story.path("out/runs.csv"), "seed"), ["4"]);
    assert_eq!(story.read("out/notes.txt"), "mine");
}

#[test]
fn runs_that_cannot_take_place_are_rows_and_the_batch_is_complete() {
    let story = Story::begin();
    let batch = ["batch", "smoke", "--seeds", "1..3", "--out", "out"];
    let answer = story.tell(&[batch.as_slice(), &NO_ROOM].concat()).expect_code(1);
    assert!(answer.stdout.contains("0 finished, 3 failed"), "{}", answer.stdout);
    let runs = story.path("out/runs.csv");
    assert_eq!(column(&runs, "status"), ["failed"; 3]);
    assert!(column(&runs, "message").iter().all(|message| message.contains("no placement left")));
    assert!(column(&runs, "obstacles").iter().all(String::is_empty));
}

#[test]
fn run_that_cannot_take_place_says_why() {
    let story = Story::begin();
    let run = ["run", "smoke", "--events", "events.csv"];
    story.tell(&[run.as_slice(), &NO_ROOM].concat()).expect_code(1).expect_complaint(&["no placement left"]);
    assert!(story.entries().is_empty());
    let answer = story.tell(&[&["run", "smoke", "--json"], NO_ROOM.as_slice()].concat()).expect_code(1);
    let json: serde_json::Value = serde_json::from_str(&answer.stdout).expect("stdout is one JSON object");
    assert_eq!(json["run"]["status"], "failed");
}

#[test]
fn a_batch_opens_with_who_won_and_what_was_saved_and_ends_with_a_command_that_shows_a_run() {
    let story = Story::begin();
    let batch = |arguments: &[&str]| story.tell(&[&["batch"], arguments].concat()).expect_code(0).stdout;
    // Lines without the breaks of sentences.
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let opening = |text: &str| flat(text.split("\n\n").nth(1).expect("there is an opening"));
    let text = batch(&["smoke", "--seeds", "1..30", "--out", "many"]);
    assert!(opening(&text).starts_with("The ") && opening(&text).contains(" of 30 runs"), "{text}");
    assert!(opening(&text).contains(" % of ") && opening(&text).contains(" bushes (mean; 95 % interval "), "{text}");
    assert!(text.contains("\nPage with charts: wildfire report many\n"), "{text}");
    let table = text.find("TABLE I.").expect("it is there");
    assert!(text.find("wildfire report").is_some_and(|place| place < table), "the answer comes first: {text}");
    assert!(text.contains("All 30 runs are in runs.csv") && !text.contains("Seed"), "{text}");
    let last = text.lines().last().expect("a line");
    let command = last.strip_prefix("Watch a run: wildfire ").expect(last);
    assert_eq!(command, "render many --seed 1 --page seed-1.html");
    story.tell(&command.split(' ').collect::<Vec<_>>()).expect_code(0);
    assert!(story.read("seed-1.html").starts_with("<!DOCTYPE html>"));
    let one = batch(&["smoke", "--seeds", "7", "--out", "one"]);
    assert!(!opening(&one).contains("mean") && !opening(&one).contains(" of 1 "), "{one}");
    let alone = batch(&["wumpus-alone", "--seeds", "1..3", "--out", "alone"]);
    assert!(opening(&alone).starts_with("Without trucks, ") && opening(&alone).ends_with("did not burn."), "{alone}");
    let several = batch(&["smoke", "--planner", "prm-rs,lattice", "--seeds", "1..3", "--out", "several"]);
    assert!(opening(&several).starts_with("6 runs of 2 variants finished; "), "{several}");
    assert!(several.contains("\nDifferences: wildfire compare several\n"), "{several}");
    story.tell(&["compare", "several"]).expect_code(0);
}

#[test]
fn agents_of_one_side_play_no_contest() {
    let story = Story::begin();
    for name in ["wumpus-alone", "unimog-alone"] {
        let answer = story.tell(&["run", name]).expect_code(0);
        assert!(answer.stdout.contains("No contest"), "{}", answer.stdout);
        let answer = story.tell(&["batch", name, "--seeds", "1..2"]).expect_code(0);
        assert!(!answer.stdout.contains("Champion"), "{}", answer.stdout);
    }
}

#[test]
fn a_fire_on_the_ground_is_told_without_bushes_and_points() {
    let answer = Story::begin().tell(&["run", "line", "--set", "duration_s=60"]).expect_code(0);
    assert!(answer.stdout.contains("Ground: "), "{}", answer.stdout);
    for word in ["Obstacles", "contest", "Wumpus", "Agent", "search"] {
        assert!(!answer.stdout.contains(word), "{word}: {}", answer.stdout);
    }
}

#[test]
fn every_built_in_scenario_runs() {
    run_presets(|name| !LARGE.contains(&name));
}

#[test]
#[ignore = "tier 2: a run of each large preset"]
fn every_large_built_in_scenario_runs() {
    run_presets(|name| LARGE.contains(&name));
}

fn run_presets(is_selected: fn(&str) -> bool) {
    let story = Story::begin();
    for (name, _) in wildfire::scenario::BUILT_IN.iter().filter(|(name, _)| is_selected(name)) {
        story.tell(&["run", name, "--seed", "5", "--quiet"]).expect_code(0);
    }
}
