//! The columns of runs that a report shows, and how.

use crate::batch::table::{RUN_COLUMNS, RunColumn, RunRecord, Unit, is_measured, run_column};

const OBSTACLES: usize = run_column("obstacles");

/// A number of every run that is done: that of a column, in the unit in which charts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity(usize);

/// The ends of a run.
pub static STATES: [Quantity; 4] =
    [quantity("intact"), quantity("burning"), quantity("burned_out"), quantity("extinguished")];

/// The parts of the planners' CPU time.
pub static CPU_PARTS: [Quantity; 7] = [
    quantity("cpu_clearance_field_s"),
    quantity("cpu_sampling_s"),
    quantity("cpu_map_generation_s"),
    quantity("cpu_roadmap_search_s"),
    quantity("cpu_local_search_s"),
    quantity("cpu_reachability_s"),
    quantity("cpu_wumpus_s"),
];

/// Further quantities that differ from run to run.
pub static MEASURES: [Quantity; 4] = [
    quantity("mean_response_s"),
    quantity("truck_distance_m"),
    quantity("truck_stuck_s"),
    quantity("cpu_unimog_total_s"),
];

const fn quantity(column: &str) -> Quantity {
    Quantity(run_column(column))
}

/// Everything that is kept of a run.
pub fn all() -> impl Iterator<Item = Quantity> {
    STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).copied()
}

impl Quantity {
    fn about(self) -> &'static RunColumn {
        &RUN_COLUMNS[self.0]
    }

    pub fn column(self) -> &'static str {
        self.about().name
    }

    pub fn label(self) -> &'static str {
        self.about().title
    }

    /// Returns its name outside of a chart of several.
    pub fn title(self) -> String {
        match self.about().unit {
            Unit::Cells => format!("{} at the end of a run", self.label()),
            _ => self.label().into(),
        }
    }

    /// Returns the number of a run; `None` where the run has none. Cells are shown as shares of all, CPU times in
    /// milliseconds.
    pub fn number(self, run: &RunRecord) -> Option<f64> {
        let number = run.number(self.0)?;
        match self.about().unit {
            Unit::Cells => Some(number / run.number(OBSTACLES).filter(|&obstacles| obstacles > 0.0)?),
            Unit::Seconds if is_measured(self.column()) => Some(number * 1e3),
            _ => Some(number),
        }
    }

    /// Returns what an axis is called that shows it.
    pub fn axis(self) -> &'static str {
        match self.about().unit {
            Unit::Cells => SHARE_AXIS,
            Unit::Metres => "metres",
            Unit::Seconds if is_measured(self.column()) => "milliseconds",
            Unit::Seconds => "seconds",
            other => other.symbol(),
        }
    }
}

/// The name of an axis that shows shares of cells.
pub const SHARE_AXIS: &str = "share of obstacles";
