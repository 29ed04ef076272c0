//! The runs of a table as a comparison needs them: seeds, conditions, and the columns of the metrics.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::comparison::error::ComparisonError;
use crate::execute::{RUNS_FILE, expect_files};
use crate::plan::{MAX_RUNS, PLAN_FILE};
use crate::table::{QueryTally, TableError, TableReader};
use wildfire_base::untrusted::visible;

/// Numbers of larger size could overflow in sums of squares.
const LARGEST: f64 = 1e100;

/// The most values of a condition, and the most bytes of one.
const MAX_LEVELS: usize = 10_000;
const MAX_LEVEL_BYTES: usize = 1000;

/// The most messages of failed runs that are kept, and the most characters of one.
const MAX_MESSAGES: usize = 10_000;
const MAX_MESSAGE: usize = 600;

/// The prefix of columns that count failed queries by reason.
const FAILED_QUERIES: &str = "truck_failed_";

/// A value to read from every row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RowField {
    /// The number in this column.
    Number(String),
    /// 1 if the column has this word, otherwise 0.
    Is(String, &'static str),
}

impl RowField {
    fn column(&self) -> &str {
        match self {
            Self::Number(column) | Self::Is(column, _) => column,
        }
    }
}

/// The runs in the order of the file.
#[derive(Debug)]
pub struct RunsTable {
    pub path: PathBuf,
    pub seeds: Vec<u64>,
    /// True if the run finished.
    pub done: Vec<bool>,
    pub conditions: Vec<RunCondition>,
    /// The value of every run for each requested field; NaN where there is none.
    pub values: Vec<Vec<f64>>,
    /// The queries of each run's trucks, as far as the table has them.
    pub queries: Vec<QueryTally>,
    /// The number of each run in its plan; 0 where the table has none.
    pub numbers: Vec<u64>,
    /// Runs whose bush counts do not add up, with the reason.
    pub impossible: BTreeMap<usize, String>,
    /// The reason of the first failed run.
    pub messages: BTreeMap<usize, String>,
    /// Failed queries of each run by reason, such as `timed_out`, as far as the table has columns for them.
    pub failures: Vec<(String, Vec<u64>)>,
}

/// A condition of runs: the scenario, the planner, or a swept key.
#[derive(Debug)]
pub struct RunCondition {
    pub name: String,
    /// The values in the order of their first runs.
    pub levels: Vec<String>,
    /// The level of every run, as an index.
    pub of_run: Vec<u32>,
}

/// Opens the table of a batch: its folder, or the file itself.
pub fn open(path: &Path) -> Result<TableReader, ComparisonError> {
    let path = if path.is_dir() {
        expect_files(path)?;
        path.join(RUNS_FILE)
    } else {
        path.to_owned()
    };
    let table = TableReader::open(&path).map_err(|error| match error {
        TableError::Unreadable { path, source }
            if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
        {
            // A plan without a table is a batch that was stopped; the error then says how to finish it.
            match path.parent().filter(|folder| folder.join(PLAN_FILE).is_file()) {
                Some(folder) if path.ends_with(RUNS_FILE) => ComparisonError::Stopped { folder: folder.to_owned() },
                _ => ComparisonError::NoBatch { path },
            }
        }
        error => error.into(),
    })?;
    match ["seed", "status"].into_iter().find(|column| table.place(column).is_none()) {
        Some(column) => Err(ComparisonError::NotATableOfRuns { path, column }),
        None => Ok(table),
    }
}

