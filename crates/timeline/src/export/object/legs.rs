//! Legs: the ways that agents followed, with their clocks.

use schemars::JsonSchema;
use serde::Serialize;

use super::{AgentLabel, PoseObject};
use crate::{FollowedLeg, RunIndex, Timeline};
use wildfire_base::geometry::Pose;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Piece;

/// A leg, and whose it is.
#[derive(Clone, Copy)]
pub struct LegOfAgent {
    agent: usize,
    leg: FollowedLeg,
    until: SimTime,
}

/// All legs of a run, agent by agent, in order of time.
pub struct LegTable {
    legs: Vec<LegOfAgent>,
    /// By event, the leg that begins with it.
    of_event: Vec<Option<u32>>,
}

impl LegTable {
    pub fn new(index: &RunIndex<'_>) -> Self {
        let timeline = index.timeline();
        let mut table = Self { legs: Vec::new(), of_event: vec![None; timeline.events.len()] };
        for agent in 0..timeline.setting.agents.len() {
            for &leg in index.legs_of(agent) {
                table.of_event[leg.fact()] = Some(table.legs.len() as u32);
                table.legs.push(LegOfAgent { agent, leg, until: leg.until.min(index.end_time()) });
            }
        }
        table
    }

    pub fn iter(&self) -> impl Iterator<Item = LegOfAgent> + '_ {
        self.legs.iter().copied()
    }

    /// Returns the place of the leg that begins with an event.
    pub fn leg_of(&self, event: usize) -> Option<u32> {
        self.of_event[event]
    }
}

/// A path that an agent followed. Before it begins the agent stands at its start, after its last piece at its end.
#[derive(Serialize, JsonSchema)]
pub struct LegObject {
    agent: AgentLabel,
    /// The place among the events of the one that it began with.
    event: usize,
    /// From when on the agent followed it.
    from_ns: u64,
    /// Until when: the next leg began, or the run ended.
    until_ns: u64,
    /// When its first piece begins; until then planning time is charged.
    begins_ns: u64,
    start: PoseObject,
    /// In order, including pieces that the agent did not reach.
    pieces: Vec<PieceObject>,
}

/// A stretch of motion.
#[derive(Serialize, JsonSchema)]
pub struct PieceObject {
    /// Where it begins.
    start: PoseObject,
    /// How long it takes, in seconds.
    lasts_s: f64,
    #[serde(flatten)]
    motion: Motion,
}

/// What a piece is.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "motion", rename_all = "kebab-case")]
enum Motion {
    /// Along an arc, or a straight line if the curvature is 0, at constant acceleration.
    Drive {
        /// In 1/m, positive to the left.
        curvature: f64,
        /// Negative in reverse.
        length_m: f64,
        /// At its start, never negative.
        speed_mps: f64,
        /// The change of this speed.
        acceleration_mps2: f64,
    },
    /// On the spot, at once.
    Turn { heading_rad: f64 },
    /// Standing.
    Wait,
}

impl LegObject {
    pub fn new(LegOfAgent { agent, leg, until }: LegOfAgent, timeline: &Timeline) -> Self {
        let trajectory = leg.trajectory(timeline);
        Self {
            agent: AgentLabel(timeline.setting.agents[agent].id),
            event: leg.fact(),
            from_ns: leg.from.as_nanos(),
            until_ns: until.as_nanos(),
            begins_ns: trajectory.start_time().as_nanos(),
            start: trajectory.start().into(),
            pieces: trajectory.pieces_with_starts().map(PieceObject::from).collect(),
        }
    }
}

impl From<(Pose, &Piece)> for PieceObject {
    fn from((start, piece): (Pose, &Piece)) -> Self {
        let motion = match *piece {
            Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                Motion::Drive { curvature: segment.curvature, length_m: segment.length_m, speed_mps, acceleration_mps2 }
            }
            Piece::Turn { heading } => Motion::Turn { heading_rad: heading },
            Piece::Wait { .. } => Motion::Wait,
        };
        Self { start: start.into(), lasts_s: piece.duration_s(), motion }
    }
}
