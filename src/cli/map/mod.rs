//! `wildfire map`: the grid maps of the reports, from files to numbers, pictures and paths.

mod commands;
mod computed;
mod explained;
mod fields;
mod graphs;
mod options;
mod page;
mod report;
mod searches;
mod sweep;
mod timing;
mod traces;

use std::io;
use std::path::Path;
use std::process::ExitCode;

use clap::Subcommand;

pub use options::{NO_IMAGE, parse_tolerance};

use commands::Computation;
use computed::{MapInputError, timed};
use page::MapPageArguments;
use report::{MapReport, with_scene, write_film};
use sweep::DescentSweep;
use timing::TimingArguments;

use crate::cli::error::CliError;
use crate::cli::output_files::{self, Files, ReportStream};
use crate::cli::terminal;
use wildfire_grid::map_files::{MapFile, write_path};
use wildfire_picture::{MapScene, Picture, draw_map, draw_overlay, draw_surface};

#[derive(Debug, Subcommand)]
pub enum MapCommand {
    #[command(flatten)]
    Compute(Computation),
    /// Measure the CPU time of brushfire and wavefront on maps.
    Timing(TimingArguments),
    /// Write a page with all maps and searches of one problem.
    Report(MapPageArguments),
}

pub fn run(command: &MapCommand, quiet: bool) -> Result<ExitCode, CliError> {
    match command {
        MapCommand::Compute(computation) => compute_and_report(computation, quiet)?,
        MapCommand::Timing(arguments) => timing::run(arguments, quiet)?,
        MapCommand::Report(arguments) => page::run(arguments, quiet)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn compute_and_report(computation: &Computation, quiet: bool) -> Result<(), CliError> {
    computation.parameters().check().map_err(|problem| CliError::bad_input(problem, None))?;
    // This comes before the map is read, so a name that is wrong does not cost reading a large image.
    let stream = check_files(computation)?;
    let input = &computation.files().input;
    let output = &computation.files().output;
    let (map, cpu_read) = timed(|| input.reading.read(&input.map));
    let map = map?;
    check_values(computation, &map)?;
    if let Some(query) = sweep::swept_query(computation) {
        let sweep = DescentSweep::new(computation, query, &map, cpu_read);
        let sweep = sweep.map_err(|problem| refused(&input.map, &problem))?;
        // JSON has the sentences as members, and people at a terminal should still see them.
        if output.form.is_json() && !quiet {
            sweep.sentences().iter().for_each(|sentence| terminal::note(sentence));
        }
        let printed = stream.print(&output.form.render(&sweep));
        let written = output_files::write_all(
            &[
                (output.csv.as_deref(), &|path| sweep.write_csv(path)),
                (output.png.as_deref(), &|path| sweep.draw().with_map(&map.occupied).write_png(path)),
            ],
            quiet,
        );
        return printed.and(written);
    }
    let computed = computation.compute(&map.occupied).map_err(|problem| refused(&input.map, &problem))?;
    let report = MapReport::new(computation, &map, &computed, cpu_read);
    if output.form.is_json() && !quiet {
        report.sentences().iter().for_each(|sentence| terminal::note(sentence));
    }
    let printed = stream.print(&output.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = write_files(&report, quiet);
    printed.and(written)
}

/// Words a question that has no answer.
fn refused(map: &Path, problem: &MapInputError) -> CliError {
    CliError::bad_input(format_args!("{}: {problem}", map.display()), problem.help().as_deref())
}

/// The longest side of a map whose values are written into its cells.
const MAX_WRITTEN: usize = 60;

/// Refuses values in the cells of a map that is too large for them.
fn check_values(computation: &Computation, map: &MapFile) -> Result<(), CliError> {
    let cols = map.occupied.cols();
    let rows = map.occupied.rows();
    if !computation.files().output.values || cols.max(rows) <= MAX_WRITTEN {
        return Ok(());
    }
    let file = computation.files().input.map.display();
    let sentence =
        format!("--values: {file} has {cols} columns and {rows} rows; expected at most {MAX_WRITTEN} of each");
    Err(CliError::bad_input(sentence, Some("--resize COLSxROWS makes a map smaller")))
}

/// Checks what can be checked before anything is computed, and returns where the words go.
fn check_files(computation: &Computation) -> Result<ReportStream, CliError> {
    let files = computation.files();
    if files.output.path.is_some() && !computation.parameters().has_start() {
        let help = "wavefront, descend, voronoi and all searches find a path from --start";
        return Err(CliError::bad_input("--path needs --start: without a start there is no path to write", Some(help)));
    }
    if let Some(query) = sweep::swept_query(computation) {
        sweep::check_outputs(query)?;
    }
    let inputs = vec![files.input.map.as_path()];
    Files { inputs, form: files.output.form, ..Files::default() }
        .writing(files.output.files())
        .writing(computation.parameters().more_files())
        .check()
}

/// Writes all files; the error is the first.
fn write_files(report: &MapReport, quiet: bool) -> Result<(), CliError> {
    let output = &report.computation.files().output;
    let values = &report.computed.values;
    let grey = report.map.grey.as_ref();
    let occupied = &report.map.occupied;
    // Pictures carry the map, so that they can be read as one.
    let draw =
        |draw: &dyn Fn(&MapScene) -> Picture, path: &Path| with_scene(report, draw).with_map(occupied).write_png(path);
    let [(_, table), (_, film)] = report.computation.parameters().more_files();
    output_files::write_all(
        &[
            (output.csv.as_deref(), &|path| values.write_csv(path)),
            (output.npy.as_deref(), &|path| values.write_npy(path)),
            (output.path.as_deref(), &|path| write_route(report, path)),
            (output.png.as_deref(), &|path| draw(&draw_map, path)),
            (output.overlay.as_deref(), &|path| draw(&|scene| draw_overlay(scene, grey), path)),
            (output.surface.as_deref(), &|path| draw(&draw_surface, path)),
            (table.as_deref(), &|path| write_table(report, path)),
            (film.as_deref(), &|path| write_film(report, path)),
        ],
        quiet,
    )
}

fn write_route(report: &MapReport, path: &Path) -> io::Result<()> {
    let points = report.computed.walk.as_ref().map_or(&[][..], |walk| &walk.path.points);
    if points.is_empty() {
        write_path(path, report.path_cells().unwrap_or_default())
    } else {
        traces::write_points(path, points)
    }
}

/// Writes what a search expanded, or the edges of a graph.
fn write_table(report: &MapReport, path: &Path) -> io::Result<()> {
    let computed = report.computed;
    match (&computed.search, &computed.graph) {
        (Some(search), _) => {
            search.write_expansions(path, report.map.occupied.cols(), &|place| computed.values.at(place).to_text())
        }
        (None, Some(graph)) => graph.write_edges(path),
        (None, None) => unreachable!("only searches and graphs have such a table"),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::cli::Command;
    use crate::cli::command_lines::{check_message, drawn_args, parsed};
    use crate::cli::fuzz::{Case, Fuzzer, Law, below, one_of};
    use wildfire_grid::Grid;

    #[test]
    fn maps_take_any_parameters() {
        Fuzzer { name: "maps_take", target: "--lib", law: map_takes_parameters }.run(3000);
    }

    /// Checks that a question about a small map is answered or refused.
    fn map_takes_parameters(case: &mut Case<'_>) -> Law {
        let rows = 1 + below(&mut case.dice, 12);
        let cols = 1 + below(&mut case.dice, 12);
        let percent = *one_of(&mut case.dice, &[20, 0, 50, 100]);
        let cells = (0..rows * cols).map(|_| case.chance(percent)).collect();
        let occupied = Grid::from_values(rows, cols, cells);
        let args = drawn_args(case, &["map"]);
        let Some(Command::Map { command: MapCommand::Compute(command) }) = parsed(case, "map", args)? else {
            return Ok(());
        };
        if let Err(refusal) = command.parameters().check() {
            return check_message(&refusal.to_string());
        }
        case.count("parameters accepted");
        let map = MapFile::from_cells(occupied);
        let computed = match command.compute(&map.occupied) {
            Ok(computed) => computed,
            Err(refusal) => return check_message(&refusal.to_string()),
        };
        case.count("maps computed");
        let report = MapReport::new(&command, &map, &computed, Duration::ZERO);
        let form = command.files().output.form;
        let rendered = form.render(&report);
        if form.is_json() && serde_json::from_str::<serde_json::Value>(&rendered).is_err() {
            return Err(format!("this is no JSON: {rendered}"));
        }
        check_message(&rendered)
    }
}
