//! Every path densely as a CSV file, so that others can check it.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use serde::Serialize;

use crate::cli::curve::{self, PathSample};
use wildfire_base::untrusted::spreadsheet_cell;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::drives::Attempt;
use wildfire_planning::PlannerName;

/// A little less than 5 cm, so that rounding of `s_m` never makes a step longer than that.
const STEP_M: f64 = 0.0499;

/// A pose of the rear axle on a path.
#[derive(Serialize)]
struct PathRow<'a> {
    field: Cow<'a, str>,
    goal: usize,
    planner: &'a PlannerName,
    /// Metres driven so far, forward and reverse alike.
    s_m: f64,
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    /// The gear in which the truck arrives there; of the start, that in which it leaves.
    direction: &'static str,
}

/// Writes start, joints, end, and equal steps between them of at most 5 cm, of every path that was found.
pub fn write_paths(path: &Path, attempts: &[Attempt]) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(WholeFile::create(path)?);
    for row in attempts.iter().flat_map(path_rows) {
        table.serialize(row)?;
    }
    table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}

fn path_rows<'a>(attempt: &'a Attempt) -> impl Iterator<Item = PathRow<'a>> {
    let samples = attempt.drive.iter().flat_map(|drive| curve::poses_along(&drive.path, STEP_M));
    let field = spreadsheet_cell(&attempt.problem.name);
    samples.map(move |PathSample { driven_m: s_m, pose, direction }| PathRow {
        field: field.clone(),
        goal: attempt.goal,
        planner: &attempt.planner,
        s_m,
        x_m: pose.x,
        y_m: pose.y,
        heading_rad: pose.heading,
        direction,
    })
}
