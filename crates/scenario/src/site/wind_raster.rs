//! Wind by place: rasters of speed and direction, or of the components to the east and to the north, and the lists of FARSITE
//! and WindNinja (`.atm`) that name two of them for each time.
//!
//! Rasters may be coarser or finer than the field and have to cover it, in the coordinate system of its landscape or, without
//! one, in metres from its south-west corner. Between the middles of their cells wind is bilinear in its two components, as a
//! mean of directions would turn the wrong way round at north.

use std::ops::{Add, Div, Mul};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::layers::{ImportedLayers, PackedLayer};
use super::weather_csv::read_text;
use super::wind::{MAX_WIND_MPS, WindChange, WindUnits};
use wildfire_base::geometry::{DVec2, FieldFrame, compass, ops};
use wildfire_base::time::SimTime;
use wildfire_base::untrusted::visible_start;
use wildfire_fire::WindField;
use wildfire_grid::map_files::raster::{self, GeoKeys, Raster};

/// Metres per second in a mile per hour and in a kilometre per hour.
const MILE_PER_HOUR: f64 = 0.447_04;
const KM_PER_HOUR: f64 = 1.0 / 3.6;

/// Wind at 10 m from wind at 20 ft, as in weather streams.
const FROM_20_FT: f64 = 1.15;

/// The share of a cell by which a raster may end before the field.
const ROUNDING: f64 = 0.01;

/// The first line of a list of rasters.
const LIST: &str = "WINDS_AND_CLOUDS";

/// A wind field as a resolved scenario holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackedWind {
    east: PackedLayer,
    north: PackedLayer,
}

impl PackedWind {
    pub(crate) fn new(field: &WindField) -> Self {
        Self { east: PackedLayer::from_integers(&field.east), north: PackedLayer::from_integers(&field.north) }
    }

    /// Returns the wind by cell index; `None` if it was made for a field of another size.
    pub(crate) fn field(&self, cells: usize) -> Option<WindField> {
        Some(WindField { east: self.east.integers(cells)?, north: self.north.integers(cells)? })
    }
}

/// The rasters of one wind.
#[derive(Clone, Copy, Debug)]
pub struct WindRasters<'a> {
    pub first: &'a Path,
    pub second: &'a Path,
    pub kind: WindRasterKind,
    pub units: WindUnits,
}

/// What two rasters of a wind hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindRasterKind {
    /// Speed, and the azimuth that it blows from.
    SpeedFrom,
    /// Speed, and the azimuth that it blows to.
    SpeedToward,
    /// Components to the east and to the north.
    EastNorth,
}

