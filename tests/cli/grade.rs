//! `wildfire grade`, and the files of courses for the platforms that run it.

use std::fs;

use serde_json::{Value, json};

use crate::children::wait_until;
use crate::story::{Story, refuse};

const RULES: &str = "\
free = [\"unimog.planner\", \"planner.*\"]
seeds = \"@secret/seeds.txt\"

[grading]
metric = \"extinguished\"
baselines = [\"prm+primitives\", \"weak.toml\"]
marks = [[0, 0], [1000, 40]]
max_expansions = 1e9
points = { valid = 5, no_crash = 10, no_violation = 15, baseline = 10, effort = 2.5 }

[scenario]
from = \"smoke\"
unimog.rescue = false
";

/// A folder with rules, seeds, a baseline and an entry.
fn course() -> Story {
    let story = Story::begin();
    fs::create_dir(story.path("secret")).expect("writable");
    story.file("secret/seeds.txt", "123456789\n987654321\n");
    story.file("rules.toml", RULES);
    story.file("weak.toml", "unimog.planner = \"lattice\"\n");
    story.file("anna.toml", "unimog.planner = \"hybrid-astar\"\n");
    story
}

fn graded(story: &Story, entry: &str, platform: &str, code: i32) -> Value {
    let form = ["--for", platform, "--json-out", "out.json", "--trust"];
    story.tell(&[&["grade", entry, "--rules", "rules.toml"][..], &form].concat()).expect_code(code);
    serde_json::from_str(&story.read("out.json")).expect("it is JSON")
}

fn test<'a>(grade: &'a Value, name: &str) -> &'a Value {
    let mut tests = grade["tests"].as_array().expect("a list").iter();
    tests.find(|test| test["name"] == name).unwrap_or_else(|| panic!("no test `{name}`: {grade}"))
}

#[test]
fn points_follow_from_tests_and_from_the_table_of_marks() {
    let story = course();
    let grade = graded(&story, "anna.toml", "plain", 0);
    let score = grade["score"].as_f64().expect("a number");
    assert!(score > 0.0, "{grade}");
    let of_score = test(&grade, "Score");
    assert_eq!(of_score["points"].as_f64(), Some((score * 4.0).round() / 100.0), "{of_score}");
    assert_eq!(of_score["max_points"], 40.0);
    let sum: f64 = grade["tests"].as_array().expect("a list").iter().filter_map(|it| it["points"].as_f64()).sum();
    assert_eq!((grade["points"].as_f64(), grade["max_points"].as_f64()), (Some(sum), Some(92.5)));
    assert_eq!(test(&grade, "Valid entry")["points"], 5.0);
    assert_eq!(test(&grade, "No crash")["points"], 10.0);
    assert_eq!(test(&grade, "No violation")["points"], 15.0);
    assert_eq!(test(&grade, "Effort within the budget")["points"], 2.5);
    // Copies of a baseline do not beat it.
    story.file("copy.toml", "unimog.planner = \"prm+primitives\"\n");
    let copy = graded(&story, "copy.toml", "plain", 0);
    assert_eq!(test(&copy, "Beats the baseline prm+primitives")["is_passed"], false);
    story.file("rules.toml", &RULES.replace("1e9", "1"));
    assert_eq!(test(&graded(&story, "anna.toml", "plain", 0), "Effort within the budget")["points"], 0.0);
}

