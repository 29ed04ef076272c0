//! `wildfire judge`: what the program's own planners found is sound and measures the same; what others bring is held
//! against the rules, and what is no table of paths is refused with its line.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::fs;

use serde_json::Value;
use wildfire::geometry::Pose;
use wildfire::vehicle::{Path, Segment};

use crate::story::{Story, refuse, widest};

const ALL: &str = "prm+primitives,prm-rs,hybrid-astar,lattice";
const HEADER: &str = "field,goal,planner,x_m,y_m,heading_rad,direction";

/// A bush from (50, 20) to (55, 25) on 100 m by 100 m, the truck in the west.
const FIELD: &str = "{\"field\": \"mine\", \"n\": 20, \"cell_m\": 5, \"cells_cr\": [[10, 4]], \"start\": [20, 22.5, 0],\n\
                     \"goals\": [{\"pose\": [40, 22.5, 0]}, {\"disc\": [52.5, 22.5, 10]}, {\"pose\": [33, 35.5, 1.5707963267948966]}]}";

const START: Pose = Pose { x: 20.0, y: 22.5, heading: 0.0 };

fn begin() -> Story {
    let story = Story::begin();
    story.file("mine.json", FIELD);
    story
}

type Row = Vec<(String, String)>;

#[test]
fn certified_bounds_hold_and_those_that_were_changed_are_refused() {
    let story = begin();
    let plan =
        ["plan", "mine.json", "--planner", "hybrid-astar,prm-rs", "--certify", "bounds.json", "--csv", "drives.csv"];
    story.tell(&plan).expect_code(0);
    for row in rows(&story, "drives.csv") {
        let bound = value(&row, "certified_bound_m");
        // The second goal is a disc: its drives have no bound.
        assert_eq!(bound.is_empty(), value(&row, "goal") == "1");
        let length_m: f64 = value(&row, "length_m").parse().expect("a length");
        assert!(bound.is_empty() || bound.parse::<f64>().is_ok_and(|bound_m| bound_m > 0.9 * length_m), "{row:?}");
    }
    story.tell(&["plan", "report", "drives.csv", "--out", "drives.html"]).expect_code(0);
    let judge = ["judge", "mine.json", "--certificate", "bounds.json", "--json"];
    let text = story.read("bounds.json");
    let report: Value = serde_json::from_str(&story.tell(&judge).expect_code(0).stdout).expect("one object");
    let found = report["rows"].as_array().expect("rows");
    assert_eq!(found.iter().map(|row| row["goal"].as_u64()).collect::<Vec<_>>(), [Some(0), Some(2)]);
    assert!(found.iter().all(|row| row["fault"].is_null() && row["clearance_m"] == 0.01), "{report}");
    let mut changed: Value = serde_json::from_str(&text).expect("one object");
    let bound = &mut changed["certificates"][0]["certificate"]["bound_m"];
    *bound = (bound.as_f64().expect("metres") + 1.0).into();
    changed["certificates"][1]["goal"] = 0.into();
    story.file("bounds.json", &changed.to_string());
    let answer = story.tell(&judge[..4]).expect_code(4);
    assert!(answer.stdout.contains("0 of 2 certificates hold"), "{}", answer.stdout);
    assert!(answer.stdout.contains("for another start or goal"), "{}", answer.stdout);
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
    story.file("bounds.json", &text.replace("mine", "other"));
    refuse(&story, &judge[..4], &["bounds.json", "certificate 0", "goal 0 of the field other"]);
    story.file("bounds.json", &text.replace("\"wildfire_certificates\":1", "\"wildfire_certificates\":2"));
    refuse(&story, &judge[..4], &["bounds.json", "format 2"]);
    refuse(&story, &["judge", "mine.json", "--certificate", "mine.json"], &["mine.json", "wildfire plan --certify"]);
}

fn rows(story: &Story, name: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(story.path(name)).expect("it was written");
    let header = reader.headers().expect("a header").clone();
    let named = |row: csv::StringRecord| header.iter().zip(&row).map(|(n, v)| (n.to_owned(), v.to_owned())).collect();
    reader.records().map(|row| named(row.expect("a row"))).collect()
}

fn value<'a>(row: &'a Row, column: &str) -> &'a str {
    &row.iter().find(|(name, _)| name == column).expect("a column of the table").1
}

