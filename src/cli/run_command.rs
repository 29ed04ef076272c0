//! `wildfire run`.

use std::io::{self, Write};
use std::panic;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::batch::{RunLabel, RunResult, RunRow, Status, file_name_of, run_json};
use crate::cli::args::RunArguments;
use crate::cli::error::CliError;
use crate::cli::output_files::{self, Files, Format, Words};
use crate::cli::{run_report, scenario_commands, terminal};
use crate::scenario::Scenario;
use crate::sim::{self, RunOptions};
use crate::time::wall::WallStopwatch;
use crate::timeline::export::{ExportError, FINEST_STEP_S, write_events, write_trace};
use crate::timeline::{Outcome, Timeline, file};
use crate::whole_file::WholeFile;

pub fn run(arguments: &RunArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let scenario = scenario_commands::load(&arguments.scenario.source, &arguments.scenario.overrides)?;
    let (outputs, words) = Outputs::checked(arguments, &scenario)?;
    let (row, timeline) = run_once(&scenario, arguments)?;
    let printed = print(&row, arguments.json, words);
    // Whatever cannot be written, all else of the run is kept.
    let written = timeline.map_or(Ok(()), |timeline| outputs.write(&timeline, quiet));
    printed.and(written)?;
    match row.result {
        Some(_) => Ok(ExitCode::SUCCESS),
        None => Err(CliError::run_failed(row.message)),
    }
}

fn print(row: &RunRow, as_json: bool, words: Words) -> Result<(), CliError> {
    match &row.result {
        _ if as_json => terminal::print(&format!("{}\n", run_json(row))),
        Some(result) => words.print(&run_report::to_text(row, result)),
        None => Ok(()),
    }
}

fn run_once(scenario: &Scenario, arguments: &RunArguments) -> Result<(RunRow, Option<Timeline>), CliError> {
    let seed = arguments.seed;
    let options = RunOptions { records_searches: arguments.record_searches, memory: arguments.memory.limit() };
    let stopwatch = WallStopwatch::start();
    // The panic has been printed by then, with a backtrace if one was asked for.
    let caught = panic::catch_unwind(|| sim::run_with(scenario, seed, options));
    let (wall, label) = (stopwatch.elapsed(), RunLabel::alone(scenario, seed));
    match caught.map_err(|_| CliError::run_failed("the run panicked: this is a fault of the program"))? {
        Ok(run) => {
            let result = RunResult::new(Outcome::new(&run.timeline), run.cost);
            Ok((RunRow::done(label, result, wall), Some(run.timeline)))
        }
        Err(error) => Ok((RunRow::not_done(label, Status::Failed, error.to_string(), wall), None)),
    }
}

/// The files that one run was asked for.
struct Outputs<'a> {
    recording: Option<PathBuf>,
    events: Option<&'a Path>,
    trace: Option<&'a Path>,
    step_s: f64,
}

impl<'a> Outputs<'a> {
    /// Checks what can be checked before the run, and returns where its words go.
    fn checked(arguments: &'a RunArguments, scenario: &Scenario) -> Result<(Self, Words), CliError> {
        let step_s = arguments.step;
        if !(step_s.is_finite() && step_s >= FINEST_STEP_S) {
            let sentence = format!("--step is {step_s}; expected seconds, at least {FINEST_STEP_S}");
            return Err(CliError::bad_input(sentence, None));
        }
        let recording = arguments.out.as_deref().map(|path| recording_path(path, scenario, arguments.seed));
        let inputs = vec![Path::new(&arguments.scenario.source)];
        let files = Files { inputs, json: arguments.json, ..Files::default() }.writing([
            (Format::Recording, &recording),
            (Format::Csv, &arguments.events),
            (Format::Csv, &arguments.trace),
        ]);
        let words = files.check()?;
        let (events, trace) = (arguments.events.as_deref(), arguments.trace.as_deref());
        Ok((Self { recording, events, trace, step_s }, words))
    }

    /// Tries all files; the error is the first.
    fn write(&self, timeline: &Timeline, quiet: bool) -> Result<(), CliError> {
        let recording = self.recording.as_deref().map(|path| (path, write_recording(path, timeline)));
        let events = self.events.map(|path| (path, write_csv(path, |to| write_events(timeline, to))));
        let trace = self.trace.map(|path| (path, write_csv(path, |to| write_trace(timeline, self.step_s, to))));
        let mut all = Ok(());
        for (path, written) in [recording, events, trace].into_iter().flatten() {
            if written.is_ok() {
                output_files::note_written(path, quiet);
            }
            all = all.and(written);
        }
        all
    }
}

/// The recording's own name in a folder; the path itself if it names a file.
fn recording_path(path: &Path, scenario: &Scenario, seed: u64) -> PathBuf {
    let names_a_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
    if names_a_folder {
        path.join(format!("{}-seed-{seed}.wildfire", file_name_of(&scenario.name)))
    } else {
        path.to_owned()
    }
}

fn write_recording(path: &Path, timeline: &Timeline) -> Result<(), CliError> {
    let unwritable = |error| CliError::environment(format_args!("cannot write {}: {error}", path.display()));
    file::write(timeline, path).map_err(unwritable)
}

fn write_csv(path: &Path, write: impl FnOnce(&mut dyn Write) -> Result<(), ExportError>) -> Result<(), CliError> {
    let unwritable = |error: io::Error| CliError::unwritable(path, &error);
    let mut file = WholeFile::create(path).map_err(unwritable)?;
    write(&mut file)
        .map_err(|error| CliError::environment(format_args!("cannot write {}: {error}", path.display())))?;
    file.finish().map_err(unwritable)
}
