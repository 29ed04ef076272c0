//! `wildfire compare`, from the batches that it is told to run to the page that it prints.

use std::fs;

use serde_json::Value;

use crate::story::{Story, refuse, widest};

/// Two batches of the same seeds, `a` and `b`, with unlike planners.
fn two_batches() -> Story {
    let story = Story::begin();
    for (folder, planner) in [("a", "prm+primitives"), ("b", "hybrid-astar")] {
        let set = format!("unimog.planner={planner}");
        story.tell(&["batch", "smoke", "--seeds", "1..6", "--set", &set, "--out", folder]).expect_code(0);
    }
    story
}

/// A batch of two planners with a name that means something to a browser.
fn hostile_batch(story: &Story) {
    let mut text = String::from("scenario,seed,run,planner,status,message,intact,extinguished,winner\n");
    for seed in 1..=12 {
        text += &format!("s,{seed},1,<script>alert(1)</script>,done,,{seed},7,unimog\n");
        text += &format!("s,{seed},2,\"a|b \u{1b}[2J\",done,,{},7,wumpus\n", seed + seed % 3);
    }
    story.file("runs.csv", &text);
}

#[test]
fn batches_are_compared_in_every_form() {
    let story = two_batches();
    let text = story.tell(&["compare", "a", "b"]).expect_code(0).stdout;
    for fragment in ["A: a/runs.csv (scenario smoke", "6 pairs of runs.", "saved: ", "B − A", "Fewer than 10 seeds"] {
        assert!(text.contains(fragment), "`{fragment}` is missing:\n{text}");
    }
    assert!(widest(&text) <= 80, "{text}");
    assert_eq!(text, story.tell(&["compare", "a", "b"]).stdout, "the same files give the same figures");
    let markdown = story.tell(&["compare", "a", "b", "--md"]).expect_code(0).stdout;
    assert!(markdown.contains("\n| saved |"), "{markdown}");
    let page = story.tell(&["compare", "a", "b", "--html"]).expect_code(0).stdout;
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains(">saved</td>"), "{page}");
    assert!(page.contains("<svg ") && page.contains("B − A (% of A"), "a forest of the differences");
    let paper = story.tell(&["compare", "a", "b", "--tex"]).expect_code(0).stdout;
    assert!(paper.contains("\\midrule\nsaved & 6 & "), "{paper}");
    let json = story.tell(&["compare", "a", "b", "--json", "--metric", "saved,truck_cusps"]).expect_code(0).stdout;
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    let metrics = json["comparisons"][0]["metrics"].as_array().expect("a list");
    assert_eq!(
        metrics.iter().map(|it| it["metric"].as_str()).collect::<Vec<_>>(),
        [Some("saved"), Some("truck_cusps")]
    );
    assert_eq!(metrics[0]["pairs"], 6);
}

#[test]
fn differences_are_written_as_csv() {
    let story = two_batches();
    let text = story.tell(&["compare", "a", "b"]).expect_code(0).stdout;
    let answer = story.tell(&["compare", "a", "b", "--csv", "differences.csv"]).expect_code(0);
    assert_eq!(answer.stdout, text);
    let json = story.tell(&["compare", "a", "b", "--json"]).expect_code(0).stdout;
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    let written = story.read("differences.csv");
    let mut table = csv::Reader::from_reader(written.as_bytes());
    let names = ["metric", "unit", "difference", "low", "percent_of_a", "mean_a"];
    let headers = table.headers().expect("a table").clone();
    let places = names.map(|name| headers.iter().position(|header| header == name).expect(name));
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let metrics = json["comparisons"][0]["metrics"].as_array().expect("a list");
    assert_eq!(rows.len(), metrics.len());
    for (row, metric) in rows.iter().zip(metrics) {
        let [name, unit, difference, low, percent, mean] = places.map(|place| &row[place]);
        assert_eq!(Some(name), metric["metric"].as_str());
        assert_eq!(difference.parse().ok(), metric["difference"].as_f64());
        assert_eq!(low.parse().ok(), metric["interval"][0].as_f64());
        assert_eq!(
            unit,
            match name {
                "saved" => "cells",
                "truck_won" => "1",
                "burning_cell_s" => "cells s",
                _ => "s",
            }
        );
        let number = |text: &str| text.parse::<f64>().unwrap_or(0.0);
        assert!((number(percent) * number(mean).abs() - 100.0 * number(difference)).abs() < 1e-6 * number(mean).abs());
    }
    refuse(&story, &["compare", "a", "b", "--csv", "differences.png"], &["differences.png"]);
}

