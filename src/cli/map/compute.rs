//! Computing what a command asks of a map.

use crate::cli::map::args::{
    AttractionArguments, BrushfireArguments, Computation, CostArguments, DescendArguments, RepulsionArguments,
    WavefrontArguments,
};
use crate::cli::map::computed::{
    BadQuestion, Bare, Computed, Values, Walk, Way, check_free, check_inside, timed, title_with_neighbours,
};
use crate::cli::map::options::{self, AttractionOptions, Convention, FieldArguments};
use crate::cli::map::{graphs, searches};
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::cost_map::cost_map;
use wildfire_grid::descent::{descend, descend_or_escape};
use wildfire_grid::distance::euclidean_distances;
use wildfire_grid::octile::shortest_path;
use wildfire_grid::path_search::SearchOrder;
use wildfire_grid::wavefront::{UNREACHED, descend_wavefront, wavefront};
use wildfire_grid::{Connectivity, Grid, Place, potential};

/// Does what a command asks, on a map.
pub fn compute(computation: &Computation, occupied: &Grid<bool>) -> Result<Computed, BadQuestion> {
    match computation {
        Computation::Occupancy(_) => Ok(occupancy(occupied)),
        Computation::Brushfire(arguments) => Ok(distances(occupied, arguments)),
        Computation::Cost(arguments) => Ok(costs(occupied, arguments)),
        Computation::Wavefront(arguments) => steps(occupied, arguments),
        Computation::Attraction(arguments) => attraction(occupied, arguments),
        Computation::Repulsion(arguments) => Ok(repulsion(occupied, arguments)),
        Computation::Total(arguments) => total(occupied, &arguments.field),
        Computation::Descend(arguments) => descent(occupied, arguments),
        Computation::Euclidean(_) => Ok(euclidean(occupied)),
        Computation::Voronoi(arguments) => searches::diagram(occupied, arguments),
        Computation::Astar(arguments) => searches::best_first(occupied, arguments, SearchOrder::AStar),
        Computation::Dijkstra(arguments) => searches::best_first(occupied, arguments, SearchOrder::Dijkstra),
        Computation::Greedy(arguments) => searches::best_first(occupied, arguments, SearchOrder::Greedy),
        Computation::Theta(arguments) => searches::any_angle(occupied, arguments),
        Computation::Jps(arguments) => searches::jumps(occupied, arguments),
        Computation::Rrt(arguments) => graphs::rrt(occupied, arguments),
        Computation::RrtStar(arguments) => graphs::rrt_star(occupied, arguments),
        Computation::Prm(arguments) => graphs::roadmap(occupied, arguments),
    }
}

fn occupancy(occupied: &Grid<bool>) -> Computed {
    Computed::timed("Occupancy", "occupied", || Values::Flags(occupied.clone()))
}

fn distances(occupied: &Grid<bool>, arguments: &BrushfireArguments) -> Computed {
    let neighbours = arguments.neighbours.connectivity;
    let value_name = match arguments.convention {
        Convention::ObstacleOne => "distance + 1",
        Convention::ObstacleZero => "distance",
    };
    Computed::timed(&title_with_neighbours("Brushfire", neighbours), value_name, || {
        let mut values = brushfire_or_zero(occupied, neighbours.into());
        if arguments.convention == Convention::ObstacleZero {
            values.values_mut().iter_mut().for_each(|value| *value = value.saturating_sub(1));
        }
        Values::Distances(values)
    })
}

/// The brushfire map, 0 everywhere without obstacles.
fn brushfire_or_zero(occupied: &Grid<bool>, connectivity: Connectivity) -> Grid<u16> {
    brushfire(occupied, connectivity).unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0))
}

fn euclidean(occupied: &Grid<bool>) -> Computed {
    let none = || Grid::filled(occupied.rows(), occupied.cols(), 0.0);
    Computed::timed("Euclidean distance", "distance in cells", || {
        Values::Reals(euclidean_distances(occupied).unwrap_or_else(none))
    })
}

fn costs(occupied: &Grid<bool>, arguments: &CostArguments) -> Computed {
    Computed::timed("Cost map", "cost", || {
        Values::Reals(cost_map(&brushfire_or_zero(occupied, Connectivity::Four), &arguments.zones()))
    })
}

