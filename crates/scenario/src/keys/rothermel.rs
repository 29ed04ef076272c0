//! Fire by Rothermel's equations in a scenario: what grows, how moist it is, and choices on which programs differ.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::site::fuel_name::FuelName;
use crate::site::moisture::{ImportedMoisture, MoistureRasters, RateFactor};
use wildfire_base::ranges;
use wildfire_fire::models::Neighbours;
use wildfire_fire::surface::{Combine, Curing, FuelMoisture, LengthToWidth, SurfaceOptions, WindLimit};

/// The fire model `rothermel`: a front that spreads through all fuel.
///
/// Angles are degrees counter-clockwise from east, as everywhere in scenarios; files of slope and aspect have compass
/// azimuths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RothermelSettings {
    /// The fuel between the bushes: code or number of a fuel model, or `"none"`.
    pub ground: FuelName,
    /// The fuel of the bushes.
    pub bushes: FuelName,
    /// A raster of numbers of fuel models, for all cells without a bush, instead of `ground`.
    pub fuel_map: Option<PathBuf>,
    /// A raster of elevations in metres.
    pub elevation: Option<PathBuf>,
    /// Rasters of the slope in degrees and of the azimuth that it faces, instead of `elevation`.
    pub slope: Option<PathBuf>,
    pub aspect: Option<PathBuf>,
    /// The slope of the whole field where there is no raster, and the direction uphill.
    pub slope_deg: f64,
    pub uphill_deg: f64,
    /// Moistures of the fuel, as fractions of its dry weight.
    pub moisture: FuelMoisture,
    /// Moistures by fuel model, in a file of FARSITE (`.fms`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moisture_file: Option<PathBuf>,
    /// Rasters of moisture in percent, of some classes or all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moisture_rasters: Option<MoistureRasters>,
    /// Factors on the rate of spread by fuel model, in a file of FARSITE (`.adj`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adjustment_file: Option<PathBuf>,
    /// What the files of moisture say. Loading fills it in.
    #[serde(rename = "given_moisture", skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub imported_moisture: Option<ImportedMoisture>,
    /// The factors of the file. Loading fills them in.
    #[serde(rename = "given_factors", skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip)]
    pub imported_factors: Vec<RateFactor>,
    pub curing: Curing,
    pub combine: Combine,
    pub wind_limit: WindLimit,
    pub length_to_width: LengthToWidth,
    /// Neighbours that fire reaches from a cell in a straight line: 8, 16 or 32.
    pub neighbours: Neighbours,
    /// Adds directions between these where a fire is too narrow for them.
    pub refined: bool,
    /// Duration for which a truck's stop wets cells within reach that are not burning; 0: none.
    pub wet_s: f64,
    /// Lets Wumpuses light ground as well as bushes.
    pub lights_ground: bool,
}

impl Default for RothermelSettings {
    fn default() -> Self {
        let SurfaceOptions { curing, combine, wind_limit, length_to_width } = SurfaceOptions::default();
        Self {
            ground: FuelName::from_code("GR2"),
            bushes: FuelName::from_code("SH5"),
            fuel_map: None,
            elevation: None,
            slope: None,
            aspect: None,
            slope_deg: 0.0,
            uphill_deg: 0.0,
            moisture: FuelMoisture::default(),
            moisture_file: None,
            moisture_rasters: None,
            adjustment_file: None,
            imported_moisture: None,
            imported_factors: Vec::new(),
            curing,
            combine,
            wind_limit,
            length_to_width,
            neighbours: Neighbours::ThirtyTwo,
            refined: true,
            wet_s: 120.0,
            lights_ground: false,
        }
    }
}

impl RothermelSettings {
    /// Returns the choices as the equations take them.
    pub fn options(&self) -> SurfaceOptions {
        let Self { curing, combine, wind_limit, length_to_width, .. } = *self;
        SurfaceOptions { curing, combine, wind_limit, length_to_width }
    }
}

ranges! { RothermelSettings { slope_deg: 0.0..=60.0, uphill_deg: -360.0..=360.0, wet_s: 0.0..=1e6; moisture } }
