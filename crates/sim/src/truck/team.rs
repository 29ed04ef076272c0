//! Decisions of a team: its policy chooses for all trucks that are asked at one instant, and they carry the choices out
//! together.
//!
//! First those that are under way and are to go elsewhere stop, so that what they went for is free; then those that stand
//! set out, smaller numbers first. A truck that stops at once, or finds no path to its goal, is asked again at the
//! same instant. That comes to an end: a truck that has set out is not asked again before a fire begins or ends, each
//! plan that fails rules a goal out, and a truck that comes to wait wakes nobody unless it was under way before.

use bevy_ecs::prelude::*;
use glam::DVec2;

use super::decision::{DecisionOutcome, DecisionResources, Relocation};
use super::drive::DepartureContext;
use super::{Fleet, Truck, UnreachableStaging};
use crate::agent::{Activity, Agent};
use crate::policies::dispatch::AS_GOOD_M;
use crate::policies::{Action, PolicyId, PolicyQuery};
use crate::traffic::Traffic;
use wildfire_base::geometry::Pose;
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::FireField;
use wildfire_planning::{Effort, Found, GoalDisc};
use wildfire_timeline::{AgentFact, AgentId};

/// How near to its place a truck that is sent there comes, in metres: that of the middle of its body.
const STAGING_RADIUS_M: f64 = 10.0;

/// How long a truck does not try again to set out for a place that others are in the way to.
const PATIENCE: SimTime = SimTime::from_nanos(10_000_000_000);

impl Agent {
    /// Returns true if it is under way to a fire, or to a place where it is to wait.
    fn may_be_called_off(&self, now: SimTime) -> bool {
        self.is_under_way() || self.is_relocating(now)
    }
}

/// Trucks whose decisions are due.
struct DueTrucks {
    /// By number.
    queried: Vec<(AgentId, Entity)>,
    /// Those of them that are under way.
    moving: Vec<Entity>,
}

impl DueTrucks {
    fn entities(&self) -> Vec<Entity> {
        self.queried.iter().map(|&(_, entity)| entity).collect()
    }
}

impl Fleet<'_, '_> {
    /// Decides for the trucks of a team whose decisions are due; returns false if the answer comes later.
    pub fn decide_for_team(
        &mut self,
        policy: PolicyId,
        fires: &FireField,
        resources: &mut DecisionResources<'_, '_>,
    ) -> bool {
        let mut called = self.called(policy, resources);
        // What was due has changed meanwhile.
        if called.queried.is_empty() {
            self.queue.drop_next();
            return true;
        }
        let mut changed = Vec::new();
        // Goals of all that are asked count as free, so that the team can exchange them.
        let all = called.entities();
        for &entity in all.iter().filter(|entity| !called.moving.contains(entity)) {
            self.deliberate(entity, fires);
        }
        // Where others are in the way to all that is left, there is nothing to choose.
        for &entity in &all {
            if self.has_blocked_drives(entity) && self.options(entity, &all, fires).is_empty() {
                let conclusion = self.stop_looking(entity, fires);
                changed.extend(self.conclude_in_team(entity, conclusion, resources).then_some(entity));
                called.queried.retain(|&(_, other)| other != entity);
            }
        }
        if !called.queried.is_empty() {
            let orders = self.ask_team(policy, &called, fires, resources);
            // An external policy has not answered yet.
            if orders.is_empty() {
                return false;
            }
            // Those under way first: a goal that is dropped is free for the trucks that stand.
            for &(entity, choice) in orders.iter().filter(|(entity, _)| called.moving.contains(entity)) {
                changed.extend(self.call_off(entity, choice).then_some(entity));
            }
            for &(entity, choice) in orders.iter().filter(|(entity, _)| !called.moving.contains(entity)) {
                if let Some(conclusion) = self.execute(entity, choice, fires) {
                    changed.extend(self.conclude_in_team(entity, conclusion, resources).then_some(entity));
                }
            }
        }
        // Only now, so that nobody forgets meanwhile what was in its way. A change is none of the own truck's.
        match changed[..] {
            [] => {}
            [only] => self.wake_blocked(only),
            _ => self.wake_blocked(Entity::PLACEHOLDER),
        }
        true
    }

