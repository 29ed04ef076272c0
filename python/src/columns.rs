//! Tables as columns of numpy arrays.
//!
//! Integers are `int64` (or `uint64` if the table requires it), reals `float64`, flags `bool`, text objects of `str`. A
//! missing real is nan, missing text None; a column of integers or flags with missing values is a masked array.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};
use wildfire::batch::plan::Value;
use wildfire::batch::table::{FileColumn, Kind};

/// A column under construction.
struct ColumnBuilder {
    about: FileColumn,
    values: Vec<Value>,
}

/// A table built row by row.
pub struct TableBuilder(Vec<ColumnBuilder>);

impl TableBuilder {
    pub fn new(columns: impl IntoIterator<Item = FileColumn>) -> Self {
        Self(columns.into_iter().map(|about| ColumnBuilder { about, values: Vec::new() }).collect())
    }

    /// Adds a row with a value for each column.
    pub fn push(&mut self, row: impl IntoIterator<Item = Value>) {
        let mut row = row.into_iter();
        for column in &mut self.0 {
            column.values.push(row.next().unwrap_or(Value::Missing));
        }
    }

    /// Builds the Python object `Columns`.
    pub fn finish(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let arrays = PyDict::new(py);
        let units = PyDict::new(py);
        let descriptions = PyDict::new(py);
        for ColumnBuilder { about, values } in self.0 {
            let name = about.name.as_ref();
            arrays.set_item(name, array(py, about.kind, &values)?)?;
            units.set_item(name, about.unit.symbol())?;
            descriptions.set_item(name, about.description.as_ref())?;
        }
        columns_class(py)?.call1((arrays, units, descriptions))
    }
}

fn columns_class(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = CLASS
        .get_or_try_init(py, || PyResult::Ok(py.import("wildfire_contest.columns")?.getattr("Columns")?.unbind()))?;
    Ok(class.bind(py))
}

fn array<'py>(py: Python<'py>, kind: Kind, values: &[Value]) -> PyResult<Bound<'py, PyAny>> {
    let mask = || values.iter().map(|value| *value == Value::Missing).collect::<Vec<_>>();
    match kind {
        // There is no integer for a missing count: as nan it would turn the column into reals, which are exact only up to 2^53.
        Kind::Count => masked(PyArray1::from_iter(py, values.iter().map(signed)).into_any(), mask()),
        Kind::LargeCount => masked(PyArray1::from_iter(py, values.iter().map(unsigned)).into_any(), mask()),
        Kind::Flag => {
            let flags = values.iter().map(|value| matches!(value, Value::Flag(true)));
            masked(PyArray1::from_iter(py, flags).into_any(), mask())
        }
        Kind::Real => Ok(PyArray1::from_iter(py, values.iter().map(real)).into_any()),
        Kind::Text => {
            // It is always of objects: numpy would take text of a fixed width where none is missing, and objects where one is.
            let texts = PyList::new(py, values.iter().map(text))?;
            let array = py.import("numpy")?.call_method1("empty", (values.len(), "O"))?;
            array.set_item(pyo3::types::PySlice::full(py), texts)?;
            Ok(array)
        }
    }
}

/// Masks missing values, if there are any.
fn masked<'py>(array: Bound<'py, PyAny>, mask: Vec<bool>) -> PyResult<Bound<'py, PyAny>> {
    if !mask.contains(&true) {
        return Ok(array);
    }
    let py = array.py();
    let mask = PyArray1::from_vec(py, mask);
    py.import("numpy.ma")?.call_method1("MaskedArray", (array, mask))
}

fn signed(value: &Value) -> i64 {
    i64::try_from(unsigned(value)).unwrap_or(i64::MAX)
}

fn unsigned(value: &Value) -> u64 {
    if let Value::Count(count) = value { *count } else { 0 }
}

/// A swept column may mix integers and reals.
fn real(value: &Value) -> f64 {
    match value {
        Value::Count(count) => *count as f64,
        Value::Real(number) => *number,
        Value::Missing | Value::Text(_) | Value::Flag(_) => f64::NAN,
    }
}

fn text(value: &Value) -> Option<String> {
    (*value != Value::Missing).then(|| value.to_string())
}
