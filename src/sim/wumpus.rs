//! The arsonist: which cell next, the walk there, and dropping a goal that is no longer worth it.
//!
//! A Wumpus that descends a potential field without an escape may end in a local minimum. There its goal counts as a
//! failed plan, and it turns to another one. Bushes are obstacles for the whole run, so the same descent from the same
//! point always ends the same: it never tries a goal twice from one point. Failed goals come again elsewhere, and when
//! all that it could light has failed from where it stands, it rests until something else can be lit.

use std::collections::BTreeSet;
use std::f64::consts::SQRT_2;

use bevy::prelude::*;
use glam::DVec2;

use crate::fire::FireField;
use crate::geometry::{Cell, FieldFrame, Pose, ops};
use crate::grid::open_list::{OpenList, Ranked};
use crate::planning::walk::{Walk, WalkLattice, WalkPlanner};
use crate::planning::{Effort, PlanFailure, QueryMonitor};
use crate::scenario::WumpusGoal;
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{AgentFact, AgentId, Fact, RestReason};
use crate::trajectory::{Piece, Trajectory};
use crate::vehicle::Segment;

use super::AgentCost;
use super::agenda::{Agenda, Due};
use super::agent::{Activity, Agent, Log};

/// A Wumpus's rules, its lattice, and where it stands on it.
#[derive(Component)]
pub struct Wumpus {
    pub reach_m: f64,
    pub policy: WumpusGoal,
    pub keeps_goal: bool,
    /// Seconds for an orthogonal step and for a diagonal one.
    pub step_times: (f64, f64),
    pub seconds_per_expansion: f64,
    pub lattice: WalkLattice,
    pub planner: WalkPlanner,
    /// The lattice point where it stands, or where its walk begins.
    pub point: usize,
    /// The walk's points, from `point` on.
    pub walk: Vec<usize>,
    /// Whether the walk ends at a local minimum.
    pub is_stuck: bool,
    /// Points and the goals to which no descent leads from there.
    pub failed: BTreeSet<(usize, Cell)>,
    /// The cells that it can approach; for `random-intact` in the order of its permutation.
    pub targets: Vec<Cell>,
    /// Where in `targets` the next random goal is looked for first.
    pub next_target: usize,
    pub cost: AgentCost,
}

impl Wumpus {
    /// What it could light and has not failed to approach from here, best first by the policy, ties by cell index;
    /// `trucks` are the trucks' body centres.
    fn candidates(&self, frame: &FieldFrame, fires: &FireField, trucks: &[DVec2]) -> OpenList<Candidate> {
        let here = self.lattice.position(self.point);
        let to_truck = |centre: DVec2| trucks.iter().map(|truck| (*truck - centre).length_squared()).reduce(f64::min);
        let mut candidates = OpenList::default();
        for (target, &cell) in self.targets.iter().enumerate() {
            if !fires.can_burn(cell) || self.has_failed(cell) {
                continue;
            }
            let centre = frame.centre(cell);
            let score = match (self.policy, to_truck(centre)) {
                // From where the last goal was found, so that cells which can burn again wait for their next turn.
                (WumpusGoal::RandomIntact, _) => {
                    ((target + self.targets.len() - self.next_target) % self.targets.len()) as f64
                }
                (WumpusGoal::FarthestFromTruck, Some(squared)) => -squared,
                (WumpusGoal::NearestIntact | WumpusGoal::FarthestFromTruck, _) => (centre - here).length_squared(),
            };
            candidates.push(Candidate { score, cell: frame.index(cell), target });
        }
        candidates
    }

    /// Whether it is known that no descent leads from here to this cell.
    pub fn has_failed(&self, cell: Cell) -> bool {
        self.failed.contains(&(self.point, cell))
    }

    /// Whether anything that it can approach can be lit.
    pub fn has_something_to_light(&self, fires: &FireField) -> bool {
        self.targets.iter().any(|&cell| fires.can_burn(cell))
    }

    /// The walk over lattice points as a trajectory; steps in one direction are one piece.
    fn trajectory(&self, start_time: SimTime, start: Pose, walk: &[usize]) -> Trajectory {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut facing = start.heading;
        for step in walk.windows(2) {
            let (from, to) = (self.lattice.position(step[0]), self.lattice.position(step[1]));
            let heading = ops::atan2(to.y - from.y, to.x - from.x);
            let length_m = self.lattice.step_length(step[0], step[1]);
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
            pieces.push(Piece::Drive {
                segment: Segment { curvature: 0.0, length_m },
                speed_mps: length_m / self.step_time(step[0], step[1]),
                acceleration_mps2: 0.0,
            });
        }
        Trajectory::new(start_time, start, pieces)
    }

    /// Planning time for so many expansions.
    fn charge(&self, expansions: u32) -> SimTime {
        SimTime::from_seconds(self.seconds_per_expansion * f64::from(expansions))
    }

    fn step_time(&self, from: usize, to: usize) -> f64 {
        let is_diagonal = self.lattice.step_length(from, to) > 1.2 * self.lattice.step_m();
        if is_diagonal { self.step_times.1 } else { self.step_times.0 }
    }
}

/// Seconds for an orthogonal and a diagonal step at a speed.
pub fn step_times_by_distance(step_m: f64, speed_mps: f64) -> (f64, f64) {
    (step_m / speed_mps, step_m * SQRT_2 / speed_mps)
}

/// A target that waits to be gone for.
struct Candidate {
    /// The least is the best.
    score: f64,
    /// Index of its cell.
    cell: usize,
    /// Place among the targets.
    target: usize,
}

impl Ranked for Candidate {
    type Tie = usize;

