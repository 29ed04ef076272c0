//! WebAssembly modules as planners and policies: they need no trust, break nothing, and their runs are the same each time.

use wildfire::planning::{Plan, PlanFailure};

use crate::shell::Shell;
use crate::stage::{Stage, ask};

/// Says that there is no path, and that this took many expansions.
const NONE: &str = "(call $answer (i32.const 1536) (i32.const 64) (local.get $id))";
/// Drives ten metres straight ahead.
const AHEAD: &str = "(call $answer (i32.const 1792) (i32.const 60) (local.get $id))";
const LOOP: &str = "(loop $again (br $again))";
const BOMB: &str = "(loop $again (br_if $again (i32.ge_s (memory.grow (i32.const 100)) (i32.const 0)))) (unreachable)";
const FLOOD: &str = "(loop $again (call $write (i32.const 1) (i32.const 65536) (i32.const 65536)) (br $again))";
const NONSENSE: &str = "(call $write (i32.const 1) (i32.const 65546) (i32.const 5))
    (call $write (i32.const 1) (i32.const 2398) (i32.const 2))";
const TRAP: &str = "(unreachable)";
const EXIT: &str = "(call $write (i32.const 2) (i32.const 1024) (i32.const 6)) (call $exit (i32.const 3))";
/// Reads the clock, and fails if it moves.
const CLOCK: &str = "(drop (call $clock (i32.const 1) (i64.const 0) (i32.const 16)))
    (if (i64.ne (i64.load (i32.const 16)) (i64.const 0)) (then (unreachable)))";
/// Chooses nothing, as a policy.
const WAIT: &str = "(call $answer (i32.const 2048) (i32.const 35) (local.get $id))";

