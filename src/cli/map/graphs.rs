//! Trees and roadmaps of points: their parameters, and what they answer.

use std::path::PathBuf;
use std::sync::OnceLock;

use clap::Args;
use serde::{Serialize, Serializer};

use crate::cli::map::commands::ArgumentGroup;
use crate::cli::map::computed::{
    Computed, MapInputError, MapPath, MapValues, MapWalk, NoData, WalkResult, check_problem, timed,
};
use crate::cli::map::options::{EndArguments, GoalArguments, PathArguments, parse_number};
use crate::cli::map::traces::GraphTrace;
use crate::cli::numbers;
use crate::cli::output_files::Format;
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::sampling::{
    PointGraph, PointRoute, PrmSettings, RrtSettings, TreeKind, grow_tree, probabilistic_roadmap,
};
use wildfire_grid::segment::GridPoint;
use wildfire_grid::{Grid, Place};
use wildfire_picture::GrownPath;

/// Files that only trees and roadmaps are written to.
#[derive(Debug, Default, Args)]
pub struct GraphFiles {
    /// Write the edges in the order in which they were added: order,from_row,from_col,to_row,to_col.
    #[arg(long, value_name = "FILE.csv")]
    pub edges: Option<PathBuf>,
    /// Draw the growing tree or roadmap as an animation.
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
}

/// How a tree grows.
#[derive(Debug, Args, Serialize)]
pub struct Growth {
    /// Seed of the random samples.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Maximum number of samples, from 1 to 100000.
    #[arg(long, default_value_t = 5000, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: u32,
    /// Maximum edge length in cells; `auto`: 1/20 of the map's longer side, at least 5.
    #[arg(long, value_name = "CELLS|auto", default_value = "auto", allow_hyphen_values = true, value_parser = parse_step)]
    pub step: TreeStep,
    /// Probability of sampling the goal instead of a random point.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, allow_hyphen_values = true, value_parser = parse_number)]
    pub goal_bias: f64,
}

/// Which points are neighbours.
#[derive(Debug, Args, Serialize)]
pub struct Near {
    /// Number of nearest points that are neighbours, from 1 to 1000 [default: 2e ln n of n points].
    #[arg(long = "nearest", alias = "neighbours", value_name = "K", allow_hyphen_values = true, value_parser = parse_count)]
    pub neighbours: Option<u32>,
    /// Maximum distance of neighbours in cells [default: no limit].
    #[arg(long, value_name = "CELLS", allow_hyphen_values = true, value_parser = parse_number)]
    pub radius: Option<f64>,
}

#[derive(Debug, Args, Serialize)]
pub struct RrtStarParameters {
    #[command(flatten)]
    #[serde(flatten)]
    pub growth: Growth,
    #[command(flatten)]
    #[serde(flatten)]
    pub near: Near,
}

#[derive(Debug, Args, Serialize)]
pub struct PrmParameters {
    /// Seed of the random samples.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Number of samples, from 1 to 100000; those in obstacles are discarded.
    #[arg(long, default_value_t = 500, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: u32,
    #[command(flatten)]
    #[serde(flatten)]
    pub near: Near,
}

/// The longest edge of a tree: as it was given, or as a map suggests, from when it is known.
#[derive(Clone, Debug, Default)]
pub struct TreeStep {
    requested: Option<f64>,
    of_map: OnceLock<f64>,
}

impl TreeStep {
    /// On maps of up to 100 cells.
    const MIN: f64 = 5.0;
    /// Edges that span the longer side.
    const EDGES_ACROSS: f64 = 20.0;

    pub fn requested(&self) -> Option<f64> {
        self.requested
    }

    /// Returns the step on a map of which the longer side has so many cells.
    fn on_side(&self, longer: usize) -> f64 {
        let of_map = || (longer as f64 / Self::EDGES_ACROSS).max(Self::MIN);
        self.requested.unwrap_or_else(|| *self.of_map.get_or_init(of_map))
    }
}

impl Serialize for TreeStep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.requested.or_else(|| self.of_map.get().copied()).serialize(serializer)
    }
}

impl Growth {
    fn check_with(&self, near: Option<&Near>) -> Result<(), BadParameter> {
        // The map is not read yet, and the step that `auto` derives from it is never out of range.
        self.settings_of_step(self.step.requested.unwrap_or(TreeStep::MIN), near).check()
    }

    /// The settings of a tree on a map; RRT has no neighbours.
    fn settings(&self, occupied: &Grid<bool>, near: Option<&Near>) -> RrtSettings {
        self.settings_of_step(self.step.on_side(occupied.rows().max(occupied.cols())), near)
    }

    fn settings_of_step(&self, step: f64, near: Option<&Near>) -> RrtSettings {
        RrtSettings {
            seed: self.seed,
            samples: self.samples,
            step,
            goal_bias: self.goal_bias,
            neighbours: near.and_then(|near| near.neighbours),
            radius: near.and_then(|near| near.radius),
        }
    }
}