#[test]
fn entry_that_is_refused_gets_a_grade_and_wrong_rules_do_not() {
    let story = course();
    story.file("bad.toml", "[unimog]\nplanner = \"lattice\"\nspeed_mps = 20\n");
    let grade = graded(&story, "bad.toml", "plain", 2);
    let output = test(&grade, "Valid entry")["output"].as_str().expect("a text");
    assert_eq!(output, "bad.toml:3: `unimog.speed_mps` is fixed by the rules in rules.toml.");
    assert_eq!((&grade["points"], &grade["max_points"], &grade["score"]), (&json!(0.0), &json!(92.5), &Value::Null));
    fs::create_dir(story.path("empty")).expect("writable");
    assert_eq!(graded(&story, "empty", "gradescope", 2)["score"], 0.0);
    for (wrong, parts) in [
        ("marks = [[5, 0], [3, 40]]", &["rules.toml:7: ", "scores rising"][..]),
        ("baselines = [\"lattice\", \"strong\"]", &["rules.toml:6: ", "`strong` is no built-in planner"]),
        ("baselines = [\"missing.toml\"]", &["missing.toml", "does not exist"]),
        ("metric = \"extinguishd\"", &["did you mean"]),
        ("metric = \"planner\"", &["rules.toml"]),
        ("points.valid = -1", &["expected points"]),
    ] {
        let key = wrong.split([' ', '.']).next().expect("a word");
        let lines = RULES.lines().map(|line| if line.starts_with(&format!("{key} =")) { wrong } else { line });
        story.file("rules.toml", &lines.collect::<Vec<_>>().join("\n"));
        refuse(&story, &["grade", "anna.toml", "--rules", "rules.toml"], parts);
    }
    story.file("rules.toml", RULES.split("[grading]").next().expect("a text"));
    refuse(&story, &["grade", "anna.toml", "--rules", "rules.toml"], &["no table [grading]"]);
}

/// What an author reads has no seeds, no paths and nobody else's name, whatever went wrong.
#[cfg(unix)]
#[test]
fn author_reads_why_and_nothing_secret() {
    let story = course();
    fs::create_dir(story.path("dora")).expect("writable");
    let entry =
        "[entry]\nname = \"dora\"\n[unimog]\nplanner = \"mine\"\n[planner.mine]\ncommand = [\"sh\", \"mine.sh\"]\n";
    story.file("dora/entry.toml", entry);
    let path = story.path("dora").display().to_string();
    story.file("dora/mine.sh", &format!("echo 'cannot read {path}/map.csv for seed 123456789' >&2\nexit 3\n"));
    story.file("weak.toml", "[entry]\nname = \"ben\"\n[unimog]\nplanner = \"lattice\"\n");
    refuse(&story, &["grade", "dora", "--rules", "rules.toml"], &["--trust"]);
    for platform in ["plain", "gradescope", "classroom50"] {
        let text = graded(&story, "dora", platform, 1).to_string();
        assert!(text.contains("exit code 3") && text.contains("cannot read map.csv for seed -"), "{text}");
        let folder = story.path("").display().to_string();
        for secret in ["123456789", "987654321", folder.trim_end_matches('/'), "secret", "\"ben\"", "seeds.txt"] {
            assert!(!text.contains(secret), "`{secret}`: {text}");
        }
    }
    let grade = graded(&story, "dora", "plain", 1);
    assert_eq!((&grade["entry"], &grade["points"]), (&json!("dora"), &json!(5.0)), "a valid file, and nothing else");
}

/// By Gradescope's "Autograder Specifications", section "Output format".
fn expect_gradescope(results: &Value) {
    let is_visibility = |value: &Value| {
        ["visible", "hidden", "after_due_date", "after_published"].iter().any(|visibility| value == visibility)
    };
    assert!(results["score"].is_number() && results["output"].is_string(), "{results}");
    assert!(is_visibility(&results["visibility"]) && is_visibility(&results["stdout_visibility"]), "{results}");
    let tests = results["tests"].as_array().expect("a list");
    let mut sum = 0.0_f64;
    for test in tests {
        let [score, max_score] = ["score", "max_score"].map(|member| test[member].as_f64().expect("a number"));
        assert!((0.0..=max_score).contains(&score), "{test}");
        assert!(test["name"].is_string() && test["output"].is_string() && is_visibility(&test["visibility"]), "{test}");
        assert!(test["status"] == "passed" || test["status"] == "failed", "{test}");
        sum += score;
    }
    assert!(
        !tests.is_empty() && results["score"].as_f64().is_some_and(|score| (score - sum).abs() < 0.01),
        "{results}"
    );
    for line in results["leaderboard"].as_array().expect("a list") {
        assert!(line["name"].is_string() && line["value"].is_number(), "{line}");
        assert!(line["order"] == "asc" || line["order"] == "desc", "{line}");
    }
}

