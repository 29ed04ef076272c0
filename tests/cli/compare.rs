//! `wildfire compare`, from the batches that it is told to run to the page that it prints.

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
    for words in ["A: a/runs.csv (scenario smoke", "6 pairs of runs.", "saved: ", "B less A", "Fewer than 10 pairs"] {
        assert!(text.contains(words), "`{words}` is missing:\n{text}");
    }
    assert!(widest(&text) <= 80, "{text}");
    assert_eq!(text, story.tell(&["compare", "a", "b"]).stdout, "the same files give the same figures");
    let markdown = story.tell(&["compare", "a", "b", "--md"]).expect_code(0).stdout;
    assert!(markdown.contains("\n| saved |"), "{markdown}");
    let page = story.tell(&["compare", "a", "b", "--html"]).expect_code(0).stdout;
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<td>saved</td>"), "{page}");
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
fn batch_stands_beside_the_report() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..6", "--out", "a"]).expect_code(0);
    let text = story.tell(&["compare", "a", "--with", "report"]).expect_code(0).stdout;
    for words in ["intact           0.302 0.071", "extinguished     0.357 0.037", "Wumpus search      2.072"] {
        assert!(text.contains(words), "`{words}` is missing:\n{text}");
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
    for form in ["--md", "--json", "--html"] {
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
        (&["runs.csv", "--by", "planner=x,x"], &["`x` stands there twice"]),
        (&["runs.csv", "--where", "planner"], &["expected COLUMN=VALUE"]),
        (&["runs.csv", "--with", "thesis"], &["report"]),
    ];
    for (arguments, words) in cases {
        refuse(&story, &[&["compare"], arguments].concat(), words);
    }
}
