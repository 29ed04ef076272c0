//! Names that mean something to a terminal, a reader's eye or a spreadsheet.

use std::fs::File;

use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::story::{Answer, Story, refuse};

/// Clears the screen, rings, and turns the direction of what follows.
const HOSTILE: &str = "a\u{1b}[2Jb\u{7}c\u{9b}1md\u{202e}e\u{2066}f\u{200f}g\u{2028}h";

/// A name that a scenario may have: controls are refused there, marks of direction are not.
const TURNED: &str = "a\u{202e}b\u{2069}c";

const SMALL: &str = "duration_s = 20\n[[wumpus]]\n[[unimog]]\n";

/// Says whether nothing in a text acts on a terminal; the program itself uses line ends only.
fn is_harmless(text: &str) -> bool {
    let acts = |letter: char| {
        let code = u32::from(letter);
        (code < 0x20 && letter != '\n')
            || (0x7f..=0x9f).contains(&code)
            || [0x61c, 0x200e, 0x200f].contains(&code)
            || (0x2028..=0x202e).contains(&code)
            || (0x2066..=0x2069).contains(&code)
    };
    !text.chars().any(acts)
}

fn expect_harmless(answer: &Answer, arguments: &[&str]) {
    assert!(is_harmless(&answer.stdout), "{arguments:?} prints {:?}", answer.stdout);
    assert!(is_harmless(&answer.stderr), "{arguments:?} prints {:?}", answer.stderr);
}

fn named(name: &str) -> String {
    format!("name = \"{name}\"\n{SMALL}")
}

#[test]
fn what_a_user_writes_cannot_act_on_the_terminal() {
    let story = Story::begin();
    let hostile = |ending: &str| format!("{HOSTILE}{ending}");
    let [scenario, broken, map, recording, folder] =
        [".toml", "-broken.toml", ".txt", ".wildfire", "-batch"].map(hostile);
    story.file(&scenario, &named(TURNED));
    story.file(&broken, &format!("# {HOSTILE}\nduration_s = \"{}\"\n", HOSTILE.replace('\u{1b}', "\\u001b")));
    story.file(&map, "000\n010\n000\n");
    let (set, path_set) = (format!("fire.burn_out_s={HOSTILE}"), format!("{HOSTILE}=1"));
    let commands: [&[&str]; 25] = [
        &["run", HOSTILE],
        &["run", &broken],
        &["check", &broken],
        &["check", &scenario],
        &["run", &scenario, "--out", &recording, "--events", HOSTILE],
        &["run", &scenario, "--json"],
        &["run", "--set", &set],
        &["run", "--set", &path_set],
        &["run", "--seed", HOSTILE],
        &[HOSTILE],
        &["audit", &recording],
        &["audit", &map],
        &["audit", HOSTILE],
        &["batch", &scenario, "--seeds", "1..2", "--out", &folder],
        &["batch", &scenario, "--seeds", "1..2", "--dry-run"],
        &["batch", &scenario, "--out", &folder],
        &["status", &folder],
        &["report", &folder],
        &["merge", &folder],
        &["compare", &folder, &folder],
        &["compare", &folder, "--by", HOSTILE],
        &["map", "occupancy", &map],
        &["map", "occupancy", &map, "--csv", HOSTILE, "--json"],
        &["map", "occupancy", &broken],
        &["render", &recording, "-o", "still.png", "--size", "320x240"],
    ];
    let mut naming = 0;
    for arguments in commands {
        let answer = story.tell(arguments);
        expect_harmless(&answer, arguments);
        let all = format!("{}{}", answer.stdout, answer.stderr);
        let is_naming = ["\\u202e", "\\u001b", "\\u{1b}"].iter().any(|escape| all.contains(escape));
        assert!(is_naming || answer.code == Some(0), "{arguments:?} fails without a name:\n{all}");
        naming += u32::from(is_naming);
    }
    assert!(naming >= 20, "{naming} commands print names");
}

#[test]
fn escapes_in_json_are_those_of_json() {
    let story = Story::begin();
    story.file("s.toml", &named(TURNED));
    let answer = story.tell(&["run", "s.toml", "--json"]).expect_code(0).stdout;
    let object: serde_json::Value = serde_json::from_str(&answer).expect("it is JSON");
    assert_eq!(object["run"]["scenario"], TURNED);
    assert!(answer.contains("a\\u202eb\\u2069c"), "{answer}");
}

