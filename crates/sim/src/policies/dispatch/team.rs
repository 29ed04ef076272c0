//! A team of trucks before one decision, as the rules of dispatch see it: trucks, fires with deadlines, and the rules that
//! say how fast things happen. Lengths in metres in the frame of the field, speeds in m/s.

use std::sync::Arc;

use glam::DVec2;

use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_timeline::{AgentId, WaterRules};

/// A drive is longer than the straight line by this factor, on the fields of the contest.
pub const WAY_FACTOR: f64 = 1.12;

/// A place to wait this near to where a truck is, or to where it was sent, is as good, in metres.
pub const AS_GOOD_M: f64 = 20.0;

/// A cell that burns, and that no truck stands at to put it out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fire {
    pub cell: Cell,
    /// Its centre.
    pub place: DVec2,
    pub since: SimTime,
    /// When it burns out; `SimTime::MAX` if it never does.
    pub burns_out: SimTime,
    /// When it sets on fire what grows around it, if it still burns then; `SimTime::MAX` if it has done so or never does.
    pub spreads_at: SimTime,
}

/// A truck of the team.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TeamTruck {
    pub id: AgentId,
    /// The middle of its body when it is next free to set out.
    pub place: DVec2,
    /// When it is: now, unless it has to end something first, or to fill its tank.
    pub free_at: SimTime,
    pub speed_mps: f64,
    /// The fire that it goes for or puts out.
    pub goal: Option<Cell>,
    /// The place that it has been sent to, if it is on its way there or waits there.
    pub post: Option<DVec2>,
    /// Where it began the run.
    pub start: DVec2,
    /// True if a decision may give it another goal: it is free, or it is under way and may change its mind, and its tank
    /// suffices for a stop.
    pub is_asked: bool,
    /// The stops that its tank suffices for; `u32::MAX` where water does not matter.
    pub stops_left: u32,
}

/// The rules that decide what can be saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TeamRules {
    /// How near the middle of a truck has to be to a fire; `None` if that does not matter.
    pub reach_m: Option<f64>,
    /// How long it has to stand there.
    pub dwell: SimTime,
    /// True if a stop puts out all that burns in reach.
    pub extinguishes_all: bool,
    /// How far fire goes from a burning bush, once, and after which time; `None` where another model says so.
    pub spread: Option<(f64, SimTime)>,
    /// True if what caught fire from another bush spreads too, and not only what was lit.
    pub caught_spreads: bool,
    /// How long a bush burns; `None` if forever.
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
    /// What burns and is seen, by cell index.
    pub fires: Vec<Fire>,
    /// All trucks, by number.
    pub trucks: Vec<TeamTruck>,
    /// The bushes that are intact, as far as the team knows, by cell index; read-only and cheap to hand on.
    pub intact: &'a dyn Intact,
    /// The Wumpuses' places, where the team may see them.
    pub wumpuses: Vec<DVec2>,
    /// The rules of water, if there are any.
    pub water: Option<&'a WaterRules>,
}

/// What a team knows of bushes that do not burn.
pub trait Intact {
    /// Says whether an intact bush is known to grow on a cell.
    fn is_intact(&self, cell: Cell) -> bool;

    /// Lists the cells of all bushes of the run, by cell index.
    fn bushes(&self) -> Arc<[Cell]>;
}

impl std::fmt::Debug for dyn Intact + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Intact")
    }
}

impl Team<'_> {
    /// Estimates where a truck that drives from here to water has a full tank, and when; it sets out at `time` with the water
    /// for some stops.
    pub fn refilled(&self, speed_mps: f64, from: DVec2, time: SimTime, stops_left: u32) -> (DVec2, SimTime) {
        let Some(water) = self.water else { return (from, time) };
        let place = water.nearest(from);
        let metres = ((place - from).length() - water.reach_m).max(0.0);
        let drive = SimTime::from_seconds(WAY_FACTOR * metres / speed_mps);
        (place, time + drive + water.fill_time(stops_left))
    }

    /// Estimates the time of a truck's drive between two places, to within reach of the second.
    pub fn drive_time(&self, speed_mps: f64, from: DVec2, to: DVec2) -> SimTime {
        let metres = ((to - from).length() - self.rules.reach_m.unwrap_or_default()).max(0.0);
        SimTime::from_seconds(WAY_FACTOR * metres / speed_mps)
    }
}

/// Says which fire each truck of a team goes for.
pub trait Assignment: Send + Sync {
    /// Returns the goals of trucks that are asked; those that are left out have nothing to go for. No cell is given twice.
    /// Adds what it looked at to `effort`, in pairs of a truck and a fire, or in rollouts.
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)>;

    /// Says whether trucks that are under way are asked again when a fire begins or ends.
    fn replans(&self) -> bool;

    /// Says whether trucks that get a goal go for the fire that is nearest by drive instead, as their planners find.
    fn is_by_drive(&self) -> bool {
        false
    }
}

/// Says where trucks wait that have nothing to go for.
pub trait Positioning: Send + Sync {
    /// Returns places for some of these trucks, which are asked and have no goal; the others stay where they are.
    fn post(&mut self, team: &Team<'_>, idle: &[AgentId]) -> Vec<(AgentId, DVec2)>;
}
