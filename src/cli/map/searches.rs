//! Searches on cells and the diagram that a path keeps to: their parameters, and what they answer.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::cli::map::commands::ArgumentGroup;
use crate::cli::map::computed::{
    Computed, MapInputError, MapValues, MapWalk, NoData, check_problem, check_size, timed, title_with_neighbours,
};
use crate::cli::map::options::{
    CornerArguments, EndArguments, GoalArguments, NeighbourArguments, Neighbours, PathArguments, choices, neighbours,
    parse_number, parse_place,
};
use crate::cli::map::traces::{SearchTrace, ShortestCost};
use crate::cli::output_files::Format;
use wildfire_base::document::number::count;
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::path_search::{
    Heuristic, PathSearch, SearchOrder, jump_point_search, search_best_first, theta_star,
};
use wildfire_grid::segment::line_length;
use wildfire_grid::voronoi::{Sites, path_along, voronoi};
use wildfire_grid::{CornerCutting, Grid, Place};

/// Files that only searches write.
#[derive(Debug, Default, Args)]
pub struct SearchFiles {
    /// Write the cells in the order of expansion: order,row,col,cost.
    #[arg(long, value_name = "FILE.csv")]
    pub expansions: Option<PathBuf>,
    /// Draw the search as an animation, expansion by expansion.
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
}

#[derive(Debug, Args, Serialize)]
pub struct SearchParameters {
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct GreedyParameters {
    #[command(flatten)]
    #[serde(flatten)]
    pub search: SearchParameters,
    /// Estimate of the cost to the goal [default: octile, with 4 neighbours manhattan].
    #[arg(long, value_enum, value_name = "NAME")]
    pub heuristic: Option<HeuristicName>,
}

#[derive(Debug, Args, Serialize)]
pub struct AstarParameters {
    #[command(flatten)]
    #[serde(flatten)]
    pub estimate: GreedyParameters,
    /// Factor of the estimate, from 0 to 1000; above 1 the path may be longer than the shortest.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_hyphen_values = true,
        value_parser = parse_number
    )]
    pub weight: f64,
}

/// The parameters of a search in the order of costs and estimates.
pub trait Ordered {
    fn search(&self) -> &SearchParameters;

    fn order(&self) -> SearchOrder;

    /// The words that open the title, and the subcommand.
    fn names(&self) -> (String, &'static str);
}

/// Parameters of searches that have 8 neighbours always.
#[derive(Debug, Args, Serialize)]
pub struct EightSearchParameters {
    /// Neighbours of a cell: always 8 in this search.
    #[arg(
        long = "neighbours",
        alias = "connectivity",
        value_name = "8",
        default_value = "8",
        value_parser = neighbours(&["8"])
    )]
    pub connectivity: Neighbours,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct VoronoiArguments {
    /// Sites: connected obstacles and each wall, or single cells seen at least 60 degrees apart.
    #[arg(long, value_enum, value_name = "NAME", default_value = "obstacles")]
    pub sites: SiteKind,
    /// Start of a path along the diagram.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place, requires = "goal")]
    pub start: Option<Place>,
    /// Goal of the path.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place, requires = "start")]
    pub goal: Option<Place>,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

choices! {
    SiteKind for Sites { Obstacles, Cells }
    HeuristicName for Heuristic { Zero, Euclidean, Octile, Manhattan }
}

impl ArgumentGroup for SearchFiles {
    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &self.expansions), (Format::Gif, &self.gif)]
    }
}

impl ArgumentGroup for SearchParameters {}

impl ArgumentGroup for GreedyParameters {}

impl ArgumentGroup for AstarParameters {
    fn check(&self) -> Result<(), BadParameter> {
        self.order().check()
    }
}

impl GreedyParameters {
    fn heuristic(&self) -> Heuristic {
        let exact = Heuristic::exact(self.search.neighbours.connectivity.into());
        self.heuristic.map_or(exact, Heuristic::from)
    }

    /// The name of a search with the estimate, if it was chosen.
    fn named(&self, name: &str) -> String {
        let Some(heuristic) = self.heuristic else { return name.to_owned() };
        format!("{name}, heuristic {}", format!("{heuristic:?}").to_lowercase())
    }
}

impl Ordered for SearchParameters {
    fn search(&self) -> &SearchParameters {
        self
    }

    fn order(&self) -> SearchOrder {
        SearchOrder::Dijkstra
    }

    fn names(&self) -> (String, &'static str) {
        ("Dijkstra's search".to_owned(), "dijkstra")
    }
}

impl Ordered for GreedyParameters {
    fn search(&self) -> &SearchParameters {
        &self.search
    }

    fn order(&self) -> SearchOrder {
        SearchOrder::Greedy { heuristic: self.heuristic() }
    }

    fn names(&self) -> (String, &'static str) {
        (self.named("Greedy search"), "greedy")
    }
}

impl Ordered for AstarParameters {
    fn search(&self) -> &SearchParameters {
        &self.estimate.search
    }

    fn order(&self) -> SearchOrder {
        SearchOrder::AStar { heuristic: self.estimate.heuristic(), weight: self.weight }
    }

    fn names(&self) -> (String, &'static str) {
        let weight = if self.weight == 1.0 { String::new() } else { format!(", weight {}", self.weight) };
        (self.estimate.named("A*") + &weight, "astar")
    }
}

