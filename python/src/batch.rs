//! Many runs: a batch of the command line, made and read from Python.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyInt, PyMapping, PyString};
use tempfile::TempDir;
use wildfire::batch::{
    self as library, BatchError, BatchPlan, BatchReport, BatchRequest, FinishedBatch, OutputFolder, Record,
    RequestError, Seeds, Setting, Slice, Sweep, read_rows, swept_columns,
};
use wildfire::scenario::{Fault, ScenarioText};
use wildfire::sim::{RunError, RunOptions};

use crate::errors::{error, scenario_error};
use crate::literal::literal;
use crate::planner::{Factories, Interruption};
use crate::run::simulate;
use crate::scenario::{Scenario, ScenarioLike, table_of};
use crate::tables::Table;

/// The most threads of a batch.
const MAX_JOBS: usize = 1024;

/// The time between two looks for Ctrl-C.
const POLL: Duration = Duration::from_millis(50);

/// A batch that is over. Its tables are read when they are asked for.
///
/// Made by `batch`.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Batch {
    plan: BatchPlan,
    folder: OutputFolder,
    /// The folder, if nobody asked for one: it goes with the batch.
    scratch: Option<TempDir>,
    report: BatchReport,
}

#[pymethods]
impl Batch {
    /// Returns a row a run, with the columns of ``runs.csv`` in the order of the plan.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::Runs)
    }

    /// Returns a row an agent of a run, with the columns of ``agents.csv``.
    #[getter]
    fn agents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::Agents)
    }

    /// Returns a row a query to a planner, with the columns of ``planner_calls.parquet``.
    #[getter]
    fn calls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::Calls)
    }

    /// Returns the number of bushes in each state over time, with the columns of ``states.parquet``.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::States)
    }

    /// Returns the tables of the contest as text, as the command line prints them.
    #[getter]
    fn tables(&self) -> String {
        self.report.to_document().to_text()
    }

    /// Returns the folder with the files of the batch; None if none was asked for.
    #[getter]
    fn folder(&self) -> Option<PathBuf> {
        self.scratch.is_none().then(|| self.folder.path().to_owned())
    }

    /// Returns the number of runs that failed.
    #[getter]
    fn not_done(&self) -> u64 {
        self.report.not_done()
    }

    fn __len__(&self) -> usize {
        usize::try_from(self.plan.count()).unwrap_or(usize::MAX)
    }

    fn __repr__(&self) -> String {
        let (variants, runs) = (self.plan.variants.len(), self.plan.count());
        format!("<Batch of {runs} runs, {variants} variants, seeds {}>", self.plan.seeds)
    }
}

impl Batch {
    /// Returns the folder, asked for or not.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    fn table<'py>(&self, py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyAny>> {
        let largest_seed = self.plan.seeds.iter().max().unwrap_or_default();
        let mut started = table.begin(&swept_columns(&self.plan), largest_seed);
        let read = py.detach(|| read_rows(&self.plan, &self.folder, |row| started.add(row)));
        read.map_err(error)?;
        started.finish(py)
    }
}

/// One thing or several of them.
#[derive(FromPyObject)]
pub enum OneOrMore<T> {
    One(T),
    More(Vec<T>),
}

impl<T> OneOrMore<T> {
    pub fn into_vec(self) -> Vec<T> {
        match self {
            Self::One(one) => vec![one],
            Self::More(more) => more,
        }
    }
}

/// The arguments that say which runs there are.
struct Request<'a, 'py> {
    scenarios: Vec<Py<Scenario>>,
    seeds: Seeds,
    planners: Vec<String>,
    sweep: Option<&'a Bound<'py, PyMapping>>,
    record: Record,
}

