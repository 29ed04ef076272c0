//! Contests for learning: many side by side, stepped in one call, written into the same arrays.

use std::thread;

use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use wildfire::geometry::Cell;
use wildfire::picture::film::{FrameRenderer, FrameRequest, RunView, ViewOptions};
use wildfire::rng;
use wildfire::scenario::{Scenario, Sight as SightRules, TruckGoal, WumpusGoal};
use wildfire::sim::policies::dispatch::TeamSight;
use wildfire::sim::{Episode, Points, RunError, RunOptions};
use wildfire::time::SimTime;
use wildfire::timeline::AgentId;

use crate::errors::error;
use crate::observation::{AGENT_NUMBERS, AgentArrays, Layout, SharedArrays, Sight};
use crate::scenario::ScenarioLike;

/// The largest number of contests side by side.
const MAX_LANES: usize = 4096;

/// One of the contests side by side.
#[derive(Default)]
struct Lane {
    episode: Option<Episode>,
    /// The seed and all actions so far.
    history: History,
    /// The cells of each seat's candidates.
    candidates: Vec<Vec<Cell>>,
    points: Points,
    time: SimTime,
}

/// Everything that makes a contest what it is: played again, it gives the same.
#[derive(Clone, Default)]
struct History {
    seed: u64,
    /// The actions of all seats, step by step.
    actions: Vec<i64>,
    /// Futures that were drawn, each with the number of actions before.
    futures: Vec<(usize, u32)>,
}

/// The parts of the arrays that belong to one lane.
struct LaneSlice<'a> {
    shared: SharedArrays<'a>,
    action_mask: &'a mut [i8],
    candidates: &'a mut [f32],
    queried: &'a mut [bool],
    reward: &'a mut [f64],
    illegal: &'a mut [bool],
    dt_s: &'a mut f64,
    turn: &'a mut i64,
    ended: &'a mut bool,
}

