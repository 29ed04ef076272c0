//! The computations of `wildfire map`: a table of their words, their parameters and the functions that compute them.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::cli::map::computed::{BadQuestion, Computed};
use crate::cli::map::options::FileArguments;
use crate::cli::map::{fields, graphs, searches};
use crate::cli::output_files::Format;
use wildfire_grid::Grid;
use wildfire_grid::parameter::BadParameter;

/// A command's files, and the parameters of its algorithm. Serialised it is the parameters in the JSON.
#[derive(Debug, Args, Serialize)]
#[serde(transparent)]
pub struct Question<P: Args> {
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
    ($($(#[$words:meta])* $name:ident($parameters:ty) = $compute:path;)*) => {
        /// A computation on a map, with its parameters.
        #[derive(Debug, Subcommand, Serialize)]
        #[serde(tag = "command", content = "parameters", rename_all = "kebab-case")]
        pub enum Computation {
            $($(#[$words])* $name(Question<$parameters>),)*
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
            pub fn compute(&self, occupied: &Grid<bool>) -> Result<Computed, BadQuestion> {
                match self {
                    $(Self::$name(question) => $compute(occupied, &question.parameters),)*
                }
            }
        }
    };
}

computations! {
    /// The occupied cells: 1 occupied, 0 free.
    #[command(after_help = "\
Example:
  wildfire map occupancy assets/maps/drawing.png --tolerance 128 --csv cells.csv")]
    Occupancy(fields::NoParameters) = fields::occupancy;

    /// The distance of every cell from the nearest obstacle.
    #[command(after_help = "\
A map without obstacles is 0 everywhere, and a note says so; a full one is 1 \
everywhere.

Example:
  wildfire map brushfire assets/maps/maze.txt --neighbours 4 --png fire.png")]
    Brushfire(fields::BrushfireArguments) = fields::brushfire;

    /// Cost that falls with the distance from obstacles, in two zones.
    #[command(after_help = "\
The distance d is the city-block one from the nearest obstacle (4 neighbours). \
Obstacles cost --max-cost. Inside the safety zone, 0 < d < --safety-distance, \
cost falls in a line from --safety-max at d = 0 to --safety-min at its edge. \
Beyond, it is --safety-min - --cost-rate x d, at least 0, in the literal form, and \
--safety-min - --cost-rate x (d - --safety-distance), at least 0, in the \
continuous one. Without obstacles all cost is 0.

Example:
  wildfire map cost assets/maps/drawing.png --form continuous --overlay cost.png")]
    Cost(fields::CostArguments) = fields::cost;

    /// The number of steps from every cell to the goal; with --start, a path.
    #[command(after_help = "\
Obstacles hold 1, the goal 2, a cell that n steps lead to 2 + n, free cells that \
the wave never reaches 0. With --scale all values, those of obstacles too, are \
divided by the largest and multiplied by S. With 4 neighbours no step cuts a \
corner, so --no-corner-cutting changes nothing.

Example:
  wildfire map wavefront assets/maps/u-trap.txt --goal 10,27 --png wave.png")]
    Wavefront(fields::WavefrontArguments) = fields::wave;

    /// A potential that grows with the distance from the goal.
    #[command(after_help = "\
The goal may lie in an obstacle: attraction does not see obstacles.

Example:
  wildfire map attraction assets/maps/u-trap.txt --goal 10,27 --surface pull.png")]
    Attraction(fields::AttractionArguments) = fields::attraction;

    /// A potential that grows towards obstacles.
    #[command(after_help = "\
With D the brushfire value, 1 on obstacles: 0 where D > Q, else \
eta / 2 x (1 / D - 1 / Q)^2. Without obstacles it is 0 everywhere.

Example:
  wildfire map repulsion assets/maps/two-rooms.txt --q 4 --surface push.png")]
    Repulsion(fields::RepulsionArguments) = fields::repulsion;

    /// The sum of attraction and repulsion.
    #[command(after_help = "\
Example:
  wildfire map total assets/maps/u-trap.txt --goal 10,27 --surface total.png")]
    Total(fields::FieldArguments) = fields::total;

    /// Gradient descent on the total potential: reached, or stuck in a local minimum.
    #[command(after_help = "\
From the start to the lowest neighbour, ties to the first in W N E S NW NE SE SW, \
as long as it is strictly lower; obstacles are not entered. It ends at the goal or \
in a local minimum, which is named. The values are those of `wildfire map total`.

Examples:
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --escape wavefront")]
    Descend(fields::DescendArguments) = fields::descent;

    /// The Euclidean distance of every cell's centre from that of the nearest obstacle.
    #[command(after_help = "\
Exact, between centres: obstacles 0, a cell beside one 1, beside its corner the \
square root of 2. A map without obstacles is 0 everywhere, and a note says so.

Example:
  wildfire map euclidean assets/maps/drawing.png --png distances.png")]
    Euclidean(fields::NoParameters) = fields::euclidean;

    /// The cells equally far from two obstacles; with --start and --goal, a path along them.
    #[command(after_help = "\
Of two cells side by side whose nearest sites differ, the one belongs to the \
diagram that is less far from the other's nearest obstacle cell, or both. Sites are \
connected obstacles and the four walls around the map; where one obstacle is all \
around, as in a maze, `--sites cells` has a diagram all the same. Values: the \
distance from the nearest site on the diagram, 0 off it. The path is the one with \
the least length off the diagram, and of those the shortest.

Examples:
  wildfire map voronoi assets/maps/drawing.png --png voronoi.png
  wildfire map voronoi assets/maps/maze.txt --sites cells \\
    --goal 19,29 --start 1,1")]
    Voronoi(searches::VoronoiArguments) = searches::diagram;

    /// A cheapest path by A*: cost so far plus the least that the rest can cost.
    #[command(after_help = "\
Values are costs from the start where the search knows them, inf elsewhere. A step \
costs 1, a diagonal one the square root of 2. Ties go to the larger cost so far, \
then to the first in reading order.

Examples:
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png a.png
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --expansions order.csv --gif search.gif")]
    Astar(searches::Search<searches::AstarParameters>) = searches::best_first;

    /// A cheapest path by Dijkstra's search, in the order of the cost so far.
    #[command(after_help = "\
As `wildfire map astar`, but without an estimate of the cost to go.

Example:
  wildfire map dijkstra assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png d.png")]
    Dijkstra(searches::Search<searches::SearchParameters>) = searches::best_first;

    /// Some path by greedy best-first search, in the order of the distance to go.
    #[command(after_help = "\
As `wildfire map astar`, but the cost so far does not count, so the path need not be \
a cheapest one. A cell keeps the way by which it was reached first.

Example:
  wildfire map greedy assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png g.png")]
    Greedy(searches::Search<searches::GreedyParameters>) = searches::best_first;

    /// A path that turns at any angle, by Theta*.
    #[command(after_help = "\
The path is a row of cells, joined by straight segments between centres that enter \
no obstacle. With --no-corner-cutting they touch none either, not even at a corner. \
It never costs more than a cheapest path in steps.

Example:
  wildfire map theta assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --path turns.csv")]
    Theta(searches::Search<searches::EightSearchParameters>) = searches::any_angle;

    /// A cheapest path by jump point search.
    #[command(after_help = "\
A* that expands only cells at which a shortest path may have to turn; costs are \
known there alone. It costs what A* costs, with and without --no-corner-cutting. \
Cells touched are those that the jumps went through.

Example:
  wildfire map jps assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png jumps.png")]
    Jps(searches::Search<searches::EightSearchParameters>) = searches::jumps;

    /// A path by a rapidly-exploring random tree of points.
    #[command(after_help = "\
Points are drawn with equal chance over the map, between cells too, from the centre \
of the start to that of the goal; segments touch no obstacle. The tree ends when it \
reaches the goal. Values: the least cost of a point of the tree in the cell, inf \
without one. A seed gives the same tree everywhere.

Example:
  wildfire map rrt assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png tree.png")]
    Rrt(graphs::Search<graphs::Growth>) = graphs::rrt;

    /// A path by RRT*, which gets shorter with more samples.
    #[command(after_help = "\
As `wildfire map rrt`, but all samples are drawn: a point joins the neighbour that \
makes its way shortest, and neighbours join it anew where theirs gets shorter.

Example:
  wildfire map rrt-star assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --samples 2000 --png tree.png")]
    RrtStar(graphs::Search<graphs::RrtStarParameters>) = graphs::rrt_star;

    /// A path through a probabilistic roadmap of points.
    #[command(after_help = "\
Points are drawn as by `wildfire map rrt`, each is joined with its nearest ones where \
the segment is free, and the path is a shortest one through the roadmap.

Example:
  wildfire map prm assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png roadmap.png")]
    Prm(graphs::Search<graphs::PrmParameters>) = graphs::roadmap;
}
