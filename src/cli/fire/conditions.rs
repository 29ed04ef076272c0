//! Conditions of a fire, the columns of what follows from them, and tables: conditions in, the same with the fire's numbers
//! out.
//!
//! Numbers are the shortest decimals that read back as the same `f64`. A row is read, written and forgotten before the
//! next.

use std::path::Path;

use crate::cli::error::CliError;
use crate::cli::fire::calculators::number;
use crate::cli::fire::options::{
    AZIMUTHS_DEG, DEAD_MOISTURES, LIVE_MOISTURES, SLOPES, SlopeArguments, WINDS_MPS, no_such_fuel,
};
use crate::cli::number_table::{Column, Columns, Content, NumberTable, write_answers};
use wildfire_base::document::number::short;
use wildfire_base::geometry::compass;
use wildfire_base::object::Members;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::surface::{FuelBed, FuelMoisture, SurfaceFire, SurfaceOptions, WindLimit, flame_length_m};

/// The fuel, its moistures, the wind and the slope of a fire; the options of the model are apart.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    pub model: &'static FuelModel,
    pub moisture: FuelMoisture,
    pub wind_midflame_mps: f64,
    pub wind_from_deg: f64,
    pub slope: SlopeArguments,
}

impl Conditions {
    /// Returns the fuel as it burns.
    pub fn bed(&self, options: &SurfaceOptions) -> FuelBed {
        FuelBed::new(self.model, &self.moisture, options.curing)
    }

    pub fn burn(&self, options: &SurfaceOptions) -> SurfaceFire {
        let wind = compass::unit_from(self.wind_from_deg) * self.wind_midflame_mps;
        self.bed(options).behavior(wind, self.slope.gradient(), options)
    }
}

/// Names the moistures of fuel in percent.
pub fn moisture_text(&FuelMoisture { d1, d10, d100, herb, woody }: &FuelMoisture) -> String {
    let [d1, d10, d100, herb, woody] = [d1, d10, d100, herb, woody].map(|part| short(100.0 * part));
    format!("Moisture of dead fuel {d1}, {d10} and {d100} %, of live grass {herb} %, of live wood {woody} %")
}

