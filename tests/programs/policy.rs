//! Programs as policies.

use crate::shell::{Shell, has};
use crate::stage::{GREETING, script};

/// The rule `nearest-burning` once more, by what the messages say.
const NEAREST: &str = r#"
import json, math, sys
for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "hello":
        answer = {"type": "hello", "protocol": 1}
    elif message["type"] == "field":
        cell, cols = message["cell_m"], message["cols"]
        vehicle = message["vehicle"]
        ahead = vehicle["length"] / 2 - vehicle["rear_overhang"]
        assert message["plays"] == ["unimog/0"] and len(message["agents"]) == 2, message
        answer = {"type": "ready"}
    elif message["type"] == "ask":
        choices = []
        for agent in message["state"]:
            if agent["agent"] in message["agents"]:
                x, y, heading = agent["pose"]
                x, y = x + ahead * math.cos(heading), y + ahead * math.sin(heading)
                def distance(at):
                    return (math.hypot((at[0] + 0.5) * cell - x, (at[1] + 0.5) * cell - y), at[1] * cols + at[0])
                burning = [[col, row] for col, row, since in message["burning"]]
                assert all(option in burning for option in agent["options"])
                best = min(agent["options"], key=distance, default=None)
                choices.append({"agent": agent["agent"], "cell": best})
        answer = {"type": "answer", "id": message["id"], "choices": choices}
    else:
        break
    print(json.dumps(answer), flush=True)
"#;

const TABLE: &str = "duration_s = 600.0\n[field]\nsize_m = 150.0\ncoverage = 0.1\n[[wumpus]]\nstart_m = [2.5, 2.5]\n[[unimog]]\ngoal = \"own\"\n";

/// The outcome of a run, without what it says of its policy.
fn result(shell: &Shell, arguments: &[&str]) -> serde_json::Value {
    let mut outcome = whole_result(shell, arguments);
    outcome.as_object_mut().expect("it is an object").retain(|name, _| !name.starts_with("policy"));
    outcome
}

fn whole_result(shell: &Shell, arguments: &[&str]) -> serde_json::Value {
    let printed = shell.run(&[&["run"], arguments, &["--json"]].concat(), &[0]);
    let value: serde_json::Value = serde_json::from_slice(&printed.stdout).expect("it is JSON");
    value["run"].clone()
}

#[test]
fn policy_that_answers_as_the_rule_does_plays_the_rules_run() {
    if !has("python3", &["--version"]) {
        return;
    }
    let shell = Shell::new();
    shell.file("nearest.py", NEAREST);
    shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"python3\", \"nearest.py\"]\n"));
    for seed in ["1", "2", "3"] {
        let external = result(&shell, &["own.toml", "--trust", "--seed", seed]);
        let rule = result(&shell, &["own.toml", "--set", "unimog.goal=nearest-burning", "--seed", seed]);
        assert_eq!(external, rule);
    }
    shell.refuse(&["run", "own.toml"], &["policy `own`", "--trust"]);
    shell.expect_nobody();
}

/// A line of a script that answers with these choices.
fn answer(choices: &str) -> String {
    format!("echo \"{{\\\"type\\\":\\\"answer\\\",\\\"id\\\":$id,\\\"choices\\\":[{choices}]}}\"")
}

#[test]
fn agents_of_a_policy_that_fails_wait() {
    for (body, column) in [
        ("exit 1", "policy_failed_crashed"),
        ("sleep 100", "policy_failed_timed_out"),
        ("echo nonsense", "policy_failed_bad_answer"),
        (&answer("{\\\"agent\\\":\\\"unimog/0\\\",\\\"cell\\\":[999,999]}"), "policy_illegal"),
        (&answer("{\\\"agent\\\":\\\"truck\\\",\\\"cell\\\":null}"), "policy_illegal"),
        (&answer(""), "policy_asked"),
    ] {
        let shell = Shell::new();
        let limit_s = if column.ends_with("timed_out") { 0.3 } else { 60.0 };
        shell.file("own.sh", &script(body));
        shell.file(
            "own.toml",
            &format!("{TABLE}[policy.own]\ncommand = [\"sh\", \"own.sh\"]\nquery_limit_s = {limit_s}\n"),
        );
        let printed = whole_result(&shell, &["own.toml", "--trust", "--set", "duration_s=150"]);
        assert_eq!(printed["extinguished"], 0, "{printed}");
        assert!(printed["policy_asked"].as_u64() > Some(0) && printed[column] == printed["policy_asked"], "{printed}");
        let message = printed["message"].as_str().unwrap_or_default();
        assert!(message.starts_with("policy own at ") == (column != "policy_asked"), "{message}");
        shell.expect_nobody();
    }
    let shell = Shell::new();
    shell.file("own.sh", &format!("{GREETING}\nexit 0").replace("ready", "sorry"));
    shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"sh\", \"own.sh\"]\n"));
    shell.run(&["run", "own.toml", "--trust"], &[1]);
}

