//! The demonstration: what it leaves, and what it refuses.

use super::story::Story;

#[test]
fn a_first_minute_leaves_a_page_pictures_and_a_report() {
    let story = Story::begin();
    let answer = story.tell(&["demo", "--out", "first look"]).expect_code(0);
    for fragment in [
        "1/9",
        "9/9",
        "$ wildfire run contest --seed 7 --record-searches --out 'first look'/run.wildfire",
        "Violations: none",
    ] {
        assert!(answer.stdout.contains(fragment), "{fragment} is not in {}", answer.stdout);
    }
    assert_eq!(answer.stderr, "");
    let page = story.read("first look/run.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.len() < 500_000, "{} bytes", page.len());
    for file in
        ["run.wildfire", "search.png", "play.html", "run.png", "drives.png", "batch/runs.csv", "batch/report.html"]
    {
        assert!(story.path("first look").join(file).is_file(), "{file} is missing");
    }
    let index = story.read("first look/index.html");
    let links: Vec<&str> = index.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(links.len() >= 7, "{index}");
    for link in links {
        assert!(story.path("first look").join(link).is_file(), "{link} is missing");
    }
    assert_eq!(story.entries(), ["first look"]);
    let again = story.tell(&["demo", "--out", "first look"]).expect_code(2);
    assert!(again.stderr.contains("first look already exists"), "{}", again.stderr);
    assert_eq!(again.stdout, "");
}

#[test]
fn a_folder_that_cannot_be_made_is_said_before_anything_is_run() {
    let story = Story::begin();
    story.file("file", "");
    for folder in ["file", "file/inside"] {
        let answer = story.tell(&["demo", "--out", folder]);
        assert!(answer.code == Some(2) || answer.code == Some(3), "{:?}", answer.code);
        assert!(answer.stderr.contains(folder) && answer.stdout.is_empty(), "{}", answer.stderr);
    }
}
