//! The graph of a roadmap: the edges from each milestone, whatever milestones and edges are.

use std::ops::Range;

/// An edge as seen from one of its milestones.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub to: u32,
    pub edge: u32,
}

/// An undirected graph; milestones and edges are identified by their numbers.
#[derive(Debug, Default)]
pub struct RoadmapGraph {
    /// Links of milestone i are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
    links: Vec<Link>,
    max_links: usize,
}

impl RoadmapGraph {
    /// Creates the graph of edges between milestones below `milestones`; an edge's number is its index in the list.
    ///
    /// A milestone's links are in the order of the edges' numbers.
    pub fn from_edges(milestones: usize, edges: impl ExactSizeIterator<Item = [u32; 2]> + Clone) -> Self {
        // One list for all links, filled by counting, in place of an allocation for every milestone.
        let mut first = vec![0; milestones + 1];
        for milestone in edges.clone().flatten() {
            first[milestone as usize + 1] += 1;
        }
        let max_links = first.iter().copied().max().unwrap_or(0) as usize;
        for milestone in 0..milestones {
            first[milestone + 1] += first[milestone];
        }
        let mut next = first.clone();
        let mut links = vec![Link { to: 0, edge: 0 }; 2 * edges.len()];
        for (number, [a, b]) in edges.enumerate() {
            for (milestone, to) in [(a, b), (b, a)] {
                links[next[milestone as usize] as usize] = Link { to, edge: number as u32 };
                next[milestone as usize] += 1;
            }
        }
        Self { first, links, max_links }
    }

    /// Returns the links of a milestone, each with its number.
    pub fn links(&self, milestone: u32) -> impl Iterator<Item = (u32, Link)> + '_ {
        self.numbers(milestone).map(|link| (link, self.links[link as usize]))
    }

    /// Returns the numbers of the links of a milestone.
    pub fn numbers(&self, milestone: u32) -> Range<u32> {
        self.first[milestone as usize]..self.first[milestone as usize + 1]
    }

    pub fn link(&self, number: u32) -> Link {
        self.links[number as usize]
    }

    /// Returns the maximum number of links of a milestone.
    pub fn max_links(&self) -> usize {
        self.max_links
    }
}