    /// Lists the trucks of a policy that decide now.
    fn called(&self, policy: PolicyId, resources: &DecisionResources<'_, '_>) -> DueTrucks {
        let now = self.now();
        let mut called = DueTrucks { queried: Vec::new(), moving: Vec::new() };
        for due in self.queue.decisions(now).filter(|due| self.trucks.contains(due.agent)) {
            let (agent, _) = self.trucks.one(due.agent);
            let is_meant = agent.revision == due.revision && resources.followers.get(due.agent) == Ok(&policy);
            // A truck on its way to a waiting place is under way too.
            let stands = agent.goal.is_none() && agent.stands(now);
            let is_called_off = agent.is_called && agent.may_be_called_off(now);
            let who = (agent.id, due.agent);
            if is_meant && (stands || is_called_off) && !called.queried.contains(&who) {
                called.queried.push(who);
                called.moving.extend((!stands).then_some(due.agent));
            }
        }
        // By number, as events of an instant come in the order in which they were scheduled.
        called.queried.sort_by_key(|&(id, _)| id);
        called
    }

    /// Returns what the policy chooses for all that are called, by number; whom it leaves out waits. Nobody is in it if the
    /// answer comes later.
    fn ask_team(
        &mut self,
        policy: PolicyId,
        called: &DueTrucks,
        fires: &FireField,
        resources: &mut DecisionResources<'_, '_>,
    ) -> Vec<(Entity, Action)> {
        let now = self.now();
        let trucks = self.trucks.agents().map(|agent| agent.view(now));
        let agents = trucks.chain(resources.others.iter().map(|agent| agent.view(now))).collect();
        let inquiry = PolicyQuery { now, fires, agents, queried: called.queried.clone() };
        let all = called.entities();
        // Here and not in `ask`, which leaves out the time of teams.
        let mut stopwatch = CpuStopwatch::start();
        let choices = resources.following.ask(policy, inquiry, &|entity| self.options(entity, &all, fires));
        resources.following.team_cpu += stopwatch.elapsed_since_last();
        // After the answer, whose effort it charges.
        let delay = resources.following.charge(policy);
        // All stay called, so that the same trucks are in the query once the answer has come.
        if choices.is_empty() {
            return Vec::new();
        }
        for &entity in &all {
            let (mut agent, mut truck) = self.trucks.one_mut(entity);
            // The call is answered, whatever the choice is.
            agent.is_called = false;
            if let Some(state) = &mut truck.deliberation {
                // A truck that sets out by this decision waits for as long as the team has planned.
                state.delay = delay;
            }
        }
        let choice_of =
            |entity| choices.iter().find(|&&(other, _)| other == entity).map_or(Action::Wait, |&(_, it)| it);
        all.into_iter().map(|entity| (entity, choice_of(entity))).collect()
    }

    /// Lets a truck that is under way stop if it is to go elsewhere; returns true if so.
    fn call_off(&mut self, entity: Entity, choice: Action) -> bool {
        let (agent, _) = self.trucks.one(entity);
        match (agent.goal, agent.staging_point, choice) {
            (Some(goal), _, Action::Go(cell)) if cell != goal => self.drop_goal(entity),
            (Some(_), _, Action::Move(_) | Action::Refill) => self.drop_goal(entity),
            // It is on its way to water.
            (None, ..) if agent.stops_left == Some(0) => return false,
            (None, _, Action::Go(_) | Action::GoToNearest) => self.halt(entity),
            (None, Some(staging_point), Action::Move(place)) if (place - staging_point).length() > AS_GOOD_M => {
                self.halt(entity);
            }
            _ => return false,
        }
        true
    }

    /// Lets a truck that stands do what was chosen for it. Returns `None` if that fails and it is to be asked again.
    fn execute(&mut self, entity: Entity, choice: Action, fires: &FireField) -> Option<DecisionOutcome> {
        let options = self.options(entity, &[entity], fires);
        match choice {
            _ if self.is_out_of_water(entity, fires) => Some(self.refill(entity, fires)),
            Action::Go(_) | Action::GoToNearest if choice.is_one_of(&options) => {
                let conclusion = match choice {
                    Action::Go(cell) => self.try_goal(entity, cell, fires),
                    _ => self.try_nearest(entity, &options, fires),
                };
                if conclusion.is_none() {
                    // If it rests after all, that is a fact of its own after the plan that failed.
                    self.trucks.one_mut(entity).0.activity = Activity::Idle;
                }
                conclusion
            }
            _ if options.is_empty() && !matches!(choice, Action::Move(_) | Action::Refill)
                || self.has_blocked_drives(entity) =>
            {
                Some(self.stop_looking(entity, fires))
            }
            Action::Move(place) => Some(self.relocate(entity, place, fires)),
            Action::Refill => Some(self.refill(entity, fires)),
            _ => Some(DecisionOutcome::Stays(choice.until())),
        }
    }

