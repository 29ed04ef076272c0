//! The worth of decisions of all runs of a batch, as a table: a row for each choice that was not taken.

use std::time::Duration;

use crate::decisions::futures::{AlternativeAction, DecisionValue, SelectedDecisions};
use crate::decisions::why::WhyReport;
use crate::execute::{BatchError, DECISIONS_PARQUET, RealDisk, RunResult, RunRow};
use crate::plan::{PlannedRun, Value};
use crate::stats::Series;
use crate::table::{
    Column, FinishedBatch, Kind, ParquetWriter, RecordedRow, TableOfRows, Unit, about, columns, new_file,
};
use wildfire_base::geometry::Cell;
use wildfire_sim::{RunCost, RunOptions};
use wildfire_timeline::Outcome;

/// Rows that are held in memory.
const ROWS_A_GROUP: usize = 16_384;

/// A decision and one of the choices that were not taken.
#[derive(Clone, Copy)]
pub struct ChoiceRow<'a> {
    worth: &'a DecisionValue,
    /// The number of the decision among those of its run that were judged, from 0.
    number: usize,
    choice: &'a AlternativeAction,
    /// Distances from the agent to where it set out for, and to the choice, in metres.
    metres: (Option<f64>, f64),
}

pub type DecisionColumn = Column<for<'a> fn(&ChoiceRow<'a>) -> Value>;

fn whole(cell: Option<Cell>, side: fn(Cell) -> u16) -> Option<u64> {
    cell.map(|cell| u64::from(side(cell)))
}

/// The columns of `decisions.parquet` in order, after those of the run.
#[rustfmt::skip]
pub const DECISION_COLUMNS: &[DecisionColumn] = columns! { DecisionColumn, row;
    decision: Count None "number of the decision among those of its run that were judged, from 0" = row.number as u64;
    agent: Text None "agent that decides: unimog/0, wumpus/0 ..." = row.worth.decision.agent.id.to_string();
    t_s: Real Seconds "simulated time of the decision" = row.worth.decision.time.as_seconds();
    x_m: Real Metres "position of the agent, from the west" = row.worth.decision.agent.place.x;
    y_m: Real Metres "position of the agent, from the south" = row.worth.decision.agent.place.y;
    options: Count None "number of cells that the agent could go for" = row.worth.decision.options.len() as u64;
    chosen_col: optional Count None "column of the cell that it set out for; none if it stayed"
        = whole(row.worth.selected, |cell| cell.col);
    chosen_row: optional Count None "row of that cell" = whole(row.worth.selected, |cell| cell.row);
    chosen_distance_m: optional Real Metres "straight distance from the agent to that cell" = row.metres.0;
    choice_col: Count None "column of the other cell" = u64::from(row.choice.cell.col);
    choice_row: Count None "row of the other cell" = u64::from(row.choice.cell.row);
    choice_distance_m: Real Metres "straight distance from the agent to the other cell" = row.metres.1;
    chosen_burning_s: optional Real Seconds "how long the cell that it set out for has burned"
        = row.worth.selected_features.map(|cell| cell.burning_s);
    chosen_intact_near: optional Count None "bushes that can burn within 30 m of that cell"
        = row.worth.selected_features.map(|cell| cell.intact_near);
    chosen_burning_near: optional Count None "burning bushes within 30 m of that cell"
        = row.worth.selected_features.map(|cell| cell.burning_near);
    chosen_other_truck_m: optional Real Metres "distance from the nearest other truck to that cell"
        = row.worth.selected_features.and_then(|cell| cell.other_truck_m);
    choice_burning_s: optional Real Seconds "how long the other cell has burned" = row.choice.features.map(|cell| cell.burning_s);
    choice_intact_near: optional Count None "bushes that can burn within 30 m of the other cell"
        = row.choice.features.map(|cell| cell.intact_near);
    choice_burning_near: optional Count None "burning bushes within 30 m of the other cell"
        = row.choice.features.map(|cell| cell.burning_near);
    choice_other_truck_m: optional Real Metres "distance from the nearest other truck to the other cell"
        = row.choice.features.and_then(|cell| cell.other_truck_m);
    chosen_lost: Real None "bushes lost with the agent's own choice, mean over futures"
        = Series::from_values(&row.worth.losses).mean().unwrap_or(0.0);
    futures: Count None "number of futures in which both were played" = row.choice.gains.len() as u64;
    gain: Real None "bushes by which the agent's side does better with the other cell, mean over futures" = row.choice.mean;
    gain_standard_error: Real None "standard error of that mean"
        = Series::from_values(&row.choice.gains).standard_error().unwrap_or(0.0);
    gain_low: optional Real None "lower end of the 95 % interval of that mean; none if all gains are equal"
        = row.choice.interval.map(|interval| interval.low);
    gain_high: optional Real None "its upper end" = row.choice.interval.map(|interval| interval.high);
    first_gain: Real None "gain in the first of these futures" = row.choice.gains.first().copied().unwrap_or(0.0);
    half_gain: Real None "mean gain in the first half of these futures, rounded down"
        = Series::from_values(&row.choice.gains[..row.choice.gains.len() / 2]).mean().unwrap_or(0.0);
    p_adjusted: Real None "p-value of the gain, adjusted for all choices of the run (Holm)" = row.choice.p_adjusted;
    is_mistake: Flag None "whether another choice than that of the agent is significantly better" = row.worth.better().is_some();
};

