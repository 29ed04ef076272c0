//! A report as what a picture of it shows.

use crate::cli::map::args::{Computation, CostArguments};
use crate::cli::map::report::MapReport;
use crate::grid::brushfire::brushfire;
use crate::grid::{Connectivity, Grid, Place};
use crate::picture::{MapScene, Picture, Zones};

/// Zones of the cost map, the most expensive first.
const ZONES: [&str; 3] = ["safety zone", "outer zone", "no cost"];

/// Draws a report.
pub fn with_scene(report: &MapReport, draw: impl FnOnce(&MapScene) -> Picture) -> Picture {
    let computed = report.computed;
    let value = |place| value(report, place);
    let scene = MapScene {
        path: report.way().unwrap_or_default(),
        start: computed.walk.as_ref().map(|walk| walk.start),
        goal: computed.goal,
        stuck: computed.walk.as_ref().and_then(|walk| walk.way.minimum),
        colours: report.computation.files().output.colormap.into(),
        free_name: matches!(report.computation, Computation::Occupancy(_)).then_some("free"),
        ..MapScene::new(&computed.title, computed.value_name, &report.map.occupied, &value)
    };
    let Computation::Cost(arguments) = report.computation else { return draw(&scene) };
    let in_safety_zone = safety_zone(&report.map.occupied, arguments);
    let zone = |place| match computed.values.at(place).as_f64() {
        _ if in_safety_zone[place] => 0,
        cost if cost > 0.0 => 1,
        _ => 2,
    };
    draw(&MapScene { zones: Some(Zones { names: &ZONES, zone: &zone }), ..scene })
}

/// The value to draw: a wavefront has none where the wave does not come.
fn value(report: &MapReport, place: Place) -> Option<f64> {
    let value = report.computed.values.at(place).as_f64();
    let is_wave = report.computed.unreached.is_some();
    let is_bare = is_wave && (report.map.occupied[place] || value == 0.0);
    (!is_bare).then_some(value)
}

fn safety_zone(occupied: &Grid<bool>, arguments: &CostArguments) -> Grid<bool> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let Some(distances) = brushfire(occupied, Connectivity::Four) else { return Grid::filled(rows, cols, false) };
    let is_near = |&value: &u16| value - 1 < arguments.safety_distance;
    Grid::from_values(rows, cols, distances.values().iter().map(is_near).collect())
}
