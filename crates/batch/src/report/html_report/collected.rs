//! The rows of a batch, as far as a report needs them.

use std::collections::BTreeMap;

use super::quantities::SelectedQuantities;
use crate::comparison::Metric;
use crate::plan::BatchPlan;
use crate::report::summary::{BatchReport, VariantReport, validity_of};
use crate::stats::{Series, Validity};
use crate::table::{FinishedError, FinishedRows, RunRecord, run_column};
use wildfire_picture::charts::Estimate;

/// Times in which agents were stuck.
const STUCK_S: [usize; 2] = [run_column("truck_stuck_s"), run_column("wumpus_stuck_s")];

/// The maximum number of runs of a kind that are listed individually.
pub const LISTED_RUNS: usize = 100;

/// The numbers of a batch for its report.
#[derive(Debug, Default)]
pub struct Collected {
    pub report: BatchReport,
    /// The numbers of each variant, in the order of the plan.
    pub variants: Vec<Values>,
    /// The first runs without a result; the report has their number.
    pub failures: Vec<ListedRun>,
    /// The runs in which an agent was stuck, longest first, and their number.
    pub stuck: Vec<ListedRun>,
    pub stuck_runs: usize,
}

/// The numbers of a variant's runs, by quantity: one per seed, in order, NaN where the run has none.
#[derive(Debug, Default)]
pub struct Values {
    by_quantity: BTreeMap<&'static str, Vec<f64>>,
    /// Of the intervals of means.
    pub validity: Validity,
}

/// A listed run, with the reason.
#[derive(Debug)]
pub struct ListedRun {
    pub number: u64,
    pub reason: String,
}

impl Collected {
    /// Reads all rows, and keeps the usual and the chosen quantities of runs.
    pub fn read(
        plan: &BatchPlan,
        mut rows: FinishedRows,
        selected: &SelectedQuantities,
    ) -> Result<Self, FinishedError> {
        let kept = selected.kept();
        let mut collected = Self::default();
        let mut stuck: Vec<(u64, f64)> = Vec::new();
        let mut number = 0;
        for (index, variant) in plan.variants.iter().enumerate() {
            let mut report = VariantReport::new(plan, variant);
            let mut values = Values { validity: validity_of(plan), ..Values::default() };
            for _ in 0..plan.seeds_of(index) {
                number += 1;
                let run = plan.run(number);
                let row = rows.next(&run)?;
                report.add(&row);
                values.add(&row, &kept);
                if row.is_done() {
                    let seconds = STUCK_S.iter().filter_map(|&column| row.number(column)).sum::<f64>();
                    // All are kept until they are sorted, as the run that was stuck the longest may come last.
                    stuck.extend((seconds > 0.0).then_some((number, seconds)));
                } else if collected.failures.len() < LISTED_RUNS {
                    let reason = format!("{}: {}", row.status(), row.message());
                    collected.failures.push(ListedRun { number, reason });
                }
            }
            collected.report.variants.push(report);
            collected.variants.push(values);
        }
        // Ties go to the first run of the plan, so that the list does not depend on the sort.
        stuck.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        collected.stuck_runs = stuck.len();
        collected.stuck = stuck
            .into_iter()
            .take(LISTED_RUNS)
            .map(|(number, seconds)| ListedRun { number, reason: format!("{seconds:.1} s") })
            .collect();
        Ok(collected)
    }
}

impl Values {
    fn add(&mut self, row: &RunRecord, kept: &[&'static Metric]) {
        for &quantity in kept {
            let number = quantity.shown_number(row).filter(|_| row.is_done());
            self.by_quantity.entry(quantity.about.name).or_default().push(number.unwrap_or(f64::NAN));
        }
    }

    /// Returns a number for each seed; NaN where the run has none.
    pub fn of_seeds(&self, quantity: &Metric) -> &[f64] {
        self.by_quantity.get(quantity.about.name).map_or(&[], Vec::as_slice)
    }

    /// Returns the numbers of the runs that have one, in their order.
    pub fn numbers(&self, quantity: &Metric) -> Vec<f64> {
        self.of_seeds(quantity).iter().copied().filter(|number| !number.is_nan()).collect()
    }

    /// Returns the sum, without an interval; `None` without values.
    pub fn sum(&self, quantity: &Metric) -> Option<Estimate> {
        let numbers = self.numbers(quantity);
        (!numbers.is_empty()).then(|| Estimate { value: numbers.iter().sum(), interval: None })
    }

    /// Returns the mean with its interval; `None` without values.
    pub fn mean(&self, quantity: &Metric) -> Option<Estimate> {
        mean_of(&self.numbers(quantity), quantity.range(), self.validity)
    }
}

/// Returns the mean of numbers in a range with its interval, which stays within the range; `None` without numbers.
pub fn mean_of(numbers: &[f64], range: (f64, f64), validity: Validity) -> Option<Estimate> {
    let series = Series::from_values(numbers);
    let value = series.mean().filter(|mean| mean.is_finite())?;
    let interval = series.mean_interval_for(validity, range).map(|interval| (interval.low, interval.high));
    // Of numbers as large as 1e200 the spread is beyond all numbers.
    let interval = interval.filter(|(low, high)| low.is_finite() && high.is_finite());
    Some(Estimate { value, interval })
}
