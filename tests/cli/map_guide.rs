//! The guide's chapter on grid maps covers commands, options and answers, and the examples of the help run.

use std::fs;
use std::path::Path;

use crate::guide;
use crate::story::Story;

fn assets() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"))
}

fn story_with_maps() -> Story {
    let story = Story::begin();
    fs::create_dir_all(story.path("assets/maps")).expect("writable");
    for entry in fs::read_dir(assets().join("maps")).expect("the maps are there") {
        let from = entry.expect("readable").path();
        let name = from.file_name().expect("a file has a name");
        fs::copy(&from, story.path("assets/maps").join(name)).expect("writable");
    }
    story
}

/// The subcommands and what they say of themselves.
fn helps(story: &Story) -> Vec<(String, String)> {
    let help = |arguments: &[&str]| story.tell(arguments).expect_code(0).stdout;
    let overview = help(&["map", "--help"]);
    let listed = overview.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let helps: Vec<_> = names.map(|name| (name.to_owned(), help(&["map", name, "--help"]))).collect();
    assert_eq!(helps.len(), 20, "{overview}");
    helps
}

#[test]
fn examples_of_the_help_run() {
    let story = story_with_maps();
    // Timing takes its time, and its example is for a shell.
    for (subcommand, help) in helps(&story).into_iter().filter(|(subcommand, _)| subcommand != "timing") {
        let help = help.replace("\\\n", " ");
        let lines: Vec<_> = help.lines().filter(|line| line.starts_with("  wildfire map ")).collect();
        assert!(!lines.is_empty(), "{subcommand} has no example");
        for line in lines {
            let arguments: Vec<_> = line.split_whitespace().skip(1).collect();
            story.tell(&arguments).expect_code(0);
        }
    }
}

#[test]
fn every_subcommand_option_and_member_is_explained() {
    let story = Story::begin();
    story.file("map.txt", "00\n01\n");
    let mut names: Vec<String> = Vec::new();
    for (subcommand, help) in helps(&story) {
        names.push(format!("wildfire map {subcommand}"));
        let options = help.lines().filter_map(|line| line.strip_prefix("      --"));
        names.extend(options.filter_map(|line| line.split([' ', '=']).next()).map(|name| format!("--{name}")));
    }
    let answer = story.tell(&["map", "descend", "map.txt", "--goal", "0,0", "--start", "1,0", "--json"]).expect_code(0);
    let object: serde_json::Value = serde_json::from_str(&answer.stdout).expect("the answer is JSON");
    names.extend(object.as_object().expect("an object").keys().map(|name| format!("`{name}`")));
    let chapter = guide::chapter("grid-maps.md");
    names.retain(|name| !chapter.contains(name.as_str()));
    assert!(names.is_empty(), "the guide does not explain {names:?}");
}
