//! `wildfire export`: a run in the forms that other tools read.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::cli::args::{MemoryArguments, ProgramArguments, parse_seed};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::show::{Searches, parse_agent, source_of_runs};
use crate::cli::terminal;
use wildfire_base::input_file::is_standard_stream;
use wildfire_base::whole_file::WholeFile;
use wildfire_picture::write_mcap;
use wildfire_timeline::export::{
    ExportError, FINEST_STEP_S, Sampling, write_events, write_json, write_npz, write_trace,
};
use wildfire_timeline::{AgentId, Timeline};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire export contest --seed 7 -o run.json
  wildfire export run.wildfire -o run.npz --every 1
  wildfire export run.wildfire -o run.mcap --agent unimog/0
  wildfire export runs/contest --seed 3 -o run.csv
  wildfire export smoke --format json -o - | jq .outcome

The contents of each file are listed in docs/output-files.md; `wildfire schema export` prints
the JSON Schema of the object.")]
pub struct ExportArguments {
    /// A recording, the folder of a batch, a scenario file, or the name of a built-in scenario.
    #[arg(value_name = "RUN|SCENARIO", default_value = "contest")]
    pub source: String,
    /// Change a value of the scenario, such as `unimog.planner=hybrid-astar`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of the run [default: 1, or the first of the batch].
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: Option<u64>,
    /// Also export the planners' searches, for JSON and MCAP; only for simulated runs.
    #[arg(long)]
    pub record_searches: bool,
    /// File format [default: from the ending of the name].
    #[arg(long, value_enum)]
    pub format: Option<ExportFormat>,
    /// Output file; for CSV, NAME.csv means NAME-events.csv and NAME-trace.csv.
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Simulated seconds between samples of the agents' poses [default: 0.1]; not for JSON, which holds the legs.
    #[arg(long = "every", alias = "step", value_name = "SECONDS", allow_hyphen_values = true, value_parser = parse_step)]
    pub step: Option<f64>,
    /// Sample only this agent, such as `unimog/0`; may be repeated.
    #[arg(long = "agent", value_name = "AGENT", value_parser = parse_agent)]
    pub agents: Vec<AgentId>,
}

/// A format in which a run is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    Json,
    Csv,
    Npz,
    Mcap,
}

const USUAL_STEP_S: f64 = 0.1;

fn parse_step(text: &str) -> Result<f64, String> {
    numbers::parse_time(text)
        .filter(|step| step.is_finite() && *step >= FINEST_STEP_S)
        .ok_or_else(|| format!("expected seconds, at least {FINEST_STEP_S}"))
}

pub fn run(arguments: &ExportArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let outputs = ExportOutput::checked(arguments)?;
    let source = source_of_runs(&arguments.source, &arguments.overrides, arguments.memory.memory, context)?;
    if let Some(note) = source.note().filter(|_| !context.quiet) {
        terminal::note(&note);
    }
    let searches = if arguments.record_searches { Searches::Recorded } else { Searches::LeftOut };
    let timeline = source.run(arguments.seed, searches)?.timeline;
    outputs.write(&timeline, arguments, context.quiet)?;
    Ok(ExitCode::SUCCESS)
}

/// The files that are to be written.
enum ExportOutput {
    Json(PathBuf),
    Npz(PathBuf),
    Mcap(PathBuf),
    Csv { events: PathBuf, trace: PathBuf },
}

impl ExportOutput {
    /// Checks what can be checked before anything is simulated.
    fn checked(arguments: &ExportArguments) -> Result<Self, CliError> {
        let out = &arguments.out;
        let outputs = match format_of(arguments)? {
            ExportFormat::Json => Self::Json(out.clone()),
            ExportFormat::Npz => Self::Npz(out.clone()),
            ExportFormat::Mcap => Self::Mcap(out.clone()),
            ExportFormat::Csv if is_standard_stream(out) => {
                let sentence = "--format csv writes two tables; expected a file name, not - (stdout)";
                return Err(CliError::bad_input(sentence, None));
            }
            ExportFormat::Csv => Self::Csv { events: beside(out, "events")?, trace: beside(out, "trace")? },
        };
        // An option without effect would leave its user believing that the file was thinned.
        if let Self::Json(_) = outputs {
            let unused = [("--every", arguments.step.is_some()), ("--agent", !arguments.agents.is_empty())];
            if let Some((option, _)) = unused.into_iter().find(|(_, is_set)| *is_set) {
                let sentence = format!("{option} applies to samples; JSON holds the legs of all agents instead");
                return Err(CliError::bad_input(sentence, None));
            }
        }
        let inputs = vec![Path::new(&arguments.source)];
        Files { inputs, outputs: outputs.named(), ..Files::default() }.check()?;
        Ok(outputs)
    }

