//! Poses along curves as a table.

use std::io::{self, Write};
use std::path::Path as FilePath;

use crate::cli::curve::report::FoundCurve;
use crate::cli::curve::words;
use crate::cli::error::CliError;
use crate::geometry::Pose;
use crate::vehicle::Path;
use crate::whole_file::WholeFile;

/// The most rows of a table.
const MOST_ROWS: f64 = 1e6;

/// Refuses steps that would make the table longer than anybody reads.
pub fn check(curves: &[FoundCurve], step_m: f64) -> Result<(), CliError> {
    let rows = curves.iter().map(|curve| curve.length_m / step_m).sum::<f64>();
    if rows <= MOST_ROWS {
        return Ok(());
    }
    let sentence = format!("--step is {step_m} m: the curves have {rows:.0} steps, expected at most {MOST_ROWS}");
    Err(CliError::bad_input(sentence, Some("give a longer --step")))
}

/// Writes `curve,s_m,x_m,y_m,heading_rad,direction`, the samples of [`along`]. Numbers are the shortest decimals that read
/// back as the same `f64`.
pub fn write(path: &FilePath, curves: &[FoundCurve], step_m: f64) -> io::Result<()> {
    let mut table = WholeFile::create(path)?;
    writeln!(table, "curve,s_m,x_m,y_m,heading_rad,direction")?;
    for curve in curves {
        for (driven_m, Pose { x, y, heading }, direction) in along(&curve.path, step_m) {
            writeln!(table, "{},{driven_m},{x},{y},{heading},{direction}", curve.kind)?;
        }
    }
    table.finish()
}

/// Metres driven so far, the pose there, and whether the truck came there `forward` or in `reverse`; of the start, how it
/// leaves. The start, every joint and the end are there, and equal steps of at most `step_m` between them.
pub fn along(path: &Path, step_m: f64) -> impl Iterator<Item = (f64, Pose, &'static str)> {
    let directions = path.segments.iter().map(words::direction);
    let first = (0.0, path.start, directions.clone().next().unwrap_or("forward"));
    let mut driven_m = 0.0;
    let legs = path.legs().zip(directions).flat_map(move |((start, segment), direction)| {
        let before_m = driven_m;
        driven_m += segment.length_m.abs();
        let leg = Path { start, segments: vec![segment] };
        leg.samples(step_m).skip(1).map(|(s, pose)| (before_m + s, pose, direction)).collect::<Vec<_>>()
    });
    std::iter::once(first).chain(legs)
}
