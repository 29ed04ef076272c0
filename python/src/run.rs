//! One run and its results.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use numpy::IntoPyArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use wildfire::batch::execute::{RunDetail, RunResult, RunRow};
use wildfire::batch::plan::{PLANNER_KEY, RunLabel, Value};
use wildfire::batch::report::RunObject;
use wildfire::batch::table::{FileColumn, Kind, RUN_COLUMNS, Unit, is_measured};
use wildfire::picture::Picture;
use wildfire::picture::film::{FrameLayout, FrameRenderer, FrameRequest, RunView, ViewOptions};
use wildfire::scenario as library;
use wildfire::sim::{self as library_sim, RunError, RunOptions, Simulation};
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::timeline::export::{FINEST_STEP_S, write_events};
use wildfire::timeline::{Outcome, Replay, RunIndex, Timeline, file};

use crate::columns::TableBuilder;
use crate::errors::{error, one_of};
use crate::interruption::Interruption;
use crate::planner::Factories;
use crate::program::programs;
use crate::scenario::{Pickled, ScenarioLike, restorer};
use crate::tables::Table;

/// The largest number of rows of a trace.
const MAX_TRACE_ROWS: f64 = 1e7;

/// A finished run with its outcome, tables and pictures.
///
/// Tables are `Columns`. Created by `run`.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Run {
    pub timeline: Timeline,
    row: RunRow,
    /// Created with the first picture.
    view: OnceLock<RunView>,
    messages: Vec<String>,
}

#[pymethods]
impl Run {
    /// Returns the name of the scenario.
    #[getter]
    fn scenario(&self) -> &str {
        &self.row.label.scenario
    }

    /// Returns the seed.
    #[getter]
    fn seed(&self) -> u64 {
        self.row.label.seed
    }

