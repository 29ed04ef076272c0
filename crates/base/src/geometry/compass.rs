//! Compass azimuths, as maps, weather reports and files of landscapes have them: degrees clockwise from north.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec2;

use super::ops;

/// Returns the unit vector (x east, y north) that points to an azimuth; exact at multiples of 90 degrees, and
/// mirrored azimuths give mirrored vectors.
pub fn unit_toward(azimuth_deg: f64) -> DVec2 {
    let turned = azimuth_deg % 360.0;
    let positive = if turned < 0.0 { turned + 360.0 } else { turned };
    // Turned from the nearest axis by exchange and change of sign, which round nothing.
    let quarters = (positive / 90.0).round();
    let rest = positive - 90.0 * quarters;
    // The sine and the cosine of 45 degrees differ in their last bit, so a diagonal would not be its own mirror image.
    let (sin, cos) = match rest.abs() == 45.0 {
        true => (FRAC_1_SQRT_2.copysign(rest), FRAC_1_SQRT_2),
        false => ops::sin_cos(rest * (PI / 180.0)),
    };
    // Just short of a whole turn the nearest axis is north again, the fourth from there.
    match quarters as u8 % 4 {
        0 => DVec2::new(sin, cos),
        1 => DVec2::new(cos, -sin),
        2 => DVec2::new(-sin, -cos),
        _ => DVec2::new(-cos, sin),
    }
}

/// Returns the unit vector along which a wind blows that comes from an azimuth.
pub fn unit_from(azimuth_deg: f64) -> DVec2 {
    -unit_toward(azimuth_deg)
}

/// Returns the azimuth that a vector points to, in [0, 360); that of the zero vector is 0.
pub fn azimuth_deg(vector: DVec2) -> f64 {
    let degrees = ops::atan2(vector.x, vector.y) * (180.0 / PI);
    let turned = if degrees < 0.0 { degrees + 360.0 } else { degrees };
    // A tiny negative angle becomes a whole turn by rounding; the zero of atan2 has a sign.
    if turned >= 360.0 || turned == 0.0 { 0.0 } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_exact_and_all_else_is_read_back() {
        for (azimuth, x, y) in
            [(0.0, 0.0, 1.0), (90.0, 1.0, 0.0), (180.0, 0.0, -1.0), (270.0, -1.0, 0.0), (-90.0, -1.0, 0.0)]
        {
            assert_eq!(unit_toward(azimuth), DVec2::new(x, y), "{azimuth}");
            assert_eq!(unit_from(azimuth), DVec2::new(-x, -y), "{azimuth}");
        }
        for tenths in 0..7200 {
            let azimuth = f64::from(tenths) / 10.0 - 360.0;
            let unit = unit_toward(azimuth);
            assert!((unit.length() - 1.0).abs() < 1e-15);
            let difference = (azimuth_deg(unit) - azimuth).rem_euclid(360.0);
            assert!(difference.min(360.0 - difference) < 1e-12, "{azimuth} became {}", azimuth_deg(unit));
            assert_eq!(unit_toward(-azimuth), DVec2::new(-unit.x, unit.y), "mirrored {azimuth}");
        }
        assert_eq!(azimuth_deg(DVec2::ZERO), 0.0);
        assert_eq!(azimuth_deg(DVec2::new(-1e-300, 1.0)), 0.0);
    }
}
