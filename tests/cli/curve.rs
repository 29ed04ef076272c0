//! `wildfire curve` between two poses: what it tells, writes, draws and refuses.

use std::fs;

use serde_json::Value;
use wildfire::geometry::{Pose, ops};
use wildfire::vehicle::{Path, Segment};

use crate::story::{Story, refuse, widest};

const ENDS: [&str; 5] = ["curve", "--from", "0,0,0", "--to", "20,15,180"];

fn with<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&ENDS, arguments].concat()
}

fn curves(story: &Story, arguments: &[&str]) -> Vec<Value> {
    let answer = story.tell(&[arguments, &["--json"]].concat()).expect_code(0).stdout;
    let object: Value = serde_json::from_str(&answer).expect("the answer is JSON");
    object["curves"].as_array().expect("a list").clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The path that the segments of a curve describe.
fn path(curve: &Value, start: Pose, radius_m: f64) -> Path {
    let segment = |segment: &Value| {
        let sign = if segment["direction"] == "reverse" { -1.0 } else { 1.0 };
        let curvature = match segment["steering"].as_str() {
            Some("left") => 1.0 / radius_m,
            Some("right") => -1.0 / radius_m,
            _ => 0.0,
        };
        Segment { curvature, length_m: sign * number(&segment["length_m"]) }
    };
    Path { start, segments: curve["segments"].as_array().expect("a list").iter().map(segment).collect() }
}

#[test]
fn both_curves_are_told_with_length_word_and_segments() {
    let story = Story::begin();
    let quarter = ["left", "forward", "20.420352", "+90.000000"];
    let answer = story.tell(&["curve", "--from", "0,0,0", "--to", "13,13,90"]).expect_code(0).stdout;
    for name in ["Reeds-Shepp", "Dubins"] {
        let (_, curve) = answer.split_once(&format!("\n{name}: 20.420352 m, ")).expect("the length is told");
        let (word, segments) = curve.split_once('\n').expect("a line");
        let segment = segments.lines().nth(3).expect("a row under headings and a rule");
        assert!(["L+, family CSC, no cusp", "L, no cusp"].contains(&word), "{word}");
        assert_eq!(segment.split_whitespace().collect::<Vec<_>>(), quarter, "{answer}");
    }
    let answer = story.tell(&["curve", "--from", "0,0,0", "--to", "-26,10,0"]).expect_code(0).stdout;
    assert!(answer.contains(" reverse ") && answer.contains(", family C"), "{answer}");
}

/// Equal poses, a straight, and a curve that only Dubins has.
#[test]
fn words_have_the_letters_that_are_driven() {
    let story = Story::begin();
    let curves_to = |to: &str, more: &[&str]| {
        let found = curves(&story, &[&["curve", "--from", "0,0,0", "--to", to, "--radius", "3"], more].concat());
        let texts = found.iter().map(|curve| curve["word"].as_str().expect("a word").to_owned());
        (texts.collect::<Vec<_>>(), found.last().and_then(|curve| curve["price"]["price_m"].as_f64()))
    };
    assert_eq!(curves_to("0,0,0", &[]).0, ["", ""]);
    assert_eq!(curves_to("5,0,0", &[]).0, ["S+", "S"]);
    let (found, price_m) = curves_to("3,0,180", &["--cusp-m", "20"]);
    assert!(["L+R+L+", "R+L+R+"].contains(&found[2].as_str()), "{found:?}");
    assert!((price_m.expect("it has a price") - 21.158).abs() < 0.01, "{price_m:?}");
    let answer = story.tell(&["curve", "--from", "0,0,0", "--to", "0,0,0"]).expect_code(0).stdout;
    assert!(answer.contains("Reeds-Shepp: 0.000000 m, no segment, no cusp"), "{answer}");
}

#[test]
fn lines_fit_a_terminal_whatever_the_numbers() {
    let story = Story::begin();
    let ends =
        ["curve", "--from", "-999999.12345678,999999.12345678,-359.12345678", "--to", "999999.12345678,1e-300,-1e-9"];
    let prices = ["--radius", "0.001", "--reverse-factor", "1.0625", "--cusp-m", "12345.625"];
    let answer = story.tell(&[ends.as_slice(), &prices].concat()).expect_code(0).stdout;
    assert!(widest(&answer) <= 80, "{answer}");
}

#[test]
fn segments_lead_from_the_start_to_the_goal() {
    let story = Story::begin();
    let far = ["-1000000,1000000,-1000000", "1000000,-1000000,1000000"];
    for [from, to] in [["0,0,0", "20,15,180"], ["3,4,45", "3.001,4,45"], ["3,4,45", "3,4,45"], far] {
        for radius in ["0.001", "13", "1000000"] {
            let pose = |text: &str| {
                let numbers: Vec<f64> = text.split(',').map(|number| number.parse().expect("a number")).collect();
                Pose::new(numbers[0], numbers[1], (numbers[2] % 360.0).to_radians())
            };
            let (start, goal, radius_m) = (pose(from), pose(to), radius.parse().expect("a number"));
            for curve in curves(&story, &["curve", "--from", from, "--to", to, "--radius", radius, "--cusp-m", "2"]) {
                let path = path(&curve, start, radius_m);
                let off_m = path.end().position().distance(goal.position());
                assert!(off_m < 1e-8 + 1e-11 * radius_m, "{from} to {to} by {radius} m ends {off_m} m off: {curve}");
                let turned = ops::wrap_angle(path.end().heading - goal.heading).abs();
                assert!(turned < 1e-8, "{from} to {to} by {radius} m ends {turned} rad off: {curve}");
                assert_eq!(curve["cusps"], path.cusps());
                assert!((number(&curve["length_m"]) - path.length_m()).abs() <= 1e-12 * (path.length_m() + radius_m));
                let turns = curve["segments"].as_array().expect("a list").iter().zip(&path.segments);
                for (reported, segment) in turns {
                    let degrees = (segment.curvature * segment.length_m).to_degrees();
                    assert!((number(&reported["turn_deg"]) - degrees).abs() < 1e-9, "{reported}");
                }
            }
        }
    }
}

#[test]
fn prices_add_the_cheapest_curve() {
    let story = Story::begin();
    assert_eq!(curves(&story, &ENDS).len(), 2);
    let priced = curves(&story, &with(&["--cusp-m", "30", "--reverse-factor", "2"]));
    let [shortest, _, cheapest] = priced.as_slice() else { panic!("three curves are expected: {priced:?}") };
    let price = |curve: &Value| {
        let metres = |direction: &str| {
            let segments = curve["segments"].as_array().expect("a list").iter();
            segments.filter(|segment| segment["direction"] == direction).map(|s| number(&s["length_m"])).sum::<f64>()
        };
        metres("forward") + 2.0 * metres("reverse") + 30.0 * number(&curve["cusps"])
    };
    assert!((number(&cheapest["price"]["price_m"]) - price(cheapest)).abs() < 1e-9);
    assert!(price(cheapest) < price(shortest) - 1.0, "{priced:?}");
    assert!(number(&cheapest["length_m"]) > number(&shortest["length_m"]));
    assert!(shortest["price"].is_null() && !shortest["word"].is_null());
}

#[test]
fn sampled_poses_follow_the_curves() {
    let story = Story::begin();
    story.tell(&with(&["--csv", "poses.csv", "--step", "0.5"])).expect_code(0).expect_complaint(&["wrote poses.csv"]);
    let mut reader = csv::Reader::from_path(story.path("poses.csv")).expect("it was written");
    assert_eq!(reader.headers().expect("a header"), vec!["curve", "s_m", "x_m", "y_m", "heading_rad", "direction"]);
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("readable")).collect();
    for (curve, kind) in curves(&story, &ENDS).iter().zip(["reeds_shepp", "dubins"]) {
        let path = path(curve, Pose::default(), 13.0);
        let rows: Vec<_> = rows.iter().filter(|row| &row[0] == kind).collect();
        let numbers = |row: &csv::StringRecord| [1, 2, 3, 4].map(|at| row[at].parse::<f64>().expect("a number"));
        let joints = path.segments.iter().scan(0.0, |driven_m, segment| {
            *driven_m += segment.length_m.abs();
            Some(*driven_m)
        });
        let joints: Vec<f64> = joints.collect();
        for joint_m in std::iter::once(&0.0).chain(&joints) {
            assert!(rows.iter().any(|row| (numbers(row)[0] - joint_m).abs() < 1e-9), "{kind}: no row at {joint_m} m");
        }
        for pair in rows.windows(2) {
            let ([before, ..], [s, x, y, heading]) = (numbers(pair[0]), numbers(pair[1]));
            assert!(before < s && s - before <= 0.5 + 1e-12, "{before} to {s}");
            let pose = path.pose_at(s);
            assert!((pose.position() - Pose::new(x, y, heading).position()).length() < 1e-9);
            assert!(ops::wrap_angle(pose.heading - heading).abs() < 1e-9);
            let leg = joints.iter().position(|joint_m| s < joint_m + 1e-9).expect("it is on the way");
            let expected = if path.segments[leg].is_reverse() { "reverse" } else { "forward" };
            assert_eq!(&pair[1][5], expected, "at {s} m");
        }
    }
}

