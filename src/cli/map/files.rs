//! The files that a command was asked for.

use std::path::PathBuf;

use crate::cli::error::CliError;
use crate::cli::map::args::Computation;
use crate::cli::map::options::OutputArguments;
use crate::cli::map::report::MapReport;
use crate::cli::map::scene::with_scene;
use crate::cli::output_files::{self, Files, Format, Words};
use crate::map_files::write_path;
use crate::picture::{draw_map, draw_overlay, draw_surface};

/// Checks what can be checked before anything is computed, and returns where the words go.
pub fn check(computation: &Computation) -> Result<Words, CliError> {
    let files = computation.files();
    if files.output.path.is_some() && !computation.has_start() {
        let help = "`wildfire map wavefront` and `wildfire map descend` find paths, from --start";
        return Err(CliError::bad_input("--path without a start: there is no path to write", Some(help)));
    }
    let json = files.output.json;
    Files { inputs: vec![&files.input.map], json, ..Files::default() }.writing(named(&files.output)).check()
}

fn named(output: &OutputArguments) -> [(Format, &Option<PathBuf>); 6] {
    let OutputArguments { csv, npy, png, overlay, surface, path, colormap: _, json: _ } = output;
    let pictures = [png, overlay, surface].map(|picture| (Format::Png, picture));
    let [png, overlay, surface] = pictures;
    [(Format::Csv, csv), (Format::Npy, npy), png, overlay, surface, (Format::Csv, path)]
}

/// Says whether any file was asked for.
pub fn are_wanted(output: &OutputArguments) -> bool {
    named(output).iter().any(|(_, path)| path.is_some())
}

/// Writes all files; the error is the first.
pub fn write(report: &MapReport, quiet: bool) -> Result<(), CliError> {
    let (output, values) = (&report.computation.files().output, &report.computed.values);
    let grey = report.map.grey.as_ref();
    output_files::write_all(
        &[
            (output.csv.as_deref(), &|path| values.write_csv(path)),
            (output.npy.as_deref(), &|path| values.write_npy(path)),
            (output.path.as_deref(), &|path| write_path(path, report.way().unwrap_or_default())),
            (output.png.as_deref(), &|path| with_scene(report, draw_map).write_png(path)),
            (output.overlay.as_deref(), &|path| with_scene(report, |scene| draw_overlay(scene, grey)).write_png(path)),
            (output.surface.as_deref(), &|path| with_scene(report, draw_surface).write_png(path)),
        ],
        quiet,
    )
}
