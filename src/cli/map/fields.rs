//! Maps of values: their parameters, and computing them.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::cli::map::commands::ArgumentGroup;
use crate::cli::map::computed::{
    Computed, MapInputError, MapPath, MapValues, MapWalk, NoData, check_free, check_inside, timed,
    title_with_neighbours,
};
use crate::cli::map::options::{
    CornerArguments, GoalArguments, NeighbourArguments, Numbers, choices, parse_number, parse_numbers, parse_place,
};
use crate::cli::numbers;
use crate::cli::output_files::Format;
use wildfire_grid::brushfire;
use wildfire_grid::cost_map::{self, cost_map};
use wildfire_grid::descent::{descend, descend_or_escape};
use wildfire_grid::distance::euclidean_distances;
use wildfire_grid::octile::shortest_path;
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::wavefront::{UNREACHED, descend_wavefront, wavefront};
use wildfire_grid::{Connectivity, Grid, Place, TieOrder, potential};

#[derive(Debug, Args, Serialize)]
pub struct NoParameters {}

/// The film of a front that spreads.
#[derive(Debug, Default, Args)]
pub struct FilmArguments {
    /// Draw the spreading front as an animation.
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
}

impl FilmArguments {
    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &None), (Format::Gif, &self.gif)]
    }
}

#[derive(Debug, Args, Serialize)]
pub struct BrushfireArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub film: FilmArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    /// The value of obstacles: 1 (free cells 1 + distance), or 0 (free cells the distance).
    #[arg(long, value_enum, value_name = "NAME", default_value = "obstacle-one")]
    pub convention: Convention,
}

#[derive(Debug, Args, Serialize)]
pub struct CostArguments {
    /// Formula of the outer zone: literal, with a jump at its inner edge, or continuous.
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
    /// Decrease of the cost per cell beyond the safety zone.
    #[arg(long, value_name = "COST", default_value_t = 15.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub cost_rate: f64,
}

#[derive(Debug, Args, Serialize)]
pub struct WavefrontArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub film: FilmArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
    /// Start of the path.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Option<Place>,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    /// Order of equally good neighbours: S N E W SE SW NE NW, or W N E S NW NE SE SW.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value = "cross-first",
        requires = "start",
        conflicts_with = "shortest"
    )]
    pub tie_order: Order,
    /// Find the path of least length (diagonal steps: square root of 2), not of fewest steps.
    #[arg(long, requires = "start")]
    pub shortest: bool,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
    /// Largest value after scaling, or `none`.
    #[arg(long, value_name = "S|none", default_value = "none", allow_hyphen_values = true, value_parser = parse_scale)]
    pub scale: Scale,
}

#[derive(Debug, Args, Serialize)]
pub struct AttractionArguments {
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub attraction: AttractionOptions,
}

#[derive(Debug, Args, Serialize)]
pub struct RepulsionArguments {
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub repulsion: RepulsionOptions,
}

#[derive(Debug, Args, Serialize)]
pub struct FieldArguments {
    #[command(flatten)]
    #[serde(flatten)]
    pub attraction: AttractionArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub repulsion: RepulsionArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct DescendArguments {
    /// Start of the descent.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Place,
    #[command(flatten)]
    #[serde(flatten)]
    pub field: FieldArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
    /// Leave a local minimum along the wavefront's path to the goal.
    #[arg(long, value_enum, value_name = "NAME")]
    pub escape: Option<Escape>,
}

#[derive(Debug, Args, Serialize)]
pub struct AttractionOptions {
    /// d2: zeta / 2 x the squared Euclidean distance from the goal; manhattan: city-block distance.
    #[arg(long, value_enum, value_name = "NAME", default_value = "d2")]
    pub distance: Distance,
    /// Strength of the attraction `d2`; only has an effect with `--scale none`.
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub zeta: f64,
    /// Largest attraction after scaling, or `none`.
    #[arg(long, value_name = "S|none", default_value = "10", allow_hyphen_values = true, value_parser = parse_scale)]
    pub scale: Scale,
}

#[derive(Debug, Args, Serialize)]
pub struct RepulsionOptions {
    /// The brushfire value beyond which there is no repulsion; `descend` tries several values.
    #[arg(long, value_name = "Q[,Q...]", default_value = "5", allow_hyphen_values = true, value_parser = parse_numbers)]
    pub q: Numbers,
    /// Strength of the repulsion; `descend` tries several values.
    #[arg(
        long,
        value_name = "ETA[,ETA...]",
        default_value = "15",
        allow_hyphen_values = true,
        value_parser = parse_numbers
    )]
    pub eta: Numbers,
    /// Use the distance, as textbooks do: brushfire value - 1, obstacles infinitely high.
    #[arg(long)]
    pub true_distance: bool,
}