impl PrmParameters {
    fn settings(&self) -> PrmSettings {
        let Near { neighbours, radius } = self.near;
        PrmSettings { seed: self.seed, samples: self.samples, neighbours, radius }
    }
}

impl ArgumentGroup for GraphFiles {
    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &self.edges), (Format::Gif, &self.gif)]
    }
}

impl ArgumentGroup for Growth {
    fn check(&self) -> Result<(), BadParameter> {
        self.check_with(None)
    }
}

impl ArgumentGroup for RrtStarParameters {
    fn check(&self) -> Result<(), BadParameter> {
        self.growth.check_with(Some(&self.near))
    }
}

impl ArgumentGroup for PrmParameters {
    fn check(&self) -> Result<(), BadParameter> {
        self.settings().check()
    }
}

pub fn parse_count(text: &str) -> Result<u32, String> {
    numbers::parse(text).ok_or_else(|| "expected a whole number".to_owned())
}

pub fn parse_step(text: &str) -> Result<TreeStep, String> {
    let requested = match text {
        "auto" => None,
        _ => Some(numbers::parse(text).ok_or_else(|| "expected a number of cells, or `auto`".to_owned())?),
    };
    Ok(TreeStep { requested, ..TreeStep::default() })
}

/// Arguments of a search.
pub type Search<P> = PathArguments<GraphFiles, P>;

pub fn rrt(occupied: &Grid<bool>, Search { ends, parameters, .. }: &Search<Growth>) -> Result<Computed, MapInputError> {
    let settings = parameters.settings(occupied, None);
    let found =
        answer(occupied, "rrt", ends, |start, goal| grow_tree(occupied, start, goal, TreeKind::Rrt, &settings))?;
    Ok(Computed { title: "RRT".to_owned(), ..found })
}

pub fn rrt_star(
    occupied: &Grid<bool>,
    Search { ends, parameters: RrtStarParameters { growth, near }, .. }: &Search<RrtStarParameters>,
) -> Result<Computed, MapInputError> {
    let settings = growth.settings(occupied, Some(near));
    let found = answer(occupied, "rrt-star", ends, |start, goal| {
        grow_tree(occupied, start, goal, TreeKind::RrtStar, &settings)
    })?;
    Ok(Computed { title: "RRT*".to_owned(), ..found })
}

pub fn roadmap(
    occupied: &Grid<bool>,
    Search { ends, parameters, .. }: &Search<PrmParameters>,
) -> Result<Computed, MapInputError> {
    let settings = parameters.settings();
    let found = answer(occupied, "prm", ends, |start, goal| probabilistic_roadmap(occupied, start, goal, &settings))?;
    Ok(Computed { title: "PRM".to_owned(), ..found })
}

/// Returns what was found, still without a title.
fn answer<E: std::fmt::Debug>(
    occupied: &Grid<bool>,
    command: &'static str,
    &EndArguments { start, goal: GoalArguments { goal, .. } }: &EndArguments,
    search: impl FnOnce(Place, Place) -> Result<PointGraph, E>,
) -> Result<Computed, MapInputError> {
    check_problem(command, occupied, start, goal)?;
    let (graph, cpu_map) = timed(|| search(start, goal).expect("both ends are on the map"));
    // Several points may lie in one cell, which then shows the cheapest of them.
    let mut min = Grid::filled(occupied.rows(), occupied.cols(), f64::INFINITY);
    for (point, &cost) in graph.points.iter().zip(&graph.costs) {
        let cell = point.cell();
        min[cell] = min[cell].min(cost);
    }
    let edges = graph.edges.iter().map(|edge| edge.map(|number| graph.points[number as usize].coordinates())).collect();
    let path = MapPath {
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
    let earlier = graph.earlier.iter().map(|earlier| GrownPath {
        steps: earlier.edges,
        track: earlier.path.iter().map(|point| point.coordinates()).collect(),
    });
    let earlier = earlier.collect();
    let trace = GraphTrace { cost: graph.cost, samples: graph.samples, vertices: graph.points.len(), edges, earlier };
    Ok(Computed {
        bare: NoData::Infinite("no point"),
        goal: Some(goal),
        walk: Some(MapWalk { start, goal, path }),
        graph: Some(trace),
        ..Computed::new("", "cost from start", (MapValues::Reals(min), cpu_map))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_grow_with_the_map_unless_they_are_given() {
        for (text, longer, expected) in
            [("auto", 30, 5.0), ("auto", 100, 5.0), ("auto", 4000, 200.0), ("7.5", 4000, 7.5)]
        {
            let step = parse_step(text).expect("a step");
            assert_eq!(step.on_side(longer), expected, "{text} of {longer}");
            assert_eq!(serde_json::to_value(&step).expect("a number"), serde_json::json!(expected));
        }
        assert!(parse_step("far").is_err_and(|expected| expected.contains("`auto`")));
    }
}
