//! The metrics that a report shows.

use std::sync::LazyLock;

use super::ReportError;
use crate::comparison::Metric;
use crate::table::{RUN_COLUMNS, RunRecord, run_column};
use wildfire_base::untrusted::visible_start;
use wildfire_scenario::nearest_name;

const OBSTACLES: usize = run_column("obstacles");

/// The axis of states.
pub const SHARE_OF_OBSTACLES: &str = "share of obstacles";

/// The final states of bushes.
pub static STATES: [Metric; 4] = [metric("intact"), metric("burning"), metric("burned_out"), metric("extinguished")];

/// The parts of the planners' CPU time.
pub static CPU_PARTS: [Metric; 9] = [
    metric("cpu_clearance_field_s"),
    metric("cpu_sampling_s"),
    metric("cpu_map_generation_s"),
    metric("cpu_roadmap_search_s"),
    metric("cpu_local_search_s"),
    metric("cpu_reachability_s"),
    metric("cpu_custom_start_s"),
    metric("cpu_custom_queries_s"),
    metric("cpu_wumpus_s"),
];

/// The totals of the planners' CPU time: the trucks', of which their roadmaps', and the Wumpuses'.
pub static CPU_TOTALS: [Metric; 3] = [metric("cpu_unimog_total_s"), metric("cpu_prm_total_s"), metric("cpu_wumpus_s")];

/// Returns whether only runs with custom planners have it.
pub fn is_of_custom_planners(metric: &Metric) -> bool {
    metric.name.starts_with("cpu_custom_")
}

/// The share of the bushes that did not burn.
pub static SAVED: LazyLock<Metric> = LazyLock::new(|| Metric::from_name("saved"));

/// The number of bushes of a field.
pub static BUSHES: Metric = metric("obstacles");

/// The burned area of bushes and ground, where there are few bushes or none.
pub static BURNED_AREA: Metric = metric("burned_ha");

/// More quantities that vary between runs.
pub static MEASURES: [Metric; 4] =
    [metric("mean_response_s"), metric("truck_distance_m"), metric("truck_stuck_s"), metric("cpu_unimog_total_s")];

/// Returns the quantities in which variants are compared: the main one, and all others with an aim.
pub fn aims(main: &'static Metric) -> impl Iterator<Item = &'static Metric> {
    let others = Metric::of_columns().iter().filter(|metric| metric.about.aim.is_some() && **metric != BURNED_AREA);
    [main].into_iter().chain(others)
}

const fn metric(column: &str) -> Metric {
    Metric::of_column(run_column(column))
}

/// The quantities that a report shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SelectedQuantities {
    /// Those that were asked for, each once; none for the usual ones.
    requested: Vec<&'static Metric>,
}

impl SelectedQuantities {
    /// Finds the columns of these names; without any, the default ones.
    ///
    /// # Errors
    /// If there is no such column, or it holds no numbers.
    pub fn new(names: &[String]) -> Result<Self, ReportError> {
        let mut requested = Vec::new();
        for name in names {
            let quantity = &Metric::of_columns()[column_of_numbers(name)?];
            if !requested.contains(&quantity) {
                requested.push(quantity);
            }
        }
        Ok(Self { requested })
    }

    /// Returns the places of the requested columns among [`RUN_COLUMNS`].
    pub fn places(&self) -> Vec<usize> {
        self.requested
            .iter()
            .filter_map(|metric| RUN_COLUMNS.iter().position(|column| column.name == metric.name))
            .collect()
    }

    /// Returns the requested quantities.
    pub fn requested(&self) -> &[&'static Metric] {
        &self.requested
    }

    /// Returns those of some quantities that are shown, in order.
    pub fn among(&self, quantities: &'static [Metric]) -> Vec<&'static Metric> {
        quantities.iter().filter(|metric| self.requested.is_empty() || self.requested.contains(metric)).collect()
    }

    /// Returns the quantities whose distributions, and means over swept keys, are shown.
    pub fn of_runs(&self) -> Vec<&'static Metric> {
        if self.requested.is_empty() { STATES.iter().chain(&MEASURES).collect() } else { self.requested.clone() }
    }

    /// Returns all quantities that are kept of a run: for the answer, and for charts.
    pub fn kept(&self) -> Vec<&'static Metric> {
        let mut kept: Vec<&Metric> = STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).collect();
        kept.extend([&BUSHES, &BURNED_AREA]);
        for quantity in CPU_TOTALS.iter().chain(aims(&SAVED)).chain(self.requested.iter().copied()) {
            kept.extend((!kept.contains(&quantity)).then_some(quantity));
        }
        kept
    }
}

fn column_of_numbers(name: &str) -> Result<usize, ReportError> {
    match RUN_COLUMNS.iter().position(|column| column.name == name) {
        Some(place) if RUN_COLUMNS[place].holds_numbers() => Ok(place),
        Some(_) => Err(ReportError::NoNumbers { name: name.to_owned() }),
        None => {
            let names = RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).map(|column| column.name);
            Err(ReportError::UnknownColumn { name: visible_start(name), nearest: nearest_name(name, names) })
        }
    }
}

/// How charts show a metric. States and their sum are shown as shares of all bushes, CPU times in milliseconds.
impl Metric {
    pub fn label(&self) -> &'static str {
        self.about.title
    }

    /// Returns the title outside of a chart of several quantities.
    pub fn title(&self) -> String {
        let when = if self.is_share_of_bushes() { " at the end of a run" } else { "" };
        format!("{}{when}", self.label())
    }

    fn is_share_of_bushes(&self) -> bool {
        *self == *SAVED || STATES.contains(self)
    }

    /// Returns the number of a run in the unit of charts; `None` where the run has none.
    pub fn shown_number(&self, run: &RunRecord) -> Option<f64> {
        let number = self.number(run)?;
        if self.is_share_of_bushes() {
            return Some(number / run.number(OBSTACLES).filter(|&bushes| bushes > 0.0)?);
        }
        Some(number * self.about.unit.chart_factor())
    }

    /// Returns the least and the greatest possible value.
    pub fn range(&self) -> (f64, f64) {
        if self.is_share_of_bushes() { (0.0, 1.0) } else { self.about.range() }
    }

    /// Returns the title of an axis, with the unit.
    pub fn axis(&self) -> &'static str {
        if self.is_share_of_bushes() { SHARE_OF_OBSTACLES } else { self.about.unit.axis() }
    }

    /// Returns the unit in sentences.
    pub fn unit_in_text(&self) -> &'static str {
        if self.range() == (0.0, 1.0) { "%" } else { self.unit() }
    }

    /// Returns the factor of numbers in sentences.
    pub fn factor_in_text(&self) -> f64 {
        if self.range() == (0.0, 1.0) { 100.0 } else { 1.0 }
    }

    /// Returns the unit of the axis; empty if there is none.
    pub fn unit(&self) -> &'static str {
        self.axis().rsplit_once(" (").map_or("", |(_, unit)| unit.trim_end_matches(')'))
    }
}

/// Returns the title of a swept key's axis, with the unit that the key's last word contains, if any.
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
    // Longer endings come before those that they end with, such as `_deg_s` before `_s`.
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
