use glam::DVec2;
use rand::{Rng, RngExt};

use crate::planning::kit::halton::radical_inverse;

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
