//! The place, the agents and the rules of a run.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{AgentId, WaterRules};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::Dimensions;
use wildfire_fire::models::{Alexandridis, AlexandridisRules, Rothermel, RothermelRules};
use wildfire_fire::surface::{FuelBed, FuelMoisture};
use wildfire_fire::{BushState, FireModel, FireRules, Landscape, Weather, WeatherInterval};

/// The body of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// A square around its pose, with its side in metres.
    Square {
        size_m: f64,
    },
    Truck(Dimensions),
}

impl Body {
    /// Returns the position of the body's centre for a pose of its agent.
    pub fn centre(&self, pose: Pose) -> DVec2 {
        match self {
            Self::Square { .. } => pose.position(),
            Self::Truck(body) => body.body_centre(pose),
        }
    }
}

/// An agent at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgentStart {
    pub id: AgentId,
    pub pose: Pose,
    pub body: Body,
    /// The speed limits; `None` if the recording does not include them.
    pub limits: Option<SpeedLimits>,
}

/// The rules that readers of facts need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    pub duration: SimTime,
    /// The distance in metres from body centre to cell centre; `None` if there is no such rule.
    pub suppression_reach_m: Option<f64>,
    pub suppression_dwell: SimTime,
    /// True if a stop extinguishes everything that burns in reach, not only its goal; `None` if the recording does not
    /// include this rule.
    pub extinguishes_all: Option<bool>,
    /// The rules of spread and burn-out; `None` if the recording does not include them.
    pub fire: Option<FireRules>,
    #[serde(rename = "relight")]
    pub reignition: bool,
    pub score_wumpus_ignited: f64,
    pub score_wumpus_burned_out: f64,
    pub score_truck_extinguished: f64,
}

impl Rules {
    /// Returns true if a bush burns out before a truck that arrives at this time could have extinguished it; false if
    /// the recording does not include burn-out times.
    pub fn is_hopeless(&self, bush: BushState, arrives: SimTime) -> bool {
        match (bush, self.fire.and_then(|fire| fire.burn_out)) {
            // What is due at the same instant is put out first.
            (BushState::Burning { since }, Some(burn_out)) => arrives + self.suppression_dwell > since + burn_out,
            _ => false,
        }
    }
}

/// The spread of fire over ground, as audits, films and maps need it.
#[derive(Clone, Debug, PartialEq)]
pub enum SpreadSetting {
    /// Spread by Rothermel's equations.
    Rothermel { landscape: Arc<Landscape>, weather: Arc<Weather>, rules: RothermelRules },
    /// Spread by the automaton of Alexandridis; its random numbers are those of the run's seed.
    Alexandridis { landscape: Arc<Landscape>, weather: Arc<Weather>, rules: AlexandridisRules },
}

impl SpreadSetting {
    /// Creates the fire model for the run of a seed.
    pub fn model(&self, seed: u64) -> Box<dyn FireModel> {
        match self {
            Self::Rothermel { landscape, weather, rules } => {
                Box::new(Rothermel::new(Arc::clone(landscape), Arc::clone(weather), *rules))
            }
            Self::Alexandridis { landscape, weather, rules } => {
                Box::new(Alexandridis::new(Arc::clone(landscape), Arc::clone(weather), *rules, seed))
            }
        }
    }

    /// Returns the fuels of all cells, including those of bushes.
    pub fn landscape(&self) -> &Landscape {
        match self {
            Self::Rothermel { landscape, .. } | Self::Alexandridis { landscape, .. } => landscape,
        }
    }

    /// Returns the weather in the course of the run.
    pub fn weather(&self) -> &Weather {
        match self {
            Self::Rothermel { weather, .. } | Self::Alexandridis { weather, .. } => weather,
        }
    }

    /// Returns the flaming time of each fuel.
    pub fn flaming_times(&self) -> FlamingTimes {
        FlamingTimes::new(self)
    }
}

/// The flaming times of cells, by fuel and by the weather at ignition.
#[derive(Clone, Debug)]
pub struct FlamingTimes {
    spread: SpreadSetting,
    /// By interval of the weather and number of the fuel model; `None` flames forever.
    spans: Vec<Option<SimTime>>,
}

impl FlamingTimes {
    fn new(spread: &SpreadSetting) -> Self {
        // Where moisture differs from place to place they are computed for each cell.
        let intervals = spread.weather().intervals().iter().filter(|_| spread.weather().moisture_zones().is_none());
        let spans = intervals.flat_map(|interval: &WeatherInterval| {
            (0..=u8::MAX).map(move |number| Self::span(spread, &interval.moisture, number))
        });
        let spans = spans.collect();
        Self { spread: spread.clone(), spans }
    }

