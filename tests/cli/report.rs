//! `wildfire report`: a page that stands alone, and its charts.

use std::fs;

use serde_json::Value;

use crate::story::{Story, outcomes, refuse};

/// A batch `a` of two planners and two coverages.
fn swept_batch() -> Story {
    let story = Story::begin();
    let planners = ["--planner", "prm+primitives,hybrid-astar", "--set", "field.coverage=0.05,0.10"];
    story.tell(&[&["batch", "smoke", "--seeds", "1..5", "--out", "a"], planners.as_slice()].concat()).expect_code(0);
    story
}

fn report(story: &Story) -> String {
    story.tell(&["report", "a"]).expect_code(0);
    story.read("a/report.html")
}

/// Names of charts in the folder, those of one ending without it.
fn charts(story: &Story, ending: &str) -> Vec<String> {
    let entries = fs::read_dir(story.path("a/charts")).expect("the folder is there");
    let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter_map(|name| name.strip_suffix(ending).map(str::to_owned)).collect();
    names.sort();
    names
}

#[test]
fn report_is_one_page_with_every_table_and_chart() {
    let story = swept_batch();
    let page = report(&story);
    for fragment in ["TABLE I.", "TABLE II.", "field.coverage 0.1", "Plan and version", "plan.json", "1..5"] {
        assert!(page.contains(fragment), "`{fragment}` is missing");
    }
    let names = charts(&story, ".svg");
    for name in ["states", "cpu-time", "distribution-extinguished", "over-time-4", "sweep-field.coverage-burned_out"] {
        assert!(names.contains(&name.to_owned()), "{name} is missing: {names:?}");
    }
    assert_eq!(names, charts(&story, ".png"));
    for name in &names {
        let svg = story.read(&format!("a/charts/{name}.svg"));
        assert!(page.contains(&svg), "{name} is not in the page");
        let png = fs::read(story.path(&format!("a/charts/{name}.png"))).expect("the picture is there");
        assert!(png.starts_with(b"\x89PNG"), "{name}");
    }
    let without_names = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for outside in ["http", "src=", "url(", "<script", "@import"] {
        assert!(!without_names.contains(outside), "the page needs `{outside}`");
    }
    assert!(!page.contains("NaN") && !page.contains("inf<"), "{page}");
}

/// Checks that every link of a page leads to a part of it, or to a file beside it, and returns them.
fn checked_links<'a>(story: &Story, page: &'a str) -> Vec<&'a str> {
    let links: Vec<&str> =
        page.split(" href=\"").skip(1).map(|rest| rest.split_once('"').expect("it ends").0).collect();
    for link in &links {
        match link.strip_prefix('#') {
            Some(id) => assert_eq!(page.matches(&format!(" id=\"{id}\"")).count(), 1, "{id}"),
            None => assert!(story.path(&format!("a/{link}")).is_file(), "{link}"),
        }
    }
    links
}

#[test]
fn every_link_of_a_report_has_its_target() {
    let story = swept_batch();
    let page = report(&story);
    let links = checked_links(&story, &page);
    for link in
        ["#means", "#files", "runs.csv", "plan.json", "charts/answer.svg", "charts/answer.csv", "charts/states.png"]
    {
        assert!(links.contains(&link), "{link} is missing: {links:?}");
    }
    assert_eq!(links.iter().filter(|link| link.starts_with('#')).count(), page.matches("<h2 id=").count());
    assert!(!links.iter().any(|link| link.ends_with(".pdf")));
    story.tell(&["report", "a", "--pages", "--pdf", "--pgf"]).expect_code(0);
    let page = story.read("a/report.html");
    let links = checked_links(&story, &page);
    for link in ["charts/median-run.html", "charts/states.pdf", "charts/states.pgf"] {
        assert!(links.contains(&link), "{link} is missing: {links:?}");
    }
    fs::remove_file(story.path("a/runs.parquet")).expect("the file is there");
    assert!(!checked_links(&story, &report(&story)).contains(&"runs.parquet"));
}

