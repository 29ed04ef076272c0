//! Settings of the planner `lattice`, and what scenarios say about it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::LatticePlanner;
use crate::geometry::FieldFrame;
use crate::planning::TruckPlanner;
use crate::planning::memory::PlannerMemory;
use crate::planning::reachability::LATTICES;
use crate::planning::registry::{Charge, MakePlanner, Site, TruckPlannerSettings, describe_charge};
use crate::ranges::{OutOfRange, SettingsTable, check_range};

/// Settings of the planner `lattice`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LatticeSettings {
    /// Poses from which the floods of one query may spread. The finest flood alone can take 2.9 million on 250 m x 250 m.
    pub max_expansions: u32,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for LatticeSettings {
    fn default() -> Self {
        Self { max_expansions: 4_000_000, seconds_per_expansion: 0.0 }
    }
}

impl SettingsTable for LatticeSettings {
    fn check(&self, _: &FieldFrame) -> Result<(), OutOfRange> {
        check_range("max_expansions", self.max_expansions.into(), 1.0..=1e8)?;
        check_range("seconds_per_expansion", self.seconds_per_expansion, 0.0..=1e6)
    }
}

/// Makes planners of the name `lattice`.
pub struct Maker;

impl MakePlanner for Maker {
    fn make(&self, site: &Site<'_>) -> Box<dyn TruckPlanner> {
        Box::new(LatticePlanner::build(site.checker, site.memory, site.settings.lattice))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["lattice"]
    }

    fn memory(&self, frame: &FieldFrame, _: u64, settings: &TruckPlannerSettings<'_>) -> PlannerMemory {
        LatticePlanner::memory(frame, settings.lattice)
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: 0.0, local_s: settings.lattice.seconds_per_expansion }
    }

    fn describe(&self, settings: &TruckPlannerSettings<'_>) -> String {
        let [coarse, middle, fine] =
            LATTICES.map(|lattice| format!("{} m and {} headings", lattice.bin_m, lattice.headings));
        format!(
            "Flood over a lattice of poses: one pose in bins of {coarse}, where that fails of {middle}, then of \
             {fine}; a query spreads from at most {} poses; {}.",
            settings.lattice.max_expansions,
            describe_charge(settings.lattice.seconds_per_expansion)
        )
    }
}
