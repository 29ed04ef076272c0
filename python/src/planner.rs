//! Planners of Python in a run: a factory of Python is a maker, what it makes a planner.
//!
//! Whatever Python does is an answer. An exception is a failed query, and so is an object that is no path; an exception
//! that is meant to end the program, such as `KeyboardInterrupt`, ends the run or the batch. A truck is only ever driven
//! by paths that the gate has let pass.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{AllowTypeChange, PyArrayLike2};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use rand::Rng;
use wildfire::collision::CollisionChecker;
use wildfire::geometry::Pose;
use wildfire::planning::judge::MOST_SEGMENTS;
use wildfire::planning::{self, Goal, MakeError, NameError, Plan, PlanFailure, Planners, TruckPlanner};
use wildfire::sim::Entrants;
use wildfire::vehicle::{Path, Segment};

use crate::arrays::{described, is_sane_pose, pose};
use crate::checker::Checker;
use crate::errors::{NoPath, error};
use crate::path;
use crate::policy::GivenPolicies;
use crate::query::{Query, Site};

/// Bits of a seed: all whole numbers below 2^53 are also floats.
pub const SEED_BITS: u32 = 53;

/// The wish to end, raised inside of a callback: nothing of Python is asked any more.
#[derive(Default)]
pub struct Interruption {
    stop: Arc<AtomicBool>,
    exception: Mutex<Option<PyErr>>,
}

