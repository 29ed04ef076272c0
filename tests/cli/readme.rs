//! What the README and the guide say is so: their commands run, they show what the program prints and draws, and their
//! links lead somewhere.
//!
//! | block of a page | what is done with it |
//! |---|---|
//! | `sh` | lines that begin with `wildfire`, or with `cargo run --release --`, are run in a folder of the page's own |
//! | `text` | must be what the last command before it printed; `...` as its last line stands for the rest |
//! | `text times` | the same, but numbers are not compared |
//! | `sh measured`, `text measured` | is not run; its section says when and at which commit it was measured |
//! | `toml my.toml`, or another name of a file | is the content of that file |
//!
//! CPU times in a `text` block are not compared, see [`comparable`]. `WILDFIRE_REWRITE_DOCS=1 cargo test --test cli readme`
//! writes all answers and pictures that are not what the program gives into the pages.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use wildfire::batch::decisions::DECISION_COLUMNS;
use wildfire::batch::drives::DRIVE_COLUMNS;
use wildfire::batch::table::{AGENT_COLUMNS, CALL_COLUMNS, Column, RUN_COLUMNS, STATE_COLUMNS};
use wildfire::picture::film::{BINDINGS, Layer};
use wildfire::scenario::BUILT_IN;

use crate::children::{self, output_of};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// The README, the chapters of the guide, and the papers and generated pages below it.
fn pages() -> Vec<String> {
    let mut pages = vec!["README.md".to_owned()];
    for folder in ["docs", "docs/paper", "docs/reference"] {
        let files = fs::read_dir(root().join(folder)).expect("the guide is there");
        let names = files.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
        pages.extend(names.filter(|name| name.ends_with(".md")).map(|name| format!("{folder}/{name}")));
    }
    pages.sort();
    pages
}

/// Whether the pages are to be written again where they differ.
fn rewriting() -> bool {
    std::env::var_os("WILDFIRE_REWRITE_DOCS").is_some_and(|value| value == "1")
}

/// A fenced block: the words after its fence, the lines between, and where these begin on the page, from 0.
struct Block {
    tags: Vec<String>,
    lines: Vec<String>,
    first_line: usize,
}

impl Block {
    fn is(&self, tags: &[&str]) -> bool {
        self.tags.iter().map(String::as_str).eq(tags.iter().copied())
    }

    fn is_measured(&self) -> bool {
        self.tags.get(1).is_some_and(|word| word == "measured")
    }

    /// The commands of the program, without the backslashes that join lines.
    fn commands(&self) -> Vec<String> {
        let joined = self.lines.join("\n").replace("\\\n", " ");
        let lines = joined.lines().map(|line| line.replacen("cargo run --release -- ", "wildfire ", 1));
        lines.filter(|line| line.starts_with("wildfire ")).collect()
    }
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut inside = false;
    for (number, line) in text.lines().enumerate() {
        match line.strip_prefix("```") {
            Some(_) if inside => inside = false,
            Some(info) => {
                let tags = info.split_whitespace().map(str::to_owned).collect();
                blocks.push(Block { tags, lines: Vec::new(), first_line: number + 1 });
                inside = true;
            }
            None if inside => blocks.last_mut().expect("inside a block").lines.push(line.to_owned()),
            None => {}
        }
    }
    blocks
}

/// A text without what may differ between two runs of the program: widths of columns, which follow from their
/// contents, and numbers that are CPU times.
///
/// Of a line that begins with the name of a `cpu_` column only the name is kept: whether CPU times differ, and by which
/// test, may change from run to run too. Other CPU times are in lines that speak of CPU; in all of a paragraph that
/// speaks of CPU in its first two lines; and in the table below such a paragraph if that is only a title. With
/// `all_numbers` no number is kept.
fn comparable(text: &str, all_numbers: bool) -> Vec<String> {
    let mut lines = Vec::new();
    let mut under_title = false;
    for paragraph in text.split("\n\n") {
        let titled = paragraph.lines().take(2).any(|line| line.contains("CPU"));
        let is_title = titled && paragraph.lines().count() <= 2;
        // A sentence goes on in lines that are indented; where it is broken depends on its numbers.
        for line in paragraph.replace("\n  ", " ").lines() {
            let masked = all_numbers || titled || under_title || line.contains("CPU");
            lines.push(match line.split([' ', ':']).next() {
                Some(column) if column.starts_with("cpu_") => column.to_owned(),
                _ if masked => without_numbers(line),
                _ => line.to_owned(),
            });
        }
        under_title = is_title;
        lines.push(String::new());
    }
    lines.iter().map(|line| narrowed(line)).collect()
}

