//! Where a run takes place, between whom, and under which rules.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{AgentId, WaterRules};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::Dimensions;
use wildfire_fire::fuel::FuelModel;
use wildfire_fire::models::{Alexandridis, AlexandridisRules, Rothermel, RothermelRules};
use wildfire_fire::surface::FuelBed;
use wildfire_fire::{BushState, FireModel, FireRules, Landscape, Weather};

/// The body of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// A square about its pose, side in metres.
    Square {
        size_m: f64,
    },
    Truck(Dimensions),
}

impl Body {
    /// World position of the body's centre for a pose of its agent.
    pub fn centre(&self, pose: Pose) -> DVec2 {
        match self {
            Self::Square { .. } => pose.position(),
            Self::Truck(body) => body.body_centre(pose),
        }
    }
}

/// An agent as it stands at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgentStart {
    pub id: AgentId,
    pub pose: Pose,
    pub body: Body,
    /// The limits of its speed; `None` where the recording does not say.
    pub limits: Option<SpeedLimits>,
}

/// The rules that readers of facts need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    pub duration: SimTime,
    /// Metres, from body centre to cell centre; `None` is no rule of distance.
    pub suppression_reach_m: Option<f64>,
    pub suppression_dwell: SimTime,
    /// True if a stop puts out all that burns in reach, not only its goal; `None` where the recording does not say.
    pub extinguishes_all: Option<bool>,
    /// The rules of spread and burn-out; `None` where the recording does not say.
    pub fire: Option<FireRules>,
    pub relight: bool,
    pub score_wumpus_ignited: f64,
    pub score_wumpus_burned_out: f64,
    pub score_truck_extinguished: f64,
}

impl Rules {
    /// Returns true if a bush burns out before a truck that arrives at this time could have put it out; false where the
    /// recording does not say when bushes burn out.
    pub fn is_hopeless(&self, bush: BushState, arrives: SimTime) -> bool {
        match (bush, self.fire.and_then(|fire| fire.burn_out)) {
            // What is due at the same instant is put out first.
            (BushState::Burning { since }, Some(burn_out)) => arrives + self.suppression_dwell > since + burn_out,
            _ => false,
        }
    }
}

/// How fire goes over ground: what an audit, a film and a map need to know of it.
#[derive(Clone, Debug, PartialEq)]
pub enum SpreadSetting {
    /// By Rothermel's equations.
    Rothermel { landscape: Arc<Landscape>, weather: Arc<Weather>, rules: RothermelRules },
    /// By the automaton of Alexandridis; its chance is that of the run's seed.
    Alexandridis { landscape: Arc<Landscape>, weather: Arc<Weather>, rules: AlexandridisRules },
}

impl SpreadSetting {
    /// Makes the model of the run of a seed.
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

    /// The fuels of all cells, those of bushes too.
    pub fn landscape(&self) -> &Landscape {
        match self {
            Self::Rothermel { landscape, .. } | Self::Alexandridis { landscape, .. } => landscape,
        }
    }

    /// The weather in the course of the run.
    pub fn weather(&self) -> &Weather {
        match self {
            Self::Rothermel { weather, .. } | Self::Alexandridis { weather, .. } => weather,
        }
    }

    /// Returns how long each fuel flames.
    pub fn flaming_times(&self) -> FlamingTimes {
        FlamingTimes::new(self)
    }
}

/// How long cells flame, by the weather in which they catch fire and by their fuel.
#[derive(Clone, Debug)]
pub struct FlamingTimes {
    spread: SpreadSetting,
    /// By interval of the weather and number of the fuel model; `None` flames forever.
    spans: Vec<Option<SimTime>>,
}

impl FlamingTimes {
    fn new(spread: &SpreadSetting) -> Self {
        let span = |moisture, number| match spread {
            SpreadSetting::Alexandridis { rules, .. } => Some(rules.step),
            SpreadSetting::Rothermel { rules, .. } => {
                let residence_s = FuelModel::by_number(number)
                    .filter(|model| model.burns())
                    .map_or(0.0, |model| FuelBed::new(model, moisture, rules.options.curing).residence_s());
                rules.burn_out.map(|least| least.max(SimTime::from_seconds(residence_s)))
            }
        };
        let intervals = spread.weather().intervals().iter();
        let spans =
            intervals.flat_map(|interval| (0..=u8::MAX).map(move |number| span(&interval.moisture, number))).collect();
        Self { spread: spread.clone(), spans }
    }

    /// Returns when a cell that catches fire then burns out by itself; `None` if it burns forever.
    pub fn burns_out_at(&self, cell: Cell, ignited: SimTime) -> Option<SimTime> {
        let interval = self.spread.weather().interval_at(ignited);
        let number = usize::from(self.spread.landscape().fuel_number(cell));
        self.spans[interval * (usize::from(u8::MAX) + 1) + number].map(|span| ignited + span)
    }
}

/// Where a run took place, and between whom.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub scenario: String,
    pub seed: u64,
    pub program_version: String,
    pub frame: FieldFrame,
    /// In the order of cell indices, none twice.
    pub bushes: Vec<Cell>,
    /// Cells that block trucks and Wumpuses and hold no bush, in the order of their indices.
    pub blocked: Vec<Cell>,
    /// Wumpuses first, then trucks, by number.
    pub agents: Vec<AgentStart>,
    pub rules: Rules,
    /// How fire goes over ground; `None` where only bushes burn.
    pub spread: Option<SpreadSetting>,
    /// The tanks of trucks; `None` where water does not matter.
    pub water: Option<WaterRules>,
}

impl Setting {
    /// Returns true if the cell is ground that burns: its fuel does, and no bush stands there.
    pub fn is_ground(&self, cell: Cell) -> bool {
        let burns = |number| FuelModel::by_number(number).is_some_and(FuelModel::burns);
        self.spread.as_ref().is_some_and(|spread| burns(spread.landscape().fuel_number(cell)))
            && self.bush_index(cell).is_none()
    }

    /// Place of a bush in [`Setting::bushes`]; `None` where nothing grows.
    pub fn bush_index(&self, cell: Cell) -> Option<usize> {
        self.bushes.binary_search_by_key(&(cell.row, cell.col), |bush| (bush.row, bush.col)).ok()
    }

    /// Returns the cells that no body may overlap: bushes and what else blocks, in the order of their indices.
    pub fn obstacles(&self) -> Vec<Cell> {
        let mut cells = [self.bushes.as_slice(), &self.blocked].concat();
        cells.sort_unstable_by_key(|cell| (cell.row, cell.col));
        cells
    }

    /// Place of an agent in [`Setting::agents`].
    pub fn agent_index(&self, id: AgentId) -> Option<usize> {
        self.agents.binary_search_by_key(&id, |start| start.id).ok()
    }
}