/// Numbers of decisions of the runs of one variant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DecisionTally {
    pub runs: u64,
    pub decisions: u64,
    pub mistakes: u64,
    pub good: u64,
}

/// Judges decisions of all runs of a batch and writes `decisions.parquet` into its folder.
///
/// Calls `on_run` after each run. Returns a tally for each variant of the plan.
///
/// # Errors
/// If a run cannot take place or be forked, or the file cannot be written.
pub fn judge_batch(
    batch: &FinishedBatch,
    selection: &SelectedDecisions,
    options: &RunOptions,
    on_run: impl Fn(),
) -> Result<Vec<DecisionTally>, JudgeError> {
    let plan = batch.plan();
    let path = batch.folder().join(DECISIONS_PARQUET);
    // Groups of rows go to the file as they fill, as a batch of 1,000 runs has more choices than fit into memory.
    let mut file = new_file(path, &RealDisk, plan, TableOfRows::Decisions, ROWS_A_GROUP)?;
    let mut tallies = vec![DecisionTally::default(); plan.variants.len()];
    for run in batch.runs() {
        let report = selection.judge(&run.variant.scenario, run.seed, options, |_| {})?;
        add(&mut file, &run, &report)?;
        let tally = &mut tallies[plan.place(run.number).variant];
        tally.runs += 1;
        tally.decisions += report.worths.len() as u64;
        tally.mistakes += report.mistakes().len() as u64;
        tally.good += report.good().len() as u64;
        on_run();
    }
    file.finish()?;
    Ok(tallies)
}

fn add(file: &mut ParquetWriter, run: &PlannedRun<'_>, report: &WhyReport) -> Result<(), BatchError> {
    let frame = run.variant.scenario.field.frame();
    let metres = |worth: &DecisionValue, cell: Cell| (frame.centre(cell) - worth.decision.agent.place).length();
    let mut rows: Vec<ChoiceRow<'_>> = Vec::new();
    for (number, worth) in report.worths.iter().enumerate() {
        let selected_m = worth.selected.map(|cell| metres(worth, cell));
        rows.extend(worth.others.iter().map(|choice| ChoiceRow {
            worth,
            number,
            choice,
            metres: (selected_m, metres(worth, choice.cell)),
        }));
    }
    // The columns that name the run are those of its row, whatever its outcome.
    let outcome = RunResult::new(Outcome::default(), RunCost::default());
    let named = RecordedRow::new(RunRow::done(run.label(), outcome, Duration::ZERO));
    file.add_alike(named.label_values(), rows.len(), |row, column| (DECISION_COLUMNS[column].value)(&rows[row]))
}

/// The reason why decisions of a batch were not judged.
#[derive(Debug, thiserror::Error)]
pub enum JudgeError {
    #[error(transparent)]
    Run(#[from] wildfire_sim::RunError),
    #[error(transparent)]
    File(#[from] BatchError),
}
