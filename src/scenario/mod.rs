//! Scenarios, which users write: field, fire, agents, score; with defaults, checks and terrain generation.
//!
//! [`load`] turns a name or a path into a [`Scenario`] that is complete and checked: it reads the TOML text, makes the
//! changes of the command line, fills in the defaults, reads the map if the field is given, and refuses what cannot be
//! simulated, with the place of the fault. [`Terrain::from_scenario`] gives the field of a run, [`explain`] puts a scenario
//! into sentences.
//!
//! Every default is the value of the built-in scenario `contest`. Lengths are metres, times seconds, in the world
//! frame of [`crate::geometry`]. The format is described in `scenarios/README.md`.

mod agents;
mod change;
mod check;
mod error;
mod explain;
mod explain_agents;
mod field;
mod given;
mod json_place;
mod load;
mod memory;
mod or_none;
mod path;
mod problem;
mod rules;
mod sketch;
mod source;
mod terrain;
mod tetromino;
mod warnings;
mod wording;

pub use agents::{
    Escape, Limits, Retarget, StartPose, StepCost, StepTime, TruckGoal, Unimog, Wumpus, WumpusGoal, WumpusHeuristic,
    WumpusPlanner, WumpusPotential,
};
pub use error::{Fault, ScenarioError, SourceLocation, nearest_name};
pub use explain::explain;
pub use field::{Field, MAX_CELLS_A_SIDE, MAX_COVERAGE, Overlaps};
pub use given::{GivenField, MapError, MapFault};
pub use load::{LoadedScenario, load};
pub use memory::{MemoryEstimate, MemoryExceeded, MemoryLimit, MemoryPart, bytes_text};
pub use problem::{MAX_GOALS, Problem};
pub use rules::{Extinguishes, Fire, Ignition, IgnitionCells, Score, SpreadFrom, Suppression};
pub use source::{
    BUILT_IN, MAX_MAP_BYTES, MAX_SCENARIO_BYTES, ScenarioText, can_be_read_again, first_too_deep, toml_value,
};
pub use terrain::{Terrain, TerrainError};
pub use tetromino::Shape;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::DVec2;
use crate::input_file::list_of_at_most;
pub use crate::planning::{
    ClearanceTo, HybridSettings, LatticeSettings, MotionCost, PrimitiveSettings, PrmRsSettings, PrmSettings,
    RoadmapGoal, RoadmapSearch, SafetyForm, SafetyMap, SafetySettings, TruckPlannerKind,
};

/// Builds the JSON Schema of scenario files.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(Scenario)
}

/// A contest: where, under which rules, between whom, for how long.
///
/// The limits on lists here only keep other files from filling the memory; [`Self::check`] sets lower ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    #[serde(default)]
    pub name: String,
    #[serde(default = "defaults::duration_s")]
    pub duration_s: f64,
    #[serde(default)]
    pub field: Field,
    #[serde(default)]
    pub fire: Fire,
    #[serde(default)]
    pub suppression: Suppression,
    #[serde(default)]
    pub score: Score,
    #[serde(deserialize_with = "list_of_at_most::<1_000, _, _>")]
    pub wumpus: Vec<Wumpus>,
    #[serde(deserialize_with = "list_of_at_most::<1_000, _, _>")]
    pub unimog: Vec<Unimog>,
    #[serde(default, deserialize_with = "list_of_at_most::<100_000, _, _>")]
    pub ignition: Vec<Ignition>,
}

impl Scenario {
    /// Checks a scenario that does not come from [`load`] as that would.
    ///
    /// # Errors
    /// Returns the first value that is refused.
    pub fn check(&self) -> Result<(), Fault> {
        check::check(self).map_err(|refusal| refusal.fault())
    }

    /// Lists the body centres of all agents at their starts, Wumpuses first.
    pub fn start_centres(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.wumpus.iter().map(Wumpus::start_centre).chain(self.unimog.iter().map(Unimog::start_centre))
    }
}

mod defaults {
    pub fn duration_s() -> f64 {
        3600.0
    }
}
