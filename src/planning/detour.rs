//! The way round what stands on a path that was planned without it, for instance another truck.

use crate::collision::CollisionChecker;
use crate::vehicle::Path;

use super::kit::local_search::{LocalSearch, PrimitiveSettings};
use super::memory::MemoryMeter;
use super::{Effort, GoalDisc};

/// A detour leaves the path so many metres before the place where it is blocked.
const LEAVE_M: f64 = 20.0;

/// Nodes that the search for one detour may expand.
const MAX_EXPANSIONS: u32 = 250;

/// A path into a disc that begins like `path`, which is blocked after `free_m` metres, and the effort of finding it.
///
/// `checker` knows what stands in the way. The detour leaves the path shortly before or, if that leads nowhere, at its
/// start. It is a motion-primitive search straight for the disc, short and without a roadmap, because what stands in
/// the way is somewhere else each time.
pub fn detour(checker: &CollisionChecker, path: &Path, free_m: f64, disc: GoalDisc) -> (Option<Path>, Effort) {
    let settings = PrimitiveSettings { max_expansions: MAX_EXPANSIONS, ..PrimitiveSettings::default() };
    let mut search = LocalSearch::new(checker, &MemoryMeter::unlimited(), &settings, None);
    let mut from = |metres: f64| {
        let (kept, _) = path.split_at(metres);
        let rest = search.drive(kept.end(), &[], disc.inner().into()).ok()?;
        Some(Path { start: kept.start, segments: kept.segments.into_iter().chain(rest.path.segments).collect() })
    };
    let late = (free_m > LEAVE_M).then(|| from(free_m - LEAVE_M)).flatten();
    let path = late.or_else(|| from(0.0));
    (path, Effort { roadmap_expansions: 0, local_expansions: search.expansions() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::planning::test_fields::{TestField, assert_drivable};
    use crate::vehicle::Segment;
    use glam::DVec2;

    #[test]
    fn a_detour_leads_round_what_stands_on_the_path_and_nowhere_through_it() {
        let start = Pose::new(10.0, 50.0, 0.0);
        let open = TestField::drawn(&["...................."; 20], start);
        let lane = TestField::drawn(&["####################", "....................", "####################"], start);
        let ahead = |metres: f64| Path { start, segments: vec![Segment { curvature: 0.0, length_m: metres }] };
        let disc = GoalDisc { centre: DVec2::new(90.0, 50.0), radius_m: 10.0 };
        let body = *open.checker.body();
        let crowded = open.checker.with_obstacles([body.footprint(Pose::new(60.0, 50.0, 1.5))]);
        let (path, effort) = detour(&crowded, &ahead(75.0), 45.0, disc);
        let path = path.expect("the field is wide");
        assert_drivable(&crowded, &path, start, disc);
        assert!(path.length_m() < 85.0 && effort.local_expansions > 0, "{path:?}");
        assert_eq!(path.pose_at(24.9), ahead(75.0).pose_at(24.9), "it leaves the path shortly before");

        let start = Pose::new(10.0, 7.5, 0.0);
        let crowded = lane.checker.with_obstacles([body.footprint(Pose::new(60.0, 7.5, 0.0))]);
        let disc = GoalDisc { centre: DVec2::new(90.0, 7.5), radius_m: 10.0 };
        assert!(detour(&crowded, &Path { start, ..ahead(75.0) }, 45.0, disc).0.is_none());
    }
}
