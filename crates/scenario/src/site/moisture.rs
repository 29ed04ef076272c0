//! What differs from place to place and stays throughout a run: moisture by fuel model (`.fms` of FARSITE) or by rasters, and
//! factors on the rate of spread by fuel model (`.adj`).
//!
//! A line of `.fms` has the number of a fuel model and its moistures in percent: dead fuel of 1, 10 and 100 hours, live herbs,
//! live wood. The line of 0 is for all models without one. A line of `.adj` has a number and a factor. Lines that are empty
//! or begin with `#` are left out.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fuel_name::FuelName;
use super::layers::{ImportedLayers, PackedLayer};
use super::wind_raster::{RasterSampler, check_crs};
use crate::faults::check::{Check, TablePath};
use crate::{FireModelName, RothermelSettings, Scenario};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::input_file;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::fuel::{CustomFuels, FuelModel, custom_number, written_number};
use wildfire_fire::surface::FuelMoisture;
use wildfire_fire::{Landscape, MoistureZones, RATE_FACTORS, RATE_PARTS};
use wildfire_grid::map_files::raster;

/// The most bytes of a file with a line for each fuel model.
const MAX_BYTES: u64 = 1_000_000;

/// The classes of fuel as keys name them, and their most percent.
pub const MOISTURE_CLASSES: [(&str, f64); 5] =
    [("d1", 100.0), ("d10", 100.0), ("d100", 100.0), ("herb", 500.0), ("woody", 500.0)];

/// The percent of cells for which a raster says nothing.
const ABSENT: i16 = -1;

/// Rasters of moisture, for any of the classes; the others have the moisture of `moisture`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MoistureRasters {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d1: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d10: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub d100: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub herb: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub woody: Option<PathBuf>,
}

impl MoistureRasters {
    /// Returns the files by class.
    pub(crate) fn files(&self) -> [Option<&PathBuf>; 5] {
        let Self { d1, d10, d100, herb, woody } = self;
        [d1, d10, d100, herb, woody].map(Option::as_ref)
    }
}

/// Moisture by place, as files say it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ImportedMoisture {
    /// By the number of the fuel model; that of 0 is for those without one.
    Models(Vec<(u8, FuelMoisture)>),
    /// By the place of a class in [`MOISTURE_CLASSES`]: whole percents of each cell.
    Rasters(Vec<(u8, PackedLayer)>),
}

/// The factor of a fuel model on the rate of spread, in thousandths.
pub type RateFactor = (u8, u16);

fn parts(moisture: &mut FuelMoisture) -> [&mut f64; 5] {
    let FuelMoisture { d1, d10, d100, herb, woody } = moisture;
    [d1, d10, d100, herb, woody]
}

impl ImportedMoisture {
    /// Reads moistures by fuel model.
    ///
    /// # Errors
    /// Returns a sentence with the path and the line of what is wrong.
    pub fn read_models(path: &Path) -> Result<Self, String> {
        let percent = MOISTURE_CLASSES.map(|(_, max)| 0.0..=max);
        let rows = read_rows(path, percent, "fuel model, d1, d10, d100, herbaceous and woody moisture in percent")?;
        let moistures = rows.into_iter().map(|(number, percents)| {
            let [d1, d10, d100, herb, woody] = percents.map(|percent| percent / 100.0);
            (number, FuelMoisture { d1, d10, d100, herb, woody })
        });
        Ok(Self::Models(moistures.collect()))
    }

    /// Reads rasters, by the place of their class, for the cells of a field.
    ///
    /// # Errors
    /// Returns a sentence that begins with a path, and names row and column, counted from 0 at the north-west corner, where a
    /// value is wrong.
    pub fn read_rasters(
        files: &[(u8, PathBuf)],
        frame: &FieldFrame,
        layers: Option<&ImportedLayers>,
        fuels: &CustomFuels,
    ) -> Result<Self, String> {
        let may_lack: Vec<bool> = layers.map_or_else(Vec::new, |layers| {
            let fuel = layers.fuel_or(1).into_iter();
            fuel.map(|number| fuels.model(number).is_none_or(|model| !model.burns())).collect()
        });
        let mut rasters = Vec::with_capacity(files.len());
        for (class, path) in files {
            let percents = read_percents(path, MOISTURE_CLASSES[usize::from(*class)].1, frame, layers, &may_lack)?;
            rasters.push((*class, PackedLayer::from_integers(&percents)));
        }
        Ok(Self::Rasters(rasters))
    }

