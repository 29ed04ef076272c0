//! The progress of a batch, also while other processes work on it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::ErrorKind;

use crate::execute::journal::{FailedRuns, add_failed, count_lines, open_to_read};
use crate::execute::{BatchError, JournalError, JournalIndex, OutputFolder};
use crate::plan::{BatchPlan, Slice};

/// A plan and its slices.
#[derive(Debug)]
pub struct BatchStatus {
    pub plan: BatchPlan,
    pub slices: Vec<(Slice, SliceState)>,
    /// The failed runs of each variant, by its place in the plan.
    pub failures: BTreeMap<u64, FailedRuns>,
}

/// The progress of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SliceState {
    pub runs: u64,
    /// The number of runs in the journal.
    pub stored: u64,
    /// The number of runs in the journal without a result.
    pub not_done: u64,
    /// The number of repeated lines, which two processes made.
    pub repeated: u64,
    /// True if a process is working on it.
    pub is_running: bool,
}

/// Reads plan and journals of a folder; of slices that have not begun, that they have not.
///
/// # Errors
/// If there is no plan, or a journal cannot be read or is damaged.
pub fn batch_status(folder: &OutputFolder) -> Result<BatchStatus, BatchError> {
    let plan = BatchPlan::read(folder.path())?;
    let first = folder.journals()?.first().copied().unwrap_or(Slice::WHOLE);
    let mut failures = BTreeMap::new();
    let states = first.all().map(|slice| Ok((slice, state_of(folder, slice, &plan, &mut failures)?)));
    let slices = states.collect::<Result<Vec<_>, JournalError>>()?;
    Ok(BatchStatus { plan, slices, failures })
}

/// Reads the journal of a slice, and adds its failed runs to those of others.
fn state_of(
    folder: &OutputFolder,
    slice: Slice,
    plan: &BatchPlan,
    failures: &mut BTreeMap<u64, FailedRuns>,
) -> Result<SliceState, JournalError> {
    // Looking at a batch must not disturb it: the lock is tried, and not waited for.
    let path = folder.journal(slice);
    let (file, is_running) = match open_to_read(&path, folder.keeping().lock) {
        Ok(file) => (Ok(file), false),
        // The process that holds the lock is at work; reading needs none.
        Err(JournalError::Locked { .. }) => (File::open(&path), true),
        Err(JournalError::Unreadable { source, .. }) => (Err(source), false),
        Err(error) => return Err(error),
    };
    let file = match file {
        Ok(file) => file,
        // A slice without a journal has not begun.
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let runs = slice.count(plan.count());
            return Ok(SliceState { runs, stored: 0, not_done: 0, repeated: 0, is_running });
        }
        Err(source) => return Err(JournalError::Unreadable { path, source }),
    };
    let index = JournalIndex::read(&path, &file, plan, slice)?;
    for (&variant, failed) in index.failures() {
        add_failed(failures, variant, failed.clone());
    }
    Ok(SliceState {
        runs: index.count(),
        stored: index.stored(),
        not_done: index.not_done(),
        repeated: index.repeated(),
        is_running,
    })
}

/// Returns the slices of which a folder has journals, all of one partition.
///
/// # Errors
/// [`BatchError::NoJournal`] if there is none, [`BatchError::OtherSlices`] if they are of several numbers.
pub fn slices_of(folder: &OutputFolder) -> Result<impl Iterator<Item = Slice> + use<>, BatchError> {
    let found = folder.journals()?;
    let path = || folder.path().to_owned();
    let Some(&first) = found.first() else { return Err(BatchError::NoJournal { path: path() }) };
    match found.iter().find(|other| other.of() != first.of()) {
        Some(&other) => Err(BatchError::OtherSlices { path: path(), found: other, requested: first }),
        None => Ok(first.all()),
    }
}

/// A slice with missing runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissingRuns {
    pub slice: Slice,
    /// The number of missing lines; a repeated run hides a missing one.
    pub missing: u64,
    pub of: u64,
}

/// A survey of the lengths of all journals, which is cheap enough to repeat while others work.
#[derive(Clone, Debug)]
pub struct JournalScan {
    folder: OutputFolder,
    runs: u64,
    slices: Vec<CountedLines>,
}

/// The lines of a slice's journal that were counted so far.
#[derive(Clone, Copy, Debug)]
struct CountedLines {
    slice: Slice,
    lines: u64,
    bytes: u64,
}

impl JournalScan {
    /// Creates a survey without counts.
    ///
    /// # Errors
    /// As [`slices_of`].
    pub fn new(folder: &OutputFolder, plan: &BatchPlan) -> Result<Self, BatchError> {
        let slices = slices_of(folder)?.map(|slice| CountedLines { slice, lines: 0, bytes: 0 }).collect();
        Ok(Self { folder: folder.clone(), runs: plan.count(), slices })
    }

    /// Counts the lines written since the last update, and returns their number.
    pub fn update(&mut self) -> Result<u64, BatchError> {
        let mut new = 0;
        for counted in &mut self.slices {
            let path = self.folder.journal(counted.slice);
            let found = match count_lines(&path, counted.bytes) {
                // A slice without a journal has not begun.
                Err(JournalError::Unreadable { source, .. }) if source.kind() == ErrorKind::NotFound => continue,
                found => found?,
            };
            counted.lines += found.lines;
            counted.bytes = found.end;
            new += found.lines;
        }
        Ok(new)
    }

    pub fn number_of_slices(&self) -> usize {
        self.slices.len()
    }

    /// Lists the slices with missing runs, in order.
    pub fn missing(&self) -> Vec<MissingRuns> {
        let lacking = self.slices.iter().filter_map(|counted| {
            let of = counted.slice.count(self.runs);
            let missing = of.saturating_sub(counted.lines.saturating_sub(1));
            // A slice without a run is begun by its first line all the same.
            let is_lacking = missing > 0 || counted.lines == 0;
            is_lacking.then_some(MissingRuns { slice: counted.slice, missing, of })
        });
        lacking.collect()
    }
}
