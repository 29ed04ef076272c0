//! Each line of the table of failures: a program that does just that.

use std::time::Duration;

use wildfire::planning::PlanFailure;

use crate::stage::{AHEAD, Stage, ask, script};

/// Expects that a program does not start, for a reason with these words.
fn expect_no_start(script: &str, settings: &str, fragments: &[&str]) {
    let stage = Stage::new(script, settings);
    let Err(reason) = stage.planner() else { panic!("it started: {script}") };
    for word in fragments {
        assert!(reason.contains(word), "`{word}` is missing: {reason}");
    }
    stage.expect_nobody();
}

/// Expects that a query fails in this way, that the message has these words, and that the next query is answered by a
/// program that was started again.
fn expect_failure(first: &str, settings: &str, failure: PlanFailure, fragments: &[&str]) {
    // A program that finds the file has been started again.
    let body = format!("if [ -e begun ]; then {AHEAD}; else : > begun\n{first}\nfi");
    let stage = Stage::new(&script(&body), settings);
    let mut planner = stage.planner().expect("it starts");
    let plan = ask(planner.as_mut());
    assert_eq!(plan.path.err(), Some(failure), "{:?}", plan.message);
    let message = plan.message.expect("it says why");
    for word in fragments {
        assert!(message.contains(word), "`{word}` is missing: {message}");
    }
    let plan = ask(planner.as_mut());
    assert!(plan.path.is_ok(), "{:?}", plan.message);
    drop(planner);
    stage.expect_nobody();
}

#[test]
fn program_that_does_not_start_says_why() {
    let soon = "start_limit_s = 0.5";
    expect_no_start("sleep 100", soon, &["gave no `hello` within"]);
    expect_no_start("read -r line; echo '{\"type\":\"hello\",\"protocol\":1}'; sleep 100", soon, &["gave no `ready`"]);
    expect_no_start("exit 7", "", &["ended with exit code 7"]);
    expect_no_start("echo no such module >&2; exit 1", "", &["exit code 1", "last words: no such module"]);
    expect_no_start("kill -9 $$", "", &["was ended by the signal SIGKILL"]);
    expect_no_start("echo hello", "", &["answered `hello`", "no JSON object"]);
    expect_no_start("echo '{\"type\":\"hello\",\"protocol\":2}'", "", &["`protocol` is 2; expected 1"]);
    expect_no_start("echo '{\"type\":\"ready\"}'", "", &["expected the type `hello`"]);
    let refuses =
        "echo '{\"type\":\"hello\",\"protocol\":1}'; echo '{\"type\":\"error\",\"message\":\"too small\"}'; cat";
    expect_no_start(refuses, "", &["refuses the field: too small"]);
    let stage = Stage::new("", "");
    std::fs::remove_file(stage.path().join("script.sh")).expect("it is there");
    assert!(stage.planner().err().is_some_and(|reason| reason.contains("ended with exit code")));
}

#[test]
fn program_that_is_not_there_is_named() {
    let stage = Stage::new("", "settings = { a = 1 }");
    let text = std::fs::read_to_string(stage.path().join("stage.toml")).expect("it was written");
    let other = text.replace("\"sh\"", "\"./no-such-program\"");
    assert_ne!(other, text);
    let stage = Stage::from_text(&other);
    let reason = stage.planner().err().expect("it cannot start");
    assert!(reason.contains("cannot be started") && reason.contains("No such file"), "{reason}");
}

#[test]
fn program_that_does_not_answer_is_killed_and_started_anew() {
    let soon = "query_limit_s = 1.5";
    expect_failure("sleep 100", soon, PlanFailure::TimedOut, &["gave no answer within 1.5 s"]);
    expect_failure("printf '{\"type\":'; sleep 100", soon, PlanFailure::TimedOut, &["gave no answer"]);
    expect_failure("while :; do echo spam >&2; done", soon, PlanFailure::TimedOut, &["gave no answer"]);
    let cpu = "query_cpu_s = 0.3";
    expect_failure("while :; do :; done", cpu, PlanFailure::TimedOut, &["within 0.3 s of CPU time"]);
    expect_failure("sh -c 'while :; do :; done'", cpu, PlanFailure::TimedOut, &["within 0.3 s of CPU time"]);
}

