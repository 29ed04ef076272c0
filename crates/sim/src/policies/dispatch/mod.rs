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
mod sight;
mod team;
mod threat;
mod threat_first;

pub use auction::Auction;
pub use hungarian::Hungarian;
pub use idle::{Centroids, LearnedPosts, Regions, RegionsFirst, Stay};
pub use nearest::NearestByNumber;
pub use nearest_by_drive::NearestByDrive;
pub use nearest_savable::NearestSavable;
pub use of_scenario::{DispatchRules, policy_of};
pub use rollout::Rollout;
pub use sight::TeamSight;
pub use team::{AS_GOOD_M, Assignment, Fire, Intact, StagingRule, Team, TeamRules, TeamTruck, WAY_FACTOR};
pub use threat_first::ThreatFirst;
