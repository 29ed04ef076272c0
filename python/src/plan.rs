//! Drives of the truck planned by any planners: the rows of `wildfire plan`, single paths, their judge, lower bounds on
//! their lengths, and vehicles that plan together.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use wildfire::batch::drives::{DRIVE_COLUMNS, DriveColumn, DriveProblems, DriveRequest};
use wildfire::batch::together::InstanceAnswer;
use wildfire::collision::{CollisionChecker, MIN_CLEARANCE_M};
use wildfire::input_file;
use wildfire::planning::certificate::Certificate;
use wildfire::planning::judge::Judge;
use wildfire::planning::together::files::{MAX_BYTES, read_instance};
use wildfire::planning::together::{Mode, PlanTogether, RepairMethod};
use wildfire::planning::{PlannerName, TruckPlannerKind};
use wildfire::scenario::MemoryLimit;
use wildfire::trajectory::SpeedLimits;

use crate::arrays::{LARGEST, Poses};
use crate::batch::OneOrMore;
use crate::checker::Checker;
use crate::columns::TableBuilder;
use crate::errors::{NoPath, error};
use crate::literal;
use crate::path::{Path, one_pose};
use crate::planner::{Factories, Interruption};
use crate::query::GoalLike;

#[pyfunction]
#[pyo3(signature = (
    field = None, *, planner = None, planners = None, seed = 1, goals = None, cells = None, scenario = None, changes = None
))]
/// Plans drives of the truck with any planners: the rows of ``wildfire plan``.
///
/// Parameters
/// ----------
/// field : path or sequence of paths
///     Field files; default: the scenario's field.
/// planner : str or sequence of str
///     The planners to run.
/// planners : mapping
///     Custom planners, as in `run`.
/// seed : int
///     Determines everything random.
/// goals, cells : int
///     The number of random poses, or of random bushes, to drive to; default: 50 poses.
/// scenario : str or path
///     The scenario whose first truck drives; default: `drives`.
/// changes : mapping
///     Changes to the scenario, as in `scenario`.
///
/// Returns
/// -------
/// Columns
///     A row for each goal and planner.
///
/// Raises
/// ------
/// WildfireError
///     A field or a planner is invalid.
#[expect(clippy::too_many_arguments, reason = "each is a keyword of Python")]
pub fn plan<'py>(
    py: Python<'py>,
    field: Option<OneOrMore<PathBuf>>,
    planner: Option<OneOrMore<String>>,
    planners: Option<&Bound<'py, PyMapping>>,
    seed: u64,
    goals: Option<usize>,
    cells: Option<usize>,
    scenario: Option<PathBuf>,
    changes: Option<&Bound<'py, PyMapping>>,
) -> PyResult<Bound<'py, PyAny>> {
    let factories = Factories::new(planners, None)?;
    let names = planner.map_or_else(Vec::new, OneOrMore::into_vec);
    let checked = |name: &String| PlannerName::new(name).map_err(|bad| error(format_args!("`{name}`: {bad}")));
    let planners = names.iter().map(checked).collect::<PyResult<_>>()?;
    let fields = field.map_or_else(Vec::new, OneOrMore::into_vec);
    let request = DriveRequest {
        scenario: scenario.map_or_else(|| "drives".to_owned(), |path| path.display().to_string()),
        changes: changes.map_or_else(|| Ok(Vec::new()), literal::changes)?,
        problems: DriveProblems { fields, goals, cells },
        planners,
        seed,
        memory: MemoryLimit::default(),
    };
    let interruption: Arc<Interruption> = Arc::default();
    let registry = factories.registry(py, &interruption);
    let answer = interruption.work(py, || request.plan(&registry));
    // The rows of queries that were no longer asked after an exception are worth nothing.
    if let Some(exception) = interruption.take() {
        return Err(exception);
    }
    let mut table = TableBuilder::new(DRIVE_COLUMNS.iter().map(DriveColumn::described));
    for query in answer.map_err(error)?.rows {
        table.push(DRIVE_COLUMNS.iter().map(|column| (column.value)(&query)));
    }
    table.finish(py)
}

/// Finds a path between two poses, or to a disc, on a map.
///
/// Parameters
/// ----------
/// checker : Checker
///     The body and the map.
/// start : array of shape (3,)
/// goal : Disc, Pose or (x, y, heading)
/// planner : {"hybrid-astar", "prm-rs", "prm+primitives", "lattice"}
///     A built-in planner, with its default settings.
/// seed : int
///     Of the roadmaps of the two that are random.
///
/// Returns
/// -------
/// Path
///     It keeps at least 1 cm from obstacles and border.
///
/// Raises
/// ------
/// NoPath
///     None was found, for the reason in ``reason``.
/// ValueError
///     An argument is invalid.
#[pyfunction]
#[pyo3(signature = (checker, start, goal, planner = "hybrid-astar", seed = 1))]
pub fn find_path(
    py: Python<'_>,
    checker: &Checker,
    start: Poses,
    goal: GoalLike,
    planner: &str,
    seed: u64,
) -> PyResult<Path> {
    let kind = TruckPlannerKind::from_str(planner)
        .map_err(|expected| PyValueError::new_err(format!("planner is '{planner}'; {expected}")))?;
    let start = one_pose(start, "start")?;
    let plan = py.detach(|| kind.build(&checker.0, seed).plan(start, goal.0));
    plan.path.map(Path).map_err(|failure| NoPath::new_err(failure.to_string().replace(' ', "-")))
}

