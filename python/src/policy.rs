//! Python policies in a run: functions from an environment's observation to an action, and from what crews know to points
//! of line.
//!
//! `None` lets an agent wait. After an exception or an invalid action the agent waits too, and the failure is counted; the
//! first exception of a run is printed.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use numpy::{AllowTypeChange, Element, PyArray1, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyMapping};
use rand::Rng;
use wildfire::geometry::{Cell, DVec2};
use wildfire::planning::{MakeError, PlanFailure};
use wildfire::programs::protocol::question;
use wildfire::scenario::Scenario;
use wildfire::sim::policies::{
    Action, FirelineContext, Observation, Policies, Policy, PolicyContext, PolicyNameError, QueryReport,
};
use wildfire::time::SimTime;
use wildfire::timeline::AgentId;

use crate::arrays::described;
use crate::interruption::{Interruption, is_an_end};
use crate::observation::{AGENT_NUMBERS, AgentArrays, CANDIDATE_NUMBERS, Layout, SharedArrays, Sight};
use crate::planner::{SEED_BITS, cpu_limit_s, last_line, report_exception};

/// The Python attributes of a policy.
pub struct CustomPolicy {
    pub name: String,
    /// The whole object; the other fields are parts of it.
    pub policy: Py<PyAny>,
    act: Py<PyAny>,
    nearest: Option<usize>,
    wait_s: f64,
    per_run: bool,
}

impl CustomPolicy {
    fn clone_ref(&self, py: Python<'_>) -> Self {
        let policy = self.policy.clone_ref(py);
        let act = self.act.clone_ref(py);
        Self { name: self.name.clone(), policy, act, ..*self }
    }
}

/// The custom policies.
pub struct CustomPolicies(pub Vec<CustomPolicy>);

