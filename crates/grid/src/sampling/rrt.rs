//! RRT and RRT*: trees that grow from the start towards random points.
//!
//! S. LaValle, "Rapidly-Exploring Random Trees: A New Tool for Path Planning" (TR 98-11, Iowa State University, 1998), with
//! the goal drawn in place of a point now and then; S. Karaman, E. Frazzoli, "Sampling-based algorithms for optimal motion
//! planning", International Journal of Robotics Research 30(7), 2011, section 3.3.3, for RRT* with the nearest neighbours.

use rand::RngExt;

use super::point_index::PointIndex;
use super::{
    CORNERS, EarlierPath, PointGraph, PointRoute, check_neighbours, check_radius, check_samples, draw_point,
    neighbours_of_many, squared_units,
};
use crate::parameter::BadParameter;
use crate::segment::{GridPoint, is_free_segment};
use crate::{BadPlace, Grid, Place, place};
use wildfire_base::rng;

/// The kind of tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeKind {
    /// Stops when it reaches the goal.
    Rrt,
    /// Uses all samples, joins each point to the neighbour that makes the path shortest, and rewires neighbours through
    /// it.
    RrtStar,
}

/// The settings of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RrtSettings {
    pub seed: u64,
    /// The maximum number of samples.
    pub samples: u32,
    /// The longest edge, in cells.
    pub step: f64,
    /// The probability of sampling the goal instead of a random point.
    pub goal_bias: f64,
    /// The number of neighbours that RRT* considers; 2e ln n of n points if `None`.
    pub neighbours: Option<u32>,
    /// The radius in cells of RRT*'s neighbourhood; unlimited if `None`.
    pub radius: Option<f64>,
}

impl RrtSettings {
    /// Accepts settings in the ranges that trees support.
    pub fn check(&self) -> Result<(), BadParameter> {
        check_samples(self.samples)?;
        let is_step = (0.1..=100_000.0).contains(&self.step);
        BadParameter::unless(is_step, "the step", "a number of cells from 0.1 to 100000", self.step)?;
        let is_chance = (0.0..=1.0).contains(&self.goal_bias);
        BadParameter::unless(is_chance, "the goal bias", "a number from 0 to 1", self.goal_bias)?;
        check_neighbours(self.neighbours)?;
        check_radius(self.radius)
    }
}

/// The number of times that a growing RRT* is looked at for a path.
const LOOKS: u32 = 100;

/// Grows a tree from the centre of the start cell to that of the goal cell.
///
/// More samples of the same seed grow the same tree further, so that the cost of RRT* never rises with them. A goal
/// outside or in an obstacle is an error, and so is a start outside.
///
/// # Panics
/// If [`RrtSettings::check`] refuses the settings.
pub fn grow_tree(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    kind: TreeKind,
    settings: &RrtSettings,
) -> Result<PointGraph, BadPlace> {
    settings.check().expect("the settings were checked");
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PointGraph::from_occupied_start());
    }
    let start = GridPoint::centre(start);
    let goal = GridPoint::centre(goal);
    let mut rng = rng::stream(settings.seed, "map/rrt");
    let mut index = PointIndex::new(occupied, settings.samples as usize);
    index.add(0, start);
    let mut tree =
        SearchTree { occupied, points: vec![start], parents: vec![0], costs: vec![0.0], children: vec![Vec::new()] };
    // Points from which the goal is one step.
    let mut gates: Vec<u32> = tree.is_step(start, goal, settings.step).then_some(0).into_iter().collect();
    let mut samples = 0;
    let mut earlier: Vec<EarlierPath> = Vec::new();
    let mut shortest = f64::INFINITY;
    // A plain tree is done with the first path; RRT* gets better with every sample.
    while samples < settings.samples && (kind == TreeKind::RrtStar || gates.is_empty()) {
        samples += 1;
        // Both draws are made always, so that a bias does not shift the points that follow.
        let aims_at_goal = rng.random_bool(settings.goal_bias);
        let drawn = draw_point(occupied, &mut rng);
        let aim = if aims_at_goal { goal } else { drawn };
        let nearest = index.nearest(aim).expect("the start is there");
        let from = tree.points[nearest as usize];
        let point = steered(from, aim, settings.step);
        // Samples that are lost count too: the number of samples bounds the work.
        if point == from || !is_free_segment(occupied, from, point, CORNERS) {
            continue;
        }
        let around = match kind {
            TreeKind::Rrt => Vec::new(),
            TreeKind::RrtStar => {
                let max = settings.neighbours.map_or_else(|| neighbours_of_many(tree.points.len()), |max| max as usize);
                index.nearest_of_many(point, max, squared_units(settings.radius))
            }
        };
        let number = tree.join(point, nearest, &around);
        index.add(number, point);
        if tree.is_step(point, goal, settings.step) {
            gates.push(number);
        }
        // Only now and then: of many samples that reach the goal each would have to be compared.
        if kind == TreeKind::RrtStar && samples % settings.samples.div_ceil(LOOKS) == 0 {
            let gate = tree.best_gate(goal, &gates).filter(|&gate| tree.cost_over(gate, goal) < shortest);
            if let Some(gate) = gate {
                shortest = tree.cost_over(gate, goal);
                earlier.push(EarlierPath { edges: tree.points.len() - 1, path: tree.path_over(gate, goal) });
            }
        }
    }
    Ok(PointGraph { earlier, ..tree.into_graph(goal, &gates, samples) })
}

