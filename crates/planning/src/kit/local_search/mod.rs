//! The local search: motion primitives that the truck can drive, along the waypoints of a route.
//!
//! It is the search of [`super::best_first`]. Instead of Reeds-Shepp words, turns and straights are steered to waypoints
//! and into goal discs, because any heading will do there; goal poses are met by Reeds-Shepp curves from the nodes
//! expanded near them.
//!
//! Poses are those of the rear axle, positions those of the body's centre, in the world frame, metres.

mod search;
mod settings;

pub use search::{PrimitiveQuery, PrimitiveSearch};
pub use settings::{MotionCost, PrimitiveSettings};

use std::sync::Arc;

use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::memory::MemoryMeter;
use crate::observer::PlanningObserver;
use crate::{Found, FoundBy, Goal, GoalDisc, PlanFailure};
use wildfire_base::geometry::Pose;
use wildfire_base::query::SearchPhase;
use wildfire_base::vehicle::Path;

use super::best_first::SearchFailure;
use super::clearance_profile::{ClearanceProfile, END_SHARE};
use super::relaxation::Stage;
use super::safety::Safety;

/// The effort of a stage is the percentage of the budget that it may spend.
///
/// They add up to 50, because a query may drive twice: along its route, then straight for the goal. What one stage leaves
/// of its percentage is not handed on.
const SCHEDULE: [Stage<u32>; 3] =
    [Stage { share: 1.0, effort: 8 }, Stage { share: 0.5, effort: 15 }, Stage { share: 0.1, effort: 27 }];

/// A planner of drivable paths for one body on one field.
#[derive(Debug)]
pub struct LocalSearch {
    checker: CollisionChecker,
    settings: PrimitiveSettings,
    search: PrimitiveSearch,
    expansions: u32,
}

impl LocalSearch {
    pub fn new(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: &PrimitiveSettings,
        safety: Option<Arc<Safety>>,
    ) -> Self {
        Self {
            checker: checker.clone(),
            settings: settings.clone(),
            search: PrimitiveSearch::new(checker, memory, settings, safety),
            expansions: 0,
        }
    }

    /// Begins a new query with its whole budget.
    pub fn begin(&mut self) {
        self.expansions = 0;
    }

    /// Returns the nodes expanded since the query began.
    pub fn expansions(&self) -> u32 {
        self.expansions
    }

    /// Finds a path from `start` along positions for the body's centre into `goal`, which contains the last of them or,
    /// if it is a pose, is near it. A goal pose is free.
    ///
    /// Without waypoints the search makes straight for the goal.
    ///
    /// # Errors
    /// [`PlanFailure::StartBlocked`] when the body touches something at the start; [`PlanFailure::Disconnected`] when
    /// the lattice holds no path; [`PlanFailure::BudgetSpent`] when its search was cut short.
    pub fn drive(
        &mut self,
        start: Pose,
        waypoints: &[DVec2],
        goal: Goal,
        observer: &mut dyn PlanningObserver,
    ) -> Result<Found, PlanFailure> {
        let start_clearance = self.checker.clearance(start);
        if start_clearance <= 0.0 {
            return Err(PlanFailure::StartBlocked);
        }
        // More clearance than a goal pose has cannot be kept; a share of it, so that rounding does not decide.
        let max_m = match goal {
            Goal::Pose(end) => END_SHARE * self.checker.clearance(end),
            Goal::Disc(_) => f64::INFINITY,
        };
        // The last stage asks for the least clearance, so how its search ends tells whether there is a path at all.
        let mut ending = SearchFailure::Exhausted;
        for stage in SCHEDULE {
            let min_clearance_m = stage.min_clearance_m(self.settings.clearance_m, max_m);
            let profile = ClearanceProfile::from_start(min_clearance_m, start, start_clearance);
            let budget = self.settings.max_expansions;
            // What a stage did not spend falls to none of the later ones: each has its own part of the budget.
            let limit = self.expansions.saturating_add(part_of(budget, stage.effort)).min(budget);
            // A copy, as `follow` borrows all of `self`.
            let query = PrimitiveQuery { checker: &self.checker.clone(), profile: &profile, start, waypoints, goal };
            match self.follow(&query, limit, observer) {
                Ok(mut path) => {
                    if let Goal::Disc(disc) = goal
                        && self.settings.aimed
                    {
                        // An aimed way may end deeper in the disc than it has to.
                        self.search.steering().shorten_end(&mut path, disc, |pose, segment| {
                            profile.motion_is_free(&self.checker, pose, segment)
                        });
                    }
                    let by = match waypoints {
                        _ if stage.is_relaxed() => FoundBy::Relaxed,
                        [] => FoundBy::Search,
                        _ => FoundBy::Roadmap,
                    };
                    return Ok(Found { path: path.joined(), by });
                }
                Err(failed) => ending = failed,
            }
        }
        Err(match ending {
            SearchFailure::Exhausted => PlanFailure::Disconnected,
            SearchFailure::BudgetSpent => PlanFailure::BudgetSpent,
        })
    }

    /// Makes one search over all waypoints, or one from each to the next.
    fn follow(
        &mut self,
        query: &PrimitiveQuery<'_>,
        limit: u32,
        observer: &mut dyn PlanningObserver,
    ) -> Result<Path, SearchFailure> {
        let PrimitiveQuery { waypoints, goal, .. } = *query;
        // The last waypoint is passed on the way into the goal, so it is not a stop.
        let stops = if self.settings.restart_at_waypoints { waypoints.len().saturating_sub(1) } else { 0 };
        let mut path = Path::standing(query.start);
        let mut pose = query.start;
        for stop in 0..=stops {
            let (waypoints, goal) = if stop < stops {
                let disc = GoalDisc { centre: waypoints[stop], radius_m: self.settings.waypoint_tolerance_m };
                (&waypoints[stop..=stop], disc.into())
            } else {
                (&waypoints[stops..], goal)
            };
            let leg = PrimitiveQuery { start: pose, waypoints, goal, ..*query };
            // The budget is that of the whole route: legs before may have spent it.
            let found = self.search.run(&leg, limit.saturating_sub(self.expansions));
            self.expansions += self.search.expansions();
            // A search that failed is counted and shown as well, so both come before the error is returned.
            observer.on_edges_examined(SearchPhase::Local, &mut self.search.lines());
            let found = found?;
            pose = found.end();
            path.segments.extend(found.segments);
        }
        Ok(path)
    }
}

/// Returns a percentage of a budget, rounded up so that none of a small one comes to nothing.
fn part_of(budget: u32, percent: u32) -> u32 {
    (u64::from(budget) * u64::from(percent)).div_ceil(100) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_may_spend_half_the_budget_and_every_clearance_a_part() {
        for budget in (1..3_000).chain([u32::MAX]) {
            let parts = SCHEDULE.map(|stage| part_of(budget, stage.effort));
            assert!(parts.iter().all(|&part| part >= 1), "{budget}: {parts:?}");
            let beyond_half = 2 * parts.iter().map(|&part| i64::from(part)).sum::<i64>() - i64::from(budget);
            assert!((0..6).contains(&beyond_half), "{budget}: {parts:?}");
        }
    }
}
