//! The space for the body at the ends of a drive.

use std::f64::consts::TAU;

use glam::DVec2;
use rand::{Rng, RngExt};

use crate::collision::{CollisionChecker, MIN_CLEARANCE_M};
use wildfire_base::geometry::{Pose, ops};

use crate::{GoalDisc, PlanFailure};

use super::target::Target;

/// Returns the fixed poses of a drive's ends, each with the body's clearance there: the start and, if it is a pose, the
/// target.
///
/// # Errors
/// The one of the two that has no room for the body, or is not on the field.
pub fn free_ends(checker: &CollisionChecker, start: Pose, target: Target<'_>) -> Result<Vec<(Pose, f64)>, PlanFailure> {
    let mut ends = vec![(start, free_clearance(checker, start).ok_or(PlanFailure::StartBlocked)?)];
    match target {
        Target::Pose(end) => ends.push((end, free_clearance(checker, end).ok_or(PlanFailure::GoalBlocked)?)),
        Target::Discs(discs) => {
            let frame = checker.field().frame();
            let corner = DVec2::new(frame.width_m(), frame.height_m());
            let is_on_field =
                |disc: &GoalDisc| disc.centre.clamp(DVec2::ZERO, corner).distance(disc.centre) <= disc.radius_m;
            if !discs.iter().any(is_on_field) {
                return Err(PlanFailure::GoalBlocked);
            }
        }
    }
    Ok(ends)
}

/// Returns the clearance of a pose, if the body is free there.
fn free_clearance(checker: &CollisionChecker, pose: Pose) -> Option<f64> {
    let is_finite = pose.position().is_finite() && pose.heading.is_finite();
    Some(checker.clearance(pose)).filter(|&clearance| is_finite && clearance > 0.0)
}

/// Rings of places that are tried in a goal disc, and headings at each place.
const RINGS: u32 = 20;
const HEADINGS: u32 = 24;

/// Returns whether the body fits somewhere in a disc, centre inside: on rings of places half a metre apart in a disc of
/// 10 m.
pub fn has_free_pose(checker: &CollisionChecker, disc: GoalDisc) -> bool {
    free_poses_in(checker, disc, RINGS, MIN_CLEARANCE_M).next().is_some()
}

/// Returns the reason of a failure, which is different if the body fits nowhere in any of the discs.
pub fn explain_failure(checker: &CollisionChecker, target: Target<'_>, failure: PlanFailure) -> PlanFailure {
    match target {
        Target::Discs(discs) if !discs.iter().any(|&disc| has_free_pose(checker, disc)) => PlanFailure::GoalBlocked,
        _ => failure,
    }
}

/// Returns poses that keep a clearance with the body's centre in a disc: at places on rings and in the middle.
pub fn free_poses_in(
    checker: &CollisionChecker,
    disc: GoalDisc,
    rings: u32,
    clearance_m: f64,
) -> impl Iterator<Item = Pose> + '_ {
    // The rings of a disc that is far larger than the field would all lie outside of it.
    let reach = disc.radius_m.min(checker.field().frame().width_m() + checker.field().frame().height_m());
    let ahead = checker.body().centre_offset_m();
    // From the rim inwards: there is a bush in the middle.
    let places = (0..=rings).rev().flat_map(move |ring| {
        // So many that neighbours on a ring are about as far apart as the rings are.
        let count = (6 * ring).max(1);
        (0..count).map(move |place| {
            let (sin, cos) = ops::sin_cos(f64::from(place) / f64::from(count) * TAU);
            disc.centre + DVec2::new(cos, sin) * (reach * f64::from(ring) / f64::from(rings.max(1)))
        })
    });
    // One look at the field rules out all headings of a place.
    let roomy = places.filter(|&centre| checker.field().lower_bound(centre) >= 0.5 * checker.body().width_m);
    let poses = roomy.flat_map(move |centre| {
        (0..HEADINGS).map(move |k| {
            let heading = ops::wrap_angle(f64::from(k) / f64::from(HEADINGS) * TAU);
            let axle = Pose::new(centre.x, centre.y, heading).transform(DVec2::new(-ahead, 0.0));
            Pose::new(axle.x, axle.y, heading)
        })
    });
    poses.filter(move |&pose| checker.pose_is_free(pose, clearance_m))
}

/// Poses drawn for one that is free, until the field counts as full.
const DRAWS_A_POSE: usize = 10_000;

/// Samples poses all over the field, at any heading, that keep a clearance. The iterator ends if the field has no room.
pub fn free_poses(checker: &CollisionChecker, clearance_m: f64, rng: &mut impl Rng) -> impl Iterator<Item = Pose> {
    let frame = checker.field().frame();
    let mut draw = || {
        let x = rng.random_range(0.0..frame.width_m());
        let y = rng.random_range(0.0..frame.height_m());
        Pose::new(x, y, rng.random_range(0.0..TAU))
    };
    std::iter::from_fn(move || (0..DRAWS_A_POSE).map(|_| draw()).find(|pose| checker.pose_is_free(*pose, clearance_m)))
}
