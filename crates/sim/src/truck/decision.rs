//! A truck's decision: it asks its policy for a fire until it can set out for one, has to wait for other trucks, or has
//! no option left.

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use glam::DVec2;

use super::drive::{Departure, DepartureContext};
use super::{BlockReason, Blocked, DecisionState, Drive, Fleet, Truck};
use crate::agent::{Activity, Agent};
use crate::fire::Fires;
use crate::policies::{Action, PolicyId, PolicyQuery, PolicyScope, PolicySet};
use crate::queue::AgentEvent;
use crate::recorder::CpuLog;
use crate::traffic::Traffic;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, Trajectory};
use wildfire_base::vehicle::Path;
use wildfire_fire::FireField;
use wildfire_planning::{Effort, FoundBy};
use wildfire_scenario::{Detours, TrafficPlan};
use wildfire_timeline::{AgentFact, RestReason};

/// Of its options a truck that goes to the nearest by drive looks at this number of the nearest in a straight line.
const MAX_GOALS: usize = 6;

/// The result of a choice.
pub enum DecisionOutcome {
    SetsOut(Departure),
    Relocates(Relocation),
    /// Planning time of a failed plan is charged.
    Thinks,
    /// Other trucks block its drives; never empty.
    Waits(Vec<Blocked>),
    Rests(RestReason),
    /// The policy wants it to stay where it is, until something wakes it or until this time.
    Stays(Option<SimTime>),
    /// The truck fills its tank until then.
    Refills(SimTime),
}

/// A drive to a place where a truck will wait.
#[derive(Debug)]
pub struct Relocation {
    pub place: DVec2,
    pub leg: Trajectory,
    pub effort: Effort,
    pub found_by: FoundBy,
}

/// The end of a decision.
pub struct ActivityTransition {
    /// True if it set out, or continues planning.
    pub has_new_plans: bool,
    /// Its activities before and after the decision.
    pub was: Activity,
    pub is: Activity,
}

/// The resources of decisions, besides the trucks and the fires.
#[derive(SystemParam)]
pub struct DecisionResources<'w, 's> {
    pub following: ResMut<'w, PolicySet>,
    pub cpu_log: ResMut<'w, CpuLog>,
    pub followers: Query<'w, 's, &'static PolicyId, With<Truck>>,
    pub others: Query<'w, 's, &'static Agent, Without<Truck>>,
}

impl Truck {
    /// Lists what a truck may go for of the burning cells that no other truck has as its goal.
    fn options(&self, agent: &Agent, unclaimed: impl Iterator<Item = Cell> + Clone) -> Vec<Cell> {
        if agent.goal.is_some() {
            // The goal may itself be one that the planner had failed on and the flood reached.
            return unclaimed.filter(|cell| agent.goal == Some(*cell) || !self.failed_goals.contains(cell)).collect();
        }
        // Of another revision it is about a decision that is over.
        let state = self.deliberation.as_ref().filter(|state| state.revision == agent.revision);
        let blocked = state.map_or(&[][..], |state| &state.blocked);
        // A scenario limits how many blocked goals a truck tries before it waits.
        if blocked.len() >= self.traffic.goals as usize {
            return Vec::new();
        }
        let is_blocked = |cell: &Cell| blocked.iter().any(|blocked| blocked.drive.goal == *cell);
        let untried: Vec<Cell> =
            unclaimed.clone().filter(|cell| !self.failed_goals.contains(cell) && !is_blocked(cell)).collect();
        if !untried.is_empty() || !blocked.is_empty() || !self.is_rescued {
            return untried;
        }
        // Only goals that failed are left: those that the flood reaches can be driven to all the same.
        unclaimed.filter(|cell| !self.out_of_reach.contains(cell)).collect()
    }
}

/// Returns the path of a leg as it was driven.
fn driven(trajectory: &Trajectory) -> Option<Path> {
    let segments: Vec<_> = trajectory.pieces().iter().filter_map(Piece::segment).collect();
    (!segments.is_empty()).then(|| Path { start: trajectory.start(), segments })
}

