//! The report on a map: an object, a document and pictures of what was computed.

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::{Serialize, Serializer};
use serde_json::Value as Json;

use crate::cli::map::commands::Computation;
use crate::cli::map::computed::{Computed, MapWalk, NoData, Value};
use crate::cli::map::fields::CostArguments;
use crate::cli::map::options::NO_IMAGE;
use crate::cli::map::traces::{GraphTrace, SearchTrace};
use wildfire_base::document::number::{count, percent, rounded};
use wildfire_base::document::{Block, Document};
use wildfire_base::object;
use wildfire_base::untrusted::visible;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::map_files::{MapFile, NEAR_TOLERANCE};
use wildfire_grid::{Connectivity, Grid, Place};
use wildfire_picture::{MapGrowth, MapScene, Spot, Zones, write_map_film};

/// The size of a terminal that shows all values.
const MAX_WIDTH: usize = 80;
const MAX_ROWS: usize = 40;

/// Zones of the cost map, the most expensive first.
const ZONES: [&str; 3] = ["safety zone", "outer zone", "no cost"];

/// The contents of all outputs of a command.
pub struct MapReport<'a> {
    pub computation: &'a Computation,
    pub path: &'a Path,
    pub map: &'a MapFile,
    pub computed: &'a Computed,
    pub occupied_cells: usize,
    pub cpu_read: Duration,
}

impl<'a> MapReport<'a> {
    pub fn new(computation: &'a Computation, map: &'a MapFile, computed: &'a Computed, cpu_read: Duration) -> Self {
        let occupied_cells = map.occupied.values().iter().filter(|&&occupied| occupied).count();
        Self { computation, path: &computation.files().input.map, map, computed, occupied_cells, cpu_read }
    }

    pub fn cells(&self) -> usize {
        self.map.occupied.values().len()
    }

    /// Returns the cells of the path; `None` if there is no path or no start.
    pub fn path_cells(&self) -> Option<&[Place]> {
        self.computed.walk.as_ref().map(|walk| walk.path.cells.as_slice()).filter(|cells| !cells.is_empty())
    }

    /// Lists notes on the map and the question.
    pub fn map_sentences(&self) -> Vec<String> {
        let notes = self.map.notes.iter().map(|note| format!("{}: {note}.", visible(&self.path.to_string_lossy())));
        notes.chain(self.oddities()).collect()
    }

    /// Lists notes on the map, and the result of the walk.
    pub fn sentences(&self) -> Vec<String> {
        let walk = self.computed.walk.as_ref().map(MapWalk::sentence);
        let search = self.computed.search.as_ref().map(SearchTrace::sentence);
        let graph = self.computed.graph.as_ref().map(GraphTrace::sentence);
        self.map_sentences().into_iter().chain(walk).chain(search).chain(graph).collect()
    }

    /// The title of pictures: the map and what was computed.
    pub fn title(&self) -> String {
        let name = self.path.file_name().unwrap_or(self.path.as_os_str());
        format!("{}: {}", name.to_string_lossy(), self.computed.title)
    }

    /// The parameters with their values, such as `goal 2,5; no corner cutting`; those without a value are left out.
    pub fn parameters(&self) -> String {
        let computation = serde_json::to_value(self.computation).unwrap_or_default();
        let Some(parameters) = computation["parameters"].as_object() else { return String::new() };
        let parts = parameters.iter().filter_map(|(name, value)| {
            let name = name.replace('_', " ");
            match value {
                Json::Null | Json::Bool(false) => None,
                Json::Bool(true) => Some(name),
                Json::String(text) => Some(format!("{name} {text}")),
                Json::Array(numbers) => {
                    let numbers: Vec<String> = numbers.iter().map(Json::to_string).collect();
                    Some(format!("{name} {}", numbers.join(",")))
                }
                other => Some(format!("{name} {other}")),
            }
        });
        parts.collect::<Vec<_>>().join("; ")
    }

    /// Lists what is odd about the map or the question.
    fn oddities(&self) -> Vec<String> {
        let mut oddities = self.map.doubts();
        if self.occupied_cells == 0 {
            oddities.push("No obstacle: no cell of the map is occupied.".to_owned());
        }
        if self.occupied_cells == self.cells() {
            oddities.push("No free cell: every cell of the map is occupied.".to_owned());
        }
        if let Some(goal) = self.computed.goal.filter(|&goal| self.map.occupied[goal]) {
            oddities.push(format!("The goal, row {}, column {}, lies in an obstacle.", goal.0, goal.1));
        }
        if self.computation.files().input.reading.tolerance.is_some() && self.map.grey.is_none() {
            oddities.push(NO_IMAGE.to_owned());
        }
        oddities
    }
}

