//! From journals to tables.

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::batch::execute::{Batch, BatchError, Disk, JournalError, OutputFolder, ReadJournal, RunRow, TABLES_FILE};
use crate::batch::plan::{BatchPlan, Slice};
use crate::batch::report::summary::{BatchReport, VariantReport};
use crate::batch::table::{CsvFiles, ParquetFiles, RunRecord};

impl Batch {
    /// Writes the tables of a whole batch whose runs are all in the journal.
    ///
    /// # Errors
    /// [`BatchError::Stopped`] if `stop` was set before the end, or one of the disk.
    pub fn finish(&self, stop: &AtomicBool) -> Result<BatchReport, BatchError> {
        let mut rows = self.rows()?;
        write_tables(self.plan(), self.folder(), self.disk(), stop, |run| rows.row(run))
    }
}

/// Writes all rows in the order of the plan, and the tables.
fn write_tables(
    plan: &BatchPlan,
    folder: &OutputFolder,
    disk: &dyn Disk,
    stop: &AtomicBool,
    mut row_of: impl FnMut(u64) -> Result<RunRow, JournalError>,
) -> Result<BatchReport, BatchError> {
    let mut files = CsvFiles::create(folder, disk, &plan.swept_keys)?;
    let mut parquet_files = ParquetFiles::create(folder, disk, plan)?;
    let mut report = BatchReport::default();
    let mut number = 0;
    for variant in &plan.variants {
        let mut variant_report = VariantReport::new(plan.title(variant), &variant.scenario);
        for _ in 0..plan.seeds.count() {
            if stop.load(Ordering::Relaxed) {
                return Err(BatchError::Stopped);
            }
            number += 1;
            let row = row_of(number)?;
            let record = RunRecord::from_row(&row);
            files.add(&row, &record)?;
            parquet_files.add(&row, &record)?;
            variant_report.add(&record);
            variant_report.add_detail(&row);
        }
        report.variants.push(variant_report);
    }
    write_markdown(folder, disk, &report)?;
    parquet_files.finish()?;
    files.finish()?;
    Ok(report)
}

fn write_markdown(folder: &OutputFolder, disk: &dyn Disk, report: &BatchReport) -> Result<(), BatchError> {
    let path = folder.path().join(TABLES_FILE);
    let write = || {
        let mut file = disk.whole_file(&path)?;
        file.write_all(report.to_document().to_markdown().as_bytes())?;
        file.finish()
    };
    write().map_err(|source| BatchError::unwritable(&path, source))
}

/// Reads the rows of a batch that is over, in the order of the plan, from its journals.
///
/// # Errors
/// If it is not over, or a journal is gone or damaged.
pub fn read_rows(plan: &BatchPlan, folder: &OutputFolder, mut on_row: impl FnMut(&RunRow)) -> Result<(), BatchError> {
    let journals = complete_journals(plan, folder)?;
    let mut rows = journals.iter().map(ReadJournal::rows).collect::<Result<Vec<_>, _>>()?;
    let of = rows.len() as u64;
    for run in 1..=plan.count() {
        let slice = usize::try_from((run - 1) % of).expect("there are few slices");
        on_row(&rows[slice].row(run)?);
    }
    Ok(())
}

/// A batch whose slices were put together.
#[derive(Debug)]
pub struct Merged {
    pub plan: BatchPlan,
    pub report: BatchReport,
    /// Files that were being written when a process was killed; they were removed.
    pub leftovers: Vec<PathBuf>,
}

/// Puts the slices of a batch together: all must be complete, and nobody at work on them.
pub fn merge(folder: &OutputFolder, disk: &dyn Disk, stop: &AtomicBool) -> Result<Merged, BatchError> {
    let plan = BatchPlan::read(folder.path())?;
    let journals = complete_journals(&plan, folder)?;
    let leftovers = folder.remove_leftovers()?;
    let mut rows = journals.iter().map(ReadJournal::rows).collect::<Result<Vec<_>, _>>()?;
    let of = rows.len() as u64;
    let report = write_tables(&plan, folder, disk, stop, |run| {
        let slice = usize::try_from((run - 1) % of).expect("there are few slices");
        rows[slice].row(run)
    })?;
    drop(rows);
    Ok(Merged { plan, report, leftovers })
}

/// Opens the journals of all slices, each of which must be complete.
fn complete_journals(plan: &BatchPlan, folder: &OutputFolder) -> Result<Vec<ReadJournal>, BatchError> {
    let slices = slices_of(folder)?;
    let journals: Result<Vec<_>, _> = slices.iter().map(|&slice| ReadJournal::open(folder, slice, plan)).collect();
    let journals = journals?;
    for journal in &journals {
        if !journal.index.is_complete() {
            let (held, _) = journal.index.held();
            let missing = journal.index.count() - held;
            return Err(BatchError::Incomplete { slice: journal.index.slice(), missing, of: journal.index.count() });
        }
    }
    Ok(journals)
}

/// The slices that a folder has journals of: all of one number.
fn slices_of(folder: &OutputFolder) -> Result<Vec<Slice>, BatchError> {
    let found = folder.journals()?;
    let path = || folder.path().to_owned();
    let Some(&first) = found.first() else { return Err(BatchError::NoJournal { path: path() }) };
    if let Some(&other) = found.iter().find(|other| other.of() != first.of()) {
        return Err(BatchError::OtherSlices { path: path(), found: other, asked: first });
    }
    match first.all().find(|slice| !found.contains(slice)) {
        Some(slice) => Err(BatchError::NotBegun { path: path(), slice }),
        None => Ok(found),
    }
}
