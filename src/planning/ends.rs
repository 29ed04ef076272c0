//! Whether there is room for the body where a drive begins and ends.

use glam::DVec2;

use crate::collision::{CollisionChecker, LEAST_CLEARANCE_M};
use crate::geometry::{Pose, ops};

use super::GoalDisc;

/// The clearance of a pose, if the body is free there.
pub fn free_clearance(checker: &CollisionChecker, pose: Pose) -> Option<f64> {
    let is_finite = pose.position().is_finite() && pose.heading.is_finite();
    Some(checker.clearance(pose)).filter(|&clearance| is_finite && clearance > 0.0)
}

/// Rings of places that are tried in a goal disc, and headings at each place.
const RINGS: u32 = 20;
const HEADINGS: u32 = 24;

/// Whether the body fits somewhere in a disc, centre inside: on rings of places half a metre apart in a disc of 10 m.
pub fn has_free_pose(checker: &CollisionChecker, disc: GoalDisc) -> bool {
    let reach = disc.radius_m.min(checker.field().frame().width_m() + checker.field().frame().height_m());
    let ahead = checker.body().centre_offset_m();
    // From the rim inwards: a bush stands in the middle.
    (0..=RINGS).rev().any(|ring| {
        let places = (6 * ring).max(1);
        (0..places).any(|place| {
            let around = f64::from(place) / f64::from(places) * std::f64::consts::TAU;
            let (sin, cos) = ops::sin_cos(around);
            let centre = disc.centre + DVec2::new(cos, sin) * (reach * f64::from(ring) / f64::from(RINGS));
            checker.field().at(centre) >= 0.5 * checker.body().width_m
                && (0..HEADINGS).any(|k| {
                    let heading = f64::from(k) / f64::from(HEADINGS) * std::f64::consts::TAU;
                    let facing = Pose::new(centre.x, centre.y, heading);
                    let axle = facing.transform(DVec2::new(-ahead, 0.0));
                    checker.pose_is_free(Pose::new(axle.x, axle.y, heading), LEAST_CLEARANCE_M)
                })
        })
    })
}