/// The rows of a path to a goal of the field, with poses this far apart.
fn table_rows(goal: usize, planner: &str, path: &Path, step_m: f64) -> String {
    let mut text = String::new();
    let mut write = |pose: Pose, is_reverse: bool| {
        let Pose { x, y, heading } = pose;
        let direction = if is_reverse { "reverse" } else { "forward" };
        writeln!(text, "mine,{goal},{planner},{x},{y},{heading},{direction}").expect("text grows");
    };
    write(path.start, path.segments.first().is_some_and(Segment::is_reverse));
    for (start, segment) in path.legs() {
        let leg = Path { start, segments: vec![segment] };
        leg.samples(step_m).skip(1).for_each(|(_, pose)| write(pose, segment.is_reverse()));
    }
    text
}

fn path(segments: &[(f64, f64)]) -> Path {
    let segment = |&(curvature, length_m)| Segment { curvature, length_m };
    Path { start: START, segments: segments.iter().map(segment).collect() }
}

/// What the program says of one path to a goal.
fn judged(goal: usize, path: &Path, step_m: f64, code: i32) -> Value {
    let story = begin();
    story.file("paths.csv", &format!("{HEADER}\n{}", table_rows(goal, "theirs", path, step_m)));
    let answer = story.tell(&["judge", "mine.json", "paths.csv", "--json"]).expect_code(code);
    let report: Value = serde_json::from_str(&answer.stdout).expect("a JSON object");
    report["rows"][goal].clone()
}

fn violation(goal: usize, path: &Path, step_m: f64) -> String {
    judged(goal, path, step_m, 4)["violation"].as_str().expect("something is wrong with it").to_owned()
}

#[test]
fn paths_of_all_planners_are_sound_and_have_the_same_figures() {
    let accelerating =
        ["unimog.limits.acceleration_mps2=1.5", "unimog.limits.braking_mps2=3", "unimog.limits.lateral_mps2=4"];
    let slow = accelerating.map(|change| ["--set", change]).concat();
    for (scenario, goals, more) in [
        ("contest", ["--goals", "12"], &[][..]),
        ("contest", ["--cells", "12"], &slow[..]),
        ("dense", ["--goals", "12"], &[][..]),
        ("fleet", ["--cells", "12"], &[][..]),
    ] {
        let story = Story::begin();
        let problem = [&["--scenario", scenario, "--seed", "3"][..], &goals, more].concat();
        let plan = [&["plan", "--planner", ALL, "--csv", "drives.csv", "--paths", "paths.csv"][..], &problem].concat();
        story.tell(&plan).expect_code(0);
        story.tell(&[&["judge", "paths.csv", "--csv", "judged.csv"][..], &problem].concat()).expect_code(0);
        let (drives, judged) = (rows(&story, "drives.csv"), rows(&story, "judged.csv"));
        assert_eq!(drives.len(), judged.len(), "{scenario}");
        let mut sound = 0;
        for drive in &drives {
            let same = |row: &&Row| ["goal", "planner"].iter().all(|key| value(row, key) == value(drive, key));
            let row = judged.iter().find(same).expect("every attempt was judged");
            assert_eq!((value(row, "success"), value(row, "violation")), (value(drive, "success"), ""), "{row:?}");
            if value(drive, "success") == "false" {
                assert_eq!(value(row, "reason"), "no path");
                continue;
            }
            sound += 1;
            assert_eq!(value(row, "cusps"), value(drive, "cusps"), "{drive:?}");
            for (column, tolerance) in
                [("length_m", 1e-6), ("lower_bound_ratio", 1e-6), ("drive_s", 1e-6), ("min_clearance_m", 0.02)]
            {
                let [found, expected] = [row, drive].map(|row| value(row, column).parse::<f64>().ok());
                let is_near = found.zip(expected).map(|(found, expected)| (found - expected).abs() <= tolerance);
                assert!(is_near != Some(false), "{column}: {found:?}, not {expected:?}: {drive:?}");
                assert_eq!(found.is_some(), expected.is_some(), "{column}: {drive:?}");
            }
        }
        assert!(sound > 30, "{scenario}: {sound} paths");
    }
}

