//! The roadmap of `prm-rs`: poses joined by Reeds-Shepp curves, either built before the first query or grown by
//! queries.

use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

use glam::DVec2;
use petgraph::unionfind::UnionFind;

use super::PrmRsSettings;
use crate::collision::CollisionChecker;
use crate::memory::{CapacityBytes, MemoryKind, MemoryMeter, MemoryShare};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::rng::Xoshiro256PlusPlus;
use wildfire_base::vehicle::reeds_shepp::PricedCurve;
use wildfire_base::vehicle::{CurvePrice, ReedsShepp, Segment};

use super::near::Places;
use super::sample::{MOTIONS, Sampler, expand_near};
use crate::kit::clearance_profile::longest_first;
use crate::kit::drive_cost::CostModel;
use crate::kit::milestone_tiles::{CellBlock, MilestoneTiles, SampleSink};
use crate::kit::relaxation::Stage;
use crate::kit::roadmap_graph::{Link, RoadmapGraph};

/// The clearances that queries try in turn.
pub const SCHEDULE: [Stage<()>; 3] =
    [Stage { share: 1.0, effort: () }, Stage { share: 1.0 / 3.0, effort: () }, Stage { share: 0.04, effort: () }];
/// The index of a clearance in the schedule.
pub type ClearanceLevel = usize;
pub const LEVELS: usize = SCHEDULE.len();

/// The number of times that more poses are tried about minor components.
const BRIDGE_ROUNDS: u32 = 2;
/// The most nodes of minor components that are looked at in a round.
const MAX_MINOR: usize = 100;
/// Nodes between which the field is tighter than this half way are not joined.
const HOPELESS_M: f64 = 0.5;

/// The truck and the field that a roadmap is made for.
pub struct RoadmapSite<'a> {
    pub checker: &'a CollisionChecker,
    pub memory: &'a MemoryMeter,
    pub settings: &'a PrmRsSettings,
    /// The cost by which its curves are compared.
    pub cost: CostModel,
}

/// Poses, and Reeds-Shepp curves between them that may be driven in both directions.
///
/// Curves are worked out and swept when they are asked for, and remembered. A roadmap is either made of poses that are
/// added to it, each joined to the nearest before it, or it grows: its poses are drawn by tiles of the field that
/// searches come near, and joined to the nearest of all about them when a search leaves them. What a search finds
/// does not depend on the searches before it.
#[derive(Debug)]
pub struct Roadmap {
    checker: CollisionChecker,
    curves: ReedsShepp,
    price: CurvePrice,
    clearances_m: [f64; LEVELS],
    neighbours: usize,
    max_edge_m: f64,
    nodes: Vec<Milestone>,
    edges: Vec<RoadmapEdge>,
    ways: Vec<PricedCurve>,
    mode: RoadmapMode,
    /// The sets of nodes joined by edges that keep the wanted clearance.
    joined: UnionFind<u32>,
    components: u32,
    /// The number of edges of which it is known whether they join components.
    examined: usize,
    /// The memory of the ways.
    memory: MemoryShare,
}

#[derive(Clone, Copy, Debug)]
struct Milestone {
    pose: Pose,
    direction: DVec2,
}

impl Milestone {
    fn new(pose: Pose) -> Self {
        Self { pose, direction: pose.direction() }
    }
}

/// What a roadmap is made of before the first query: all, or nothing.
#[derive(Debug)]
enum RoadmapMode {
    /// All nodes, and their edges once they are ready for queries.
    Eager { places: Places, graph: RoadmapGraph },
    /// The nodes of the tiles near which searches have come.
    Lazy {
        tiles: MilestoneTiles,
        sampling: TileSampling,
        /// The first link of a node that a search left, and the one after its last. Links have the numbers of their edges,
        /// each of which belongs to the node that it begins at.
        links: Vec<Option<(u32, u32)>>,
    },
}

/// The samples of a tile.
#[derive(Clone, Copy, Debug)]
struct TileSampling {
    /// Poses drawn evenly, on average.
    samples_per_hectare: f64,
    corner_places: u32,
    clearance_m: f64,
}

/// The nodes, while they are drawn by tiles.
struct TileSampler<'a> {
    checker: &'a CollisionChecker,
    sampling: TileSampling,
    nodes: &'a mut Vec<Milestone>,
}

