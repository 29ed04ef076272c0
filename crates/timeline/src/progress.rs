//! The activity of an agent, derived from the facts about it.

use serde::Serialize;

use super::{AgentFact, Fact};
use wildfire_base::geometry::{Cell, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{MotionState, Trajectory};

/// The activity of an agent, as of its latest fact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Activity {
    /// None of the others.
    Standing,
    /// Planning time is charged: until the start of the planned leg, or until the end of a failed plan.
    Planning,
    /// The agent moves: from the start to the end of a leg with pieces, including the rest of a dropped leg; a Wumpus
    /// walks. A wait at the beginning does not count.
    Driving,
    /// From `Suppressing` until this truck extinguishes something, its suppression ends, or it drops its goal.
    Suppressing,
    /// A truck waits for another one: after `Blocked` until the next plan or rest, and while a leg begins with a wait.
    Waiting,
    /// The truck fills its tank.
    Refilling,
}

wildfire_base::names! { Activity {
    Standing: "standing",
    Planning: "planning",
    Driving: "driving",
    Suppressing: "suppressing",
    Waiting: "waiting",
    Refilling: "refilling",
} }

/// The part of an agent's state that facts change; everything else follows from the time.
#[derive(Clone, Copy, Debug)]
pub struct AgentProgress<'a> {
    start: Pose,
    leg: Option<&'a Trajectory>,
    planning_until: SimTime,
    refilling_until: SimTime,
    suppresses: bool,
    is_blocked: bool,
    pub goal: Option<Cell>,
}

impl<'a> AgentProgress<'a> {
    pub fn standing(start: Pose) -> Self {
        let planning_until = SimTime::ZERO;
        let refilling_until = SimTime::ZERO;
        Self { start, leg: None, planning_until, refilling_until, suppresses: false, is_blocked: false, goal: None }
    }

    /// Applies a fact of this agent.
    pub fn apply(&mut self, fact: &'a Fact) {
        let fact = match fact {
            Fact::Agent(_, fact) => fact,
            // It lit the cell, or put it out.
            Fact::Fire(_) => return self.give_up_goal(),
            Fact::Ended { .. } => return,
        };
        match fact {
            AgentFact::Planned { goal, trajectory, .. } => self.follow(trajectory, Some(*goal)),
            AgentFact::Dropped { trajectory, .. }
            | AgentFact::GaveWay { trajectory, .. }
            | AgentFact::Relocated { trajectory, .. }
            | AgentFact::Halted { trajectory } => {
                self.follow(trajectory, None);
            }
            AgentFact::Blocked { .. } => self.is_blocked = true,
            AgentFact::PlanFailed { until, .. } | AgentFact::RelocationFailed { until, .. } => {
                self.planning_until = *until;
            }
            AgentFact::Refilling { until } => {
                self.give_up_goal();
                self.refilling_until = *until;
            }
            AgentFact::Suppressing { .. } => self.suppresses = true,
            AgentFact::SuppressionEnded { .. } | AgentFact::Rested { .. } | AgentFact::LocalMinimum { .. } => {
                self.give_up_goal();
            }
            AgentFact::StartMoved { .. }
            | AgentFact::RoadmapBuilt { .. }
            | AgentFact::OutOfReach { .. }
            | AgentFact::Searched { .. } => {}
        }
    }

    /// Follows a leg from now on; planning time is charged until it begins.
    fn follow(&mut self, leg: &'a Trajectory, goal: Option<Cell>) {
        // A leg ends whatever the agent did before.
        *self = Self { leg: Some(leg), planning_until: leg.start_time(), goal, ..Self::standing(self.start) };
    }

    /// Applies an ignition or extinction on the ground: the agent's goal, or a fire beside it.
    pub fn change_ground(&mut self) {
        self.give_up_goal();
    }

    fn give_up_goal(&mut self) {
        self.goal = None;
        self.suppresses = false;
        self.is_blocked = false;
    }

    pub fn activity(&self, time: SimTime) -> Activity {
        if self.suppresses {
            Activity::Suppressing
        } else if let Some(leg) =
            self.leg.filter(|leg| !leg.pieces().is_empty() && leg.start_time() <= time && time < leg.end_time())
        {
            if time < leg.sets_out_at() { Activity::Waiting } else { Activity::Driving }
        } else if time < self.planning_until {
            Activity::Planning
        } else if time < self.refilling_until {
            Activity::Refilling
        } else if self.is_blocked {
            Activity::Waiting
        } else {
            Activity::Standing
        }
    }

    /// Returns the first time after `time` at which the activity may change without a fact.
    pub fn next_change(&self, time: SimTime) -> Option<SimTime> {
        let leg = self.leg.map(|leg| [leg.start_time(), leg.sets_out_at(), leg.end_time()]);
        leg.into_iter()
            .flatten()
            .chain([self.planning_until, self.refilling_until])
            .filter(|&change| change > time)
            .min()
    }

    pub fn motion_at(&self, time: SimTime) -> MotionState {
        self.leg.map_or(MotionState::standing(self.start), |leg| leg.state_at(time))
    }
}
