//! The fire truck: which fire next, the drive there, and the dwell that puts it out.
//!
//! A goal whose plan fails is set aside and the next is tried. When only such goals remain, the reachability flood
//! answers, and where it says yes the truck gets there: by a large lattice search from where it stands, by backing out
//! the way it came until its planner finds a path, or, if both fail, back along all its tracks to its start and from
//! there by the flood's own path.

use bevy::prelude::*;
use glam::DVec2;

use crate::fire::Vegetation;
use crate::geometry::{Cell, FieldFrame, Pose};
use crate::planning::reachability::Reachability;
use crate::planning::{Effort, GoalDisc, TruckPlanner};
use crate::scenario::TruckGoal;
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{Fact, RestReason};
use crate::trajectory::{Piece, SpeedLimits, Trajectory};
use crate::vehicle::{Dimensions, Path};

use super::AgentCost;
use super::agenda::{Agenda, Due, Rank};
use super::agent::{Activity, Agent, Log};
use super::stage::Stage;
use super::tracks::Tracks;

/// Legs that a truck backs out of a pocket before it goes all the way back to its start.
const BACKED_OUT_LEGS: usize = 8;

/// Where a scenario has no rule of distance, the flood still drives this near to the fire: the contest's reach.
const REACH_WITHOUT_RULE_M: f64 = 10.0;

/// A truck's rules, its planners, and what it knows.
#[derive(Component)]
pub struct Truck {
    pub body: Dimensions,
    pub speed: SpeedLimits,
    pub policy: TruckGoal,
    /// Whether it reconsiders on its way whenever something ignites.
    pub retargets: bool,
    /// Infinite where the scenario has no rule of distance.
    pub reach_m: f64,
    pub dwell: SimTime,
    pub extinguishes_all: bool,
    /// Planning time charged for each expansion of the roadmap and of the local search.
    pub seconds_per_expansion: (f64, f64),
    pub planner: Box<dyn TruckPlanner>,
    pub reachability: Reachability,
    /// Goals that the planner failed on, while they burn.
    pub set_aside: Vec<Cell>,
    /// Goals that the flood does not reach.
    pub out_of_reach: Vec<Cell>,
    pub tracks: Tracks,
    pub cost: AgentCost,
}

impl Truck {
    fn disc(&self, frame: &FieldFrame, cell: Cell) -> GoalDisc {
        GoalDisc { centre: frame.centre(cell), radius_m: self.reach_m }
    }

    /// A drive into a disc that the flood reaches, and the effort it took; `None` if the flood does not reach it.
    fn drive_by_flood(&mut self, pose: Pose, disc: GoalDisc) -> (Option<Path>, Effort) {
        let mut effort = Effort::default();
        if !self.reachability.reaches(disc) {
            return (None, effort);
        }
        let (path, expansions) = self.reachability.search(pose, disc);
        effort.local_expansions += expansions;
        let path = path.or_else(|| self.by_backing_out(pose, disc, &mut effort));
        (path.or_else(|| self.by_way_of_the_start(pose, disc)), effort)
    }

    /// Back along the truck's own tracks to where one of the last legs began, and planned from there: where it cannot
    /// turn it came in another way.
    fn by_backing_out(&mut self, pose: Pose, disc: GoalDisc, effort: &mut Effort) -> Option<Path> {
        for legs in 1..=self.tracks.legs().min(BACKED_OUT_LEGS) {
            let plan = self.planner.plan(self.tracks.start_of_last(legs), disc.into());
            effort.roadmap_expansions += plan.effort.roadmap_expansions;
            effort.local_expansions += plan.effort.local_expansions;
            if let Ok(path) = plan.path {
                return Some(self.tracks.lead_back(pose, legs, path));
            }
        }
        None
    }

    /// Back along all tracks to the start, and from there into the disc by the flood's own path.
    fn by_way_of_the_start(&mut self, pose: Pose, disc: GoalDisc) -> Option<Path> {
        let path = self.reachability.path_to(disc)?;
        Some(self.tracks.lead_back(pose, self.tracks.legs(), path))
    }

