//! What the crates are for decides what they may use. The compiler keeps them to their manifests; this keeps the manifests,
//! and the rooms inside of crates, as [ARCHITECTURE.md] says.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The crates, lowest first, with those of ours that each uses.
const CRATES: [(&str, &[&str]); 13] = [
    ("base", &[]),
    ("grid", &["base"]),
    ("fire", &["base"]),
    ("planning", &["base", "grid"]),
    // Readers of runs know no planner.
    ("timeline", &["base", "fire"]),
    // A second opinion shares no code with what it judges.
    ("audit", &["base", "fire", "timeline"]),
    ("picture", &["base", "grid", "fire", "timeline"]),
    // What runs in a module cannot harm anybody, so it knows nobody.
    ("module", &["base"]),
    // What reads files runs nothing.
    ("scenario", &["base", "grid", "fire", "planning", "module"]),
    ("sim", &["base", "grid", "fire", "planning", "scenario", "timeline", "module"]),
    ("batch", &["base", "planning", "timeline", "audit", "picture", "scenario", "sim"]),
    // A window reads timelines; nothing in it can change an outcome.
    ("view", &["base", "picture"]),
    // A browser has no batches, files and programs.
    ("web", &["base", "picture", "scenario", "sim", "timeline"]),
];

/// Rooms of `batch`, each with those that it may use: first it is known which runs there are, then they take place, then
/// tables are written, which other tools read too, and then something is said of them.
const ROOMS_OF_BATCH: [(&str, &[&str]); 13] = [
    ("stats", &[]),
    ("plan", &[]),
    ("together", &["plan"]),
    ("execute", &["plan"]),
    // The dictionary of all tables has the columns of decisions.
    ("table", &["plan", "execute", "decisions"]),
    ("decisions", &["stats", "plan", "execute", "table"]),
    ("comparison", &["stats", "plan", "execute", "table"]),
    ("stopping", &["stats", "plan", "execute", "table", "comparison"]),
    ("report", &["stats", "plan", "execute", "table", "comparison"]),
    ("maps", &["stats", "plan", "execute", "table"]),
    ("drives", &["stats", "plan", "table", "comparison"]),
    ("arena", &["stats", "plan", "execute", "table", "comparison", "report", "drives"]),
    ("grading", &["plan", "execute", "table", "comparison", "report", "arena"]),
];

/// Rooms of `scenario`: what may be wrong, the field, the keys that describe it, how they are read, how they are explained.
const ROOMS_OF_SCENARIO: [(&str, &[&str]); 6] = [
    ("faults", &[]),
    ("site", &["faults"]),
    ("keys", &["faults", "site"]),
    ("memory", &["faults", "site", "keys"]),
    ("read", &["faults", "site", "keys", "memory"]),
    ("explain", &["faults", "site", "keys", "memory", "read"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the sources are there").map(|entry| entry.expect("readable").path());
    entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

fn of_crate(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates").join(name)
}

/// Names that follow `start` anywhere in the code of a file, with the number of their line.
fn names_after(path: &Path, start: &str) -> Vec<(String, usize)> {
    let text = fs::read_to_string(path).expect("sources are readable text");
    let mut names = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        names.extend(code.split(start).skip(1).map(|rest| {
            let name = rest.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect();
            (name, index + 1)
        }));
    }
    names
}

/// What files in the folders of `rooms` name of other rooms, behind one of the starts, unless it is `allowed`.
fn forbidden(folder: &Path, rooms: &[&str], starts: &[&str], allowed: impl Fn(&str, &str) -> bool) -> Vec<String> {
    let mut objections = Vec::new();
    for room in rooms {
        let path = folder.join(room);
        let files = if path.is_dir() { sources(&path) } else { vec![path.with_extension("rs")] };
        for (path, start) in files.iter().flat_map(|path| starts.iter().map(move |start| (path, start))) {
            let named = names_after(path, start).into_iter();
            let named =
                named.filter(|(name, _)| name != room && rooms.contains(&name.as_str()) && !allowed(room, name));
            objections.extend(named.map(|(name, line)| format!("{}:{line} uses {name}", path.display())));
        }
    }
    objections
}

#[test]
fn crates_use_what_they_may() {
    for (name, used) in CRATES {
        let manifest = fs::read_to_string(of_crate(name).join("Cargo.toml")).expect("every crate has a manifest");
        let lines = manifest.lines().take_while(|line| *line != "[dev-dependencies]");
        let found = lines.filter_map(|line| line.strip_prefix("wildfire-")?.split(['.', ' ']).next());
        assert_eq!(found.collect::<BTreeSet<_>>(), used.iter().copied().collect(), "what wildfire-{name} uses");
    }
    let folders = fs::read_dir(of_crate("")).expect("there are crates").count();
    assert_eq!(folders, CRATES.len(), "a crate that is not in the table");
}

#[test]
fn rooms_use_each_other_one_way() {
    for (folder, rooms) in [("batch/src", &ROOMS_OF_BATCH[..]), ("scenario/src", &ROOMS_OF_SCENARIO)] {
        let folder = of_crate(folder);
        let may_use = |room: &str, other: &str| rooms.iter().any(|(name, used)| *name == room && used.contains(&other));
        let names: Vec<&str> = rooms.iter().map(|(room, _)| *room).collect();
        assert_eq!(forbidden(&folder, &names, &["crate::", "super::super::"], may_use), [""; 0]);
        let entries = fs::read_dir(&folder).expect("the sources are there").count();
        assert_eq!(entries, rooms.len() + 1, "what is no room and not `lib.rs`");
    }
}

#[test]
fn planners_use_the_kit_and_no_sibling() {
    let folder = of_crate("planning/src/planners");
    let planners: Vec<String> = fs::read_dir(&folder)
        .expect("there are planners")
        .filter_map(|entry| entry.expect("readable").path().file_stem()?.to_str().map(str::to_owned))
        .filter(|name| name != "mod")
        .collect();
    let planners: Vec<&str> = planners.iter().map(String::as_str).collect();
    assert!(planners.len() > 3, "the planners were not found: {planners:?}");
    assert_eq!(forbidden(&folder, &planners, &["planners::", "super::super::"], |_, _| false), [""; 0]);
    // The kit knows none of those who are made of it.
    for path in sources(&of_crate("planning/src/kit")) {
        for above in ["planners", "registry", "reachability", "traffic", "walk"] {
            let found = names_after(&path, "crate::").into_iter().find(|(name, _)| name == above);
            assert_eq!(found, None, "{} uses {above}", path.display());
        }
    }
}
