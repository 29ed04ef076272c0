//! Running a plan on several threads, with rows in the order of its seeds.

use rayon::prelude::*;

use crate::batch::row_files::RowFiles;
use crate::batch::{
    BatchError, BatchPlan, BatchReport, OutputFolder, PLAN_FILE, Record, RunResult, RunRow, Status, TABLES_FILE,
    Tables, Tally, panics,
};
use crate::scenario::Scenario;
use crate::sim::{self, Run, RunError};
use crate::time::wall::WallStopwatch;
use crate::timeline::file::{self, FileError};
use crate::timeline::{Outcome, Timeline};
use crate::whole_file::write_whole;

/// Runs between two writings of rows, per worker: enough that waiting for the last of them costs little.
const RUNS_PER_ROUND: usize = 128;

/// Runs every seed of the plan on `jobs` threads and writes the files of the batch.
///
/// `on_run` is called from the workers after each run, in any order. An error is one of the disk, or of starting the
/// threads; runs that fail, or that cannot be recorded though they should be, are rows.
pub fn run_batch(
    plan: &BatchPlan,
    folder: &OutputFolder,
    jobs: usize,
    on_run: impl Fn(Status) + Sync,
) -> Result<BatchReport, BatchError> {
    run_batch_with(plan, folder, jobs, sim::run, on_run)
}

/// The same with another way to run a scenario with a seed.
pub fn run_batch_with(
    plan: &BatchPlan,
    folder: &OutputFolder,
    jobs: usize,
    run: impl Fn(&Scenario, u64) -> Result<Run, RunError> + Sync,
    on_run: impl Fn(Status) + Sync,
) -> Result<BatchReport, BatchError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    let mut files = begin_files(plan, folder)?;
    let mut report = BatchReport { tables: Tables::default(), tally: Tally::default() };
    let worker = |&seed: &u64| {
        let row = run_one(plan, folder, seed, &run);
        row.inspect(|row| on_run(row.status))
    };
    let mut seeds = plan.seeds.iter();
    loop {
        let round: Vec<u64> = seeds.by_ref().take(RUNS_PER_ROUND * jobs).collect();
        if round.is_empty() {
            break;
        }
        let rows: Vec<_> = pool.install(|| round.par_iter().with_max_len(1).map(worker).collect());
        for row in rows {
            let row = row?;
            files.add(&row)?;
            report.tables.add(&row);
            report.tally.add(&row);
        }
    }
    write_file(folder, TABLES_FILE, &format!("{}\n{}\n", report.tables.to_markdown(), report.tally))?;
    files.finish()?;
    Ok(report)
}

/// Opens the files of rows and writes the plan, so that a disk that cannot be written is found before the first run.
///
/// Only then do earlier results go, the plan that says which are its recordings with them.
fn begin_files(plan: &BatchPlan, folder: &OutputFolder) -> Result<RowFiles, BatchError> {
    let files = RowFiles::create(folder)?;
    if plan.record != Record::None {
        folder.prepare_recordings()?;
    }
    folder.remove_earlier_results()?;
    write_file(folder, PLAN_FILE, &plan.to_json())?;
    Ok(files)
}

fn write_file(folder: &OutputFolder, name: &str, text: &str) -> Result<(), BatchError> {
    let path = folder.path().join(name);
    write_whole(&path, text.as_bytes()).map_err(|source| BatchError::unwritable(&path, source))
}

fn run_one(
    plan: &BatchPlan,
    folder: &OutputFolder,
    seed: u64,
    run: impl Fn(&Scenario, u64) -> Result<Run, RunError>,
) -> Result<RunRow, BatchError> {
    let stopwatch = WallStopwatch::start();
    let caught = panics::catch(|| run(&plan.scenario, seed).map(|run| (Outcome::of(&run.timeline), run)));
    let wall = stopwatch.elapsed();
    let name = &plan.scenario.name;
    match caught {
        Ok(Ok((outcome, run))) => {
            let refusal = if is_recorded(plan.record, &outcome) { record(folder, seed, &run.timeline)? } else { None };
            Ok(match refusal {
                None => RunRow::done(name, seed, RunResult::new(outcome, run.cost), wall),
                Some(reason) => {
                    let message = format!("cannot be recorded: {reason}");
                    RunRow::not_done(name, seed, Status::Failed, message, wall)
                }
            })
        }
        Ok(Err(error)) => Ok(RunRow::not_done(name, seed, Status::Failed, error.to_string(), wall)),
        Err(panic) => {
            let message = format!("panicked: {panic}; see it again: {}", plan.repeating_command(seed));
            Ok(RunRow::not_done(name, seed, Status::Panicked, message, wall))
        }
    }
}

fn is_recorded(record: Record, outcome: &Outcome) -> bool {
    match record {
        Record::All => true,
        Record::Failed => outcome.truck_stuck_s > 0.0 || outcome.wumpus_stuck_s > 0.0,
        Record::None => false,
    }
}

/// Writes the recording of a run, or says what about the run cannot be recorded. An error is one of the disk.
fn record(folder: &OutputFolder, seed: u64, timeline: &Timeline) -> Result<Option<FileError>, BatchError> {
    let path = folder.recording(seed);
    match file::write(timeline, &path) {
        Ok(()) => Ok(None),
        Err(FileError::Io(source)) => Err(BatchError::Unrecordable { path, source }),
        Err(refusal) => Ok(Some(refusal)),
    }
}