/// What a lane does next.
#[derive(Clone, Copy)]
enum LaneTask<'a> {
    Stay,
    Reset(u64),
    Restore(&'a SavedContest, Option<u32>),
    Step(&'a [i64]),
}

impl Lane {
    /// Takes a contest up; what is in the arrays was another one's.
    fn begin(&mut self, episode: Episode, board: &mut LaneSlice<'_>) {
        (self.points, self.time) = (episode.points(), episode.now());
        board.shared.cells.fill(0);
        board.shared.burning_s.fill(0.0);
        board.action_mask.fill(0);
        board.illegal.fill(false);
        self.episode = Some(episode);
    }
}

/// The settings that lanes share.
struct LaneRules {
    scenario: Scenario,
    played: Vec<AgentId>,
    layout: Layout,
    /// True if observers see no more than the team of trucks, by the scenario's `[sight]`.
    by_sight: bool,
    /// True if all asked agents answer together, each in its own seat; otherwise one answers at a time.
    together: bool,
    /// A number of its own for scenario, agents and actions: a saved contest fits where it is the same.
    key: u64,
}

impl LaneRules {
    fn seats(&self) -> usize {
        if self.together { self.played.len() } else { 1 }
    }

    fn carry_out(&self, lane: &mut Lane, task: LaneTask<'_>, board: &mut LaneSlice<'_>) -> Result<(), RunError> {
        match task {
            LaneTask::Stay => return Ok(()),
            LaneTask::Reset(seed) => {
                lane.episode = None;
                let episode = Episode::new(&self.scenario, seed, &RunOptions::default(), &self.played)?;
                lane.history = History { seed, ..History::default() };
                lane.begin(episode, board);
            }
            LaneTask::Restore(saved, future) => {
                match &saved.episode {
                    Some(episode) => {
                        lane.history = saved.history.clone();
                        lane.begin(episode.fork(None)?, board);
                    }
                    None => self.play_again(&saved.history, lane, board)?,
                }
                if let (Some(future), Some(episode)) = (future, &lane.episode) {
                    let episode = episode.fork(Some(future))?;
                    lane.history.futures.push((lane.history.actions.len(), future));
                    lane.begin(episode, board);
                }
            }
            LaneTask::Step(actions) => {
                let Some(episode) = &mut lane.episode else { return Ok(()) };
                let mut choices = Vec::with_capacity(episode.pending().len());
                let rules = self.scenario.sight.clone().unwrap_or_default();
                let sight = self.sight_of(episode, &rules);
                for pending in episode.pending() {
                    let Some(seat) = self.seat_of(pending.agent) else { continue };
                    let candidates = lane.candidates.get(seat).map_or(&[][..], Vec::as_slice);
                    let action = usize::try_from(actions[seat]).unwrap_or(0);
                    let options = sight.visible_options(&pending.options);
                    let choice = self.layout.choice(action, episode.now(), &options, candidates);
                    board.illegal[seat] = choice.is_none();
                    choices.push((pending.agent, choice.unwrap_or_else(|| self.layout.waiting(episode.now()))));
                    if !self.together {
                        break;
                    }
                }
                drop(sight);
                episode.answer(&choices)?;
                lane.history.actions.extend(actions);
            }
        }
        self.observe(lane, board);
        Ok(())
    }

    fn sight_of<'a>(&'a self, episode: &'a Episode, rules: &'a SightRules) -> Sight<'a> {
        let (now, fires, agents) = (episode.now(), episode.fires(), episode.agents());
        let team = self.by_sight.then(|| TeamSight::new(rules, &self.layout.frame, now, fires, agents));
        Sight { now, fires, agents, team }
    }

    /// Plays a contest up to where it was saved.
    fn play_again(&self, history: &History, lane: &mut Lane, board: &mut LaneSlice<'_>) -> Result<(), RunError> {
        self.carry_out(lane, LaneTask::Reset(history.seed), board)?;
        let mut futures = history.futures.iter().copied().peekable();
        for step in 0..=history.actions.len() / self.seats() {
            while let Some((_, future)) = futures.next_if(|&(actions, _)| actions <= step * self.seats()) {
                lane.episode = lane.episode.as_ref().map(|episode| episode.fork(Some(future))).transpose()?;
            }
            if let Some(actions) = history.actions.chunks_exact(self.seats()).nth(step) {
                self.carry_out(lane, LaneTask::Step(actions), board)?;
            }
        }
        lane.history = history.clone();
        Ok(())
    }

    fn seat_of(&self, agent: AgentId) -> Option<usize> {
        if self.together { self.played.iter().position(|&played| played == agent) } else { Some(0) }
    }

    fn observe(&self, lane: &mut Lane, board: &mut LaneSlice<'_>) {
        let Some(episode) = &lane.episode else { return };
        let pending =
            if self.together { episode.pending() } else { &episode.pending()[..episode.pending().len().min(1)] };
        let rules = self.scenario.sight.clone().unwrap_or_default();
        let sight = self.sight_of(episode, &rules);
        sight.write(&self.layout, |id| pending.iter().any(|pending| pending.agent == id), &mut board.shared);
        lane.candidates.resize(self.seats(), Vec::new());
        let actions = self.layout.actions();
        let numbers = self.layout.candidate_numbers();
        for seat in 0..self.seats() {
            let entry = pending.iter().find(|pending| self.seat_of(pending.agent) == Some(seat));
            board.queried[seat] = entry.is_some();
            let mut arrays = AgentArrays {
                action_mask: &mut board.action_mask[seat * actions..(seat + 1) * actions],
                candidates: &mut board.candidates[seat * numbers..(seat + 1) * numbers],
            };
            let visible = entry.map(|pending| (pending.agent, sight.visible_options(&pending.options)));
            let options = visible.as_ref().map(|(agent, options)| (*agent, options.as_slice()));
            lane.candidates[seat] = sight.write_agent(&self.layout, options, &mut arrays);
            let viewer = self.played[seat];
            board.reward[seat] = episode.points().lead_of(viewer) - lane.points.lead_of(viewer);
        }
        let first = pending.first().and_then(|pending| self.played.iter().position(|&played| played == pending.agent));
        *board.turn = first.map_or(-1, |place| place as i64);
        *board.dt_s = episode.now().since(lane.time).as_seconds();
        *board.ended = episode.pending().is_empty();
        (lane.points, lane.time) = (episode.points(), episode.now());
    }
}

/// Arrays of all lanes, one after the other.
struct LaneArrays {
    cells: Py<PyArray1<u8>>,
    burning_s: Py<PyArray1<f32>>,
    agents: Py<PyArray1<f32>>,
    time_s: Py<PyArray1<f32>>,
    action_mask: Py<PyArray1<i8>>,
    candidates: Py<PyArray1<f32>>,
    queried: Py<PyArray1<bool>>,
    reward: Py<PyArray1<f64>>,
    illegal: Py<PyArray1<bool>>,
    dt_s: Py<PyArray1<f64>>,
    turn: Py<PyArray1<i64>>,
    ended: Py<PyArray1<bool>>,
}

