//! One pass over the world: the order of its systems, and what makes an ambiguous order an error.
//!
//! Ranks decide what happens first at one instant ([`Rank`](super::queue::Rank)); a system acts only on what is next in
//! the queue. A pass therefore may do little, and the instant is over when nothing more is due at it.

use super::queue::{Due, SimClock, SimQueue};
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor};

/// The schedule of one pass.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Pass;

/// The sets of systems of a pass, in their order.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum SimSystems {
    /// Bushes ignite, burn out and are extinguished, until an agent hears of a change.
    Fire,
    /// Agents that heard of a change look again.
    Wake,
    Wumpus,
    Truck,
    /// Trucks that block one another.
    Traffic,
    End,
}

/// The plugin that orders the sets, on one thread.
#[derive(Debug)]
pub struct SchedulePlugin;

impl Plugin for SchedulePlugin {
    fn build(&self, app: &mut App) {
        app.init_schedule(Pass);
        app.edit_schedule(Pass, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
            schedule.set_build_settings(ScheduleBuildSettings {
                // Two systems without an order between them could run in either, and a run must be the same each time.
                ambiguity_detection: LogLevel::Error,
                ..ScheduleBuildSettings::default()
            });
        });
        use SimSystems::{End, Fire, Traffic, Truck, Wake, Wumpus};
        // Sets of systems that would find nothing to act on are left out: most passes are about one of them.
        let fire = Fire.run_if(fire_is_next);
        let wake = Wake.run_if(agent_is_next);
        let wumpus = Wumpus.run_if(agent_is_next);
        let truck = Truck.run_if(agent_is_next);
        let traffic = Traffic.run_if(agent_is_next);
        app.configure_sets(Pass, (fire, wake, wumpus, truck, traffic, End).chain());
    }
}

/// Returns whether what is next is due now and concerns no agent.
fn fire_is_next(clock: Res<SimClock>, queue: Res<SimQueue>) -> bool {
    queue.next(clock.0).is_some_and(|due| !matches!(due, Due::Agent(..)))
}

/// Returns whether what is next is due now and concerns an agent.
fn agent_is_next(clock: Res<SimClock>, queue: Res<SimQueue>) -> bool {
    queue.next(clock.0).is_some_and(|due| matches!(due, Due::Agent(..)))
}
