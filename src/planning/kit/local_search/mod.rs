//! The local search: motion primitives that the truck can drive, along the waypoints of a route.
//!
//! Forward search over a lattice of (x, y, heading) with exact arcs and straights, as in Dolgov, Thrun, Montemerlo and
//! Diebel, "Path planning for autonomous vehicles in unknown semi-structured environments", IJRR 29(5), 2010; sweeps
//! are put off until a motion's turn comes, as in Bohlin and Kavraki, "Path planning using lazy PRM", ICRA 2000.
//! Instead of Reeds-Shepp words, turn-then-straight motions are aimed at waypoints and into goal discs, because any
//! heading will do there; goal poses are met by Reeds-Shepp curves from the nodes expanded near them.
//!
//! Poses are those of the rear axle, places those of the body's centre, in the world frame, metres.

mod floor;
mod search;
mod settings;

pub use floor::Floor;
pub use search::{Ending, Search, Task};
pub use settings::{MotionCost, PrimitiveSettings};

use std::sync::Arc;

use glam::DVec2;

use crate::collision::{CollisionChecker, LEAST_CLEARANCE_M};
use crate::geometry::Pose;
use crate::vehicle::{Path, Segment};

use super::safety::Safety;
use super::shorten::shorten;
use crate::planning::memory::MemoryMeter;
use crate::planning::search_graph::{SearchPhase, SearchRecorder, Searched};
use crate::planning::{Found, FoundBy, Goal, GoalDisc, PlanFailure};

/// Clearances tried in turn, as shares of the wanted one, each with the percentage of the budget that it may spend.
///
/// They add up to 50, because a query may drive twice: along its route, then straight for the goal. What one clearance
/// leaves of its percentage is not handed on.
const LADDER: [(f64, u32); 3] = [(1.0, 8), (0.5, 15), (0.1, 27)];

/// A tight goal pose is asked for this share of its own clearance.
const GOAL_SHARE: f64 = 0.9;