#[test]
fn the_place_of_a_fault_is_that_in_the_file() {
    let story = Story::begin();
    story.file(
        "s.toml",
        &format!("# \u{2066}\nname = \"{TURNED}\"\nwumpus = [] # \u{202e}\nfire = {{ relight = 3 }}\n"),
    );
    refuse(&story, &["check", "s.toml"], &["s.toml:4:20", "fire = { relight = 3 }"]);
}

#[test]
fn pages_do_not_turn_the_direction_of_writing() {
    let story = Story::begin();
    story.file("s.toml", &named(TURNED));
    let arguments = ["batch", "s.toml", "--seeds", "1..3", "--set", "field.coverage=0.05,0.1", "--out", "a"];
    story.tell(&arguments).expect_code(0);
    story.tell(&["report", "a"]).expect_code(0);
    for page in ["a/report.html", "a/tables.md"] {
        let page = story.read(page);
        assert!(is_harmless(&page) && page.contains("u202eb") && page.contains("u2069c"), "{page}");
    }
    for form in ["--html", "--md"] {
        let page = story.tell(&["compare", "a", "--by", "field.coverage", form]).expect_code(0).stdout;
        assert!(is_harmless(&page) && page.contains("u202eb"), "{page}");
    }
}

/// The cells of a column, the first row being names.
fn column(text: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let place = reader.headers().expect("a header").iter().position(|column| column == name).expect("the column");
    reader.records().map(|record| record.expect("a row")[place].to_owned()).collect()
}

#[test]
fn a_name_that_is_a_formula_is_text_in_csv_files_and_itself_everywhere_else() {
    for (number, name) in ["=1+1", "+1", "-cmd", "@SUM(A1)", "'=x", "-5"].into_iter().enumerate() {
        let (story, folder) = (Story::begin(), number.to_string());
        story.file("s.toml", &named(name));
        let arguments = ["batch", "s.toml", "--seeds", "1..3", "--out", &folder, "--record", "all"];
        story.tell(&arguments).expect_code(0);
        let runs = story.read(&format!("{folder}/runs.csv"));
        let cell = if ["+1", "-5"].contains(&name) { name.to_owned() } else { format!("'{name}") };
        assert_eq!(column(&runs, "scenario"), [cell.as_str(); 3]);
        assert_eq!(column(&story.read(&format!("{folder}/agents.csv")), "scenario"), [cell.as_str(); 6]);

        let parquet = File::open(story.path(&format!("{folder}/runs.parquet"))).expect("it is there");
        let parquet = SerializedFileReader::new(parquet).expect("it is Parquet");
        for row in parquet.get_row_iter(None).expect("readable") {
            let scenario = row.expect("readable").get_column_iter().next().expect("a column").1.to_string();
            assert_eq!(scenario, format!("{name:?}"));
        }

        // The rows still go with their runs, by the true name.
        story.tell(&["audit", &folder]).expect_code(0);
        story.tell(&["report", &folder]).expect_code(0);
        let condition = format!("scenario={name}");
        let compared = ["compare", &folder, "--by", "seed", "--where", &condition];
        assert!(!story.tell(&compared).stderr.contains(&format!("'{name}")), "{name}");
        let both = story.tell(&["compare", &folder, &folder]).expect_code(0).stdout;
        assert!(both.contains(&format!("scenario {name}")), "{both}");

        // Resuming writes the same bytes from the journal.
        std::fs::remove_file(story.path(&format!("{folder}/runs.csv"))).expect("it was there");
        story.tell(&["batch", "--resume", &folder]).expect_code(0);
        assert_eq!(story.read(&format!("{folder}/runs.csv")), runs);
    }
}

#[test]
fn a_planned_field_that_is_called_like_a_formula_is_text_in_tables_and_itself_in_json() {
    let story = Story::begin();
    story.file("s.toml", &named("=1+1"));
    let arguments =
        ["plan", "--scenario", "s.toml", "--goals", "2", "--csv", "rows.csv", "--paths", "paths.csv", "--json"];
    let answer = story.tell(&arguments).expect_code(0).stdout;
    assert_eq!(column(&story.read("rows.csv"), "field"), ["'=1+1"; 2]);
    assert!(column(&story.read("paths.csv"), "field").iter().all(|field| field == "'=1+1"));
    assert!(answer.contains("\"=1+1\"") && !answer.contains("'=1+1"), "{answer}");
}
