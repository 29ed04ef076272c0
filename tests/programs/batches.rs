//! Batches with a program that fails in all ways at once.

use std::process::Stdio;

use crate::children::{end_of, send, wait_until};
use crate::shell::Shell;
use crate::stage::{GREETING, processes_in};

/// What the program does depends on its seed, so that a run repeats.
fn moody() -> String {
    format!(
        "{GREETING}\nseed=${{field#*\\\"seed\\\":}}; seed=${{seed%%,*}}\nid=0\nwhile read -r line; do\n\
         case $line in *'\"type\":\"end\"'*) exit 0;; esac\nid=$((id+1))\ncase $(( (seed + id) % 8 )) in\n\
         0) exit 3;;\n1) sleep 100;;\n2) echo nonsense;;\n3) kill -9 $$;;\n\
         4) echo \"{{\\\"type\\\":\\\"path\\\",\\\"id\\\":$id,\\\"segments\\\":[[5,1000]]}}\";;\n\
         5) exec >&-; sleep 100;;\n\
         6) sleep 100 & echo \"{{\\\"type\\\":\\\"none\\\",\\\"id\\\":99}}\";;\n\
         *) echo \"{{\\\"type\\\":\\\"none\\\",\\\"id\\\":$id,\\\"reason\\\":\\\"disconnected\\\"}}\";;\nesac\ndone"
    )
}

const TABLE: &str = "duration_s = 300.0\n[field]\nsize_m = 100.0\ncoverage = 0.1\n[[wumpus]]\nstart_m = [2.5, 2.5]\n[[unimog]]\n\
                     planner = \"moody\"\n[planner.moody]\ncommand = [\"sh\", \"moody.sh\"]\nquery_limit_s = 0.1\nrestarts = 2\n";

#[test]
fn batch_with_a_program_that_fails_at_random_ends() {
    let shell = Shell::new();
    shell.file("moody.sh", &moody());
    shell.file("moody.toml", TABLE);
    let arguments = ["batch", "moody.toml", "--seeds", "1..20", "--out", "out", "--trust", "--quiet"];
    let printed = String::from_utf8_lossy(&shell.run(&arguments, &[0, 1]).stdout).into_owned();
    let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    // What a program takes has columns of its own, and those of roadmaps are left out.
    assert!(printed.contains("Custom Custom Unimog") && !printed.contains("gener."), "{printed}");
    let (_, line) = printed.split_once("Failed queries of moody: ").expect("there are many");
    for fragment in ["bad answer ", "timed out ", "crashed ", "disconnected "] {
        assert!(line.contains(fragment), "{line}");
    }
    let rows = std::fs::read_to_string(shell.path("out/runs.csv")).expect("it was written");
    assert_eq!(rows.lines().count(), 21);
    let header: Vec<&str> = rows.lines().next().expect("a header").split(',').collect();
    for column in ["truck_failed_timed_out", "truck_failed_crashed", "truck_failed_bad_answer"] {
        let place = header.iter().position(|name| *name == column).expect("there is such a column");
        let count = |row: &str| row.split(',').nth(place).and_then(|cell| cell.parse::<u64>().ok()).unwrap_or(0);
        assert!(rows.lines().skip(1).map(count).sum::<u64>() > 20, "{column}");
    }
    shell.expect_nobody();
}

#[test]
fn batch_that_is_killed_leaves_no_process() {
    for signal in ["KILL", "TERM", "INT"] {
        let shell = Shell::new();
        shell.file("stuck.sh", &format!("{GREETING}\nsleep 100 &\nwhile :; do sleep 100; done"));
        shell.file("moody.toml", &TABLE.replace("moody.sh", "stuck.sh").replace("query_limit_s = 0.1", ""));
        let mut command = shell.command(&["batch", "moody.toml", "--seeds", "1..50", "--out", "out", "--trust"]);
        let mut batch = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        // The batch, its supervisors and their programs all work in the folder.
        wait_until("programs are running", || {
            assert!(batch.try_wait().expect("it can be asked").is_none(), "it ended by itself");
            processes_in(shell.folder()).len() >= 4
        });
        send(signal, &batch);
        end_of(batch);
        shell.expect_nobody();
    }
}

#[test]
fn run_whose_program_does_not_start_fails_and_others_go_on() {
    let shell = Shell::new();
    let script = format!("{GREETING}\n").replace(
        "read -r field;",
        "read -r field; seed=${field#*\\\"seed\\\":}; seed=${seed%%,*}; [ $((seed % 2)) = 0 ] || { echo odd seed >&2; exit 1; };",
    );
    shell.file("moody.sh", &format!("{script}\ncat > /dev/null"));
    shell.file("moody.toml", TABLE);
    shell.run(&["batch", "moody.toml", "--seeds", "1..8", "--out", "out", "--trust"], &[1]);
    let rows = std::fs::read_to_string(shell.path("out/runs.csv")).expect("it was written");
    let failed = rows.lines().filter(|row| row.contains("odd seed")).count();
    assert!(failed > 2 && failed < 6, "{rows}");
    shell.expect_nobody();
}
