//! Positions of idle trucks: places from which they soon reach any fire that may begin.

mod centroids;
mod learned;
mod regions;
mod spread_out;

use super::team::{StagingRule, Team};
use glam::DVec2;
use wildfire_timeline::AgentId;

pub use centroids::Centroids;
pub use learned::LearnedPosts;
pub use regions::{Regions, RegionsFirst};

/// Lets trucks wait where they are.
#[derive(Clone, Copy, Debug)]
pub struct Stay;

impl StagingRule for Stay {
    fn staging_points(&mut self, _: &Team<'_>, _: &[AgentId]) -> Vec<(AgentId, DVec2)> {
        Vec::new()
    }
}
