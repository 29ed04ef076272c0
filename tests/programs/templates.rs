//! The planners that `wildfire new planner` writes play by the rules.

use std::process::Command;

use crate::shell::{Shell, has};

/// Plays and plans with a planner that is started by this command.
fn expect_it_plays(shell: &Shell, command: &str) {
    let own = format!("mine={command}");
    let arguments = ["batch", "smoke", "--seeds", "1..2", "--planner", "mine", "--command", &own, "--out", "out"];
    shell.run(&arguments, &[0]);
    shell.run(&["audit", "out", "--trust"], &[0]);
    let rows = std::fs::read_to_string(shell.path("out/runs.csv")).expect("it was written");
    let header: Vec<&str> = rows.lines().next().expect("a header").split(',').collect();
    let sum = |column: &str| {
        let place = header.iter().position(|name| *name == column).unwrap_or_else(|| panic!("no column {column}"));
        let cell = |row: &str| row.split(',').nth(place).and_then(|cell| cell.parse::<u64>().ok()).unwrap_or(0);
        rows.lines().skip(1).map(cell).sum::<u64>()
    };
    for column in ["truck_failed_timed_out", "truck_failed_crashed", "truck_failed_bad_answer"] {
        assert_eq!(sum(column), 0, "{column}: {rows}");
    }
    assert!(sum("extinguished") > 0, "it puts something out: {rows}");
    let plan = ["plan", "--scenario", "smoke", "--cells", "3", "--planner", "mine", "--command", &own, "--repeat"];
    let said = String::from_utf8_lossy(&shell.run(&plan, &[0]).stdout).into_owned();
    assert!(said.contains("the same bit for bit"), "{said}");
    shell.expect_nobody();
}

#[test]
fn template_in_python_plays() {
    let shell = Shell::new();
    shell.run(&["new", "planner", "mine.py"], &[0]);
    shell.refuse(&["new", "planner", "mine.py"], &["is there already"]);
    shell.refuse(&["new", "planner", "mine.js"], &[".py, .cpp or .rs"]);
    let text = std::fs::read_to_string(shell.path("mine.py")).expect("it was written");
    assert!(text.contains("python3 mine.py") && !text.contains("FILE"));
    if has("python3", "--version") {
        expect_it_plays(&shell, "python3 mine.py");
    }
}

/// Writes the template, builds it by the command of its head, and plays.
fn expect_it_is_built_and_plays(file: &str, compiler: &str) {
    let shell = Shell::new();
    shell.run(&["new", "planner", file], &[0]);
    if !has(compiler, "--version") {
        return;
    }
    let text = std::fs::read_to_string(shell.path(file)).expect("it was written");
    let build = text.lines().find_map(|line| line.strip_prefix("// Build it:")).expect("it says how").trim();
    let built = Command::new("sh").args(["-c", build]).current_dir(shell.folder()).output().expect("there is a shell");
    assert!(built.status.success(), "{build}: {}", String::from_utf8_lossy(&built.stderr));
    expect_it_plays(&shell, "./planner");
}

#[test]
fn template_in_cpp_plays() {
    expect_it_is_built_and_plays("mine.cpp", "g++");
}

#[test]
fn template_in_rust_plays() {
    expect_it_is_built_and_plays("mine.rs", "rustc");
}
