//! The computations of `wildfire map`: a table of their words, their parameters and the functions that compute them.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::cli::map::computed::{Computed, MapInputError};
use crate::cli::map::options::FileArguments;
use crate::cli::map::{fields, graphs, searches};
use crate::cli::output_files::Format;
use wildfire_grid::Grid;
use wildfire_grid::parameter::BadParameter;

/// A command's files, and the parameters of its algorithm. Serialised it is the parameters in the JSON.
#[derive(Debug, Args, Serialize)]
#[serde(transparent)]
pub struct MapQuery<P: Args> {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    pub parameters: P,
}

/// A group of arguments of a command.
pub trait ArgumentGroup {
    /// Accepts parameters in the ranges that their algorithms state.
    fn check(&self) -> Result<(), BadParameter> {
        Ok(())
    }

    /// Says whether a path is asked for.
    fn has_start(&self) -> bool {
        false
    }

    /// Lists the files beside those of every command: the table of what was expanded or joined, and the film.
    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &None), (Format::Gif, &None)]
    }
}

/// Makes the enumeration of all computations from lines `Name(parameters) = function;` below the text of their help. The
/// function takes the map and the parameters.
macro_rules! computations {
    ($($(#[$doc:meta])* $name:ident($parameters:ty) = $compute:path;)*) => {
        /// A computation on a map, with its parameters.
        #[derive(Debug, Subcommand, Serialize)]
        #[serde(tag = "command", content = "parameters", rename_all = "kebab-case")]
        pub enum Computation {
            $($(#[$doc])* $name(MapQuery<$parameters>),)*
        }

        impl Computation {
            pub fn files(&self) -> &FileArguments {
                match self {
                    $(Self::$name(question) => &question.files,)*
                }
            }

            pub fn parameters(&self) -> &dyn ArgumentGroup {
                match self {
                    $(Self::$name(question) => &question.parameters,)*
                }
            }

            /// Does what the command asks, on a map.
            pub fn compute(&self, occupied: &Grid<bool>) -> Result<Computed, MapInputError> {
                match self {
                    $(Self::$name(question) => $compute(occupied, &question.parameters),)*
                }
            }
        }
    };
}

computations! {
    /// Compute the occupied cells: 1 occupied, 0 free.
    #[command(after_help = "\
Example:
  wildfire map occupancy assets/maps/drawing.png --tolerance 128 --csv cells.csv")]
    Occupancy(fields::NoParameters) = fields::occupancy;

    /// Compute the distance from every cell to the nearest obstacle.
    #[command(aliases = ["grassfire"], after_help = "\
A map without obstacles is 0 everywhere, and a note reports it; a full map is 1 \
everywhere.

Examples:
  wildfire map brushfire assets/maps/maze.txt --neighbours 4 --png fire.png
  wildfire map brushfire assets/maps/basic-14x20.txt --gif fire.gif")]
    Brushfire(fields::BrushfireArguments) = fields::brushfire;

    /// Compute costs that fall with the distance from obstacles, in two zones.
    #[command(aliases = ["costmap"], after_help = "\
d is the city-block distance to the nearest obstacle (4 neighbours). \
Obstacles cost --max-cost. In the safety zone, 0 < d < --safety-distance, \
cost falls linearly from --safety-max at d = 0 to --safety-min at its edge. \
Beyond, it is --safety-min - --cost-rate x d, at least 0, in the literal form, and \
--safety-min - --cost-rate x (d - --safety-distance), at least 0, in the \
continuous one. Without obstacles all cost is 0.

Example:
  wildfire map cost assets/maps/drawing.png --form continuous --overlay cost.png")]
    Cost(fields::CostArguments) = fields::cost;

    /// Count the steps from every cell to the goal; with --start, find a path.
    #[command(aliases = ["nf1"], after_help = "\
Obstacles have the value 1, the goal 2, a cell n steps from the goal 2 + n, and \
free cells that the wave never reaches 0. --scale divides all values, including \
those of obstacles, by the largest and multiplies them by S. With 4 neighbours no \
step cuts a corner, so --no-corner-cutting changes nothing.

Examples:
  wildfire map wavefront assets/maps/u-trap.txt --goal 10,27 --png wave.png
  wildfire map wavefront assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --gif wave.gif")]
    Wavefront(fields::WavefrontArguments) = fields::wave;

    /// Compute a potential that grows with the distance from the goal.
    #[command(aliases = ["attractive"], after_help = "\
The goal may lie in an obstacle: attraction ignores obstacles.

Example:
  wildfire map attraction assets/maps/u-trap.txt --goal 10,27 --surface pull.png")]
    Attraction(fields::AttractionArguments) = fields::attraction;

    /// Compute a potential that grows towards obstacles.
    #[command(aliases = ["repulsive"], after_help = "\
With D the brushfire value, 1 on obstacles: 0 where D > Q, else \
eta / 2 x (1 / D - 1 / Q)^2. Without obstacles it is 0 everywhere.

Example:
  wildfire map repulsion assets/maps/two-rooms.txt --q 4 --surface push.png")]
    Repulsion(fields::RepulsionArguments) = fields::repulsion;

    /// Compute the sum of attraction and repulsion.
    #[command(aliases = ["potential"], after_help = "\
Example:
  wildfire map total assets/maps/u-trap.txt --goal 10,27 --surface total.png")]
    Total(fields::FieldArguments) = fields::total;

    /// Descend the total potential to the goal or into a local minimum.
    #[command(aliases = ["gradient-descent"], after_help = "\
Each step leads to the lowest neighbour if it is strictly lower; ties go to the \
first in W N E S NW NE SE SW. Obstacles are not entered. The descent ends at the \
goal or in a local minimum, which is reported. The values are those of `wildfire map total`. \
Several values of --q or --eta give a table of all pairs; then --png draws a sheet \
of small maps and --csv writes the table.

Examples:
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --q 5,10,15 --eta 10,15,20 --png sweep.png
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --escape wavefront")]
    Descend(fields::DescendArguments) = fields::descent;

    /// Compute the Euclidean distance from every cell to the nearest obstacle.
    #[command(aliases = ["edt", "distance-transform"], after_help = "\
Exact distances between centres of cells: obstacles 0, a cell beside one 1, a cell \
at its corner the square root of 2. A map without obstacles is 0 everywhere, and a \
note reports it.

Example:
  wildfire map euclidean assets/maps/drawing.png --png distances.png")]
    Euclidean(fields::NoParameters) = fields::euclidean;

    /// Compute the Voronoi diagram of the obstacles; with --start and --goal, a path along it.
    #[command(aliases = ["gvd"], after_help = "\
Where the nearest sites of two adjacent cells differ, the cell closer to the \
other's nearest obstacle cell belongs to the diagram, or both do. Sites are \
connected obstacles and the four walls around the map; in a maze all obstacles are \
one site, and `--sites cells` still gives a diagram. Values: the distance to the \
nearest site on the diagram, 0 off it. The path has the least length off the \
diagram; among equals it is the shortest.

Examples:
  wildfire map voronoi assets/maps/drawing.png --png voronoi.png
  wildfire map voronoi assets/maps/maze.txt --sites cells \\
    --goal 19,29 --start 1,1")]
    Voronoi(searches::VoronoiArguments) = searches::diagram;

    /// Find a shortest path by A*, ordered by cost so far plus estimated cost to go.
    #[command(aliases = ["a*"], after_help = "\
Values are the costs from the start of all cells reached, inf elsewhere. A step \
costs 1, a diagonal step the square root of 2. Ties go to the larger cost so far, \
then to the first in reading order. With --weight above 1, or `--heuristic \
manhattan` and 8 neighbours, the path may be longer than the shortest: the output \
then has the bound and the difference.

Examples:
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --weight 2 --format json
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png a.png
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --expansions order.csv --gif search.gif")]
    Astar(searches::Search<searches::AstarParameters>) = searches::best_first;

    /// Find a shortest path by Dijkstra's search, ordered by cost so far.
    #[command(aliases = ["uniform-cost"], after_help = "\
Like `wildfire map astar --heuristic zero`.

Example:
  wildfire map dijkstra assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png d.png")]
    Dijkstra(searches::Search<searches::SearchParameters>) = searches::best_first;

    /// Find a path by greedy best-first search, ordered by estimated cost to go.
    #[command(aliases = ["gbfs"], after_help = "\
Like `wildfire map astar`, but the cost so far does not count: the path may be \
longer than the shortest, without a bound. A cell keeps the path by which it was \
first reached.

Example:
  wildfire map greedy assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png g.png")]
    Greedy(searches::Search<searches::GreedyParameters>) = searches::best_first;

    /// Find a path that turns at any angle, by Theta*.
    #[command(aliases = ["theta*"], after_help = "\
The path consists of straight segments between centres of cells that enter no \
obstacle. With --no-corner-cutting they touch none either, not even at a corner. \
The path never costs more than the shortest path in steps.

Example:
  wildfire map theta assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --path turns.csv")]
    Theta(searches::Search<searches::EightSearchParameters>) = searches::any_angle;

    /// Find a shortest path by jump point search.
    #[command(aliases = ["jump-point-search"], after_help = "\
A* that expands only cells where a shortest path may have to turn; only these have \
a cost. The path costs the same as that of A*, with and without \
--no-corner-cutting. Touched cells are those that the jumps passed through.

Example:
  wildfire map jps assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png jumps.png")]
    Jps(searches::Search<searches::EightSearchParameters>) = searches::jumps;

    /// Find a path by a rapidly-exploring random tree (RRT).
    #[command(after_help = "\
Samples are uniformly random over the map, not only centres of cells; edges touch \
no obstacle. The tree stops when it reaches the goal. Values: the least cost of a \
point of the tree in the cell, inf without one. A seed gives the same tree on every \
machine.

Example:
  wildfire map rrt assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png tree.png")]
    Rrt(graphs::Search<graphs::Growth>) = graphs::rrt;

    /// Find a path by RRT*, which more samples make shorter.
    #[command(aliases = ["rrt*"], after_help = "\
Like `wildfire map rrt`, but uses all samples: a new point connects to the \
neighbour that gives it the shortest path, and neighbours reconnect through it \
where that shortens theirs.

Example:
  wildfire map rrt-star assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --samples 2000 --png tree.png")]
    RrtStar(graphs::Search<graphs::RrtStarParameters>) = graphs::rrt_star;

    /// Find a path through a probabilistic roadmap (PRM).
    #[command(aliases = ["roadmap"], after_help = "\
Samples as in `wildfire map rrt`; each is connected to its nearest neighbours where \
the segment is free. The path is the shortest through the roadmap.

Example:
  wildfire map prm assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png roadmap.png")]
    Prm(graphs::Search<graphs::PrmParameters>) = graphs::roadmap;
}
