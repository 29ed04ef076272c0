//! What goes into papers: tables as LaTeX, charts of chosen columns, and what made the numbers.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::children::{command, output_of};
use crate::story::{Story, refuse};

/// A batch `a` of two planners, whose scenario has a name that LaTeX would act on.
fn story() -> Story {
    let story = Story::begin();
    let smoke = story.tell(&["scenarios", "--show", "smoke", "--all"]).expect_code(0).stdout;
    story.file("odd.toml", &smoke.replacen("name = \"smoke\"", "name = \"50% \\\\input{x} & a_b\"", 1));
    let planners = ["--planner", "prm-rs,hybrid-astar", "--set", "field.coverage=0.05,0.1"];
    story.tell(&[&["batch", "odd.toml", "--seeds", "1..4", "--out", "a"], &planners[..]].concat()).expect_code(0);
    story
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn charts(story: &Story, ending: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(story.path("a/charts")).expect("the folder is there");
    let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
    names.filter_map(|name| name.strip_suffix(ending).map(str::to_owned)).collect()
}

#[test]
fn tables_of_a_batch_are_latex_in_which_no_name_acts() {
    let story = story();
    let escaped = "50\\% \\textbackslash{}input\\{x\\} \\& a\\_b";
    for command in [&["report", "a", "--tex"][..], &["report", "a", "--tex", "--metric", "truck_cusps"]] {
        let paper = story.tell(command).expect_code(0).stdout;
        assert!(paper.starts_with("% \\usepackage[T1]{fontenc}\n% \\usepackage{booktabs,graphicx}\n"), "{paper}");
        assert!(paper.contains(escaped) && !paper.contains("\\input"), "{paper}");
        for rule in ["\\toprule", "\\midrule", "\\bottomrule"] {
            assert!(paper.contains(rule), "{rule}: {paper}");
        }
        assert_eq!(paper.matches("\\begin{table}").count(), paper.matches("\\label{tab:").count(), "{paper}");
        let begins = paper.matches("\\begin{").count();
        assert!(begins > 1 && begins == paper.matches("\\end{").count(), "{paper}");
    }
    let printed = story.tell(&["report", "a", "--tex", "--metric", "truck_cusps"]).expect_code(0).stdout;
    assert_eq!(printed.matches("\\begin{tabular}{lrrrrr}").count(), 1, "one table for the column: {printed}");
    let means = story.tell(&["report", "a", "--tex"]).expect_code(0).stdout;
    assert!(means.contains("\\caption{Means over finished runs}\\label{tab:means-over-finished-runs}"), "{means}");
    assert!(!means.contains("\n1 & 1 & ") && !means.contains("Obstacle states at the end of each run"), "{means}");
    let rows = story.tell(&["report", "a", "--tex", "--rows"]).expect_code(0).stdout;
    assert_eq!(rows.matches("\n1 & 1 & ").count(), 4, "a first run, of seed 1, in each variant: {rows}");
    let new = ["batch", "smoke", "--seeds", "1..2", "--force", "--out", "b"];
    for form in ["--tex", "--md", "--html"] {
        let batch = story.tell(&[&new[..], &[form]].concat()).expect_code(0).stdout;
        assert!(batch.contains("Obstacle states at the end of each run"), "{form}: {batch}");
    }
    assert!(story.tell(&["check", "smoke", "--all", "--tex"]).expect_code(0).stdout.contains("\\subsection*{Fire}"));
}

#[test]
fn means_of_the_variants_are_a_table_of_their_own() {
    let story = story();
    let rows = |file: &str| {
        let mut reader = csv::Reader::from_path(story.path(file)).expect("the table is there");
        let names = reader.headers().expect("it has names").clone();
        let rows: Vec<_> = reader.records().map(|row| row.expect("it is whole")).collect();
        (names, rows)
    };
    let ((names, means), (all_names, all)) = (rows("a/summary.csv"), rows("a/runs.csv"));
    let labels: Vec<&str> = names.iter().take(6).collect();
    assert_eq!(labels, ["variant", "scenario", "planner", "field.coverage", "finished", "failed"]);
    let place =
        |names: &csv::StringRecord, name: &str| names.iter().position(|header| header == name).expect("it is there");
    let number = |row: &csv::StringRecord, place: usize| row[place].parse::<f64>().expect("a number");
    assert_eq!(means.len(), 4);
    for (index, row) in means.iter().enumerate() {
        assert_eq!([&row[0], &row[4], &row[5]], [&(index + 1).to_string(), "4", "0"]);
        let of_variant = &all[4 * index..4 * index + 4];
        assert_eq!(row[place(&names, "field.coverage")], of_variant[0][place(&all_names, "field.coverage")]);
        let mean = of_variant.iter().map(|run| number(run, place(&all_names, "extinguished"))).sum::<f64>() / 4.0;
        let found =
            ["extinguished_low", "extinguished", "extinguished_high"].map(|name| number(row, place(&names, name)));
        assert!((found[1] - mean).abs() < 1e-9 && found[0] <= mean && mean <= found[2], "{found:?} about {mean}");
    }
}

/// Compiles what commands print, in a column of 88 mm, where LaTeX is installed (Debian: texlive-latex-recommended).
#[test]
fn latex_sets_everything_within_a_column() {
    if std::process::Command::new("pdflatex").arg("--version").output().is_err() {
        return;
    }
    let story = story();
    let mut paper = "\\documentclass{article}\n\\usepackage[T1]{fontenc}\n\\usepackage{booktabs,graphicx}\n\
                     \\setlength{\\textwidth}{88mm}\n\\begin{document}\n"
        .to_owned();
    for command in [
        "report a --rows",
        "report a --metric truck_cusps",
        "compare a --by planner",
        "run smoke",
        "check contest",
        "status a",
        "plan --goals 2",
        "fire behavior --fuel GR2 --wind 5",
    ] {
        let args: Vec<&str> = command.split(' ').chain(["--tex"]).collect();
        paper += &story.tell(&args).expect_code(0).stdout;
        paper += "\\clearpage\n";
    }
    story.file("paper.tex", &(paper + "\\end{document}\n"));
    let mut latex = command("pdflatex");
    let latex = latex.args(["-interaction=nonstopmode", "-halt-on-error", "paper.tex"]).current_dir(story.path(""));
    let output = output_of(latex);
    let log = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{log}");
    let wide: Vec<&str> = log.lines().filter(|line| line.starts_with("Overfull \\hbox")).collect();
    assert!(wide.is_empty(), "{wide:#?}\n{log}");
}

#[test]
fn charts_are_those_of_the_columns_that_were_asked_for() {
    let story = story();
    let answer =
        story.tell(&["report", "a", "--metric", "truck_distance_m,extinguished", "--metric", "spotted"]).expect_code(0);
    assert!(answer.stdout.contains("truck_distance_m (m): distance driven"), "{}", answer.stdout);
    let expected = [
        "states",
        "mean-truck_distance_m",
        "mean-spotted",
        "distribution-truck_distance_m",
        "distribution-extinguished",
        "sweep-field.coverage-truck_distance_m",
        "over-time-1",
        "over-time-2",
        "over-time-3",
        "over-time-4",
    ];
    let found = charts(&story, ".svg");
    for name in expected {
        assert!(found.contains(name), "{name}: {found:?}");
    }
    assert!(!found.iter().any(|name| name.contains("cpu") || name.contains("burned") || name == "answer"), "{found:?}");
    assert_eq!(found, charts(&story, ".csv").into_iter().collect(), "each with what it shows");
    let over_time = story.read("a/charts/over-time-1.svg");
    assert!(!over_time.contains(">Burned out<"), "{over_time}");
    assert!(story.read("a/report.html").contains("truck_distance_m (m): distance driven"));
}

#[test]
fn columns_that_charts_cannot_show_are_refused_with_near_names() {
    let story = story();
    let missing = ["no column `truck_distance`", "did you mean `truck_distance_m`?", "wildfire schema runs"];
    refuse(&story, &["report", "a", "--metric", "intact,truck_distance"], &missing);
    refuse(&story, &["report", "a", "--metric", "winner"], &["`winner`", "holds no numbers"]);
    refuse(&story, &["report", "a", "--metric", "seed"], &["`seed`", "holds no numbers"]);
    refuse(&story, &["report", "a", "--metric", "a\u{1b}[2J"], &["a\\u001b[2J"]);
    assert!(!story.path("a/charts").exists(), "nothing was drawn");
}

#[test]
fn machines_are_named_beside_the_plan_and_put_together_by_merge() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..4", "--out", "whole", "--jobs", "2"]).expect_code(0);
    for slice in ["1/2", "2/2"] {
        story
            .tell(&["batch", "smoke", "--seeds", "1..4", "--out", "out", "--shard", slice, "--jobs", "2"])
            .expect_code(0);
    }
    story.tell(&["merge", "out"]).expect_code(0);
    let machine = |folder: &str| {
        let file = object(&story.read(&format!("{folder}/machines.json")));
        let machines = file["machines"].as_array().expect("a list").clone();
        assert_eq!(machines.len(), 1, "{file}");
        machines[0].clone()
    };
    let (mut whole, merged) = (machine("whole"), machine("out"));
    assert_eq!((whole["processes"].as_u64(), merged["processes"].as_u64()), (Some(1), Some(2)));
    assert_eq!(whole["threads"], 2);
    whole["processes"] = 2.into();
    assert_eq!(whole, merged);
    let plan = object(&story.read("whole/plan.json"));
    assert_eq!((&plan["compiler"], &plan["commit"]), (&whole["compiler"], &whole["commit"]));
    assert!(plan["compiler"].as_str().is_some_and(|name| name.starts_with("rustc ")), "{plan}");
    // Neither decides anything: a plan of another build goes on here.
    let other = story.read("whole/plan.json").replacen("\"compiler\": \"rustc", "\"compiler\": \"another rustc", 1);
    story.file("whole/plan.json", &other);
    story.tell(&["batch", "--resume", "whole"]).expect_code(0);
    assert_eq!(machine("whole")["processes"], 1, "nobody worked");
    assert!(story.tell(&["report", "whole"]).expect_code(0).stdout.contains("charts"));
    let page = story.read("whole/report.html");
    assert!(
        page.contains("another rustc") && page.contains("Machine: "),
        "who wrote the plan is named, not who reads it"
    );
    story.file("whole/machines.json", "{");
    refuse(&story, &["report", "whole"], &["whole/machines.json is not a list of machines", "you may remove it"]);
    story.tell(&["batch", "smoke", "--seeds", "1", "--out", "out", "--force"]).expect_code(0);
    assert!(!story.path("out/machines-1-of-2.json").exists(), "they go with their batch");
}

