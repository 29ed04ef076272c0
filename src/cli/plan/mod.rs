//! `wildfire plan`: drives of the truck by any planners, with their figures, and paths that others can check.

mod attempts;
mod drive;
mod ompl;
mod problems;
mod repeat;
mod report;
mod tables;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

pub use attempts::{Attempt, Question, attempts};
pub use drive::missed;
pub use problems::{ProblemArguments, goal_count, no_truck};
pub use report::{mean, quantile, shortened};

use repeat::Repeat;
use report::{PlanReport, Summary};

use crate::batch::file_name_of;
use crate::cli::args::{MemoryArguments, ProgramArguments};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{self, Files, Format};
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use crate::input_file::is_standard_stream;
use crate::planning::{PlannerName, TruckPlannerKind};
use crate::scenario::{LoadedScenario, Problem};

const EXAMPLES: &str = "\
Examples:
  wildfire plan
  wildfire plan --goals 5 --planner prm-rs,hybrid-astar --png drives.png
  wildfire plan --scenario dense --seed 7 --cells 50
  wildfire plan field_*.json --planner hybrid-astar --csv drives.csv
  wildfire plan field.json --set unimog.hybrid.shortcuts=0 --paths paths.csv";

#[derive(Debug, Args)]
#[command(after_help = format!("Planners: {}.\n\n{EXAMPLES}", TruckPlannerKind::names()))]
pub struct PlanArguments {
    #[command(flatten)]
    pub problems: ProblemArguments,
    /// The planner; several names, with commas or repeated, are compared [default: the scenario's].
    #[arg(long = "planner", value_name = "NAME", value_delimiter = ',')]
    pub planners: Vec<PlannerName>,
    /// The scenario whose first truck's settings planners have: a file, or a built-in name.
    #[arg(long, value_name = "SCENARIO", default_value = "drives")]
    pub scenario: String,
    /// Change a value of the scenario, such as `unimog.hybrid.clearance_m=1`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
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

pub fn run(arguments: &PlanArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_own_names(&arguments.overrides))?;
    let problems = arguments.problems.load(&loaded.scenario)?;
    let planners = planners(arguments, &problems);
    let pictures = pictures(arguments, &problems);
    let words = files(arguments, &pictures).check()?;
    let report = report(arguments, context, &loaded, (&problems, &planners))?;
    let printed = words.print(&arguments.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = write_files(arguments, &report, &pictures, context.quiet);
    printed.and(written)?;
    let is_clean = report.summaries.iter().all(|summary| summary.violations == 0);
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

/// Returns the report as an object, and writes nothing.
pub fn object(arguments: &PlanArguments, context: &CommandContext) -> Result<String, CliError> {
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_own_names(&arguments.overrides))?;
    let problems = arguments.problems.load(&loaded.scenario)?;
    let planners = planners(arguments, &problems);
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

/// The planners that were named, each once, or else the truck's own.
fn planners(arguments: &PlanArguments, problems: &[Problem]) -> Vec<PlannerName> {
    let own = problems.iter().take(1).map(|problem| problem.truck.planner.clone());
    let named = arguments.planners.iter().cloned();
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
    pictures: &[PathBuf],
    quiet: bool,
) -> Result<(), CliError> {
    let tables = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| tables::write_rows(path, &report.attempts)),
            (arguments.paths.as_deref(), &|path| tables::write_paths(path, &report.attempts)),
            (arguments.ompl.as_deref(), &|path| ompl::write_log(path, report)),
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
