//! The probabilistic roadmap: collision-free milestones for the truck's body centre, joined by straight lines.
//!
//! After Kavraki, Svestka, Latombe and Overmars, "Probabilistic roadmaps for path planning in high-dimensional
//! configuration spaces", IEEE Trans. Robotics and Automation 12(4), 1996, with low-discrepancy samples as in LaValle,
//! Branicky and Lindemann, "On the relationship between classical grid search and probabilistic roadmaps", IJRR
//! 23(7-8), 2004.
//!
//! It is a roadmap of places, without headings: every edge works both ways, and what the truck's steering makes of
//! it is the business of the local search. World frame, metres.

mod query;
mod space;
mod tighten;

pub use query::{RoadmapRoute, RoadmapScratch};

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::Arc;

use glam::DVec2;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use petgraph::unionfind::UnionFind;
use rand::{Rng, RngExt};

use crate::collision::CollisionChecker;
use crate::kit::halton::radical_inverse;
use crate::kit::roadmap_graph::RoadmapGraph;
use crate::kit::safety::Safety;
use crate::planners::prm_primitives::PrmSettings;
use space::FreeSpace;
use wildfire_base::trajectory::GroundSpeed;

/// Draws stop after this number for each wanted milestone, so that a full field cannot hold the planner up.
const MAX_DRAWS_PER_SAMPLE: u32 = 100;

/// For each neighbour wanted, this number of the nearest milestones is looked at, lest dense roadmaps try all pairs.
const EXAMINED_PER_NEIGHBOUR: usize = 5;

/// The side of the squares in which roads have a milestone, metres.
const ROAD_SQUARE_M: f64 = 15.0;

/// Where more than this share of a field is as fast as any, that is no road.
const MAX_ROADS: f64 = 0.3;

/// Milestones and the free straight lines between them.
#[derive(Debug)]
pub struct Roadmap {
    settings: PrmSettings,
    space: FreeSpace,
    milestones: Vec<DVec2>,
    draws: u32,
    /// Finds the milestones about a position; there is none without milestones.
    tree: Option<ImmutableKdTree<f64, 2>>,
    graph: RoadmapGraph,
    /// The cost of each edge's line: its metres, unless a safety map prices them.
    costs: Vec<f64>,
    components: u32,
}

impl Roadmap {
    /// Samples milestones, not yet joined.
    ///
    /// There are fewer than wanted when the draws run out (see [`MAX_DRAWS_PER_SAMPLE`]).
    pub fn sampled(checker: &CollisionChecker, settings: &PrmSettings, rng: &mut impl Rng) -> Self {
        let space = FreeSpace::new(checker, settings);
        let (milestones, draws) = draw_milestones(&space, settings.samples_on(checker.field().frame()), rng);
        Self {
            settings: settings.clone(),
            space,
            milestones,
            draws,
            tree: None,
            graph: RoadmapGraph::default(),
            costs: Vec::new(),
            components: 0,
        }
    }

    /// Returns the same milestones and others along roads: where a small part of the field is faster than the rest, one in
    /// each square of this side that has such a cell.
    #[must_use]
    pub fn along_roads(mut self, ground: Option<&GroundSpeed>) -> Self {
        let Some(ground) = ground else { return self };
        let frame = *self.space.frame();
        let cells = || (0..frame.cell_count()).map(|index| (ground.share(index), frame.cell(index)));
        let fastest = cells().map(|(share, _)| share).fold(0.0, f64::max);
        let roads = || cells().filter(|&(share, _)| share == fastest).map(|(_, cell)| frame.centre(cell));
        if roads().count() as f64 > MAX_ROADS * frame.cell_count() as f64 {
            return self;
        }
        // In order, so that the milestones have the same numbers in every run.
        let mut squares: BTreeMap<[i32; 2], (f64, DVec2)> = BTreeMap::new();
        for place in roads().filter(|&place| self.space.point_is_free(place)) {
            let square = (place / ROAD_SQUARE_M).floor();
            let off_m = place.distance((square + 0.5) * ROAD_SQUARE_M);
            let nearest = squares.entry([square.y as i32, square.x as i32]).or_insert((off_m, place));
            if off_m < nearest.0 {
                *nearest = (off_m, place);
            }
        }
        // The search tree wants few of them in one line.
        let places = (1..).zip(squares.into_values()).map(|(number, (_, place))| {
            let aside = DVec2::new(radical_inverse(2, number), radical_inverse(3, number)) - 0.5;
            place + 0.2 * frame.cell_m * aside
        });
        self.milestones.extend(places.filter(|&place| self.space.point_is_free(place)));
        self
    }

