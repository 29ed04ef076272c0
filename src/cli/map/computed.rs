//! Results of computations on a map: values, perhaps a path, and how long they took.

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use crate::cli::map::options::Neighbours;
use crate::cli::map::traces::{GraphTrace, SearchTrace};
use wildfire_base::document::number::{count, rounded, short};
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_grid::descent::{Descent, Escape};
use wildfire_grid::map_files::{MapValue, write_csv, write_npy};
use wildfire_grid::path_search::MAX_CELLS;
use wildfire_grid::place::octile_length;
use wildfire_grid::{BadPlace, Grid, Place, Route, place};
use wildfire_picture::Spot;

/// The result of a computation on a map.
#[derive(Debug)]
pub struct Computed {
    /// The name of the map, such as `Brushfire, 8 neighbours`.
    pub title: String,
    /// The name of the values, in a word or two.
    pub value_name: &'static str,
    pub values: MapValues,
    /// Which cells have no value.
    pub bare: NoData,
    /// Free cells that the wave never reaches, of a wavefront.
    pub unreached: Option<usize>,
    pub goal: Option<Place>,
    pub walk: Option<MapWalk>,
    /// What a search did.
    pub search: Option<SearchTrace>,
    /// The tree or roadmap that a path was found in.
    pub graph: Option<GraphTrace>,
    /// CPU time of the values.
    pub cpu_map: Duration,
    /// CPU time of the walk.
    pub cpu_path: Option<Duration>,
}

