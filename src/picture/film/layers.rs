//! What of a run is shown, to be switched on and off.

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
    /// What the last query of the roadmap looked at.
    Query,
    /// What the last local search of a truck expanded.
    LocalSearch,
    /// What the last search of a Wumpus expanded.
    WumpusSearch,
    /// Distance to the nearest bush or the field's edge.
    Clearance,
    CostMap,
    /// Cost to go to a truck's goal.
    Wavefront,
}

impl Layer {
    pub const ALL: [Self; 12] = [
        Self::Paths,
        Self::Suppression,
        Self::Spread,
        Self::Ages,
        Self::GridLines,
        Self::Roadmap,
        Self::Query,
        Self::LocalSearch,
        Self::WumpusSearch,
        Self::Clearance,
        Self::CostMap,
        Self::Wavefront,
    ];

    /// As the command line writes it, and the legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paths => "paths",
            Self::Suppression => "suppression",
            Self::Spread => "spread",
            Self::Ages => "ages",
            Self::GridLines => "grid-lines",
            Self::Roadmap => "roadmap",
            Self::Query => "prm-query",
            Self::LocalSearch => "local-search",
            Self::WumpusSearch => "wumpus-search",
            Self::Clearance => "clearance",
            Self::CostMap => "cost-map",
            Self::Wavefront => "wavefront",
        }
    }

    /// Whether it shows what only a run with recorded searches holds.
    pub fn needs_searches(self) -> bool {
        matches!(self, Self::Roadmap | Self::Query | Self::LocalSearch | Self::WumpusSearch)
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers(u16);

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

    fn bit(layer: Layer) -> u16 {
        1 << layer as u16
    }
}

impl FromIterator<Layer> for Layers {
    fn from_iter<I: IntoIterator<Item = Layer>>(layers: I) -> Self {
        layers.into_iter().fold(Self::NONE, Self::with)
    }
}

impl Default for Layers {
    /// Paths and all that fire does.
    fn default() -> Self {
        [Layer::Paths, Layer::Suppression, Layer::Spread, Layer::Ages].into_iter().collect()
    }
}
