//! `wildfire batch` and what follows it: `status`, `merge` and `report`, which take the folder of a batch.

mod answer;
mod args;
mod estimates;
mod folder;
mod keeping;
mod slurm;

pub use answer::{BatchObject, PlanAnswer, ReportAnswer, SliceAnswer};
pub use args::{BatchArguments, SeedsArgument, parse_seeds};
pub use folder::{MergeArguments, ReportArguments, StatusArguments, merge, report, status};

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::cli::args::jobs_or_usual;
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::next_command::resume_command;
use crate::cli::terminal::Progress;
use crate::cli::why::judge_runs;
use crate::cli::{interrupt, terminal};
use answer::summary;
use args::RUNS_FOLDER;
use estimates::Estimates;
use keeping::LockArguments;
use wildfire_base::document::{Block, Document};
use wildfire_batch::decisions::SelectedDecisions;
use wildfire_batch::execute::{Batch, BatchError, Found, OutputFolder, Status, limit_threads};
use wildfire_batch::plan::{
    BatchPlan, BatchRequest, CoursePlan, CourseRefusal, CourseRequest, PROGRAM_VERSION, RequestError, Slice, shell_word,
};
use wildfire_batch::stopping::{PlayedBatch, USUAL_MAX_SEEDS};
use wildfire_batch::table::FinishedBatch;
use wildfire_scenario::ScenarioText;

/// The most variants that a dry run lists.
const LISTED_VARIANTS: usize = 50;

/// The most files that a note lists.
const LISTED_FILES: usize = 10;

pub fn run(arguments: &BatchArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    arguments.form.expect_no_json_with("--profile", arguments.profile)?;
    arguments.form.expect_no_json_with("--decisions", arguments.why.is_some())?;
    // This comes before anything is read, as a wrong `K/N` is an error of the command line alone.
    let slice = arguments.slice()?;
    let mut left_out = 0;
    let batch = match &arguments.resume {
        Some(folder) => {
            interrupt::set_resumable();
            let path = OutputFolder::existing(folder)?.with_keeping(arguments.keeping.keeping());
            // What is wrong with the folder itself, resuming says better.
            if let Ok(plan) = BatchPlan::read(path.path()) {
                context.expect_trusted_plan(&plan)?;
            }
            let batch = Batch::resume(path, slice)?;
            batch.plan().expect_registry(&context.registry, folder).map_err(BatchError::from)?;
            batch
        }
        None => {
            if arguments.slurm.slurm {
                slurm::refuse_pipes(arguments)?;
            }
            let plan = match &arguments.rules {
                Some(rules) => {
                    let course = plan_of_course(arguments, rules)?;
                    course.left_out.iter().for_each(|fault| terminal::note(&format!("skipped: {fault}")));
                    left_out = course.left_out.len() as u64;
                    with_rule(arguments, course.plan)?
                }
                None => match frozen_plan(arguments)? {
                    Some(plan) => {
                        plan.expect_registry(&context.registry, Path::new(&arguments.sources[0]))
                            .map_err(BatchError::from)?;
                        plan
                    }
                    None => plan(arguments, context)?,
                },
            };
            // Before anything is written: a plan may run programs.
            context.expect_trusted_plan(&plan)?;
            context.note_doubts(plan.variants.iter().map(|variant| &variant.scenario));
            if arguments.slurm.slurm {
                terminal::print(&slurm::script(arguments, &plan, context)?)?;
                return Ok(ExitCode::SUCCESS);
            }
            if arguments.dry_run {
                terminal::print(&arguments.form.render_either(&plan_answer(&plan), || dry_run(&plan)))?;
                return Ok(exit_code(left_out));
            }
            let batch = begin(arguments, plan, slice)?;
            // From here on an interrupt leaves a folder that can be resumed.
            interrupt::set_resumable();
            batch
        }
    };
    if !context.quiet {
        note_repairs(batch.found());
    }
    let resume = resume_command(batch.folder().path(), slice) + &arguments.keeping.args();
    // Every error from here on ends with the command that resumes.
    // The folder has a plan by now, so every error can be answered by resuming.
    let from_batch = |error| CliError::from_batch_error(error, &resume);
    let jobs = jobs_or_usual(arguments.jobs);
    // Signals are watched from here on: until now, one leaves nothing that has to be tidied up.
    let watch = interrupt::watch(arguments.keeping.longest_tidying());
    let PlayedBatch { batch, look } = run_with_progress(batch, jobs, watch.stop(), context).map_err(from_batch)?;
    // Tables are those of the whole batch: a slice is merged later.
    if !batch.progress().slice().is_whole() {
        drop(watch);
        terminal::print(&arguments.form.render(&slice_summary(&batch, &arguments.keeping.lock)))?;
        return Ok(exit_code(batch.progress().not_done()));
    }
    // Tables are made by as many threads as runs were.
    limit_threads(jobs);
    let report = batch.finish(watch.stop()).map_err(from_batch)?;
    // Nothing is written any more, so a signal may end the program at once.
    drop(watch);
    let document = || {
        let document = summary(batch.plan(), batch.folder(), &report, look.as_ref());
        if arguments.profile { document.with(report.profile().blocks) } else { document }
    };
    let object = BatchObject::new(batch.plan(), batch.folder().path(), &report);
    terminal::print(&arguments.form.render_either(&object, document))?;
    if let Some(sample) = arguments.why {
        let finished = FinishedBatch::open(batch.folder().path())?;
        let options = context.run_options(false, finished.plan().memory);
        judge_runs(&finished, &SelectedDecisions::sample(sample), &options, arguments.form, context)?;
    }
    Ok(exit_code(report.not_done() + left_out))
}

