//! Batches of runs, as on the command line, run and read from Python.

use std::path::{Path, PathBuf, absolute};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyInt, PyMapping, PySequence, PyString};
use tempfile::TempDir;
use wildfire::batch as library;
use wildfire::batch::execute::{BatchError, OutputFolder, RealDisk, RunScenario, with_threads};
use wildfire::batch::plan::{
    BatchPlan, BatchRequest, MAX_SLICES, PlanError, Record, RequestError, Seeds, Setting, Slice, SliceError,
    StoppingRule, Sweep,
};
use wildfire::batch::report::{BatchReport, Merged, merge, read_report, read_rows};
use wildfire::batch::stopping::{StopRequest, USUAL_MAX_SEEDS};
use wildfire::batch::table::{FinishedBatch, swept_columns};
use wildfire::scenario::{Fault, ScenarioText};
use wildfire::sim::{RunError, RunOptions};

use crate::errors::{error, scenario_error};
use crate::interruption::{Interruption, say};
use crate::literal::literal;
use crate::planner::Factories;
use crate::program::programs;
use crate::run::simulate;
use crate::scenario::{Pickled, Scenario, ScenarioLike, restorer, table_of};
use crate::tables::Table;

/// The most threads of a batch.
const MAX_JOBS: usize = 1024;

/// A finished batch. Its tables are read on first access.
///
/// Created by `batch`.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Batch {
    plan: BatchPlan,
    folder: OutputFolder,
    /// The temporary folder, if no folder was requested: it is deleted with the batch.
    scratch: Option<TempDir>,
    report: BatchReport,
    /// True if all of its runs existed when it was requested.
    was_read: bool,
}

#[pymethods]
impl Batch {
    /// Returns a row per run, with the columns of ``runs.csv`` in the order of the plan.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::Runs)
    }

    /// Returns a row per agent and run, with the columns of ``agents.csv``.
    #[getter]
    fn agents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.table(py, Table::Agents)
    }

    /// Returns a row per query to a planner, with the columns of ``planner_calls.parquet``.
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

    /// Returns the folder with the files of the batch; None if none was requested.
    #[getter]
    fn folder(&self) -> Option<PathBuf> {
        self.scratch.is_none().then(|| self.folder.path().to_owned())
    }

    /// Returns the rule by which the batch stopped and after how many seeds, such as ``"saved decided, after 30 of at most
    /// 1000 seeds"``; None without a rule.
    #[getter]
    fn stopped_by(&self) -> Option<String> {
        self.plan.stop_text()
    }

    /// Returns the number of runs that failed.
    #[getter]
    fn not_done(&self) -> u64 {
        self.report.not_done()
    }

    /// Shows the tables in a notebook.
    fn _repr_html_(&self) -> String {
        let text = self.tables().replace('&', "&amp;").replace('<', "&lt;");
        format!("<pre>{text}</pre>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, (PathBuf,)>> {
        match self.folder() {
            Some(folder) => Ok((restorer(py, "read_batch")?, (folder,))),
            None => Err(error("a batch is pickled as its folder; expected one created with `out=FOLDER`")),
        }
    }

    fn __len__(&self) -> usize {
        usize::try_from(self.plan.count()).unwrap_or(usize::MAX)
    }

    fn __repr__(&self) -> String {
        let variants = self.plan.variants.len();
        let runs = self.plan.count();
        let read = if self.was_read { format!(", read from {}", self.folder.path().display()) } else { String::new() };
        format!("<Batch of {runs} runs, {variants} variants, seeds {}{read}>", self.plan.seeds)
    }
}

impl Batch {
    /// Returns the folder, whether requested or temporary.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    fn table<'py>(&self, py: Python<'py>, table: Table) -> PyResult<Bound<'py, PyAny>> {
        let largest_seed = self.plan.seeds.iter().max().unwrap_or_default();
        let mut started = table.begin(&swept_columns(&self.plan), largest_seed);
        let read = || read_rows(&self.plan, &self.folder, |row| started.add(row));
        py.detach(|| with_threads(1, read)).and_then(|read| read).map_err(error)?;
        started.finish(py)
    }
}

