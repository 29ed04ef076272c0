//! Policies for a whole team of trucks: which truck goes to which fire, and where idle trucks wait.
//!
//! A decision is a pure function of a [`Team`], and of a policy's own memory, which holds no more than counts of bushes: no
//! clock, no chance. Distances are straight and drives a factor longer; roads, bodies and traffic are the business of
//! planners. Ties go to less time, then to the smaller cell index, then to the smaller number of a truck.
//!
//! | rule | decides | for whom |
//! |---|---|---|
//! | [`NearestSavable`] | always the pair that is done first, hopeless fires left alone | free trucks |
//! | [`Hungarian`] | the least sum of times and losses | free trucks |
//! | [`ThreatFirst`] | the most threatening fire, by the nearest truck | free trucks |
//! | [`Auction`] | routes of several fires, won one by one | all that may change their minds |
//! | [`Rollout`] | whichever loses least in forecasts | all that may change their minds |

mod auction;
mod forecast;
mod hungarian;
mod idle;
mod nearest;
mod nearest_by_drive;
mod nearest_savable;
mod of_scenario;
mod open_fires;
mod place_index;
mod policy;
mod rollout;
#[cfg(test)]
mod samples;
mod team;
mod threat;
mod threat_first;

use std::sync::Arc;

use super::learned::Networks;

pub use auction::Auction;
pub use hungarian::Hungarian;
pub use idle::{Centroids, LearnedPosts, Regions, RegionsFirst, Stay};
pub use nearest::NearestByNumber;
pub use nearest_by_drive::NearestByDrive;
pub use nearest_savable::NearestSavable;
pub use of_scenario::policy_of;
pub use rollout::Rollout;
pub use team::{AS_GOOD_M, Assignment, Fire, Intact, StagingRule, Team, TeamRules, TeamTruck, WAY_FACTOR};
pub use threat_first::ThreatFirst;

/// A rule of who goes to which fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssignmentRule {
    /// One truck after the other, by number.
    Nearest,
    /// The same by drive.
    NearestByDrive,
    NearestSavable,
    Hungarian,
    ThreatFirst,
    Auction,
    /// With so many forecasts for a decision at most.
    Rollout {
        rollouts: u32,
    },
}

/// A rule of where trucks wait that have nothing to go for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdleRule {
    Stay,
    Centroids,
    /// Trucks also serve their own regions first.
    Regions,
    /// By learned weights of bushes.
    Learned,
}

/// Makes the two halves of a team's policy, which are asked in turn for one run.
pub fn make(rule: AssignmentRule, idle: IdleRule, networks: &Networks) -> (Box<dyn Assignment>, Box<dyn StagingRule>) {
    let assignment: Box<dyn Assignment> = match rule {
        AssignmentRule::Nearest => Box::new(NearestByNumber),
        AssignmentRule::NearestByDrive => Box::new(NearestByDrive),
        AssignmentRule::NearestSavable => Box::new(NearestSavable),
        AssignmentRule::Hungarian => Box::new(Hungarian),
        AssignmentRule::ThreatFirst => Box::new(ThreatFirst),
        AssignmentRule::Auction => Box::new(Auction),
        AssignmentRule::Rollout { rollouts } => Box::new(Rollout { rollouts }),
    };
    match idle {
        IdleRule::Stay => (assignment, Box::new(Stay)),
        IdleRule::Centroids => (assignment, Box::<Centroids>::default()),
        IdleRule::Learned => (assignment, Box::new(LearnedPosts::new(Arc::clone(&networks.posts)))),
        IdleRule::Regions => (Box::new(RegionsFirst(assignment)), Box::<Regions>::default()),
    }
}
