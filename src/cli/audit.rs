//! `wildfire audit`.

use std::fs;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;

use clap::Args;
use serde::{Serialize, Serializer};

use crate::audit::{Audited, SampleStep};
use crate::batch::{
    AuditOptions, AuditReport, AuditSource, FinishedBatch, FinishedError, LISTED_VIOLATIONS, PROGRAM_VERSION,
    PlanError, RECORDINGS_FOLDER, Record, audit_all, recordings_in,
};
use crate::cli::args::parse_jobs;
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::report::FormArguments;
use crate::cli::terminal::Progress;
use crate::cli::{numbers, terminal};
use crate::document::number::count;
use crate::document::{Block, Document};
use crate::input_file::is_standard_stream;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire audit run.wildfire
  wildfire audit runs/contest runs/dense --jobs 2

It drives every leg once more in small steps, by other means than the planners', and
exits with 4 if a rule is violated: it prints the first violation of every run, with
time, place and rule.")]
pub struct AuditArguments {
    /// Recordings, folders with recordings, or folders of batches; what a batch did not record is simulated again from
    /// its plan.
    #[arg(value_name = "RUN|DIR", required = true)]
    pub paths: Vec<PathBuf>,
    /// Threads [default: as many as the machine runs at once].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// The most metres between two poses that are checked.
    #[arg(long, value_name = "METRES", default_value_t = 0.02, allow_hyphen_values = true, value_parser = parse_audit_step)]
    pub step: f64,
    /// Run the programs that plans of batches name, where runs are simulated again.
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
    let jobs = arguments.jobs.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let step = SampleStep { metres: arguments.step, ..SampleStep::default() };
    let progress = Progress::new(sources.iter().map(AuditSource::count).sum(), "runs", context.quiet);
    let options = AuditOptions { jobs, step, entrants: &context.entrants, listed: LISTED_VIOLATIONS };
    let report = audit_all(&sources, &options, || progress.advance());
    progress.end();
    conclude(&report?, arguments.form)
}

/// Finds out what is at a path: a recording, a folder of recordings, or a batch.
fn source(path: &Path, context: &CommandContext) -> Result<AuditSource, CliError> {
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
        Ok(batch) => {
            batch.expect_entrants(&context.entrants)?;
            if batch.plan().record != Record::All {
                context.expect_trusted_plan(batch.plan())?;
            }
            Ok(AuditSource::Batch(Box::new(batch)))
        }
        Err(error @ FinishedError::Plan(PlanError::OtherVersion { .. })) => {
            if !context.quiet {
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
fn conclude(report: &AuditReport, form: FormArguments) -> Result<ExitCode, CliError> {
    let unreadable = report.first_unreadable.as_ref().map(|(reason, kind)| match report.unreadable {
        1 => (reason.clone(), *kind),
        count => (format!("{reason} (and {} more recordings cannot be read)", count - 1), *kind),
    });
    if report.runs() + report.not_run > 0 {
        terminal::print(&form.render(report))?;
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

/// The members in their order.
#[derive(Serialize)]
struct Object {
    program_version: &'static str,
    recorded: u64,
    simulated: u64,
    not_run: u64,
    unreadable: u64,
    without_row: u64,
    without_limits: u64,
    legs: u64,
    poses: u64,
    metres: f64,
    extinctions: u64,
    violations: u64,
    first_violations: Vec<String>,
}

impl Serialize for AuditReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Audited { legs, poses, metres, extinctions } = self.audited;
        let object = Object {
            program_version: PROGRAM_VERSION,
            recorded: self.recorded,
            simulated: self.simulated,
            not_run: self.not_run,
            unreadable: self.unreadable,
            without_row: self.without_row,
            without_limits: self.without_limits,
            legs,
            poses,
            metres,
            extinctions,
            violations: self.violations,
            first_violations: self.listed.iter().map(ToString::to_string).collect(),
        };
        object.serialize(serializer)
    }
}

impl From<&AuditReport> for Document {
    /// Lists the first violations, one for each run, then how much was checked.
    fn from(report: &AuditReport) -> Self {
        let runs = report.runs() + report.not_run;
        let mut document = Self::new(format!("Audit of {}", count(runs as usize, "run")));
        let hidden = report.violations.saturating_sub(LISTED_VIOLATIONS as u64);
        let hidden = (hidden > 0).then(|| format!("... and {hidden} more runs."));
        // One line each, however long it is: such lines are searched and sorted.
        let listed: Vec<_> = report.listed.iter().map(ToString::to_string).chain(hidden).collect();
        document = document.with((!listed.is_empty()).then(|| Block::Verbatim(listed.join("\n"))));
        document.add_list(report.sentences());
        document
    }
}