#[test]
fn power_and_equivalence_are_answered_in_every_form() {
    let story = two_batches();
    let args =
        ["compare", "a", "b", "--metric", "saved,truck_won,mean_response_s", "--power", "1", "--equivalent", "30"];
    let text = story.tell(&args).expect_code(0).stdout;
    for fragment in ["Seeds that a difference between A and B needs", "1 cell ", "Equivalence of A and B", "30 cells"] {
        assert!(text.contains(fragment), "`{fragment}` is missing:\n{text}");
    }
    assert!(widest(&text) <= 80, "{text}");
    let with = |more: &[&str]| story.tell(&[&args[..], more].concat()).expect_code(0).stdout;
    assert!(with(&["--tex"]).contains("Equivalence of A and B"), "{}", with(&["--tex"]));
    let json: Value = serde_json::from_str(&with(&["--json"])).expect("it is JSON");
    let saved = &json["comparisons"][0]["metrics"][0];
    let needed = saved["power"]["seeds_needed"].as_u64().expect("a number of seeds");
    let power = saved["power"]["power"].as_f64().expect("a probability");
    assert_eq!((needed <= 6, saved["power"]["difference"].as_f64()), (power >= 0.8, Some(1.0)));
    assert_eq!(saved["equivalence"]["margin"], 30.0);
    // A share cannot differ by 1; nobody asks about it then.
    assert_eq!(json["comparisons"][0]["metrics"][1].get("power"), None);
    with(&["--csv", "differences.csv"]);
    let written = story.read("differences.csv");
    let mut table = csv::Reader::from_reader(written.as_bytes());
    let headers = table.headers().expect("a table").clone();
    let place = |name: &str| headers.iter().position(|header| header == name).expect(name);
    let row = table.records().next().expect("a row").expect("it is read");
    assert_eq!(row[place("seeds_needed")], needed.to_string());
    assert_eq!(row[place("equivalence_p")].parse().ok(), saved["equivalence"]["p_value"].as_f64());
    let alone = story.tell(&["compare", "a", "b", "--metric", "saved", "--json"]).expect_code(0).stdout;
    assert!(!alone.contains("seeds_needed") && !alone.contains("equivalen"), "{alone}");
    for (option, value, fragment) in [
        ("--power", "0", "expected a number above 0"),
        ("--power", "-1", "expected a number above 0"),
        ("--equivalent", "1 parsec", "there is no unit `parsec`"),
        ("--equivalent", "5 m", "--equivalent 5 m: no metric has this unit; expected one of"),
    ] {
        refuse(&story, &["compare", "a", "b", option, value], &[fragment]);
    }
}

/// A batch of `smoke` in `folder` with these changes.
fn batch(story: &Story, folder: &str, changes: &[&str]) {
    let mut arguments = vec!["batch", "smoke", "--seeds", "1..6", "--out", folder];
    changes.iter().for_each(|change| arguments.extend(["--set", change]));
    story.tell(&arguments).expect_code(0);
}

const FORMS: [&[&str]; 5] = [&[], &["--md"], &["--html"], &["--tex"], &["--json"]];

/// The words about the planner where it is all that differs.
const THE_PLANNERS: &str = "the difference is the planner";

