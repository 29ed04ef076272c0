//! The truck's body and how it moves: dimensions, footprint, Ackermann steering, exact paths, shortest curves.
//!
//! Body frame: origin in the middle of the rear axle, x forward, y left.

pub mod curve;
pub mod dubins;
mod path;
pub mod reeds_shepp;
mod steering;

pub use dubins::Dubins;
pub use path::{Path, Segment};
pub use reeds_shepp::{CurvePrice, ReedsShepp};
pub use steering::{STEERING_STEP_S, SteeringLimits};

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::{OrientedRect, Pose, ops};
use crate::or_none;
use crate::ranges::{OutOfRange, check_range};

/// The largest steering angle, degrees: beyond it front wheels push the truck sideways rather than turn it.
const MAX_STEERING_DEG: f64 = 60.0;

/// The distance by which the front axle may be ahead of the body through rounding, metres.
const ROUNDING_M: f64 = 1e-9;

/// Dimensions of a truck with Ackermann steering, in metres. The default is the contest's Unimog.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Dimensions {
    /// Overall length, bumper to bumper.
    pub length_m: f64,
    /// Overall width.
    pub width_m: f64,
    /// Distance between the axles.
    pub wheelbase_m: f64,
    /// From the rear axle to the rear bumper.
    pub rear_overhang_m: f64,
    /// Smallest radius that the middle of the rear axle can drive.
    pub turning_radius_m: f64,
    /// Turning rate of the front wheels in degrees per second; `"none"`: at once.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub steering_rate_deg_s: Option<f64>,
}

impl Default for Dimensions {
    fn default() -> Self {
        Self {
            length_m: 4.9,
            width_m: 2.2,
            wheelbase_m: 3.0,
            rear_overhang_m: 0.95,
            turning_radius_m: 13.0,
            steering_rate_deg_s: None,
        }
    }
}

crate::ranges! { Dimensions {
    length_m: 0.1..=100.0, width_m: 0.1..=100.0, turning_radius_m: 0.1..=10_000.0, steering_rate_deg_s: 1.0..=1000.0,
} and |dimensions, _| dimensions.check_body() }

impl Dimensions {
    /// Checks that the axles are under the body, and that its steering reaches its turning radius.
    fn check_body(&self) -> Result<(), OutOfRange> {
        check_range("rear_overhang_m", self.rear_overhang_m, 0.0..=self.length_m)?;
        check_range("wheelbase_m", self.wheelbase_m, 0.1..=self.length_m)?;
        let room = self.length_m - self.rear_overhang_m;
        if self.rear_overhang_m + self.wheelbase_m > self.length_m + ROUNDING_M {
            let expected = format!("a front axle under the body, at most {room} m ahead of the rear axle");
            return Err(OutOfRange::new("wheelbase_m", self.wheelbase_m, expected));
        }
        if self.turning_radius_m < 0.5 * self.width_m {
            let expected = "a centre of turning outside the body, at least half the width away".into();
            return Err(OutOfRange::new("turning_radius_m", self.turning_radius_m, expected));
        }
        if self.max_steering_rad().to_degrees() > MAX_STEERING_DEG {
            let min_m = self.wheelbase_m / ops::tan(MAX_STEERING_DEG.to_radians());
            let expected = format!("at least {min_m:.3}, which steering by {MAX_STEERING_DEG} degrees gives");
            return Err(OutOfRange::new("turning_radius_m", self.turning_radius_m, expected));
        }
        Ok(())
    }

    /// From the rear axle forward to the body's centre.
    pub fn centre_offset_m(&self) -> f64 {
        0.5 * self.length_m - self.rear_overhang_m
    }

    /// World position of the body's centre for a pose of the rear axle.
    #[inline]
    pub fn body_centre(&self, pose: Pose) -> DVec2 {
        pose.position() + pose.direction() * self.centre_offset_m()
    }

    /// The body's outline for a pose of the rear axle.
    pub fn footprint(&self, pose: Pose) -> OrientedRect {
        let centre = self.body_centre(pose);
        OrientedRect {
            centre: Pose { x: centre.x, y: centre.y, heading: pose.heading },
            half_length: 0.5 * self.length_m,
            half_width: 0.5 * self.width_m,
        }
    }

    /// Steering angle of the bicycle model at the smallest radius, in radians.
    pub fn max_steering_rad(&self) -> f64 {
        ops::atan(self.wheelbase_m / self.turning_radius_m)
    }

    /// Returns the limit of its steering, if it has one.
    pub fn steering_limits(&self) -> Option<SteeringLimits> {
        self.steering_rate_deg_s
            .map(|rate| SteeringLimits { rate_rad_s: rate.to_radians(), wheelbase_m: self.wheelbase_m })
    }

    /// Returns the metres that the fastest point of the body moves for a metre of the rear axle: on an arc, the distance
    /// of the farthest point from the turning centre, over the radius.
    pub fn farthest_point_rate(&self, curvature: f64) -> f64 {
        if curvature == 0.0 {
            return 1.0;
        }
        let reach = self.rear_overhang_m.abs().max((self.length_m - self.rear_overhang_m).abs());
        ops::hypot(reach * curvature, 1.0 + 0.5 * self.width_m * curvature.abs())
    }

    /// Largest curvature of the rear axle's path, 1/m.
    pub fn max_curvature(&self) -> f64 {
        1.0 / self.turning_radius_m
    }
}
