//! `wildfire plan`: drives of the truck by any planners, with their figures, and paths that others can check.

mod arguments;
mod benchmark;
mod ompl;
mod paths_file;
mod repeat;
mod report;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use arguments::{PlanArguments, goal_count};

use arguments::PlanCommand;
use ompl::{OmplLog, OmplPlanner, OmplRun, Started, program_limit_s};
use repeat::Repeat;
use report::{PlanReport, planner_settings};

use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{self, Files, Format};
use crate::cli::terminal;
use crate::cli::together;
use wildfire_base::input_file::is_standard_stream;
use wildfire_batch::drives::{
    AttemptSettings, CertificateFile, DriveTable, PlannerSummary, ask_all, expect_planners_exist, requested_planners,
};
use wildfire_batch::execute::file_name_of;
use wildfire_planning::PlannerName;
use wildfire_scenario::{LoadedScenario, Problem};

pub fn run(arguments: &PlanArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    if let Some(PlanCommand::Report(report)) = &arguments.command {
        return benchmark::report(report, context.quiet);
    }
    if !arguments.together.together.is_empty() {
        return together::run(&arguments.together, arguments.problems.seed, arguments.form, &arguments.csv, context);
    }
    if benchmark::matches(arguments)? {
        return benchmark::run(arguments, context);
    }
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_custom_names(&arguments.overrides))?;
    let problems = arguments.problems.problems().load(&loaded.scenario, arguments.problems.seed)?;
    let planners = requested_planners(&arguments.planners, &loaded.scenario);
    let pictures = pictures(arguments, &problems);
    let stream = files(arguments, &pictures).check()?;
    let started = arguments.ompl.as_ref().map(|_| Started::now()).transpose()?;
    let report = report(arguments, context, &loaded, (&problems, &planners))?;
    let printed = stream.print(&arguments.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = write_files(arguments, &report, (&pictures, started), context.quiet);
    printed.and(written)?;
    let is_clean = report.summaries.iter().all(|summary| summary.violations == 0);
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

/// Asks all planners on all problems.
fn report<'a>(
    arguments: &'a PlanArguments,
    context: &CommandContext,
    loaded: &'a LoadedScenario,
    (problems, planners): (&'a [Problem], &'a [PlannerName]),
) -> Result<PlanReport<'a>, CliError> {
    expect_planners_exist(&context.registry, &loaded.scenario, planners)?;
    context.expect_trusted_planners(&loaded.scenario, planners)?;
    let ask = || {
        // Programs start again each time, those too that could play on.
        let makers = context.planners_of(&loaded.scenario)?;
        let question = AttemptSettings {
            planners,
            makers: &makers,
            programs: &loaded.scenario.planner,
            seed: arguments.problems.seed,
            limit: arguments.memory.limit(),
        };
        Ok::<_, CliError>(ask_all(problems, &question)?)
    };
    let all = ask()?;
    // This takes new planners: what one of them remembers would otherwise look like agreement.
    let again = if arguments.repeat { Some(ask()?) } else { None };
    let repeats = again.map(|again| planners.iter().map(|planner| Repeat::new(planner, &all, &again)).collect());
    let mut drives = DriveTable::of_one_variant(all.iter().map(|attempt| attempt.query(None, 0)).collect());
    let certificates = arguments.certify.as_ref().map(|_| CertificateFile::new(&all, &mut drives));
    Ok(PlanReport {
        loaded,
        changes: &arguments.overrides,
        seed: arguments.problems.seed,
        problems,
        planners,
        attempts: all,
        repeats,
        summaries: PlannerSummary::all(&drives),
        drives,
        certificates,
    })
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
    let names = problems.iter().map(|problem| format!("{stem}-{}{extension}", file_name_of(&problem.name)));
    names.map(|name| path.with_file_name(name)).collect()
}

fn files<'a>(arguments: &'a PlanArguments, pictures: &'a [PathBuf]) -> Files<'a> {
    let inputs =
        arguments.problems.fields.iter().map(PathBuf::as_path).chain([Path::new(&arguments.scenario)]).collect();
    let outputs = pictures.iter().map(|picture| (Format::Png, picture.as_path())).collect();
    let PlanArguments { csv, paths, ompl, certify, .. } = arguments;
    let tables = [(Format::Csv, csv), (Format::Csv, paths), (Format::OmplLog, ompl), (Format::Json, certify)];
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
            (arguments.csv.as_deref(), &|path| report.drives.write(path)),
            (arguments.paths.as_deref(), &|path| paths_file::write_paths(path, &report.attempts)),
            (arguments.ompl.as_deref(), &|path| ompl_log(arguments, report, started).write(path)),
            (arguments.certify.as_deref(), &|path| {
                report.certificates.iter().try_for_each(|certificate| certificate.write(path))
            }),
        ],
        quiet,
    );
    let drawn = report.problems.iter().zip(pictures).map(|(problem, picture)| {
        output_files::write_all(&[(Some(picture), &|path| report.draw(problem).write_png(path))], quiet)
    });
    // All are tried; the error is the first.
    let written = drawn.fold(tables, Result::and);
    let names = report.problems.iter().zip(pictures).map(|(problem, _)| problem.name.as_str());
    terminal::note_unknown_letters(names, quiet);
    written
}

/// The log of all attempts: a planner for each that was asked.
fn ompl_log<'a>(arguments: &PlanArguments, report: &'a PlanReport, started: Option<Started>) -> OmplLog<'a> {
    let problems = report.problems.iter().map(|problem| {
        let frame = problem.terrain.frame;
        let goals = problem.goals.len();
        format!("field {}, {} x {} m, {goals} goals", problem.name, frame.width_m(), frame.height_m())
    });
    let planners = report.planners.iter().map(|planner| {
        let attempts =
            report.attempts.iter().zip(&report.drives.rows).filter(|(attempt, _)| attempt.planner == *planner);
        let settings = planner_settings(planner, report.loaded);
        OmplPlanner {
            name: planner.name(),
            settings,
            runs: attempts
                .map(|(attempt, query)| OmplRun {
                    problem: report.number_of(attempt.problem),
                    seed: report.seed,
                    query,
                })
                .collect(),
        }
    });
    OmplLog {
        scenario: &report.loaded.scenario.name,
        seed: report.seed,
        started,
        memory: arguments.memory.limit(),
        program_limit_s: program_limit_s(report.planners, &report.loaded.scenario.planner),
        problems: problems.collect(),
        planners: planners.collect(),
    }
}
