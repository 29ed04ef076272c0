//! Fire behavior row by row: a table of conditions in, the same with the fire's numbers out.
//!
//! Numbers are the shortest decimals that read back as the same `f64`. A row is read, written and forgotten before the
//! next.

use std::io::{self, Write};
use std::path::Path;

use crate::cli::error::CliError;
use crate::cli::fire::direction::Direction;
use crate::cli::fire::options::{AZIMUTHS_DEG, DEAD_MOISTURES, LIVE_MOISTURES, SLOPES, WINDS_MPS, no_such_fuel};
use crate::cli::number_table::{Column, Columns, NumberTable};
use wildfire_base::geometry::compass;
use wildfire_base::whole_file::WholeFile;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::surface::{FuelBed, FuelMoisture, SurfaceFire, SurfaceOptions, WindLimit, flame_length_m};

/// Columns that are written after all that are there.
const ADDED: [&str; 8] =
    ["r0_m_min", "i0_kw_m", "r_m_min", "azimuth_deg", "intensity_kw_m", "flame_m", "length_to_width", "eccentricity"];
/// Columns that are written after these where azimuths are asked for.
const OF_AZIMUTH: [&str; 4] = ["azimuth_of_deg", "front_normal_m_min", "ray_m_min", "ray_horizontal_m_min"];

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
    let unwritable = |error: io::Error| CliError::unwritable(output, &error);
    let added: Vec<&'static str> =
        ADDED.into_iter().chain(OF_AZIMUTH.into_iter().filter(|_| !azimuths.is_empty())).collect();
    let mut conditions = NumberTable::open(input, columns(&added))?;
    let mut table = WholeFile::create(output).map_err(unwritable)?;
    write_row(&mut table, conditions.row(), format_args!("{}", added.join(","))).map_err(unwritable)?;
    let [mut rows, mut without_fire] = [0; 2];
    while let Some(numbers) = conditions.next()? {
        let fire = fire(&conditions, &numbers, options)?;
        let values = head_values(&fire).map(|value| value.to_string()).join(",");
        if azimuths.is_empty() {
            write_row(&mut table, conditions.row(), format_args!("{values}")).map_err(unwritable)?;
        }
        for &azimuth in azimuths {
            let Direction { azimuth_of_deg, front_normal_m_min, ray_m_min, ray_horizontal_m_min } =
                Direction::new(&fire, azimuth);
            let of_azimuth = format!("{azimuth_of_deg},{front_normal_m_min},{ray_m_min},{ray_horizontal_m_min}");
            write_row(&mut table, conditions.row(), format_args!("{values},{of_azimuth}")).map_err(unwritable)?;
        }
        rows += 1;
        without_fire += u64::from(fire.rate_mps == 0.0);
    }
    table.finish().map_err(unwritable)?;
    Ok([rows, without_fire])
}

fn write_row(table: &mut WholeFile, row: &[u8], added: std::fmt::Arguments) -> io::Result<()> {
    table.write_all(row)?;
    writeln!(table, ",{added}")
}

fn columns<'a>(added: &'a [&'static str]) -> Columns<'a, 11> {
    let column = |name, range| Column { name, range, without: None };
    Columns {
        read: [
            column("number", 0.0..=255.0),
            column("m_1h", DEAD_MOISTURES),
            column("m_10h", DEAD_MOISTURES),
            column("m_100h", DEAD_MOISTURES),
            column("m_live_herb", LIVE_MOISTURES),
            column("m_live_woody", LIVE_MOISTURES),
            column("wind_midflame_mps", WINDS_MPS),
            column("wind_from_deg", AZIMUTHS_DEG),
            column("slope_rise_run", SLOPES),
            column("aspect_deg", AZIMUTHS_DEG),
            Column { name: "wind_limit", range: 0.0..=1.0, without: Some(f64::NAN) },
        ],
        row: "the conditions of a fire",
        added,
    }
}

fn fire(table: &NumberTable<11>, numbers: &[f64; 11], options: &SurfaceOptions) -> Result<SurfaceFire, CliError> {
    let [number, d1, d10, d100, herb, woody, wind_mps, wind_from, slope, aspect, wind_limit] = *numbers;
    let model = FuelModel::by_number(number as u8).filter(|_| number.fract() == 0.0);
    let model = model.ok_or_else(|| table.refuse(NUMBER, no_such_fuel(&number.trunc().to_string())))?;
    let wind_limit = match wind_limit {
        0.0 => WindLimit::None,
        1.0 => WindLimit::Rothermel1972,
        // The table has no such column.
        absent if absent.is_nan() => options.wind_limit,
        _ => return Err(table.refuse(WIND_LIMIT, "1 (rothermel-1972) or 0 (none)".to_owned())),
    };
    let options = SurfaceOptions { wind_limit, ..*options };
    let bed = FuelBed::new(model, &FuelMoisture { d1, d10, d100, herb, woody }, options.curing);
    let wind = compass::unit_from(wind_from) * wind_mps;
    Ok(bed.behavior(wind, compass::unit_from(aspect) * slope, &options))
}

/// The values of [`ADDED`].
fn head_values(fire: &SurfaceFire) -> [f64; ADDED.len()] {
    let intensity = fire.intensity_kw_m(fire.rate_mps);
    [
        fire.r0_mps * 60.0,
        fire.intensity_kw_m(fire.r0_mps),
        fire.rate_mps * 60.0,
        compass::azimuth_deg(fire.heading.truncate()),
        intensity,
        flame_length_m(intensity),
        fire.length_to_width,
        fire.eccentricity,
    ]
}
