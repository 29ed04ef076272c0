//! A scratch folder in which `wildfire` is told to do things.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use crate::children::{self, output_of, wait_until};
use crate::stage::processes_in;

/// A scratch folder.
pub struct Shell {
    folder: TempDir,
}

impl Shell {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a scratch folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn file(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("the scratch folder is writable");
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = children::program();
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    /// Runs the program and expects one of these exit codes.
    pub fn run(&self, arguments: &[&str], codes: &[i32]) -> Output {
        let output = output_of(&mut self.command(arguments));
        let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let code = output.status.code().expect("it ends by itself");
        assert!(codes.contains(&code), "{arguments:?} ended with {code}\nstdout:\n{stdout}\nstderr:\n{stderr}");
        output
    }

    /// Runs the program, expects that it refuses what it is asked, and that stderr has these words.
    pub fn refuse(&self, arguments: &[&str], fragments: &[&str]) {
        let before = self.entries();
        let stderr = String::from_utf8_lossy(&self.run(arguments, &[2]).stderr).into_owned();
        let flat = stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in fragments {
            assert!(flat.contains(word), "`{word}` is missing:\n{stderr}");
        }
        assert_eq!(self.entries(), before, "{arguments:?} wrote something");
    }

    pub fn entries(&self) -> Vec<PathBuf> {
        let mut entries: Vec<PathBuf> =
            fs::read_dir(self.folder.path()).expect("readable").map(|entry| entry.expect("readable").path()).collect();
        entries.sort();
        entries
    }

    /// Waits until no process works in the folder.
    pub fn expect_nobody(&self) {
        wait_until("no process is left", || processes_in(self.folder.path()).is_empty());
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }
}

/// Says whether a program is on the machine; if not, which test is left out.
#[expect(clippy::print_stdout, reason = "whoever reads the test's output is to know")]
pub fn has(program: &str, arguments: &[&str]) -> bool {
    let found = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let is_there = found.is_ok_and(|status| status.success());
    if !is_there {
        println!("left out, since this fails here: {program} {}", arguments.join(" "));
    }
    is_there
}