impl Interruption {
    /// Returns the flag that says that everybody should stop.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    pub fn is_set(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Asks everybody to stop because of this exception. The first one is kept.
    pub fn set(&self, exception: PyErr) {
        self.exception.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(exception);
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Takes the exception that asked for a stop, if one did.
    pub fn take(&self) -> Option<PyErr> {
        self.exception.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// What was handed in, by name: factories of planners, and policies.
pub struct Factories {
    planners: Vec<(String, Py<PyAny>)>,
    policies: GivenPolicies,
}

impl Factories {
    /// Takes Python's mappings of names to factories and to policies.
    ///
    /// # Errors
    /// If a planner or a policy cannot have its name, or is none.
    pub fn new(given: Option<&Bound<'_, PyMapping>>, policies: Option<&Bound<'_, PyMapping>>) -> PyResult<Self> {
        let mut factories = Vec::new();
        for item in given.map(PyMappingMethods::items).transpose()?.iter().flatten() {
            let (name, factory) = item.extract::<(String, Bound<'_, PyAny>)>()?;
            if !factory.is_callable() {
                let kind = factory.get_type().name()?;
                let sentence =
                    format!("the planner `{name}` is a {kind}; expected what makes one from a Site, such as a class");
                return Err(pyo3::exceptions::PyTypeError::new_err(sentence));
            }
            factories.push((name, factory.unbind()));
        }
        let factories = Self { planners: factories, policies: GivenPolicies::new(policies)? };
        // Names are checked now, before anything runs.
        Python::attach(|py| {
            factories.planners(py, &Arc::default()).map_err(error)?;
            factories.policies.policies(py, &Arc::default()).map_err(error)
        })?;
        Ok(factories)
    }

    /// Says whether a planner or a policy, as `kind` says, of this name was handed in.
    pub fn knows(&self, kind: &str, name: &str) -> bool {
        match kind {
            "planner" => self.planners.iter().any(|(known, _)| known == name),
            _ => self.policies.knows(name),
        }
    }

    /// Returns what was handed in, for one run.
    pub fn entrants(&self, py: Python<'_>, interruption: &Arc<Interruption>) -> Entrants {
        let planners = self.planners(py, interruption).expect("the names were checked before");
        let policies = self.policies.policies(py, interruption).expect("the names were checked before");
        Entrants { planners, policies, ..Entrants::default() }
    }

    fn planners(&self, py: Python<'_>, interruption: &Arc<Interruption>) -> Result<Planners, NameError> {
        let has_printed = Arc::new(AtomicBool::new(false));
        self.planners.iter().try_fold(Planners::default(), |planners, (name, factory)| {
            let maker = Maker {
                name: name.clone(),
                factory: factory.clone_ref(py),
                interruption: Arc::clone(interruption),
                has_printed: Arc::clone(&has_printed),
            };
            planners.with(name, move |site: &planning::Site<'_>| maker.make(site))
        })
    }
}

/// Makes planners of one name in one run.
struct Maker {
    name: String,
    factory: Py<PyAny>,
    interruption: Arc<Interruption>,
    /// True if an exception of this run was printed whole.
    has_printed: Arc<AtomicBool>,
}

impl Maker {
    fn make(&self, site: &planning::Site<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> {
        let made = Python::try_attach(|py| {
            self.call(py, site).map_err(|exception| {
                let words = words(py, &exception);
                self.settle(py, exception);
                MakeError::new(words)
            })
        });
        made.unwrap_or_else(|| Err(MakeError::new("Python has ended")))
    }

    fn call(&self, py: Python<'_>, site: &planning::Site<'_>) -> PyResult<Box<dyn TruckPlanner>> {
        let checker = Py::new(py, Checker::new(CollisionChecker::clone(site.checker)))?;
        let settings = if site.own.is_null() {
            PyDict::new(py).into_any()
        } else {
            py.import("json")?.call_method1("loads", (site.own.to_string(),))?
        };
        let seed = (site.stream)(&self.name).next_u64() >> (u64::BITS - SEED_BITS);
        let told = Py::new(py, Site::new(site, seed, settings.unbind(), checker.clone_ref(py)))?;
        let planner = self.factory.bind(py).call1((told,))?;
        let plan = planner.getattr("plan").map_err(|_| {
            let kind = planner.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
            error(format_args!("it made a {kind}, which has no method `plan`"))
        })?;
        Ok(Box::new(PythonPlanner {
            plan: plan.unbind(),
            checker,
            interruption: Arc::clone(&self.interruption),
            has_printed: Arc::clone(&self.has_printed),
        }))
    }

    fn settle(&self, py: Python<'_>, exception: PyErr) {
        settle(py, exception, &self.interruption, &self.has_printed);
    }
}

/// A planner that Python made.
struct PythonPlanner {
    /// Its bound method.
    plan: Py<PyAny>,
    checker: Py<Checker>,
    interruption: Arc<Interruption>,
    has_printed: Arc<AtomicBool>,
}

impl TruckPlanner for PythonPlanner {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        if self.interruption.is_set() {
            return Plan::failed(PlanFailure::Crashed, "it was not asked, as all was to stop");
        }
        let plan = Python::try_attach(|py| self.ask(py, start, goal));
        plan.unwrap_or_else(|| Plan::failed(PlanFailure::Crashed, "Python has ended"))
    }
}

impl PythonPlanner {
    fn ask(&self, py: Python<'_>, start: Pose, goal: Goal) -> Plan {
        let query = Query { start, goal, checker: self.checker.clone_ref(py) };
        let answer = self.plan.bind(py).call1((query,));
        match answer.map_err(Refusal::Exception).and_then(|answer| self.path(start, &answer)) {
            Ok(path) => Plan::from(path),
            Err(Refusal::Words(words)) => Plan::failed(PlanFailure::BadAnswer, words),
            Err(Refusal::Exception(exception)) => self.failure(py, exception),
        }
    }

    /// Reads an answer.
    fn path(&self, start: Pose, answer: &Bound<'_, PyAny>) -> Result<Result<Path, PlanFailure>, Refusal> {
        if answer.is_none() {
            return Ok(Err(PlanFailure::Disconnected));
        }
        if let Ok(path) = answer.cast::<path::Path>() {
            return Ok(Ok(path.get().0.clone()));
        }
        let refuse = |found: String| Refusal::Words(format!("{found}; expected {EXPECTED}"));
        let rows = match answer.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>() {
            Ok(rows) => rows,
            Err(exception) if is_an_end(answer.py(), &exception) => return Err(Refusal::Exception(exception)),
            // Nothing to drive has no columns.
            Err(_) if answer.len().is_ok_and(|length| length == 0) => return Ok(Ok(Path::standing(start))),
            Err(_) => return Err(refuse(described(answer))),
        };
        let rows = rows.as_array();
        if rows.nrows() > MOST_SEGMENTS {
            return Err(Refusal::Words(format!("it has {} rows, the most is {MOST_SEGMENTS}", rows.nrows())));
        }
        match rows.ncols() {
            _ if rows.nrows() == 0 => Ok(Ok(Path::standing(start))),
            2 => {
                let segments = rows.rows().into_iter();
                let segments = segments.map(|row| Segment { curvature: row[0], length_m: row[1] }).collect();
                Ok(Ok(Path { start, segments }))
            }
            3 => {
                let poses: Vec<_> = rows.rows().into_iter().map(|row| pose(row[0], row[1], row[2])).collect();
                if let Some(index) = poses.iter().position(|pose| !is_sane_pose(pose)) {
                    let sentence = format!("pose {} of {} is not made of finite, sane numbers", index + 1, poses.len());
                    return Err(Refusal::Words(sentence));
                }
                Ok(Ok(path::through(start, &poses, self.checker.get().0.body().turning_radius_m)))
            }
            _ => Err(refuse(described(answer))),
        }
    }

    /// Makes a failure out of an exception.
    fn failure(&self, py: Python<'_>, exception: PyErr) -> Plan {
        if exception.is_instance_of::<NoPath>(py) {
            let reason = exception.value(py).getattr("reason").and_then(|reason| reason.extract::<String>());
            return match reason.as_deref() {
                Ok("disconnected") => Plan::from(Err(PlanFailure::Disconnected)),
                Ok("start-blocked") => Plan::from(Err(PlanFailure::StartBlocked)),
                Ok("goal-blocked") => Plan::from(Err(PlanFailure::GoalBlocked)),
                Ok("budget-spent") => Plan::from(Err(PlanFailure::BudgetSpent)),
                _ => {
                    let expected = "disconnected, start-blocked, goal-blocked or budget-spent";
                    let words = words(py, &exception);
                    Plan::failed(PlanFailure::BadAnswer, format!("{words}: expected one of {expected}"))
                }
            };
        }
        let words = words(py, &exception);
        settle(py, exception, &self.interruption, &self.has_printed);
        Plan::failed(PlanFailure::Crashed, words)
    }
}

const EXPECTED: &str =
    "a Path, segments of the shape (n, 2), poses of the shape (n, 3), or None where there is no path";

/// Why an answer is no path.
enum Refusal {
    Words(String),
    Exception(PyErr),
}

/// Says whether an exception is meant to end more than what raised it.
fn is_an_end(py: Python<'_>, exception: &PyErr) -> bool {
    !exception.is_instance_of::<PyException>(py)
}

/// Passes on an exception that is meant to end the program; of others the first of a run is printed whole.
pub fn settle(py: Python<'_>, exception: PyErr, interruption: &Interruption, has_printed: &AtomicBool) {
    if is_an_end(py, &exception) {
        interruption.set(exception);
    } else if !has_printed.swap(true, Ordering::Relaxed) {
        exception.display(py);
    }
}

/// Returns the last line of an exception's traceback.
pub fn words(py: Python<'_>, exception: &PyErr) -> String {
    let lines = || {
        let lines = py.import("traceback")?.call_method1("format_exception_only", (exception.value(py),))?;
        lines.extract::<Vec<String>>()
    };
    let last = lines().ok().and_then(|lines| lines.last().map(|line| line.trim().to_owned()));
    last.unwrap_or_else(|| exception.get_type(py).to_string())
}
