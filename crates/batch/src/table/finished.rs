//! A finished batch, read from its folder: its runs, and the contents of its rows.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::execute::{OutputFolder, RUNS_FILE, UnexpectedFile, expect_file, expect_files};
use crate::plan::{BatchPlan, PLAN_FILE, PlanError, PlannedRun};
use crate::table::columns::RUN_COLUMNS;
use crate::table::reader::{TableError, TableReader};
use crate::table::record::RunRecord;
use wildfire_sim::CustomRegistry;

/// The reason why a folder cannot be read as a finished batch. Messages are sentences that name the file.
#[derive(Debug, Error)]
pub enum FinishedError {
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Strange(#[from] UnexpectedFile),
    #[error("{} does not fit its plan: {reason}", path.display())]
    OtherRows { path: PathBuf, reason: String },
    #[error("cannot read {}: {reason}", path.display())]
    Damaged { path: PathBuf, reason: String },
    #[error(transparent)]
    WrongTable(TableError),
}

/// A batch's folder and plan.
#[derive(Debug)]
pub struct FinishedBatch {
    folder: PathBuf,
    plan: BatchPlan,
}

impl FinishedBatch {
    /// Returns whether a folder has the plan of a batch, or may have one because it is not accessible.
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

    /// Returns the number of runs.
    pub fn count(&self) -> u64 {
        self.plan.count()
    }

    /// Iterates over the runs in the order of the plan.
    pub fn runs(&self) -> impl Iterator<Item = PlannedRun<'_>> {
        self.plan.runs()
    }

    /// Returns a name for a run: its folder, its variant if there are several, and its seed.
    pub fn name_of(&self, run: &PlannedRun<'_>) -> String {
        let folder = self.folder.display();
        match self.plan.variants.as_slice() {
            [_] => format!("{folder}, seed {}", run.seed),
            _ => format!("{folder}, {}, seed {}", self.plan.title(run.variant), run.seed),
        }
    }

    /// Returns the path of a run's recording, if there is one.
    pub fn recording(&self, run: &PlannedRun<'_>) -> Option<PathBuf> {
        let path = OutputFolder::recording_in(&self.folder, &self.plan.recording_name(run));
        path.exists().then_some(path)
    }

    /// Refuses a batch of which a run would have to be repeated and cannot, see [`BatchPlan::expect_registry`].
    pub fn expect_registry(&self, registry: &CustomRegistry) -> Result<(), FinishedError> {
        match self.plan.expect_registry(registry, &self.folder) {
            // Where every run has its recording, none has to be repeated, and no custom planner is needed.
            Err(_) if self.runs().all(|run| self.recording(&run).is_some()) => Ok(()),
            status => Ok(status?),
        }
    }

    /// Opens the rows of the runs; `None` if the batch did not write them.
    pub fn rows(&self) -> Result<Option<FinishedRows>, FinishedError> {
        match TableReader::open(&self.folder.join(RUNS_FILE)) {
            Ok(table) => FinishedRows::new(table).map(Some),
            Err(TableError::Unreadable { source, .. }) if source.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error.into()),
        }
    }
}

/// The rows of a batch, read in their order.
pub struct FinishedRows {
    table: TableReader,
    /// The place of each of [`RUN_COLUMNS`].
    places: Vec<usize>,
}

impl FinishedRows {
    fn new(table: TableReader) -> Result<Self, FinishedError> {
        let places = RUN_COLUMNS
            .iter()
            .map(|column| {
                table.place(column.name).ok_or_else(|| FinishedError::OtherRows {
                    path: table.path().to_owned(),
                    reason: format!("it has no column `{}`", column.name),
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { table, places })
    }

    /// Reads the next run's row.
    pub fn next(&mut self, run: &PlannedRun<'_>) -> Result<RunRecord, FinishedError> {
        let seed = run.seed;
        let other = |table: &TableReader, reason| FinishedError::OtherRows { path: table.path().to_owned(), reason };
        if !self.table.next_row()? {
            return Err(other(&self.table, format!("it ends before the row of seed {seed}")));
        }
        let columns = self.places.iter().zip(RUN_COLUMNS);
        let values = columns.map(|(&place, column)| self.table.value(place, column.kind));
        let record = RunRecord::from_values(values.collect::<Result<_, _>>()?);
        // A table that was sorted or edited no longer fits its plan.
        if (record.seed(), record.number_in_plan()) != (seed, run.number) {
            let reason = format!("it has the row of seed {}; expected that of seed {seed}", record.seed());
            return Err(other(&self.table, reason));
        }
        Ok(record)
    }
}

impl From<TableError> for FinishedError {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Unreadable { path, source } => Self::Unreadable { path, source },
            TableError::Damaged { path, line, complaint } => {
                Self::OtherRows { path, reason: format!("line {line}: {complaint}") }
            }
            other => Self::WrongTable(other),
        }
    }
}

/// Returns the recordings in a folder, shorter names first, so that numbered ones are in numerical order.
pub fn recordings_in(folder: &Path) -> Result<Vec<PathBuf>, FinishedError> {
    let unreadable = |source| FinishedError::Unreadable { path: folder.to_owned(), source };
    let entries = fs::read_dir(folder).map_err(unreadable)?;
    let paths =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let mut recordings: Vec<PathBuf> =
        paths.into_iter().filter(|path| path.extension().is_some_and(|extension| extension == "wildfire")).collect();
    recordings.iter().try_for_each(|path| expect_file(path))?;
    recordings.sort_by_cached_key(|path| (path.as_os_str().len(), path.clone()));
    Ok(recordings)
}
