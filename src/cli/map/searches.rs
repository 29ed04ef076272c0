//! What the searches on cells answer, and the diagram that a path keeps to.

use crate::cli::map::computed::{
    BadQuestion, Bare, Computed, Values, Walk, Way, check_free, check_inside, check_size, timed, title_with_neighbours,
};
use crate::cli::map::search_args::{EightSearchArguments, SearchArguments, VoronoiArguments};
use crate::cli::map::traces::SearchTrace;
use wildfire_base::document::number::count;
use wildfire_grid::path_search::{PathSearch, SearchOrder, jump_point_search, search_best_first, theta_star};
use wildfire_grid::segment::line_length;
use wildfire_grid::voronoi::{path_along, voronoi};
use wildfire_grid::{CornerCutting, Grid, Place};

pub fn best_first(
    occupied: &Grid<bool>,
    arguments: &SearchArguments,
    order: SearchOrder,
) -> Result<Computed, BadQuestion> {
    let (name, command) = match order {
        SearchOrder::AStar => ("A*", "astar"),
        SearchOrder::Dijkstra => ("Dijkstra's search", "dijkstra"),
        SearchOrder::Greedy => ("Greedy search", "greedy"),
    };
    let (ends, neighbours, corners) =
        (arguments.ends.places(), arguments.neighbours.connectivity, arguments.corners.rule());
    let search = || search_best_first(occupied, ends, order, neighbours.into(), corners);
    let title = with_corners(title_with_neighbours(name, neighbours), corners);
    answer(occupied, &Question { title, command, ends, is_any_angle: false }, search)
}

pub fn any_angle(occupied: &Grid<bool>, arguments: &EightSearchArguments) -> Result<Computed, BadQuestion> {
    let (ends, corners) = (arguments.ends.places(), arguments.corners.rule());
    let title = with_corners("Theta*, 8 neighbours".to_owned(), corners);
    let question = Question { title, command: "theta", ends, is_any_angle: true };
    answer(occupied, &question, || theta_star(occupied, ends, corners))
}

pub fn jumps(occupied: &Grid<bool>, arguments: &EightSearchArguments) -> Result<Computed, BadQuestion> {
    let (ends, corners) = (arguments.ends.places(), arguments.corners.rule());
    let title = with_corners("Jump point search, 8 neighbours".to_owned(), corners);
    let question = Question { title, command: "jps", ends, is_any_angle: false };
    answer(occupied, &question, || jump_point_search(occupied, ends, corners))
}

fn with_corners(title: String, corners: CornerCutting) -> String {
    if corners == CornerCutting::Forbidden { format!("{title}, no corner cutting") } else { title }
}

/// What a search was asked.
struct Question {
    title: String,
    command: &'static str,
    ends: (Place, Place),
    is_any_angle: bool,
}

/// Accepts a goal on a free cell, a start on the map, and a map that there is room for.
pub fn check_problem(
    command: &'static str,
    occupied: &Grid<bool>,
    (start, goal): (Place, Place),
) -> Result<(), BadQuestion> {
    check_size(command, occupied)?;
    check_free("goal", occupied, goal)?;
    check_inside("start", occupied, start)
}

fn answer<E: std::fmt::Debug>(
    occupied: &Grid<bool>,
    question: &Question,
    search: impl FnOnce() -> Result<PathSearch, E>,
) -> Result<Computed, BadQuestion> {
    let (start, goal) = question.ends;
    check_problem(question.command, occupied, question.ends)?;
    let (found, cpu_map) = timed(|| search().expect("both ends are on the map"));
    let mut way = Way::from(found.route);
    if question.is_any_angle {
        way.is_any_angle = true;
        way.length = line_length(&way.cells);
    }
    Ok(Computed {
        bare: Bare::Infinite("not reached"),
        goal: Some(goal),
        walk: Some(Walk { start, goal, way }),
        search: Some(SearchTrace {
            cost: found.cost,
            expanded: found.expanded,
            touched: found.touched,
            swept: found.swept,
        }),
        cpu_map,
        ..Computed::timed(&question.title, "cost from start", || Values::Reals(found.costs))
    })
}

/// The Voronoi diagram, and a path that keeps to it.
pub fn diagram(occupied: &Grid<bool>, arguments: &VoronoiArguments) -> Result<Computed, BadQuestion> {
    check_size("voronoi", occupied)?;
    let corners = arguments.corners.rule();
    let ends = arguments.start.zip(arguments.goal);
    if let Some(ends) = ends {
        check_problem("voronoi", occupied, ends)?;
    }
    let (found, cpu_map) = timed(|| voronoi(occupied, arguments.sites.into()));
    let walk = ends.map(|(start, goal)| {
        timed(|| {
            let route = path_along(occupied, &found.diagram, (start, goal), corners);
            Walk { start, goal, way: route.expect("both ends are on the map").into() }
        })
    });
    let (walk, cpu_path) = walk.unzip();
    let mut values = found.clearance;
    for (value, &is_on) in values.values_mut().iter_mut().zip(found.diagram.values()) {
        *value = if is_on { *value } else { 0.0 };
    }
    let title = with_corners(format!("Voronoi diagram, {}", count(found.sites, "site")), corners);
    Ok(Computed {
        bare: Bare::Zero("off the diagram"),
        goal: ends.map(|(_, goal)| goal),
        walk,
        cpu_map,
        cpu_path,
        ..Computed::timed(&title, "clearance in cells", || Values::Reals(values))
    })
}
