//! Phrases that readers stumble over stay out of everything they may see: pages, help, messages, docstrings, comments.

use std::fs;
use std::path::{Path, PathBuf};

/// A phrase in small letters, and what to write in its place.
const BANNED: [(&str, &str); 31] = [
    ("anew", "again, from scratch"),
    ("asked of", "posed to, planned by"),
    ("b less a", "B − A"),
    ("beforehand", "first"),
    ("by another then", "has changed"),
    ("by other means", "by independent code"),
    ("drawn at random", "random"),
    ("for ever", "forever"),
    ("found fault", "rejected"),
    ("handed in", "submitted, registered"),
    ("hang together", "are connected"),
    ("hangs together", "is connected"),
    ("how far a batch", "a batch's progress"),
    ("in the mean over", "averaged over"),
    ("in vain", "without success"),
    ("in which the least", "with the fewest"),
    ("is no more than what", "is an upper bound on"),
    ("judged alike", "scored by one judge"),
    ("more than chance explains", "significant"),
    ("nobody's way", "blocks nobody"),
    ("nobody, in no run", "No agent got stuck"),
    ("not there yet", "does not exist yet"),
    ("nothing else does", "only ... does"),
    ("of one's own", "custom"),
    ("of yours", "your"),
    ("second opinion", "independent check"),
    ("stands where it", "stops"),
    ("told apart", "significantly different, distinguished"),
    ("what there is to", "a noun"),
    ("without more ado", "by default"),
    ("worth having", "pays off"),
];

/// Files that readers open, or that hold what the program prints.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut waiting: Vec<_> = ["assets", "crates", "docs", "examples", "python", "runs", "scenarios", "src"]
        .map(|name| root.join(name))
        .into();
    let mut files: Vec<_> =
        ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)).into();
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                waiting.push(path);
            } else if path.extension().is_some_and(|ending| {
                ["css", "html", "ipynb", "js", "md", "py", "pyi", "rs", "toml"].iter().any(|text| ending == *text)
            }) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The lines of a text with its words in small letters; a phrase may go on in the next line, behind its `//`.
fn places(text: &str, phrase: &str) -> Vec<usize> {
    let mut flat = String::new();
    let mut starts = Vec::new();
    for line in text.lines() {
        starts.push(flat.len());
        let line = line.trim_start().trim_start_matches(['/', '!', '#', '*', '"']);
        flat.extend(line.split_whitespace().flat_map(|word| [&word.to_lowercase(), " "].map(str::to_owned)));
    }
    let begins_a_word = |at: usize| !flat[..at].ends_with(|letter: char| letter.is_alphanumeric());
    let ends_a_word = |at: usize| !flat[at..].starts_with(|letter: char| letter.is_alphanumeric());
    let found = flat.match_indices(phrase).filter(|(at, _)| begins_a_word(*at) && ends_a_word(at + phrase.len()));
    found.map(|(at, _)| starts.partition_point(|start| *start <= at)).collect()
}

#[test]
fn phrases_that_readers_stumble_over_are_gone() {
    let mut found = Vec::new();
    for file in files() {
        let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        for (phrase, better) in BANNED {
            let lines = places(&text, phrase);
            found.extend(lines.iter().map(|line| format!("{}:{line}: {phrase} -> {better}", file.display())));
        }
    }
    assert!(found.is_empty(), "{} phrases:\n{}", found.len(), found.join("\n"));
}

#[test]
fn phrases_are_found_across_lines_and_in_comments_only_as_words() {
    let text = "//! It is asked\n/// OF a planner.\nlet renewed = \"anew\";\n";
    assert_eq!(places(text, "asked of"), [1]);
    assert_eq!(places(text, "anew"), [3]);
    assert_eq!(places("renewed, manew", "anew"), [] as [usize; 0]);
}
