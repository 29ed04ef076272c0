//! The README's section on watching runs: its commands run, its pictures are theirs, its words cover the options.

use std::fs;
use std::path::Path;

use crate::readme;
use crate::story::{Story, refuse};

fn section() -> &'static str {
    readme::section("Watch")
}

#[test]
fn commands_of_the_readme_draw_its_pictures() {
    let story = Story::begin();
    fs::create_dir_all(story.path("assets/pictures")).expect("writable");
    for arguments in readme::calls(section(), "render") {
        story.tell(&arguments).expect_code(0);
    }
    let pictures = readme::pictures(section());
    assert_eq!(pictures, ["contest.gif", "compare.png"]);
    for name in pictures {
        let name = Path::new("assets/pictures").join(name);
        let drawn = fs::read(story.path(&name.to_string_lossy())).expect("a command draws it");
        let stored = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(&name)).expect("the picture is stored");
        let name = name.display();
        assert!(drawn == stored, "{name} is not what its command draws: run it again where the README lies");
        assert!(stored.len() < 3_000_000, "{name} has {} bytes", stored.len());
    }
}

#[test]
fn every_option_is_explained() {
    let story = Story::begin();
    let help = |command| story.tell(&[command, "--help"]).expect_code(0).stdout;
    let mut names: Vec<String> = Vec::new();
    for command in ["play", "render"] {
        let help = help(command);
        let options = help.lines().filter_map(|line| line.trim_start().strip_prefix("--"));
        names.extend(options.filter_map(|line| line.split([' ', '=']).next()).map(|name| format!("--{name}")));
    }
    assert!(names.len() >= 25, "the options were not found");
    names.retain(|name| name != "--quiet" && !section().contains(name.as_str()));
    assert!(names.is_empty(), "the README does not explain {names:?}");
}

#[test]
fn examples_of_the_help_are_understood() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    let help = story.tell(&["render", "--help"]).expect_code(0).stdout;
    let examples: Vec<_> = help.lines().filter_map(|line| line.strip_prefix("  wildfire ")).collect();
    assert!(examples.len() >= 5, "{help}");
    for example in examples {
        // An output that cannot be written is what is found first, once the arguments make sense.
        let words: Vec<_> = example.split_whitespace().collect();
        let outputs = ["still.png", "film.gif", "film.mp4", "two.png", "near.png"];
        let nowhere: Vec<String> = words
            .iter()
            .map(|word| if outputs.contains(word) { format!("nowhere/{word}") } else { (*word).to_owned() })
            .collect();
        let nowhere: Vec<&str> = nowhere.iter().map(String::as_str).collect();
        refuse(&story, &nowhere, &["nowhere/", "no such folder"]);
    }
}
