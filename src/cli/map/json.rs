//! A report as one JSON object.

use serde::Serialize;

use crate::batch::PROGRAM_VERSION;
use crate::cli::map::args::Computation;
use crate::cli::map::report::MapReport;
use crate::cli::map::values::Value;
use crate::cli::map::walk::WalkResult;
use crate::grid::Place;
use crate::grid::place::octile_length;

/// The members in their order; what does not apply is null.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    map: String,
    rows: usize,
    cols: usize,
    cells: usize,
    occupied: usize,
    no_obstacle: bool,
    tolerance: Option<u8>,
    near_tolerance: Option<f64>,
    remove_edges: usize,
    /// `command` and `parameters`.
    #[serde(flatten)]
    computation: &'a Computation,
    maximum: Option<Value>,
    unreached: Option<usize>,
    answer: Option<WalkResult>,
    minimum: Option<Place>,
    path_cells: Option<usize>,
    steps: Option<usize>,
    length: Option<f64>,
    path: Option<&'a [Place]>,
    notes: Vec<String>,
    measured: Measured,
}

#[derive(Serialize)]
struct Measured {
    cpu_read_s: f64,
    cpu_map_s: f64,
    cpu_path_s: Option<f64>,
}

/// The report on one line.
pub fn to_json(report: &MapReport) -> String {
    let (computed, occupied, way) = (report.computed, report.occupied_cells, report.way());
    let walk = computed.walk.as_ref();
    let object = Object {
        program_version: PROGRAM_VERSION,
        map: report.path.display().to_string(),
        rows: report.map.occupied.rows(),
        cols: report.map.occupied.cols(),
        cells: report.cells(),
        occupied,
        no_obstacle: occupied == 0,
        tolerance: report.tolerance(),
        near_tolerance: report.near_tolerance(),
        remove_edges: report.computation.files().input.reading.remove_edges,
        computation: report.computation,
        maximum: computed.values.max(),
        unreached: computed.unreached,
        answer: walk.map(|walk| walk.way.answer),
        minimum: walk.and_then(|walk| walk.way.minimum),
        path_cells: way.map(<[Place]>::len),
        steps: way.map(|cells| cells.len() - 1),
        length: way.map(octile_length),
        path: way,
        notes: report.sentences(),
        measured: Measured {
            cpu_read_s: report.cpu_read.as_secs_f64(),
            cpu_map_s: computed.cpu_map.as_secs_f64(),
            cpu_path_s: computed.cpu_path.map(|cpu| cpu.as_secs_f64()),
        },
    };
    serde_json::to_string(&object).expect("names, numbers and words are JSON")
}
