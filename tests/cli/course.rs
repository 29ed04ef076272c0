//! Courses: `wildfire batch --rules --entry`, and the ranking of what it leaves.

use std::fs;

use serde_json::Value;

use crate::children::output_of;
use crate::story::{Story, outcomes, refuse};

const RULES: &str = "\
free = [\"unimog.planner\", \"unimog.lattice\", \"planner.*\"]
seeds = \"@secret/seeds.txt\"

[limits]
query_cpu_s = 2
restarts = 1

[scenario]
from = \"smoke\"
fire.relight = true
";

/// A folder with rules, seeds and three agents.
fn course() -> Story {
    let story = Story::begin();
    fs::create_dir(story.path("secret")).expect("writable");
    story.file("secret/seeds.txt", "3..5 # three\n11, 12\n");
    story.file("rules.toml", RULES);
    story.file("anna.toml", "unimog.planner = \"prm+primitives\"\n");
    story.file("ben.toml", "[unimog]\nplanner = \"lattice\"\n[unimog.lattice]\nmax_expansions = 5000\n");
    story.file("cem.toml", "[unimog]\nplanner = \"prm+primitives\"\n");
    story
}

const BATCH: [&str; 7] = ["batch", "--rules", "rules.toml", "--entry", "anna.toml", "ben.toml", "cem.toml"];

fn with<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&BATCH[..], arguments].concat()
}

#[test]
fn agents_run_with_the_seeds_and_rules_of_the_course_and_are_ranked() {
    let story = course();
    story.tell(&with(&["--out", "course", "--jobs", "1"])).expect_code(0);
    let rows = outcomes(&story.path("course/runs.csv"));
    let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
    let (entry, seed) = (column("entry"), column("seed"));
    let found: Vec<_> = rows[1..].iter().map(|row| (row[entry].as_str(), row[seed].as_str())).collect();
    let seeds = ["3", "4", "5", "11", "12"];
    let expected: Vec<_> = ["anna", "ben", "cem"].iter().flat_map(|name| seeds.map(|seed| (*name, seed))).collect();
    assert_eq!(found, expected);
    let ranking: Value =
        serde_json::from_str(&story.tell(&["rank", "course", "--json"]).expect_code(0).stdout).expect("it is JSON");
    let entries = ranking["entries"].as_array().expect("a list");
    let names: Vec<_> = entries.iter().filter_map(|entry| entry["entry"].as_str()).collect();
    assert_eq!(names, ["anna", "cem", "ben"], "copies are in the order of their names");
    assert_eq!(entries[0]["groups"], entries[1]["groups"]);
    // Each run can be repeated by what the plan says of it.
    let plan: Value = serde_json::from_str(&story.read("course/plan.json")).expect("it is JSON");
    let ben = &plan["variants"][1];
    assert_eq!(
        (&ben["scenario"]["fire"]["relight"], &ben["scenario"]["unimog"][0]["planner"]),
        (&true.into(), &"lattice".into())
    );
    let mut command = vec!["run".to_owned(), "smoke".to_owned(), "--seed".into(), "4".into(), "--json".into()];
    for change in ben["changes"].as_array().expect("a list") {
        command.extend(["--set".to_owned(), change.as_str().expect("a text").to_owned()]);
    }
    let again = story.tell(&command.iter().map(String::as_str).collect::<Vec<_>>()).expect_code(0).stdout;
    let again: Value = serde_json::from_str(&again).expect("it is JSON");
    let row = rows.iter().find(|row| row[entry] == "ben" && row[seed] == "4").expect("it was run");
    assert_eq!(again["run"]["extinguished"].to_string(), row[column("extinguished")]);
    // A course that is over can be resumed, and asks for nothing more.
    story.tell(&["batch", "--resume", "course"]).expect_code(0);
    assert_eq!(outcomes(&story.path("course/runs.csv")), rows);
}

