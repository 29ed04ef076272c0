//! Errors of the library as Python exceptions, with the messages of the command line.

use pyo3::exceptions::PyTypeError;
use pyo3::import_exception;
use pyo3::prelude::*;
use wildfire::scenario;

use crate::arrays::described;

import_exception!(wildfire_contest.errors, NoPath);
import_exception!(wildfire_contest.errors, QueryTimedOut);
import_exception!(wildfire_contest.errors, ScenarioError);
import_exception!(wildfire_contest.errors, WildfireError);

/// Makes an error with a message of the library.
pub fn error(sentence: impl ToString) -> PyErr {
    WildfireError::new_err(sentence.to_string())
}

/// Makes the error of an argument that is of none of the expected types.
pub fn unexpected(object: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    PyTypeError::new_err(format!("found {}; expected {expected}", described(object)))
}

/// Reads an argument as the first of several types that it has. PyO3's own derive reports each attempt in a line.
macro_rules! one_of {
    ($One:ty, $expected:literal, $($variant:expr),+) => {
        impl<'py> FromPyObject<'_, 'py> for $One {
            type Error = PyErr;

            fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
                $(if let Ok(read) = object.extract() {
                    return Ok($variant(read));
                })+
                Err(crate::errors::unexpected(&object, $expected))
            }
        }
    };
}
pub(crate) use one_of;

/// Makes the error of an invalid scenario, with its location and the command line's advice.
pub fn scenario_error(refusal: &scenario::ScenarioError) -> PyErr {
    let advice = refusal.fault.advice();
    let location = refusal.location.as_ref();
    let place = location.map(ToString::to_string);
    let sentence = match &place {
        Some(place) => format!("{place}: {refusal}"),
        None => refusal.to_string(),
    };
    let sentence = advice.map_or(sentence.clone(), |advice| format!("{sentence} ({advice})"));
    let (line, column) = location.map(scenario::SourceLocation::line_and_column).unzip();
    // A location is written FILE:LINE:COLUMN, and the file's name may contain colons.
    let file = place.map(|place| place.rsplitn(3, ':').nth(2).unwrap_or_default().to_owned());
    ScenarioError::new_err((sentence, file, line, column))
}
