use glam::DVec2;
use rand::{Rng, RngExt};

use super::space::FreeSpace;

/// Draws stop after so many a wanted milestone, so that a full field cannot hold the planner up.
pub const MAX_DRAWS_PER_SAMPLE: u32 = 100;

/// Draws `wanted` free points that cover the field evenly; also says how many points were drawn.
///
/// The points are Halton's with bases 2 and 3 (J. H. Halton, "On the efficiency of certain quasi-random sequences of
/// points in evaluating multi-dimensional integrals", Numerische Mathematik 2, 1960), moved by one random shift modulo
/// the field's sides (R. Cranley, T. N. L. Patterson, "Randomization of number theoretic methods for multiple
/// integration", SIAM J. Numerical Analysis 13(6), 1976). Points that are not free are dropped.
pub fn draw_milestones(space: &FreeSpace, wanted: u32, rng: &mut impl Rng) -> (Vec<DVec2>, u32) {
    let shift = DVec2::new(rng.random(), rng.random());
    let max_draws = wanted.saturating_mul(MAX_DRAWS_PER_SAMPLE);
    let mut milestones = Vec::with_capacity(wanted as usize);
    let mut draws = 0;
    while milestones.len() < wanted as usize && draws < max_draws {
        draws += 1;
        let unit = DVec2::new(radical_inverse(2, draws), radical_inverse(3, draws)) + shift;
        let point = unit.fract() * space.size_m();
        if space.point_is_free(point) {
            milestones.push(point);
        }
    }
    (milestones, draws)
}

/// The digits of `index` in a base, mirrored at the point: in [0, 1).
pub fn radical_inverse(base: u32, index: u32) -> f64 {
    let mut rest = index;
    let mut mirrored = 0u64;
    let mut scale = 1u64;
    while rest > 0 {
        mirrored = mirrored * u64::from(base) + u64::from(rest % base);
        scale *= u64::from(base);
        rest /= base;
    }
    mirrored as f64 / scale as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radical_inverses_are_mirrored_digits() {
        assert_eq!([1, 2, 3, 4, 6].map(|i| radical_inverse(2, i)), [0.5, 0.25, 0.75, 0.125, 0.375]);
        assert_eq!([1, 2, 3, 5].map(|i| radical_inverse(3, i)), [1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0, 7.0 / 9.0]);
        assert!(radical_inverse(3, u32::MAX) < 1.0);
    }
}
