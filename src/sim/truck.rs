//! The fire truck: which fire next, the drive there, and the dwell that puts it out.
//!
//! A goal whose plan fails is set aside and the next is tried. When only such goals remain, the reachability flood
//! answers, and where it says yes the truck gets there: by a large lattice search from where it stands, by backing out
//! the way it came until its planner finds a path, or, if both fail, back along all its tracks to its start and from
//! there by the flood's own path.

use bevy::prelude::*;

use crate::collision::CollisionChecker;
use crate::geometry::{Cell, FieldFrame, Pose};
use crate::planning::reachability::Reachability;
use crate::planning::registry::Charge;
use crate::planning::{Effort, GoalDisc, PlanFailure, QueryMonitor, TruckPlanner, replan_around};
use crate::scenario::TruckGoal;
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{AgentFact, AgentId, Fact, RestReason};
use crate::trajectory::{Piece, SpeedLimits, Trajectory};
use crate::vehicle::{Dimensions, Path};

use super::AgentCost;
use super::agenda::{Agenda, Due, Rank};
use super::agent::{Activity, Agent, Log};
use super::situation::Situation;
use super::stage::Stage;
use super::tracks::Tracks;

/// Legs that a truck backs out of a pocket before it goes all the way back to its start.
const BACKED_OUT_LEGS: usize = 8;

/// Goals that a truck looks at in one decision though others are in the way to them.
const MOST_BLOCKED: usize = 3;

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
    pub charge: Charge,
    pub planner: Box<dyn TruckPlanner>,
    pub reachability: Reachability,
    /// Goals that the planner failed on, while they burn.
    pub set_aside: Vec<Cell>,
    /// Goals that the flood does not reach.
    pub out_of_reach: Vec<Cell>,
    pub tracks: Tracks,
    pub checker: CollisionChecker,
    /// What it would do if other trucks were not in the way, best first. Plans are kept, because it stands where it is.
    pub blocked: Vec<Blocked>,
    pub cost: AgentCost,
}

/// A drive that is planned, but for its time.
#[derive(Clone, Debug)]
pub struct Drive {
    pub goal: Cell,
    pub path: Path,
    /// Metres of the path that lead back over the truck's tracks.
    pub back_m: f64,
    pub effort: Effort,
    pub by_lattice: bool,
}

/// A drive that another truck is in the way of.
#[derive(Clone, Debug)]
pub struct Blocked {
    pub drive: Drive,
    pub by: AgentId,
}

impl Blocked {
    fn reason(&self) -> (Cell, AgentId) {
        (self.drive.goal, self.by)
    }
}

impl Truck {
    pub fn is_blocked(&self) -> bool {
        !self.blocked.is_empty()
    }

    fn disc(&self, frame: &FieldFrame, cell: Cell) -> GoalDisc {
        GoalDisc { centre: frame.centre(cell), radius_m: self.reach_m }
    }

    /// A drive to a goal as it was planned before, or by a new plan; or why there is none, and what that took.
    ///
    /// `spent` is the effort so far of this decision's plans that other trucks were in the way of; it is passed on.
    fn plan_again(
        &mut self,
        pose: Pose,
        goal: Cell,
        before: &[Blocked],
        situation: &Situation,
        spent: &mut Effort,
        log: &mut Log,
    ) -> Result<Drive, (PlanFailure, Effort)> {
        if let Some(known) = before.iter().find(|blocked| blocked.drive.goal == goal && !blocked.drive.by_lattice) {
            return Ok(known.drive.clone());
        }
        let mut monitor = QueryMonitor::new(log.records_searches);
        let plan = self.planner.plan_observed(pose, self.disc(situation.frame, goal).into(), &mut monitor);
        let (time, searched) = monitor.finish();
        self.cost.roadmap_search += time.roadmap;
        self.cost.local_search += time.local;
        *spent += plan.effort;
        log.add_searches(situation.now, self.cost.agent, searched);
        match plan.path {
            Ok(path) => Ok(Drive { goal, path, back_m: 0.0, effort: *spent, by_lattice: false }),
            Err(reason) => Err((reason, std::mem::take(spent))),
        }
    }

    fn plan_by_flood(&mut self, pose: Pose, goal: Cell, situation: &Situation) -> Option<Drive> {
        let mut clock = CpuStopwatch::start();
        let disc = self.disc(situation.frame, goal);
        let mut effort = Effort::default();
        let path = self.path_by_flood(pose, disc, &mut effort);
        self.cost.reachability += clock.lap();
        path.map(|(path, back_m)| Drive { goal, path, back_m, effort, by_lattice: true })
    }

