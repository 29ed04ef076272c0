//! Where a run took place, between whom, under which rules.

use schemars::JsonSchema;
use serde::Serialize;

use super::{AgentLabel, PoseObject};
use crate::{AgentStart, Body, Rules, Setting, SpreadSetting, WaterEnergy, WaterRules};
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::Dimensions;
use wildfire_fire::embers::EmberSettings;
use wildfire_fire::models::{AlexandridisRules, Density, Neighbours, RothermelRules, Vegetation};
use wildfire_fire::surface::crown::CrownRules;
use wildfire_fire::surface::{FuelMoisture, SurfaceOptions};
use wildfire_fire::{FireRules, Landscape, Relief, WeatherInterval};

/// The field, the agents and the rules.
#[derive(Serialize, JsonSchema)]
pub struct SettingObject<'a> {
    /// Columns of the field.
    cols: u16,
    /// Rows of the field.
    rows: u16,
    /// The side of a cell.
    cell_m: f64,
    /// Cells with a bush, in the order of row and column.
    #[schemars(with = "Vec<[u16; 2]>")]
    bushes: &'a [Cell],
    /// Cells without a bush that block agents all the same.
    #[schemars(with = "Vec<[u16; 2]>")]
    blocked: &'a [Cell],
    /// Wumpuses first, then trucks, by number.
    agents: Vec<AgentObject>,
    rules: RulesObject,
    /// How fire goes over the ground between the bushes; null where only bushes burn.
    ground: Option<GroundObject<'a>>,
    /// The tanks of trucks; null where water does not matter.
    water: Option<WaterObject>,
}

/// An agent at its start.
#[derive(Serialize, JsonSchema)]
struct AgentObject {
    agent: AgentLabel,
    start: PoseObject,
    body: BodyObject,
    /// Null if the recording does not contain it.
    limits: Option<LimitsObject>,
}

/// The body of an agent.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "shape", rename_all = "kebab-case")]
enum BodyObject {
    /// Round its pose.
    Square { size_m: f64 },
    /// Its pose is that of the middle of the rear axle.
    Truck {
        length_m: f64,
        width_m: f64,
        wheelbase_m: f64,
        rear_overhang_m: f64,
        turning_radius_m: f64,
        /// How fast its front wheels turn; null: at once.
        steering_rate_deg_s: Option<f64>,
    },
}

/// How fast an agent may go; null is no limit.
#[derive(Serialize, JsonSchema)]
struct LimitsObject {
    forward_mps: f64,
    reverse_mps: f64,
    acceleration_mps2: Option<f64>,
    braking_mps2: Option<f64>,
    lateral_mps2: Option<f64>,
}

/// The rules of the contest.
#[derive(Serialize, JsonSchema)]
struct RulesObject {
    duration_ns: u64,
    /// From the middle of a truck's body to the middle of a cell; null is no rule of distance.
    suppression_reach_m: Option<f64>,
    suppression_dwell_ns: u64,
    /// Whether a stop puts out all that burns in reach; null where the recording does not say.
    extinguishes_all: Option<bool>,
    /// Whether what was put out can burn again.
    relight: bool,
    score_wumpus_ignited: f64,
    score_wumpus_burned_out: f64,
    score_truck_extinguished: f64,
    /// How fire goes from bush to bush by distance and delay; null under other rules.
    radius: Option<RadiusObject>,
}

#[derive(Serialize, JsonSchema)]
struct RadiusObject {
    spread_delay_ns: u64,
    spread_radius_m: f64,
    /// Whether bushes that were lit spread fire.
    lit_spreads: bool,
    /// Whether bushes that caught fire from others spread it.
    caught_spreads: bool,
    /// Null burns forever.
    burn_out_ns: Option<u64>,
}

#[derive(Serialize, JsonSchema)]
struct WaterObject {
    /// Stops that a full tank suffices for.
    full_tank: u32,
    fill_per_stop_ns: u64,
    reach_m: f64,
    places_m: Vec<[f64; 2]>,
    /// The water that the heat of a fire takes, if stops differ; tanks are then counted in portions.
    #[serde(skip_serializing_if = "Option::is_none")]
    energy: Option<WaterEnergy>,
}

/// The ground, the weather, and how fire goes on.
#[derive(Serialize, JsonSchema)]
struct GroundObject<'a> {
    /// Numbers of fuel models, each with how many cells in turn have it, by row and column; 0 does not burn.
    fuel_runs: Vec<(u8, usize)>,
    relief: ReliefObject<'a>,
    /// Only where there are trees: their heights and those of the beginning of crowns in tenths of metres, densities in
    /// hundredths of kg/m3, and covers in percent, by row and column.
    #[serde(skip_serializing_if = "Option::is_none")]
    trees: Option<&'a [Vec<u16>; 4]>,
    /// In order of time; each holds until the next.
    weather: Vec<WeatherObject>,
    rules: SpreadObject,
}