/// One value or several.
pub enum OneOrMore<T> {
    One(T),
    More(Vec<T>),
}

impl<'a, 'py, T: FromPyObjectOwned<'py>> FromPyObject<'a, 'py> for OneOrMore<T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<T>() {
            Ok(one) => Ok(Self::One(one)),
            // What is wrong with one of several, or with the only one.
            Err(_) if object.cast::<PySequence>().is_ok() => object.extract().map(Self::More),
            Err(error) => Err(error.into()),
        }
    }
}

impl<T> OneOrMore<T> {
    pub fn into_vec(self) -> Vec<T> {
        match self {
            Self::One(one) => vec![one],
            Self::More(more) => more,
        }
    }
}

/// The arguments that determine the runs.
struct RunsRequest<'a, 'py> {
    scenarios: Vec<Py<Scenario>>,
    seeds: Seeds,
    planners: Vec<String>,
    sweep: Option<&'a Bound<'py, PyMapping>>,
    record: Record,
}

#[pyfunction]
#[pyo3(signature = (
    scenarios = None, seeds = None, *, planner = None, planners = None, policies = None, sweep = None, until = None,
    metric = None, equivalent = None, jobs = 1, out = None, record = None, version = None, trust = false, executor = None,
    shards = None
))]
/// Runs scenarios with many seeds.
///
/// All combinations of scenarios, planners, swept values and seeds are run. A failed run is a row with the reason.
///
/// Parameters
/// ----------
/// scenarios : str, path or Scenario, or several of them
///     Default: `contest`.
/// seeds : str, int or iterable of int
///     ``"1..50,99"`` or numbers; default: 1 to 5.
/// planner : str or sequence of str
///     The trucks' planners to compare.
/// planners, policies : mapping
///     Custom planners and policies, as in `run`.
/// sweep : mapping
///     Values to vary by key of the scenario, such as ``{"field.coverage": [0.05, 0.1]}``.
/// until : str
///     What is to be known before the batch stops: ``"decided"``, ``"groups"`` or ``"saved=0.5"``, as ``wildfire batch
///     --until``. `seeds` are then the most, by default 1 to 1000.
/// metric : str
///     The metric of ``"decided"`` and ``"groups"``; default: ``"saved"``.
/// equivalent : float
///     The difference below which two variants count as equal there.
/// jobs : int
///     Threads; -1 for one per core. Python planners take turns if the interpreter has a lock.
/// out : path
///     The folder for all files; default: a temporary one that is deleted with the batch. A batch stopped there continues
///     with the same call and the same code of planners and policies.
/// record : str
///     The runs to record in that folder: ``"all"``, ``"failed"`` or ``"none"``.
/// version : str
///     The version of your planners and policies. It replaces the hash of their code, which covers functions, classes,
///     numbers and strings, but not lists or objects.
/// trust : bool
///     Whether programs named by scenarios may be started.
/// executor : Executor, or a callable that returns one
///     Where the shards run, such as a ``concurrent.futures.ProcessPoolExecutor``: its ``submit`` returns a future with a
///     ``result``. Its workers must see the folder. A shard whose worker dies is submitted again, twice at most; a pool of
///     processes is then broken, and only a callable, such as ``lambda: ProcessPoolExecutor(4)``, gives another one.
/// shards : int
///     The number of shards that go to the executor; each runs with `jobs` threads.
///
/// Raises
/// ------
/// ScenarioError
///     A scenario is invalid.
/// WildfireError
///     The seeds or the folder are invalid, the disk is full, or a shard failed; the message names it.
/// KeyboardInterrupt
///     Ctrl-C was pressed, or a planner raised it: the batch in `out` can be resumed.
#[expect(clippy::too_many_arguments, reason = "each is a keyword of Python")]
pub fn batch(
    py: Python<'_>,
    scenarios: Option<OneOrMore<ScenarioLike<'_>>>,
    seeds: Option<&Bound<'_, PyAny>>,
    planner: Option<OneOrMore<String>>,
    planners: Option<&Bound<'_, PyMapping>>,
    policies: Option<&Bound<'_, PyMapping>>,
    sweep: Option<&Bound<'_, PyMapping>>,
    until: Option<&str>,
    metric: Option<String>,
    equivalent: Option<f64>,
    jobs: isize,
    out: Option<PathBuf>,
    record: Option<&str>,
    version: Option<&str>,
    trust: bool,
    executor: Option<&Bound<'_, PyAny>>,
    shards: Option<u64>,
) -> PyResult<Batch> {
    let jobs = threads(jobs)?;
    let spread = SpreadBatch::new(executor, shards)?;
    let scenarios = scenarios.map_or_else(|| vec![ScenarioLike::or_contest(None)], OneOrMore::into_vec);
    let request = RunsRequest {
        scenarios: scenarios.iter().map(|named| named.load(py, Vec::new())).collect::<PyResult<_>>()?,
        seeds: match seeds {
            Some(seeds) => seeds_from(seeds)?,
            None if until.is_some() => USUAL_MAX_SEEDS.parse().map_err(error)?,
            None => Seeds::default(),
        },
        planners: planner.map_or_else(Vec::new, OneOrMore::into_vec),
        sweep,
        record: record
            .unwrap_or("none")
            .parse()
            .map_err(|message: String| PyValueError::new_err(format!("record: {message}")))?,
    };
    let factories = Arc::new(Factories::new(planners, policies)?.with_programs(programs(py, trust)));
    let mut plan = request.plan(&factories)?;
    factories.sign(py, &mut plan, version)?;
    plan.until = stopping_rule(&plan, until, metric, equivalent)?;
    if plan.until.is_some() && spread.is_some() {
        return Err(PyValueError::new_err("expected no executor beside `until`: its seeds run in rounds"));
    }
    let (path, scratch) = match out {
        Some(path) => (path, None),
        None => {
            let scratch = tempfile::Builder::new().prefix("wildfire-").tempdir().map_err(error)?;
            (scratch.path().to_owned(), Some(scratch))
        }
    };
    let (report, plan, found) = match spread {
        None => run_to_its_end(py, plan, &path, &factories, jobs)?,
        Some(spread) => {
            let path = spread.prepare(plan, &path, &factories)?;
            let workers = (planners, policies, jobs, version, trust);
            let found = spread.run(py, &path, workers)?;
            let merged = merged(py, &path, &factories, jobs)?;
            (merged.report, merged.plan, found)
        }
    };
    let was_read = found == plan.count();
    if was_read {
        say(py, &format!("read from {}, nothing was run", path.display()));
    }
    // Wrong answers and exceptions fail no run: without a word, a policy that does not work looks like one that plays badly.
    if policies.is_some() {
        report.failure_sentences().iter().for_each(|sentence| say(py, sentence));
    }
    let folder = OutputFolder::existing(&path).map_err(error)?;
    Ok(Batch { plan, folder, scratch, report, was_read })
}

