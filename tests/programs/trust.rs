//! A scenario file starts no program unless it is trusted.

use crate::shell::Shell;
use crate::stage::{AHEAD, script};

/// A scenario whose planner leaves a file as soon as it starts.
fn scene() -> Shell {
    let shell = Shell::new();
    shell.file("mine.sh", &format!(": > touched\n{}", script(AHEAD)));
    shell.file(
        "mine.toml",
        "duration_s = 120.0\n[field]\nsize_m = 100.0\ncoverage = 0.05\n[[wumpus]]\nstart_m = [2.5, 2.5]\n[[unimog]]\nplanner = \"mine\"\n\
         [planner.mine]\ncommand = [\"sh\", \"mine.sh\", \"a b\"]\nfiles = [\"notes.txt\"]\n",
    );
    shell.file("notes.txt", "one\n");
    shell
}

#[test]
fn program_of_a_file_is_shown_and_not_started() {
    let shell = scene();
    let fragments = ["planner `mine`", "would have run in .: sh mine.sh 'a b'", "--trust"];
    shell.refuse(&["run", "mine.toml"], &fragments);
    shell.refuse(&["run", "mine.toml", "--out", "run.wildfire"], &fragments);
    shell.refuse(&["batch", "mine.toml", "--out", "out"], &fragments);
    shell.refuse(&["batch", "mine.toml", "--dry-run"], &fragments);
    shell.refuse(&["plan", "--scenario", "mine.toml"], &fragments);
    shell.refuse(&["render", "mine.toml", "--out", "still.png"], &fragments);
    // What only reads never starts anything, trusted or not.
    shell.run(&["check", "mine.toml"], &[0]);
    shell.run(&["check", "mine.toml", "--trust"], &[0]);
    let schema = shell.run(&["schema", "planner-protocol"], &[0]);
    assert!(serde_json::from_slice::<serde_json::Value>(&schema.stdout).is_ok());
    // Nor do planners that nobody asks for.
    shell.run(&["run", "mine.toml", "--set", "unimog.planner=prm-rs"], &[0]);
    assert!(!shell.path("touched").exists());
    shell.run(&["run", "mine.toml", "--trust"], &[0]);
    assert!(shell.path("touched").exists());
    shell.expect_nobody();
}

#[test]
fn program_of_the_command_line_is_trusted_and_works_in_the_current_folder() {
    let shell = Shell::new();
    shell.file("own script.sh", &format!("echo \"$1\" > told\n{}", script(AHEAD)));
    let command = "own=sh 'own script.sh' \"a  b\"";
    let options = ["--command", command, "--set", "unimog.planner=own", "--set", "duration_s=60"];
    let with = |first: &[&'static str]| first.iter().copied().chain(options).collect::<Vec<_>>();
    shell.run(&with(&["run", "smoke"]), &[0]);
    assert_eq!(std::fs::read_to_string(shell.path("told")).expect("it was started"), "a  b\n");
    let planners =
        ["batch", "smoke", "--seeds", "1..2", "--out", "out", "--planner", "own,prm-rs", "--command", command];
    shell.run(&planners, &[0]);
    let rows = std::fs::read_to_string(shell.path("out/runs.csv")).expect("it was written");
    assert_eq!(rows.lines().filter(|row| row.contains("own")).count(), 2, "{rows}");
    shell.refuse(&["run", "smoke", "--command", "own"], &["NAME=COMMAND"]);
    shell.refuse(&["run", "smoke", "--command", "prm-rs=sh"], &["built-in"]);
    shell.refuse(&["run", "smoke", "--command", "own='sh"], &["not closed"]);
    shell.expect_nobody();
}

#[test]
fn batch_is_resumed_with_the_same_files_and_with_trust_only() {
    let shell = scene();
    let batch = ["batch", "mine.toml", "--seeds", "1..3", "--out", "out", "--trust"];
    shell.run(&batch, &[0]);
    let plan: serde_json::Value =
        serde_json::from_slice(&std::fs::read(shell.path("out/plan.json")).expect("it was written")).expect("JSON");
    let table = &plan["variants"][0]["scenario"]["planner"]["mine"];
    assert_eq!(table["command"][1], "mine.sh");
    let hashes = table["sha256"].as_object().expect("it has hashes");
    assert_eq!(hashes.keys().collect::<Vec<_>>(), ["mine.sh", "notes.txt"]);
    assert_eq!(hashes["notes.txt"], "2c8b08da5ce60398e1f19af0e5dccc744df274b826abe585eaba68c525434806");
    shell.refuse(&["batch", "--resume", "out"], &["planner `mine`", "--trust"]);
    shell.run(&["batch", "--resume", "out", "--trust"], &[0]);
    shell.file("notes.txt", "two\n");
    shell.refuse(
        &["batch", "--resume", "out", "--trust"],
        &["has changed since the batch began", "notes.txt has changed"],
    );
    std::fs::remove_file(shell.path("notes.txt")).expect("it is there");
    shell.refuse(&["batch", "--resume", "out", "--trust"], &["notes.txt"]);
    shell.refuse(&["run", "mine.toml", "--trust"], &["notes.txt"]);
    // What is filled in cannot be written.
    shell.file("hidden.toml", "wumpus = []\n[[unimog]]\n[planner.a]\ncommand = [\"sh\"]\nworks_in = \"/\"\n");
    shell.refuse(&["check", "hidden.toml"], &["works_in"]);
    shell.expect_nobody();
}

#[test]
fn runs_of_a_program_are_audited_with_trust_and_repeat() {
    let shell = scene();
    shell.run(&["batch", "mine.toml", "--seeds", "1..2", "--out", "out", "--trust"], &[0]);
    shell.refuse(&["audit", "out"], &["planner `mine`", "--trust"]);
    shell.run(&["audit", "out", "--trust"], &[0]);
    shell.run(&["run", "mine.toml", "--trust", "--out", "run.wildfire"], &[0]);
    shell.run(&["audit", "run.wildfire"], &[0]);
    let output = shell.run(&["plan", "--scenario", "mine.toml", "--goals", "3", "--trust", "--repeat"], &[0]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("bit-identical"));
    let fickle = "answer=$(od -An -N2 -tu2 /dev/urandom | tr -d ' '); echo \"{\\\"type\\\":\\\"none\\\",\\\"id\\\":$id,\\\"reason\\\":\\\"disconnected\\\",\\\"expansions\\\":$answer}\"";
    shell.file("fickle.sh", &script(fickle));
    let arguments = ["plan", "--goals", "3", "--planner", "fickle", "--command", "fickle=sh fickle.sh", "--repeat"];
    let output = shell.run(&arguments, &[0]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("not reproducible"), "{output:?}");
}