choices! {
    Convention { ObstacleOne, ObstacleZero }
    Distance { D2, Manhattan }
    Escape { Wavefront }
    Form for cost_map::Form { Literal, Continuous }
    Order for TieOrder { CrossFirst, WestFirst }
}

/// The greatest attraction; `None` leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Scale(pub Option<f64>);

impl ArgumentGroup for NoParameters {}

impl ArgumentGroup for BrushfireArguments {
    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        self.film.more_files()
    }
}

impl ArgumentGroup for CostArguments {
    /// Accepts what the zones accept. Of costs that do not go together, one may be left to its default: options are named.
    fn check(&self) -> Result<(), BadParameter> {
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
}

impl CostArguments {
    pub fn zones(&self) -> cost_map::TwoZones {
        cost_map::TwoZones {
            form: self.form.into(),
            max_cost: self.max_cost,
            safety_max: self.safety_max,
            safety_min: self.safety_min,
            safety_distance: self.safety_distance,
            cost_rate: self.cost_rate,
        }
    }
}

impl ArgumentGroup for WavefrontArguments {
    fn check(&self) -> Result<(), BadParameter> {
        self.scale.0.map_or(Ok(()), |scale| BadParameter::unless_positive("the scale", scale))
    }

    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        self.film.more_files()
    }

    fn has_start(&self) -> bool {
        self.start.is_some()
    }
}

impl ArgumentGroup for AttractionArguments {
    fn check(&self) -> Result<(), BadParameter> {
        self.attraction.check()
    }
}

impl ArgumentGroup for RepulsionArguments {
    fn check(&self) -> Result<(), BadParameter> {
        self.repulsion.check_single()
    }
}

impl ArgumentGroup for FieldArguments {
    fn check(&self) -> Result<(), BadParameter> {
        self.attraction.check()?;
        self.repulsion.check()
    }
}

impl ArgumentGroup for DescendArguments {
    fn check(&self) -> Result<(), BadParameter> {
        self.field.attraction.check()?;
        let laws = self.laws();
        let fits = laws.len() <= MAX_DESCENTS;
        BadParameter::unless(fits, "the number of pairs of --q and --eta", "at most 64", laws.len() as f64)?;
        laws.iter().try_for_each(potential::Repulsion::check)
    }

    fn has_start(&self) -> bool {
        true
    }
}

impl AttractionOptions {
    pub fn check(&self) -> Result<(), BadParameter> {
        self.kind().check(self.scale.0)
    }

    pub fn kind(&self) -> potential::Attraction {
        match self.distance {
            Distance::D2 => potential::Attraction::Squared { zeta: self.zeta },
            Distance::Manhattan => potential::Attraction::Manhattan,
        }
    }
}

impl RepulsionOptions {
    /// Returns the first law, which is the only one of all commands but `descend`.
    pub fn law(&self) -> potential::Repulsion {
        self.laws()[0]
    }

    /// Lists all pairs of values, row by row: every eta for the first Q, then for the next.
    fn laws(&self) -> Vec<potential::Repulsion> {
        let distance = if self.true_distance {
            potential::RepulsionDistance::True
        } else {
            potential::RepulsionDistance::Brushfire
        };
        let mut laws = Vec::new();
        for &q in &self.q.0 {
            laws.extend(self.eta.0.iter().map(|&eta| potential::Repulsion { q, eta, distance }));
        }
        laws
    }

    /// Accepts a single law in its ranges.
    fn check_single(&self) -> Result<(), BadParameter> {
        let values = self.q.0.len().max(self.eta.0.len());
        let is_single = values == 1;
        BadParameter::unless(
            is_single,
            "the number of values of --q or --eta",
            "1, except of `descend`",
            values as f64,
        )?;
        self.law().check()
    }
}

impl DescendArguments {
    /// Lists the laws of repulsion to try, row by row: every eta for the first Q, then for the next.
    pub fn laws(&self) -> Vec<potential::Repulsion> {
        self.field.repulsion.repulsion.laws()
    }
}

/// The most descents that one command tries.
const MAX_DESCENTS: usize = 64;

