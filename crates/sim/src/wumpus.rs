//! The arsonist: walking to a bush, lighting it, and dropping a goal that is no longer worthwhile.
//!
//! A Wumpus that descends a potential field without an escape may end in a local minimum. There its goal counts as a
//! failed plan, and it turns to another one. Bushes are obstacles for the whole run, so the same descent from the same
//! point always ends the same: it never tries a goal twice from one point. Failed goals come again elsewhere, and when
//! all that it could light has failed from where it stands, it rests until something else can be lit.

use std::collections::BTreeSet;
use std::f64::consts::SQRT_2;
use std::sync::Arc;
use std::time::Duration;

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use glam::DVec2;

use wildfire_base::geometry::{Cell, Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire_base::vehicle::Segment;
use wildfire_fire::FireField;
use wildfire_planning::walk::{Walk, WalkLattice};
use wildfire_planning::{Effort, PlanFailure, QueryMonitor};
use wildfire_scenario::{self as scenario, StepTime};
use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, Cause, RestReason};

use super::agent::{Activity, Agent, enlist};
use super::fire::Fires;
use super::options::RunError;
use super::policies::{Action, ActionMask, AgentView, PolicyId, PolicyQuery, PolicySet};
use super::queue::{AgentEvent, CellEvent, Due, SimClock, SimQueue};
use super::recorder::{CpuLog, Recorder};
use super::schedule::{Pass, SimSystems};
use super::wake::{Trigger, WakeTriggers};
use super::walk_lattices::{LatticePosition, Targets, WalkLattices, WalkPlannerId, WalkPlanners};

/// The plugin in which Wumpuses walk and light bushes.
#[derive(Debug)]
pub struct WumpusPlugin;

impl Plugin for WumpusPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, (lose_goal, light, decide).chain().in_set(SimSystems::Wumpus));
    }
}

/// A Wumpus's rules, its lattice, and its position on it.
#[derive(Component, Clone)]
pub struct Wumpus {
    reach_m: f64,
    /// Seconds for an orthogonal step and for a diagonal one.
    step_times: (f64, f64),
    seconds_per_expansion: f64,
    lattice: Arc<WalkLattice>,
    planner: WalkPlannerId,
    /// The lattice point where it stands, or where its walk begins.
    point: usize,
    /// The walk's points, from `point` on.
    walk: Vec<usize>,
    /// Whether the walk ends at a local minimum.
    is_stuck: bool,
    /// Points and the goals to which no descent leads from there.
    failed_goals: BTreeSet<(usize, Cell)>,
    targets: Arc<Targets>,
    deliberation: Option<WumpusDecision>,
}

/// A decision that is not yet made.
#[derive(Clone, Copy, Debug)]
struct WumpusDecision {
    /// The agent's revision when it began.
    revision: u32,
    /// When it may set out: planning times of goals that it failed to approach add up.
    ready: SimTime,
    /// What the agent's plans had cost before.
    cpu: Duration,
}

impl Wumpus {
    /// Lists what it could light and has not failed to approach from here, by cell index.
    fn options<'a>(&'a self, fires: &'a FireField) -> impl Iterator<Item = Cell> + 'a {
        self.targets.cells.iter().copied().filter(|&cell| self.may_light(cell, fires))
    }

    /// Returns whether a cell is one of its options.
    fn is_option(&self, cell: Cell, fires: &FireField) -> bool {
        self.may_light(cell, fires) && self.targets.contains(cell)
    }

    /// Returns whether one of its targets can be lit, and it has not failed to approach it from here.
    fn may_light(&self, target: Cell, fires: &FireField) -> bool {
        fires.can_burn(target) && !self.failed_goals.contains(&(self.point, target))
    }

    /// Returns true if it can light anything that it can approach.
    pub fn has_something_to_light(&self, fires: &FireField) -> bool {
        self.targets.cells.iter().any(|&cell| fires.can_burn(cell))
    }