/// Which cells have no value, and what they are called where they are free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoData {
    None,
    /// Obstacles, and cells whose value is 0.
    Zero(&'static str),
    /// Cells whose value is infinite.
    Infinite(&'static str),
}

/// Why a question about a map has no answer.
#[derive(Debug, thiserror::Error)]
pub enum MapInputError {
    /// A start or goal that the map does not allow.
    #[error("the {which} at {problem}")]
    End { which: &'static str, problem: BadPlace },
    #[error("the map has {cells} cells; expected at most {MAX_CELLS} for `{command}`")]
    TooLarge { cells: usize, command: &'static str },
}

impl MapInputError {
    /// Returns what was probably meant by a place that lies on the map as column and row.
    pub fn help(&self) -> Option<String> {
        let Self::End { problem: BadPlace::Outside { place: (row, col), rows, cols }, .. } = *self else { return None };
        let is_swapped = col < rows && row < cols;
        is_swapped.then(|| format!("places are ROW,COLUMN; did you mean {col},{row}?"))
    }
}

impl Computed {
    /// Values alone, and the CPU time that they took.
    pub fn new(title: impl Into<String>, value_name: &'static str, (values, cpu_map): (MapValues, Duration)) -> Self {
        Self {
            title: title.into(),
            value_name,
            values,
            bare: NoData::None,
            unreached: None,
            goal: None,
            walk: None,
            search: None,
            graph: None,
            cpu_map,
            cpu_path: None,
        }
    }
}

pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let mut stopwatch = CpuStopwatch::start();
    let result = work();
    (result, stopwatch.elapsed_since_last())
}

pub fn title_with_neighbours(name: &str, Neighbours(number): Neighbours) -> String {
    format!("{name}, {number} neighbours")
}

/// Accepts maps that a search has room for.
pub fn check_size(command: &'static str, occupied: &Grid<bool>) -> Result<(), MapInputError> {
    let cells = occupied.values().len();
    if cells > MAX_CELLS { Err(MapInputError::TooLarge { cells, command }) } else { Ok(()) }
}

pub fn check_free(which: &'static str, occupied: &Grid<bool>, place: Place) -> Result<(), MapInputError> {
    place::check_free(occupied, place).map_err(|problem| MapInputError::End { which, problem })
}

pub fn check_inside(which: &'static str, occupied: &Grid<bool>, place: Place) -> Result<(), MapInputError> {
    match check_free(which, occupied, place) {
        Err(MapInputError::End { problem: BadPlace::Occupied { .. }, .. }) => Ok(()),
        checked => checked,
    }
}

/// Accepts a goal on a free cell, a start on the map, and a map that there is room for.
pub fn check_problem(
    command: &'static str,
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
) -> Result<(), MapInputError> {
    check_size(command, occupied)?;
    check_free("goal", occupied, goal)?;
    check_inside("start", occupied, start)
}

/// A map of values.
#[derive(Debug)]
pub enum MapValues {
    Flags(Grid<bool>),
    Distances(Grid<u16>),
    Steps(Grid<u32>),
    Reals(Grid<f64>),
}

/// One value of a map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    Whole(u32),
    Real(f64),
}

impl MapValues {
    pub fn write_csv(&self, path: &Path) -> io::Result<()> {
        match self {
            Self::Flags(map) => write_csv(path, map),
            Self::Distances(map) => write_csv(path, map),
            Self::Steps(map) => write_csv(path, map),
            Self::Reals(map) => write_csv(path, map),
        }
    }

    pub fn write_npy(&self, path: &Path) -> io::Result<()> {
        match self {
            Self::Flags(map) => write_npy(path, map),
            Self::Distances(map) => write_npy(path, map),
            Self::Steps(map) => write_npy(path, map),
            Self::Reals(map) => write_npy(path, map),
        }
    }

    pub fn at(&self, place: Place) -> Value {
        match self {
            Self::Flags(map) => Value::Whole(map[place].into()),
            Self::Distances(map) => Value::Whole(map[place].into()),
            Self::Steps(map) => Value::Whole(map[place]),
            Self::Reals(map) => Value::Real(map[place]),
        }
    }

    /// The largest value that is finite; `None` if there is none.
    pub fn max(&self) -> Option<Value> {
        match self {
            Self::Flags(map) => map.values().iter().max().map(|&value| Value::Whole(value.into())),
            Self::Distances(map) => map.values().iter().max().map(|&value| Value::Whole(value.into())),
            Self::Steps(map) => map.values().iter().max().map(|&value| Value::Whole(value)),
            Self::Reals(map) => {
                map.values().iter().copied().filter(|value| value.is_finite()).reduce(f64::max).map(Value::Real)
            }
        }
    }
}

impl Value {
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Whole(value) => value.into(),
            Self::Real(value) => value,
        }
    }

    /// The value as the CSV file has it.
    pub fn to_text(self) -> String {
        let mut text = Vec::new();
        match self {
            Self::Whole(value) => value.append_text(&mut text),
            Self::Real(value) => value.append_text(&mut text),
        }
        String::from_utf8(text).expect("numbers are ASCII")
    }

    /// The value with two digits after the point where it is no integer by type.
    pub fn to_short_text(self) -> String {
        match self {
            Self::Whole(value) => value.to_string(),
            Self::Real(value) => rounded(value, 2),
        }
    }
}

impl Value {
    /// The value in at most three digits or its whole part, as a cell has room for; nothing where it is infinite.
    pub fn to_cell_text(self) -> Option<String> {
        match self {
            Self::Whole(value) => Some(value.to_string()),
            Self::Real(value) if !value.is_finite() => None,
            Self::Real(value) => {
                // Bounds lie where rounding adds a digit: 9.996 is written as 10 and not as 10.00.
                let steps = match value.abs() {
                    size if size >= 99.95 => 1.0,
                    size if size >= 9.995 => 10.0,
                    _ => 100.0,
                };
                Some(short((value * steps).round() / steps))
            }
        }
    }
}

/// The answer to the question for a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WalkResult {
    Reached,
    Unreachable,
    Stuck,
    StartOccupied,
    /// The samples were used up.
    NotFound,
}

wildfire_base::names! { WalkResult {
    Reached: "reached",
    Unreachable: "unreachable",
    Stuck: "stuck",
    StartOccupied: "start-occupied",
    NotFound: "not-found",
} }