/// A module that does `body` for each query; `$id` is its number, `$sum` that of the bytes of its line, modulo 2^32.
fn module(body: &str) -> Vec<u8> {
    let text = format!(
        r#"(module
            (import "wasi_snapshot_preview1" "fd_read" (func $fd_read (param i32 i32 i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "fd_write" (func $fd_write (param i32 i32 i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "clock_time_get" (func $clock (param i32 i64 i32) (result i32)))
            (import "wasi_snapshot_preview1" "proc_exit" (func $exit (param i32)))
            (memory (export "memory") 3)
            (data (i32.const 1024) "{{\"type\":\"hello\",\"protocol\":1}}\n")
            (data (i32.const 1280) "{{\"type\":\"ready\"}}\n")
            (data (i32.const 1536) "{{\"type\":\"none\",\"reason\":\"disconnected\",\"expansions\":987654,\"id\":")
            (data (i32.const 1792) "{{\"type\":\"path\",\"segments\":[[0,10]],\"expansions\":987654,\"id\":")
            (data (i32.const 2048) "{{\"type\":\"answer\",\"choices\":[],\"id\":")
            (data (i32.const 2398) "}}\n")
            (func $write (param $fd i32) (param $from i32) (param $length i32)
                (i32.store (i32.const 0) (local.get $from))
                (i32.store (i32.const 4) (local.get $length))
                (drop (call $fd_write (local.get $fd) (i32.const 0) (i32.const 1) (i32.const 8))))
            ;; Reads a whole line and returns the sum of the bytes of its end.
            (func $read (result i32) (local $at i32) (local $sum i32)
                (loop $more
                    (i32.store (i32.const 0) (i32.const 65536))
                    (i32.store (i32.const 4) (i32.const 65536))
                    (drop (call $fd_read (i32.const 0) (i32.const 0) (i32.const 1) (i32.const 8)))
                    (local.set $at (i32.load (i32.const 8)))
                    (br_if $more (i32.ne (i32.load8_u (i32.add (i32.const 65535) (local.get $at))) (i32.const 10))))
                (loop $next
                    (local.set $at (i32.sub (local.get $at) (i32.const 1)))
                    (local.set $sum (i32.add (local.get $sum) (i32.load8_u (i32.add (i32.const 65536) (local.get $at)))))
                    (br_if $next (local.get $at)))
                (local.get $sum))
            ;; Writes a text, a number and the end of an object.
            (func $answer (param $from i32) (param $length i32) (param $id i32) (local $at i32)
                (call $write (i32.const 1) (local.get $from) (local.get $length))
                (local.set $at (i32.const 2398))
                (loop $digit
                    (local.set $at (i32.sub (local.get $at) (i32.const 1)))
                    (i32.store8 (local.get $at) (i32.add (i32.const 48) (i32.rem_u (local.get $id) (i32.const 10))))
                    (br_if $digit (local.tee $id (i32.div_u (local.get $id) (i32.const 10)))))
                (call $write (i32.const 1) (local.get $at) (i32.sub (i32.const 2400) (local.get $at))))
            (func (export "_start") (local $id i32) (local $sum i32)
                (drop (call $read))
                (call $write (i32.const 1) (i32.const 1024) (i32.const 30))
                (drop (call $read))
                (call $write (i32.const 1) (i32.const 1280) (i32.const 17))
                (loop $query
                    (local.set $sum (call $read))
                    (local.set $id (i32.add (local.get $id) (i32.const 1)))
                    {body}
                    (br $query))))"#
    );
    wat::parse_str(text).expect("the text of a module")
}

/// Fails in all ways, by what it is asked.
fn moody() -> Vec<u8> {
    let acts = [LOOP, BOMB, FLOOD, NONSENSE, TRAP, EXIT, AHEAD];
    let acts = acts.iter().enumerate().map(|(number, act)| {
        format!(
            "(if (i32.eq (i32.rem_u (local.get $sum) (i32.const 8)) (i32.const {number})) (then {act} (br $query)))"
        )
    });
    module(&format!("{} {NONE}", acts.collect::<String>()))
}

/// Asks twice, and expects that both queries fail in this way: the second one of a fresh instance.
fn expect_failure(act: &str, settings: &str, failure: PlanFailure, fragment: &str) -> Plan {
    let stage = Stage::of_module(&module(&format!("{act} {AHEAD}")), settings);
    let mut planner = stage.planner().expect("it starts");
    let plan = ask(planner.as_mut());
    assert_eq!(plan.path.as_ref().err(), Some(&failure), "{:?}", plan.message);
    assert!(plan.message.as_ref().is_some_and(|message| message.contains(fragment)), "{fragment}: {:?}", plan.message);
    assert_eq!(ask(planner.as_mut()).path.err(), Some(failure), "it is asked again");
    plan
}

#[test]
fn each_failure_of_a_module_is_a_failed_query_with_a_sentence() {
    let budget = "query_instructions = 1000000";
    let spent = expect_failure(LOOP, budget, PlanFailure::BudgetSpent, "ran more than 1000000 instructions");
    assert_eq!(spent.effort.local_expansions, 1);
    expect_failure(BOMB, "", PlanFailure::Crashed, "trapped: ");
    expect_failure(FLOOD, "", PlanFailure::BadAnswer, "wrote more than 16000000 bytes");
    expect_failure(NONSENSE, "", PlanFailure::BadAnswer, "it is no JSON object");
    expect_failure(TRAP, "", PlanFailure::Crashed, "trapped: wasm `unreachable` instruction executed");
    expect_failure(EXIT, "", PlanFailure::Crashed, "ended with exit code 3; its last message: {\"type");
}

#[test]
fn module_that_spends_ten_budgets_in_a_row_is_given_up() {
    let stage = Stage::of_module(&module(LOOP), "query_instructions = 2000000");
    let mut planner = stage.planner().expect("it starts");
    for number in 0..12 {
        let plan = ask(planner.as_mut());
        assert_eq!((plan.path.err(), plan.effort.local_expansions), (Some(PlanFailure::BudgetSpent), 2));
        let expected = "was given up after 10 queries in a row over 2000000 instructions";
        assert_eq!(plan.message.as_deref() == Some(expected), number >= 10, "{number}: {:?}", plan.message);
    }
}

#[test]
fn submit_check_refuses_an_entry_that_never_answers_and_prints_why() {
    let shell = Shell::new();
    std::fs::write(shell.path("loop.wasm"), module(LOOP)).expect("the folder is writable");
    shell.file(
        "entry.toml",
        "[entry]\nname = \"loop\"\ntracks = [\"drive\", \"contest\"]\n[unimog]\nplanner = \"own\"\n[planner.own]\n\
         module = \"loop.wasm\"\nquery_instructions = 1000000\n",
    );
    let check = |args: &[&str]| {
        let printed = shell.run(&[&["arena", "submit-check", "entry.toml"], args].concat(), &[4]).stdout;
        String::from_utf8_lossy(&printed).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let printed = check(&["--track", "drive"]);
    let drive = "drive: all 4 queries failed on the first seed; the other seeds were not played";
    assert!(
        printed.starts_with("loop cannot be submitted") && printed.contains(drive) && !printed.contains("contest"),
        "{printed}"
    );
    assert!(
        printed.contains("Failed queries of own: 4 of 4 (100.0 %): budget spent 4 (ran more than 1000000"),
        "{printed}"
    );
    let printed = check(&[]);
    let (_, rest) = printed.split_once("contest: all ").expect("it is refused there too");
    let queries = rest.split_once(' ').expect("a number").0;
    assert!(rest.contains(&format!("budget spent {queries} (ran more than 1000000 instructions)")), "{printed}");
}

#[test]
fn failures_of_modules_with_one_name_are_those_of_each() {
    let shell = Shell::new();
    shell.file(
        "rules.toml",
        "free = [\"unimog.planner\", \"planner.*\"]\nseeds = \"1\"\n[scenario]\nfrom = \"smoke\"\n",
    );
    for (name, body) in [("anna", TRAP), ("ben", NONE)] {
        std::fs::create_dir(shell.path(name)).expect("the folder is writable");
        std::fs::write(shell.path(name).join("mine.wasm"), module(body)).expect("the folder is writable");
        let table = "[unimog]\nplanner = \"mine\"\n[planner.mine]\nmodule = \"mine.wasm\"\n";
        shell.file(&format!("{name}/entry.toml"), table);
    }
    let args = ["batch", "--rules", "rules.toml", "--entry", "anna/entry.toml", "ben/entry.toml", "--out", "out"];
    let printed = String::from_utf8_lossy(&shell.run(&args, &[0]).stdout).into_owned();
    for (entry, reason) in [("anna", "crashed"), ("ben", "disconnected")] {
        let (_, rest) = printed.split_once(&format!("Failed queries of {entry}: ")).expect(&printed);
        assert!(rest.split('.').nth(1).is_some_and(|sentence| sentence.contains(reason)), "{printed}");
    }
    shell.refuse(
        &["batch", "--rules", "rules.toml", "--entry", "rules.toml", "anna/entry.toml"],
        &["rules.toml: it is a rules file; expected an entry"],
    );
}

#[test]
fn instructions_count_and_not_what_a_module_says() {
    let plan = |body: &str| {
        let stage = Stage::of_module(&module(body), "");
        let mut planner = stage.planner().expect("it starts");
        [(); 2].map(|()| {
            let Plan { path, effort, message, .. } = ask(planner.as_mut());
            assert!(path.is_ok(), "{message:?}");
            effort.local_expansions
        })
    };
    assert_eq!(plan(&format!("{CLOCK} {AHEAD}")), [1, 1]);
    let turns = "(local.set $sum (i32.const 500000))
        (loop $turn (br_if $turn (local.tee $sum (i32.sub (local.get $sum) (i32.const 1)))))";
    assert_eq!(plan(&format!("{turns} {AHEAD}")), [3, 3], "five instructions a turn");
}

const TABLE: &str = "duration_s = 200.0\n[field]\nsize_m = 100.0\ncoverage = 0.1\n[[wumpus]]\nstart_m = [2.5, 2.5]\n[[unimog]]\n\
                     planner = \"moody\"\n[planner.moody]\nmodule = \"moody.wasm\"\nquery_instructions = 1000000\n\
                     memory_limit_mb = 10\n";

/// The rows of a batch up to the first measured column.
fn rows(shell: &Shell, folder: &str) -> Vec<String> {
    let rows = std::fs::read_to_string(shell.path(folder).join("runs.csv")).expect("it was written");
    let header: Vec<&str> = rows.lines().next().expect("a header").split(',').collect();
    let measured = header.iter().position(|name| name.starts_with("cpu_")).expect("a measured column");
    rows.lines().map(|row| row.split(',').take(measured).collect::<Vec<_>>().join(",")).collect()
}

#[test]
fn batch_with_a_module_that_fails_in_all_ways_is_the_same_each_time() {
    let shell = Shell::new();
    std::fs::write(shell.path("moody.wasm"), moody()).expect("the folder is writable");
    shell.file("moody.toml", TABLE);
    let batch = ["batch", "moody.toml", "--seeds", "1..4", "--quiet", "--out"];
    let printed = shell.run(&[&batch[..], &["out", "--jobs", "1"]].concat(), &[0]);
    let printed = String::from_utf8_lossy(&printed.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, line) = printed.split_once("Failed queries of moody: ").expect("there are many");
    for fragment in ["bad answer ", "crashed ", "budget spent ", "disconnected "] {
        assert!(line.contains(fragment), "{line}");
    }
    shell.run(&[&batch[..], &["two", "--jobs", "2"]].concat(), &[0]);
    shell.run(&[&batch[..], &["again", "--jobs", "2"]].concat(), &[0]);
    let first = rows(&shell, "out");
    assert!(first.len() == 5 && first.iter().skip(1).all(|row| row.contains(",done,")), "{first:#?}");
    assert_eq!(first, rows(&shell, "two"));
    assert_eq!(first, rows(&shell, "again"));
    shell.run(&["audit", "out"], &[0]);
    assert!(line.contains("(ran more than 1000000 instructions)") && !line.contains("--trust"), "{line}");
    // The module belongs to the plan, which notices another one.
    let plan = std::fs::read_to_string(shell.path("out/plan.json")).expect("it was written");
    assert!(plan.contains("\"moody.wasm\":") && plan.contains("\"sha256\""), "{plan}");
    shell.run(&["batch", "--resume", "out"], &[0]);
    std::fs::write(shell.path("moody.wasm"), module(NONE)).expect("the folder is writable");
    shell.refuse(&["batch", "--resume", "out"], &["moody.wasm has changed"]);
}

#[test]
fn module_of_the_command_line_plans_or_decides() {
    let shell = Shell::new();
    std::fs::write(shell.path("ahead.wasm"), module(AHEAD)).expect("the folder is writable");
    std::fs::write(shell.path("wait.wasm"), module(WAIT)).expect("the folder is writable");
    let run = |module: &str, change: &str| {
        let printed = shell.run(&["run", "smoke", "--module", module, "--set", change, "--json"], &[0]);
        let value: serde_json::Value = serde_json::from_slice(&printed.stdout).expect("it is JSON");
        value["run"].clone()
    };
    let planned = run("own=ahead.wasm", "unimog.planner=own");
    assert!(planned["planner"] == "own" && planned["truck_failed_bad_answer"].as_u64() > Some(0), "{planned}");
    let decided = run("own=wait.wasm", "unimog.goal=own");
    assert!(decided["policy"] == "own" && decided["policy_asked"].as_u64() > Some(0), "{decided}");
    assert_eq!((&decided["policy_failed_bad_answer"], &decided["extinguished"]), (&0.into(), &0.into()), "{decided}");
    let failing = run("own=ahead.wasm", "unimog.goal=own");
    assert_eq!(failing["policy_failed_bad_answer"], failing["policy_asked"], "{failing}");
    let plan =
        ["plan", "--scenario", "smoke", "--goals", "2", "--planner", "own", "--module", "own=ahead.wasm", "--repeat"];
    let printed = String::from_utf8_lossy(&shell.run(&plan, &[0]).stdout).into_owned();
    assert!(printed.contains("bit-identical"), "{printed}");
}

#[test]
fn file_that_is_no_module_is_refused_with_its_place() {
    let shell = Shell::new();
    shell.file("moody.toml", TABLE);
    let expect = |fragments: &[&str]| {
        for command in ["check", "run"] {
            shell.refuse(&[command, "moody.toml"], fragments);
        }
    };
    expect(&["moody.toml:10:", "moody.wasm", "cannot be read", "No such file"]);
    shell.file("moody.wasm", "#!/bin/sh\n");
    expect(&["moody.toml:10:", "`moody.wasm` is not a WebAssembly module"]);
    shell.refuse(&["run", "smoke", "--module", "own=moody.wasm"], &["`moody.wasm` is not a WebAssembly module"]);
    let text = r#"(module (import "env" "now" (func)) (memory (export "memory") 1) (func (export "_start")))"#;
    std::fs::write(shell.path("moody.wasm"), wat::parse_str(text).expect("a module")).expect("the folder is writable");
    expect(&["`moody.wasm` imports `env.now`; only functions of `wasi_snapshot_preview1` exist"]);
    let large = std::fs::File::create(shell.path("moody.wasm")).expect("the folder is writable");
    large.set_len(64_000_001).expect("a file with a hole");
    expect(&["moody.wasm", "too large; expected at most 64 MB"]);
    std::fs::write(shell.path("moody.wasm"), moody()).expect("the folder is writable");
    let printed = shell.run(&["check", "moody.toml"], &[0]);
    let printed = String::from_utf8_lossy(&printed.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(printed.contains("The planner `moody` is the WebAssembly module moody.wasm; a query may run"), "{printed}");
    shell.file("both.toml", &format!("{TABLE}command = [\"sh\"]\n"));
    shell.refuse(&["check", "both.toml"], &["both.toml", "cannot be combined with", "each says what plans"]);
    shell.refuse(&["run", "smoke", "--module", "own"], &["NAME=FILE.wasm"]);
    shell.refuse(&["run", "smoke", "--module", "prm-rs=moody.wasm"], &["built-in"]);
}
