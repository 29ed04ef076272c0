//! The fire that is nearest by drive. [`NearestByNumber`] decides which trucks get a fire; the truck's planner decides
//! which one, among those nearest in a straight line.

use super::nearest::NearestByNumber;
use super::team::{Assignment, Team};
use crate::policies::{Action, Observation, Policy};
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Assigns each truck the fire that is left and nearest by drive.
#[derive(Clone, Copy, Debug)]
pub struct NearestByDrive;

impl Assignment for NearestByDrive {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        NearestByNumber.assign(team, effort)
    }

    fn replans(&self) -> bool {
        NearestByNumber.replans()
    }

    fn is_by_drive(&self) -> bool {
        true
    }
}

/// The same where nobody is sent to a place to wait: each truck chooses when those before it have acted.
impl Policy for NearestByDrive {
    fn choose(&mut self, _: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        queried.first().map(|&truck| (truck, Action::GoToNearest)).into_iter().collect()
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(*self))
    }
}
