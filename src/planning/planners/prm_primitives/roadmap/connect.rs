use std::num::NonZero;

use glam::DVec2;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use petgraph::Undirected;
use petgraph::csr::Csr;
use petgraph::unionfind::UnionFind;

use super::space::FreeSpace;
use crate::planning::planners::prm_primitives::PrmSettings;

/// For each neighbour wanted, so many of the nearest milestones are looked at, lest dense roadmaps try all pairs.
const LOOKED_AT_PER_NEIGHBOUR: usize = 5;

/// Two milestones, the lower index first, and what the line between them costs.
pub type Edge = (u32, u32, f64);

/// The search tree over the milestones, if there are any.
pub fn index_milestones(milestones: &[DVec2]) -> Option<ImmutableKdTree<f64, 2>> {
    let points: Vec<[f64; 2]> = milestones.iter().map(DVec2::to_array).collect();
    (!points.is_empty())
        .then(|| ImmutableKdTree::new_from_slice(&points).expect("milestones are finite and few share a coordinate"))
}

/// All edges, sorted, each once: from every milestone to its nearest neighbours with a free line between.
///
/// Neighbours are taken by distance, ties by index.
pub fn find_edges(
    space: &FreeSpace,
    milestones: &[DVec2],
    tree: Option<&ImmutableKdTree<f64, 2>>,
    settings: &PrmSettings,
) -> Vec<Edge> {
    let Some(tree) = tree else { return Vec::new() };
    let mut tried = TriedLines::new(milestones.len());
    let mut edges = Vec::with_capacity(milestones.len() * settings.neighbours as usize);
    let mut near = Vec::new();
    let looked_at = settings.neighbours as usize * LOOKED_AT_PER_NEIGHBOUR + 1;
    let looked_at = NonZero::new(looked_at).expect("one more than something");
    for (index, &here) in milestones.iter().enumerate() {
        neighbours_by_distance(tree, milestones, here, settings.max_edge_m, looked_at, &mut near);
        let mut joined = 0;
        for &(_, other) in near.iter().filter(|&&(_, other)| other as usize != index) {
            if joined == settings.neighbours {
                break;
            }
            let index = index as u32;
            if tried.is_free(index, other, || space.line_is_free(here, milestones[other as usize])) {
                joined += 1;
                let price = space.price(here, milestones[other as usize]);
                edges.push((index.min(other), index.max(other), price));
            }
        }
    }
    edges.sort_unstable_by_key(|&(low, high, _)| (low, high));
    edges.dedup_by_key(|&mut (low, high, _)| (low, high));
    edges
}

/// The most bytes that joining this number of milestones takes, besides what is kept.
pub fn most_bytes_at_work(milestones: u64, neighbours: u64) -> u64 {
    let edges = milestones * neighbours * size_of::<Edge>() as u64;
    // A line is tried once and kept at one of its ends, in a list that doubles from room for four.
    let tried = milestones * (neighbours * LOOKED_AT_PER_NEIGHBOUR as u64 + 4);
    let tried = 2 * tried * size_of::<(u32, bool)>() as u64 + milestones * size_of::<Vec<(u32, bool)>>() as u64;
    // Then all edges are listed from both ends, in a list that doubles.
    edges + tried.max(4 * edges)
}

/// The nearest milestones within a distance (inclusive), at most so many, nearest first, ties by index.
pub fn neighbours_by_distance(
    tree: &ImmutableKdTree<f64, 2>,
    milestones: &[DVec2],
    here: DVec2,
    max_m: f64,
    most: NonZero<usize>,
    near: &mut Vec<(f64, u32)>,
) {
    // The tree only preselects, with a little more radius; our own arithmetic decides.
    let radius_squared = max_m * max_m * 1.000_001;
    let query = here.to_array();
    let found = tree.query(&query).nearest_n::<SquaredEuclidean<f64>>(most).within(radius_squared).execute();
    near.clear();
    near.extend(found.iter().map(|hit| (here.distance(milestones[hit.item as usize]), hit.item)));
    near.retain(|&(distance, _)| distance <= max_m);
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
}

/// Answers for lines between milestones, so that none is swept twice.
///
/// Milestones are visited in the order of their indices; what a lower one learned about a higher one waits there.
struct TriedLines(Vec<Vec<(u32, bool)>>);

impl TriedLines {
    fn new(milestones: usize) -> Self {
        Self(vec![Vec::new(); milestones])
    }

    fn is_free(&mut self, visited: u32, other: u32, sweep: impl FnOnce() -> bool) -> bool {
        if other < visited
            && let Some(&(_, free)) = self.0[visited as usize].iter().find(|&&(lower, _)| lower == other)
        {
            return free;
        }
        let free = sweep();
        if other > visited {
            self.0[other as usize].push((visited, free));
        }
        free
    }
}

/// The undirected graph of the milestones, weighted by cost.
pub fn graph_of(milestones: usize, edges: &[Edge]) -> Csr<(), f64, Undirected> {
    let mut both_ways: Vec<Edge> = edges.iter().flat_map(|&(a, b, m)| [(a, b, m), (b, a, m)]).collect();
    both_ways.sort_unstable_by_key(|&(from, to, _)| (from, to));
    let mut graph = Csr::from_sorted_edges(&both_ways).expect("edges are sorted and unique");
    for _ in graph.node_count()..milestones {
        graph.add_node(());
    }
    graph
}

/// How many connected components the milestones form.
pub fn count_components(milestones: usize, edges: &[Edge]) -> u32 {
    let mut sets = UnionFind::<u32>::new(milestones);
    let merged = edges.iter().filter(|&&(a, b, _)| sets.union(a, b)).count();
    (milestones - merged) as u32
}
