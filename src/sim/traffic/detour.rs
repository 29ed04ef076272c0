//! The way round trucks that stand in the way.

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::planning::{GoalDisc, HybridAstar, HybridSettings, Plan, TruckPlanner};
use crate::rng::Xoshiro256PlusPlus;

use super::Traffic;

/// Nodes that the search for one way round may expand.
const MAX_EXPANSIONS: u32 = 2_000;

/// Plans ways round other trucks, whatever planner the truck has: the field is another one each time, so that no
/// roadmap could be kept.
#[derive(Debug)]
pub struct Detours {
    checker: CollisionChecker,
    settings: HybridSettings,
    rng: Xoshiro256PlusPlus,
}

impl Detours {
    pub fn new(checker: &CollisionChecker, settings: &HybridSettings, rng: Xoshiro256PlusPlus) -> Self {
        let settings =
            HybridSettings { max_expansions: MAX_EXPANSIONS.min(settings.max_expansions), ..settings.clone() };
        Self { checker: checker.clone(), settings, rng }
    }

    pub fn checker(&self) -> &CollisionChecker {
        &self.checker
    }

    /// A path into a disc round the others where they come to rest.
    pub fn plan(&self, traffic: Traffic<'_>, pose: Pose, disc: GoalDisc) -> Plan {
        HybridAstar::build(&traffic.crowd(&self.checker), &self.settings, self.rng.clone()).plan(pose, disc.into())
    }
}