impl ArgumentGroup for EightSearchParameters {}

impl ArgumentGroup for VoronoiArguments {
    fn has_start(&self) -> bool {
        self.start.is_some()
    }
}

/// Arguments of a search.
pub type Search<P> = PathArguments<SearchFiles, P>;

pub fn best_first<P: Args + Ordered>(
    occupied: &Grid<bool>,
    Search { ends, parameters, .. }: &Search<P>,
) -> Result<Computed, MapInputError> {
    let SearchParameters { neighbours, corners } = parameters.search();
    let neighbours = neighbours.connectivity;
    let corners = corners.rule();
    let (name, command) = parameters.names();
    let order = parameters.order();
    let connectivity = neighbours.into();
    let search = |order| search_best_first(occupied, ends.start, ends.goal.goal, order, connectivity, corners);
    let title = with_corners(title_with_neighbours(&name, neighbours), corners);
    let mut found = answer(occupied, command, ends, |_, _| search(order))?;
    let bound = order.cost_bound(connectivity);
    // Where the order guarantees the shortest path, a second search would find the same cost.
    if let Some(trace) = found.search.as_mut().filter(|trace| trace.cost.is_some() && bound != Some(1.0)) {
        let shortest = search(SearchOrder::astar(connectivity)).expect("both ends are on the map");
        trace.shortest = shortest.cost.map(|cost| ShortestCost { cost, bound });
    }
    Ok(Computed { title, ..found })
}

pub fn any_angle(
    occupied: &Grid<bool>,
    Search { ends, parameters, .. }: &Search<EightSearchParameters>,
) -> Result<Computed, MapInputError> {
    let corners = parameters.corners.rule();
    let mut found = answer(occupied, "theta", ends, |start, goal| theta_star(occupied, start, goal, corners))?;
    if let Some(MapWalk { path, .. }) = &mut found.walk {
        // A route is measured from cell to cell at first, whereas these cells are joined by segments.
        path.is_any_angle = true;
        path.length = line_length(&path.cells);
    }
    Ok(Computed { title: with_corners("Theta*, 8 neighbours".to_owned(), corners), ..found })
}

pub fn jumps(
    occupied: &Grid<bool>,
    Search { ends, parameters, .. }: &Search<EightSearchParameters>,
) -> Result<Computed, MapInputError> {
    let corners = parameters.corners.rule();
    let found = answer(occupied, "jps", ends, |start, goal| jump_point_search(occupied, start, goal, corners))?;
    Ok(Computed { title: with_corners("Jump point search, 8 neighbours".to_owned(), corners), ..found })
}

fn with_corners(title: String, corners: CornerCutting) -> String {
    if corners == CornerCutting::Forbidden { format!("{title}, no corner cutting") } else { title }
}

/// Returns what a search found, still without a title.
fn answer<E: std::fmt::Debug>(
    occupied: &Grid<bool>,
    command: &'static str,
    &EndArguments { start, goal: GoalArguments { goal, .. } }: &EndArguments,
    search: impl FnOnce(Place, Place) -> Result<PathSearch, E>,
) -> Result<Computed, MapInputError> {
    check_problem(command, occupied, start, goal)?;
    let (found, cpu_map) = timed(|| search(start, goal).expect("both ends are on the map"));
    let PathSearch { route, cost, expanded, touched, swept, costs } = found;
    Ok(Computed {
        bare: NoData::Infinite("not reached"),
        goal: Some(goal),
        walk: Some(MapWalk { start, goal, path: route.into() }),
        search: Some(SearchTrace { cost, shortest: None, expanded, touched, swept }),
        ..Computed::new("", "cost from start", (MapValues::Reals(costs), cpu_map))
    })
}

/// The Voronoi diagram, and a path that keeps to it.
pub fn diagram(occupied: &Grid<bool>, arguments: &VoronoiArguments) -> Result<Computed, MapInputError> {
    check_size("voronoi", occupied)?;
    let corners = arguments.corners.rule();
    let ends = arguments.start.zip(arguments.goal);
    // The ends are checked before the diagram, which is computed for the whole map.
    if let Some((start, goal)) = ends {
        check_problem("voronoi", occupied, start, goal)?;
    }
    let (found, cpu_map) = timed(|| voronoi(occupied, arguments.sites.into()));
    let walk = ends.map(|(start, goal)| {
        timed(|| {
            let route = path_along(occupied, &found.diagram, start, goal, corners);
            MapWalk { start, goal, path: route.expect("both ends are on the map").into() }
        })
    });
    let (walk, cpu_path) = walk.unzip();
    let mut values = found.clearance;
    for (value, &is_on) in values.values_mut().iter_mut().zip(found.diagram.values()) {
        // Off the diagram a clearance would fill the picture, and hide the lines that it is about.
        *value = if is_on { *value } else { 0.0 };
    }
    let title = with_corners(format!("Voronoi diagram, {}", count(found.sites, "site")), corners);
    let bare = NoData::Zero("off the diagram");
    let goal = ends.map(|(_, goal)| goal);
    let computed = Computed::new(title, "clearance in cells", (MapValues::Reals(values), cpu_map));
    Ok(Computed { bare, goal, walk, cpu_path, ..computed })
}