fn without_numbers(line: &str) -> String {
    let mut kept = String::new();
    for letter in line.chars() {
        match letter {
            '0'..='9' if kept.ends_with('#') => {}
            '.' | ',' if kept.ends_with('#') => {}
            '0'..='9' => kept.push('#'),
            other => kept.push(other),
        }
    }
    kept
}

/// A line with single spaces, and with single dashes for rules under the heads of tables.
fn narrowed(line: &str) -> String {
    let cells = line.split_whitespace().map(|word| if word.chars().all(|letter| letter == '-') { "-" } else { word });
    cells.collect::<Vec<_>>().join(" ")
}

/// Runs a line of a page as a shell would, and returns what it prints.
fn run(command: &str, folder: &Path) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_wildfire"));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let program_first = std::iter::once(program.parent().expect("in a folder").to_owned());
    let path = std::env::join_paths(program_first.chain(std::env::split_paths(&path))).expect("a search path");
    let mut shell = children::command("sh");
    shell.args(["-c", command]).current_dir(folder).env("PATH", path);
    let output = output_of(&mut shell);
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "`{command}` failed\nstdout:\n{stdout}\nstderr:\n{stderr}");
    stdout.into_owned()
}

/// A folder with the example maps, where commands of a page are run.
fn folder_of_a_page() -> TempDir {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let maps = folder.path().join("assets/maps");
    fs::create_dir_all(&maps).expect("writable");
    fs::create_dir(folder.path().join("assets/pictures")).expect("writable");
    for entry in fs::read_dir(root().join("assets/maps")).expect("the maps are there") {
        let from = entry.expect("readable").path();
        fs::copy(&from, maps.join(from.file_name().expect("a file has a name"))).expect("writable");
    }
    folder
}

/// Runs the commands of a page and compares what they print and draw with what it shows.
fn hold(page: &str, largest_picture: usize) {
    let text = read(page);
    let folder = folder_of_a_page();
    let mut answer = None;
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut different = Vec::new();
    // From the last block to the first, so that the numbers of lines before it stay true.
    let mut replacements = Vec::new();
    for block in blocks(&text) {
        if block.is(&["sh"]) {
            answer = None;
            for command in block.commands() {
                answer = Some(run(&command, folder.path()));
            }
        } else if block.is(&["text"]) || block.is(&["text", "times"]) {
            let answer: &String = answer
                .as_ref()
                .unwrap_or_else(|| panic!("{page}:{}: no command before this block prints anything", block.first_line));
            let mut wanted: Vec<String> = answer.trim_end().lines().map(str::to_owned).collect();
            if block.lines.last().is_some_and(|line| line == "...") {
                wanted.truncate(block.lines.len() - 1);
                wanted.push("...".to_owned());
            }
            let times = block.is(&["text", "times"]);
            if comparable(&block.lines.join("\n"), times) != comparable(&wanted.join("\n"), times) {
                different.push(format!("{page}:{}: the program prints\n{}", block.first_line, wanted.join("\n")));
                replacements.push((block, wanted));
            }
        } else if let Some(name) = block.tags.get(1).filter(|name| name.contains('.')) {
            let file = folder.path().join(name);
            fs::create_dir_all(file.parent().expect("it is below the folder")).expect("writable");
            fs::write(file, block.lines.join("\n") + "\n").expect("writable");
        }
    }
    for (block, wanted) in replacements.into_iter().rev() {
        lines.splice(block.first_line..block.first_line + block.lines.len(), wanted);
    }
    for entry in fs::read_dir(folder.path().join("assets/pictures")).expect("it is there") {
        let drawn = entry.expect("readable").path();
        let name = Path::new("assets/pictures").join(drawn.file_name().expect("a file has a name"));
        let picture = fs::read(&drawn).expect("readable");
        assert!(picture.len() < largest_picture, "{} has {} bytes", name.display(), picture.len());
        if fs::read(root().join(&name)).ok().as_ref() != Some(&picture) {
            different.push(format!("{page}: {} is not what its command draws", name.display()));
            if rewriting() {
                fs::write(root().join(&name), picture).expect("the pictures can be written");
            }
        }
    }
    if rewriting() {
        fs::write(root().join(page), lines.join("\n") + "\n").expect("the page can be written");
    } else {
        let how =
            "`WILDFIRE_REWRITE_DOCS=1 cargo test --test cli readme` writes what the program says now into the pages";
        assert!(different.is_empty(), "{}\n\n{how}", different.join("\n\n"));
    }
}

