//! `wildfire curve --pairs`: lengths and words of many pairs, from a table to a table.

use wildfire::geometry::Pose;
use wildfire::vehicle::{Dubins, ReedsShepp};

use crate::reference::{both, larger};
use crate::story::{Story, refuse};

const HEADER: &str = "x0,y0,th0,x1,y1,th1";

fn lengths(story: &Story, more: &[&str]) -> String {
    let answer = story.tell(&[&["curve", "--pairs", "pairs.csv", "--csv", "out.csv"], more].concat()).expect_code(0);
    assert!(answer.stdout.is_empty(), "{}", answer.stdout);
    story.read("out.csv")
}

#[test]
fn lengths_and_words_stand_after_what_was_there() {
    let story = Story::begin();
    // Columns in another order, spaces, quotes, a blank line, Windows line ends, a byte order mark.
    let text = "\u{feff}id,th1,\"x0\", y0,th0,x1,y1\r\n\"a,b\",1.5,0,0,0,20,15.25\r\n\r\nlast,-1,1e1,2,3,4,5";
    story.file("pairs.csv", text);
    let written = lengths(&story, &["--radius", "8"]);
    let lines: Vec<&str> = written.lines().collect();
    assert_eq!(lines[0], "id,th1,\"x0\", y0,th0,x1,y1,reeds_shepp_m,reeds_shepp_word,dubins_m,dubins_word");
    let poses = [
        ("\"a,b\",1.5,0,0,0,20,15.25", Pose::new(0.0, 0.0, 0.0), Pose::new(20.0, 15.25, 1.5)),
        ("last,-1,1e1,2,3,4,5", Pose::new(10.0, 2.0, 3.0), Pose::new(4.0, 5.0, -1.0)),
    ];
    assert_eq!(lines.len(), 1 + poses.len());
    for (line, (input, from, to)) in lines[1..].iter().zip(poses) {
        let best = ReedsShepp { radius_m: 8.0 }.shortest(from, to);
        let forward = Dubins { radius_m: 8.0 }.shortest(from, to);
        let added = line.strip_prefix(input).and_then(|rest| rest.strip_prefix(',')).expect("own columns come first");
        let added: Vec<&str> = added.split(',').collect();
        assert_eq!(added[0].parse(), Ok(best.length_m), "numbers read back exactly");
        assert_eq!(added[2].parse(), Ok(forward.length_m));
        let letters = best.driven_letters().map(|letter| letter.to_string()).collect::<String>();
        assert_eq!([added[1], added[3]], [letters, forward.word.to_string()]);
    }
}

/// The table of a spreadsheet, whatever is between its fields, has the same answers in its own notation.
#[test]
fn separators_and_decimal_commas_of_spreadsheets_are_read_and_kept() {
    let story = Story::begin();
    let table = "x0,y0,th0,x1,y1,th1,\n0,0,0,30,10.5,-2.25,\n1e1,0,0,2,3,0.5,kept\n";
    story.file("pairs.csv", table);
    let expected = lengths(&story, &[]);
    let semicolons = |table: &str| table.replace(',', ";").replace('.', ",");
    for (head, change) in [
        ("", &(|table: &str| table.replace(',', ";")) as &dyn Fn(&str) -> String),
        ("", &semicolons),
        ("\u{feff}sep=;\r\n", &semicolons),
        ("sep=\t\n", &|table| semicolons(table).replace(';', "\t")),
        ("", &|table| table.replace(',', "\t")),
    ] {
        story.file("pairs.csv", &format!("{head}{}", change(table)));
        assert_eq!(lengths(&story, &[]), change(&expected), "{head}");
    }
    story.file("pairs.csv", "x0;y0;th0;x1;y1;th1\n0;0;0;1.234,5;0;0\n");
    let refused = story.tell(&["curve", "--pairs", "pairs.csv", "--csv", "other.csv"]).expect_code(2);
    refused.expect_complaint(&["line 2, column x1: found \"1.234,5\", expected a number"]);
}

#[test]
fn table_without_rows_has_an_answer_without_rows() {
    let story = Story::begin();
    story.file("pairs.csv", HEADER);
    assert_eq!(lengths(&story, &[]), format!("{HEADER},reeds_shepp_m,reeds_shepp_word,dubins_m,dubins_word\n"));
}

