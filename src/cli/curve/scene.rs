//! The curves between two poses as a picture.

use crate::cli::curve::args::End;
use crate::cli::curve::report::CurveReport;
use crate::cli::curve::words::short;
use crate::picture::{CurveScene, Picture, draw_curves};
use crate::vehicle::Dimensions;

/// The least extent of the picture, in turning radii.
const LEAST_RADII: f64 = 1e-3;

/// Draws the curves, and the contest's truck unless the radius is shorter than its wheelbase, which no truck drives.
pub fn draw(report: &CurveReport) -> Picture {
    let truck = Dimensions::default();
    let names: Vec<String> =
        report.curves.iter().map(|curve| format!("{}, {:.3} m", curve.name, curve.length_m)).collect();
    let ways: Vec<_> = names.iter().zip(&report.curves).map(|(name, curve)| (name.as_str(), &curve.path)).collect();
    let title = format!(
        "Shortest curves from {} to {}, turning radius {} m",
        place(report.from),
        place(report.to),
        report.radius_m
    );
    draw_curves(&CurveScene {
        title: &title,
        start: report.from.pose(),
        goal: report.to.pose(),
        ways: &ways,
        body: (report.radius_m >= truck.wheelbase_m).then_some(&truck),
        least_m: LEAST_RADII * report.radius_m,
    })
}

fn place(End { x, y, heading_deg }: End) -> String {
    format!("({}, {}, {} deg)", short(x), short(y), short(heading_deg))
}