#[test]
fn every_entry_plays_every_condition_and_its_mean_is_over_them() {
    let story = course();
    let conditions = "[conditions]\nnear.wumpus.goal = \"nearest-intact\"\nfast.unimog.speed_mps = 12.0\n";
    story.file("rules.toml", &format!("{RULES}\n{conditions}"));
    story.tell(&with(&["--out", "course"])).expect_code(0);
    let rows = outcomes(&story.path("course/runs.csv"));
    let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
    let (entry, condition) = (column("entry"), column("condition"));
    let of = |wanted: [&'static str; 2]| -> Vec<&String> {
        let is_it = |row: &&Vec<String>| [&row[entry], &row[condition]] == wanted;
        rows.iter().filter(is_it).map(|row| &row[column("burned_out")]).collect()
    };
    assert_eq!((rows.len(), of(["anna", "near"]).len(), of(["ben", "fast"]).len()), (1 + 3 * 2 * 5, 5, 5));
    assert_ne!(of(["anna", "near"]), of(["anna", "fast"]));
    let ranking: Value =
        serde_json::from_str(&story.tell(&["rank", "course", "--json"]).expect_code(0).stdout).expect("it is JSON");
    assert_eq!((&ranking["mean_over"][0], &ranking["runs"]), (&"condition".into(), &10.into()));
    for (wrong, part) in [
        ("near.unimog.planner = \"prm-rs\"", "`unimog.planner` is both set by [conditions.near] and free"),
        ("near.unimog.sped_mps = 3.0", "unknown"),
        ("near = 3", "expected a table"),
    ] {
        story.file("rules.toml", &format!("{RULES}\n[conditions]\n{wrong}\n"));
        refuse(&story, &with(&[]), &["rules.toml:", part]);
    }
}

#[test]
fn entries_may_differ_in_whatever_the_rules_free() {
    let story = course();
    story.file("rules.toml", "free = [\"wumpus.goal\"]\nseeds = \"1..3\"\nscenario.from = \"smoke\"\n");
    for (name, goal) in [("anna", "random-intact"), ("ben", "nearest-intact")] {
        story.file(&format!("{name}.toml"), &format!("[wumpus]\ngoal = \"{goal}\"\n"));
    }
    let rules = ["batch", "--rules", "rules.toml", "--entry", "anna.toml", "ben.toml", "--out", "course"];
    story.tell(&rules).expect_code(0);
    story.tell(&["rank", "course", "--metric", "wumpus_score", "--better", "higher"]).expect_code(0);
    // Who did not play by these rules may not differ in it.
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "other"]).expect_code(0);
    refuse(&story, &["rank", "course", "other"], &["wumpus.goal is random-intact and nearest-intact"]);
}

#[test]
fn entries_take_turns() {
    let story = course();
    story.tell(&with(&["--out", "course", "--jobs", "1"])).expect_code(0);
    let journal = fs::read(story.path("course/runs.journal")).expect("it is there");
    let journal = String::from_utf8_lossy(&journal);
    // One worker leaves its lines in the order in which it ran.
    let places: Vec<usize> =
        ["anna", "ben", "cem"].iter().filter_map(|name| journal.find(&format!("\"{name}\""))).collect();
    let second_of_anna = journal.match_indices("\"anna\"").nth(1).map(|(at, _)| at).expect("five runs");
    assert!(places.len() == 3 && places.iter().all(|&place| place < second_of_anna), "{places:?} {second_of_anna}");
}

