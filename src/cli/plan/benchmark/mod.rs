//! Benchmarks of drives: `wildfire plan` with several seeds, or with keys that take several values; and
//! `wildfire plan report`, which draws what such a benchmark found.
//!
//! Shares of queries that found a drive have Wilson's interval. Medians have that of two order statistics, which holds
//! whatever the distribution (Conover, "Practical nonparametric statistics", 1999, section 3.2).

mod ask;
mod charts;
mod page;
mod report;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::arguments::{PlanArguments, PlanReportArguments};
use super::ompl::{OmplLog, OmplPlanner, OmplRun, Started, program_limit_s};
use super::report::planner_settings;
use crate::cli::args::PaperArguments;
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{self, Files, Format, ReportStream};
use crate::cli::terminal;
use ask::{Benchmark, BenchmarkAnswers};
use page::{charts_folder_of, write_page};
use report::BenchmarkReport;
use wildfire_base::document::Document;
use wildfire_base::input_file::is_standard_stream;
use wildfire_batch::drives::{DriveTable, PlannerSummary};
use wildfire_batch::plan::{BatchRequest, RequestError};
use wildfire_scenario::LoadedScenario;

/// The files of a folder that `--report` fills.
const QUERIES_FILE: &str = "queries.csv";
const PAGE_FILE: &str = "report.html";

/// Says whether the arguments ask for several seeds or variants, or for a report on them.
pub fn matches(arguments: &PlanArguments) -> Result<bool, CliError> {
    let mut request = BatchRequest::default();
    arguments.overrides.iter().try_for_each(|option| request.add_option(option)).map_err(RequestError::from)?;
    Ok(arguments.seeds.is_some() || arguments.report.is_some() || !request.sweeps.is_empty())
}

pub fn run(arguments: &PlanArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let benchmark = begin(arguments, context)?;
    // This comes before the queries, which may take hours.
    let stream = files(arguments).check()?;
    arguments.report.as_deref().map_or(Ok(()), check_folder)?;
    // This is the time at the beginning, as OMPL's logs have it.
    let started = arguments.ompl.as_ref().map(|_| Started::now()).transpose()?;
    let report = run_queries(arguments, &benchmark)?;
    let printed = stream.print(&arguments.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| report.drives.write(path)),
            (arguments.ompl.as_deref(), &|path| ompl_log(&benchmark, &report, started)?.write(path)),
        ],
        context.quiet,
    );
    let filled = arguments.report.as_deref().map_or(Ok(()), |folder| fill_folder(folder, &report, context.quiet));
    printed.and(written).and(filled)?;
    let is_clean = report.summaries.iter().all(|summary| summary.violations == 0);
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

fn begin<'a>(arguments: &'a PlanArguments, context: &'a CommandContext) -> Result<Benchmark<'a>, CliError> {
    let file_options =
        [("--paths", arguments.paths.is_some()), ("--png", arguments.png.is_some()), ("--repeat", arguments.repeat)];
    if let Some((option, _)) = file_options.into_iter().find(|(_, is_requested)| *is_requested) {
        let sentence = format!("{option} needs a single variant and seed; expected --seed, and one value of each key");
        return Err(CliError::bad_input(sentence, Some("leave it out, or plan the drives of one field separately")));
    }
    Benchmark::new(arguments, context)
}

fn run_queries<'a>(arguments: &'a PlanArguments, benchmark: &Benchmark<'_>) -> Result<BenchmarkReport<'a>, CliError> {
    let BenchmarkAnswers { drives, problems } = benchmark.ask()?;
    Ok(BenchmarkReport {
        scenario: benchmark.plan.variants[0].scenario.name.clone(),
        changes: &arguments.overrides,
        seeds: benchmark.plan.seeds.to_string(),
        summaries: PlannerSummary::all(&drives),
        drives,
        problems,
    })
}

fn files(arguments: &PlanArguments) -> Files<'_> {
    let inputs =
        arguments.problems.fields.iter().map(PathBuf::as_path).chain([Path::new(&arguments.scenario)]).collect();
    let outputs = [(Format::Csv, &arguments.csv), (Format::OmplLog, &arguments.ompl)];
    Files { inputs, form: arguments.form, ..Files::default() }.writing(outputs)
}

/// Refuses a name that is taken by something else than a folder.
fn check_folder(folder: &Path) -> Result<(), CliError> {
    if fs::metadata(folder).is_ok_and(|found| !found.is_dir()) {
        return Err(CliError::bad_input(format_args!("{} is a file; expected a folder", folder.display()), None));
    }
    Ok(())
}