    fn charge(&self, effort: &Effort) -> SimTime {
        let (roadmap, local) = self.seconds_per_expansion;
        let seconds = roadmap * f64::from(effort.roadmap_expansions) + local * f64::from(effort.local_expansions);
        SimTime::from_seconds(seconds)
    }
}

/// What a decision may look at.
pub struct Situation<'a> {
    pub now: SimTime,
    pub frame: &'a FieldFrame,
    pub fires: &'a Vegetation,
    /// Goals of the other trucks.
    pub claimed: &'a [Cell],
}

impl Situation<'_> {
    /// The best burning cell by a policy among those that `may` be chosen and that no other truck has.
    fn best(&self, policy: TruckGoal, centre: DVec2, may: impl Fn(Cell) -> bool) -> Option<Cell> {
        let open = self.fires.burning().filter(|cell| !self.claimed.contains(cell) && may(*cell));
        let distance = |cell: Cell| (self.frame.centre(cell) - centre).length_squared();
        let nearest = |a: &Cell, b: &Cell| distance(*a).total_cmp(&distance(*b));
        // Burning cells come by index and the first of equals wins, so ties go to the smaller index.
        match policy {
            TruckGoal::NearestBurning => open.min_by(nearest),
            TruckGoal::Oldest => open
                .min_by(|a, b| self.fires.ignited_at(*a).cmp(&self.fires.ignited_at(*b)).then_with(|| nearest(a, b))),
            TruckGoal::LargestCluster => {
                let sizes = cluster_sizes(self.frame, self.fires);
                let size = |cell: &Cell| sizes[self.frame.index(*cell)];
                open.min_by(|a, b| size(b).cmp(&size(a)).then_with(|| nearest(a, b)))
            }
        }
    }
}

/// By cell index: how many burning cells hang together with this burning cell over sides and corners.
fn cluster_sizes(frame: &FieldFrame, fires: &Vegetation) -> Vec<u32> {
    let mut sizes = vec![0; frame.cell_count()];
    for seed in fires.burning() {
        if sizes[frame.index(seed)] != 0 {
            continue;
        }
        let mut cluster = vec![seed];
        sizes[frame.index(seed)] = 1;
        let mut next = 0;
        while let Some(&cell) = cluster.get(next) {
            next += 1;
            for (cols, rows) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let Some(other) = frame.offset(cell, cols, rows) else { continue };
                if fires.is_burning(other) && sizes[frame.index(other)] == 0 {
                    sizes[frame.index(other)] = 1;
                    cluster.push(other);
                }
            }
        }
        for cell in &cluster {
            sizes[frame.index(*cell)] = cluster.len() as u32;
        }
    }
    sizes
}

/// Chooses a fire and sets out for it, keeps the one it has, or rests.
pub fn decide(
    (entity, agent, truck): (Entity, &mut Agent, &mut Truck),
    situation: &Situation,
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let now = situation.now;
    let pose = agent.trajectory.pose_at(now);
    let centre = truck.body.body_centre(pose);
    truck.set_aside.retain(|&cell| situation.fires.is_burning(cell));
    if let Some(goal) = agent.goal {
        // The goal may itself be one that the planner had set aside and the flood reached.
        let best = situation.best(truck.policy, centre, |cell| cell == goal || !truck.set_aside.contains(&cell));
        if best != Some(goal) {
            let cut = if agent.activity == Activity::Moving {
                agent.trajectory.stopping(now, truck.speed.braking_mps2)
            } else {
                Trajectory::new(now, pose, Vec::new())
            };
            agent.break_off(entity, now, cut, agenda, log);
        }
        return;
    }
    agent.activity = Activity::Idle;
    truck.tracks.record(driven(&agent.trajectory));
    agent.trajectory = Trajectory::new(now, pose, Vec::new());
    while let Some(goal) = situation.best(truck.policy, centre, |cell| !truck.set_aside.contains(&cell)) {
        let plan = truck.planner.plan(pose, truck.disc(situation.frame, goal).into());
        truck.cost.roadmap_search += plan.time.roadmap;
        truck.cost.local_search += plan.time.local;
        let ready = now + truck.charge(&plan.effort);
        match plan.path {
            Ok(path) => {
                set_out((entity, agent, truck), now, ready, (goal, path, plan.effort, false), agenda, log);
                return;
            }
            Err(reason) => {
                truck.set_aside.push(goal);
                log.add(now, Fact::PlanFailed { agent: agent.id, goal, reason, effort: plan.effort, until: ready });
                if ready > now {
                    agent.think_until(entity, ready, agenda);
                    return;
                }
            }
        }
    }
    decide_by_flood((entity, agent, truck), pose, situation, agenda, log);
}

