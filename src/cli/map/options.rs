//! Options that several commands of `wildfire map` share, and what they mean to the algorithms.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgGroup, Args, ValueEnum};
use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::output_files::Format;
use crate::cli::report::FormArguments;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_grid::map_files::{self, MAX_CELLS, MAX_SIDE, MapError, MapFile, Reading, Tolerance};
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::{Connectivity, CornerCutting, Place, TieOrder, occupancy, potential};
use wildfire_picture::ColourMap;

/// The map to read.
#[derive(Debug, Args)]
pub struct InputArguments {
    /// A map: an image (PNG, JPEG, WebP, GIF, BMP, TIFF, PGM), text of 0 and 1 or of `.` and `#`, a table or a NumPy array
    /// of 0 and 1, Moving AI `.map` (S, swamp, and W, water, are blocked like all but `.` and G), or the YAML file of a ROS
    /// map.
    #[arg(value_name = "MAP")]
    pub map: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArguments,
}

/// Options of reading a map.
#[derive(Debug, Args)]
pub struct ReadingArguments {
    /// Pixels of an image are occupied where their grey value, 0 black to 255 white, is at most this; `auto` takes the
    /// value that separates dark from light best, by Otsu's method [default: 50].
    #[arg(long, value_name = "GREY|auto", allow_hyphen_values = true, value_parser = parse_tolerance)]
    pub tolerance: Option<Tolerance>,
    /// Take an image as its negative, so that what is light is occupied; in other maps occupied cells become free and
    /// free ones occupied.
    #[arg(long)]
    pub invert: bool,
    /// Free the first and last K rows and columns of the file.
    #[arg(long, value_name = "K", default_value_t = 0, allow_hyphen_values = true, value_parser = parse_edge)]
    pub remove_edges: usize,
    /// Lay this many columns and rows of cells over the map: a cell is occupied where anything in it is, so that no wall
    /// is lost.
    #[arg(long, value_name = "COLSxROWS", allow_hyphen_values = true, value_parser = parse_size)]
    pub resize: Option<MapSize>,
}

/// Says that `--tolerance` was given for a map that has no grey values.
pub const NO_IMAGE: &str = "--tolerance has no effect: the map is no image.";

/// The size of a map, as people say it: columns first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapSize {
    cols: usize,
    rows: usize,
}

impl ReadingArguments {
    /// Returns the options as they are typed, so that another command reads the same map.
    pub fn words(&self) -> String {
        let mut words = Vec::new();
        words.extend(self.tolerance.map(|tolerance| match tolerance {
            Tolerance::Grey(grey) => format!("--tolerance {grey}"),
            Tolerance::Auto => "--tolerance auto".to_owned(),
        }));
        words.extend(self.invert.then(|| "--invert".to_owned()));
        words.extend((self.remove_edges > 0).then(|| format!("--remove-edges {}", self.remove_edges)));
        words.extend(self.resize.map(|size| format!("--resize {}x{}", size.cols, size.rows)));
        words.join(" ")
    }

    /// Reads the map in a file, without its edges, and says how much CPU time that took.
    pub fn read(&self, path: &Path) -> Result<(MapFile, Duration), CliError> {
        let mut stopwatch = CpuStopwatch::start();
        let reading = Reading { tolerance: self.tolerance.unwrap_or_default(), inverted: self.invert };
        let mut map = map_files::read(path, reading)?;
        occupancy::remove_edges(&mut map.occupied, self.remove_edges);
        if let Some(MapSize { cols, rows }) = self.resize {
            map.resize(rows, cols).map_err(|fault| MapError { path: path.to_owned(), fault })?;
        }
        Ok((map, stopwatch.lap()))
    }
}

/// Files to write, and the form of the answer.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("picture").args(["png", "overlay", "surface"]).multiple(true))]
pub struct OutputArguments {
    /// Write the values as CSV, without a header; floats with 12 significant digits.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write the values as a NumPy array.
    #[arg(help_heading = "Output", long, value_name = "FILE.npy")]
    pub npy: Option<PathBuf>,
    /// Draw the values from above, with path, start and goal.
    #[arg(help_heading = "Output", long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
    /// Draw the values over the input.
    #[arg(help_heading = "Output", long, value_name = "FILE.png")]
    pub overlay: Option<PathBuf>,
    /// Draw the values as a surface in space.
    #[arg(help_heading = "Output", long, value_name = "FILE.png")]
    pub surface: Option<PathBuf>,
    /// Write the path, ROW,COLUMN per line from the start on; an empty file if there is none.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub path: Option<PathBuf>,
    /// Colours of the pictures.
    #[arg(
        help_heading = "Output",
        long,
        value_enum,
        value_name = "NAME",
        default_value = "viridis",
        requires = "picture"
    )]
    pub colormap: Colours,
    #[command(flatten)]
    pub form: FormArguments,
}