/// A path in cells, or through points, whose rows and columns are whole numbers at the centres of cells.
#[derive(Serialize)]
#[serde(untagged)]
enum PathMember<'a> {
    Cells(&'a [Place]),
    Points(&'a [Spot]),
}

impl Serialize for MapReport<'_> {
    /// Serialises the members in their order; what does not apply is null.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let computed = self.computed;
        let occupied = self.occupied_cells;
        let path = self.path_cells();
        let walk = computed.walk.as_ref();
        let search = computed.search.as_ref();
        let graph = computed.graph.as_ref();
        let report = object!(Map {
            program_version: PROGRAM_VERSION,
            map: self.path.display().to_string(),
            rows: self.map.occupied.rows(),
            cols: self.map.occupied.cols(),
            cells: self.cells(),
            occupied,
            no_obstacle: occupied == 0,
            tolerance: self.map.tolerance,
            near_tolerance: self.map.share_near(),
            remove_edges: self.computation.files().input.reading.remove_edges,
            // `command` and `parameters`.
            #[serde(flatten)]
            computation: self.computation,
            maximum: computed.values.max(),
            unreached: computed.unreached,
            answer: walk.map(|walk| walk.path.answer),
            minimum: walk.and_then(|walk| walk.path.minimum),
            path_cells: path.map(<[Place]>::len),
            steps: path.map(|cells| cells.len() - 1),
            length: path.and(walk).map(|walk| walk.path.length),
            cost: search.and_then(|search| search.cost).or(graph.and_then(|graph| graph.cost)),
            shortest_cost: search.and_then(|search| search.shortest).map(|shortest| shortest.cost),
            cost_bound: search.and_then(|search| search.shortest).and_then(|shortest| shortest.bound),
            expansions: search.map(|search| search.expanded.len()),
            touched: search.map(|search| search.touched),
            samples: graph.map(|graph| graph.samples),
            vertices: graph.map(|graph| graph.vertices),
            edges: graph.map(|graph| graph.edges.len()),
            path: path.map(|cells| match walk.map(|walk| walk.path.points.as_slice()) {
                Some(points) if !points.is_empty() => PathMember::Points(points),
                _ => PathMember::Cells(cells),
            }),
            notes: self.sentences(),
            measured: object!(Measured {
                cpu_read_s: self.cpu_read.as_secs_f64(),
                cpu_map_s: computed.cpu_map.as_secs_f64(),
                cpu_path_s: computed.cpu_path.map(|cpu| cpu.as_secs_f64()),
            }),
        });
        report.serialize(serializer)
    }
}

impl From<&MapReport<'_>> for Document {
    /// Size, notes, the largest value, CPU time, and the values themselves where they fit on a terminal and nowhere else.
    fn from(report: &MapReport) -> Self {
        let mut lines: Vec<String> = near_tolerance(report).into_iter().collect();
        lines.push(largest_value(report));
        lines.extend(report.sentences());
        lines.push(cpu(report));
        let more_files = report.computation.parameters().more_files();
        let has_files =
            report.computation.files().output.has_files() || more_files.iter().any(|(_, file)| file.is_some());
        let values = values(report).filter(|_| !has_files);
        Self::new(size(report)).with([Block::List(lines)]).with(values.map(Block::Verbatim))
    }
}

/// Describes the map: its file, size, and how much is occupied.
pub fn size(report: &MapReport) -> String {
    let path = report.path.to_string_lossy();
    let path = visible(&path);
    let map = &report.map.occupied;
    let cells = report.cells();
    let occupied = report.occupied_cells;
    let share = percent(occupied as f64 / cells as f64);
    let [rows, cols, cells] =
        [(map.rows(), "row"), (map.cols(), "column"), (cells, "cell")].map(|(n, of)| count(n, of));
    format!("{path}: {rows} x {cols}, {cells}, {occupied} occupied ({share} %)")
}

/// Says how much of an image the tolerance hardly separates.
fn near_tolerance(report: &MapReport) -> Option<String> {
    let percent = percent(report.map.share_near()?);
    let tolerance = report.map.tolerance?;
    Some(format!("Tolerance {tolerance}: {percent} % of the pixels within {NEAR_TOLERANCE} grey levels of it"))
}

fn largest_value(report: &MapReport) -> String {
    let computed = report.computed;
    let max = computed.values.max().map_or("none".to_owned(), Value::to_text);
    let unreached = computed.unreached.map(|cells| format!(", free cells unreached {cells}"));
    format!("{}: maximum {max}{}", computed.title, unreached.unwrap_or_default())
}

fn cpu(report: &MapReport) -> String {
    let path = report.computed.cpu_path.map(|cpu| format!(", path {}", ms(cpu)));
    format!("CPU: reading {}, map {}{}", ms(report.cpu_read), ms(report.computed.cpu_map), path.unwrap_or_default())
}

fn ms(cpu: Duration) -> String {
    format!("{} ms", rounded(cpu.as_secs_f64() * 1e3, 3))
}

