//! Where trucks stand when a run begins: one after the other on the free pose that is nearest to its start.

use std::sync::Arc;

use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::vehicle::Dimensions;
use wildfire_planning::collision::{ClearanceField, CollisionChecker, gap_between};

/// What trucks keep between them, in metres.
pub const TRUCK_MARGIN_M: f64 = 0.2;

/// Clearance that a truck's start has at least, in metres.
const START_CLEARANCE_M: f64 = 0.05;

/// Returns the free pose nearest to where a truck is wanted, at which it keeps its margin to those that stand already;
/// `None` if there is none.
pub fn free_start(
    body: &Dimensions,
    wanted: Pose,
    field: &ClearanceField,
    checker: &CollisionChecker,
    standing: &[(Dimensions, Pose)],
) -> Option<Pose> {
    let keeps_apart =
        |pose: &Pose| standing.iter().all(|(other, at)| gap_between(body, *pose, other, *at) >= TRUCK_MARGIN_M);
    nearest_free_pose(field.frame(), wanted, |pose| checker.pose_is_free(*pose, START_CLEARANCE_M) && keeps_apart(pose))
}

/// Returns the number of the first truck that has no place, if there is one.
pub(crate) fn first_without_place(
    mut trucks: impl Iterator<Item = (Dimensions, Pose)>,
    field: &Arc<ClearanceField>,
) -> Option<usize> {
    let mut standing = Vec::new();
    trucks.position(|(body, wanted)| {
        let checker = CollisionChecker::new(Arc::clone(field), body);
        let start = free_start(&body, wanted, field, &checker, &standing);
        standing.extend(start.map(|start| (body, start)));
        start.is_none()
    })
}

/// Returns the free pose nearest to a wanted one: places on rings half a metre apart, headings from the wanted one
/// outwards.
fn nearest_free_pose(frame: &FieldFrame, wanted: Pose, is_free: impl Fn(&Pose) -> bool) -> Option<Pose> {
    const RING_M: f64 = 0.5;
    const HEADINGS: i32 = 16;
    if is_free(&wanted) {
        return Some(wanted);
    }
    let rings = (2.0 * frame.width_m().max(frame.height_m()) / RING_M).ceil() as i32;
    (0..rings).find_map(|ring| {
        let radius = f64::from(ring) * RING_M;
        // Spokes grow with the ring, so that places stay about as close together; 64 bound the search on far rings.
        let spokes = (8 * ring).clamp(1, 64);
        (0..spokes).find_map(|spoke| {
            let bearing = std::f64::consts::TAU * f64::from(spoke) / f64::from(spokes);
            let place = wanted.position() + Pose::new(0.0, 0.0, bearing).direction() * radius;
            // Headings alternate to both sides, so the one nearest to the wanted one is tried first.
            let turned = |k: i32| {
                let steps = if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 };
                wanted.heading + std::f64::consts::TAU * f64::from(steps) / f64::from(HEADINGS)
            };
            (0..HEADINGS).map(|k| Pose::new(place.x, place.y, turned(k))).find(&is_free)
        })
    })
}