/// Returns the sentence that a page opens with.
fn opening(page: &str) -> &str {
    let after_title = page.split_once("</h1>\n<p>").expect("a paragraph follows the title").1;
    after_title.split_once("</p>").expect("it ends").0
}

/// Returns the numbers of a column of runs that are done.
fn column(story: &Story, name: &str) -> Vec<f64> {
    let rows = outcomes(&story.path("a/runs.csv"));
    let column = rows[0].iter().position(|header| header == name).expect("the column is there");
    rows[1..].iter().map(|row| row[column].parse().expect("a number")).collect()
}

#[test]
fn report_of_one_variant_opens_with_what_was_saved_and_a_curve() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..8", "--out", "a"]).expect_code(0);
    let page = report(&story);
    let [intact, extinguished, bushes] = ["intact", "extinguished", "obstacles"].map(|name| column(&story, name));
    let saved: Vec<f64> =
        intact.iter().zip(&extinguished).map(|(intact, extinguished)| intact + extinguished).collect();
    let mean = saved.iter().sum::<f64>() / 8.0;
    let opening_text = opening(&page);
    let number = opening_text.split_once(" saved ").expect(opening_text).1.split_once(" of ").expect(opening_text).0;
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    assert_eq!(number, format!("{mean:.decimals$}"), "{opening_text}");
    assert!(
        opening_text.contains(&format!(" of {} bushes (", bushes[0])) && opening_text.contains(" in 8 runs; "),
        "{opening_text}"
    );
    let curve = story.read("a/charts/over-time-1.svg");
    let at = page.find(&curve).expect("the curve is there");
    assert!(at < page.find("<nav").expect("contents") && page.matches(&curve).count() == 1);
}

#[test]
fn field_of_the_median_run_is_shown_where_it_was_recorded() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--record", "all", "--out", "a"]).expect_code(0);
    let page = report(&story);
    let burned = column(&story, "burned_ratio");
    let mut sorted = burned.clone();
    sorted.sort_by(f64::total_cmp);
    let caption = format!("{:.1} % of the bushes burned.</figcaption>", 100.0 * sorted[1]);
    let before_contents = page.split_once("<nav").expect("contents").0;
    assert!(
        before_contents.contains("src=\"data:image/png;base64,") && before_contents.contains(&caption),
        "{caption}"
    );
    assert!(page.contains(&story.read("a/charts/over-time-1.svg")));
}

#[test]
fn report_of_several_variants_opens_with_the_best_and_how_sure_that_is() {
    let story = swept_batch();
    let page = report(&story);
    let opening_text = opening(&page);
    assert!(page.contains("<div class=\"phone\">\n<svg"), "charts have a narrow form for phones");
    let saved: Vec<f64> = column(&story, "burned_ratio").iter().map(|burned| 1.0 - burned).collect();
    // The plan has coverages within planners.
    let means = [&saved[..10], &saved[10..]].map(|half| 100.0 * half.iter().sum::<f64>() / 10.0);
    let (best, mean) = if means[0] >= means[1] { ("prm+primitives", means[0]) } else { ("hybrid-astar", means[1]) };
    let number = opening_text.split_once(": ").expect(opening_text).1.split_once(" %").expect(opening_text).0;
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    if !opening_text.starts_with("No difference") {
        assert!(
            opening_text.starts_with(best) && opening_text.contains("averaged over 2 values of field.coverage"),
            "{opening_text}"
        );
        assert_eq!(number, format!("{mean:.decimals$}"), "{opening_text}");
        assert!(opening_text.contains("paired by seed"), "{opening_text}");
    }
    let answer = page.find(&story.read("a/charts/answer.svg")).expect("the curve is there");
    assert!(answer < page.find("<nav").expect("contents"));
    let axis = story.read("a/charts/answer.svg");
    for fragment in [">0.05<", ">0.1<", ">field.coverage<", ">bushes per run<"] {
        assert!(axis.contains(fragment), "{fragment}");
    }
}

