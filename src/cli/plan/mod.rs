//! `wildfire plan`: drives of the truck by any planners, with their figures, and paths that others can check.

mod args;
mod attempts;
mod drive;
mod json;
mod ompl;
mod path_rows;
mod problems;
mod report;
mod rows;
mod scene;
mod settings;
mod summary;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use args::PlanArguments;

use attempts::{Attempt, attempts};
use summary::Summary;

use crate::batch::file_name_of;
use crate::cli::error::CliError;
use crate::cli::exit;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::terminal;
use crate::input_file::is_standard_stream;
use crate::planning::TruckPlannerKind;
use crate::scenario::{LoadedScenario, Problem};

/// The question and all answers.
struct PlanReport<'a> {
    loaded: &'a LoadedScenario,
    /// Changed values, as on the command line.
    changes: &'a [String],
    seed: u64,
    problems: &'a [Problem],
    planners: &'a [TruckPlannerKind],
    /// Problem by problem, goal by goal, planner by planner.
    attempts: Vec<Attempt<'a>>,
    /// In the order of the planners.
    summaries: Vec<Summary>,
}

impl PlanReport<'_> {
    /// The place of a problem of the list.
    fn number_of(&self, problem: &Problem) -> usize {
        self.problems.iter().position(|other| std::ptr::eq(other, problem)).expect("it is in the list")
    }
}

pub fn run(arguments: &PlanArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let loaded = LoadedScenario::open(&arguments.scenario, &arguments.overrides)?;
    let problems = problems::load(arguments, &loaded.scenario)?;
    let planners = planners(arguments, &problems);
    let pictures = pictures(arguments, &problems);
    let words = files(arguments, &pictures).check()?;
    let mut all = Vec::new();
    for problem in &problems {
        let attempts = attempts(problem, &planners, arguments.seed, arguments.memory.limit());
        let exceeded =
            |exceeded| CliError::run_failed(format_args!("planning on the field {}: {exceeded}", problem.name));
        all.extend(attempts.map_err(exceeded)?);
    }
    let summaries = planners.iter().map(|&planner| Summary::new(planner, &all)).collect();
    let report = PlanReport {
        loaded: &loaded,
        changes: &arguments.overrides,
        seed: arguments.seed,
        problems: &problems,
        planners: &planners,
        attempts: all,
        summaries,
    };
    let rendered = if arguments.json { json::to_json(&report) } else { report::to_text(&report) };
    let printed = words.print(&rendered);
    // Whatever cannot be written, all else is kept.
    let written = write_files(arguments, &report, &pictures, quiet);
    printed.and(written)?;
    let is_clean = report.summaries.iter().all(|summary| summary.violations == 0);
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

/// The planners that were named, each once, or else the truck's own.
fn planners(arguments: &PlanArguments, problems: &[Problem]) -> Vec<TruckPlannerKind> {
    let own = problems.iter().take(1).map(|problem| problem.truck.planner);
    let named = arguments.planners.iter().copied();
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
    let inputs = arguments.fields.iter().map(PathBuf::as_path).chain([Path::new(&arguments.scenario)]).collect();
    let outputs = pictures.iter().map(|picture| (Format::Png, picture.as_path())).collect();
    let (csv, paths, ompl) = (&arguments.csv, &arguments.paths, &arguments.ompl);
    let tables = [(Format::Csv, csv), (Format::Csv, paths), (Format::OmplLog, ompl)];
    Files { inputs, outputs, json: arguments.json }.writing(tables)
}

fn write_files(
    arguments: &PlanArguments,
    report: &PlanReport,
    pictures: &[PathBuf],
    quiet: bool,
) -> Result<(), CliError> {
    let tables = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| rows::write(path, &report.attempts)),
            (arguments.paths.as_deref(), &|path| path_rows::write(path, &report.attempts)),
            (arguments.ompl.as_deref(), &|path| ompl::write(path, report)),
        ],
        quiet,
    );
    let drawn = report.problems.iter().zip(pictures).map(|(problem, picture)| {
        let draw = |path: &Path| scene::draw(problem, report).write_png(path);
        output_files::write_all(&[(Some(picture), &draw)], quiet)
    });
    // All are tried; the error is the first.
    let written = drawn.fold(tables, Result::and);
    let names = report.problems.iter().zip(pictures).map(|(problem, _)| problem.name.as_str());
    terminal::note_unknown_letters(names, quiet);
    written
}
