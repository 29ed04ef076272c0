//! What is written of `wildfire plan` covers options and columns, and the example of a field file is one.

use crate::guide;
use crate::story::Story;

#[test]
fn every_option_and_column_is_explained() {
    let help = Story::begin().tell(&["plan", "--help"]).expect_code(0).stdout;
    let options = help.lines().filter_map(|line| line.trim_start().strip_prefix("--"));
    let options = options.filter_map(|line| line.split([' ', '=']).next()).filter(|name| *name != "quiet");
    let mut names: Vec<String> = options.map(|name| format!("--{name}")).collect();
    assert!(names.len() >= 11, "the options were not found: {help}");
    let columns = "field,goal,planner,success,reason,cpu_build_s,cpu_query_s,length_m,lower_bound_ratio,\
                   min_clearance_m,cusps,drive_s,expansions,violation";
    names.extend([columns.to_owned(), "field,goal,planner,s_m,x_m,y_m,heading_rad,direction".to_owned()]);
    let chapter = guide::chapter("planning-drives.md");
    names.retain(|name| !chapter.contains(name.as_str()));
    assert!(names.is_empty(), "the guide does not explain {names:?}");
}

#[test]
fn example_of_a_field_file_is_one() {
    let readme = include_str!("../../scenarios/README.md");
    let (_, section) = readme.split_once("\n## Field files\n").expect("the section is there");
    let (_, example) = section.split_once("```json\n").expect("an example is there");
    let story = Story::begin();
    story.file("example.json", example.split("```").next().unwrap_or_default());
    let answer = story.tell(&["plan", "example.json"]).expect_code(0).stdout;
    assert!(answer.starts_with("Field `two bushes`, 2 goals, ") && answer.contains(" 2/2 "), "{answer}");
}