#[test]
fn parquet_files_name_the_compiler_in_their_metadata() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1", "--out", "out"]).expect_code(0);
    let compiler = object(&story.read("out/plan.json"))["compiler"].as_str().expect("a text").to_owned();
    for file in ["runs", "planner_calls", "states"] {
        let bytes = fs::read(story.path(&format!("out/{file}.parquet"))).expect("it was written");
        let is_there = bytes.windows(compiler.len()).any(|bytes| bytes == compiler.as_bytes());
        assert!(is_there, "{file}");
    }
}

#[test]
fn answers_as_json_have_the_members_of_their_schemas() {
    let story = story();
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<BTreeSet<_>>();
    let slice = ["batch", "smoke", "--seeds", "1..2", "--out", "slices", "--shard", "1/2", "--json"];
    let slice = story.tell(&slice).expect_code(0).stdout;
    story.tell(&["batch", "smoke", "--seeds", "1..2", "--out", "slices", "--shard", "2/2"]).expect_code(0);
    let answers = [
        (
            "batch-answer",
            story.tell(&["batch", "smoke", "--seeds", "1..2", "--out", "b", "--json"]).expect_code(0).stdout,
        ),
        ("batch-answer", story.tell(&["merge", "slices", "--json"]).expect_code(0).stdout),
        ("dry-run-answer", story.tell(&["batch", "smoke", "--dry-run", "--json"]).expect_code(0).stdout),
        ("slice-answer", slice),
        ("report-answer", story.tell(&["report", "a", "--json"]).expect_code(0).stdout),
        ("check-answer", story.tell(&["check", "smoke", "--json"]).expect_code(0).stdout),
        ("scenarios-answer", story.tell(&["scenarios", "--json"]).expect_code(0).stdout),
        ("machines", story.read("a/machines.json")),
    ];
    for (name, answer) in &answers {
        let schema = object(&story.tell(&["schema", name]).expect_code(0).stdout);
        assert_eq!(keys(&object(answer)), keys(&schema["properties"]), "{name}");
    }
    let report = object(&answers[4].1);
    assert_eq!(report["variants"].as_array().map(Vec::len), Some(4), "{report}");
    let extinguished = &report["variants"][0]["columns"]["extinguished"];
    assert_eq!(extinguished["runs"], 4, "{extinguished}");
    let (low, high) = (extinguished["low"].as_f64(), extinguished["high"].as_f64());
    assert!(low <= extinguished["mean"].as_f64() && extinguished["mean"].as_f64() <= high, "{extinguished}");
    assert_eq!(report["charts"].as_array().map(Vec::len), Some(charts(&story, ".svg").len()));
    refuse(&story, &["batch", "smoke", "--out", "c", "--json", "--profile"], &["--profile"]);
    refuse(&story, &["scenarios", "--show", "smoke", "--json"], &["--show"]);
}

#[test]
fn citation_names_plan_and_program_also_as_json() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1", "--out", "out"]).expect_code(0);
    let plan = story.read("out/plan.json");
    let commit = plan.lines().find(|line| line.starts_with("  \"commit\": ")).expect("it is a member");
    story.file("out/plan.json", &plan.replacen(commit, "  \"commit\": \"0123abc-dirty\",", 1));
    let entry = story.tell(&["cite", "out"]).expect_code(0).stdout;
    assert!(
        entry.contains(
            "note         = {Commit 0123abc-dirty; Scenarios: smoke; planners: prm-rs; seeds 1; 1 runs; plan "
        ),
        "{entry}"
    );
    let cited = object(&story.tell(&["cite", "out", "--json"]).expect_code(0).stdout);
    assert_eq!((&cited["commit"], &cited["batch"]["runs"]), (&"0123abc-dirty".into(), &1.into()), "{cited}");
    assert!(entry.contains(cited["batch"]["content_sha256"].as_str().expect("a hash")), "{entry}");
}