#[test]
fn lengths_agree_with_independent_programs() {
    for path in both("reeds_shepp.csv").chain(larger("reeds_shepp_edge.csv")) {
        let name = path.display();
        let story = Story::begin();
        story.tell(&["curve", "--pairs", &path.to_string_lossy(), "--csv", "out.csv"]).expect_code(0);
        let mut reader = csv::Reader::from_path(story.path("out.csv")).expect("it was written");
        let header = reader.headers().expect("a header").clone();
        let column = |name: &str| header.iter().position(|found| found == name).expect("the column is there");
        let mut rows = 0;
        for row in reader.records().map(|row| row.expect("readable")) {
            rows += 1;
            let number = |name: &str| row[column(name)].parse::<f64>().expect("a number");
            for (ours, theirs) in [("reeds_shepp_m", "rs_len_ompl_2_0_1"), ("dubins_m", "dubins_len_ompl_2_0_1")] {
                assert!((number(ours) - number(theirs)).abs() < 1e-9, "{name}, row {rows}: {ours}");
            }
        }
        assert!(rows >= 20, "{name} has {rows} rows");
    }
}

#[test]
fn broken_tables_are_refused_with_line_and_column() {
    let story = Story::begin();
    let row = "\n1,2,3,4,5,6\n";
    for (text, fragment) in [
        (String::new(), "pairs.csv: the file is empty; expected a header with the columns x0,y0,th0,x1,y1,th1"),
        ("\n\n \n".to_owned(), "the file is empty"),
        ("1,2,3,4,5,6\n".to_owned(), "line 1: the column x0 is missing"),
        (format!("x0,y0,th0,x1,y1,{row}"), "line 1: the column th1 is missing; expected a header with"),
        (format!("{HEADER},y1{row}"), "line 1: the column y1 appears twice"),
        (format!("{HEADER},dubins_m{row}"), "line 1: the column dubins_m already exists"),
        (format!("{HEADER}{row}1,2,3,4,5\n"), "line 3: found 5 columns, expected 6"),
        (format!("{HEADER}{row}1,2,3,4,5,6,7\n"), "line 3: found 7 columns, expected 6"),
        (format!("{HEADER}{row}\n\r\n1,2,nan,4,5,6\n"), "line 5, column th0: found \"nan\", expected a number from"),
        (format!("{HEADER}{row}1,2,3,inf,5,6\n"), "line 3, column x1: found \"inf\""),
        (format!("{HEADER}{row}1,1000001,3,4,5,6\n"), "expected a number from -1000000 to 1000000"),
        (format!("{HEADER}{row}1,2,3,4,,6\n"), "line 3, column y1: found \"\""),
        (format!("{HEADER}{row}1,2,3,4,5,\u{1b}[2J\n"), "found \"\\u{1b}[2J\""),
        (format!("{HEADER}{row}{},2,3,4,5,6\n", "9".repeat(5000)), "999\", expected"),
        (format!("{HEADER}{row}{},2,3,4,5,6\n", "9".repeat(70_000)), "line 3: the line is longer than 65536 bytes"),
        (format!("{HEADER},note{row}1,2,3,4,5,6,\"open\n"), "line 2: found 6 columns, expected 7"),
        (format!("{HEADER}{row}\"1,2,3,4,5,6\n"), "line 3, column x0: found"),
    ] {
        story.file("pairs.csv", &text);
        refuse(&story, &["curve", "--pairs", "pairs.csv", "--csv", "out.csv"], &["pairs.csv: ", fragment]);
    }
}

#[test]
fn faults_do_not_replace_an_older_table() {
    let story = Story::begin();
    story.file("pairs.csv", "x0,y0,th0,x1,y1,th1\n1,2,3,4,5,6\n1,2,3,4,5,six\n");
    story.file("out.csv", "precious");
    refuse(&story, &["curve", "--pairs", "pairs.csv", "--csv", "out.csv"], &["line 3, column th1", "\"six\""]);
    assert_eq!(story.read("out.csv"), "precious");
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let story = Story::begin();
    story.file("pairs.csv", HEADER);
    refuse(&story, &["curve", "--pairs", "none.csv", "--csv", "out.csv"], &["none.csv: cannot be read"]);
    refuse(&story, &["curve", "--pairs", ".", "--csv", "out.csv"], &[".: cannot be read"]);
    refuse(&story, &["curve", "--pairs", "pairs.csv", "--csv", "./pairs.csv"], &["two files"]);
    refuse(&story, &["curve", "--pairs", "pairs.csv", "--csv", "nowhere/out.csv"], &["nowhere/out.csv"]);
}