/// The point at most a step towards an aim.
fn steered(from: GridPoint, aim: GridPoint, step: f64) -> GridPoint {
    let distance = from.distance(aim);
    if distance <= step {
        return aim;
    }
    let along = |from: i64, aim: i64| from + ((aim - from) as f64 * (step / distance)).round() as i64;
    GridPoint::from_units(along(from.row, aim.row), along(from.col, aim.col))
}

struct SearchTree<'a> {
    occupied: &'a Grid<bool>,
    points: Vec<GridPoint>,
    /// The start is its own.
    parents: Vec<u32>,
    costs: Vec<f64>,
    children: Vec<Vec<u32>>,
}

impl SearchTree<'_> {
    fn is_step(&self, from: GridPoint, to: GridPoint, step: f64) -> bool {
        from.distance(to) <= step && is_free_segment(self.occupied, from, to, CORNERS)
    }

    /// Adds a point over the neighbour with the shortest way, the nearest among equals, and joins those neighbours again
    /// whose way gets shorter over it.
    fn join(&mut self, point: GridPoint, nearest: u32, around: &[u32]) -> u32 {
        let cost_by = |tree: &Self, by: u32| tree.costs[by as usize] + tree.points[by as usize].distance(point);
        let mut parent = nearest;
        let mut cost = cost_by(self, nearest);
        for &by in around {
            let to_point = cost_by(self, by);
            // The cheap comparison comes first: tests of segments are the main work.
            if to_point < cost && is_free_segment(self.occupied, self.points[by as usize], point, CORNERS) {
                (parent, cost) = (by, to_point);
            }
        }
        let number = self.points.len() as u32;
        self.points.push(point);
        self.parents.push(parent);
        self.costs.push(cost);
        self.children.push(Vec::new());
        self.children[parent as usize].push(number);
        // Rewiring (Karaman, Frazzoli, 2011) needs the cost of the new point, and so comes last.
        for &other in around {
            let at = self.points[other as usize];
            let by_point = cost + point.distance(at);
            if by_point < self.costs[other as usize] && is_free_segment(self.occupied, point, at, CORNERS) {
                self.move_below(other, number, by_point);
            }
        }
        number
    }

    /// Gives a point another parent; all that grew from it gets cheaper too.
    fn move_below(&mut self, number: u32, parent: u32, cost: f64) {
        let old = self.parents[number as usize] as usize;
        self.children[old].retain(|&child| child != number);
        self.parents[number as usize] = parent;
        self.children[parent as usize].push(number);
        self.costs[number as usize] = cost;
        let mut front = vec![number];
        while let Some(here) = front.pop() {
            // A copy, as costs change while the list is read.
            for child in self.children[here as usize].clone() {
                let edge = self.points[here as usize].distance(self.points[child as usize]);
                self.costs[child as usize] = self.costs[here as usize] + edge;
                front.push(child);
            }
        }
    }

    /// Returns the length of the path over a point from which the goal is one step.
    fn cost_over(&self, gate: u32, goal: GridPoint) -> f64 {
        self.costs[gate as usize] + self.points[gate as usize].distance(goal)
    }

    /// Returns the point over which the path is shortest, the first among equals.
    fn best_gate(&self, goal: GridPoint, gates: &[u32]) -> Option<u32> {
        gates.iter().copied().min_by(|&a, &b| self.cost_over(a, goal).total_cmp(&self.cost_over(b, goal)))
    }

    fn path_over(&self, gate: u32, goal: GridPoint) -> Vec<GridPoint> {
        let mut here = gate;
        let mut path = vec![goal, self.points[here as usize]];
        while here != 0 {
            here = self.parents[here as usize];
            path.push(self.points[here as usize]);
        }
        path.reverse();
        // The goal itself may have been drawn and joined.
        path.dedup();
        path
    }

    fn into_graph(self, goal: GridPoint, gates: &[u32], samples: u32) -> PointGraph {
        let best = self.best_gate(goal, gates);
        let path = best.map_or_else(Vec::new, |gate| self.path_over(gate, goal));
        let cost = best.map(|gate| self.cost_over(gate, goal));
        PointGraph {
            edges: (1..).zip(&self.parents[1..]).map(|(number, &parent)| [parent, number]).collect(),
            answer: if best.is_some() { PointRoute::Found } else { PointRoute::NotFound },
            path,
            cost,
            points: self.points,
            costs: self.costs,
            samples,
            earlier: Vec::new(),
        }
    }
}