/// Plays all runs of a plan in a new folder, and writes their tables.
pub fn play_plan(
    plan: BatchPlan,
    folder: &Path,
    jobs: usize,
    context: &CommandContext,
) -> Result<FinishedBatch, CliError> {
    let batch = Batch::begin(plan, OutputFolder::named(folder, false)?)?;
    let resume = resume_command(batch.folder().path(), Slice::WHOLE);
    let stop = Arc::new(AtomicBool::new(false));
    let played = run_with_progress(batch, jobs, &stop, context).and_then(|played| played.batch.finish(&stop));
    played.map_err(|error| CliError::from_batch_error(error, &resume))?;
    Ok(FinishedBatch::open(folder)?)
}

/// Makes the plan of a course.
fn plan_of_course(arguments: &BatchArguments, rules: &Path) -> Result<CoursePlan, CliError> {
    let request = CourseRequest {
        rules: rules.to_owned(),
        entries: arguments.entry.clone(),
        seeds: arguments.seeds.as_ref().map(SeedsArgument::seeds).transpose()?,
        record: arguments.record,
        skips_refused: arguments.skip_refused,
    };
    request.resolve(arguments.force).map_err(|refusal| match refusal {
        CourseRefusal::Request(refusal) => refusal.into(),
        CourseRefusal::Entries(faults) => {
            let [first, others @ ..] = &faults[..] else { unreachable!("there is an entry, and it is refused") };
            others.iter().rev().for_each(|fault| terminal::note(&fault.to_string()));
            let help = if arguments.entry.len() > 1 { Some("--skip-refused runs the other entries") } else { None };
            CliError::bad_input(first, help)
        }
        CourseRefusal::Rules(fault) => match fault.unreadable {
            Some(kind) => CliError::from_input_error(fault, kind),
            None => CliError::bad_input(fault, None),
        },
        refusal @ CourseRefusal::TooManyEntries { .. } => CliError::bad_input(refusal, None),
    })
}