/// Judges a path as the contest judges those of custom planners, and computes its figures.
///
/// Parameters
/// ----------
/// checker : Checker
///     The body and the map.
/// path : Path
/// goal : Disc, Pose or (x, y, heading)
///
/// Returns
/// -------
/// dict
///     ``violation``: the first rule that the path breaks, with the place, or None. Of a path without violation also
///     ``length_m``, ``lower_bound_ratio`` (over a lower bound on the length of all paths; None if that is 0),
///     ``min_clearance_m`` (of poses every 2 cm; a lower bound above 1 m) and ``cusps``.
#[pyfunction]
#[pyo3(signature = (checker, path, goal))]
pub fn judge<'py>(py: Python<'py>, checker: &Checker, path: &Path, goal: GoalLike) -> PyResult<Bound<'py, PyDict>> {
    let path = &path.0;
    let judge = Judge::new(CollisionChecker::clone(&checker.0));
    // Speeds are only needed for the time of a drive, which is not among the members.
    let limits = SpeedLimits::new(1.0, 1.0);
    let judged =
        py.detach(|| judge.check(path.start, goal.0, path).map(|()| judge.figures(path.start, goal.0, path, limits)));
    let answer = PyDict::new(py);
    answer.set_item("violation", judged.as_ref().err().map(ToString::to_string))?;
    if let Ok(figures) = judged {
        answer.set_item("length_m", figures.length_m)?;
        answer.set_item("lower_bound_ratio", figures.printed_ratio())?;
        answer.set_item("min_clearance_m", figures.min_clearance_m)?;
        answer.set_item("cusps", figures.cusps)?;
    }
    Ok(answer)
}

/// Computes a lower bound on the length of every path from the start to the goal that keeps 1 cm from the bushes.
///
/// Parameters
/// ----------
/// checker : Checker
/// start, goal : array of shape (3,)
/// length : float
///     The length of a valid path, in metres: no bound beyond it is of interest.
///
/// Returns
/// -------
/// float
///     Metres, at most ``length`` if that is the length of a path.
#[pyfunction]
#[pyo3(signature = (checker, start, goal, length))]
pub fn certify(py: Python<'_>, checker: &Checker, start: Poses, goal: Poses, length: f64) -> PyResult<f64> {
    let start = one_pose(start, "start")?;
    let goal = one_pose(goal, "goal")?;
    if !(0.0..=LARGEST).contains(&length) {
        return Err(PyValueError::new_err(format!("length is {length}; expected metres from 0")));
    }
    let certificate = py.detach(|| Certificate::new(&checker.0, start, goal, MIN_CLEARANCE_M, length));
    // Equal poses have none.
    Ok(certificate.map_or(0.0, |certificate| certificate.bound_m.max(0.0)))
}

/// Plans paths of many vehicles at once on an instance of the CL-MAPF benchmark: a row of ``wildfire plan --together``.
///
/// Parameters
/// ----------
/// instance : path
///     A YAML file.
/// mode : {"exact", "benchmark"}
///     Rules of what touches what.
/// method : {"repair", "prioritised"}
///     What to do about conflicts that planning one vehicle after the other leaves.
/// seed : int
/// polish : int
///     The number of attempts for each vehicle to make paths shorter, up to 1000.
/// limit_s : float
///     CPU seconds.
///
/// Returns
/// -------
/// dict
///     The members of a row of ``--json``, and ``solution``: the text of the solution's file, or None.
///
/// Raises
/// ------
/// WildfireError
///     The instance is invalid.
#[pyfunction]
#[pyo3(signature = (instance, *, mode = "exact", method = "repair", seed = 1, polish = 0, limit_s = 20.0))]
pub fn plan_together<'py>(
    py: Python<'py>,
    instance: PathBuf,
    mode: &str,
    method: &str,
    seed: u64,
    polish: u32,
    limit_s: f64,
) -> PyResult<Bound<'py, PyAny>> {
    if !(0.001..=1e6).contains(&limit_s) {
        return Err(PyValueError::new_err(format!("limit_s is {limit_s}; expected 0.001 to 1e6 seconds")));
    }
    if polish > 1000 {
        return Err(PyValueError::new_err(format!("polish is {polish}; expected 0 to 1000")));
    }
    let settings = PlanTogether {
        mode: named("mode", mode, Mode::ALL.map(|it| (it.name(), it)))?,
        method: named("method", method, RepairMethod::ALL.map(|it| (it.name(), it)))?,
        seed,
        polish,
        ..PlanTogether::default()
    };
    let at_path = |fault: &dyn std::fmt::Display| error(format_args!("{}: {fault}", instance.display()));
    let text = input_file::read_text(&instance, MAX_BYTES).map_err(|fault| at_path(&fault))?;
    let read = read_instance(&text).map_err(|fault| at_path(&fault))?;
    let answer = py.detach(|| InstanceAnswer::new(&instance, &read, &settings, Duration::from_secs_f64(limit_s)));
    let row = serde_json::to_string(&answer.row).map_err(error)?;
    let row = py.import("json")?.call_method1("loads", (row,))?;
    row.set_item("solution", answer.solution)?;
    Ok(row)
}

/// Returns the value of this name.
fn named<T: Copy, const N: usize>(what: &str, name: &str, values: [(&str, T); N]) -> PyResult<T> {
    let found = values.iter().find(|(valid, _)| *valid == name);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let valid = values.map(|(valid, _)| format!("'{valid}'")).join(" or ");
        PyValueError::new_err(format!("{what} is '{name}'; expected {valid}"))
    })
}
