//! The columns of runs that a report shows, and how.

use super::ReportError;
use crate::comparison::{NAMED_METRICS, NamedMetric};
use crate::table::{Column, RUN_COLUMNS, RunRecord, place, run_column};
use wildfire_base::untrusted::visible_start;
use wildfire_sim::scenario::nearest_name;

const OBSTACLES: usize = run_column("obstacles");
const SAVED_METRIC: &NamedMetric = &NAMED_METRICS[place(NAMED_METRICS, "saved")];

/// The axis of states.
pub const SHARE_OF_OBSTACLES: &str = "share of obstacles";

/// A number of every run that is done: that of a column, or the sum of two, in the unit in which charts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity {
    column: usize,
    /// The column that is added: the sum is the metric `saved`.
    added: Option<usize>,
}

/// The ends of a run.
pub static STATES: [Quantity; 4] =
    [quantity("intact"), quantity("burning"), quantity("burned_out"), quantity("extinguished")];

/// The parts of the planners' CPU time.
pub static CPU_PARTS: [Quantity; 9] = [
    quantity("cpu_clearance_field_s"),
    quantity("cpu_sampling_s"),
    quantity("cpu_map_generation_s"),
    quantity("cpu_roadmap_search_s"),
    quantity("cpu_local_search_s"),
    quantity("cpu_reachability_s"),
    CUSTOM_PLANNERS[0],
    CUSTOM_PLANNERS[1],
    quantity("cpu_wumpus_s"),
];

/// The parts that only runs with planners that are not built in have.
pub const CUSTOM_PLANNERS: [Quantity; 2] = [quantity("cpu_custom_start_s"), quantity("cpu_custom_queries_s")];

/// The bushes that did not burn: the share of all.
pub const SAVED: Quantity = Quantity { column: run_column("intact"), added: Some(run_column("extinguished")) };

/// All bushes of a field, as a number.
pub const BUSHES: Quantity = quantity("obstacles");

/// Where bushes are few or none: what burned of them and of ground.
pub const BURNED_AREA: Quantity = quantity("burned_ha");

/// Further quantities that differ from run to run.
pub static MEASURES: [Quantity; 4] = [
    quantity("mean_response_s"),
    quantity("truck_distance_m"),
    quantity("truck_stuck_s"),
    quantity("cpu_unimog_total_s"),
];

/// Returns what variants are compared in: the main quantity, and whatever else has an aim.
pub fn aims(main: Quantity) -> impl Iterator<Item = Quantity> {
    let columns = (0..RUN_COLUMNS.len()).map(|column| Quantity { column, added: None });
    let others = columns.filter(|quantity| quantity.about().aim.is_some() && *quantity != BURNED_AREA);
    [main].into_iter().chain(others)
}

const fn quantity(column: &str) -> Quantity {
    Quantity { column: run_column(column), added: None }
}

/// The quantities that a report shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChosenQuantities {
    /// Those that were asked for, each once; none for the usual ones.
    asked: Vec<Quantity>,
}

impl ChosenQuantities {
    /// Finds the columns of these names; without any the usual ones are shown.
    ///
    /// # Errors
    /// If there is no such column, or it holds no numbers.
    pub fn new(names: &[String]) -> Result<Self, ReportError> {
        let mut asked = Vec::new();
        for name in names {
            let quantity = Quantity { column: column_of_numbers(name)?, added: None };
            if !asked.contains(&quantity) {
                asked.push(quantity);
            }
        }
        Ok(Self { asked })
    }

    /// Returns the places of those that were asked for, among [`RUN_COLUMNS`].
    pub fn places(&self) -> Vec<usize> {
        self.asked.iter().map(|quantity| quantity.column).collect()
    }

    /// Returns those that were asked for.
    pub fn asked(&self) -> &[Quantity] {
        &self.asked
    }

    /// Returns those of some quantities that are shown, in their order.
    pub fn among(&self, quantities: &[Quantity]) -> Vec<Quantity> {
        let is_shown = |quantity: &Quantity| self.asked.is_empty() || self.asked.contains(quantity);
        quantities.iter().copied().filter(is_shown).collect()
    }

    /// Returns those whose distributions, and means over what is swept, are shown.
    pub fn of_runs(&self) -> Vec<Quantity> {
        let usual = || STATES.iter().chain(&MEASURES).copied().collect();
        if self.asked.is_empty() { usual() } else { self.asked.clone() }
    }

