//! Field files with problems for the truck: what is read of them, and how broken ones are refused.

use std::fs;
use std::path::PathBuf;

use rand::RngExt;
use tempfile::TempDir;
use wildfire::geometry::Pose;
use wildfire::planning::Goal;
use wildfire::rng;
use wildfire::scenario::{MAX_GOALS, Problem, ScenarioError, Unimog};

const WHOLE: &str = r#"{
  "field": 7, "size_m": 100, "cell_m": 5, "n": 20, "density": 0.1,
  "vehicle": {
    "length": 5.5,
    "width": 2.0,
    "wheelbase": 3.2,
    "rear_overhang": 1.0,
    "front_from_rear_axle": 4.5,
    "min_turn_radius": 11.0,
    "v_max": 6.0,
    "pose_reference": "rear axle"
  },
  "cells_cr": [[0, 0], [19, 3]],
  "start": [20, 30.5, 7],
  "goals": [
    {"pose": [50, 60, -1.5], "is_hard": true},
    {"disc": [70.0, 20.0, 10]}
  ]
}"#;

struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a scratch folder"))
    }

    fn path(&self, text: &str) -> PathBuf {
        let path = self.0.path().join("mine.json");
        fs::write(&path, text).expect("the scratch folder is writable");
        path
    }

    fn open(&self, text: &str) -> Problem {
        Problem::open(&self.path(text), &Unimog::default()).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    fn refused(&self, text: &str) -> Box<ScenarioError> {
        Problem::open(&self.path(text), &Unimog::default()).map(|_| ()).expect_err(text)
    }
}

/// The whole problem with a part of its text replaced.
fn with(old: &str, new: &str) -> String {
    assert!(WHOLE.contains(old), "{old}");
    WHOLE.replace(old, new)
}

fn line(error: &ScenarioError) -> usize {
    error.location.as_ref().unwrap_or_else(|| panic!("{error} has no place")).line_and_column().0
}

#[test]
fn everything_that_a_problem_says_is_read() {
    let problem = Files::new().open(WHOLE);
    assert_eq!(problem.name, "7");
    assert_eq!((problem.terrain.frame.cols, problem.terrain.frame.rows, problem.terrain.bushes.len()), (20, 20, 2));
    assert!(problem.terrain.occupied[(3, 19)] && problem.terrain.occupied[(0, 0)]);
    let truck = &problem.truck;
    assert_eq!((truck.vehicle.length_m, truck.vehicle.turning_radius_m), (5.5, 11.0));
    assert_eq!((truck.speed_mps, truck.reverse_speed_mps), (6.0, 6.0));
    assert_eq!(problem.start, Pose::new(20.0, 30.5, 7.0));
    assert_eq!(problem.goals[0], Goal::Pose(Pose::new(50.0, 60.0, -1.5)));
    let Goal::Disc(disc) = problem.goals[1] else { panic!("a disc is expected") };
    assert_eq!((disc.centre.x, disc.centre.y, disc.radius_m), (70.0, 20.0, 10.0));
}

