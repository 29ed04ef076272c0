use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::CollisionChecker;
use crate::geometry::FieldFrame;
use crate::rng::Xoshiro256PlusPlus;

use super::TruckPlanner;
use super::kit::local_search::PrimitiveSettings;
use super::kit::safety::SafetySettings;
use super::memory::{MemoryMeter, PlannerMemory};
use super::planners::hybrid_astar::{HybridAstar, HybridSettings};
use super::planners::lattice::{LatticePlanner, LatticeSettings};
use super::planners::prm_primitives::{PrmPrimitives, PrmSettings};
use super::planners::prm_rs::{PrmRs, PrmRsSettings};

/// How a truck finds its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
pub enum TruckPlannerKind {
    /// A roadmap, and motion primitives along its waypoints.
    #[serde(rename = "prm+primitives")]
    PrmPrimitives,
    /// A roadmap over poses with Reeds-Shepp curves, and a lattice search where it does not serve.
    #[serde(rename = "prm-rs")]
    PrmRs,
    /// A lattice search that looks ahead with Reeds-Shepp curves.
    #[serde(rename = "hybrid-astar")]
    HybridAstar,
    /// A flood over a lattice of poses: slow, and complete at its resolution.
    #[serde(rename = "lattice")]
    Lattice,
}

impl TruckPlannerKind {
    pub const ALL: [Self; 4] = [Self::PrmPrimitives, Self::PrmRs, Self::HybridAstar, Self::Lattice];

    /// As scenarios and tables write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::PrmPrimitives => "prm+primitives",
            Self::PrmRs => "prm-rs",
            Self::HybridAstar => "hybrid-astar",
            Self::Lattice => "lattice",
        }
    }
}

impl fmt::Display for TruckPlannerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for TruckPlannerKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let names = || Self::ALL.map(Self::name).join(", ");
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| format!("expected one of {}", names()))
    }
}

/// The settings of every planner; each looks at its own.
#[derive(Clone, Copy, Debug)]
pub struct TruckPlannerSettings<'a> {
    pub prm: &'a PrmSettings,
    pub primitives: &'a PrimitiveSettings,
    pub prm_rs: &'a PrmRsSettings,
    pub hybrid: &'a HybridSettings,
    pub lattice: &'a LatticeSettings,
    pub safety: &'a SafetySettings,
}

/// The most bytes that a planner takes on a field whose bushes have up to this number of convex corners.
pub fn truck_planner_memory(
    kind: TruckPlannerKind,
    frame: &FieldFrame,
    corners: u64,
    settings: &TruckPlannerSettings<'_>,
) -> PlannerMemory {
    match kind {
        TruckPlannerKind::PrmPrimitives => {
            PrmPrimitives::memory(frame, settings.prm, settings.primitives, settings.safety)
        }
        TruckPlannerKind::PrmRs => PrmRs::memory(frame, corners, settings.prm_rs, settings.hybrid),
        TruckPlannerKind::HybridAstar => HybridAstar::memory(frame, settings.hybrid),
        TruckPlannerKind::Lattice => LatticePlanner::memory(frame, settings.lattice),
    }
}

/// Makes a planner for one body on one field, which reports to `memory` what it holds as it grows; `stream` gives the
/// random stream of a name.
pub fn truck_planner(
    kind: TruckPlannerKind,
    checker: &CollisionChecker,
    memory: &MemoryMeter,
    settings: &TruckPlannerSettings<'_>,
    stream: impl Fn(&str) -> Xoshiro256PlusPlus,
) -> Box<dyn TruckPlanner> {
    match kind {
        TruckPlannerKind::PrmPrimitives => {
            let (prm, primitives) = (settings.prm, settings.primitives);
            Box::new(PrmPrimitives::build(checker, memory, prm, primitives, settings.safety, &mut stream("prm")))
        }
        TruckPlannerKind::PrmRs => {
            let streams = (stream("prm-rs"), stream("shortcuts"));
            Box::new(PrmRs::build(checker, memory, settings.prm_rs, settings.hybrid, streams.0, streams.1))
        }
        TruckPlannerKind::HybridAstar => {
            Box::new(HybridAstar::build(checker, memory, settings.hybrid, stream("shortcuts")))
        }
        TruckPlannerKind::Lattice => Box::new(LatticePlanner::build(checker, memory, settings.lattice)),
    }
}
