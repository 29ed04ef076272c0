//! What counts as equal: integers exactly, other numbers to 1e-9 of their size.

use std::fmt::{Display, Formatter, Result, Write};

use serde_json::Value;
use sha2::{Digest, Sha256};
use wildfire::grid::Grid;

use super::answers::Answer;

/// How many files were compared.
#[derive(Default)]
pub struct Tally {
    pub compared: usize,
    /// Answers about a goal in an obstacle, which was refused as it should be.
    pub refused: usize,
    /// Files that are not for reproduction.
    pub excepted: usize,
}

impl Display for Tally {
    fn fmt(&self, f: &mut Formatter) -> Result {
        let Self { compared, refused, excepted } = self;
        write!(f, "{compared} files equal, {refused} whose goal is refused, {excepted} not for reproduction")
    }
}

pub fn is_close(found: f64, expected: f64) -> bool {
    found == expected || (found - expected).abs() <= 1e-9 * expected.abs().max(found.abs())
}

/// Compares an answer with the content of a file and with what the case's facts say of it.
pub fn with_file(place: &str, answer: &Answer, text: &str, facts: &Value) {
    match answer {
        Answer::Integers(values) => {
            assert_integers(place, values, text);
            let computed = csv(values);
            assert!(computed == text, "{place}: the values agree, the text does not");
            assert_eq!(facts["sha256"], hex_sha256(&computed), "{place}");
            assert_sums(place, &values.values().iter().map(|&value| f64::from(value)).collect::<Vec<_>>(), facts);
        }
        Answer::Reals(values) => {
            assert_reals(place, values, text);
            assert_sums(place, values.values(), facts);
        }
        Answer::Path(path) => {
            let lines: String = path.iter().fold(String::new(), |mut lines, (row, col)| {
                writeln!(lines, "{row},{col}").expect("text grows");
                lines
            });
            assert!(lines == text, "{place}: found\n{lines}expected\n{text}");
        }
        Answer::Refused => unreachable!("a refusal has no values"),
    }
}

fn hex_sha256(text: &str) -> String {
    Sha256::digest(text).iter().fold(String::new(), |mut hex, byte| {
        write!(hex, "{byte:02x}").expect("text grows");
        hex
    })
}

fn csv(values: &Grid<u32>) -> String {
    let mut text = String::new();
    for row in 0..values.rows() {
        for (col, value) in values.row(row).iter().enumerate() {
            let comma = if col > 0 { "," } else { "" };
            write!(text, "{comma}{value}").expect("text grows");
        }
        text.push('\n');
    }
    text
}

fn assert_integers(place: &str, values: &Grid<u32>, text: &str) {
    assert_fields(place, values, text, |found, expected| Ok(*found) == expected.parse());
}

fn assert_reals(place: &str, values: &Grid<f64>, text: &str) {
    assert_fields(place, values, text, |&found, expected| {
        expected.parse().is_ok_and(|expected| is_close(found, expected))
    });
}

fn assert_fields<T: Display>(place: &str, values: &Grid<T>, text: &str, is_equal: impl Fn(&T, &str) -> bool) {
    assert_eq!(text.lines().count(), values.rows(), "{place}: rows");
    for (row, line) in text.lines().enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), values.cols(), "{place}: columns of row {row}");
        for (col, (found, expected)) in values.row(row).iter().zip(fields).enumerate() {
            assert!(is_equal(found, expected), "{place}: row {row}, column {col}: {found}, not {expected}");
        }
    }
}

fn assert_sums(place: &str, values: &[f64], facts: &Value) {
    let expected = |name: &str| facts[name].as_f64().unwrap_or_else(|| panic!("{place}: no {name} among the facts"));
    assert!(is_close(values.iter().sum(), expected("sum")), "{place}: sum");
    assert!(is_close(values.iter().copied().fold(0.0, f64::max), expected("max")), "{place}: maximum");
    assert_eq!(values.iter().filter(|&&value| value == 0.0).count() as f64, expected("zeros"), "{place}: zeros");
}
