//! Settings of the planner `prm-rs`, and what scenarios say about it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PrmRs;
use crate::geometry::FieldFrame;
use crate::planning::TruckPlanner;
use crate::planning::memory::PlannerMemory;
use crate::planning::registry::{Charge, MakePlanner, RoadmapSize, Site, TruckPlannerSettings, describe_charge};
use crate::ranges::{OutOfRange, SettingsTable, check_range};

/// Settings of the planner `prm-rs`. Lengths are metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmRsSettings {
    /// Poses to draw, besides those at the corners of bushes.
    pub samples: u32,
    /// Places around every convex corner of a bush at which the truck may pass it, in either direction.
    pub corner_places: u32,
    /// The number of nearest earlier poses to which each is joined.
    pub neighbours: u32,
    /// The highest cost of an edge.
    pub max_edge_m: f64,
    /// Clearance of the body from bushes and border; where that leads nowhere, a third of it, then a twenty-fifth, at
    /// least 1 cm.
    pub clearance_m: f64,
    /// Added for every change between forward and reverse.
    pub cusp_cost: f64,
    /// Shortcuts tried on the path found.
    pub shortcuts: u32,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for PrmRsSettings {
    fn default() -> Self {
        Self {
            samples: 200,
            corner_places: 2,
            neighbours: 16,
            max_edge_m: 40.0,
            clearance_m: 0.6,
            cusp_cost: 2.0,
            shortcuts: 50,
            seconds_per_expansion: 0.0,
        }
    }
}

impl SettingsTable for PrmRsSettings {
    fn check(&self, _: &FieldFrame) -> Result<(), OutOfRange> {
        check_range("samples", self.samples.into(), 0.0..=100_000.0)?;
        check_range("corner_places", self.corner_places.into(), 0.0..=10.0)?;
        check_range("neighbours", self.neighbours.into(), 1.0..=100.0)?;
        check_range("max_edge_m", self.max_edge_m, 0.01..=1e6)?;
        check_range("clearance_m", self.clearance_m, 0.01..=100.0)?;
        check_range("cusp_cost", self.cusp_cost, 0.0..=1e6)?;
        check_range("shortcuts", self.shortcuts.into(), 0.0..=1e6)?;
        check_range("seconds_per_expansion", self.seconds_per_expansion, 0.0..=1e6)
    }
}

/// Makes planners of the name `prm-rs`.
pub struct Maker;

impl MakePlanner for Maker {
    fn make(&self, site: &Site<'_>) -> Box<dyn TruckPlanner> {
        let TruckPlannerSettings { prm_rs, hybrid, .. } = site.settings;
        let (samples, shortcuts) = ((site.stream)("prm-rs"), (site.stream)("shortcuts"));
        Box::new(PrmRs::build(site.checker, site.memory, prm_rs, hybrid.search(), samples, shortcuts))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["prm_rs", "hybrid"]
    }

    fn memory(&self, frame: &FieldFrame, corners: u64, settings: &TruckPlannerSettings<'_>) -> PlannerMemory {
        PrmRs::memory(frame, corners, settings.prm_rs, &settings.hybrid.search())
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: settings.prm_rs.seconds_per_expansion, local_s: settings.hybrid.seconds_per_expansion }
    }

    fn describe(&self, settings: &TruckPlannerSettings<'_>) -> String {
        let TruckPlannerSettings { prm_rs, hybrid, .. } = settings;
        format!(
            "Roadmap of {} poses, and {} places at every corner of a bush, each joined to {} others within {} m by \
             Reeds-Shepp curves, {} m clear, a change of direction at the price of {} m, then {} shortcuts; where it \
             does not serve, hybrid A* with at most {} expansions; {}.",
            prm_rs.samples,
            prm_rs.corner_places,
            prm_rs.neighbours,
            prm_rs.max_edge_m,
            prm_rs.clearance_m,
            prm_rs.cusp_cost,
            prm_rs.shortcuts,
            hybrid.max_expansions,
            describe_charge(prm_rs.seconds_per_expansion)
        )
    }

    fn roadmap_size(&self, settings: &TruckPlannerSettings<'_>, bushes: usize) -> Option<RoadmapSize> {
        let PrmRsSettings { samples, corner_places, neighbours, max_edge_m, .. } = *settings.prm_rs;
        let at_corners = 4 * bushes as u64 * u64::from(corner_places);
        Some(RoadmapSize { milestones: u64::from(samples) + at_corners, neighbours, max_edge_m })
    }
}