    fn priority(&self) -> f64 {
        self.score
    }

    fn cost(&self) -> f64 {
        0.0
    }

    fn tie(&self) -> usize {
        self.cell
    }
}

/// Chooses a goal and sets out for it, or rests. Planning times of goals that it fails to approach add up.
pub fn decide(
    (entity, agent, wumpus): (Entity, &mut Agent, &mut Wumpus),
    now: SimTime,
    (frame, fires, trucks): (&FieldFrame, &FireField, &[DVec2]),
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let mut clock = CpuStopwatch::start();
    let mut ready = now;
    let mut candidates = wumpus.candidates(frame, fires, trucks);
    while let Some(Candidate { target, .. }) = candidates.pop() {
        let goal = wumpus.targets[target];
        wumpus.next_target = target + 1;
        let mut monitor = QueryMonitor::new(log.records_searches);
        let walk = wumpus.planner.plan(&wumpus.lattice, wumpus.point, (goal, wumpus.reach_m), &mut monitor);
        wumpus.cost.local_search += clock.lap();
        ready += wumpus.charge(walk.expansions);
        log.add_searches(now, agent.id, monitor.finish().1);
        if !walk.is_stuck() || walk.minimum != Some(wumpus.point) {
            set_out((entity, agent, wumpus), (now, ready), (goal, walk), agenda, log);
            return;
        }
        fail(agent.id, wumpus, (now, ready), (goal, walk.expansions), log);
    }
    if ready > now {
        agent.think_until(entity, ready, agenda);
    } else if wumpus.has_something_to_light(fires) {
        agent.rest(now, RestReason::LocalMinima, log);
    } else {
        agent.rest(now, RestReason::NothingLeftToLight, log);
    }
}

fn set_out(
    (entity, agent, wumpus): (Entity, &mut Agent, &mut Wumpus),
    (now, ready): (SimTime, SimTime),
    (goal, walk): (Cell, Walk),
    agenda: &mut Agenda,
    log: &mut Log,
) {
    wumpus.is_stuck = walk.is_stuck();
    if wumpus.is_stuck {
        wumpus.failed.insert((wumpus.point, goal));
    } else if let Some(minimum) = walk.minimum {
        log_minimum(agent.id, wumpus, now, (goal, minimum), log);
    }
    wumpus.walk = walk.path.expect("targets are the cells that can be approached");
    let trajectory = wumpus.trajectory(ready, agent.trajectory.end(), &wumpus.walk);
    let effort = Effort { roadmap_expansions: 0, local_expansions: walk.expansions };
    log.add(
        now,
        Fact::Agent(agent.id, AgentFact::Planned { goal, trajectory: trajectory.clone(), effort, by_lattice: false }),
    );
    agent.set_out(entity, now, goal, trajectory, agenda);
    agenda.add(agent.trajectory.end_time(), Due::Lighting(agent.call(entity)));
}

/// Books a plan that failed because the Wumpus stands at a local minimum; its planning time is over at `until`.
fn fail(
    id: AgentId,
    wumpus: &mut Wumpus,
    (now, until): (SimTime, SimTime),
    (goal, expansions): (Cell, u32),
    log: &mut Log,
) {
    wumpus.failed.insert((wumpus.point, goal));
    log_minimum(id, wumpus, now, (goal, wumpus.point), log);
    let effort = Effort { roadmap_expansions: 0, local_expansions: expansions };
    log.add(now, Fact::Agent(id, AgentFact::PlanFailed { goal, reason: PlanFailure::LocalMinimum, effort, until }));
}

fn log_minimum(id: AgentId, wumpus: &Wumpus, now: SimTime, (goal, minimum): (Cell, usize), log: &mut Log) {
    let place = wumpus.lattice.position(minimum);
    log.add(now, Fact::Agent(id, AgentFact::LocalMinimum { goal, x_m: place.x, y_m: place.y }));
}

/// Gives a goal up at the local minimum where the walk ended: there it plans once more, which takes one expansion.
pub fn give_up(
    (entity, agent, wumpus): (Entity, &mut Agent, &mut Wumpus),
    now: SimTime,
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let goal = agent.goal.take().expect("a Wumpus walks to a goal");
    agent.activity = Activity::Idle;
    let ready = now + wumpus.charge(1);
    fail(agent.id, wumpus, (now, ready), (goal, 1), log);
    if ready > now {
        agent.think_until(entity, ready, agenda);
    } else {
        agent.reconsider(entity, now, agenda);
    }
}

/// The walk is over: the Wumpus stands on its last point.
pub fn arrive(wumpus: &mut Wumpus) {
    if let Some(&last) = wumpus.walk.last() {
        wumpus.point = last;
    }
    wumpus.walk.clear();
}

/// Drops a goal that is no longer intact: the Wumpus walks on to the next lattice point and decides there.
pub fn drop_goal(
    (entity, agent, wumpus): (Entity, &mut Agent, &mut Wumpus),
    now: SimTime,
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let cut = if agent.activity == Activity::Moving {
        let (start_time, start) = (agent.trajectory.start_time(), agent.trajectory.start());
        let prefix = |points: usize| wumpus.trajectory(start_time, start, &wumpus.walk[..points]);
        let points = (1..wumpus.walk.len()).find(|&points| prefix(points).end_time() >= now);
        let points = points.unwrap_or(wumpus.walk.len());
        let cut = prefix(points);
        wumpus.walk.truncate(points);
        cut
    } else {
        wumpus.walk.truncate(1);
        Trajectory::new(now, agent.trajectory.start(), Vec::new())
    };
    arrive(wumpus);
    agent.break_off(entity, now, cut, agenda, log);
}
