//! The arsonist: which cell next, the walk there, and dropping a goal that is no longer worth it.

use std::f64::consts::SQRT_2;

use bevy::prelude::*;
use glam::DVec2;

use crate::fire::Vegetation;
use crate::geometry::{Cell, FieldFrame, Pose, ops};
use crate::grid::astar::AStar;
use crate::planning::Effort;
use crate::planning::walk::{WalkLattice, WalkSearch};
use crate::scenario::WumpusGoal;
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{Fact, RestReason};
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
    pub search: WalkSearch,
    pub seconds_per_expansion: f64,
    pub lattice: WalkLattice,
    pub memory: AStar,
    /// The lattice point where it stands, or where its walk begins.
    pub point: usize,
    /// The walk's points, from `point` on.
    pub walk: Vec<usize>,
    /// The cells that it can approach; for `random-intact` in the order of its permutation.
    pub targets: Vec<Cell>,
    /// Where in `targets` the next random goal is looked for first.
    pub next_target: usize,
    pub cost: AgentCost,
}

impl Wumpus {
    /// Goal by the policy, ties by cell index; `trucks` are the trucks' body centres.
    fn choose(&mut self, here: DVec2, frame: &FieldFrame, fires: &Vegetation, trucks: &[DVec2]) -> Option<Cell> {
        let open = self.targets.iter().copied().filter(|&cell| fires.can_burn(cell));
        let least = |score: &dyn Fn(Cell) -> f64| {
            open.clone()
                .map(|cell| (score(cell), cell))
                .min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| frame.index(a.1).cmp(&frame.index(b.1))))
        };
        let distance = |cell: Cell| (frame.centre(cell) - here).length_squared();
        match self.policy {
            WumpusGoal::RandomIntact => {
                // From where the last goal was found, so that cells which can burn again wait for their next turn.
                let (before, after) = self.targets.split_at(self.next_target);
                let found = after.iter().chain(before).position(|&cell| fires.can_burn(cell))?;
                let index = (self.next_target + found) % self.targets.len();
                self.next_target = index + 1;
                Some(self.targets[index])
            }
            WumpusGoal::NearestIntact => least(&distance).map(|(_, cell)| cell),
            WumpusGoal::FarthestFromTruck if trucks.is_empty() => least(&distance).map(|(_, cell)| cell),
            WumpusGoal::FarthestFromTruck => {
                let to_truck = |cell: Cell| {
                    let centre = frame.centre(cell);
                    trucks.iter().map(|truck| (*truck - centre).length_squared()).fold(f64::INFINITY, f64::min)
                };
                least(&|cell| -to_truck(cell)).map(|(_, cell)| cell)
            }
        }
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

    fn step_time(&self, from: usize, to: usize) -> f64 {
        let is_diagonal = self.lattice.step_length(from, to) > 1.2 * self.lattice.step_m();
        if is_diagonal { self.step_times.1 } else { self.step_times.0 }
    }
}

/// Seconds for an orthogonal and a diagonal step at a speed.
pub fn step_times_by_distance(step_m: f64, speed_mps: f64) -> (f64, f64) {
    (step_m / speed_mps, step_m * SQRT_2 / speed_mps)
}

/// Chooses a goal and sets out for it, or rests.
pub fn decide(
    (entity, agent, wumpus): (Entity, &mut Agent, &mut Wumpus),
    now: SimTime,
    (frame, fires, trucks): (&FieldFrame, &Vegetation, &[DVec2]),
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let here = wumpus.lattice.position(wumpus.point);
    let mut clock = CpuStopwatch::start();
    let Some(goal) = wumpus.choose(here, frame, fires, trucks) else {
        agent.rest(now, RestReason::NothingLeftToLight, log);
        return;
    };
    let found = wumpus.lattice.search(&mut wumpus.memory, wumpus.point, (goal, wumpus.reach_m), &wumpus.search);
    wumpus.cost.local_search += clock.lap();
    wumpus.walk = found.path.expect("targets are the cells that can be approached");
    let charged = SimTime::from_seconds(wumpus.seconds_per_expansion * f64::from(found.expansions));
    let trajectory = wumpus.trajectory(now + charged, agent.trajectory.end(), &wumpus.walk);
    log.add(
        now,
        Fact::Planned {
            agent: agent.id,
            goal,
            trajectory: trajectory.clone(),
            effort: Effort { roadmap_expansions: 0, local_expansions: found.expansions },
            by_lattice: false,
        },
    );
    agent.set_out(entity, now, goal, trajectory, agenda);
    agenda.add(agent.trajectory.end_time(), Due::Lighting(agent.call(entity)));
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