#[test]
fn what_the_rules_fix_is_refused_by_name_and_line() {
    let story = course();
    let refused = |text: &str, fragments: &[&str]| {
        story.file("ben.toml", text);
        refuse(&story, &with(&["--out", "course"]), fragments);
    };
    refused(
        "[unimog]\nplanner = \"lattice\"\nspeed_mps = 20\n",
        &["ben.toml:3: `unimog.speed_mps` is fixed by the rules in rules.toml"],
    );
    refused("[field]\ncoverage = 0.01\n", &["ben.toml:2: `field.coverage` is fixed"]);
    refused("duration_s = 1\n[unimog]\nplanner = \"lattice\"\n", &["ben.toml:1: `duration_s` is fixed"]);
    refused(
        "[[unimog]]\nplanner = \"lattice\"\n",
        &["ben.toml:1: `unimog` is a list of tables; expected a table [unimog]"],
    );
    refused("[unimog]\nplanner = \"latice\"\n", &["ben.toml:2:", "latice", "lattice"]);
    refused(
        "[unimog]\nplaner = \"lattice\"\n",
        &["ben.toml:2: unknown field `planer` in `unimog`; did you mean `planner`?"],
    );
    refused("[unimgo]\nplanner = \"lattice\"\n", &["ben.toml:2: unknown field `unimgo`", "did you mean `unimog`?"]);
    let price = "`unimog.lattice.seconds_per_expansion` is a price, and fixed by the rules in rules.toml";
    refused("[unimog.lattice]\nseconds_per_expansion = 0\n", &[&format!("ben.toml:2: {price}")]);
    refused("[unimog.lattice]\nsamples = 1\n", &["ben.toml:2: unknown field `samples`"]);
    refused("[unimog]\nplanner = [\n", &["ben.toml:"]);
    refused("", &["ben.toml: it is empty"]);
    let program = "[unimog]\nplanner = \"mine\"\n[planner.mine]\ncommand = [\"true\"]\n";
    refused(
        &format!("{program}reuse = true\n"),
        &["ben.toml:5: `planner.mine.reuse` is true; in a course every run has its own process"],
    );
    refused(
        &format!("{program}query_cpu_s = 3\n"),
        &["ben.toml:5: `planner.mine.query_cpu_s` is 3; the rules allow at most 2"],
    );
    for price in ["seconds_per_expansion", "expansions_per_query"] {
        refused(
            &format!("{program}{price} = 0\n"),
            &[&format!("ben.toml:5: `planner.mine.{price}` is a price, and fixed by the rules in rules.toml")],
        );
    }
    refused(&format!("{program}query_cpu_s = \"none\"\n"), &["the rules allow at most 2"]);
    refused(
        &format!("{program}query_limit_s = 21\n"),
        &["ben.toml:5: `planner.mine.query_limit_s` is 21; the rules allow at most 20"],
    );
    fs::remove_file(story.path("ben.toml")).expect("it is there");
    refuse(&story, &with(&["--out", "course"]), &["ben.toml: the file does not exist"]);
    refuse(&story, &["batch", "--rules", "rules.toml", "--entry", "anna.toml", "anna.toml"], &["it is named twice"]);
}

