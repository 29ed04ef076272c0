//! Tables of curves as CSV files: lengths and words of many pairs of poses, and poses along a few curves.
//!
//! Numbers are the shortest decimals that read back as the same `f64`.

use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::path::Path as FilePath;

use crate::cli::curve::report::{FoundCurve, direction, dubins_word, reeds_shepp_word};
use crate::cli::error::CliError;
use crate::cli::number_table::{Column, Columns, Content, write_answers};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dubins, Path, ReedsShepp};
use wildfire_base::whole_file::WholeFile;

/// The range of coordinates in metres, and of headings in degrees or radians. Within this and the range of turning radii a curve ends
/// within 1e-8 m and 1e-11 turning radii of its goal.
pub const COORDINATES: RangeInclusive<f64> = -1e6..=1e6;

/// Columns that are written after all that are there.
const ADDED: [&str; 4] = ["reeds_shepp_m", "reeds_shepp_word", "dubins_m", "dubins_word"];

/// Writes the rows of a table of pairs, each with the lengths and words of its shortest curves after its own columns,
/// which stay as they are; tells how many rows.
///
/// Numbers are the shortest decimals that read back as the same `f64`. A row is read, written and forgotten before the
/// next.
pub fn write_lengths(input: &FilePath, output: &FilePath, radius_m: f64) -> Result<u64, CliError> {
    let reeds_shepp = ReedsShepp { radius_m };
    let dubins = Dubins { radius_m };
    let read = COLUMNS.map(|name| Column { name, content: Content::Number(COORDINATES), without: None });
    let columns = Columns { read, row: "a pair of poses", added: &ADDED };
    write_answers(input, output, columns, |_, &[x0, y0, th0, x1, y1, th1]| {
        let from = Pose::new(x0, y0, th0);
        let to = Pose::new(x1, y1, th1);
        let best = reeds_shepp.shortest(from, to);
        let forward = dubins.shortest(from, to);
        let labels = [reeds_shepp_word(&best), dubins_word(&forward)];
        Ok(vec![format!("{},{},{},{}", best.length_m, labels[0], forward.length_m, labels[1])])
    })
}

/// Columns that are read, by their names in the header: metres and radians.
const COLUMNS: [&str; 6] = ["x0", "y0", "th0", "x1", "y1", "th1"];

/// The most rows of a table.
const MAX_ROWS: f64 = 1e6;

/// Refuses steps that would make the table longer than anybody reads.
pub fn check_samples(curves: &[FoundCurve], step_m: f64) -> Result<(), CliError> {
    let rows = curves.iter().map(|curve| curve.length_m / step_m).sum::<f64>();
    if rows <= MAX_ROWS {
        return Ok(());
    }
    let sentence = format!("--step-m is {step_m} m: the curves have {rows:.0} steps, expected at most {MAX_ROWS}");
    Err(CliError::bad_input(sentence, Some("choose a larger --step-m")))
}

/// Writes `curve,s_m,x_m,y_m,heading_rad,direction`, the samples of [`poses_along`]. Numbers are the shortest decimals that read
/// back as the same `f64`.
pub fn write_samples(path: &FilePath, curves: &[FoundCurve], step_m: f64) -> io::Result<()> {
    let mut table = WholeFile::create(path)?;
    writeln!(table, "curve,s_m,x_m,y_m,heading_rad,direction")?;
    for curve in curves {
        for PathSample { driven_m, pose: Pose { x, y, heading }, direction } in poses_along(&curve.path, step_m) {
            writeln!(table, "{},{driven_m},{x},{y},{heading},{direction}", curve.kind)?;
        }
    }
    table.finish()
}

/// A pose on a path.
#[derive(Debug)]
pub struct PathSample {
    /// From the start of the path.
    pub driven_m: f64,
    pub pose: Pose,
    /// `forward` or `reverse`, as the truck came there; of the start, as it leaves.
    pub direction: &'static str,
}

/// The start, every joint and the end of a path, and equal steps of at most `step_m` between them.
pub fn poses_along(path: &Path, step_m: f64) -> impl Iterator<Item = PathSample> {
    let directions = path.segments.iter().map(direction);
    let direction = directions.clone().next().unwrap_or("forward");
    let first = PathSample { driven_m: 0.0, pose: path.start, direction };
    let mut driven_m = 0.0;
    let legs = path.legs().zip(directions).flat_map(move |((start, segment), direction)| {
        let before_m = driven_m;
        driven_m += segment.length_m.abs();
        let leg = Path { start, segments: vec![segment] };
        let samples = leg.samples(step_m).skip(1);
        samples.map(|(s, pose)| PathSample { driven_m: before_m + s, pose, direction }).collect::<Vec<_>>()
    });
    std::iter::once(first).chain(legs)
}
