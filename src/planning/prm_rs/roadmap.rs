use glam::DVec2;
use petgraph::unionfind::UnionFind;

use crate::collision::{CollisionChecker, LEAST_CLEARANCE_M};
use crate::geometry::Pose;
use crate::planning::PrmRsSettings;
use crate::vehicle::reeds_shepp::PricedCurve;
use crate::vehicle::{CurvePrice, ReedsShepp, Segment};

use super::near::Places;

/// Shares of the wanted clearance that queries ask for in turn.
const SHARES: [f64; 3] = [1.0, 1.0 / 3.0, 0.04];
/// Which of the clearances a query asks for.
pub type Level = usize;
pub const LEVELS: usize = SHARES.len();

/// Poses, and Reeds-Shepp curves between them that may be driven both ways.
#[derive(Debug)]
pub struct Roadmap {
    checker: CollisionChecker,
    curves: ReedsShepp,
    price: CurvePrice,
    clearances_m: [f64; LEVELS],
    neighbours: usize,
    max_edge_m: f64,
    poses: Vec<Pose>,
    places: Places,
    edges: Vec<Edge>,
    /// Links of node i are those from `first[i]` to `first[i + 1]`.
    first: Vec<u32>,
    links: Vec<Link>,
    pub components: u32,
}

/// A curve from one node to another.
#[derive(Debug)]
struct Edge {
    nodes: [u32; 2],
    way: PricedCurve,
    /// Whether it keeps each of the clearances, where that is known.
    is_free: [Option<bool>; LEVELS],
}

/// An edge as it looks from one of its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub to: u32,
    pub edge: u32,
    pub cost: f64,
    pub departs_reverse: bool,
    pub arrives_reverse: bool,
}

impl Roadmap {
    pub fn new(checker: &CollisionChecker, settings: &PrmRsSettings) -> Self {
        Self {
            checker: checker.clone(),
            curves: ReedsShepp { radius_m: checker.body().turning_radius_m },
            price: CurvePrice { reverse_factor: 1.0, cusp_m: settings.cusp_cost },
            clearances_m: SHARES.map(|share| (share * settings.clearance_m).max(LEAST_CLEARANCE_M)),
            neighbours: settings.neighbours as usize,
            max_edge_m: settings.max_edge_m,
            poses: Vec::new(),
            places: Places::new(checker.field().frame()),
            edges: Vec::new(),
            first: Vec::new(),
            links: Vec::new(),
            components: 0,
        }
    }

    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    pub fn clearance_m(&self, level: Level) -> f64 {
        self.clearances_m[level]
    }

    pub fn curves(&self) -> (&ReedsShepp, &CurvePrice) {
        (&self.curves, &self.price)
    }

    /// Replaces what `found` holds by the nodes within `reach_m` of a place, with their distances, nearest first.
    pub fn near(&self, place: DVec2, reach_m: f64, found: &mut Vec<(f64, u32)>) {
        self.places.near(place, reach_m, found);
    }

    /// Adds poses, each with curves to the nearest ones before it, of which nothing is known yet.
    pub fn add(&mut self, poses: impl IntoIterator<Item = Pose>) {
        let (mut near, mut best) = (Vec::new(), Vec::new());
        for pose in poses {
            let node = self.poses.len() as u32;
            self.places.near(pose.position(), self.max_edge_m, &mut near);
            self.nearest_by_curve(pose, &near, &mut best);
            self.edges.extend(best.drain(..).map(|(way, other)| Edge {
                nodes: [other, node],
                way,
                is_free: [None; LEVELS],
            }));
            self.places.add(pose.position());
            self.poses.push(pose);
        }
    }