/// Heights, or how the ground rises to the east and to the north; lists are by row and column.
#[derive(Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum ReliefObject<'a> {
    /// The same rise everywhere.
    Plane([f64; 2]),
    ElevationM(&'a [f32]),
    Gradient(&'a [[f32; 2]]),
}

#[derive(Serialize, JsonSchema)]
struct WeatherObject {
    from_ns: u64,
    /// Where the wind goes: east and north.
    wind_mps: [f64; 2],
    moisture: FuelMoisture,
}

/// The model of fire with its numbers.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "model", rename_all = "kebab-case")]
enum SpreadObject {
    Rothermel {
        options: SurfaceOptions,
        neighbours: Neighbours,
        /// Whether directions are added where fires are too narrow for those to the neighbours.
        refined: bool,
        wet_ns: u64,
        /// The least time that a cell flames; null flames forever.
        burn_out_ns: Option<u64>,
        /// Null where there are none.
        embers: Option<EmbersObject>,
        /// Only where there are trees.
        #[serde(skip_serializing_if = "Option::is_none")]
        crowns: Option<CrownRules>,
    },
    Alexandridis {
        p0: f64,
        wind_c1: f64,
        wind_c2: f64,
        slope_a: f64,
        vegetation: Vegetation,
        density: Density,
        step_ns: u64,
    },
}

#[derive(Serialize, JsonSchema)]
struct EmbersObject {
    seed: u64,
    #[serde(flatten)]
    settings: EmberSettings,
}

impl<'a> From<&'a Setting> for SettingObject<'a> {
    fn from(setting: &'a Setting) -> Self {
        Self {
            cols: setting.frame.cols,
            rows: setting.frame.rows,
            cell_m: setting.frame.cell_m,
            bushes: &setting.bushes,
            blocked: &setting.blocked,
            agents: setting.agents.iter().map(AgentObject::from).collect(),
            rules: RulesObject::from(&setting.rules),
            ground: setting.spread.as_ref().map(GroundObject::from),
            water: setting.water.as_ref().map(WaterObject::from),
        }
    }
}

impl From<&AgentStart> for AgentObject {
    fn from(start: &AgentStart) -> Self {
        let limits = |limits| {
            let SpeedLimits { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2, .. } = limits;
            LimitsObject { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2 }
        };
        Self {
            agent: AgentLabel(start.id),
            start: start.pose.into(),
            body: start.body.into(),
            limits: start.limits.map(limits),
        }
    }
}

impl From<Body> for BodyObject {
    fn from(body: Body) -> Self {
        match body {
            Body::Square { size_m } => Self::Square { size_m },
            Body::Truck(truck) => {
                let Dimensions {
                    length_m,
                    width_m,
                    wheelbase_m,
                    rear_overhang_m,
                    turning_radius_m,
                    steering_rate_deg_s,
                } = truck;
                Self::Truck { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, steering_rate_deg_s }
            }
        }
    }
}

impl From<&Rules> for RulesObject {
    fn from(rules: &Rules) -> Self {
        let radius = |fire: FireRules| RadiusObject {
            spread_delay_ns: fire.spread_delay.as_nanos(),
            spread_radius_m: fire.spread_radius_m,
            lit_spreads: fire.sources_spread,
            caught_spreads: fire.caught_spreads,
            burn_out_ns: fire.burn_out.map(SimTime::as_nanos),
        };
        Self {
            duration_ns: rules.duration.as_nanos(),
            suppression_reach_m: rules.suppression_reach_m,
            suppression_dwell_ns: rules.suppression_dwell.as_nanos(),
            extinguishes_all: rules.extinguishes_all,
            relight: rules.reignition,
            score_wumpus_ignited: rules.score_wumpus_ignited,
            score_wumpus_burned_out: rules.score_wumpus_burned_out,
            score_truck_extinguished: rules.score_truck_extinguished,
            radius: rules.fire.map(radius),
        }
    }
}

impl From<&WaterRules> for WaterObject {
    fn from(water: &WaterRules) -> Self {
        Self {
            full_tank: water.full_tank,
            fill_per_stop_ns: water.fill_per_stop.as_nanos(),
            reach_m: water.reach_m,
            places_m: water.places.iter().map(DVec2::to_array).collect(),
            energy: water.energy,
        }
    }
}

impl<'a> From<&'a SpreadSetting> for GroundObject<'a> {
    fn from(spread: &'a SpreadSetting) -> Self {
        let landscape: &Landscape = spread.landscape();
        Self {
            fuel_runs: landscape.fuel.chunk_by(|one, other| one == other).map(|run| (run[0], run.len())).collect(),
            relief: match &landscape.relief {
                Relief::Plane(rise) => ReliefObject::Plane(rise.to_array()),
                Relief::Elevation(heights) => ReliefObject::ElevationM(heights),
                Relief::Gradient(rises) => ReliefObject::Gradient(rises),
            },
            trees: landscape.canopy.as_ref().map(|trees| &trees.0),
            weather: spread.weather().intervals().iter().map(WeatherObject::from).collect(),
            rules: match spread {
                SpreadSetting::Rothermel { rules, .. } => rules.into(),
                SpreadSetting::Alexandridis { rules, .. } => rules.into(),
            },
        }
    }
}

impl From<&WeatherInterval> for WeatherObject {
    fn from(interval: &WeatherInterval) -> Self {
        let wind_mps = interval.wind_mps.to_array();
        let moisture = interval.moisture;
        Self { from_ns: interval.from.as_nanos(), wind_mps, moisture }
    }
}

impl From<&RothermelRules> for SpreadObject {
    fn from(
        &RothermelRules { options, neighbours, refined, wet, burn_out, embers, crowns, .. }: &RothermelRules,
    ) -> Self {
        let embers = embers.map(|embers| EmbersObject { seed: embers.seed, settings: embers.settings });
        let wet_ns = wet.as_nanos();
        let burn_out_ns = burn_out.map(SimTime::as_nanos);
        Self::Rothermel { options, neighbours, refined, wet_ns, burn_out_ns, embers, crowns }
    }
}

impl From<&AlexandridisRules> for SpreadObject {
    fn from(rules: &AlexandridisRules) -> Self {
        let AlexandridisRules { p0, wind_c1, wind_c2, slope_a, vegetation, density, step } = *rules;
        Self::Alexandridis { p0, wind_c1, wind_c2, slope_a, vegetation, density, step_ns: step.as_nanos() }
    }
}
