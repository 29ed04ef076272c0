//! `wildfire fire spread`: a fire on a landscape, without agents: when it reaches which cell.

mod automaton;
mod automaton_arguments;
mod canopy;
mod ground;
mod perimeters;
mod report;
mod rothermel;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};

use automaton_arguments::AutomatonArguments;
use canopy::CanopyArguments;
use perimeters::PerimeterArguments;

use super::options::{
    ChoiceArguments, MAX_SECONDS, SlopeArguments, WindStep, WindSteps, cell, choice, moisture, wind_steps,
};
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::report::FormArguments;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::models::Neighbours;
use wildfire_fire::surface::FuelMoisture;
use wildfire_fire::{Landscape, Weather, WeatherInterval};
use wildfire_scenario::{
    ImportedLayers, ImportedMoisture, MOISTURE_CLASSES, MemoryLimit, TimedWindField, WindRasterKind, WindRasters,
    WindUnits,
};

/// The ranges of sides of a field in cells, of sides of cells in metres, and of times in seconds.
const SIDES: RangeInclusive<u16> = 1..=4000;
const CELLS_M: RangeInclusive<f64> = 0.01..=10_000.0;
const TIMES_S: RangeInclusive<f64> = 0.0..=MAX_SECONDS;

/// The sides of a field that neither a raster nor an option gives.
const USUAL_SIDE: u16 = 201;
const USUAL_CELL_M: f64 = 5.0;

#[derive(Debug, Args)]
#[command(after_help = "\
Rows count from the south, columns from the west, both from 0. Directions are \
compass azimuths: degrees clockwise from north. A wind from 270 blows to the \
east; a slope of aspect 180 goes up to the north. Winds are at 10 m, over unsheltered ground.

Fire spreads from cell to cell along straight lines to 8, 16 or 32 neighbours, and from points between two burned \
cells. Roads and water (fuels 91 to 99) stop it, as do chains of such cells that touch at corners.

Examples:
  wildfire fire spread --rows 201 --cols 201 --cell 5 --fuel GR2 --ignite 100,40 \
--wind 2.8@270 --duration 6600 --png arrival.png
  wildfire fire spread --rows 201 --cols 201 --cell 5 --fuel 102 --ignite 50,50 \
--wind 0:2.22@270,4800:2.22@180 --duration 9600 --arrival arrival.asc
  wildfire fire spread --fuel fuel.tif --elevation dem.tif --wind 4@250 \
--ignite 120,80 --ignite 300,90@600 --duration 7200 --format json
  wildfire fire spread --fuel TU5 --wind 9@270 --canopy-height ch.tif --canopy-base cbh.tif \
--canopy-density cbd.tif --canopy-cover cc.tif --bands fire.tif
  wildfire fire spread --fuel fuel.tif --wind 4@250 --duration 6:00:00 --perimeters hours.geojson
  wildfire fire spread --model alexandridis --rows 121 --cols 121 --steps 40 --runs 1000
  wildfire fire spread --model alexandridis --p0 0.3 --wind 8@270 --csv areas.csv")]