#[test]
fn a_path_of_anybodys_is_judged_with_its_figures() {
    // Columns in another order, some of them unknown, none that name field and planner; single precision.
    let story = begin();
    let mut table = String::from("t_s,heading_rad,direction,x_m,y_m,goal\n");
    for step in 0..=40 {
        let x = 20.0_f32 + 0.5 * step as f32;
        writeln!(table, "{step},{:e},forward,{x},22.5,0", 0.0_f32).expect("text grows");
    }
    story.file("paths.csv", &table);
    let answer = story.tell(&["judge", "mine.json", "paths.csv"]).expect_code(0).stdout;
    assert!(answer.starts_with("Field `mine`, 3 goals: paths of 1 planner\n"), "{answer}");
    assert!(answer.contains("paths      0  20.00 1.000   5.49     0   2.5   sound"), "{answer}");
    assert!(answer.contains("paths: no path 2 times, first on field mine, goal 1."), "{answer}");
    assert!(answer.contains(" 1/3 ") && widest(&answer) <= 80, "{answer}");

    // The same as a spreadsheet writes it.
    story.file("paths.csv", &format!("sep=;\r\n{}", table.replace(',', ";").replace('.', ",")));
    assert_eq!(story.tell(&["judge", "mine.json", "paths.csv"]).expect_code(0).stdout, answer);
    story.file("paths.csv", &table.replace(',', "\t"));
    assert_eq!(story.tell(&["judge", "mine.json", "paths.csv"]).expect_code(0).stdout, answer);

    let turning = path(&[(1.0 / 13.0, 13.0 * FRAC_PI_2)]);
    for step_m in [0.05, 0.31, 0.5] {
        let row = judged(2, &turning, step_m, 0);
        assert_eq!((&row["success"], &row["cusps"]), (&Value::Bool(true), &Value::from(0)));
        assert!((row["length_m"].as_f64().expect("a length") - turning.length_m()).abs() < 1e-9, "{row}");
        assert!((row["lower_bound_ratio"].as_f64().expect("a ratio") - 1.0).abs() < 1e-9, "{row}");
    }
    // A truck that is told to stay where it is, in reach of nothing.
    assert!(violation(0, &Path::standing(START), 0.5).contains("line 2: it ends 20.0000 m"));
}

#[test]
fn cusps_are_changes_of_direction() {
    let row = judged(0, &path(&[(0.0, 22.0), (0.0, -4.0), (0.0, 2.0)]), 0.4, 0);
    assert_eq!((&row["cusps"], &row["length_m"], &row["success"]), (&2.into(), &28.0.into(), &true.into()));
}

#[test]
fn what_breaks_a_rule_is_told_with_line_and_place() {
    let through = path(&[(0.0, 28.0)]);
    let message = violation(1, &through, 0.05);
    assert!(
        message.starts_with("line 5")
            && message.contains("26.0")
            && message.contains("deep in the bush at cell (10, 4)"),
        "{message}"
    );

    let sharp = path(&[(0.0, 3.0), (1.0 / 12.6, 5.0)]);
    let message = violation(0, &sharp, 0.5);
    assert!(
        message.starts_with("line 9, 3.00 m along, at (23.00, 22.50): a curvature of 0.0794 1/m; the limit is 0.0787"),
        "{message}"
    );
    assert!(!violation(0, &path(&[(1.0 / 12.8, 5.0)]), 0.5).contains("curvature"), "a little more is allowed");
    let near_the_limit = (0..8).map(|step| violation(0, &path(&[(1.0 / (12.69 + 0.003 * f64::from(step)), 5.0)]), 0.5));
    let compared = near_the_limit.filter_map(|message| {
        let (_, found) = message.split_once("a curvature of ")?;
        let (found, limit) = found.split_once(" 1/m; the limit is ")?;
        Some([found, limit.split_once(' ')?.0].map(|number| number.parse::<f64>().expect("a number")))
    });
    let compared: Vec<[f64; 2]> = compared.collect();
    assert!(!compared.is_empty() && compared.iter().all(|[found, limit]| found > limit), "{compared:?}");

    let story = begin();
    let crab: String = (0..100)
        .map(|k| format!("mine,0,crab,{},{},0,forward\n", 20.0 + 0.1 * f64::from(k), 22.5 + 0.001 * f64::from(k)))
        .collect();
    let spot = "mine,1,spot,20,22.5,0,forward\nmine,1,spot,20,22.5,0.1,forward\n";
    let away = "mine,0,away,20,22.51,0,forward\nmine,0,away,20.5,22.51,0,forward\n";
    let turned = "mine,0,turned,20,22.5,0.002,forward\n";
    story.file("paths.csv", &format!("{HEADER}\n{crab}{spot}{away}{turned}"));
    let answer = story.tell(&["judge", "mine.json", "paths.csv", "--csv", "judged.csv"]).expect_code(4).stdout;
    for fragment in [
        "crab: violation on field mine, goal 0: line ",
        " mm sideways on 0.100 m, the limit is ",
        "spot: violation on field mine, goal 1: line 103, 0.00 m along, at (20.00, 22.50): it turns by 0.1000 rad on the spot",
        "away: violation on field mine, goal 0: line 104: it begins 0.0100 m and 0.0000 rad away from the start",
        "turned: violation on field mine, goal 0: line 106: it begins 0.0000 m and 0.0020 rad away from the start",
    ] {
        let flat = answer.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(fragment.trim()), "{fragment}\n{answer}");
    }
    assert!(widest(&answer) <= 80, "{answer}");
    assert!(rows(&story, "judged.csv").iter().all(|row| value(row, "success") == "false"));
}

