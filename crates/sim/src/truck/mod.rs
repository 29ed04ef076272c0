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
mod plugin;
mod spawn;
mod team;
mod tracks;
mod water;

use std::sync::Arc;
use std::time::Duration;

use bevy_ecs::prelude::*;
use glam::DVec2;

use crate::agent::Activity;
use crate::shared::Shared;
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{GroundSpeed, SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path};
use wildfire_planning::collision::CollisionChecker;
use wildfire_planning::reachability::Reachability;
use wildfire_planning::registry::Charge;
use wildfire_planning::{Effort, FoundBy, TruckPlanner};
use wildfire_scenario::TrafficRules;
use wildfire_timeline::{AgentId, WaterRules};

pub use fleet::Fleet;
pub use plugin::TruckPlugin;
pub use spawn::spawn;

use tracks::Tracks;

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
        // What the planner before failed on this one may reach, and it has other drives.
        self.failed_goals.clear();
        self.closed_posts.clear();
        self.blocked.clear();
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

/// A decision in progress.
#[derive(Clone, Debug)]
pub struct DecisionState {
    /// The agent's revision when it began.
    revision: u32,
    /// The agent's activity when it began.
    activity: Activity,
    /// The drives that were blocked when it decided last; it has not moved since.
    before: Vec<Blocked>,
    /// The drives that are blocked at present, best first.
    pub blocked: Vec<Blocked>,
    /// Effort of plans that other trucks were in the way of.
    spent: Effort,
    /// What the agent's plans had cost before.
    cpu: Duration,
    /// The planning time of its team that delays its departure.
    pub delay: SimTime,
}

/// A planned drive without a departure time.
#[derive(Clone, Debug)]
pub struct Drive {
    pub goal: Cell,
    pub path: Path,
    /// The metres of the path that lead back over the truck's tracks.
    pub back_m: f64,
    pub effort: Effort,
    pub found_by: FoundBy,
}

impl Drive {
    /// Returns true if the planner had failed on the goal and the drive comes from the reachability flood.
    pub fn is_by_flood(&self) -> bool {
        self.found_by.is_after_failure()
    }
}

/// A drive that another truck blocks.
#[derive(Clone, Debug)]
pub struct Blocked {
    pub drive: Drive,
    pub by: AgentId,
}

/// The goal of a drive, and the truck that blocks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockReason {
    pub goal: Cell,
    pub by: AgentId,
}

impl Blocked {
    pub fn reason(&self) -> BlockReason {
        BlockReason { goal: self.drive.goal, by: self.by }
    }
}

/// A place to which a truck found no path.
#[derive(Clone, Copy, Debug)]
pub struct UnreachableStaging {
    from: Pose,
    to: DVec2,
    /// It is not tried again from there before this time.
    until: SimTime,
}
