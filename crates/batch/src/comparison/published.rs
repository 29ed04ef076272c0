//! The comparison of a batch with the five published runs of a student's program from 2024.
//!
//! The figures are Tables I and II of A. Shaikh, "RBE 550: Wildfire Assignment", 2024. Their seeds are not known, so
//! nothing can be paired.

use std::path::Path;

use rand::RngExt;

use crate::comparison::error::ComparisonError;
use crate::comparison::runs_table::{self, RowField, RunsTable};
use crate::comparison::sides::{Selection, Side, whole};
use crate::comparison::{Pairs, SideSummary, summary};
use crate::stats::{Interval, Series, quantile, welch_interval};
use wildfire_base::rng;

/// Runs that were published.
const RUNS: usize = 5;

/// Obstacles of each published run: all, intact, burned, extinguished.
const OBSTACLES: [[f64; 4]; RUNS] = [
    [237.0, 67.0, 84.0, 86.0],
    [235.0, 44.0, 113.0, 78.0],
    [238.0, 79.0, 70.0, 89.0],
    [234.0, 85.0, 54.0, 95.0],
    [228.0, 79.0, 78.0, 71.0],
];

/// States, their columns here and in the published table.
const STATES: [(&str, &str, usize); 3] =
    [("intact", "intact_ratio", 1), ("burned", "burned_ratio", 2), ("extinguished", "extinguished_ratio", 3)];

/// CPU seconds of each published run, and the columns here: multiples of 1/64 s, the resolution of that clock.
const CPU_TIMES: [(&str, &str, [f64; RUNS]); 7] = [
    ("sampling", "cpu_sampling_s", [0.031, 0.031, 0.016, 0.016, 0.016]),
    ("map generation", "cpu_map_generation_s", [0.594, 0.578, 0.594, 0.609, 0.563]),
    ("roadmap search", "cpu_roadmap_search_s", [0.0, 0.094, 0.031, 0.016, 0.047]),
    ("local search", "cpu_local_search_s", [0.906, 1.078, 0.828, 0.672, 1.0]),
    ("Unimog total", "cpu_unimog_total_s", [1.531, 1.781, 1.469, 1.313, 1.625]),
    ("PRM only", "cpu_prm_total_s", [0.625, 0.703, 0.641, 0.641, 0.625]),
    ("Wumpus search", "cpu_wumpus_s", [1.828, 1.813, 2.906, 2.125, 1.688]),
];

/// Means of five runs that are drawn from the batch.
const DRAWS: usize = 20_000;

/// A batch compared with the published tables.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedComparison {
    pub batch: SideSummary,
    pub states: Vec<PublishedState>,
    pub times: Vec<PublishedTime>,
}

/// The ratio of a state, in the published runs and in the batch.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedState {
    pub name: &'static str,
    pub published: Series,
    pub batch: Series,
    /// Welch's interval of the batch's mean minus the published one.
    pub difference: Option<Interval>,
    /// The interval that holds 95 % of the means of five runs of the batch.
    pub five_runs: Interval,
    /// The share of means of five runs of the batch that are at least as far from the batch's mean as the published
    /// one.
    pub as_far: f64,
}

/// CPU seconds, in the published runs and in the batch.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedTime {
    pub name: &'static str,
    pub published_s: f64,
    pub batch_s: f64,
}

impl PublishedComparison {
    /// Compares the finished runs of a batch, a folder or its table, with the published ones.
    pub fn from_batch(path: &Path, selection: &Selection) -> Result<Self, ComparisonError> {
        let columns = STATES.map(|(_, column, _)| column).into_iter().chain(CPU_TIMES.map(|(_, column, _)| column));
        let file = runs_table::open(path)?;
        // The check by name comes first, so the error for a table of drives names a column and no value.
        if let Some(column) = columns.clone().find(|column| file.place(column).is_none()) {
            return Err(ComparisonError::NotATableOfRuns { path: path.to_owned(), column });
        }
        let fields: Vec<RowField> = columns.map(|column| RowField::Number(column.into())).collect();
        let table = RunsTable::read(file, &fields)?;
        let side = whole(&table, selection)?;
        // Every run is its own partner, unless a seed is there twice.
        let pairs = Pairs::new(&side, &side)?;
        if pairs.runs.is_empty() {
            return Err(ComparisonError::NoRows { path: table.path.clone() });
        }
        Ok(Self { batch: summary(&side), states: states(&side, &pairs), times: times(&side, &pairs) })
    }
}

fn numbers(side: &Side<'_>, pairs: &Pairs, column: usize) -> Vec<f64> {
    let values = pairs.runs.iter().map(|&(run, _)| side.table.values[column][run]);
    values.filter(|value| !value.is_nan()).collect()
}

fn states(side: &Side<'_>, pairs: &Pairs) -> Vec<PublishedState> {
    let states = STATES.into_iter().enumerate().filter_map(|(index, (name, _, column))| {
        let published = Series::from_values(&OBSTACLES.map(|run| run[column] / run[0]));
        let numbers = numbers(side, pairs, index);
        let batch = Series::from_values(&numbers);
        let (five_runs, as_far) = of_five_runs(&numbers, published.mean()?, name)?;
        let difference = welch_interval(&published, &batch);
        Some(PublishedState { name, published, batch, difference, five_runs, as_far })
    });
    states.collect()
}

/// Returns the interval of means of five runs, and the share of them that is as far off as the published one; `None`
/// of no numbers.
fn of_five_runs(numbers: &[f64], published: f64, name: &str) -> Option<(Interval, f64)> {
    let mean = Series::from_values(numbers).mean()?;
    let random = &mut rng::stream(1, &format!("report/{name}"));
    let mut means: Vec<f64> = (0..DRAWS)
        .map(|_| (0..RUNS).map(|_| numbers[random.random_range(0..numbers.len())]).sum::<f64>() / RUNS as f64)
        .collect();
    means.sort_unstable_by(f64::total_cmp);
    let far = means.iter().filter(|&&of_five| (of_five - mean).abs() >= (published - mean).abs()).count();
    let interval = Interval { low: quantile(&means, 0.025)?, high: quantile(&means, 0.975)? };
    Some((interval, far as f64 / DRAWS as f64))
}

fn times(side: &Side<'_>, pairs: &Pairs) -> Vec<PublishedTime> {
    let times = CPU_TIMES.into_iter().enumerate().filter_map(|(index, (name, _, published))| {
        let batch = Series::from_values(&numbers(side, pairs, STATES.len() + index));
        Some(PublishedTime { name, published_s: Series::from_values(&published).mean()?, batch_s: batch.mean()? })
    });
    times.collect()
}
