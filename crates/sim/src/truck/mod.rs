//! The fire truck: the drive to a fire, and the dwell that extinguishes it.
//!
//! A goal whose plan fails is set aside while it burns. If the scenario lets the truck be rescued, it is tried again when
//! nothing else is left: then the reachability flood answers, and where
//! it says yes the truck gets there: by a large lattice search from where it stands, by backing out the way it came
//! until its planner finds a path, or, if both fail, back along all its tracks to its start and from there by the
//! flood's own path.

mod decision;
mod drive;
mod fleet;
mod spawn;
mod team;
mod tracks;
mod water;

use std::sync::Arc;

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;

use crate::shared::Shared;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{GroundSpeed, SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path};
use wildfire_planning::collision::CollisionChecker;
use wildfire_planning::reachability::Reachability;
use wildfire_planning::registry::Charge;
use wildfire_planning::{Effort, TruckPlanner};
use wildfire_scenario::TrafficRules;
use wildfire_timeline::WaterRules;

pub use drive::{Blocked, Drive};
pub use fleet::Fleet;
pub use spawn::spawn;

use super::schedule::{Pass, SimSystems};
use decision::DecisionState;
use team::UnreachableStaging;
use tracks::Tracks;

/// The plugin in which trucks drive and extinguish fires.
#[derive(Debug)]
pub struct TruckPlugin;

impl Plugin for TruckPlugin {
    fn build(&self, app: &mut App) {
        let systems = (fleet::lose_goal, fleet::end_dwell, fleet::arrive, decision::decide);
        app.add_systems(Pass, systems.chain().in_set(SimSystems::Truck));
    }
}

/// A truck's rules, planners and knowledge.
#[derive(Component, Clone)]
pub struct Truck {
    pub body: Dimensions,
    pub speed: SpeedLimits,
    /// Ground on which it is slow.
    ground: Option<GroundSpeed>,
    /// Infinite where the scenario has no rule of distance.
    reach_m: f64,
    dwell: SimTime,
    extinguishes_all: bool,
    /// For how long a stop wets what does not burn in reach, if it does.
    wets: Option<SimTime>,
    charge: Charge,
    planner: Shared<Box<dyn TruckPlanner>>,
    /// Whether goals that the planner failed on are driven by what the flood knows.
    is_rescued: bool,
    reachability: Shared<Reachability>,
    /// Goals that the planner failed on, while they burn.
    failed_goals: Vec<Cell>,
    /// Goals that the flood does not reach.
    out_of_reach: Vec<Cell>,
    tracks: Tracks,
    pub checker: CollisionChecker,
    /// What it tries before it waits for others.
    traffic: TrafficRules,
    /// The drives that it would take if no other trucks blocked them, best first. Plans are kept, because it stays in
    /// place.
    pub blocked: Vec<Blocked>,
    deliberation: Option<DecisionState>,
    /// The rules of water, if there are any.
    water: Option<Arc<WaterRules>>,
    /// The cells that its present stop puts out, and the episode of each; only where heat matters.
    extinguish_set: Option<Vec<(Cell, u32)>>,
    /// Places that it found no way to.
    closed_posts: Vec<UnreachableStaging>,
}

impl Truck {
    /// Plans from now on as another truck on the same field does.
    pub fn plan_like(&mut self, other: &Self) {
        self.planner = other.planner.clone();
        (self.charge, self.is_rescued, self.traffic) = (other.charge, other.is_rescued, other.traffic.clone());
        self.failed_goals.clear();
    }

    /// Returns a drive along a path as fast as its limits and the ground allow.
    pub fn leg(&self, path: &Path, sets_out: SimTime) -> Trajectory {
        match &self.ground {
            None => Trajectory::from_path(path, sets_out, self.speed),
            Some(ground) => Trajectory::over_ground(path, sets_out, self.speed, ground),
        }
    }

    /// Returns the planning time charged for an effort.
    pub fn charge(&self, effort: &Effort) -> SimTime {
        let Charge { roadmap_s, local_s } = self.charge;
        let seconds = roadmap_s * f64::from(effort.roadmap_expansions) + local_s * f64::from(effort.local_expansions);
        SimTime::from_seconds(seconds)
    }
}