    /// Returns the outcome: the columns of ``runs.csv`` that are not measured.
    ///
    /// It is the same for the same scenario and seed on every machine.
    #[getter]
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = self.values(py, |name| !is_measured(name))?;
        py.import("wildfire_contest.outcome")?.getattr("Outcome")?.call1((values,))
    }

    /// Returns the measurements: CPU and real times in seconds, by column. They differ between repetitions.
    #[getter]
    fn measured<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.values(py, is_measured)
    }

    /// Returns notes for readers of the run's results.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.row.result.as_ref().map(wildfire::batch::report::notes).unwrap_or_default()
    }

    /// Returns the first 20 messages about failed queries of custom planners, such as why a path was rejected.
    #[getter]
    fn messages(&self) -> Vec<String> {
        self.messages.clone()
    }

    /// Returns a row per agent, with the columns of ``agents.csv``.
    #[getter]
    fn agents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Table::Agents.of_run(py, &self.row)
    }

    /// Returns a row per query to a planner, with the columns that ``wildfire schema planner-calls`` prints.
    #[getter]
    fn calls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Table::Calls.of_run(py, &self.row)
    }

    /// Returns the number of bushes in each state at every sixtieth of the duration.
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Table::States.of_run(py, &self.row)
    }

    /// Returns a row per event: ``t_s, event, agent, col, row, detail``.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        events(&self.timeline).map_err(error)?.finish(py)
    }

    /// Returns the position of every agent over time: ``t_s, agent, x_m, y_m, heading_rad, speed_mps, activity``.
    ///
    /// Parameters
    /// ----------
    /// step_s : float
    ///     Simulated seconds between two rows of an agent; the last row is at the end of the run.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The step is below a millisecond, or there would be more than ten million rows.
    #[pyo3(signature = (step_s = 0.1))]
    fn trace<'py>(&self, py: Python<'py>, step_s: f64) -> PyResult<Bound<'py, PyAny>> {
        let end = self.timeline.end_time();
        let rows = end.as_seconds() / step_s * self.timeline.setting.agents.len() as f64;
        if !(step_s.is_finite() && step_s >= FINEST_STEP_S && rows <= MAX_TRACE_ROWS) {
            let sentence = format!(
                "step_s is {step_s}; expected seconds, at least {FINEST_STEP_S}, and at most {MAX_TRACE_ROWS:e} rows"
            );
            return Err(PyValueError::new_err(sentence));
        }
        py.detach(|| trace(&self.timeline, step_s)).finish(py)
    }

    /// Draws the state of the run at a given time.
    ///
    /// Parameters
    /// ----------
    /// at_s : float
    ///     Simulated seconds; default: the end of the run.
    /// size : int or tuple of int
    ///     Width and height in pixels, or one number for both.
    ///
    /// Returns
    /// -------
    /// array of shape (height, width, 4), uint8
    ///     Red, green, blue and opacity of each pixel; the first row is the top one.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The time is outside the run, or the size is not allowed.
    #[pyo3(signature = (at_s = None, size = PictureSize::Side(1000)))]
    fn picture<'py>(&self, py: Python<'py>, at_s: Option<f64>, size: PictureSize) -> PyResult<Bound<'py, PyAny>> {
        let size @ (width, height) = match size {
            PictureSize::Side(side) => (side, side),
            PictureSize::Sides(width, height) => (width, height),
        };
        let max = FrameLayout::MAX_SIDE;
        let min_width = FrameLayout::MIN_WIDTH;
        let min_height = FrameLayout::MIN_HEIGHT;
        if !(min_width..=max).contains(&width) || !(min_height..=max).contains(&height) {
            let sentence = format!(
                "size is {size:?}; expected width and height in pixels from {min_width} x {min_height} to {max} x {max}"
            );
            return Err(PyValueError::new_err(sentence));
        }
        let end_s = self.timeline.end_time().as_seconds();
        let at_s = at_s.unwrap_or(end_s);
        if !(0.0..=end_s).contains(&at_s) {
            return Err(PyValueError::new_err(format!("at_s is {at_s}; expected 0 to {end_s}, the end of the run")));
        }
        let pixels = py.detach(|| self.pixels(SimTime::from_seconds(at_s), size));
        pixels.into_pyarray(py).call_method1("reshape", ((height, width, 4),))
    }

    /// Returns the object that ``wildfire run --json`` prints.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = serde_json::to_string(&RunObject::new(&self.row)).map_err(error)?;
        py.import("json")?.call_method1("loads", (json,))
    }

    /// Writes a recording of the run, which ``wildfire play``, ``render`` and ``audit`` read.
    ///
    /// Raises
    /// ------
    /// WildfireError
    ///     The file cannot be written.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| file::write(&self.timeline, &path))
            .map_err(|refusal| error(format_args!("cannot write {}: {refusal}", path.display())))
    }

    /// Shows the end of the run in a notebook.
    fn _repr_png_(&self, py: Python<'_>) -> Vec<u8> {
        py.detach(|| Picture::from_rgba(500, 500, self.pixels(self.timeline.end_time(), (500, 500))).to_png())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, RunParts>> {
        let bytes = file::encode(&self.timeline).map_err(error)?;
        let row = serde_json::to_string(&self.row).map_err(error)?;
        Ok((restorer(py, "_restored_run")?, (bytes, row, self.messages.clone())))
    }

    fn __repr__(&self) -> String {
        let ended_s = self.timeline.end_time().as_seconds();
        format!("<Run of {}, seed {}: ended after {ended_s} s>", self.row.label.scenario, self.row.label.seed)
    }
}

/// The pickled form of a run: its recording, its row as JSON, and its messages.
type RunParts = (Vec<u8>, String, Vec<String>);

/// The size of a picture in pixels.
enum PictureSize {
    Side(u32),
    Sides(u32, u32),
}

one_of!(PictureSize, "a size in pixels, or (width, height)", Self::Side, |(width, height)| Self::Sides(width, height));

impl Run {
    /// Returns the scenario and seed as a name.
    pub fn name(&self) -> String {
        format!("{}, seed {}", self.row.label.scenario, self.row.label.seed)
    }

    fn new(label: RunLabel, run: library_sim::Run) -> Self {
        let index = RunIndex::new(&run.timeline);
        let detail = RunDetail::new(&index, &run.answer_cpu);
        let result = RunResult { asks: run.asks, ..RunResult::new(Outcome::new(&run.timeline), run.cost) };
        let message = run.messages.to_string();
        let row = RunRow { detail, message, ..RunRow::done(label, result, Duration::ZERO) };
        Self { timeline: run.timeline, row, view: OnceLock::new(), messages: run.messages.first }
    }

