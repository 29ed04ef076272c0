//! Scenarios: built-in ones, files, and changes to them.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::scenario::{self as library, Fault, LoadedScenario, ScenarioError, ScenarioText, Terrain};

use crate::checker::Checker;
use crate::errors::{error, one_of, scenario_error};
use crate::literal;
use crate::planner::Factories;

/// A complete, validated scenario. It is immutable.
///
/// Created by `scenario`, `Scenario.from_toml` and `Scenario.with_`.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Scenario {
    text: ScenarioText,
    /// The requested changes.
    changes: Vec<String>,
    /// Names of planners and policies that are not known yet, each with the error if a run does not supply it.
    missing: Vec<Missing>,
    loaded: LoadedScenario,
}

/// A planner or a policy that is neither built in nor has a table.
struct Missing {
    /// Its kind as named in scenarios.
    kind: &'static str,
    name: String,
    refusal: Box<ScenarioError>,
}

impl Scenario {
    /// Loads a scenario. Unknown planners and policies may be supplied when it is run; until then each has an empty table.
    fn load(text: ScenarioText, changes: Vec<String>) -> PyResult<Self> {
        let mut missing: Vec<Missing> = Vec::new();
        // The reader stops at the first unknown name, so each of them takes a pass.
        loop {
            let tables = missing.iter().map(|missing| table_of(missing.kind, &missing.name));
            let all: Vec<_> = changes.iter().cloned().chain(tables).collect();
            match LoadedScenario::from_text(&text, &all) {
                Ok(loaded) => return Ok(Self { text, changes, missing, loaded }),
                Err(refusal) => match unknown_name(&refusal.fault) {
                    Some((kind, name))
                        if missing.iter().all(|missing| (missing.kind, missing.name.as_str()) != (kind, name)) =>
                    {
                        missing.push(Missing { kind, name: name.to_owned(), refusal });
                    }
                    _ => return Err(scenario_error(&refusal)),
                },
            }
        }
    }

    pub fn library(&self) -> &library::Scenario {
        &self.loaded.scenario
    }

    /// Returns the scenario's text, and the changes to it that yield the scenario.
    pub fn parts(&self) -> (&ScenarioText, Vec<String>) {
        let tables = self.missing.iter().map(|missing| table_of(missing.kind, &missing.name));
        (&self.text, self.changes.iter().cloned().chain(tables).collect())
    }

    /// Rejects a scenario with a planner or a policy that was not supplied.
    pub fn expect_registered(&self, factories: &Factories) -> PyResult<()> {
        let missing = self.missing.iter().find(|missing| !factories.knows(missing.kind, &missing.name));
        missing.map_or(Ok(()), |missing| Err(scenario_error(&missing.refusal)))
    }
}

/// The change that gives a planner or a policy an empty table.
pub fn table_of(kind: &str, name: &str) -> String {
    format!("{kind}.\"{name}\".command=[]")
}

/// Returns the kind and name of an unknown planner or policy, if that is the fault.
fn unknown_name(fault: &Fault) -> Option<(&'static str, &str)> {
    match fault {
        Fault::UnknownName { kind, found, .. } => Some((kind, found)),
        _ => None,
    }
}

#[pymethods]
impl Scenario {
    /// Reads a scenario from the text of a file.
    ///
    /// Raises
    /// ------
    /// ScenarioError
    ///     The scenario is invalid; the file is named ``<text>``.
    #[staticmethod]
    #[pyo3(signature = (text, /))]
    fn from_toml(text: String) -> PyResult<Self> {
        let source = ScenarioText::from_bytes("<text>", Ok(text.into_bytes()));
        Self::load(source.map_err(|refusal| scenario_error(&refusal))?, Vec::new())
    }

    /// Returns its name in tables.
    #[getter]
    fn name(&self) -> &str {
        &self.library().name
    }