pub struct SpreadArguments {
    /// Spread model.
    #[arg(long, value_enum, value_name = "NAME", default_value = "rothermel")]
    model: ModelName,
    /// Code or number of a fuel model, or a raster of numbers: ESRI ASCII (.asc) or GeoTIFF (.tif).
    #[arg(long, value_name = "NAME|FILE")]
    pub fuel: Option<String>,
    /// Custom fuel models: a .fmd file of FARSITE or a CSV table of ELMFIRE.
    #[arg(long, value_name = "FILE")]
    pub fuel_models: Option<PathBuf>,
    /// Rows of the field; rasters have their own [default: 201].
    #[arg(long, value_name = "N", value_parser = side)]
    pub rows: Option<u16>,
    /// Columns of the field; rasters have their own [default: 201].
    #[arg(long, value_name = "N", value_parser = side)]
    pub cols: Option<u16>,
    /// Side of a cell in metres; rasters have their own [default: 5].
    #[arg(long, value_name = "METRES", allow_hyphen_values = true, value_parser = cell_m)]
    pub cell: Option<f64>,
    /// A raster of elevations in metres, instead of --slope.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["slope", "aspect"])]
    pub elevation: Option<PathBuf>,
    #[command(flatten)]
    pub slope: SlopeArguments,
    /// Moistures as fractions of the dry weight: dead 1-h, 10-h and 100-h, live herbaceous, live woody.
    #[arg(
        long,
        value_name = "D1,D10,D100,HERB,WOODY",
        default_value = "0.06,0.07,0.08,0.60,0.90",
        allow_hyphen_values = true,
        value_parser = moisture
    )]
    pub moisture: FuelMoisture,
    /// Moistures by fuel model instead: an initial moisture file (.fms) of FARSITE.
    #[arg(long, value_name = "FILE", conflicts_with = "moisture")]
    pub moisture_file: Option<PathBuf>,
    /// A raster of moisture in percent for a class, d1, d10, d100, herb or woody; may be repeated.
    #[arg(long, value_name = "CLASS=FILE", conflicts_with = "moisture_file", value_parser = moisture_raster)]
    pub moisture_raster: Vec<(u8, PathBuf)>,
    /// Factors on the rate of spread by fuel model: an adjustment file (.adj) of FARSITE.
    #[arg(long, value_name = "FILE")]
    pub adjustment_file: Option<PathBuf>,
    /// Wind at 10 m above the ground: speed in m/s and the azimuth it blows from, such as 2.5@270, with changes at
    /// later seconds, such as 2.5@270,4800:3@180 [default: none].
    #[arg(long, value_name = "M/S@FROM,SECONDS:M/S@FROM,...", allow_hyphen_values = true, value_parser = wind_steps)]
    pub wind: Option<WindSteps>,
    /// Wind by place instead: a raster of speeds in m/s at 10 m, and one of the azimuths it blows from.
    #[arg(long, value_name = "FILE", requires = "wind_from", conflicts_with_all = ["wind", "wind_list"])]
    pub wind_speed: Option<PathBuf>,
    #[arg(long, value_name = "FILE", requires = "wind_speed", hide_short_help = true)]
    pub wind_from: Option<PathBuf>,
    /// Unit and height of --wind-speed: si is m/s at 10 m, english mph at 20 ft, metric km/h at 10 m.
    #[arg(long, value_name = "NAME", default_value = "si", value_parser = choice::<WindUnits>(&["si", "english", "metric"]))]
    pub wind_units: WindUnits,
    /// Winds by place and time: a list of rasters (.atm) of WindNinja or FARSITE.
    #[arg(long, value_name = "FILE", conflicts_with = "wind")]
    pub wind_list: Option<PathBuf>,
    /// Cell to ignite, at the start or some seconds later; may be repeated [default: the middle cell].
    #[arg(long, value_name = "ROW,COL[@SECONDS]", allow_hyphen_values = true, value_parser = ignition)]
    pub ignite: Vec<TimedIgnition>,
    /// Duration of the fire in seconds.
    #[arg(long, value_name = "TIME", default_value = "3600", allow_hyphen_values = true, value_parser = time_s)]
    pub duration: f64,
    #[command(flatten)]
    pub canopy: CanopyArguments,
    /// Neighbours of a cell that fire reaches in a straight line.
    #[arg(long, value_name = "8|16|32", default_value = "32", value_parser = neighbours)]
    pub neighbours: Neighbours,
    /// Memory limit of the fire, such as 4GB [default: 2GB].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
    #[command(flatten)]
    pub choices: ChoiceArguments,
    #[command(flatten)]
    pub automaton: AutomatonArguments,
    /// Write when each cell caught fire, in seconds, -9999 where nothing burned; the name ends in .asc, .tif or .npy.
    #[arg(long, value_name = "FILE")]
    pub arrival: Option<PathBuf>,
    /// Write time, fire type, flame length and intensity of each cell as the bands of a GeoTIFF.
    #[arg(long, value_name = "FILE.tif")]
    pub bands: Option<PathBuf>,
    #[command(flatten)]
    perimeters: PerimeterArguments,
    /// Draw arrival times with contour lines.
    #[arg(long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

/// The models by their names in scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModelName {
    /// A front at the rates of Rothermel's equations.
    Rothermel,
    /// The automaton of Alexandridis and others, 2008.
    Alexandridis,
}