/// A program of the shell that has no path for anybody, and whose greeting is in a file beside it.
#[cfg(unix)]
const SILENT: &str = "\
read hello; cat greeting.json
read field; echo '{\"type\":\"ready\"}'
while read -r line; do
  case $line in *'\"end\"'*) exit;; esac
  id=${line#*\"id\":}; id=${id%%,*}
  echo \"{\\\"type\\\":\\\"none\\\",\\\"id\\\":$id,\\\"reason\\\":\\\"disconnected\\\"}\"
done
";

#[cfg(unix)]
#[test]
fn programs_work_in_the_folder_of_their_entry_within_the_limits_of_the_rules() {
    let story = course();
    fs::create_dir(story.path("dora")).expect("writable");
    story.file("dora/silent.sh", SILENT);
    story.file("dora/greeting.json", "{\"type\":\"hello\",\"protocol\":1,\"name\":\"silent\",\"version\":\"1\"}\n");
    let table = "[unimog]\nplanner = \"mine\"\n[planner.mine]\ncommand = [\"sh\", \"silent.sh\"]\nquery_cpu_s = 0.5\n";
    story.file("dora/dora.toml", table);
    let batch = ["batch", "--rules", "rules.toml", "--entry", "anna.toml", "dora/dora.toml", "--seeds", "1..2"];
    let with = |more: &[&'static str]| [&batch[..], &["--out", "course"], more].concat();
    // What a ranking would refuse is refused before the first run.
    let unequal = "dora/dora.toml: its `unimog.rescue` is false, but true in anna; expected [scenario] in rules.toml";
    refuse(&story, &with(&["--trust"]), &[unequal]);
    story.file("rules.toml", &RULES.replace("fire.relight = true", "unimog.rescue = false"));
    refuse(&story, &with(&[]), &["planner `mine`", "sh silent.sh", "--trust"]);
    story.tell(&with(&["--trust"])).expect_code(0);
    let plan: Value = serde_json::from_str(&story.read("course/plan.json")).expect("it is JSON");
    let table = &plan["variants"][1]["scenario"]["planner"]["mine"];
    assert_eq!(
        (&table["query_cpu_s"], &table["query_limit_s"], &table["restarts"]),
        (&0.5.into(), &20.0.into(), &1.into())
    );
    let ranking = story.tell(&["rank", "course", "--json", "--metric", "extinguished"]).expect_code(0).stdout;
    let ranking: Value = serde_json::from_str(&ranking).expect("it is JSON");
    let last = &ranking["entries"][1];
    assert_eq!((&last["entry"], &last["mean"], &last["failed"]), (&"dora".into(), &0.0.into(), &0.into()));
    assert!(last["queries"]["failed"].as_u64() > Some(0), "{last}");
}

/// A course without rescue in which `dora` asks this program of the shell, and the limits of the rules.
#[cfg(unix)]
fn course_with_program(program: &str, limits: &str) -> Story {
    let story = course();
    story.file("silent.sh", program);
    story.file("greeting.json", "{\"type\":\"hello\",\"protocol\":1,\"name\":\"silent\",\"version\":\"1\"}\n");
    story.file("dora.toml", "[unimog]\nplanner = \"mine\"\n[planner.mine]\ncommand = [\"sh\", \"silent.sh\"]\n");
    let limits = format!("[limits]\n{limits}\n");
    let rules = RULES.replace("[limits]\n", &limits).replace("fire.relight = true", "unimog.rescue = false");
    story.file("rules.toml", &rules);
    story
}

#[cfg(unix)]
#[test]
fn rules_charge_every_entry_for_expansions_and_programs_for_queries() {
    let story = course_with_program(SILENT, "seconds_per_expansion = 0.01\nexpansions_per_query = 300");
    let batch = ["batch", "--rules", "rules.toml", "--entry", "ben.toml", "dora.toml", "--out", "course", "--trust"];
    story.tell(&batch).expect_code(0);
    let plan: Value = serde_json::from_str(&story.read("course/plan.json")).expect("it is JSON");
    for variant in plan["variants"].as_array().expect("a list") {
        assert_eq!(variant["scenario"]["unimog"][0]["seconds_per_expansion"], 0.01);
    }
    let rows = outcomes(&story.path("course/runs.csv"));
    let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
    let number = |row: &[String], name: &str| row[column(name)].parse::<f64>().expect("a number");
    for row in &rows[1..] {
        let expansions = number(row, "truck_local_expansions");
        // Searches that are called off, or are under way at the end, are charged in part.
        let share = number(row, "truck_planning_s") / (0.01 * expansions);
        assert!((0.5..=1.0 + 1e-9).contains(&share), "{share}: {row:?}");
        if row[column("entry")] == "dora" {
            assert_eq!(expansions, 300.0 * number(row, "truck_plans"), "{row:?}");
        }
    }
    // A student's file cannot ask for less, unless the rules free the price by its name.
    let rules = story.read("rules.toml");
    story.file("rules.toml", &rules.replace("\"planner.*\"", "\"planner.*\", \"planner.*.expansions_per_query\""));
    let dora = story.read("dora.toml");
    story.file("dora.toml", &format!("{dora}expansions_per_query = 299\n"));
    refuse(&story, &batch, &["dora.toml:5: `planner.mine.expansions_per_query` is 299; the rules allow at least 300"]);
    story.file("dora.toml", &format!("{dora}expansions_per_query = 301\n"));
    story.tell(&[&batch[..], &["--dry-run"]].concat()).expect_code(0);
}

#[cfg(unix)]
#[test]
fn every_form_says_that_outcomes_depend_on_the_machine_where_a_clock_ended_a_query() {
    let late = SILENT.replace("  id=", "  sleep 60\n  id=");
    let story = course_with_program(&late, "query_limit_s = 0.02");
    let out = ["--seeds", "1..2", "--trust", "--out"];
    let batch = |folder: &'static str, entries: &[&'static str], form: &[&'static str]| {
        let rules = ["batch", "--rules", "rules.toml", "--entry"];
        story.tell(&[&rules[..], entries, &out[..], &[folder], form].concat()).expect_code(0).stdout
    };
    let sentence = "Outcomes depend on this machine: ";
    let expect_sentence = |what: &str, text: &str| {
        assert!(text.split_whitespace().collect::<Vec<_>>().join(" ").contains(sentence), "{what}:\n{text}");
    };
    expect_sentence("text", &batch("class", &["anna.toml", "dora.toml"], &[]));
    for form in ["--md", "--html", "--json", "--tex"] {
        expect_sentence(form, &batch("again", &["anna.toml", "dora.toml"], &["--force", form]));
    }
    for folder in ["class", "one"] {
        if folder == "one" {
            expect_sentence(folder, &batch(folder, &["dora.toml"], &[]));
        }
        for form in [["--md"], ["--json"], ["--tex"]] {
            expect_sentence(
                "report",
                &story.tell(&[&["report", folder, "--trust"][..], &form].concat()).expect_code(0).stdout,
            );
        }
        expect_sentence("page", &story.read(&format!("{folder}/report.html")));
        expect_sentence("tables.md", &story.read(&format!("{folder}/tables.md")));
        for form in [&[][..], &["--md"], &["--json"], &["--tex"], &["--html"]] {
            expect_sentence("rank", &story.tell(&[&["rank", folder], form].concat()).expect_code(0).stdout);
        }
    }
    let run = ["run", "smoke", "--command", "mine=sh silent.sh", "--set", "unimog.planner=mine"];
    let run = [&run[..], &["--set", "planner.mine.query_limit_s=0.02", "--set", "planner.mine.restarts=0"]].concat();
    for form in [&[][..], &["--json"]] {
        expect_sentence("run", &story.tell(&[&run[..], form].concat()).expect_code(0).stdout);
    }
    let text = story.tell(&["rank", "class"]).expect_code(0).stdout;
    assert_eq!(text.matches("Outcomes depend").count(), 1, "anna's do not: {text}");
}

#[test]
fn ranking_repeats_and_audits_runs_and_finds_rows_that_they_do_not_give() {
    let story = course();
    story.tell(&with(&["--out", "course", "--record", "all"])).expect_code(0);
    let answer = story.tell(&["rank", "course", "--audit", "2"]).expect_code(0);
    assert!(answer.stdout.contains("Audit: 6 runs repeated, no violation."), "{}", answer.stdout);
    // The best row of `ben` is made better; its states still add up.
    let rows = outcomes(&story.path("course/runs.csv"));
    let text = story.read("course/runs.csv");
    let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
    let (entry, burned, saved) = (column("entry"), column("burned_out"), column("extinguished"));
    let mut is_done = false;
    let lines = text.lines().map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if cells[entry] == "ben" && !is_done {
            is_done = true;
            let move_to = cells[burned].parse::<u32>().expect("a number");
            cells[saved] = (cells[saved].parse::<u32>().expect("a number") + move_to).to_string();
            cells[burned] = "0".into();
        }
        cells.join(",") + "\n"
    });
    let rewritten: String = lines.collect();
    story.file("course/runs.csv", &rewritten);
    story.tell(&["rank", "course"]).expect_code(0);
    let answer = story.tell(&["rank", "course", "--audit", "1"]).expect_code(4);
    assert!(
        answer.stdout.contains("ben: 1 of 1 audited runs violate a rule or give a different row: "),
        "{}",
        answer.stdout
    );
    let json = story.tell(&["rank", "course", "--audit", "1", "--json"]).expect_code(4).stdout;
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    for entry in json["entries"].as_array().expect("a list") {
        let violations = u32::from(entry["entry"] == "ben");
        assert_eq!(entry["audit"]["violations"], violations, "{entry}");
    }
    assert!(
        story.tell(&["rank", "course", "--without", "ben"]).expect_code(0).stdout.starts_with("2 entries by saved")
    );
}

