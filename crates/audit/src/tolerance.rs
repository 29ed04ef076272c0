//! The distance that two poses may have and still count as the same.
//!
//! The audit and the timeline compute one pose in two ways. What may lie between the two answers of a proper run
//! follows from the leg; anything above is a violation. With v the greatest speed of the leg and k its greatest
//! curvature, L its length, T its duration, n the number of its pieces, A the radians that it turns in all, and X the
//! largest coordinate that it comes to:
//!
//! - **Rounding of numbers.** A sum of coordinates is off by at most e X, e being [`f64::EPSILON`], and a product of
//!   the unit vector of a heading by 2 e of its length. The audit adds up at most [`STRIDE`] steps before it begins
//!   again from the start of a piece, and both answers add up pieces, so that a sum is off by at most
//!   s = 4 e ([`STRIDE`] + n) of what it comes to; an angle is off by e times what it has turned, besides. So headings
//!   are apart by at most r = s + 4 e A. Places are, by the roundings of their own sums and by a heading that is off by
//!   r on a way of L, at most r (X + L).
//! - **Rounding of time.** The timeline counts nanoseconds. The audit asks for the nearest one to its own sum of
//!   durations, the timeline lets a leg end at the next one, so they are apart by at most d = 1 ns + s T, the second
//!   part from sums in seconds. In that time a body moves by at most v d and turns by v k d. It may be on a
//!   neighbouring piece then, which is why v and k are those of the leg.
//! - **A negligible amount**, [`SAME_POSE`], is granted on top, so that no rounding that was overlooked here makes a
//!   violation of a proper run.
//!
//! In `contest` that makes 1.01e-6 m and 1.001e-6 rad. At the limits of what scenarios may ask for, 1000 m/s with a
//! turning radius of 0.1 m, it makes 2e-6 m and 1.1e-5 rad; a walk of 1000 km by a thousand cells adds some 5e-6 m.
//! All of it is far below the millimetre that bodies may overlap by. That one is for rapier's single precision: offsets
//! and extents of at most 1 km are off by 2^-24 of it, 6e-5 m, a few times over.

use super::leg::STRIDE;
use super::pace::DriveProfile;
use wildfire_base::trajectory::{Piece, Trajectory};

/// A negligible difference, in metres and radians.
pub const SAME_POSE: f64 = 1e-6;

/// The unit that the timeline rounds times to, in seconds.
const TICK_S: f64 = 1e-9;

/// The distance that two poses may have and still count as the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    pub metres: f64,
    pub radians: f64,
}

impl Tolerance {
    /// The tolerance for a body that has not moved.
    pub const STANDING: Self = Self { metres: SAME_POSE, radians: SAME_POSE };

    /// Computes the tolerance for poses on a leg, as the module derives it.
    pub fn from_leg(leg: &Trajectory) -> Self {
        let mut fastest_mps = 0.0_f64;
        let mut sharpest = 0.0_f64;
        let mut length_m = 0.0;
        let mut turned_rad = 0.0;
        for piece in leg.pieces() {
            if let Piece::Drive { segment, speed_mps, acceleration_mps2 } = *piece {
                let metres = segment.length_m.abs();
                fastest_mps = fastest_mps.max(DriveProfile::new(metres, speed_mps, acceleration_mps2).fastest_mps());
                sharpest = sharpest.max(segment.curvature.abs());
                length_m += metres;
                turned_rad += metres * segment.curvature.abs();
            }
        }
        // X, s, r and d of the module's text; the way from the start bounds X.
        let farthest_m = leg.start().position().abs().max_element() + length_m;
        let of_sums = 4.0 * f64::EPSILON * (STRIDE as f64 + leg.pieces().len() as f64);
        let rounding = of_sums + 4.0 * f64::EPSILON * turned_rad;
        let seconds = TICK_S + of_sums * leg.duration_s();
        Self {
            metres: SAME_POSE + fastest_mps * seconds + rounding * (farthest_m + length_m),
            radians: SAME_POSE + fastest_mps * sharpest * seconds + rounding,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::Pose;
    use wildfire_base::time::SimTime;
    use wildfire_base::trajectory::SpeedLimits;
    use wildfire_base::vehicle::{Path, Segment};

    fn tolerance(speed_mps: f64, radius_m: f64, length_m: f64, from_m: f64) -> Tolerance {
        let segments = [1.0, -1.0, 0.0].map(|side| Segment { curvature: side / radius_m, length_m: length_m / 3.0 });
        let path = Path { start: Pose::new(from_m, 0.0, 0.5), segments: segments.to_vec() };
        Tolerance::from_leg(&Trajectory::from_path(&path, SimTime::ZERO, SpeedLimits::new(speed_mps, speed_mps)))
    }

    #[test]
    fn a_leg_of_the_contest_has_a_micrometre() {
        let Tolerance { metres, radians } = tolerance(8.0, 13.0, 500.0, 250.0);
        assert!(
            (SAME_POSE..1.01e-6).contains(&metres) && (SAME_POSE..1.001e-6).contains(&radians),
            "{metres} {radians}"
        );
    }

    #[test]
    fn the_tolerance_grows_with_speed_curvature_and_length_and_stays_small() {
        let fast = tolerance(1000.0, 0.1, 500.0, 250.0);
        assert!((2e-6..2.1e-6).contains(&fast.metres) && (1.1e-5..1.2e-5).contains(&fast.radians), "{fast:?}");
        let far = tolerance(2.0, 13.0, 1e6, 1e6);
        assert!((1.5e-6..1e-3).contains(&far.metres) && far.radians < 1.1e-6, "{far:?}");
        assert!(tolerance(1000.0, 13.0, 500.0, 250.0).radians < fast.radians);
    }

    #[test]
    fn what_stands_has_no_more_than_what_is_of_no_consequence() {
        let stands = Trajectory::new(SimTime::ZERO, Pose::default(), Vec::new());
        let found = Tolerance::from_leg(&stands);
        assert!(found.metres < 1.001 * SAME_POSE && found.radians < 1.001 * SAME_POSE, "{found:?}");
    }
}
