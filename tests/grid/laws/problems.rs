//! Maps to try the laws on, and answers that share nothing with the functions under test.

use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;

use petgraph::algo::dijkstra;
use petgraph::graph::{NodeIndex, UnGraph};
use rand::RngExt;
use rand::seq::IndexedRandom;
use wildfire::grid::brushfire::brushfire;
use wildfire::grid::potential::{Attraction, Repulsion, RepulsionDistance, attraction, total};
use wildfire::grid::wavefront::{descend_wavefront, wavefront};
use wildfire::grid::{Connectivity, CornerCutting, Grid, Place, Route, TieOrder, drawn};
use wildfire::rng;

/// How cells are connected.
pub type Way = (Connectivity, CornerCutting);

/// The ways to connect cells that differ: with four neighbours there are no corners to cut.
pub const WAYS: [Way; 3] = [
    (Connectivity::Four, CornerCutting::Allowed),
    (Connectivity::Eight, CornerCutting::Allowed),
    (Connectivity::Eight, CornerCutting::Forbidden),
];

/// `#` is occupied, `.` free.
pub fn map(rows: &[&str]) -> Grid<bool> {
    let occupied = rows.iter().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
    Grid::from_values(rows.len(), rows[0].len(), occupied)
}

pub fn places(occupied: &Grid<bool>) -> Vec<Place> {
    (0..occupied.rows()).flat_map(|row| (0..occupied.cols()).map(move |col| (row, col))).collect()
}

pub fn free_places(occupied: &Grid<bool>) -> Vec<Place> {
    places(occupied).into_iter().filter(|&place| !occupied[place]).collect()
}

/// A random map of up to 20 x 20 cells, every tenth of up to 70 x 70, scattered or a maze, with two of its free cells.
pub fn random_problem(seed: u64) -> (Grid<bool>, Place, Place) {
    let mut rng = rng::stream(seed, "tests/grid_laws");
    loop {
        let side = if seed.is_multiple_of(10) { 70 } else { 20 };
        let (rows, cols) = (rng.random_range(1..=side), rng.random_range(1..=side));
        let occupied = match seed % 3 {
            0 => drawn::maze(rows, cols, rng.random_range(1..=3), &mut rng),
            _ => {
                let share = rng.random_range(0.0..0.5);
                drawn::random(rows, cols, share, &mut rng)
            }
        };
        let free = free_places(&occupied);
        if let (Some(&start), Some(&goal)) = (free.choose(&mut rng), free.choose(&mut rng)) {
            return (occupied, start, goal);
        }
    }
}

pub fn is_legal(occupied: &Grid<bool>, from: Place, to: Place, (connectivity, corners): Way) -> bool {
    let (rows, cols) = (from.0.abs_diff(to.0), from.1.abs_diff(to.1));
    let is_diagonal = rows + cols == 2;
    let cuts = is_diagonal && (occupied[(from.0, to.1)] || occupied[(to.0, from.1)]);
    let is_step = rows.max(cols) == 1 && (!is_diagonal || connectivity == Connectivity::Eight);
    let may_pass = corners == CornerCutting::Allowed || !cuts;
    is_step && may_pass && !occupied[from] && !occupied[to]
}

/// Where legal steps lead, by [`TieOrder::CrossFirst`].
pub fn neighbours(occupied: &Grid<bool>, from: Place, way: Way) -> impl Iterator<Item = Place> {
    let steps = TieOrder::CrossFirst.steps(Connectivity::Eight).iter();
    let places = steps.map(move |&(rows, cols)| (from.0.wrapping_add_signed(rows), from.1.wrapping_add_signed(cols)));
    places.filter(move |to| occupied.get(to.0, to.1).is_some() && is_legal(occupied, from, *to, way))
}

pub fn assert_is_walk(occupied: &Grid<bool>, path: &[Place], start: Place, goal: Place, way: Way) {
    assert_eq!((path[0], path[path.len() - 1]), (start, goal));
    for pair in path.windows(2) {
        assert!(is_legal(occupied, pair[0], pair[1], way), "{:?} to {:?}, {way:?}", pair[0], pair[1]);
    }
}

/// Lengths of shortest walks to `goal` by another library's Dijkstra.
pub fn lengths_by_petgraph(occupied: &Grid<bool>, goal: Place, way: Way) -> BTreeMap<Place, f64> {
    let places = places(occupied);
    let mut graph = UnGraph::<Place, f64>::with_capacity(places.len(), 4 * places.len());
    let nodes: Vec<NodeIndex> = places.iter().map(|&place| graph.add_node(place)).collect();
    for (a, &from) in places.iter().enumerate() {
        // To the east and to the three in the row below; an edge leads both ways.
        for (rows, cols) in [(0, 1), (1, -1), (1, 0), (1, 1)] {
            let to = (from.0 + rows, from.1.wrapping_add_signed(cols));
            if occupied.get(to.0, to.1).is_some() && is_legal(occupied, from, to, way) {
                let length = if rows == 1 && cols != 0 { SQRT_2 } else { 1.0 };
                graph.add_edge(nodes[a], nodes[to.0 * occupied.cols() + to.1], length);
            }
        }
    }
    let goal = nodes[goal.0 * occupied.cols() + goal.1];
    let found = dijkstra(&graph, goal, None, |edge| *edge.weight());
    found.into_iter().map(|(node, length)| (graph[node], length)).collect()
}

pub fn route_by_wavefront(occupied: &Grid<bool>, start: Place, goal: Place, way: Way) -> Route {
    let values = wavefront(occupied, goal, way.0, way.1).expect("the goal is free");
    descend_wavefront(&values, start, way.0, way.1, TieOrder::CrossFirst)
}

/// The potential of the report: scaled attraction plus repulsion.
pub fn potential(
    occupied: &Grid<bool>,
    goal: Place,
    connectivity: Connectivity,
    distance: RepulsionDistance,
) -> Grid<f64> {
    let values = brushfire(occupied, connectivity).unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0));
    let attraction = attraction(occupied.rows(), occupied.cols(), goal, Attraction::default(), Some(10.0));
    total(attraction, &values, &Repulsion { distance, ..Repulsion::default() })
}