/// By the page "Advanced Autograding" of Classroom 50's wiki, section "The result.json contract".
#[cfg(unix)]
fn expect_classroom50(result: &Value) {
    assert_eq!(result["schema"], "classroom50/result/v1");
    for member in ["classroom", "assignment", "owner", "submission", "commit", "release", "review", "datetime"] {
        assert!(result[member].as_str().is_some_and(|text| !text.is_empty()), "{member}: {result}");
    }
    let mut sums = [0, 0];
    for test in result["tests"].as_array().expect("a list") {
        assert!(test["test-name"].is_string() && test["passed"].is_boolean(), "{test}");
        for (sum, member) in sums.iter_mut().zip(["score", "max-score"]) {
            *sum += test[member].as_i64().expect("a whole number");
        }
    }
    assert_eq!((result["score"].as_i64(), result["max-score"].as_i64()), (Some(sums[0]), Some(sums[1])));
}

#[test]
fn results_are_those_that_platforms_read() {
    let story = course();
    let results = graded(&story, "anna.toml", "gradescope", 0);
    expect_gradescope(&results);
    assert_eq!(results["leaderboard"][0]["name"], "extinguished");
    story.file("bad.toml", "free = 3\n");
    expect_gradescope(&graded(&story, "bad.toml", "gradescope", 2));
}

/// The script of Gradescope runs as its documentation describes, but for the folder; and that of Classroom 50.
#[cfg(unix)]
#[test]
fn platforms_run_their_files_on_a_submission() {
    use crate::children::output_of;

    let story = Story::begin();
    story.tell(&["new", "assignment", "course", "--for", "gradescope"]).expect_code(0);
    story.tell(&["new", "assignment", "room", "--for", "classroom50"]).expect_code(0);
    refuse(&story, &["new", "plan", "--for", "plain"], &["--for applies only to an assignment"]);
    let script = "
        set -e
        mkdir -p root/source root/submission root/results
        readme=$(grep -o 'zip -j autograder.zip .*' course/README.md)
        for file in ${readme#*.zip}; do cp course/$file root/source; done
        echo 7 > root/source/secret.csv
        cp course/cem.toml root/submission/entry.toml
        chmod +x root/source/run_autograder
        AUTOGRADER_ROOT=root root/source/run_autograder
        mkdir bundle checkout
        for file in $(grep -o '^cp [a-z0-9. ]* ' room/README.md | cut -d' ' -f2-); do cp room/$file bundle; done
        echo 7 > bundle/public.csv
        cp room/cem.toml checkout/entry.toml
        cd checkout
        git init -q && git add . && git -c user.name=a -c user.email=a@b commit -qm entry
        CLASSROOM=c ASSIGNMENT=a OWNER=o SUBMISSION_TAG=submit/1 COMMIT_URL=u RELEASE_URL=r python3 ../bundle/autograder.py
    ";
    let made = output_of(&mut story.shell(script));
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let results: Value = serde_json::from_str(&story.read("root/results/results.json")).expect("it is JSON");
    expect_gradescope(&results);
    assert_eq!(test(&results, "Valid entry")["score"], 5.0);
    let result: Value = serde_json::from_str(&story.read("checkout/result.json")).expect("it is JSON");
    expect_classroom50(&result);
    let submitted = result["datetime"].as_str().expect("a text");
    assert!(submitted.len() == "2026-06-01T14:32:01Z".len() && submitted.ends_with('Z'), "{submitted}");
    assert!(!story.path("bundle/secret.csv").exists(), "Classroom 50 publishes the bundle");
}

#[test]
fn watched_ranking_is_a_page_that_renews_itself_without_seeds() {
    let story = course();
    let mut watch = story.command(&["rank", "runs", "--watch", "board.html"]);
    let mut watch = watch.spawn().expect("the program can be started");
    let wait_for = |part: &str| {
        wait_until(part, || fs::read_to_string(story.path("board.html")).is_ok_and(|page| page.contains(part)));
    };
    wait_for("No batch has finished yet");
    story.tell(&["batch", "--rules", "rules.toml", "--entry", "anna.toml", "--out", "runs/anna"]).expect_code(0);
    wait_for("anna");
    story.tell(&["batch", "--rules", "rules.toml", "--agent", "weak.toml", "--out", "runs/weak"]).expect_code(0);
    wait_for("weak");
    watch.kill().and_then(|()| watch.wait()).expect("it was at work");
    let page = story.read("board.html");
    assert!(page.contains("http-equiv=\"refresh\"") && !page.contains("123456789"), "{page}");
}
