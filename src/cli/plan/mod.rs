//! `wildfire plan`: drives of the truck by any planners, with their figures, and paths that others can check.

mod attempts;
mod benchmark;
mod drive;
mod ompl;
mod problems;
mod repeat;
mod report;
mod tables;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand};

pub use attempts::{Attempt, Question, attempts};
pub use drive::missed;
pub use problems::{ProblemArguments, goal_count, no_truck};
pub use report::{mean, quantile, shortened};

use benchmark::{PlanReportArguments, Query};
use ompl::{OmplLog, OmplPlanner, OmplRun, Started, program_limit_s};
use repeat::Repeat;
use report::{PlanReport, Summary, planner_settings};

use crate::batch::file_name_of;
use crate::cli::args::{MemoryArguments, ProgramArguments, parse_jobs};
use crate::cli::batch::{SeedsArgument, parse_seeds};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{self, Files, Format};
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use crate::input_file::is_standard_stream;
use crate::planning::{PlannerName, TruckPlannerKind};
use crate::scenario::{LoadedScenario, Problem, Scenario};

const EXAMPLES: &str = "\
Examples:
  wildfire plan
  wildfire plan --goals 5 --planner prm-rs,hybrid-astar --png drives.png
  wildfire plan --scenario dense --seed 7 --cells 50
  wildfire plan field_*.json --planner hybrid-astar --csv drives.csv
  wildfire plan field.json --set unimog.hybrid.shortcuts=0 --paths paths.csv
  wildfire plan --seeds 1..30 --set field.coverage=0.05,0.10 --planner all --report bench
  wildfire plan report bench --pdf";

#[derive(Debug, Args)]
#[command(
    after_help = format!("Planners: {}.\n\n{EXAMPLES}", TruckPlannerKind::names()),
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
pub struct PlanArguments {
    #[command(subcommand)]
    pub command: Option<PlanCommand>,
    #[command(flatten)]
    pub problems: ProblemArguments,
    /// The planner; several names, with commas or repeated, are compared, and `all` is every one that is known [default:
    /// the scenario's].
    #[arg(long = "planner", value_name = "NAME", value_delimiter = ',')]
    pub planners: Vec<PlannerName>,
    /// The scenario whose first truck's settings planners have: a file, or a built-in name.
    #[arg(long, value_name = "SCENARIO", default_value = "drives")]
    pub scenario: String,
    /// Change a value of the scenario, such as `unimog.hybrid.clearance_m=1`; with several values between commas, ask for
    /// the drives with each. Several such keys are multiplied; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE[,VALUE...]")]
    pub overrides: Vec<String>,
    /// Seeds, each with a field, goals and random draws of its own, in place of one: ranges with both ends, lists, or both,
    /// such as `1..30` or `1,5,9`; or `@FILE` that holds them.
    #[arg(help_heading = "Benchmarks", long, conflicts_with = "seed", allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    /// Threads that share the seeds and variants of a benchmark; they slow each other, which CPU times show [default: 1].
    #[arg(help_heading = "Benchmarks", short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Write all queries and a page with tables and charts into this folder; `wildfire plan report DIR` writes the page again.
    #[arg(help_heading = "Benchmarks", long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    /// Ask all planners twice, programs in another process, and say whether their answers repeat bit for bit.
    #[arg(long)]
    pub repeat: bool,
    #[command(flatten)]
    pub memory: MemoryArguments,
    #[command(flatten)]
    pub form: FormArguments,
    /// Write a row for each goal and planner.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write poses along the paths, at most 5 cm apart: field,goal,planner,s_m,x_m,y_m,heading_rad,direction.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub paths: Option<PathBuf>,
    /// Write a benchmark log of OMPL, for Planner Arena.
    #[arg(help_heading = "Output", long, value_name = "FILE.log")]
    pub ompl: Option<PathBuf>,
    /// Draw field and paths; of several fields into a file each, FILE-FIELD.png.
    #[arg(help_heading = "Output", long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
}