#[test]
fn one_batch_has_one_interval_and_the_headline_gives_where_it_holds() {
    let story = swept_batch();
    // On the second coverage the second planner saves some more of the bushes that burned, on the first it is the same.
    let rows = outcomes(&story.path("a/runs.csv"));
    let place = |name: &str| rows[0].iter().position(|column| column == name).expect("a column");
    let [planner, coverage, seed, intact, extinguished, burned_out, burning, burned] =
        ["planner", "field.coverage", "seed", "intact", "extinguished", "burned_out", "burning", "burned_ratio"]
            .map(place);
    let text = story.read("a/runs.csv");
    let changed = text.lines().enumerate().map(|(index, line)| {
        if index == 0 {
            return line.to_owned();
        }
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let gain = match (cells[planner].as_str(), cells[coverage].as_str()) {
            ("hybrid-astar", "0.1") => 4 + cells[seed].parse::<u32>().expect("a seed") * 7 % 3,
            _ => 0,
        };
        let all: u32 = [intact, extinguished, burned_out, burning]
            .map(|at| cells[at].parse::<u32>().expect("a count"))
            .iter()
            .sum();
        let saved = all / 2 + gain;
        for (at, number) in [(intact, 0), (burning, 0), (extinguished, saved), (burned_out, all - saved)] {
            cells[at] = number.to_string();
        }
        cells[burned] = (f64::from(all - saved) / f64::from(all)).to_string();
        cells.join(",")
    });
    let changed: Vec<String> = changed.collect();
    story.file("a/runs.csv", &(changed.join("\n") + "\n"));
    let page = report(&story);
    let opening_text = opening(&page);
    let object = |arguments: &[&str]| -> Value {
        serde_json::from_str(&story.tell(arguments).expect_code(0).stdout).expect("it is JSON")
    };
    let by = "planner=prm+primitives,hybrid-astar";
    let compared = object(&["compare", "a", "--by", by, "--metric", "saved", "--json"]);
    let metric = &compared["comparisons"][0]["metrics"][0];
    let ends = |it: &Value| [0, 1].map(|end| it["interval"][end].as_f64().expect("an end"));
    let [low, high] = ends(metric);
    let mirrored =
        object(&["compare", "a", "--by", "planner=hybrid-astar,prm+primitives", "--metric", "saved", "--json"]);
    assert_eq!(ends(&mirrored["comparisons"][0]["metrics"][0]), [-high, -low]);
    let ranked = object(&["rank", "a", "--json"]);
    assert_eq!(
        (ranked["pairs"][0]["first"].as_str(), ends(&ranked["pairs"][0])),
        (Some("hybrid-astar"), [-high, -low])
    );
    assert!(opening_text.contains(&format!("(95 % interval {low:.2} to {high:.2})")), "{low} {high} {opening_text}");
    let dependence = "The difference from prm+primitives depends on field.coverage, p < 0.001: hybrid-astar is \
                      significantly ahead at field.coverage 0.1; no evidence of a difference at field.coverage 0.05.";
    assert!(opening_text.contains(&dependence.replace('<', "&lt;")), "{opening_text}");
    // The chart shows these differences, with the intervals of the strata.
    let strata = metric["by_stratum"]["strata"].as_array().expect("two coverages");
    let rows: Vec<String> = story.read("a/charts/answer.csv").lines().map(str::to_owned).collect();
    assert!(rows.len() == 3 && rows[1].starts_with(",prm+primitives,0.05,") && rows[1].contains(",0.0,"), "{rows:?}");
    let [low, high] = ends(&strata[1]);
    let numbers: Vec<f64> = rows[2].split(',').skip(4).map(|cell| cell.parse().expect("an end")).collect();
    assert_eq!((numbers, rows[2].starts_with(",prm+primitives,0.1,-")), (vec![-high, -low], true), "{rows:?}");
}

