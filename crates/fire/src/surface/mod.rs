//! Rothermel's equations: how fast a fire on the ground goes, how hot it is, and what the wind and the slope do to it.
//!
//! A [`FuelBed`] is a fuel model with moistures; its [`FuelBed::behavior`] under a wind and on a slope is a
//! [`SurfaceFire`], whose spread from a point is an [`Ellipse`].
//!
//! Outside of this module lengths are metres, times seconds, moistures fractions of dry weight, slopes rise over run; wind
//! vectors point where the wind blows, x east, y north. Inside, the equations are in feet, pounds, Btu and minutes, in
//! which they were fitted, and what comes out is converted once.
//!
//! Sources: Rothermel, "A mathematical model for predicting fire spread in wildland fuels", USDA Forest Service INT-115,
//! 1972 (numbers of equations are his), with the changes of Albini, INT-30, 1976; Andrews, "The Rothermel surface fire
//! spread model and associated developments", RMRS-GTR-371, 2018. Further ones are named where they are used.

mod behavior;
pub mod crown;
mod ellipse;
mod fuel_bed;
mod wind_adjustment;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use wildfire_base::geometry::Cell;
use wildfire_base::ranges;
use wildfire_base::time::SimTime;

use crate::{Landscape, Weather};

pub(crate) use behavior::length_to_width;
pub use behavior::{SurfaceFire, flame_length_m};
pub use ellipse::Ellipse;
pub use fuel_bed::{FuelBed, FuelState};
pub use wind_adjustment::{sheltered_adjustment, twenty_foot_wind, unsheltered_adjustment};

/// Metres in a foot and joules in a Btu.
const FOOT_M: f64 = 0.3048;
const BTU_J: f64 = 1_055.055_852_62;
/// Metres per second in a foot per minute.
const FOOT_PER_MINUTE: f64 = FOOT_M / 60.0;

/// Computes the surface fire of a cell at a time, under a wind that no trees shelter; `None` where nothing burns.
pub fn surface_fire(
    landscape: &Landscape,
    weather: &Weather,
    options: &SurfaceOptions,
    cell: Cell,
    time: SimTime,
) -> Option<SurfaceFire> {
    let model = landscape.burning_model(cell)?;
    let weather = weather.at_cell(time, landscape.frame.index(cell));
    let midflame = twenty_foot_wind(1.0) * unsheltered_adjustment(model.depth_ft) * weather.wind_mps;
    let bed = FuelBed::new(model, &weather.moisture, options.curing);
    Some(bed.behavior(midflame, landscape.gradient(cell), options))
}

/// Moistures of the classes of fuel, as fractions of the dry weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FuelMoisture {
    /// Of dead fuel that dries in an hour: grass, needles, twigs to 6 mm.
    pub d1: f64,
    /// Of dead fuel that takes ten hours, 6 to 25 mm.
    pub d10: f64,
    /// Of dead fuel that takes a hundred hours, 25 to 76 mm.
    pub d100: f64,
    /// Of live grass and herbs.
    pub herb: f64,
    /// Of live twigs and leaves of shrubs.
    pub woody: f64,
}

// A live plant may hold more than three times its dry weight in water.
ranges! { FuelMoisture { d1: 0.0..=1.0, d10: 0.0..=1.0, d100: 0.0..=1.0, herb: 0.0..=5.0, woody: 0.0..=5.0 } }

impl Default for FuelMoisture {
    /// A dry summer day with grass that is two thirds cured.
    fn default() -> Self {
        Self { d1: 0.06, d10: 0.07, d100: 0.08, herb: 0.60, woody: 0.90 }
    }
}

/// Selects the line by which live grass of low moisture counts as dead, in models that are dynamic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Curing {
    /// From all live at 120 % to all dead at 30 % (Scott and Burgan, 2005).
    #[default]
    Exact,
    /// The same with the rounded numbers of BEHAVE: 1.333 - 1.11 times the moisture.
    Behave,
}

/// Selects how wind and slope are added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Combine {
    /// As vectors in the plane of the slope, onto which the wind is lifted (ELMFIRE, pyretechnics).
    #[default]
    Plane,
    /// As horizontal vectors (BEHAVE).
    Flat,
}

/// Selects the limit beyond which more wind does not speed up the fire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum WindLimit {
    #[serde(rename = "none")]
    None,
    /// 0.9 times the reaction intensity (86).
    #[default]
    #[serde(rename = "rothermel-1972")]
    Rothermel1972,
    /// 96.8 times the cube root of the reaction intensity (Andrews, Cruz, Rothermel, 2013).
    #[serde(rename = "andrews-2013")]
    Andrews2013,
}

/// Selects how the shape of a fire follows from the wind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LengthToWidth {
    /// Anderson, INT-305, 1983, at most 8.
    #[default]
    #[serde(rename = "anderson-1983")]
    Anderson1983,
    /// One, plus a quarter for each mile per hour.
    #[serde(rename = "linear")]
    Linear,
}

/// Choices on which programs for fire behavior differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SurfaceOptions {
    pub curing: Curing,
    pub combine: Combine,
    pub wind_limit: WindLimit,
    pub length_to_width: LengthToWidth,
}
