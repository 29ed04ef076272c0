//! `wildfire plan`: a row for each goal and planner, whatever becomes of it, and paths that keep what they promise.

use std::fs;

use serde_json::Value;
use wildfire::geometry::{DVec2, Pose, ops};
use wildfire::vehicle::Dimensions;

use crate::reference::both;
use crate::story::{Story, refuse, widest};

const COLUMNS: &str = "field,goal,planner,success,reason,cpu_build_s,cpu_query_s,length_m,lower_bound_ratio,\
                       min_clearance_m,cusps,drive_s,expansions,violation";

/// 100 m with a wall from the south that leaves a gap in the north, and a bush of its own in the east.
fn field(name: &str, start: &str, goals: &str) -> String {
    let wall = (0..13).map(|row| format!("[10, {row}]")).collect::<Vec<_>>().join(", ");
    format!(
        "{{\"field\": \"{name}\", \"n\": 20, \"cell_m\": 5, \"cells_cr\": [[16, 4], {wall}],\n\
         \"start\": {start},\n\"goals\": [{goals}]}}"
    )
}

const START: &str = "[20, 20, 0]";
const GOALS: &str = "{\"pose\": [75, 15, 2]}, {\"pose\": [30, 70, -1]}, {\"disc\": [82.5, 22.5, 10]}";

/// Two goals in bushes, one on the border, one outside, one that is no number, one far away.
const HOPELESS: &str = "{\"pose\": [52, 30, 0]}, {\"pose\": [80, 22, 0]}, {\"pose\": [0.5, 50, 0]}, \
                        {\"pose\": [-50, 50, 0]}, {\"pose\": [null, 50, 0]}, {\"pose\": [1e6, -1e6, 0]}, \
                        {\"disc\": [1e6, 0, 3]}, {\"disc\": [null, 0, 3]}, {\"disc\": [52.5, 30, 0]}";

fn begin() -> Story {
    let story = Story::begin();
    story.file("mine.json", &field("mine", START, GOALS));
    story
}

/// The rows of a table by name.
fn rows(story: &Story, name: &str) -> Vec<Vec<(String, String)>> {
    let mut reader = csv::Reader::from_path(story.path(name)).expect("it was written");
    let header = reader.headers().expect("a header").clone();
    let named = |row: csv::StringRecord| header.iter().zip(&row).map(|(n, v)| (n.to_owned(), v.to_owned())).collect();
    reader.records().map(|row| named(row.expect("a row"))).collect()
}

fn value<'a>(row: &'a [(String, String)], column: &str) -> &'a str {
    &row.iter().find(|(name, _)| name == column).expect("a column of the table").1
}

fn number(row: &[(String, String)], column: &str) -> f64 {
    value(row, column).parse().unwrap_or_else(|_| panic!("{column} is no number: {row:?}"))
}

/// What does not depend on the machine.
fn outcomes(story: &Story, name: &str) -> Vec<Vec<(String, String)>> {
    let outcome = |row: Vec<(String, String)>| row.into_iter().filter(|(name, _)| !name.starts_with("cpu_")).collect();
    rows(story, name).into_iter().map(outcome).collect()
}