impl WindRasters<'_> {
    /// Reads the wind of the cells of a field.
    ///
    /// # Errors
    /// Returns a sentence that begins with a path, and names row and column, counted from 0 at the north-west corner, where a
    /// value is wrong.
    pub fn read(&self, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<WindField, String> {
        let is_components = self.kind == WindRasterKind::EastNorth;
        let second_kind = if is_components { Quantity::Speed } else { Quantity::Direction };
        let first = self.raster(self.first, 0, Quantity::Speed, layers)?;
        let second = self.raster(self.second, 1, second_kind, layers)?;
        let name = self.second.display();
        let has_same_place = (first.rows, first.cols) == (second.rows, second.cols)
            && (first.west_m - second.west_m).abs().max((first.south_m - second.south_m).abs())
                <= ROUNDING * first.cell_m
            && (first.cell_m - second.cell_m).abs() <= 1e-6 * first.cell_m;
        if !has_same_place {
            return Err(format!(
                "{name}: it has {}, expected {} as in {}",
                describe_place(&second),
                describe_place(&first),
                self.first.display()
            ));
        }
        let winds: Vec<Option<DVec2>> = first
            .values
            .iter()
            .zip(&second.values)
            .map(|(&first_value, &second_value)| {
                let is_absent = first.is_nodata(first_value) || second.is_nodata(second_value);
                let one = f64::from(first_value);
                let other = f64::from(second_value);
                (!is_absent).then(|| match self.kind {
                    WindRasterKind::SpeedFrom => -compass::unit_toward(other) * one,
                    WindRasterKind::SpeedToward => compass::unit_toward(other) * one,
                    WindRasterKind::EastNorth => DVec2::new(one, other),
                })
            })
            .collect();
        let fuel = layers.map(|layers| layers.fuel_or(1));
        let sampler = RasterSampler { raster: &first, path: self.first, quantity: "wind" };
        // Where nothing grows nobody asks for the wind.
        let by_cell =
            sampler.by_cell(&winds, frame, layers, |index| fuel.as_ref().is_some_and(|fuel| fuel[index] == 0))?;
        Ok(WindField::new(by_cell.into_iter().map(Option::unwrap_or_default)))
    }

    /// Reads one of the two rasters, of two bands that with this number, in m/s or degrees.
    fn raster(
        &self,
        path: &Path,
        number: usize,
        quantity: Quantity,
        layers: Option<&ImportedLayers>,
    ) -> Result<Raster, String> {
        let name = path.display();
        let mut bands = raster::read_bands(path).map_err(|error| error.to_string())?;
        let band = match bands.len() {
            1 => bands.remove(0),
            2 => bands.remove(number),
            count => {
                return Err(format!(
                    "{name}: it has {count} bands, expected one, or two: speed and direction, or u and v"
                ));
            }
        };
        let mut raster = band.raster;
        check_crs(&raster, layers, path)?;
        let stated = band.unit.as_deref().map(str::trim).filter(|unit| !unit.is_empty());
        let scale = match (quantity, stated) {
            (Quantity::Direction, _) => 1.0,
            // A file may state its unit, but never the height above ground, which the scenario's units imply.
            (Quantity::Speed, None) => self.units.scale() * self.units.height_factor(),
            (Quantity::Speed, Some(unit)) => {
                let scale = speed_scale(unit).ok_or_else(|| {
                    let unit = visible_start(unit);
                    format!("{name}: its unit is `{unit}`, expected m/s, km/h, mph or knots")
                })?;
                scale * self.units.height_factor()
            }
        };
        // Components have signs, speeds do not.
        let min = if self.kind == WindRasterKind::EastNorth { -MAX_WIND_MPS } else { 0.0 };
        // In the order of the file, so that the error names its first fault.
        for row in 0..raster.rows {
            for col in 0..raster.cols {
                let index = raster.file_row(row) * raster.cols + col;
                let value = raster.values[index];
                if raster.is_nodata(value) {
                    // From here on NaN alone is no data: a converted value may equal the file's number for it.
                    raster.values[index] = f32::NAN;
                    continue;
                }
                let converted = f64::from(value) * scale;
                let expected = match quantity {
                    Quantity::Speed if !(min..=MAX_WIND_MPS).contains(&converted) => {
                        format!("a wind of {min} to {MAX_WIND_MPS} m/s")
                    }
                    Quantity::Direction if !(-360.0..=360.0).contains(&converted) => "an azimuth in degrees".to_owned(),
                    _ => {
                        raster.values[index] = converted as f32;
                        continue;
                    }
                };
                return Err(format!("{name}: row {row}, column {col}: found {value}, expected {expected}"));
            }
        }
        Ok(raster)
    }
}

/// Refuses a raster in another coordinate system than the landscape's.
pub(crate) fn check_crs(raster: &Raster, layers: Option<&ImportedLayers>, path: &Path) -> Result<(), String> {
    let found = raster.crs.as_ref().and_then(GeoKeys::epsg);
    let expected = layers.and_then(|layers| layers.crs.as_ref()).and_then(GeoKeys::epsg);
    match found.zip(expected) {
        Some((found, expected)) if found != expected => Err(format!(
            "{}: it is in the coordinate system EPSG:{found}, expected EPSG:{expected} as in the landscape",
            path.display()
        )),
        _ => Ok(()),
    }
}

/// A raster that is coarser or finer than a field.
pub(crate) struct RasterSampler<'a> {
    pub raster: &'a Raster,
    pub path: &'a Path,
    /// What its values are, for messages.
    pub quantity: &'static str,
}