    /// Returns the walk over lattice points as a trajectory; steps in one direction are one piece.
    fn trajectory(&self, start_time: SimTime, start: Pose, walk: &[usize]) -> Trajectory {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut facing = start.heading;
        for step in walk.windows(2) {
            let from = self.lattice.position(step[0]);
            let to = self.lattice.position(step[1]);
            let heading = ops::atan2(to.y - from.y, to.x - from.x);
            let length_m = self.lattice.step_length(step[0], step[1]);
            // Steps in one direction make one piece, so that recordings hold turns and not steps.
            if heading == facing
                && let Some(Piece::Drive { segment, .. }) = pieces.last_mut()
            {
                segment.length_m += length_m;
                continue;
            }
            if heading != facing {
                pieces.push(Piece::Turn { heading });
                facing = heading;
            }
            // Between 1 and the square root of 2 steps, far from rounding.
            let is_diagonal = length_m > 1.2 * self.lattice.step_m();
            let step_s = if is_diagonal { self.step_times.1 } else { self.step_times.0 };
            pieces.push(Piece::Drive {
                segment: Segment { curvature: 0.0, length_m },
                speed_mps: length_m / step_s,
                acceleration_mps2: 0.0,
            });
        }
        Trajectory::new(start_time, start, pieces)
    }

    /// Returns the planning time that is charged for this number of expansions.
    fn charge(&self, expansions: u32) -> SimTime {
        SimTime::from_seconds(self.seconds_per_expansion * f64::from(expansions))
    }

    /// Ends its walk: it stands on the last point.
    fn arrive(&mut self) {
        if let Some(&last) = self.walk.last() {
            self.point = last;
        }
        self.walk.clear();
    }
}

/// Places a Wumpus on the free point of its lattice that is nearest to its start.
pub fn spawn(
    world: &mut World,
    grounds: &mut WalkLattices<'_>,
    number: u16,
    settings: &scenario::Wumpus,
) -> Result<AgentStart, RunError> {
    let id = AgentId::wumpus(number);
    let start = DVec2::from(settings.start_m);
    let LatticePosition { lattice, point, targets, planner } =
        grounds.place(settings).ok_or(RunError::NoFreeStart { agent: id })?;
    let step_m = lattice.step_m();
    let here = lattice.position(point);
    let mut recorder = world.resource_mut::<Recorder>();
    // On cell centres a start anywhere in a cell means that cell; only a move to another one is worth a word.
    if (here - start).abs().max_element() > 0.5 * step_m * (1.0 + 1e-9) {
        let from = Pose::new(start.x, start.y, 0.0);
        recorder.record_agent(SimTime::ZERO, id, AgentFact::StartMoved { from });
    }
    // Known at the start: the lattice does not change in a run.
    if !targets.walled_in.is_empty() {
        recorder.record_agent(SimTime::ZERO, id, AgentFact::OutOfReach { cells: targets.walled_in.clone() });
    }
    let orthogonal_s = step_m / settings.speed_mps;
    let diagonal_s = step_m * SQRT_2 / settings.speed_mps;
    // Where diagonal steps take no longer than others, they are faster than its speed.
    let (step_times, fastest) = match settings.step_time {
        StepTime::Distance => ((orthogonal_s, diagonal_s), settings.speed_mps),
        StepTime::Uniform => ((orthogonal_s, orthogonal_s), settings.speed_mps * SQRT_2),
    };
    let wumpus = Wumpus {
        reach_m: settings.reach_m,
        step_times,
        seconds_per_expansion: settings.seconds_per_expansion,
        lattice,
        planner,
        point,
        walk: Vec::new(),
        is_stuck: false,
        failed_goals: BTreeSet::new(),
        targets,
        deliberation: None,
    };
    let mut triggers = vec![Trigger::FuelWhileResting, Trigger::ChangeWhileWaiting];
    triggers.extend((!settings.keep_goal).then_some(Trigger::GoalIgnited));
    // Policies are made before the agents.
    let follows = world.resource::<PolicySet>().policy_of(id);
    let agent = Agent::standing(id, Body::Square { size_m: settings.size_m }, Pose::new(here.x, here.y, 0.0));
    // It turns on the spot instead of walking backwards, so it has no speed in reverse.
    Ok(enlist(world, agent, SpeedLimits::new(fastest, 0.0), (wumpus, WakeTriggers(triggers), follows)))
}

