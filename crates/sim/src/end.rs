//! The end of a run.

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;

use wildfire_timeline::{EndReason, Fact};

use super::agent::{Activity, Agent};
use super::fire::{Fires, Ignitions};
use super::queue::{Rank, SimClock, SimQueue};
use super::recorder::Recorder;
use super::schedule::{Pass, SimSystems};
use super::wumpus::Wumpus;

/// The plugin that ends runs.
#[derive(Debug)]
pub struct EndPlugin;

impl Plugin for EndPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Ended>();
        app.add_systems(Pass, end.in_set(SimSystems::End));
    }
}

/// True once the run has ended.
#[derive(Resource, Clone, Debug, Default)]
pub struct Ended(pub bool);

/// Ends the run at its time, or when nothing burns, nothing will be lit, and no Wumpus has anything left to do.
fn end(
    clock: Res<SimClock>,
    mut queue: ResMut<SimQueue>,
    mut recorder: ResMut<Recorder>,
    mut ended: ResMut<Ended>,
    (fires, ignitions): (Res<Fires>, Res<Ignitions>),
    wumpuses: Query<(&Agent, &Wumpus)>,
) {
    let now = clock.0;
    let reason = if queue.take(now, Rank::End).is_some() {
        EndReason::Duration
    } else {
        // More may be due at this instant, which the next pass carries out.
        let is_over = queue.next_time() > Some(now)
            && fires.field.burning().len() == 0
            && !fires.model.is_under_way()
            && ignitions.pending == 0
            && wumpuses.iter().all(|(agent, wumpus)| {
                matches!(agent.activity, Activity::Resting(_)) && !wumpus.has_something_to_light(&fires.field)
            });
        if !is_over {
            return;
        }
        EndReason::NothingLeft
    };
    recorder.record(now, Fact::Ended { reason });
    ended.0 = true;
}