impl RasterSampler<'_> {
    /// Returns values of the raster's cells at the cells of a field, between their middles; `None` where there are none, which
    /// is refused in all cells but those that `may_lack` one.
    pub fn by_cell<T: Sampled>(
        &self,
        values: &[Option<T>],
        frame: &FieldFrame,
        layers: Option<&ImportedLayers>,
        may_lack: impl Fn(usize) -> bool,
    ) -> Result<Vec<Option<T>>, String> {
        let Self { raster, quantity, .. } = self;
        let name = self.path.display();
        let corner = layers.map_or(DVec2::ZERO, |layers| DVec2::new(layers.west_m, layers.south_m));
        let mut by_cell = Vec::with_capacity(frame.cell_count());
        for index in 0..frame.cell_count() {
            let at = corner + frame.centre(frame.cell(index));
            // In cells of the raster, from the middle of its first one.
            let place = (at - DVec2::new(raster.west_m, raster.south_m)) / raster.cell_m - DVec2::splat(0.5);
            let is_inside =
                |place: f64, count: usize| (-0.5 - ROUNDING..=count as f64 - 0.5 + ROUNDING).contains(&place);
            if !(is_inside(place.x, raster.cols) && is_inside(place.y, raster.rows)) {
                let ends = DVec2::new(raster.cols as f64, raster.rows as f64) * raster.cell_m;
                return Err(format!(
                    "{name}: it reaches from ({}, {}) to ({}, {}), expected {quantity} for the whole field, which has a \
                     cell at ({}, {})",
                    raster.west_m,
                    raster.south_m,
                    raster.west_m + ends.x,
                    raster.south_m + ends.y,
                    at.x,
                    at.y
                ));
            }
            let value = bilinear(values, [raster.cols, raster.rows], place);
            if value.is_none() && !may_lack(index) {
                return Err(format!(
                    "{name}: found no data at ({}, {}), expected {quantity} in every cell of the field",
                    at.x, at.y
                ));
            }
            by_cell.push(value);
        }
        Ok(by_cell)
    }
}

/// What can be weighted.
pub(crate) trait Sampled:
    Copy + Default + Add<Output = Self> + Mul<f64, Output = Self> + Div<f64, Output = Self>
{
}

impl Sampled for f64 {}
impl Sampled for DVec2 {}

fn describe_place(raster: &Raster) -> String {
    let Raster { rows, cols, west_m, south_m, cell_m, .. } = raster;
    format!("{rows} rows and {cols} columns of {cell_m} m from ({west_m}, {south_m})")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Speed,
    Direction,
}

/// Returns the m/s in a unit of speed; `None` if it is not known.
fn speed_scale(unit: &str) -> Option<f64> {
    Some(match unit.to_ascii_lowercase().as_str() {
        "m/s" | "mps" | "m s-1" | "m s**-1" | "[m/s]" => 1.0,
        "km/h" | "kph" | "kmh" | "km h-1" => KM_PER_HOUR,
        "mph" | "mi/h" => MILE_PER_HOUR,
        "knot" | "knots" | "kt" | "kts" => 1852.0 / 3600.0,
        _ => return None,
    })
}

impl WindUnits {
    /// Returns the m/s in the unit.
    fn scale(self) -> f64 {
        match self {
            Self::Si => 1.0,
            Self::Metric => KM_PER_HOUR,
            Self::English => MILE_PER_HOUR,
        }
    }

    fn height_factor(self) -> f64 {
        if self == Self::English { FROM_20_FT } else { 1.0 }
    }
}

/// Returns the value between four cells, of those that have one; `None` if none has.
fn bilinear<T: Sampled>(values: &[Option<T>], [cols, rows]: [usize; 2], place: DVec2) -> Option<T> {
    let x = place.x.clamp(0.0, (cols - 1) as f64);
    let y = place.y.clamp(0.0, (rows - 1) as f64);
    let col = x as usize;
    let row = y as usize;
    let [beyond_x, beyond_y] = [x - col as f64, y - row as f64];
    let mut sum = T::default();
    // Cells without a value leave their weight to the others.
    let mut weights = 0.0;
    for (near_row, of_row) in [(row, 1.0 - beyond_y), ((row + 1).min(rows - 1), beyond_y)] {
        for (near_col, of_col) in [(col, 1.0 - beyond_x), ((col + 1).min(cols - 1), beyond_x)] {
            let weight = of_row * of_col;
            if weight > 0.0
                && let Some(value) = values[near_row * cols + near_col]
            {
                sum = sum + value * weight;
                weights += weight;
            }
        }
    }
    (weights > 0.0).then(|| sum / weights)
}

