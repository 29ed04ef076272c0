//! A team of trucks before a decision, as dispatch rules see it: trucks, fires with deadlines, and the rules that
//! determine how fast things happen. Lengths are in metres in the frame of the field, speeds in m/s.

use std::sync::Arc;

use dyn_clone::DynClone;
use glam::DVec2;

use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_timeline::{AgentId, WaterRules};

/// The mean ratio of the length of a drive to the straight distance, on the fields of the contest.
pub const WAY_FACTOR: f64 = 1.12;

/// The distance in metres within which two places to wait are equally good.
pub const AS_GOOD_M: f64 = 20.0;

/// A burning cell at which no truck stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fire {
    pub cell: Cell,
    /// The centre of the cell.
    pub place: DVec2,
    pub since: SimTime,
    /// The time of its burn-out; `SimTime::MAX` if it never burns out.
    pub burns_out: SimTime,
    /// The time at which it ignites what grows around it, if it still burns then; `SimTime::MAX` if it has done so or
    /// never does.
    pub spreads_at: SimTime,
}

/// A truck of the team.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TeamTruck {
    pub id: AgentId,
    /// The centre of its body when it is next free to set out.
    pub place: DVec2,
    /// The time at which it is free: now, unless it has to finish something or fill its tank first.
    pub free_at: SimTime,
    pub speed_mps: f64,
    /// The fire that it drives to or extinguishes.
    pub goal: Option<Cell>,
    /// The place that it has been sent to, if it is driving there or waits there.
    pub staging_point: Option<DVec2>,
    /// The position at which it began the run.
    pub start: DVec2,
    /// True if a decision may assign it another goal: it is free, or it is driving and may change its mind, and its
    /// tank lasts for a stop.
    pub is_queried: bool,
    /// The number of stops that its tank lasts for; `u32::MAX` where water does not matter.
    pub stops_left: u32,
}

/// The rules that determine what can be saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TeamRules {
    /// The greatest distance from the centre of a truck to a fire that it can extinguish; `None` if it does not matter.
    pub reach_m: Option<f64>,
    /// The time that a truck has to stand there.
    pub dwell: SimTime,
    /// True if a stop extinguishes everything that burns within reach.
    pub extinguishes_all: bool,
    /// The spread radius of a burning bush and the time until it spreads once; `None` if another model decides.
    pub spread: Option<(f64, SimTime)>,
    /// True if bushes ignited by other bushes spread too, and not only those that were lit.
    pub caught_spreads: bool,
    /// The time until a bush burns out; `None` if it never does.
    pub burn_out: Option<SimTime>,
}

/// The team at one instant.
#[derive(Clone, Debug)]
pub struct Team<'a> {
    pub now: SimTime,
    /// The end of the run.
    pub end: SimTime,
    pub frame: FieldFrame,
    pub rules: TeamRules,
    /// The visible fires, by cell index.
    pub fires: Vec<Fire>,
    /// All trucks by number.
    pub trucks: Vec<TeamTruck>,
    /// The bushes that are intact to the team's knowledge, by cell index; read-only and cheap to pass on.
    pub intact: &'a dyn Intact,
    /// The positions of the Wumpuses, if the team may see them.
    pub wumpuses: Vec<DVec2>,
    /// The rules of water, if there are any.
    pub water: Option<&'a WaterRules>,
}

/// What a team knows about bushes that do not burn.
pub trait Intact {
    /// Returns whether an intact bush is known to grow on a cell.
    fn is_intact(&self, cell: Cell) -> bool;

    /// Lists the cells of all bushes of the run, by cell index.
    fn bushes(&self) -> Arc<[Cell]>;
}

impl std::fmt::Debug for dyn Intact + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Intact")
    }
}

/// Where and when a truck sets out for a place.
#[derive(Clone, Copy, Debug)]
pub struct RouteStart {
    pub place: DVec2,
    pub time: SimTime,
}

impl Team<'_> {
    /// Estimates where and when a truck that drives from here to water has a full tank; it sets out at `time` with
    /// water for some stops.
    pub fn refilled(&self, speed_mps: f64, from: DVec2, time: SimTime, stops_left: u32) -> RouteStart {
        let Some(water) = self.water else { return RouteStart { place: from, time } };
        let place = water.nearest(from);
        // It fills its tank within reach of the water, so that part of the way is not driven.
        let metres = ((place - from).length() - water.reach_m).max(0.0);
        let drive = SimTime::from_seconds(WAY_FACTOR * metres / speed_mps);
        RouteStart { place, time: time + drive + water.fill_time(stops_left) }
    }

    /// Estimates the time of a truck's drive between two places, to within reach of the second.
    pub fn drive_time(&self, speed_mps: f64, from: DVec2, to: DVec2) -> SimTime {
        // It stops as soon as the fire is in reach.
        let metres = ((to - from).length() - self.rules.reach_m.unwrap_or_default()).max(0.0);
        SimTime::from_seconds(WAY_FACTOR * metres / speed_mps)
    }
}

/// Assigns fires to the trucks of a team.
pub trait Assignment: DynClone + Send + Sync {
    /// Returns the goals of trucks that are asked; those that are left out have nothing to go for. No cell is given twice.
    /// Adds what it looked at to `effort`, in pairs of a truck and a fire, or in rollouts.
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)>;

    /// Returns whether trucks that are under way are asked again when a fire begins or ends.
    fn replans(&self) -> bool;

    /// Returns whether trucks that get a goal go for the fire that is nearest by drive instead, as their planners find.
    fn is_by_drive(&self) -> bool {
        false
    }
}

dyn_clone::clone_trait_object!(Assignment);

/// Chooses where trucks without a goal wait.
pub trait StagingRule: DynClone + Send + Sync {
    /// Returns places for some of these trucks, which are asked and have no goal; the others stay where they are.
    fn staging_points(&mut self, team: &Team<'_>, idle: &[AgentId]) -> Vec<(AgentId, DVec2)>;
}

dyn_clone::clone_trait_object!(StagingRule);
