//! Front wheels that take their time to turn, and the curves on which they do.
//!
//! Where wheels turn at a constant rate while a truck drives at a constant speed, its curvature changes by the same amount
//! every metre: it drives a clothoid. A change from one curvature to another at the greatest rate takes a length that is
//! proportional to the speed (A. Scheuer, Th. Fraichard, "Continuous-curvature path planning for car-like vehicles",
//! IROS 1997; Th. Fraichard, A. Scheuer, "From Reeds and Shepp's to continuous-curvature paths", IEEE Trans. Robotics
//! 20(6), 2004, section III).
//!
//! Paths are made of arcs, whose poses, sweeps and times are exact, so a clothoid is driven as a row of arcs: the steering
//! is set in steps, as a controller sets it, each step no greater than what the wheels turn in [`STEERING_STEP_S`], and each arc
//! as long as they take for it.

use serde::{Deserialize, Serialize};

use super::Segment;
use crate::geometry::ops;

/// Wheels of a truck that moves are set no farther at once than they turn in this time, in seconds; for more it stands.
pub const STEERING_STEP_S: f64 = 0.1;

/// Share of a step that is rounding.
const STEP_NOISE: f64 = 1e-9;

/// The limit of how fast front wheels turn, those of the bicycle model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteeringLimits {
    /// In rad/s, positive.
    pub rate_rad_s: f64,
    /// Between the axles.
    pub wheelbase_m: f64,
}

impl SteeringLimits {
    /// Returns the angle of the front wheels to the body on a path of this curvature (1/m) of the rear axle.
    pub fn angle_rad(&self, curvature: f64) -> f64 {
        ops::atan(self.wheelbase_m * curvature)
    }

    /// Returns the seconds that wheels take from one curvature to another.
    pub fn turning_s(&self, from: f64, to: f64) -> f64 {
        (self.angle_rad(to) - self.angle_rad(from)).abs() / self.rate_rad_s
    }

    /// Says whether a truck that moves may go over from one curvature to another at once.
    pub fn is_step(&self, from: f64, to: f64) -> bool {
        self.turning_s(from, to) <= STEERING_STEP_S * (1.0 + STEP_NOISE)
    }

    /// Returns the arcs of a clothoid from one curvature to another, at a speed in m/s along which wheels turn at their
    /// rate; `sense` is 1 forward and -1 in reverse. The curvatures themselves are not among those of the arcs.
    pub fn clothoid(&self, from: f64, to: f64, sense: f64, speed_mps: f64) -> impl Iterator<Item = Segment> + use<> {
        // The angle changes the most with the curvature where wheels are straight, by the wheelbase.
        let turning_s = self.wheelbase_m * (to - from).abs() / self.rate_rad_s;
        let steps = (turning_s / STEERING_STEP_S).ceil().max(1.0);
        let length_m = sense * speed_mps * turning_s / steps;
        (1..steps as u32).map(move |step| {
            let curvature = from + (to - from) * f64::from(step) / steps;
            Segment { curvature, length_m }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    const STEERING: SteeringLimits = SteeringLimits { rate_rad_s: 0.35, wheelbase_m: 3.0 };

    #[test]
    fn arcs_of_a_clothoid_are_steps_that_the_wheels_keep_up_with() {
        for (from, to) in [(0.0, 1.0 / 13.0), (1.0 / 13.0, -1.0 / 13.0), (0.03, 0.0), (0.01, 0.0)] {
            for (sense, speed_mps) in [(1.0, 8.0), (-1.0, 0.5)] {
                let arcs: Vec<Segment> = STEERING.clothoid(from, to, sense, speed_mps).collect();
                let curvatures = std::iter::once(from).chain(arcs.iter().map(|arc| arc.curvature)).chain([to]);
                let curvatures: Vec<f64> = curvatures.collect();
                for pair in curvatures.windows(2) {
                    assert!(STEERING.is_step(pair[0], pair[1]));
                    assert!((pair[1] - pair[0]).signum() == (to - from).signum(), "{curvatures:?}");
                    let arc_s = arcs.first().map_or(f64::INFINITY, |arc| arc.length_m.abs() / speed_mps);
                    assert!(STEERING.turning_s(pair[0], pair[1]) <= arc_s * (1.0 + 1e-9));
                }
                assert!(arcs.iter().all(|arc| arc.is_reverse() == (sense < 0.0)));
            }
        }
    }

    /// The closed form is a series of Fresnel's integrals; here the curve is integrated in small steps instead.
    #[test]
    fn arcs_follow_the_clothoid_within_centimetres() {
        let (from, to, speed_mps) = (0.0, 1.0 / 13.0, 6.0);
        let arcs: Vec<Segment> = STEERING.clothoid(from, to, 1.0, speed_mps).collect();
        let step_m = arcs[0].length_m;
        let length_m = step_m * (arcs.len() + 1) as f64;
        // Half a step on either side belongs to the curvatures before and behind.
        let before = Segment { curvature: from, length_m: 0.5 * step_m };
        let behind = Segment { curvature: to, length_m: 0.5 * step_m };
        let way = std::iter::once(before).chain(arcs).chain([behind]);
        let driven = way.fold(Pose::default(), |pose, segment| segment.end(pose));
        let mut smooth = Pose::default();
        let count = 20_000;
        for k in 0..count {
            let share = (f64::from(k) + 0.5) / f64::from(count);
            let curvature = from + (to - from) * share;
            smooth = Segment { curvature, length_m: length_m / f64::from(count) }.end(smooth);
        }
        assert!(driven.position().distance(smooth.position()) < 0.02, "{driven:?} {smooth:?}");
        assert!((driven.heading - smooth.heading).abs() < 1e-9);
    }
}
