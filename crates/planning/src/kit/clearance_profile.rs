//! The clearance that motions keep on a drive: one value, relaxed near ends of the drive that do not have it.
//!
//! A truck may have to start or to end in a place that is tighter than what its planner wants to keep. About such an end
//! the demand falls to a share of what the end itself has, and rises by [`RAMP`] for every metre away from it.

use glam::DVec2;

use crate::collision::CollisionChecker;
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::Segment;

const NOTHING: Segment = Segment { curvature: 0.0, length_m: 0.0 };

/// Clearance gained for every metre away from a tight end.
const RAMP: f64 = 0.1;
/// Near a tight end, motions are judged in pieces of this length.
const PIECE_M: f64 = 1.0;
/// The share of its own clearance that a tight end has to keep, so that rounding does not decide.
pub const END_SHARE: f64 = 0.9;

/// The minimum clearance by position, for one drive.
#[derive(Clone, Debug)]
pub struct ClearanceProfile {
    min_clearance_m: f64,
    tight: Vec<LowClearanceEnd>,
    rule: PieceRule,
}

#[derive(Clone, Copy, Debug)]
struct LowClearanceEnd {
    position: DVec2,
    min_clearance_m: f64,
}

/// The clearance that a piece of a motion near a tight end keeps.
#[derive(Clone, Copy, Debug)]
enum PieceRule {
    /// The lesser of the clearances at both ends, so that a path into a tight end is judged like the path out of it.
    LesserOfEnds,
    /// The clearance at its start. Away from the start of a drive, where the demand only rises, that is enough.
    AtItsStart,
}

impl ClearanceProfile {
    /// Creates a profile; `ends` are the poses that are given, each with the body's clearance there, positive.
    pub fn new(min_clearance_m: f64, ends: impl IntoIterator<Item = (Pose, f64)>) -> Self {
        let ends = ends.into_iter();
        let ends = ends
            .map(|(pose, clearance_m)| LowClearanceEnd {
                position: pose.position(),
                min_clearance_m: END_SHARE * clearance_m,
            })
            .filter(|end| end.min_clearance_m < min_clearance_m);
        Self { min_clearance_m, tight: ends.collect(), rule: PieceRule::LesserOfEnds }
    }

    /// Creates a profile for a drive that only has a start, at which the body has the clearance `start_clearance_m`,
    /// positive.
    pub fn from_start(min_clearance_m: f64, start: Pose, start_clearance_m: f64) -> Self {
        Self { rule: PieceRule::AtItsStart, ..Self::new(min_clearance_m, [(start, start_clearance_m)]) }
    }

    /// Returns whether the body keeps its clearance along a segment from `pose`.
    pub fn motion_is_free(&self, checker: &CollisionChecker, pose: Pose, segment: Segment) -> bool {
        if self.tight.is_empty() {
            return segment.length_m == 0.0 || checker.motion_is_free(pose, segment, self.min_clearance_m);
        }
        match self.rule {
            PieceRule::LesserOfEnds => self.pieces_are_free(checker, pose, segment),
            PieceRule::AtItsStart => self.way_out_is_free(checker, pose, segment),
        }
    }

    /// Returns whether the body keeps its clearance along consecutive segments from `pose`.
    pub fn way_is_free(
        &self,
        checker: &CollisionChecker,
        pose: Pose,
        segments: impl IntoIterator<Item = Segment>,
    ) -> bool {
        longest_first(pose, segments).all(|(from, segment)| self.motion_is_free(checker, from, segment))
    }

    fn pieces_are_free(&self, checker: &CollisionChecker, start: Pose, segment: Segment) -> bool {
        let mut pose = start;
        let mut rest_m = segment.length_m.abs();
        while rest_m > 0.0 {
            // Away from tight ends the demand is the same everywhere, so one piece reaches to where it falls.
            let piece_m = rest_m.min(self.distance_to_tight(pose).max(PIECE_M));
            let piece = segment.with_length(piece_m);
            let end = piece.end(pose);
            if !checker.motion_is_free(pose, piece, self.at(pose).min(self.at(end))) {
                return false;
            }
            pose = end;
            rest_m -= piece_m;
        }
        true
    }

    fn way_out_is_free(&self, checker: &CollisionChecker, start: Pose, segment: Segment) -> bool {
        let mut pose = start;
        let mut rest_m = segment.length_m;
        while rest_m != 0.0 {
            let required_m = self.at(pose);
            // From here on the demand rises no further, so the rest is one sweep instead of many.
            if required_m >= self.min_clearance_m {
                return checker.motion_is_free(pose, Segment { length_m: rest_m, ..segment }, self.min_clearance_m);
            }
            let piece = Segment { length_m: rest_m.clamp(-PIECE_M, PIECE_M), ..segment };
            if !checker.motion_is_free(pose, piece, required_m) {
                return false;
            }
            pose = piece.end(pose);
            rest_m -= piece.length_m;
        }
        true
    }

    /// Returns the clearance that is asked for at a pose.
    fn at(&self, pose: Pose) -> f64 {
        self.tight
            .iter()
            .map(|end| end.min_clearance_m + RAMP * pose.position().distance(end.position))
            .fold(self.min_clearance_m, f64::min)
    }