#[test]
fn program_that_ends_says_how_and_is_started_anew() {
    let crashed = PlanFailure::Crashed;
    expect_failure("exit 3", "", crashed, &["ended with exit code 3"]);
    expect_failure("echo one >&2; echo 'two  ' >&2; exit 1", "", crashed, &["exit code 1; its last words: two"]);
    expect_failure("kill -SEGV $$", "", crashed, &["signal SIGSEGV"]);
    expect_failure("exec >&-; exec sleep 100", "", crashed, &["closed its output"]);
    // Its input too: it is found when the next query is not taken.
    expect_failure("exec <&-; exec sleep 100", "query_limit_s = 1", PlanFailure::TimedOut, &["gave no answer"]);
}

#[test]
fn answer_that_is_none_is_quoted_and_the_program_started_anew() {
    let bad = PlanFailure::BadAnswer;
    expect_failure("echo planning...", "", bad, &["answered `planning...`", "no JSON object", "stderr"]);
    expect_failure("echo '{\"type\":\"path\",\"id\":1,'", "", bad, &["no JSON"]);
    expect_failure("echo '{\"type\":\"ready\"}'", "", bad, &["expected the type `path` or `none`"]);
    expect_failure("echo '{\"type\":\"path\",\"id\":9,\"segments\":[]}'", "", bad, &["`id` is 9; expected 1"]);
    expect_failure("echo '{\"type\":\"path\",\"id\":1}'", "", bad, &["`segments` or `poses`"]);
    expect_failure("head -c 17000000 /dev/zero | tr '\\0' x; echo", "", bad, &["longer than 16000000 bytes", "xxx…"]);
    expect_failure("cat /dev/zero", "", bad, &["longer than 16000000 bytes"]);
}

#[test]
fn program_that_takes_too_much_is_killed() {
    let crashed = PlanFailure::Crashed;
    let forks = "for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do sleep 100 & done; wait";
    expect_failure(forks, "", crashed, &["processes and was killed"]);
    expect_failure(
        "head -c 400000000 /dev/zero | tail",
        "memory_limit_mb = 60",
        crashed,
        &["MB of memory and was killed"],
    );
}

#[test]
fn program_that_fails_too_often_is_not_started_again() {
    let once = format!("echo x >> starts; [ -e begun ] && exit 1; : > begun\n{}", script("exit 1"));
    let stage = Stage::new(&once, "restarts = 2");
    let mut planner = stage.planner().expect("it starts");
    for query in 0..6 {
        let plan = ask(planner.as_mut());
        assert_eq!(plan.path.err(), Some(PlanFailure::Crashed));
        let cpu = plan.cpu.expect("it is known");
        assert_eq!(cpu.starting > Duration::ZERO, (1..=3).contains(&query), "query {query}: {cpu:?}");
        assert!(cpu.starting <= cpu.time, "{cpu:?}");
    }
    let message = ask(planner.as_mut()).message.expect("it says why");
    assert!(message.contains("failed to start more often than it may"), "{message}");
    let starts = std::fs::read_to_string(stage.path().join("starts")).expect("it was started");
    assert_eq!(starts.lines().count(), 1 + 3, "a run bears two failed starts");
}

#[test]
fn query_that_fails_costs_that_query_alone() {
    let settings = "restarts = 0\nquery_limit_s = 1.5";
    for failure in ["sleep 100", "exit 3", "echo nonsense"] {
        let body = format!("echo x >> asked; if [ $(wc -l < asked) -gt 2 ]; then {AHEAD}; else {failure}; fi");
        let stage = Stage::new(&script(&body), settings);
        let mut planner = stage.planner().expect("it starts");
        for _ in 0..2 {
            assert!(ask(planner.as_mut()).path.is_err());
        }
        let plan = ask(planner.as_mut());
        assert!(plan.path.is_ok(), "{failure}: {:?}", plan.message);
    }
}

