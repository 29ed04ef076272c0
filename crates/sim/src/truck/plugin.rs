//! When in a pass trucks act, and in which order.

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;

use super::{decision, fleet};
use crate::schedule::{Pass, SimSystems};

/// The plugin in which trucks drive and extinguish fires.
#[derive(Debug)]
pub struct TruckPlugin;

impl Plugin for TruckPlugin {
    fn build(&self, app: &mut App) {
        let systems = (fleet::lose_goal, fleet::end_dwell, fleet::arrive, decision::decide);
        app.add_systems(Pass, systems.chain().in_set(SimSystems::Truck));
    }
}
