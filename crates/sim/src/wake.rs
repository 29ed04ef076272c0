//! Wake-ups: changes of the fire wake the agents that they concern.

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;

use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::{FireChange, FireField};
use wildfire_timeline::RestReason;

use super::agent::{Activity, Agent, AgentOrder};
use super::policies::PolicyScope;
use super::queue::{AgentEvent, Due, SimClock, SimQueue};
use super::schedule::{Pass, SimSystems};

/// The plugin in which agents are woken; agents without a system of their own look again.
#[derive(Debug)]
pub struct WakePlugin;

impl Plugin for WakePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Pass, (drop_void_events, replan, finish_planning).chain().in_set(SimSystems::Wake));
    }
}

/// The triggers that wake an agent.
#[derive(Component, Clone, Debug)]
pub struct WakeTriggers(pub Vec<Trigger>);

impl WakeTriggers {
    /// Returns the triggers of a truck whose policy is asked in this way, and which may reconsider its goal whenever
    /// something ignites.
    pub fn truck(asking: PolicyScope, reconsiders: bool) -> Self {
        // The loss of a goal comes first, because only the first trigger that fires counts.
        let triggers = match asking {
            PolicyScope::Team { replans } => vec![Trigger::GoalBurnsNoMore, Trigger::ChangeForTeam { replans }],
            PolicyScope::Each => {
                let standing = [Trigger::IgnitionWhileFree, Trigger::FireOverWhileBlocked, Trigger::ChangeWhileWaiting];
                let under_way = reconsiders.then_some(Trigger::IgnitionUnderWay);
                [Trigger::GoalBurnsNoMore].into_iter().chain(standing).chain(under_way).collect()
            }
        };
        Self(triggers)
    }

    /// Returns true if the agent is woken as one of a team.
    pub fn is_in_team(&self) -> bool {
        self.0.iter().any(|trigger| matches!(trigger, Trigger::ChangeForTeam { .. }))
    }
}

/// A reason to wake an agent: a change of a bush, and the agent's activity at the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    GoalIgnited,
    GoalBurnsNoMore,
    IgnitionWhileFree,
    IgnitionUnderWay,
    FireOverWhileBlocked,
    /// A fire is over, and its bush can be lit again, while the agent rests.
    FuelWhileResting,
    ChangeWhileWaiting,
    /// Any change, for a truck in a team that neither suppresses nor comes to a stop.
    ChangeForTeam {
        /// True if trucks that are under way to a fire are asked too.
        replans: bool,
    },
}

/// Triggers fired by a change of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TriggerEvent {
    Ignition(Cell),
    FireOver(Cell),
    /// A wet cell, which cannot be lit until it dries.
    Water(Cell),
    Fuel,
}

impl TriggerEvent {
    /// First comes what happened, then what it makes possible.
    fn of_change(change: FireChange, fires: &FireField) -> impl Iterator<Item = Self> {
        let (first, then) = match change {
            FireChange::Ignited { cell, .. } => (Some(Self::Ignition(cell)), None),
            FireChange::Extinguished { cell } | FireChange::BurnedOut { cell } => {
                (Some(Self::FireOver(cell)), fires.can_burn(cell).then_some(Self::Fuel))
            }
            FireChange::Wetted { cell, .. } => (Some(Self::Water(cell)), None),
            FireChange::Dried { cell } => (None, fires.can_burn(cell).then_some(Self::Fuel)),
        };
        first.into_iter().chain(then)
    }
}

