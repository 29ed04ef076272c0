//! The planner `lattice`: a flood over a lattice of poses, slow, and complete at its resolution.

use serde::{Deserialize, Serialize};

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::time::cpu::CpuStopwatch;

use super::reachability::Reachability;
use super::{BuildReport, Effort, Goal, Plan, PlanFailure, QueryTime, TruckPlanner};

/// What a scenario may choose about the truck's planner `lattice`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSettings {
    /// Planning time charged, during which the truck stands.
    pub seconds_per_expansion: f64,
}

/// The planner for one body on one field.
#[derive(Debug)]
pub struct LatticePlanner {
    checker: CollisionChecker,
}

impl LatticePlanner {
    pub fn build(checker: &CollisionChecker, _settings: &LatticeSettings) -> Self {
        Self { checker: checker.clone() }
    }
}

impl TruckPlanner for LatticePlanner {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut watch = CpuStopwatch::start();
        let path = match goal {
            Goal::Disc(disc) => Reachability::new(&self.checker, start).path_to(disc).ok_or(PlanFailure::Disconnected),
            Goal::Pose(_) => Err(PlanFailure::Disconnected),
        };
        Plan { path, effort: Effort::default(), time: QueryTime { local: watch.lap(), ..QueryTime::default() } }
    }
}
