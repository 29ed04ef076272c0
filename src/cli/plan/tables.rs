//! Tables of all answers as CSV files: a row for each goal and planner, and every path densely, so that others can
//! check it.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use serde::Serialize;

use crate::cli::curve;
use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::query::Query;
use crate::planning::judge::DriveFigures;
use crate::planning::{PlanFailure, PlannerName};
use crate::untrusted::spreadsheet_cell;
use crate::whole_file::WholeFile;

/// The columns in their order; of a goal that was not reached, those of the path are empty.
#[derive(Serialize)]
pub struct Row<'a> {
    field: Cow<'a, str>,
    goal: usize,
    planner: &'a str,
    success: bool,
    /// The reason why there is no path.
    reason: Option<String>,
    cpu_build_s: f64,
    cpu_query_s: f64,
    length_m: Option<f64>,
    lower_bound_ratio: Option<f64>,
    min_clearance_m: Option<f64>,
    cusps: Option<u32>,
    drive_s: Option<f64>,
    expansions: u64,
}

impl<'a> Row<'a> {
    pub fn new(attempt: &'a Attempt<'a>) -> Self {
        let (build_s, query_s) = (attempt.build.as_secs_f64(), attempt.query.as_secs_f64());
        let outcome = attempt.drive.as_ref().map(|drive| drive.figures).map_err(|reason| *reason);
        let names = (attempt.problem.name.as_str(), attempt.goal, attempt.planner.name());
        Self { expansions: attempt.expansions, ..Self::with(names, [build_s, query_s], outcome) }
    }

    /// Makes the row of a query of a benchmark.
    pub fn from_query(query: &'a Query) -> Self {
        let names = (&*query.field, query.goal, &*query.planner);
        let cpu_s = [query.cpu_build_s, query.cpu_query_s];
        Self { expansions: query.expansions, ..Self::with(names, cpu_s, query.outcome) }
    }

    /// The row of a field, goal and planner, and of CPU times of building and of the query.
    fn with(
        (field, goal, planner): (&'a str, usize, &'a str),
        [cpu_build_s, cpu_query_s]: [f64; 2],
        outcome: Result<DriveFigures, PlanFailure>,
    ) -> Self {
        let figures = outcome.ok();
        Self {
            field: Cow::Borrowed(field),
            goal,
            planner,
            success: outcome.is_ok(),
            reason: outcome.err().map(|reason| reason.to_string()),
            cpu_build_s,
            cpu_query_s,
            length_m: figures.map(|figures| figures.length_m),
            lower_bound_ratio: figures.and_then(|figures| figures.lower_bound_ratio),
            min_clearance_m: figures.map(|figures| figures.min_clearance_m),
            cusps: figures.map(|figures| figures.cusps),
            drive_s: figures.map(|figures| figures.drive_s),
            expansions: 0,
        }
    }

    /// Makes the same row for a CSV file, where names are cells.
    pub fn in_table(self) -> Self {
        let field = match self.field {
            Cow::Borrowed(field) => spreadsheet_cell(field),
            Cow::Owned(field) => Cow::Owned(spreadsheet_cell(&field).into_owned()),
        };
        Self { field, ..self }
    }
}

/// Writes a row for each attempt; numbers read back as the same `f64`, and no spreadsheet computes a name.
pub fn write_rows(path: &Path, attempts: &[Attempt]) -> io::Result<()> {
    write_csv(path, attempts.iter().map(|attempt| Row::new(attempt).in_table()))
}

/// Writes rows under the names of their members.
fn write_csv(path: &Path, rows: impl Iterator<Item = impl Serialize>) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(WholeFile::create(path)?);
    for row in rows {
        table.serialize(row)?;
    }
    table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}

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
    write_csv(path, attempts.iter().flat_map(path_rows))
}

fn path_rows<'a>(attempt: &'a Attempt) -> impl Iterator<Item = PathRow<'a>> {
    let samples = attempt.drive.iter().flat_map(|drive| curve::poses_along(&drive.path, STEP_M));
    let field = spreadsheet_cell(&attempt.problem.name);
    samples.map(move |(s_m, pose, direction)| PathRow {
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