    /// Returns the longest duration of a run in simulated seconds.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.library().duration_s
    }

    /// Writes all values, defaults included, as the text of a scenario file.
    fn to_toml(&self) -> PyResult<String> {
        toml::to_string(self.library()).map_err(error)
    }

    /// Returns the scenario with further changes; see `scenario`.
    #[pyo3(signature = (changes, /))]
    fn with_(&self, changes: &Bound<'_, PyMapping>) -> PyResult<Self> {
        let changes = self.changes.iter().cloned().chain(literal::changes(changes)?).collect();
        Self::load(self.text.clone(), changes)
    }

    /// Returns the collision checker of a truck on the field of a seed, without a run.
    ///
    /// Raises
    /// ------
    /// WildfireError
    ///     There is no such truck, or the field cannot be generated.
    #[pyo3(signature = (seed = 1, truck = 0))]
    fn checker(&self, py: Python<'_>, seed: u64, truck: usize) -> PyResult<Checker> {
        let scenario = self.library();
        let trucks = scenario.unimog.len();
        let Some(unimog) = scenario.unimog.get(truck) else {
            return Err(error(format_args!("there is no truck {truck}: the scenario has {trucks}, numbered from 0")));
        };
        let terrain = py.detach(|| Terrain::from_scenario(scenario, seed)).map_err(error)?;
        let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        Ok(Checker::new(CollisionChecker::new(field, unimog.vehicle)))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, (String, String, Vec<String>)>> {
        let Self { text, changes, .. } = self;
        Ok((restorer(py, "_restored_scenario")?, (text.source.clone(), text.text.clone(), changes.clone())))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.library() == other.get().library())
    }

    fn __repr__(&self) -> String {
        let changes: String = self.changes.iter().map(|change| format!(", {change}")).collect();
        format!("<Scenario {}{changes}>", self.library().name)
    }
}

/// The form that pickle expects: a function, and the arguments that restore the object.
pub type Pickled<'py, T> = (Bound<'py, PyAny>, T);

/// Returns the function that restores a pickled object.
pub fn restorer<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("wildfire_contest._core")?.getattr(name)
}

/// Restores a pickled scenario. Relative paths keep their base.
#[pyfunction]
#[pyo3(name = "_restored_scenario")]
pub fn restored_scenario(source: &str, text: String, changes: Vec<String>) -> PyResult<Scenario> {
    let text = ScenarioText::from_bytes(source, Ok(text.into_bytes()));
    Scenario::load(text.map_err(|refusal| scenario_error(&refusal))?, changes)
}

/// A scenario, or its name or path.
pub enum ScenarioLike<'py> {
    Loaded(Bound<'py, Scenario>),
    Named(PathBuf),
}

one_of!(ScenarioLike<'py>, "a Scenario, or the name or the path of one", Self::Loaded, Self::Named);

impl ScenarioLike<'_> {
    /// Returns the scenario `contest` if none is given.
    pub fn or_contest(scenario: Option<Self>) -> Self {
        scenario.unwrap_or_else(|| Self::Named("contest".into()))
    }

    /// Returns the scenario with the changes applied, loading it if necessary.
    pub fn load(&self, py: Python<'_>, changes: Vec<String>) -> PyResult<Py<Scenario>> {
        match self {
            Self::Loaded(scenario) if changes.is_empty() => Ok(scenario.clone().unbind()),
            Self::Loaded(scenario) => {
                let scenario = scenario.get();
                let changes = scenario.changes.iter().cloned().chain(changes).collect();
                Py::new(py, Scenario::load(scenario.text.clone(), changes)?)
            }
            Self::Named(path) => {
                let text = ScenarioText::open(&path.to_string_lossy()).map_err(|refusal| scenario_error(&refusal))?;
                Py::new(py, Scenario::load(text, changes)?)
            }
        }
    }
}

/// Loads a scenario: a built-in one by name, or a file by path.
///
/// Parameters
/// ----------
/// source : str, path or Scenario
///     Default: `contest`.
/// changes : mapping
///     Values by keys such as ``"fire.burn_out_s"``, ``"unimog.prm_rs.samples"`` (all trucks) or ``"unimog.0.speed_mps"``
///     (the first); None becomes `none`. It may name a custom planner, which is then passed to the run.
///
/// Raises
/// ------
/// ScenarioError
///     The scenario is invalid; with file, line and column.
#[pyfunction]
#[pyo3(signature = (source = None, changes = None))]
pub fn scenario(
    py: Python<'_>,
    source: Option<ScenarioLike<'_>>,
    changes: Option<&Bound<'_, PyMapping>>,
) -> PyResult<Py<Scenario>> {
    let changes = changes.map_or(Ok(Vec::new()), literal::changes)?;
    ScenarioLike::or_contest(source).load(py, changes)
}
