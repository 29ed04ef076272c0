//! `wildfire plan --together` and `wildfire judge --together`: many vehicles that plan at once, on instances of the CL-MAPF
//! benchmark.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::numbers;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::report::FormArguments;
use wildfire_base::input_file;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::together::{CheckedSolution, InstanceAnswer, InstanceRow, TogetherReport, VerdictReport};
use wildfire_planning::together::files::{FileFault, MAX_BYTES, read_instance, read_solution};
use wildfire_planning::together::{Instance, Mode, PlanTogether, RepairMethod};

/// Folders inside each other that are searched for instances.
const DEEPEST: usize = 8;

/// The options of `wildfire plan --together`.
#[derive(Debug, Args)]
pub struct TogetherArguments {
    /// Plan paths of many car-like vehicles at once instead: instances of the CL-MAPF benchmark, or folders of them.
    #[arg(
        help_heading = "Many vehicles", long, value_name = "FILE.yaml|DIR", num_args = 1..,
        conflicts_with_all = [
            "fields", "goals", "cells", "planners", "scenario", "overrides", "seeds", "jobs", "report", "commands", "modules",
            "trust", "repeat", "memory", "paths", "ompl", "png", "certify",
        ]
    )]
    pub together: Vec<PathBuf>,
    /// Rules of what touches what: rectangles and discs at all times, or the benchmark's circles at whole steps [default:
    /// exact].
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_parser = mode_parser())]
    pub mode: Option<Mode>,
    /// What to do about conflicts that planning one vehicle after the other leaves: start again in another order, or plan
    /// those around a conflict again [default: repair].
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_parser = method_parser())]
    pub method: Option<RepairMethod>,
    /// Number of attempts for each vehicle to make paths shorter once they are free [default: 0].
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_name = "N", value_parser = polish)]
    pub polish: Option<u32>,
    /// CPU seconds for an instance, after which it counts as unsolved or, with free paths, is polished no further
    /// [default: 20].
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_name = "SECONDS", value_parser = limit_s)]
    pub limit_s: Option<f64>,
    /// Write each solution into this folder, under its instance's path, as the benchmark's program does.
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_name = "DIR")]
    pub yaml: Option<PathBuf>,
}

/// Reads the name of rules: `benchmark` (the benchmark's own) or `exact`.
pub fn mode_parser() -> impl TypedValueParser<Value = Mode> {
    PossibleValuesParser::new(Mode::ALL.map(Mode::name))
        .map(|name| Mode::ALL.into_iter().find(|mode| mode.name() == name).expect("one of the names"))
}

fn method_parser() -> impl TypedValueParser<Value = RepairMethod> {
    PossibleValuesParser::new(RepairMethod::ALL.map(RepairMethod::name))
        .map(|name| RepairMethod::ALL.into_iter().find(|method| method.name() == name).expect("one of the names"))
}

fn polish(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(0..=1000), "a whole number")
}

fn limit_s(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.001..=1e6), "seconds")
}

/// Plans all instances that were named.
pub fn run(
    arguments: &TogetherArguments,
    seed: u64,
    form: FormArguments,
    csv: &Option<PathBuf>,
    context: &CommandContext,
) -> Result<ExitCode, CliError> {
    let inputs = instances(&arguments.together)?;
    let named = inputs.iter().map(|(path, _)| path.as_path()).collect();
    let stream = Files { inputs: named, form, ..Files::default() }.writing([(Format::Csv, csv)]).check()?;
    let default = PlanTogether::default();
    let settings = PlanTogether {
        mode: arguments.mode.unwrap_or(default.mode),
        method: arguments.method.unwrap_or(default.method),
        seed,
        polish: arguments.polish.unwrap_or(default.polish),
        ..default
    };
    // This comes before planning, which may take hours.
    if let Some(folder) = &arguments.yaml {
        expect_room_for_solutions(folder, &inputs)?;
    }
    // All are read before the first is planned: a fault in the last should not cost the answers for the others.
    let read: Vec<Instance> = inputs.iter().map(|(path, _)| open_instance(path)).collect::<Result<_, _>>()?;
    let limit = Duration::from_secs_f64(arguments.limit_s.unwrap_or(20.0));
    let mut rows = Vec::new();
    for ((path, place), instance) in inputs.iter().zip(&read) {
        let answer = InstanceAnswer::new(path, instance, &settings, limit);
        if let (Some(folder), Some(text)) = (&arguments.yaml, answer.solution) {
            write_into(&folder.join(place), &text)?;
        }
        rows.push(answer.row);
    }
    let report = TogetherReport { settings, limit_s: limit.as_secs_f64(), rows };
    let printed = stream.print(&form.render(&report));
    let written = output_files::write_all(&[(csv.as_deref(), &|path| report.write(path))], context.quiet);
    printed.and(written)?;
    Ok(exit_code(report.rows.iter().all(InstanceRow::is_clean)))
}