fn parse_distance(text: &str) -> Result<u16, String> {
    numbers::parse(text).ok_or_else(|| format!("expected a distance in cells, a whole number from 1 to {}", u16::MAX))
}

fn parse_scale(text: &str) -> Result<Scale, String> {
    match text {
        "none" => Ok(Scale(None)),
        _ => {
            let scale = numbers::parse(text).map(|scale| Scale(Some(scale)));
            scale.ok_or_else(|| "expected a number or `none`".to_owned())
        }
    }
}

pub fn occupancy(occupied: &Grid<bool>, _: &NoParameters) -> Result<Computed, MapInputError> {
    Ok(Computed::new("Occupancy", "occupied", timed(|| MapValues::Flags(occupied.clone()))))
}

pub fn brushfire(occupied: &Grid<bool>, arguments: &BrushfireArguments) -> Result<Computed, MapInputError> {
    let neighbours = arguments.neighbours.connectivity;
    let (value_name, less) = match arguments.convention {
        Convention::ObstacleOne => ("distance + 1", 0),
        Convention::ObstacleZero => ("distance", 1),
    };
    let values = timed(|| {
        let mut values = brushfire_or_zero(occupied, neighbours.into());
        // Without obstacles all is 0 and stays so.
        values.values_mut().iter_mut().for_each(|value| *value = value.saturating_sub(less));
        MapValues::Distances(values)
    });
    Ok(Computed::new(title_with_neighbours("Brushfire", neighbours), value_name, values))
}

/// The brushfire map, 0 everywhere without obstacles.
fn brushfire_or_zero(occupied: &Grid<bool>, connectivity: Connectivity) -> Grid<u16> {
    brushfire::brushfire(occupied, connectivity).unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0))
}

pub fn euclidean(occupied: &Grid<bool>, _: &NoParameters) -> Result<Computed, MapInputError> {
    let values = timed(|| {
        let distances = euclidean_distances(occupied);
        MapValues::Reals(distances.unwrap_or_else(|| Grid::filled(occupied.rows(), occupied.cols(), 0.0)))
    });
    Ok(Computed::new("Euclidean distance", "distance in cells", values))
}

pub fn cost(occupied: &Grid<bool>, arguments: &CostArguments) -> Result<Computed, MapInputError> {
    let values = timed(|| {
        // The two zones are defined by city-block distance, so there is no option for 8 neighbours.
        let brushfire = brushfire_or_zero(occupied, Connectivity::Four);
        MapValues::Reals(cost_map(&brushfire, &arguments.zones()))
    });
    Ok(Computed::new("Cost map", "cost", values))
}

pub fn wave(occupied: &Grid<bool>, arguments: &WavefrontArguments) -> Result<Computed, MapInputError> {
    let goal = arguments.goal.goal;
    let neighbours = arguments.neighbours.connectivity;
    let connectivity = neighbours.into();
    let corners = arguments.corners.rule();
    // The goal is checked before the map is computed, as a front cannot start in a wall.
    check_free("goal", occupied, goal)?;
    if let Some(start) = arguments.start {
        check_inside("start", occupied, start)?;
    }
    let (steps, cpu_map) = timed(|| wavefront(occupied, goal, connectivity, corners).expect("the goal is free"));
    let walk = arguments.start.map(|start| {
        timed(|| {
            let route = if arguments.shortest {
                shortest_path(occupied, start, goal, connectivity, corners).expect("both ends are on the map")
            } else {
                descend_wavefront(&steps, start, connectivity, corners, arguments.tie_order.into())
            };
            MapWalk { start, goal, path: route.into() }
        })
    });
    let (walk, cpu_path) = walk.unzip();
    // They are counted in steps and not in scaled values, where a cell that was not reached has a number too.
    let unreached = Some(steps.values().iter().filter(|&&value| value == UNREACHED).count());
    let (value_name, values) = match arguments.scale.0 {
        Some(scale) => ("scaled value", MapValues::Reals(scaled(&steps, scale))),
        None => ("steps + 2", MapValues::Steps(steps)),
    };
    let bare = NoData::Zero("unreached");
    let title = title_with_neighbours("Wavefront", neighbours);
    let computed = Computed::new(title, value_name, (values, cpu_map));
    Ok(Computed { bare, unreached, goal: Some(goal), walk, cpu_path, ..computed })
}