#[pyfunction]
#[pyo3(signature = (
    scenarios = None, seeds = None, *, planner = None, planners = None, policies = None, sweep = None, jobs = 1, out = None,
    record = None
))]
/// Runs scenarios with many seeds.
///
/// Everything is multiplied: scenarios, planners, what is swept, seeds. Runs that fail are rows with a reason.
///
/// Parameters
/// ----------
/// scenarios : str, path or Scenario, or several of them
///     `contest` if it is left out.
/// seeds : str, int or iterable of int
///     ``"1..50,99"`` or numbers; 1 to 5 if it is left out.
/// planner : str or sequence of str
///     Planners of the trucks, to be compared.
/// planners, policies : mapping
///     Planners and policies of one's own, as in `run`.
/// sweep : mapping
///     Values that keys of the scenario take, such as ``{"field.coverage": [0.05, 0.1]}``.
/// jobs : int
///     Threads. Planners of Python take turns where the interpreter has a lock.
/// out : path
///     The folder for all files; one that goes with the batch if it is left out. A batch that was stopped there goes on
///     when the same is asked for again.
/// record : str
///     Which runs leave a recording in that folder: ``"all"``, ``"failed"`` or ``"none"``.
///
/// Raises
/// ------
/// ScenarioError
///     A scenario is refused.
/// WildfireError
///     The seeds or the folder are refused, or the disk is full.
/// KeyboardInterrupt
///     Ctrl-C, or a planner raised it: what is in `out` can be resumed.
#[expect(clippy::too_many_arguments, reason = "each is a keyword of Python")]
pub fn batch(
    py: Python<'_>,
    scenarios: Option<OneOrMore<ScenarioLike<'_>>>,
    seeds: Option<&Bound<'_, PyAny>>,
    planner: Option<OneOrMore<String>>,
    planners: Option<&Bound<'_, PyMapping>>,
    policies: Option<&Bound<'_, PyMapping>>,
    sweep: Option<&Bound<'_, PyMapping>>,
    jobs: usize,
    out: Option<PathBuf>,
    record: Option<&str>,
) -> PyResult<Batch> {
    if !(1..=MAX_JOBS).contains(&jobs) {
        return Err(PyValueError::new_err(format!("jobs is {jobs}; expected 1 to {MAX_JOBS} threads")));
    }
    let scenarios = scenarios.map_or_else(|| vec![ScenarioLike::or_contest(None)], OneOrMore::into_vec);
    let request = Request {
        scenarios: scenarios.iter().map(|named| named.load(py, Vec::new())).collect::<PyResult<_>>()?,
        seeds: seeds.map_or_else(|| Ok(Seeds::default()), seeds_from)?,
        planners: planner.map_or_else(Vec::new, OneOrMore::into_vec),
        sweep,
        record: record
            .unwrap_or("none")
            .parse()
            .map_err(|words: String| PyValueError::new_err(format!("record: {words}")))?,
    };
    let factories = Factories::new(planners, policies)?;
    let plan = request.plan(&factories)?;
    let (path, scratch) = match out {
        Some(path) => (path, None),
        None => {
            let scratch = tempfile::Builder::new().prefix("wildfire-").tempdir().map_err(error)?;
            (scratch.path().to_owned(), Some(scratch))
        }
    };
    let (report, plan) = run_to_its_end(py, plan, &path, factories, jobs)?;
    let folder = OutputFolder::existing(&path).map_err(error)?;
    Ok(Batch { plan, folder, scratch, report })
}

impl Request<'_, '_> {
    /// Makes the plan: each scenario by itself, since each has changes of its own.
    fn plan(&self, factories: &Factories) -> PyResult<BatchPlan> {
        let mut plans = Vec::new();
        for scenario in &self.scenarios {
            scenario.get().expect_known(factories)?;
            plans.push(self.plan_of(scenario.get(), factories)?);
        }
        let mut plans = plans.into_iter();
        let mut plan = plans.next().ok_or_else(|| PyValueError::new_err("no scenario; expected at least one"))?;
        plan.variants.extend(plans.flat_map(|other| other.variants));
        self.expect_names_that_differ()?;
        Ok(plan)
    }

    fn plan_of(&self, scenario: &Scenario, factories: &Factories) -> PyResult<BatchPlan> {
        let (text, mut changes) = scenario.parts();
        let mut declared: Vec<String> = Vec::new();
        loop {
            let mut request = self.request(text, changes.clone())?;
            request.add_planners(&self.planners).map_err(error)?;
            match request.resolve(true) {
                Ok(plan) => return Ok(plan),
                Err(RequestError::Scenario(refusal)) => match &refusal.fault {
                    // What was handed in has no table yet.
                    Fault::UnknownName { kind, found, .. }
                        if factories.knows(kind, found) && !declared.contains(&table_of(kind, found)) =>
                    {
                        changes.push(table_of(kind, found));
                        declared.push(table_of(kind, found));
                    }
                    _ => return Err(scenario_error(&refusal)),
                },
                Err(refusal) => return Err(error(refusal)),
            }
        }
    }

    fn request(&self, text: &ScenarioText, changes: Vec<String>) -> PyResult<BatchRequest> {
        let sweep = |item: Bound<'_, PyAny>| {
            let (key, values) = item.extract::<(String, Vec<Bound<'_, PyAny>>)>()?;
            let settings = values.iter().map(|value| Ok(Setting::parse(&literal(value)?)));
            Sweep::together(vec![(key, settings.collect::<PyResult<_>>()?)]).map_err(error)
        };
        let items = self.sweep.map(PyMappingMethods::items).transpose()?;
        Ok(BatchRequest {
            scenarios: vec![text.source.clone()],
            texts: vec![text.clone()],
            changes,
            sweeps: items.iter().flatten().map(sweep).collect::<PyResult<_>>()?,
            seeds: Some(self.seeds.clone()),
            record: Some(self.record),
            memory: None,
        })
    }

