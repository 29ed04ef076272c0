//! The commands of `wildfire map` and their arguments, as clap reads them. Serialised they are the parameters in the JSON.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde::Serialize;

use crate::cli::map::options::{
    AttractionOptions, Convention, CornerArguments, Escape, FieldArguments, FileArguments, Form, GoalArguments,
    NeighbourArguments, Order, ReadingArguments, RepulsionOptions, parse_distance, parse_number, parse_place,
};
use crate::cli::map::search_args::{
    EightSearchArguments, EndArguments, EuclideanArguments, PrmArguments, RrtArguments, RrtStarArguments,
    SearchArguments, TreeStep, VoronoiArguments, parse_count, parse_step,
};
use crate::cli::output_files::Format;
use crate::cli::report::FormArguments;
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::{Place, cost_map};

#[derive(Debug, Subcommand)]
pub enum MapCommand {
    #[command(flatten)]
    Compute(Computation),
    /// CPU time of brushfire and wavefront on maps, as a table.
    Timing(TimingArguments),
    /// All maps and searches of one problem, as a page for a report.
    Report(PageArguments),
}

/// A computation on a map, with its parameters.
#[derive(Debug, Subcommand, Serialize)]
#[serde(tag = "command", content = "parameters", rename_all = "kebab-case")]
pub enum Computation {
    /// The occupied cells: 1 occupied, 0 free.
    Occupancy(OccupancyArguments),
    /// The distance of every cell from the nearest obstacle.
    Brushfire(BrushfireArguments),
    /// Cost that falls with the distance from obstacles, in two zones.
    Cost(CostArguments),
    /// The number of steps from every cell to the goal; with --start, a path.
    Wavefront(WavefrontArguments),
    /// A potential that grows with the distance from the goal.
    Attraction(AttractionArguments),
    /// A potential that grows towards obstacles.
    Repulsion(RepulsionArguments),
    /// The sum of attraction and repulsion.
    Total(TotalArguments),
    /// Gradient descent on the total potential: reached, or stuck in a local minimum.
    Descend(DescendArguments),
    /// The Euclidean distance of every cell's centre from that of the nearest obstacle.
    Euclidean(EuclideanArguments),
    /// The cells equally far from two obstacles; with --start and --goal, a path along them.
    #[command(after_help = VORONOI_HELP)]
    Voronoi(VoronoiArguments),
    /// A cheapest path by A*: cost so far plus the least that the rest can cost.
    #[command(after_help = ASTAR_HELP)]
    Astar(SearchArguments),
    /// A cheapest path by Dijkstra's search, in the order of the cost so far.
    #[command(after_help = DIJKSTRA_HELP)]
    Dijkstra(SearchArguments),
    /// Some path by greedy best-first search, in the order of the distance to go.
    #[command(after_help = GREEDY_HELP)]
    Greedy(SearchArguments),
    /// A path that turns at any angle, by Theta*.
    #[command(after_help = THETA_HELP)]
    Theta(EightSearchArguments),
    /// A cheapest path by jump point search.
    #[command(after_help = JPS_HELP)]
    Jps(EightSearchArguments),
    /// A path by a rapidly-exploring random tree of points.
    #[command(after_help = RRT_HELP)]
    Rrt(RrtArguments),
    /// A path by RRT*, which gets shorter with more samples.
    #[command(after_help = RRT_STAR_HELP)]
    RrtStar(RrtStarArguments),
    /// A path through a probabilistic roadmap of points.
    #[command(after_help = PRM_HELP)]
    Prm(PrmArguments),
}

const VORONOI_HELP: &str = "\
Of two cells side by side whose nearest sites differ, the one belongs to the \
diagram that is less far from the other's nearest obstacle cell, or both. Sites are \
connected obstacles and the four walls around the map; where one obstacle is all \
around, as in a maze, `--sites cells` has a diagram all the same. Values: the \
distance from the nearest site on the diagram, 0 off it. The path is the one with \
the least length off the diagram, and of those the shortest.

Examples:
  wildfire map voronoi assets/maps/drawing.png --png voronoi.png
  wildfire map voronoi assets/maps/maze.txt --sites cells \\
    --goal 19,29 --start 1,1";