/// Says whether a text is a list of rasters.
pub(crate) fn is_list(text: &str) -> bool {
    text.trim_start().get(..LIST.len()).is_some_and(|start| start.eq_ignore_ascii_case(LIST))
}

/// Reads a list of rasters up to a second of the run: a line for each time has month, day, `hhmm`, and the files of speed and
/// direction beside the list (and of clouds, which are not used). The first line is the start of the run.
///
/// # Errors
/// Returns a sentence with the path and the line of what is wrong.
pub(crate) fn read_list(path: &Path, text: &str, end_s: f64) -> Result<Vec<WindChange>, String> {
    let name = path.display();
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut units = None;
    let mut start = None;
    // Only a line of 29 February says that the year is a leap year.
    let leap_day = u32::from(text.lines().any(|line| {
        let mut cells = line.split_whitespace().map(str::parse::<u32>);
        (cells.next(), cells.next()) == (Some(Ok(2)), Some(Ok(29)))
    }));
    let mut changes: Vec<WindChange> = Vec::new();
    let lines = text.lines().zip(1_usize..).map(|(line, number)| (line.trim(), number));
    // The first line is the heading by which the list was recognised.
    for (line, number) in lines.filter(|(line, _)| !line.is_empty()).skip(1) {
        let refused = |expected: &str| {
            Err(format!("{name}: line {number}: found `{}`, expected {expected}", visible_start(line)))
        };
        let Some(units) = units else {
            units = match line.to_ascii_uppercase().as_str() {
                "ENGLISH" => Some(WindUnits::English),
                "METRIC" => Some(WindUnits::Metric),
                _ => return refused("ENGLISH or METRIC"),
            };
            continue;
        };
        let cells: Vec<&str> = line.split_whitespace().collect();
        let numbers = [0, 1, 2].map(|place| cells.get(place).and_then(|cell| cell.parse::<u32>().ok()));
        let [Some(month), Some(day), Some(time)] = numbers else {
            return refused("month, day, hhmm, and the files of speed and direction");
        };
        let [Some(speed), Some(from)] = [3, 4].map(|place| cells.get(place)) else {
            return refused("month, day, hhmm, and the files of speed and direction");
        };
        let is_time = (1..=12).contains(&month) && (1..=31).contains(&day) && time / 100 < 24 && time % 100 < 60;
        if !is_time {
            return refused("a month, a day of it and a time as hhmm");
        }
        // Lists have no year: what seems to be before the first line is of the next one.
        const DAYS_BEFORE: [u32; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];
        let days = DAYS_BEFORE[month as usize - 1] + day - 1 + if month > 2 { leap_day } else { 0 };
        let minute = days * 1440 + time / 100 * 60 + time % 100;
        let first = *start.get_or_insert(minute);
        let minutes = if minute < first { minute + (365 + leap_day) * 1440 - first } else { minute - first };
        let at_s = 60.0 * f64::from(minutes);
        if changes.last().is_some_and(|before: &WindChange| at_s <= before.at_s) {
            return refused("a time after that of the line before");
        }
        if at_s > end_s {
            break;
        }
        // Zeros until the rasters are read, which say what the wind is.
        changes.push(WindChange {
            speed: Some(folder.join(speed)),
            from: Some(folder.join(from)),
            units,
            ..WindChange::uniform(at_s, 0.0, 0.0)
        });
    }
    if changes.is_empty() {
        Err(format!("{name}: it names no rasters; expected a line for each time"))
    } else {
        Ok(changes)
    }
}

/// Reads the file of the key `wind_file` if it is a list of rasters; `None` if it is not.
pub(crate) fn read_wind_list(path: &Path, end_s: f64) -> Result<Option<Vec<WindChange>>, String> {
    let text = read_text(path)?;
    if is_list(&text) { read_list(path, &text, end_s).map(Some) } else { Ok(None) }
}

/// A wind by place from a time on.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedWindField {
    pub from: SimTime,
    pub field: WindField,
}

