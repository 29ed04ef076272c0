#![doc = include_str!("../README.md")]
//!
//! [`load`] turns a name or a path into a [`Scenario`] that is complete and checked: it reads the TOML text, makes the
//! changes of the command line, fills in the defaults, reads the map if the field is given, and refuses what cannot be
//! simulated, with the place of the fault. [`Terrain::from_scenario`] gives the field of a run, [`explain()`] explains
//! a scenario.
//!
//! Each kind of agent, and the rules of fire, have a file in `keys` with everything that a scenario says about them; what it
//! says about planners is beside the planners, in [`wildfire_planning::registry`]. `faults`, `site`, `keys`, `memory`, `read`
//! and `explain` each use only those before it.
//!
//! Every default is the value of the built-in scenario `contest-1`. Lengths are metres, times seconds, in the world
//! frame of [`wildfire_base::geometry`]. The format is described in `scenarios/README.md`.

mod explain;
mod faults;
mod keys;
mod memory;
mod read;
mod site;

pub use explain::warnings::{doubts_of_files, warnings_of_map};
pub use explain::{explain, outline};
pub use faults::error::{Fault, MapFault, ScenarioError, SourceLocation, nearest_name};
pub use faults::path::{FieldPath, PathStep};
pub use keys::agents::MemoryPart;
pub use keys::alexandridis::AlexandridisSettings;
pub use keys::custom_fuel::CustomFuel;
pub use keys::dispatch::{Dispatch, DispatchPolicy, IdleRule, Sight, SightOfField};
pub use keys::field::{Field, MAX_COVERAGE, MapTolerance, Overlaps};
pub use keys::fire::{Fire, FireModelName, FireUnit, SpreadFrom};
pub use keys::goal::{LinePolicy, TruckGoal, WumpusGoal, is_built_in_policy};
pub use keys::ground_speed::GroundKinds;
pub use keys::learned::{HIDDEN, Learned};
pub use keys::line::{Crew, LineHolds, LineSettings, ProtectedPlace};
pub use keys::network::Network;
pub use keys::program::{MAX_MESSAGE_BYTES, Program, Programs, UsedProgram};
pub use keys::rothermel::RothermelSettings;
pub use keys::rules::{Extinguishes, Ignition, IgnitionArea, IgnitionCells, IgnitionDensity, Score, Suppression};
pub use keys::traffic::{Detours, TrafficPlan, TrafficRules};
pub use keys::unimog::{FallbackMode, Limits, Retarget, StartPose, TruckPlannerContext, Unimog};
pub use keys::water::{Water, WaterEffect, WaterPlace};
pub use keys::wumpus::{Escape, StepCost, StepTime, Wumpus, WumpusHeuristic, WumpusPlanner, WumpusPotential};
pub use memory::{MemoryEstimate, MemoryExceeded, MemoryLimit, bytes_text};
pub use read::built_in::BUILT_IN;
pub use read::difference::{ValueDifference, value_differences};
pub use read::load::{LoadedScenario, load};
pub use read::problem::{MAX_GOALS, Problem};
pub use read::source::{
    MAX_MAP_BYTES, MAX_SCENARIO_BYTES, ScenarioText, can_be_read_again, first_too_deep, toml_value,
};
pub use site::features::{Hill, Patches, River, Road, Runs};
pub use site::fuel_file::read_fuels;
pub use site::fuel_name::FuelName;
pub use site::imported::{ImportedField, MAX_CELLS_A_SIDE, MapError};
pub use site::landscape::{Barrier, LandscapeSettings};
pub use site::layers::{ImportedLayers, LayerKind, LayerReader, Weights};
pub use site::moisture::{
    ImportedMoisture, MOISTURE_CLASSES, MoistureRasters, MoistureShift, rate_factors, read_rate_factors,
};
pub use site::terrain::{Terrain, TerrainError};
pub use site::tetromino::Shape;
pub use site::truck_starts::{TRUCK_MARGIN_M, free_start};
pub use site::weather::{DeadMoisture, MoistureChange, WeatherSettings, weather, weather_on};
pub use site::weather_csv::WeatherSample;
pub use site::wind::{WindChange, WindUnits};
pub use site::wind_raster::{TimedWindField, WindRasterKind, WindRasters};

