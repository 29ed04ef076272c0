//! The guide's chapter on watching runs covers the options, and the examples of the help make sense.

use crate::guide;
use crate::story::{Story, refuse};

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
    let chapter = guide::chapter("watch.md");
    names.retain(|name| name != "--quiet" && !chapter.contains(name.as_str()));
    assert!(names.is_empty(), "the guide does not explain {names:?}");
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
        let args: Vec<_> = example.split_whitespace().collect();
        let outputs =
            ["still.png", "film.gif", "film.mp4", "tour.mp4", "run.html", "two.png", "near.png", "search.png"];
        let nowhere: Vec<String> = args
            .iter()
            .map(|word| if outputs.contains(word) { format!("nowhere/{word}") } else { (*word).to_owned() })
            .collect();
        let nowhere: Vec<&str> = nowhere.iter().map(String::as_str).collect();
        refuse(&story, &nowhere, &["nowhere/", "the folder does not exist"]);
    }
}
