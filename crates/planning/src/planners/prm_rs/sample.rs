//! The sampling of the roadmap's poses: in the open, along bushes, and at their protruding corners.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use glam::DVec2;
use rand::{Rng, RngExt};

use crate::collision::{ClearanceField, CollisionChecker};
use crate::kit::halton::radical_inverse;
use crate::kit::lattice::motions;
use crate::kit::milestone_tiles::CellBlock;
use wildfire_base::geometry::{Pose, ops};
use wildfire_grid::Grid;

/// Draws stop after this number for each wanted pose, so that a full field cannot hold the planner up.
const MAX_DRAWS_PER_SAMPLE: u32 = 100;
/// Nearer to a bush, poses head along it.
const ALONG_M: f64 = 6.0;
/// Half the distance over which the direction to the nearest bush is measured.
const PROBE_M: f64 = 0.5;
/// The number of motions from poses of minor components along which other poses are tried.
pub const MOTIONS: u32 = 6;
const NEAR_M: f64 = 6.0;
/// Poses at corners keep this much more than the clearance, so that curves through them do too.
const CORNER_SPARE_M: f64 = 0.1;

/// Samples poses that keep a clearance, on a field or a part of it.
#[derive(Debug)]
pub struct Sampler<'a> {
    checker: &'a CollisionChecker,
    clearance_m: f64,
    block: CellBlock,
    /// The beginning of each axis's sequence, as a share: x, y, heading.
    shift: [f64; 3],
    pub draws: u32,
}

impl<'a> Sampler<'a> {
    pub fn new(checker: &'a CollisionChecker, clearance_m: f64, rng: &mut impl Rng) -> Self {
        let occupied = checker.field().occupied();
        let block = CellBlock { rows: 0..occupied.rows(), cols: 0..occupied.cols() };
        Self::of_block(checker, clearance_m, block, rng)
    }

    /// Creates a sampler of a part of the field.
    pub fn of_block(checker: &'a CollisionChecker, clearance_m: f64, block: CellBlock, rng: &mut impl Rng) -> Self {
        Self { checker, clearance_m, block, shift: std::array::from_fn(|_| rng.random()), draws: 0 }
    }

    /// Samples this number of free poses on average: the next lower or the next higher integer.
    pub fn draw_about(&mut self, wanted: f64, rng: &mut impl Rng) -> Vec<Pose> {
        let more = rng.random_bool(wanted.fract());
        self.draw(wanted as u32 + u32::from(more))
    }