impl SampleSink for TileSampler<'_> {
    fn draw(&mut self, block: CellBlock, mut rng: Xoshiro256PlusPlus) {
        let TileSampling { samples_per_hectare, corner_places, clearance_m } = self.sampling;
        let wanted = block.hectares(self.checker.field().frame().cell_m) * samples_per_hectare;
        let mut sampler = Sampler::of_block(self.checker, clearance_m, block, &mut rng);
        let mut poses = sampler.draw_about(wanted, &mut rng);
        poses.extend(sampler.corner_samples(corner_places));
        self.nodes.extend(poses.into_iter().map(Milestone::new));
    }

    fn count(&self) -> usize {
        self.nodes.len()
    }

    fn position(&self, milestone: u32) -> DVec2 {
        self.nodes[milestone as usize].pose.position()
    }
}

/// A curve from one node to another.
#[derive(Debug)]
struct RoadmapEdge {
    nodes: [u32; 2],
    /// Index of the curve, once it is known.
    way: Option<u32>,
    /// True where it keeps each of the clearances, where that is known.
    is_free: [Option<bool>; LEVELS],
}

/// The curve of a link, in the direction of the link.
#[derive(Clone, Copy, Debug)]
pub struct Bridge {
    pub cost: f64,
    pub departs_reverse: bool,
    pub arrives_reverse: bool,
}

impl Roadmap {
    pub fn new(context: &RoadmapSite<'_>) -> Self {
        let places = Places::new(context.checker.field().frame());
        Self::with(RoadmapMode::Eager { places, graph: RoadmapGraph::default() }, context)
    }

    /// Creates a roadmap that grows; `key` determines the positions of its poses.
    pub fn lazy(context: &RoadmapSite<'_>, key: u64) -> Self {
        let &RoadmapSite { checker, settings, .. } = context;
        let frame = checker.field().frame();
        let sampling = TileSampling {
            samples_per_hectare: settings.samples_per_hectare_on(frame),
            corner_places: settings.corner_places,
            clearance_m: settings.clearance_m,
        };
        Self::with(RoadmapMode::Lazy { tiles: MilestoneTiles::new(frame, key), sampling, links: Vec::new() }, context)
    }

    fn with(mode: RoadmapMode, context: &RoadmapSite<'_>) -> Self {
        let &RoadmapSite { checker, memory, settings, cost } = context;
        Self {
            checker: checker.clone(),
            curves: ReedsShepp { radius_m: checker.body().turning_radius_m },
            price: cost.motion_price(checker.body()).curve_price(),
            clearances_m: SCHEDULE.map(|stage| stage.min_clearance_m(settings.clearance_m, f64::INFINITY)),
            neighbours: settings.neighbours as usize,
            max_edge_m: settings.max_edge_m,
            nodes: Vec::new(),
            edges: Vec::new(),
            ways: Vec::new(),
            mode,
            joined: UnionFind::new_empty(),
            components: 0,
            examined: 0,
            memory: memory.holder(MemoryKind::Curves),
        }
    }

    /// Returns whether there is memory for this number of further computed curves.
    ///
    /// A roadmap that grows counts all that it holds.
    pub fn has_memory_for(&mut self, ways: usize) -> bool {
        let ways = self.ways.bytes_after(ways);
        let grown = match &self.mode {
            RoadmapMode::Eager { .. } => 0,
            RoadmapMode::Lazy { tiles, links, .. } => {
                self.nodes.bytes_after(0) + self.edges.bytes_after(0) + links.bytes_after(0) + tiles.bytes()
            }
        };
        self.memory.cover(ways + grown)
    }

    /// Returns the maximum number of links of a node.
    pub fn max_links(&self) -> usize {
        match &self.mode {
            RoadmapMode::Eager { graph, .. } => graph.max_links(),
            RoadmapMode::Lazy { .. } => self.neighbours_when_lazy(),
        }
    }

    /// Returns whether it grows with the searches.
    pub fn is_lazy(&self) -> bool {
        matches!(self.mode, RoadmapMode::Lazy { .. })
    }

    /// Discards the grown part if it has more nodes than this. Growing it again gives the same poses and edges.
    pub fn forget_beyond(&mut self, max: usize) {
        if let RoadmapMode::Lazy { tiles, links, .. } = &mut self.mode
            && self.nodes.len() > max
        {
            tiles.clear();
            (*links, self.nodes, self.edges, self.ways) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            self.memory = self.memory.beside();
        }
    }

