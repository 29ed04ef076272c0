//! Options that several commands of `wildfire map` share, and what they mean to the algorithms.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use serde::{Serialize, Serializer};

use crate::cli::error::CliError;
use crate::cli::map::commands::ArgumentGroup;
use crate::cli::numbers;
use crate::cli::output_files::Format;
use crate::cli::report::FormArguments;
use wildfire_grid::map_files::{self, MAX_CELLS, MAX_SIDE, MapError, MapFile, Reading, Tolerance};
use wildfire_grid::parameter::BadParameter;
use wildfire_grid::{Connectivity, CornerCutting, Place, occupancy};
use wildfire_picture::ColourMap;

/// Makes the values of options from their names, `Name { Value, Value }`; with `for Type` they are values of that type of
/// an algorithm.
macro_rules! choices {
    ($name:ident { $($(#[$meta:meta])* $value:ident),* } $($more:tt)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            $($(#[$meta])* $value),*
        }

        choices! { $($more)* }
    };
    ($name:ident for $of_algorithm:ty { $($(#[$meta:meta])* $value:ident),* } $($more:tt)*) => {
        choices! { $name { $($(#[$meta])* $value),* } $($more)* }

        impl From<$name> for $of_algorithm {
            fn from(name: $name) -> Self {
                match name {
                    $($name::$value => Self::$value),*
                }
            }
        }
    };
    () => {};
}
pub(super) use choices;

choices! {
    Colours for ColourMap { Viridis, Jet, #[value(alias = "parula")] BlueYellow }
}

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
    /// Largest grey value of an occupied pixel, 0 black to 255 white; `auto` picks it with Otsu's method [default: 50].
    #[arg(long, value_name = "GREY|auto", allow_hyphen_values = true, value_parser = parse_tolerance)]
    pub tolerance: Option<Tolerance>,
    /// Swap occupied and free: in an image, light pixels are occupied.
    #[arg(long)]
    pub invert: bool,
    /// Free the first and last K rows and columns of the file.
    #[arg(long, value_name = "K", default_value_t = 0, allow_hyphen_values = true, value_parser = parse_edge)]
    pub remove_edges: usize,
    /// Resample the map to this many columns and rows; a cell with anything occupied in it is occupied.
    #[arg(long, value_name = "COLSxROWS", allow_hyphen_values = true, value_parser = parse_size)]
    pub resize: Option<MapSize>,
}

/// Says that `--tolerance` was given for a map that has no grey values.
pub const NO_IMAGE: &str = "--tolerance has no effect: the map is not an image.";

/// The size of a map, as people say it: columns first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapSize {
    cols: usize,
    rows: usize,
}

impl ReadingArguments {
    /// Returns the options as they are typed, so that another command reads the same map.
    pub fn args(&self) -> String {
        let mut args = Vec::new();
        args.extend(self.tolerance.map(|tolerance| match tolerance {
            Tolerance::Grey(grey) => format!("--tolerance {grey}"),
            Tolerance::Auto => "--tolerance auto".to_owned(),
        }));
        args.extend(self.invert.then(|| "--invert".to_owned()));
        args.extend((self.remove_edges > 0).then(|| format!("--remove-edges {}", self.remove_edges)));
        args.extend(self.resize.map(|size| format!("--resize {}x{}", size.cols, size.rows)));
        args.join(" ")
    }

    /// Reads the map in a file, without its edges.
    pub fn read(&self, path: &Path) -> Result<MapFile, CliError> {
        let reading = Reading { tolerance: self.tolerance.unwrap_or_default(), inverted: self.invert };
        let mut map = map_files::read(path, reading)?;
        // Edges go before the map is resampled, since K counts rows and columns of the file.
        occupancy::remove_edges(&mut map.occupied, self.remove_edges);
        if let Some(MapSize { cols, rows }) = self.resize {
            map.resize(rows, cols).map_err(|fault| MapError { path: path.to_owned(), fault })?;
        }
        Ok(map)
    }
}

/// Files to write, and the form of the answer.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("picture").args(["png", "overlay", "surface"]).multiple(true))]
pub struct OutputArguments {
    /// Write the values as CSV, without a header; floats with 12 significant digits.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write the values as a NumPy array.
    #[arg(long, value_name = "FILE.npy")]
    pub npy: Option<PathBuf>,
    /// Draw the values from above, with path, start and goal.
    #[arg(long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
    /// Draw the values over the input.
    #[arg(long, value_name = "FILE.png")]
    pub overlay: Option<PathBuf>,
    /// Draw the values as a surface in space.
    #[arg(long, value_name = "FILE.png")]
    pub surface: Option<PathBuf>,
    /// Write the path, ROW,COLUMN per line from the start; an empty file without a path.
    #[arg(long, value_name = "FILE.csv")]
    pub path: Option<PathBuf>,
    /// Write the value of every cell into it, on maps of at most 60 columns and rows.
    #[arg(long, requires = "png")]
    pub values: bool,
    /// Colours of the pictures; blue-yellow is much like MATLAB's parula, which is not free.
    #[arg(long, value_enum, value_name = "NAME", default_value = "viridis", requires = "picture")]
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
    #[arg(
        long = "neighbours",
        alias = "connectivity",
        value_name = "4|8",
        default_value = "8",
        value_parser = neighbours(&["4", "8"])
    )]
    pub connectivity: Neighbours,
}

#[derive(Debug, Args, Serialize)]
pub struct GoalArguments {
    /// The goal, counted from 0; row 0 is the first line of the file.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub goal: Place,
}

/// Where a search begins and ends.
#[derive(Debug, Args, Serialize)]
pub struct EndArguments {
    /// Start of the path.
    #[arg(long, value_name = "ROW,COLUMN", allow_hyphen_values = true, value_parser = parse_place)]
    pub start: Place,
    #[command(flatten)]
    #[serde(flatten)]
    pub goal: GoalArguments,
}

#[derive(Debug, Args, Serialize)]
pub struct CornerArguments {
    /// Allow a diagonal step only where both cells beside it are free.
    #[arg(long)]
    pub no_corner_cutting: bool,
}

/// Files of a search, its ends, and the parameters of its algorithm.
#[derive(Debug, Args, Serialize)]
pub struct PathArguments<F: Args, P: Args> {
    #[command(flatten)]
    #[serde(skip)]
    pub more_files: F,
    #[command(flatten)]
    #[serde(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    #[serde(flatten)]
    pub parameters: P,
}

impl<F: Args + ArgumentGroup, P: Args + ArgumentGroup> ArgumentGroup for PathArguments<F, P> {
    fn check(&self) -> Result<(), BadParameter> {
        self.parameters.check()
    }

    fn has_start(&self) -> bool {
        true
    }

    fn more_files(&self) -> [(Format, &Option<PathBuf>); 2] {
        self.more_files.more_files()
    }
}

/// Number of neighbours of a cell, 4 or 8.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(transparent)]
pub struct Neighbours(pub u8);

impl From<Neighbours> for Connectivity {
    fn from(Neighbours(number): Neighbours) -> Self {
        if number == 4 { Self::Four } else { Self::Eight }
    }
}

impl CornerArguments {
    pub fn rule(&self) -> CornerCutting {
        if self.no_corner_cutting { CornerCutting::Forbidden } else { CornerCutting::Allowed }
    }
}

// Values of options from text; an error is what was expected. The ranges of parameters are their algorithms' business.

pub fn parse_place(text: &str) -> Result<Place, String> {
    let numbers =
        text.split_once(',').and_then(|(row, col)| Some((numbers::parse(row.trim())?, numbers::parse(col.trim())?)));
    numbers.ok_or_else(|| "expected ROW,COLUMN, two whole numbers counted from 0, such as 3,17".to_owned())
}

/// Reads one of these numbers of neighbours.
pub fn neighbours(numbers: &'static [&'static str]) -> impl TypedValueParser<Value = Neighbours> {
    PossibleValuesParser::new(numbers).map(|number| Neighbours(number.parse().expect("these are numbers")))
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
    let size = text.split_once('x').and_then(|(cols, rows)| Some(MapSize { cols: side(cols)?, rows: side(rows)? }));
    size.filter(|size| size.cols * size.rows <= MAX_CELLS).ok_or_else(|| {
        format!("expected COLSxROWS, such as 100x80, of 1 to {MAX_SIDE} each and at most {MAX_CELLS} cells in all")
    })
}

fn side(text: &str) -> Option<usize> {
    numbers::parse(text).filter(|side| (1..=MAX_SIDE).contains(side))
}

fn parse_edge(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(0..=MAX_SIDE), "a number of rows and columns")
}

pub fn parse_number(text: &str) -> Result<f64, String> {
    numbers::parse(text).ok_or_else(|| "expected a number".to_owned())
}

/// One number, or several that are tried in turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers(pub Vec<f64>);

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.as_slice() {
            [one] => one.serialize(serializer),
            several => several.serialize(serializer),
        }
    }
}

pub fn parse_numbers(text: &str) -> Result<Numbers, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| numbers::parse(number.trim())).collect();
    numbers.map(Numbers).ok_or_else(|| "expected a number, or several separated by commas, such as 5,10,15".to_owned())
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
        assert_eq!(parse_tolerance("255"), Ok(Tolerance::Grey(255)));
        assert_eq!(parse_tolerance("auto"), Ok(Tolerance::Auto));
        assert!(parse_tolerance("256").is_err_and(|expected| expected.contains("0 to 255")));
        assert_eq!(parse_size("32767x1"), Ok(MapSize { cols: 32_767, rows: 1 }));
        for wrong in ["", "3", "3,4", "0x4", "3x-4", "32768x1", "20000x20000", "axb"] {
            assert!(parse_size(wrong).is_err_and(|expected| expected.contains("COLSxROWS")), "{wrong}");
        }
        assert_eq!(parse_numbers("5, 10,1.5"), Ok(Numbers(vec![5.0, 10.0, 1.5])));
        for wrong in ["", "5,", "5;10", "a"] {
            assert!(parse_numbers(wrong).is_err_and(|expected| expected.contains("commas")), "{wrong}");
        }
        assert!(parse_edge("32767").is_ok() && parse_edge("32768").is_err() && parse_edge("-1").is_err());
    }
}
