//! The front page of the library is short and documented in full; what is behind it is no promise.

use std::fs;
use std::path::{Path, PathBuf};

const MAX_NAMES: usize = 20;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the sources are there").map(|entry| entry.expect("readable").path());
    let mut files: Vec<_> = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect();
    files.sort();
    files
}

fn lines(path: &Path) -> Vec<String> {
    fs::read_to_string(path).expect("readable").lines().map(str::to_owned).collect()
}

/// What `lib.rs` re-exports and shows: each name with the folder or file that defines it; those of the page itself begin
/// their line, those of its modules do not.
fn names(indent: &str) -> Vec<(String, PathBuf)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let front = lines(&root.join("src/lib.rs"));
    let begin = format!("{indent}pub use ");
    let shown = front.windows(2).filter(|pair| pair[0] != "#[doc(hidden)]" && !pair[0].starts_with("#[cfg"));
    let uses = shown.filter_map(|pair| pair[1].strip_prefix(&begin)).map(|line| line.trim_end_matches(';'));
    uses.flat_map(|path| {
        let (module, names) = path.rsplit_once("::").expect("a path");
        let (home, module) = module.split_once("::").unwrap_or((module, ""));
        let home = match home.strip_prefix("wildfire_") {
            Some(name) => root.join("crates").join(name).join("src"),
            None => root.join("src"),
        };
        let folder = home.join(module.replace("::", "/"));
        let names = names.trim_matches(['{', '}']).split(", ");
        let name_of = |name: &str| (name.split(" as ").next().unwrap_or(name).to_owned(), folder.clone());
        names.map(name_of).collect::<Vec<_>>()
    })
    .collect()
}

/// Whether a comment stands above a line, attributes between them left out.
fn is_documented(lines: &[String], index: usize) -> bool {
    let mut above = lines[..index].iter().rev().map(|line| line.trim_start());
    above.find(|line| !line.starts_with("#[")).is_some_and(|line| line.starts_with("///"))
}

/// What is open inside the item that begins at a line, and is not documented: fields, variants, methods.
fn undocumented_inside(lines: &[String], index: usize) -> Vec<String> {
    let head = &lines[index];
    let is_type_of_all = head.starts_with("pub enum") || head.starts_with("pub trait");
    let block = lines[index + 1..].iter().take_while(|line| !line.starts_with('}'));
    let members = block.enumerate().map(|(offset, line)| (index + 1 + offset, line)).filter(|(_, line)| {
        let Some(member) = line.strip_prefix("    ") else { return false };
        let is_named = if head.starts_with("pub trait") {
            member.starts_with("fn ")
        } else {
            is_type_of_all && member.starts_with(char::is_uppercase)
        };
        is_named || member.starts_with("pub ")
    });
    let missing = members.filter(|(at, _)| !is_documented(lines, *at));
    missing.map(|(_, line)| line.trim().to_owned()).collect()
}

#[test]
fn front_page_is_short_and_the_rest_is_hidden() {
    let names = names("");
    assert!((10..=MAX_NAMES).contains(&names.len()), "{names:?}");
    let front = lines(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    for (index, line) in front.iter().enumerate().filter(|(_, line)| line.starts_with("pub mod ")) {
        let above = front[..index].iter().rev().take_while(|line| line.starts_with("#["));
        let is_hidden = above.clone().any(|line| line.contains("doc(hidden)"));
        assert!(is_hidden || is_documented(&front, index), "`{line}` is neither hidden nor documented");
    }
}

#[test]
fn all_of_the_front_page_is_documented() {
    let mut missing = Vec::new();
    for (name, folder) in names("").into_iter().chain(names("    ")) {
        let files = if folder.is_dir() { sources(&folder) } else { vec![folder.with_extension("rs")] };
        let files: Vec<_> = files.iter().map(|path| lines(path)).collect();
        let begins = |line: &str| {
            let kinds = ["struct", "enum", "trait", "fn"];
            kinds.iter().any(|kind| {
                let rest = line.strip_prefix(&format!("pub {kind} {name}"));
                rest.is_some_and(|rest| !rest.starts_with(|letter: char| letter.is_alphanumeric() || letter == '_'))
            })
        };
        let methods = format!("impl {name} {{");
        let mut is_defined = false;
        for lines in &files {
            for (index, line) in lines.iter().enumerate() {
                if begins(line) {
                    is_defined = true;
                    if !is_documented(lines, index) {
                        missing.push(format!("{name}: {line}"));
                    }
                }
                if begins(line) && !line.ends_with(';') && !line.starts_with("pub fn") || line.starts_with(&methods) {
                    missing.extend(undocumented_inside(lines, index).iter().map(|member| format!("{name}: {member}")));
                }
            }
        }
        assert!(is_defined, "`{name}` was not found");
    }
    assert!(missing.is_empty(), "not documented: {missing:#?}");
}