fn zeros<T: Element>(py: Python<'_>, length: usize) -> Py<PyArray1<T>> {
    PyArray1::zeros(py, length, false).unbind()
}

/// A contest as it was when it was saved.
#[pyclass(module = "wildfire_contest._core", frozen)]
pub struct SavedContest {
    /// `None` after it was pickled.
    episode: Option<Episode>,
    history: History,
    /// The environments that it fits.
    played_in: u64,
}

#[pymethods]
impl SavedContest {
    #[new]
    fn new(seed: u64, actions: Vec<i64>, futures: Vec<(usize, u32)>, played_in: u64) -> Self {
        Self { episode: None, history: History { seed, actions, futures }, played_in }
    }

    /// Pickles its history; the contest is played again where it is restored.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let History { seed, actions, futures } = self.history.clone();
        (py.get_type::<Self>(), (seed, actions, futures, self.played_in)).into_pyobject(py)
    }
}

/// Contests of one scenario side by side, played from outside. Observations are written into the same arrays.
#[pyclass(module = "wildfire_contest")]
pub struct Contests {
    rules: LaneRules,
    lanes: Vec<Lane>,
    threads: usize,
    arrays: LaneArrays,
}

#[pymethods]
impl Contests {
    #[new]
    #[pyo3(signature = (scenario, lanes, play, *, together, nearest, wait_s, threads, by_sight))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn new(
        py: Python<'_>,
        scenario: ScenarioLike<'_>,
        lanes: usize,
        play: Vec<String>,
        together: bool,
        nearest: Option<usize>,
        wait_s: f64,
        threads: usize,
        by_sight: bool,
    ) -> PyResult<Self> {
        let scenario = scenario.load(py, Vec::new())?;
        let mut scenario = scenario.get().library().clone();
        if !(1..=MAX_LANES).contains(&lanes) {
            return Err(PyValueError::new_err(format!("n is {lanes}; expected 1 to {MAX_LANES}")));
        }
        if threads == 0 {
            return Err(PyValueError::new_err("threads is 0; expected 1 or more"));
        }
        if !(0.1..=1e6).contains(&wait_s) {
            return Err(PyValueError::new_err(format!("wait_s is {wait_s}; expected 0.1 to 1e6")));
        }
        if nearest.is_some_and(|max| !(1..=1000).contains(&max)) {
            return Err(PyValueError::new_err("k is outside of its range; expected 1 to 1000"));
        }
        let all = agents_of(&scenario);
        let played = play.iter().map(|name| agent_named(&all, name)).collect::<PyResult<Vec<AgentId>>>()?;
        if played.is_empty() {
            return Err(PyValueError::new_err("play is empty; expected some of the scenario's agents"));
        }
        if by_sight && played.iter().any(|agent| agent.role.lights()) {
            return Err(PyValueError::new_err(
                "observe=\"sight\" is what trucks see; expected play to name trucks only",
            ));
        }
        // A played agent follows no other policy.
        for &AgentId { role, number } in &played {
            if role.lights() {
                scenario.wumpus[usize::from(number)].goal = WumpusGoal::RandomIntact;
            } else {
                scenario.unimog[usize::from(number)].goal = TruckGoal::NearestBurning;
            }
        }
        let layout = Layout {
            frame: scenario.field.frame(),
            agents: all.len(),
            nearest,
            wait: SimTime::from_seconds(wait_s),
            duration: SimTime::from_seconds(scenario.duration_s),
        };
        let settings = format!("{scenario:?} {played:?} {nearest:?} {wait_s} {together} {by_sight}");
        let rules = LaneRules { scenario, played, layout, by_sight, together, key: rng::key(0, &settings) };
        let cells = lanes * rules.layout.frame.cell_count();
        let seats = lanes * rules.seats();
        let arrays = LaneArrays {
            cells: zeros(py, cells),
            burning_s: zeros(py, cells),
            agents: zeros(py, lanes * rules.layout.agents * AGENT_NUMBERS),
            time_s: zeros(py, lanes * 2),
            action_mask: zeros(py, seats * rules.layout.actions()),
            candidates: zeros(py, seats * rules.layout.candidate_numbers()),
            queried: zeros(py, seats),
            reward: zeros(py, seats),
            illegal: zeros(py, seats),
            dt_s: zeros(py, lanes),
            turn: zeros(py, lanes),
            ended: zeros(py, lanes),
        };
        let lanes = (0..lanes).map(|_| Lane::default()).collect();
        Ok(Self { rules, lanes, threads, arrays })
    }

    /// Names all agents of the scenario, played or not.
    #[getter]
    fn agents_named(&self) -> Vec<String> {
        agents_of(&self.rules.scenario).into_iter().map(name_of).collect()
    }

    #[getter]
    fn shape(&self) -> (u16, u16) {
        (self.rules.layout.frame.rows, self.rules.layout.frame.cols)
    }

    #[getter]
    fn actions(&self) -> usize {
        self.rules.layout.actions()
    }

    #[getter]
    fn cells(&self, py: Python<'_>) -> Py<PyArray1<u8>> {
        self.arrays.cells.clone_ref(py)
    }

    #[getter]
    fn burning_s(&self, py: Python<'_>) -> Py<PyArray1<f32>> {
        self.arrays.burning_s.clone_ref(py)
    }

    #[getter]
    fn agents(&self, py: Python<'_>) -> Py<PyArray1<f32>> {
        self.arrays.agents.clone_ref(py)
    }

    #[getter]
    fn time_s(&self, py: Python<'_>) -> Py<PyArray1<f32>> {
        self.arrays.time_s.clone_ref(py)
    }

    #[getter]
    fn action_mask(&self, py: Python<'_>) -> Py<PyArray1<i8>> {
        self.arrays.action_mask.clone_ref(py)
    }

    #[getter]
    fn candidates(&self, py: Python<'_>) -> Py<PyArray1<f32>> {
        self.arrays.candidates.clone_ref(py)
    }

    #[getter]
    fn asked(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.queried.clone_ref(py)
    }

    #[getter]
    fn reward(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.arrays.reward.clone_ref(py)
    }

    #[getter]
    fn illegal(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.illegal.clone_ref(py)
    }

    #[getter]
    fn dt_s(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.arrays.dt_s.clone_ref(py)
    }

    /// Holds the index, for each contest, of the played agent that answers next, or -1.
    #[getter]
    fn turn(&self, py: Python<'_>) -> Py<PyArray1<i64>> {
        self.arrays.turn.clone_ref(py)
    }

    #[getter]
    fn ended(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.ended.clone_ref(py)
    }

    /// Restarts contests, each with a seed; the others are unchanged.
    fn reset(&mut self, py: Python<'_>, resets: Vec<(usize, u64)>) -> PyResult<()> {
        let tasks = self.tasks(&resets, |_| LaneTask::Stay)?;
        self.carry_out(py, tasks)
    }

    /// Steps all contests, except those that it restarts. `actions` has a number for each seat.
    fn step(&mut self, py: Python<'_>, actions: PyReadonlyArray1<'_, i64>, resets: Vec<(usize, u64)>) -> PyResult<()> {
        let actions = actions.as_slice()?.to_vec();
        let seats = self.rules.seats();
        if actions.len() != self.lanes.len() * seats {
            let found = actions.len();
            let expected = self.lanes.len() * seats;
            return Err(PyValueError::new_err(format!("found {found} actions, expected {expected}")));
        }
        let is_action =
            |&action: &i64| usize::try_from(action).is_ok_and(|action| action < self.rules.layout.actions());
        if let Some(wrong) = actions.iter().find(|action| !is_action(action)) {
            let max = self.rules.layout.actions() - 1;
            return Err(PyValueError::new_err(format!("the action {wrong} is invalid; expected 0 to {max}")));
        }
        let is_reset = |lane: usize| resets.iter().any(|&(reset, _)| reset == lane);
        if (0..self.lanes.len()).any(|lane| self.lanes[lane].episode.is_none() && !is_reset(lane)) {
            return Err(PyIndexError::new_err("there is no contest to play yet: call reset first"));
        }
        let tasks = self.tasks(&resets, |lane| LaneTask::Step(&actions[lane * seats..(lane + 1) * seats]))?;
        self.carry_out(py, tasks)
    }

    /// Returns a copy of a contest as it is now.
    fn save(&self, lane: usize) -> PyResult<SavedContest> {
        let none = || PyIndexError::new_err("there is no contest to save yet: call reset first");
        let lane = self.lanes.get(lane).ok_or_else(none)?;
        let episode = lane.episode.as_ref().ok_or_else(none)?.fork(None).map_err(error)?;
        Ok(SavedContest { episode: Some(episode), history: lane.history.clone(), played_in: self.rules.key })
    }

    /// Makes a contest what it was when it was saved, with its own future or one that is drawn again by a number.
    #[pyo3(signature = (lane, saved, future=None))]
    fn restore(&mut self, py: Python<'_>, lane: usize, saved: &SavedContest, future: Option<u32>) -> PyResult<()> {
        if saved.played_in != self.rules.key {
            return Err(PyValueError::new_err("the contest was saved in an environment with other settings"));
        }
        if !saved.history.actions.len().is_multiple_of(self.rules.seats()) {
            return Err(PyValueError::new_err("the saved contest has actions for another number of agents"));
        }
        if lane >= self.lanes.len() {
            return Err(PyIndexError::new_err(format!("there is no contest {lane}")));
        }
        let tasks = (0..self.lanes.len()).map(|other| match other == lane {
            true => LaneTask::Restore(saved, future),
            false => LaneTask::Stay,
        });
        self.carry_out(py, tasks.collect())
    }

    /// Draws the current state of a contest: an array of height, width and red, green, blue.
    fn picture<'py>(&self, py: Python<'py>, lane: usize, size: (u32, u32)) -> PyResult<Bound<'py, PyAny>> {
        let episode = self
            .lanes
            .get(lane)
            .and_then(|lane| lane.episode.as_ref())
            .ok_or_else(|| PyIndexError::new_err("there is no contest to draw yet: call reset first"))?;
        let pixels = py.detach(|| {
            let view = RunView::new(episode.timeline(), None);
            let options = ViewOptions::default();
            let request = FrameRequest { runs: &[&view], time: episode.now(), options: &options };
            let mut renderer = FrameRenderer::new(size, 1);
            let rgba = renderer.paint(&request);
            rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect::<Vec<u8>>()
        });
        PyArray1::from_vec(py, pixels).call_method1("reshape", ((size.1, size.0, 3),))
    }

    /// Returns the number of facts so far, which distinguishes contests in tests.
    fn facts(&self, lane: usize) -> usize {
        self.lanes.get(lane).and_then(|lane| lane.episode.as_ref()).map_or(0, |episode| episode.facts().len())
    }
}

