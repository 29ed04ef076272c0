//! The viewer's options: camera, layers, what is followed and selected.

use std::fmt;

use crate::film::Camera;
use wildfire_base::geometry::Cell;
use wildfire_base::query::SearchPhase;
use wildfire_timeline::AgentId;

/// The bush or agent that the viewer selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selected {
    Bush(Cell),
    Agent(AgentId),
}

/// The agents that the camera goes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraTarget {
    /// One agent, in the middle.
    Agent(AgentId),
    /// All trucks that do something, as near as all of them are in view; the whole fleet while none does.
    Fleet,
}

impl fmt::Display for CameraTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Agent(agent) => agent.fmt(f),
            Self::Fleet => f.write_str("fleet"),
        }
    }
}

/// The viewer's options: all of a picture that does not follow from the runs and the time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOptions {
    pub camera: Camera,
    /// Whom the camera goes with, in place of its own centre; with the fleet, in place of its own zoom too.
    pub follows: Option<CameraTarget>,
    pub layers: Layers,
    /// The bush or agent whose story is told, and the run that it belongs to.
    pub selected: Option<(usize, Selected)>,
    /// True if all keys are shown, over everything else.
    pub shows_help: bool,
    /// The state of the player; a still has none.
    pub status: Option<Status>,
}

impl ViewOptions {
    /// The one agent that the camera goes with.
    pub fn followed_agent(&self) -> Option<AgentId> {
        match self.follows {
            Some(CameraTarget::Agent(agent)) => Some(agent),
            Some(CameraTarget::Fleet) | None => None,
        }
    }
}

/// The state of a player.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    pub is_paused: bool,
    /// Simulated seconds for a second.
    pub speed: f64,
    /// Such as what was saved, or what is being simulated.
    pub message: Option<String>,
}

/// A part of the picture that can be switched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Ways that agents go: driven, and planned.
    Paths,
    /// Reach and progress of a suppression.
    Suppression,
    /// Rings about a cell that spreads its fire, at the moment of spreading.
    Spread,
    /// Seconds since ignition, on burning cells that are drawn large enough.
    Ages,
    GridLines,
    Roadmap,
    /// The edges that the last query of the roadmap examined.
    Query,
    /// The poses that the last local search of a truck expanded.
    LocalSearch,
    /// The cells that the last search of a Wumpus expanded.
    WumpusSearch,
    /// Distance to the nearest bush or the field's edge.
    Clearance,
    CostMap,
    /// Cost to go to a truck's goal.
    Wavefront,
    /// What grows on the ground, and how steep it is.
    Ground,
    /// Ground and bushes that trucks have wetted, and line.
    Wet,
    /// What embers have lit.
    Embers,
    /// Where the wind blows to, how fast, and where it comes from.
    Wind,
    /// Lines that the front reached at round times.
    Arrival,
    /// Burned ground in the colours of the intensity of its fire.
    Intensity,
    /// Burned ground in the colours of the kind of its fire, where there are trees.
    FireType,
}

wildfire_base::names! { Layer {
    Paths: "paths",
    Suppression: "suppression",
    Spread: "spread",
    Ages: "ages",
    GridLines: "grid-lines",
    Roadmap: "roadmap",
    Query: "prm-query",
    LocalSearch: "local-search",
    WumpusSearch: "wumpus-search",
    Clearance: "clearance",
    CostMap: "cost-map",
    Wavefront: "wavefront",
    Ground: "ground",
    Wet: "wet",
    Embers: "embers",
    Wind: "wind",
    Arrival: "arrival",
    Intensity: "intensity",
    FireType: "fire-type",
} }

impl Layer {
    /// The layers of a run: those of the ground only where there is some.
    pub fn all_of(has_ground: bool) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |layer| has_ground || !layer.needs_ground())
    }

    /// Returns whether only a run with fire on the ground has what it shows.
    pub fn needs_ground(self) -> bool {
        matches!(self, Self::Ground | Self::Wet | Self::Embers | Self::Wind | Self::Arrival)
            || matches!(self, Self::Intensity | Self::FireType)
    }

    /// Returns the layer that shows searches of a phase.
    pub fn for_phase(phase: SearchPhase) -> Self {
        match phase {
            SearchPhase::Roadmap => Self::Roadmap,
            SearchPhase::Query => Self::Query,
            SearchPhase::Local => Self::LocalSearch,
            SearchPhase::Walk => Self::WumpusSearch,
        }
    }

    /// Returns whether only a run with recorded searches has what it shows.
    pub fn needs_searches(self) -> bool {
        matches!(self, Self::Roadmap | Self::Query | Self::LocalSearch | Self::WumpusSearch)
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers(u32);

impl Layers {
    pub const NONE: Self = Self(0);

    pub fn with(self, layer: Layer) -> Self {
        Self(self.0 | Self::bit(layer))
    }

    pub fn without(self, layer: Layer) -> Self {
        Self(self.0 & !Self::bit(layer))
    }

    pub fn toggle(&mut self, layer: Layer) {
        self.0 ^= Self::bit(layer);
    }

    pub fn contains(self, layer: Layer) -> bool {
        self.0 & Self::bit(layer) != 0
    }

    fn bit(layer: Layer) -> u32 {
        1 << layer as u16
    }
}

impl FromIterator<Layer> for Layers {
    fn from_iter<I: IntoIterator<Item = Layer>>(layers: I) -> Self {
        layers.into_iter().fold(Self::NONE, Self::with)
    }
}

impl Default for Layers {
    /// Paths and all that fire does; the ground where there is some, and its wind.
    fn default() -> Self {
        let everywhere = [Layer::Paths, Layer::Suppression, Layer::Spread, Layer::Ages];
        everywhere.into_iter().chain([Layer::Ground, Layer::Wet, Layer::Embers, Layer::Wind]).collect()
    }
}
