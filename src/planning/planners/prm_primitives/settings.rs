//! Settings of the planner `prm+primitives`, and what scenarios say about it.
//!
//! Defaults are those of the scenario `contest`. Lengths are metres.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PrmPrimitives;
use crate::geometry::FieldFrame;
use crate::planning::TruckPlanner;
use crate::planning::memory::PlannerMemory;
use crate::planning::registry::{Charge, MakePlanner, RoadmapSize, Site, TruckPlannerSettings, describe_charge};
use crate::ranges::{OutOfRange, SettingsTable, check_range};
use crate::vehicle::Dimensions;

/// The probabilistic roadmap over the truck's body centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrmSettings {
    /// Milestones to draw.
    pub samples: u32,
    /// The number of nearest milestones to which each is joined, those to which the straight line is free.
    pub neighbours: u32,
    /// The longest edge.
    pub max_edge_m: f64,
    /// Free radius around milestones and along edges.
    pub clearance_m: f64,
    pub clearance_to: ClearanceTo,
    pub search: RoadmapSearch,
    pub goal: RoadmapGoal,
    /// Simulated planning time charged, during which the truck stands still.
    pub seconds_per_expansion: f64,
}

impl Default for PrmSettings {
    fn default() -> Self {
        Self {
            samples: 500,
            neighbours: 10,
            max_edge_m: 30.0,
            clearance_m: 1.75,
            clearance_to: ClearanceTo::Cells,
            search: RoadmapSearch::Astar,
            goal: RoadmapGoal::InReach,
            seconds_per_expansion: 0.0,
        }
    }
}

/// The obstacles from which milestones and edges keep their clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClearanceTo {
    /// From the nearest edge of a bush, and from the field's border.
    Cells,
    /// From the nearest centre of a bush cell, as the original program has it; the border only encloses them.
    CellCentres,
}

/// The search on the roadmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapSearch {
    Astar,
    Dijkstra,
    /// Best first by straight-line distance to the goal alone.
    Greedy,
}

/// The milestones that are the goals of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RoadmapGoal {
    /// Those from which the fire can be reached; the drive ends in the goal disc.
    InReach,
    /// The one nearest to the fire, of those from which it can be reached; the drive ends about that milestone, where
    /// the fire is in reach.
    NearestMilestone,
}

impl SettingsTable for PrmSettings {
    fn check(&self, _: &FieldFrame) -> Result<(), OutOfRange> {
        check_range("samples", self.samples.into(), 0.0..=100_000.0)?;
        check_range("neighbours", self.neighbours.into(), 1.0..=100.0)?;
        check_range("max_edge_m", self.max_edge_m, 0.01..=1e6)?;
        check_range("clearance_m", self.clearance_m, 0.0..=1000.0)?;
        check_range("seconds_per_expansion", self.seconds_per_expansion, 0.0..=1e6)
    }
}

/// Makes planners of the name `prm+primitives`.
pub struct Maker;

impl MakePlanner for Maker {
    fn make(&self, site: &Site<'_>) -> Box<dyn TruckPlanner> {
        let TruckPlannerSettings { prm, primitives, safety, .. } = site.settings;
        let mut rng = (site.stream)("prm");
        Box::new(PrmPrimitives::build(site.checker, site.memory, prm, primitives, safety, &mut rng))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["prm", "primitives", "safety"]
    }

    fn memory(&self, frame: &FieldFrame, _: u64, settings: &TruckPlannerSettings<'_>) -> PlannerMemory {
        PrmPrimitives::memory(frame, settings.prm, settings.primitives, settings.safety)
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: settings.prm.seconds_per_expansion, local_s: settings.primitives.seconds_per_expansion }
    }

    fn describe(&self, settings: &TruckPlannerSettings<'_>) -> String {
        let TruckPlannerSettings { prm, primitives: local, safety, .. } = settings;
        let search = match prm.search {
            RoadmapSearch::Astar => "A*",
            RoadmapSearch::Dijkstra => "Dijkstra's search",
            RoadmapSearch::Greedy => "greedy search",
        };
        let goal = match prm.goal {
            RoadmapGoal::InReach => "milestones from which the fire is in reach",
            RoadmapGoal::NearestMilestone => "the milestone nearest to the fire, of those from which it is in reach",
        };
        let roadmap = format!(
            "Roadmap of {} samples, {} neighbours each, edges up to {} m, {} m clear; {search} to {goal}; {}.",
            prm.samples,
            prm.neighbours,
            prm.max_edge_m,
            prm.clearance_m,
            describe_charge(prm.seconds_per_expansion)
        );
        format!(
            "{roadmap} Local search with motions of {} m, bins of {} m and {} headings, {} m clear, at most {} \
             expansions; {}.{}",
            local.step_m,
            local.bin_m,
            local.headings,
            local.clearance_m,
            local.max_expansions,
            describe_charge(local.seconds_per_expansion),
            safety.describe()
        )
    }

    fn roadmap_size(&self, settings: &TruckPlannerSettings<'_>, _: usize) -> Option<RoadmapSize> {
        let PrmSettings { samples, neighbours, max_edge_m, .. } = *settings.prm;
        Some(RoadmapSize { milestones: samples.into(), neighbours, max_edge_m })
    }

    fn warning(&self, settings: &TruckPlannerSettings<'_>, body: &Dimensions, truck: &str) -> Option<String> {
        let clearance_m = settings.prm.clearance_m;
        (clearance_m < 0.5 * body.width_m).then(|| {
            format!(
                "The roadmap of {truck} keeps {clearance_m} m clear, less than half the truck's width: it may lead \
                 where the truck cannot go."
            )
        })
    }
}
