//! Commands on the folder of a batch: `status`, `merge` and `report`.

use std::fs;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use super::answer::{BatchObject, ReportAnswer, ShownTables, summary};
use super::keeping::LockArguments;
use super::{exit_code, list, note_leftovers, note_repeated};
use crate::cli::args::{PaperArguments, ProgramArguments, jobs_or_usual, parse_jobs};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::next_command::{NextCommand, help_on_unfinished, next_command, resume_command};
use crate::cli::report::FormArguments;
use crate::cli::show::{Searches, check_grounds, run_of_batch, write_page};
use crate::cli::{interrupt, numbers, output_files, terminal};
use wildfire_base::document::number::count;
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::time::SimTime;
use wildfire_base::time::wall::WallStopwatch;
use wildfire_batch::execute::{
    BatchError, BatchStatus, JournalError, JournalScan, MissingRuns, OutputFolder, RUNS_FILE, RealDisk, SliceState,
    batch_status, limit_threads,
};
use wildfire_batch::plan::{BatchPlan, PlanError, Slice, range_text, shell_word};
use wildfire_batch::report::{
    FieldPicture, NotableRun, ReportError, ReportParts, SelectedQuantities, notable_runs, runs_with_pages, write_report,
};
use wildfire_batch::table::FinishedBatch;
use wildfire_picture::film::{FrameRequest, RunView, ViewOptions, still};

#[derive(Debug, Args)]
pub struct StatusArguments {
    /// The folder of a batch.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    #[command(flatten)]
    lock: LockArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire report runs/contest
  wildfire report runs/contest --pages
  wildfire report runs/contest --pdf --width-mm 88
  wildfire report runs/contest --metric truck_distance_m,truck_cusps --format tex > tables.tex

In PDF charts, text is outlined in the built-in font Arimo; in PGF charts it stays text,
which LaTeX sets in the paper's font.")]
pub struct ReportArguments {
    /// The folder of a batch.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Also write pages that play the runs with the least, median and most burned; unrecorded runs are simulated again.
    #[arg(long)]
    pub pages: bool,
    /// Limit charts and printed tables to these columns of runs.csv; may be repeated.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',')]
    pub metric: Vec<String>,
    /// With --format tex, md or html, also print a row for each run.
    #[arg(help_heading = "Papers", long, conflicts_with = "metric")]
    pub rows: bool,
    #[command(flatten)]
    pub paper: PaperArguments,
    #[command(flatten)]
    pub programs: ProgramArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire merge runs/big
  wildfire merge runs/big --wait --jobs 4")]
pub struct MergeArguments {
    /// The folder of a batch.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Wait for incomplete slices until no run has finished for this long: seconds, or `h:mm:ss` [default: 300].
    #[arg(
        long,
        value_name = "TIME",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "300",
        value_parser = parse_wait
    )]
    pub wait: Option<f64>,
    /// Number of threads [default: SLURM_CPUS_PER_TASK in a Slurm task, else the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    lock: LockArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

fn parse_wait(text: &str) -> Result<f64, String> {
    numbers::parse_time_within(text, &(0.0..=1e6))
}

/// Writes the tables of a batch whose slices were run one by one.
pub fn merge(arguments: &MergeArguments, quiet: bool) -> Result<ExitCode, CliError> {
    // A merge leaves the journals as they are, so that it can be repeated after a signal.
    interrupt::set_resumable();
    let folder = OutputFolder::existing(&arguments.folder)?.with_keeping(arguments.lock.keeping());
    let watch = interrupt::watch(interrupt::USUAL_TIDYING);
    let mut waiting = arguments.wait.map(|seconds| OthersWait::new(&folder, Duration::from_secs_f64(seconds), quiet));
    limit_threads(jobs_or_usual(arguments.jobs));
    let merged = loop {
        let error = match wildfire_batch::report::merge(&folder, &RealDisk, watch.stop()) {
            Ok(merged) => break merged,
            Err(error) => error,
        };
        let goes_on = match &mut waiting {
            // Waiting only helps where runs are missing; any other error stays.
            Some(waiting) if is_unfinished(&error) => waiting.until_it_is_worth_it(watch.stop())?,
            _ => false,
        };
        if !goes_on {
            return Err(merge_error(error, &folder, &arguments.lock));
        }
    };
    // From here on nothing has to be tidied up, and a signal may end the program at once.
    drop(watch);
    if !quiet {
        note_leftovers(&merged.leftovers);
        note_repeated(merged.repeated);
    }
    let object = BatchObject::new(&merged.plan, folder.path(), &merged.report);
    terminal::print(&arguments.form.render_either(&object, || summary(&merged.plan, &folder, &merged.report, None)))?;
    Ok(exit_code(merged.report.not_done()))
}

/// Says whether a batch may be merged later, when others have gone on with it.
fn is_unfinished(error: &BatchError) -> bool {
    matches!(
        error,
        BatchError::Incomplete { .. }
            | BatchError::SliceNotStarted { .. }
            | BatchError::NoJournal { .. }
            | BatchError::Plan(PlanError::Missing { .. })
            | BatchError::Journal(
                JournalError::Locked { .. } | JournalError::Changed { .. } | JournalError::Rewritten { .. }
            )
    )
}

/// A wait for the runs of other processes.
struct OthersWait<'a> {
    folder: &'a OutputFolder,
    patience: Duration,
    quiet: bool,
    survey: Option<JournalScan>,
    since_last_run: WallStopwatch,
}