#[test]
fn every_goal_and_planner_has_a_row() {
    let story = begin();
    let names = "lattice,hybrid-astar,prm+primitives";
    story.tell(&["plan", "mine.json", "--planner", names, "--csv", "drives.csv"]).expect_code(0);
    assert_eq!(story.read("drives.csv").lines().next(), Some(COLUMNS));
    let rows = rows(&story, "drives.csv");
    let expected = (0..3).flat_map(|goal| names.split(',').map(move |planner| (goal.to_string(), planner)));
    let found = rows.iter().map(|row| (value(row, "goal").to_owned(), value(row, "planner")));
    assert_eq!(found.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    for row in rows.iter().filter(|row| value(row, "planner") == "hybrid-astar") {
        assert_eq!((value(row, "field"), value(row, "success"), value(row, "reason")), ("mine", "true", ""));
        assert!(number(row, "cpu_build_s") > 0.0 && number(row, "cpu_query_s") > 0.0);
        assert!(number(row, "length_m") > 10.0 && number(row, "lower_bound_ratio") > 0.999_999, "{row:?}");
        assert!(number(row, "min_clearance_m") > 0.01 && number(row, "cusps") < 10.0, "{row:?}");
        // At 8 m/s without limits of acceleration.
        assert!((number(row, "drive_s") - number(row, "length_m") / 8.0).abs() < 1e-6, "{row:?}");
    }
}

#[test]
fn goals_and_starts_that_cannot_be_are_rows_with_a_reason() {
    let story = Story::begin();
    story.file("hopeless.json", &field("hopeless", START, HOPELESS));
    let all = "prm+primitives,prm-rs,hybrid-astar,lattice";
    let answer = story.tell(&["plan", "hopeless.json", "--planner", all, "--csv", "a.csv", "--png", "a.png"]);
    let answer = answer.expect_code(0).stdout;
    assert!(
        answer.contains(" 0/9 ") && answer.contains("lattice: goal blocked 9 times, first on field hopeless, goal 0."),
        "{answer}"
    );
    for row in rows(&story, "a.csv") {
        assert_eq!(value(&row, "success"), "false", "{row:?}");
        assert!(["goal blocked", "disconnected", "budget spent"].contains(&value(&row, "reason")), "{row:?}");
        assert!(["length_m", "lower_bound_ratio", "cusps", "drive_s"].iter().all(|name| value(&row, name).is_empty()));
    }
    for start in ["[52, 30, 0]", "[0, 0, 0]", "[null, 20, 0]", "[20, 20, null]", "[-1e6, 1e6, 0]"] {
        story.file("stuck.json", &field("stuck", start, GOALS));
        story.tell(&["plan", "stuck.json", "--planner", all, "--csv", "b.csv", "--png", "b.png"]).expect_code(0);
        for row in rows(&story, "b.csv") {
            assert_eq!(value(&row, "reason"), "start blocked", "{start}: {row:?}");
        }
    }
}

/// Metres driven, pose and direction of each row of a goal's path.
fn path(rows: &[Vec<(String, String)>], goal: &str) -> Vec<(f64, Pose, String)> {
    let of_goal = rows.iter().filter(|row| value(row, "goal") == goal);
    let sample = |row: &Vec<(String, String)>| {
        let pose = Pose::new(number(row, "x_m"), number(row, "y_m"), number(row, "heading_rad"));
        (number(row, "s_m"), pose, value(row, "direction").to_owned())
    };
    of_goal.map(sample).collect()
}

#[test]
fn written_paths_lead_to_their_goals_as_a_truck_drives() {
    let story = begin();
    story.tell(&["plan", "mine.json", "--planner", "hybrid-astar", "--paths", "paths.csv"]).expect_code(0);
    let header = story.read("paths.csv").lines().next().map(str::to_owned);
    assert_eq!(header.as_deref(), Some("field,goal,planner,s_m,x_m,y_m,heading_rad,direction"));
    let rows = rows(&story, "paths.csv");
    for (goal, expected) in [("0", Pose::new(75.0, 15.0, 2.0)), ("1", Pose::new(30.0, 70.0, -1.0))] {
        let end = path(&rows, goal).last().expect("a path").1;
        assert!(end.position().distance(expected.position()) < 1e-3 && (end.heading - expected.heading).abs() < 1e-3);
    }
    let end = path(&rows, "2").last().expect("a path").1;
    assert!(Dimensions::default().body_centre(end).distance(DVec2::new(82.5, 22.5)) <= 10.0);
    for goal in ["0", "1", "2"] {
        let samples = path(&rows, goal);
        assert_eq!((samples[0].0, samples[0].1), (0.0, Pose::new(20.0, 20.0, 0.0)));
        for pair in samples.windows(2) {
            let ((before, from, _), (after, to, direction)) = (&pair[0], &pair[1]);
            let way = after - before;
            assert!(way > 0.0 && way <= 0.05, "from {before} to {after}");
            let turn = ops::wrap_angle(to.heading - from.heading);
            assert!(turn.abs() <= way / 13.0 + 1e-9, "turns by {turn} on {way} m");
            let heading = Pose::new(0.0, 0.0, from.heading + 0.5 * turn).direction();
            let along = (to.position() - from.position()).dot(heading);
            let sign = if direction == "forward" { 1.0 } else { -1.0 };
            assert!((sign * along - way).abs() < 1e-6, "moves {along} m on {way} m {direction}");
        }
    }
}

#[test]
fn tables_fit_a_terminal_and_compare_the_planners() {
    let story = begin();
    story.file("other.json", &field("a field with a long name", START, GOALS));
    let planners =
        ["plan", "mine.json", "other.json", "--planner", "prm+primitives", "--planner", "hybrid-astar,lattice"];
    let answer = story.tell(&planners).expect_code(0).stdout;
    assert!(widest(&answer) <= 80, "{answer}");
    assert!(answer.starts_with("2 fields, 6 goals, seed 1\n\nSettings of the scenario `drives`.\n"), "{answer}");
    assert!(answer.contains("Budget of hybrid-astar: hybrid.max_expansions="), "the budget is not told: {answer}");
    let summary = |planner: &str| answer.lines().filter(|line| line.starts_with(planner)).count();
    assert!(["prm+primitives", "hybrid-astar", "lattice"].iter().all(|name| summary(name) >= 7), "{answer}");
}

#[test]
fn json_says_what_the_table_says() {
    let story = begin();
    let answer = story.tell(&["plan", "mine.json", "--planner", "hybrid-astar", "--csv", "a.csv", "--json"]);
    let object: Value = serde_json::from_str(&answer.expect_code(0).stdout).expect("the answer is JSON");
    let reported = object["rows"].as_array().expect("a list");
    let rows = rows(&story, "a.csv");
    assert_eq!(reported.len(), rows.len());
    for (member, row) in reported.iter().zip(&rows) {
        assert_eq!(member["success"], true);
        for column in ["length_m", "lower_bound_ratio", "min_clearance_m", "drive_s", "cpu_query_s"] {
            assert_eq!(member[column].as_f64(), Some(number(row, column)), "{column}");
        }
    }
    assert_eq!(object["fields"][0]["goals"][2]["disc"][2], 10.0);
    assert_eq!((&object["summary"][0]["solved"], &object["summary"][0]["violations"]), (&3.into(), &0.into()));
    assert_eq!(object["settings"]["hybrid-astar"]["hybrid.headings"], "24");
}

#[test]
fn same_seed_gives_the_same_drives() {
    let story = Story::begin();
    let tell = |seed: &str, name: &str| {
        let arguments =
            ["plan", "--goals", "3", "--planner", "hybrid-astar,prm+primitives", "--seed", seed, "--csv", name];
        story.tell(&arguments).expect_code(0);
        outcomes(&story, name)
    };
    let (one, two) = (tell("7", "one.csv"), tell("7", "two.csv"));
    assert_eq!(one, two);
    assert_eq!(one.len(), 6);
    assert_ne!(one, tell("8", "three.csv"));
}

#[test]
fn settings_are_those_of_the_scenario_and_its_changes() {
    let story = begin();
    let length = |arguments: &[&str]| {
        story
            .tell(&[&["plan", "mine.json", "--planner", "hybrid-astar", "--csv", "a.csv"], arguments].concat())
            .expect_code(0);
        number(&rows(&story, "a.csv")[0], "length_m")
    };
    assert_ne!(length(&[]), length(&["--set", "unimog.hybrid.clearance_m=2.5"]));
    story.file("short.toml", "wumpus = []\n[[unimog]]\nhybrid.max_expansions = 1\nhybrid.clearance_m = 0.01\n");
    let answer = story.tell(&["plan", "mine.json", "--planner", "hybrid-astar", "--scenario", "short.toml"]);
    assert!(answer.expect_code(0).stdout.contains("budget spent"), "one expansion leads nowhere");
}

#[test]
fn bushes_are_driven_to_as_near_as_the_truck_reaches() {
    let story = begin();
    let planner = ["plan", "mine.json", "--planner", "hybrid-astar", "--cells", "20", "--json"];
    let answer = story.tell(&planner).expect_code(0).stdout;
    let object: Value = serde_json::from_str(&answer).expect("the answer is JSON");
    let goals = object["fields"][0]["goals"].as_array().expect("a list");
    assert_eq!(goals.len(), 14, "each bush once");
    assert!(goals.iter().all(|goal| goal["disc"][2] == 10.0), "{goals:?}");
    assert_eq!(object["summary"][0]["solved"], 14);
    let answer = story.tell(&[&planner[..], &["--set", "suppression.reach_m=3"]].concat()).expect_code(0).stdout;
    let object: Value = serde_json::from_str(&answer).expect("the answer is JSON");
    assert_eq!(object["fields"][0]["goals"][0]["disc"][2], 3.0);
}

#[test]
fn each_field_has_a_picture() {
    let story = begin();
    story.file("b.json", &field("b/c", START, HOPELESS));
    let planner = ["--planner", "hybrid-astar"];
    story.tell(&[&["plan", "mine.json", "--png", "one.png"], &planner[..]].concat()).expect_code(0);
    story.tell(&[&["plan", "mine.json", "b.json", "--png", "all.png"], &planner[..]].concat()).expect_code(0);
    assert_eq!(story.entries(), ["all-b-c.png", "all-mine.png", "b.json", "mine.json", "one.png"]);
    let bytes = |name: &str| fs::read(story.path(name)).expect("it was written");
    assert!(bytes("one.png") == bytes("all-mine.png"), "the same field, the same picture");
}

#[test]
fn questions_that_make_no_sense_are_refused() {
    let story = begin();
    story.file("broken.json", "{\"n\": 20,\n \"cells_cr\": [],\n \"start\": [1, 2 3]}");
    story.file("empty.json", "{\"n\": 20, \"cells_cr\": [], \"start\": [20, 20, 0]}");
    story.file("alone.toml", "wumpus = []\nunimog = []\n");
    fs::copy(story.path("mine.json"), story.path("again.json")).expect("writable");
    for (arguments, fragment) in [
        ("plan broken.json --csv a.csv", &["broken.json:3", "this is not JSON"] as &[&str]),
        ("plan nothing.json", &["nothing.json", "cannot be read"]),
        ("plan contest", &["`contest` cannot be read", "--scenario contest"]),
        ("plan empty.json", &["`empty` has no goals", "--cells"]),
        ("plan empty.json --cells 3", &["`empty` has no bushes", "leave out --cells"]),
        ("plan mine.json again.json", &["again.json", "another field is also named `mine`"]),
        ("plan mine.json --planner rrt", &["--planner", "prm-rs", "hybrid-astar"]),
        ("plan mine.json --goals 3", &["--goals"]),
        ("plan --goals 3 --cells 3", &["--cells"]),
        ("plan --cells 0", &["--cells", "from 1 to 10000"]),
        ("plan --cells 3 --set suppression.reach_m=none", &["`suppression.reach_m` is \"none\""]),
        ("plan --scenario alone.toml", &["no truck", "[[unimog]]"]),
        ("plan --set unimog.hybrid.headings=1", &["unimog.hybrid.headings", "from 4 to 360"]),
        ("plan mine.json --csv mine.json", &["mine.json", "two files"]),
        ("plan mine.json --csv a.csv --paths a.csv", &["a.csv", "two files"]),
    ] {
        refuse(&story, &arguments.split_whitespace().collect::<Vec<_>>(), fragment);
    }
    refuse(&story, &["plan", "mine.json", "--csv", "none/a.csv"], &["none/a.csv", "the folder does not exist"]);
}

#[test]
fn all_goals_of_the_reference_are_reached_without_a_violation() {
    for folder in both("plan") {
        let story = Story::begin();
        let mut lengths = csv::Reader::from_path(folder.join("lengths.csv")).expect("it can be read");
        let bounds_m: Vec<[f64; 3]> = lengths
            .records()
            .map(|row| {
                let row = row.expect("a row");
                [0, 1, row.len() - 1].map(|column| row[column].parse().expect("a number"))
            })
            .collect();
        let paths = (0..5).map(|number| folder.join(format!("field_{number:02}.json")));
        let fields: Vec<String> = paths.filter(|path| path.exists()).map(|path| path.display().to_string()).collect();
        let fields: Vec<&str> = fields.iter().map(String::as_str).collect();
        let options = ["--planner", "hybrid-astar,prm-rs", "--csv", "drives.csv"];
        story.tell(&[&["plan"], &fields[..], &options].concat()).expect_code(0);
        let rows = rows(&story, "drives.csv");
        assert_eq!(rows.len(), 2 * bounds_m.len());
        for row in &rows {
            assert_eq!(value(row, "success"), "true");
            let ratio = number(row, "lower_bound_ratio");
            let is_meant = |bound: &&[f64; 3]| bound[0] == number(row, "field") && bound[1] == number(row, "goal");
            let [.., bound_m] = bounds_m.iter().find(is_meant).expect("every drive has a bound");
            let found_m = number(row, "length_m") / ratio;
            // Lengths are printed in millimetres.
            assert!(ratio > 0.999_999 && (found_m - bound_m).abs() < 2e-3, "{row:?}: {found_m}, not {bound_m}");
        }
    }
}

#[test]
fn example_of_a_field_file_is_one() {
    let readme = include_str!("../../scenarios/README.md");
    let (_, section) = readme.split_once("\n## Field files\n").expect("the section is there");
    let (_, example) = section.split_once("```json\n").expect("an example is there");
    let story = Story::begin();
    story.file("example.json", example.split("```").next().unwrap_or_default());
    let answer = story.tell(&["plan", "example.json"]).expect_code(0).stdout;
    assert!(answer.starts_with("Field `two bushes`, 2 goals, ") && answer.contains(" 2/2 "), "{answer}");
}
