//! Agents: a body on a trajectory with a goal that can change.

use std::sync::Arc;
use std::time::Duration;

use bevy_ecs::prelude::*;
use glam::DVec2;

use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_planning::Planners;
use wildfire_planning::collision::ClearanceField;
use wildfire_planning::memory::MemoryMeter;
use wildfire_scenario::{GroundKinds, Scenario};
use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, CpuSample, RestReason, WaterRules};

use super::policies::AgentView;
use super::queue::{AgentEvent, SimQueue, Wake};
use super::recorder::{CpuLog, Recorder};
use super::run::AgentCost;

/// The shortest time for which a policy lets an agent wait: no answer may keep a run at one instant.
const SHORTEST_WAIT: SimTime = SimTime::from_nanos(100_000_000);

/// The activity of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// The agent stands and is about to decide.
    Idle,
    /// The agent stands without a goal until something wakes it, or because its policy chose to wait.
    Resting(RestReason),
    /// The agent stands because others block every option.
    Blocked,
    /// The agent stands while planning time is charged.
    Planning,
    Moving,
    Suppressing,
    /// The agent stands at water and fills its tank.
    Refilling,
}

/// An agent of the contest.
#[derive(Component, Clone, Debug)]
pub struct Agent {
    pub id: AgentId,
    pub body: Body,
    /// A number that increases whenever the agent changes its mind; events with an older number are void.
    pub revision: u32,
    pub activity: Activity,
    pub goal: Option<Cell>,
    /// The place that the policy sent the agent to, until it is sent elsewhere.
    pub staging_point: Option<DVec2>,
    /// True if something happened on the drive and the policy has not been asked about it yet.
    pub is_called: bool,
    /// The number of stops that the water in the tank lasts for; `None` where water does not matter.
    pub stops_left: Option<u32>,
    /// The end of the stop at a fire, of a refill, or of the planning time of a failed plan.
    pub busy_until: SimTime,
    /// The last leg: the agent moves along it or stands at its end.
    pub trajectory: Trajectory,
    pub cost: AgentCost,
    /// The part of it that building its planner and the queries answered so far took.
    answered: Duration,
}

impl Agent {
    pub fn standing(id: AgentId, body: Body, pose: Pose) -> Self {
        Self {
            id,
            body,
            revision: 0,
            activity: Activity::Idle,
            goal: None,
            staging_point: None,
            is_called: false,
            stops_left: None,
            busy_until: SimTime::ZERO,
            trajectory: Trajectory::new(SimTime::ZERO, pose, Vec::new()),
            cost: AgentCost::new(id),
            answered: Duration::ZERO,
        }
    }

    /// Returns the centre of the agent's body.
    pub fn centre(&self, now: SimTime) -> DVec2 {
        self.body.centre(self.trajectory.pose_at(now))
    }

    /// Returns what policies see of the agent.
    pub fn view(&self, now: SimTime) -> AgentView {
        let pose = self.trajectory.pose_at(now);
        let place = self.body.centre(pose);
        let (free_at, free_place) = self.free_from(now, place);
        let id = self.id;
        let activity = self.shown_activity(now);
        let goal = self.goal;
        let staging_point = self.staging_point;
        let stops_left = self.stops_left;
        AgentView { id, place, pose, activity, goal, staging_point, stops_left, free_at, free_place }
    }

    /// Returns when and where it can set out for something else; it is at `place` now.
    fn free_from(&self, now: SimTime, place: DVec2) -> (SimTime, DVec2) {
        match self.activity {
            Activity::Suppressing | Activity::Refilling => (self.busy_until, place),
            Activity::Planning if self.goal.is_none() => (self.busy_until, place),
            // It comes to a stop, or drives aside.
            Activity::Moving if self.goal.is_none() && self.staging_point.is_none() => {
                (self.trajectory.end_time().max(now), self.body.centre(self.trajectory.end()))
            }
            _ => (now, place),
        }
    }

    /// Returns true if the agent stands and can choose a goal.
    pub fn is_free(&self) -> bool {
        matches!(self.activity, Activity::Idle | Activity::Resting(_) | Activity::Blocked)
    }

