//! Python planners in a run, created by Python factories.
//!
//! Every result of a call counts as an answer. An exception is a failed query, and so is an object that is no path; an
//! exception that ends the program, such as `KeyboardInterrupt`, ends the run or the batch. A query that exceeds its CPU
//! time fails as *timed out*. A truck only drives paths that the gate has accepted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::{AllowTypeChange, PyArrayLike2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use rand::Rng;
use wildfire::batch::plan::{BatchPlan, Variant};
use wildfire::collision::CollisionChecker;
use wildfire::geometry::Pose;
use wildfire::planning::judge::MAX_SEGMENTS;
use wildfire::planning::{self, Goal, MakeError, NameError, Plan, PlanFailure, Planners, TruckPlanner};
use wildfire::scenario::{Programs, Scenario};
use wildfire::sim::{CustomRegistry, StartPrograms};
use wildfire::vehicle::{Path, Segment};

use crate::arrays::{described, is_sane_pose, pose};
use crate::checker::Checker;
use crate::errors::{NoPath, error};
pub use crate::interruption::Interruption;
use crate::interruption::is_an_end;
use crate::path;
use crate::policy::CustomPolicies;
use crate::query::{Query, Site};

/// Bits of a seed: every integer below 2^53 is exact as a float.
pub const SEED_BITS: u32 = 53;

/// The custom planner factories and policies, by name.
pub struct Factories {
    planners: Vec<(String, Py<PyAny>)>,
    policies: CustomPolicies,
    /// Starts the programs of scenarios.
    programs: Option<Arc<dyn StartPrograms>>,
}

