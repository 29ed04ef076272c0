//! The rates of a fire over one azimuth, of which `wildfire fire behavior` lists many.

use serde::Serialize;

use wildfire_base::geometry::compass;
use wildfire_fire::surface::SurfaceFire;

/// Rates of a fire over one azimuth.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Direction {
    /// Compass azimuth, in degrees.
    pub azimuth_of_deg: f64,
    /// The rate of a piece of the front that faces there, normal to itself, in m/min.
    pub front_normal_m_min: f64,
    /// The rate along a ray from the ignition, in the plane of the slope, in m/min.
    pub ray_m_min: f64,
    /// The same rate on the map.
    pub ray_horizontal_m_min: f64,
}

impl Direction {
    pub fn new(fire: &SurfaceFire, azimuth_of_deg: f64) -> Self {
        let toward = compass::unit_toward(azimuth_of_deg);
        Self {
            azimuth_of_deg,
            front_normal_m_min: fire.front_normal_rate_mps(toward) * 60.0,
            ray_m_min: fire.ray_rate_mps(toward) * 60.0,
            ray_horizontal_m_min: 60.0 / fire.ellipse().travel_s(toward),
        }
    }
}