impl Trigger {
    /// Returns what the agent is to do about the news, if they wake it.
    fn wakes(self, agent: &Agent, news: TriggerEvent, now: SimTime) -> Option<AgentEvent> {
        // Only pairs that can matter are listed; whether the agent is in the state for it is asked after.
        let (is_woken, event) = match (self, news) {
            (Self::GoalIgnited, TriggerEvent::Ignition(cell) | TriggerEvent::Water(cell))
            | (Self::GoalBurnsNoMore, TriggerEvent::FireOver(cell)) => (agent.goal == Some(cell), AgentEvent::GoalLost),
            (Self::IgnitionWhileFree, TriggerEvent::Ignition(_)) => (agent.is_free(), AgentEvent::Replan),
            (Self::IgnitionUnderWay, TriggerEvent::Ignition(_)) => (agent.is_under_way(), AgentEvent::Replan),
            (Self::FireOverWhileBlocked, TriggerEvent::FireOver(_)) => {
                (agent.activity == Activity::Blocked, AgentEvent::Replan)
            }
            (Self::FuelWhileResting, TriggerEvent::Fuel) => {
                (matches!(agent.activity, Activity::Resting(_)), AgentEvent::Replan)
            }
            (Self::ChangeWhileWaiting, TriggerEvent::Ignition(_) | TriggerEvent::FireOver(_)) => {
                (agent.activity == Activity::Resting(RestReason::PolicyWait), AgentEvent::Replan)
            }
            (Self::ChangeForTeam { replans }, TriggerEvent::Ignition(_) | TriggerEvent::FireOver(_)) => {
                let is_woken = agent.is_free() || agent.is_relocating(now) || replans && agent.is_under_way();
                (is_woken, AgentEvent::Replan)
            }
            _ => return None,
        };
        is_woken.then_some(event)
    }
}

/// All agents that listen for changes.
#[derive(SystemParam)]
pub struct WakeTargets<'w, 's> {
    roster: Res<'w, AgentOrder>,
    agents: Query<'w, 's, (&'static Agent, &'static WakeTriggers)>,
}

impl WakeTargets<'_, '_> {
    /// Wakes the agents that a change concerns, in the order of their names; returns false if there are none.
    pub fn notify(&self, change: FireChange, now: SimTime, fires: &FireField, queue: &mut SimQueue) -> bool {
        let mut is_heard = false;
        for news in TriggerEvent::of_change(change, fires) {
            for &entity in &self.roster.0 {
                let Ok((agent, WakeTriggers(triggers))) = self.agents.get(entity) else { continue };
                if let Some(event) = triggers.iter().find_map(|trigger| trigger.wakes(agent, news, now)) {
                    queue.push_for(now, event, agent.wake(entity));
                    is_heard = true;
                }
            }
        }
        is_heard
    }
}

/// Drops what is next as long as it is for an agent that has changed its mind, or is no longer there.
fn drop_void_events(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, agents: Query<&Agent>) {
    while let Some(&Due::Agent(_, wake)) = queue.next(clock.0) {
        if agents.get(wake.agent).is_ok_and(|agent| agent.revision == wake.revision) {
            return;
        }
        queue.drop_next();
    }
}

/// Lets agents that were woken decide again: who stands begins again, who is under way goes on meanwhile.
fn replan(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, mut agents: Query<&mut Agent>) {
    while let Some(wake) = queue.take_for(clock.0, AgentEvent::Replan, |_| true) {
        match agents.get_mut(wake.agent) {
            Ok(mut agent) if agent.is_free() => agent.reconsider(wake.agent, clock.0, &mut queue),
            Ok(mut agent) => {
                agent.is_called = true;
                queue.push_for(clock.0, AgentEvent::Decision, agent.wake(wake.agent));
            }
            Err(_) => {}
        }
    }
}

/// Charged planning time is over: the agent moves, or decides again if its plan had failed or it filled its tank.
fn finish_planning(clock: Res<SimClock>, mut queue: ResMut<SimQueue>, mut agents: Query<&mut Agent>) {
    while let Some(wake) = queue.take_for(clock.0, AgentEvent::PlanningDone, |_| true) {
        let Ok(mut agent) = agents.get_mut(wake.agent) else { continue };
        if agent.revision != wake.revision {
            continue;
        }
        if agent.goal.is_some() {
            agent.activity = Activity::Moving;
        } else {
            agent.activity = Activity::Idle;
            agent.reconsider(wake.agent, clock.0, &mut queue);
        }
    }
}