#[test]
fn failed_asks_are_told_to_people_and_ranked() {
    let shell = Shell::new();
    shell.file("own.sh", &script("case $id in 1) sleep 100;; *) exit 3;; esac"));
    shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"sh\", \"own.sh\"]\nquery_limit_s = 0.3\n"));
    let printed = |arguments: &[&str]| {
        let text = String::from_utf8_lossy(&shell.run(arguments, &[0]).stdout).into_owned();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let short = "duration_s=150";
    let run = printed(&["run", "own.toml", "--trust", "--set", short]);
    assert!(run.contains("Failed asks of the policy own: ") && run.contains("(gave no answer within 0.3 s)"), "{run}");
    assert!(run.contains("Outcomes depend on this machine: ") && run.contains("of a policy timed out."), "{run}");
    let goals = "unimog.goal=own,nearest-burning";
    let of_batch = ["batch", "own.toml", "--trust", "--seeds", "1..2", "--set", short, "--set", goals, "--out", "out"];
    let batch = printed(&of_batch);
    assert!(batch.contains("Failed asks of the policy own: "), "{batch}");
    let ranked = printed(&["rank", "out"]);
    assert!(ranked.contains("asks %") && ranked.contains("100.0"), "{ranked}");
    shell.expect_nobody();
}

#[test]
fn program_of_the_command_line_may_be_a_policy() {
    let shell = Shell::new();
    shell.file("own.sh", &script(&answer("")));
    let command = ["--command", "own=sh own.sh"];
    let arguments = [&["smoke", "--set", "unimog.goal=own"], &command[..]].concat();
    let printed = whole_result(&shell, &arguments);
    assert!(printed["policy"] == "own" && printed["policy_asked"].as_u64() > Some(0), "{printed}");
    // As a planner it is no policy, and a plan says nothing of one.
    let arguments = ["batch", "smoke", "--planner", "own", "--seeds", "1", "--out", "out", "--quiet"];
    shell.run(&[&arguments[..], &command].concat(), &[0]);
    let plan = std::fs::read_to_string(shell.path("out/plan.json")).expect("it was written");
    assert!(plan.contains("own.sh") && !plan.contains("\"policy\":"), "{plan}");
}

#[test]
fn program_says_where_crews_build_and_without_an_answer_they_build_nothing() {
    let line = |points: &str| format!("echo \"{{\\\"type\\\":\\\"line\\\",\\\"id\\\":$id,\\\"points\\\":{points}}}\"");
    for (body, column, builds) in [
        (&line("[[60,60],[300,60],[300,300]]")[..], "policy_failed_bad_answer", true),
        (&line("[]"), "policy_failed_bad_answer", false),
        (&answer(""), "policy_failed_bad_answer", false),
        ("exit 1", "policy_failed_crashed", false),
    ] {
        let shell = Shell::new();
        let check = "case $line in *'\"line\":{\"crews\":[{\"count\":4,'*'\"square_m\":10.0,'*) ;; *) exit 2;; esac";
        shell.file("own.sh", &script(&format!("{check}\n{body}")));
        let args = ["line", "--set", "line.policy=own", "--command", "own=sh own.sh", "--set", "duration_s=3000"];
        let printed = whole_result(&shell, &args);
        assert!(printed["policy_asked"] == 1 && printed[column] == u64::from(!builds), "{printed}");
        assert!((printed["line_built_m"].as_f64() > Some(400.0)) == builds, "{printed}");
        shell.expect_nobody();
    }
}