impl Factories {
    /// Reads Python mappings of names to factories and to policies.
    ///
    /// # Errors
    /// If a name is not allowed, or an object is no planner or policy.
    pub fn new(planners: Option<&Bound<'_, PyMapping>>, policies: Option<&Bound<'_, PyMapping>>) -> PyResult<Self> {
        let mut factories = Vec::new();
        for item in planners.map(PyMappingMethods::items).transpose()?.iter().flatten() {
            let (name, factory) = item.extract::<(String, Bound<'_, PyAny>)>()?;
            if !factory.is_callable() {
                let kind = factory.get_type().name()?;
                let sentence =
                    format!("the planner `{name}` is a {kind}; expected a callable that takes a Site, such as a class");
                return Err(PyTypeError::new_err(sentence));
            }
            factories.push((name, factory.unbind()));
        }
        let factories = Self { planners: factories, policies: CustomPolicies::new(policies)?, programs: None };
        // Names are checked now, before anything runs.
        Python::attach(|py| {
            factories.planners(py, None, &Arc::default()).map_err(error)?;
            factories.policies.policies(py, None, &Arc::default()).map_err(error)
        })?;
        Ok(factories)
    }

    /// Returns the same with a starter of scenarios' programs.
    pub fn with_programs(self, programs: Option<Arc<dyn StartPrograms>>) -> Self {
        Self { programs, ..self }
    }

    /// Returns whether a planner or a policy (`kind`) of this name was passed in.
    pub fn knows(&self, kind: &str, name: &str) -> bool {
        match kind {
            "planner" => self.planners.iter().any(|(id, _)| id == name),
            _ => self.policies.knows(name),
        }
    }

    /// Returns the planners and policies for one run, with default limits.
    pub fn registry(&self, py: Python<'_>, interruption: &Arc<Interruption>) -> CustomRegistry {
        self.registry_of(py, None, interruption)
    }

    /// Returns the same with the limits of a scenario's tables.
    pub fn registry_of(
        &self,
        py: Python<'_>,
        scenario: Option<&Scenario>,
        interruption: &Arc<Interruption>,
    ) -> CustomRegistry {
        let planners = self.planners(py, scenario, interruption).expect("the names were checked before");
        let policies = self.policies.policies(py, scenario, interruption).expect("the names were checked before");
        CustomRegistry { planners, policies, programs: self.programs.clone() }
    }

    /// Returns whether nothing was passed in.
    pub fn is_empty(&self) -> bool {
        self.planners.is_empty() && self.policies.0.is_empty()
    }

    /// Adds to a plan the version of the custom code, or else its hash.
    pub fn sign(&self, py: Python<'_>, plan: &mut BatchPlan, version: Option<&str>) -> PyResult<()> {
        let hash = py.import("wildfire_contest.fingerprint")?.getattr("fingerprint")?;
        let planners = self.planners.iter().map(|(name, factory)| (true, name, factory));
        let policies = self.policies.0.iter().map(|custom| (false, &custom.name, &custom.policy));
        for (is_planner, name, code) in planners.chain(policies) {
            let (kind, signature) = match version {
                Some(version) => ("version", version.to_owned()),
                None => ("code", hash.call1((code,))?.extract()?),
            };
            for Variant { scenario, .. } in &mut plan.variants {
                let tables = if is_planner { &mut scenario.planner } else { &mut scenario.policy };
                let matching = tables.iter_mut().filter(|(id, table)| id.name() == name && !table.is_external());
                matching.for_each(|(_, table)| drop(table.sha256.insert(kind.to_owned(), signature.clone())));
            }
        }
        Ok(())
    }

    fn planners(
        &self,
        py: Python<'_>,
        scenario: Option<&Scenario>,
        interruption: &Arc<Interruption>,
    ) -> Result<Planners, NameError> {
        let has_printed = Arc::new(AtomicBool::new(false));
        self.planners.iter().try_fold(Planners::default(), |planners, (name, factory)| {
            let maker = PythonPlannerFactory {
                name: name.clone(),
                limit_s: cpu_limit_s(scenario.map(|scenario| &scenario.planner), name),
                factory: factory.clone_ref(py),
                interruption: Arc::clone(interruption),
                has_printed: Arc::clone(&has_printed),
            };
            planners.with(name, move |site: &planning::PlannerContext<'_>| maker.make(site))
        })
    }
}

/// Returns the limit of CPU seconds per query from the table of a name: a limit of wall-clock time for programs counts CPU
/// time of the thread here.
pub fn cpu_limit_s(tables: Option<&Programs>, name: &str) -> f64 {
    let limits = tables.and_then(|tables| tables.iter().find(|(id, _)| id.name() == name));
    let table = limits.map(|(_, table)| table.clone()).unwrap_or_default();
    table.query_cpu_s.unwrap_or(table.query_limit_s)
}

/// Creates planners of one name in one run.
struct PythonPlannerFactory {
    name: String,
    limit_s: f64,
    factory: Py<PyAny>,
    interruption: Arc<Interruption>,
    /// True once an exception of this run was printed in full.
    has_printed: Arc<AtomicBool>,
}

impl PythonPlannerFactory {
    fn make(&self, site: &planning::PlannerContext<'_>) -> Result<Box<dyn TruckPlanner>, MakeError> {
        let made = Python::try_attach(|py| {
            let made = self.interruption.watched(
                py,
                || format!("the factory of the planner `{}`", self.name),
                None,
                || self.call(py, site),
            );
            made.map_err(MakeError::new)?.map_err(|exception| {
                let message = last_line(py, &exception);
                self.report_exception(py, exception);
                MakeError::new(message)
            })
        });
        made.unwrap_or_else(|| Err(MakeError::new("Python has ended")))
    }

    fn call(&self, py: Python<'_>, site: &planning::PlannerContext<'_>) -> PyResult<Box<dyn TruckPlanner>> {
        let checker = Py::new(py, Checker::new(CollisionChecker::clone(site.checker)))?;
        let settings = if site.custom_settings.is_null() {
            PyDict::new(py).into_any()
        } else {
            py.import("json")?.call_method1("loads", (site.custom_settings.to_string(),))?
        };
        let seed = (site.stream)(&self.name).next_u64() >> (u64::BITS - SEED_BITS);
        let context = Py::new(py, Site::new(site, seed, settings.unbind(), checker.clone_ref(py)))?;
        let planner = self.factory.bind(py).call1((context,))?;
        let plan = planner.getattr("plan").map_err(|_| {
            let kind = planner.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
            error(format_args!("it made a {kind}, which has no method `plan`"))
        })?;
        Ok(Box::new(PythonPlanner {
            name: self.name.clone(),
            limit_s: self.limit_s,
            plan: plan.unbind(),
            checker,
            interruption: Arc::clone(&self.interruption),
            has_printed: Arc::clone(&self.has_printed),
        }))
    }

    fn report_exception(&self, py: Python<'_>, exception: PyErr) {
        report_exception(py, exception, &self.interruption, &self.has_printed);
    }
}

/// A planner created in Python.
struct PythonPlanner {
    name: String,
    limit_s: f64,
    /// Its bound method.
    plan: Py<PyAny>,
    checker: Py<Checker>,
    interruption: Arc<Interruption>,
    has_printed: Arc<AtomicBool>,
}

impl TruckPlanner for PythonPlanner {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        if self.interruption.is_set() {
            return Plan::failed(PlanFailure::Crashed, "it was not asked, since everything was stopping");
        }
        let plan = Python::try_attach(|py| self.ask(py, start, goal));
        plan.unwrap_or_else(|| Plan::failed(PlanFailure::Crashed, "Python has ended"))
    }
}

impl PythonPlanner {
    fn ask(&self, py: Python<'_>, start: Pose, goal: Goal) -> Plan {
        let query = Query { start, goal, checker: self.checker.clone_ref(py) };
        let about = || {
            let goal = match goal {
                Goal::Disc(disc) => disc.centre,
                Goal::Pose(pose) => pose.position(),
            };
            format!("the planner `{}`, asked for a path to ({:.1}, {:.1}),", self.name, goal.x, goal.y)
        };
        let answered = self.interruption.watched(py, about, Some(self.limit_s), || {
            let answer = self.plan.bind(py).call1((query,))?;
            self.read(start, &answer)
        });
        match answered {
            Ok(Ok(plan)) => plan,
            Ok(Err(exception)) => self.failure(py, exception),
            Err(message) => Plan::failed(PlanFailure::TimedOut, message),
        }
    }

