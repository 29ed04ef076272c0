//! The recorder of searches: what a query examined, as graphs to show.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use wildfire_base::query::{MAX_SEARCH_EDGES, SearchGraph, SearchPhase};

/// The places that one phase of a query examined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Searched {
    pub phase: SearchPhase,
    pub graph: SearchGraph,
}

/// Collects what the searches of a query examined, if requested.
#[derive(Debug, Default)]
pub struct SearchRecorder {
    is_on: bool,
    graphs: BTreeMap<SearchPhase, GraphOfLines>,
}

/// A graph that grows by lines.
///
/// Places to the centimetre and edges are kept once, so that searches which follow each other share them.
#[derive(Debug, Default)]
struct GraphOfLines {
    graph: SearchGraph,
    /// The index of each place in the graph.
    indices: BTreeMap<(i32, i32), u32>,
    edges: BTreeSet<(u32, u32)>,
}

impl SearchRecorder {
    pub fn new(is_on: bool) -> Self {
        Self { is_on, graphs: BTreeMap::new() }
    }

    /// Adds straight lines in the order in which they were examined, in metres; a search begins with a line of length
    /// zero. Without recording the lines are not requested.
    pub fn add(&mut self, phase: SearchPhase, lines: impl IntoIterator<Item = [DVec2; 2]>) {
        if !self.is_on {
            return;
        }
        let recorded = self.graphs.entry(phase).or_default();
        for ends in lines {
            // Lines after the limit are not even asked for, so that nobody works them out.
            if recorded.graph.edges.len() == MAX_SEARCH_EDGES {
                return;
            }
            let [from, to] = ends.map(|place| recorded.index_of(place));
            if from != to && recorded.edges.insert((from, to)) {
                recorded.graph.edges.push((from, to));
            }
        }
    }

    /// Returns the recorded lines, in the order of the phases.
    pub fn finish(self) -> Vec<Searched> {
        let graphs = self.graphs.into_iter().map(|(phase, recorded)| Searched { phase, graph: recorded.graph });
        graphs.filter(|searched| !searched.graph.places.is_empty()).collect()
    }
}

impl GraphOfLines {
    fn index_of(&mut self, place: DVec2) -> u32 {
        let centimetres = (place * 100.0).round();
        let place = (centimetres.x as i32, centimetres.y as i32);
        *self.indices.entry(place).or_insert_with(|| {
            self.graph.places.push(place);
            self.graph.places.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: f64, to: f64) -> [DVec2; 2] {
        [DVec2::new(from, 1.0), DVec2::new(to, 1.0)]
    }

    fn recorded(lines: impl IntoIterator<Item = [DVec2; 2]>) -> SearchGraph {
        let mut recorder = SearchRecorder::new(true);
        recorder.add(SearchPhase::Walk, lines);
        let searched = recorder.finish();
        assert_eq!((searched.len(), searched[0].phase), (1, SearchPhase::Walk));
        searched[0].graph.clone()
    }

    #[test]
    fn searches_that_follow_each_other_share_places_and_edges() {
        let mut recorder = SearchRecorder::new(true);
        recorder.add(SearchPhase::Local, [line(0.0, 0.0), line(0.0, 2.5), line(2.5, -1.004)]);
        recorder.add(SearchPhase::Query, [line(3.0, 3.0)]);
        recorder.add(SearchPhase::Local, [line(0.001, 2.499), line(0.0, -1.0), line(7.0, 7.0)]);
        let [query, local] = recorder.finish().try_into().expect("there are two phases");
        assert_eq!((query.phase, query.graph.places), (SearchPhase::Query, vec![(300, 100)]));
        let Searched { phase, graph } = local;
        assert_eq!(phase, SearchPhase::Local);
        assert_eq!(graph.places, [(0, 100), (250, 100), (-100, 100), (700, 100)]);
        assert_eq!(graph.edges, [(0, 1), (1, 2), (0, 2)]);
        let lines: Vec<_> = graph.lines().collect();
        assert_eq!(lines, [line(0.0, 2.5), line(2.5, -1.0), line(0.0, -1.0)]);
        let again = recorded(graph.lines());
        assert_eq!((again.places.len(), again.edges), (3, graph.edges), "lines become what they were of");
    }

    #[test]
    fn what_is_not_wanted_is_not_requested() {
        let mut recorder = SearchRecorder::new(false);
        recorder.add(SearchPhase::Local, std::iter::once_with(|| unreachable!("nobody asked")));
        assert_eq!(recorder.finish(), []);
    }

    #[test]
    fn the_first_edges_are_kept_and_no_more_is_requested() {
        let graph = recorded((0..).map(|place| line(f64::from(place), f64::from(place) + 1.0)));
        assert_eq!((graph.edges.len(), graph.places.len()), (MAX_SEARCH_EDGES, MAX_SEARCH_EDGES + 1));
        assert_eq!(graph.edges[0], (0, 1));
    }
}
