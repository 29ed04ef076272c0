//! `wildfire batch`.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use crate::batch::{BatchPlan, BatchReport, OutputFolder, Status, run_batch};
use crate::cli::args::BatchArguments;
use crate::cli::failure::Failure;
use crate::cli::{exit, scenario_commands, terminal};

/// The folder, in the current one, that holds a folder for each batch.
const RUNS_FOLDER: &str = "runs";

pub fn run(arguments: &BatchArguments, quiet: bool) -> Result<ExitCode, Failure> {
    let plan = plan(arguments)?;
    let jobs = arguments.jobs.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let folder = match &arguments.out {
        Some(path) => OutputFolder::named(path, arguments.force)?,
        None => OutputFolder::next_free(Path::new(RUNS_FOLDER), &plan.scenario.name)?,
    };
    let report = run_with_progress(&plan, &folder, jobs, quiet)?;
    terminal::print(summary(&plan, &folder, &report).as_bytes())?;
    let code = if report.tally.not_done() == 0 { ExitCode::SUCCESS } else { ExitCode::from(exit::RUN_FAILED) };
    Ok(code)
}

fn plan(arguments: &BatchArguments) -> Result<BatchPlan, Failure> {
    Ok(BatchPlan {
        source: arguments.scenario.source.clone(),
        overrides: arguments.scenario.overrides.clone(),
        scenario: scenario_commands::load(&arguments.scenario.source, &arguments.scenario.overrides)?,
        seeds: arguments.seeds.clone(),
        record: arguments.record,
    })
}

fn run_with_progress(
    plan: &BatchPlan,
    folder: &OutputFolder,
    jobs: usize,
    quiet: bool,
) -> Result<BatchReport, Failure> {
    let bar = terminal::progress_bar(plan.seeds.count(), quiet);
    let not_done = AtomicU64::new(0);
    let count = |status: Status| {
        if status != Status::Done {
            let count = not_done.fetch_add(1, Ordering::Relaxed) + 1;
            bar.set_message(format!("({count} failed)"));
        }
        bar.inc(1);
    };
    let report = run_batch(plan, folder, jobs, count);
    bar.finish_and_clear();
    Ok(report?)
}

fn summary(plan: &BatchPlan, folder: &OutputFolder, report: &BatchReport) -> String {
    let (name, seeds) = (&plan.scenario.name, &plan.seeds);
    let (tables, tally) = (report.tables.to_text(), &report.tally);
    format!("{name}, seeds {seeds}\n\n{tables}\n{tally}\nFiles: {}\n", folder.path().display())
}