    /// Joins a node to its nearest neighbours, unless it is joined already or the roadmap does not grow.
    pub fn grow_from(&mut self, node: u32) {
        let RoadmapMode::Lazy { links, .. } = &self.mode else { return };
        if links.get(node as usize).copied().flatten().is_some() {
            return;
        }
        let here = self.nodes[node as usize];
        let mut near = Vec::new();
        self.within(here.pose.position(), self.max_edge_m, &mut near);
        // The node is within reach of itself.
        near.retain(|&(_, other)| other != node);
        self.keep_nearest(&here, self.neighbours_when_lazy(), &mut near);
        // The links of a node are next to each other in `edges`, so a range of numbers is all that is kept of them.
        let first = self.edges.len() as u32;
        let edges = near.iter().map(|&(_, to)| RoadmapEdge { nodes: [node, to], way: None, is_free: [None; LEVELS] });
        self.edges.extend(edges);
        if let RoadmapMode::Lazy { links, .. } = &mut self.mode {
            links.resize(self.nodes.len(), None);
            links[node as usize] = Some((first, self.edges.len() as u32));
        }
    }

    /// The number of others that a node of a growing roadmap is joined to: as many as it would have on average in both
    /// directions if each were joined to those before it.
    fn neighbours_when_lazy(&self) -> usize {
        2 * self.neighbours
    }

    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    pub fn pose(&self, node: u32) -> Pose {
        self.nodes[node as usize].pose
    }

    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// Returns the number of components formed by edges that keep the wanted clearance, after joining.
    pub fn components(&self) -> u32 {
        self.components
    }

    /// Returns the nodes outside the largest component, at most [`MAX_MINOR`] of them.
    fn minor_components(&self) -> Vec<Pose> {
        let sets: Vec<u32> = (0..self.nodes.len() as u32).map(|node| self.joined.find(node)).collect();
        let mut sizes = vec![0u32; self.nodes.len()];
        sets.iter().for_each(|&set| sizes[set as usize] += 1);
        let Some(largest) = (0..sizes.len()).max_by_key(|&set| sizes[set]) else { return Vec::new() };
        let minor = sets.iter().zip(&self.nodes).filter(|(set, _)| **set as usize != largest);
        minor.map(|(_, node)| node.pose).take(MAX_MINOR).collect()
    }

    pub fn clearance_m(&self, level: ClearanceLevel) -> f64 {
        self.clearances_m[level]
    }

    pub fn curves(&self) -> &ReedsShepp {
        &self.curves
    }

    pub fn curve_price(&self) -> &CurvePrice {
        &self.price
    }

    /// Replaces what `found` holds by the nodes within `reach_m` of a place, with their distances, nearest first.
    pub fn near(&mut self, place: DVec2, reach_m: f64, found: &mut Vec<(f64, u32)>) {
        self.within(place, reach_m, found);
        self.put_in_order(found);
    }

    /// Does the same in no particular order.
    fn within(&mut self, place: DVec2, reach_m: f64, found: &mut Vec<(f64, u32)>) {
        match &mut self.mode {
            RoadmapMode::Eager { places, .. } => places.within(place, reach_m, found),
            RoadmapMode::Lazy { tiles, sampling, .. } => {
                let mut nodes = TileSampler { checker: &self.checker, sampling: *sampling, nodes: &mut self.nodes };
                tiles.within(&mut nodes, place, reach_m, found);
            }
        }
    }

    /// Puts nodes in the order of the numbers beside them, ties by what does not depend on earlier searches.
    fn put_in_order(&self, found: &mut [(f64, u32)]) {
        found.sort_unstable_by(|a, b| self.order(a, b));
    }

    /// Compares nodes by the numbers beside them, which are not negative and so compare as their bits do.
    #[inline]
    fn order(&self, a: &(f64, u32), b: &(f64, u32)) -> Ordering {
        a.0.to_bits().cmp(&b.0.to_bits()).then_with(|| self.rank(a.1).cmp(&self.rank(b.1)))
    }

    fn rank(&self, node: u32) -> u64 {
        match &self.mode {
            RoadmapMode::Eager { .. } => node.into(),
            RoadmapMode::Lazy { tiles, .. } => tiles.rank(node),
        }
    }