const ASTAR_HELP: &str = "\
Values are costs from the start where the search knows them, inf elsewhere. A step \
costs 1, a diagonal one the square root of 2. Ties go to the larger cost so far, \
then to the first in reading order.

Examples:
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png a.png
  wildfire map astar assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --expansions order.csv --gif search.gif";

const DIJKSTRA_HELP: &str = "\
As `wildfire map astar`, but without an estimate of the cost to go.

Example:
  wildfire map dijkstra assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png d.png";

const GREEDY_HELP: &str = "\
As `wildfire map astar`, but the cost so far does not count, so the path need not be \
a cheapest one. A cell keeps the way by which it was reached first.

Example:
  wildfire map greedy assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png g.png";

const THETA_HELP: &str = "\
The path is a row of cells, joined by straight segments between centres that enter \
no obstacle. With --no-corner-cutting they touch none either, not even at a corner. \
It never costs more than a cheapest path in steps.

Example:
  wildfire map theta assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --path turns.csv";

const JPS_HELP: &str = "\
A* that expands only cells at which a shortest path may have to turn; costs are \
known there alone. It costs what A* costs, with and without --no-corner-cutting. \
Cells touched are those that the jumps went through.

Example:
  wildfire map jps assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png jumps.png";

const RRT_HELP: &str = "\
Points are drawn with equal chance over the map, between cells too, from the centre \
of the start to that of the goal; segments touch no obstacle. The tree ends when it \
reaches the goal. Values: the least cost of a point of the tree in the cell, inf \
without one. A seed gives the same tree everywhere.

Example:
  wildfire map rrt assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png tree.png";

const RRT_STAR_HELP: &str = "\
As `wildfire map rrt`, but all samples are drawn: a point joins the neighbour that \
makes its way shortest, and neighbours join it anew where theirs gets shorter.

Example:
  wildfire map rrt-star assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --samples 2000 --png tree.png";

const PRM_HELP: &str = "\
Points are drawn as by `wildfire map rrt`, each is joined with its nearest ones where \
the segment is free, and the path is a shortest one through the roadmap.

Example:
  wildfire map prm assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --png roadmap.png";

impl Computation {
    pub fn files(&self) -> &FileArguments {
        match self {
            Self::Occupancy(arguments) => &arguments.files,
            Self::Brushfire(arguments) => &arguments.files,
            Self::Cost(arguments) => &arguments.files,
            Self::Wavefront(arguments) => &arguments.files,
            Self::Attraction(arguments) => &arguments.files,
            Self::Repulsion(arguments) => &arguments.files,
            Self::Total(arguments) => &arguments.files,
            Self::Descend(arguments) => &arguments.files,
            Self::Euclidean(arguments) => &arguments.files,
            Self::Voronoi(arguments) => &arguments.files,
            Self::Astar(arguments) | Self::Dijkstra(arguments) | Self::Greedy(arguments) => &arguments.files,
            Self::Theta(arguments) | Self::Jps(arguments) => &arguments.files,
            Self::Rrt(arguments) => &arguments.files,
            Self::RrtStar(arguments) => &arguments.files,
            Self::Prm(arguments) => &arguments.files,
        }
    }

