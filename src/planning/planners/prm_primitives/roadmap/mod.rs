//! The probabilistic roadmap: milestones where the truck's body centre may be, joined by straight lines.
//!
//! After Kavraki, Svestka, Latombe and Overmars, "Probabilistic roadmaps for path planning in high-dimensional
//! configuration spaces", IEEE Trans. Robotics and Automation 12(4), 1996, with low-discrepancy samples as in LaValle,
//! Branicky and Lindemann, "On the relationship between classical grid search and probabilistic roadmaps", IJRR
//! 23(7-8), 2004.
//!
//! It is a roadmap of places, without headings: every edge works both ways, and what the truck's steering makes of
//! it is the local search's business. World frame, metres.

mod connect;
mod query;
mod route;
mod sample;
mod scratch;
mod space;

pub use query::Route;
pub use scratch::RoadmapScratch;

use std::sync::Arc;

use glam::DVec2;
use kiddo::ImmutableKdTree;
use petgraph::Undirected;
use petgraph::csr::Csr;
use rand::Rng;

use crate::collision::CollisionChecker;

use super::PrmSettings;
use crate::planning::kit::safety::Safety;
use space::FreeSpace;

/// Milestones and the free straight lines between them.
#[derive(Debug)]
pub struct Roadmap {
    settings: PrmSettings,
    space: FreeSpace,
    milestones: Vec<DVec2>,
    draws: u32,
    /// For finding the milestones about a place; there is none without milestones.
    tree: Option<ImmutableKdTree<f64, 2>>,
    /// Edge weights are what the lines cost: their metres, unless a safety map prices them.
    graph: Csr<(), f64, Undirected>,
    edges: u32,
    components: u32,
}

impl Roadmap {
    /// Draws milestones, not yet joined.
    ///
    /// There are fewer than wanted when the draws run out (see [`sample::MAX_DRAWS_PER_SAMPLE`]).
    pub fn sampled(checker: &CollisionChecker, settings: &PrmSettings, rng: &mut impl Rng) -> Self {
        let space = FreeSpace::new(checker, settings);
        let (milestones, draws) = sample::draw_milestones(&space, settings.samples, rng);
        Self {
            settings: settings.clone(),
            space,
            milestones,
            draws,
            tree: None,
            graph: Csr::new(),
            edges: 0,
            components: 0,
        }
    }

    /// The same milestones, the lines between them priced by a safety map.
    #[must_use]
    pub fn priced_by(mut self, safety: Option<Arc<Safety>>) -> Self {
        self.space = self.space.priced_by(safety);
        self
    }

    /// Joins the milestones to their neighbours.
    #[must_use]
    pub fn connected(mut self) -> Self {
        self.tree = connect::index_milestones(&self.milestones);
        let edges = connect::find_edges(&self.space, &self.milestones, self.tree.as_ref(), &self.settings);
        self.edges = edges.len() as u32;
        self.components = connect::count_components(self.milestones.len(), &edges);
        self.graph = connect::graph_of(self.milestones.len(), &edges);
        self
    }

    /// The most bytes that it takes for good, and on top of that while it is made.
    pub fn most_bytes(settings: &PrmSettings) -> [u64; 2] {
        let (milestones, neighbours) = (u64::from(settings.samples), u64::from(settings.neighbours));
        let edges = milestones * neighbours;
        // The tree has a milestone's place and number once more, in leaves that need not be full.
        let milestone = 3 * size_of::<DVec2>() + 2 * size_of::<u64>();
        // Each edge is listed at both its ends, in lists that double.
        let edge = 4 * (size_of::<u32>() + size_of::<f64>());
        let held = milestones * milestone as u64 + edges * edge as u64;
        [held, connect::most_bytes_at_work(milestones, neighbours)]
    }

    pub fn milestones(&self) -> &[DVec2] {
        &self.milestones
    }

    /// Points drawn to get the milestones.
    pub fn draws(&self) -> u32 {
        self.draws
    }

    /// Number of edges, each counted once.
    pub fn edge_count(&self) -> u32 {
        self.edges
    }

    /// Number of connected components.
    pub fn component_count(&self) -> u32 {
        self.components
    }

    /// The graph; its nodes are indices of [`Self::milestones`], its weights what the lines cost.
    pub fn graph(&self) -> &Csr<(), f64, Undirected> {
        &self.graph
    }