    /// Returns the moisture of each cell, drier or moister in the dead classes; what files do not say is `usual`. `None` if it
    /// is damaged or has too many zones.
    pub fn zones(&self, landscape: &Landscape, usual: FuelMoisture, shift: MoistureShift) -> Option<MoistureZones> {
        let fuel = &landscape.fuel;
        let moisture: Box<dyn Fn(usize) -> FuelMoisture> = match self {
            Self::Models(models) => {
                let of_all = models.iter().find(|(number, _)| *number == 0).map_or(usual, |(_, moisture)| *moisture);
                let mut of_number = [of_all; 256];
                models.iter().for_each(|&(number, moisture)| of_number[usize::from(number)] = moisture);
                Box::new(move |index| of_number[usize::from(fuel[index])])
            }
            Self::Rasters(rasters) => {
                let percents = PercentLayers::new(rasters, fuel.len())?;
                Box::new(move |index| percents.at(index, usual))
            }
        };
        let burns = landscape.burning_numbers();
        let is_fuel: Vec<bool> = fuel.iter().map(|&number| burns[usize::from(number)]).collect();
        // Zones of what does not burn would keep cells of a fuel from being alike: its moisture is that of another cell.
        let first = is_fuel.iter().position(|&is_fuel| is_fuel).unwrap_or(0);
        let cells = is_fuel.iter().enumerate().map(|(index, &is_fuel)| if is_fuel { index } else { first });
        MoistureZones::new(cells.map(|index| shift.applied_to(moisture(index))))
    }

    /// Returns the number of a fuel model that burns and has no moisture, as files write it, if one of these is such a model.
    pub fn missing_model(&self, numbers: impl IntoIterator<Item = u8>, fuels: &CustomFuels) -> Option<u16> {
        let Self::Models(models) = self else { return None };
        let burning = numbers.into_iter().filter(|&number| fuels.model(number).is_some_and(FuelModel::burns));
        let mut missing = burning.filter(|number| !models.iter().any(|(listed, _)| [0, *number].contains(listed)));
        missing.next().map(written_number)
    }

    /// Describes the range of each class in sentences, and what may have been misread.
    pub fn describe(&self, cells: usize) -> Vec<String> {
        let mut notes = Vec::new();
        let mut ranges = Vec::new();
        let (by, count) = match self {
            Self::Models(models) => {
                for class in 0..MOISTURE_CLASSES.len() {
                    let of_class = models.iter().map(|&(_, mut moisture)| *parts(&mut moisture)[class]);
                    // Rounded, as a hundredth of a percent has no exact number.
                    ranges.extend(PercentRange::new(class, of_class.map(|part| (1e6 * part).round() / 1e4)));
                }
                ("fuel model", format!("{} fuel models", models.len()))
            }
            Self::Rasters(rasters) => {
                for (class, packed) in rasters {
                    let percents = packed.integers(cells).unwrap_or_default().into_iter();
                    let present = percents.filter(|&percent| percent != ABSENT).map(f64::from);
                    ranges.extend(PercentRange::new((*class).into(), present));
                }
                let dry = ranges.iter().filter(|range| range.max < 2.0);
                notes.extend(dry.map(|range| {
                    format!(
                        "The raster of {} has at most 1.5 %; if its values are fractions, gdal_calc.py --calc=100*A -A \
                         in.tif --outfile out.tif makes them percent.",
                        range.name
                    )
                }));
                let zones = PercentLayers::new(rasters, cells).and_then(|percents| percents.zones(cells));
                ("place", format!("{} zones", zones.map_or(0, |zones| zones.moistures.len())))
            }
        };
        let ranges: Vec<String> = ranges
            .iter()
            .map(
                |PercentRange { name, min, max }| {
                    if min == max { format!("{name} {min} %") } else { format!("{name} {min} to {max} %") }
                },
            )
            .collect();
        let ranges = if ranges.is_empty() { "no class".to_owned() } else { ranges.join(", ") };
        notes.insert(0, format!("Moisture by {by} instead: {ranges}; {count}."));
        notes
    }
}

