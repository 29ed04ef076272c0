//! The wind as scenarios write it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::wind_raster::PackedWind;
use wildfire_base::geometry::{DVec2, compass};
use wildfire_base::ranges;

/// The fastest wind, m/s: twice that of the strongest hurricanes.
pub(crate) const MAX_WIND_MPS: f64 = 150.0;

/// Wind from a time on: everywhere the same, or by rasters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WindChange {
    #[serde(default)]
    pub at_s: f64,
    /// Speed at 10 m above the ground. Loading fills in the mean of rasters.
    #[serde(default = "absent")]
    pub speed_mps: f64,
    /// Direction it blows to, counter-clockwise from east.
    #[serde(default = "absent")]
    pub toward_deg: f64,
    /// A raster of speeds at 10 m, with `from` or `toward`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<PathBuf>,
    /// A raster of azimuths, clockwise from north, that the wind blows from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<PathBuf>,
    /// A raster of azimuths that it blows to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub toward: Option<PathBuf>,
    /// Rasters of its components, or one with both as bands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub east: Option<PathBuf>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub north: Option<PathBuf>,
    /// Unit and height of rasters that state no unit.
    #[serde(default, skip_serializing_if = "WindUnits::is_si")]
    pub units: WindUnits,
    /// The wind of the rasters by cell. Loading fills it in.
    #[serde(rename = "given", default, skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub imported: Option<PackedWind>,
}

/// What is absent is told by it from every number that can be written.
fn absent() -> f64 {
    f64::NAN
}

/// Units and heights of wind rasters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WindUnits {
    /// Metres per second at 10 m.
    #[default]
    Si,
    /// Miles per hour at 20 ft, as WindNinja's files for FARSITE.
    English,
    /// Kilometres per hour at 10 m.
    Metric,
}

impl WindUnits {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
    fn is_si(&self) -> bool {
        *self == Self::Si
    }
}

ranges! { WindChange { at_s: 0.0..=1e6, speed_mps: 0.0..=MAX_WIND_MPS, toward_deg: -360.0..=360.0 } }

impl WindChange {
    /// Creates a wind that is everywhere the same.
    pub fn uniform(at_s: f64, speed_mps: f64, toward_deg: f64) -> Self {
        let units = WindUnits::Si;
        let [speed, from, toward, east, north] = [const { None }; 5];
        Self { at_s, speed_mps, toward_deg, speed, from, toward, east, north, units, imported: None }
    }

    /// Where it blows to, exact along the axes: an angle from east against the clock is an azimuth from north with it.
    pub(crate) fn vector(&self) -> DVec2 {
        compass::unit_toward(90.0 - self.toward_deg) * self.speed_mps
    }
}
