//! What is written of `wildfire plan`: its commands run, its picture is theirs, its words cover options and columns.

use std::fs;
use std::path::Path;

use crate::readme;
use crate::story::Story;

fn section() -> &'static str {
    readme::section("Planning drives")
}

#[test]
fn commands_of_the_readme_draw_its_picture() {
    let story = Story::begin();
    fs::create_dir_all(story.path("assets/pictures")).expect("writable");
    let commands = readme::calls(section(), "plan");
    // Those on fields of others run where the fields are.
    for arguments in commands.iter().filter(|words| !words.iter().any(|word| word.ends_with(".json"))) {
        story.tell(arguments).expect_code(0);
    }
    let pictures = readme::pictures(section());
    assert_eq!(pictures.len(), 1, "the picture was not found");
    for name in pictures {
        let name = Path::new("assets/pictures").join(name);
        let stored = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(&name)).expect("the picture is stored");
        let drawn = fs::read(story.path(&name.to_string_lossy())).expect("a command draws it");
        assert!(
            drawn == stored,
            "{} is not what its command draws: run it again where the README lies",
            name.display()
        );
        assert!(stored.len() < 100_000, "{} has {} bytes", name.display(), stored.len());
    }
}

#[test]
fn every_option_and_column_is_explained() {
    let help = Story::begin().tell(&["plan", "--help"]).expect_code(0).stdout;
    let options = help.lines().filter_map(|line| line.trim_start().strip_prefix("--"));
    let options = options.filter_map(|line| line.split([' ', '=']).next()).filter(|name| *name != "quiet");
    let mut names: Vec<String> = options.map(|name| format!("--{name}")).collect();
    assert!(names.len() >= 11, "the options were not found: {help}");
    let columns = "field,goal,planner,success,reason,cpu_build_s,cpu_query_s,length_m,lower_bound_ratio,\
                   min_clearance_m,cusps,drive_s,expansions";
    names.extend([columns.to_owned(), "field,goal,planner,s_m,x_m,y_m,heading_rad,direction".to_owned()]);
    names.retain(|name| !section().contains(name.as_str()));
    assert!(names.is_empty(), "the README does not explain {names:?}");
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
