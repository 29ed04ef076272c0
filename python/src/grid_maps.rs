//! Grid maps of numpy arrays: wavefronts, and searches for paths.

use numpy::{AllowTypeChange, Element, IntoPyArray, PyArrayLike2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wildfire::grid::map_files::{MAX_CELLS, MAX_SIDE};
use wildfire::grid::path_search::{
    Heuristic, MAX_CELLS as MAX_SEARCHED_CELLS, SearchOrder, jump_point_search, search_best_first, theta_star,
};
use wildfire::grid::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, wavefront};

use crate::arrays::{described, rows};

/// A map of free and occupied cells.
pub struct Occupied(pub Grid<bool>);

impl<'py> FromPyObject<'_, 'py> for Occupied {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let expected = || {
            let found = described(&object);
            PyValueError::new_err(format!(
                "expected occupied of shape (rows, cols) with flags or numbers, found {found}"
            ))
        };
        // Texts are all true.
        let numpy = object.py().import("numpy")?;
        let array = numpy.call_method1("asarray", (object,)).map_err(|_| expected())?;
        let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
        let cells = array.extract::<PyArrayLike2<'_, bool, AllowTypeChange>>().ok().filter(|_| "biuf".contains(&kind));
        let cells = cells.ok_or_else(expected)?;
        let cells = cells.as_array();
        Ok(Self(Grid::from_values(cells.nrows(), cells.ncols(), cells.iter().copied().collect())))
    }
}

impl Occupied {
    /// Returns the map if it is not larger than the maps of the command line.
    fn checked(self, max_cells: usize) -> PyResult<Grid<bool>> {
        let Self(map) = self;
        let (rows, cols) = (map.rows(), map.cols());
        if [rows, cols].iter().all(|side| (1..=MAX_SIDE).contains(side)) && rows * cols <= max_cells {
            return Ok(map);
        }
        let sentence = format!(
            "occupied has shape ({rows}, {cols}); expected 1 to {MAX_SIDE} cells per side, at most {max_cells} in all"
        );
        Err(PyValueError::new_err(sentence))
    }
}

/// Reads a cell: two integers, of a tuple, a list or an array.
fn cell(which: &str, object: &Bound<'_, PyAny>) -> PyResult<Place> {
    let numbers =
        object.try_iter().and_then(|items| items.map(|item| item?.extract::<usize>()).collect::<PyResult<Vec<_>>>());
    let found = || object.repr().map_or_else(|_| described(object), |text| text.to_string());
    match numbers.as_deref() {
        Ok(&[row, col]) => Ok((row, col)),
        _ => Err(PyValueError::new_err(format!("the {which} is {}; expected (row, column), from 0", found()))),
    }
}

fn connectivity(neighbours: u32) -> PyResult<Connectivity> {
    match neighbours {
        4 => Ok(Connectivity::Four),
        8 => Ok(Connectivity::Eight),
        _ => Err(PyValueError::new_err(format!("neighbours is {neighbours}; expected 4 or 8"))),
    }
}

fn corners(corner_cutting: bool) -> CornerCutting {
    if corner_cutting { CornerCutting::Allowed } else { CornerCutting::Forbidden }
}

fn bad_end(goal: Place, bad: &BadPlace) -> PyErr {
    let (BadPlace::Outside { place, .. } | BadPlace::Occupied { place }) = bad;
    let which = if *place == goal { "goal" } else { "start" };
    PyValueError::new_err(format!("the {which} at {bad}"))
}

