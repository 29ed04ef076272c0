//! The README's section on grid maps: its commands run, its pictures are theirs, its words cover the answers.

use std::fs;
use std::path::Path;

use crate::readme;
use crate::story::Story;

fn section() -> &'static str {
    readme::section("Grid maps")
}

fn commands() -> Vec<Vec<&'static str>> {
    readme::calls(section(), "map")
}

fn assets() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"))
}

fn story_with_maps() -> Story {
    let story = Story::begin();
    fs::create_dir_all(story.path("assets/maps")).expect("writable");
    fs::create_dir(story.path("assets/pictures")).expect("writable");
    for entry in fs::read_dir(assets().join("maps")).expect("the maps are there") {
        let from = entry.expect("readable").path();
        let name = from.file_name().expect("a file has a name");
        fs::copy(&from, story.path("assets/maps").join(name)).expect("writable");
    }
    story
}

#[test]
fn commands_of_the_readme_run_and_draw_its_pictures() {
    let story = story_with_maps();
    let commands = commands();
    assert!(commands.len() > 8, "the commands were not found");
    for arguments in &commands {
        // Timing takes its time, and says what it says about the machine only.
        if arguments[1] == "timing" {
            assert!(arguments[2..].iter().all(|map| story.path(map).is_file()), "{arguments:?}");
        } else {
            story.tell(arguments).expect_code(0);
        }
    }
    let shown = readme::pictures(section());
    assert!(shown.len() >= 5, "the pictures were not found");
    for name in shown {
        let drawn =
            fs::read(story.path("assets/pictures").join(name)).unwrap_or_else(|_| panic!("no command draws {name}"));
        let stored = fs::read(assets().join("pictures").join(name)).unwrap_or_else(|_| panic!("{name} is not stored"));
        assert!(drawn == stored, "{name} is not what its command draws: run it again where the README lies");
        assert!(stored.len() < 100_000, "{name} has {} bytes", stored.len());
    }
}

#[test]
fn answer_to_the_first_command_is_what_the_readme_shows() {
    let answer = story_with_maps().tell(&commands()[0]).expect_code(0).stdout;
    assert!(answer.lines().count() > 10, "{answer}");
    for line in answer.lines().filter(|line| !line.starts_with("CPU:")) {
        assert!(section().contains(line), "the README does not show `{line}`");
    }
}

/// The subcommands and what they say of themselves.
fn helps(story: &Story) -> Vec<(String, String)> {
    let help = |arguments: &[&str]| story.tell(arguments).expect_code(0).stdout;
    let overview = help(&["map", "--help"]);
    let listed = overview.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let helps: Vec<_> = names.map(|name| (name.to_owned(), help(&["map", name, "--help"]))).collect();
    assert_eq!(helps.len(), 9, "{overview}");
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
    names.retain(|name| !section().contains(name.as_str()));
    assert!(names.is_empty(), "the README does not explain {names:?}");
}