    /// A path into a disc that the flood reaches, with the metres that lead back; `None` if the flood does not reach it.
    fn path_by_flood(&mut self, pose: Pose, disc: GoalDisc, effort: &mut Effort) -> Option<(Path, f64)> {
        let near = if disc.radius_m.is_finite() { disc } else { GoalDisc { radius_m: REACH_WITHOUT_RULE_M, ..disc } };
        if !self.reachability.reaches(near) {
            return None;
        }
        let (path, expansions) = self.reachability.search(pose, near);
        effort.local_expansions += expansions;
        let path = path.map(|path| (path, 0.0));
        // The planner keeps to the scenario's rule, so that it may end farther away where there is none.
        let path = path.or_else(|| self.by_backing_out(pose, disc, effort));
        path.or_else(|| self.by_way_of_the_start(pose, near))
    }

    /// Back along the truck's own tracks to where one of the last legs began, and planned from there: where it cannot
    /// turn it came in another way.
    fn by_backing_out(&mut self, pose: Pose, disc: GoalDisc, effort: &mut Effort) -> Option<(Path, f64)> {
        for legs in 1..=self.tracks.legs().min(BACKED_OUT_LEGS) {
            let plan = self.planner.plan(self.tracks.start_of_last(legs), disc.into());
            *effort += plan.effort;
            if let Ok(path) = plan.path {
                return Some(self.tracks.lead_back(pose, legs, path));
            }
        }
        None
    }

    /// Back along all tracks to the start, and from there into the disc by the flood's own path.
    fn by_way_of_the_start(&mut self, pose: Pose, disc: GoalDisc) -> Option<(Path, f64)> {
        let path = self.reachability.path_to(disc)?;
        Some(self.tracks.lead_back(pose, self.tracks.legs(), path))
    }

    /// The drive with its leg, as soon as the other trucks allow.
    fn set_off(&self, drive: Drive, situation: &Situation) -> Result<(Drive, Trajectory), Blocked> {
        let ready = situation.now + self.charge(&drive.effort);
        let leg = Trajectory::from_path(&drive.path, ready, self.speed);
        match situation.traffic.departure(&self.body, &leg) {
            Ok(leg) => Ok((drive, leg)),
            Err(by) => Err(Blocked { drive, by }),
        }
    }

    /// A drive to the same goal round the trucks that are in the way.
    fn go_round(&mut self, blocked: &Drive, situation: &Situation) -> Option<(Drive, Trajectory)> {
        let (path, spent) = self.detour(blocked, situation)?;
        let mut effort = blocked.effort;
        effort += spent;
        self.set_off(Drive { path, effort, ..blocked.clone() }, situation).ok()
    }

    fn detour(&mut self, drive: &Drive, situation: &Situation) -> Option<(Path, Effort)> {
        let disc = self.disc(situation.frame, drive.goal);
        if disc.radius_m.is_infinite() {
            return None;
        }
        let mut clock = CpuStopwatch::start();
        let traffic = situation.traffic;
        let leg = Trajectory::from_path(&drive.path, SimTime::ZERO, self.speed);
        let free_m = traffic.free_m(&self.body, &leg)?;
        let (path, spent) = replan_around(&traffic.crowd(&self.checker), &drive.path, free_m, disc);
        self.cost.local_search += clock.lap();
        Some((path?, spent))
    }

    pub fn charge(&self, effort: &Effort) -> SimTime {
        let Charge { roadmap_s, local_s } = self.charge;
        let seconds = roadmap_s * f64::from(effort.roadmap_expansions) + local_s * f64::from(effort.local_expansions);
        SimTime::from_seconds(seconds)
    }
}

/// Chooses a fire and sets out for it, keeps the one it has, waits for other trucks, or rests.
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
        // Something may have ignited just as it arrived.
        let is_on_its_way = agent.activity != Activity::Suppressing;
        if is_on_its_way && best != Some(goal) {
            let cut = situation.traffic.stopping(&truck.body, &agent.trajectory, now, truck.speed.braking_mps2);
            agent.break_off(entity, now, cut, agenda, log);
        }
        return;
    }
    agent.activity = Activity::Idle;
    truck.tracks.record(driven(&agent.trajectory));
    agent.trajectory = Trajectory::new(now, pose, Vec::new());
    let before = std::mem::take(&mut truck.blocked);
    match choose((agent.id, pose, truck), &before, situation, log) {
        Choice::Drive(drive, leg) => set_out((entity, agent, truck), now, drive, leg, agenda, log),
        Choice::Think(until) => agent.think_until(entity, until, agenda),
        Choice::Rest(reason) => agent.rest(now, reason, log),
        Choice::Wait(blocked) => {
            let (goal, by) = blocked[0].reason();
            if before.first().map(Blocked::reason) != Some((goal, by)) {
                log.add(now, Fact::Agent(agent.id, AgentFact::Blocked { goal, by }));
            }
            agent.rests = None;
            truck.blocked = blocked;
            agenda.add(now, Due::Standoff(agent.call(entity)));
        }
    }
}