/// Lets a truck set out on a drive, round those that are in its way if need be. Returns `None` if they stay in its way; the
/// drive is kept then, and another goal is to be tried.
fn depart_or_wait(
    agent: &mut Agent,
    truck: &mut Truck,
    drive: Drive,
    outset: DepartureContext<'_>,
    state: &mut DecisionState,
) -> Option<DecisionOutcome> {
    let by_flood = drive.is_by_flood();
    // A drive by the flood is a last resort: no other search would find a path.
    let may_lead_elsewhere = truck.traffic.plan == TrafficPlan::Together && !by_flood;
    match truck.depart(drive, outset) {
        // Others pass: another path may arrive before they are gone.
        Ok(first) if may_lead_elsewhere && first.leg.sets_out_at() > first.leg.start_time() => {
            let other = truck.plan_among(&first.drive, outset, &mut agent.cost);
            let earlier = other.filter(|other| other.leg.end_time() < first.leg.end_time());
            Some(DecisionOutcome::SetsOut(earlier.unwrap_or(first)))
        }
        Ok(departure) => Some(DecisionOutcome::SetsOut(departure)),
        // Its path is the only one known, so it waits at once.
        Err(blocked) if by_flood => Some(DecisionOutcome::Waits(vec![blocked])),
        Err(blocked) => {
            // Looking for a way round is expensive: once for every truck that is in the way.
            let is_new = !state.before.iter().any(|before| before.reason() == blocked.reason());
            let is_worthwhile = is_new || truck.traffic.plan == TrafficPlan::Together;
            let detour = if truck.traffic.detours == Detours::Each && is_worthwhile {
                truck.detour(&blocked.drive, outset, &mut agent.cost)
            } else {
                None
            };
            // Kept, so that it can wait for the best of them if no goal is left.
            if detour.is_none() {
                state.blocked.push(blocked);
            }
            detour.map(DecisionOutcome::SetsOut)
        }
    }
}

impl Fleet<'_, '_> {
    /// Lists what burns and is the goal of none but some trucks.
    pub fn unclaimed(&self, except: &[Entity], fires: &FireField) -> Vec<Cell> {
        let claimed = self.claimed(except);
        fires.burning().filter(|cell| !claimed.contains(cell)).collect()
    }

    /// Lists what a truck may go for; goals of the trucks in `askers`, including itself, count as free.
    pub fn options(&self, entity: Entity, askers: &[Entity], fires: &FireField) -> Vec<Cell> {
        let (agent, truck) = self.trucks.one(entity);
        let unclaimed = self.unclaimed(askers, fires).into_iter();
        truck.options(agent, unclaimed.filter(|&cell| self.has_water_for(agent, cell)))
    }

    /// Begins a decision, unless it has begun.
    pub fn deliberate(&mut self, entity: Entity, fires: &FireField) {
        let now = self.now();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        if truck.deliberation.as_ref().is_some_and(|state| state.revision == agent.revision) {
            return;
        }
        // A fire that is out is no option, and one that begins there later may be reachable.
        truck.failed_goals.retain(|&cell| fires.is_burning(cell));
        // Under way its tracks are recorded when the leg ends.
        if agent.goal.is_none() {
            truck.tracks.record(driven(&agent.trajectory));
            // A leg without pieces: it keeps the place where it decides, also for reservations.
            agent.trajectory = Trajectory::new(now, agent.trajectory.pose_at(now), Vec::new());
        }
        let before = std::mem::take(&mut truck.blocked);
        let blocked = Vec::new();
        let spent = Effort::default();
        // Noted, so that the decision's own share can be told at its end.
        let cpu = agent.cost.total();
        let revision = agent.revision;
        let activity = agent.activity;
        let delay = SimTime::ZERO;
        truck.deliberation = Some(DecisionState { revision, activity, before, blocked, spent, cpu, delay });
    }