    /// Lists the files beside those of every command: the table of what was expanded or joined, and the film.
    pub fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        match self {
            Self::Astar(arguments) | Self::Dijkstra(arguments) | Self::Greedy(arguments) => arguments.trace.files(),
            Self::Theta(arguments) | Self::Jps(arguments) => arguments.trace.files(),
            Self::Rrt(arguments) => arguments.graph.files(),
            Self::RrtStar(arguments) => arguments.graph.files(),
            Self::Prm(arguments) => arguments.graph.files(),
            _ => [(Format::Csv, &None), (Format::Gif, &None)],
        }
    }

    /// Accepts parameters in the ranges that their algorithms state.
    pub fn check_parameters(&self) -> Result<(), BadParameter> {
        match self {
            Self::Occupancy(_) | Self::Brushfire(_) | Self::Euclidean(_) | Self::Voronoi(_) => Ok(()),
            Self::Astar(_) | Self::Dijkstra(_) | Self::Greedy(_) | Self::Theta(_) | Self::Jps(_) => Ok(()),
            Self::Cost(arguments) => arguments.check(),
            Self::Wavefront(arguments) => {
                arguments.scale.map_or(Ok(()), |scale| BadParameter::unless_positive("the scale", scale))
            }
            Self::Attraction(arguments) => arguments.attraction.check(),
            Self::Repulsion(arguments) => arguments.repulsion.law().check(),
            Self::Total(arguments) => arguments.field.check(),
            Self::Descend(arguments) => arguments.field.check(),
            Self::Rrt(arguments) => arguments.growth.check(None),
            Self::RrtStar(arguments) => arguments.growth.check(Some(&arguments.near)),
            Self::Prm(arguments) => arguments.settings().check(),
        }
    }

    /// Says whether a path is asked for.
    pub fn has_start(&self) -> bool {
        match self {
            Self::Wavefront(arguments) => arguments.start.is_some(),
            Self::Voronoi(arguments) => arguments.start.is_some(),
            Self::Occupancy(_) | Self::Brushfire(_) | Self::Cost(_) | Self::Attraction(_) => false,
            Self::Repulsion(_) | Self::Total(_) | Self::Euclidean(_) => false,
            Self::Descend(_) | Self::Astar(_) | Self::Dijkstra(_) | Self::Greedy(_) | Self::Theta(_) => true,
            Self::Jps(_) | Self::Rrt(_) | Self::RrtStar(_) | Self::Prm(_) => true,
        }
    }
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Example:
  wildfire map occupancy assets/maps/drawing.png --tolerance 128 --csv cells.csv")]
pub struct OccupancyArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
A map without obstacles is 0 everywhere, and a note says so; a full one is 1 \
everywhere.

Example:
  wildfire map brushfire assets/maps/maze.txt --neighbours 4 --png fire.png")]
pub struct BrushfireArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    /// The value of obstacles: 1 (free cells 1 + distance), or 0 (free cells the distance).
    #[arg(long, value_enum, value_name = "NAME", default_value = "obstacle-one")]
    pub convention: Convention,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
The distance d is the city-block one from the nearest obstacle (4 neighbours). \
Obstacles cost --max-cost. Inside the safety zone, 0 < d < --safety-distance, \
cost falls in a line from --safety-max at d = 0 to --safety-min at its edge. \
Beyond, it is --safety-min - --cost-rate x d, at least 0, in the literal form, and \
--safety-min - --cost-rate x (d - --safety-distance), at least 0, in the \
continuous one. Without obstacles all cost is 0.

Example:
  wildfire map cost assets/maps/drawing.png --form continuous --overlay cost.png")]
pub struct CostArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    /// The outer zone as the formula of its source has it, with a jump, or as its text promises, without.
    #[arg(long, value_enum, value_name = "NAME", default_value = "literal")]
    pub form: Form,
    /// Cost of obstacles.
    #[arg(long, value_name = "COST", default_value_t = 1000.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub max_cost: f64,
    /// Cost in the safety zone beside an obstacle, at distance 0.
    #[arg(long, value_name = "COST", default_value_t = 800.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub safety_max: f64,
    /// Cost at the outer edge of the safety zone.
    #[arg(long, value_name = "COST", default_value_t = 500.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub safety_min: f64,
    /// Width of the safety zone in cells, at least 1.
    #[arg(long, value_name = "CELLS", default_value_t = 12, allow_hyphen_values = true, value_parser = parse_distance)]
    pub safety_distance: u16,
    /// The cost that each further cell takes off, beyond the safety zone.
    #[arg(long, value_name = "COST", default_value_t = 15.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub cost_rate: f64,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Obstacles hold 1, the goal 2, a cell that n steps lead to 2 + n, free cells that \
the wave never reaches 0. With --scale all values, those of obstacles too, are \
divided by the largest and multiplied by S. With 4 neighbours no step cuts a \
corner, so --no-corner-cutting changes nothing.

Example:
  wildfire map wavefront assets/maps/u-trap.txt --goal 10,27 --png wave.png")]