#[test]
fn others_run_where_refused_agents_are_left_out() {
    let story = course();
    story.file("ben.toml", "[field]\ncoverage = 0.01\n");
    let answer = story.tell(&with(&["--out", "course", "--skip-refused"])).expect_code(1);
    answer.expect_complaint(&["skipped: ben.toml:2: `field.coverage` is fixed by the rules"]);
    assert!(story.tell(&["rank", "course"]).expect_code(0).stdout.starts_with("2 entries by saved"));
    story.file("anna.toml", "");
    story.file("cem.toml", "");
    refuse(&story, &with(&["--out", "none", "--skip-refused"]), &["anna.toml: it is empty"]);
}

#[test]
fn rules_that_cannot_be_used_are_refused() {
    let story = course();
    let refused = |from: &str, to: &str, fragments: &[&str]| {
        assert!(RULES.contains(from), "{from}");
        story.file("rules.toml", &RULES.replacen(from, to, 1));
        refuse(&story, &with(&["--out", "course"]), fragments);
    };
    refused(
        "free = [\"unimog.planner\", \"unimog.lattice\", \"planner.*\"]",
        "free = []",
        &["rules.toml:1: `free` is empty"],
    );
    refused("\"planner.*\"", "\"*\"", &["rules.toml:1: `*` would free everything"]);
    refused("\"planner.*\"", "\"planner..x\"", &["rules.toml:1: `planner..x` is not a key"]);
    refused("\"planner.*\"", "\"fire.*\"", &["rules.toml:10: `fire.relight` is both set by [scenario] and free"]);
    refused("restarts = 1", "restart = 1", &["rules.toml:6: unknown field `restart`"]);
    refused("restarts = 1", "restarts = 1.5", &["rules.toml:6: `restarts` is 1.5"]);
    refused("query_cpu_s = 2", "query_cpu_s = -2", &["rules.toml:5: `query_cpu_s` is -2"]);
    refused("fire.relight", "fire.relit", &["rules.toml:10: unknown field `relit`"]);
    refused("\"smoke\"", "\"smok\"", &["rules.toml:9: there is neither a file nor a built-in scenario"]);
    refused("\"smoke\"", "7", &["rules.toml:9: `from` is 7; expected a name or a path"]);
    refused("\"@secret/seeds.txt\"", "\"5..1\"", &["rules.toml:2: the range `5..1` is empty"]);
    refused("seeds = \"@secret/seeds.txt\"", "", &["missing field `seeds`"]);
    refused(
        "\"@secret/seeds.txt\"",
        "\"@nowhere.txt\"",
        &["rules.toml: its seeds in nowhere.txt cannot be read", "--seeds takes others"],
    );
    story.file("rules.toml", RULES);
    story.file("secret/seeds.txt", "# nothing\n");
    refuse(&story, &with(&["--out", "course"]), &["secret/seeds.txt: there are no seeds"]);
    story.file("secret/seeds.txt", &"1 ".repeat(4_000_001));
    refuse(&story, &with(&["--out", "course"]), &["cannot be read"]);
    story.file("secret/seeds.txt", "1..1000000");
    refuse(&story, &with(&["--out", "course"]), &["3000000 runs are many"]);
    // A student who does not have the seeds takes others.
    fs::remove_dir_all(story.path("secret")).expect("it is there");
    story.tell(&with(&["--seeds", "1..2", "--dry-run"])).expect_code(0);
    refuse(&story, &["batch", "--agent", "anna.toml"], &["--rules"]);
    refuse(&story, &["batch", "--rules", "rules.toml"], &["--entry"]);
    refuse(&story, &with(&["--set", "fire.relight=true"]), &["cannot be used with"]);
    fs::remove_file(story.path("rules.toml")).expect("it is there");
    refuse(&story, &with(&["--out", "course"]), &["rules.toml: the file does not exist"]);
}