    pub fn is_under_way(&self) -> bool {
        matches!(self.activity, Activity::Moving | Activity::Planning) && self.goal.is_some()
    }

    /// Returns true if the agent drives to a place where it will wait.
    pub fn is_relocating(&self, now: SimTime) -> bool {
        self.activity == Activity::Moving && self.goal.is_none() && self.staging_point.is_some() && !self.stands(now)
    }

    /// Returns true if the agent has reached the end of its last leg.
    pub fn stands(&self, now: SimTime) -> bool {
        self.trajectory.end_time() <= now
    }

    pub fn wake(&self, agent: Entity) -> Wake {
        Wake { agent, revision: self.revision }
    }

    /// Voids the current plan and schedules a decision.
    pub fn reconsider(&mut self, entity: Entity, at: SimTime, queue: &mut SimQueue) {
        self.revision += 1;
        queue.push_for(at, AgentEvent::Decision, self.wake(entity));
    }

    /// Drops the goal while driving; `cut` is the leg up to the stop, and the next decision falls at its end.
    pub fn drop_goal(
        &mut self,
        entity: Entity,
        now: SimTime,
        cut: Trajectory,
        queue: &mut SimQueue,
        recorder: &mut Recorder,
    ) {
        let goal = self.goal.take().expect("only an agent with a goal drops one");
        recorder.record_agent(now, self.id, AgentFact::Dropped { goal, trajectory: cut.clone() });
        self.come_to_a_stop(entity, now, cut, queue);
    }

    /// Follows what is left of a leg that is cut short, and decides again at its end.
    fn come_to_a_stop(&mut self, entity: Entity, now: SimTime, cut: Trajectory, queue: &mut SimQueue) {
        let stands_at = cut.end_time().max(now);
        self.activity = if stands_at > now { Activity::Moving } else { Activity::Idle };
        self.trajectory = cut;
        self.reconsider(entity, stands_at, queue);
    }

    /// Starts towards a goal, where `then` is scheduled; `trajectory` begins when planning time is over.
    pub fn set_out(
        &mut self,
        entity: Entity,
        now: SimTime,
        goal: Cell,
        trajectory: Trajectory,
        then: AgentEvent,
        queue: &mut SimQueue,
    ) {
        // Events that were scheduled for what it did before are void from now on.
        self.revision += 1;
        (self.goal, self.staging_point) = (Some(goal), None);
        self.activity = Activity::Moving;
        // Planning time is simulated: it stands until the leg begins.
        if trajectory.start_time() > now {
            self.activity = Activity::Planning;
            queue.push_for(trajectory.start_time(), AgentEvent::PlanningDone, self.wake(entity));
        }
        queue.push_for(trajectory.end_time(), then, self.wake(entity));
        self.trajectory = trajectory;
    }

    /// Starts towards a place to wait, and schedules a decision for the arrival.
    pub fn relocate(&mut self, entity: Entity, place: DVec2, leg: Trajectory, queue: &mut SimQueue) {
        (self.staging_point, self.activity) = (Some(place), Activity::Moving);
        self.reconsider(entity, leg.end_time(), queue);
        self.trajectory = leg;
    }

    /// Stops a drive to such a place; `cut` is the leg up to the stop, and the next decision falls at its end.
    pub fn halt(
        &mut self,
        entity: Entity,
        now: SimTime,
        cut: Trajectory,
        queue: &mut SimQueue,
        recorder: &mut Recorder,
    ) {
        recorder.record_agent(now, self.id, AgentFact::Halted { trajectory: cut.clone() });
        self.staging_point = None;
        self.come_to_a_stop(entity, now, cut, queue);
    }

    /// Stands for the planning time of a failed plan, then decides again.
    pub fn wait_until(&mut self, entity: Entity, time: SimTime, queue: &mut SimQueue) {
        self.revision += 1;
        self.busy_until = time;
        self.activity = Activity::Planning;
        queue.push_for(time, AgentEvent::PlanningDone, self.wake(entity));
    }