impl<'a> OthersWait<'a> {
    /// The time between two looks.
    const LOOK: Duration = Duration::from_secs(1);

    fn new(folder: &'a OutputFolder, patience: Duration, quiet: bool) -> Self {
        Self { folder, patience, quiet, survey: None, since_last_run: WallStopwatch::start() }
    }

    /// Waits until no line of a run is missing, and says whether that came before the patience ended. That no line is
    /// missing may be wrong, as after a kill, and somebody may be at work yet: so each time takes one look at least.
    fn until_it_is_worth_it(&mut self, stop: &AtomicBool) -> Result<bool, CliError> {
        let mut missing = self.look()?;
        if let (Some(missing), false) = (&missing, self.quiet) {
            terminal::note(&format!("waiting for {}", missing_runs_text(missing, &self.number_of_slices())));
        }
        loop {
            // The patience is counted from the last run that ended, so a slow cluster is waited for while it works.
            if self.since_last_run.elapsed() > self.patience {
                return Ok(false);
            }
            if stop.load(Ordering::Relaxed) {
                return Err(BatchError::Stopped.into());
            }
            #[expect(clippy::disallowed_methods, reason = "other processes work in real time")]
            thread::sleep(Self::LOOK);
            if missing.as_ref().is_some_and(Vec::is_empty) {
                return Ok(true);
            }
            missing = self.look()?;
        }
    }

    /// Looks for runs that are missing; none if there is no plan or no journal yet.
    fn look(&mut self) -> Result<Option<Vec<MissingRuns>>, BatchError> {
        // A slice may not have started, so plan and journals are looked for again each time.
        if self.survey.is_none() {
            let plan = match BatchPlan::read(self.folder.path()) {
                Err(PlanError::Missing { .. }) => return Ok(None),
                plan => plan?,
            };
            self.survey = match JournalScan::new(self.folder, &plan) {
                Err(BatchError::NoJournal { .. }) => return Ok(None),
                survey => Some(survey?),
            };
        }
        let Some(survey) = &mut self.survey else { return Ok(None) };
        if survey.update()? > 0 {
            self.since_last_run = WallStopwatch::start();
        }
        Ok(Some(survey.missing()))
    }

    fn number_of_slices(&self) -> String {
        self.survey.as_ref().map_or("the".into(), |survey| survey.number_of_slices().to_string())
    }
}