    pub fn has_blocked_drives(&self, entity: Entity) -> bool {
        let state = self.trucks.one(entity).1.deliberation.as_ref();
        state.is_some_and(|state| !state.blocked.is_empty())
    }

    /// Ends a decision; returns true if trucks that are blocked have something new to look at.
    fn conclude_in_team(
        &mut self,
        entity: Entity,
        conclusion: DecisionOutcome,
        resources: &mut DecisionResources<'_, '_>,
    ) -> bool {
        let Some(concluded) = self.conclude(entity, conclusion, &mut resources.cpu_log) else { return false };
        // One that was blocked and rests now, or the other way round, stays in place. If that woke others, two could
        // wake each other forever.
        let waited = |activity| matches!(activity, Activity::Resting(_) | Activity::Blocked);
        concluded.has_new_plans || waited(concluded.is) && !waited(concluded.was)
    }

    /// Sends a truck to a place where it is to wait.
    fn relocate(&mut self, entity: Entity, place: DVec2, fires: &FireField) -> DecisionOutcome {
        let (mut agent, truck) = self.trucks.one_mut(entity);
        if (truck.body.body_centre(agent.trajectory.start()) - place).length() <= AS_GOOD_M {
            // It counts as sent there, so that its policy sees it in its place.
            agent.staging_point = Some(place);
            return DecisionOutcome::Stays(None);
        }
        self.drive_to(entity, GoalDisc { centre: place, radius_m: STAGING_RADIUS_M }, fires)
    }

    /// Plans a truck's drive to a place without a fire. The truck stays if there is no path or others block it.
    pub fn drive_to(&mut self, entity: Entity, disc: GoalDisc, fires: &FireField) -> DecisionOutcome {
        let now = self.now();
        let reservations = self.reservations();
        let (mut agent, mut truck) = self.trucks.one_mut(entity);
        let (agent, truck) = (&mut *agent, &mut *truck);
        let pose = agent.trajectory.start();
        if truck.closed_until(pose, disc.centre, now).is_some() {
            return DecisionOutcome::Stays(None);
        }
        // From elsewhere there may be a way.
        truck.closed_posts.retain(|closed| closed.from == pose && closed.until > now);
        let place = disc.centre;
        let delay = truck.deliberation.as_ref().map_or(SimTime::ZERO, |state| state.delay);
        let traffic = Traffic::new(&reservations, entity);
        let outset = DepartureContext { now, pose, frame: fires.frame(), traffic, delay };
        let mut spent = Effort::default();
        let found = truck.query(disc, outset, &mut spent, &mut agent.cost, &mut self.recorder);
        let (reason, effort, until, tried_again) = match found {
            Ok(Found { path, by: found_by }) => {
                let ready = now + delay + truck.charge(&spent);
                match traffic.departure(&truck.body, &truck.leg(&path, ready)) {
                    Ok(leg) => return DecisionOutcome::Relocates(Relocation { place, leg, effort: spent, found_by }),
                    Err(_) => (None, spent, now, now + PATIENCE),
                }
            }
            // Bushes stay where they are: what fails from here fails here again.
            Err((reason, effort)) => (Some(reason), effort, now + truck.charge(&effort), SimTime::MAX),
        };
        // Noted by pose and place, so that later decisions do not plan it again.
        truck.closed_posts.push(UnreachableStaging { from: pose, to: place, until: tried_again });
        let (x_m, y_m) = (place.x, place.y);
        let failed = AgentFact::RelocationFailed { x_m, y_m, reason, effort, until };
        agent.answer(now, failed, &mut self.recorder);
        if until == now {
            return DecisionOutcome::Stays(None);
        }
        agent.wait_until(entity, until, &mut self.queue);
        DecisionOutcome::Thinks
    }
}

impl Truck {
    /// Returns the time until which a truck does not try again to drive from where it stands to a place, if it has
    /// tried.
    pub fn closed_until(&self, from: Pose, to: DVec2, now: SimTime) -> Option<SimTime> {
        self.closed_posts
            .iter()
            .filter(|closed| closed.from == from && (closed.to - to).length() <= AS_GOOD_M)
            .map(|closed| closed.until)
            .filter(|&until| until > now)
            .max()
    }
}
