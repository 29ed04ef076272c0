//! Phrases that readers stumble over stay out of everything they may see: pages, help, messages, docstrings, comments, and
//! the names in the code.
//!
//! `tests/data/identifiers.txt` has the words and whole names of a private dialect that are left in the code: one, what to
//! write in its place, and how often it occurs. These numbers only fall: `WILDFIRE_REWRITE_DATA=1 cargo test --test cli
//! english` writes lower ones.

use std::collections::BTreeMap;
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
    let mut files = files_of(
        &["assets", "crates", "docs", "examples", "python", "runs", "scenarios", "src"],
        &["css", "html", "ipynb", "js", "md", "py", "pyi", "rs", "toml"],
    );
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    files.extend(["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    files.sort();
    files
}

/// The files in folders of the repository whose names end in one of these ways.
fn files_of(folders: &[&str], endings: &[&str]) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut waiting: Vec<_> = folders.iter().map(|name| root.join(name)).collect();
    let mut files = Vec::new();
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                waiting.push(path);
            } else if path.extension().is_some_and(|ending| endings.iter().any(|text| ending == *text)) {
                files.push(path);
            }
        }
    }
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

/// The identifiers of Rust code, in order, without those in comments and text.
fn identifiers(code: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let is_of_name = |letter: char| letter.is_alphanumeric() || letter == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(hashes) = raw_text_hashes(rest) {
            let end = format!("\"{}", "#".repeat(hashes));
            let begin = rest.find('"').expect("a raw text begins") + 1;
            rest[begin..].find(&end).map_or(rest.len(), |at| begin + at + end.len())
        } else if first == '"' {
            1 + length_to_quote(&rest[1..], '"')
        } else if first == '\'' && (rest[1..].starts_with('\\') || rest[1..].chars().nth(1) == Some('\'')) {
            1 + length_to_quote(&rest[1..], '\'')
        } else if is_of_name(first) {
            let length = rest.find(|letter| !is_of_name(letter)).unwrap_or(rest.len());
            found.push(&rest[..length]);
            length
        } else {
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    found
}

fn raw_text_hashes(code: &str) -> Option<usize> {
    let hashes = code.strip_prefix('r')?;
    let begin = hashes.trim_start_matches('#');
    begin.starts_with('"').then(|| hashes.len() - begin.len())
}

fn length_to_quote(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, letter) in text.char_indices() {
        if letter == quote && !is_escaped {
            return at + 1;
        }
        is_escaped = letter == '\\' && !is_escaped;
    }
    text.len()
}

/// An identifier as small words, with a space before and after each: `is_toldApart` is ` is told apart `.
fn spaced(identifier: &str) -> String {
    let mut text = String::from(" ");
    let mut was_small = false;
    for letter in identifier.chars() {
        if (letter.is_uppercase() && was_small) || letter == '_' {
            text.push(' ');
        }
        was_small = letter.is_lowercase() || letter.is_numeric();
        if letter != '_' {
            text.extend(letter.to_lowercase());
        }
    }
    text + " "
}

#[test]
fn dialect_leaves_the_names_of_the_code() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/identifiers.txt");
    let text = fs::read_to_string(&list).expect("the list is there");
    let mut uses = BTreeMap::<String, usize>::new();
    for file in files_of(&["crates", "python/src", "src"], &["rs"]) {
        for name in identifiers(&fs::read_to_string(&file).expect("readable")) {
            *uses.entry(name.to_owned()).or_default() += 1;
        }
    }
    let split: Vec<(String, usize)> = uses.iter().map(|(name, uses)| (spaced(name), *uses)).collect();
    for (phrase, better) in BANNED {
        let phrase = format!(" {phrase} ");
        let found: Vec<_> = split.iter().filter(|(text, _)| text.contains(&phrase)).collect();
        assert!(found.is_empty(), "{found:?} -> {better}");
    }
    let mut wrong = Vec::new();
    let mut rewritten = String::new();
    for line in text.lines() {
        let [word, better, allowed] = line.splitn(3, '\t').collect::<Vec<_>>()[..] else {
            panic!("three columns: {line}")
        };
        // Types are whole names, everything else is a part of one.
        let is_type = word.starts_with(|letter: char| letter.is_uppercase());
        let phrase = spaced(word);
        let parts = || split.iter().filter(|(text, _)| text.contains(&phrase)).map(|(_, uses)| uses).sum();
        let count: usize = if is_type { uses.get(word).copied().unwrap_or(0) } else { parts() };
        let allowed: usize = allowed.parse().expect("a number");
        if count != allowed {
            wrong.push(format!("{word} -> {better}: {count} uses, {allowed} in the list"));
        }
        rewritten += &format!("{word}\t{better}\t{}\n", count.min(allowed));
    }
    if std::env::var_os("WILDFIRE_REWRITE_DATA").is_some() {
        fs::write(&list, rewritten).expect("writable");
        return;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn identifiers_are_found_outside_of_comments_and_text() {
    let code = "let told = 'a'; // asked\nr#\"given \"# + \"said \\\" held\" 'x: b'\\'' lifetime";
    assert_eq!(identifiers(code), ["let", "told", "x", "b", "lifetime"]);
    assert_eq!(spaced("is_toldApart"), " is told apart ");
}