    /// Of the nodes `near` to a pose, those from which the cheapest curves lead to it.
    fn nearest_by_curve(&self, pose: Pose, near: &[(f64, u32)], best: &mut Vec<(PricedCurve, u32)>) {
        for &(distance, other) in near {
            let bound = if best.len() < self.neighbours { self.max_edge_m } else { best[best.len() - 1].0.price };
            if distance >= bound {
                break;
            }
            let way = self.curves.cheapest_below(self.poses[other as usize], pose, &self.price, bound);
            if let Some(way) = way.filter(|way| way.price > 0.0) {
                let rank = best.partition_point(|(better, _)| better.price <= way.price);
                best.insert(rank, (way, other));
                best.truncate(self.neighbours);
            }
        }
    }

    /// Makes the edges ready for queries.
    pub fn finish(&mut self) {
        self.count_components();
        let mut first = vec![0; self.poses.len() + 1];
        for node in self.edges.iter().flat_map(|edge| edge.nodes) {
            first[node as usize + 1] += 1;
        }
        for node in 0..self.poses.len() {
            first[node + 1] += first[node];
        }
        let nothing = Link { to: 0, edge: 0, cost: 0.0, departs_reverse: false, arrives_reverse: false };
        let mut next = first.clone();
        self.links = vec![nothing; 2 * self.edges.len()];
        for (number, edge) in self.edges.iter().enumerate() {
            let mut segments = edge.way.curve.segments();
            let departs = segments.next().is_some_and(|segment| segment.is_reverse());
            let arrives = segments.last().map_or(departs, |segment| segment.is_reverse());
            let there = Link {
                to: edge.nodes[1],
                edge: number as u32,
                cost: edge.way.price,
                departs_reverse: departs,
                arrives_reverse: arrives,
            };
            let back = Link { to: edge.nodes[0], departs_reverse: !arrives, arrives_reverse: !departs, ..there };
            for (node, link) in edge.nodes.into_iter().zip([there, back]) {
                self.links[next[node as usize] as usize] = link;
                next[node as usize] += 1;
            }
        }
        self.first = first;
    }

    /// Sweeps edges, cheapest first, that would join components (J. B. Kruskal, "On the shortest spanning subtree of a graph
    /// and the traveling salesman problem", Proc. AMS 7, 1956). The others wait until a query needs them.
    fn count_components(&mut self) {
        let mut order: Vec<u32> = (0..self.edges.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| {
            let price = |edge: u32| self.edges[edge as usize].way.price;
            price(a).total_cmp(&price(b)).then(a.cmp(&b))
        });
        let mut sets = UnionFind::<u32>::new(self.poses.len());
        self.components = self.poses.len() as u32;
        for edge in order {
            let [a, b] = self.edges[edge as usize].nodes;
            if !sets.equiv(a, b) && self.is_free(edge, 0) {
                sets.union(a, b);
                self.components -= 1;
            }
        }
    }

    pub fn links(&self, node: u32) -> impl Iterator<Item = (u32, Link)> + '_ {
        let range = self.first[node as usize]..self.first[node as usize + 1];
        range.map(|link| (link, self.links[link as usize]))
    }

    pub fn link(&self, link: u32) -> Link {
        self.links[link as usize]
    }

    /// Whether an edge keeps one of the clearances; it is swept the first time that this is asked.
    pub fn is_free(&mut self, edge: u32, level: Level) -> bool {
        let edge = &mut self.edges[edge as usize];
        *edge.is_free[level].get_or_insert_with(|| {
            let mut pose = self.poses[edge.nodes[0] as usize];
            edge.way.curve.segments().all(|segment| {
                let from = pose;
                pose = segment.end(from);
                self.checker.motion_is_free(from, segment, self.clearances_m[level])
            })
        })
    }

    /// Adds the segments of a link to a way.
    pub fn append(&self, link: Link, way: &mut Vec<Segment>) {
        let edge = &self.edges[link.edge as usize];
        let joint = way.len();
        way.extend(edge.way.curve.segments());
        if link.to == edge.nodes[0] {
            way[joint..].reverse();
            way[joint..].iter_mut().for_each(|segment| segment.length_m = -segment.length_m);
        }
    }
}