/// One Wumpus while something is due for it.
struct Turn<'a> {
    entity: Entity,
    agent: &'a mut Agent,
    wumpus: &'a mut Wumpus,
    now: SimTime,
    queue: &'a mut SimQueue,
    recorder: &'a mut Recorder,
}

impl Turn<'_> {
    /// Walks to a goal, or fails to approach it; then it may choose again. `ready` is when it may set out, and is put
    /// off by what the plan takes. Returns true if it sets out.
    fn try_goal(&mut self, goal: Cell, ready: &mut SimTime, planners: &WalkPlanners) -> bool {
        let Self { agent, wumpus, now, recorder, .. } = self;
        let mut stopwatch = CpuStopwatch::start();
        let mut monitor = QueryMonitor::new(recorder.records_searches);
        let walk =
            planners.lock(wumpus.planner).plan(&wumpus.lattice, wumpus.point, goal, wumpus.reach_m, &mut monitor);
        agent.cost.local_search += stopwatch.elapsed_since_last();
        *ready += wumpus.charge(walk.expansions);
        recorder.record_searches(*now, agent.id, monitor.finish().searches);
        // A descent that ends where it begins is no walk; one that leads anywhere is walked to its end.
        if walk.is_stuck() && walk.minimum == Some(wumpus.point) {
            self.fail(goal, walk.expansions, *ready);
            return false;
        }
        self.set_out(goal, walk, *ready);
        true
    }

    fn set_out(&mut self, goal: Cell, walk: Walk, ready: SimTime) {
        self.wumpus.is_stuck = walk.is_stuck();
        // From this point the same descent would end in the same minimum.
        if self.wumpus.is_stuck {
            self.wumpus.failed_goals.insert((self.wumpus.point, goal));
        } else if let Some(minimum) = walk.minimum {
            self.record_minimum(goal, minimum);
        }
        let Self { entity, agent, wumpus, now, queue, recorder } = self;
        wumpus.walk = walk.path.expect("targets are the cells that can be approached");
        let trajectory = wumpus.trajectory(ready, agent.trajectory.end(), &wumpus.walk);
        let effort = Effort { roadmap_expansions: 0, local_expansions: walk.expansions };
        let fact = AgentFact::Planned { goal, trajectory: trajectory.clone(), effort, found_by: None };
        agent.answer(*now, fact, recorder);
        agent.set_out(*entity, *now, goal, trajectory, AgentEvent::Lighting, queue);
    }

    /// Books a plan that failed because the Wumpus stands at a local minimum; its planning time is over at `until`.
    fn fail(&mut self, goal: Cell, expansions: u32, until: SimTime) {
        self.wumpus.failed_goals.insert((self.wumpus.point, goal));
        self.record_minimum(goal, self.wumpus.point);
        let effort = Effort { roadmap_expansions: 0, local_expansions: expansions };
        let fact = AgentFact::PlanFailed { goal, reason: PlanFailure::LocalMinimum, effort, until };
        self.agent.answer(self.now, fact, self.recorder);
    }

    fn record_minimum(&mut self, goal: Cell, minimum: usize) {
        let place = self.wumpus.lattice.position(minimum);
        let fact = AgentFact::LocalMinimum { goal, x_m: place.x, y_m: place.y };
        self.recorder.record_agent(self.now, self.agent.id, fact);
    }

    /// Gives a goal up at the local minimum where the walk ended: there it plans once more, which takes one expansion.
    fn give_up(&mut self, goal: Cell) {
        let ready = self.now + self.wumpus.charge(1);
        self.fail(goal, 1, ready);
        if ready > self.now {
            self.agent.wait_until(self.entity, ready, self.queue);
        } else {
            self.agent.reconsider(self.entity, self.now, self.queue);
        }
    }

    /// Drops its goal: it walks on to the next lattice point and decides there.
    fn drop_goal(&mut self) {
        let Self { entity, agent, wumpus, now, queue, recorder } = self;
        let cut = if agent.activity == Activity::Moving {
            let start_time = agent.trajectory.start_time();
            let start = agent.trajectory.start();
            let prefix = |points: usize| wumpus.trajectory(start_time, start, &wumpus.walk[..points]);
            // It goes on to the next point of the lattice, as it can only decide on one.
            let points = (1..wumpus.walk.len()).find(|&points| prefix(points).end_time() >= *now);
            let points = points.unwrap_or(wumpus.walk.len());
            let cut = prefix(points);
            wumpus.walk.truncate(points);
            cut
        } else {
            wumpus.walk.truncate(1);
            Trajectory::new(*now, agent.trajectory.start(), Vec::new())
        };
        wumpus.arrive();
        agent.drop_goal(*entity, *now, cut, queue, recorder);
    }

    /// Carries out what its policy chose. If that fails it is asked again, with what it learned in mind.
    fn act(mut self, choice: Action, fires: &FireField, planners: &WalkPlanners, cpu_log: &mut CpuLog) {
        let Self { agent, wumpus, now, .. } = &mut self;
        // A state of another revision belongs to a decision that was overtaken.
        let state = wumpus.deliberation.take().filter(|state| state.revision == agent.revision);
        let WumpusDecision { mut ready, cpu, .. } =
            state.unwrap_or(WumpusDecision { revision: agent.revision, ready: *now, cpu: agent.cost.total() });
        match choice {
            Action::Go(goal) if wumpus.is_option(goal, fires) => {
                // The decision goes on with what it has cost so far.
                if !self.try_goal(goal, &mut ready, planners) {
                    self.wumpus.deliberation = Some(WumpusDecision { revision: self.agent.revision, ready, cpu });
                    return;
                }
            }
            _ if wumpus.options(fires).next().is_none() => self.stand(ready, fires),
            _ => {
                let (entity, now) = (self.entity, self.now);
                self.agent.wait(entity, now, choice.until(), self.queue, self.recorder);
            }
        }
        cpu_log.add(self.now, self.agent.id, self.agent.cost.total() - cpu);
    }

    /// Stands without an option: while planning time is charged for what it failed on, or until something wakes it.
    fn stand(&mut self, ready: SimTime, fires: &FireField) {
        if ready > self.now {
            self.agent.wait_until(self.entity, ready, self.queue);
        } else if self.wumpus.has_something_to_light(fires) {
            self.agent.rest(self.now, RestReason::LocalMinima, self.recorder);
        } else {
            self.agent.rest(self.now, RestReason::NothingLeftToLight, self.recorder);
        }
    }
}

