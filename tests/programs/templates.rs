//! The planners that `wildfire new planner` writes play by the rules.

use std::process::Command;

use crate::shell::{Shell, has};

/// Plays and plans with a planner that is started by this command, and that takes this time for a query at most, in the
/// mean.
fn expect_it_plays(shell: &Shell, command: &str, most_cpu_s: f64) {
    let own = format!("mine={command}");
    let arguments = ["batch", "contest", "--seeds", "3", "--planner", "mine", "--command", &own, "--out", "out"];
    shell.run(&arguments, &[0]);
    shell.run(&["audit", "out", "--trust"], &[0]);
    let rows = std::fs::read_to_string(shell.path("out/runs.csv")).expect("it was written");
    let header: Vec<&str> = rows.lines().next().expect("a header").split(',').collect();
    let sum = |column: &str| {
        let place = header.iter().position(|name| *name == column).unwrap_or_else(|| panic!("no column {column}"));
        let cell = |row: &str| row.split(',').nth(place).and_then(|cell| cell.parse::<f64>().ok()).unwrap_or(0.0);
        rows.lines().skip(1).map(cell).sum::<f64>()
    };
    for column in ["truck_failed_timed_out", "truck_failed_crashed", "truck_failed_bad_answer", "truck_lattice_plans"] {
        assert_eq!(sum(column), 0.0, "{column}: {rows}");
    }
    assert!(sum("extinguished") >= 100.0, "it saves 100 of 248 bushes without rescue: {rows}");
    let cpu_s = sum("cpu_unimog_total_s") / sum("truck_plans");
    assert!(cpu_s < most_cpu_s, "{cpu_s} s a query");
    let poses = ["plan", "--scenario", "contest", "--set", "field.coverage=0", "--goals", "12", "--csv", "poses.csv"];
    shell.run(&[&poses[..], &["--planner", "mine", "--command", &own]].concat(), &[0]);
    let rows = std::fs::read_to_string(shell.path("poses.csv")).expect("it was written");
    let column = |row: &str, name: &str| {
        let place = rows.lines().next().expect("a header").split(',').position(|found| found == name);
        row.split(',').nth(place.expect("there is such a column")).expect("a cell").to_owned()
    };
    let ratios: Vec<f64> =
        rows.lines().skip(1).map(|row| column(row, "lower_bound_ratio").parse().expect("a ratio")).collect();
    // Where the border is not in the way, the curve is the shortest of all that the truck can drive.
    assert_eq!(ratios.len(), 12, "it drives to every pose: {rows}");
    assert!(ratios.iter().filter(|&&ratio| (ratio - 1.0).abs() < 1e-6).count() >= 10, "{ratios:?}");
    let plan = ["plan", "--scenario", "smoke", "--cells", "3", "--planner", "mine", "--command", &own, "--repeat"];
    let said = String::from_utf8_lossy(&shell.run(&plan, &[0]).stdout).into_owned();
    assert!(said.contains("bit-identical"), "{said}");
    shell.expect_nobody();
}

#[test]
fn template_in_python_plays() {
    let shell = Shell::new();
    shell.run(&["new", "planner", "mine.py"], &[0]);
    shell.refuse(&["new", "planner", "mine.py"], &["already exists"]);
    shell.refuse(&["new", "planner", "mine.js"], &[".py, .cpp or .rs"]);
    let text = std::fs::read_to_string(shell.path("mine.py")).expect("it was written");
    assert!(text.contains("python3 mine.py") && !text.contains("FILE"));
    if has("python3", "--version") {
        expect_it_plays(&shell, "python3 mine.py", 0.1);
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
    expect_it_plays(&shell, "./planner", 0.005);
}

#[test]
fn template_in_cpp_plays() {
    expect_it_is_built_and_plays("mine.cpp", "g++");
}

#[test]
fn template_in_rust_plays() {
    expect_it_is_built_and_plays("mine.rs", "rustc");
}
