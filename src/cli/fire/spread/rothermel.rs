//! `wildfire fire spread` by Rothermel's equations: burns, writes the files, reports.

use std::path::Path;
use std::sync::Arc;

use super::ground::GroundSources;
use super::report::SpreadReport;
use super::{SpreadArguments, perimeters};
use crate::cli::error::CliError;
use crate::cli::map_of;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::terminal;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::Landscape;
use wildfire_fire::lone::LoneFire;
use wildfire_fire::models::RothermelRules;
use wildfire_grid::map_files::raster;
use wildfire_grid::map_files::write_npy;
use wildfire_picture::{FieldMap, MapQuantity, draw_field_maps, ground_covers};
use wildfire_timeline::{Cause, FireBehavior};

/// Lets a fire spread by Rothermel's equations.
pub fn run(arguments: &SpreadArguments, quiet: bool) -> Result<(), CliError> {
    let sources = GroundSources::new(arguments)?;
    let inputs = sources.rasters.iter().map(|&(_, path)| path).chain(
        [
            &arguments.fuel_models,
            &arguments.wind_speed,
            &arguments.wind_from,
            &arguments.wind_list,
            &arguments.moisture_file,
            &arguments.adjustment_file,
        ]
        .into_iter()
        .filter_map(|file| file.as_deref()),
    );
    let inputs = inputs.chain(arguments.moisture_raster.iter().map(|(_, path)| path.as_path())).collect();
    let format = raster_format(arguments.arrival.as_deref());
    let times_s = arguments.perimeters.times_s(arguments.duration)?;
    let stream = Files { inputs, form: arguments.form, ..Files::default() }
        .writing([
            (format, &arguments.arrival),
            (Format::Tif, &arguments.bands),
            (Format::Png, &arguments.png),
            (Format::GeoJson, &arguments.perimeters.perimeters),
            (raster_format(arguments.canopy.fire_type.as_deref()), &arguments.canopy.fire_type),
        ])
        .check()?;
    let ground = sources.read(arguments)?;
    let ignitions = ignitions(arguments, &ground.landscape)?;
    let rules = RothermelRules {
        options: arguments.choices.options(),
        neighbours: arguments.neighbours,
        crowns: arguments.canopy.rules(),
        ..RothermelRules::default()
    };
    let landscape = Arc::clone(&ground.landscape);
    if !quiet {
        ground.doubts.iter().for_each(|doubt| terminal::note(doubt));
    }
    let weather = Arc::clone(&ground.weather);
    let mut fire = LoneFire::new(Arc::clone(&landscape), Arc::clone(&weather), rules, &ignitions);
    // Only the fire is timed: reading rasters depends on the disk.
    let mut stopwatch = CpuStopwatch::start();
    fire.burn_until(SimTime::from_seconds(arguments.duration));
    let cpu = stopwatch.elapsed_since_last();
    let fire_types: Vec<f64> = match &landscape.canopy {
        Some(_) => (0..landscape.frame.cell_count())
            .map(|index| fire.fire_type(landscape.frame.cell(index)).map_or(f64::NAN, |kind| f64::from(kind as u8)))
            .collect(),
        None => Vec::new(),
    };
    let cells = (0..landscape.frame.cell_count()).map(|index| landscape.frame.cell(index));
    // Times beyond the end count too: the perimeter runs between a cell that burned and one that fire reaches later.
    let expected: Vec<f64> =
        cells.map(|cell| fire.expected_arrival(cell).map_or(f64::NAN, SimTime::as_seconds)).collect();
    let perimeter_m = perimeters::perimeter_m(landscape.frame, &expected, arguments.duration);
    let report = SpreadReport::new(arguments, &ground, &mut fire, &ignitions, cpu, &fire_types, perimeter_m);
    let arrivals = || {
        (0..landscape.frame.cell_count())
            .map(|index| fire.arrival(landscape.frame.cell(index)).map_or(f64::NAN, SimTime::as_seconds))
            .collect::<Vec<f64>>()
    };
    let write_raster = |path: &Path, values: &[f64]| {
        let format = raster_format(Some(path));
        if format == Format::Npy {
            return write_npy(path, &map_of::array(landscape.frame, values));
        }
        let raster = map_of::raster(&ground.place, landscape.frame, values);
        if format == Format::Tif { raster::write_geotiff(path, &raster) } else { raster::write_asc(path, &raster) }
    };
    let write_bands = |path: &Path| {
        let cells = (0..landscape.frame.cell_count()).map(|index| landscape.frame.cell(index));
        let ignitions = cells.map(|cell| {
            let parent = fire.parent(cell)?;
            Some((fire.arrival(cell)?, if parent == cell { Cause::Scheduled } else { Cause::Spread(parent) }))
        });
        let ignitions: Vec<_> = ignitions.collect();
        let behavior = FireBehavior::new(&landscape, &weather, &rules, &ignitions);
        ground.place.write_bands(path, landscape.frame, &arrivals(), &behavior)
    };
    let draw = |path: &Path| {
        let ignited: Vec<Cell> = ignitions.iter().map(|&(_, cell)| cell).collect();
        let map = FieldMap {
            title: &report.title(),
            frame: landscape.frame,
            quantity: MapQuantity::ArrivalTime,
            values: &arrivals(),
            without_value: "not burned",
            covers: &ground_covers(&landscape),
            landscape: Some(&landscape),
            ignitions: &ignited,
            has_contours: true,
        };
        draw_field_maps("", &[map]).write_png(path)
    };
    let printed = stream.print(&arguments.form.render(&report));
    let written = output_files::write_all(
        &[
            (arguments.arrival.as_deref(), &|path| write_raster(path, &arrivals())),
            (arguments.bands.as_deref(), &write_bands),
            (arguments.canopy.fire_type.as_deref(), &|path| write_raster(path, &fire_types)),
            (arguments.perimeters.perimeters.as_deref(), &|path| perimeters::write(path, &ground, &expected, &times_s)),
            (arguments.png.as_deref(), &draw),
        ],
        quiet,
    );
    printed.and(written)
}

fn raster_format(path: Option<&Path>) -> Format {
    let ending = path.and_then(Path::extension).unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("tif" | "tiff") => Format::Tif,
        Some("npy") => Format::Npy,
        _ => Format::Asc,
    }
}

/// Returns what is lit when, if it burns.
fn ignitions(arguments: &SpreadArguments, landscape: &Landscape) -> Result<Vec<(SimTime, Cell)>, CliError> {
    let ignitions = arguments.ignitions(landscape.frame)?.into_iter().map(|start| {
        let fuel = landscape.fuel_number(start.cell);
        if landscape.burning_model(start.cell).is_some() {
            return Ok((SimTime::from_seconds(start.seconds), start.cell));
        }
        let Cell { col, row } = start.cell;
        let sentence = match landscape.fuel_model(fuel) {
            Some(model) => format!("--ignite {row},{col}: this cell cannot burn, its fuel is {fuel}, {}", model.name),
            None => format!("--ignite {row},{col}: this cell cannot burn, it has no fuel"),
        };
        Err(CliError::bad_input(sentence, Some("rows count from the south, from 0")))
    });
    ignitions.collect()
}