/// Wumpuses drop goals that are no longer intact.
fn lose_goal(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    mut recorder: ResMut<Recorder>,
    mut wumpuses: Query<(&mut Agent, &mut Wumpus)>,
) {
    while let Some(wake) = queue.take_for(clock.0, AgentEvent::GoalLost, |entity| wumpuses.contains(entity)) {
        let (mut agent, mut wumpus) = wumpuses.get_mut(wake.agent).expect("the entity is a Wumpus");
        let (entity, now) = (wake.agent, clock.0);
        let (agent, wumpus) = (&mut *agent, &mut *wumpus);
        Turn { entity, agent, wumpus, now, queue: &mut queue, recorder: &mut recorder }.drop_goal();
    }
}

/// Wumpuses that are within reach of their goals light them, or give them up at a local minimum.
fn light(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    mut recorder: ResMut<Recorder>,
    mut wumpuses: Query<(&mut Agent, &mut Wumpus)>,
) {
    while let Some(wake) = queue.take_for(clock.0, AgentEvent::Lighting, |_| true) {
        let Ok((mut agent, mut wumpus)) = wumpuses.get_mut(wake.agent) else { continue };
        // It changed its plans on the way.
        if agent.revision != wake.revision {
            continue;
        }
        wumpus.arrive();
        let goal = agent.goal.take().expect("a Wumpus walks to a goal");
        agent.activity = Activity::Idle;
        if wumpus.is_stuck {
            let (entity, now) = (wake.agent, clock.0);
            let (agent, wumpus) = (&mut *agent, &mut *wumpus);
            Turn { entity, agent, wumpus, now, queue: &mut queue, recorder: &mut recorder }.give_up(goal);
        } else {
            agent.reconsider(wake.agent, clock.0, &mut queue);
            queue.push(clock.0, Due::Cell(CellEvent::Ignite { cell: goal, cause: Cause::Agent(agent.id) }));
        }
    }
}

