//! Notable runs: the one with the fewest burned bushes, the median, and the one with the most.

use super::ReportError;
use crate::execute::CHARTS_FOLDER;
use crate::table::{FinishedBatch, run_column};

const BURNED_RATIO: usize = run_column("burned_ratio");

/// A notable run.
#[derive(Clone, Debug, PartialEq)]
pub struct NotableRun {
    /// `best`, `median` or `worst`.
    pub word: &'static str,
    /// The number of the run, from 1, in the order of the plan.
    pub number: u64,
    /// The share of bushes that burned.
    pub burned_ratio: f64,
}

impl NotableRun {
    /// Returns the path of its page in the folder of the batch.
    pub fn page(&self) -> String {
        page_of(self.word)
    }
}

fn page_of(word: &str) -> String {
    format!("{CHARTS_FOLDER}/{word}-run.html")
}

/// What the runs are called: in them the least burned, the most, and half of the runs burned less.
const RANKS: [&str; 3] = ["best", "worst", "median"];

/// Returns the notable runs that have pages.
pub fn runs_with_pages(batch: &FinishedBatch) -> Result<Vec<NotableRun>, ReportError> {
    if !RANKS.into_iter().any(|word: &str| batch.folder().join(page_of(word)).is_file()) {
        return Ok(Vec::new());
    }
    let runs = notable_runs(batch)?;
    Ok(runs.into_iter().filter(|run| batch.folder().join(page_of(run.word)).is_file()).collect())
}

/// Returns the finished runs with the fewest and the most burned bushes, and the median; ties go to the first. A run
/// with two of these roles appears once.
pub fn notable_runs(batch: &FinishedBatch) -> Result<Vec<NotableRun>, ReportError> {
    let mut rows = batch.rows()?.ok_or_else(|| ReportError::Unfinished { folder: batch.folder().to_owned() })?;
    let mut burned: Vec<(f64, u64)> = Vec::new();
    for run in batch.runs() {
        let row = rows.next(&run)?;
        burned.extend(row.number(BURNED_RATIO).filter(|_| row.is_done()).map(|ratio| (ratio, run.number)));
    }
    burned.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let Some(last) = burned.len().checked_sub(1) else { return Ok(Vec::new()) };
    // Several runs may share the largest share of burned bushes, and ties go to the first.
    let max = burned.partition_point(|run| run.0 < burned[last].0);
    let mut notable: Vec<NotableRun> = Vec::new();
    for (word, place) in RANKS.into_iter().zip([0, max, last / 2]) {
        let (burned_ratio, number) = burned[place];
        // In a batch of one run it is the best, the worst and the median, and is listed as the best.
        if notable.iter().all(|run| run.number != number) {
            notable.push(NotableRun { word, number, burned_ratio });
        }
    }
    notable.sort_by(|one, other| one.burned_ratio.total_cmp(&other.burned_ratio).then(one.word.cmp(other.word)));
    Ok(notable)
}