/// A planner of drivable paths for one body on one field.
#[derive(Debug)]
pub struct LocalSearch {
    checker: CollisionChecker,
    settings: PrimitiveSettings,
    search: Search,
    segments: Vec<Segment>,
    expansions: u32,
    recorder: SearchRecorder,
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
            search: Search::new(checker, memory, settings, safety),
            segments: Vec::new(),
            expansions: 0,
            recorder: SearchRecorder::default(),
        }
    }

    /// The most bytes that its searches take.
    pub fn most_bytes(settings: &PrimitiveSettings) -> u64 {
        let most = LADDER.iter().map(|&(_, percent)| part_of(settings.max_expansions, percent)).sum::<u32>();
        Search::most_bytes(most.min(settings.max_expansions))
    }

    pub fn record_searches(&mut self) {
        self.recorder.switch_on();
    }

    /// What all searches since the last time looked at, if that is recorded.
    pub fn take_searched(&mut self) -> Option<Searched> {
        self.recorder.take(SearchPhase::Local)
    }

    /// Begins a new query, which has the whole budget before it.
    pub fn begin(&mut self) {
        self.expansions = 0;
    }

    /// Nodes expanded since the query began.
    pub fn expansions(&self) -> u32 {
        self.expansions
    }

    /// A path from `start` along places for the body's centre into `goal`, which holds the last of them or, if it is a
    /// pose, is near it. A goal pose is free.
    ///
    /// Without places the search makes straight for the goal.
    ///
    /// # Errors
    /// [`PlanFailure::StartBlocked`] when the body touches something at the start; [`PlanFailure::Disconnected`] when
    /// the lattice holds no path; [`PlanFailure::BudgetSpent`] when its search was cut short.
    pub fn drive(&mut self, start: Pose, waypoints: &[DVec2], goal: Goal) -> Result<Found, PlanFailure> {
        let start_clearance = self.checker.clearance(start);
        if start_clearance <= 0.0 {
            return Err(PlanFailure::StartBlocked);
        }
        let mut ending = Ending::Exhausted;
        for (stage, (share, percent)) in LADDER.into_iter().enumerate() {
            let clearance = (share * self.settings.clearance_m).min(self.most_at(goal)).max(LEAST_CLEARANCE_M);
            let floor = Floor::new(clearance, start, start_clearance);
            let budget = self.settings.max_expansions;
            let limit = self.expansions.saturating_add(part_of(budget, percent)).min(budget);
            self.segments.clear();
            ending = self.follow(start, waypoints, goal, floor, limit);
            if ending == Ending::Found {
                let by = match waypoints {
                    _ if stage > 0 => FoundBy::Relaxed,
                    [] => FoundBy::Search,
                    _ => FoundBy::Roadmap,
                };
                return Ok(Found { path: self.finish(start, goal, floor), by });
            }
        }
        Err(if ending == Ending::Exhausted { PlanFailure::Disconnected } else { PlanFailure::BudgetSpent })
    }

    /// More clearance than a goal pose has cannot be kept; a share of it, so that rounding does not decide.
    fn most_at(&self, goal: Goal) -> f64 {
        match goal {
            Goal::Pose(end) => GOAL_SHARE * self.checker.clearance(end),
            Goal::Disc(_) => f64::INFINITY,
        }
    }

    /// One search over all waypoints, or one from each to the next.
    fn follow(&mut self, start: Pose, waypoints: &[DVec2], goal: Goal, floor: Floor, limit: u32) -> Ending {
        let stops = if self.settings.restart_at_waypoints { waypoints.len().saturating_sub(1) } else { 0 };
        let mut pose = start;
        for &waypoint in &waypoints[..stops] {
            let disc = GoalDisc { centre: waypoint, radius_m: self.settings.waypoint_tolerance_m };
            let first = self.segments.len();
            match self.search(pose, &[waypoint], disc.into(), floor, limit) {
                Ending::Found => pose = self.segments[first..].iter().fold(pose, |pose, segment| segment.end(pose)),
                failed => return failed,
            }
        }
        self.search(pose, &waypoints[stops..], goal, floor, limit)
    }

    fn search(&mut self, start: Pose, waypoints: &[DVec2], goal: Goal, floor: Floor, limit: u32) -> Ending {
        let task = Task { checker: &self.checker, floor, start, waypoints, goal };
        let ending = self.search.run(&task, limit.saturating_sub(self.expansions), &mut self.segments);
        self.expansions += self.search.expansions;
        self.recorder.add(self.search.reached());
        ending
    }

    /// The path found, made shorter where that is easy.
    fn finish(&mut self, start: Pose, goal: Goal, floor: Floor) -> Path {
        if let Goal::Disc(goal) = goal
            && self.settings.aimed
        {
            let is_free = |pose, segment| floor.motion_is_free(&self.checker, pose, segment);
            let body = self.checker.body();
            shorten(body, self.search.aiming(), is_free, start, goal, &mut self.segments);
        }
        Path { start, segments: join(&self.segments) }
    }
}

/// A percentage of a budget, rounded up so that none of a small one comes to nothing.
fn part_of(budget: u32, percent: u32) -> u32 {
    (u64::from(budget) * u64::from(percent)).div_ceil(100) as u32
}

/// Segments that continue one another become one.
pub fn join(segments: &[Segment]) -> Vec<Segment> {
    let mut joined: Vec<Segment> = Vec::with_capacity(segments.len());
    for &segment in segments {
        match joined.last_mut() {
            Some(last) if last.curvature == segment.curvature && last.is_reverse() == segment.is_reverse() => {
                last.length_m += segment.length_m;
            }
            _ => joined.push(segment),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_may_spend_half_the_budget_and_every_clearance_a_part() {
        for budget in (1..3_000).chain([u32::MAX]) {
            let parts = LADDER.map(|(_, percent)| part_of(budget, percent));
            assert!(parts.iter().all(|&part| part >= 1), "{budget}: {parts:?}");
            let beyond_half = 2 * parts.iter().map(|&part| i64::from(part)).sum::<i64>() - i64::from(budget);
            assert!((0..6).contains(&beyond_half), "{budget}: {parts:?}");
        }
    }
}
