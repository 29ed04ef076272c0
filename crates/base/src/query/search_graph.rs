//! Graphs of what searches looked at, to be shown.
//!
//! World frame. Places are those of a truck's rear axle; in the roadmap of `prm+primitives` and queries of it, which know
//! no headings, those of its body's centre; and lattice points of a Wumpus. Straight lines stand for curves.

use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A graph has no more edges; what a search looked at after that is left out.
pub const MAX_SEARCH_EDGES: usize = 20_000;

/// The search that a [`SearchGraph`] is of, in the order in which a query comes to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SearchPhase {
    /// The roadmap itself.
    Roadmap,
    /// A query of the roadmap: the milestones that it settled, each from the place that it came from.
    Query,
    /// A truck's search over motions: the poses that it reached, each from the one that it came from. Searches with
    /// less clearance follow in the same graph, and so do those from the goal, where there are any.
    Local,
    /// A Wumpus's search: the points that it settled, each from the one that it came from. A wavefront comes from the
    /// goal, a descent from the start.
    Walk,
}

impl fmt::Display for SearchPhase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Roadmap => "roadmap",
            Self::Query => "query",
            Self::Local => "local",
            Self::Walk => "walk",
        })
    }
}

/// Places in whole centimetres, and straight connections between them by their place in the list; both are in the order
/// in which they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchGraph {
    pub places: Vec<(i32, i32)>,
    pub edges: Vec<(u32, u32)>,
}

impl SearchGraph {
    /// Both ends of every connection in metres, in the order in which they were found.
    pub fn lines(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let metres = |index: u32| {
            let (x, y) = self.places[index as usize];
            DVec2::new(f64::from(x), f64::from(y)) / 100.0
        };
        self.edges.iter().map(move |&(from, to)| [metres(from), metres(to)])
    }
}