    /// Adds poses, each with edges to its nearest predecessors. These edges wait until they are requested.
    pub fn add_milestones(&mut self, poses: impl IntoIterator<Item = Pose>) {
        let mut near = Vec::new();
        for pose in poses {
            if !self.has_memory_for(self.neighbours) {
                return;
            }
            let node = Milestone::new(pose);
            let number = self.nodes.len() as u32;
            // Before the node itself is added, so that it is joined only to predecessors and each pair has one edge.
            self.within(pose.position(), self.max_edge_m, &mut near);
            self.keep_nearest(&node, self.neighbours, &mut near);
            self.edges.extend(near.iter().map(|&(_, other)| RoadmapEdge {
                nodes: [other, number],
                way: None,
                is_free: [None; LEVELS],
            }));
            if let RoadmapMode::Eager { places, .. } = &mut self.mode {
                places.add(pose.position());
            }
            self.nodes.push(node);
            self.joined.new_set();
            self.components += 1;
        }
    }

    /// Sweeps edges that join components, and adds poses around the small components that are left, up to
    /// [`BRIDGE_ROUNDS`] times; returns the number of poses tried.
    pub fn join_components(&mut self) -> u32 {
        self.sweep_between_components();
        let mut tried = 0;
        for _ in 0..BRIDGE_ROUNDS {
            let minor = self.minor_components();
            tried += minor.len() as u32 * MOTIONS;
            self.add_milestones(expand_near(&self.checker, self.clearances_m[0], &minor));
            self.sweep_between_components();
        }
        tried
    }

    /// Sweeps those of the edges that were not looked at yet which would join components.
    fn sweep_between_components(&mut self) {
        for edge in std::mem::replace(&mut self.examined, self.edges.len())..self.edges.len() {
            let [a, b] = self.edges[edge].nodes;
            // An edge inside a component joins nothing; it is swept when a search asks for it.
            if self.joined.equiv(a, b) {
                continue;
            }
            // Without memory the run fails, so a roadmap that stays unjoined decides nothing.
            if !self.has_memory_for(1) {
                return;
            }
            // At the wanted clearance, by which components are counted.
            if self.is_free(edge as u32, 0) {
                self.joined.union(a, b);
                self.components -= 1;
            }
        }
    }

    /// Keeps this number of the nodes, those that a truck gets to soonest, as an estimate says.
    fn keep_nearest(&self, node: &Milestone, count: usize, near: &mut Vec<(f64, u32)>) {
        for (metres, other) in near.iter_mut() {
            *metres = self.estimate_m(node, &self.nodes[*other as usize], *metres);
        }
        // Selecting is linear where sorting all would not be. Most of those that are selected are kept.
        let mut examined = 0;
        let mut kept = 0;
        while kept < count && examined < near.len() {
            let next = &mut near[examined..];
            let selected = (2 * (count - kept)).min(next.len());
            if selected < next.len() {
                next.select_nth_unstable_by(selected, |a, b| self.order(a, b));
            }
            self.put_in_order(&mut next[..selected]);
            for index in examined..examined + selected {
                let (_, other) = near[index];
                // Most curves pass near the middle of the chord: an obstacle there makes a sweep pointless.
                let middle = node.pose.position().lerp(self.nodes[other as usize].pose.position(), 0.5);
                if kept < count && self.checker.field().lower_bound(middle) >= HOPELESS_M {
                    near[kept] = near[index];
                    kept += 1;
                }
            }
            examined += selected;
        }
        near.truncate(kept);
    }

    /// Estimates how long the curve between two nodes is: the straight line, what turning into it and out of it costs, and no
    /// less than what turning from one heading to the other takes.
    fn estimate_m(&self, a: &Milestone, b: &Milestone, distance: f64) -> f64 {
        let radius = self.curves.radius_m;
        // Two poses may be at the same place.
        let line = (b.pose.position() - a.pose.position()) / distance.max(1e-9);
        let turn_m = |direction: DVec2| {
            let along = line.dot(direction).abs();
            let across = line.perp_dot(direction).abs();
            let sideways = radius * (1.0 - along);
            0.5 * radius * across * across * across + sideways * sideways / (2.0 * distance.max(0.5 * radius))
        };
        let there = distance + turn_m(a.direction) + turn_m(b.direction);
        there.max(FRAC_PI_2 * radius * (1.0 - a.direction.dot(b.direction)))
    }