#[test]
fn planners_are_set_beside_with_paired_differences() {
    let story = Story::begin();
    let problem = ["--seed", "5", "--goals", "20"];
    story.tell(&[&["plan", "--planner", "prm-rs", "--paths", "paths.csv"][..], &problem].concat()).expect_code(0);
    let beside = [&["judge", "paths.csv", "--against", "prm-rs,lattice"][..], &problem].concat();
    let answer = story.tell(&beside).expect_code(0).stdout;
    assert!(answer.contains("prm-rs against prm-rs (asked)") && answer.contains("prm-rs against lattice"), "{answer}");
    assert!(widest(&answer) <= 80, "{answer}");
    let report = story.tell(&[&beside[..], &["--json"]].concat()).expect_code(0).stdout;
    let report: Value = serde_json::from_str(&report).expect("a JSON object");
    let comparisons = report["comparisons"].as_array().expect("a list");
    assert_eq!(comparisons.len(), 12);
    let number = |comparison: &Value, member: &str| comparison[member].as_f64().expect("a number");
    for comparison in comparisons {
        let metric = comparison["metric"].as_str().expect("a name");
        if comparison["against"] == "prm-rs (asked)" {
            let tolerance = if metric == "min_clearance_m" { 0.02 } else { 1e-6 };
            assert!(number(comparison, "difference").abs() < tolerance, "{comparison}");
        } else if metric == "length_m" {
            // The lattice's drives are much longer.
            assert!(number(comparison, "high") < -10.0 && number(comparison, "p") < 0.01, "{comparison}");
            assert!(number(comparison, "low") < number(comparison, "difference"));
        }
    }
    for form in ["--md", "--html", "--tex"] {
        assert!(story.tell(&[&beside[..], &[form]].concat()).expect_code(0).stdout.contains("lattice"));
    }
}

#[test]
fn several_fields_are_told_apart_by_their_column() {
    let story = begin();
    story.file("other.json", &FIELD.replace("\"mine\"", "\"=2+3, a \\\"field\\\"\""));
    let files = ["mine.json", "other.json"];
    story
        .tell(&[&["plan"][..], &files, &["--planner", "hybrid-astar", "--paths", "paths.csv"]].concat())
        .expect_code(0);
    let answer = story.tell(&[&["judge"][..], &files, &["paths.csv", "--csv", "judged.csv"]].concat()).expect_code(0);
    assert!(answer.stdout.starts_with("2 fields, 6 goals: paths of 1 planner") && answer.stdout.contains(" 6/6 "));
    assert_eq!(value(&rows(&story, "judged.csv")[3], "field"), "'=2+3, a \"field\"");
    story.file("nameless.csv", "goal,x_m,y_m,heading_rad,direction\n0,20,22.5,0,forward\n");
    let arguments = [&["judge"][..], &files, &["nameless.csv"]].concat();
    refuse(
        &story,
        &arguments,
        &["nameless.csv: line 1: the column field is missing, which identifies one of 2 \
        fields"],
    );
    refuse(&story, &["judge", "mine.json", "paths.csv"], &["paths.csv: line ", "column field: found", "expected mine"]);
}

