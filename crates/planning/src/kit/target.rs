//! The places where a search may end: the goal of a query, or any of several.

use std::slice;

use glam::DVec2;

use crate::{Goal, GoalDisc};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::Dimensions;

/// The places where a drive may end.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// The rear axle reaches this pose.
    Pose(Pose),
    /// The body's centre reaches any of these discs; there is at least one.
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
    /// Returns the pose's position, or the centre of the first disc.
    pub fn position(self) -> DVec2 {
        match self {
            Self::Pose(end) => end.position(),
            Self::Discs(discs) => discs[0].centre,
        }
    }

    /// Returns the relevant position of a truck: of its rear axle for a pose, of its body's centre for discs.
    pub fn position_of(self, pose: Pose, body: &Dimensions) -> DVec2 {
        match self {
            Self::Pose(_) => pose.position(),
            Self::Discs(_) => body.body_centre(pose),
        }
    }

    /// Returns the straight distance in metres from a position to the pose, or to the nearest centre of a disc.
    pub fn straight_m(self, from: DVec2) -> f64 {
        match self {
            Self::Pose(end) => from.distance(end.position()),
            Self::Discs(discs) => discs.iter().map(|disc| from.distance(disc.centre)).fold(f64::INFINITY, f64::min),
        }
    }

    /// Returns the index of the disc that a drive ends in; of several, the one whose rim is farthest.
    pub fn disc_of(self, end: Pose, body: &Dimensions) -> usize {
        let Self::Discs(discs) = self else { return 0 };
        let centre = body.body_centre(end);
        let gap = |disc: &GoalDisc| centre.distance(disc.centre) - disc.radius_m;
        let nearest = (0..discs.len()).min_by(|&a, &b| gap(&discs[a]).total_cmp(&gap(&discs[b])));
        nearest.expect("there is a disc")
    }
}
