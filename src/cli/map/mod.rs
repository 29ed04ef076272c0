//! `wildfire map`: the grid maps of the reports, from files to numbers, pictures and paths.

mod args;
mod compute;
mod files;
mod json;
mod options;
mod parse;
mod report;
mod scene;
mod summary;
mod timing;
mod values;
mod walk;

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

pub use args::MapCommand;

use args::Computation;
use options::ReadingArguments;
use report::MapReport;

use crate::cli::error::CliError;
use crate::cli::terminal;
use crate::grid::occupancy;
use crate::map_files::{self, MapFile};
use crate::time::cpu::CpuStopwatch;

pub fn run(command: &MapCommand, quiet: bool) -> Result<ExitCode, CliError> {
    match command {
        MapCommand::Compute(computation) => compute_and_report(computation, quiet)?,
        MapCommand::Timing(arguments) => timing::run(arguments, quiet)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn compute_and_report(computation: &Computation, quiet: bool) -> Result<(), CliError> {
    computation.check_parameters().map_err(|problem| CliError::bad_input(problem, None))?;
    let words = files::check(computation)?;
    let (input, output) = (&computation.files().input, &computation.files().output);
    let (map, cpu_read) = read(&input.map, &input.reading)?;
    let computed = compute::compute(computation, &map.occupied)
        .map_err(|problem| CliError::bad_input(format_args!("{}: {problem}", input.map.display()), None))?;
    let report = MapReport::new(computation, &map, &computed, cpu_read);
    if output.json && !quiet {
        report.sentences().iter().for_each(|sentence| terminal::note(sentence));
    }
    let printed = words.print(&rendered(&report));
    // Whatever cannot be written, all else is kept.
    let written = files::write(&report, quiet);
    printed.and(written)
}

fn rendered(report: &MapReport) -> String {
    let output = &report.computation.files().output;
    if output.json {
        return json::to_json(report) + "\n";
    }
    let values = summary::values(report).filter(|_| !files::are_wanted(output));
    summary::to_text(report) + &values.map(|values| format!("\n{values}")).unwrap_or_default()
}

/// The map in a file without its edges, and the CPU time that it took.
fn read(path: &Path, reading: &ReadingArguments) -> Result<(MapFile, Duration), CliError> {
    let mut stopwatch = CpuStopwatch::start();
    let mut map = map_files::read(path, reading.tolerance())?;
    occupancy::remove_edges(&mut map.occupied, reading.remove_edges);
    Ok((map, stopwatch.lap()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Command;
    use crate::cli::command_lines::{drawn_words, parsed, said};
    use crate::cli::fuzz::{Case, Fuzzer, Law, below, one_of};
    use crate::grid::Grid;

    #[test]
    fn maps_take_any_parameters() {
        Fuzzer { name: "maps_take", target: "--lib", law: map_takes_parameters }.run(3000);
    }

    /// Checks that a question about a small map is answered or refused.
    fn map_takes_parameters(case: &mut Case<'_>) -> Law {
        let (rows, cols) = (1 + below(&mut case.dice, 12), 1 + below(&mut case.dice, 12));
        let percent = *one_of(&mut case.dice, &[20, 0, 50, 100]);
        let cells = (0..rows * cols).map(|_| case.chance(percent)).collect();
        let occupied = Grid::from_values(rows, cols, cells);
        let words = drawn_words(case, &["map"]);
        let Some(Command::Map { command: MapCommand::Compute(command) }) = parsed(case, "map", words)? else {
            return Ok(());
        };
        if let Err(refusal) = command.check_parameters() {
            return said(&refusal.to_string());
        }
        case.count("parameters accepted");
        let map = MapFile { occupied, grey: None, notes: Vec::new() };
        let computed = match compute::compute(&command, &map.occupied) {
            Ok(computed) => computed,
            Err(refusal) => return said(&refusal.to_string()),
        };
        case.count("maps computed");
        let report = MapReport::new(&command, &map, &computed, Duration::ZERO);
        let rendered = rendered(&report);
        if command.files().output.json && serde_json::from_str::<serde_json::Value>(&rendered).is_err() {
            return Err(format!("this is no JSON: {rendered}"));
        }
        said(&rendered)
    }
}
