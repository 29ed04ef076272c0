//! The planners that `wildfire new planner` writes play by the rules.

use crate::children::{self, output_of};
use crate::shell::{Shell, has};

/// Plays and plans with a planner that is registered by this option, and that takes this time for a query at most, in the
/// mean.
fn expect_it_plays(shell: &Shell, options: [&str; 2], max_cpu_s: f64) {
    let batch = ["batch", "contest", "--seeds", "3", "--planner", "mine", "--out", "out"];
    shell.run(&[&batch[..], &options].concat(), &[0]);
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
    assert!(cpu_s < max_cpu_s, "{cpu_s} s a query");
    let poses = ["plan", "--scenario", "contest", "--set", "field.coverage=0", "--goals", "12", "--csv", "poses.csv"];
    shell.run(&[&poses[..], &["--planner", "mine"], &options].concat(), &[0]);
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
    let plan = ["plan", "--scenario", "smoke", "--cells", "3", "--planner", "mine", "--repeat"];
    let printed = String::from_utf8_lossy(&shell.run(&[&plan[..], &options].concat(), &[0]).stdout).into_owned();
    assert!(printed.contains("bit-identical"), "{printed}");
    shell.expect_nobody();
}

#[test]
fn template_in_python_plays() {
    let shell = Shell::new();
    shell.run(&["new", "planner", "mine.py"], &[0]);
    shell.refuse(&["new", "planner", "mine.py"], &["already exists"]);
    shell.refuse(&["new", "planner", "mine.js"], &[".py, .c, .cpp or .rs"]);
    let text = std::fs::read_to_string(shell.path("mine.py")).expect("it was written");
    assert!(text.contains("python3 mine.py") && !text.contains("FILE"));
    if has("python3", &["--version"]) {
        expect_it_plays(&shell, ["--command", "mine=python3 mine.py"], 0.1);
    }
}

/// Writes the template, and returns the lines of its head that follow this one.
fn written<'a>(shell: &Shell, file: &str, text: &'a mut String, before: &str) -> Vec<&'a str> {
    shell.run(&["new", "planner", file], &[0]);
    *text = std::fs::read_to_string(shell.path(file)).expect("it was written");
    let lines = text.lines().skip_while(|line| !line.starts_with(before));
    lines.take_while(|line| line.starts_with("//")).map(|line| line.trim_start_matches("//").trim()).collect()
}

fn build(shell: &Shell, command: &str) {
    let built = output_of(children::command("sh").args(["-c", command]).current_dir(shell.folder()));
    assert!(built.status.success(), "{command}: {}", String::from_utf8_lossy(&built.stderr));
}

/// Writes the template, builds it by the command of its head, and plays.
fn expect_it_is_built_and_plays(file: &str, compiler: &str) {
    let (shell, mut text) = (Shell::new(), String::new());
    let head = written(&shell, file, &mut text, "// Build it:");
    if has(compiler, &["--version"]) {
        build(&shell, head[0].trim_start_matches("Build it:"));
        expect_it_plays(&shell, ["--command", "mine=./planner"], 0.005);
    }
}

/// Writes the template, makes a module of it by the command of its head if `compiler` is there, and plays.
fn expect_it_is_a_module_and_plays(file: &str, compiler: &str, arguments: &[&str]) {
    let (shell, mut text) = (Shell::new(), String::new());
    let [_, _, command, run, ..] = written(&shell, file, &mut text, "// As a WebAssembly module")[..] else {
        panic!("it gives three commands: {text}")
    };
    assert_eq!(run, "wildfire run contest --module mine=mine.wasm --set unimog.planner=mine");
    if has(compiler, arguments) {
        build(&shell, command);
        expect_it_plays(&shell, ["--module", "mine=mine.wasm"], 2.0);
    }
}

#[test]
fn template_in_c_plays() {
    expect_it_is_built_and_plays("mine.c", "cc");
}

#[test]
fn template_in_cpp_plays() {
    expect_it_is_built_and_plays("mine.cpp", "g++");
}

#[test]
fn template_in_rust_plays() {
    expect_it_is_built_and_plays("mine.rs", "rustc");
}

const ZIG: [&str; 3] = ["-m", "ziglang", "version"];

#[test]
#[ignore = "tier 2: interpreted by a debug build it takes a minute"]
fn template_in_c_plays_as_a_module() {
    expect_it_is_a_module_and_plays("mine.c", "python3", &ZIG);
}

#[test]
#[ignore = "tier 2: interpreted by a debug build it takes a minute, and so does compiling its library"]
fn template_in_cpp_plays_as_a_module() {
    expect_it_is_a_module_and_plays("mine.cpp", "python3", &ZIG);
}

#[test]
#[ignore = "tier 2: interpreted by a debug build it takes a minute"]
fn template_in_rust_plays_as_a_module() {
    // Only with the target's library there is something to compile against.
    let libraries = "test -d \"$(rustc --print target-libdir --target wasm32-wasip1)\"";
    expect_it_is_a_module_and_plays("mine.rs", "sh", &["-c", libraries]);
}