impl Contests {
    fn tasks<'a>(
        &self,
        resets: &[(usize, u64)],
        otherwise: impl Fn(usize) -> LaneTask<'a>,
    ) -> PyResult<Vec<LaneTask<'a>>> {
        let mut tasks: Vec<LaneTask<'a>> = (0..self.lanes.len()).map(otherwise).collect();
        for &(lane, seed) in resets {
            *tasks.get_mut(lane).ok_or_else(|| PyIndexError::new_err(format!("there is no contest {lane}")))? =
                LaneTask::Reset(seed);
        }
        Ok(tasks)
    }

    fn carry_out(&mut self, py: Python<'_>, tasks: Vec<LaneTask<'_>>) -> PyResult<()> {
        let Self { rules, lanes, threads, arrays } = self;
        let mut open = OpenArrays::new(py, arrays);
        let boards = open.boards(rules, lanes.len())?;
        let mut work: Vec<_> = lanes.iter_mut().zip(boards).zip(tasks).collect();
        let rules = &*rules;
        let done = py.detach(|| {
            let all = |work: &mut [((&mut Lane, LaneSlice<'_>), LaneTask<'_>)]| {
                work.iter_mut().try_for_each(|((lane, board), task)| rules.carry_out(lane, *task, board))
            };
            let share = work.len().div_ceil(*threads);
            if *threads == 1 || work.len() == 1 {
                return all(&mut work);
            }
            thread::scope(|scope| {
                let running: Vec<_> = work.chunks_mut(share).map(|part| scope.spawn(move || all(part))).collect();
                running.into_iter().try_for_each(|thread| thread.join().expect("a contest does not panic"))
            })
        });
        done.map_err(error)
    }
}