/// A test for each page, so that they are held at the same time.
macro_rules! hold {
    ($($test:ident: $page:literal, pictures below $bytes:literal;)*) => {
        $(
            #[cfg(unix)]
            #[test]
            fn $test() {
                hold($page, $bytes);
            }
        )*

        #[test]
        fn every_page_is_held() {
            let mut listed = vec![$($page.to_owned()),*];
            listed.sort();
            assert_eq!(listed, pages());
        }
    };
}

hold! {
    readme: "README.md", pictures below 0;
    overview: "docs/README.md", pictures below 0;
    arena: "docs/arena.md", pictures below 0;
    assignment: "docs/assignment.md", pictures below 0;
    batches: "docs/batches.md", pictures below 0;
    command_line: "docs/command-line.md", pictures below 0;
    compare_and_report: "docs/compare-and-report.md", pictures below 0;
    decisions: "docs/decisions.md", pictures below 40_000;
    fire: "docs/fire.md", pictures below 0;
    fire_behavior: "docs/fire-behavior.md", pictures below 0;
    fire_spread: "docs/fire-spread.md", pictures below 300_000;
    grid_maps: "docs/grid-maps.md", pictures below 100_000;
    installing: "docs/installing.md", pictures below 0;
    instructors: "docs/instructors.md", pictures below 0;
    learners: "docs/learners.md", pictures below 0;
    output_files: "docs/output-files.md", pictures below 0;
    own_planner: "docs/own-planner.md", pictures below 0;
    planner_authors: "docs/planner-authors.md", pictures below 0;
    planning_drives: "docs/planning-drives.md", pictures below 100_000;
    policies: "docs/policies.md", pictures below 0;
    python: "docs/python.md", pictures below 0;
    scenarios: "docs/scenarios.md", pictures below 0;
    students: "docs/students.md", pictures below 0;
    watch: "docs/watch.md", pictures below 3_000_000;
    your_assignment: "docs/your-assignment.md", pictures below 100_000;
    paper: "docs/paper/paper.md", pictures below 40_000;
    lists: "docs/paper/lists.md", pictures below 0;
    study: "docs/paper/study.md", pictures below 400_000;
    columns: "docs/reference/columns.md", pictures below 0;
}

#[test]
fn readme_can_be_read_in_one_sitting() {
    let lines = read("README.md").lines().count();
    assert!(lines <= 130, "the README has {lines} lines");
}

#[test]
fn blocks_are_of_a_kind_that_is_known() {
    for page in pages() {
        let text = read(&page);
        for block in blocks(&text) {
            let place = format!("{page}:{}", block.first_line);
            let tags: Vec<_> = block.tags.iter().map(String::as_str).collect();
            assert!(
                matches!(tags.as_slice(), ["sh" | "text"] | ["sh" | "text", "measured"] | ["text", "times"] | ["sql"])
                    || tags.len() <= 2
                        && [
                            "toml", "csv", "json", "yaml", "ini", "groovy", "python", "pycon", "rust", "shell",
                            "console"
                        ]
                        .contains(&tags[0]),
                "{place}: {tags:?}"
            );
            if block.is_measured() {
                let before = text.lines().take(block.first_line).collect::<Vec<_>>().join(" ");
                let section = &before[before.rfind(" ## ").unwrap_or(0)..];
                let after = text.lines().skip(block.first_line).take(12).collect::<Vec<_>>().join(" ");
                assert!(says_when(section) || says_when(&after), "{place}: when and at which commit was it measured?");
            }
        }
    }
}