    /// Returns everything that is kept of a run: what the answer needs, and what is shown.
    pub fn kept(&self) -> Vec<Quantity> {
        let mut kept: Vec<Quantity> = STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).copied().collect();
        kept.extend([BUSHES, BURNED_AREA]);
        for quantity in aims(SAVED).chain(self.asked.iter().copied()) {
            kept.extend((!kept.contains(&quantity)).then_some(quantity));
        }
        kept
    }
}

fn column_of_numbers(name: &str) -> Result<usize, ReportError> {
    let names = || RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).map(|column| column.name);
    match RUN_COLUMNS.iter().position(|column| column.name == name) {
        Some(place) if RUN_COLUMNS[place].holds_numbers() => Ok(place),
        Some(_) => Err(ReportError::NoNumbers { name: name.to_owned() }),
        None => Err(ReportError::UnknownColumn { name: visible_start(name), nearest: nearest_name(name, names()) }),
    }
}

impl Quantity {
    /// Returns all that the table of columns says of it.
    pub fn about(self) -> Column<()> {
        match self.added {
            Some(_) => SAVED_METRIC.without_value(),
            None => RUN_COLUMNS[self.column].without_value(),
        }
    }

    /// Returns the name of its column; of a sum that of the sum.
    pub fn column(self) -> &'static str {
        self.about().name
    }

    pub fn label(self) -> &'static str {
        self.about().title
    }

    /// Returns its name outside of a chart of several.
    pub fn title(self) -> String {
        let when = if self.is_share_of_bushes() { " at the end of a run" } else { "" };
        format!("{}{when}", self.label())
    }

    fn is_share_of_bushes(self) -> bool {
        self == SAVED || STATES.contains(&self)
    }

    /// Returns the number of a run; `None` where the run has none. States and their sum are shown as shares of all bushes, CPU
    /// times in milliseconds.
    pub fn number(self, run: &RunRecord) -> Option<f64> {
        let number = run.number(self.column)? + self.added.map_or(Some(0.0), |column| run.number(column))?;
        if self.is_share_of_bushes() {
            return Some(number / run.number(OBSTACLES).filter(|&bushes| bushes > 0.0)?);
        }
        Some(number * RUN_COLUMNS[self.column].unit.chart_factor())
    }

    /// Returns the least and the greatest value that it can have.
    pub fn range(self) -> (f64, f64) {
        if self.is_share_of_bushes() { (0.0, 1.0) } else { self.about().range() }
    }

    /// Returns what an axis is called that shows it, with the unit.
    pub fn axis(self) -> &'static str {
        if self.is_share_of_bushes() { SHARE_OF_OBSTACLES } else { self.about().unit.axis() }
    }

    /// Returns the unit in which sentences give it, and the factor of its numbers in them.
    pub fn in_words(self) -> (&'static str, f64) {
        if self.range() == (0.0, 1.0) { ("%", 100.0) } else { (self.unit(), 1.0) }
    }

    /// Returns the unit of its axis; empty of none.
    pub fn unit(self) -> &'static str {
        self.axis().rsplit_once(" (").map_or("", |(_, unit)| unit.trim_end_matches(')'))
    }
}

/// Names the axis of a swept key, with the unit that the key's last word says, if it says one.
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
    let unit = UNITS.iter().find(|(ending, _)| key.ends_with(ending));
    unit.map_or_else(|| key.to_owned(), |(_, unit)| format!("{key} ({unit})"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_column_of_numbers_has_a_title_of_its_own() {
        let titles: BTreeSet<&str> =
            RUN_COLUMNS.iter().map(|column| column.title).filter(|it| !it.is_empty()).collect();
        assert_eq!(titles.len(), RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).count());
        assert!(RUN_COLUMNS.iter().all(|column| column.holds_numbers() != column.title.is_empty()));
    }

    #[test]
    fn axes_of_keys_have_the_unit_that_the_key_ends_with() {
        for (key, axis) in [
            ("fire.burn_out_s", "fire.burn_out_s (s)"),
            ("unimog.speed_mps", "unimog.speed_mps (m/s)"),
            ("field.coverage", "field.coverage"),
            ("unimog.vehicle.steering_rate_deg_s", "unimog.vehicle.steering_rate_deg_s (°/s)"),
        ] {
            assert_eq!(key_axis(key), axis);
        }
    }
}