    /// Both ends of every edge.
    pub fn lines(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let from = |a: u32| self.graph.neighbors_slice(a).iter().filter(move |&&b| a < b).map(move |&b| [a, b]);
        let edges = (0..self.milestones.len() as u32).flat_map(from);
        edges.map(|edge| edge.map(|milestone| self.milestones[milestone as usize]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planning::planners::prm_primitives::ClearanceTo;
    use crate::planning::test_fields::TestField;
    use crate::rng;

    fn roadmap(field: &TestField, settings: &PrmSettings) -> Roadmap {
        Roadmap::sampled(&field.checker, settings, &mut rng::stream(7, "prm")).connected()
    }

    /// Every edge with its two ends, each once.
    fn edges(roadmap: &Roadmap) -> Vec<(DVec2, DVec2, f64)> {
        let from = |a: u32| {
            let ends = roadmap.graph.neighbors_slice(a).iter().zip(roadmap.graph.edges_slice(a));
            ends.filter(move |&(&b, _)| a < b).map(move |(&b, &metres)| (a as usize, b as usize, metres))
        };
        (0..roadmap.milestones.len() as u32)
            .flat_map(from)
            .map(|(a, b, metres)| (roadmap.milestones[a], roadmap.milestones[b], metres))
            .collect()
    }

    #[test]
    fn every_edge_is_free_at_twice_the_planners_resolution() {
        let settings = PrmSettings { samples: 200, ..PrmSettings::default() };
        for seed in 0..10 {
            let field = TestField::random(seed, 25);
            let roadmap = roadmap(&field, &settings);
            let edges = edges(&roadmap);
            assert_eq!(edges.len(), roadmap.edge_count() as usize);
            assert!(edges.len() > 400);
            for (a, b, metres) in edges {
                assert!(metres <= settings.max_edge_m && metres == a.distance(b));
                // The clearance field's vertices are 0.5 m apart.
                let steps = (metres / 0.25).ceil();
                for k in 0..=steps as u32 {
                    let clearance = field.checker.field().distance(a.lerp(b, f64::from(k) / steps));
                    assert!(clearance >= settings.clearance_m, "edge {a} {b}: {clearance}");
                }
            }
        }
    }

    #[test]
    fn clearance_to_cell_centres_is_kept_along_edges() {
        let clearance_to = ClearanceTo::CellCentres;
        let settings = PrmSettings { samples: 150, clearance_m: 7.5, clearance_to, ..PrmSettings::default() };
        let field = TestField::random(3, 15);
        let edges = edges(&roadmap(&field, &settings));
        assert!(edges.len() > 100);
        for (a, b, _) in edges {
            for k in 0..=100 {
                let point = a.lerp(b, f64::from(k) / 100.0);
                assert!(field.bushes.iter().all(|bush| bush.distance(point) >= 7.5 - 1e-9));
            }
        }
    }

    #[test]
    fn every_milestone_meets_its_nearest_visible_neighbours() {
        let settings = PrmSettings { samples: 120, neighbours: 4, ..PrmSettings::default() };
        let field = TestField::random(5, 25);
        let roadmap = roadmap(&field, &settings);
        let milestones = &roadmap.milestones;
        for (index, &here) in milestones.iter().enumerate() {
            let mut visible: Vec<u32> = (0..milestones.len() as u32)
                .filter(|&other| {
                    let there = milestones[other as usize];
                    other as usize != index && here.distance(there) <= 30.0 && roadmap.space.line_is_free(here, there)
                })
                .collect();
            visible.sort_by(|&a, &b| {
                here.distance(milestones[a as usize]).total_cmp(&here.distance(milestones[b as usize]))
            });
            for &other in visible.iter().take(4) {
                assert!(roadmap.graph.contains_edge(index as u32, other));
            }
        }
    }

    #[test]
    fn components_are_those_that_petgraph_counts() {
        let settings = PrmSettings { samples: 60, max_edge_m: 14.0, ..PrmSettings::default() };
        for seed in 0..10 {
            let roadmap = roadmap(&TestField::random(seed, 40), &settings);
            assert_eq!(roadmap.component_count() as usize, petgraph::algo::connected_components(&roadmap.graph));
        }
    }

    #[test]
    fn a_full_field_ends_the_draws() {
        let field = TestField::drawn(&["####", "####", "####"], crate::geometry::Pose::new(9.0, 9.0, 0.0));
        let settings = PrmSettings { samples: 50, ..PrmSettings::default() };
        let roadmap = roadmap(&field, &settings);
        assert_eq!((roadmap.milestones.len(), roadmap.draws()), (0, 50 * sample::MAX_DRAWS_PER_SAMPLE));
        assert_eq!((roadmap.edge_count(), roadmap.component_count()), (0, 0));
    }

    #[test]
    fn samples_cover_the_field_more_evenly_than_chance() {
        let field = TestField::drawn(&[".........."; 10], crate::geometry::Pose::new(9.0, 9.0, 0.0));
        let settings = PrmSettings { samples: 500, clearance_m: 0.0, ..PrmSettings::default() };
        let roadmap = roadmap(&field, &settings);
        let mut counts = [0; 25];
        for milestone in &roadmap.milestones {
            counts[(milestone.y / 10.0) as usize * 5 + (milestone.x / 10.0) as usize] += 1;
        }
        // Independent draws would leave the middle range of 20 +- 4.4 in one square of three.
        assert!(counts.iter().all(|&count| (16..=24).contains(&count)), "{counts:?}");
    }
}