/// All values in rows and columns, those on the path with a star before them; `None` if they would not fit.
fn values(report: &MapReport) -> Option<String> {
    let rows = report.map.occupied.rows();
    let cols = report.map.occupied.cols();
    if rows > MAX_ROWS || cols > MAX_WIDTH {
        return None;
    }
    let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
    let mut texts: Vec<_> = places.map(|place| report.computed.values.at(place).to_short_text()).collect();
    let width = 1 + texts.iter().map(String::len).max().unwrap_or(0);
    for &(row, col) in report.path_cells().unwrap_or_default() {
        let text = &mut texts[row * cols + col];
        // A path may pass a cell twice, which has one star nevertheless.
        if !text.starts_with('*') {
            text.insert(0, '*');
        }
    }
    (width * cols <= MAX_WIDTH).then(|| {
        texts
            .chunks(cols)
            .map(|row| row.iter().map(|text| format!("{text:>width$}")).collect::<String>() + "\n")
            .collect()
    })
}

/// Draws a report.
pub fn with_scene<T>(report: &MapReport, draw: impl FnOnce(&MapScene) -> T) -> T {
    let computed = report.computed;
    let value = |place| drawn_value(report, place);
    let title = report.title();
    let subtitle = report.parameters();
    let text = |place| computed.values.at(place).to_cell_text();
    let bare = MapScene::new(&title, computed.value_name, &report.map.occupied, &value);
    let scene = MapScene {
        subtitle: &subtitle,
        colourless: match computed.bare {
            NoData::None => bare.colourless,
            NoData::Zero(name) | NoData::Infinite(name) => name,
        },
        path: report.path_cells().unwrap_or_default(),
        track: computed.walk.as_ref().map_or(&[], |walk| walk.path.points.as_slice()),
        edges: computed.graph.as_ref().map_or(&[], |graph| graph.edges.as_slice()),
        swept: computed.search.as_ref().and_then(|search| search.swept.as_ref()),
        start: computed.walk.as_ref().map(|walk| walk.start),
        goal: computed.goal,
        stuck: computed.walk.as_ref().and_then(|walk| walk.path.minimum),
        texts: report.computation.files().output.values.then_some(&text),
        colours: report.computation.files().output.colormap.into(),
        free_name: matches!(report.computation, Computation::Occupancy(_)).then_some("free"),
        ..bare
    };
    // Only the map of costs has zones, and finding them takes another pass over the map.
    let Computation::Cost(question) = report.computation else { return draw(&scene) };
    let in_safety_zone = safety_zone(&report.map.occupied, &question.parameters);
    let zone = |place| match computed.values.at(place).as_f64() {
        _ if in_safety_zone[place] => 0,
        cost if cost > 0.0 => 1,
        _ => 2,
    };
    draw(&MapScene { zones: Some(Zones { names: &ZONES, zone: &zone }), ..scene })
}

/// The value to draw: a wavefront has none where the wave does not come.
fn drawn_value(report: &MapReport, place: Place) -> Option<f64> {
    let value = report.computed.values.at(place).as_f64();
    let is_bare = match report.computed.bare {
        NoData::None => false,
        NoData::Zero(_) => report.map.occupied[place] || value == 0.0,
        NoData::Infinite(_) => value.is_infinite(),
    };
    (!is_bare).then_some(value)
}

/// Writes the film of a computation: cells as they were expanded, edges as they were added, or values in ascending order.
pub fn write_film(report: &MapReport, path: &Path) -> io::Result<()> {
    let rows = report.map.occupied.rows();
    let cols = report.map.occupied.cols();
    let mut order = Grid::filled(rows, cols, None::<usize>);
    let steps = match (&report.computed.search, &report.computed.graph) {
        (Some(search), _) => {
            for (step, &index) in search.expanded.iter().enumerate() {
                order.values_mut()[index as usize] = Some(step);
            }
            search.expanded.len()
        }
        (None, Some(graph)) => {
            // A cell has the value of a point of the graph, which comes with its first edge.
            for (step, &[from, to]) in graph.edges.iter().enumerate() {
                for (row, col) in [from, to] {
                    let cell = (row.round() as usize, col.round() as usize);
                    order[cell].get_or_insert(step);
                }
            }
            graph.edges.len()
        }
        // A front that spreads gives all cells of a step the same value, the next larger one.
        (None, None) => {
            let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
            let mut values: Vec<f64> = places.clone().filter_map(|place| drawn_value(report, place)).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            for place in places {
                let value = drawn_value(report, place);
                order[place] = value.and_then(|value| values.binary_search_by(|other| other.total_cmp(&value)).ok());
            }
            values.len()
        }
    };
    let paths = report.computed.graph.as_ref().map_or(&[][..], |graph| graph.earlier.as_slice());
    with_scene(report, |scene| write_map_film(scene, &MapGrowth { steps, step_of: &|place| order[place], paths }, path))
}

fn safety_zone(occupied: &Grid<bool>, arguments: &CostArguments) -> Grid<bool> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let Some(distances) = brushfire(occupied, Connectivity::Four) else { return Grid::filled(rows, cols, false) };
    Grid::from_values(
        rows,
        cols,
        distances.values().iter().map(|&value| value - 1 < arguments.safety_distance).collect(),
    )
}
