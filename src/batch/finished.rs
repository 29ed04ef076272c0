//! A batch that is over, read back from its folder: which runs it had, and what its rows say of them.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use thiserror::Error;

use crate::batch::plan::PROGRAM;
use crate::batch::{
    OutputFolder, PLAN_FILE, PROGRAM_VERSION, RUN_COLUMNS, RUNS_FILE, RunRow, Seeds, Status, is_measured,
};
use crate::scenario::Scenario;

/// The largest plan that is read; what is large in one is a field drawn as a map.
const MAX_PLAN_BYTES: u64 = 64 << 20;

/// The longest row of a batch's runs, on average; what is longer was not written by this program.
const MAX_ROW_BYTES: u64 = 64 << 10;

/// Why a folder cannot be read as a batch that is over. Messages are sentences that name the file.
#[derive(Debug, Error)]
pub enum FinishedError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{} is no plan of a batch: {reason}", path.display())]
    NotAPlan { path: PathBuf, reason: String },
    #[error("{} was written by wildfire {found}; this is {PROGRAM_VERSION}, whose runs may differ", path.display())]
    OtherVersion { path: PathBuf, found: String },
    #[error("{} does not go with its plan: {reason}", path.display())]
    OtherRows { path: PathBuf, reason: String },
}

/// A batch's plan.
#[derive(Debug)]
pub struct FinishedBatch {
    folder: PathBuf,
    scenario: Scenario,
    seeds: Seeds,
}

/// One of its runs.
#[derive(Clone, Copy, Debug)]
pub struct FinishedRun<'a> {
    pub seed: u64,
    pub scenario: &'a Scenario,
}

/// What is read first of a plan.
#[derive(Deserialize)]
struct Head {
    program: String,
    program_version: String,
}

#[derive(Deserialize)]
struct Body {
    seeds: String,
    scenario: Scenario,
}

impl FinishedBatch {
    /// Whether a folder has the plan of a batch.
    pub fn is_there(folder: &Path) -> bool {
        folder.join(PLAN_FILE).exists()
    }

    /// Reads the plan of a batch's folder.
    ///
    /// # Errors
    /// If it cannot be read, or another version of the program wrote it.
    pub fn open(folder: &Path) -> Result<Self, FinishedError> {
        let path = folder.join(PLAN_FILE);
        let text = read_text(&path)?;
        let not_a_plan = |reason: String| FinishedError::NotAPlan { path: path.clone(), reason };
        let head: Head = serde_json::from_str(&text).map_err(|error| not_a_plan(error.to_string()))?;
        if head.program != PROGRAM {
            return Err(not_a_plan(format!("its program is `{}`, expected `{PROGRAM}`", head.program)));
        }
        if head.program_version != PROGRAM_VERSION {
            return Err(FinishedError::OtherVersion { path, found: head.program_version });
        }
        let body: Body = serde_json::from_str(&text).map_err(|error| not_a_plan(error.to_string()))?;
        let seeds = body.seeds.parse().map_err(|error| not_a_plan(format!("{error}")))?;
        body.scenario.check().map_err(|fault| not_a_plan(fault.to_string()))?;
        Ok(Self { folder: folder.to_owned(), scenario: body.scenario, seeds })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Number of runs.
    pub fn count(&self) -> u64 {
        self.seeds.count()
    }

    /// The runs in the order of the plan.
    pub fn runs(&self) -> impl Iterator<Item = FinishedRun<'_>> {
        self.seeds.iter().map(|seed| FinishedRun { seed, scenario: &self.scenario })
    }

    /// Where the recording of a run is, if there is one.
    pub fn recording(&self, run: &FinishedRun<'_>) -> Option<PathBuf> {
        let path = OutputFolder::recording_in(&self.folder, run.seed);
        path.exists().then_some(path)
    }

    /// The rows of the runs; `None` where the batch did not come to write them.
    pub fn rows(&self) -> Result<Option<FinishedRows>, FinishedError> {
        let path = self.folder.join(RUNS_FILE);
        match File::open(&path) {
            Ok(file) => FinishedRows::new(path, file, self.count()).map(Some),
            Err(source) if source.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(FinishedError::Unreadable { path, source }),
        }
    }
}