    /// Samples `wanted` free poses, or fewer if the attempts run out. Positions cover the field evenly; headings are
    /// along the nearest bush, or evenly distributed.
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
        let place = self.block.position(share(0, 2), share(1, 3), self.checker.field().frame().cell_m);
        let turn = share(2, 5);
        let heading = match along_nearest_bush(self.checker.field(), place) {
            // Either way along it.
            Some(along) if turn < 0.5 => along,
            Some(along) => along + PI,
            None => turn * TAU,
        };
        Pose::new(place.x, place.y, heading)
    }

    /// Returns poses that pass the convex corners of bushes, or of groups of them, at the clearance, in both directions: `places`
    /// of them at each corner.
    pub fn corner_samples(&mut self, places: u32) -> Vec<Pose> {
        // The truck's side passes the corner at the clearance.
        let abeam_m = 0.5 * self.checker.body().width_m + self.clearance_m + CORNER_SPARE_M;
        let mut poses = Vec::new();
        for (corner, outwards) in convex_corners(self.checker.field(), &self.block) {
            for place in 0..places {
                // Evenly within 45 degrees to either side of the bisector.
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

/// Returns a heading along the nearest bush, if one is near.
fn along_nearest_bush(field: &ClearanceField, place: DVec2) -> Option<f64> {
    if field.lower_bound(place) > ALONG_M {
        return None;
    }
    let slope = |axis: DVec2| field.lower_bound(place + axis * PROBE_M) - field.lower_bound(place - axis * PROBE_M);
    let away = DVec2::new(slope(DVec2::X), slope(DVec2::Y));
    // At a right angle to the way away from the bush.
    (away != DVec2::ZERO).then(|| ops::atan2(away.x, -away.y))
}

/// Returns the corners that stick out of the bushes, each with the bearing that halves the free angle about it: those in
/// a block, its west and south edges included.
fn convex_corners<'a>(field: &'a ClearanceField, block: &'a CellBlock) -> impl Iterator<Item = (DVec2, f64)> + 'a {
    // The bush lies at 225 degrees from the corner, or at 315, 45 or 135.
    corners_of_one(field.occupied(), block).map(move |(row, col, only)| {
        let place = DVec2::new(col as f64, row as f64) * field.frame().cell_m;
        (place, FRAC_PI_4 + 2.0 * FRAC_PI_4 * only as f64)
    })
}

/// Lists the south-west corners of a block's cells that lie inside the field and at which one of four cells is a bush,
/// and says which of them.
fn corners_of_one<'a>(
    occupied: &'a Grid<bool>,
    block: &'a CellBlock,
) -> impl Iterator<Item = (usize, usize, usize)> + 'a {
    (block.rows.start.max(1)..block.rows.end).flat_map(move |row| {
        (block.cols.start.max(1)..block.cols.end).filter_map(move |col| {
            let around = [(row - 1, col - 1), (row - 1, col), (row, col), (row, col - 1)];
            let mut bushes = (0..4).filter(|&k| occupied[around[k]]);
            // Two bushes make a straight edge or shut the corner, and three a hollow: none of these sticks out.
            let (only, None) = (bushes.next()?, bushes.next()) else { return None };
            Some((row, col, only))
        })
    })
}

/// Returns poses that the truck reaches by one motion from the given ones, with the clearance kept.
pub fn expand_near(checker: &CollisionChecker, clearance_m: f64, poses: &[Pose]) -> Vec<Pose> {
    let motions = motions(checker.body(), NEAR_M);
    let ways = poses.iter().flat_map(|&pose| motions.map(|motion| (pose, motion)));
    let free = ways.filter(|&(pose, motion)| checker.motion_is_free(pose, motion, clearance_m));
    free.map(|(pose, motion)| motion.end(pose)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_fields::TestField;
    use wildfire_base::rng;

    const CLEARANCE_M: f64 = 0.6;

    #[test]
    fn samples_are_free_and_cover_the_field_evenly() {
        let field = TestField::random(1, 25);
        let mut sampler = Sampler::new(&field.checker, CLEARANCE_M, &mut rng::stream(1, "samples"));
        let poses = sampler.draw(400);
        assert_eq!(poses.len(), 400);
        assert!(poses.iter().all(|&pose| field.checker.pose_is_free(pose, CLEARANCE_M)));
        let mut counts = [0; 9];
        for pose in poses {
            counts[(pose.y / 50.0) as usize * 3 + (pose.x / 50.0) as usize] += 1;
        }
        assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
    }

    #[test]
    fn beside_a_wall_samples_head_along_it() {
        let field =
            TestField::drawn(&["..........", "..........", "##########", "..........", ".........."], Pose::default());
        let mut sampler = Sampler::new(&field.checker, CLEARANCE_M, &mut rng::stream(1, "samples"));
        let mut counts = [0; 2];
        for pose in sampler.draw(300) {
            let near_wall = (pose.y - 12.5).abs() < 6.0 && (6.0..44.0).contains(&pose.x);
            if near_wall {
                assert!(pose.direction().y.abs() < 0.3, "{pose:?}");
                counts[usize::from(pose.direction().x > 0.0)] += 1;
            }
        }
        assert!(counts[0] > 30 && counts[1] > 30, "{counts:?}");
    }

    #[test]
    fn corner_poses_pass_convex_corners_in_both_directions() {
        let picture = [
            "..............",
            "..............",
            ".....##.......",
            ".....#........",
            "..............",
            "..............",
        ];
        let field = TestField::drawn(&picture, Pose::default());
        let mut sampler = Sampler::new(&field.checker, CLEARANCE_M, &mut rng::stream(1, "samples"));
        let poses = sampler.corner_samples(1);
        // Five corners stick out; the sixth is a nook.
        assert_eq!(poses.len(), 10);
        for pair in poses.chunks(2) {
            assert_eq!(pair[0].position(), pair[1].position());
            assert!((pair[0].direction() + pair[1].direction()).length() < 1e-9);
            let clearance = field.checker.clearance(pair[0]);
            assert!((CLEARANCE_M..CLEARANCE_M + 0.2).contains(&clearance), "{clearance}");
        }
    }

    #[test]
    fn a_full_field_ends_the_draws() {
        let field = TestField::drawn(&["####", "####", "####"], Pose::default());
        let mut sampler = Sampler::new(&field.checker, CLEARANCE_M, &mut rng::stream(1, "samples"));
        assert_eq!((sampler.draw(5).len(), sampler.draws), (0, 5 * MAX_DRAWS_PER_SAMPLE));
    }

    #[test]
    fn poses_about_another_are_driven_to_from_it() {
        let field = TestField::random(3, 25);
        let about = expand_near(&field.checker, CLEARANCE_M, &[field.start]);
        assert_eq!(about.len(), 6);
        for pose in about {
            assert!((NEAR_M - pose.position().distance(field.start.position())).abs() < 0.1);
        }
    }
}