/// A comparison without the breaks of its lines.
fn flat(story: &Story, arguments: &[&str]) -> String {
    let text = story.tell(&[&["compare"], arguments].concat()).expect_code(0).stdout;
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn difference_of_the_settings_heads_the_answer_in_every_form() {
    let story = Story::begin();
    batch(&story, "a", &[]);
    batch(&story, "b", &["unimog.speed_mps=20", "fire.relight=true"]);
    for form in FORMS {
        let text = flat(&story, &[&["a", "b"], form].concat());
        let finding = text.find("saved").expect("it is compared");
        let expected = match form {
            ["--json"] => [
                "{\"key\":\"fire.relight\",\"values\":[false,true]",
                "{\"key\":\"unimog.speed_mps\",\"values\":[8.0,20.0]",
            ],
            ["--md"] => ["- fire.relight: false in A, true in B", "- unimog.speed_mps: 8.0 in A, 20.0 in B"],
            ["--tex"] => ["fire.relight: false in A, true in B", "mps:\\allowbreak{} 8.0 in A, 20.0 in B"],
            _ => ["fire.relight: false in A, true in B", "unimog.speed_mps: 8.0 in A, 20.0 in B"],
        };
        for fragment in expected {
            assert!(
                text.find(fragment).is_some_and(|place| place < finding),
                "{form:?}: `{fragment}` is missing:\n{text}"
            );
        }
        assert!(!text.contains(THE_PLANNERS), "{form:?}: {text}");
    }
    let json: Value = serde_json::from_str(&flat(&story, &["a", "b", "--json"])).expect("it is JSON");
    assert_eq!(json["comparisons"][0]["settings"]["difference_is_the_planners"], false);
    let text = story.tell(&["compare", "a", "b"]).stdout;
    assert!(widest(&text) <= 80, "{text}");
}

#[test]
fn difference_is_the_planners_only_where_nothing_else_differs() {
    let story = two_batches();
    for form in FORMS {
        let text = flat(&story, &[&["a", "b"], form].concat());
        assert!(text.contains(THE_PLANNERS), "{form:?}: {text}");
    }
    assert!(flat(&story, &["a", "b"]).contains("unimog.planner: prm+primitives in A, hybrid-astar in B"));
    // Another value besides.
    batch(&story, "c", &["unimog.planner=hybrid-astar", "unimog.speed_mps=9"]);
    let text = flat(&story, &["a", "c"]);
    assert!(text.contains("unimog.speed_mps: 8.0 in A, 9.0 in B") && !text.contains(THE_PLANNERS), "{text}");
    // Nothing at all.
    assert!(flat(&story, &["a", "a"]).contains("All settings and the program are equal"));
    // Another version of the program.
    let plan = story.read("b/plan.json");
    let version = format!("\"program_version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    story.file("b/plan.json", &plan.replacen(&version, "\"program_version\": \"0.0.1\"", 1));
    let text = flat(&story, &["a", "b"]);
    let expected = format!("program version: {} in A, 0.0.1 in B", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&expected) && !text.contains(THE_PLANNERS), "{text}");
    // Settings that were changed after the runs.
    story.file("b/plan.json", &plan.replacen("\"speed_mps\": 8.0", "\"speed_mps\": 7.0", 1));
    let text = flat(&story, &["a", "b"]);
    assert!(text.contains("The settings of B are not known") && !text.contains(THE_PLANNERS), "{text}");
}

#[test]
fn side_without_a_plan_has_settings_that_are_not_known() {
    let story = two_batches();
    story.file("alone.csv", &story.read("b/runs.csv"));
    fs::create_dir(story.path("bare")).expect("writable");
    story.file("bare/runs.csv", &story.read("b/runs.csv"));
    for side in ["bare", "bare/runs.csv", "alone.csv"] {
        let text = flat(&story, &["a", side]);
        assert!(text.contains("The settings of B are not known: there is no plan.json beside"), "{side}: {text}");
        assert!(!text.contains(THE_PLANNERS), "{side}: {text}");
    }
    // A plan that is another batch's.
    fs::copy(story.path("a/plan.json"), story.path("bare/plan.json")).expect("writable");
    let text = flat(&story, &["a", "bare"]);
    assert!(text.contains("plan.json does not go with bare/runs.csv") && !text.contains(THE_PLANNERS), "{text}");
    let json: Value = serde_json::from_str(&flat(&story, &["a", "bare", "--json"])).expect("it is JSON");
    assert_eq!(json["comparisons"][0]["settings"]["not_known"][0]["side"], "B");
}

#[test]
fn seeds_that_differ_are_said() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--out", "a"]).expect_code(0);
    story.tell(&["batch", "smoke", "--seeds", "4..8,20", "--out", "b"]).expect_code(0);
    let text = flat(&story, &["a", "b"]);
    assert!(text.contains("seeds: 1..6 in A, 4..8,20 in B; only seeds of both are compared"), "{text}");
}

