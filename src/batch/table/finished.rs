//! A batch that is over, read back from its folder: which runs it had, and what its rows say of them.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::batch::execute::{OutputFolder, RUNS_FILE, RunRow, Status, StrangeEntry, expect_file, expect_files};
use crate::batch::plan::{BatchPlan, PLAN_FILE, PlanError, PlannedRun};
use crate::batch::table::{RUN_COLUMNS, is_measured};
use crate::untrusted::text_of_cell;

/// The longest row of a batch's runs, on average; what is longer was not written by this program.
const MAX_ROW_BYTES: u64 = 64 << 10;

/// Why a folder cannot be read as a batch that is over. Messages are sentences that name the file.
#[derive(Debug, Error)]
pub enum FinishedError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Strange(#[from] StrangeEntry),
    #[error("{} does not go with its plan: {reason}", path.display())]
    OtherRows { path: PathBuf, reason: String },
}

/// A batch's folder and plan.
#[derive(Debug)]
pub struct FinishedBatch {
    folder: PathBuf,
    plan: BatchPlan,
}

impl FinishedBatch {
    /// Says whether a folder has the plan of a batch, or may have one because it cannot be looked into.
    pub fn is_there(folder: &Path) -> bool {
        folder.join(PLAN_FILE).try_exists().unwrap_or(true)
    }

    /// Reads the plan of a batch's folder.
    ///
    /// # Errors
    /// If it cannot be read, or another version of the program wrote it.
    pub fn open(folder: &Path) -> Result<Self, FinishedError> {
        expect_files(folder)?;
        Ok(Self { folder: folder.to_owned(), plan: BatchPlan::read(folder)? })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    pub fn plan(&self) -> &BatchPlan {
        &self.plan
    }

    /// Number of runs.
    pub fn count(&self) -> u64 {
        self.plan.count()
    }

    /// The runs in the order of the plan.
    pub fn runs(&self) -> impl Iterator<Item = PlannedRun<'_>> {
        self.plan.runs()
    }

    /// What a run is called: its folder, its variant if there are several, its seed.
    pub fn name_of(&self, run: &PlannedRun<'_>) -> String {
        let folder = self.folder.display();
        match self.plan.variants.as_slice() {
            [_] => format!("{folder}, seed {}", run.seed),
            _ => format!("{folder}, {}, seed {}", self.plan.title(run.variant), run.seed),
        }
    }

    /// Where the recording of a run is, if there is one.
    pub fn recording(&self, run: &PlannedRun<'_>) -> Option<PathBuf> {
        let path = OutputFolder::recording_in(&self.folder, &self.plan.recording_name(run));
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

/// The rows of a batch, read in their order.
pub struct FinishedRows {
    path: PathBuf,
    reader: csv::Reader<io::Take<File>>,
    /// Where each of [`RUN_COLUMNS`] stands.
    places: Vec<usize>,
}

/// What a row says of a run, in the order of [`RUN_COLUMNS`].
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
        let places = RUN_COLUMNS.iter().map(|column| place(column.name)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { path, reader, places })
    }

    /// The row of the run whose turn it is.
    pub fn next(&mut self, run: &PlannedRun<'_>) -> Result<FinishedRow, FinishedError> {
        let seed = run.seed;
        let other = |reason| FinishedError::OtherRows { path: self.path.clone(), reason };
        let mut record = csv::StringRecord::new();
        if !self.reader.read_record(&mut record).map_err(|error| unreadable(&self.path, error))? {
            return Err(other(format!("it ends before the row of seed {seed}")));
        }
        let row = FinishedRow(self.places.iter().map(|&place| text_of_cell(&record[place]).to_owned()).collect());
        let found = row.value("seed");
        if found != seed.to_string() || row.value("run") != run.number.to_string() {
            return Err(other(format!("it has the row of seed {found} where that of seed {seed} is expected")));
        }
        Ok(row)
    }
}

impl FinishedRow {
    /// The row as it is written.
    pub fn new(row: &RunRow) -> Self {
        Self(RUN_COLUMNS.iter().map(|column| (column.value)(row).to_string()).collect())
    }

    pub fn value(&self, name: &str) -> &str {
        let place = RUN_COLUMNS.iter().position(|column| column.name == name);
        &self.0[place.expect("only columns of this program are asked for")]
    }

    /// `None` where there is none, or it is not finite.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.value(name).parse().ok().filter(|number: &f64| number.is_finite())
    }

    pub fn number_or_zero(&self, name: &str) -> f64 {
        self.number(name).unwrap_or(0.0)
    }

    pub fn is_done(&self) -> bool {
        self.value("status") == Status::Done.to_string()
    }

    /// The first column in which a run is another than this row says, in words.
    pub fn difference(&self, run: &RunRow) -> Option<String> {
        let outcomes = RUN_COLUMNS.iter().zip(&self.0).filter(|(column, _)| !is_measured(column.name));
        let told = outcomes.map(|(column, said)| (column.name, said, (column.value)(run).to_string()));
        let mut others = told.filter(|(_, said, found)| *said != found);
        others.next().map(|(name, said, found)| {
            let word = |value: &str| if value.is_empty() { "nothing".to_owned() } else { value.to_owned() };
            format!("its row says {name} {}, its run gives {}", word(said), word(&found))
        })
    }
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
    recordings.iter().try_for_each(|path| expect_file(path))?;
    recordings.sort_by_cached_key(|path| (path.as_os_str().len(), path.clone()));
    Ok(recordings)
}