/// The moistures of a class.
struct PercentRange {
    name: &'static str,
    min: f64,
    max: f64,
}

impl PercentRange {
    /// `None` if there are no moistures.
    fn new(class: usize, percents: impl Iterator<Item = f64>) -> Option<Self> {
        let [min, max] = percents.fold([f64::INFINITY, 0.0], |[min, max], it: f64| [it.min(min), it.max(max)]);
        (min <= max).then_some(Self { name: MOISTURE_CLASSES.get(class)?.0, min, max })
    }
}

/// The rasters of some classes, unpacked.
struct PercentLayers(Vec<(usize, Vec<i16>)>);

impl PercentLayers {
    /// `None` if they are damaged or do not fit the field.
    fn new(rasters: &[(u8, PackedLayer)], cells: usize) -> Option<Self> {
        let mut layers = Vec::with_capacity(rasters.len());
        for (class, packed) in rasters {
            let max = MOISTURE_CLASSES.get(usize::from(*class))?.1 as i16;
            let percents = packed.integers(cells)?;
            if percents.iter().any(|percent| !(ABSENT..=max).contains(percent)) {
                return None;
            }
            layers.push((usize::from(*class), percents));
        }
        Some(Self(layers))
    }

    fn at(&self, index: usize, mut moisture: FuelMoisture) -> FuelMoisture {
        for (class, percents) in self.0.iter().filter(|(_, percents)| percents[index] != ABSENT) {
            *parts(&mut moisture)[*class] = f64::from(percents[index]) / 100.0;
        }
        moisture
    }

    /// Returns all zones, whatever grows there; `None` if they are too many.
    fn zones(&self, cells: usize) -> Option<MoistureZones> {
        MoistureZones::new((0..cells).map(|index| self.at(index, FuelMoisture::default())))
    }
}

/// What chance does to the moisture of dead fuel in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoistureShift {
    /// A fraction that is added, 0 or not.
    pub moister: f64,
    /// The driest that it makes dead fuel.
    pub min: f64,
}

impl MoistureShift {
    pub const NONE: Self = Self { moister: 0.0, min: 0.0 };

    pub(crate) fn applied_to(self, mut moisture: FuelMoisture) -> FuelMoisture {
        // Only where it is uncertain, as a moisture below the least that is stated must not be raised.
        if self != Self::NONE {
            for dead in [&mut moisture.d1, &mut moisture.d10, &mut moisture.d100] {
                *dead = (*dead + self.moister).max(self.min);
            }
        }
        moisture
    }
}

/// Reads the factors of fuel models on the rate of spread.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub fn read_rate_factors(path: &Path) -> Result<Vec<RateFactor>, String> {
    let [min, max] = [RATE_FACTORS.start(), RATE_FACTORS.end()].map(|&parts| f64::from(parts) / RATE_PARTS);
    let rows = read_rows(path, [min..=max], "fuel model and factor")?;
    Ok(rows.into_iter().map(|(number, [factor])| (number, (RATE_PARTS * factor).round() as u16)).collect())
}