    /// Carries out what the policy of a truck chose. If that fails it is asked again, with what it learned in mind.
    fn act(&mut self, entity: Entity, choice: Action, fires: &FireField, cpu_log: &mut CpuLog) {
        self.deliberate(entity, fires);
        let options = self.options(entity, &[entity], fires);
        let goal = match choice {
            // Policies are free to answer anything; what is no option counts as no goal.
            Action::Go(cell) if options.contains(&cell) => Some(cell),
            _ => None,
        };
        let (agent, _) = self.trucks.one(entity);
        if agent.goal.is_some() {
            self.keep_or_drop_goal(entity, goal, options.is_empty());
            return;
        }
        // The order matters: a refill comes before giving up the search, and staying is the last.
        let conclusion = match goal {
            Some(goal) => self.try_goal(entity, goal, fires),
            None if choice == Action::GoToNearest && !options.is_empty() => self.try_nearest(entity, &options, fires),
            None if choice == Action::Refill || self.is_out_of_water(entity, fires) => Some(self.refill(entity, fires)),
            // Its policy names no goal but blocked ones. A choice that is no option any more is another matter: it stays.
            None if options.is_empty() || !matches!(choice, Action::Go(_)) && self.has_blocked_drives(entity) => {
                Some(self.stop_looking(entity, fires))
            }
            None => Some(DecisionOutcome::Stays(choice.until())),
        };
        let concluded = conclusion.and_then(|conclusion| self.conclude(entity, conclusion, cpu_log));
        // Only a change can unblock others; without one they would be woken in turn forever.
        if concluded.is_some_and(|concluded| concluded.has_new_plans || concluded.is != concluded.was) {
            self.wake_blocked(entity);
        }
    }

    /// Ends the decision of a truck that is under way to a goal; `best` is where its policy would go now.
    fn keep_or_drop_goal(&mut self, entity: Entity, best: Option<Cell>, has_no_options: bool) {
        let (agent, mut truck) = self.trucks.one_mut(entity);
        truck.deliberation = None;
        let is_better = best.is_some() && best != agent.goal;
        if is_better || has_no_options {
            self.drop_goal(entity);
            // The fire that it leaves is free for others.
            self.wake_resting(entity);
        }
    }

    /// Plans a drive to a goal and sets out. Returns `None` if that fails and another goal has to be tried.
    pub fn try_goal(&mut self, entity: Entity, goal: Cell, fires: &FireField) -> Option<DecisionOutcome> {
        let now = self.now();
        let reservations = self.reservations();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let (agent, truck) = (&mut *agent, &mut *truck);
        // Taken out while the truck plans, which borrows all of it, and put back below.
        let mut state = truck.deliberation.take()?;
        let traffic = Traffic::new(&reservations, entity);
        let pose = agent.trajectory.start();
        let delay = state.delay;
        let outset = DepartureContext { now, pose, frame: fires.frame(), traffic, delay };
        // The planner is not asked for the same goal twice.
        let by_flood = truck.failed_goals.contains(&goal);
        // It has not moved since it was blocked, so the same query would find the same drive.
        let searched = state.before.iter().map(|blocked| &blocked.drive);
        let searched = searched.filter(|drive| drive.is_by_flood() == by_flood).find(|drive| drive.goal == goal);
        let drive = if let Some(searched) = searched {
            Some(searched.clone())
        } else if by_flood {
            let drive = truck.plan_by_flood(goal, outset, &mut agent.cost);
            if drive.is_none() {
                truck.out_of_reach.push(goal);
                self.recorder.record_agent(now, agent.id, AgentFact::OutOfReach { cells: vec![goal] });
            }
            drive
        } else {
            match truck.plan(goal, outset, &mut state.spent, &mut agent.cost, &mut self.recorder) {
                Ok(drive) => Some(drive),
                Err((reason, effort)) => {
                    let until = now + truck.charge(&effort);
                    truck.failed_goals.push(goal);
                    agent.answer(now, AgentFact::PlanFailed { goal, reason, effort, until }, &mut self.recorder);
                    // The time that a failure takes is charged like that of a plan.
                    if until > now {
                        truck.deliberation = Some(state);
                        agent.wait_until(entity, until, &mut self.queue);
                        return Some(DecisionOutcome::Thinks);
                    }
                    None
                }
            }
        };
        let conclusion = drive.and_then(|drive| depart_or_wait(agent, truck, drive, outset, &mut state));
        truck.deliberation = Some(state);
        conclusion
    }

