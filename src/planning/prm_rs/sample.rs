use std::f64::consts::{FRAC_PI_4, PI, TAU};

use glam::DVec2;
use rand::{Rng, RngExt};

use crate::collision::{ClearanceField, CollisionChecker};
use crate::geometry::{Pose, ops};
use crate::planning::prm::radical_inverse;

/// Draws stop after so many a wanted pose, so that a full field cannot hold the planner up.
const MAX_DRAWS_PER_SAMPLE: u32 = 100;
/// Nearer to a bush, poses head along it.
const ALONG_M: f64 = 6.0;
/// Half the distance over which the direction to the nearest bush is measured.
const PROBE_M: f64 = 0.5;
/// Poses at corners keep so much more than the clearance, so that curves through them do too.
const CORNER_SPARE_M: f64 = 0.1;

/// Draws poses that keep a clearance.
#[derive(Debug)]
pub struct Sampler<'a> {
    checker: &'a CollisionChecker,
    clearance_m: f64,
    /// Where the sequence of each axis begins, as a share: x, y, heading.
    shift: [f64; 3],
    pub draws: u32,
}

impl<'a> Sampler<'a> {
    pub fn new(checker: &'a CollisionChecker, clearance_m: f64, rng: &mut impl Rng) -> Self {
        Self { checker, clearance_m, shift: std::array::from_fn(|_| rng.random()), draws: 0 }
    }

    /// Draws `wanted` free poses, less if the draws run out. Places cover the field evenly; headings lead along the
    /// nearest bush, or evenly anywhere.
    ///
    /// Places and headings are Halton's with bases 2, 3 and 5 (J. H. Halton, "On the efficiency of certain quasi-random
    /// sequences of points in evaluating multi-dimensional integrals", Numerische Mathematik 2, 1960), moved by a random
    /// shift (R. Cranley, T. N. L. Patterson, "Randomization of number theoretic methods for multiple integration", SIAM
    /// J. Numerical Analysis 13(6), 1976).
    pub fn draw(&mut self, wanted: u32) -> Vec<Pose> {
        let last = wanted.saturating_mul(MAX_DRAWS_PER_SAMPLE);
        let mut poses = Vec::with_capacity(wanted as usize);
        while poses.len() < wanted as usize && self.draws < last {
            self.draws += 1;
            let pose = self.pose(self.draws);
            if self.checker.pose_is_free(pose, self.clearance_m) {
                poses.push(pose);
            }
        }
        poses
    }

    fn pose(&self, number: u32) -> Pose {
        let share = |axis: usize, base| (radical_inverse(base, number) + self.shift[axis]).fract();
        let frame = self.checker.field().frame();
        let place = DVec2::new(share(0, 2) * frame.width_m(), share(1, 3) * frame.height_m());
        let turn = share(2, 5);
        let heading = match along_nearest_bush(self.checker.field(), place) {
            // Either way along it.
            Some(along) if turn < 0.5 => along,
            Some(along) => along + PI,
            None => turn * TAU,
        };
        Pose::new(place.x, place.y, heading)
    }

    /// Poses that pass the convex corners of bushes, or of groups of them, at the clearance, in both directions: `places`
    /// of them at each corner.
    pub fn at_corners(&mut self, places: u32) -> Vec<Pose> {
        let abeam_m = 0.5 * self.checker.body().width_m + self.clearance_m + CORNER_SPARE_M;
        let mut poses = Vec::new();
        for (corner, outwards) in convex_corners(self.checker.field()) {
            for place in 0..places {
                let spread = (2.0 * f64::from(place) + 1.0) / f64::from(places) - 1.0;
                let bearing = outwards + spread * FRAC_PI_4;
                let (sin, cos) = ops::sin_cos(bearing);
                let beside = corner + DVec2::new(cos, sin) * abeam_m;
                for side in [1.0, -1.0] {
                    let pose = Pose::new(beside.x, beside.y, bearing + side * 2.0 * FRAC_PI_4);
                    self.draws += 1;
                    if self.checker.pose_is_free(pose, self.clearance_m) {
                        poses.push(pose);
                    }
                }
            }
        }
        poses
    }
}

/// A heading along the nearest bush, if one is near.
fn along_nearest_bush(field: &ClearanceField, place: DVec2) -> Option<f64> {
    if field.at(place) > ALONG_M {
        return None;
    }
    let slope = |axis: DVec2| field.at(place + axis * PROBE_M) - field.at(place - axis * PROBE_M);
    let away = DVec2::new(slope(DVec2::X), slope(DVec2::Y));
    (away != DVec2::ZERO).then(|| ops::atan2(away.x, -away.y))
}

/// Corners that stick out of the bushes, each with the bearing that halves the free angle about it.
fn convex_corners(field: &ClearanceField) -> impl Iterator<Item = (DVec2, f64)> + '_ {
    let (frame, occupied) = (field.frame(), field.occupied());
    (1..occupied.rows()).flat_map(move |row| {
        (1..occupied.cols()).filter_map(move |col| {
            let around = [(row - 1, col - 1), (row - 1, col), (row, col), (row, col - 1)];
            let mut bushes = (0..4).filter(|&k| occupied[around[k]]);
            let (only, None) = (bushes.next()?, bushes.next()) else { return None };
            // The bush lies at 225 degrees from the corner, or at 315, 45 or 135.
            let outwards = FRAC_PI_4 + 2.0 * FRAC_PI_4 * only as f64;
            Some((DVec2::new(col as f64, row as f64) * frame.cell_m, outwards))
        })
    })
}