use std::path::PathBuf;

use faults::check::{Check, TablePath, check_name};
use keys::agents::AgentList;
use keys::program::check_programs;
use keys::rules::check_ignitions;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::geometry::DVec2;
use wildfire_base::input_file::list_of_at_most;
use wildfire_base::ranges;
use wildfire_base::ranges::{SettingsTable, number_text};
use wildfire_fire::fuel::FuelModel;
pub use wildfire_planning::kit::local_search::{MotionCost, PrimitiveSettings};
pub use wildfire_planning::kit::safety::{SafetyForm, SafetyMap, SafetySettings};
pub use wildfire_planning::planners::hybrid_astar::HybridSettings;
pub use wildfire_planning::planners::lattice::LatticeSettings;
pub use wildfire_planning::planners::prm_primitives::{ClearanceTo, PrmSettings, RoadmapGoal, RoadmapSearch};
pub use wildfire_planning::planners::prm_rs::PrmRsSettings;
pub use wildfire_planning::{PlannerName, TruckPlannerKind};

/// The most agents of a kind.
const MAX_AGENTS: usize = 1000;

/// The most stops of all trucks in a run in which a cell can burn again and again; each adds to the timeline.
const MAX_STOPS: f64 = 1e6;

/// Builds the JSON Schema of scenario files.
pub fn schema() -> schemars::Schema {
    let mut schema = schemars::schema_for!(Scenario);
    Scenario::write_ranges(&mut schema);
    Field::write_ranges(&mut schema);
    // Files may say how many agents an entry is; once they are loaded each agent has an entry.
    for (kind, agent) in [("Wumpus", "Wumpuses"), ("Unimog", "trucks")] {
        let count = schemars::json_schema!({
            "description": format!("The number of {agent} in the entry. The first starts where the entry says, the \
             others at random places, the same in every run."),
            "type": "integer",
            "minimum": 0,
            "maximum": read::copies::MAX_COPIES,
            "default": 1,
        });
        let properties = schema.pointer_mut(&format!("/$defs/{kind}/properties"));
        let properties = properties.and_then(serde_json::Value::as_object_mut).expect("agents are tables");
        properties.insert("count".into(), count.to_value());
    }
    schema
}

/// A contest: its field, rules, agents and duration.
///
/// The limits on lists here only keep other files from filling the memory; [`Self::check`] sets lower ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, remote = "Self")]
pub struct Scenario {
    /// The name of the scenario in tables.
    #[serde(default)]
    pub name: String,
    /// The latest end of a run.
    #[serde(default = "defaults::duration_s")]
    pub duration_s: f64,
    /// The field and its bushes.
    #[serde(default)]
    pub field: Field,
    /// The behavior of fire.
    #[serde(default)]
    pub fire: Fire,
    /// How trucks extinguish fires.
    #[serde(default)]
    pub suppression: Suppression,
    /// Points for both sides.
    #[serde(default)]
    pub score: Score,
    /// The arsonists.
    #[serde(deserialize_with = "list_of_at_most::<2_000, _, _>")]
    pub wumpus: Vec<Wumpus>,
    /// The fire trucks.
    #[serde(deserialize_with = "list_of_at_most::<2_000, _, _>")]
    pub unimog: Vec<Unimog>,
    /// How the trucks are dispatched to fires as a team; without it each follows its `goal`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dispatch: Option<Dispatch>,
    /// Weights of the networks of `learned` policies; without it, those that come with the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learned: Option<Learned>,
    /// What a dispatched team sees; without it, everything except the Wumpuses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sight: Option<Sight>,
    /// What trucks do about other trucks in their way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traffic: Option<TrafficRules>,
    /// The tanks of trucks; without it water is unlimited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub water: Option<Water>,
    /// Crews that build line round a fire of the model `rothermel`.
    #[serde(default, deserialize_with = "list_of_at_most::<2_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub crew: Vec<Crew>,
    /// Where the crews build line; without it, along the front from the rear.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<LineSettings>,
    /// Bushes that catch fire by themselves.
    #[serde(default, deserialize_with = "list_of_at_most::<100_000, _, _>")]
    pub ignition: Vec<Ignition>,
    /// Changes of the wind, in order of time; before the first one the air is calm.
    #[serde(default, deserialize_with = "list_of_at_most::<100_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub wind: Vec<WindChange>,
    /// Changes of the wind in a CSV file, `t_s,speed_mps,from_deg` with compass azimuths, instead of `[[wind]]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind_file: Option<PathBuf>,
    /// Moisture in the course of a run, and how uncertain the weather is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weather: Option<WeatherSettings>,
    /// Custom fuel models.
    #[serde(default, deserialize_with = "list_of_at_most::<500, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub fuel: Vec<CustomFuel>,
    /// Custom fuel models in a file of FARSITE (`.fmd`) or of ELMFIRE (CSV).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fuel_file: Option<PathBuf>,
    /// Those of the file. Loading fills it in.
    #[serde(rename = "given_fuel", default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip)]
    pub imported_fuel: Vec<FuelModel>,
    /// Places that stop fire, or have another fuel.
    #[serde(default, deserialize_with = "list_of_at_most::<1_000, _, _>", skip_serializing_if = "Vec::is_empty")]
    pub barrier: Vec<Barrier>,
    /// A drawn or generated landscape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub landscape: Option<LandscapeSettings>,
    /// Custom planners by name.
    #[serde(default, skip_serializing_if = "Programs::is_empty")]
    pub planner: Programs,
    /// Custom policies by name.
    #[serde(default, skip_serializing_if = "Programs::is_empty")]
    pub policy: Programs,
}

