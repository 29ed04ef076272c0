//! The columns of runs that a report shows, and how.

use crate::batch::table::{RUN_COLUMNS, RunColumn, RunRecord, Unit, is_measured, run_column};

const OBSTACLES: usize = run_column("obstacles");

/// A number of every run that is done: that of a column, or the sum of two, in the unit in which charts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity {
    column: usize,
    /// The column that is added, and the name of the sum.
    added: Option<(usize, &'static str)>,
}

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

/// The bushes that did not burn: the share of all.
pub const SAVED: Quantity =
    Quantity { column: run_column("intact"), added: Some((run_column("extinguished"), "Saved")) };

/// All bushes of a field, as a number.
pub const BUSHES: Quantity = quantity("obstacles");

/// Where bushes are few or none: what burned of them and of ground.
pub const BURNED_AREA: Quantity = quantity("burned_ha");

/// The time that fires had, and the planners' time.
pub const RESPONSE: Quantity = quantity("mean_response_s");
pub const PLANNING: Quantity = quantity("cpu_unimog_total_s");

/// Further quantities that differ from run to run.
pub static MEASURES: [Quantity; 4] = [RESPONSE, quantity("truck_distance_m"), quantity("truck_stuck_s"), PLANNING];

const fn quantity(column: &str) -> Quantity {
    Quantity { column: run_column(column), added: None }
}

/// Everything that is kept of a run.
pub fn all() -> impl Iterator<Item = Quantity> {
    STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).copied().chain([SAVED, BUSHES, BURNED_AREA])
}

impl Quantity {
    fn about(self) -> &'static RunColumn {
        &RUN_COLUMNS[self.column]
    }

    /// Returns the name of its column; of a sum that of the sum.
    pub fn column(self) -> String {
        self.added.map_or_else(|| self.about().name.to_owned(), |(_, name)| name.to_lowercase())
    }

    pub fn label(self) -> &'static str {
        self.added.map_or(self.about().title, |(_, name)| name)
    }

    /// Returns its name outside of a chart of several.
    pub fn title(self) -> String {
        match self.about().unit {
            Unit::Cells => format!("{} at the end of a run", self.label()),
            _ => self.label().into(),
        }
    }

    /// Returns the number of a run; `None` where the run has none. Cells but [`BUSHES`] are shown as shares of these, CPU
    /// times in milliseconds.
    pub fn number(self, run: &RunRecord) -> Option<f64> {
        let added = self.added.map_or(Some(0.0), |(column, _)| run.number(column))?;
        let number = run.number(self.column)? + added;
        match self.about().unit {
            Unit::Cells if self != BUSHES => Some(number / run.number(OBSTACLES).filter(|&bushes| bushes > 0.0)?),
            Unit::Seconds if is_measured(self.about().name) => Some(number * 1e3),
            _ => Some(number),
        }
    }

    /// Returns the values that it can have: none is below zero, and no share above one.
    pub fn range(self) -> (f64, f64) {
        match self.about().unit {
            Unit::Cells if self != BUSHES => (0.0, 1.0),
            Unit::Share => (0.0, 1.0),
            _ => (0.0, f64::INFINITY),
        }
    }

    /// Returns what an axis is called that shows it, with the unit.
    pub fn axis(self) -> &'static str {
        match self.about().unit {
            Unit::Cells => SHARE_AXIS,
            Unit::Metres => "distance (m)",
            Unit::Seconds if is_measured(self.about().name) => "CPU time (ms)",
            Unit::Seconds => "time (s)",
            Unit::Hectares => "area (ha)",
            other => other.symbol(),
        }
    }
}

/// The name of an axis that shows shares of cells.
pub const SHARE_AXIS: &str = "share of obstacles (1)";

/// Names the axis of a swept key, with the unit that the key's last word says.
pub fn key_axis(key: &str) -> String {
    const UNITS: [(&str, &str); 13] = [
        ("_deg_s", "°/s"),
        ("_per_s", "1/s"),
        ("_mps2", "m/s²"),
        ("_mps", "m/s"),
        ("_deg", "°"),
        ("_ms", "ms"),
        ("_s", "s"),
        ("_m2", "m²"),
        ("_m", "m"),
        ("_ha", "ha"),
        ("_l", "l"),
        ("_c", "°C"),
        ("_percent", "%"),
    ];
    let unit = UNITS.iter().find(|(ending, _)| key.ends_with(ending)).map_or("1", |(_, unit)| unit);
    format!("{key} ({unit})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_units() {
        for quantity in STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).copied().chain([SAVED, BURNED_AREA]) {
            assert!(quantity.axis().ends_with(')'), "{}: {}", quantity.column(), quantity.axis());
        }
        for (key, axis) in [
            ("fire.burn_out_s", "fire.burn_out_s (s)"),
            ("unimog.speed_mps", "unimog.speed_mps (m/s)"),
            ("field.coverage", "field.coverage (1)"),
            ("unimog.vehicle.steering_rate_deg_s", "unimog.vehicle.steering_rate_deg_s (°/s)"),
        ] {
            assert_eq!(key_axis(key), axis);
        }
    }
}
