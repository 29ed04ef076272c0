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

/// The outcome of a run, without the policy's name.
fn result(shell: &Shell, arguments: &[&str]) -> serde_json::Value {
    let said = shell.run(&[&["run"], arguments, &["--json"]].concat(), &[0]);
    let value: serde_json::Value = serde_json::from_slice(&said.stdout).expect("it is JSON");
    let mut outcome = value["run"].clone();
    outcome.as_object_mut().expect("it is an object").remove("policy");
    outcome
}

#[test]
fn policy_that_answers_as_the_rule_does_plays_the_rules_run() {
    if !has("python3", "--version") {
        return;
    }
    let shell = Shell::new();
    shell.file("nearest.py", NEAREST);
    shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"python3\", \"nearest.py\"]\n"));
    for seed in ["1", "2", "3"] {
        let own = result(&shell, &["own.toml", "--trust", "--seed", seed]);
        let rule = result(&shell, &["own.toml", "--set", "unimog.goal=nearest-burning", "--seed", seed]);
        assert_eq!(own, rule);
    }
    shell.refuse(&["run", "own.toml"], &["policy `own`", "--trust"]);
    shell.expect_nobody();
}

#[test]
fn agents_of_a_policy_that_fails_wait() {
    for body in ["exit 1", "echo nonsense", "echo \"{\\\"type\\\":\\\"answer\\\",\\\"id\\\":$id,\\\"choices\\\":[]}\""]
    {
        let shell = Shell::new();
        shell.file("own.sh", &script(body));
        shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"sh\", \"own.sh\"]\n"));
        let said = result(&shell, &["own.toml", "--trust"]);
        assert_eq!(said["extinguished"], 0, "{said}");
        shell.expect_nobody();
    }
    let shell = Shell::new();
    shell.file("own.sh", &format!("{GREETING}\nexit 0").replace("ready", "sorry"));
    shell.file("own.toml", &format!("{TABLE}[policy.own]\ncommand = [\"sh\", \"own.sh\"]\n"));
    shell.run(&["run", "own.toml", "--trust"], &[1]);
}