impl CustomPolicies {
    /// Reads a Python mapping of names to policies.
    ///
    /// # Errors
    /// If an object is no policy.
    pub fn new(mapping: Option<&Bound<'_, PyMapping>>) -> PyResult<Self> {
        let mut policies = Vec::new();
        for item in mapping.map(PyMappingMethods::items).transpose()?.iter().flatten() {
            let (name, policy) = item.extract::<(String, Bound<'_, PyAny>)>()?;
            let as_policy = item.py().import("wildfire_contest.policies")?.getattr("as_policy")?;
            let policy = as_policy.call1((policy,))?;
            policies.push(CustomPolicy {
                name,
                act: policy.getattr("act")?.unbind(),
                nearest: policy.getattr("nearest")?.extract()?,
                wait_s: policy.getattr("wait_s")?.extract()?,
                per_run: policy.getattr("per_run")?.extract()?,
                policy: policy.unbind(),
            });
        }
        Ok(Self(policies))
    }

    pub fn knows(&self, name: &str) -> bool {
        self.0.iter().any(|custom| custom.name == name)
    }

    /// Returns the policies for one run.
    ///
    /// # Errors
    /// If a name is not allowed.
    pub fn policies(
        &self,
        py: Python<'_>,
        scenario: Option<&Scenario>,
        interruption: &Arc<Interruption>,
    ) -> Result<Policies, PolicyNameError> {
        let has_printed = Arc::new(AtomicBool::new(false));
        self.0.iter().try_fold(Policies::default(), |policies, custom| {
            let maker = PythonPolicyFactory {
                custom: custom.clone_ref(py),
                limit_s: cpu_limit_s(scenario.map(|scenario| &scenario.policy), &custom.name),
                interruption: Arc::clone(interruption),
                has_printed: Arc::clone(&has_printed),
            };
            policies.with(&custom.name, move |site: &PolicyContext<'_>| maker.make(site))
        })
    }
}

/// Creates policies of one name.
struct PythonPolicyFactory {
    custom: CustomPolicy,
    limit_s: f64,
    interruption: Arc<Interruption>,
    /// True once an exception of this run was printed in full.
    has_printed: Arc<AtomicBool>,
}

impl PythonPolicyFactory {
    fn make(&self, site: &PolicyContext<'_>) -> Result<Box<dyn Policy>, MakeError> {
        let made = Python::try_attach(|py| {
            self.act(py, site).map_err(|exception| {
                let message = last_line(py, &exception);
                report_exception(py, exception, &self.interruption, &self.has_printed);
                MakeError::new(message)
            })
        });
        let act = made.unwrap_or_else(|| Err(MakeError::new("Python has ended")))?;
        let layout = Layout {
            frame: site.frame,
            agents: site.agents.len(),
            nearest: self.custom.nearest,
            wait: SimTime::from_seconds(self.custom.wait_s),
            duration: site.duration,
        };
        Ok(Box::new(PythonPolicy {
            name: self.custom.name.clone(),
            limit_s: self.limit_s,
            act,
            layout,
            interruption: Arc::clone(&self.interruption),
            has_printed: Arc::clone(&self.has_printed),
            report: QueryReport::default(),
        }))
    }

    /// Returns the callable for this run.
    fn act(&self, py: Python<'_>, site: &PolicyContext<'_>) -> PyResult<Py<PyAny>> {
        if !self.custom.per_run {
            return Ok(self.custom.act.clone_ref(py));
        }
        let named = |agents: &[AgentId]| agents.iter().map(ToString::to_string).collect::<Vec<_>>();
        let context = PyDict::new(py);
        context.set_item("scenario", site.scenario)?;
        context.set_item("seed", site.seed)?;
        context.set_item("agents", named(site.agents))?;
        context.set_item("plays", named(site.plays))?;
        let settings = if site.custom_settings.is_null() { "{}".to_owned() } else { site.custom_settings.to_string() };
        context.set_item("settings", py.import("json")?.call_method1("loads", (settings,))?)?;
        context.set_item("draw", (site.stream)(&self.custom.name).next_u64() >> (u64::BITS - SEED_BITS))?;
        Ok(self.custom.act.bind(py).call1((context,))?.unbind())
    }
}

/// A policy written in Python.
struct PythonPolicy {
    name: String,
    limit_s: f64,
    act: Py<PyAny>,
    layout: Layout,
    interruption: Arc<Interruption>,
    has_printed: Arc<AtomicBool>,
    /// The report on the last decision.
    report: QueryReport,
}

impl Policy for PythonPolicy {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        let Some(&agent) = queried.first() else { return Vec::new() };
        let answer =
            (!self.interruption.is_set()).then(|| Python::try_attach(|py| self.ask(py, seen, agent))).flatten();
        vec![(agent, answer.unwrap_or_else(|| self.layout.waiting(seen.now)))]
    }

    fn line(&mut self, seen: &Observation<'_>, line: &FirelineContext<'_>) -> Vec<DVec2> {
        let points =
            (!self.interruption.is_set()).then(|| Python::try_attach(|py| self.ask_for_line(py, seen, line))).flatten();
        points.flatten().unwrap_or_default()
    }

    fn take_report(&mut self) -> QueryReport {
        std::mem::take(&mut self.report)
    }
}

impl PythonPolicy {
    fn ask(&mut self, py: Python<'_>, seen: &Observation<'_>, agent: AgentId) -> Action {
        let options = seen.options(agent);
        let waiting = self.layout.waiting(seen.now);
        let answered = self.interruption.watched(
            py,
            || format!("the policy `{}`, asked for {agent},", self.name),
            Some(self.limit_s),
            || {
                let (observation, candidates) = self.shown(py, seen, agent, &options)?;
                Ok((self.act.bind(py).call1((observation,))?, candidates))
            },
        );
        let Some((answer, candidates)) = self.answer(py, answered) else { return waiting };
        if answer.is_none() {
            return waiting;
        }
        let Ok(action) = answer.extract::<i64>() else {
            let kind = answer.get_type().name().map_or_else(|_| "something".to_owned(), |name| name.to_string());
            self.report.failure =
                Some((PlanFailure::BadAnswer, format!("answered with a {kind}; expected an action or None")));
            return waiting;
        };
        let index = usize::try_from(action).ok().filter(|&index| index < self.layout.actions());
        index.and_then(|index| self.layout.choice(index, seen.now, &options, &candidates)).unwrap_or_else(|| {
            self.report.illegal = Some(format!("{agent} cannot do action {action}"));
            waiting
        })
    }

