//! What the tests read out of the README.

/// A section, up to the next one.
pub fn section(title: &str) -> &'static str {
    let readme = include_str!("../../README.md");
    let (_, section) = readme.split_once(&format!("\n## {title}\n")).expect("the README has the section");
    section.split("\n## ").next().unwrap_or(section)
}

/// The arguments of the calls of a command in a section.
pub fn calls(section: &'static str, command: &'static str) -> Vec<Vec<&'static str>> {
    let arguments = section.lines().filter_map(|line| line.strip_prefix("wildfire ")).map(str::split_whitespace);
    arguments.map(Iterator::collect).filter(|words: &Vec<&str>| words[0] == command).collect()
}

/// The names of the pictures that a section shows.
pub fn pictures(section: &'static str) -> Vec<&'static str> {
    let starts = section.split("](assets/pictures/").skip(1);
    starts.filter_map(|rest| rest.split_once(')')).map(|(name, _)| name).collect()
}
