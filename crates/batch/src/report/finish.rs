//! The tables of a batch, made from its journals.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::execute::{
    Batch, BatchError, Disk, OutputFolder, RowReader, RowStream, RunRow, SUMMARY_FILE, StreamBudget, TABLES_FILE,
    merge_machines, slices_of, write_whole,
};
use crate::plan::{BatchPlan, Slice};
use crate::report::summary::{BatchReport, VariantReport};
use crate::table::{CsvFiles, ParquetFiles, RecordedRow};

/// Rows that are taken from the journal of a whole batch at once.
const ROWS_AT_ONCE: u64 = 512;

/// Bytes of journals whose rows are in memory at once, and bytes of lines that wait for their turn.
const BYTES_AT_ONCE: u64 = 16 << 20;
const EARLY_BYTES: usize = 16 << 20;

impl Batch {
    /// Writes the tables of a complete batch.
    ///
    /// # Errors
    /// [`BatchError::Stopped`] if `stop` was set before the end, or one of the disk.
    pub fn finish(&self, stop: &AtomicBool) -> Result<BatchReport, BatchError> {
        let mut source = WholeJournal { rows: self.rows()?, next: 1, end: self.plan().count() + 1 };
        write_tables(self.plan(), self.folder(), self.disk(), stop, &mut source)
    }
}

/// Gives rows in the order of the plan.
trait RowSource {
    /// Returns the next rows, from the first run on; none after the last.
    fn next_rows(&mut self) -> Result<Vec<RunRow>, BatchError>;
}

/// The journal of a whole batch, which is at hand and known to be complete.
struct WholeJournal<'a> {
    rows: RowReader<'a>,
    next: u64,
    end: u64,
}

impl RowSource for WholeJournal<'_> {
    fn next_rows(&mut self) -> Result<Vec<RunRow>, BatchError> {
        let runs = self.next..self.end.min(self.next + ROWS_AT_ONCE);
        self.next = runs.end;
        Ok(runs.map(|run| self.rows.row(run)).collect::<Result<_, _>>()?)
    }
}

/// The journals of all slices, each of which is opened for some rows at a time: there may be more of them than files that
/// may be open.
struct Journals {
    streams: Vec<RowStream>,
    /// The places in each slice that are next.
    next: u64,
    places: u64,
    at_once: u64,
}

impl Journals {
    fn open(plan: &BatchPlan, folder: &OutputFolder) -> Result<Self, BatchError> {
        let slices: Vec<Slice> = slices_of(folder)?.collect();
        let plan_sha256 = plan.content_sha256();
        let runs = plan.count();
        let early_bytes = EARLY_BYTES / slices.len();
        let budget = StreamBudget { plan_sha256: &plan_sha256, runs, early_bytes };
        // The first refusal by the order of slices, whichever thread meets one first.
        let streams: Vec<_> = slices.par_iter().map(|&slice| RowStream::open(folder, slice, budget)).collect();
        let streams = streams.into_iter().collect::<Result<Vec<_>, _>>()?;
        let bytes: u64 = streams.iter().map(RowStream::bytes).sum();
        let places = slices.iter().map(|slice| slice.count(runs)).max().unwrap_or(0);
        let at_once = (BYTES_AT_ONCE * places / bytes.max(1)).clamp(1, places.max(1));
        Ok(Self { streams, next: 0, places, at_once })
    }

    fn repeated(&self) -> u64 {
        self.streams.iter().map(RowStream::repeated).sum()
    }
}

impl RowSource for Journals {
    fn next_rows(&mut self) -> Result<Vec<RunRow>, BatchError> {
        let places: Range<u64> = self.next..self.places.min(self.next + self.at_once);
        if places.is_empty() {
            return Ok(Vec::new());
        }
        self.next = places.end;
        let read: Vec<_> = self.streams.par_iter_mut().map(|stream| stream.rows(places.clone())).collect();
        let mut slices = read.into_iter().map(|rows| Ok(rows?.into_iter())).collect::<Result<Vec<_>, BatchError>>()?;
        // Run by run, the slices take turns; the last turn may not come to all.
        let mut rows = Vec::new();
        for _ in places {
            rows.extend(slices.iter_mut().filter_map(Iterator::next));
        }
        Ok(rows)
    }
}

