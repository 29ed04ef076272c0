//! Comparisons of two planners, goal by goal, with the methods that compare batches.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::comparison::{Contrast, Metric, MetricKind, adjusted, contrast_of_pairs};
use crate::drives::query::DriveQuery;
use crate::drives::summary::{CLEARANCE, CUSPS, DRIVE_TIME, LENGTH, LOWER_BOUND_RATIO, Measure};
use crate::stats::Interval;
use wildfire_base::document::Table;
use wildfire_base::document::number::{optional, probability, rounded, two_digits};
use wildfire_base::untrusted::visible_start;

/// A figure of two planners over the goals that both solved; success over all goals.
#[derive(Clone, Debug, Serialize)]
pub struct DriveContrast {
    pub planner: String,
    pub against: String,
    /// The column of the figure.
    pub metric: &'static str,
    #[serde(skip)]
    heading: &'static str,
    /// The number of goals that count.
    pub goals: usize,
    pub mean: f64,
    pub against_mean: f64,
    /// The difference, first minus second, with its 95 % interval.
    pub difference: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// The p-value of no difference, adjusted over all comparisons; `None` if no goal differs.
    pub p: Option<f64>,
}

/// The note below the tables of contrasts.
pub const COMPARED: &str = "\
Differences are the first minus the second: of means over goals that both solved, and of success over all goals. \
Intervals are 95 %, by the method of `wildfire compare`; p is adjusted by Holm's method over all comparisons.";

static FIGURES: [(&str, &Measure); 5] = [
    ("length, m", &LENGTH),
    ("length / bound", &LOWER_BOUND_RATIO),
    ("clearance, m", &CLEARANCE),
    ("cusps", &CUSPS),
    ("drive, s", &DRIVE_TIME),
];

impl DriveContrast {
    /// Compares all planners with each other.
    pub fn all(planners: &[String], against: &[String], rows: &[DriveQuery]) -> Vec<Self> {
        let pairs = planners.iter().flat_map(|ours| against.iter().map(move |theirs| (ours, theirs)));
        let mut contrasts: Vec<Self> = pairs.flat_map(|(ours, theirs)| contrasts(ours, theirs, rows)).collect();
        let p_values = adjusted(contrasts.iter().map(|contrast| contrast.p));
        contrasts.iter_mut().zip(p_values).for_each(|(contrast, p)| contrast.p = p);
        contrasts
    }
}

fn contrasts(planner: &str, against: &str, rows: &[DriveQuery]) -> Vec<DriveContrast> {
    let theirs = by_goal(rows, against);
    let pairs: Vec<[&DriveQuery; 2]> =
        // The other planner comes first, as a contrast is that of its second numbers from its first.
        by_goal(rows, planner).into_iter().filter_map(|(goal, row)| Some([*theirs.get(&goal)?, row])).collect();
    let contrast = |metric: &'static str, heading, kind, numbers: &[[f64; 2]]| {
        // The name tells the random stream of its bootstrap.
        let relative = Metric::unknown(format!("{planner}/{against}/{metric}"), kind);
        let Contrast { pairs, means, difference, interval, p_value, .. } = contrast_of_pairs(&relative, numbers)?;
        let [low, high] = Interval::ends(interval);
        Some(DriveContrast {
            planner: planner.to_owned(),
            against: against.to_owned(),
            metric,
            heading,
            goals: pairs,
            mean: means[1],
            against_mean: means[0],
            difference,
            low,
            high,
            p: p_value,
        })
    };
    let solved: Vec<[f64; 2]> =
        pairs.iter().map(|pair| pair.map(|row| f64::from(u8::from(row.solved().is_some())))).collect();
    let success = contrast("success", "success", MetricKind::Answer { column: "success", yes: "true" }, &solved);
    let figures = FIGURES.iter().filter_map(|(heading, measure)| {
        let numbers: Vec<[f64; 2]> = (pairs.iter())
            // A goal that only one planner solved has one length; a mean over it would favour planners that fail on far goals.
            .filter(|pair| pair.iter().all(|row| row.solved().is_some()))
            .filter_map(|[theirs, ours]| Some([measure.number(theirs)?, measure.number(ours)?]))
            .collect();
        contrast(measure.column, heading, MetricKind::Unknown, &numbers)
    });
    success.into_iter().chain(figures).collect()
}

fn by_goal<'a>(rows: &'a [DriveQuery], name: &str) -> BTreeMap<(&'a str, usize), &'a DriveQuery> {
    rows.iter().filter(|row| &*row.planner == name).map(|row| ((&*row.field, row.goal), row)).collect()
}

/// Returns the table of contrasts of two planners.
pub fn contrast_table(pair: &[DriveContrast]) -> Table {
    let ours = visible_start(&pair[0].planner);
    let theirs = visible_start(&pair[0].against);
    let headings = ["Figure", "Goals", &ours, &theirs, "Differ-\nence", "95% low", "95% high", "p"];
    let rows = pair.iter().map(|row| {
        let width = row.low.zip(row.high).map_or(row.difference.abs(), |(low, high)| 0.5 * (high - low));
        // Where nothing differs there is no uncertainty to show.
        let decimals = if width > 0.0 { two_digits(width).min(4) } else { 3 };
        vec![
            row.heading.to_owned(),
            row.goals.to_string(),
            rounded(row.mean, decimals),
            rounded(row.against_mean, decimals),
            rounded(row.difference, decimals),
            optional(row.low, decimals),
            optional(row.high, decimals),
            row.p.map_or_else(|| "-".into(), probability),
        ]
    });
    Table::new(&headings, rows.collect())
}