/// Words what is missing, as `slices with missing runs, of 40: 3 lacks 12 of 150`.
fn missing_runs_text(missing: &[MissingRuns], of: &str) -> String {
    let lacking = missing.iter().map(|slice| match slice {
        MissingRuns { slice, missing, of } if missing == of => format!("{} has not begun", slice.number()),
        MissingRuns { slice, missing, of } => format!("{} lacks {missing} of {of}", slice.number()),
    });
    match list(lacking) {
        Some(list) => format!("{} of {of} slices with missing runs: {list}", missing.len()),
        None => "a process that is working on a slice".into(),
    }
}

fn merge_error(error: BatchError, folder: &OutputFolder, lock: &LockArguments) -> CliError {
    let first = match &error {
        BatchError::Incomplete { slice, .. } | BatchError::SliceNotStarted { slice, .. } => *slice,
        _ => {
            let path = shell_word(&folder.path().display().to_string());
            let merge = format!("wildfire merge {path}{}", lock.args());
            return CliError::from_batch_error(error, &merge);
        }
    };
    let survey =
        BatchPlan::read(folder.path()).map_err(BatchError::from).and_then(|plan| JournalScan::new(folder, &plan));
    let missing = survey.and_then(|mut survey| survey.update().map(|_| survey.missing())).unwrap_or_default();
    let command = resume_command(folder.path(), first) + &lock.args();
    // One slice has one command; several are quicker as an array.
    if missing.len() < 2 {
        return CliError::bad_input(error, Some(&format!("run it with: {command}")));
    }
    let numbers: Vec<u64> = missing.iter().map(|slice| slice.slice.number()).collect();
    let help = format!(
        "run the first with: {command}; or all of them as a Slurm array, with the original script: sbatch --array={} \
         SCRIPT",
        range_text(&numbers, "-")
    );
    CliError::bad_input(missing_runs_text(&missing, &first.of().to_string()), Some(&help))
}

/// Writes the page on a batch, and its charts.
pub fn report(arguments: &ReportArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let paper = arguments.paper.charts()?;
    let quantities = SelectedQuantities::new(&arguments.metric).map_err(report_error)?;
    let batch = FinishedBatch::open(&arguments.folder)?;
    // Pages of an earlier report are linked again.
    let playing = if arguments.pages { notable_runs(&batch) } else { runs_with_pages(&batch) }.map_err(report_error)?;
    let views = if arguments.pages { write_pages(&batch, &playing, context)? } else { Vec::new() };
    let field = median_field(&batch, &playing, &views, context)?;
    let parts = ReportParts { playing: &playing, field, quantities: &quantities, paper };
    let written = write_report(&batch, &parts).map_err(report_error)?;
    terminal::note_unknown_letters([written.unknown_letters.as_str()], context.quiet);
    if !arguments.form.is_text() {
        let shown = ShownTables { columns: &quantities.places(), rows: arguments.rows };
        let answer = ReportAnswer::new(batch.plan(), batch.folder(), &written);
        terminal::print(
            &arguments.form.render_either(&answer, || shown.document(batch.plan(), batch.folder(), &written)),
        )?;
        return Ok(ExitCode::SUCCESS);
    }
    let page = written.page.display();
    let charts = written.charts_folder.display();
    let forms = arguments.paper.forms();
    let mut document = Document::new(format!("{page}, and {} charts as {forms} in {charts}", written.charts.len()));
    document = document.with(written.tables.column_tables(&quantities.places()));
    document.add_list(written.refused);
    terminal::print(&document.to_text())?;
    Ok(ExitCode::SUCCESS)
}

/// The size of the picture of a field in a report, in pixels.
const FIELD: (u32, u32) = (1440, 900);