/// Only goals that failed are left: those that the flood reaches can be driven to all the same.
fn decide_by_flood(
    (entity, agent, truck): (Entity, &mut Agent, &mut Truck),
    pose: Pose,
    situation: &Situation,
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let now = situation.now;
    let centre = truck.body.body_centre(pose);
    while let Some(goal) = situation.best(truck.policy, centre, |cell| !truck.out_of_reach.contains(&cell)) {
        let mut clock = CpuStopwatch::start();
        let mut disc = truck.disc(situation.frame, goal);
        if disc.radius_m.is_infinite() {
            disc.radius_m = REACH_WITHOUT_RULE_M;
        }
        let (path, effort) = truck.drive_by_flood(pose, disc);
        truck.cost.reachability += clock.lap();
        match path {
            Some(path) => {
                let ready = now + truck.charge(&effort);
                set_out((entity, agent, truck), now, ready, (goal, path, effort, true), agenda, log);
                return;
            }
            None => {
                truck.out_of_reach.push(goal);
                log.add(now, Fact::OutOfReach { agent: agent.id, cells: vec![goal] });
            }
        }
    }
    let nothing_burns = situation.best(truck.policy, centre, |_| true).is_none();
    let reason = if nothing_burns { RestReason::NothingBurns } else { RestReason::NothingReachable };
    agent.rest(now, reason, log);
}

fn set_out(
    (entity, agent, truck): (Entity, &mut Agent, &mut Truck),
    now: SimTime,
    ready: SimTime,
    (goal, path, effort, by_lattice): (Cell, Path, Effort, bool),
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let trajectory = Trajectory::along(&path, ready, truck.speed);
    log.add(now, Fact::Planned { agent: agent.id, goal, trajectory: trajectory.clone(), effort, by_lattice });
    agent.set_out(entity, now, goal, trajectory, agenda);
    agenda.add(agent.trajectory.end_time(), Due::Arrival(agent.call(entity)));
}

/// The path of a leg as it was driven.
fn driven(trajectory: &Trajectory) -> Option<Path> {
    let segments: Vec<_> = trajectory.pieces().iter().filter_map(Piece::segment).collect();
    (!segments.is_empty()).then(|| Path { start: trajectory.start(), segments })
}

/// Trucks that arrived begin to suppress.
pub fn arrive(mut stage: Stage) {
    while let Some(due) = stage.take(Rank::Arrival) {
        let Due::Arrival(call) = due else { unreachable!("ranks and events go together") };
        let now = stage.now();
        let (mut agent, _, truck) = stage.agents.get_mut(call.agent).expect("agents live for the whole run");
        if agent.revision != call.revision {
            continue;
        }
        agent.activity = Activity::Suppressing;
        let cell = agent.goal.expect("a truck drives to a goal");
        stage.log.add(now, Fact::Suppressing { agent: agent.id, cell });
        let dwell = truck.expect("only trucks arrive").dwell;
        stage.agenda.add(now + dwell, Due::Extinction(agent.call(call.agent)));
    }
}
