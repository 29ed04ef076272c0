//! `wildfire audit`.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;
use std::thread;

use crate::audit::SampleStep;
use crate::batch::{
    AuditReport, AuditSource, FinishedBatch, FinishedError, PlanError, RECORDINGS_FOLDER, TOLD_VIOLATIONS, audit_all,
    recordings_in,
};
use crate::cli::args::AuditArguments;
use crate::cli::error::CliError;
use crate::cli::{exit, terminal};
use crate::input_file::is_standard_stream;

pub fn run(arguments: &AuditArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let sources = arguments.paths.iter().map(|path| source(path, quiet)).collect::<Result<Vec<_>, _>>()?;
    let jobs = arguments.jobs.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let step = SampleStep { metres: arguments.step, ..SampleStep::default() };
    let bar = terminal::progress_bar(sources.iter().map(AuditSource::count).sum(), "runs", quiet);
    let report = audit_all(&sources, jobs, step, || bar.inc(1));
    bar.finish_and_clear();
    conclude(&report?)
}

/// Finds out what is at a path: a recording, a folder of recordings, or a batch.
fn source(path: &Path, quiet: bool) -> Result<AuditSource, CliError> {
    let is_folder = match fs::metadata(path) {
        _ if is_standard_stream(path) => false,
        Ok(found) => found.is_dir(),
        Err(error) => return Err(CliError::unreadable(path, &error)),
    };
    if !is_folder {
        return Ok(AuditSource::Recordings(vec![path.to_owned()]));
    }
    if !FinishedBatch::is_there(path) {
        return recordings(path, "no recordings and no plan of a batch");
    }
    match FinishedBatch::open(path) {
        Ok(batch) => Ok(AuditSource::Batch(Box::new(batch))),
        Err(error @ FinishedError::Plan(PlanError::OtherVersion { .. })) => {
            if !quiet {
                terminal::note(&format!("{error}: only what was recorded is audited"));
            }
            recordings(&path.join(RECORDINGS_FOLDER), "no recordings, and nothing else can be audited")
        }
        Err(error) => Err(error.into()),
    }
}

fn recordings(folder: &Path, what_is_there: &str) -> Result<AuditSource, CliError> {
    let found = if folder.exists() { recordings_in(folder)? } else { Vec::new() };
    if found.is_empty() {
        return Err(CliError::bad_input(format_args!("{} holds {what_is_there}", folder.display()), None));
    }
    Ok(AuditSource::Recordings(found))
}

/// Prints the findings; a violation weighs more than a file that cannot be read.
fn conclude(report: &AuditReport) -> Result<ExitCode, CliError> {
    let unreadable = report.first_unreadable.as_ref().map(|(reason, kind)| match report.unreadable {
        1 => (reason.clone(), *kind),
        count => (format!("{reason} (and {} more recordings cannot be read)", count - 1), *kind),
    });
    if report.runs() + report.not_run > 0 {
        terminal::print(&summary(report))?;
    }
    match unreadable {
        Some((reason, kind)) if report.violations == 0 => Err(CliError::from_input_error(reason, kind)),
        Some((reason, _)) => {
            terminal::note(&reason);
            Ok(ExitCode::from(exit::VIOLATION))
        }
        None if report.violations > 0 => Ok(ExitCode::from(exit::VIOLATION)),
        None => Ok(ExitCode::SUCCESS),
    }
}

fn summary(report: &AuditReport) -> String {
    let mut text: String = report.told.iter().map(|words| format!("{words}\n")).collect();
    let hidden = report.violations.saturating_sub(TOLD_VIOLATIONS as u64);
    if hidden > 0 {
        text += &format!("... and {hidden} more runs.\n");
    }
    if report.violations > 0 {
        text.push('\n');
    }
    text + &report.to_string()
}