/// A path and its ends.
#[derive(Debug)]
pub struct MapWalk {
    pub start: Place,
    pub goal: Place,
    pub path: MapPath,
}

/// The path as far as it leads.
#[derive(Debug)]
pub struct MapPath {
    pub answer: WalkResult,
    /// Cells from the start on, or those where a path at any angle turns; empty if the path does not begin.
    pub cells: Vec<Place>,
    /// The same as points, of a path between cells; else empty.
    pub points: Vec<Spot>,
    /// Length in cells.
    pub length: f64,
    /// True if the cells are joined by segments instead of steps.
    pub is_any_angle: bool,
    /// The local minimum in which a descent ended.
    pub minimum: Option<Place>,
}

impl From<Route> for MapPath {
    fn from(route: Route) -> Self {
        let (answer, cells) = match route {
            Route::Found(cells) => (WalkResult::Reached, cells),
            Route::Unreachable => (WalkResult::Unreachable, Vec::new()),
            Route::StartOccupied => (WalkResult::StartOccupied, Vec::new()),
        };
        Self { answer, ..Self::in_steps(cells) }
    }
}

impl MapPath {
    /// Creates a path from cell to cell that reaches its goal.
    fn in_steps(cells: Vec<Place>) -> Self {
        let length = octile_length(&cells);
        Self { answer: WalkResult::Reached, cells, points: Vec::new(), length, is_any_angle: false, minimum: None }
    }
}

impl From<Descent> for MapPath {
    fn from(descent: Descent) -> Self {
        match descent {
            Descent::Reached(cells) => Self::in_steps(cells),
            Descent::Stuck(cells) => {
                let minimum = cells.last().copied();
                Self { answer: WalkResult::Stuck, minimum, ..Self::in_steps(cells) }
            }
            Descent::StartOccupied => Route::StartOccupied.into(),
        }
    }
}

impl From<Escape> for MapPath {
    fn from(escape: Escape) -> Self {
        match escape {
            Escape::NotNeeded(cells) => Descent::Reached(cells).into(),
            Escape::HandedOver { descent: mut cells, wavefront } => {
                let minimum = cells.last().copied();
                // The wavefront's path begins at the minimum, which ends the descent.
                cells.extend(wavefront.into_iter().skip(1));
                Self { minimum, ..Self::in_steps(cells) }
            }
            Escape::Unreachable(cells) => Self { answer: WalkResult::Unreachable, ..Descent::Stuck(cells).into() },
            Escape::StartOccupied => Route::StartOccupied.into(),
        }
    }
}

impl MapWalk {
    pub fn sentence(&self) -> String {
        let at = |(row, col): Place| format!("row {row}, column {col}");
        let (start, goal) = (at(self.start), at(self.goal));
        let minimum = self.path.minimum.map(|place| format!("Stuck in a local minimum at {}", at(place)));
        let measures = self.path.measures();
        match (self.path.answer, minimum) {
            (WalkResult::Reached, None) => format!("Reached the goal: {measures}."),
            (WalkResult::Reached, Some(stuck)) => {
                format!("{stuck}; reached the goal from there along the wavefront: {measures} in total.")
            }
            (WalkResult::Unreachable, None) => {
                format!("Unreachable: no path leads from the start, {start}, to the goal, {goal}.")
            }
            (WalkResult::Unreachable, Some(stuck)) => {
                format!("{stuck}. Unreachable: no path leads from there to the goal, {goal}.")
            }
            (WalkResult::Stuck, stuck) => format!("{}: {measures}.", stuck.unwrap_or_default()),
            (WalkResult::NotFound, _) => "No path found with these samples.".to_owned(),
            (WalkResult::StartOccupied, _) => format!("No path: the start, {start}, lies in an obstacle."),
        }
    }
}

impl MapPath {
    fn measures(&self) -> String {
        let pieces = self.cells.len().saturating_sub(1);
        let piece = if self.is_any_angle { "segment" } else { "step" };
        format!("{}, length {}", count(pieces, piece), rounded(self.length, 3))
    }
}
