//! A scratch folder in which the program is told to do things, and what it answers.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::children::{self, output_of};

/// Presets of which a run, or a check, takes longer than those of all others together: they are for the second tier.
pub const LARGE: [&str; 3] = ["brigade", "county", "duel"];

/// A folder of its own for one test.
pub struct Story {
    folder: TempDir,
}

/// What the program answered.
pub struct Answer {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Story {
    pub fn begin() -> Self {
        Self { folder: tempfile::tempdir().expect("a scratch folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn file(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("the scratch folder is writable");
    }

    pub fn read(&self, name: &str) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// Names of what lies in the folder.
    pub fn entries(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("the scratch folder is readable");
        let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("readable").file_name();
        let mut names: Vec<_> = entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// A shell that runs this script in this folder, with the path of the program as `$0`.
    #[cfg(unix)]
    pub fn shell(&self, script: &str) -> Command {
        let mut command = children::command("sh");
        command.args(["-c", script, env!("CARGO_BIN_EXE_wildfire")]).current_dir(self.folder.path());
        command
    }

    /// The program, in this folder, with these arguments, not run yet.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = children::program();
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    pub fn tell(&self, arguments: &[&str]) -> Answer {
        Answer::of(&output_of(&mut self.command(arguments)))
    }
}

impl Answer {
    pub fn of(output: &Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Stops the test unless the program ended with this code.
    pub fn expect_code(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// Stops the test unless stderr holds all these words.
    pub fn expect_complaint(self, fragments: &[&str]) -> Self {
        // Messages about options are wrapped; a word may not stand where a line was broken.
        let flat = self.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in fragments {
            assert!(flat.contains(word), "`{word}` is missing:\n{}", self.stderr);
        }
        self
    }
}

/// Tells the program something that it must refuse as bad input without writing anything.
pub fn refuse(story: &Story, arguments: &[&str], fragments: &[&str]) {
    let before = story.entries();
    let answer = story.tell(arguments).expect_code(2).expect_complaint(fragments);
    assert!(answer.stdout.is_empty(), "{}", answer.stdout);
    assert_eq!(story.entries(), before, "{arguments:?} wrote something");
}

/// The longest line, in characters.
pub fn widest(text: &str) -> usize {
    text.lines().map(|line| line.chars().count()).max().unwrap_or(0)
}

/// Header and rows of a CSV file without the columns that are measured.
pub fn outcomes(path: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).expect("the file is there");
    let rows: Vec<csv::StringRecord> = reader.records().map(|record| record.expect("readable")).collect();
    let measured = rows[0].iter().position(|name| name.starts_with("cpu_") || name.starts_with("wall_"));
    let kept = measured.expect("measured columns are there");
    rows.iter().map(|row| row.iter().take(kept).map(str::to_owned).collect()).collect()
}
