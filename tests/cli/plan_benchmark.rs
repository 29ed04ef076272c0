//! Benchmarks of drives: `wildfire plan` with several seeds and values of keys, and the report on what they found.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::story::{Story, refuse, widest};

const HEADER: &str = "seed,field.coverage,field,goal,planner,success,reason,cpu_build_s,cpu_query_s,length_m,\
                      lower_bound_ratio,min_clearance_m,cusps,drive_s,expansions,violation";

/// Three seeds of two coverages, two goals each.
const SMALL: [&str; 7] = ["plan", "--seeds", "1..3", "--set", "field.coverage=0.02,0.05", "--goals", "2"];

fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&SMALL[..], more].concat()
}

/// The fields of a table's rows, without those of CPU times.
fn outcomes(story: &Story, name: &str) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_path(story.path(name)).expect("it was written");
    let header = reader.headers().expect("a header").clone();
    let kept = |row: csv::StringRecord| {
        let fields = header.iter().zip(&row).filter(|(column, _)| !column.starts_with("cpu_"));
        fields.map(|(_, field)| field.to_owned()).collect()
    };
    reader.records().map(|row| kept(row.expect("a row"))).collect()
}

#[test]
fn every_planner_is_asked_for_the_same_drives_of_every_variant_and_seed() {
    let story = Story::begin();
    let answer = story.tell(&small(&["--planner", "hybrid-astar,prm-rs", "--csv", "a.csv"])).expect_code(0);
    assert!(widest(&answer.stdout) <= 80, "{}", answer.stdout);
    for fragment in
        ["seeds 1..3: 24 queries", "field.coverage 0.02: 6 queries of each planner", "field.coverage 0.05: 6 q"]
    {
        assert!(answer.stdout.contains(fragment), "{fragment}: {}", answer.stdout);
    }
    assert_eq!(story.read("a.csv").lines().next(), Some(HEADER));
    let rows = outcomes(&story, "a.csv");
    let found: Vec<_> = rows.iter().map(|row| [&row[0], &row[1], &row[3], &row[4]].map(String::as_str)).collect();
    let mut expected = Vec::new();
    for coverage in ["0.02", "0.05"] {
        for seed in ["1", "2", "3"] {
            for goal in ["0", "1"] {
                expected.extend(["hybrid-astar", "prm-rs"].map(|planner| [seed, coverage, goal, planner]));
            }
        }
    }
    assert_eq!(found, expected);
    // One of them is the same as alone.
    let alone =
        ["plan", "--seed", "2", "--set", "field.coverage=0.05", "--goals", "2", "--planner", "hybrid-astar,prm-rs"];
    story.tell(&[&alone[..], &["--csv", "one.csv"]].concat()).expect_code(0);
    let in_benchmark: Vec<_> =
        rows.iter().filter(|row| row[0] == "2" && row[1] == "0.05").map(|row| row[2..].to_vec()).collect();
    assert_eq!(in_benchmark, outcomes(&story, "one.csv"));
}

#[test]
fn threads_change_nothing_but_cpu_times() {
    let story = Story::begin();
    for (jobs, name) in [("1", "one.csv"), ("3", "three.csv")] {
        story.tell(&small(&["--planner", "hybrid-astar", "--jobs", jobs, "--csv", name])).expect_code(0);
    }
    assert_eq!(outcomes(&story, "one.csv"), outcomes(&story, "three.csv"));
}

#[test]
fn all_are_the_built_in_planners_and_those_that_were_named() {
    let story = Story::begin();
    let answer = story.tell(&["plan", "--goals", "1", "--planner", "all,lattice", "--csv", "a.csv"]);
    answer.expect_code(0);
    let planners: Vec<String> = outcomes(&story, "a.csv").into_iter().map(|row| row[2].clone()).collect();
    let distinct: BTreeSet<&str> = planners.iter().map(String::as_str).collect();
    assert_eq!(planners.len(), 4, "each once: {planners:?}");
    assert_eq!(distinct, BTreeSet::from(["hybrid-astar", "lattice", "prm+primitives", "prm-rs"]));
}