#[test]
fn whole_scenarios_of_rules_have_nothing_of_others() {
    let story = course();
    let smoke = story.tell(&["scenarios", "--show", "smoke", "--all"]).expect_code(0).stdout;
    let smoke = smoke
        .replace("[[", "[[scenario.")
        .replace("\n[", "\n[scenario.")
        .replace("[scenario.[scenario.", "[[scenario.");
    let lines: Vec<&str> = smoke.lines().filter(|line| !line.starts_with('#')).collect();
    let rules = format!("free = ['unimog.planner']\nseeds = '1..3'\n[scenario]\n{}\n", lines.join("\n"));
    story.file("rules.toml", &rules);
    story.tell(&["batch", "--rules", "rules.toml", "--entry", "anna.toml", "--out", "whole"]).expect_code(0);
    story.tell(&["batch", "smoke", "--planner", "prm+primitives", "--seeds", "1..3", "--out", "plain"]).expect_code(0);
    let without_entry = |folder: &str| {
        let rows = outcomes(&story.path(&format!("{folder}/runs.csv")));
        let entry = rows[0].iter().position(|name| name == "entry");
        rows.into_iter()
            .map(|row| row.into_iter().enumerate().filter(|(at, _)| Some(*at) != entry).map(|(_, cell)| cell).collect())
            .collect::<Vec<Vec<String>>>()
    };
    assert_eq!(without_entry("whole"), without_entry("plain"));
}