    /// Fills the tank until the given time, then decides again.
    pub fn refill(&mut self, entity: Entity, full_tank: u32, until: SimTime, queue: &mut SimQueue) {
        self.wait_until(entity, until, queue);
        (self.activity, self.stops_left) = (Activity::Refilling, Some(full_tank));
    }

    /// Rests without a goal until something wakes the agent.
    pub fn rest(&mut self, now: SimTime, reason: RestReason, recorder: &mut Recorder) {
        self.revision += 1;
        self.goal = None;
        // An agent that looks again without success has nothing new to tell.
        if self.activity != Activity::Resting(reason) {
            self.activity = Activity::Resting(reason);
            recorder.record_agent(now, self.id, AgentFact::Rested { reason });
        }
    }

    /// Rests because the policy chose to, and decides again at the given time if nothing wakes the agent earlier.
    pub fn wait(
        &mut self,
        entity: Entity,
        now: SimTime,
        until: Option<SimTime>,
        queue: &mut SimQueue,
        recorder: &mut Recorder,
    ) {
        self.rest(now, RestReason::PolicyWait, recorder);
        if let Some(until) = until {
            queue.push_for(until.max(now + SHORTEST_WAIT), AgentEvent::Decision, self.wake(entity));
        }
    }

    /// Records an answer of the agent's planner, with the CPU time since the answer before.
    pub fn answer(&mut self, now: SimTime, fact: AgentFact, recorder: &mut Recorder) {
        let total = self.cost.total();
        let cpu = total.saturating_sub(std::mem::replace(&mut self.answered, total));
        recorder.record_answer(now, self.id, fact, cpu);
    }

    /// Returns the activity as timelines record it.
    pub fn shown_activity(&self, now: SimTime) -> wildfire_timeline::Activity {
        match self.activity {
            Activity::Idle | Activity::Resting(_) => wildfire_timeline::Activity::Standing,
            Activity::Blocked => wildfire_timeline::Activity::Waiting,
            Activity::Planning => wildfire_timeline::Activity::Planning,
            // A truck that relocates counts as moving from its decision on, although its leg begins later.
            Activity::Moving if now < self.trajectory.start_time() => wildfire_timeline::Activity::Planning,
            Activity::Moving if now < self.trajectory.sets_out_at() => wildfire_timeline::Activity::Waiting,
            Activity::Moving => wildfire_timeline::Activity::Driving,
            Activity::Suppressing => wildfire_timeline::Activity::Suppressing,
            Activity::Refilling => wildfire_timeline::Activity::Refilling,
        }
    }
}

/// The agents in the order in which loops visit them, by name.
#[derive(Resource, Clone, Debug, Default)]
pub struct AgentOrder(pub Vec<Entity>);

/// What agents are built from and placed on.
pub struct SpawnContext<'a> {
    pub scenario: &'a Scenario,
    pub seed: u64,
    pub field: &'a Arc<ClearanceField>,
    pub ground: &'a Option<GroundKinds>,
    pub water: &'a Option<Arc<WaterRules>>,
    pub memory: &'a MemoryMeter,
    pub planners: &'a Planners,
}

/// Adds an agent with the components of its kind, and schedules its first decision: at time 0, or when it is no longer busy.
pub fn enlist(world: &mut World, agent: Agent, limits: SpeedLimits, kind: impl Bundle) -> AgentStart {
    let start = AgentStart { id: agent.id, pose: agent.trajectory.start(), body: agent.body, limits: Some(limits) };
    // The time that its planner took to build is a sample of its own, not part of the first answer's.
    let agent = Agent { answered: agent.cost.total(), ..agent };
    let built = CpuSample { time: SimTime::ZERO, agent: agent.id, cpu: agent.cost.total() };
    world.resource_mut::<CpuLog>().0.push(built);
    let ready = agent.busy_until;
    let entity = world.spawn((agent, kind)).id();
    world.resource_mut::<AgentOrder>().0.push(entity);
    let wake = Wake { agent: entity, revision: 0 };
    world.resource_mut::<SimQueue>().push_for(ready, AgentEvent::Decision, wake);
    start
}
