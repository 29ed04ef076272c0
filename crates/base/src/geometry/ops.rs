//! The one home of trigonometry, of powers, of the exponential function and of the logarithm.
//!
//! The standard library's functions differ between platforms and optimisation levels; these come from the
//! `libm` crate and give the same bits everywhere. `clippy.toml` bans the others.

use std::cell::Cell;
use std::f64::consts::{PI, TAU};

/// The number of angles whose sine and cosine a thread remembers, a power of two.
const PLACES: usize = 256;
/// Odd, about 2^64 divided by the golden ratio: Knuth, "The Art of Computer Programming" 3, section 6.4.
const FIBONACCI: u64 = 0x9e37_79b9_7f4a_7c15;

/// An angle, bit by bit, with its sine and cosine.
#[derive(Clone, Copy)]
struct RememberedAngle {
    bits: u64,
    sin_cos: (f64, f64),
}

thread_local! {
    /// Angle 0, which is known from the start, belongs to the first place.
    static ANGLES: [Cell<RememberedAngle>; PLACES] =
        const { [const { Cell::new(RememberedAngle { bits: 0, sin_cos: (0.0, 1.0) }) }; PLACES] };
}

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

/// Returns the same bits as [`sin_cos`], sooner for angles that come again.
///
/// Searches over poses look at a few dozen headings over and over. What a thread remembers decides how long an answer takes
/// and nothing else.
#[inline]
pub fn recurring_sin_cos(angle: f64) -> (f64, f64) {
    let bits = angle.to_bits();
    let place = (bits.wrapping_mul(FIBONACCI) >> (u64::BITS - PLACES.trailing_zeros())) as usize;
    ANGLES.with(|angles| {
        let slot = &angles[place];
        let remembered = slot.get();
        if remembered.bits == bits {
            return remembered.sin_cos;
        }
        let sin_cos = sin_cos(angle);
        slot.set(RememberedAngle { bits, sin_cos });
        sin_cos
    })
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
    // Rounding may leave the result just outside of the interval.
    if turned <= -PI {
        turned + TAU
    } else if turned > PI {
        turned - TAU
    } else if turned == -PI {
        // The interval does not hold -pi.
        PI
    } else {
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recurring_angles_have_the_same_bits_as_others() {
        let small = std::iter::successors(Some(1.37), |angle| Some(0.5 * angle)).take(120);
        let many = (-2 * PLACES as i32..=2 * PLACES as i32).flat_map(|k| [0.0137 * f64::from(k), f64::from(k % 7)]);
        // Both zeros, which differ in their sines; small angles, about where formulas change; more than are remembered, so
        // that places are taken over.
        for angle in [0.0, -0.0, PI, -PI].into_iter().chain(small).chain(many).cycle().take(9_000) {
            let [remembered, fresh] =
                [recurring_sin_cos(angle), sin_cos(angle)].map(|(sin, cos)| [sin.to_bits(), cos.to_bits()]);
            assert_eq!(remembered, fresh, "{angle}");
            // Where both are asked for, one function answers in place of another.
            assert_eq!(remembered[0], sin(angle).to_bits(), "{angle}");
        }
    }

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