    fn span(spread: &SpreadSetting, moisture: &FuelMoisture, number: u8) -> Option<SimTime> {
        match spread {
            SpreadSetting::Alexandridis { rules, .. } => Some(rules.step),
            SpreadSetting::Rothermel { rules, .. } => {
                let residence_s = spread
                    .landscape()
                    .fuel_model(number)
                    .filter(|model| model.burns())
                    .map_or(0.0, |model| FuelBed::new(model, moisture, rules.options.curing).residence_s());
                rules.burn_out.map(|min| min.max(SimTime::from_seconds(residence_s)))
            }
        }
    }

    /// Returns the burn-out time of a cell that catches fire at a time; `None` if it burns forever.
    pub fn burns_out_at(&self, cell: Cell, ignited: SimTime) -> Option<SimTime> {
        let interval = self.spread.weather().interval_at(ignited);
        let number = self.spread.landscape().fuel_number(cell);
        let span = match self.spread.weather().moisture_zones() {
            Some(zones) => Self::span(&self.spread, &zones.at(self.spread.landscape().frame.index(cell)), number),
            None => self.spans[interval * (usize::from(u8::MAX) + 1) + usize::from(number)],
        };
        span.map(|span| ignited + span)
    }
}

/// The rules of line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LineRules {
    pub crews: Vec<CrewRules>,
    /// Line may not hold, as chance decides.
    pub can_be_lost: bool,
}

/// A crew, by what bounds its work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrewRules {
    /// When it sets out.
    pub at_ns: u64,
    /// Where from, in metres in the frame of the field.
    pub start_m: [f64; 2],
    pub walking_mps: f64,
    /// The most line that it builds in a second, on both flanks together.
    pub rate_mps: f64,
}

/// The place and the agents of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub scenario: String,
    pub seed: u64,
    pub program_version: String,
    pub frame: FieldFrame,
    /// The cells with bushes, in the order of cell indices, without duplicates.
    pub bushes: Vec<Cell>,
    /// The cells without a bush that block trucks and Wumpuses, in the order of their indices.
    pub blocked: Vec<Cell>,
    /// The agents: Wumpuses first, then trucks, by number.
    pub agents: Vec<AgentStart>,
    pub rules: Rules,
    /// The spread of fire over ground; `None` where only bushes burn.
    pub spread: Option<SpreadSetting>,
    /// The tanks of trucks; `None` where water does not matter.
    pub water: Option<WaterRules>,
    /// The shares of their greatest speed that trucks keep on ground, by the number of its fuel model: 256 for each truck that
    /// some ground slows, in the order of the trucks.
    pub ground_shares: Vec<(AgentId, Vec<f64>)>,
    /// Crews that build line; `None` where there are none.
    pub line: Option<LineRules>,
    /// The number of the piece of each bush, where whole pieces catch fire and go out together; else nothing.
    pub pieces: Vec<u32>,
}

impl Setting {
    /// Returns the number of a bush's piece; `None` where each bush burns by itself.
    pub fn piece(&self, cell: Cell) -> Option<u32> {
        self.pieces.get(self.bush_index(cell)?).copied()
    }

    /// Returns true if the cell is ground that burns: its fuel does, and it has no bush.
    pub fn is_ground(&self, cell: Cell) -> bool {
        self.spread.as_ref().is_some_and(|spread| spread.landscape().burning_model(cell).is_some())
            && self.bush_index(cell).is_none()
    }

    /// Returns how long a stop at a fire takes that sprays some portions of water.
    pub fn stop_time(&self, water_units: u32) -> SimTime {
        let spraying = self.water.as_ref().map_or(SimTime::ZERO, |water| water.spraying(water_units));
        self.rules.suppression_dwell + spraying
    }

    /// Returns the place of a bush in [`Setting::bushes`]; `None` where nothing grows.
    pub fn bush_index(&self, cell: Cell) -> Option<usize> {
        // Row and column are in the order of cell indices and need no frame.
        self.bushes.binary_search_by_key(&(cell.row, cell.col), |bush| (bush.row, bush.col)).ok()
    }

    /// Returns the cells that no body may overlap: bushes and other obstacles, in the order of their indices.
    pub fn obstacles(&self) -> Vec<Cell> {
        let mut cells = [self.bushes.as_slice(), &self.blocked].concat();
        cells.sort_unstable_by_key(|cell| (cell.row, cell.col));
        cells
    }

    /// Returns the place of an agent in [`Setting::agents`].
    pub fn agent_index(&self, id: AgentId) -> Option<usize> {
        self.agents.binary_search_by_key(&id, |start| start.id).ok()
    }
}