#[test]
fn pictures_are_the_same_every_time() {
    let story = Story::begin();
    let draw = |name: &str, arguments: &[&str]| {
        story.tell(&[arguments, &["--png", name]].concat()).expect_code(0);
        fs::read(story.path(name)).expect("it was written")
    };
    assert!(draw("one.png", &ENDS) == draw("two.png", &ENDS), "the pictures differ");
    let standing = ["curve", "--from", "1e6,1e6,0", "--to", "1e6,1e6,0", "--radius", "0.001"];
    let far = ["curve", "--from", "-1e6,0,0", "--to", "1e6,0.5,0", "--radius", "0.001"];
    let wide = ["curve", "--from", "0,0,0", "--to", "0,0,1e-3", "--radius", "1e6"];
    for arguments in [standing, far, wide] {
        let picture = image::load_from_memory(&draw("odd.png", &arguments)).expect("a picture");
        assert!((300..3000).contains(&picture.width()) && (300..3000).contains(&picture.height()), "{arguments:?}");
    }
}

#[test]
fn poses_and_options_that_make_no_sense_are_refused() {
    let story = Story::begin();
    let refuse = |arguments: &str, fragments: &[&str]| {
        let arguments: Vec<_> = std::iter::once("curve").chain(arguments.split_whitespace()).collect();
        refuse(&story, &arguments, fragments);
    };
    for pose in ["1,2", "1,2,3,4", "a,2,3", "nan,0,0", "0,inf,0", "0,0,-1e7", "1000001,0,0"] {
        refuse(&format!("--from {pose} --to 0,0,0"), &[pose, "--from", "X,Y,DEG", "from -1000000 to 1000000"]);
    }
    for radius in ["0", "-13", "nan", "inf", "1e7", "wide"] {
        let fragments = ["--turning-radius", "expected metres from 0.001 to 1000000"];
        refuse(&format!("--from 0,0,0 --to 1,1,1 --radius {radius} --png curve.png"), &fragments);
        refuse(&format!("--pairs pairs.csv --csv out.csv --radius {radius}"), &fragments);
    }
    for (arguments, fragment) in [
        ("", "--from"),
        ("--from 0,0,0", "--to"),
        ("--to 0,0,0", "--from"),
        ("--from 0,0,0 --to 1,1,1 --cusp-m -1", "from 0 to 1000000"),
        ("--from 0,0,0 --to 1,1,1 --reverse-factor nan", "from 0 to 1000000"),
        ("--from 0,0,0 --to 1,1,1 --csv out.csv --step 0", "--step"),
        ("--from 0,0,0 --to 1,1,1 --step 1", "--csv"),
        ("--from 0,0,0 --to 1e6,0,0 --csv out.csv --step 1", "expected at most 1000000"),
        ("--from 0,0,0 --to 1,1,1 --csv out --png ./out", "two files"),
        ("--pairs pairs.csv", "--csv"),
        ("--pairs pairs.csv --csv out.csv --json", "--json"),
        ("--pairs pairs.csv --csv out.csv --png out.png", "--png"),
        ("--pairs pairs.csv --csv out.csv --cusp-m 1", "--cusp-m"),
        ("--pairs pairs.csv --csv out.csv --from 0,0,0 --to 1,1,1", "--from"),
    ] {
        refuse(arguments, &[fragment]);
    }
}
