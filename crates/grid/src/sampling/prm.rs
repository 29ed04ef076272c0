//! PRM: a roadmap over random free points, and a shortest path in it.
//!
//! L. Kavraki, P. Svestka, J.-C. Latombe, M. Overmars, "Probabilistic Roadmaps for Path Planning in High-Dimensional
//! Configuration Spaces", IEEE Transactions on Robotics and Automation 12(4), 1996; joined with as many nearest neighbours
//! as S. Karaman and E. Frazzoli's PRM* asks for (2011, section 3.3.3) unless another number is given.

use super::point_index::PointIndex;
use super::{
    CORNERS, PointGraph, PointRoute, check_neighbours, check_radius, check_samples, draw_point, neighbours_of_many,
    squared_units,
};
use crate::open_list::{OpenList, Ranked};
use crate::parameter::BadParameter;
use crate::segment::{GridPoint, is_free_segment};
use crate::{BadPlace, Grid, Place, place};
use wildfire_base::rng;

/// The settings of a roadmap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrmSettings {
    pub seed: u64,
    /// The number of samples; those in obstacles are dropped.
    pub samples: u32,
    /// The number of nearest points to which each point is joined; 2e ln n of n points if `None`.
    pub neighbours: Option<u32>,
    /// The longest edge in cells; unlimited if `None`.
    pub radius: Option<f64>,
}

impl PrmSettings {
    /// Accepts settings in the ranges that a roadmap supports.
    pub fn check(&self) -> Result<(), BadParameter> {
        check_samples(self.samples)?;
        check_neighbours(self.neighbours)?;
        check_radius(self.radius)
    }
}

/// Builds a roadmap that includes the centres of the start and the goal cell, and finds a shortest path in it.
///
/// Errors are those of [`super::grow_tree`].
///
/// # Panics
/// If [`PrmSettings::check`] refuses the settings.
pub fn probabilistic_roadmap(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    settings: &PrmSettings,
) -> Result<PointGraph, BadPlace> {
    settings.check().expect("the settings were checked");
    if !place::check_ends(occupied, start, goal)? {
        return Ok(PointGraph::from_occupied_start());
    }
    let mut rng = rng::stream(settings.seed, "map/prm");
    let drawn: Vec<GridPoint> = (0..settings.samples).map(|_| draw_point(occupied, &mut rng)).collect();
    // Sorted out after all draws, so that an obstacle does not move the points that follow.
    let free = drawn.into_iter().filter(|point| !occupied[point.cell()]);
    // The ends come first, so that the start has number 0 and the goal number 1.
    let points: Vec<GridPoint> = [start, goal].map(GridPoint::centre).into_iter().chain(free).collect();
    let edges = join(occupied, &points, settings);
    let (costs, parents) = shortest_ways(&points, &edges);
    let is_found = costs[1].is_finite();
    let mut path = Vec::new();
    if is_found {
        let mut here = 1;
        path.push(points[here]);
        while here != 0 {
            here = parents[here] as usize;
            path.push(points[here]);
        }
        path.reverse();
        // A goal in the start's cell is the same point.
        path.dedup();
    }
    Ok(PointGraph {
        answer: if is_found { PointRoute::Found } else { PointRoute::NotFound },
        cost: is_found.then(|| costs[1]),
        points,
        edges,
        costs,
        path,
        samples: settings.samples,
        earlier: Vec::new(),
    })
}

/// Joins every point with its nearest ones where the segment is free, each pair once, in the order of the points.
fn join(occupied: &Grid<bool>, points: &[GridPoint], settings: &PrmSettings) -> Vec<[u32; 2]> {
    let mut index = PointIndex::new(occupied, points.len());
    (0..).zip(points).for_each(|(number, &point)| index.add(number, point));
    let max = settings.neighbours.map_or_else(|| neighbours_of_many(points.len()), |max| max as usize);
    let squared_radius = squared_units(settings.radius);
    let mut pairs = Vec::new();
    for (number, &point) in (0_u32..).zip(points) {
        // The point is the nearest to itself, or as near as another at the same place.
        let near = index.nearest_of_many(point, max + 1, squared_radius);
        let others = near.into_iter().filter(|&other| other != number).take(max);
        pairs.extend(others.map(|other| [number.min(other), number.max(other)]));
    }
    // Two points that choose each other are one pair, found twice.
    pairs.sort_unstable();
    pairs.dedup();
    // Last, as the test of a segment costs the most.
    pairs.retain(|&[a, b]| is_free_segment(occupied, points[a as usize], points[b as usize], CORNERS));
    pairs
}

struct OpenSample {
    cost: f64,
    number: u32,
}

impl Ranked for OpenSample {
    type Tie = u32;

    fn priority(&self) -> f64 {
        self.cost
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> u32 {
        self.number
    }
}

/// Length of the way from the first point to each, and the point before it on that way (Dijkstra's search).
fn shortest_ways(points: &[GridPoint], edges: &[[u32; 2]]) -> (Vec<f64>, Vec<u32>) {
    let mut around = vec![Vec::new(); points.len()];
    for &[a, b] in edges {
        around[a as usize].push(b);
        around[b as usize].push(a);
    }
    let mut costs = vec![f64::INFINITY; points.len()];
    let mut parents = vec![0; points.len()];
    costs[0] = 0.0;
    let mut open = OpenList::default();
    open.push(OpenSample { cost: 0.0, number: 0 });
    while let Some(OpenSample { cost, number }) = open.pop() {
        let here = number as usize;
        // A shorter way to this point was found since the entry was made.
        if cost > costs[here] {
            continue;
        }
        for &to in &around[here] {
            let by_here = cost + points[here].distance(points[to as usize]);
            if by_here < costs[to as usize] {
                costs[to as usize] = by_here;
                parents[to as usize] = number;
                open.push(OpenSample { cost: by_here, number: to });
            }
        }
    }
    (costs, parents)
}
