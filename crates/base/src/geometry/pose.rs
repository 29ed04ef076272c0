//! Poses and rectangles in the world.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::ops;

/// A place and a direction in the world frame. For the truck, the place is the middle of the rear axle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Metres east.
    pub x: f64,
    /// Metres north.
    pub y: f64,
    /// Radians, counter-clockwise from east, in (-pi, pi].
    pub heading: f64,
}

impl Pose {
    /// A pose whose heading is wrapped into (-pi, pi].
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { x, y, heading: ops::wrap_angle(heading) }
    }

    /// Returns the place without the heading.
    pub fn position(self) -> DVec2 {
        DVec2::new(self.x, self.y)
    }

    /// Unit vector of the heading.
    #[inline]
    pub fn direction(self) -> DVec2 {
        let (sin, cos) = ops::recurring_sin_cos(self.heading);
        DVec2::new(cos, sin)
    }

    /// World position of a point given in this pose's body frame (x forward, y left).
    pub fn transform(self, body: DVec2) -> DVec2 {
        let (sin, cos) = ops::sin_cos(self.heading);
        DVec2::new(self.x + cos * body.x - sin * body.y, self.y + sin * body.x + cos * body.y)
    }
}

/// A rectangle in the world: its centre with the direction of its long axis, and half its extents in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedRect {
    pub centre: Pose,
    pub half_length: f64,
    pub half_width: f64,
}

impl OrientedRect {
    /// Corners counter-clockwise, beginning at the front left.
    pub fn corners(&self) -> [DVec2; 4] {
        let (l, w) = (self.half_length, self.half_width);
        [(l, w), (-l, w), (-l, -w), (l, -w)].map(|(x, y)| self.centre.transform(DVec2::new(x, y)))
    }
}