/// A column of a fire, and one of a fire over an azimuth.
type FireColumn = (&'static str, fn(&SurfaceFire) -> f64);
type DirectionColumn = (&'static str, fn(&SurfaceFire, f64) -> f64);

pub const FIRE_COLUMNS: [FireColumn; 8] = [
    ("r0_m_min", |fire| fire.r0_mps * 60.0),
    ("i0_kw_m", |fire| fire.intensity_kw_m(fire.r0_mps)),
    ("r_m_min", |fire| fire.rate_mps * 60.0),
    ("azimuth_deg", |fire| compass::azimuth_deg(fire.heading.truncate())),
    ("intensity_kw_m", |fire| fire.intensity_kw_m(fire.rate_mps)),
    ("flame_m", |fire| flame_length_m(fire.intensity_kw_m(fire.rate_mps))),
    ("length_to_width", |fire| fire.length_to_width),
    ("eccentricity", |fire| fire.eccentricity),
];

/// The azimuth; the rate of a piece of the front that faces there, normal to itself;
/// the rate along a ray from the ignition, in the plane of the slope and on the map.
pub const DIRECTION_COLUMNS: [DirectionColumn; 4] = [
    ("azimuth_of_deg", |_, azimuth| azimuth),
    ("front_normal_m_min", |fire, azimuth| fire.front_normal_rate_mps(compass::unit_toward(azimuth)) * 60.0),
    ("ray_m_min", |fire, azimuth| fire.ray_rate_mps(compass::unit_toward(azimuth)) * 60.0),
    ("ray_horizontal_m_min", |fire, azimuth| 60.0 / fire.ellipse().travel_s(compass::unit_toward(azimuth))),
];

/// Returns a fire over one azimuth under the names of its columns.
pub fn direction(fire: &SurfaceFire, azimuth: f64) -> Members<&'static str, f64> {
    Members(DIRECTION_COLUMNS.map(|(name, value)| (name, value(fire, azimuth))).into())
}

/// The places of two columns among those that are read.
const NUMBER: usize = 0;
const WIND_LIMIT: usize = 10;

/// Writes the rows of a table of conditions, each with its fire, once or for each of the azimuths; returns the number of
/// rows that were read and of those in which nothing burns.
pub fn write_fires(
    input: &Path,
    output: &Path,
    options: &SurfaceOptions,
    azimuths: &[f64],
) -> Result<[u64; 2], CliError> {
    let mut added = FIRE_COLUMNS.map(|(name, _)| name).to_vec();
    if !azimuths.is_empty() {
        added.extend(DIRECTION_COLUMNS.map(|(name, _)| name));
    }
    let mut without_fire = 0;
    let rows = write_answers(input, output, columns(&added), |table, numbers| {
        let fire = fire(table, numbers, options)?;
        without_fire += u64::from(fire.rate_mps == 0.0);
        let values = FIRE_COLUMNS.map(|(_, value)| value(&fire).to_string()).join(",");
        if azimuths.is_empty() {
            return Ok(vec![values]);
        }
        // The fire's own numbers are written once for each azimuth, so every row can be read by itself.
        let along =
            azimuths.iter().map(|azimuth| DIRECTION_COLUMNS.map(|(_, value)| value(&fire, *azimuth).to_string()));
        Ok(along.map(|along| format!("{values},{}", along.join(","))).collect())
    })?;
    Ok([rows, without_fire])
}

fn columns<'a>(added: &'a [&'static str]) -> Columns<'a, 11> {
    Columns {
        read: [
            number("number", 0.0..=255.0),
            number("m_1h", DEAD_MOISTURES),
            number("m_10h", DEAD_MOISTURES),
            number("m_100h", DEAD_MOISTURES),
            number("m_live_herb", LIVE_MOISTURES),
            number("m_live_woody", LIVE_MOISTURES),
            number("wind_midflame_mps", WINDS_MPS),
            number("wind_from_deg", AZIMUTHS_DEG),
            number("slope_rise_run", SLOPES),
            number("aspect_deg", AZIMUTHS_DEG),
            Column { name: "wind_limit", content: Content::Number(0.0..=1.0), without: Some(f64::NAN) },
        ],
        row: "the conditions of a fire",
        added,
    }
}

/// Returns the fuel model of a row by its number.
pub fn fuel_model<const N: usize>(
    table: &NumberTable<N>,
    column: usize,
    number: f64,
) -> Result<&'static FuelModel, CliError> {
    let model = FuelModel::by_number(number as u8).filter(|_| number.fract() == 0.0);
    model.ok_or_else(|| table.refuse(column, no_such_fuel(&number.trunc().to_string())))
}

fn fire(table: &NumberTable<11>, numbers: &[f64; 11], options: &SurfaceOptions) -> Result<SurfaceFire, CliError> {
    let [number, d1, d10, d100, herb, woody, wind_midflame_mps, wind_from_deg, slope, aspect, wind_limit] = *numbers;
    let model = fuel_model(table, NUMBER, number)?;
    let wind_limit = match wind_limit {
        0.0 => WindLimit::None,
        1.0 => WindLimit::Rothermel1972,
        // The table has no such column.
        absent if absent.is_nan() => options.wind_limit,
        _ => return Err(table.refuse(WIND_LIMIT, "1 (rothermel-1972) or 0 (none)".to_owned())),
    };
    let conditions = Conditions {
        model,
        moisture: FuelMoisture { d1, d10, d100, herb, woody },
        wind_midflame_mps,
        wind_from_deg,
        slope: SlopeArguments { slope, aspect },
    };
    Ok(conditions.burn(&SurfaceOptions { wind_limit, ..*options }))
}
