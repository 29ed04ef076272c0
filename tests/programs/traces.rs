//! Nothing of a program is left, however it and we end.

use wildfire::programs::{ProgramPool, Trust};

use crate::children::wait_until;
use crate::stage::{AHEAD, GREETING, Stage, ask, script};

#[test]
fn program_that_ends_when_told_leaves_nothing() {
    let stage = Stage::new(&script(AHEAD), "");
    let mut planner = stage.planner().expect("it starts");
    assert!(ask(planner.as_mut()).path.is_ok());
    assert!(!stage.processes().is_empty());
    drop(planner);
    assert_eq!(stage.processes(), [0; 0], "it was waited for");
}

#[test]
fn program_that_ignores_its_end_is_killed() {
    let script = format!("trap '' TERM HUP INT\n{GREETING}\nwhile :; do sleep 0.1; done");
    let stage = Stage::new(&script, "");
    drop(stage.planner().expect("it starts"));
    assert_eq!(stage.processes(), [0; 0], "it was waited for");
}

#[test]
fn children_of_a_program_end_with_it_wherever_they_moved() {
    let stage =
        Stage::new(&script("sleep 300 &\n(setsid sleep 300 &)\n(setsid sh -c 'sleep 300 & wait' &)\nexit 1"), "");
    let mut planner = stage.planner().expect("it starts");
    assert!(ask(planner.as_mut()).path.is_err());
    assert_eq!(stage.processes(), [0; 0], "they were killed with it");
}

#[test]
fn supervisor_that_is_killed_takes_the_program_along() {
    let stage = Stage::new(&script(AHEAD), "");
    let mut planner = stage.planner().expect("it starts");
    let supervisor = stage.processes().into_iter().find(|pid| {
        let command = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&command).contains("supervise-program")
    });
    let supervisor = supervisor.expect("it has one");
    assert!(
        std::process::Command::new("kill")
            .args(["-9", &supervisor.to_string()])
            .status()
            .expect("there is a kill")
            .success()
    );
    wait_until("it is gone", || !stage.processes().contains(&supervisor));
    // The program may still answer; it is gone at the end at the latest.
    let _ = ask(planner.as_mut());
    drop(planner);
    stage.expect_nobody();
}

#[test]
fn program_that_may_play_again_does() {
    let mut stage = Stage::new(
        &format!(
            "{GREETING}\necho x >> starts\nwhile read -r line; do case $line in\n\
                  *'\"type\":\"end\"'*) exit 0;;\n*'\"type\":\"field\"'*) id=0; echo '{{\"type\":\"ready\"}}';;\n\
                  *) id=$((id+1)); {AHEAD};;\nesac; done"
        ),
        "reuse = true",
    );
    for _ in 0..4 {
        let mut planner = stage.planner().expect("it starts");
        assert!(ask(planner.as_mut()).path.is_ok());
    }
    let starts = std::fs::read_to_string(stage.path().join("starts")).expect("it was started");
    assert_eq!(starts.lines().count(), 1);
    assert!(!stage.processes().is_empty(), "it waits for the next run");
    stage.pool = ProgramPool::new(Trust::All);
    assert_eq!(stage.processes(), [0; 0], "it was waited for");
}
