//! What a report keeps of a batch's rows.

use std::collections::BTreeMap;

use super::quantities::{self, Quantity};
use crate::batch::plan::BatchPlan;
use crate::batch::report::summary::{BatchReport, VariantReport};
use crate::batch::table::{FinishedError, FinishedRows, RunRecord, run_column};
use crate::picture::charts::Estimate;
use crate::stats::Series;

/// How long agents were stuck.
const STUCK_S: [usize; 2] = [run_column("truck_stuck_s"), run_column("wumpus_stuck_s")];

/// The most runs of a kind that are told one by one.
pub const TOLD_RUNS: usize = 100;

/// A batch's rows, in so far as they are reported.
#[derive(Debug, Default)]
pub struct Collected {
    pub report: BatchReport,
    /// Of each variant in the order of the plan.
    pub variants: Vec<Values>,
    /// Runs without a result, the first of them; their number is in the report.
    pub failures: Vec<ToldRun>,
    /// Runs in which an agent was stuck, the longest first, and how many there are.
    pub stuck: Vec<ToldRun>,
    pub stuck_runs: usize,
}

/// Numbers of the runs of a variant that are done, by the column that they are from.
#[derive(Debug, Default)]
pub struct Values(BTreeMap<&'static str, Vec<f64>>);

/// A run that is told of.
#[derive(Debug)]
pub struct ToldRun {
    pub number: u64,
    pub words: String,
}

impl Collected {
    pub fn read(plan: &BatchPlan, mut rows: FinishedRows) -> Result<Self, FinishedError> {
        let mut collected = Self::default();
        let mut stuck: Vec<(u64, f64)> = Vec::new();
        let mut number = 0;
        for variant in &plan.variants {
            let mut report = VariantReport::new(plan.title(variant), &variant.scenario);
            let mut values = Values::default();
            for _ in 0..plan.seeds.count() {
                number += 1;
                let run = plan.run(number);
                let row = rows.next(&run)?;
                report.add(&row);
                if row.is_done() {
                    values.add(&row);
                    let seconds = STUCK_S.iter().filter_map(|&column| row.number(column)).sum::<f64>();
                    stuck.extend((seconds > 0.0).then_some((number, seconds)));
                } else if collected.failures.len() < TOLD_RUNS {
                    let words = format!("{}: {}", row.status(), row.message());
                    collected.failures.push(ToldRun { number, words });
                }
            }
            collected.report.variants.push(report);
            collected.variants.push(values);
        }
        stuck.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        collected.stuck_runs = stuck.len();
        let told = stuck.into_iter().take(TOLD_RUNS);
        collected.stuck = told.map(|(number, seconds)| ToldRun { number, words: format!("{seconds:.1} s") }).collect();
        Ok(collected)
    }
}

impl Values {
    fn add(&mut self, row: &RunRecord) {
        for quantity in quantities::all() {
            self.0.entry(quantity.column()).or_default().extend(quantity.of(row));
        }
    }

    /// In the order of the runs; without those of runs that have none.
    pub fn of(&self, quantity: &Quantity) -> &[f64] {
        self.0.get(quantity.column()).map_or(&[], Vec::as_slice)
    }

    /// The mean with its interval; `None` without any value.
    pub fn mean(&self, quantity: &Quantity) -> Option<Estimate> {
        let series = Series::of(self.of(quantity));
        let interval = series.mean_interval().map(|interval| (interval.low, interval.high));
        Some(Estimate { value: series.mean()?, interval })
    }
}
