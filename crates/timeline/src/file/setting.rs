//! The setting of a run as recordings store it.
//!
//! These types fix the order and the width of what is written: postcard writes fields in order, integers as varints, and a
//! variant by its place. New variants come last; a changed one is a new format. The program's own types that hold just what is
//! written, [`AgentId`], [`Pose`] and [`FireRules`], are written as they are: recordings of the tests show if one changes.

use serde::{Deserialize, Serialize};

use super::FileError;
use super::check::{MAX_SIDE, limit};
use super::facts::NO_SUCH_BUSH;
use crate::{AgentId, AgentStart, Body, Rules, Setting, WaterRules};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::Dimensions;
use wildfire_fire::FireRules;

/// The first part of a setting.
#[derive(Serialize, Deserialize)]
pub struct SettingRecord {
    scenario: String,
    seed: u64,
    program_version: String,
    cols: u16,
    rows: u16,
    cell_m: f64,
    /// Index of each bush, less that of the one before it.
    bush_steps: Vec<u32>,
    agents: Vec<AgentRecord>,
    rules: RulesRecord,
}

#[derive(Serialize, Deserialize)]
struct AgentRecord {
    id: AgentId,
    pose: Pose,
    body: BodyRecord,
}

#[derive(Serialize, Deserialize)]
enum BodyRecord {
    Square {
        size_m: f64,
    },
    Truck {
        length_m: f64,
        width_m: f64,
        wheelbase_m: f64,
        rear_overhang_m: f64,
        turning_radius_m: f64,
    },
    /// A truck whose front wheels turn at a limited rate.
    SteeredTruck {
        length_m: f64,
        width_m: f64,
        wheelbase_m: f64,
        rear_overhang_m: f64,
        turning_radius_m: f64,
        steering_rate_deg_s: f64,
    },
}

#[derive(Serialize, Deserialize)]
struct RulesRecord {
    duration_ns: u64,
    suppression_reach_m: Option<f64>,
    suppression_dwell_ns: u64,
    reignition: bool,
    score_wumpus_ignited: f64,
    score_wumpus_burned_out: f64,
    score_truck_extinguished: f64,
}

