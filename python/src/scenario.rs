//! Scenarios: built-in ones, files, and changes of them.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use wildfire::scenario::{self as library, LoadedScenario, ScenarioText};

use crate::errors::{error, scenario_error};
use crate::literal;

/// A scenario that is complete and checked. It never changes.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Scenario {
    text: ScenarioText,
    changes: Vec<String>,
    loaded: Arc<LoadedScenario>,
}

impl Scenario {
    fn load(text: ScenarioText, changes: Vec<String>) -> PyResult<Self> {
        let loaded = LoadedScenario::from_text(&text, &changes).map_err(|refusal| scenario_error(&refusal))?;
        Ok(Self { text, changes, loaded: Arc::new(loaded) })
    }

    pub fn library(&self) -> &library::Scenario {
        &self.loaded.scenario
    }
}

#[pymethods]
impl Scenario {
    #[staticmethod]
    #[pyo3(signature = (text, /))]
    fn from_toml(text: String) -> PyResult<Self> {
        let source = ScenarioText::from_bytes("scenario.toml", Ok(text.into_bytes()));
        Self::load(source.map_err(|refusal| scenario_error(&refusal))?, Vec::new())
    }

    #[getter]
    fn name(&self) -> &str {
        &self.library().name
    }

    #[getter]
    fn duration_s(&self) -> f64 {
        self.library().duration_s
    }

    fn to_toml(&self) -> PyResult<String> {
        toml::to_string(self.library()).map_err(error)
    }

    #[pyo3(signature = (changes, /))]
    fn with_(&self, changes: &Bound<'_, PyMapping>) -> PyResult<Self> {
        let changes = self.changes.iter().cloned().chain(literal::changes(changes)?).collect();
        Self::load(self.text.clone(), changes)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.library() == other.get().library())
    }

    fn __repr__(&self) -> String {
        let changes: String = self.changes.iter().map(|change| format!(", {change}")).collect();
        format!("<Scenario {}{changes}>", self.library().name)
    }
}

/// Whatever names a scenario: itself, the name of a built-in one, or a path.
#[derive(FromPyObject)]
pub enum ScenarioLike<'py> {
    Loaded(Bound<'py, Scenario>),
    Named(PathBuf),
}

impl ScenarioLike<'_> {
    /// Returns the scenario, loaded if need be, and with changes if there are some.
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

#[pyfunction]
#[pyo3(signature = (source = None, changes = None))]
pub fn scenario(
    py: Python<'_>,
    source: Option<ScenarioLike<'_>>,
    changes: Option<&Bound<'_, PyMapping>>,
) -> PyResult<Py<Scenario>> {
    let changes = changes.map_or(Ok(Vec::new()), literal::changes)?;
    source.unwrap_or_else(|| ScenarioLike::Named("contest".into())).load(py, changes)
}
