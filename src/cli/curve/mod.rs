//! `wildfire curve`: the shortest curves of a turning radius between two poses, or between many pairs.

mod answer;
mod args;
mod json;
mod limits;
mod pair_table;
mod pairs;
pub mod samples;
mod scene;
mod summary;
mod words;

use std::path::Path;
use std::process::ExitCode;

pub use args::CurveArguments;

use answer::Answer;
use args::End;

use crate::cli::failure::Failure;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::terminal;
use crate::input_file::is_standard_stream;

pub fn run(arguments: &CurveArguments, quiet: bool) -> Result<ExitCode, Failure> {
    match (&arguments.pairs, &arguments.csv, arguments.from, arguments.to) {
        (Some(pairs), Some(csv), ..) => tell_lengths(pairs, csv, arguments.radius, quiet)?,
        (_, _, Some(from), Some(to)) => tell_curves(from, to, arguments, quiet)?,
        _ => unreachable!("the arguments require --pairs with --csv, or --from with --to"),
    }
    Ok(ExitCode::SUCCESS)
}

fn tell_lengths(pairs: &Path, csv: &Path, radius_m: f64, quiet: bool) -> Result<(), Failure> {
    Files { inputs: vec![pairs], outputs: vec![(Format::Csv, csv)], json: false }.check()?;
    let rows = pairs::write_lengths(pairs, csv, radius_m)?;
    if !quiet && !is_standard_stream(csv) {
        terminal::note(&format!("wrote {}: {rows} pairs, turning radius {radius_m} m", csv.display()));
    }
    Ok(())
}

fn tell_curves(from: End, to: End, arguments: &CurveArguments, quiet: bool) -> Result<(), Failure> {
    let files = Files { json: arguments.json, ..Files::default() };
    let words = files.writing([(Format::Csv, &arguments.csv), (Format::Png, &arguments.png)]).check()?;
    let answer = Answer::of(from, to, arguments);
    if arguments.csv.is_some() {
        samples::check(&answer.curves, arguments.step)?;
    }
    let told = if arguments.json { json::of(&answer) } else { summary::of(&answer) };
    let printed = words.print(&told);
    // Whatever cannot be written, all else is kept.
    let written = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| samples::write(path, &answer.curves, arguments.step)),
            (arguments.png.as_deref(), &|path| scene::draw(&answer).write_png(path)),
        ],
        quiet,
    );
    printed.and(written)
}
