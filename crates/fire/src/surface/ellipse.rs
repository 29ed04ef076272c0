//! A fire's spread from one point: an ellipse that grows evenly, with a focus on the point.
//!
//! With the head rate R, the eccentricity e and the unit heading d, all in the plane of the slope, the fire needs
//! `(|v| - e v.d) / (R (1 - e))` along a vector v of that plane: the polar form `R (1-e) / (1 - e cos t)` of the ellipse,
//! rewritten as a norm less a linear drift (a Randers metric). For a horizontal vector both are written out here, with the
//! slope and the rate multiplied in, so that an edge costs one square root.

use glam::{DVec2, DVec3};

/// Travel times from a point along horizontal vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// The squared norm in s2 of (x, y) metres is `xx x x + 2 xy x y + yy y y`.
    xx: f64,
    xy: f64,
    yy: f64,
    /// Seconds per metre that the drift takes off.
    drift: DVec2,
    /// Zero, or infinity where nothing burns: added to all times, as a test would cost more.
    barrier_s: f64,
}

impl Ellipse {
    /// The ellipse of a fuel that does not burn.
    pub const NEVER: Self = Self { xx: 0.0, xy: 0.0, yy: 0.0, drift: DVec2::ZERO, barrier_s: f64::INFINITY };

    /// The ellipse on a slope with this gradient of the elevation; `heading` is a unit vector in its plane.
    pub fn new(rate_mps: f64, eccentricity: f64, heading: DVec3, gradient: DVec2) -> Self {
        let slowness = 1.0 / (rate_mps * (1.0 - eccentricity));
        let drift = (heading.truncate() + gradient * heading.z) * (slowness * eccentricity);
        Self::with_drift(slowness, drift, gradient)
    }

    /// The ellipse of which the slowness without drift and the drift are known, in seconds per metre.
    pub fn with_drift(slowness: f64, drift: DVec2, gradient: DVec2) -> Self {
        // A rate of 0 makes it infinite, and the products below would be NaN.
        if !slowness.is_finite() {
            return Self::NEVER;
        }
        let square = slowness * slowness;
        Self {
            xx: square * (1.0 + gradient.x * gradient.x),
            xy: square * (gradient.x * gradient.y),
            yy: square * (1.0 + gradient.y * gradient.y),
            drift,
            barrier_s: 0.0,
        }
    }

    /// Says whether the fire spreads at all.
    pub fn burns(&self) -> bool {
        self.barrier_s == 0.0
    }

    /// Returns the seconds that the fire needs along a horizontal vector of metres; infinity where nothing burns.
    #[inline]
    pub fn travel_s(&self, v: DVec2) -> f64 {
        self.product(v, v).sqrt() - self.drift_s(v) + self.barrier_s
    }

    /// Returns the inner product of two horizontal vectors of metres, in s2: the square of the part of travel times
    /// that does not know forward from back.
    #[inline]
    pub fn product(&self, v: DVec2, w: DVec2) -> f64 {
        v.x * (self.xx * w.x + self.xy * w.y) + v.y * (self.xy * w.x + self.yy * w.y)
    }

    /// Returns how much of the time along a horizontal vector is the derivative of the time along another one, in the
    /// direction of the first: 1 for vectors of one direction, at least 0 where two are acute.
    pub fn acuteness(&self, u: DVec2, v: DVec2) -> f64 {
        let along = |u: DVec2, v: DVec2| self.product(u, v) / self.product(u, u).sqrt() - self.drift_s(v);
        (along(u, v) / self.travel_s(v)).min(along(v, u) / self.travel_s(u))
    }

    /// Returns the seconds that the drift takes off along a horizontal vector of metres.
    #[inline]
    pub fn drift_s(&self, v: DVec2) -> f64 {
        self.drift.x * v.x + self.drift.y * v.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::compass;

    #[test]
    fn circle_takes_the_same_time_everywhere() {
        let circle = Ellipse::new(0.5, 0.0, DVec3::Y, DVec2::ZERO);
        for degrees in (0..360).step_by(15) {
            let v = compass::unit_toward(f64::from(degrees)) * 10.0;
            assert!((circle.travel_s(v) - 20.0).abs() < 1e-12);
        }
    }

    #[test]
    fn points_reached_at_one_time_lie_on_an_ellipse_around_its_focus() {
        let (rate, e) = (1.5, 0.8);
        let ellipse = Ellipse::new(rate, e, DVec3::X, DVec2::ZERO);
        // After 10 s the half length is R t / (1 + e), and the centre e times that to the east.
        let half_length = rate * 10.0 / (1.0 + e);
        let half_width = half_length * (1.0 - e * e).sqrt();
        for degrees in (0..360).step_by(7) {
            let unit = compass::unit_toward(f64::from(degrees));
            let reached = unit * (10.0 / ellipse.travel_s(unit));
            let [x, y] = [(reached.x - half_length * e) / half_length, reached.y / half_width];
            assert!((x * x + y * y - 1.0).abs() < 1e-12, "at {degrees}");
        }
    }

    #[test]
    fn way_over_a_slope_is_longer_than_the_map_shows() {
        let gradient = DVec2::new(0.75, 0.0);
        let calm = Ellipse::new(1.0, 0.0, DVec3::new(0.8, 0.0, 0.6), gradient);
        assert!((calm.travel_s(DVec2::new(8.0, 0.0)) - 10.0).abs() < 1e-12);
        assert!((calm.travel_s(DVec2::new(0.0, 8.0)) - 8.0).abs() < 1e-12);
        // Uphill in the plane of the slope, the head needs the length of the slope at its rate.
        let uphill = Ellipse::new(2.0, 0.6, DVec3::new(0.8, 0.0, 0.6), gradient);
        assert!((uphill.travel_s(DVec2::new(8.0, 0.0)) - 5.0).abs() < 1e-12);
        assert!((uphill.travel_s(DVec2::new(-8.0, 0.0)) - 5.0 * 4.0).abs() < 1e-12, "the back is (1-e)/(1+e) as fast");
    }

    #[test]
    fn nothing_is_reached_where_nothing_burns() {
        for never in [
            Ellipse::NEVER,
            Ellipse::new(0.0, 0.0, DVec3::Y, DVec2::ZERO),
            Ellipse::new(0.0, 0.9, DVec3::Y, DVec2::new(0.3, -0.2)),
        ] {
            assert!(!never.burns());
            for v in [DVec2::ZERO, DVec2::X, DVec2::new(-3.0, 1e9)] {
                assert_eq!(never.travel_s(v), f64::INFINITY);
            }
        }
    }
}
