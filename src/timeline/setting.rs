//! Where a run takes place, between whom, and under which rules.

use serde::{Deserialize, Serialize};

use super::AgentId;
use crate::fire::FireRules;
use crate::geometry::{Cell, DVec2, FieldFrame, Pose};
use crate::time::SimTime;
use crate::trajectory::SpeedLimits;
use crate::vehicle::Dimensions;

/// The body of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// A square about its pose, side in metres.
    Square {
        size_m: f64,
    },
    Truck(Dimensions),
}

impl Body {
    /// World position of the body's centre for a pose of its agent.
    pub fn centre(&self, pose: Pose) -> DVec2 {
        match self {
            Self::Square { .. } => pose.position(),
            Self::Truck(body) => body.body_centre(pose),
        }
    }
}

/// An agent as it stands at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgentStart {
    pub id: AgentId,
    pub pose: Pose,
    pub body: Body,
    /// The limits of its speed; `None` where the recording does not say.
    pub limits: Option<SpeedLimits>,
}

/// The rules that readers of facts need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    pub duration: SimTime,
    /// Metres, from body centre to cell centre; `None` is no rule of distance.
    pub suppression_reach_m: Option<f64>,
    pub suppression_dwell: SimTime,
    /// True if a stop puts out all that burns in reach, not only its goal; `None` where the recording does not say.
    pub extinguishes_all: Option<bool>,
    /// The rules of spread and burn-out; `None` where the recording does not say.
    pub fire: Option<FireRules>,
    pub relight: bool,
    pub score_wumpus_ignited: f64,
    pub score_wumpus_burned_out: f64,
    pub score_truck_extinguished: f64,
}

/// Where a run took place, and between whom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    pub scenario: String,
    pub seed: u64,
    pub program_version: String,
    pub frame: FieldFrame,
    /// In the order of cell indices, none twice.
    pub bushes: Vec<Cell>,
    /// Wumpuses first, then trucks, by number.
    pub agents: Vec<AgentStart>,
    pub rules: Rules,
}

impl Setting {
    /// Place of a bush in [`Setting::bushes`]; `None` where nothing grows.
    pub fn bush_index(&self, cell: Cell) -> Option<usize> {
        self.bushes.binary_search_by_key(&(cell.row, cell.col), |bush| (bush.row, bush.col)).ok()
    }

    /// Place of an agent in [`Setting::agents`].
    pub fn agent_index(&self, id: AgentId) -> Option<usize> {
        self.agents.binary_search_by_key(&id, |start| start.id).ok()
    }
}
