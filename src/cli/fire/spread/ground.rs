//! The ground that a fire spreads on: from rasters, or alike everywhere.

use std::path::Path;
use std::sync::Arc;

use super::SpreadArguments;
use crate::cli::error::CliError;
use crate::cli::fire::options::no_such_fuel;
use crate::cli::map_of::EarthPlace;
use wildfire_base::geometry::FieldFrame;
use wildfire_fire::fuel::CustomFuels;
use wildfire_fire::lone::LoneFire;
use wildfire_fire::{Landscape, MoistureZones, Relief, Weather};
use wildfire_scenario::{
    FuelName, ImportedLayers, LayerKind, LayerReader, MoistureShift, bytes_text, rate_factors, read_fuels,
    read_rate_factors,
};

/// Where the ground is read from.
pub struct GroundSources<'a> {
    /// The fuel that is everywhere, where no raster has fuels.
    fuel: u8,
    pub rasters: Vec<(LayerKind, &'a Path)>,
    custom_fuels: CustomFuels,
}

/// A landscape with its place on earth.
pub struct GroundOnEarth {
    pub landscape: Arc<Landscape>,
    pub weather: Arc<Weather>,
    pub place: EarthPlace,
    /// Which bands were taken for what.
    pub bands: Vec<String>,
    /// Moisture by place in a sentence, where files give it.
    pub moisture: Option<String>,
    /// What of the rasters may have been misread or was left out, in sentences.
    pub doubts: Vec<String>,
}

impl<'a> GroundSources<'a> {
    pub fn new(arguments: &'a SpreadArguments) -> Result<Self, CliError> {
        let Some(name) = &arguments.fuel else {
            let help = "such as --fuel GR2; wildfire fire behavior --list-fuels prints all fuel models";
            return Err(CliError::bad_input("--fuel is missing; expected a fuel model or a raster", Some(help)));
        };
        let elevation = arguments.elevation.as_deref().map(|path| (LayerKind::Elevation, path));
        let mut rasters: Vec<_> = elevation.into_iter().chain(arguments.canopy.rasters()).collect();
        let custom_fuels = match &arguments.fuel_models {
            Some(path) => read_fuels(path).and_then(CustomFuels::new).map_err(|it| CliError::bad_input(it, None))?,
            None => CustomFuels::default(),
        };
        let fuel = FuelName::parse(name.trim()).map(FuelName::number);
        if let Some(fuel) = fuel.filter(|&number| custom_fuels.model(number).is_some()) {
            return Ok(Self { fuel, rasters, custom_fuels });
        }
        let path = Path::new(name);
        if path.extension().is_some() || path.exists() {
            rasters.insert(0, (LayerKind::Fuel, path));
            return Ok(Self { fuel: 0, rasters, custom_fuels });
        }
        let expected = no_such_fuel(name);
        let sentence = format!("--fuel {name}: expected {expected}, or a raster (.asc, .tif)");
        Err(CliError::bad_input(sentence, Some("wildfire fire behavior --list-fuels prints all fuel models")))
    }

    /// Reads the rasters, whose sides and cells must be those that were given.
    pub fn read(&self, arguments: &SpreadArguments) -> Result<GroundOnEarth, CliError> {
        let refused = |sentence: String| CliError::bad_input(sentence, None);
        let mut layers = LayerReader::new(self.custom_fuels.clone());
        for &(kind, path) in &self.rasters {
            layers.read(kind, path).map_err(refused)?;
        }
        let layers = layers.finish();
        let frame = layers.as_ref().map_or_else(|| arguments.frame(), |layers| layers.frame);
        // The frame is known only now, and nothing large has been taken for the fire yet.
        check_memory(&frame, arguments)?;
        let requested = [arguments.rows.map(f64::from), arguments.cols.map(f64::from), arguments.cell];
        let actual = [frame.rows.into(), frame.cols.into(), frame.cell_m];
        for ((name, requested), actual) in ["--rows", "--cols", "--cell"].into_iter().zip(requested).zip(actual) {
            if let Some(requested) = requested.filter(|&requested| requested != actual) {
                return Err(refused(format!("{name} is {requested}, expected {actual} as in the raster")));
            }
        }
        let fuel = layers.as_ref().map(|layers| layers.fuel_or(self.fuel));
        let relief = layers.as_ref().and_then(ImportedLayers::relief);
        let canopy = arguments.canopy.trees(frame.cell_count(), layers.as_ref());
        let mut landscape = Landscape {
            frame,
            fuel: fuel.unwrap_or_else(|| vec![self.fuel; frame.cell_count()]),
            relief: relief.unwrap_or_else(|| Relief::Plane(arguments.slope.gradient())),
            canopy,
            custom_fuels: self.custom_fuels.clone(),
            rate_factors: Vec::new(),
        };
        if let Some(path) = &arguments.adjustment_file {
            landscape.rate_factors = rate_factors(&landscape.fuel, &read_rate_factors(path).map_err(refused)?, &[]);
        }
        let mut weather = arguments.weather_on(&frame, layers.as_ref())?;
        let mut moisture = Vec::new();
        if let Some(imported) = arguments.local_moisture(&landscape, layers.as_ref())? {
            let zones = imported.zones(&landscape, arguments.moisture, MoistureShift::NONE).ok_or_else(|| {
                let max = MoistureZones::MAX;
                refused(format!("--moisture-raster: expected at most {max} different moistures; use coarser values"))
            })?;
            weather = weather.with_moisture_zones(zones);
            moisture = imported.describe(frame.cell_count());
        }
        let place = layers.as_ref().map_or_else(EarthPlace::default, EarthPlace::from_layers);
        let (bands, mut doubts) = layers.map_or_else(Default::default, |layers| (layers.bands, layers.doubts));
        doubts.extend(moisture.drain(moisture.len().min(1)..));
        let moisture = moisture.pop();
        let weather = Arc::new(weather);
        Ok(GroundOnEarth { landscape: Arc::new(landscape), weather, place, bands, moisture, doubts })
    }
}

/// Refuses a field on which a fire takes more memory than it may.
fn check_memory(frame: &FieldFrame, arguments: &SpreadArguments) -> Result<(), CliError> {
    // The bands are in memory in double precision and in single.
    let bands = if arguments.bands.is_some() { 128 * frame.cell_count() as u64 } else { 0 };
    let needed = LoneFire::max_bytes(frame) + bands;
    let limit = arguments.memory.unwrap_or_default();
    if needed <= limit.bytes {
        return Ok(());
    }
    let sentence = format!(
        "a fire on {} rows and {} columns would take up to {} of memory; the limit is {limit}",
        frame.rows,
        frame.cols,
        bytes_text(needed)
    );
    let help = "raise the limit with --memory, or cut out a part with gdal_translate -srcwin COL ROW COLS ROWS in.tif \
        out.tif";
    Err(CliError::bad_input(sentence, Some(help)))
}
