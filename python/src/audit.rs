//! The independent check of runs, recordings and batches against the rules.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::batch::execute::RECORDINGS_FOLDER;
use wildfire::batch::report::{AuditOptions, AuditSource, ListedViolation, audit_all};
use wildfire::batch::table::{FinishedBatch, recordings_in};

use crate::batch::{Batch, OneOrMore, threads};
use crate::errors::{error, one_of};
use crate::planner::{Factories, Interruption};
use crate::run::Run;

/// A run that violates a rule, or whose stored row differs from its result.
///
/// Attributes
/// ----------
/// run : str
///     The run, or the file of its recording.
/// text : str
///     The violation, with its place and time.
/// time_s, agent, place : float, str, (float, float)
///     The time in seconds, the agent, and the place in metres of the first violation; None if only the row is wrong.
#[pyclass(frozen, get_all, module = "wildfire_contest")]
pub struct Violation {
    /// The run, or the file of its recording.
    run: String,
    /// The violation, with its place and time.
    text: String,
    /// The simulated time in seconds.
    time_s: Option<f64>,
    /// The agent.
    agent: Option<String>,
    /// The place, metres east and north.
    place: Option<(f64, f64)>,
}

impl Violation {
    fn new(run: String, text: String, violation: Option<wildfire::audit::Violation>) -> Self {
        Self {
            run,
            text,
            time_s: violation.map(|violation| violation.time.as_seconds()),
            agent: violation.and_then(|violation| violation.agent).map(|agent| agent.to_string()),
            place: violation.map(|violation| (violation.place.x, violation.place.y)),
        }
    }
}

#[pymethods]
impl Violation {
    fn __repr__(&self) -> String {
        format!("<Violation {}: {}>", self.run, self.text)
    }
}

/// Anything that can be audited.
pub enum Auditable<'py> {
    Run(Bound<'py, Run>),
    Batch(Bound<'py, Batch>),
    Path(PathBuf),
}

one_of!(Auditable<'py>, "a Run, a Batch, or a path", Self::Run, Self::Batch, Self::Path);

/// Checks finished runs against the rules, with code that shares nothing with the planners.
///
/// Parameters
/// ----------
/// what : Run, Batch or path, or several of them
///     A path to a recording, to a folder of recordings, or to the folder of a batch. Runs of a batch without a recording
///     are simulated again.
/// planners, policies : mapping
///     The custom planners and policies of such runs, under the same names.
/// jobs : int
///     Threads; -1 for one per core.
///
/// Returns
/// -------
/// list of Violation
///     The first violation of each run that has one.
///
/// Raises
/// ------
/// WildfireError
///     A file cannot be read.
#[pyfunction]
#[pyo3(signature = (what, *, planners = None, policies = None, jobs = 1))]
pub fn audit(
    py: Python<'_>,
    what: OneOrMore<Auditable<'_>>,
    planners: Option<&Bound<'_, PyMapping>>,
    policies: Option<&Bound<'_, PyMapping>>,
    jobs: isize,
) -> PyResult<Vec<Violation>> {
    let jobs = threads(jobs)?;
    let factories = Factories::new(planners, policies)?;
    let mut violations = Vec::new();
    for audited in what.into_vec() {
        match audited {
            Auditable::Run(run) => {
                let (run, timeline) = (run.get(), &run.get().timeline);
                let verdict = py.detach(|| audit_timeline(timeline, SampleStep::default()));
                violations.extend(
                    verdict
                        .violation
                        .map(|violation| Violation::new(run.name(), violation.to_string(), Some(violation))),
                );
            }
            Auditable::Batch(batch) => {
                let source = source(batch.get().path().to_owned())?;
                violations.extend(audit_source(py, &source, &factories, jobs)?);
            }
            Auditable::Path(path) => violations.extend(audit_source(py, &source(path)?, &factories, jobs)?),
        }
    }
    Ok(violations)
}

/// Determines what a path holds: a recording, a folder of recordings, or a batch.
fn source(path: PathBuf) -> PyResult<AuditSource> {
    if !path.is_dir() {
        return Ok(AuditSource::Recordings(vec![path]));
    }
    if FinishedBatch::is_there(&path) {
        return Ok(AuditSource::Batch(Box::new(FinishedBatch::open(&path).map_err(error)?)));
    }
    let recordings = recordings_in(&path).map_err(error)?;
    if recordings.is_empty() {
        let place = path.display();
        return Err(error(format_args!("{place} holds no recordings, no {RECORDINGS_FOLDER} and no plan of a batch")));
    }
    Ok(AuditSource::Recordings(recordings))
}

fn audit_source(py: Python<'_>, source: &AuditSource, factories: &Factories, jobs: usize) -> PyResult<Vec<Violation>> {
    let interruption: Arc<Interruption> = Arc::default();
    let registry = factories.registry(py, &interruption);
    if let AuditSource::Batch(batch) = source {
        batch.expect_registry(&registry).map_err(error)?;
    }
    let options = AuditOptions { jobs, step: SampleStep::default(), registry: &registry, listed: usize::MAX };
    let report = interruption.work_aside(py, || audit_all(std::slice::from_ref(source), &options, || {}))?;
    // Once everything is stopping, planners are no longer asked, and the report says nothing of value about their runs.
    if let Some(exception) = interruption.take() {
        return Err(exception);
    }
    let report = report.map_err(error)?;
    if let Some((reason, _)) = report.first_unreadable {
        return Err(error(reason));
    }
    Ok(report
        .listed
        .into_iter()
        .map(|ListedViolation { run, violation, message }| Violation::new(run, message, violation))
        .collect())
}
