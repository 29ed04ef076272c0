//! What trees and roadmaps of points answer.

use std::time::Duration;

use crate::cli::map::computed::{BadQuestion, Bare, Computed, Values, Walk, WalkResult, Way, timed};
use crate::cli::map::search_args::{PrmArguments, RrtArguments, RrtStarArguments};
use crate::cli::map::searches::check_problem;
use crate::cli::map::traces::GraphTrace;
use wildfire_grid::sampling::{PointGraph, PointRoute, TreeKind, grow_tree, probabilistic_roadmap};
use wildfire_grid::segment::GridPoint;
use wildfire_grid::{Grid, Place};

pub fn rrt(occupied: &Grid<bool>, arguments: &RrtArguments) -> Result<Computed, BadQuestion> {
    let (ends, settings) = (arguments.ends.places(), arguments.growth.settings(occupied, None));
    check_problem("rrt", occupied, ends)?;
    let found = timed(|| grow_tree(occupied, ends, TreeKind::Rrt, &settings).expect("both ends are on the map"));
    Ok(answer(occupied, "RRT", ends, found))
}

pub fn rrt_star(occupied: &Grid<bool>, arguments: &RrtStarArguments) -> Result<Computed, BadQuestion> {
    let (ends, settings) = (arguments.ends.places(), arguments.growth.settings(occupied, Some(&arguments.near)));
    check_problem("rrt-star", occupied, ends)?;
    let found = timed(|| grow_tree(occupied, ends, TreeKind::RrtStar, &settings).expect("both ends are on the map"));
    Ok(answer(occupied, "RRT*", ends, found))
}

pub fn roadmap(occupied: &Grid<bool>, arguments: &PrmArguments) -> Result<Computed, BadQuestion> {
    let ends = arguments.ends.places();
    check_problem("prm", occupied, ends)?;
    let search = || probabilistic_roadmap(occupied, ends, &arguments.settings());
    Ok(answer(occupied, "PRM", ends, timed(|| search().expect("both ends are on the map"))))
}

fn answer(
    occupied: &Grid<bool>,
    name: &str,
    (start, goal): (Place, Place),
    (graph, cpu_map): (PointGraph, Duration),
) -> Computed {
    let mut least = Grid::filled(occupied.rows(), occupied.cols(), f64::INFINITY);
    for (point, &cost) in graph.points.iter().zip(&graph.costs) {
        let cell = point.cell();
        least[cell] = least[cell].min(cost);
    }
    let spot = |number: u32| graph.points[number as usize].coordinates();
    let edges = graph.edges.iter().map(|edge| edge.map(spot)).collect();
    let way = Way {
        answer: match graph.answer {
            PointRoute::Found => WalkResult::Reached,
            PointRoute::NotFound => WalkResult::NotFound,
            PointRoute::StartOccupied => WalkResult::StartOccupied,
        },
        cells: graph.path.iter().map(|point| point.cell()).collect(),
        points: graph.path.iter().map(|point| GridPoint::coordinates(*point)).collect(),
        length: graph.cost.unwrap_or(0.0),
        is_any_angle: true,
        minimum: None,
    };
    let trace = GraphTrace { cost: graph.cost, samples: graph.samples, vertices: graph.points.len(), edges };
    Computed {
        bare: Bare::Infinite("no point"),
        goal: Some(goal),
        walk: Some(Walk { start, goal, way }),
        graph: Some(trace),
        cpu_map,
        ..Computed::timed(name, "cost from start", || Values::Reals(least))
    }
}