/// Returns the factors of cells in thousandths; none if all are 1. `of_cell` are factors of places, which multiply with those of
/// fuel models; a product keeps the range of each.
pub fn rate_factors(fuel: &[u8], of_models: &[RateFactor], of_cell: &[u16]) -> Vec<u16> {
    let mut of_number = [RATE_PARTS as u16; 256];
    of_models.iter().for_each(|&(number, parts)| of_number[usize::from(number)] = parts);
    let mut factors = Vec::with_capacity(fuel.len());
    for (index, &number) in fuel.iter().enumerate() {
        let of_place = of_cell.get(index).map_or(RATE_PARTS, |&parts| f64::from(parts));
        let parts = (f64::from(of_number[usize::from(number)]) * of_place / RATE_PARTS).round() as u16;
        factors.push(parts.clamp(*RATE_FACTORS.start(), *RATE_FACTORS.end()));
    }
    if factors.iter().all(|&parts| f64::from(parts) == RATE_PARTS) { Vec::new() } else { factors }
}

/// Reads a line for each fuel model: its number, and others in these ranges. Models that no landscape can have are left out.
fn read_rows<const N: usize>(
    path: &Path,
    ranges: [RangeInclusive<f64>; N],
    columns: &str,
) -> Result<Vec<(u8, [f64; N])>, String> {
    let name = path.display();
    let text = input_file::read_text(path, MAX_BYTES).map_err(|error| format!("{name}: {error}"))?;
    let mut rows: Vec<(u8, [f64; N])> = Vec::new();
    let lines = text.lines().zip(1_usize..).map(|(line, number)| (line.trim(), number));
    for (line, number) in lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#')) {
        let at = format!("{name}: line {number}");
        let cells: Vec<&str> = line
            .split(|letter: char| letter.is_whitespace() || letter == ',')
            .filter(|cell| !cell.is_empty())
            .collect();
        if cells.len() != N + 1 {
            return Err(format!("{at}: found {} columns, expected {}: {columns}", cells.len(), N + 1));
        }
        let Some(written) = cells[0].parse::<u32>().ok().filter(|written| *written < 1000) else {
            return Err(format!("{at}: found `{}`, expected the number of a fuel model", visible_start(cells[0])));
        };
        let mut values = [0.0; N];
        for (place, value) in values.iter_mut().enumerate() {
            let cell = cells[place + 1];
            let range = &ranges[place];
            let Some(found) = cell.parse().ok().filter(|found| range.contains(found)) else {
                let expected = format!("a number from {} to {} in column {}", range.start(), range.end(), place + 2);
                return Err(format!("{at}: found `{}`, expected {expected}", visible_start(cell)));
            };
            *value = found;
        }
        let built_in =
            u8::try_from(written).ok().filter(|number| *number == 0 || FuelModel::by_number(*number).is_some());
        let Some(stored) = built_in.or_else(|| custom_number(written)) else { continue };
        if rows.iter().any(|(other, _)| *other == stored) {
            return Err(format!("{at}: fuel model {written} has a line before, expected one line for each"));
        }
        rows.push((stored, values));
    }
    if rows.is_empty() {
        return Err(format!("{name}: it has no fuel model; expected lines of {columns}"));
    }
    Ok(rows)
}

/// Reads the moisture of one class in whole percents of the cells of a field.
fn read_percents(
    path: &Path,
    max: f64,
    frame: &FieldFrame,
    layers: Option<&ImportedLayers>,
    may_lack: &[bool],
) -> Result<Vec<i16>, String> {
    let name = path.display();
    let mut bands = raster::read_bands(path).map_err(|error| error.to_string())?;
    if bands.len() != 1 {
        return Err(format!("{name}: it has {} bands, expected one", bands.len()));
    }
    let band = bands.remove(0);
    let scale = match band.unit.as_deref().map(str::trim).unwrap_or_default() {
        "" | "%" | "percent" => 1.0,
        "1" | "fraction" => 100.0,
        unit => {
            let unit = visible_start(unit);
            return Err(format!("{name}: its unit is `{unit}`, expected percent or fraction"));
        }
    };
    let raster = band.raster;
    check_crs(&raster, layers, path)?;
    let mut values = vec![None; raster.values.len()];
    for (row, col) in (0..raster.rows).flat_map(|row| (0..raster.cols).map(move |col| (row, col))) {
        let index = raster.file_row(row) * raster.cols + col;
        let value = raster.values[index];
        if !raster.is_nodata(value) {
            let percent = scale * f64::from(value);
            if !(0.0..=max).contains(&percent) {
                let expected = format!("a moisture of 0 to {max} %");
                return Err(format!("{name}: row {row}, column {col}: found {value}, expected {expected}"));
            }
            values[index] = Some(percent);
        }
    }
    let sampler = RasterSampler { raster: &raster, path, quantity: "moisture" };
    let percents = sampler.by_cell(&values, frame, layers, |index| may_lack.get(index) == Some(&true))?;
    Ok(percents.into_iter().map(|percent| percent.map_or(ABSENT, |percent| percent.round() as i16)).collect())
}