/// The options of Wumpuses, who are found by their entities.
struct OptionsOfWumpuses<'a, Find> {
    find: Find,
    fires: &'a FireField,
}

impl<'a, Find: Fn(Entity) -> Option<&'a Wumpus>> ActionMask<Entity> for OptionsOfWumpuses<'a, Find> {
    fn list(&self, entity: Entity) -> Vec<Cell> {
        (self.find)(entity).map_or(Vec::new(), |wumpus| wumpus.options(self.fires).collect())
    }

    fn contains(&self, entity: Entity, cell: Cell) -> bool {
        (self.find)(entity).is_some_and(|wumpus| wumpus.is_option(cell, self.fires))
    }
}

/// Wumpuses whose turn it is go where their policies say, or rest.
fn decide(
    clock: Res<SimClock>,
    fires: Res<Fires>,
    (mut queue, mut recorder, mut cpu_log): (ResMut<SimQueue>, ResMut<Recorder>, ResMut<CpuLog>),
    (mut following, planners): (ResMut<PolicySet>, Res<WalkPlanners>),
    mut wumpuses: Query<(&mut Agent, &mut Wumpus, &PolicyId)>,
    others: Query<&Agent, Without<Wumpus>>,
) {
    let (now, fires) = (clock.0, &fires.field);
    while let Some(wake) = queue.next_for(now, AgentEvent::Decision, |entity| wumpuses.contains(entity)) {
        let (agent, wumpus, &policy) = wumpuses.get(wake.agent).expect("the entity is a Wumpus");
        // Due for something that has changed since.
        if agent.revision != wake.revision {
            queue.drop_next();
            continue;
        }
        // Policies are asked only if there is something to choose.
        let choices = if wumpus.options(fires).next().is_none() {
            vec![(wake.agent, Action::Wait)]
        } else {
            // All that are due at this instant and follow this policy are asked together.
            let queried = queue.decisions(now).filter_map(|due| {
                let (agent, _, &follows) = wumpuses.get(due.agent).ok()?;
                (agent.revision == due.revision && follows == policy).then_some((agent.id, due.agent))
            });
            let queried: Vec<_> = queried.collect();
            let mut queried_ids: Vec<AgentId> = queried.iter().map(|&(id, _)| id).collect();
            queried_ids.sort_unstable();
            // Who decides stands on a point of the lattice; of others only the trajectory is known.
            let walkers = wumpuses.iter().map(|(agent, wumpus, _)| {
                let is_queried = queried_ids.binary_search(&agent.id).is_ok();
                let place = if is_queried { wumpus.lattice.position(wumpus.point) } else { agent.centre(now) };
                AgentView { place, ..agent.view(now) }
            });
            let others = others.iter().map(|agent| agent.view(now));
            let inquiry = PolicyQuery { now, fires, agents: walkers.chain(others).collect(), queried };
            let find = |entity| wumpuses.get(entity).ok().map(|(_, wumpus, _)| wumpus);
            following.ask(policy, inquiry, &OptionsOfWumpuses { find, fires })
        };
        // An external policy has not answered yet: the run pauses here.
        if choices.is_empty() {
            return;
        }
        // One after the other: `act` looks again whether the choice is still an option.
        for (entity, choice) in choices {
            let (mut agent, mut wumpus, _) = wumpuses.get_mut(entity).expect("a Wumpus was asked");
            let (agent, wumpus) = (&mut *agent, &mut *wumpus);
            let turn = Turn { entity, agent, wumpus, now, queue: &mut queue, recorder: &mut recorder };
            turn.act(choice, fires, &planners, &mut cpu_log);
        }
    }
}
