//! Designs of experiments: CSV files with a column for each key and a row for each variant, as samplers write them.

use std::io;
use std::path::Path;

use thiserror::Error;

use super::sweep::SweepError;
use super::{MAX_VARIANTS, Setting, Sweep};
use wildfire_base::input_file;

/// The most bytes of a design.
const MAX_BYTES: u64 = 16_000_000;

/// A reason for which a file is no design.
#[derive(Debug, Error)]
pub enum DesignError {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("line {line}: {problem}")]
    Line { line: u64, problem: String },
    #[error("there are no rows; expected a row of keys, such as field.coverage, and a row of values for each variant")]
    NoRows,
    #[error("there are over {MAX_VARIANTS} rows; a batch takes at most that many variants")]
    TooManyRows,
    #[error(transparent)]
    Values(#[from] SweepError),
}

/// Reads a design as a sweep whose keys take their values together, row by row.
///
/// # Errors
/// If the file cannot be read, if a column has no name, or if a row has too few or too many values.
pub fn read_design(path: &Path) -> Result<Sweep, DesignError> {
    let text = input_file::read_text(path, MAX_BYTES)?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let names = reader.headers().map_err(damaged)?.clone();
    // The nameless first column that pandas writes is its row index, and no key.
    if let Some(nameless) = names.iter().position(str::is_empty) {
        let problem = format!(
            "column {} has no name; expected a key of the scenario (pandas writes no such column with index=False)",
            nameless + 1
        );
        return Err(DesignError::Line { line: 1, problem });
    }
    // A spreadsheet with a comma as its decimal sign divides columns by semicolons; the whole line would be one key.
    if names.len() == 1 && names[0].contains([';', '\t']) {
        let problem = "the columns are divided by semicolons or tabs; expected commas".to_owned();
        return Err(DesignError::Line { line: 1, problem });
    }
    let mut columns: Vec<_> = names.iter().map(|name| (name.to_owned(), Vec::new())).collect();
    for row in reader.records() {
        let row = row.map_err(damaged)?;
        for ((key, settings), value) in columns.iter_mut().zip(&row) {
            // An empty value has no meaning that all readers share: default, missing or zero.
            if value.is_empty() {
                let line = row.position().map_or(1, csv::Position::line);
                return Err(DesignError::Line { line, problem: format!("there is no value of `{key}`") });
            }
            settings.push(Setting::parse(value));
        }
        // The limit is checked while reading, as a design may be longer than any plan.
        if columns[0].1.len() as u64 > MAX_VARIANTS {
            return Err(DesignError::TooManyRows);
        }
    }
    match columns.first() {
        Some((_, settings)) if !settings.is_empty() => Ok(Sweep::together(columns)?),
        _ => Err(DesignError::NoRows),
    }
}

fn damaged(error: csv::Error) -> DesignError {
    let line = error.position().map_or(1, csv::Position::line);
    let problem = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("expected {expected_len} values between commas, one for each key, and found {len}")
        }
        _ => error.to_string(),
    };
    DesignError::Line { line, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Sweep, String> {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("design.csv");
        std::fs::write(&path, text).expect("writable");
        read_design(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn a_design_is_a_sweep_of_keys_that_go_together() {
        let text = "\u{feff}field.coverage, unimog.planner\r\n0.05,prm-rs\r\n# a comment\r\n0.1,\"hybrid-astar\"\r\n";
        let columns = vec![
            ("field.coverage".to_owned(), ["0.05", "0.1"].map(Setting::parse).to_vec()),
            ("unimog.planner".to_owned(), ["prm-rs", "hybrid-astar"].map(Setting::parse).to_vec()),
        ];
        assert_eq!(read(text), Ok(Sweep::together(columns).expect("two rows")));
    }

    #[test]
    fn what_is_no_design_is_refused_with_its_line() {
        let refused = [
            ("", "there are no rows"),
            ("a,b\n", "there are no rows"),
            (",a\n0,1\n", "line 1: column 1 has no name"),
            ("a;b\n0;1\n", "line 1: the columns are divided by semicolons"),
            ("a,b\n1,2\n3\n", "line 3: expected 2 values between commas, one for each key, and found 1"),
            ("a,b\n1,\n", "line 2: there is no value of `b`"),
        ];
        for (text, reason) in refused {
            let error = read(text).expect_err("it is no design");
            assert!(error.contains(reason), "{text:?}: {error}");
        }
        let long = format!("a\n{}", "1\n".repeat(10_001));
        assert!(read(&long).expect_err("it is long").contains("over 10000 rows"));
    }
}