#[test]
fn the_drives_of_a_recorded_run_are_judged() {
    let story = Story::begin();
    for (scenario, trucks) in [("contest", 1), ("fleet", 3)] {
        let run = ["run", scenario, "--seed", "4", "--set", "duration_s=300", "--out", "run.wildfire", "--json"];
        story.tell(&run).expect_code(0);
        let judge = ["judge", "--recording", "run.wildfire", "--csv", "drives.csv", "--json"];
        let report: Value = serde_json::from_str(&story.tell(&judge).expect_code(0).stdout).expect("JSON");
        let drives = rows(&story, "drives.csv");
        assert!(drives.len() > 10, "{} drives", drives.len());
        assert_eq!(report["rows"].as_array().map(Vec::len), Some(drives.len()));
        assert_eq!(report["summary"].as_array().map(Vec::len), Some(trucks), "{}", report["summary"]);
        assert!(drives.iter().all(|row| value(row, "violation").is_empty()));
        assert!(drives.iter().all(|row| ["", "dropped"].contains(&value(row, "reason"))));
        fs::remove_file(story.path("run.wildfire")).expect("it was written");
    }
    story.tell(&["run", "contest", "--set", "duration_s=120", "--out", "short.wildfire"]).expect_code(0);
    let answer = story.tell(&["judge", "--recording", "short.wildfire", "--against", "hybrid-astar"]).expect_code(0);
    assert!(answer.stdout.contains("unimog/0 against hybrid-astar"), "{}", answer.stdout);
    let nobody = ["judge", "--recording", "short.wildfire", "--against", "prm-rs", "--scenario", "nobody.toml"];
    story.file("nobody.toml", "wumpus = []\nunimog = []\n");
    refuse(&story, &nobody, &["has no truck"]);
    refuse(&story, &["judge", "--recording", "none.wildfire"], &["none.wildfire"]);
    story.file("broken.wildfire", "no recording");
    refuse(&story, &["judge", "--recording", "broken.wildfire"], &["broken.wildfire"]);
    let nobody = ["run", "contest", "--set", "duration_s=1", "--out", "still.wildfire"];
    story.tell(&nobody).expect_code(0);
    refuse(&story, &["judge", "--recording", "still.wildfire"], &["no truck drives in this run"]);
}

#[test]
fn what_is_no_table_of_paths_is_refused_with_its_line() {
    let story = begin();
    let good = "mine,0,theirs,20,22.5,0,forward";
    let long = "x".repeat(70_000);
    for (text, fragment) in [
        (String::new(), "paths.csv: the file is empty; expected a header with the columns field,goal,planner"),
        (HEADER.to_owned(), "paths.csv: the file has no row after its header"),
        (format!("{HEADER}\n\n \n"), "the file has no row after its header"),
        ("a,b\n1,2\n".to_owned(), "line 1: the column goal is missing; expected a header with field,goal,planner,x_m"),
        (format!("{HEADER},x_m\n"), "line 1: the column x_m appears twice"),
        (format!("{HEADER}\n{good},1\n"), "line 2: found 8 columns, expected 7 as in the header"),
        (format!("{HEADER}\nother,0,theirs,20,22.5,0,forward"), "line 2, column field: found \"other\", expected mine"),
        (
            format!("{HEADER}\nmine,3,theirs,20,22.5,0,forward"),
            "line 2, column goal: found \"3\", expected a whole number from 0 to 2",
        ),
        (format!("{HEADER}\nmine,-1,theirs,20,22.5,0,forward"), "line 2, column goal: found \"-1\""),
        (format!("{HEADER}\nmine,0,,20,22.5,0,forward"), "line 2, column planner: found \"\", expected a name"),
        (
            format!("{HEADER}\nmine,0,theirs,nan,22.5,0,forward"),
            "line 2, column x_m: found \"nan\", expected a number from",
        ),
        (format!("{HEADER}\nmine,0,theirs,20,inf,0,forward"), "line 2, column y_m: found \"inf\""),
        (format!("{HEADER}\nmine,0,theirs,20,22.5,,forward"), "line 2, column heading_rad: found \"\""),
        (format!("{HEADER}\nmine,0,theirs,1e9,22.5,0,forward"), "line 2, column x_m: found \"1e9\""),
        (
            format!("{HEADER}\nmine,0,theirs,20,22.5,0,left"),
            "line 2, column direction: found \"left\", expected forward or reverse",
        ),
        (
            format!("{HEADER}\n{good}\n\nmine,0,theirs,20.6,22.5,0,forward"),
            "line 4: it is 0.600 m from the pose of line 2; expected at most 0.5 m",
        ),
        (
            format!("{HEADER}\n{good}\nmine,0,theirs,20.4,22.5,0,reverse"),
            "line 3: it is 0.400 m ahead of the pose of line 2, and its direction is reverse; expected poses in driving order",
        ),
        (
            format!("{HEADER}\nmine,0,theirs,20.4,22.5,0,forward\n{good}"),
            "line 3: it is 0.400 m behind the pose of line 2, and its direction is forward",
        ),
        (
            format!("{HEADER}\n{good}\nmine,1,theirs,20,22.5,0,forward\n{good}"),
            "line 4: the path of theirs to goal 0 of the field mine begins again; expected its rows in one block",
        ),
        (format!("{HEADER}\n{good}\n{long}"), "line 3: the line is longer than 65536 bytes; expected a pose"),
        ("\u{7f}ELF\u{1}\u{1}\u{0}\u{0}\u{0}".to_owned(), "line 1: the column goal is missing"),
    ] {
        story.file("paths.csv", &text);
        refuse(&story, &["judge", "mine.json", "paths.csv"], &["paths.csv: ", fragment]);
    }
    let many: String = (0..60).map(|number| format!("mine,0,planner{number},20,22.5,0,forward\n")).collect();
    story.file("paths.csv", &format!("{HEADER}\n{many}"));
    refuse(&story, &["judge", "mine.json", "paths.csv"], &["line 52: this is planner number 51"]);
    fs::write(story.path("paths.csv"), [0xff, 0xfe, 0x00, 0x80].repeat(1000)).expect("writable");
    refuse(&story, &["judge", "mine.json", "paths.csv"], &["paths.csv: "]);
}