    /// Plans a drive to the option that is nearest by drive and sets out. Returns `None` if that fails and another goal
    /// has to be tried.
    pub fn try_nearest(&mut self, entity: Entity, options: &[Cell], fires: &FireField) -> Option<DecisionOutcome> {
        let now = self.now();
        let reservations = self.reservations();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let (agent, truck) = (&mut *agent, &mut *truck);
        let pose = agent.trajectory.start();
        let frame = fires.frame();
        let from = truck.body.body_centre(pose);
        // By cell index, so that of equally near ones the first counts.
        let mut nearest = options.to_vec();
        nearest.sort_by(frame.by_distance(from));
        let first = *nearest.first()?;
        // The drive to far goals is rarely the shortest, and each goal makes the search larger.
        nearest.truncate(MAX_GOALS);
        nearest.retain(|cell| !truck.failed_goals.contains(cell));
        // Without a rule of distance every pose is at the goal.
        if nearest.len() > 1 && truck.reach_m.is_finite() {
            let mut state = truck.deliberation.take()?;
            let traffic = Traffic::new(&reservations, entity);
            let outset = DepartureContext { now, pose, frame, traffic, delay: state.delay };
            let drive = truck.plan_to_nearest(&nearest, outset, &mut state.spent, &mut agent.cost, &mut self.recorder);
            let has_drive = drive.is_some();
            let conclusion = drive.and_then(|drive| depart_or_wait(agent, truck, drive, outset, &mut state));
            truck.deliberation = Some(state);
            // A drive that is blocked counts too: the policy then chooses among the other goals.
            if has_drive {
                return conclusion;
            }
        }
        self.try_goal(entity, first, fires)
    }

    /// Ends a search without options: the truck looks for a drive around those that block it, waits for them, or rests.
    pub fn stop_looking(&mut self, entity: Entity, fires: &FireField) -> DecisionOutcome {
        // Looked up before the truck is borrowed.
        let nothing_burns = self.unclaimed(&[entity], fires).is_empty();
        let is_too_hot = self.is_too_hot(entity, fires);
        let now = self.now();
        let reservations = self.reservations();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let rests = match (nothing_burns, truck.is_rescued) {
            (true, _) => RestReason::NothingBurns,
            _ if is_too_hot => RestReason::TooHot,
            (false, true) => RestReason::NothingReachable,
            (false, false) => RestReason::NoPlan,
        };
        let state = truck.deliberation.as_mut();
        let (blocked, before, delay) = state.map_or_else(Default::default, |state| {
            (std::mem::take(&mut state.blocked), state.before.first().map(Blocked::reason), state.delay)
        });
        let Some(first) = blocked.first() else { return DecisionOutcome::Rests(rests) };
        // With detours for each blocked drive they were tried when it was blocked.
        let tried = match truck.traffic.plan {
            _ if truck.traffic.detours == Detours::Each => 0,
            // If the same truck blocks the same goal as before, the way round it has been looked for.
            TrafficPlan::Alone => usize::from(before != Some(first.reason())),
            TrafficPlan::Together => blocked.len(),
        };
        for blocked in &blocked[..tried] {
            let traffic = Traffic::new(&reservations, entity);
            let pose = agent.trajectory.start();
            let frame = fires.frame();
            let outset = DepartureContext { now, pose, frame, traffic, delay };
            if let Some(departure) = truck.detour(&blocked.drive, outset, &mut agent.cost) {
                return DecisionOutcome::SetsOut(departure);
            }
        }
        DecisionOutcome::Waits(blocked)
    }

