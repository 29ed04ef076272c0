//! Drives of the truck planned by any planners: the rows of `wildfire plan`, lower bounds on their lengths, and vehicles that
//! plan together.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use pyo3::exceptions::PyValueError;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use wildfire::batch::drives::{DRIVE_COLUMNS, DriveColumn, DriveProblems, DriveRequest};
use wildfire::batch::together::InstanceAnswer;
use wildfire::collision::MIN_CLEARANCE_M;
use wildfire::input_file;
use wildfire::planning::PlannerName;
use wildfire::planning::certificate::Certificate;
use wildfire::planning::together::files::{MAX_BYTES, read_instance};
use wildfire::planning::together::{Mode, PlanTogether, RepairMethod};
use wildfire::scenario::MemoryLimit;

use crate::arrays::{LARGEST, Poses};
use crate::batch::OneOrMore;
use crate::checker::Checker;
use crate::columns::TableBuilder;
use crate::errors::error;
use crate::literal;
use crate::path::one_pose;
use crate::planner::{Factories, Interruption};

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
    let planners = names.iter().map(|name| PlannerName::new(name)).collect::<Result<Vec<_>, _>>().map_err(error)?;
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
    let answer = py.detach(|| request.plan(&registry));
    if let Some(exception) = interruption.take() {
        return Err(exception);
    }
    let mut table = TableBuilder::new(DRIVE_COLUMNS.iter().map(DriveColumn::described));
    for query in answer.map_err(error)?.rows {
        table.push(DRIVE_COLUMNS.iter().map(|column| (column.value)(&query)));
    }
    table.finish(py)
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