impl TimedWindField {
    /// Reads the winds of a list of rasters, `.atm`, up to a second after its first line.
    ///
    /// # Errors
    /// Returns a sentence with the path and the place of what is wrong.
    pub fn read_list(
        path: &Path,
        end_s: f64,
        frame: &FieldFrame,
        layers: Option<&ImportedLayers>,
    ) -> Result<Vec<Self>, String> {
        let changes = read_wind_list(path, end_s)?;
        let changes = changes.ok_or_else(|| format!("{}: line 1: expected {LIST}", path.display()))?;
        let mut fields = Vec::with_capacity(changes.len());
        for change in &changes {
            let rasters = change.rasters()?.expect("each line of a list names two");
            fields.push(Self { from: SimTime::from_seconds(change.at_s), field: rasters.read(frame, layers)? });
        }
        Ok(fields)
    }
}

impl WindChange {
    /// Returns the rasters of its keys; `None` if it has none.
    ///
    /// # Errors
    /// Returns a sentence if keys do not belong together.
    pub(crate) fn rasters(&self) -> Result<Option<WindRasters<'_>>, String> {
        let Self { speed, from, toward, east, north, units, .. } = self;
        let (first, second, kind) = match (speed, from, toward, east, north) {
            (None, None, None, None, None) => return Ok(None),
            (Some(speed), Some(from), None, None, None) => (speed, from, WindRasterKind::SpeedFrom),
            (Some(speed), None, Some(toward), None, None) => (speed, toward, WindRasterKind::SpeedToward),
            (None, None, None, Some(east), Some(north)) => (east, north, WindRasterKind::EastNorth),
            _ => {
                let keys = [("speed", speed), ("from", from), ("toward", toward), ("east", east), ("north", north)];
                let found: Vec<&str> = keys.iter().filter(|(_, file)| file.is_some()).map(|(key, _)| *key).collect();
                return Err(format!(
                    "found the rasters `{}`, expected `speed` and `from`, `speed` and `toward`, or `east` and `north`",
                    found.join("`, `")
                ));
            }
        };
        Ok(Some(WindRasters { first, second, kind, units: *units }))
    }

    /// Takes a wind by place; its mean is what is shown of it.
    pub(crate) fn set_field(&mut self, field: &WindField) {
        let mean = field.mean();
        self.speed_mps = mean.length();
        self.toward_deg = ops::atan2(mean.y, mean.x).to_degrees();
        self.imported = Some(PackedWind::new(field));
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 4, rows: 2, cell_m: 10.0 };

    /// Writes a grid whose rows are given from the north on.
    fn grid(folder: &Path, name: &str, head: &str, rows: &str) -> std::path::PathBuf {
        let path = folder.join(name);
        fs::write(&path, format!("{head}\nNODATA_value -9999\n{rows}\n")).expect("the scratch folder takes files");
        path
    }

    const COARSE: &str = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 20";

    fn read(first: &Path, second: &Path, kind: WindRasterKind, units: WindUnits) -> Result<WindField, String> {
        WindRasters { first, second, kind, units }.read(&FRAME, None)
    }

    #[test]
    fn winds_are_bilinear_between_the_middles_of_coarse_cells_and_in_the_unit_of_the_file() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let speed = grid(folder.path(), "speed.asc", COARSE, "2 4");
        let from = grid(folder.path(), "from.asc", COARSE, "270 270");
        let east = |field: &WindField| (0..4).map(|index| field.at(index).x).collect::<Vec<_>>();
        let field = read(&speed, &from, WindRasterKind::SpeedFrom, WindUnits::Si).expect("they are right");
        assert_eq!(east(&field), [2.0, 2.5, 3.5, 4.0]);
        assert!(field.north.iter().all(|&north| north == 0) && field.at(4) == field.at(0));
        let toward = read(&speed, &from, WindRasterKind::SpeedToward, WindUnits::Metric).expect("they are right");
        assert_eq!(east(&toward), [-0.56, -0.69, -0.97, -1.11]);
        let english = read(&speed, &from, WindRasterKind::SpeedFrom, WindUnits::English).expect("they are right");
        assert_eq!(english.at(3).x, 2.06);
        let parts = read(&speed, &from, WindRasterKind::EastNorth, WindUnits::Si);
        assert!(parts.expect_err("a component of 270 m/s").contains("found 270, expected a wind of -150 to 150 m/s"));
        // About north the mean of directions would blow the other way.
        let north = grid(folder.path(), "north.asc", COARSE, "350 10");
        let field = read(&speed, &north, WindRasterKind::SpeedFrom, WindUnits::Si).expect("they are right");
        assert!((0..4).all(|index| field.at(index).y < -1.9));
        let packed = PackedWind::new(&field);
        assert_eq!((packed.field(8), packed.field(7)), (Some(field), None));
    }

    #[test]
    fn rasters_that_cannot_be_a_wind_of_the_field_are_refused() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path();
        let speed = grid(path, "speed.asc", COARSE, "2 4");
        let from = grid(path, "from.asc", COARSE, "270 270");
        for (first, second, expected) in [
            (
                grid(path, "negative.asc", COARSE, "2 -1"),
                from.clone(),
                "negative.asc: row 0, column 1: found -1, expected a wind of 0",
            ),
            (
                speed.clone(),
                grid(path, "turn.asc", COARSE, "2 400"),
                "turn.asc: row 0, column 1: found 400, expected an azimuth",
            ),
            (grid(path, "hole.asc", COARSE, "-9999 -9999"), from.clone(), "hole.asc: found no data at (5, 5)"),
            (
                speed.clone(),
                grid(path, "fine.asc", &COARSE.replace("20", "30"), "1 1"),
                "fine.asc: it has 1 rows and 2 columns of 30 m",
            ),
            (
                speed,
                grid(path, "three.asc", &COARSE.replace("ncols 2", "ncols 3"), "1 1 1"),
                "expected 1 rows and 2 columns",
            ),
            (folder.path().join("none.asc"), from, "none.asc"),
        ] {
            let refused = read(&first, &second, WindRasterKind::SpeedFrom, WindUnits::Si).expect_err(expected);
            assert!(refused.contains(expected), "{refused}");
        }
        let small = COARSE.replace("cellsize 20", "cellsize 10");
        let speed = grid(path, "small.asc", &small, "1 1");
        let refused = read(&speed, &speed, WindRasterKind::SpeedFrom, WindUnits::Si).expect_err("it ends too early");
        assert!(
            refused.contains("small.asc: it reaches from (0, 0) to (20, 10), expected wind for the whole"),
            "{refused}"
        );
    }

    #[test]
    fn lists_have_a_line_for_each_time() {
        let list = |body: &str| read_list(Path::new("winds/run.atm"), &format!("{LIST}\n{body}"), 7200.0);
        let winds =
            list("ENGLISH\n12 31 2330 a_vel.asc a_ang.asc a_cld.asc\n1 1 0 b_vel.asc b_ang.asc\n1 1 2330 c d\n");
        let winds = winds.expect("it is right");
        assert_eq!(winds.iter().map(|wind| wind.at_s).collect::<Vec<_>>(), [0.0, 1800.0]);
        assert_eq!(winds[1].speed.as_deref(), Some(Path::new("winds/b_vel.asc")));
        assert_eq!(
            (winds[1].from.as_deref(), winds[1].units),
            (Some(Path::new("winds/b_ang.asc")), WindUnits::English)
        );
        let times = |body: &str| list(body).expect("it is right").iter().map(|wind| wind.at_s).collect::<Vec<_>>();
        assert_eq!(times("METRIC\n2 29 2300 a b\n3 1 0 c d"), [0.0, 3600.0]);
        assert_eq!(times("METRIC\n2 28 2300 a b\n3 1 0 c d"), [0.0, 3600.0]);
        for (body, expected) in [
            ("", "it names no rasters"),
            ("1 1 0 a b", "line 2: found `1 1 0 a b`, expected ENGLISH or METRIC"),
            ("METRIC\n1 1 0 a", "line 3: found `1 1 0 a`, expected month, day, hhmm"),
            ("METRIC\n13 1 0 a b", "expected a month"),
            ("METRIC\n1 1 0 a b\n1 1 0 a b", "line 4: found `1 1 0 a b`, expected a time after"),
        ] {
            let refused = list(body).expect_err(expected);
            assert!(refused.contains("run.atm: ") && refused.contains(expected), "{refused}");
        }
    }
}