    fn named(&self) -> Vec<(Format, &Path)> {
        match self {
            Self::Json(path) => vec![(Format::Json, path)],
            Self::Npz(path) => vec![(Format::Npz, path)],
            Self::Mcap(path) => vec![(Format::Mcap, path)],
            Self::Csv { events, trace } => vec![(Format::Csv, events), (Format::Csv, trace)],
        }
    }

    fn write(&self, timeline: &Timeline, arguments: &ExportArguments, quiet: bool) -> Result<(), CliError> {
        let step_s = arguments.step.unwrap_or(USUAL_STEP_S);
        let sampling = Sampling::new(timeline, step_s, &arguments.agents)
            .map_err(|error| CliError::from_export_error(&arguments.out, error))?;
        let write = |path: &Path, write: &dyn Fn(&mut WholeFile) -> Result<(), ExportError>| {
            write_export(path, write)?;
            output_files::note_written(path, quiet);
            Ok(())
        };
        match self {
            Self::Json(path) => write(path, &|to| write_json(timeline, to)),
            Self::Npz(path) => write(path, &|to| write_npz(timeline, &sampling, to)),
            Self::Mcap(path) => write(path, &|to| write_mcap(timeline, &sampling, to)),
            Self::Csv { events, trace } => {
                // Both are tried, so that one table is there even where the other cannot be written.
                let of_events = write(events, &|to| write_events(timeline, to));
                let of_trace = write(trace, &|to| write_trace(timeline, &sampling, to));
                of_events.and(of_trace)
            }
        }
    }
}

/// Writes a file that appears whole.
pub fn write_export(
    path: &Path,
    write: impl FnOnce(&mut WholeFile) -> Result<(), ExportError>,
) -> Result<(), CliError> {
    let unwritable = |error| CliError::unwritable(path, &error);
    let mut file = WholeFile::create(path).map_err(unwritable)?;
    write(&mut file).map_err(|error| CliError::from_export_error(path, error))?;
    file.finish().map_err(unwritable)
}

/// The form that is asked for, or that the file's name ends in.
fn format_of(arguments: &ExportArguments) -> Result<ExportFormat, CliError> {
    if let Some(format) = arguments.format {
        return Ok(format);
    }
    let ending = arguments.out.extension().unwrap_or_default();
    let by_ending = ExportFormat::value_variants().iter().copied();
    let mut named = by_ending
        .filter(|&format| ending.eq_ignore_ascii_case(format.to_possible_value().expect("none is hidden").get_name()));
    named.next().ok_or_else(|| {
        let sentence = match is_standard_stream(&arguments.out) {
            true => "- (stdout) has no ending that selects a format; expected --format json, npz or mcap".to_owned(),
            false => {
                let path = arguments.out.display();
                format!("the name {path} selects no format; expected a name that ends in .json, .csv, .npz or .mcap")
            }
        };
        CliError::bad_input(sentence, None)
    })
}

/// The name of one of two tables: `run.csv` becomes `run-events.csv`.
fn beside(path: &Path, table: &str) -> Result<PathBuf, CliError> {
    let (Some(stem), Some(ending)) = (path.file_stem(), path.extension()) else {
        let sentence = format!("{} would hold CSV tables; expected a name that ends in .csv", path.display());
        return Err(CliError::bad_input(sentence, None));
    };
    let mut name = stem.to_owned();
    name.push(format!("-{table}."));
    name.push(ending);
    Ok(path.with_file_name(name))
}
