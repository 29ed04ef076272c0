//! Arguments of the commands that search for a path, of the diagrams of distances, and of trees and roadmaps.

use std::path::PathBuf;
use std::sync::OnceLock;

use clap::{Args, ValueEnum};
use serde::{Serialize, Serializer};

use crate::cli::map::options::{
    CornerArguments, FileArguments, GoalArguments, NeighbourArguments, parse_number, parse_place,
};
use crate::cli::numbers;
use crate::cli::output_files::Format;
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::sampling::{PrmSettings, RrtSettings};
use wildfire_grid::voronoi::Sites;
use wildfire_grid::{Grid, Place};

/// Where a search begins and ends.
#[derive(Debug, Args, Serialize)]
pub struct EndArguments {
    /// The cell in which the path begins.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Place,
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
}

impl EndArguments {
    pub fn places(&self) -> (Place, Place) {
        (self.start, self.goal.goal)
    }
}

/// Files that only searches write.
#[derive(Debug, Default, Args)]
pub struct TraceArguments {
    /// Write the cells in the order in which they were expanded, as order,row,col,cost.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub expansions: Option<PathBuf>,
    /// Draw the search as it went on, as an animation.
    #[arg(help_heading = "Output", long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
}

impl TraceArguments {
    pub fn files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &self.expansions), (Format::Gif, &self.gif)]
    }
}

/// Files that only trees and roadmaps are written to.
#[derive(Debug, Default, Args)]
pub struct GraphFileArguments {
    /// Write the edges in the order in which they came, as order,from_row,from_col,to_row,to_col.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub edges: Option<PathBuf>,
    /// Draw the tree or the roadmap as it grew, as an animation.
    #[arg(help_heading = "Output", long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
}

impl GraphFileArguments {
    pub fn files(&self) -> [(Format, &Option<PathBuf>); 2] {
        [(Format::Csv, &self.edges), (Format::Gif, &self.gif)]
    }
}

#[derive(Debug, Args, Serialize)]
pub struct SearchArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub trace: TraceArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

/// Arguments of searches that have 8 neighbours always.
#[derive(Debug, Args, Serialize)]
pub struct EightSearchArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub trace: TraceArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    /// Neighbours of a cell: this search has 8, those that share a side or a corner.
    #[arg(long = "neighbours", alias = "connectivity", value_enum, value_name = "8", default_value = "8")]
    pub connectivity: EightNeighbours,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(into = "u8")]
pub enum EightNeighbours {
    #[value(name = "8")]
    Eight,
}

impl From<EightNeighbours> for u8 {
    fn from(EightNeighbours::Eight: EightNeighbours) -> Self {
        8
    }
}

#[derive(Debug, Args, Serialize)]
#[command(after_help = "\
Exact, between centres: obstacles 0, a cell beside one 1, beside its corner the \
square root of 2. A map without obstacles is 0 everywhere, and a note says so.

Example:
  wildfire map euclidean assets/maps/drawing.png --png distances.png")]
pub struct EuclideanArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct VoronoiArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    /// What counts as one obstacle: connected components and each wall, or cells that are seen 60 degrees apart.
    #[arg(long, value_enum, value_name = "NAME", default_value = "obstacles")]
    pub sites: SiteKind,
    /// The cell in which a path along the diagram begins.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place, requires = "goal")]
    pub start: Option<Place>,
    /// The cell in which it ends.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place, requires = "start")]
    pub goal: Option<Place>,
    #[command(flatten)]
    #[serde(flatten)]
    pub corners: CornerArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SiteKind {
    Obstacles,
    Cells,
}

impl From<SiteKind> for Sites {
    fn from(kind: SiteKind) -> Self {
        match kind {
            SiteKind::Obstacles => Self::Obstacles,
            SiteKind::Cells => Self::Cells,
        }
    }
}