/// The part of a setting that follows the facts.
#[derive(Serialize, Deserialize)]
pub struct SettingTail {
    /// In the order of the agents; none are there where nothing is known of any.
    limits: Vec<Option<LimitsRecord>>,
    extinguishes_all: Option<bool>,
    fire: FireRecord,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
struct LimitsRecord {
    forward_mps: f64,
    reverse_mps: f64,
    acceleration_mps2: Option<f64>,
    braking_mps2: Option<f64>,
    lateral_mps2: Option<f64>,
}

/// The tanks of trucks.
#[derive(Serialize, Deserialize)]
pub struct WaterRecord {
    full_tank: u32,
    fill_per_stop_ns: u64,
    reach_m: f64,
    places: Vec<[f64; 2]>,
}

impl From<&WaterRules> for WaterRecord {
    fn from(water: &WaterRules) -> Self {
        let WaterRules { full_tank, fill_per_stop, reach_m, places, energy: _ } = water;
        let places = places.iter().map(DVec2::to_array).collect();
        Self { full_tank: *full_tank, fill_per_stop_ns: fill_per_stop.as_nanos(), reach_m: *reach_m, places }
    }
}

impl From<WaterRecord> for WaterRules {
    fn from(record: WaterRecord) -> Self {
        let WaterRecord { full_tank, fill_per_stop_ns, reach_m, places } = record;
        let places = places.into_iter().map(DVec2::from_array).collect();
        Self { full_tank, fill_per_stop: SimTime::from_nanos(fill_per_stop_ns), reach_m, places, energy: None }
    }
}

/// The speeds of a truck by ground.
#[derive(Serialize, Deserialize)]
pub struct GroundSharesRecord {
    truck: u16,
    shares: Vec<f64>,
}

impl From<&(AgentId, Vec<f64>)> for GroundSharesRecord {
    fn from((truck, shares): &(AgentId, Vec<f64>)) -> Self {
        Self { truck: truck.number, shares: shares.clone() }
    }
}

impl From<GroundSharesRecord> for (AgentId, Vec<f64>) {
    fn from(GroundSharesRecord { truck, shares }: GroundSharesRecord) -> Self {
        (AgentId::unimog(truck), shares)
    }
}

/// The model of fire with its numbers.
#[derive(Clone, Serialize, Deserialize)]
enum FireRecord {
    Unknown,
    Radius(FireRules),
    /// The same where fire takes whole pieces, with the number of each bush's piece.
    RadiusOfPieces {
        radius: FireRules,
        pieces: Vec<u32>,
    },
}

impl From<&Setting> for SettingRecord {
    fn from(setting: &Setting) -> Self {
        let rules = &setting.rules;
        Self {
            scenario: setting.scenario.clone(),
            seed: setting.seed,
            program_version: setting.program_version.clone(),
            cols: setting.frame.cols,
            rows: setting.frame.rows,
            cell_m: setting.frame.cell_m,
            bush_steps: steps(setting.frame, &setting.bushes),
            agents: setting.agents.iter().map(AgentRecord::from).collect(),
            rules: RulesRecord {
                duration_ns: rules.duration.as_nanos(),
                suppression_reach_m: rules.suppression_reach_m,
                suppression_dwell_ns: rules.suppression_dwell.as_nanos(),
                reignition: rules.reignition,
                score_wumpus_ignited: rules.score_wumpus_ignited,
                score_wumpus_burned_out: rules.score_wumpus_burned_out,
                score_truck_extinguished: rules.score_truck_extinguished,
            },
        }
    }
}

impl From<&AgentStart> for AgentRecord {
    fn from(&AgentStart { id, pose, body, limits: _ }: &AgentStart) -> Self {
        Self { id, pose, body: body.into() }
    }
}

impl From<Body> for BodyRecord {
    fn from(body: Body) -> Self {
        let truck = match body {
            Body::Square { size_m } => return Self::Square { size_m },
            Body::Truck(truck) => truck,
        };
        let Dimensions { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, steering_rate_deg_s } =
            truck;
        match steering_rate_deg_s {
            None => Self::Truck { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m },
            Some(steering_rate_deg_s) => Self::SteeredTruck {
                length_m,
                width_m,
                wheelbase_m,
                rear_overhang_m,
                turning_radius_m,
                steering_rate_deg_s,
            },
        }
    }
}

impl From<&BodyRecord> for Body {
    fn from(record: &BodyRecord) -> Self {
        let (length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, steering_rate_deg_s) = match *record {
            BodyRecord::Square { size_m } => return Self::Square { size_m },
            BodyRecord::Truck { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m } => {
                (length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, None)
            }
            BodyRecord::SteeredTruck {
                length_m,
                width_m,
                wheelbase_m,
                rear_overhang_m,
                turning_radius_m,
                steering_rate_deg_s,
            } => (length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, Some(steering_rate_deg_s)),
        };
        let truck =
            Dimensions { length_m, width_m, wheelbase_m, rear_overhang_m, turning_radius_m, steering_rate_deg_s };
        Self::Truck(truck)
    }
}

impl From<&Setting> for SettingTail {
    fn from(setting: &Setting) -> Self {
        let limits = |limits| {
            let SpeedLimits { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2, .. } = limits;
            LimitsRecord { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2 }
        };
        Self {
            limits: setting.agents.iter().map(|agent| agent.limits.map(limits)).collect(),
            extinguishes_all: setting.rules.extinguishes_all,
            fire: match setting.rules.fire {
                None => FireRecord::Unknown,
                Some(radius) if setting.pieces.is_empty() => FireRecord::Radius(radius),
                Some(radius) => FireRecord::RadiusOfPieces { radius, pieces: setting.pieces.clone() },
            },
        }
    }
}

impl SettingRecord {
    /// Returns the setting including its supplement; its values have not been checked yet.
    pub fn into_setting(self, supplement: &SettingTail) -> Result<Setting, FileError> {
        let frame = FieldFrame { cols: self.cols, rows: self.rows, cell_m: self.cell_m };
        limit("cells along a side", frame.cols.max(frame.rows).into(), MAX_SIDE)?;
        let limits = supplement.limits.iter().map(|limits| limits.map(SpeedLimits::from));
        // Files that know no agent's limits have an empty list.
        let agents = self.agents.iter().zip(limits.chain(std::iter::repeat(None)));
        Ok(Setting {
            scenario: self.scenario,
            seed: self.seed,
            program_version: self.program_version,
            frame,
            bushes: cells(frame, &self.bush_steps)?,
            // These come from parts of the payload behind the facts.
            blocked: Vec::new(),
            spread: None,
            water: None,
            ground_shares: Vec::new(),
            line: None,
            pieces: supplement.fire.pieces(),
            agents: agents.map(|(agent, limits)| agent.start(limits)).collect(),
            rules: Rules {
                duration: SimTime::from_nanos(self.rules.duration_ns),
                suppression_reach_m: self.rules.suppression_reach_m,
                suppression_dwell: SimTime::from_nanos(self.rules.suppression_dwell_ns),
                extinguishes_all: supplement.extinguishes_all,
                fire: supplement.fire.rules(),
                reignition: self.rules.reignition,
                score_wumpus_ignited: self.rules.score_wumpus_ignited,
                score_wumpus_burned_out: self.rules.score_wumpus_burned_out,
                score_truck_extinguished: self.rules.score_truck_extinguished,
            },
        })
    }
}

/// Returns the differences between the indices of consecutive cells.
pub fn steps(frame: FieldFrame, cells: &[Cell]) -> Vec<u32> {
    let mut last = 0;
    let indices = cells.iter().map(|&cell| frame.index(cell) as u32);
    indices.map(|index| index - std::mem::replace(&mut last, index)).collect()
}

/// Returns the cells with these differences between their indices.
pub fn cells(frame: FieldFrame, steps: &[u32]) -> Result<Vec<Cell>, FileError> {
    let mut index = 0_usize;
    steps
        .iter()
        .map(|&step| {
            index = index.checked_add(step as usize).filter(|&index| index < frame.cell_count()).ok_or(NO_SUCH_BUSH)?;
            Ok(frame.cell(index))
        })
        .collect()
}

impl AgentRecord {
    fn start(&self, limits: Option<SpeedLimits>) -> AgentStart {
        let body = Body::from(&self.body);
        let steering = match body {
            Body::Square { .. } => None,
            Body::Truck(truck) => truck.steering_limits(),
        };
        AgentStart {
            id: self.id,
            pose: self.pose,
            body,
            limits: limits.map(|limits| SpeedLimits { steering, ..limits }),
        }
    }
}

impl From<LimitsRecord> for SpeedLimits {
    fn from(limits: LimitsRecord) -> Self {
        let LimitsRecord { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2 } = limits;
        // Steering is the body's.
        Self { forward_mps, reverse_mps, acceleration_mps2, braking_mps2, lateral_mps2, steering: None }
    }
}

impl FireRecord {
    fn rules(&self) -> Option<FireRules> {
        match *self {
            Self::Unknown => None,
            Self::Radius(radius) | Self::RadiusOfPieces { radius, .. } => Some(radius),
        }
    }

    fn pieces(&self) -> Vec<u32> {
        match self {
            Self::Unknown | Self::Radius(_) => Vec::new(),
            Self::RadiusOfPieces { pieces, .. } => pieces.clone(),
        }
    }
}