/// The arrays while they are written to.
struct OpenArrays<'py> {
    cells: PyReadwriteArray1<'py, u8>,
    burning_s: PyReadwriteArray1<'py, f32>,
    agents: PyReadwriteArray1<'py, f32>,
    time_s: PyReadwriteArray1<'py, f32>,
    action_mask: PyReadwriteArray1<'py, i8>,
    candidates: PyReadwriteArray1<'py, f32>,
    queried: PyReadwriteArray1<'py, bool>,
    reward: PyReadwriteArray1<'py, f64>,
    illegal: PyReadwriteArray1<'py, bool>,
    dt_s: PyReadwriteArray1<'py, f64>,
    turn: PyReadwriteArray1<'py, i64>,
    ended: PyReadwriteArray1<'py, bool>,
}

impl<'py> OpenArrays<'py> {
    fn new(py: Python<'py>, arrays: &LaneArrays) -> Self {
        Self {
            cells: arrays.cells.bind(py).readwrite(),
            burning_s: arrays.burning_s.bind(py).readwrite(),
            agents: arrays.agents.bind(py).readwrite(),
            time_s: arrays.time_s.bind(py).readwrite(),
            action_mask: arrays.action_mask.bind(py).readwrite(),
            candidates: arrays.candidates.bind(py).readwrite(),
            queried: arrays.queried.bind(py).readwrite(),
            reward: arrays.reward.bind(py).readwrite(),
            illegal: arrays.illegal.bind(py).readwrite(),
            dt_s: arrays.dt_s.bind(py).readwrite(),
            turn: arrays.turn.bind(py).readwrite(),
            ended: arrays.ended.bind(py).readwrite(),
        }
    }