    /// Makes the edges ready for queries.
    pub fn build_graph(&mut self) {
        if let RoadmapMode::Eager { graph, .. } = &mut self.mode {
            *graph = RoadmapGraph::from_edges(self.nodes.len(), self.edges.iter().map(|edge| edge.nodes));
        }
    }

    /// Returns the links of a node, each with its number; in a growing roadmap, of a node from which it has grown.
    #[cfg(test)]
    pub fn links(&self, node: u32) -> impl Iterator<Item = (u32, Link)> + '_ {
        self.link_numbers(node).map(|number| (number, self.link(number)))
    }

    /// Returns the numbers of the links of a node; of a roadmap that grows, of a node that it has grown from.
    pub fn link_numbers(&self, node: u32) -> Range<u32> {
        match &self.mode {
            RoadmapMode::Eager { graph, .. } => graph.numbers(node),
            RoadmapMode::Lazy { links, .. } => links[node as usize].map_or(0..0, |(first, end)| first..end),
        }
    }

    pub fn link(&self, link: u32) -> Link {
        match &self.mode {
            RoadmapMode::Eager { graph, .. } => graph.link(link),
            RoadmapMode::Lazy { .. } => Link { to: self.edges[link as usize].nodes[1], edge: link },
        }
    }

    /// Returns what no way between two nodes is shorter than.
    pub fn min_m(&self, from: u32, to: u32) -> f64 {
        min_length_m(self.curves.radius_m, self.pose(from), self.pose(to))
    }

    fn way(&mut self, edge: u32) -> &PricedCurve {
        let edge = &mut self.edges[edge as usize];
        let way = *edge.way.get_or_insert_with(|| {
            let [a, b] = edge.nodes.map(|node| self.nodes[node as usize].pose);
            self.ways.push(self.curves.cheapest_word(a, b, &self.price));
            self.ways.len() as u32 - 1
        });
        &self.ways[way as usize]
    }

    /// Works out the curve of a link, as it is driven along the link.
    pub fn bridge(&mut self, link: Link) -> Bridge {
        let is_back = link.to == self.edges[link.edge as usize].nodes[0];
        let price = self.price;
        let way = self.way(link.edge);
        // Driven back, what led forward leads in reverse.
        let cost = if is_back { price.cost_back(&way.curve) } else { way.price };
        let mut segments = way.curve.segments();
        let first = segments.next().is_some_and(|segment| segment.is_reverse());
        let last = segments.last().map_or(first, |segment| segment.is_reverse());
        let (departs_reverse, arrives_reverse) = if is_back { (!last, !first) } else { (first, last) };
        Bridge { cost, departs_reverse, arrives_reverse }
    }

    /// Returns whether an edge keeps one of the clearances; it is swept the first time that this is asked.
    pub fn is_free(&mut self, edge: u32, level: ClearanceLevel) -> bool {
        if let Some(cached) = self.edges[edge as usize].is_free[level] {
            return cached;
        }
        let way = *self.way(edge);
        let start = self.pose(self.edges[edge as usize].nodes[0]);
        let mut row = longest_first(start, way.curve.segments());
        let clearance_m = self.clearances_m[level];
        let is_free = row.all(|(from, segment)| self.checker.motion_is_free(from, segment, clearance_m));
        self.edges[edge as usize].is_free[level] = Some(is_free);
        is_free
    }

    /// Returns both ends of every edge that keeps the least of the clearances; all are swept for it.
    pub fn free_lines(&mut self) -> impl Iterator<Item = [DVec2; 2]> {
        (0..self.edges.len() as u32).filter_map(|edge| {
            let ends = self.edges[edge as usize].nodes.map(|node| self.pose(node).position());
            (self.has_memory_for(1) && self.is_free(edge, LEVELS - 1)).then_some(ends)
        })
    }

    /// Adds the segments of a link to a way.
    pub fn append(&mut self, link: Link, segments: &mut Vec<Segment>) {
        let is_back = link.to == self.edges[link.edge as usize].nodes[0];
        let joint = segments.len();
        segments.extend(self.way(link.edge).curve.segments());
        if is_back {
            segments[joint..].reverse();
            segments[joint..].iter_mut().for_each(|segment| segment.length_m = -segment.length_m);
        }
    }
}

