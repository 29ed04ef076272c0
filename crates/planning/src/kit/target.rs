//! Where a search may end: the goal of a query, or any of several.

use std::slice;

use glam::DVec2;

use crate::{Goal, GoalDisc};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::Dimensions;

/// The places where a drive may end.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// The rear axle in this pose.
    Pose(Pose),
    /// The body's centre in any of these discs; there is at least one.
    Discs(&'a [GoalDisc]),
}

impl<'a> From<&'a Goal> for Target<'a> {
    fn from(goal: &'a Goal) -> Self {
        match goal {
            Goal::Pose(end) => Self::Pose(*end),
            Goal::Disc(disc) => Self::Discs(slice::from_ref(disc)),
        }
    }
}

impl Target<'_> {
    /// Returns the pose, or the middle of the first disc.
    pub fn position(self) -> DVec2 {
        match self {
            Self::Pose(end) => end.position(),
            Self::Discs(discs) => discs[0].centre,
        }
    }

    /// Returns the position of a truck that counts: of its rear axle for a pose, of its body's centre for discs.
    pub fn position_of(self, pose: Pose, body: &Dimensions) -> DVec2 {
        match self {
            Self::Pose(_) => pose.position(),
            Self::Discs(_) => body.body_centre(pose),
        }
    }

    /// Returns metres in a straight line from a position to the pose, or to the nearest middle of a disc.
    pub fn straight_m(self, from: DVec2) -> f64 {
        match self {
            Self::Pose(end) => from.distance(end.position()),
            Self::Discs(discs) => discs.iter().map(|disc| from.distance(disc.centre)).fold(f64::INFINITY, f64::min),
        }
    }

    /// Returns the place among the discs of the one that a drive ends in; of several, it is the one whose rim is the farthest.
    pub fn disc_of(self, end: Pose, body: &Dimensions) -> usize {
        let Self::Discs(discs) = self else { return 0 };
        let centre = body.body_centre(end);
        let gap = |disc: &GoalDisc| centre.distance(disc.centre) - disc.radius_m;
        let nearest = (0..discs.len()).min_by(|&a, &b| gap(&discs[a]).total_cmp(&gap(&discs[b])));
        nearest.expect("there is a disc")
    }
}