    /// Divides the arrays among the lanes.
    fn boards(&mut self, rules: &LaneRules, lanes: usize) -> PyResult<Vec<LaneSlice<'_>>> {
        let (layout, seats) = (&rules.layout, rules.seats());
        let cells = layout.frame.cell_count();
        let mut cell_codes = self.cells.as_slice_mut()?.chunks_exact_mut(cells);
        let mut burning_s = self.burning_s.as_slice_mut()?.chunks_exact_mut(cells);
        let mut agents = self.agents.as_slice_mut()?.chunks_exact_mut(layout.agents * AGENT_NUMBERS);
        let mut time_s = self.time_s.as_slice_mut()?.chunks_exact_mut(2);
        let mut action_mask = self.action_mask.as_slice_mut()?.chunks_exact_mut(seats * layout.actions());
        // There may be no candidates, and no chunk is empty.
        let mut candidates =
            self.candidates.as_slice_mut()?.chunks_exact_mut((seats * layout.candidate_numbers()).max(1));
        let mut queried = self.queried.as_slice_mut()?.chunks_exact_mut(seats);
        let mut reward = self.reward.as_slice_mut()?.chunks_exact_mut(seats);
        let mut illegal = self.illegal.as_slice_mut()?.chunks_exact_mut(seats);
        let mut dt_s = self.dt_s.as_slice_mut()?.iter_mut();
        let mut turn = self.turn.as_slice_mut()?.iter_mut();
        let mut ended = self.ended.as_slice_mut()?.iter_mut();
        let boards = (0..lanes).map_while(|_| {
            Some(LaneSlice {
                shared: SharedArrays {
                    cells: cell_codes.next()?,
                    burning_s: burning_s.next()?,
                    agents: agents.next()?,
                    time_s: time_s.next()?,
                },
                action_mask: action_mask.next()?,
                candidates: candidates.next().unwrap_or_default(),
                queried: queried.next()?,
                reward: reward.next()?,
                illegal: illegal.next()?,
                dt_s: dt_s.next()?,
                turn: turn.next()?,
                ended: ended.next()?,
            })
        });
        Ok(boards.collect())
    }
}

/// Returns the names of a scenario's agents in environments.
#[pyfunction]
#[pyo3(name = "agents_of", signature = (scenario, /))]
pub fn named_agents(py: Python<'_>, scenario: ScenarioLike<'_>) -> PyResult<Vec<String>> {
    let scenario = scenario.load(py, Vec::new())?;
    Ok(agents_of(scenario.get().library()).into_iter().map(name_of).collect())
}

/// Lists the agents of a scenario, by name.
fn agents_of(scenario: &Scenario) -> Vec<AgentId> {
    let wumpuses = (0..scenario.wumpus.len()).map(|number| AgentId::wumpus(number as u16));
    wumpuses.chain((0..scenario.unimog.len()).map(|number| AgentId::unimog(number as u16))).collect()
}

/// Returns the name of an agent in environments, where a slash would read as a folder.
fn name_of(agent: AgentId) -> String {
    format!("{}_{}", agent.role.name(), agent.number)
}

fn agent_named(all: &[AgentId], name: &str) -> PyResult<AgentId> {
    all.iter().copied().find(|&agent| name_of(agent) == name).ok_or_else(|| {
        let names: Vec<String> = all.iter().copied().map(name_of).collect();
        PyValueError::new_err(format!("{name:?} is no agent of this scenario; its agents are {}", names.join(", ")))
    })
}