    /// Asks where crews build line, by the question that programs get.
    fn ask_for_line(
        &mut self,
        py: Python<'_>,
        seen: &Observation<'_>,
        line: &FirelineContext<'_>,
    ) -> Option<Vec<DVec2>> {
        let answered = self.interruption.watched(
            py,
            || format!("the policy `{}`, asked where crews build line,", self.name),
            Some(self.limit_s),
            || {
                let text = PyBytes::new(py, &question(1, seen, &[], Some(line)));
                let answer = self.act.bind(py).call1((py.import("json")?.call_method1("loads", (text,))?,))?;
                match answer.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>() {
                    Ok(points) if points.as_array().ncols() == 2 => {
                        Ok(Ok(points.as_array().rows().into_iter().map(|row| DVec2::new(row[0], row[1])).collect()))
                    }
                    Err(exception) if is_an_end(py, &exception) => Err(exception),
                    _ => Ok(Err(format!("answered with {}; expected points of shape (n, 2)", described(&answer)))),
                }
            },
        );
        let points = self.answer(py, answered)?;
        points.map_err(|message| self.report.failure = Some((PlanFailure::BadAnswer, message))).ok()
    }

    /// Returns what was answered, or takes notes on why nothing was.
    fn answer<T>(&mut self, py: Python<'_>, answered: Result<PyResult<T>, String>) -> Option<T> {
        match answered {
            Ok(Ok(answered)) => return Some(answered),
            Err(message) => self.report.failure = Some((PlanFailure::TimedOut, message)),
            Ok(Err(exception)) => {
                self.report.failure = Some((PlanFailure::Crashed, last_line(py, &exception)));
                report_exception(py, exception, &self.interruption, &self.has_printed);
            }
        }
        None
    }

    /// Makes the arrays of an environment's observation.
    fn shown<'py>(
        &self,
        py: Python<'py>,
        seen: &Observation<'_>,
        agent: AgentId,
        options: &[Cell],
    ) -> PyResult<(Bound<'py, PyDict>, Vec<Cell>)> {
        let layout = &self.layout;
        let cell_count = self.layout.frame.cell_count();
        let mut cells = vec![0; cell_count];
        let mut burning_s = vec![0.0; cell_count];
        let mut agents = vec![0.0; layout.agents * AGENT_NUMBERS];
        let mut time_s = [0.0; 2];
        let mut mask = vec![0; layout.actions()];
        let mut candidates = vec![0.0; layout.candidate_numbers()];
        let sight = Sight { now: seen.now, fires: seen.fires, agents: seen.agents, team: None };
        let mut shared =
            SharedArrays { cells: &mut cells, burning_s: &mut burning_s, agents: &mut agents, time_s: &mut time_s };
        sight.write(layout, |id| id == agent, &mut shared);
        let mut arrays = AgentArrays { action_mask: &mut mask, candidates: &mut candidates };
        let targets = sight.write_agent(layout, Some((agent, options)), &mut arrays);
        let observation = PyDict::new(py);
        let field = (usize::from(layout.frame.rows), usize::from(layout.frame.cols));
        observation.set_item("cells", shaped(py, cells, field)?)?;
        observation.set_item("burning_s", shaped(py, burning_s, field)?)?;
        observation.set_item("agents", shaped(py, agents, (layout.agents, AGENT_NUMBERS))?)?;
        observation.set_item("time_s", PyArray1::from_slice(py, &time_s))?;
        observation.set_item("action_mask", PyArray1::from_vec(py, mask))?;
        if let Some(max) = layout.nearest {
            observation.set_item("candidates", shaped(py, candidates, (max, CANDIDATE_NUMBERS))?)?;
        }
        Ok((observation, targets))
    }
}

fn shaped<T: Element>(py: Python<'_>, values: Vec<T>, shape: (usize, usize)) -> PyResult<Bound<'_, PyAny>> {
    Ok(PyArray1::from_vec(py, values).reshape([shape.0, shape.1])?.into_any())
}