/// A cell that is lit after some seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedIgnition {
    pub cell: Cell,
    pub seconds: f64,
}

fn side(text: &str) -> Result<u16, String> {
    numbers::parse_within(text, &SIDES, "cells")
}

fn cell_m(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &CELLS_M, "metres")
}

fn time_s(text: &str) -> Result<f64, String> {
    numbers::parse_time_within(text, &TIMES_S)
}

fn moisture_raster(text: &str) -> Result<(u8, PathBuf), String> {
    let parts = text.split_once('=').filter(|(_, file)| !file.is_empty());
    let named = parts.and_then(|(name, file)| {
        let class = MOISTURE_CLASSES.iter().position(|(class, _)| *class == name.trim())?;
        Some((class as u8, file.into()))
    });
    named.ok_or_else(|| "expected a class and a file, such as d1=moisture.tif".to_owned())
}

fn neighbours(text: &str) -> Result<Neighbours, String> {
    let count = text.trim().parse::<u8>().ok().and_then(|count| Neighbours::try_from(count).ok());
    count.ok_or_else(|| "expected 8, 16 or 32".to_owned())
}

fn ignition(text: &str) -> Result<TimedIgnition, String> {
    let (place, seconds) = match text.split_once('@') {
        Some((place, seconds)) => (place, time_s(seconds)?),
        None => (text, 0.0),
    };
    let cell = cell(place).map_err(|expected| expected + ", or 100,40@600 for one that is lit after 600 s")?;
    Ok(TimedIgnition { cell, seconds })
}

pub fn run(arguments: &SpreadArguments, quiet: bool) -> Result<(), CliError> {
    arguments.check_model()?;
    match arguments.model {
        ModelName::Rothermel => rothermel::run(arguments, quiet),
        ModelName::Alexandridis => automaton::run(arguments, quiet),
    }
}

impl SpreadArguments {
    /// The field, where no raster gives it.
    fn frame(&self) -> FieldFrame {
        let [rows, cols] = [self.rows, self.cols].map(|side| side.unwrap_or(USUAL_SIDE));
        FieldFrame { cols, rows, cell_m: self.cell.unwrap_or(USUAL_CELL_M) }
    }

    /// Returns the cells that are lit, the one in the middle if none is named, with their seconds.
    fn ignitions(&self, frame: FieldFrame) -> Result<Vec<TimedIgnition>, CliError> {
        if self.ignite.is_empty() {
            return Ok(vec![TimedIgnition { cell: Cell { col: frame.cols / 2, row: frame.rows / 2 }, seconds: 0.0 }]);
        }
        match self.ignite.iter().find(|ignited| ignited.cell.col >= frame.cols || ignited.cell.row >= frame.rows) {
            Some(TimedIgnition { cell: Cell { col, row }, .. }) => {
                let expected = format!("expected a row below {} and a column below {}", frame.rows, frame.cols);
                Err(CliError::bad_input(format!("--ignite {row},{col}: there is no such cell; {expected}"), None))
            }
            None => Ok(self.ignite.clone()),
        }
    }

    /// Returns the winds, none if none were given.
    fn winds(&self) -> Vec<WindStep> {
        let calm = WindStep { from: SimTime::ZERO, speed_mps: 0.0, from_deg: 0.0 };
        self.wind.as_ref().map_or_else(|| vec![calm], |wind| wind.0.clone())
    }

    fn weather(&self) -> Weather {
        let interval =
            |step: WindStep| WeatherInterval { from: step.from, wind_mps: step.wind_mps(), moisture: self.moisture };
        let intervals = self.winds().into_iter().map(interval).collect();
        Weather::new(intervals).expect("winds begin at 0 and rise in time")
    }