/// Returns the rule of a batch that stops when enough is known.
fn stopping_rule(
    plan: &BatchPlan,
    until: Option<&str>,
    metric: Option<String>,
    equivalent: Option<f64>,
) -> PyResult<Option<StoppingRule>> {
    let Some(until) = until else {
        let is_alone = metric.is_none() && equivalent.is_none();
        let refusal = || PyValueError::new_err("expected `until` beside `metric` and `equivalent`");
        return if is_alone { Ok(None) } else { Err(refusal()) };
    };
    let until = until.parse().map_err(|reason: String| PyValueError::new_err(format!("until: {reason}")))?;
    StopRequest { until, metric, equivalent }.rule(plan).map(Some).map_err(error)
}

/// Runs what is missing of a shard of a batch in a folder, and returns how many of its runs were there before.
///
/// The planners and policies must be those of the batch.
#[pyfunction]
#[pyo3(signature = (folder, number, of, /, planners, policies, jobs, version, trust))]
#[expect(clippy::too_many_arguments, reason = "they travel to a worker one by one")]
pub fn run_shard(
    py: Python<'_>,
    folder: PathBuf,
    number: u64,
    of: u64,
    planners: Option<&Bound<'_, PyMapping>>,
    policies: Option<&Bound<'_, PyMapping>>,
    jobs: usize,
    version: Option<&str>,
    trust: bool,
) -> PyResult<u64> {
    let slice = Slice::new(number, of).ok_or_else(|| error(SliceError))?;
    let factories = Arc::new(Factories::new(planners, policies)?.with_programs(programs(py, trust)));
    let mut plan = BatchPlan::read(&folder).map_err(error)?;
    // The code that this worker has is what counts: a worker with another version of it is refused below.
    factories.sign(py, &mut plan, version)?;
    interruptible(py, &factories, jobs, |interruption| {
        let mut batch = library::execute::Batch::resume(OutputFolder::existing(&folder)?, slice)?;
        batch.plan().expect_same(&plan, &folder)?;
        let found = batch.progress().stored();
        run_missing(&mut batch, &factories, jobs, interruption)?;
        Ok(found)
    })
}