pub struct WavefrontArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
    /// The cell in which a path begins.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Option<Place>,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    /// The order in which a path tries neighbours that are equally good: S N E W SE SW NE NW, or W N E S NW NE SE SW.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value = "cross-first",
        requires = "start",
        conflicts_with = "shortest"
    )]
    pub tie_order: Order,
    /// The shortest path, a diagonal step counting the square root of 2, instead of one with the fewest steps.
    #[arg(long, requires = "start")]
    pub shortest: bool,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
    /// Divide the values by the largest and multiply them by S.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = parse_number)]
    pub scale: Option<f64>,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
The goal may lie in an obstacle: attraction does not see obstacles.

Example:
  wildfire map attraction assets/maps/u-trap.txt --goal 10,27 --surface pull.png")]
pub struct AttractionArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub attraction: AttractionOptions,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
With D the brushfire value, 1 on obstacles: 0 where D > Q, else \
eta / 2 x (1 / D - 1 / Q)^2. Without obstacles it is 0 everywhere.

Example:
  wildfire map repulsion assets/maps/two-rooms.txt --q 4 --surface push.png")]
pub struct RepulsionArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub repulsion: RepulsionOptions,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Example:
  wildfire map total assets/maps/u-trap.txt --goal 10,27 --surface total.png")]
pub struct TotalArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub field: FieldArguments,
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
From the start to the lowest neighbour, ties to the first in W N E S NW NE SE SW, \
as long as it is strictly lower; obstacles are not entered. It ends at the goal or \
in a local minimum, which is named. The values are those of `wildfire map total`.

Examples:
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2
  wildfire map descend assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --escape wavefront")]
pub struct DescendArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    /// The cell in which the descent begins.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Place,
    #[command(flatten)]
    #[serde(flatten)]
    pub field: FieldArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
    /// The way out of a local minimum: the wavefront's path to the goal.
    #[arg(long, value_enum, value_name = "NAME")]
    pub escape: Option<Escape>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Both with 8 neighbours. The goal of the wavefront is the free cell nearest the \
map's centre. Each figure is the median of at least five repetitions and at least \
0.2 s of CPU time of one thread, into memory that is warm; reading is not in it.

Example:
  wildfire map timing assets/maps/*.png")]
pub struct TimingArguments {
    /// Maps of any kind.
    #[arg(value_name = "MAP", required = true)]
    pub maps: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
The folder is made if need be; it gets report.html, which needs no other file, and \
searches.csv. Theta* and jump point search have 8 neighbours whatever is asked for. \
CPU times are of one run each.

Example:
  wildfire map report assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --out lab")]
pub struct PageArguments {
    /// A map of any kind.
    #[arg(value_name = "MAP")]
    pub map: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArguments,
    #[command(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    pub corners: CornerArguments,
    /// The number that decides what trees and roadmaps draw.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Points that trees draw at most, from 1 to 100000 [default: 5000].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: Option<u32>,
    /// The longest edge of trees in cells; `auto` is a twentieth of the map's longer side, at least 5.
    #[arg(long, value_name = "CELLS|auto", default_value = "auto", allow_hyphen_values = true, value_parser = parse_step)]
    pub step: TreeStep,
    /// The folder to write to.
    #[arg(short, long, value_name = "FOLDER")]
    pub out: PathBuf,
}

impl CostArguments {
    /// Accepts what the zones accept. Of costs that do not go together, one may be left to its default: options are named.
    pub fn check(&self) -> Result<(), BadParameter> {
        let unfit = |name, expected, found| BadParameter { name, expected, found };
        self.zones().check().map_err(|problem| {
            if self.safety_max > self.max_cost {
                let name = "--safety-max, the cost at the inner edge of the safety zone,";
                unfit(name, "at most --max-cost, the largest cost", self.safety_max)
            } else if self.safety_min > self.safety_max {
                let name = "--safety-min, the cost at the outer edge of the safety zone,";
                unfit(name, "at most --safety-max, that at its inner edge", self.safety_min)
            } else {
                problem
            }
        })
    }

    pub fn zones(&self) -> cost_map::TwoZones {
        cost_map::TwoZones {
            form: match self.form {
                Form::Literal => cost_map::Form::Literal,
                Form::Continuous => cost_map::Form::Continuous,
            },
            max_cost: self.max_cost,
            safety_max: self.safety_max,
            safety_min: self.safety_min,
            safety_distance: self.safety_distance,
            cost_rate: self.cost_rate,
        }
    }
}