    /// Tables tell scenarios apart by their names.
    fn expect_names_that_differ(&self) -> PyResult<()> {
        let mut names: Vec<&str> =
            self.scenarios.iter().map(|scenario| scenario.get().library().name.as_str()).collect();
        names.sort_unstable();
        let twice = names.windows(2).find(|pair| pair[0] == pair[1]);
        twice.map_or(Ok(()), |pair| {
            let sentence = "two scenarios are named `NAME`; name one of them otherwise, by `.with_({\"name\": ...})`, as \
                            tables could not tell them apart";
            Err(error(sentence.replace("NAME", pair[0])))
        })
    }
}

/// Takes seeds as the command line has them, or as whole numbers.
fn seeds_from(seeds: &Bound<'_, PyAny>) -> PyResult<Seeds> {
    if seeds.is_instance_of::<PyString>() {
        return seeds.extract::<String>()?.parse().map_err(error);
    }
    let numbers: Vec<u64> = if seeds.is_instance_of::<PyInt>() {
        vec![seeds.extract()?]
    } else {
        let expected = |_| PyTypeError::new_err("seeds are a text such as `1..50`, or whole numbers");
        seeds.try_iter().map_err(expected)?.map(|seed| seed?.extract()).collect::<PyResult<_>>()?
    };
    // Numbers that count up are one range.
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if last.checked_add(1) == Some(number) => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let parts: Vec<String> = ranges.iter().map(|(first, last)| format!("{first}..{last}")).collect();
    Seeds::from_parts(parts.iter().map(String::as_str)).map_err(error)
}

/// Runs what a folder does not hold yet, and writes the tables.
fn run_to_its_end(
    py: Python<'_>,
    plan: BatchPlan,
    path: &Path,
    factories: Factories,
    jobs: usize,
) -> PyResult<(BatchReport, BatchPlan)> {
    let interruption: Arc<Interruption> = Arc::default();
    let ended = py.detach(|| {
        thread::scope(|scope| {
            let (sender, ended) = mpsc::channel();
            let interruption = &interruption;
            let work = move || {
                let result = work_off(plan, path, factories, jobs, interruption);
                // Whoever waits has not gone away.
                let _ = sender.send(result);
            };
            thread::Builder::new().spawn_scoped(scope, work).map_err(error)?;
            loop {
                match ended.recv_timeout(POLL) {
                    Ok(result) => return Ok(result),
                    Err(RecvTimeoutError::Disconnected) => {
                        return Err(PyRuntimeError::new_err("the batch ended without a result"));
                    }
                    Err(RecvTimeoutError::Timeout) => {
                        Python::attach(|py| -> PyResult<()> { py.check_signals() })
                            .unwrap_or_else(|exception| interruption.set(exception));
                    }
                }
            }
        })
    })?;
    match (ended, interruption.take()) {
        (Ok(done), _) => Ok(done),
        (Err(BatchError::Stopped), Some(exception)) => Err(exception),
        (Err(refusal), _) => Err(error(refusal)),
    }
}

fn work_off(
    plan: BatchPlan,
    path: &Path,
    factories: Factories,
    jobs: usize,
    interruption: &Arc<Interruption>,
) -> Result<(BatchReport, BatchPlan), BatchError> {
    let memory = plan.memory;
    let mut batch = begin_or_go_on(plan, path)?;
    let run = {
        let interruption = Arc::clone(interruption);
        move |scenario: &wildfire::scenario::Scenario, seed| {
            // The thread is known to Python for the whole run, so that a query need not introduce it.
            let run = Python::try_attach(|py| {
                let options = RunOptions { memory, ..factories.entrants(py, &interruption).into() };
                py.detach(|| simulate(scenario, seed, &options, || interruption.is_set()))
            });
            run.unwrap_or(Err(RunError::Stopped))
        }
    };
    batch.run_with(Box::new(run), jobs, interruption.stop(), |_| {})?;
    let report = batch.finish(interruption.stop())?;
    Ok((report, batch.plan().clone()))
}

/// Begins a batch, or goes on with the same one where it was stopped.
fn begin_or_go_on(plan: BatchPlan, path: &Path) -> Result<library::Batch, BatchError> {
    if path.is_dir() && FinishedBatch::is_there(path) {
        BatchPlan::read(path)?.expect_same(&plan, path)?;
        return library::Batch::resume(OutputFolder::existing(path)?, Slice::WHOLE);
    }
    library::Batch::begin(plan, OutputFolder::named(path, false)?)
}
