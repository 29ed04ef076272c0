//! Drives of the truck planned by any planners: the rows of `wildfire plan`.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use wildfire::batch::drives::{DRIVE_COLUMNS, DriveColumn, DriveProblems, DriveRequest};
use wildfire::planning::PlannerName;
use wildfire::scenario::MemoryLimit;

use crate::batch::OneOrMore;
use crate::columns::TableBuilder;
use crate::errors::error;
use crate::literal;
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