    /// Draws the state of the run at a time: four bytes per pixel.
    fn pixels(&self, time: SimTime, size: (u32, u32)) -> Vec<u8> {
        let view = self.view.get_or_init(|| RunView::new(self.timeline.clone(), None));
        let request = FrameRequest { runs: &[view], time, options: &ViewOptions::default() };
        FrameRenderer::new(size, 1).paint(&request).to_vec()
    }

    /// Returns the values of selected columns of the run.
    fn values<'py>(&self, py: Python<'py>, is_wanted: impl Fn(&str) -> bool) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for column in RUN_COLUMNS.iter().filter(|column| is_wanted(column.name)) {
            match (column.value)(&self.row) {
                Value::Missing => values.set_item(column.name, py.None())?,
                Value::Count(count) => values.set_item(column.name, count)?,
                Value::Real(number) => values.set_item(column.name, number)?,
                Value::Text(text) => values.set_item(column.name, text)?,
                Value::Flag(flag) => values.set_item(column.name, flag)?,
            }
        }
        Ok(values)
    }
}

/// Restores a pickled run.
#[pyfunction]
#[pyo3(name = "_restored_run")]
pub fn restored_run(bytes: &[u8], row: &str, messages: Vec<String>) -> PyResult<Run> {
    let timeline = file::decode(bytes).map_err(error)?;
    Ok(Run { timeline, row: serde_json::from_str(row).map_err(error)?, view: OnceLock::new(), messages })
}

fn column(name: &'static str, kind: Kind, unit: Unit, description: &'static str) -> FileColumn {
    FileColumn { name: Cow::Borrowed(name), description: Cow::Borrowed(description), unit, kind, is_required: false }
}

/// Reads back the table that `wildfire run --events` writes.
fn events(timeline: &Timeline) -> Result<TableBuilder, Box<dyn std::error::Error>> {
    let mut bytes = Vec::new();
    write_events(timeline, &mut bytes)?;
    let mut table = TableBuilder::new([
        column("t_s", Kind::Real, Unit::Seconds, "simulated time"),
        column("event", Kind::Text, Unit::None, "kind of event"),
        column("agent", Kind::Text, Unit::None, "agent that caused it"),
        column("col", Kind::Count, Unit::None, "column of the cell, from the west"),
        column("row", Kind::Count, Unit::None, "row of the cell, from the south"),
        column("detail", Kind::Text, Unit::None, "pairs key=value separated by semicolons"),
    ]);
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    for line in reader.records() {
        let line = line?;
        let text = |place: usize| Some(line[place].to_owned()).filter(|text| !text.is_empty());
        let count = |place: usize| text(place).and_then(|digits| digits.parse::<u64>().ok());
        let time: f64 = line[0].parse()?;
        table.push([
            time.into(),
            text(1).into(),
            text(2).into(),
            count(3).into(),
            count(4).into(),
            line[5].to_owned().into(),
        ]);
    }
    Ok(table)
}

/// Builds the table that `wildfire run --trace` writes.
fn trace(timeline: &Timeline, step_s: f64) -> TableBuilder {
    let mut table = TableBuilder::new([
        column("t_s", Kind::Real, Unit::Seconds, "simulated time"),
        column("agent", Kind::Text, Unit::None, "the agent"),
        column(
            "x_m",
            Kind::Real,
            Unit::Metres,
            "position east of the south-west corner; for a truck, of its rear axle",
        ),
        column(
            "y_m",
            Kind::Real,
            Unit::Metres,
            "position north of the south-west corner; for a truck, of its rear axle",
        ),
        column("heading_rad", Kind::Real, Unit::None, "counter-clockwise from east"),
        column("speed_mps", Kind::Real, Unit::None, "never negative"),
        column("activity", Kind::Text, Unit::None, "current activity"),
    ]);
    let end = timeline.end_time();
    let mut replay = Replay::new(timeline);
    // Times are multiples of the step and not sums, whose rounding errors would grow with the run.
    let multiples = (0_u64..).map(|step| SimTime::from_seconds(step as f64 * step_s)).take_while(|&time| time < end);
    for time in multiples.chain([end]) {
        replay.seek(time);
        for agent in 0..timeline.setting.agents.len() {
            let state = replay.agent(agent);
            table.push([
                time.as_seconds().into(),
                state.id.to_string().into(),
                state.pose.x.into(),
                state.pose.y.into(),
                state.pose.heading.into(),
                state.speed_mps.into(),
                state.activity.name().to_owned().into(),
            ]);
        }
    }
    table
}