fn read_text(path: &Path) -> Result<String, FinishedError> {
    let unreadable = |source| FinishedError::Unreadable { path: path.to_owned(), source };
    let mut text = String::new();
    File::open(path).map_err(unreadable)?.take(MAX_PLAN_BYTES + 1).read_to_string(&mut text).map_err(unreadable)?;
    if text.len() as u64 > MAX_PLAN_BYTES {
        let reason = format!("it has more than {MAX_PLAN_BYTES} bytes");
        return Err(FinishedError::NotAPlan { path: path.to_owned(), reason });
    }
    Ok(text)
}

/// The rows of a batch, read in their order.
pub struct FinishedRows {
    path: PathBuf,
    reader: csv::Reader<io::Take<File>>,
    /// Where each outcome column of this program stands.
    places: Vec<usize>,
}

/// What a row says of a run, by outcome column.
#[derive(Debug)]
pub struct FinishedRow(Vec<String>);

impl FinishedRows {
    fn new(path: PathBuf, file: File, runs: u64) -> Result<Self, FinishedError> {
        let mut reader = csv::Reader::from_reader(file.take((runs + 1).saturating_mul(MAX_ROW_BYTES)));
        let header = reader.headers().map_err(|error| unreadable(&path, error))?.clone();
        let place = |name: &str| {
            let reason = || format!("it has no column `{name}`");
            let place = header.iter().position(|column| column == name);
            place.ok_or_else(|| FinishedError::OtherRows { path: path.clone(), reason: reason() })
        };
        let places = outcome_columns().map(|(name, _)| place(name)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { path, reader, places })
    }

    /// The row of the run whose turn it is.
    pub fn next(&mut self, seed: u64) -> Result<FinishedRow, FinishedError> {
        let other = |reason| FinishedError::OtherRows { path: self.path.clone(), reason };
        let mut record = csv::StringRecord::new();
        if !self.reader.read_record(&mut record).map_err(|error| unreadable(&self.path, error))? {
            return Err(other(format!("it ends before the row of seed {seed}")));
        }
        let row = FinishedRow(self.places.iter().map(|&place| record[place].to_owned()).collect());
        let found = row.value("seed");
        if found != seed.to_string() {
            return Err(other(format!("it has the row of seed {found} where that of seed {seed} is expected")));
        }
        Ok(row)
    }
}

impl FinishedRow {
    pub fn value(&self, name: &str) -> &str {
        let place = outcome_columns().position(|(column, _)| column == name);
        &self.0[place.expect("only columns of this program are asked for")]
    }

    pub fn is_done(&self) -> bool {
        self.value("status") == Status::Done.to_string()
    }

    /// The first column in which a run is another than this row says, in words.
    pub fn difference(&self, run: &RunRow) -> Option<String> {
        let columns = outcome_columns().zip(&self.0);
        let told = columns.map(|((name, value), said)| (name, said, value(run).to_string()));
        let mut others = told.filter(|(_, said, found)| *said != found);
        others.next().map(|(name, said, found)| {
            let word = |value: &str| if value.is_empty() { "nothing".to_owned() } else { value.to_owned() };
            format!("its row says {name} {}, its run gives {}", word(said), word(&found))
        })
    }
}

fn outcome_columns() -> impl Iterator<Item = (&'static str, fn(&RunRow) -> crate::batch::Value)> {
    RUN_COLUMNS.iter().filter(|column| !is_measured(column.name)).map(|column| (column.name, column.value))
}

fn unreadable(path: &Path, error: csv::Error) -> FinishedError {
    let path = path.to_owned();
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos: Some(place), expected_len, len } => {
            let reason = format!("line {}: {len} fields; expected {expected_len}", place.line());
            FinishedError::OtherRows { path, reason }
        }
        _ => FinishedError::Unreadable { path, source: error.into() },
    }
}

/// The recordings in a folder, shorter names first, so that numbered ones are in the order of their numbers.
pub fn recordings_in(folder: &Path) -> Result<Vec<PathBuf>, FinishedError> {
    let unreadable = |source| FinishedError::Unreadable { path: folder.to_owned(), source };
    let entries = fs::read_dir(folder).map_err(unreadable)?;
    let paths =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let is_recording = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "wildfire");
    let mut recordings: Vec<PathBuf> = paths.into_iter().filter(is_recording).collect();
    recordings.sort_by_cached_key(|path| (path.as_os_str().len(), path.clone()));
    Ok(recordings)
}