    /// Returns the metres until the nearest position at which less than the full clearance is asked for; not positive
    /// there.
    fn distance_to_tight(&self, pose: Pose) -> f64 {
        self.tight
            .iter()
            .map(|end| pose.position().distance(end.position) - (self.min_clearance_m - end.min_clearance_m) / RAMP)
            .fold(f64::INFINITY, f64::min)
    }
}

/// Two Reeds-Shepp curves have no more segments.
const MAX_OF_TWO_CURVES: usize = 10;

/// Segments, each with the pose at which it begins, the longest first.
#[derive(Debug)]
pub struct LongestFirst {
    row: [(Pose, Segment); MAX_OF_TWO_CURVES],
    count: usize,
}

/// Returns consecutive segments from `pose`, of at most two Reeds-Shepp curves, each with the pose at which it begins.
///
/// The longest comes first: it is the likeliest to be in the way of something, so that a way that is not free is known
/// sooner.
pub fn longest_first(pose: Pose, segments: impl IntoIterator<Item = Segment>) -> LongestFirst {
    let mut row = [(pose, NOTHING); MAX_OF_TWO_CURVES];
    let mut count = 0;
    // Where a segment begins is worked out when it is known that there is one.
    for segment in segments {
        let begins = if count == 0 { pose } else { row[count - 1].1.end(row[count - 1].0) };
        row[count] = (begins, segment);
        count += 1;
    }
    LongestFirst { row, count }
}

impl Iterator for LongestFirst {
    type Item = (Pose, Segment);

    fn next(&mut self) -> Option<Self::Item> {
        let metres = self.row[..self.count].iter().map(|(_, segment)| segment.length_m.abs());
        let (longest, _) = metres.enumerate().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        let next = self.row[longest];
        self.row.copy_within(longest + 1..self.count, longest);
        self.count -= 1;
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::collision::MOTION_TOLERANCE_M;
    use crate::test_fields::{TestField, least_clearance, random_pose};
    use wildfire_base::rng;
    use wildfire_base::vehicle::Path;

    #[test]
    fn free_motions_keep_the_clearance_except_near_tight_ends() {
        let mut rng = rng::stream(1, "clearance floor");
        let (mut full, mut less) = (0, 0);
        for seed in 0..8 {
            let field = TestField::random(seed, 45);
            for _ in 0..400 {
                let pose = random_pose(&mut rng, 150.0);
                let clearance_m = field.checker.clearance(pose);
                if clearance_m <= 0.05 {
                    continue;
                }
                let profile = ClearanceProfile::new(1.5, [(pose, clearance_m)]);
                let curvature = f64::from(rng.random_range(-1..=1)) * field.checker.body().max_curvature();
                let segment = Segment { curvature, length_m: rng.random_range(-25.0..25.0) };
                if !profile.motion_is_free(&field.checker, pose, segment) {
                    continue;
                }
                for (_, there) in (Path { start: pose, segments: vec![segment] }).samples(0.05) {
                    let kept = field.checker.clearance(there);
                    let required = profile.at(there) - RAMP * PIECE_M;
                    assert!(
                        kept > 0.0 && kept >= required.min(1.0) - MOTION_TOLERANCE_M - 1e-9,
                        "{kept}, not {required}"
                    );
                }
                let min = least_clearance(&field.checker, &Path { start: pose, segments: vec![segment] });
                if min >= 1.0 { full += 1 } else { less += 1 }
            }
        }
        assert!(full > 100 && less > 50, "{full} with room, {less} without");
    }

    #[test]
    fn what_is_free_into_a_tight_end_is_mostly_free_out_of_it() {
        let mut rng = rng::stream(2, "clearance floor");
        let (mut both, mut one) = (0, 0);
        for seed in 0..8 {
            let field = TestField::random(seed, 45);
            for _ in 0..200 {
                let pose = random_pose(&mut rng, 150.0);
                let clearance_m = field.checker.clearance(pose);
                let segment = Segment { curvature: 0.0, length_m: rng.random_range(2.0..25.0) };
                if clearance_m > 0.1 {
                    let profile = ClearanceProfile::new(0.75, [(pose, clearance_m)]);
                    let out = profile.motion_is_free(&field.checker, pose, segment);
                    let back = Segment { length_m: -segment.length_m, ..segment };
                    match (out, profile.motion_is_free(&field.checker, segment.end(pose), back)) {
                        (true, true) => both += 1,
                        (false, false) => {}
                        _ => one += 1,
                    }
                }
            }
        }
        assert!(both > 100 && one * 20 < both, "{both} both ways, {one} one way only");
    }

    #[test]
    fn the_longest_segment_comes_first_from_where_it_begins() {
        let start = Pose::new(3.0, 4.0, 0.5);
        let segments =
            [1.0, -7.0, 3.0, 7.0].map(|length_m| Segment { curvature: 0.05 * f64::signum(length_m), length_m });
        let row: Vec<(Pose, Segment)> = longest_first(start, segments).collect();
        assert_eq!(row.iter().map(|(_, segment)| segment.length_m).collect::<Vec<_>>(), [-7.0, 7.0, 3.0, 1.0]);
        let mut pose = start;
        for segment in segments {
            assert!(row.contains(&(pose, segment)), "{segment:?}");
            pose = segment.end(pose);
        }
    }
}