/// Writes all rows in the order of the plan, and the tables.
fn write_tables(
    plan: &BatchPlan,
    folder: &OutputFolder,
    disk: &dyn Disk,
    stop: &AtomicBool,
    source: &mut dyn RowSource,
) -> Result<BatchReport, BatchError> {
    let mut files = CsvFiles::create(folder, disk, &plan.swept_keys)?;
    let mut parquet_files = ParquetFiles::create(folder, disk, plan)?;
    let mut report = BatchReport::default();
    let mut number = 0;
    loop {
        let rows = source.next_rows()?;
        if rows.is_empty() {
            break;
        }
        if stop.load(Ordering::Relaxed) {
            return Err(BatchError::Stopped);
        }
        let rows: Vec<RecordedRow> = rows.into_par_iter().map(RecordedRow::new).collect();
        // Both kinds of tables are made of the same rows and share nothing else, so they are written at once.
        let (csv, parquet) = rayon::join(|| files.add(&rows), || parquet_files.add(&rows));
        csv.and(parquet)?;
        // Rows are added one after the other in the order of the plan: sums of floats depend on it, and threads must not.
        for row in &rows {
            add_row(&mut report, plan, number, row);
            number += 1;
        }
    }
    // `runs.csv` comes last: a folder with it counts as finished, so all other files must be whole by then.
    write_whole(disk, &folder.path().join(TABLES_FILE), report.to_document().to_markdown().as_bytes())?;
    write_whole(disk, &folder.path().join(SUMMARY_FILE), &report.to_csv(plan))?;
    parquet_files.finish()?;
    files.finish()?;
    Ok(report)
}

/// Adds a row of the plan, by its place from 0, to a report that has those before it.
fn add_row(report: &mut BatchReport, plan: &BatchPlan, place: u64, row: &RecordedRow) {
    let place = plan.place(place + 1);
    if place.seed == 0 {
        let variant = &plan.variants[place.variant];
        report.variants.push(VariantReport::new(plan, variant));
    }
    let variant_report = report.variants.last_mut().expect("the first row begins the first");
    variant_report.add(&row.record);
    variant_report.add_detail(&row.row);
}

/// Reads the rows of a finished batch, in the order of the plan, from its journals.
///
/// # Errors
/// If it is not over, or a journal is gone or damaged.
pub fn read_rows(plan: &BatchPlan, folder: &OutputFolder, mut on_row: impl FnMut(&RunRow)) -> Result<(), BatchError> {
    let mut journals = Journals::open(plan, folder)?;
    loop {
        let rows = journals.next_rows()?;
        if rows.is_empty() {
            return Ok(());
        }
        rows.iter().for_each(&mut on_row);
    }
}

/// Creates the report of a finished batch from its journals, and writes nothing.
///
/// # Errors
/// As [`read_rows`].
pub fn read_report(plan: &BatchPlan, folder: &OutputFolder) -> Result<BatchReport, BatchError> {
    let mut report = BatchReport::default();
    let mut place = 0;
    read_rows(plan, folder, |row| {
        add_row(&mut report, plan, place, &RecordedRow::new(row.clone()));
        place += 1;
    })?;
    Ok(report)
}

/// A batch whose slices were merged.
#[derive(Debug)]
pub struct Merged {
    pub plan: BatchPlan,
    pub report: BatchReport,
    /// Incomplete files of a killed process, which were removed.
    pub leftovers: Vec<PathBuf>,
    /// Repeated lines of journals, equal in everything that is not measured; two processes made them.
    pub repeated: u64,
}

/// Merges the slices of a batch: all must be complete, and no process may be working on them.
///
/// Every line is read once, on the threads of rayon's pool, and few files are open at a time, however many slices there
/// are. Memory does not grow with the rows but for the bytes of an index and of the files' own tables of contents.
pub fn merge(folder: &OutputFolder, disk: &dyn Disk, stop: &AtomicBool) -> Result<Merged, BatchError> {
    let plan = BatchPlan::read(folder.path())?;
    let mut journals = Journals::open(&plan, folder)?;
    let report = write_tables(&plan, folder, disk, stop, &mut journals)?;
    merge_machines(folder, disk)?;
    // All slices are complete, so nobody has anything left to write aside.
    let leftovers = folder.remove_leftovers()?;
    Ok(Merged { plan, report, leftovers, repeated: journals.repeated() })
}