fn steps(occupied: &Grid<bool>, arguments: &WavefrontArguments) -> Result<Computed, BadQuestion> {
    let (goal, neighbours) = (arguments.goal.goal, arguments.neighbours.connectivity);
    let (connectivity, corners) = (neighbours.into(), arguments.corners.rule());
    check_free("goal", occupied, goal)?;
    if let Some(start) = arguments.start {
        check_inside("start", occupied, start)?;
    }
    let wave = || wavefront(occupied, goal, connectivity, corners).expect("the goal is free");
    let (values, cpu_map) = timed(wave);
    let walk = arguments.start.map(|start| {
        timed(|| {
            let route = if arguments.shortest {
                shortest_path(occupied, start, goal, connectivity, corners).expect("both ends are on the map")
            } else {
                descend_wavefront(&values, start, connectivity, corners, arguments.tie_order.into())
            };
            Walk { start, goal, way: route.into() }
        })
    });
    let (walk, cpu_path) = walk.unzip();
    Ok(Computed {
        title: title_with_neighbours("Wavefront", neighbours),
        value_name: if arguments.scale.is_some() { "scaled value" } else { "steps + 2" },
        bare: Bare::Zero("unreached"),
        search: None,
        graph: None,
        unreached: Some(values.values().iter().filter(|&&value| value == UNREACHED).count()),
        values: match arguments.scale {
            Some(scale) => Values::Reals(scaled(&values, scale)),
            None => Values::Steps(values),
        },
        goal: Some(goal),
        walk,
        cpu_map,
        cpu_path,
    })
}

/// All values divided by the largest, times `scale`.
fn scaled(values: &Grid<u32>, scale: f64) -> Grid<f64> {
    let max = f64::from(values.values().iter().copied().max().unwrap_or(1));
    let reals = values.values().iter().map(|&value| f64::from(value) / max * scale).collect();
    Grid::from_values(values.rows(), values.cols(), reals)
}

fn attraction(occupied: &Grid<bool>, arguments: &AttractionArguments) -> Result<Computed, BadQuestion> {
    let goal = arguments.goal.goal;
    check_inside("goal", occupied, goal)?;
    let field = || Values::Reals(attraction_field(occupied, goal, &arguments.attraction));
    Ok(Computed { goal: Some(goal), ..Computed::timed("Attraction", "potential", field) })
}

fn attraction_field(occupied: &Grid<bool>, goal: Place, options: &AttractionOptions) -> Grid<f64> {
    potential::attraction(occupied.rows(), occupied.cols(), goal, options.kind(), options.scale.0)
}

fn repulsion(occupied: &Grid<bool>, arguments: &RepulsionArguments) -> Computed {
    let neighbours = arguments.neighbours.connectivity;
    let brushfire = || brushfire_or_zero(occupied, neighbours.into());
    let field = || Values::Reals(potential::repulsion(&brushfire(), &arguments.repulsion.law()));
    Computed::timed(&title_with_neighbours("Repulsion", neighbours), "potential", field)
}

fn total(occupied: &Grid<bool>, arguments: &FieldArguments) -> Result<Computed, BadQuestion> {
    let goal = arguments.goal.goal;
    check_inside("goal", occupied, goal)?;
    let title = title_with_neighbours("Total potential", arguments.neighbours.connectivity);
    let field = || Values::Reals(total_field(occupied, arguments));
    Ok(Computed { goal: Some(goal), ..Computed::timed(&title, "potential", field) })
}

fn total_field(occupied: &Grid<bool>, arguments: &FieldArguments) -> Grid<f64> {
    let brushfire = brushfire_or_zero(occupied, arguments.neighbours.connectivity.into());
    let attraction = attraction_field(occupied, arguments.goal.goal, &arguments.attraction);
    potential::total(attraction, &brushfire, &arguments.repulsion.law())
}

fn descent(occupied: &Grid<bool>, arguments: &DescendArguments) -> Result<Computed, BadQuestion> {
    let (start, goal, neighbours) =
        (arguments.start, arguments.field.goal.goal, arguments.field.neighbours.connectivity);
    let (connectivity, corners) = (neighbours.into(), arguments.corners.rule());
    check_free("goal", occupied, goal)?;
    check_inside("start", occupied, start)?;
    let (field, cpu_map) = timed(|| total_field(occupied, &arguments.field));
    let (walk, cpu_path) = timed(|| {
        let walk = match arguments.escape {
            None => descend(&field, occupied, start, goal, connectivity, corners).map(Way::from),
            Some(options::Escape::Wavefront) => {
                descend_or_escape(&field, occupied, start, goal, connectivity, corners).map(Way::from)
            }
        };
        Walk { start, goal, way: walk.expect("both ends are on the map") }
    });
    Ok(Computed {
        title: title_with_neighbours("Gradient descent", neighbours),
        value_name: "potential",
        values: Values::Reals(field),
        bare: Bare::None,
        search: None,
        graph: None,
        unreached: None,
        goal: Some(goal),
        walk: Some(walk),
        cpu_map,
        cpu_path: Some(cpu_path),
    })
}