#[test]
fn no_interval_of_two_runs_leaves_the_range_of_its_column() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..2", "--out", "a"]).expect_code(0);
    let object: Value =
        serde_json::from_str(&story.tell(&["report", "a", "--json"]).expect_code(0).stdout).expect("JSON");
    let columns = object["variants"][0]["columns"].as_object().expect("columns");
    let mut beyond = 0;
    // Equal numbers have no interval.
    let has_interval = |column: &Value| !column["low"].is_null();
    for (name, column) in columns.iter().filter(|(name, column)| !name.ends_with("_score") && has_interval(column)) {
        let [mean, deviation, low, high] =
            ["mean", "standard_deviation", "low", "high"].map(|member| column[member].as_f64().unwrap_or(0.0));
        let is_share = name.ends_with("_ratio");
        assert!(0.0 <= low && low <= mean && mean <= high && !(is_share && high > 1.0), "{name}: {low} to {high}");
        let student = 12.706 * deviation / 2.0_f64.sqrt();
        beyond += u32::from(mean - student < 0.0 || is_share && mean + student > 1.0);
    }
    assert!(beyond > 0, "Student's intervals leave it: {columns:?}");
}

#[test]
fn distribution_of_equal_numbers_is_left_out_with_a_sentence() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..4", "--out", "a"]).expect_code(0);
    let runs = story.read("a/runs.csv");
    let mut rows: Vec<Vec<String>> = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(runs.as_bytes())
        .records()
        .map(|row| row.expect("a row").iter().map(str::to_owned).collect())
        .collect();
    let place = rows[0].iter().position(|name| name == "truck_distance_m").expect("it is there");
    rows[1..].iter_mut().for_each(|row| row[place] = "12.5".into());
    let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    story.file("a/runs.csv", &(lines.join("\n") + "\n"));
    let page = report(&story);
    let sentence = "Distance driven by trucks: no distribution, since it is 12.5 m in all 4 runs.";
    assert!(page.contains(sentence), "{page}");
    assert!(!charts(&story, ".svg").contains(&"distribution-truck_distance_m".to_owned()));
}

#[test]
fn names_of_variants_become_no_tags() {
    let story = Story::begin();
    for (file, name, radius) in [("one.toml", "<b>one</b>", 20), ("two.toml", "<b>two</b>&amp;", 30)] {
        let text = format!("name = \"{name}\"\nduration_s = {radius}\n[[wumpus]]\n[[unimog]]\n");
        story.file(file, &text);
    }
    story.tell(&["batch", "one.toml", "two.toml", "--seeds", "1..3", "--out", "a"]).expect_code(0);
    let page = report(&story);
    assert!(!page.contains("<b>") && page.contains("&lt;b&gt;one&lt;/b&gt;"), "{page}");
    assert!(page.contains("&lt;b&gt;two&lt;/b&gt;&amp;amp;"), "{page}");
    checked_links(&story, &page);
}

#[test]
fn page_has_colours_for_a_dark_screen_for_all_that_is_no_data() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "a"]).expect_code(0);
    let page = report(&story);
    let dark = page.split_once("prefers-color-scheme:dark").expect("a dark screen").1;
    let dark = dark.split_once("@media print").expect("and paper").0;
    let svg = story.read("a/charts/states.svg");
    for line in svg.lines().filter(|line| line.contains(" class=\"")) {
        let element = line.trim_start_matches('<').split(' ').next().expect("a name");
        let class = line.split_once(" class=\"").expect("it was found").1.split_once('"').expect("it ends").0;
        assert!(dark.contains(&format!("{element}.{class}")), "{element}.{class}");
    }
    assert!(svg.contains(" class=\"ink\"") && svg.contains("fill=\"#ffffff\" class=\"paper\"/>"), "{svg}");
}

