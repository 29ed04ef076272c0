//! Drives of the truck by any planners: the rows of `wildfire plan`.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use serde_json::Value as Json;
use wildfire::batch::{FileColumn, Kind, Unit, Value};
use wildfire::cli;

use crate::batch::OneOrMore;
use crate::columns::TableBuilder;
use crate::errors::error;
use crate::literal;
use crate::planner::{Factories, Interruption};

/// The columns of `wildfire plan --csv`, and what is wrong with a path.
const COLUMNS: [(&str, Kind, Unit, &str); 14] = [
    ("field", Kind::Text, Unit::None, "name of the field"),
    ("goal", Kind::Count, Unit::None, "number of the goal, from 0"),
    ("planner", Kind::Text, Unit::None, "who was asked"),
    ("success", Kind::Flag, Unit::None, "whether there is a path"),
    ("reason", Kind::Text, Unit::None, "why there is no path"),
    ("cpu_build_s", Kind::Real, Unit::Seconds, "CPU time: clearance field and preparation"),
    ("cpu_query_s", Kind::Real, Unit::Seconds, "CPU time: the query"),
    ("length_m", Kind::Real, Unit::Metres, "length of the way"),
    ("lower_bound_ratio", Kind::Real, Unit::None, "length over what no path can be shorter than"),
    ("min_clearance_m", Kind::Real, Unit::Metres, "least distance to a bush or the border"),
    ("cusps", Kind::Count, Unit::None, "changes between forward and reverse"),
    ("drive_s", Kind::Real, Unit::Seconds, "time of the drive"),
    ("expansions", Kind::Count, Unit::None, "nodes expanded"),
    ("violation", Kind::Text, Unit::None, "what the second opinion finds wrong with the path"),
];

#[pyfunction]
#[pyo3(signature = (
    field = None, *, planner = None, planners = None, seed = 1, goals = None, cells = None, scenario = None, changes = None
))]
/// Plans drives of the truck by any planners: the rows of ``wildfire plan``.
///
/// Parameters
/// ----------
/// field : path or sequence of paths
///     Field files; the scenario's field if it is left out.
/// planner : str or sequence of str
///     Who is asked.
/// planners : mapping
///     Planners of one's own, as in `run`.
/// seed : int
///     Everything random follows from it.
/// goals, cells : int
///     The number of random poses, or of random bushes, to drive to; 50 poses if both are left out.
/// scenario : str or path
///     Whose first truck drives; `drives` if it is left out.
/// changes : mapping
///     Changes of the scenario, as in `scenario`.
///
/// Returns
/// -------
/// Columns
///     A row for each goal and planner.
///
/// Raises
/// ------
/// WildfireError
///     A field or a planner is refused.
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
    let mut words = vec![format!("--seed={seed}")];
    let changes = changes.map_or_else(|| Ok(Vec::new()), literal::changes)?;
    words.extend(changes.into_iter().map(|change| format!("--set={change}")));
    words
        .extend(planner.map_or_else(Vec::new, OneOrMore::into_vec).into_iter().map(|name| format!("--planner={name}")));
    words.extend(goals.map(|count| format!("--goals={count}")));
    words.extend(cells.map(|count| format!("--cells={count}")));
    words.extend(scenario.map(|path| format!("--scenario={}", path.display())));
    words.push("--".to_owned());
    words.extend(field.map_or_else(Vec::new, OneOrMore::into_vec).into_iter().map(|path| path.display().to_string()));
    let interruption: Arc<Interruption> = Arc::default();
    let entrants = factories.entrants(py, &interruption);
    let answer = py.detach(|| cli::plan_object(&words, entrants));
    if let Some(exception) = interruption.take() {
        return Err(exception);
    }
    let object: Json = serde_json::from_str(&answer.map_err(error)?).map_err(error)?;
    let column = |(name, kind, unit, words)| FileColumn {
        name: Cow::Borrowed(name),
        words: Cow::Borrowed(words),
        unit,
        kind,
        is_required: false,
    };
    let mut table = TableBuilder::new(COLUMNS.map(column));
    for row in object["rows"].as_array().into_iter().flatten() {
        let is_its = |offence: &&Json| ["field", "goal", "planner"].iter().all(|&name| offence[name] == row[name]);
        let violation = object["offences"].as_array().and_then(|offences| offences.iter().find(is_its));
        let violation = violation.map_or(&Json::Null, |offence| &offence["offence"]);
        let named = |name: &str| if name == "violation" { violation } else { &row[name] };
        table.push(COLUMNS.map(|(name, kind, ..)| value(named(name), kind)));
    }
    table.finish(py)
}

fn value(json: &Json, kind: Kind) -> Value {
    match (json, kind) {
        (Json::Bool(flag), _) => Value::Flag(*flag),
        (Json::String(text), _) => Value::Text(text.clone()),
        (Json::Number(number), Kind::Count | Kind::LargeCount) => number.as_u64().into(),
        (Json::Number(number), _) => number.as_f64().into(),
        _ => Value::Missing,
    }
}