/// Returns what no curve between two poses is shorter than: the straight line, and what turning takes.
pub fn min_length_m(radius_m: f64, from: Pose, to: Pose) -> f64 {
    let turn = ops::wrap_angle(to.heading - from.heading).abs();
    from.position().distance(to.position()).max(radius_m * turn)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::test_fields::{TestField, least_clearance};
    use wildfire_base::rng;
    use wildfire_base::vehicle::Path;

    fn roadmap(field: &TestField) -> Roadmap {
        let settings = PrmRsSettings::default();
        let mut sampler = Sampler::new(&field.checker, settings.clearance_m, &mut rng::stream(1, "roadmap"));
        let mut roadmap = Roadmap::new(&RoadmapSite {
            checker: &field.checker,
            memory: &MemoryMeter::unlimited(),
            settings: &settings,
            cost: CostModel::Length { cusp_m: settings.cusp_cost },
        });
        roadmap.add_milestones(sampler.draw(100));
        roadmap.add_milestones(sampler.corner_samples(1));
        roadmap.build_graph();
        roadmap
    }

    #[test]
    fn neighbours_are_the_first_of_all_in_order_that_are_not_hopeless() {
        let field = TestField::random(3, 45);
        let roadmap = roadmap(&field);
        let mut fewer = 0;
        for node in 0..roadmap.node_count() {
            let here = roadmap.nodes[node];
            let all = (0..roadmap.node_count() as u32).filter(|&other| other as usize != node);
            let all: Vec<(f64, u32)> =
                all.map(|other| (here.pose.position().distance(roadmap.pose(other).position()), other)).collect();
            let mut wanted: Vec<(f64, u32)> = Vec::new();
            for &(metres, other) in &all {
                let there = &roadmap.nodes[other as usize];
                let middle = here.pose.position().lerp(there.pose.position(), 0.5);
                if field.checker.field().lower_bound(middle) >= HOPELESS_M {
                    wanted.push((roadmap.estimate_m(&here, there, metres), other));
                }
            }
            roadmap.put_in_order(&mut wanted);
            for count in [1, 16, wanted.len() + 5] {
                let mut kept = all.clone();
                roadmap.keep_nearest(&here, count, &mut kept);
                assert_eq!(kept, wanted[..count.min(wanted.len())], "{count} of node {node}");
            }
            fewer += u32::from(wanted.len() < all.len());
        }
        assert!(fewer > 50, "{fewer} nodes with hopeless ones about them");
    }

    #[test]
    fn links_lead_from_pose_to_pose_both_ways_and_free_ones_keep_the_clearance() {
        let mut free = 0;
        for seed in 0..4 {
            let field = TestField::random(seed, 30);
            let mut roadmap = roadmap(&field);
            for node in (0..roadmap.node_count() as u32).step_by(3) {
                let links: Vec<Link> = roadmap.links(node).map(|(_, link)| link).collect();
                for link in links.into_iter().step_by(2) {
                    let mut path = Path::standing(roadmap.pose(node));
                    roadmap.append(link, &mut path.segments);
                    let (end, there) = (path.end(), roadmap.pose(link.to));
                    assert!(end.position().distance(there.position()) < 1e-6);
                    assert!(ops::wrap_angle(end.heading - there.heading).abs() < 1e-6);
                    let passage = roadmap.bridge(link);
                    assert!((passage.cost - path.length_m() - 2.0 * f64::from(path.cusps())).abs() < 1e-6);
                    assert_eq!(passage.departs_reverse, path.segments[0].is_reverse());
                    assert_eq!(passage.arrives_reverse, path.segments[path.segments.len() - 1].is_reverse());
                    assert!(roadmap.min_m(node, link.to) <= passage.cost + 1e-9);
                    if roadmap.is_free(link.edge, 0) {
                        free += 1;
                        assert!(least_clearance(&field.checker, &path) > roadmap.clearance_m(0) - 0.03 - 1e-6);
                    }
                }
            }
        }
        assert!(free > 300, "{free} are free");
    }

    fn lazy(field: &TestField) -> Roadmap {
        let settings = PrmRsSettings::default();
        let cost = CostModel::Length { cusp_m: settings.cusp_cost };
        let memory = MemoryMeter::unlimited();
        Roadmap::lazy(&RoadmapSite { checker: &field.checker, memory: &memory, settings: &settings, cost }, 7)
    }

    #[test]
    fn a_growing_roadmap_joins_a_node_to_those_that_the_estimate_says_are_nearest() {
        for seed in 0..3 {
            let field = TestField::random(seed, 30);
            let mut all = lazy(&field);
            let mut roadmap = lazy(&field);
            let mut near = Vec::new();
            all.near(DVec2::splat(75.0), f64::INFINITY, &mut near);
            roadmap.near(field.start.position(), 20.0, &mut near);
            assert!(near.len() > 3 && roadmap.node_count() < all.node_count());
            for (_, node) in near {
                roadmap.grow_from(node);
                let here = roadmap.nodes[node as usize];
                let mut others: Vec<(f64, Pose)> = Vec::new();
                for there in &all.nodes {
                    let metres = here.pose.position().distance(there.pose.position());
                    let middle = here.pose.position().lerp(there.pose.position(), 0.5);
                    let is_shut = field.checker.field().lower_bound(middle) < HOPELESS_M;
                    if there.pose != here.pose && metres <= 40.0 && !is_shut {
                        others.push((all.estimate_m(&here, there, metres), there.pose));
                    }
                }
                others.sort_by(|a, b| a.0.total_cmp(&b.0));
                let estimate = |to: u32| {
                    let there = &roadmap.nodes[to as usize];
                    roadmap.estimate_m(&here, there, here.pose.position().distance(there.pose.position()))
                };
                let found: Vec<f64> = roadmap.links(node).map(|(_, link)| estimate(link.to)).collect();
                let wanted: Vec<f64> = others.iter().take(32).map(|&(metres, _)| metres).collect();
                assert_eq!(found, wanted);
            }
        }
    }

    #[test]
    fn what_a_roadmap_grows_does_not_depend_on_what_grew_before() {
        let field = TestField::random(4, 30);
        let mut rng = rng::stream(4, "growing");
        let mut kept = lazy(&field);
        for _ in 0..30 {
            let place = DVec2::new(rng.random_range(0.0..150.0), rng.random_range(0.0..150.0));
            let mut fresh = lazy(&field);
            let [one, two] = [&mut kept, &mut fresh].map(|roadmap| {
                let mut near = Vec::new();
                roadmap.near(place, 30.0, &mut near);
                let poses = |roadmap: &Roadmap, nodes: &mut dyn Iterator<Item = u32>| -> Vec<Pose> {
                    nodes.map(|node| roadmap.pose(node)).collect()
                };
                let about = poses(roadmap, &mut near.iter().map(|&(_, node)| node));
                let first = near.first().map_or(Vec::new(), |&(_, node)| {
                    roadmap.grow_from(node);
                    poses(roadmap, &mut roadmap.links(node).map(|(_, link)| link.to))
                });
                (about, first)
            });
            assert_eq!(one, two);
            kept.forget_beyond(400);
            assert!(kept.node_count() <= 400);
        }
    }

    #[test]
    fn components_are_those_of_all_free_edges() {
        for seed in 0..4 {
            let field = TestField::random(seed, 60);
            let mut roadmap = roadmap(&field);
            roadmap.join_components();
            let mut sets = UnionFind::<u32>::new(roadmap.node_count());
            let mut components = roadmap.node_count() as u32;
            for edge in 0..roadmap.edge_count() as u32 {
                let [a, b] = roadmap.edges[edge as usize].nodes;
                components -= u32::from(roadmap.is_free(edge, 0) && sets.union(a, b));
            }
            assert_eq!(roadmap.components(), components);
            let apart = roadmap.minor_components();
            assert!(apart.len() as u32 >= components - 1);
        }
    }

    #[test]
    fn what_is_cached_of_an_edge_does_not_change_it() {
        let field = TestField::random(2, 40);
        let mut queried = roadmap(&field);
        let mut fresh = roadmap(&field);
        let mut rng = rng::stream(2, "edges");
        let edges: Vec<(u32, ClearanceLevel)> =
            (0..300).map(|_| (rng.random_range(0..queried.edge_count() as u32), rng.random_range(0..LEVELS))).collect();
        let answers: Vec<bool> = edges.iter().map(|&(edge, level)| queried.is_free(edge, level)).collect();
        for (&(edge, level), &answer) in edges.iter().zip(&answers).rev() {
            assert_eq!(fresh.is_free(edge, level), answer);
            assert_eq!(queried.is_free(edge, level), answer);
        }
    }
}
