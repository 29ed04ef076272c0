//! The one home of trigonometry, of powers, of the exponential function and of the logarithm.
//!
//! The standard library's functions differ between platforms and optimisation levels; these come from the
//! `libm` crate and give the same bits everywhere. `clippy.toml` bans the others.

use std::f64::consts::{PI, TAU};

#[inline]
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

#[inline]
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Sine and cosine of one angle, in this order.
#[inline]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

pub fn atan(slope: f64) -> f64 {
    libm::atan(slope)
}

#[inline]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Arc cosine; arguments beyond -1 and 1 by rounding are clamped.
#[inline]
pub fn acos(cosine: f64) -> f64 {
    libm::acos(cosine.clamp(-1.0, 1.0))
}

pub fn exp(exponent: f64) -> f64 {
    libm::exp(exponent)
}

/// Natural logarithm.
pub fn ln(number: f64) -> f64 {
    libm::log(number)
}

/// Natural logarithm of one more than a number, exact for small numbers.
pub fn ln_1p(number: f64) -> f64 {
    libm::log1p(number)
}

/// The base, zero or more, to the power of the exponent.
pub fn pow(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}

#[inline]
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// The same direction in (-pi, pi].
#[inline]
pub fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle - TAU * ((angle + PI) / TAU).floor();
    if turned <= -PI {
        turned + TAU
    } else if turned > PI {
        turned - TAU
    } else if turned == -PI {
        PI
    } else {
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_angles_lie_in_the_half_open_turn() {
        for k in -40..=40 {
            let angle = f64::from(k) * 0.37;
            let wrapped = wrap_angle(angle);
            assert!(wrapped > -PI && wrapped <= PI, "{angle} became {wrapped}");
            assert!((sin(angle) - sin(wrapped)).abs() < 1e-12);
            assert!((cos(angle) - cos(wrapped)).abs() < 1e-12);
        }
        assert_eq!(wrap_angle(-PI), PI);
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(3.0 * PI), PI);
    }
}
