//! Errors of the library as Python exceptions, with the messages of the command line.

use pyo3::import_exception;
use pyo3::prelude::*;
use wildfire::scenario;

import_exception!(wildfire_contest.errors, NoPath);
import_exception!(wildfire_contest.errors, QueryTimedOut);
import_exception!(wildfire_contest.errors, ScenarioError);
import_exception!(wildfire_contest.errors, WildfireError);

/// Makes an error with a message of the library.
pub fn error(sentence: impl ToString) -> PyErr {
    WildfireError::new_err(sentence.to_string())
}

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