/// Whether a text says "measured on 2026-11-21 at commit 2d4aafe" somewhere.
fn says_when(text: &str) -> bool {
    let text = text.to_lowercase();
    text.match_indices("measured on ").any(|(at, phrase)| {
        let (date, rest) = text[at + phrase.len()..].split_once(' ').unwrap_or_default();
        let commit: String = rest.strip_prefix("at commit ").unwrap_or_default().chars().take(7).collect();
        date.len() == 10
            && date.chars().all(|letter| letter.is_ascii_digit() || letter == '-')
            && commit.len() == 7
            && commit.chars().all(|letter| letter.is_ascii_hexdigit())
    })
}

/// What links name: `](target)`, outside of blocks.
fn links(text: &str) -> Vec<&str> {
    let mut inside = false;
    let mut links = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = !inside;
        } else if !inside {
            links.extend(line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target));
        }
    }
    links
}

/// The anchors of a page's headings, as they are made from the text.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let kept = |letter: &char| letter.is_alphanumeric() || " -_".contains(*letter);
    headings
        .map(|line| line.trim_start_matches('#').trim().to_lowercase())
        .map(|heading| heading.chars().filter(kept).collect::<String>().replace(' ', "-"))
        .collect()
}

#[test]
fn links_lead_to_files_and_headings_that_exist() {
    let others = ["ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "scenarios/README.md"];
    let others = others.iter().chain(&["assets/maps/README.md", "runs/README.md"]).map(|page| (*page).to_owned());
    let mut broken = Vec::new();
    for page in pages().into_iter().chain(others) {
        let text = read(&page);
        for link in links(&text).into_iter().filter(|link| !link.starts_with("https://")) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if file.is_empty() { PathBuf::from(&page) } else { Path::new(&page).with_file_name("").join(file) };
            let found = root().join(&target).exists();
            let leads = found && (anchor.is_empty() || anchors(&read(&target.to_string_lossy())).contains(anchor));
            if !leads {
                broken.push(format!("{page}: {link}"));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere: {broken:#?}");
}

#[test]
fn files_that_are_named_exist() {
    let mut missing = Vec::new();
    for page in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = read(page);
        let named = text.split('`').skip(1).step_by(2);
        let files = named.filter(|name| {
            ["crates/", "src/", "tests/", "docs/", "examples/"].iter().any(|root| name.starts_with(root))
        });
        // In recipes NAME is what the reader calls it.
        let gone = files.filter(|name| !name.contains("NAME") && !root().join(name).exists());
        missing.extend(gone.map(|name| format!("{page}: {name}")));
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn pictures_are_drawn_by_commands_that_the_pages_show() {
    let texts: Vec<String> = pages().iter().map(|page| read(page)).collect();
    let shown: BTreeSet<&str> =
        texts.iter().flat_map(|text| links(text)).filter_map(|link| link.split("assets/pictures/").nth(1)).collect();
    let commands: Vec<_> = texts.iter().flat_map(|text| blocks(text)).flat_map(|block| block.commands()).collect();
    let drawn = |name: &&str| commands.iter().any(|command| command.contains(&format!("assets/pictures/{name}")));
    let others: Vec<_> = shown.iter().copied().filter(|name| !drawn(name)).collect();
    // Planners of another library, a drawing of the parts of the program, areas of fires in a test, charts of a report on
    // thousands of runs, measured times, a study that one script makes, and a browser with the page of a run.
    let expected = [
        "against-ompl.svg",
        "architecture.svg",
        "contain.svg",
        "distributions.png",
        "figure-cpu-sums.svg",
        "page.png",
        "states-over-time.png",
        "study-1.svg",
        "study-2.svg",
        "study-3.svg",
        "study-4.svg",
        "study-5.svg",
        "study-6.svg",
        "sweep.png",
    ];
    assert_eq!(others, expected);
    let stored = fs::read_dir(root().join("assets/pictures")).expect("the pictures are there");
    let stored = stored.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
    assert_eq!(stored.collect::<BTreeSet<_>>(), shown.iter().map(|name| (*name).to_owned()).collect());
}

#[test]
fn every_figure_of_an_assignment_has_a_picture_of_a_command_on_its_page() {
    let page = read("docs/your-assignment.md");
    let commands: Vec<String> = blocks(&page).iter().flat_map(|block| block.lines.clone()).collect();
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| ") && line.contains("](")).collect();
    assert!(rows.len() >= 40, "{} rows", rows.len());
    for row in rows {
        let picture = links(row).into_iter().find_map(|link| link.strip_prefix("../")).expect("a picture");
        assert!(commands.iter().any(|command| command.contains(picture)), "{row}");
    }
}

/// The rows of a table of columns.
fn rows_of<F>(columns: &[Column<F>]) -> String {
    let row =
        |column: &Column<F>| format!("| `{}` | {} | {} |\n", column.name, column.unit.symbol(), column.description);
    columns.iter().map(row).collect()
}

#[test]
fn page_of_columns_is_what_the_tables_have() {
    const PAGE: &str = "docs/reference/columns.md";
    let tables = [
        ("runs.csv, runs.parquet", rows_of(RUN_COLUMNS)),
        ("agents.csv", rows_of(AGENT_COLUMNS)),
        ("planner_calls.parquet", rows_of(CALL_COLUMNS)),
        ("states.parquet", rows_of(STATE_COLUMNS)),
        ("decisions.parquet", rows_of(DECISION_COLUMNS)),
        ("Queries of `wildfire plan` and `judge`", rows_of(DRIVE_COLUMNS)),
    ];
    let page = read(PAGE);
    let (opening, _) = page.split_once("\n## ").expect("an opening before the tables");
    let sections = tables
        .iter()
        .map(|(title, rows)| format!("\n## {title}\n\n| column | unit | meaning |\n|---|---|---|\n{rows}"));
    let expected = format!("{opening}{}", sections.collect::<String>());
    if rewriting() {
        fs::write(root().join(PAGE), expected).expect("the page can be written");
    } else {
        assert_eq!(page, expected, "`WILDFIRE_REWRITE_DOCS=1 cargo test --test cli readme` writes the page");
    }
}

#[test]
fn every_built_in_scenario_is_named() {
    let page = read("docs/scenarios.md");
    let missing: Vec<_> = BUILT_IN.iter().filter(|(name, _)| !page.contains(&format!("`{name}`"))).collect();
    assert!(missing.is_empty(), "the guide does not name {missing:?}");
}

#[test]
fn citation_names_this_version() {
    let citation = include_str!("../../CITATION.cff");
    assert!(citation.contains(concat!("\nversion: ", env!("CARGO_PKG_VERSION"), "\n")));
}

#[test]
fn every_key_and_layer_is_explained() {
    let page = read("docs/watch.md");
    let keys = BINDINGS.iter().map(|binding| format!("| `{}` | {} |", binding.keys, binding.does));
    let layers = Layer::ALL.into_iter().map(|layer| format!("| `{}` | `{}` |", layer.name(), layer.key()));
    let missing: Vec<_> = keys.chain(layers).filter(|row| !page.contains(row)).collect();
    assert!(missing.is_empty(), "the guide does not have the rows {missing:?}");
}

#[test]
fn whether_cpu_times_differ_is_left_to_the_run() {
    let page = "cpu_unimog_total_s: with B the planners use 5.2 ms less CPU per run, 95 %\n  interval 4.2 to 6.3";
    let run = "cpu_unimog_total_s: no evidence of a difference (95 % interval for B − A: −1.2 to 0.4)";
    assert_eq!(comparable(page, false), comparable(run, false));
    let page = "cpu_query_s <0.001 Student's t -0.72 <0.001 -0.78";
    assert_eq!(comparable(page, false), comparable("cpu_query_s 0.002   bootstrap -0.27  -", false));
    assert_ne!(comparable("cpu_run_s 1.0 -", false), comparable("cpu_query_s 1.0 -", false));
    assert_ne!(comparable("saved 0.002 bootstrap", false), comparable("saved 0.002 McNemar", false));
}
