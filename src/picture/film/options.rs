//! How a viewer looks at runs.

use super::{Camera, Layers};
use crate::geometry::Cell;
use crate::timeline::AgentId;

/// What the viewer asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selected {
    Bush(Cell),
    Agent(AgentId),
}

/// How a viewer looks at runs: all of a picture that does not follow from the runs and the time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOptions {
    pub camera: Camera,
    /// The agent that the camera goes with, in place of its own centre.
    pub follows: Option<AgentId>,
    pub layers: Layers,
    /// What is told the story of, and in which of the runs.
    pub selected: Option<(usize, Selected)>,
    /// Whether all keys are shown, over everything else.
    pub shows_help: bool,
    /// What a player says about itself; a still says nothing.
    pub status: Option<Status>,
}

/// What a player says about itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    pub is_paused: bool,
    /// Simulated seconds for a second.
    pub speed: f64,
    /// Such as what was saved, or what is being simulated.
    pub message: Option<String>,
}