#[test]
fn new_assignment_is_a_course_that_runs_and_is_ranked_with_sheets() {
    let story = Story::begin();
    let printed = story.tell(&["new", "assignment", "logic"]).expect_code(0).stdout;
    let commands: Vec<&str> = printed.lines().filter_map(|line| line.strip_prefix("  wildfire ")).collect();
    let [batch, rank] = commands[..] else { panic!("{printed}") };
    let batch: Vec<&str> = batch.split(' ').collect();
    let dry = story.tell(&[&batch[..], &["--dry-run"]].concat()).expect_code(0).stdout;
    assert!(dry.starts_with("3 variants x 20 seeds") && dry.contains("entry cem"), "{dry}");
    let seeds = |text: &str| text.lines().map(|line| line.parse::<u64>().expect("a seed")).collect::<Vec<_>>();
    let secret = seeds(&story.read("logic/secret.csv"));
    assert!(secret.len() == 20 && secret.iter().filter(|&&seed| seed > 1 << 53).count() > 10, "{secret:?}");
    assert_ne!(seeds(&story.tell(&["new", "seeds"]).expect_code(0).stdout), secret, "they are random");
    refuse(&story, &["new", "assignment", "logic"], &["logic already exists"]);
    refuse(&story, &["new", "assignment"], &["an assignment needs a folder"]);

    story.tell(&[&batch[..], &["--seeds", "100001..100004"]].concat()).expect_code(0);
    story.tell(&rank.split(' ').collect::<Vec<_>>()).expect_code(0);
    let sheet = story.read("runs/sheets/ben.md");
    for fragment in
        ["# ben: rank ", "Difference from the first: -", "| budget spent |", "--entry entry.toml --seeds 1..20"]
    {
        assert!(sheet.contains(fragment), "`{fragment}` is missing:\n{sheet}");
    }
    for secret in ["10000", "anna", "cem", "logic"] {
        assert!(!sheet.contains(secret), "`{secret}` is for the instructor:\n{sheet}");
    }
    // The worst runs are those of the table, and the instructor's commands make pages.
    let rows = outcomes(&story.path("runs/course/runs.csv"));
    let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
    let runs = rows[1..].iter().filter(|row| row[column("entry")] == "ben");
    let saved = |row: &[String]| ["intact", "extinguished"].map(|name| row[column(name)].parse::<u32>().unwrap());
    let worst = runs.min_by_key(|row| saved(row).iter().sum::<u32>()).expect("it has runs");
    let seed = &worst[column("seed")];
    let number: u32 = seed.trim_start_matches("10000").parse().expect("a digit");
    assert!(sheet.contains(&format!("| {number} | ")), "{sheet}\n{worst:?}");
    let instructor = story.read("runs/sheets/instructor.md");
    let of_ben = instructor.split("## ben").nth(1).expect("there is such a heading");
    let command =
        of_ben.lines().find_map(|line| line.strip_prefix("    wildfire render ")).expect("there is a command");
    assert!(command.contains(&format!("--seed {seed} ")), "{command}\n{worst:?}");
    let made = output_of(&mut story.shell(&format!("\"$0\" render {command}")));
    assert!(made.status.success() && story.path(&format!("seed-{seed}.html")).exists());
}