/// Draws the field at the end of the median run of a batch of one variant, if its page or its recording is there: nothing is
/// simulated for it.
fn median_field(
    batch: &FinishedBatch,
    playing: &[NotableRun],
    views: &[RunView],
    context: &CommandContext,
) -> Result<Option<FieldPicture>, CliError> {
    if batch.plan().variants.len() > 1 || views.is_empty() && !batch.runs().any(|run| batch.recording(&run).is_some()) {
        return Ok(None);
    }
    let found = if views.is_empty() { notable_runs(batch).map_err(report_error)? } else { playing.to_vec() };
    // Of one or two runs the median is the best.
    let median = found.iter().position(|run| run.word == "median").or_else(|| (!found.is_empty()).then_some(0));
    let Some(index) = median else { return Ok(None) };
    let run = batch.plan().run(found[index].number);
    // It is declared outside of the match, so that a run that is read lives as long as its view.
    let read;
    let view = match views.get(index) {
        Some(view) => view,
        None if batch.recording(&run).is_some() => {
            let options = context.run_options(true, batch.plan().memory);
            read = run_of_batch(batch, &run, Searches::Recorded, &options)?.into_view();
            &read
        }
        None => return Ok(None),
    };
    let options = ViewOptions::default();
    let request = FrameRequest { runs: &[view], time: view.end_time(), options: &options };
    let percent = 100.0 * found[index].burned_ratio;
    let caption = format!(
        "The field at the end of the {} run by share burned: seed {}, {percent:.1} % of the bushes burned.",
        found[index].word, run.seed
    );
    Ok(Some(FieldPicture { caption, png: still(&request, FIELD).to_png() }))
}

/// Writes a page for each of some runs, all or none, and returns what they show.
fn write_pages(
    batch: &FinishedBatch,
    playing: &[NotableRun],
    context: &CommandContext,
) -> Result<Vec<RunView>, CliError> {
    let mut runs = Vec::new();
    for notable in playing {
        let run = batch.plan().run(notable.number);
        // A recording starts no program.
        if batch.recording(&run).is_none() {
            context.expect_trusted(&run.variant.scenario)?;
        }
        let options = context.run_options(true, batch.plan().memory);
        runs.push(run_of_batch(batch, &run, Searches::Recorded, &options)?.into_view());
    }
    runs.iter().try_for_each(|run| check_grounds(&[run]))?;
    for (notable, run) in playing.iter().zip(&runs) {
        let path = batch.folder().join(notable.page());
        let folder = path.parent().unwrap_or(batch.folder());
        fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
        let options = ViewOptions::default();
        write_page(&FrameRequest { runs: &[run], time: SimTime::ZERO, options: &options }, &path)?;
        output_files::note_written(&path, context.quiet);
    }
    Ok(runs)
}

fn report_error(error: ReportError) -> CliError {
    match error {
        ReportError::Finished(error) => error.into(),
        ReportError::Unfinished { folder } => {
            let help = help_on_unfinished(&folder);
            CliError::bad_input(ReportError::Unfinished { folder }, help.as_deref())
        }
        ReportError::Unwritable { path, source } => CliError::unwritable(&path, &source),
        ReportError::Batch(error) => error.into(),
        error @ (ReportError::UnknownColumn { .. } | ReportError::NoNumbers { .. }) => {
            CliError::bad_input(error, Some("`wildfire schema runs` lists all columns"))
        }
    }
}

/// Shows a batch's progress, and how to continue it.
pub fn status(arguments: &StatusArguments) -> Result<ExitCode, CliError> {
    let folder = OutputFolder::existing(&arguments.folder)?.with_keeping(arguments.lock.keeping());
    let status = batch_status(&folder)?;
    let report = StatusReport {
        folder: folder.path().display().to_string(),
        variants: status.plan.variants.len(),
        seeds: status.plan.seeds.to_string(),
        planned: status.plan.count(),
        slices: status.slices.iter().map(SliceRow::new).collect(),
        failures: failures(&status),
        next_step: next_step(&folder, &status.slices, &arguments.lock),
    };
    terminal::print(&arguments.form.render(&report))?;
    Ok(ExitCode::SUCCESS)
}

/// The members in their order.
#[derive(Serialize)]
struct StatusReport {
    folder: String,
    variants: usize,
    seeds: String,
    planned: u64,
    slices: Vec<SliceRow>,
    /// The variants with failed runs.
    failures: Vec<FailureRow>,
    next_step: Option<String>,
}

#[derive(Serialize)]
struct FailureRow {
    variant: String,
    failed: u64,
    /// The seed of the first failed run, and the reason.
    seed: u64,
    message: String,
}

