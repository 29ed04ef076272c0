//! `wildfire rank`, from the batches that it is told to run to the table that it prints.

use std::fs;

use serde_json::Value;

use crate::story::{Story, refuse, widest};

/// A batch of three planners, and two batches of one each.
fn batches() -> Story {
    let story = Story::begin();
    let planners = "prm-rs,prm+primitives,lattice";
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--planner", planners, "--out", "all"]).expect_code(0);
    for (folder, planner) in [("anna", "lattice"), ("ben", "hybrid-astar")] {
        story.tell(&["batch", "smoke", "--seeds", "1..6", "--planner", planner, "--out", folder]).expect_code(0);
    }
    story
}

#[test]
fn entries_are_ranked_in_every_form() {
    let story = batches();
    let batches = ["rank", "all", "anna", "ben"];
    let text = story.tell(&batches).expect_code(0).stdout;
    for fragment in ["5 entries by saved, higher is better", "Each entry: 6 runs, seeds 1..6", "all prm-rs", "anna "] {
        assert!(text.contains(fragment), "`{fragment}` is missing:\n{text}");
    }
    assert!(widest(&text) <= 80, "{text}");
    assert_eq!(text, story.tell(&["rank", "ben", "all", "anna"]).stdout, "in whatever order they are given");
    let printed = |form: &str| story.tell(&[&batches[..], &[form]].concat()).expect_code(0).stdout;
    assert!(printed("--md").contains("\n| anna |"), "{}", printed("--md"));
    assert!(printed("--html").starts_with("<!DOCTYPE html>") && printed("--html").contains(">anna</td>"));
    assert!(printed("--html").contains("<svg ") && !printed("--md").contains("<svg "));
    assert!(printed("--tex").contains("\nanna & "), "{}", printed("--tex"));
    let json: Value = serde_json::from_str(&printed("--json")).expect("it is JSON");
    let entries = json["entries"].as_array().expect("a list");
    assert_eq!((entries.len(), json["pairs"].as_array().map(Vec::len)), (5, Some(10)));
    // A planner and its copy in another batch have equal runs.
    let lattices: Vec<_> = entries.iter().filter(|entry| entry["planner"] == "lattice").collect();
    assert_eq!(lattices[0]["mean"], lattices[1]["mean"]);
    assert_eq!(lattices[0]["groups"], lattices[1]["groups"]);
}

#[test]
fn table_of_entries_is_written_whole() {
    let story = batches();
    story.tell(&["rank", "all", "--csv", "ranking.csv", "--metric", "burned"]).expect_code(0);
    let mut reader = csv::Reader::from_path(story.path("ranking.csv")).expect("it was written");
    let header: Vec<_> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    assert_eq!(header[..4], ["place", "entry", "planner", "rank_from"]);
    let rows: Vec<_> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!((rows.len(), &rows[0][0], &rows[0][6]), (3, "1", "burned"));
    assert_eq!(&rows[0][8], "", "the first has no difference from itself");
    let on_stdout = story.tell(&["rank", "all", "--csv", "-", "--metric", "burned"]).expect_code(0).stdout;
    assert_eq!(on_stdout, story.read("ranking.csv"));
}

#[test]
fn what_cannot_be_ranked_is_refused() {
    let story = batches();
    story.tell(&["batch", "smoke", "--seeds", "1..5", "--out", "fewer"]).expect_code(0);
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--set", "fire.relight=true", "--out", "other"]).expect_code(0);
    refuse(&story, &["rank", "anna", "fewer"], &["anna and fewer do not have the same seeds: 1..6 and 1..5"]);
    let help = "--free KEY lets entries differ in a key";
    refuse(
        &story,
        &["rank", "anna", "other"],
        &["did not play by the same rules: fire.relight is false and true", help],
    );
    story.tell(&["rank", "anna", "other", "--free", "fire.relight"]).expect_code(0);
    refuse(&story, &["rank", "nowhere"], &["expected a folder with a runs.csv, or such a file"]);
    refuse(&story, &["rank", "anna", "--metric", "savd"], &["there is no metric `savd`: did you mean `saved`?"]);
    refuse(&story, &["rank", "anna", "--metric", "ended_s"], &["add `--better higher` or `--better lower`"]);
    refuse(&story, &["rank", "anna", "--where", "planner=nobody"], &["no run has planner `nobody`"]);
    refuse(&story, &["rank", "anna", "--csv", "ranking.png"], &["expected a name that ends in .csv or .txt"]);
    refuse(&story, &["rank"], &["BATCH"]);
    fs::write(story.path("anna/plan.json"), "{}").expect("writable");
    refuse(&story, &["rank", "anna"], &["the rules of anna/runs.csv are not known"]);
}

#[test]
fn nothing_in_a_name_acts_on_a_page_or_a_terminal() {
    let story = batches();
    let hostile = "<b>\u{1b}[2J|a";
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--planner", "lattice", "--out", hostile]).expect_code(0);
    for form in [&[][..], &["--md"], &["--html"], &["--tex"], &["--json"]] {
        let arguments = [&["rank", hostile, "ben"], form].concat();
        let printed = story.tell(&arguments).expect_code(0).stdout;
        assert!(!printed.contains('\u{1b}'), "{form:?}: {printed}");
        assert!(!["--html", "--md"].contains(form.first().unwrap_or(&"")) || !printed.contains("<b>"), "{printed}");
    }
}