impl Default for Scenario {
    /// Returns the contest of one Wumpus and one truck with all defaults.
    fn default() -> Self {
        serde_json::from_str(r#"{"wumpus": [{}], "unimog": [{}]}"#).expect("all other keys have defaults")
    }
}

impl Scenario {
    /// Returns this scenario with everything of another that may change in the middle of a run: how trucks plan, and how
    /// agents decide.
    pub fn with_conduct_of(&self, other: &Self) -> Self {
        Self {
            dispatch: other.dispatch.clone(),
            learned: other.learned.clone(),
            sight: other.sight.clone(),
            traffic: other.traffic.clone(),
            planner: other.planner.clone(),
            policy: other.policy.clone(),
            wumpus: self.wumpus.iter().zip(&other.wumpus).map(changed_wumpus).collect(),
            unimog: self.unimog.iter().zip(&other.unimog).map(changed_unimog).collect(),
            ..self.clone()
        }
    }
}

/// Returns a Wumpus with the goal of another.
fn changed_wumpus((this, other): (&Wumpus, &Wumpus)) -> Wumpus {
    Wumpus { goal: other.goal.clone(), ..this.clone() }
}

fn changed_unimog((this, other): (&Unimog, &Unimog)) -> Unimog {
    // The body of a truck cannot change during a run, but its planner can.
    let Unimog { start, vehicle, speed_mps, reverse_speed_mps, limits, .. } = this.clone();
    Unimog { start, vehicle, speed_mps, reverse_speed_mps, limits, ..other.clone() }
}

ranges! { Scenario {
    duration_s: 0.001..=1e6;
    fire, suppression, score, dispatch, sight, traffic, water, line, crew, wind, weather, fuel, barrier, landscape, planner, policy, wumpus, unimog,
} }

impl Scenario {
    /// Checks a scenario that does not come from [`load`] as that would: ranges that bound time, bodies that are
    /// possible, starts inside the field. Memory is bounded by [`MemoryEstimate`].
    ///
    /// # Errors
    /// Returns the first value that is refused.
    pub fn check(&self) -> Result<(), Fault> {
        self.check_values().map_err(|refusal| refusal.fault())
    }