/// Reads the plan of another batch, `plan.json` as it lies in its folder, which says all that decides the runs.
fn frozen_plan(arguments: &BatchArguments) -> Result<Option<BatchPlan>, CliError> {
    let [source] = &arguments.sources[..] else { return Ok(None) };
    // The ending decides, since a plan file in TOML may have any name.
    if !Path::new(source).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        return Ok(None);
    }
    let changes = [
        ("--set", !arguments.set.is_empty()),
        ("--planner", !arguments.planner.is_empty()),
        ("--seeds", arguments.seeds.is_some()),
        ("--record", arguments.record.is_some()),
        ("--memory", arguments.memory.is_some()),
        ("--until", arguments.until.is_some()),
    ];
    // A plan that is run again must give the same runs, which any of these options would prevent.
    if let Some((option, _)) = changes.into_iter().find(|(_, is_set)| *is_set) {
        let sentence = format!("{option} would change {source}, the plan of a batch that has run; leave {option} out");
        return Err(CliError::bad_input(sentence, Some("a plan file in TOML can be changed: wildfire new plan")));
    }
    Ok(Some(BatchPlan::read_file(source.into()).map_err(BatchError::from)?))
}

/// Makes the plan, from options, or from a plan file and options that change it.
fn plan(arguments: &BatchArguments, context: &CommandContext) -> Result<BatchPlan, CliError> {
    let mut request = request_from(&arguments.sources)?;
    request.changes = context.with_custom_names(&request.changes);
    let options = arguments.set.iter().try_for_each(|option| request.add_option(option));
    options.and_then(|()| request.add_planners(&arguments.planner)).map_err(RequestError::from)?;
    if let Some(seeds) = &arguments.seeds {
        request.seeds = Some(seeds.seeds()?);
    } else if arguments.until.is_some() && request.seeds.is_none() {
        request.seeds = Some(USUAL_MAX_SEEDS.parse().expect("a range"));
    }
    request.record = arguments.record.or(request.record);
    request.memory = arguments.memory.or(request.memory);
    with_rule(arguments, request.resolve(arguments.force)?)
}

/// Adds the stopping rule, if one is asked for.
fn with_rule(arguments: &BatchArguments, plan: BatchPlan) -> Result<BatchPlan, CliError> {
    let until = arguments.stop_request().map(|request| request.rule(&plan)).transpose();
    let until = until.map_err(|error| CliError::bad_input(&error, error.help()))?;
    Ok(BatchPlan { until, ..plan })
}

fn request_from(sources: &[String]) -> Result<BatchRequest, CliError> {
    let mut texts = Vec::new();
    for source in sources {
        let text = ScenarioText::open(source)?;
        match BatchRequest::from_text(&text)? {
            // A plan file says all by itself; beside other inputs it would be unclear which of its values hold for them.
            Some(request) if sources.len() == 1 => return Ok(request),
            Some(_) => {
                let sentence = format!("{source} is a plan, which names its scenarios; expected no other inputs");
                return Err(CliError::bad_input(sentence, None));
            }
            None => texts.push(text),
        }
    }
    let scenarios = if sources.is_empty() { vec!["contest".to_owned()] } else { sources.to_vec() };
    Ok(BatchRequest { scenarios, texts, ..BatchRequest::default() })
}

fn begin(arguments: &BatchArguments, plan: BatchPlan, slice: Slice) -> Result<Batch, CliError> {
    let name = &plan.variants[0].scenario.name;
    let folder = match &arguments.out {
        Some(path) if slice.is_whole() => OutputFolder::named(path, arguments.force)?,
        Some(path) => OutputFolder::shared(path)?,
        None => OutputFolder::next_free(Path::new(RUNS_FOLDER), name)?,
    };
    let folder = folder.with_keeping(arguments.keeping.keeping());
    Ok(if slice.is_whole() { Batch::begin(plan, folder)? } else { Batch::join(plan, folder, slice)? })
}

/// Returns the exit code of a batch with this many failed runs.
fn exit_code(not_done: u64) -> ExitCode {
    if not_done == 0 { ExitCode::SUCCESS } else { ExitCode::from(exit::RUN_FAILED) }
}

/// Notes what was found damaged and has been repaired.
fn note_repairs(found: &Found) {
    if found.has_torn_line {
        terminal::note("dropped the incomplete last line of the journal; its run is repeated");
    }
    note_leftovers(&found.leftovers);
    note_repeated(found.repeated);
    let lost = found.lost_recordings.iter().map(|lost| format!("{} ({})", lost.path.display(), lost.reason));
    if let Some(list) = list(lost) {
        terminal::note(&format!("repeating runs whose recordings are missing: {list}"));
    }
}

