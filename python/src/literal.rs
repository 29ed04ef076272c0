//! Conversion of Python values to values of a scenario.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyMapping, PySequence, PyString};

/// The deepest nesting written; no value of a scenario is nested as deeply.
const MAX_DEPTH: usize = 16;

/// Writes changes in the command line's form: `key=value`, the value as TOML.
pub fn changes(changes: &Bound<'_, PyMapping>) -> PyResult<Vec<String>> {
    let change = |item: Bound<'_, PyAny>| {
        let (key, value) = item.extract::<(String, Bound<'_, PyAny>)>()?;
        if key.contains('=') {
            return Err(PyValueError::new_err(format!("`{key}` is not a key of a scenario: it has a `=`")));
        }
        let written = literal(&value).map_err(|error| named(&key, error, value.py()))?;
        Ok(format!("{key}={written}"))
    };
    changes.items()?.iter().map(change).collect()
}

/// Adds the key of an invalid value to its error.
fn named(key: &str, error: PyErr, py: Python<'_>) -> PyErr {
    PyTypeError::new_err(format!("`{key}`: {}", error.value(py)))
}

/// Writes a value as TOML. Numbers and arrays of numpy are accepted like Python's own; None becomes `none`.
pub fn literal(value: &Bound<'_, PyAny>) -> PyResult<String> {
    nested(value, 0)
}

fn nested(value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    // A list that contains itself would overflow the stack, and that ends Python without an exception.
    if depth > MAX_DEPTH {
        return Err(PyTypeError::new_err("lists and tables are nested too deep for a scenario"));
    }
    if value.is_none() {
        return Ok("\"none\"".to_owned());
    }
    // In Python, True is also an integer, so flags are tested first.
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return number(value.extract()?);
    }
    if value.is_instance_of::<PyString>() {
        return Ok(text(&value.extract::<String>()?));
    }
    if let Ok(table) = value.cast::<PyMapping>() {
        let members = table
            .items()?
            .iter()
            .map(|item| {
                let (key, value) = item.extract::<(String, Bound<'_, PyAny>)>()?;
                Ok(format!("{} = {}", text(&key), nested(&value, depth + 1)?))
            })
            .collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("{{ {} }}", members.join(", ")));
    }
    if let Ok(list) = value.cast::<PySequence>() {
        let entries = list.try_iter()?.map(|entry| nested(&entry?, depth + 1)).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("[{}]", entries.join(", ")));
    }
    if value.hasattr("tolist")? {
        return nested(&value.call_method0("tolist")?, depth + 1);
    }
    if value.hasattr("__fspath__")? {
        return nested(&value.call_method0("__fspath__")?, depth + 1);
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "a {kind} is no value of a scenario; expected numbers, strings, lists or mappings"
    )))
}

/// Writes a real number with the point or exponent that TOML requires.
fn number(number: f64) -> PyResult<String> {
    if number.is_finite() {
        return Ok(format!("{number:?}"));
    }
    Err(PyTypeError::new_err(format!("{number} is no value of a scenario; expected a finite number")))
}

/// Writes a string. JSON strings are TOML strings too, except that JSON does not escape the character 127.
fn text(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}
