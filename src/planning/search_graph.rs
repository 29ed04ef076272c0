//! What a search looked at, to be shown.
//!
//! World frame. Places are those of a truck's rear axle, but of its body's centre in the roadmap of `prm+primitives` and
//! queries of it, which know no headings, and lattice points of a Wumpus. What was driven in curves is told by straight
//! lines.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A graph has no more edges; what a search looked at after that is left out.
pub const MAX_SEARCH_EDGES: usize = 20_000;

/// Which search a [`SearchGraph`] is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

/// What one phase of a query looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Searched {
    pub phase: SearchPhase,
    pub graph: SearchGraph,
}

/// Puts together what the searches of a query looked at, if that is wanted.
///
/// Places to the centimetre and edges are kept once, so that searches which follow each other share them.
#[derive(Debug, Default)]
pub struct SearchRecorder {
    is_on: bool,
    graph: SearchGraph,
    /// Where in the graph a place is.
    indices: BTreeMap<(i32, i32), u32>,
    edges: BTreeSet<(u32, u32)>,
}

impl SearchRecorder {
    pub fn switch_on(&mut self) {
        self.is_on = true;
    }

    /// Adds straight lines in the order in which they were looked at, in metres; where a search began there is a line
    /// of length zero. The lines are not asked for where nothing is recorded.
    pub fn add(&mut self, lines: impl IntoIterator<Item = [DVec2; 2]>) {
        if !self.is_on {
            return;
        }
        for ends in lines {
            if self.graph.edges.len() == MAX_SEARCH_EDGES {
                return;
            }
            let [from, to] = ends.map(|place| self.index_of(place));
            if from != to && self.edges.insert((from, to)) {
                self.graph.edges.push((from, to));
            }
        }
    }

    fn index_of(&mut self, place: DVec2) -> u32 {
        let centimetres = (place * 100.0).round();
        let place = (centimetres.x as i32, centimetres.y as i32);
        *self.indices.entry(place).or_insert_with(|| {
            self.graph.places.push(place);
            self.graph.places.len() as u32 - 1
        })
    }

    /// What was added since the last time, if anything.
    pub fn take(&mut self, phase: SearchPhase) -> Option<Searched> {
        let Self { graph, .. } = std::mem::replace(self, Self { is_on: self.is_on, ..Self::default() });
        (!graph.places.is_empty()).then_some(Searched { phase, graph })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: f64, to: f64) -> [DVec2; 2] {
        [DVec2::new(from, 1.0), DVec2::new(to, 1.0)]
    }

    #[test]
    fn searches_that_follow_each_other_share_places_and_edges() {
        let mut recorder = SearchRecorder::default();
        recorder.switch_on();
        recorder.add([line(0.0, 0.0), line(0.0, 2.5), line(2.5, -1.004)]);
        recorder.add([line(0.001, 2.499), line(0.0, -1.0), line(7.0, 7.0)]);
        let Searched { phase, graph } = recorder.take(SearchPhase::Walk).expect("there are places");
        assert_eq!(phase, SearchPhase::Walk);
        assert_eq!(graph.places, [(0, 100), (250, 100), (-100, 100), (700, 100)]);
        assert_eq!(graph.edges, [(0, 1), (1, 2), (0, 2)]);
        let lines: Vec<_> = graph.lines().collect();
        assert_eq!(lines, [line(0.0, 2.5), line(2.5, -1.0), line(0.0, -1.0)]);
        recorder.add(graph.lines());
        let again = recorder.take(SearchPhase::Walk).expect("there are places");
        assert_eq!((again.graph.places.len(), again.graph.edges), (3, graph.edges), "lines become what they were of");
    }

    #[test]
    fn what_is_not_wanted_is_not_asked_for() {
        let mut recorder = SearchRecorder::default();
        recorder.add(std::iter::once_with(|| unreachable!("nobody asked")));
        assert_eq!(recorder.take(SearchPhase::Local), None);
    }

    #[test]
    fn the_first_edges_are_kept_and_no_more_is_asked_for() {
        let mut recorder = SearchRecorder::default();
        recorder.switch_on();
        recorder.add((0..).map(|place| line(f64::from(place), f64::from(place) + 1.0)));
        let graph = recorder.take(SearchPhase::Local).expect("there are places").graph;
        assert_eq!((graph.edges.len(), graph.places.len()), (MAX_SEARCH_EDGES, MAX_SEARCH_EDGES + 1));
        assert_eq!(graph.edges[0], (0, 1));
    }
}