/// Says which files were removed that were only half written.
fn note_leftovers(leftovers: &[PathBuf]) {
    if let Some(list) = list(leftovers.iter().map(|path| path.display().to_string())) {
        terminal::note(&format!("removed files left by a killed process: {list}"));
    }
}

/// Says that two processes made the same runs.
fn note_repeated(repeated: u64) {
    if repeated > 0 {
        terminal::note(&format!(
            "{repeated} rows appear twice and count once: two processes worked on one slice, and their rows are equal \
             except for measured values"
        ));
    }
}

/// The first things of many; `None` if there are none.
fn list(things: impl ExactSizeIterator<Item = String>) -> Option<String> {
    let more = things.len().saturating_sub(LISTED_FILES);
    let listed = things.take(LISTED_FILES).collect::<Vec<_>>().join(", ");
    match more {
        _ if listed.is_empty() => None,
        0 => Some(listed),
        more => Some(format!("{listed} and {more} more")),
    }
}

fn run_with_progress(
    batch: Batch,
    jobs: usize,
    stop: &Arc<AtomicBool>,
    context: &CommandContext,
) -> Result<PlayedBatch, BatchError> {
    let stored = batch.progress().stored();
    let mut not_done = batch.progress().not_done();
    let lost = batch.found().lost_recordings.len() as u64;
    let progress = Progress::new(batch.progress().count() + lost, "runs", context.quiet).resumed(stored);
    // Only of a batch from its beginning, whose runs are all still to come.
    let is_new = stored == 0 && batch.progress().slice().is_whole() && !context.quiet;
    let mut estimates = is_new.then(|| Estimates::new(batch.plan(), jobs));
    let plan = batch.plan().clone();
    let simulation = batch.simulation(&context.registry);
    let done = batch.run_until(
        simulation,
        jobs,
        stop,
        |end| {
            if let Some(sentence) = estimates.as_mut().and_then(|estimates| estimates.sentence(end)) {
                progress.note(&sentence);
            }
            if end.status != Status::Done {
                not_done += 1;
                progress.say(format!("({not_done} failed)"));
            }
            progress.advance();
        },
        |look| progress.say(look.progress(&plan)),
    );
    progress.end();
    done
}

fn slice_summary(batch: &Batch, lock: &LockArguments) -> SliceAnswer {
    let progress = batch.progress();
    let slice = progress.slice().to_string();
    let folder = batch.folder().path().display().to_string();
    let merge = format!("wildfire merge {}{}", shell_word(&folder), lock.args());
    let runs = progress.stored();
    SliceAnswer { program_version: PROGRAM_VERSION, folder, slice, runs, not_done: progress.not_done(), merge }
}

/// Lists what a plan would run.
fn dry_run(plan: &BatchPlan) -> Document {
    let variants = plan.variants.len();
    let seeds = plan.seeds.count();
    let title = format!("{variants} variants x {seeds} seeds ({}) = {} runs", plan.seeds, plan.count());
    let mut lines: Vec<String> = plan
        .variants
        .iter()
        .enumerate()
        .take(LISTED_VARIANTS)
        .map(|(index, variant)| {
            let first = index as u64 * seeds + 1;
            format!("runs {first} to {}: {}", first + seeds - 1, plan.title(variant))
        })
        .collect();
    if variants > LISTED_VARIANTS {
        lines.push(format!("and {} more", variants - LISTED_VARIANTS));
    }
    lines.push(format!("plan {}", plan.content_sha256()));
    Document::new(title).with([Block::List(lines)])
}

fn plan_answer(plan: &BatchPlan) -> PlanAnswer {
    PlanAnswer {
        program_version: PROGRAM_VERSION,
        content_sha256: plan.content_sha256(),
        seeds: plan.seeds.to_string(),
        runs: plan.count(),
        variants: plan.variants.iter().map(|variant| plan.title(variant)).collect(),
    }
}