#[test]
fn pages_play_the_runs_in_which_the_least_and_the_most_burned() {
    let story = swept_batch();
    let answer = story.tell(&["report", "a", "--pages"]).expect_code(0);
    assert_eq!(answer.stderr.matches("wrote a/charts/").count(), 3, "{}", answer.stderr);
    let report = story.read("a/report.html");
    let rows = fs::File::open(story.path("a/runs.csv")).expect("it was written");
    let mut rows = csv::Reader::from_reader(rows);
    let column = rows.headers().expect("a table").iter().position(|name| name == "burned_ratio").expect("it is there");
    let mut burned: Vec<f64> =
        rows.records().map(|row| row.expect("a row")[column].parse().expect("a number")).collect();
    burned.sort_by(f64::total_cmp);
    for (word, ratio) in [("best", burned[0]), ("median", burned[9]), ("worst", burned[19])] {
        let page = story.read(&format!("a/charts/{word}-run.html"));
        assert!(page.starts_with("<!DOCTYPE html>") && page.contains("id=\"run-data\""), "{word}");
        let link = format!("<a href=\"charts/{word}-run.html\">{word}: ");
        let line = report.lines().find(|line| line.contains(&link)).expect(word);
        assert!(line.contains(&format!(", {:.1} % of the bushes burned", 100.0 * ratio)), "{line}");
    }
    let best = story.read("a/charts/best-run.html");
    story.tell(&["report", "a", "--pages"]).expect_code(0);
    assert_eq!(story.read("a/charts/best-run.html"), best, "the same batch gives the same page");
    story.tell(&["batch", "smoke", "--seeds", "1", "--out", "a", "--force"]).expect_code(0);
    assert!(!story.path("a/charts/best-run.html").exists(), "what a batch wrote is removed with it");
}

#[test]
fn every_variant_of_a_large_sweep_is_in_the_charts() {
    let story = Story::begin();
    let swept = ["--planner", "prm-rs,lattice", "--set", "fire.burn_out_s=30,35,40,45,50,55,60,65,70,75,80,85"];
    story.tell(&[&["batch", "smoke", "--seeds", "1..2", "--out", "a"], swept.as_slice()].concat()).expect_code(0);
    let page = report(&story);
    assert!(!page.contains("first 7"), "no variant is left out");
    let names = charts(&story, ".svg");
    let of = |name: &str| -> String {
        let is_sheet =
            |file: &&String| *file == name || file.strip_prefix(name).is_some_and(|rest| rest.starts_with('-'));
        let sheets = names.iter().filter(is_sheet).map(|file| story.read(&format!("a/charts/{file}.svg")));
        sheets.collect()
    };
    for chart in ["states", "cpu-time", "distribution-extinguished"] {
        let svg = of(chart);
        for value in (30..=85).step_by(5) {
            assert_eq!(svg.matches(&format!(">fire.burn_out_s {value}<")).count(), 1, "{chart}: {value}");
        }
        assert!(svg.contains(">prm-rs<") && svg.contains(">lattice<"), "{chart}");
    }
    let over_time = of("over-time");
    for planner in ["prm-rs", "lattice"] {
        for value in (30..=85).step_by(5) {
            let name = format!(">{planner}, fire.burn_out_s {value}<");
            assert_eq!(over_time.matches(&name).count(), 1, "{name}");
        }
    }
    let sweep = of("sweep-fire.burn_out_s-burned_out");
    assert!(sweep.contains(">prm-rs<") && sweep.contains(">lattice<"), "a curve for each planner");
}

#[test]
fn chart_that_would_have_too_many_panels_is_refused_with_words() {
    let story = Story::begin();
    let values = (1..=130).map(|value| format!("{value}")).collect::<Vec<_>>().join(",");
    let set = format!("fire.burn_out_s={values}");
    let short = ["--set", "duration_s=5", "--set", &set];
    story.tell(&[&["batch", "smoke", "--seeds", "1", "--out", "a"], short.as_slice()].concat()).expect_code(0);
    let sentence = "No charts of states over time: they would need 130 panels; at most 120 are drawn.";
    let answer = story.tell(&["report", "a"]).expect_code(0).stdout;
    assert!(answer.split_whitespace().collect::<Vec<_>>().join(" ").contains(sentence), "{answer}");
    assert!(story.read("a/report.html").contains(sentence));
    let names = charts(&story, ".svg");
    assert!(names.contains(&"states-19".to_owned()), "seven variants on each of 19 sheets: {names:?}");
    assert!(!names.iter().any(|name| name.starts_with("over-time")), "{names:?}");
}