    /// Returns the same milestones with a safety map that prices the lines between them.
    #[must_use]
    pub fn priced_by(mut self, safety: Option<Arc<Safety>>) -> Self {
        self.space = self.space.priced_by(safety);
        self
    }

    /// Joins the milestones to their neighbours.
    #[must_use]
    pub fn connected(mut self) -> Self {
        self.tree = index_milestones(&self.milestones);
        let edges = find_edges(&self.space, &self.milestones, self.tree.as_ref(), &self.settings);
        let mut sets = UnionFind::<u32>::new(self.milestones.len());
        let merged = edges.iter().filter(|&&(a, b, _)| sets.union(a, b)).count();
        self.components = (self.milestones.len() - merged) as u32;
        self.graph = RoadmapGraph::from_edges(self.milestones.len(), edges.iter().map(|&(a, b, _)| [a, b]));
        self.costs = edges.into_iter().map(|(_, _, cost)| cost).collect();
        self
    }

    pub fn milestones(&self) -> &[DVec2] {
        &self.milestones
    }

    /// Returns the number of points sampled to get the milestones.
    pub fn draws(&self) -> u32 {
        self.draws
    }

    /// Returns the number of edges, each counted once.
    pub fn edge_count(&self) -> u32 {
        self.costs.len() as u32
    }

    /// Returns the number of connected components.
    pub fn component_count(&self) -> u32 {
        self.components
    }

    /// Returns both ends of every edge.
    pub fn lines(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let edges = (0..self.milestones.len() as u32)
            .flat_map(|a| self.graph.links(a).map(move |(_, link)| [a, link.to]).filter(|[a, b]| a < b));
        edges.map(|edge| edge.map(|milestone| self.milestones[milestone as usize]))
    }
}

/// Draws `wanted` free points that cover the field evenly; also says how many points were drawn.
///
/// The points are Halton's with bases 2 and 3 (J. H. Halton, "On the efficiency of certain quasi-random sequences of
/// points in evaluating multi-dimensional integrals", Numerische Mathematik 2, 1960), moved by one random shift modulo
/// the field's sides (R. Cranley, T. N. L. Patterson, "Randomization of number theoretic methods for multiple
/// integration", SIAM J. Numerical Analysis 13(6), 1976). Points that are not free are dropped.
fn draw_milestones(space: &FreeSpace, wanted: u32, rng: &mut impl Rng) -> (Vec<DVec2>, u32) {
    let shift = DVec2::new(rng.random(), rng.random());
    let max_draws = wanted.saturating_mul(MAX_DRAWS_PER_SAMPLE);
    let mut milestones = Vec::with_capacity(wanted as usize);
    let mut draws = 0;
    while milestones.len() < wanted as usize && draws < max_draws {
        draws += 1;
        let unit = DVec2::new(radical_inverse(2, draws), radical_inverse(3, draws)) + shift;
        let point = unit.fract() * space.size_m();
        if space.point_is_free(point) {
            milestones.push(point);
        }
    }
    (milestones, draws)
}

/// Two milestones, the lower index first, and what the line between them costs.
type MilestonePair = (u32, u32, f64);

/// Returns the search tree over the milestones, if there are any.
fn index_milestones(milestones: &[DVec2]) -> Option<ImmutableKdTree<f64, 2>> {
    let points: Vec<[f64; 2]> = milestones.iter().map(DVec2::to_array).collect();
    (!points.is_empty())
        .then(|| ImmutableKdTree::new_from_slice(&points).expect("milestones are finite and few share a coordinate"))
}