impl RothermelSettings {
    /// Returns the key that sets moisture by place, if there is one.
    pub(crate) fn local_moisture_key(&self) -> Option<&'static str> {
        let by_rasters = self.moisture_rasters.as_ref().map(|_| "fire.rothermel.moisture_rasters");
        self.moisture_file.as_ref().map(|_| "fire.rothermel.moisture_file").or(by_rasters)
    }
}

impl Scenario {
    /// Returns the settings of a landscape on which fire has a rate, with the moisture by place that they set.
    pub(crate) fn local_moisture(&self) -> Option<(&RothermelSettings, &ImportedMoisture)> {
        let settings = self.fire.rothermel.as_ref().filter(|_| self.fire.model == FireModelName::Rothermel)?;
        Some((settings, settings.imported_moisture.as_ref()?))
    }

    /// Checks moistures by place and factors that were read from files, or come from a plan.
    pub(crate) fn check_zones(&self, frame: &FieldFrame, fuels: &CustomFuels) -> Check {
        let Some(settings) = &self.fire.rothermel else { return Ok(()) };
        let table = TablePath::named("fire.rothermel");
        if settings.imported_factors.iter().any(|(_, parts)| !RATE_FACTORS.contains(parts)) {
            return table.refuse("given_factors", "damaged".into(), "factors above 0 and at most 10".into());
        }
        let cells = frame.cell_count();
        let Some(imported) = &settings.imported_moisture else { return Ok(()) };
        match imported {
            ImportedMoisture::Rasters(rasters) => {
                let zones = PercentLayers::new(rasters, cells).and_then(|percents| percents.zones(cells));
                if zones.is_none() {
                    let found = format!("more than {} different moistures together", MoistureZones::MAX);
                    return table.refuse("moisture_rasters", found, "fewer rasters, or coarser values".into());
                }
            }
            ImportedMoisture::Models(models) => {
                for (_, moisture) in models {
                    table.settings(moisture, frame)?;
                }
                let missing = imported.missing_model(self.fuel_numbers(settings), fuels);
                if let Some(number) = missing {
                    let file = settings.moisture_file.as_deref().unwrap_or(Path::new("")).display();
                    let found = format!("{file} without a line of fuel model {number}");
                    let expected = "a line of each that burns on the landscape, or of 0 for all others";
                    return table.refuse("moisture_file", found, expected.into());
                }
            }
        }
        Ok(())
    }

