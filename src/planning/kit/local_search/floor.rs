use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::vehicle::Segment;

/// Clearance gained for every metre away from a tight start.
const RAMP: f64 = 0.1;
/// Near a tight start, motions are judged in pieces of this length.
const PIECE_M: f64 = 1.0;
/// A tight start is asked for this share of its own clearance, so that rounding does not decide.
const START_SHARE: f64 = 0.9;

/// The clearance that motions keep: one value, less near a start that does not have it.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    clearance_m: f64,
    start: DVec2,
    at_start_m: f64,
}

impl Floor {
    /// `start_clearance_m` is the body's clearance at the start pose, positive.
    pub fn new(clearance_m: f64, start: Pose, start_clearance_m: f64) -> Self {
        let at_start_m = clearance_m.min(START_SHARE * start_clearance_m);
        Self { clearance_m, start: start.position(), at_start_m }
    }

    /// Whether the body keeps this floor along a segment from `pose`.
    pub fn motion_is_free(&self, checker: &CollisionChecker, pose: Pose, segment: Segment) -> bool {
        let mut pose = pose;
        let mut rest = segment.length_m;
        while rest != 0.0 {
            let floor = self.at(pose);
            if floor >= self.clearance_m {
                return checker.motion_is_free(pose, Segment { length_m: rest, ..segment }, self.clearance_m);
            }
            let piece = Segment { length_m: rest.clamp(-PIECE_M, PIECE_M), ..segment };
            if !checker.motion_is_free(pose, piece, floor) {
                return false;
            }
            pose = piece.end(pose);
            rest -= piece.length_m;
        }
        true
    }

    fn at(&self, pose: Pose) -> f64 {
        (self.at_start_m + RAMP * pose.position().distance(self.start)).min(self.clearance_m)
    }
}