#[test]
fn means_are_those_of_the_table_of_runs() {
    let story = swept_batch();
    let page = report(&story);
    let rows = outcomes(&story.path("a/runs.csv"));
    let column = rows[0].iter().position(|name| name == "extinguished_ratio").expect("the column is there");
    for variant in rows[1..].chunks(5) {
        let ratios = variant.iter().map(|row| row[column].parse::<f64>().expect("a number"));
        let mean = ratios.sum::<f64>() / 5.0;
        assert!(page.contains(&format!("<td>{mean:.3}</td>")), "{mean}");
    }
}

#[test]
fn report_needs_no_journal_and_does_not_change() {
    let story = swept_batch();
    let page = report(&story);
    let chart = fs::read(story.path("a/charts/states.png")).expect("the picture is there");
    fs::remove_file(story.path("a/runs.journal")).expect("the journal is there");
    assert!(page == report(&story), "another page of the same batch");
    assert!(chart == fs::read(story.path("a/charts/states.png")).expect("the picture is there"));
}

#[test]
fn runs_without_result_are_told_with_their_commands_and_nothing_becomes_a_tag() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..4", "--out", "a"]).expect_code(0);
    let runs = story.read("a/runs.csv");
    let mut lines: Vec<String> = runs.lines().map(str::to_owned).collect();
    lines[3] = lines[3].replacen(",done,,", ",failed,<script>alert(1)</script>,", 1);
    story.file("a/runs.csv", &(lines.join("\n") + "\n"));
    let page = report(&story);
    assert!(page.contains("1 of 4 runs."), "{page}");
    let cells = "failed: &lt;script&gt;alert(1)&lt;/script&gt;</td><td class=\"text\">wildfire run smoke --seed 3</td>";
    assert!(page.contains(cells) && !page.contains("<script"), "{page}");
    assert!(page.contains("3 finished, 1 failed"), "{page}");
}

#[test]
fn batch_that_is_not_over_cannot_be_reported_on() {
    let story = swept_batch();
    refuse(&story, &["report", "nowhere"], &["plan.json"]);
    fs::remove_file(story.path("a/runs.csv")).expect("the table is there");
    refuse(&story, &["report", "a"], &["no table of runs yet", "wildfire batch --resume a"]);
    refuse(&story, &["report", "a", "--pages"], &["no table of runs yet"]);
}

#[test]
fn damaged_states_are_refused_and_missing_ones_left_out() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "a"]).expect_code(0);
    let path = story.path("a/states.parquet");
    let whole = fs::read(&path).expect("the file is there");
    for cut in [0, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..cut]).expect("the folder is writable");
        refuse(&story, &["report", "a"], &["cannot read a/states.parquet"]);
    }
    // A changed byte may be one of a number, but never ends the program.
    for at in (0..whole.len()).step_by(whole.len() / 12) {
        let mut changed = whole.clone();
        changed[at] ^= 0x55;
        fs::write(&path, &changed).expect("the folder is writable");
        let answer = story.tell(&["report", "a"]);
        assert!(matches!(answer.code, Some(0 | 2)), "byte {at}: {}", answer.stderr);
    }
    fs::remove_file(&path).expect("the file is there");
    assert!(!report(&story).contains("States over time"));
}

#[test]
fn report_goes_with_its_batch() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "1..3", "--out", "a"]).expect_code(0);
    report(&story);
    story.tell(&["batch", "smoke", "--seeds", "4..6", "--out", "a", "--force"]).expect_code(0);
    assert!(!story.path("a/report.html").exists() && charts(&story, ".svg").is_empty());
}