impl OutputArguments {
    /// Lists the files that may have been asked for.
    pub fn files(&self) -> [(Format, &Option<PathBuf>); 6] {
        let pictures = [&self.png, &self.overlay, &self.surface].map(|picture| (Format::Png, picture));
        let [png, overlay, surface] = pictures;
        [(Format::Csv, &self.csv), (Format::Npy, &self.npy), png, overlay, surface, (Format::Csv, &self.path)]
    }

    /// Says whether any file was asked for.
    pub fn has_files(&self) -> bool {
        self.files().iter().any(|(_, path)| path.is_some())
    }
}

/// Input and output of a command; no parameters of its algorithm.
#[derive(Debug, Args)]
pub struct FileArguments {
    #[command(flatten)]
    pub input: InputArguments,
    #[command(flatten)]
    pub output: OutputArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct NeighbourArguments {
    /// Neighbours of a cell: the 4 that share a side, or the 8 that share a side or a corner.
    #[arg(long = "neighbours", alias = "connectivity", value_enum, value_name = "4|8", default_value = "8")]
    pub connectivity: Neighbours,
}

#[derive(Debug, Args, Serialize)]
pub struct GoalArguments {
    /// The goal, counted from 0; row 0 is the first line of the file.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub goal: Place,
}

#[derive(Debug, Args, Serialize)]
pub struct CornerArguments {
    /// Allow a diagonal step only where both cells beside it are free.
    #[arg(long)]
    pub no_corner_cutting: bool,
}

#[derive(Debug, Args, Serialize)]
pub struct FieldArguments {
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub attraction: AttractionOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub repulsion: RepulsionOptions,
}

#[derive(Debug, Args, Serialize)]
pub struct AttractionOptions {
    /// zeta / 2 x the square of the Euclidean distance from the goal, or the city-block distance.
    #[arg(long, value_enum, value_name = "NAME", default_value = "d2")]
    pub distance: Distance,
    /// Strength of the attraction `d2`; it shows with `--scale none` only.
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub zeta: f64,
    /// The largest attraction, to which all are scaled, or `none`.
    #[arg(long, value_name = "S|none", default_value = "10", allow_hyphen_values = true, value_parser = parse_scale)]
    pub scale: Scale,
}

#[derive(Debug, Args, Serialize)]
pub struct RepulsionOptions {
    /// The brushfire value beyond which there is no repulsion.
    #[arg(long, default_value_t = 5.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub q: f64,
    /// Strength of the repulsion.
    #[arg(long, default_value_t = 15.0, allow_hyphen_values = true, value_parser = parse_number)]
    pub eta: f64,
    /// Take the distance itself, one less than the brushfire value, as textbooks do: obstacles become infinitely high.
    #[arg(long)]
    pub true_distance: bool,
}

/// The greatest attraction; `None` leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Scale(pub Option<f64>);

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(into = "u8")]
pub enum Neighbours {
    #[value(name = "4")]
    Four,
    #[value(name = "8")]
    Eight,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    ObstacleOne,
    ObstacleZero,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    Literal,
    Continuous,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    CrossFirst,
    WestFirst,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distance {
    D2,
    Manhattan,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Escape {
    Wavefront,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Colours {
    Viridis,
    Jet,
}

impl From<Neighbours> for u8 {
    fn from(neighbours: Neighbours) -> Self {
        match neighbours {
            Neighbours::Four => 4,
            Neighbours::Eight => 8,
        }
    }
}

impl From<Neighbours> for Connectivity {
    fn from(neighbours: Neighbours) -> Self {
        match neighbours {
            Neighbours::Four => Self::Four,
            Neighbours::Eight => Self::Eight,
        }
    }
}

impl From<Order> for TieOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::CrossFirst => Self::CrossFirst,
            Order::WestFirst => Self::WestFirst,
        }
    }
}