#[test]
fn object_has_all_queries_and_estimates_with_intervals() {
    let story = Story::begin();
    let answer = story.tell(&small(&["--planner", "hybrid-astar", "--json", "--csv", "a.csv"])).expect_code(0).stdout;
    let object: Value = serde_json::from_str(&answer).expect("it is JSON");
    assert_eq!((&object["seeds"], &object["keys"][0]), (&"1..3".into(), &"field.coverage".into()));
    let rows = object["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), outcomes(&story, "a.csv").len());
    let columns: Vec<&str> = HEADER.split(',').map(str::trim).collect();
    let members: BTreeSet<&str> = rows[0].as_object().expect("an object").keys().map(String::as_str).collect();
    assert_eq!(members, columns.iter().copied().collect());
    let groups = object["summary"].as_array().expect("a list");
    assert_eq!(groups.len(), 2);
    for group in groups {
        let share = &group["solved_ratio"];
        assert!(share["low"].as_f64() <= share["value"].as_f64() && share["value"].as_f64() <= share["high"].as_f64());
        let ratio = &group["figures"]["lower_bound_ratio"];
        assert!(ratio["median"].as_f64().is_some_and(|ratio| ratio >= 0.999_999), "{group}");
        assert!(ratio["median_low"].is_number(), "six numbers have an interval: {group}");
    }
}

#[test]
fn field_files_are_drives_of_every_seed_too() {
    let story = Story::begin();
    story.file(
        "mine.json",
        "{\"field\": \"mine\", \"n\": 20, \"cells_cr\": [[10, 10]], \"start\": [20, 20, 0],\n\
         \"goals\": [{\"pose\": [52, 52, 0]}, {\"pose\": [70, 70, 1]}]}",
    );
    let answer = story.tell(&["plan", "mine.json", "--seeds", "4,9", "--planner", "lattice", "--csv", "a.csv"]);
    let answer = answer.expect_code(0).stdout;
    assert!(answer.contains("lattice: goal blocked 2 times, first on field mine, goal 0 (seed 4)."), "{answer}");
    let rows = outcomes(&story, "a.csv");
    assert_eq!(rows.iter().map(|row| row[0].as_str()).collect::<Vec<_>>(), ["4", "4", "9", "9"]);
    assert_eq!(rows[0][1..], rows[2][1..], "the lattice draws nothing");
}

#[test]
fn report_needs_no_other_file_and_is_the_same_again() {
    let story = Story::begin();
    story.tell(&small(&["--planner", "hybrid-astar,lattice", "--report", "bench"])).expect_code(0);
    let page = story.read("bench/report.html");
    for fragment in [
        "<h1>Drives: bench</h1>",
        ">Boxes</h2>",
        ">Medians over swept keys</h2>",
        "milliseconds",
        "field.coverage 0.05",
        "hybrid-astar",
        "Wilson",
    ] {
        assert!(page.contains(fragment), "{fragment} is missing");
    }
    assert!(page.contains("<svg") && !page.contains("<script") && !page.contains("src=\"http"), "it needs no network");
    let charts = |folder: &str| {
        let entries = fs::read_dir(story.path(folder)).expect("the folder of charts");
        entries
            .map(|entry| entry.expect("readable").file_name().into_string().expect("a name"))
            .collect::<BTreeSet<_>>()
    };
    let found = charts("bench/report-charts");
    for chart in
        ["box-cpu_query_s", "box-lower_bound_ratio", "sweep-field.coverage-cpu_query_s", "sweep-field.coverage-solved"]
    {
        for ending in ["svg", "png", "csv"] {
            assert!(found.contains(&format!("{chart}.{ending}")), "{chart}.{ending}: {found:?}");
        }
    }
    story.tell(&["plan", "report", "bench"]).expect_code(0);
    assert_eq!(story.read("bench/report.html"), page);
    // The same from the table alone, elsewhere, with charts for papers.
    fs::copy(story.path("bench/queries.csv"), story.path("bench.csv")).expect("it is there");
    let answer =
        story.tell(&["plan", "report", "bench.csv", "--out", "page.html", "--pdf", "--pgf"]).expect_code(0).stdout;
    assert!(answer.contains("page.html, and ") && answer.contains("SVG, PNG, PDF and PGF in page-charts"), "{answer}");
    let found = charts("page-charts");
    assert!(["pdf", "pgf"].iter().all(|ending| found.contains(&format!("box-cpu_query_s.{ending}"))), "{found:?}");
    let data = story.read("page-charts/sweep-field.coverage-solved.csv");
    assert!(data.starts_with("panel,series,x,value,low,high\n,hybrid-astar,0.02,100"), "{data}");
}

#[test]
fn tables_without_seeds_have_a_report_too() {
    let story = Story::begin();
    story.tell(&["plan", "--goals", "6", "--planner", "hybrid-astar,lattice", "--csv", "one.csv"]).expect_code(0);
    story.tell(&["plan", "report", "one.csv"]).expect_code(0);
    let page = story.read("one.html");
    assert!(
        page.contains("6 queries of each planner") && !page.contains("<h2>Medians over"),
        "it has tables and boxes"
    );
}

#[test]
fn what_is_no_benchmark_is_refused_and_nothing_is_written() {
    let story = Story::begin();
    story.file("f.json", "{\"n\": 20, \"cells_cr\": [], \"start\": [20, 20, 0], \"goals\": [{\"pose\": [70, 70, 1]}]}");
    story.file("taken", "a file");
    for (args, fragments) in [
        (&["plan", "--seeds", "3..1"][..], &["the range `3..1` is empty"][..]),
        (&["plan", "--seeds", "1..2", "--seed", "3"], &["cannot be used with"]),
        (&["plan", "--seeds", "1..2", "--png", "a.png"], &["--png needs a single variant and seed"]),
        (&["plan", "--set", "field.coverage=0.1,0.2", "--paths", "a.csv"], &["--paths needs a single variant"]),
        (&["plan", "--seeds", "1,2", "--repeat"], &["--repeat needs a single variant"]),
        (&["plan", "--set", "field.coverage=0.1,"], &["`field.coverage`", "an empty place"]),
        (&["plan", "--set", "field.coverage=0.1,0.1"], &["`field.coverage` has the value 0.1 twice"]),
        (&["plan", "--set", "field.covrage=0.1,0.2"], &["coverage"]),
        (&["plan", "--set", "unimog.planner=lattice,prm-rs", "--planner", "all"], &["both name planners"]),
        (&["plan", "--seeds", "1..2", "--planner", "hybrid"], &["`hybrid`", "hybrid-astar"]),
        (&["plan", "--seeds", "1..2000000", "--goals", "1"], &["2000000 queries or more are too many"]),
        (&["plan", "f.json", "--seeds", "1..400000", "--planner", "all"], &["1600000 queries or more are too many"]),
        (&["plan", "-", "--seeds", "1..2"], &["- is stdin, which can be read only once"]),
        (&["plan", "--seeds", "1,2", "--report", "taken"], &["taken is a file; expected a folder"]),
        (&["plan", "--seeds", "1,2", "--csv", "nowhere/a.csv"], &["the folder does not exist"]),
        (&["plan", "--seeds", "1,2", "--jobs", "0"], &["from 1 to 1024"]),
    ] {
        refuse(&story, args, fragments);
    }
}

#[test]
fn field_without_room_is_known_before_anybody_is_asked() {
    let story = Story::begin();
    let full = ["plan", "--seeds", "1..3", "--set", "field.coverage=0.02,0.9", "--goals", "3", "--csv", "a.csv"];
    let answer = story.tell(&full);
    assert_ne!(answer.code, Some(0), "{}", answer.stdout);
    assert!(answer.stdout.is_empty() && story.entries().is_empty(), "{}", answer.stdout);
    answer.expect_complaint(&["field.coverage"]);
}

/// `plan` took the value of the nearest rank and `plan report` the mean of the two in the middle.
#[test]
fn plan_and_report_on_its_table_print_the_same_medians() {
    let story = Story::begin();
    let answer = story.tell(&["plan", "--goals", "4", "--planner", "prm-rs", "--csv", "q.csv"]).expect_code(0).stdout;
    let cells: Vec<&str> = answer.lines().find(|line| line.starts_with("prm-rs")).expect("a row").split(' ').collect();
    let clearance = cells.iter().rev().filter(|cell| !cell.is_empty()).nth(2).expect("clearance, cusps, violations");
    let median = |numbers: &mut Vec<f64>| {
        numbers.sort_by(f64::total_cmp);
        f64::midpoint(numbers[1], numbers[2])
    };
    let mut found: Vec<f64> = outcomes(&story, "q.csv").iter().map(|row| row[7].parse().expect("metres")).collect();
    assert_eq!(*clearance, format!("{:.2}", median(&mut found)));
    story.tell(&["plan", "report", "q.csv"]).expect_code(0);
    assert!(story.read("q.html").contains(&format!("<td>{clearance}</td>")), "{clearance}");
    for page in [answer, story.read("q.html")] {
        assert!(page.contains("mean") || page.contains("median"), "each figure says which statistic it is: {page}");
    }
}

#[test]
fn tables_that_are_none_are_refused_with_their_line() {
    let story = Story::begin();
    let columns = HEADER.replace(",field.coverage", "");
    let good = "1,drives,0,lattice,true,,0.1,0.1,10.0,1.0,1.0,0,1.0,5,";
    let table = |header: &str, row: &str| format!("{header}\n{good}\n{row}\n");
    for (header, row, fragments) in [
        (columns.replace("cpu_query_s", "cpu"), good.to_owned(), &["there is no column `cpu_query_s`"][..]),
        (columns.clone(), "1,drives,0".to_owned(), &["line 3", "3 fields"]),
        (columns.clone(), good.replace("true", "yes"), &["line 3: success is `yes`; expected true or false"]),
        (columns.clone(), good.replace("true,,", "false,tired,"), &["line 3: reason is `tired`"]),
        (columns.clone(), good.replace("10.0", "NaN"), &["line 3: length_m is `NaN`; expected a number from 0 up"]),
        (columns.clone(), good.replace("10.0", "-1"), &["line 3: length_m is `-1`"]),
        (columns.clone(), good.replace("10.0", ""), &["line 3: length_m is ``"]),
        (columns.replace("seed", "goal"), good.to_owned(), &["the column `goal` appears twice"]),
        (columns.clone(), good.replacen('1', "-1", 1), &["line 3: seed is `-1`; expected a seed"]),
    ] {
        story.file("t.csv", &table(&header, &row));
        refuse(&story, &["plan", "report", "t.csv"], fragments);
    }
    story.file("t.csv", &format!("{columns}\n"));
    refuse(&story, &["plan", "report", "t.csv"], &["it has no queries"]);
    refuse(&story, &["plan", "report", "nowhere.csv"], &["nowhere.csv"]);
    refuse(&story, &["plan", "report", "."], &["queries.csv"]);
    story.file("t.csv", &format!("{columns}\n{good}\n"));
    refuse(&story, &["plan", "report", "t.csv", "--out", "page.txt"], &["page.txt would hold a page"]);
    refuse(&story, &["plan", "report", "t.csv", "--out", "-"], &["- is stdout"]);
    refuse(&story, &["plan", "report", "-"], &["expected --out"]);
    story.tell(&["plan", "report", "t.csv"]).expect_code(0);
}

#[test]
fn names_in_a_table_are_text_and_nothing_else() {
    let story = Story::begin();
    let columns = HEADER.replace("field.coverage", "<b>key</b>");
    let row = |seed: u32| {
        let metres = f64::from(seed) + 1.0;
        format!("{seed},\u{1b}[2J<i>,f,0,<script>alert(1)</script>,true,,0.1,0.1,{metres},1.0,1.0,0,1.0,5,\n")
    };
    story.file("t.csv", &format!("{columns}\n{}", (1..9).map(row).collect::<String>()));
    let answer = story.tell(&["plan", "report", "t.csv"]).expect_code(0);
    let page = story.read("t.html");
    for printed in [&answer.stdout, &answer.stderr, &page] {
        assert!(
            !printed.contains('\u{1b}') && !printed.contains("<script>") && !printed.contains("<b>key"),
            "{printed}"
        );
    }
}