fn failures(status: &BatchStatus) -> Vec<FailureRow> {
    let rows = status.failures.iter().map(|(&variant, failed)| FailureRow {
        variant: status.plan.title(&status.plan.variants[variant as usize]),
        failed: failed.count,
        seed: status.plan.run(failed.first).seed,
        message: failed.message.clone(),
    });
    rows.collect()
}

/// The most variants with failed runs that are listed.
const LISTED_FAILURES: usize = 5;

#[derive(Serialize)]
struct SliceRow {
    slice: String,
    planned: u64,
    /// Runs with a result.
    finished: u64,
    /// Runs without one.
    failed: u64,
    /// Rows that are there twice.
    repeated: u64,
    state: &'static str,
}

impl SliceRow {
    fn new((slice, state): &(Slice, SliceState)) -> Self {
        let word = match state {
            SliceState { is_running: true, .. } => "running",
            SliceState { runs, stored, .. } if runs == stored => "complete",
            SliceState { stored: 0, .. } => "not begun",
            _ => "stopped",
        };
        let slice = if slice.is_whole() { "whole".to_owned() } else { slice.to_string() };
        let SliceState { runs: planned, stored, not_done: failed, repeated, .. } = *state;
        Self { slice, planned, finished: stored - failed, failed, repeated, state: word }
    }
}

/// The most slices that are listed one by one.
const LISTED_SLICES: usize = 60;

impl From<&StatusReport> for Document {
    fn from(report: &StatusReport) -> Self {
        let StatusReport { folder, variants, seeds, planned, slices, failures, next_step } = report;
        // Of many slices those count that are not as they should be in the end.
        let rows: Vec<_> = slices
            .iter()
            .filter(|slice| slices.len() <= LISTED_SLICES || slice.state != "complete")
            .take(LISTED_SLICES)
            .map(|slice| {
                let SliceRow { slice, planned, finished, failed, state, .. } = slice;
                vec![slice.clone(), planned.to_string(), finished.to_string(), failed.to_string(), (*state).to_owned()]
            })
            .collect();
        let listed = rows.len();
        let table = (listed > 0).then(|| Table::new(&["Slice", "Planned", "Finished", "Failed", "State"], rows));
        let sum = |count: fn(&SliceRow) -> u64| slices.iter().map(count).sum::<u64>();
        let [finished, failed] = [sum(|slice| slice.finished), sum(|slice| slice.failed)];
        let left = planned - finished - failed;
        let mut sentences =
            vec![format!("{finished} of {planned} runs finished, {failed} failed, {left} still to run.")];
        sentences.extend(failures.iter().take(LISTED_FAILURES).map(|failure| {
            let FailureRow { variant, failed, seed, message } = failure;
            format!("{variant}: {} failed; the first, seed {seed}: {message}", count(*failed as usize, "run"))
        }));
        if failures.len() > LISTED_FAILURES {
            let more = count(failures.len() - LISTED_FAILURES, "more variant");
            sentences.push(format!("Runs of {more} failed too; `--format json` lists all reasons."));
        }
        if listed < slices.len() {
            let complete = slices.iter().filter(|slice| slice.state == "complete").count();
            sentences.push(format!("{complete} of {} slices are complete.", slices.len()));
        }
        let repeated = sum(|slice| slice.repeated);
        if repeated > 0 {
            sentences.push(format!("{repeated} rows appear twice, with equal values except for measured ones."));
        }
        Self::new(format!("{folder}: {}, seeds {seeds}", count(*variants, "variant")))
            .with(table)
            .with([Block::List(sentences)])
            .with(next_step.iter().map(|step| Block::Verbatim(step.clone())))
    }
}

fn next_step(folder: &OutputFolder, slices: &[(Slice, SliceState)], lock: &LockArguments) -> Option<String> {
    if folder.path().join(RUNS_FILE).exists()
        && slices.iter().all(|(_, state)| state.stored == state.runs && !state.is_running)
    {
        return Some("The tables are written.".into());
    }
    let NextCommand { purpose, command } = next_command(folder.path(), slices, &lock.args())?;
    Some(format!("{purpose} with: {command}"))
}
