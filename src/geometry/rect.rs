use glam::DVec2;

use super::Pose;

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
