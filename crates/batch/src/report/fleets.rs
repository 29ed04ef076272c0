//! How teams of trucks worked: what they drove, how long they waited, and for what they drove in vain.

use crate::stats::Series;
use crate::table::{RunRecord, run_column};
use wildfire_base::document::Table;
use wildfire_base::document::number::optional;
use wildfire_sim::scenario::Scenario;

/// A mean over the runs of a variant that are done.
struct FleetMean {
    heading: &'static str,
    column: usize,
    scale: f64,
    decimals: usize,
}

const fn mean(heading: &'static str, column: &str, scale: f64, decimals: usize) -> FleetMean {
    FleetMean { heading, column: run_column(column), scale, decimals }
}

const MEANS: [FleetMean; 9] = [
    mean("Burned\nratio", "burned_ratio", 1.0, 3),
    mean("Goals", "truck_goals", 1.0, 1),
    mean("Wasted\ndrives", "truck_wasted_drives", 1.0, 1),
    mean("Hope-\nless", "truck_hopeless_drives", 1.0, 1),
    mean("Flock\nratio", "truck_flock_ratio", 1.0, 3),
    mean("Driven\nkm", "truck_distance_m", 1e-3, 2),
    mean("Waiting\ns", "truck_waiting_s", 1.0, 1),
    mean("Idle\ns", "truck_idle_s", 1.0, 1),
    mean("Dispatch\nCPU ms", "cpu_dispatch_s", 1e3, 2),
];

/// The means of a variant with more than one truck.
#[derive(Clone, Debug)]
pub struct Fleet {
    trucks: usize,
    means: [Series; MEANS.len()],
}

impl Fleet {
    /// Creates the means of a scenario's fleet, if it has one, without any run yet.
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let trucks = scenario.unimog.len();
        (trucks > 1).then(|| Self { trucks, means: Default::default() })
    }

    /// Adds the next run.
    pub fn add(&mut self, run: &RunRecord) {
        for (series, mean) in self.means.iter_mut().zip(&MEANS) {
            run.number(mean.column).into_iter().for_each(|number| series.add(number * mean.scale));
        }
    }

    fn cells(&self) -> impl Iterator<Item = String> {
        let means = self.means.iter().zip(&MEANS);
        let numbers = means.map(|(series, mean)| optional(series.mean(), mean.decimals));
        [self.trucks.to_string()].into_iter().chain(numbers)
    }
}

/// Makes a table of fleets with the titles of their variants, one a line; `None` if there are none.
pub fn fleets_table<'a>(fleets: impl Iterator<Item = (&'a str, &'a Fleet)>) -> Option<Table> {
    let rows: Vec<Vec<String>> =
        fleets.map(|(title, fleet)| [title.to_owned()].into_iter().chain(fleet.cells()).collect()).collect();
    let headings: Vec<&str> = ["Variant", "Trucks"].into_iter().chain(MEANS.map(|mean| mean.heading)).collect();
    (!rows.is_empty()).then(|| Table::new(&headings, rows))
}