/// Commands on what was planned before.
#[derive(Debug, Subcommand)]
pub enum PlanCommand {
    /// Write a page on a table of queries: medians, box plots, and curves over what is swept.
    Report(PlanReportArguments),
}

pub fn run(arguments: &PlanArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    if let Some(PlanCommand::Report(report)) = &arguments.command {
        return benchmark::report(report, context.quiet);
    }
    if benchmark::is_meant(arguments)? {
        return benchmark::run(arguments, context);
    }
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_own_names(&arguments.overrides))?;
    let problems = arguments.problems.load(&loaded.scenario)?;
    let planners = asked_planners(arguments, &loaded.scenario);
    let pictures = pictures(arguments, &problems);
    let words = files(arguments, &pictures).check()?;
    let started = arguments.ompl.as_ref().map(|_| Started::now()).transpose()?;
    let report = report(arguments, context, &loaded, (&problems, &planners))?;
    let printed = words.print(&arguments.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = write_files(arguments, &report, (&pictures, started), context.quiet);
    printed.and(written)?;
    let is_clean = report.summaries.iter().all(|summary| summary.violations == 0);
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

/// Returns the report as an object, and writes nothing.
pub fn object(arguments: &PlanArguments, context: &CommandContext) -> Result<String, CliError> {
    if arguments.command.is_some() {
        return Err(CliError::bad_input("`report` writes a page; expected arguments of drives to plan", None));
    }
    if benchmark::is_meant(arguments)? {
        return benchmark::object(arguments, context);
    }
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_own_names(&arguments.overrides))?;
    let problems = arguments.problems.load(&loaded.scenario)?;
    let planners = asked_planners(arguments, &loaded.scenario);
    let report = report(arguments, context, &loaded, (&problems, &planners))?;
    Ok(FormArguments { json: true, ..FormArguments::default() }.render(&report))
}

/// Asks all planners on all problems.
fn report<'a>(
    arguments: &'a PlanArguments,
    context: &CommandContext,
    loaded: &'a LoadedScenario,
    (problems, planners): (&'a [Problem], &'a [PlannerName]),
) -> Result<PlanReport<'a>, CliError> {
    context.expect_known_planners(&loaded.scenario, planners)?;
    context.expect_trusted_planners(&loaded.scenario, planners)?;
    let ask = || {
        // Programs start anew each time, those too that could play on.
        let makers = context.planners_of(&loaded.scenario, arguments.problems.seed)?;
        let question = Question {
            planners,
            makers: &makers,
            programs: &loaded.scenario.planner,
            seed: arguments.problems.seed,
            limit: arguments.memory.limit(),
        };
        let mut all = Vec::new();
        for problem in problems {
            let failed = |error| CliError::run_failed(format_args!("planning on the field {}: {error}", problem.name));
            all.extend(attempts(problem, &question).map_err(failed)?);
        }
        Ok::<_, CliError>(all)
    };
    let all = ask()?;
    let again = if arguments.repeat { Some(ask()?) } else { None };
    let repeats = again.map(|again| planners.iter().map(|planner| Repeat::new(planner, &all, &again)).collect());
    let summaries = planners.iter().map(|planner| Summary::new(planner, &all)).collect();
    Ok(PlanReport {
        loaded,
        changes: &arguments.overrides,
        seed: arguments.problems.seed,
        problems,
        planners,
        attempts: all,
        repeats,
        summaries,
    })
}

/// The name that is every known planner's.
const ALL_PLANNERS: &str = "all";

/// Returns the planners that were named, each once, or else the first truck's own.
fn asked_planners(arguments: &PlanArguments, scenario: &Scenario) -> Vec<PlannerName> {
    let own = scenario.unimog.iter().take(1).map(|truck| truck.planner.clone());
    let known = || TruckPlannerKind::ALL.map(PlannerName::from).into_iter().chain(scenario.planner.keys().cloned());
    let named = arguments.planners.iter().flat_map(|name| match name.name() {
        ALL_PLANNERS => known().collect(),
        _ => vec![name.clone()],
    });
    let mut planners = Vec::new();
    for planner in named.chain(own.filter(|_| arguments.planners.is_empty())) {
        if !planners.contains(&planner) {
            planners.push(planner);
        }
    }
    planners
}