#[test]
fn files_that_are_not_there_or_in_the_wrong_place_are_refused() {
    let story = begin();
    story.file("paths.csv", &format!("{HEADER}\nmine,0,theirs,20,22.5,0,forward\n"));
    refuse(&story, &["judge"], &["FIELD.json"]);
    refuse(
        &story,
        &["judge", "mine.json"],
        &["mine.json has the ending of a field file; expected the table of paths \
    last"],
    );
    refuse(&story, &["judge", "paths.csv", "mine.json"], &["mine.json has the ending of a field file"]);
    refuse(&story, &["judge", "paths.csv", "paths.csv"], &["paths.csv"]);
    refuse(&story, &["judge", "mine.json", "none.csv"], &["none.csv"]);
    refuse(&story, &["judge", "none.json", "paths.csv"], &["none.json"]);
    refuse(
        &story,
        &["judge", "mine.json", "paths.csv", "--goals", "5"],
        &["--goals samples goals on the scenario's field"],
    );
    refuse(&story, &["judge", "mine.json", "paths.csv", "--against", "prm-sr"], &["there is no planner `prm-sr`"]);
    refuse(&story, &["judge", "mine.json", "paths.csv", "--against", "PRM"], &["PRM"]);
    refuse(&story, &["judge", "mine.json", "paths.csv", "--csv", "paths.csv"], &["is named for two files"]);
    refuse(&story, &["judge", "mine.json", "paths.csv", "--recording", "run.wildfire"], &["--recording"]);
    refuse(&story, &["judge", "paths.csv", "--scenario", "nowhere"], &["nowhere"]);
}

#[test]
fn starts_and_goals_that_are_no_numbers_are_missed() {
    let story = Story::begin();
    for (start, goal) in [("[null, 22.5, 0]", "[20, 22.5, 0]"), ("[20, 22.5, 0]", "[20, 22.5, null]")] {
        let field = format!(
            "{{\"field\": \"mine\", \"n\": 20, \"cell_m\": 5, \"cells_cr\": [[10, 4]], \"start\": {start}, \"goals\": [{{\"pose\": {goal}}}]}}"
        );
        story.file("odd.json", &field);
        story.file("paths.csv", &format!("{HEADER}\nmine,0,theirs,20,22.5,0,forward\n"));
        let answer = story.tell(&["judge", "odd.json", "paths.csv", "--against", "prm-rs"]).expect_code(4).stdout;
        assert!(answer.contains("violation on field mine, goal 0: line 2: it "), "{answer}");
    }
}