fn fill_folder(folder: &Path, report: &BenchmarkReport<'_>, quiet: bool) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let table = folder.join(QUERIES_FILE);
    output_files::write_all(&[(Some(&table), &|path| report.drives.write(path))], quiet)?;
    let page = folder.join(PAGE_FILE);
    let written = write_page(&report.drives, &title_of(folder), &page, &PaperArguments::default().charts()?)?;
    output_files::note_written(&page, quiet);
    terminal::note_unknown_letters(written.texts.iter().map(String::as_str), quiet);
    Ok(())
}

fn title_of(source: &Path) -> String {
    let name = fs::canonicalize(source).ok();
    let name = name.as_deref().unwrap_or(source).file_name().unwrap_or_default();
    format!("Drives: {}", name.to_string_lossy())
}

/// The log of all queries: every planner of every variant is one of its own, with the variant's values among its
/// settings.
fn ompl_log<'a>(
    benchmark: &'a Benchmark<'_>,
    report: &'a BenchmarkReport<'_>,
    started: Option<Started>,
) -> std::io::Result<OmplLog<'a>> {
    let plan = &benchmark.plan;
    let problems = report.problems.iter().map(|it| {
        let values = plan.swept_keys.iter().zip(&plan.variants[it.variant].swept);
        let values = values.map(|(key, value)| format!(", {key} {value}")).collect::<String>();
        format!("field {}, seed {}{values}, {} goals", it.field, it.seed, it.goals)
    });
    let mut planners = Vec::new();
    for (variant, names) in benchmark.planners.iter().enumerate() {
        let changes = &plan.variants[variant].changes;
        // It was loaded from the same text before.
        let loaded = LoadedScenario::from_text(&benchmark.text, changes).map_err(std::io::Error::other)?;
        for planner in names {
            let plan_variant = &plan.variants[variant];
            let swept = plan.swept_keys.iter().cloned().zip(plan_variant.swept.iter().map(ToString::to_string));
            let settings = planner_settings(planner, &loaded);
            let settings = swept
                // A key that is swept and a setting of the planner is listed once.
                .filter(|(key, _)| settings.iter().all(|(setting, _)| setting != key))
                .chain(settings.clone())
                .collect();
            planners.push((variant, OmplPlanner { name: planner.name(), settings, runs: Vec::new() }));
        }
    }
    let mut place = 0;
    for (number, problem) in report.problems.iter().enumerate() {
        // Rows follow one another problem by problem, so a count is enough to find those of each.
        let count = problem.goals * benchmark.planners[problem.variant].len();
        for query in &report.drives.rows[place..place + count] {
            let planner = planners
                .iter_mut()
                .find(|(variant, planner)| *variant == problem.variant && *planner.name == *query.planner);
            let run = OmplRun { problem: number, seed: problem.seed, query };
            planner.expect("it is one of those asked").1.runs.push(run);
        }
        place += count;
    }
    let programs = plan.variants.iter().zip(&benchmark.planners);
    Ok(OmplLog {
        scenario: &report.scenario,
        seed: plan.seeds.nth(0),
        started,
        memory: plan.memory,
        program_limit_s: programs
            .map(|(variant, names)| program_limit_s(names, &variant.scenario.planner))
            .fold(0.0, f64::max),
        problems: problems.collect(),
        planners: planners.into_iter().map(|(_, planner)| planner).collect(),
    })
}

/// Writes the page of a table of queries.
pub fn report(arguments: &PlanReportArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let source = &arguments.source;
    let is_folder = fs::metadata(source).is_ok_and(|found| found.is_dir());
    let table = if is_folder { source.join(QUERIES_FILE) } else { source.clone() };
    let page = match &arguments.out {
        Some(page) => page.clone(),
        None if is_folder => source.join(PAGE_FILE),
        None if is_standard_stream(source) => {
            return Err(CliError::bad_input(
                "- is stdin, from which no page name follows; expected --out FILE.html",
                None,
            ));
        }
        None => source.with_extension("html"),
    };
    if is_standard_stream(&page) {
        let sentence = "- is stdout, but the charts need a folder; expected a name that ends in .html";
        return Err(CliError::bad_input(sentence, None));
    }
    let files = Files { inputs: vec![&table], outputs: vec![(Format::Html, &page)], ..Files::default() };
    // This comes before the table is read, as a page that cannot be written needs none.
    let stream: ReportStream = files.check()?;
    check_folder(&charts_folder_of(&page))?;
    let queries = DriveTable::read(&table)?;
    let paper = arguments.paper.charts()?;
    let written = write_page(&queries, &title_of(source), &page, &paper)?;
    let shown = page.display();
    let charts = written.charts_folder.display();
    let forms = arguments.paper.forms();
    let mut document = Document::new(format!("{shown}, and {} charts as {forms} in {charts}", written.charts));
    document.add_list(written.refused);
    stream.print(&document.to_text())?;
    terminal::note_unknown_letters(written.texts.iter().map(String::as_str), quiet);
    Ok(ExitCode::SUCCESS)
}