#[test]
fn comparison_by_planner_says_what_it_is_a_mean_over() {
    let story = Story::begin();
    let planners = ["--planner", "prm-rs,lattice", "--set", "field.coverage=0.05,0.2", "--set", "duration_s=200,300"];
    story.tell(&[&["batch", "smoke", "--seeds", "1..6", "--out", "a"], &planners[..]].concat()).expect_code(0);
    let sentence = "Every difference is a mean over 4 combinations of duration_s (200, 300) and field.coverage (0.05, 0.2), \
                6 pairs each.";
    for form in &FORMS[..3] {
        let text = flat(&story, &[&["a", "--by", "planner"], *form].concat());
        assert!(text.contains(sentence) && text.contains("p strata"), "{form:?}: {text}");
        assert!(text.contains("unimog.planner: prm-rs in A, lattice in B"), "{form:?}: {text}");
        assert!(text.contains(THE_PLANNERS), "{form:?}: {text}");
    }
    let text = story.tell(&["compare", "a", "--by", "planner", "--metric", "truck_distance_m"]).expect_code(0).stdout;
    assert!(widest(&text) <= 80, "{text}");
    let lines = text.replace("\n  ", " ");
    assert!(
        lines.contains("it depends on duration_s and field.coverage"),
        "lattice drives more where more burns:\n{text}"
    );
    assert!(lines.contains("duration_s 200, field.coverage 0.05: with B trucks drive"), "{text}");
    let json: Value = serde_json::from_str(&flat(&story, &["a", "--by", "planner", "--json"])).expect("it is JSON");
    let of_planner = &json["comparisons"][0];
    assert_eq!(of_planner["mean_over"]["columns"], serde_json::json!(["duration_s", "field.coverage"]));
    let strata = of_planner["metrics"][0]["by_stratum"]["strata"].as_array().expect("a list");
    assert_eq!(strata.len(), 4);
    assert_eq!(strata[3]["values"], serde_json::json!({ "duration_s": "300", "field.coverage": "0.2" }));
    assert_eq!(strata[3]["pairs"], 6);
    // What divides the sides is what differs, the planner is what is averaged over.
    let text = flat(&story, &["a", "--by", "field.coverage", "--where", "duration_s=300"]);
    assert!(text.contains("field.coverage: 0.05 in A, 0.2 in B") && text.contains("a mean over planner ("), "{text}");
    assert!(!text.contains(THE_PLANNERS), "{text}");
}

#[test]
fn batch_stands_beside_the_report() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--out", "a"]).expect_code(0);
    let text = story.tell(&["compare", "a", "--with", "report"]).expect_code(0).stdout;
    for fragment in ["intact           0.302 0.071", "extinguished     0.357 0.037", "Wumpus search      2.072"] {
        assert!(text.contains(fragment), "`{fragment}` is missing:\n{text}");
    }
    let json = story.tell(&["compare", "a", "--with", "report", "--json"]).expect_code(0).stdout;
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["states"].as_array().map(Vec::len), Some(3));
    refuse(&story, &["compare", "a", "a", "--with", "report"], &["2 batches; expected a single one"]);
}

#[test]
fn names_from_files_are_harmless_wherever_they_are_printed() {
    let story = Story::begin();
    hostile_batch(&story);
    for form in ["--md", "--json", "--html", "--tex"] {
        let text = story.tell(&["compare", "runs.csv", form]).expect_code(0).stdout;
        assert!(!text.contains('\u{1b}'), "{form}: {text}");
        // In JSON a quoted name is harmless, in Markdown one behind a backslash.
        assert!(form == "--json" || !text.replace("\\<", "").contains("<script"), "{form}: {text}");
    }
    assert!(!story.tell(&["compare", "runs.csv"]).expect_code(0).stdout.contains('\u{1b}'));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let story = Story::begin();
    hostile_batch(&story);
    story.file("notes.csv", "a,b\n1,2\n");
    let cases: [(&[&str], &[&str]); 8] = [
        (&["nowhere"], &["nowhere: expected a folder with a runs.csv, or such a file"]),
        (&["notes.csv"], &["there is no column `seed`"]),
        (&["runs.csv", "--metric", "savd"], &["there is no metric `savd`", "did you mean `saved`?"]),
        (&["runs.csv", "--metric", "winner"], &["line 2", "winner is `unimog`; expected a number, or nothing"]),
        (&["runs.csv", "--by", "color"], &["no column `color`"]),
        (&["runs.csv", "--by", "planner=x,x"], &["`x` is given twice"]),
        (&["runs.csv", "--where", "planner"], &["expected COLUMN=VALUE"]),
        (&["runs.csv", "--with", "thesis"], &["report"]),
    ];
    for (arguments, fragments) in cases {
        refuse(&story, &[&["compare"], arguments].concat(), fragments);
    }
}