/// All values divided by the largest, times `scale`.
fn scaled(values: &Grid<u32>, scale: f64) -> Grid<f64> {
    let max = f64::from(values.values().iter().copied().max().unwrap_or(1));
    let reals = values.values().iter().map(|&value| f64::from(value) / max * scale).collect();
    Grid::from_values(values.rows(), values.cols(), reals)
}

pub fn attraction(occupied: &Grid<bool>, arguments: &AttractionArguments) -> Result<Computed, MapInputError> {
    let goal = arguments.goal.goal;
    // A goal in an obstacle will do, since attraction knows nothing of obstacles.
    check_inside("goal", occupied, goal)?;
    let values = timed(|| MapValues::Reals(attraction_field(occupied, goal, &arguments.attraction)));
    Ok(Computed { goal: Some(goal), ..Computed::new("Attraction", "potential", values) })
}

fn attraction_field(occupied: &Grid<bool>, goal: Place, options: &AttractionOptions) -> Grid<f64> {
    potential::attraction(occupied.rows(), occupied.cols(), goal, options.kind(), options.scale.0)
}

pub fn repulsion(occupied: &Grid<bool>, arguments: &RepulsionArguments) -> Result<Computed, MapInputError> {
    let neighbours = arguments.neighbours.connectivity;
    let title = title_with_neighbours("Repulsion", neighbours);
    let values = timed(|| {
        let brushfire = brushfire_or_zero(occupied, neighbours.into());
        MapValues::Reals(potential::repulsion(&brushfire, &arguments.repulsion.law()))
    });
    Ok(Computed::new(title, "potential", values))
}

pub fn total(occupied: &Grid<bool>, arguments: &FieldArguments) -> Result<Computed, MapInputError> {
    let goal = arguments.attraction.goal.goal;
    check_inside("goal", occupied, goal)?;
    let title = title_with_neighbours("Total potential", arguments.repulsion.neighbours.connectivity);
    let law = arguments.repulsion.repulsion.law();
    let values = timed(|| MapValues::Reals(total_field(occupied, arguments, &law)));
    Ok(Computed { goal: Some(goal), ..Computed::new(title, "potential", values) })
}

fn total_field(occupied: &Grid<bool>, arguments: &FieldArguments, law: &potential::Repulsion) -> Grid<f64> {
    let FieldArguments { attraction, repulsion } = arguments;
    let brushfire = brushfire_or_zero(occupied, repulsion.neighbours.connectivity.into());
    let attraction = attraction_field(occupied, attraction.goal.goal, &attraction.attraction);
    potential::total(attraction, &brushfire, law)
}

pub fn descent(occupied: &Grid<bool>, arguments: &DescendArguments) -> Result<Computed, MapInputError> {
    descent_with(occupied, arguments, &arguments.field.repulsion.repulsion.law())
}

/// Descends the field of one of the laws of repulsion.
pub fn descent_with(
    occupied: &Grid<bool>,
    arguments: &DescendArguments,
    law: &potential::Repulsion,
) -> Result<Computed, MapInputError> {
    let start = arguments.start;
    let goal = arguments.field.attraction.goal.goal;
    let neighbours = arguments.field.repulsion.neighbours.connectivity;
    let connectivity = neighbours.into();
    let corners = arguments.corners.rule();
    check_free("goal", occupied, goal)?;
    check_inside("start", occupied, start)?;
    let (field, cpu_map) = timed(|| total_field(occupied, &arguments.field, law));
    let (walk, cpu_path) = timed(|| {
        let path = match arguments.escape {
            None => descend(&field, occupied, start, goal, connectivity, corners).map(MapPath::from),
            Some(Escape::Wavefront) => {
                descend_or_escape(&field, occupied, start, goal, connectivity, corners).map(MapPath::from)
            }
        };
        MapWalk { start, goal, path: path.expect("both ends are on the map") }
    });
    let title = title_with_neighbours("Gradient descent", neighbours);
    let computed = Computed::new(title, "potential", (MapValues::Reals(field), cpu_map));
    Ok(Computed { goal: Some(goal), walk: Some(walk), cpu_path: Some(cpu_path), ..computed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_is_no_value_is_refused_with_what_was_expected() {
        assert_eq!(parse_scale("none"), Ok(Scale(None)));
        assert_eq!(parse_scale("2.5"), Ok(Scale(Some(2.5))));
        assert!(parse_scale("all").is_err_and(|expected| expected.contains("`none`")));
        assert!(parse_distance("12").is_ok() && parse_distance("1.5").is_err() && parse_distance("65536").is_err());
    }
}