#[derive(Debug, Args, Serialize)]
pub struct RrtArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub graph: GraphFileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub growth: GrowthArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct RrtStarArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub graph: GraphFileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub growth: GrowthArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub near: NearArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct PrmArguments {
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArguments,
    #[command(flatten)]
    #[serde(skip)]
    pub graph: GraphFileArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    /// The number that decides all draws.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Points that are drawn, from 1 to 100000; those in obstacles are left out.
    #[arg(long, default_value_t = 500, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: u32,
    #[command(flatten)]
    #[serde(flatten)]
    pub near: NearArguments,
}

/// How a tree grows.
#[derive(Debug, Args, Serialize)]
pub struct GrowthArguments {
    /// The number that decides all draws.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Points that are drawn at most, from 1 to 100000.
    #[arg(long, default_value_t = 5000, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: u32,
    /// The longest edge in cells; `auto` is a twentieth of the map's longer side, at least 5.
    #[arg(long, value_name = "CELLS|auto", default_value = "auto", allow_hyphen_values = true, value_parser = parse_step)]
    pub step: TreeStep,
    /// The chance that the goal is drawn in place of a point.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, allow_hyphen_values = true, value_parser = parse_number)]
    pub goal_bias: f64,
}

/// Which points are neighbours.
#[derive(Debug, Args, Serialize)]
pub struct NearArguments {
    /// How many nearest points are neighbours, from 1 to 1000 [default: 2e ln n of n points].
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = parse_count)]
    pub neighbours: Option<u32>,
    /// The distance in cells within which points are neighbours [default: no limit].
    #[arg(long, value_name = "CELLS", allow_hyphen_values = true, value_parser = parse_number)]
    pub radius: Option<f64>,
}

/// The longest edge of a tree: as it was given, or as a map suggests, from when it is known.
#[derive(Clone, Debug, Default)]
pub struct TreeStep {
    given: Option<f64>,
    of_map: OnceLock<f64>,
}

impl TreeStep {
    /// On maps of up to 100 cells.
    const LEAST: f64 = 5.0;
    /// Edges that span the longer side.
    const EDGES_ACROSS: f64 = 20.0;

    pub fn given(&self) -> Option<f64> {
        self.given
    }

    /// Returns the step on a map of which the longer side has so many cells.
    fn on_side(&self, longer: usize) -> f64 {
        let of_map = || (longer as f64 / Self::EDGES_ACROSS).max(Self::LEAST);
        self.given.unwrap_or_else(|| *self.of_map.get_or_init(of_map))
    }
}

impl Serialize for TreeStep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.given.or_else(|| self.of_map.get().copied()).serialize(serializer)
    }
}

impl GrowthArguments {
    pub fn check(&self, near: Option<&NearArguments>) -> Result<(), BadParameter> {
        self.settings_of_step(self.step.given.unwrap_or(TreeStep::LEAST), near).check()
    }

    /// The settings of a tree on a map; RRT has no neighbours.
    pub fn settings(&self, occupied: &Grid<bool>, near: Option<&NearArguments>) -> RrtSettings {
        self.settings_of_step(self.step.on_side(occupied.rows().max(occupied.cols())), near)
    }

    fn settings_of_step(&self, step: f64, near: Option<&NearArguments>) -> RrtSettings {
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

impl PrmArguments {
    pub fn settings(&self) -> PrmSettings {
        let NearArguments { neighbours, radius } = self.near;
        PrmSettings { seed: self.seed, samples: self.samples, neighbours, radius }
    }
}

pub fn parse_count(text: &str) -> Result<u32, String> {
    numbers::parse(text).ok_or_else(|| "expected a whole number".to_owned())
}

pub fn parse_step(text: &str) -> Result<TreeStep, String> {
    let given = match text {
        "auto" => None,
        _ => Some(numbers::parse(text).ok_or_else(|| "expected a number of cells, or `auto`".to_owned())?),
    };
    Ok(TreeStep { given, ..TreeStep::default() })
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
