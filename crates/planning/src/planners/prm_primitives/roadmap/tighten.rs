//! Tightening of routes: fewer and straighter lines.

use glam::DVec2;

use super::space::FreeSpace;
use super::{Roadmap, RoadmapRoute};

/// The number of halvings of the way that a waypoint is pulled towards the straight line.
const PULLS: u32 = 4;

impl Roadmap {
    /// Drops waypoints that are not needed and pulls the others towards the straight line; all lines stay free and no
    /// path becomes more expensive.
    ///
    /// The last waypoint stays. From each waypoint the farthest one that can be seen and is worth it comes next.
    pub fn tighten(&self, start: DVec2, route: &mut RoadmapRoute) {
        thin(&self.space, start, &mut route.waypoints);
        pull(&self.space, start, &mut route.waypoints);
        let points = std::iter::once(start).chain(route.waypoints.iter().copied());
        route.cost = points.clone().zip(points.skip(1)).map(|(a, b)| self.space.price(a, b)).sum();
    }
}

fn line_is_free(space: &FreeSpace, departs: bool, from: DVec2, to: DVec2) -> bool {
    if departs { space.departure_is_free(from, to) } else { space.line_is_free(from, to) }
}

fn thin(space: &FreeSpace, start: DVec2, waypoints: &mut Vec<DVec2>) {
    let mut kept = 0;
    let mut here = start;
    let mut next = 0;
    while next < waypoints.len() {
        // From the far end, so that the first that is in sight leaves out as many as possible.
        let seen = (next + 1..waypoints.len()).rev().find(|&far: &usize| {
            line_is_free(space, kept == 0, here, waypoints[far])
                && space.costs_no_more(here, &[waypoints[far]], &waypoints[next..=far])
        });
        next = seen.unwrap_or(next);
        here = waypoints[next];
        waypoints[kept] = here;
        kept += 1;
        next += 1;
    }
    waypoints.truncate(kept);
}

/// Moves every inner waypoint towards the nearest point of the line between its neighbours, as far as bisection finds
/// it free and no more expensive.
fn pull(space: &FreeSpace, start: DVec2, waypoints: &mut [DVec2]) {
    for index in 0..waypoints.len().saturating_sub(1) {
        let before = if index == 0 { start } else { waypoints[index - 1] };
        let here = waypoints[index];
        let after = waypoints[index + 1];
        let along = after - before;
        // The waypoints before and after may be the same place.
        let share = ((here - before).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let straight = before + along * share;
        let (mut free, mut width) = (0.0, 1.0);
        for _ in 0..PULLS {
            width *= 0.5;
            let tried = here.lerp(straight, free + width);
            let pulled = here.lerp(straight, free);
            if line_is_free(space, index == 0, before, tried)
                && space.line_is_free(tried, after)
                && space.costs_no_more(before, &[tried, after], &[pulled, after])
            {
                free += width;
            }
        }
        waypoints[index] = here.lerp(straight, free);
    }
}
