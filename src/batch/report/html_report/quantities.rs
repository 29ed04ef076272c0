//! What a report shows of runs.

use crate::batch::table::FinishedRow;

/// A number of every run that is done.
#[derive(Debug, PartialEq, Eq)]
pub struct Quantity {
    /// A column of `runs.csv`.
    pub column: &'static str,
    pub name: &'static str,
    pub unit: Unit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Counts over those of all obstacles.
    Share,
    Metres,
    Seconds,
    /// From seconds.
    Milliseconds,
}

impl Unit {
    /// What an axis is called that shows it.
    pub fn of_axis(self) -> &'static str {
        match self {
            Self::Share => "share of obstacles",
            Self::Metres => "metres",
            Self::Seconds => "seconds",
            Self::Milliseconds => "milliseconds",
        }
    }
}

const fn quantity(column: &'static str, name: &'static str, unit: Unit) -> Quantity {
    Quantity { column, name, unit }
}

/// How a run ends.
pub static STATES: [Quantity; 4] = [
    quantity("intact", "Intact", Unit::Share),
    quantity("burning", "Burning", Unit::Share),
    quantity("burned_out", "Burned out", Unit::Share),
    quantity("extinguished", "Extinguished", Unit::Share),
];

/// Where the planners' CPU time goes.
pub static CPU_PARTS: [Quantity; 7] = [
    quantity("cpu_clearance_field_s", "Clearance field", Unit::Milliseconds),
    quantity("cpu_sampling_s", "Sampling", Unit::Milliseconds),
    quantity("cpu_map_generation_s", "Connecting", Unit::Milliseconds),
    quantity("cpu_roadmap_search_s", "Roadmap search", Unit::Milliseconds),
    quantity("cpu_local_search_s", "Local search", Unit::Milliseconds),
    quantity("cpu_reachability_s", "Reachability", Unit::Milliseconds),
    quantity("cpu_wumpus_s", "Wumpus", Unit::Milliseconds),
];

/// What else differs from run to run.
pub static MEASURES: [Quantity; 4] = [
    quantity("mean_response_s", "Time from ignition to extinction", Unit::Seconds),
    quantity("truck_distance_m", "Distance driven by the trucks", Unit::Metres),
    quantity("truck_stuck_s", "Time that trucks were stuck", Unit::Seconds),
    quantity("cpu_unimog_total_s", "CPU time of the trucks' planning", Unit::Milliseconds),
];

/// Everything that is kept of a run.
pub fn all() -> impl Iterator<Item = &'static Quantity> {
    STATES.iter().chain(&CPU_PARTS).chain(&MEASURES)
}

impl Quantity {
    /// Its name where it stands alone.
    pub fn title(&self) -> String {
        match self.unit {
            Unit::Share => format!("{} at the end of a run", self.name),
            Unit::Metres | Unit::Seconds | Unit::Milliseconds => self.name.into(),
        }
    }

    /// The number of a run; `None` where the run has none.
    pub fn of(&self, row: &FinishedRow) -> Option<f64> {
        let number = row.number(self.column)?;
        match self.unit {
            Unit::Share => Some(number / row.number("obstacles").filter(|&obstacles| obstacles > 0.0)?),
            Unit::Milliseconds => Some(number * 1e3),
            Unit::Metres | Unit::Seconds => Some(number),
        }
    }
}