/// Checks a solution of any program.
pub fn judge(files: &[PathBuf], mode: Mode, form: FormArguments) -> Result<ExitCode, CliError> {
    let [of_instance, of_solution] = files else { unreachable!("the option takes two files") };
    let inputs = vec![of_instance.as_path(), of_solution.as_path()];
    let stream = Files { inputs, form, ..Files::default() }.check()?;
    let instance = open_instance(of_instance)?;
    let schedules = parsed(of_solution, read_solution)?;
    let report = VerdictReport::new(of_solution, mode, CheckedSolution::new(&instance, mode, &schedules));
    stream.print(&form.render(&report))?;
    Ok(exit_code(report.is_clean()))
}

fn exit_code(is_clean: bool) -> ExitCode {
    if is_clean { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) }
}

fn open_instance(path: &Path) -> Result<Instance, CliError> {
    parsed(path, read_instance)
}

fn parsed<T>(path: &Path, read: fn(&str) -> Result<T, FileFault>) -> Result<T, CliError> {
    let text = input_file::read_text(path, MAX_BYTES).map_err(|error| CliError::unreadable(path, &error))?;
    read(&text).map_err(|fault| CliError::bad_input(format_args!("{}: {fault}", path.display()), None))
}

/// Lists the files that were named and those in folders, each with the path that its solution gets in a folder.
fn instances(named: &[PathBuf]) -> Result<Vec<(PathBuf, PathBuf)>, CliError> {
    let mut found = Vec::new();
    for path in named {
        if path.is_dir() {
            let before = found.len();
            add_folder(path, Path::new(""), 0, &mut found).map_err(|error| CliError::unreadable(path, &error))?;
            if found.len() == before {
                let sentence = format!("{} has no instances; expected files that end in .yaml", path.display());
                return Err(CliError::bad_input(sentence, None));
            }
        } else {
            found.push((path.clone(), path.file_name().map_or_else(|| "solution.yaml".into(), PathBuf::from)));
        }
    }
    Ok(found)
}

/// Adds the instances of a folder and of those in it, by their names; links to folders are not followed.
fn add_folder(folder: &Path, place: &Path, depth: usize, found: &mut Vec<(PathBuf, PathBuf)>) -> io::Result<()> {
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    // Files go by name, as folders list them in an order of their own and rows must be in the same one everywhere.
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        let place = place.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            // The depth is bounded, since folders may be nested without end.
            if depth < DEEPEST {
                add_folder(&path, &place, depth + 1, found)?;
            }
        } else if path.extension().is_some_and(|ending| ending == "yaml" || ending == "yml") {
            found.push((path, place));
        }
    }
    Ok(())
}

/// Refuses a folder in which a solution would replace an instance, or another solution.
fn expect_room_for_solutions(folder: &Path, inputs: &[(PathBuf, PathBuf)]) -> Result<(), CliError> {
    let mut places: Vec<&Path> = inputs.iter().map(|(_, place)| place.as_path()).collect();
    places.sort_unstable();
    let twice = places.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| folder.join(pair[0]));
    let sources: BTreeSet<PathBuf> = inputs.iter().filter_map(|(path, _)| fs::canonicalize(path).ok()).collect();
    let is_source = |place: &&&Path| fs::canonicalize(folder.join(place)).is_ok_and(|path| sources.contains(&path));
    let (path, taken) = match (twice, places.iter().find(is_source)) {
        (Some(path), _) => (path, "the solutions of two instances"),
        (None, Some(place)) => (folder.join(place), "an instance and a solution"),
        (None, None) => return Ok(()),
    };
    let help = Some("name another folder, or folders of instances instead of files");
    Err(CliError::bad_input(format_args!("{} would be {taken}", path.display()), help))
}

fn write_into(path: &Path, text: &str) -> Result<(), CliError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let written = fs::create_dir_all(folder).and_then(|()| write_whole(path, text.as_bytes()));
    written.map_err(|error| CliError::unwritable(path, &error))
}