/// Reads a finished batch from its folder.
///
/// Parameters
/// ----------
/// folder : path
///     The output folder of `batch` or ``wildfire batch``.
///
/// Raises
/// ------
/// WildfireError
///     There is no batch, or some of its runs are missing.
#[pyfunction]
#[pyo3(signature = (folder, /))]
pub fn read_batch(py: Python<'_>, folder: PathBuf) -> PyResult<Batch> {
    let plan = BatchPlan::read(&folder).map_err(error)?;
    let folder = OutputFolder::existing(&folder).map_err(error)?;
    let read = py.detach(|| with_threads(1, || read_report(&plan, &folder)));
    let report = read.and_then(|read| read).map_err(error)?;
    Ok(Batch { plan, folder, scratch: None, report, was_read: true })
}

/// Returns the requested number of threads.
pub fn threads(jobs: isize) -> PyResult<usize> {
    match usize::try_from(jobs) {
        Ok(jobs) if (1..=MAX_JOBS).contains(&jobs) => Ok(jobs),
        _ if jobs == -1 => Ok(thread::available_parallelism().map_or(1, |cores| cores.get().min(MAX_JOBS))),
        _ => {
            Err(PyValueError::new_err(format!("jobs is {jobs}; expected 1 to {MAX_JOBS} threads, or -1 for all cores")))
        }
    }
}