/// Returns the file of each field's picture, if they were asked for: the file named, or one beside it for each of
/// several fields. Only one picture can go to stdout.
fn pictures(arguments: &PlanArguments, problems: &[Problem]) -> Vec<PathBuf> {
    let Some(path) = &arguments.png else { return Vec::new() };
    if problems.len() == 1 || is_standard_stream(path) {
        return vec![path.clone(); problems.len()];
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or(String::new(), |extension| format!(".{}", extension.to_string_lossy()));
    let name = |problem: &Problem| format!("{stem}-{}{extension}", file_name_of(&problem.name));
    problems.iter().map(|problem| path.with_file_name(name(problem))).collect()
}

fn files<'a>(arguments: &'a PlanArguments, pictures: &'a [PathBuf]) -> Files<'a> {
    let inputs =
        arguments.problems.fields.iter().map(PathBuf::as_path).chain([Path::new(&arguments.scenario)]).collect();
    let outputs = pictures.iter().map(|picture| (Format::Png, picture.as_path())).collect();
    let (csv, paths, ompl) = (&arguments.csv, &arguments.paths, &arguments.ompl);
    let tables = [(Format::Csv, csv), (Format::Csv, paths), (Format::OmplLog, ompl)];
    Files { inputs, outputs, form: arguments.form }.writing(tables)
}

fn write_files(
    arguments: &PlanArguments,
    report: &PlanReport,
    (pictures, started): (&[PathBuf], Option<Started>),
    quiet: bool,
) -> Result<(), CliError> {
    let tables = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| tables::write_rows(path, &report.attempts)),
            (arguments.paths.as_deref(), &|path| tables::write_paths(path, &report.attempts)),
            (arguments.ompl.as_deref(), &|path| ompl_log(arguments, report, started).write(path)),
        ],
        quiet,
    );
    let drawn = report.problems.iter().zip(pictures).map(|(problem, picture)| {
        let draw = |path: &Path| report.draw(problem).write_png(path);
        output_files::write_all(&[(Some(picture), &draw)], quiet)
    });
    // All are tried; the error is the first.
    let written = drawn.fold(tables, Result::and);
    let names = report.problems.iter().zip(pictures).map(|(problem, _)| problem.name.as_str());
    terminal::note_unknown_letters(names, quiet);
    written
}

/// The log of all attempts: a planner for each that was asked.
fn ompl_log<'a>(arguments: &PlanArguments, report: &'a PlanReport, started: Option<Started>) -> OmplLog<'a> {
    let problem = |problem: &Problem| {
        let (frame, goals) = (problem.terrain.frame, problem.goals.len());
        format!("field {}, {} x {} m, {goals} goals", problem.name, frame.width_m(), frame.height_m())
    };
    let planner = |planner: &'a PlannerName| {
        let own = report.attempts.iter().filter(|attempt| attempt.planner == *planner);
        let run = |attempt: &Attempt| OmplRun {
            problem: report.number_of(attempt.problem),
            seed: report.seed,
            query: Query::new(attempt, None, 0),
            has_violation: attempt.drive.as_ref().is_ok_and(|drive| drive.violation.is_some()),
        };
        let settings = planner_settings(planner, report.loaded);
        OmplPlanner { name: planner.name(), settings, runs: own.map(run).collect() }
    };
    OmplLog {
        scenario: &report.loaded.scenario.name,
        seed: report.seed,
        started,
        memory: arguments.memory.limit(),
        program_limit_s: program_limit_s(report.planners, &report.loaded.scenario.planner),
        problems: report.problems.iter().map(problem).collect(),
        planners: report.planners.iter().map(planner).collect(),
    }
}