    /// Ends a decision, unless there is none.
    pub fn conclude(
        &mut self,
        entity: Entity,
        conclusion: DecisionOutcome,
        cpu_log: &mut CpuLog,
    ) -> Option<ActivityTransition> {
        let now = self.now();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let state = truck.deliberation.take()?;
        cpu_log.add(now, agent.id, agent.cost.total() - state.cpu);
        let has_new_plans =
            matches!(conclusion, DecisionOutcome::SetsOut(_) | DecisionOutcome::Relocates(_) | DecisionOutcome::Thinks);
        match conclusion {
            DecisionOutcome::SetsOut(Departure { drive, leg }) => self.set_out(entity, drive, leg),
            DecisionOutcome::Relocates(Relocation { place, leg, effort, found_by }) => {
                truck.tracks.set_out(0.0);
                let (x_m, y_m) = (place.x, place.y);
                let fact = AgentFact::Relocated { x_m, y_m, trajectory: leg.clone(), effort, found_by };
                agent.answer(now, fact, &mut self.recorder);
                agent.relocate(entity, place, leg, &mut self.queue);
            }
            DecisionOutcome::Thinks => {}
            DecisionOutcome::Rests(reason) => agent.rest(now, reason, &mut self.recorder),
            DecisionOutcome::Stays(until) => agent.wait(entity, now, until, &mut self.queue, &mut self.recorder),
            DecisionOutcome::Refills(until) => {
                let full_tank = truck.water.as_ref().map_or(0, |water| water.full_tank);
                self.recorder.record_agent(now, agent.id, AgentFact::Refilling { until });
                agent.refill(entity, full_tank, until, &mut self.queue);
            }
            DecisionOutcome::Waits(blocked) => {
                let reason = blocked[0].reason();
                // Looking again without success is no new fact.
                if state.before.first().map(Blocked::reason) != Some(reason) {
                    let BlockReason { goal, by } = reason;
                    self.recorder.record_agent(now, agent.id, AgentFact::Blocked { goal, by });
                }
                // Void what is scheduled for the decision that ends here.
                agent.revision += 1;
                agent.activity = Activity::Blocked;
                truck.blocked = blocked;
                // Whether all wait for each other is seen when all decisions of this instant are made.
                self.queue.push_for(now, AgentEvent::Deadlock, agent.wake(entity));
            }
        }
        // Looked up again, as setting out changes the activity.
        let (agent, _) = self.trucks.one(entity);
        Some(ActivityTransition { has_new_plans, was: state.activity, is: agent.activity })
    }
}

/// Lets trucks whose turn it is follow their policies, keep their goals, wait for other trucks, or rest.
pub fn decide(mut fleet: Fleet, fires: Res<Fires>, mut resources: DecisionResources) {
    let (now, fires) = (fleet.now(), &fires.field);
    // One at a time: what one truck decides changes the options of the next.
    while let Some(wake) = fleet.queue.next_for(now, AgentEvent::Decision, |entity| fleet.trucks.contains(entity)) {
        let (agent, _) = fleet.trucks.one(wake.agent);
        let policy = *resources.followers.get(wake.agent).expect("every truck follows a policy");
        // Something may have ignited just as it arrived.
        if agent.revision != wake.revision || agent.activity == Activity::Suppressing {
            fleet.queue.drop_next();
            continue;
        }
        if matches!(resources.following.asking(policy), PolicyScope::Team { .. }) {
            if !fleet.decide_for_team(policy, fires, &mut resources) {
                return;
            }
            continue;
        }
        fleet.deliberate(wake.agent, fires);
        // A policy is not asked where there is nothing to choose.
        let choices = if fleet.options(wake.agent, &[wake.agent], fires).is_empty() {
            vec![(wake.agent, Action::Wait)]
        } else {
            let mut queried = Vec::new();
            for due in fleet.queue.decisions(now).filter(|due| fleet.trucks.contains(due.agent)) {
                let (agent, _) = fleet.trucks.one(due.agent);
                let is_meant = agent.revision == due.revision && agent.activity != Activity::Suppressing;
                let who = (agent.id, due.agent);
                // All that are due and follow this policy are asked at once; a truck may be due more than once.
                if is_meant && resources.followers.get(due.agent) == Ok(&policy) && !queried.contains(&who) {
                    queried.push(who);
                }
            }
            let trucks = fleet.trucks.agents().map(|agent| agent.view(now));
            let agents = trucks.chain(resources.others.iter().map(|agent| agent.view(now))).collect();
            let inquiry = PolicyQuery { now, fires, agents, queried };
            resources.following.ask(policy, inquiry, &|entity: Entity| fleet.options(entity, &[entity], fires))
        };
        // An external policy has not answered yet: the run pauses here.
        if choices.is_empty() {
            return;
        }
        for (entity, choice) in choices {
            let has_goal = fleet.trucks.one(entity).0.goal.is_some();
            if has_goal && entity == wake.agent {
                // It may be called several times at one instant without changing its mind.
                fleet.queue.drop_next();
            }
            fleet.act(entity, choice, fires, &mut resources.cpu_log);
        }
    }
}