    /// Reads an answer. An object that is no path is a bad answer; an error is an exception that ends the program.
    fn read(&self, start: Pose, answer: &Bound<'_, PyAny>) -> PyResult<Plan> {
        if answer.is_none() {
            return Ok(Plan::from(Err(PlanFailure::Disconnected)));
        }
        if let Ok(path) = answer.cast::<path::Path>() {
            return Ok(Plan::from(Ok(path.get().0.clone())));
        }
        let bad = |message: String| Ok(Plan::failed(PlanFailure::BadAnswer, message));
        let refuse = || bad(format!("{}; expected {EXPECTED}", described(answer)));
        let rows = match answer.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>() {
            Ok(rows) => rows,
            // Ctrl-C may come while numpy reads the object; it is no bad answer.
            Err(exception) if is_an_end(answer.py(), &exception) => return Err(exception),
            // An empty list has no columns.
            Err(_) if answer.len().is_ok_and(|length| length == 0) => return Ok(Plan::from(Ok(Path::standing(start)))),
            Err(_) => return refuse(),
        };
        let rows = rows.as_array();
        if rows.nrows() > MAX_SEGMENTS {
            return bad(format!("it has {} rows; expected at most {MAX_SEGMENTS}", rows.nrows()));
        }
        match rows.ncols() {
            _ if rows.nrows() == 0 => Ok(Plan::from(Ok(Path::standing(start)))),
            2 => {
                let segments = rows.rows().into_iter();
                let segments = segments.map(|row| Segment { curvature: row[0], length_m: row[1] }).collect();
                Ok(Plan::from(Ok(Path { start, segments })))
            }
            3 => {
                let poses: Vec<_> = rows.rows().into_iter().map(|row| pose(row[0], row[1], row[2])).collect();
                // The curves between poses are computed before the gate sees the path; such numbers would make nonsense of them.
                if let Some(index) = poses.iter().position(|pose| !is_sane_pose(pose)) {
                    let count = poses.len();
                    return bad(format!("pose {} of {count} has numbers that are not finite or too large", index + 1));
                }
                let radius_m = self.checker.get().0.body().turning_radius_m;
                Ok(Plan::from(Ok(path::through(start, &poses, radius_m))))
            }
            _ => refuse(),
        }
    }

    /// Converts an exception to a failure.
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
                    let message = last_line(py, &exception);
                    Plan::failed(PlanFailure::BadAnswer, format!("{message}: expected one of {expected}"))
                }
            };
        }
        let message = last_line(py, &exception);
        report_exception(py, exception, &self.interruption, &self.has_printed);
        Plan::failed(PlanFailure::Crashed, message)
    }
}

const EXPECTED: &str = "a Path, segments of shape (n, 2), poses of shape (n, 3), or None if there is no path";

/// Passes on an exception that ends the program; of other exceptions, prints the first of a run in full.
pub fn report_exception(py: Python<'_>, exception: PyErr, interruption: &Interruption, has_printed: &AtomicBool) {
    if is_an_end(py, &exception) {
        interruption.set(exception);
    } else if !has_printed.swap(true, Ordering::Relaxed) {
        exception.display(py);
    }
}

/// Returns the last line of an exception's traceback.
pub fn last_line(py: Python<'_>, exception: &PyErr) -> String {
    let lines = || {
        let lines = py.import("traceback")?.call_method1("format_exception_only", (exception.value(py),))?;
        lines.extract::<Vec<String>>()
    };
    let last = lines().ok().and_then(|lines| lines.last().map(|line| line.trim().to_owned()));
    last.unwrap_or_else(|| exception.get_type(py).to_string())
}