    /// Checks every value that serde cannot; `scenarios/README.md` documents the limits.
    fn check_values(&self) -> Check {
        check_name("name", &self.name)?;
        let top = TablePath::named("");
        // The field comes first, as the frame of one that was not checked may have billions of cells.
        self.field.check(&top.inner("field"))?;
        let frame = self.field.frame();
        top.settings(self, &frame)?;
        // A resolved scenario holds the cells packed, and may have been edited.
        let damaged = self
            .barrier
            .iter()
            .position(|barrier| barrier.covered.as_ref().is_some_and(|it| it.bytes(frame.cell_count()).is_none()));
        if let Some(number) = damaged {
            let expected = "cells that can be unpacked and fit the field".into();
            return top.inner("barrier").item(number).refuse("given", "damaged".into(), expected);
        }
        self.check_wind_fields(&top, frame.cell_count())?;
        top.ascending("wind", self.wind.iter().map(|change| change.at_s))?;
        self.weather.as_ref().map_or(Ok(()), |weather| weather.check(&top.inner("weather"), &frame))?;
        // Before the landscape, whose layers may name custom models.
        let fuels = self.check_fuels()?;
        self.landscape.as_ref().map_or(Ok(()), |landscape| landscape.check(&top.inner("landscape"), &frame, &fuels))?;
        self.check_zones(&frame, &fuels)?;
        self.check_stops()?;
        self.check_nearest_by_drive()?;
        self.learned.as_ref().map_or(Ok(()), |learned| learned.check(&top.inner("learned")))?;
        self.water.as_ref().map_or(Ok(()), |water| water.check(&top.inner("water"), &frame, self.fire.model))?;
        self.check_crews(&frame)?;
        check_programs("planner", &self.planner, |name| name.built_in().is_some())?;
        check_programs("policy", &self.policy, |name| is_built_in_policy(name.name()))?;
        // Counted first, as the checks below take time for each agent.
        for agents in self.kinds() {
            top.count(agents.key(), agents.len(), MAX_AGENTS)?;
        }
        self.kinds().iter().try_for_each(|agents| agents.check(self))?;
        check_ignitions(&self.ignition, &frame)
    }

    /// Checks winds by place that were not read from rasters but from a plan.
    fn check_wind_fields(&self, top: &TablePath, cells: usize) -> Check {
        let mut packed = self.wind.iter().map(|wind| wind.imported.as_ref());
        match packed.position(|packed| packed.is_some_and(|packed| packed.field(cells).is_none())) {
            Some(number) => {
                let expected = "winds that can be unpacked and fit the field".into();
                top.inner("wind").item(number).refuse("given", "damaged".into(), expected)
            }
            None => Ok(()),
        }
    }

    /// Returns the layers that files give, with their place on earth.
    pub fn layers(&self) -> Option<&ImportedLayers> {
        self.landscape.as_ref().and_then(|landscape| landscape.imported.as_ref())
    }

    /// Refuses rules that know other fires than a planner that looks for the nearest.
    fn check_nearest_by_drive(&self) -> Check {
        let Some(dispatch) = self.dispatch.as_ref().filter(|it| it.policy == DispatchPolicy::NearestByDrive) else {
            return Ok(());
        };
        if dispatch.idle == IdleRule::Regions {
            let expected = "`stay` or `centroids` with the policy `nearest-by-drive`";
            return TablePath::named("dispatch").refuse("idle", dispatch.idle.to_string(), expected.into());
        }
        match &self.sight {
            Some(sight) if sight.field == SightOfField::Radius => {
                let expected = "`everything` or `burning` with the policy `nearest-by-drive`";
                TablePath::named("sight").refuse("field", "radius".into(), expected.into())
            }
            _ => Ok(()),
        }
    }

    /// Bounds the work of fires that can be put out again and again.
    fn check_stops(&self) -> Check {
        let dwell_s = self.suppression.dwell_s;
        let stops = self.unimog.len() as f64 * self.duration_s / dwell_s;
        if self.fire.relight && stops > MAX_STOPS {
            let expected =
                format!("with `fire.relight`, time for at most {MAX_STOPS:e} stops of all trucks in the run");
            return TablePath::named("suppression").refuse("dwell_s", number_text(dwell_s), expected);
        }
        Ok(())
    }

    /// Lists the body centres of all agents at their starts, Wumpuses first.
    pub fn start_centres(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.kinds().into_iter().flat_map(AgentList::starts).map(|start| start.centre)
    }

    /// Lists the kinds of agents, each with its agents; the only place that does.
    fn kinds(&self) -> [&dyn AgentList; 2] {
        [&self.wumpus, &self.unimog]
    }
}

mod defaults {
    pub fn duration_s() -> f64 {
        3600.0
    }
}