/// Returns all edges, sorted, each once: from every milestone to its nearest neighbours with a free line between.
///
/// Neighbours are taken by distance, ties by index.
fn find_edges(
    space: &FreeSpace,
    milestones: &[DVec2],
    tree: Option<&ImmutableKdTree<f64, 2>>,
    settings: &PrmSettings,
) -> Vec<MilestonePair> {
    let Some(tree) = tree else { return Vec::new() };
    let mut tried = TriedLines::new(milestones.len());
    let mut edges = Vec::with_capacity(milestones.len() * settings.neighbours as usize);
    let mut near = Vec::new();
    // One more, since a milestone is nearest to itself.
    let examined = settings.neighbours as usize * EXAMINED_PER_NEIGHBOUR + 1;
    let examined = NonZero::new(examined).expect("one more than something");
    for (index, &here) in milestones.iter().enumerate() {
        neighbours_by_distance(tree, milestones, here, settings.max_edge_m, examined, &mut near);
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
    // Two milestones that are near each other find the same edge, once from each side.
    edges.sort_unstable_by_key(|&(low, high, _)| (low, high));
    edges.dedup_by_key(|&mut (low, high, _)| (low, high));
    edges
}

/// Replaces what `near` holds by the nearest milestones within a distance (inclusive), at most `max`, nearest first,
/// ties by index.
pub fn neighbours_by_distance(
    tree: &ImmutableKdTree<f64, 2>,
    milestones: &[DVec2],
    here: DVec2,
    max_m: f64,
    max: NonZero<usize>,
    near: &mut Vec<(f64, u32)>,
) {
    // The tree only preselects, with a little more radius; our own arithmetic decides.
    let radius_squared = max_m * max_m * 1.000_001;
    let query = here.to_array();
    let found = tree.query(&query).nearest_n::<SquaredEuclidean<f64>>(max).within(radius_squared).execute();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planners::prm_primitives::ClearanceTo;
    use crate::test_fields::TestField;
    use wildfire_base::rng;

    fn roadmap(field: &TestField, settings: &PrmSettings) -> Roadmap {
        Roadmap::sampled(&field.checker, settings, &mut rng::stream(7, "prm")).connected()
    }

    /// Every edge with its two ends, each once.
    fn edges(roadmap: &Roadmap) -> Vec<(DVec2, DVec2, f64)> {
        let from = |a: u32| roadmap.graph.links(a).filter(move |(_, link)| a < link.to).map(move |(_, link)| (a, link));
        let place = |milestone: u32| roadmap.milestones[milestone as usize];
        (0..roadmap.milestones.len() as u32)
            .flat_map(from)
            .map(|(a, link)| (place(a), place(link.to), roadmap.costs[link.edge as usize]))
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
                assert!(roadmap.graph.links(index as u32).any(|(_, link)| link.to == other));
            }
        }
    }

    #[test]
    fn components_are_those_that_petgraph_counts() {
        let settings = PrmSettings { samples: 60, max_edge_m: 14.0, ..PrmSettings::default() };
        for seed in 0..10 {
            let roadmap = roadmap(&TestField::random(seed, 40), &settings);
            let edges = (0..roadmap.milestones.len() as u32)
                .flat_map(|a| roadmap.graph.links(a).map(move |(_, link)| (a, link.to)));
            let mut graph = petgraph::graph::UnGraph::<(), ()>::from_edges(edges);
            while graph.node_count() < roadmap.milestones.len() {
                graph.add_node(());
            }
            assert_eq!(roadmap.component_count() as usize, petgraph::algo::connected_components(&graph));
        }
    }

    #[test]
    fn a_full_field_ends_the_draws() {
        let field = TestField::drawn(&["####", "####", "####"], wildfire_base::geometry::Pose::new(9.0, 9.0, 0.0));
        let settings = PrmSettings { samples: 50, ..PrmSettings::default() };
        let roadmap = roadmap(&field, &settings);
        assert_eq!((roadmap.milestones.len(), roadmap.draws()), (0, 50 * MAX_DRAWS_PER_SAMPLE));
        assert_eq!((roadmap.edge_count(), roadmap.component_count()), (0, 0));
    }

    #[test]
    fn samples_cover_the_field_more_evenly_than_chance() {
        let field = TestField::drawn(&[".........."; 10], wildfire_base::geometry::Pose::new(9.0, 9.0, 0.0));
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
