//! What a report keeps of a batch's rows.

use std::collections::BTreeMap;
use std::time::Duration;

use super::quantities::{self, Quantity};
use crate::batch::execute::{CpuSplit, RunResult, RunRow, Status};
use crate::batch::plan::{BatchPlan, PlannedRun};
use crate::batch::report::{BatchReport, VariantReport};
use crate::batch::table::{FinishedError, FinishedRow, FinishedRows};
use crate::picture::charts::Estimate;
use crate::scenario::Scenario;
use crate::sim::RunCost;
use crate::stats::Series;
use crate::timeline::{AgentId, AgentOutcome, Outcome};

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
            let mut report = VariantReport::titled(plan.title(variant));
            let mut values = Values::default();
            for _ in 0..plan.seeds.count() {
                number += 1;
                let run = plan.run(number);
                let row = rows.next(&run)?;
                report.add(&run_row(&run, &row));
                if row.is_done() {
                    values.add(&row);
                    let seconds = row.number_or_zero("truck_stuck_s") + row.number_or_zero("wumpus_stuck_s");
                    stuck.extend((seconds > 0.0).then_some((number, seconds)));
                } else if collected.failures.len() < TOLD_RUNS {
                    let words = format!("{}: {}", row.value("status"), row.value("message"));
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
    fn add(&mut self, row: &FinishedRow) {
        for quantity in quantities::all() {
            self.0.entry(quantity.column).or_default().extend(quantity.of(row));
        }
    }

    /// In the order of the runs; without those of runs that have none.
    pub fn of(&self, quantity: &Quantity) -> &[f64] {
        self.0.get(quantity.column).map_or(&[], Vec::as_slice)
    }

    /// The mean with its interval; `None` without any value.
    pub fn mean(&self, quantity: &Quantity) -> Option<Estimate> {
        let series = Series::of(self.of(quantity));
        let interval = series.mean_interval().map(|interval| (interval.low, interval.high));
        Some(Estimate { value: series.mean()?, interval })
    }
}

/// What tables and tallies need of a row; everything else in it is empty.
fn run_row(run: &PlannedRun<'_>, row: &FinishedRow) -> RunRow {
    if !row.is_done() {
        let status =
            if row.value("status") == Status::Panicked.to_string() { Status::Panicked } else { Status::Failed };
        return RunRow::not_done(run.label(), status, row.value("message").to_owned(), Duration::ZERO);
    }
    let mut result = RunResult::new(outcome(row, &run.variant.scenario), RunCost::default());
    result.cpu = cpu(row);
    RunRow::done(run.label(), result, Duration::ZERO)
}

fn outcome(row: &FinishedRow, scenario: &Scenario) -> Outcome {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of a field's cells fit; what does not, saturates"
    )]
    let count = |column| row.number_or_zero(column) as u32;
    let agent = |id: fn(u16) -> AgentId| move |number| AgentOutcome::idle(id(number));
    let agents = (0..).take(scenario.wumpus.len()).map(agent(AgentId::wumpus));
    let trucks = (0..).take(scenario.unimog.len()).map(agent(AgentId::unimog));
    Outcome {
        obstacles: count("obstacles"),
        intact: count("intact"),
        burning: count("burning"),
        burned_out: count("burned_out"),
        extinguished: count("extinguished"),
        truck_stuck_s: row.number_or_zero("truck_stuck_s"),
        wumpus_stuck_s: row.number_or_zero("wumpus_stuck_s"),
        wumpus_score: row.number_or_zero("wumpus_score"),
        truck_score: row.number_or_zero("truck_score"),
        agents: agents.chain(trucks).collect(),
        ..Outcome::default()
    }
}

fn cpu(row: &FinishedRow) -> CpuSplit {
    CpuSplit {
        terrain_s: row.number_or_zero("cpu_terrain_s"),
        clearance_field_s: row.number_or_zero("cpu_clearance_field_s"),
        sampling_s: row.number_or_zero("cpu_sampling_s"),
        map_generation_s: row.number_or_zero("cpu_map_generation_s"),
        roadmap_search_s: row.number_or_zero("cpu_roadmap_search_s"),
        local_search_s: row.number_or_zero("cpu_local_search_s"),
        reachability_s: row.number_or_zero("cpu_reachability_s"),
        wumpus_s: row.number_or_zero("cpu_wumpus_s"),
        run_s: row.number_or_zero("cpu_run_s"),
    }
}