/// What a truck without a goal does next.
enum Choice {
    Drive(Drive, Trajectory),
    /// A plan failed, and planning time is charged until then.
    Think(SimTime),
    /// Never empty.
    Wait(Vec<Blocked>),
    Rest(RestReason),
}

/// `before` are the drives that were blocked when the truck chose last; it has not moved since.
fn choose(
    (id, pose, truck): (AgentId, Pose, &mut Truck),
    before: &[Blocked],
    situation: &Situation,
    log: &mut Log,
) -> Choice {
    let now = situation.now;
    let centre = truck.body.body_centre(pose);
    let mut effort = Effort::default();
    let mut blocked: Vec<Blocked> = Vec::new();
    while blocked.len() < MOST_BLOCKED
        && let Some(goal) = situation.best(truck.policy, centre, |cell| {
            !truck.set_aside.contains(&cell) && blocked.iter().all(|blocked| blocked.drive.goal != cell)
        })
    {
        let drive = match truck.plan_again(pose, goal, before, situation, &mut effort, log) {
            Ok(drive) => drive,
            Err((reason, spent)) => {
                let until = now + truck.charge(&spent);
                truck.set_aside.push(goal);
                log.add(now, Fact::Agent(id, AgentFact::PlanFailed { goal, reason, effort: spent, until }));
                if until > now {
                    return Choice::Think(until);
                }
                continue;
            }
        };
        match truck.set_off(drive, situation) {
            Ok((drive, leg)) => return Choice::Drive(drive, leg),
            Err(behind) => blocked.push(behind),
        }
    }
    let Some(first) = blocked.first() else { return choose_by_flood((id, pose, truck), before, situation, log) };
    // Looking for a way round is dear: once for every truck that is in the way.
    let is_new = before.first().map(Blocked::reason) != Some(first.reason());
    match is_new.then(|| truck.go_round(&first.drive, situation)).flatten() {
        Some((drive, leg)) => Choice::Drive(drive, leg),
        None => Choice::Wait(blocked),
    }
}

/// Only goals that failed are left: those that the flood reaches can be driven to all the same.
fn choose_by_flood(
    (id, pose, truck): (AgentId, Pose, &mut Truck),
    before: &[Blocked],
    situation: &Situation,
    log: &mut Log,
) -> Choice {
    let now = situation.now;
    let centre = truck.body.body_centre(pose);
    while let Some(goal) = situation.best(truck.policy, centre, |cell| !truck.out_of_reach.contains(&cell)) {
        let known = before.iter().find(|blocked| blocked.drive.goal == goal && blocked.drive.by_lattice);
        let drive = known.map(|blocked| blocked.drive.clone()).or_else(|| truck.plan_by_flood(pose, goal, situation));
        if let Some(drive) = drive {
            return match truck.set_off(drive, situation) {
                Ok((drive, leg)) => Choice::Drive(drive, leg),
                Err(behind) => Choice::Wait(vec![behind]),
            };
        }
        truck.out_of_reach.push(goal);
        log.add(now, Fact::Agent(id, AgentFact::OutOfReach { cells: vec![goal] }));
    }
    let nothing_burns = situation.best(truck.policy, centre, |_| true).is_none();
    Choice::Rest(if nothing_burns { RestReason::NothingBurns } else { RestReason::NothingReachable })
}

pub fn set_out(
    (entity, agent, truck): (Entity, &mut Agent, &mut Truck),
    now: SimTime,
    drive: Drive,
    leg: Trajectory,
    agenda: &mut Agenda,
    log: &mut Log,
) {
    let Drive { goal, effort, by_lattice, back_m, .. } = drive;
    truck.tracks.set_out(back_m);
    log.add(now, Fact::Agent(agent.id, AgentFact::Planned { goal, trajectory: leg.clone(), effort, by_lattice }));
    agent.set_out(entity, now, goal, leg, agenda);
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
        stage.log.add(now, Fact::Agent(agent.id, AgentFact::Suppressing { cell }));
        let dwell = truck.expect("only trucks arrive").dwell;
        stage.agenda.add(now + dwell, Due::Extinction(agent.call(call.agent)));
    }
}
