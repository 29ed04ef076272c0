//! The wind as scenarios write it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::geometry::{DVec2, compass};
use wildfire_base::ranges;

/// The fastest wind, m/s: twice that of the strongest hurricanes.
pub(crate) const MAX_WIND_MPS: f64 = 150.0;

/// Wind from a time on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WindChange {
    #[serde(default)]
    pub at_s: f64,
    /// Speed at 10 m above the ground.
    pub speed_mps: f64,
    /// Direction it blows to, counter-clockwise from east.
    pub toward_deg: f64,
}

ranges! { WindChange { at_s: 0.0..=1e6, speed_mps: 0.0..=MAX_WIND_MPS, toward_deg: -360.0..=360.0 } }

impl WindChange {
    /// Where it blows to, exact along the axes: an angle from east against the clock is an azimuth from north with it.
    pub(crate) fn vector(&self) -> DVec2 {
        compass::unit_toward(90.0 - self.toward_deg) * self.speed_mps
    }
}
