//! Finds what the program is built from, for `wildfire --version` and the files that name it: commit, compiler, target.
//!
//! A development build does not look at the repository, so that a commit does not compile everything again; its commit is
//! unknown. Neither does a build without a repository: of a packaged crate cargo has written down the commit.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Where the program comes from: changes elsewhere make no other program.
const SOURCES: [&str; 9] = [
    "crates",
    "src",
    "scenarios",
    "assets/fonts",
    "assets/planners",
    "assets/page",
    "assets/sprites",
    "Cargo.toml",
    "Cargo.lock",
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let crate_dir = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it for every build script"));
    // `crates/batch` of the repository.
    let root = crate_dir.join("../..");
    let is_release = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = if is_release { packaged_commit(&crate_dir).or_else(|| commit_of_clone(&root)) } else { None };
    let text = match &commit {
        Some(commit) => commit,
        None if is_release => "unknown",
        None => "unknown (development build)",
    };
    println!("cargo::rustc-env=WILDFIRE_COMMIT_WORDS={text}");
    println!("cargo::rustc-env=WILDFIRE_COMMIT={}", commit.as_deref().unwrap_or_default());
    println!("cargo::rustc-env=WILDFIRE_COMPILER={}", compiler().as_deref().unwrap_or("unknown"));
    println!("cargo::rustc-env=WILDFIRE_TARGET={}", env::var("TARGET").as_deref().unwrap_or("unknown"));
}

/// The first line that the compiler says of itself.
fn compiler() -> Option<String> {
    let output = Command::new(env::var_os("RUSTC")?).arg("--version").output().ok()?;
    Some(String::from_utf8(output.stdout).ok()?.lines().next()?.trim().to_owned())
}

/// The commit that `cargo package` took the crate from.
fn packaged_commit(root: &Path) -> Option<String> {
    let text = fs::read_to_string(root.join(".cargo_vcs_info.json")).ok()?;
    let (_, rest) = text.split_once("\"sha1\"")?;
    let hash = as_hash(rest.split('"').nth(1)?)?;
    Some(if text.contains("\"dirty\": true") { hash + "-dirty" } else { hash })
}

/// The commit that is checked out here, with `-dirty` behind it if `git` knows of sources that differ from it. A repository
/// further up is somebody else's, into which the crate was copied.
fn commit_of_clone(root: &Path) -> Option<String> {
    let folder = git_folder(root)?;
    let head = fs::read_to_string(folder.join("HEAD")).ok()?;
    // The log grows with every commit, whatever file holds its hash.
    for path in SOURCES.map(|name| root.join(name)).into_iter().chain([folder.join("HEAD"), folder.join("logs/HEAD")]) {
        // A file that is not there would make cargo ask each time.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    let hash = match head.trim().strip_prefix("ref: ") {
        None => as_hash(head.trim())?,
        Some(name) => hash_of(name, &folder)?,
    };
    Some(if is_changed(root) { hash + "-dirty" } else { hash })
}

/// The folder of the repository; a worktree has a file that names it.
fn git_folder(root: &Path) -> Option<PathBuf> {
    let entry = root.join(".git");
    if entry.is_dir() {
        return Some(entry);
    }
    let text = fs::read_to_string(entry).ok()?;
    Some(root.join(text.trim().strip_prefix("gitdir: ")?))
}

/// The hash of a branch, from a file of its own or from the list of all.
fn hash_of(name: &str, folder: &Path) -> Option<String> {
    let shared = fs::read_to_string(folder.join("commondir"));
    let shared = shared.map_or_else(|_| folder.to_owned(), |path| folder.join(path.trim()));
    for folder in [folder, &shared] {
        let path = folder.join(name);
        if let Ok(text) = fs::read_to_string(&path) {
            println!("cargo::rerun-if-changed={}", path.display());
            return as_hash(text.trim());
        }
    }
    let packed = fs::read_to_string(shared.join("packed-refs")).ok()?;
    let hash = packed.lines().find_map(|line| line.strip_suffix(name)?.strip_suffix(' '));
    as_hash(hash?)
}

/// Says whether `git` finds sources that are not as committed; without it nobody knows.
fn is_changed(root: &Path) -> bool {
    let mut git = Command::new("git");
    git.current_dir(root).env("GIT_OPTIONAL_LOCKS", "0").args(["status", "--porcelain", "--untracked-files=no", "--"]);
    git.args(SOURCES).output().is_ok_and(|output| output.status.success() && !output.stdout.is_empty())
}

/// The text, if it is the hash of a commit.
fn as_hash(text: &str) -> Option<String> {
    let is_hash = matches!(text.len(), 40 | 64) && text.bytes().all(|letter| letter.is_ascii_hexdigit());
    is_hash.then(|| text.to_owned())
}