impl RunsRequest<'_, '_> {
    /// Makes the plan: one per scenario, since each has its own changes.
    fn plan(&self, factories: &Factories) -> PyResult<BatchPlan> {
        let mut plans = Vec::new();
        for scenario in &self.scenarios {
            scenario.get().expect_registered(factories)?;
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
        // A refusal names one unknown name. Each gets a table once, so one that stays unknown ends the loop with its refusal.
        loop {
            let mut request = self.request(text, changes.clone())?;
            request.add_planners(&self.planners).map_err(error)?;
            match request.resolve(true) {
                Ok(plan) => return Ok(plan),
                Err(RequestError::Scenario(refusal)) => match &refusal.fault {
                    // Planners and policies passed in have no table yet.
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

    /// Tables identify scenarios by their names.
    fn expect_names_that_differ(&self) -> PyResult<()> {
        let mut names: Vec<&str> =
            self.scenarios.iter().map(|scenario| scenario.get().library().name.as_str()).collect();
        names.sort_unstable();
        let twice = names.windows(2).find(|pair| pair[0] == pair[1]);
        twice.map_or(Ok(()), |pair| {
            let sentence = "two scenarios are named `NAME`; rename one of them with `.with_({\"name\": ...})`, since \
                            tables could not tell them apart";
            Err(error(sentence.replace("NAME", pair[0])))
        })
    }
}

/// Reads seeds in the command line's notation, or as integers.
fn seeds_from(seeds: &Bound<'_, PyAny>) -> PyResult<Seeds> {
    if seeds.is_instance_of::<PyString>() {
        return seeds.extract::<String>()?.parse().map_err(error);
    }
    // The integers of numpy are none of Python's, but stand for one.
    let one = seeds.extract::<u64>();
    let numbers: Vec<u64> = if one.is_ok() || seeds.is_instance_of::<PyInt>() {
        vec![one?]
    } else {
        seeds
            .try_iter()
            .map_err(|_| PyTypeError::new_err("seeds are a string such as `1..50`, or integers"))?
            .map(|seed| seed?.extract())
            .collect::<PyResult<_>>()?
    };
    // Consecutive numbers form one range.
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

/// A batch that is spread over the workers of an executor.
struct SpreadBatch<'a, 'py> {
    executor: &'a Bound<'py, PyAny>,
    shards: u64,
}

impl<'a, 'py> SpreadBatch<'a, 'py> {
    fn new(executor: Option<&'a Bound<'py, PyAny>>, shards: Option<u64>) -> PyResult<Option<Self>> {
        match (executor, shards) {
            (None, None) => Ok(None),
            (Some(executor), Some(shards)) if Slice::new(1, shards).is_some() => Ok(Some(Self { executor, shards })),
            (Some(_), Some(shards)) => {
                Err(PyValueError::new_err(format!("shards is {shards}; expected a number from 1 to {MAX_SLICES}")))
            }
            _ => Err(PyValueError::new_err("expected `executor` and `shards` together, or neither of them")),
        }
    }

    /// Begins the first shard, so that the folder has the plan, and what does not go with it is refused here and at once.
    /// Returns the folder as workers find it.
    fn prepare(&self, plan: BatchPlan, path: &Path, factories: &Factories) -> PyResult<PathBuf> {
        let begin = || {
            let folder = match FinishedBatch::is_there(path) {
                true => OutputFolder::existing(path)?,
                false => OutputFolder::named(path, false)?,
            };
            let first = Slice::new(1, self.shards).expect("the number was checked before");
            library::execute::Batch::join(plan, folder, first)
        };
        begin().map_err(|refusal| refused(refusal, factories))?;
        // Workers may have another working directory.
        absolute(path).map_err(error)
    }

    /// Runs all shards, and returns how many of their runs were there before.
    fn run(&self, py: Python<'py>, path: &Path, rest: impl IntoPyObject<'py>) -> PyResult<u64> {
        let spread = py.import("wildfire_contest.executors")?.getattr("run_shards")?;
        spread.call1((self.executor, path, self.shards, rest))?.extract()
    }
}

/// Puts the shards of a batch together.
fn merged(py: Python<'_>, path: &Path, factories: &Factories, jobs: usize) -> PyResult<Merged> {
    interruptible(py, factories, jobs, |interruption| {
        merge(&OutputFolder::existing(path)?, &RealDisk, interruption.stop())
    })
}

/// Runs the missing runs of a folder and writes the tables. Also returns the number of runs that it held before.
fn run_to_its_end(
    py: Python<'_>,
    plan: BatchPlan,
    path: &Path,
    factories: &Arc<Factories>,
    jobs: usize,
) -> PyResult<(BatchReport, BatchPlan, u64)> {
    interruptible(py, factories, jobs, |interruption| {
        let batch = begin_or_go_on(plan, path)?;
        let found = batch.progress().stored();
        let run = simulation(&batch, factories, interruption);
        let played = batch.run_until(run, jobs, interruption.stop(), |_| {}, |_| {});
        end_runs(played.is_err(), interruption);
        let batch = played?.batch;
        let report = batch.finish(interruption.stop())?;
        Ok((report, batch.plan().clone(), found))
    })
}

/// Does work on threads of its own, which Ctrl-C and exceptions of the factories' code end.
fn interruptible<T: Send>(
    py: Python<'_>,
    factories: &Factories,
    jobs: usize,
    work: impl FnOnce(&Arc<Interruption>) -> Result<T, BatchError> + Send,
) -> PyResult<T> {
    let interruption: Arc<Interruption> = Arc::default();
    let ended = interruption.work_aside(py, || with_threads(jobs, || work(&interruption)).and_then(|done| done))?;
    // Ctrl-C after the last run does not throw a finished batch away.
    match (ended, interruption.take()) {
        (Ok(done), _) => Ok(done),
        (Err(BatchError::Stopped), Some(exception)) => Err(exception),
        (Err(refusal), _) => Err(refused(refusal, factories)),
    }
}

/// Makes the exception of a refusal, with advice where code that was registered may be the reason.
fn refused(refusal: BatchError, factories: &Factories) -> PyErr {
    match refusal {
        BatchError::Plan(PlanError::Differs { .. }) if !factories.is_empty() => {
            let advice =
                "if code has changed, use another folder, or pass `version=` in all calls if it plans the same";
            error(format_args!("{refusal} ({advice})"))
        }
        refusal => error(refusal),
    }
}

/// Runs what the journal of a batch, or of a shard, does not hold.
fn run_missing(
    batch: &mut library::execute::Batch,
    factories: &Arc<Factories>,
    jobs: usize,
    interruption: &Arc<Interruption>,
) -> Result<(), BatchError> {
    let run = simulation(batch, factories, interruption);
    let ran = batch.run_with(run, jobs, interruption.stop(), |_| {});
    end_runs(ran.is_err(), interruption);
    ran
}

/// Returns the function that simulates a run of a batch with planners and policies in Python.
fn simulation(
    batch: &library::execute::Batch,
    factories: &Arc<Factories>,
    interruption: &Arc<Interruption>,
) -> Box<RunScenario> {
    let memory = batch.plan().memory;
    let factories = Arc::clone(factories);
    let interruption = Arc::clone(interruption);
    Box::new(move |scenario, seed| {
        let run = interruption.run(|| {
            // Attaching the thread to Python for the whole run saves doing so in each query.
            Python::try_attach(|py| {
                let registry = factories.registry_of(py, Some(scenario), &interruption);
                let options = RunOptions { memory, ..registry.into() };
                py.detach(|| simulate(scenario, seed, &options, || interruption.is_set()))
            })
        });
        // A run that was never begun gets no row, so the batch runs it when it is continued.
        run.flatten().unwrap_or(Err(RunError::Stopped))
    })
}

/// Waits for the runs that are under way, which are to stop if something is wrong.
fn end_runs(is_wrong: bool, interruption: &Interruption) {
    if is_wrong {
        interruption.stop().store(true, Ordering::Relaxed);
    }
    interruption.wait_for_runs();
}

/// Starts a batch, or continues the same one where it was stopped.
fn begin_or_go_on(plan: BatchPlan, path: &Path) -> Result<library::execute::Batch, BatchError> {
    if path.is_dir() && FinishedBatch::is_there(path) {
        let found = BatchPlan::read(path)?;
        // One that its rule has stopped has fewer seeds.
        let stopped = if plan.until.is_some() { plan.shortened(&found.played()) } else { plan.clone() };
        // Where it is another batch, the refusal compares it with what was asked for, not with its shortened form.
        let is_stopped = stopped.content_sha256() == found.content_sha256();
        found.expect_same(if is_stopped { &stopped } else { &plan }, path)?;
        return library::execute::Batch::resume(OutputFolder::existing(path)?, Slice::WHOLE);
    }
    library::execute::Batch::begin(plan, OutputFolder::named(path, false)?)
}
