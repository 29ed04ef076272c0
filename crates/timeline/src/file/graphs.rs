//! Graphs of searches: an edge by how far its end lies from that of the edge before and how far its beginning lies
//! from its end in the list of places, a place by how far it is from the one that the first edge from an earlier place
//! to it comes from, or else from the place before it. All are steps that are small and recur.

use super::{FileError, append, take};
use wildfire_base::query::SearchGraph;

const NO_SUCH_PLACE: FileError = FileError::Damaged("a search in it leads to a place that it does not contain");

/// Appends the edges of a graph, then its places.
pub fn append_graph(bytes: &mut Vec<u8>, graph: &SearchGraph) {
    let mut last = 0;
    for &(from, to) in &graph.edges {
        append(bytes, &(to.wrapping_sub(last).cast_signed(), to.wrapping_sub(from).cast_signed()));
        last = to;
    }
    // A place is told from its first edge, so the edges come before the places.
    let origins = origins(graph.places.len(), &graph.edges);
    for (index, &(x, y)) in graph.places.iter().enumerate() {
        let (origin_x, origin_y) = origin(origins[index], &graph.places[..index]);
        append(bytes, &(x.wrapping_sub(origin_x), y.wrapping_sub(origin_y)));
    }
}

/// Reads a graph of these numbers of places and edges from the front of some bytes.
pub fn take_graph(bytes: &mut &[u8], places: u32, edges: u32) -> Result<SearchGraph, FileError> {
    let mut graph = SearchGraph::default();
    let mut last = 0_u32;
    for _ in 0..edges {
        let (step, back) = take::<(i32, i32)>(bytes)?;
        // A file may hold any steps; numbers that wrap around are out of range below.
        let to = last.wrapping_add_signed(step);
        let from = to.wrapping_sub(back.cast_unsigned());
        if from >= places || to >= places {
            return Err(NO_SUCH_PLACE);
        }
        graph.edges.push((from, to));
        last = to;
    }
    for first in origins(places as usize, &graph.edges) {
        let (x, y) = origin(first, &graph.places);
        let (east, north) = take::<(i32, i32)>(bytes)?;
        graph.places.push((x.wrapping_add(east), y.wrapping_add(north)));
    }
    Ok(graph)
}

/// By place: where the first edge comes from that leads to it from an earlier one.
fn origins(places: usize, edges: &[(u32, u32)]) -> Vec<Option<u32>> {
    let mut origins = vec![None; places];
    // A place is read after those before it, so only one of those can be its origin.
    for &(from, to) in edges.iter().filter(|(from, to)| from < to) {
        origins[to as usize].get_or_insert(from);
    }
    origins
}

/// Returns the place from which the step to the place after some others is written.
fn origin(first: Option<u32>, before: &[(i32, i32)]) -> (i32, i32) {
    first.map_or_else(|| before.last().copied().unwrap_or_default(), |first| before[first as usize])
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

    use super::*;
    use wildfire_base::rng;

    fn assert_comes_back(graph: &SearchGraph) {
        let mut bytes = Vec::new();
        append_graph(&mut bytes, graph);
        let mut rest = &bytes[..];
        let places = graph.places.len() as u32;
        let edges = graph.edges.len() as u32;
        assert_eq!(&take_graph(&mut rest, places, edges).expect("it was written"), graph);
        assert!(rest.is_empty());
    }

    #[test]
    fn graphs_of_any_shape_come_back() {
        assert_comes_back(&SearchGraph::default());
        let extreme = [i32::MIN, -1, 0, 1, i32::MAX];
        let mut rng = rng::stream(1, "timeline/file/graphs");
        for _ in 0..300 {
            let coordinate = |rng: &mut rng::Xoshiro256PlusPlus| match rng.random_range(0..4) {
                0 => extreme[rng.random_range(0..extreme.len())],
                _ => rng.random_range(0..25_000),
            };
            let count = rng.random_range(1..40);
            let places = (0..count).map(|_| (coordinate(&mut rng), coordinate(&mut rng))).collect();
            let end = |rng: &mut rng::Xoshiro256PlusPlus| rng.random_range(0..count);
            let edges = (0..rng.random_range(0..80)).map(|_| (end(&mut rng), end(&mut rng))).collect();
            assert_comes_back(&SearchGraph { places, edges });
        }
    }

    #[test]
    fn a_tree_on_a_lattice_takes_six_bytes_a_place_before_deflation() {
        let places: Vec<_> = (0..1000).map(|at| (12_500 + 500 * (at % 50), 12_500 + 500 * (at / 50))).collect();
        let edges: Vec<_> = (1..1000).map(|to| (to - if to < 50 { 1 } else { 50 }, to)).collect();
        let mut bytes = Vec::new();
        append_graph(&mut bytes, &SearchGraph { places, edges });
        assert!(bytes.len() < 6 * 1000, "{} bytes", bytes.len());
    }

    #[test]
    fn edges_to_nowhere_and_counts_that_the_bytes_do_not_hold_are_errors() {
        let mut bytes = Vec::new();
        append_graph(&mut bytes, &SearchGraph { places: vec![(1, 2), (3, 4)], edges: vec![(0, 1)] });
        for (places, edges) in [(1, 1), (0, 1), (3, 1), (2, 2), (2, u32::MAX), (8_000_000, 1)] {
            assert!(take_graph(&mut &bytes[..], places, edges).is_err(), "{places} places, {edges} edges");
        }
    }

    #[test]
    fn random_bytes_give_graphs_without_stray_edges_or_errors() {
        let mut rng = rng::stream(2, "timeline/file/graphs");
        let mut whole = 0;
        for _ in 0..3_000 {
            let mut noise = [0; 24];
            rng.fill_bytes(&mut noise);
            noise.iter_mut().for_each(|byte| *byte %= 8);
            if let Ok(graph) = take_graph(&mut &noise[..], 6, 5) {
                assert!(graph.edges.iter().all(|&(from, to)| from < 6 && to < 6));
                whole += 1;
            }
        }
        assert!(whole > 10, "{whole} could be read");
    }
}