/// Runs a scenario with a seed.
///
/// Parameters
/// ----------
/// scenario : str, path or Scenario
///     Default: `contest`.
/// seed : int
///     From 0 to 2**64 - 1; determines everything random.
/// planner : str
///     The planner of all trucks; replaces the scenario's.
/// planners : mapping
///     Custom planners by name: callables that create one from a `Site`.
/// policies : mapping
///     Custom policies by name; see `wildfire_contest.policies`.
/// record : path
///     The file to write a recording to.
/// trust : bool
///     Whether programs named by the scenario may be started.
///
/// Raises
/// ------
/// ScenarioError
///     The scenario is invalid.
/// WildfireError
///     The run cannot take place: no room, too much memory, a planner that cannot be built.
#[pyfunction]
#[pyo3(signature = (
    scenario = None, seed = 1, *, planner = None, planners = None, policies = None, record = None, trust = false
))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword of Python")]
pub fn run(
    py: Python<'_>,
    scenario: Option<ScenarioLike<'_>>,
    seed: u64,
    planner: Option<String>,
    planners: Option<&Bound<'_, PyMapping>>,
    policies: Option<&Bound<'_, PyMapping>>,
    record: Option<PathBuf>,
    trust: bool,
) -> PyResult<Run> {
    let changes = planner.map(|name| format!("{PLANNER_KEY}={name}"));
    let scenario = ScenarioLike::or_contest(scenario).load(py, changes.into_iter().collect())?;
    let factories = Factories::new(planners, policies)?.with_programs(programs(py, trust));
    scenario.get().expect_registered(&factories)?;
    let library = scenario.get().library();
    let interruption: Arc<Interruption> = Arc::default();
    let options = RunOptions::from(factories.registry_of(py, Some(library), &interruption));
    // Python can be interrupted between two slices.
    let check =
        || Python::attach(|py| -> PyResult<()> { py.check_signals() }).map_err(|exception| interruption.set(exception));
    let simulate = || simulate(library, seed, &options, || check().is_err() || interruption.is_set());
    // Where no Python is called, nothing needs a second thread that supervises it.
    let run = if factories.is_empty() { py.detach(simulate) } else { interruption.work(py, simulate) };
    if let Some(exception) = interruption.take() {
        return Err(exception);
    }
    let run = run.map_err(error)?;
    let run = py.detach(|| Run::new(RunLabel::from_scenario(library, seed), run));
    record.map_or(Ok(()), |path| run.write(py, path))?;
    Ok(run)
}

/// Simulated seconds between two checks for a stop.
const SLICE_S: f64 = 10.0;

/// Runs a scenario with a seed, unless it is stopped early. The division of its time into slices does not affect the result.
pub fn simulate(
    scenario: &library::Scenario,
    seed: u64,
    options: &RunOptions,
    mut is_to_stop: impl FnMut() -> bool,
) -> Result<library_sim::Run, RunError> {
    let mut stopwatch = CpuStopwatch::start();
    let simulation = Simulation::with(scenario, seed, options);
    // If a planner ends the program while it is built, the run does not count as failed.
    if is_to_stop() {
        return Err(RunError::Stopped);
    }
    let mut simulation = simulation?;
    let slices = (1..).map(|slice| f64::from(slice) * SLICE_S).take_while(|&time_s| time_s < scenario.duration_s);
    for time in slices.map(SimTime::from_seconds).chain([SimTime::MAX]) {
        if is_to_stop() {
            return Err(RunError::Stopped);
        }
        simulation.advance_to(time);
    }
    // A planner that is asked after a stop fails at once, so a run that was stopped in its last slice is not what it seems.
    if is_to_stop() {
        return Err(RunError::Stopped);
    }
    simulation.expect_within_memory()?;
    let mut run = simulation.finish();
    run.cost.total = stopwatch.elapsed_since_last();
    Ok(run)
}