fn grid_array<T: Element + Clone>(py: Python<'_>, grid: Grid<T>) -> PyResult<Bound<'_, PyAny>> {
    let shape = (grid.rows(), grid.cols());
    grid.values().to_vec().into_pyarray(py).call_method1("reshape", (shape,))
}

/// Counts the fewest steps from each cell to the goal, plus two: 2 on the goal, 1 on obstacles, 0 where no path leads.
///
/// Parameters
/// ----------
/// occupied : array of shape (rows, cols), bool
/// goal : (int, int)
///     Row and column, from 0.
/// neighbours : {8, 4}
/// corner_cutting : bool
///     False: a diagonal step needs both cells beside it to be free.
///
/// Returns
/// -------
/// array of shape (rows, cols), uint32
///
/// Raises
/// ------
/// ValueError
///     An argument is invalid, or the goal is occupied.
#[pyfunction]
#[pyo3(name = "wavefront", signature = (occupied, goal, neighbours = 8, corner_cutting = true))]
pub fn wavefront_map<'py>(
    py: Python<'py>,
    occupied: Occupied,
    goal: &Bound<'py, PyAny>,
    neighbours: u32,
    corner_cutting: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let connectivity = connectivity(neighbours)?;
    let goal = cell("goal", goal)?;
    let occupied = occupied.checked(MAX_CELLS)?;
    let map = py.detach(|| wavefront::wavefront(&occupied, goal, connectivity, corners(corner_cutting)));
    grid_array(py, map.map_err(|bad| bad_end(goal, &bad))?)
}

/// Searches a grid for a path.
///
/// A step costs 1, a diagonal one the square root of 2. Ties go to the larger cost so far, then to the first cell in
/// reading order, so that the same map gives the same path everywhere.
///
/// Parameters
/// ----------
/// occupied : array of shape (rows, cols), bool
/// start, goal : (int, int)
///     Row and column, from 0.
/// method : {"astar", "dijkstra", "greedy", "jps", "theta"}
///     The last two, jump point search and Theta*, have 8 neighbours; paths of Theta* are straight between their cells.
/// neighbours : {8, 4}
/// corner_cutting : bool
///     False: a diagonal step needs both cells beside it to be free.
///
/// Returns
/// -------
/// GridSearch
///
/// Raises
/// ------
/// ValueError
///     An argument is invalid, the goal is occupied, or an end is outside.
#[pyfunction]
#[pyo3(signature = (occupied, start, goal, method = "astar", *, neighbours = 8, corner_cutting = true))]
pub fn search_grid<'py>(
    py: Python<'py>,
    occupied: Occupied,
    start: &Bound<'py, PyAny>,
    goal: &Bound<'py, PyAny>,
    method: &str,
    neighbours: u32,
    corner_cutting: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let connectivity = connectivity(neighbours)?;
    let corners = corners(corner_cutting);
    let ends = (cell("start", start)?, cell("goal", goal)?);
    let order = match method {
        "astar" => Some(SearchOrder::astar(connectivity)),
        "dijkstra" => Some(SearchOrder::Dijkstra),
        "greedy" => Some(SearchOrder::Greedy { heuristic: Heuristic::exact(connectivity) }),
        "jps" | "theta" if connectivity == Connectivity::Eight => None,
        "jps" | "theta" => {
            return Err(PyValueError::new_err(format!("neighbours is {neighbours}; expected 8 for `{method}`")));
        }
        _ => {
            let expected = "'astar', 'dijkstra', 'greedy', 'jps' or 'theta'";
            return Err(PyValueError::new_err(format!("method is '{method}'; expected {expected}")));
        }
    };
    let occupied = occupied.checked(MAX_SEARCHED_CELLS)?;
    let searched = py.detach(|| match order {
        Some(order) => search_best_first(&occupied, ends.0, ends.1, order, connectivity, corners),
        None if method == "jps" => jump_point_search(&occupied, ends.0, ends.1, corners),
        None => theta_star(&occupied, ends.0, ends.1, corners),
    });
    let searched = searched.map_err(|bad| bad_end(ends.1, &bad))?;
    let number = |(row, col): Place| [row as i64, col as i64];
    let path: Vec<_> = match searched.route {
        Route::Found(cells) => cells.into_iter().map(number).collect(),
        Route::StartOccupied | Route::Unreachable => Vec::new(),
    };
    let cols = occupied.cols();
    let expanded = searched.expanded.into_iter().map(|index| index as usize);
    let expanded: Vec<_> = expanded.map(|index| number((index / cols, index % cols))).collect();
    let answer = py.import("wildfire_contest.planners")?.getattr("GridSearch")?;
    answer.call1((rows(py, &path)?, searched.cost.unwrap_or(f64::INFINITY), rows(py, &expanded)?))
}