#[test]
fn what_a_problem_leaves_out_is_as_the_truck_has_it() {
    let problem = Files::new().open(r#"{"n": 30, "cells_cr": [], "start": [20, 20, 0]}"#);
    let truck = Unimog::default();
    assert_eq!(problem.name, "mine");
    assert_eq!((problem.truck.vehicle, problem.truck.speed_mps), (truck.vehicle, truck.speed_mps));
    assert_eq!((problem.terrain.frame.cell_m, problem.goals.len()), (5.0, 0));
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_change_nothing() {
    let files = Files::new();
    let marked = files.open(&format!("\u{FEFF}{}", WHOLE.replace('\n', "\r\n")));
    let plain = files.open(WHOLE);
    assert_eq!((marked.start, marked.goals), (plain.start, plain.goals));
    assert_eq!(marked.terrain.occupied, plain.terrain.occupied);
    assert_eq!(line(&files.refused(&format!("\u{FEFF}{}", with("\"width\": 2.0", "\"width\": -2.0")))), 5);
}

#[test]
fn null_is_not_a_number_and_planners_may_say_so() {
    let files = Files::new();
    assert!(files.open(&with("20, 30.5, 7", "20, null, 7")).start.y.is_nan());
    let Goal::Pose(pose) = files.open(&with("50, 60, -1.5", "50, 60, null")).goals[0] else { panic!("a pose") };
    assert!(pose.heading.is_nan());
}

#[test]
fn broken_json_is_refused_where_it_breaks() {
    let files = Files::new();
    for (text, at) in [
        (String::new(), 1),
        ("[]".to_owned(), 1),
        ("7".to_owned(), 1),
        (with("\"start\": [20,", "\"start\": [20"), 14),
        (with("-1.5], ", "-1.5] "), 16),
        (with("50, 60, -1.5", "50, NaN, -1.5"), 16),
        (with("50, 60, -1.5", "50, 1e999, -1.5"), 16),
        (WHOLE[..WHOLE.len() - 10].to_owned(), 17),
        (format!("{WHOLE}\n{{}}"), 20),
        ("[".repeat(100_000), 1),
        ("{\"start\":".repeat(100_000), 1),
    ] {
        let error = files.refused(&text);
        assert_eq!(line(&error), at, "{error}");
    }
}

#[test]
fn a_text_map_or_a_list_is_said_to_be_no_object() {
    let files = Files::new();
    for text in ["", "\n", "..#\n#..\n", "010\n", "[null, null, [50, 50, 0], []]", "\"text\""] {
        let error = files.refused(text).to_string();
        assert!(error.contains("a field file is one JSON object"), "{text}: {error}");
    }
}

#[test]
fn values_that_cannot_be_are_refused_where_they_stand() {
    let files = Files::new();
    for (old, new, at, fragment) in [
        ("\"width\": 2.0", "\"width\": -2.0", 5, "`vehicle.width` is -2; expected a number from 0.1"),
        ("\"width\": 2.0", "\"width\": \"2\"", 5, "`vehicle.width` is the text \"2\"; expected a number"),
        ("\"width\": 2.0,", "", 12, "missing field `width` in `vehicle`"),
        (
            "\"wheelbase\": 3.2",
            "\"wheelbase\": 5.0",
            6,
            "`vehicle.wheelbase` is 5; expected a front axle under the body",
        ),
        ("\"min_turn_radius\": 11.0", "\"min_turn_radius\": 0.9", 9, "at least half the width away"),
        (
            "\"min_turn_radius\": 11.0",
            "\"min_turn_radius\": 1.5",
            9,
            "at least 1.848, which steering by 60 degrees gives",
        ),
        ("\"front_from_rear_axle\": 4.5", "\"front_from_rear_axle\": 4.4", 8, "ahead of the rear axle, 4.5"),
        ("\"v_max\": 6.0", "\"v_max\": 0", 10, "`vehicle.v_max` is 0; expected a number from 0.001"),
        ("[19, 3]", "[20, 3]", 13, "cell [20, 3] lies outside a field of 20 x 20 cells"),
        ("[19, 3]", "[19, -3]", 13, "-3"),
        ("\"cells_cr\"", "\"cells\"", 19, "missing field `cells_cr`"),
        ("20, 30.5, 7", "20, 30.5", 14, "`start` is a list of 2; expected a list of three numbers"),
        ("20, 30.5, 7", "20, 30.5, 7, 8", 14, "`start` is a list of 4"),
        ("20, 30.5, 7", "2e6, 30.5, 7", 14, "`start.0` is 2000000; expected a number from -1000000 to 1000000"),
        ("\"pose\": [50, 60, -1.5]", "\"place\": 1", 16, "`goals.0` is neither; expected either a `pose` or a `disc`"),
        ("20.0, 10]", "20.0, -10]", 17, "`goals.1.disc.2` is -10; expected a number from 0"),
        ("20.0, 10]", "20.0, null]", 17, "`goals.1.disc.2` is NaN"),
        ("\"field\": 7", "\"field\": [7]", 2, "expected a number or a string in quotes"),
        ("\"field\": 7", "\"field\": \"\"", 2, "`field` is \"\"; expected a line of 1 to 100 characters"),
        ("\"n\": 20", "\"n\": 1e9", 2, "`n` is 1000000000.0; expected a whole number from 0"),
        ("\"n\": 20", "\"n\": 21", 1, "the map does not give its number of cells"),
        ("\"size_m\": 100, \"cell_m\": 5, \"n\": 20", "\"cell_m\": 2000, \"n\": 20", 2, "`cell_m` is 2000"),
        ("\"size_m\": 100, \"cell_m\": 5, \"n\": 20", "\"n\": 100000", 1, "more than 4096 cells along a side"),
    ] {
        let error = files.refused(&with(old, new));
        assert!(error.to_string().contains(fragment), "{new}: {error}");
        assert_eq!(line(&error), at, "{new}: {error}");
    }
}

#[test]
fn damaged_files_are_read_or_refused_with_a_place_in_them() {
    let files = Files::new();
    let mut rng = rng::stream(1, "tests/problem_files");
    let pieces = ["é", "\u{1F525}", "[", "]", "{", "}", "\"", ",", ":", "-", "9e9", "null", "\n", "\\"];
    for _ in 0..200 {
        let mut text = WHOLE.to_owned();
        for _ in 0..rng.random_range(1..4) {
            let at = text.floor_char_boundary(rng.random_range(0..text.len()));
            let end = text.ceil_char_boundary(at + rng.random_range(0..3usize)).min(text.len());
            text.replace_range(at..end, pieces[rng.random_range(0..pieces.len())]);
        }
        if let Err(error) = Problem::open(&files.path(&text), &Unimog::default()) {
            assert!(line(&error) <= text.lines().count(), "{error}");
            assert!(error.location.is_some_and(|place| place.to_string().contains("mine.json")), "{text}");
        }
    }
}

#[test]
fn too_many_goals_are_refused() {
    let goals = |count| with("{\"disc\": [70.0, 20.0, 10]}", &vec!["{\"disc\": [70.0, 20.0, 10]}"; count].join(","));
    let files = Files::new();
    assert_eq!(files.open(&goals(MAX_GOALS - 1)).goals.len(), MAX_GOALS);
    assert!(files.refused(&goals(MAX_GOALS)).to_string().contains("`goals` is 10001; expected at most 10000"));
}

#[test]
fn what_is_no_file_of_text_is_refused() {
    let files = Files::new();
    let refused = |path: PathBuf| Problem::open(&path, &Unimog::default()).map(|_| ()).expect_err("it is not a file");
    assert!(refused(files.0.path().join("none.json")).to_string().contains("cannot be read"));
    assert!(refused(files.0.path().to_owned()).to_string().contains("is a folder"));
    let path = files.path("");
    fs::write(&path, [b'{', 0xFF]).expect("the scratch folder is writable");
    assert!(refused(path).to_string().contains("is not UTF-8"));
}
