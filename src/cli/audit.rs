//! `wildfire audit`.

use std::fs;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::cli::args::{jobs_or_all, parse_jobs};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::report::FormArguments;
use crate::cli::terminal::Progress;
use crate::cli::{numbers, terminal};
use wildfire_audit::SampleStep;
use wildfire_base::input_file::is_standard_stream;
use wildfire_batch::execute::RECORDINGS_FOLDER;
use wildfire_batch::plan::{PlanError, Record};
use wildfire_batch::report::{AuditOptions, AuditReport, AuditSource, LISTED_VIOLATIONS, audit_all};
use wildfire_batch::table::{FinishedBatch, FinishedError, recordings_in};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire audit run.wildfire
  wildfire audit runs/contest runs/dense --jobs 2

The audit re-drives every leg in small steps, with code that shares nothing with the
planners. It prints the first violation of every run, with time, place and rule, and exits
with 4 if there is one.")]
pub struct AuditArguments {
    /// Recordings, folders of recordings, or batch folders; unrecorded runs of a batch are simulated again from its
    /// plan.
    #[arg(value_name = "RUN|DIR", required = true)]
    pub paths: Vec<PathBuf>,
    /// Number of threads [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Largest distance between checked poses, in metres.
    #[arg(long = "step-m", alias = "step", value_name = "METRES", default_value_t = 0.02, allow_hyphen_values = true, value_parser = parse_audit_step)]
    pub step: f64,
    /// Allow programs named in batch plans to run when runs are simulated again.
    #[arg(long)]
    pub trust: bool,
    #[command(flatten)]
    pub form: FormArguments,
}

/// The distances between checked poses that an audit takes, metres.
const AUDIT_STEPS_M: RangeInclusive<f64> = 0.001..=1.0;

fn parse_audit_step(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &AUDIT_STEPS_M, "metres")
}

pub fn run(arguments: &AuditArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let sources = arguments.paths.iter().map(|path| source(path, context)).collect::<Result<Vec<_>, _>>()?;
    let jobs = jobs_or_all(arguments.jobs);
    let step = SampleStep { metres: arguments.step, ..SampleStep::default() };
    let progress = Progress::new(sources.iter().map(AuditSource::count).sum(), "runs", context.quiet);
    let options = AuditOptions { jobs, step, registry: &context.registry, listed: LISTED_VIOLATIONS };
    let report = audit_all(&sources, &options, || progress.advance());
    progress.end();
    conclude(&report?, arguments.form)
}

/// Finds out what is at a path: a recording, a folder of recordings, or a batch.
fn source(path: &Path, context: &CommandContext) -> Result<AuditSource, CliError> {
    let is_folder = match fs::metadata(path) {
        // A standard stream has no metadata, and is never a folder.
        _ if is_standard_stream(path) => false,
        Ok(found) => found.is_dir(),
        Err(error) => return Err(CliError::unreadable(path, &error)),
    };
    if !is_folder {
        return Ok(AuditSource::Recordings(vec![path.to_owned()]));
    }
    // A folder without a plan may still hold recordings.
    if !FinishedBatch::is_there(path) {
        return recordings(path, "no recordings and no batch plan");
    }
    match FinishedBatch::open(path) {
        Ok(batch) => {
            batch.expect_registry(&context.registry)?;
            // Recorded runs are only read; all others are simulated again, which may start programs.
            if batch.plan().record != Record::All {
                context.expect_trusted_plan(batch.plan())?;
            }
            Ok(AuditSource::Batch(Box::new(batch)))
        }
        // Another version makes other runs of these seeds, so only what was recorded can be checked.
        Err(error @ FinishedError::Plan(PlanError::OtherVersion { .. })) => {
            if !context.quiet {
                terminal::note(&format!("{error}: only recorded runs are audited"));
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
fn conclude(report: &AuditReport, form: FormArguments) -> Result<ExitCode, CliError> {
    let unreadable = report.first_unreadable.as_ref().map(|(reason, kind)| match report.unreadable {
        1 => (reason.clone(), *kind),
        count => (format!("{reason} (and {} more recordings cannot be read)", count - 1), *kind),
    });
    // A report of no run at all would look like a clean one.
    if report.runs() + report.not_run > 0 {
        terminal::print(&form.render(report))?;
    }
    match unreadable {
        // A violation is the graver finding, and its exit code must not be hidden by a file that is missing.
        Some((reason, kind)) if report.violations == 0 => Err(CliError::from_input_error(reason, kind)),
        Some((reason, _)) => {
            terminal::note(&reason);
            Ok(ExitCode::from(exit::VIOLATION))
        }
        None if report.violations > 0 => Ok(ExitCode::from(exit::VIOLATION)),
        None => Ok(ExitCode::SUCCESS),
    }
}