/// A program that changes the files of the batch where no sandbox keeps it from that: its runs fail by its name, and the others
/// stay as they were.
#[cfg(unix)]
#[test]
fn program_that_changes_files_of_the_batch_costs_its_own_runs() {
    for (attack, part) in [
        ("echo lie >> $J", "runs.journal: it has "),
        ("sed -i s/anna/emma/ $J", "runs.journal: "),
        ("perl -pi -e 's/anna/emma/' $J; truncate -s 0 $J", "runs.journal: "),
        ("rm -r $J", "removed or renamed"),
        ("echo lie >> ${J%/*}/plan.json", "plan.json was changed"),
    ] {
        let story = course_with_program(SILENT, "");
        let journal = story.path("course/runs.journal").display().to_string();
        let attack = attack.replace("$J", &journal).replace("${J%/*}", &story.path("course").display().to_string());
        story.file("silent.sh", &SILENT.replacen('\n', &format!("\n{attack}\n"), 1));
        // Without a sandbox, as on machines that have none.
        let empty = story.path("no-bubblewrap");
        fs::create_dir(&empty).expect("writable");
        story.file("no-bubblewrap/bwrap", "#!/bin/sh\nexit 1\n");
        let script = format!(
            "chmod +x no-bubblewrap/bwrap; PATH={}:$PATH \"$0\" batch --rules rules.toml --entry anna.toml dora.toml ben.toml --seeds 3,4 --trust --out course",
            empty.display()
        );
        let made = output_of(&mut story.shell(&script));
        let stderr = String::from_utf8_lossy(&made.stderr);
        assert_eq!(made.status.code(), Some(1), "{attack}: {stderr}");
        assert!(stderr.contains("without a sandbox"), "{stderr}");
        let rows = outcomes(&story.path("course/runs.csv"));
        let column = |name: &str| rows[0].iter().position(|found| found == name).expect("there is such a column");
        for row in &rows[1..] {
            let is_dora = row[column("entry")] == "dora";
            assert_eq!(row[column("status")] == "failed", is_dora, "{attack}: {row:?}");
            let message = &row[column("message")];
            assert!(!is_dora || message.contains("its program changed files") && message.contains(part), "{message}");
        }
        assert_eq!(rows.len(), 1 + 3 * 2);
        let ranking = story.tell(&["rank", "course"]).expect_code(0).stdout;
        assert!(ranking.contains("dora: 2 of 2 runs failed; the first: its program changed"), "{ranking}");
    }
}

#[test]
fn after_its_first_run_an_entry_is_told_how_long_it_will_take() {
    use std::io::{BufRead, BufReader};

    let story = course();
    let mut batch = story.command(&with(&["--seeds", "1..30000", "--jobs", "1", "--out", "long"]));
    let mut batch = batch.stderr(std::process::Stdio::piped()).spawn().expect("the program can be started");
    let lines = BufReader::new(batch.stderr.take().expect("it is piped")).lines().map_while(Result::ok);
    let estimate = lines.take(20).find(|line| line.contains(": about "));
    batch.kill().and_then(|()| batch.wait()).expect("it was at work");
    let estimate = estimate.expect("three entries of 30,000 runs take more than a minute");
    assert!(estimate.contains("entry anna") && estimate.ends_with(" for this entry, 30000 runs"), "{estimate}");
}