impl From<Colours> for ColourMap {
    fn from(colours: Colours) -> Self {
        match colours {
            Colours::Viridis => Self::Viridis,
            Colours::Jet => Self::Jet,
        }
    }
}

impl CornerArguments {
    pub fn rule(&self) -> CornerCutting {
        if self.no_corner_cutting { CornerCutting::Forbidden } else { CornerCutting::Allowed }
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

impl FieldArguments {
    pub fn check(&self) -> Result<(), BadParameter> {
        self.attraction.check()?;
        self.repulsion.law().check()
    }
}

impl RepulsionOptions {
    pub fn law(&self) -> potential::Repulsion {
        let distance = if self.true_distance {
            potential::RepulsionDistance::True
        } else {
            potential::RepulsionDistance::Brushfire
        };
        potential::Repulsion { q: self.q, eta: self.eta, distance }
    }
}

// Values of options from text; an error is what was expected. The ranges of parameters are their algorithms' business.

pub fn parse_place(text: &str) -> Result<Place, String> {
    let whole = |text: &str| numbers::parse(text.trim());
    let numbers = text.split_once(',').and_then(|(row, col)| Some((whole(row)?, whole(col)?)));
    numbers.ok_or_else(|| "expected ROW,COLUMN, two whole numbers counted from 0, such as 3,17".to_owned())
}

pub fn parse_tolerance(text: &str) -> Result<Tolerance, String> {
    match text {
        "auto" => Ok(Tolerance::Auto),
        _ => {
            numbers::parse_within(text, &(0..=u8::MAX), "`auto`, or a grey value, a whole number").map(Tolerance::Grey)
        }
    }
}

fn parse_size(text: &str) -> Result<MapSize, String> {
    let side = |text: &str| numbers::parse(text).filter(|side| (1..=MAX_SIDE).contains(side));
    let size = text.split_once('x').and_then(|(cols, rows)| Some(MapSize { cols: side(cols)?, rows: side(rows)? }));
    size.filter(|size| size.cols * size.rows <= MAX_CELLS).ok_or_else(|| {
        format!("expected COLSxROWS, such as 100x80, of 1 to {MAX_SIDE} each and at most {MAX_CELLS} cells in all")
    })
}

fn parse_edge(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(0..=MAX_SIDE), "a number of rows and columns")
}

pub fn parse_distance(text: &str) -> Result<u16, String> {
    numbers::parse(text).ok_or_else(|| format!("expected a distance in cells, a whole number from 1 to {}", u16::MAX))
}

pub fn parse_number(text: &str) -> Result<f64, String> {
    numbers::parse(text).ok_or_else(|| "expected a number".to_owned())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_two_whole_numbers() {
        assert_eq!(parse_place("3,17"), Ok((3, 17)));
        assert_eq!(parse_place("3, 17"), Ok((3, 17)));
        for wrong in ["", "3", "3;17", "-1,2", "1,2,3", "1.5,2", "a,b", "99999999999999999999,0"] {
            assert!(parse_place(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn text_that_is_no_value_is_refused_with_what_was_expected() {
        assert_eq!(parse_scale("none"), Ok(Scale(None)));
        assert_eq!(parse_scale("2.5"), Ok(Scale(Some(2.5))));
        assert!(parse_scale("all").is_err_and(|expected| expected.contains("`none`")));
        assert_eq!(parse_tolerance("255"), Ok(Tolerance::Grey(255)));
        assert_eq!(parse_tolerance("auto"), Ok(Tolerance::Auto));
        assert!(parse_tolerance("256").is_err_and(|expected| expected.contains("0 to 255")));
        assert_eq!(parse_size("32767x1"), Ok(MapSize { cols: 32_767, rows: 1 }));
        for wrong in ["", "3", "3,4", "0x4", "3x-4", "32768x1", "20000x20000", "axb"] {
            assert!(parse_size(wrong).is_err_and(|expected| expected.contains("COLSxROWS")), "{wrong}");
        }
        assert!(parse_edge("32767").is_ok() && parse_edge("32768").is_err() && parse_edge("-1").is_err());
        assert!(parse_distance("12").is_ok() && parse_distance("1.5").is_err() && parse_distance("65536").is_err());
    }
}