    /// Returns the weather of a field, by place where rasters say so.
    fn weather_on(&self, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<Weather, CliError> {
        let rasters = self.wind_speed.as_deref().zip(self.wind_from.as_deref());
        let fields = match (rasters, &self.wind_list) {
            (Some((first, second)), _) => {
                let rasters = WindRasters { first, second, kind: WindRasterKind::SpeedFrom, units: self.wind_units };
                vec![TimedWindField { from: SimTime::ZERO, field: rasters.read(frame, layers).map_err(refused)? }]
            }
            (None, Some(list)) => TimedWindField::read_list(list, self.duration, frame, layers).map_err(refused)?,
            (None, None) => return Ok(self.weather()),
        };
        let intervals = fields.iter().map(|it| {
            let wind_mps = it.field.mean();
            WeatherInterval { from: it.from, wind_mps, moisture: self.moisture }
        });
        let weather = Weather::new(intervals.collect()).map_err(|error| CliError::bad_input(error, None))?;
        Ok(weather.with_wind_fields(fields.into_iter().map(|it| Some(Arc::new(it.field))).collect()))
    }

    /// Returns the moisture by place that files give; `None` if there are none.
    fn local_moisture(
        &self,
        landscape: &Landscape,
        layers: Option<&ImportedLayers>,
    ) -> Result<Option<ImportedMoisture>, CliError> {
        let fuels = &landscape.custom_fuels;
        if let Some(file) = &self.moisture_file {
            let imported = ImportedMoisture::read_models(file).map_err(refused)?;
            return match imported.missing_model(landscape.fuel.iter().copied(), fuels) {
                Some(number) => {
                    let expected = "expected one, as it burns on the landscape, or a line of 0 for all others";
                    Err(refused(format!("{}: it has no line of fuel model {number}; {expected}", file.display())))
                }
                None => Ok(Some(imported)),
            };
        }
        let mut is_named = [false; MOISTURE_CLASSES.len()];
        for (class, _) in &self.moisture_raster {
            if std::mem::replace(&mut is_named[usize::from(*class)], true) {
                let name = MOISTURE_CLASSES[usize::from(*class)].0;
                return Err(refused(format!("--moisture-raster names {name} twice; expected one raster for a class")));
            }
        }
        let rasters = (!self.moisture_raster.is_empty())
            .then(|| ImportedMoisture::read_rasters(&self.moisture_raster, &landscape.frame, layers, fuels));
        rasters.transpose().map_err(refused)
    }

    /// Refuses options of the other model.
    fn check_model(&self) -> Result<(), CliError> {
        let (options, model) = match self.model {
            ModelName::Rothermel => {
                let AutomatonArguments { areas, steps, .. } = &self.automaton;
                (vec![("--csv", areas.is_some()), ("--steps", steps.is_some())], "alexandridis")
            }
            ModelName::Alexandridis => {
                let rasters = [("--fuel", self.fuel.is_some()), ("--elevation", self.elevation.is_some())];
                let trees = [("--canopy-height", self.canopy.canopy_height.is_some())];
                let bands = ("--bands", self.bands.is_some());
                let winds = [("--wind-speed", self.wind_speed.is_some()), ("--wind-list", self.wind_list.is_some())];
                let outputs = [("--arrival", self.arrival.is_some()), bands, ("--png", self.png.is_some())];
                let zones = [
                    ("--moisture-file", self.moisture_file.is_some()),
                    ("--moisture-raster", !self.moisture_raster.is_empty()),
                    ("--adjustment-file", self.adjustment_file.is_some()),
                ];
                let perimeters = [("--perimeters", self.perimeters.perimeters.is_some())];
                ([&rasters[..], &trees, &outputs, &perimeters, &winds, &zones].concat(), "rothermel")
            }
        };
        // An option without effect would leave its user believing that it was taken into account.
        match options.iter().find(|(_, is_set)| *is_set) {
            Some((name, _)) => Err(CliError::bad_input(format!("{name} is an option of --model {model}"), None)),
            None => Ok(()),
        }
    }
}

fn refused(message: String) -> CliError {
    CliError::bad_input(message, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ignitions_are_rows_before_columns_with_or_without_a_time() {
        let ignited = |row, col, seconds| TimedIgnition { cell: Cell { col, row }, seconds };
        assert_eq!(ignition("100,40"), Ok(ignited(100, 40, 0.0)));
        assert_eq!(ignition("3, 5@12.5"), Ok(ignited(3, 5, 12.5)));
        assert_eq!(ignition("3,5@1:20:00"), Ok(ignited(3, 5, 4800.0)));
        for wrong in ["", "3", "3,", "-1,4", "3,4@", "3,4@-1", "70000,1", "1,2,3", "1.5,2"] {
            assert!(ignition(wrong).is_err(), "{wrong}");
        }
    }
}