impl RunsTable {
    /// Reads all rows of a table of runs that has columns for these fields.
    pub fn read(mut table: TableReader, fields: &[RowField]) -> Result<Self, ComparisonError> {
        let place = |column: &str| table.place(column).expect("the column was looked for");
        let (seed, status) = (place("seed"), place("status"));
        let places: Vec<usize> = fields.iter().map(|field| place(field.column())).collect();
        // Conditions come before the status, and are what does not name the run itself.
        let mut conditions: Vec<(usize, RunCondition, BTreeMap<Vec<u8>, u32>)> = Vec::new();
        for (place, name) in table.columns().iter().enumerate().take_while(|(_, name)| *name != "status") {
            if name != "seed" && name != "run" {
                // The name of the run and its seed identify a row; as conditions they would make each run its own stratum.
                let condition = RunCondition { name: name.clone(), levels: Vec::new(), of_run: Vec::new() };
                conditions.push((place, condition, BTreeMap::new()));
            }
        }
        let mut seeds = Vec::new();
        let mut done = Vec::new();
        let mut values = vec![Vec::new(); fields.len()];
        let mut queries = Vec::new();
        let mut numbers = Vec::new();
        let mut impossible = BTreeMap::new();
        let mut messages = BTreeMap::new();
        let columns = table.columns().iter().enumerate();
        let reasons: Vec<(usize, String)> =
            columns.filter_map(|(place, name)| Some((place, name.strip_prefix(FAILED_QUERIES)?.to_owned()))).collect();
        let mut failures: Vec<(String, Vec<u64>)> =
            reasons.iter().map(|(_, name)| (name.clone(), Vec::new())).collect();
        while table.next_row()? {
            // While reading, as a file may be longer than the memory.
            if seeds.len() as u64 == MAX_RUNS {
                return Err(ComparisonError::TooManyRows { path: table.path().to_owned(), limit: MAX_RUNS });
            }
            seeds.push(table.count(seed, "a seed")?);
            done.push(table.bytes(status) == b"done");
            // Other versions of the program may lack these columns, and nothing else is made of them.
            let count = |column: &str| table.place(column).and_then(|place| table.count(place, "").ok());
            let message =
                table.place("message").map_or(Cow::Borrowed(""), |place| String::from_utf8_lossy(table.bytes(place)));
            queries.push(QueryTally::of_run(|column| count(column).unwrap_or(0), &message));
            if done.last() == Some(&false) && messages.len() < MAX_MESSAGES {
                messages
                    .insert(seeds.len() - 1, visible(&message.chars().take(MAX_MESSAGE).collect::<String>()).into());
            }
            if let Some(reason) = done.last().filter(|done| **done).and_then(|_| impossible_states(&count)) {
                impossible.insert(seeds.len() - 1, reason);
            }
            numbers.push(count("run").unwrap_or(0));
            for ((_, counts), (place, _)) in failures.iter_mut().zip(&reasons) {
                counts.push(table.count(*place, "").unwrap_or(0));
            }
            // Levels are numbered as they come: texts are kept once, not once a run.
            for (place, condition, index_of) in &mut conditions {
                let level = table.bytes(*place);
                // Each value is checked: a table may state any number of them.
                if level.len() > MAX_LEVEL_BYTES || index_of.len() > MAX_LEVELS {
                    return Err(table.wrong_value(*place, "at most 1000 bytes, and 10000 values in all").into());
                }
                condition.add(level, index_of);
            }
            for ((values, field), &place) in values.iter_mut().zip(fields).zip(&places) {
                values.push(match field {
                    RowField::Is(_, word) if !table.bytes(place).is_empty() => {
                        f64::from(u8::from(table.bytes(place) == word.as_bytes()))
                    }
                    // An empty word is a missing value, not another word.
                    RowField::Is(..) => f64::NAN,
                    RowField::Number(_) => match table.number(place)? {
                        // Larger numbers would overflow in the squares of the statistics.
                        Some(number) if number.abs() <= LARGEST => number,
                        Some(_) => return Err(table.wrong_value(place, "a number, or nothing").into()),
                        None => f64::NAN,
                    },
                });
            }
        }
        if seeds.is_empty() {
            return Err(ComparisonError::NoRows { path: table.path().to_owned() });
        }
        let conditions = conditions.into_iter().map(|(_, condition, _)| condition).collect();
        let path = table.path().to_owned();
        Ok(Self { path, seeds, done, conditions, values, queries, numbers, impossible, messages, failures })
    }
}

/// Says how the states of the bushes of a run do not add up; `None` if they do, or if the table does not have them all.
fn impossible_states(count: &dyn Fn(&str) -> Option<u64>) -> Option<String> {
    let states = ["intact", "burning", "burned_out", "extinguished"].map(count);
    let [intact, burning, burned_out, extinguished] = states.map(|state| state.map(u128::from));
    let obstacles = count("obstacles")?;
    let sum = intact? + burning? + burned_out? + extinguished?;
    (sum != obstacles.into()).then(|| {
        format!("intact, burning, burned_out and extinguished add up to {sum}, and there are {obstacles} obstacles")
    })
}

impl RunCondition {
    fn add(&mut self, level: &[u8], index_of: &mut BTreeMap<Vec<u8>, u32>) {
        let index = index_of.get(level).copied().unwrap_or_else(|| {
            let index = self.levels.len() as u32;
            self.levels.push(String::from_utf8_lossy(level).into_owned());
            index_of.insert(level.to_owned(), index);
            index
        });
        self.of_run.push(index);
    }

    pub fn level_of(&self, run: usize) -> &str {
        &self.levels[self.of_run[run] as usize]
    }
}