#[test]
fn program_whose_path_is_refused_lives_on() {
    // It ends beside the goal, then in a turn that no truck makes, then where it should.
    let body = format!(
        "echo x >> queries\ncase $id in\n1) echo '{{\"type\":\"path\",\"id\":1,\"segments\":[[0,3]]}}';;\n\
         2) echo '{{\"type\":\"path\",\"id\":2,\"segments\":[[1,10]]}}';;\n*) {AHEAD};;\nesac"
    );
    let stage = Stage::new(&script(&body), "restarts = 0");
    let mut planner = stage.planner().expect("it starts");
    for _ in 0..2 {
        assert_eq!(ask(planner.as_mut()).path.err(), Some(PlanFailure::BadAnswer));
    }
    assert!(ask(planner.as_mut()).path.is_ok());
}

#[test]
fn answers_of_all_kinds_are_understood() {
    let body = r#"case $id in
1) echo '{"type":"path","id":1,"poses":[[45,50,0],[50,50,0]],"expansions":12,"note":{"any":["thing",null]}}';;
2) echo '{"type":"none","id":2,"reason":"goal-blocked"}';;
3) echo '{"type":"none","id":3,"reason":"start-blocked","expansions":4,"cpu_s":1000}';;
4) echo '{"type":"none","id":4,"reason":"budget-spent"}';;
5) echo '{"type":"none","id":5,"reason":"disconnected"}';;
esac"#;
    let stage = Stage::new(&script(body), "");
    let mut planner = stage.planner().expect("it starts");
    let plan = ask(planner.as_mut());
    let path = plan.path.expect("it is free");
    assert!((path.end().x - 50.0).abs() < 1e-9 && (path.length_m() - 10.0).abs() < 1e-9);
    assert_eq!(plan.effort.local_expansions, 12);
    let reasons =
        [PlanFailure::GoalBlocked, PlanFailure::StartBlocked, PlanFailure::BudgetSpent, PlanFailure::Disconnected];
    for reason in reasons {
        let plan = ask(planner.as_mut());
        assert_eq!((plan.path.err(), plan.message), (Some(reason), None));
    }
}

#[test]
fn program_is_told_of_its_field_and_of_the_query() {
    let settings = "settings = { range_m = 12, names = [\"a\", \"b\"] }";
    let body = format!("echo \"$hello\" > told; echo \"$field\" >> told; echo \"$line\" >> told\n{AHEAD}");
    let stage = Stage::new(&script(&body), settings);
    let mut planner = stage.planner().expect("it starts");
    assert!(ask(planner.as_mut()).path.is_ok());
    let received = std::fs::read_to_string(stage.path().join("told")).expect("it was told");
    let lines: Vec<serde_json::Value> =
        received.lines().map(|line| serde_json::from_str(line).expect("it is JSON")).collect();
    let [hello, field, plan] = lines.as_slice() else { panic!("{received}") };
    assert_eq!((hello["type"].as_str(), hello["protocol"].as_u64()), (Some("hello"), Some(1)));
    assert_eq!((field["run"].as_str(), field["truck"].as_u64()), (Some("stage"), Some(0)));
    assert_eq!((field["cols"].as_u64(), field["cell_m"].as_f64()), (Some(20), Some(5.0)));
    assert_eq!(field["settings"], serde_json::json!({ "range_m": 12, "names": ["a", "b"] }));
    assert!(field["seed"].as_u64().is_some_and(|seed| seed < 1 << 53));
    assert_eq!(field["vehicle"]["min_turn_radius"].as_f64(), Some(13.0));
    assert!(field["limits"]["braking"].is_null());
    assert_eq!(plan["start"], serde_json::json!([40.0, 50.0, 0.0]));
    assert_eq!(plan["goal"]["disc"], serde_json::json!([51.5, 50.0, 2.0]));
}