    /// Lists the fuel models that may be on the landscape.
    fn fuel_numbers(&self, settings: &RothermelSettings) -> Vec<u8> {
        let mut numbers = match self.layers() {
            Some(layers) => layers.fuel_or(settings.ground.number()),
            None => vec![settings.ground.number()],
        };
        if self.field.imported.is_some() || self.field.wanted_pieces() > 0 {
            numbers.push(settings.bushes.number());
        }
        let patches = self.landscape.iter().flat_map(|landscape| &landscape.patches);
        numbers.extend(patches.map(|patches| patches.fuel.number()));
        numbers.extend(self.barrier.iter().filter_map(|barrier| barrier.fuel).map(FuelName::number));
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::{LoadedScenario, MemoryLimit, Terrain, explain, load, weather, weather_on};
    use wildfire_base::geometry::Cell;

    const FIRE: &str = "wumpus = []\nunimog = []\n[fire]\nmodel = \"rothermel\"\n[fire.rothermel]\n";
    const HEAD: &str = "ncols 4\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";

    struct Folder(tempfile::TempDir);

    impl Folder {
        fn new(files: &[(&str, &str)]) -> Self {
            let folder = Self(tempfile::tempdir().expect("a scratch folder"));
            folder.write("fuel.asc", &format!("{HEAD}102 102 142 142\n102 98 142 142\n"));
            files.iter().for_each(|(name, text)| folder.write(name, text));
            folder
        }

        fn write(&self, name: &str, text: &str) {
            fs::write(self.0.path().join(name), text).expect("writable");
        }

        /// Loads a scenario on a field of 4 x 2 cells.
        fn load(&self, keys: &str) -> Result<Scenario, String> {
            self.write("mine.toml", &format!("{FIRE}fuel_map = \"fuel.asc\"\n{keys}\n[field]\ncoverage = 0\n"));
            let path = self.0.path().join("mine.toml");
            let scenario = load(path.to_str().expect("plain"), &[]).map_err(|error| error.to_string())?;
            // The contents of a plan are the same without the files.
            let json = serde_json::to_string(&scenario).expect("scenarios are text and numbers");
            let frozen: Scenario = serde_json::from_str(&json).expect("it was written so");
            assert!(frozen == scenario && frozen.check().is_ok());
            Ok(scenario)
        }

        fn checked(&self, keys: &str) -> String {
            self.load(keys).expect("it is right");
            let path = self.0.path().join("mine.toml");
            let loaded = LoadedScenario::open(path.to_str().expect("plain"), &[]).expect("it is right");
            explain(&loaded, MemoryLimit::default()).to_text().split_whitespace().collect::<Vec<_>>().join(" ")
        }
    }

    fn landscape(scenario: &Scenario) -> Landscape {
        let terrain = Terrain::from_scenario(scenario, 1).expect("it needs no drawing");
        Landscape::clone(&terrain.landscape.expect("the ground burns"))
    }

    /// The moisture of dead fuel of 1 hour, cell by cell.
    fn d1(scenario: &Scenario, seed: u64) -> Vec<f64> {
        let weather = weather_on(scenario, seed, &landscape(scenario));
        (0..8).map(|index| weather.in_cell(0, index).moisture.d1).collect()
    }

    #[test]
    fn equal_lines_and_even_rasters_are_the_uniform_moisture() {
        let even = format!("{HEAD}{}", "9 9 9 9\n".repeat(2));
        let folder = Folder::new(&[
            ("even.fms", "# all alike\n\n102 6 7 9 60 90\n142, 6.0, 7, 9, 60, 90\n"),
            ("rest.fms", "0 6 7 9 60 90\n13 20 20 20 100 100\n400 9 9 9 9 9\n"),
            ("even.asc", &even),
        ]);
        let uniform = folder.load("moisture = { d1 = 0.06, d10 = 0.07, d100 = 0.09, herb = 0.6, woody = 0.9 }");
        let uniform = weather(&uniform.expect("it is right"), 1);
        for keys in [
            "moisture_file = \"even.fms\"",
            "moisture_file = \"rest.fms\"",
            "moisture_rasters = { d100 = \"even.asc\" }",
        ] {
            let scenario = folder.load(keys).expect("it is right");
            assert_eq!(weather_on(&scenario, 1, &landscape(&scenario)), uniform, "{keys}");
        }
    }

    #[test]
    fn moisture_is_that_of_the_fuel_or_of_the_place_and_chance_moves_all_of_it() {
        let folder = Folder::new(&[
            ("mine.fms", "102 4.5 7 8 60 90\n142 8 9 10 70 90\n"),
            ("d1.asc", &format!("{HEAD}4 5 6 7\n8 -9999 10 11.4\n")),
            ("share.asc", &format!("{HEAD}{}", ".3 .3 .3 1.4\n".repeat(2))),
        ]);
        let by_fuel = "moisture_file = \"mine.fms\"";
        let scenario = folder.load(by_fuel).expect("it is right");
        // The south row first; water is like grass.
        assert_eq!(d1(&scenario, 1), [0.045, 0.045, 0.08, 0.08, 0.045, 0.045, 0.08, 0.08]);
        let text = folder.checked(by_fuel);
        assert!(text.contains("Moisture by fuel model instead: d1 4.5 to 8 %, d10 7 to 9 %,"), "{text}");
        let by_place = "moisture_rasters = { d1 = \"d1.asc\", herb = \"share.asc\" }";
        let scenario = folder.load(by_place).expect("it is right");
        assert_eq!(d1(&scenario, 1), [0.08, 0.08, 0.1, 0.11, 0.04, 0.05, 0.06, 0.07]);
        let text = folder.checked(by_place);
        assert!(text.contains("d1 4 to 11 %, herb 0 to 1 %; 7 zones."), "{text}");
        assert!(text.contains("The raster of herb has at most 1.5 %; if its values are fractions"), "{text}");
        assert!(text.contains("GR2 in its first cell: the head"), "{text}");
        let uncertain = folder.load(&format!("{by_fuel}\n[weather]\nmoisture_sd = 0.01")).expect("it is right");
        let [one, other] = [1, 2].map(|seed| d1(&uncertain, seed));
        assert!(one != other && (one[2] - one[0] - 0.035).abs() < 1e-12, "{one:?} {other:?}");
        let usual = weather(&uncertain, 1).intervals()[0].moisture.d1;
        assert!((usual - 0.06 - (one[0] - 0.045)).abs() < 1e-12);
    }

    #[test]
    fn factors_of_fuels_and_of_places_multiply() {
        let shape = r#"{"type": "Polygon", "coordinates": [[[0, 0], [30, 0], [30, 10], [0, 10], [0, 0]]]}"#;
        let folder = Folder::new(&[("mine.adj", "142 0.5\n13 2\n"), ("stand.geojson", shape)]);
        let factors = |keys: &str| landscape(&folder.load(keys).expect("it is right")).rate_factors;
        assert_eq!(factors("adjustment_file = \"mine.adj\""), [1000, 1000, 500, 500, 1000, 1000, 500, 500]);
        let stand = "\n[[barrier]]\nfile = \"stand.geojson\"\nfactor = ";
        let both = format!("adjustment_file = \"mine.adj\"{stand}0.3\n");
        assert_eq!(factors(&both), [300, 300, 150, 500, 1000, 1000, 500, 500]);
        assert!(folder.checked(&both).contains("Factors on the rate of spread from 0.15 to 1."));
        assert!(factors(&format!("{stand}1")).is_empty() && factors("").is_empty());
        let scenario = folder.load(&format!("{stand}2\nfuel = 104")).expect("it is right");
        assert_eq!(landscape(&scenario).fuel_number(Cell { col: 0, row: 0 }), 104);
        let refused = folder.load(&format!("{stand}0")).expect_err("fire would never come");
        assert!(refused.contains("`barrier.0.factor` is 0; expected a number from 0.001 to 10"), "{refused}");
    }

    #[test]
    fn files_that_are_no_moistures_and_no_factors_are_refused_with_their_place() {
        let many = (0..5000).map(|cell| format!("{} ", cell % 100)).collect::<String>();
        let tens = (0..5000).map(|cell| format!("{} ", cell / 100)).collect::<String>();
        let wide = HEAD.replace("ncols 4", "ncols 100").replace("nrows 2", "nrows 50");
        let folder = Folder::new(&[
            ("short.fms", "102 6 7 8 60 90\n\n142 6 7\n"),
            ("moist.fms", "102 101 7 8 60 90\n"),
            ("word.fms", "GR2 6 7 8 60 90\n"),
            ("nan.fms", "102 nan 7 8 60 90\n"),
            ("twice.fms", "102 6 7 8 60 90\n102 6 7 8 60 90\n"),
            ("lacking.fms", "102 6 7 8 60 90\n"),
            ("empty.fms", "# nothing\n"),
            ("zero.adj", "102 0\n"),
            ("hole.asc", &format!("{HEAD}4 5 6 7\n-9999 9 10 11\n")),
            ("moist.asc", &format!("{HEAD}4 5 6 7\n8 9 10 101\n")),
            ("even.asc", &format!("{HEAD}4 5 6 7\n8 9 10 10\n")),
            ("small.asc", &format!("{}4 5 6\n", HEAD.replace("ncols 4", "ncols 3").replace("nrows 2", "nrows 1"))),
            ("days.csv", "d1,d10,d100,herb,woody\n0.06,0.07,0.08,0.6,0.9\n"),
            ("wide.asc", &format!("{wide}{}", "102 ".repeat(5000))),
            ("many.asc", &format!("{wide}{many}")),
            ("tens.asc", &format!("{wide}{tens}")),
        ]);
        let file = |name: &str| format!("moisture_file = \"{name}\"");
        let raster = |name: &str| format!("moisture_rasters = {{ d1 = \"{name}\" }}");
        let days = "\n[weather]\nsamples = \"days.csv\"";
        let later = "\n[[weather.moisture]]\nat_s = 60\nd1 = 0.1\nd10 = 0.1\nd100 = 0.1\nherb = 0.6\nwoody = 0.9";
        for (keys, expected) in [
            (file("short.fms"), "short.fms: line 3: found 3 columns, expected 6: fuel model, d1"),
            (file("moist.fms"), "moist.fms: line 1: found `101`, expected a number from 0 to 100 in column 2"),
            (file("word.fms"), "word.fms: line 1: found `GR2`, expected the number of a fuel model"),
            (file("nan.fms"), "nan.fms: line 1: found `nan`, expected a number"),
            (file("twice.fms"), "twice.fms: line 2: fuel model 102 has a line before"),
            (file("lacking.fms"), "lacking.fms without a line of fuel model 142; expected a line of each"),
            (file("empty.fms"), "empty.fms: it has no fuel model; expected lines"),
            (file("none.fms"), "none.fms: "),
            (
                "adjustment_file = \"zero.adj\"".into(),
                "zero.adj: line 1: found `0`, expected a number from 0.001 to 10",
            ),
            (raster("hole.asc"), "hole.asc: found no data at (5, 5), expected moisture in every cell"),
            (raster("moist.asc"), "moist.asc: row 1, column 3: found 101, expected a moisture of 0 to 100 %"),
            (
                raster("small.asc"),
                "small.asc: it reaches from (0, 0) to (30, 10), expected moisture for the whole field",
            ),
            (
                format!("{}\n{}", file("rest.fms"), raster("even.asc")),
                "`fire.rothermel.moisture_file` cannot be combined with `fire.rothermel.moisture_rasters`",
            ),
            (
                format!("{}{later}", raster("even.asc")),
                "`fire.rothermel.moisture_rasters` cannot be combined with `weather.moisture`",
            ),
            (
                format!("{}{days}", raster("even.asc")),
                "`weather.samples` has columns of moisture; expected none beside `fire.rothermel.moisture_rasters`",
            ),
        ] {
            let refused = folder.load(&keys).expect_err(expected);
            assert!(refused.contains(expected), "{refused}");
        }
        fs::copy(folder.0.path().join("wide.asc"), folder.0.path().join("fuel.asc")).expect("writable");
        let both = "moisture_rasters = { d1 = \"many.asc\", d10 = \"tens.asc\" }";
        let refused = folder.load(both).expect_err("there are 5000");
        assert!(refused.contains("more than 4096 different moistures together; expected fewer rasters"), "{refused}");
        assert!(folder.load(&raster("many.asc")).is_ok());
    }
}
