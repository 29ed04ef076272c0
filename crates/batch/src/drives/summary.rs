//! The summary of a planner's drives in one variant: success rate, and means and quantiles of figures.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::drives::query::DriveQuery;
use crate::drives::table::DriveTable;
use crate::stats::{Series, quantile, quantile_interval, wilson_interval};
use wildfire_base::object;
use wildfire_picture::charts::Estimate;

/// A number of a query, and its appearance in charts.
#[derive(Debug)]
pub struct Measure {
    /// The name in tables of queries.
    pub column: &'static str,
    pub title: &'static str,
    /// The name of an axis, with its unit.
    pub axis: &'static str,
    /// The factor from the column to the axis.
    pub scale: f64,
    pub is_logarithmic: bool,
    value: fn(&DriveQuery) -> Option<f64>,
}

impl Measure {
    const fn new(
        column: &'static str,
        title: &'static str,
        axis: &'static str,
        value: fn(&DriveQuery) -> Option<f64>,
    ) -> Self {
        Self { column, title, axis, scale: 1.0, is_logarithmic: false, value }
    }

    const fn in_milliseconds(self) -> Self {
        Self { scale: 1e3, ..self }
    }

    const fn logarithmic(self) -> Self {
        Self { is_logarithmic: true, ..self }
    }

    /// Returns the number of a query; `None` where it has none.
    pub fn number(&self, query: &DriveQuery) -> Option<f64> {
        (self.value)(query)
    }
}

pub static LOWER_BOUND_RATIO: Measure =
    Measure::new("lower_bound_ratio", "Length over the lower bound", "length / bound", |query| {
        query.solved()?.printed_ratio()
    });

pub static CPU_QUERY: Measure =
    Measure::new("cpu_query_s", "CPU time of a query", "milliseconds", |query| Some(query.cost?.cpu_query_s))
        .in_milliseconds()
        .logarithmic();

pub static CLEARANCE: Measure = Measure::new("min_clearance_m", "Smallest clearance of a drive", "metres", |query| {
    Some(query.solved()?.min_clearance_m)
});

// All goals of a field share it.
pub static CPU_BUILD: Measure =
    Measure::new("cpu_build_s", "CPU time of clearance field and preparation", "milliseconds", |query| {
        query.cost.filter(|_| query.goal == 0).map(|cost| cost.cpu_build_s)
    })
    .in_milliseconds()
    .logarithmic();

pub static LENGTH: Measure =
    Measure::new("length_m", "Length of a drive", "metres", |query| Some(query.solved()?.length_m));

pub static DRIVE_TIME: Measure =
    Measure::new("drive_s", "Duration of a drive", "seconds", |query| Some(query.solved()?.drive_s));

pub static CUSPS: Measure = Measure::new("cusps", "Changes between forward and reverse", "cusps of a drive", |query| {
    Some(query.solved()?.cusps.into())
});

static EXPANSIONS: Measure =
    Measure::new("expansions", "Nodes expanded in a query", "nodes", |query| Some(query.cost?.expansions as f64))
        .logarithmic();

/// All measures, in the order of the charts.
pub static MEASURES: [&Measure; 8] =
    [&LOWER_BOUND_RATIO, &CPU_QUERY, &CLEARANCE, &LENGTH, &DRIVE_TIME, &CUSPS, &EXPANSIONS, &CPU_BUILD];

/// The drives of a planner in a variant.
#[derive(Debug)]
pub struct PlannerSummary {
    pub variant: usize,
    pub planner: Arc<str>,
    pub queries: u64,
    pub solved: u64,
    /// The paths that the audit rejects.
    pub violations: u64,
    /// By the column of the measure, ascending.
    values: BTreeMap<&'static str, Vec<f64>>,
}

impl PlannerSummary {
    /// Summarises a table variant by variant, planner by planner.
    pub fn all(table: &DriveTable) -> Vec<Self> {
        // Planners keep the order of the table, in which they were named, and are not sorted by name.
        let planners = table.planners();
        let places: BTreeMap<&str, usize> = planners.iter().enumerate().map(|(place, name)| (&**name, place)).collect();
        let mut summaries: BTreeMap<(usize, usize), Self> = BTreeMap::new();
        for query in &table.rows {
            let summary = summaries.entry((query.variant, places[&*query.planner])).or_insert_with(|| Self {
                variant: query.variant,
                planner: Arc::clone(&query.planner),
                queries: 0,
                solved: 0,
                violations: 0,
                values: BTreeMap::new(),
            });
            summary.queries += 1;
            summary.solved += u64::from(query.solved().is_some());
            summary.violations += u64::from(query.violation.is_some());
            for measure in MEASURES {
                summary.values.entry(measure.column).or_default().extend(measure.number(query));
            }
        }
        let mut summaries: Vec<Self> = summaries.into_values().collect();
        let lists = summaries.iter_mut().flat_map(|summary| summary.values.values_mut());
        // Quantiles and order statistics need sorted values; sorted once, each is a look-up.
        lists.for_each(|values| values.sort_by(f64::total_cmp));
        summaries
    }

    /// Returns the numbers of the queries that have one, ascending, in the unit of the column.
    pub fn values(&self, measure: &Measure) -> &[f64] {
        self.values.get(measure.column).map_or(&[], Vec::as_slice)
    }

    /// Returns the share of queries that are solved, with Wilson's interval.
    pub fn solved_share(&self) -> Estimate {
        let interval = wilson_interval(self.solved, self.queries).map(|interval| (interval.low, interval.high));
        Estimate { value: self.solved as f64 / self.queries as f64, interval }
    }

    /// Returns the mean; `None` without numbers.
    pub fn mean(&self, measure: &Measure) -> Option<f64> {
        Series::from_values(self.values(measure)).mean()
    }

    /// Returns the quantile at `share`, from 0 to 1; `None` without numbers.
    pub fn quantile(&self, measure: &Measure, share: f64) -> Option<f64> {
        quantile(self.values(measure), share)
    }

    /// Returns the median with the interval of the order statistics; `None` without numbers.
    pub fn median(&self, measure: &Measure) -> Option<Estimate> {
        let interval = quantile_interval(self.values(measure), 0.5).map(|interval| (interval.low, interval.high));
        Some(Estimate { value: self.quantile(measure, 0.5)?, interval })
    }

    /// Returns the quartiles; `None` without numbers.
    pub fn quartiles(&self, measure: &Measure) -> Option<[f64; 3]> {
        let values = self.values(measure);
        Some([quantile(values, 0.25)?, quantile(values, 0.5)?, quantile(values, 0.75)?])
    }
}

impl DriveTable {
    /// Returns summaries of the table's rows as members of JSON.
    pub fn summary_members(&self, summaries: &[PlannerSummary]) -> Vec<impl Serialize> {
        let member = |summary: &PlannerSummary| {
            let Estimate { value, interval } = summary.solved_share();
            let (low, high) = interval.unzip();
            let figures = MEASURES.iter().filter_map(|measure| Some((measure.column, figure(summary, measure)?)));
            object!(Summary {
                // The values of its variant, by key.
                #[serde(flatten)]
                swept: self
                    .keys
                    .iter()
                    .cloned()
                    .zip(self.variants[summary.variant].clone())
                    .collect::<BTreeMap<_, _>>(),
                planner: summary.planner.to_string(),
                queries: summary.queries,
                solved: summary.solved,
                solved_ratio: object!(Share { value, low, high }),
                violations: summary.violations,
                figures: figures.collect::<BTreeMap<_, _>>(),
            })
        };
        summaries.iter().map(member).collect()
    }
}

/// Returns statistics of a measure; `None` without numbers.
fn figure(summary: &PlannerSummary, measure: &Measure) -> Option<impl Serialize + use<>> {
    let median = summary.median(measure)?;
    let (median_low, median_high) = median.interval.unzip();
    Some(object!(Figure {
        count: summary.values(measure).len(),
        mean: summary.mean(measure),
        median: median.value,
        median_low,
        median_high,
        p95: summary.quantile(measure, 0.95),
        max: summary.quantile(measure, 1.0),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::made_up_drives;

    #[test]
    fn summaries_hold_each_query_once() {
        let queries = made_up_drives();
        let groups = PlannerSummary::all(&queries);
        let names: Vec<_> =
            groups.iter().map(|group| (group.variant, &*group.planner, group.queries, group.solved)).collect();
        let expected: Vec<_> =
            (0..3).flat_map(|variant| [(variant, "prm-rs", 40, 39), (variant, "own", 40, 30)]).collect();
        assert_eq!(names, expected);
        assert_eq!(groups[0].values(&LOWER_BOUND_RATIO).len(), 38, "one has no bound, one a violation");
        assert_eq!(groups[1].values(&LOWER_BOUND_RATIO).len(), 29, "those without a drive have none");
        assert_eq!(groups[1].values(&CPU_QUERY).len(), 40, "they took time all the same");
    }

    #[test]
    fn medians_and_shares_are_those_that_one_can_reckon() {
        let groups = PlannerSummary::all(&made_up_drives());
        // 40 numbers from 0 to 39 in steps of 1: the interval is the 14th and the 27th of them.
        let cpu = groups[0].median(&CPU_QUERY).expect("there are numbers");
        assert!((cpu.value - 19.5e-3).abs() < 1e-12);
        assert_eq!(cpu.interval, Some((1e-3 * 13.0, 1e-3 * 26.0)));
        assert_eq!([0.95, 1.0].map(|share| groups[0].quantile(&EXPANSIONS, share)), [37.05, 39.0].map(Some));
        assert_eq!((groups[0].mean(&EXPANSIONS), groups[0].values(&CPU_BUILD).len()), (Some(19.5), 20));
        assert_eq!(groups[0].quartiles(&EXPANSIONS), Some([9.75, 19.5, 29.25]));
        let share = groups[1].solved_share();
        assert_eq!(share.value, 0.75);
        let (low, high) = share.interval.expect("there are queries");
        assert!((low - 0.598).abs() < 1e-3 && (high - 0.858).abs() < 1e-3, "{low} {high}");
    }

    #[test]
    fn table_reads_back_as_it_was() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("one.csv");
        let again = folder.path().join("two.csv");
        let queries = made_up_drives();
        queries.write(&path).expect("writable");
        let read = DriveTable::read(&path).expect("it was just written");
        assert_eq!((&read.keys, &read.variants), (&queries.keys, &queries.variants));
        // Messages of planners are no column.
        let without_message = |row: &DriveQuery| DriveQuery { message: None, ..row.clone() };
        assert_eq!(queries.rows.iter().map(without_message).collect::<Vec<_>>(), read.rows);
        read.write(&again).expect("writable");
        let [one, two] = [path, again].map(|path| std::fs::read_to_string(path).expect("readable"));
        assert_eq!(one, two);
        assert!(
            one.starts_with("seed,field.coverage,fire.model,field,goal,planner,success,reason,cpu_build_s,"),
            "{one}"
        );
        assert!(one.contains("\n0,0.05,'-so,\"'=made up, \"\"two\"\"\",0,prm-rs,true,,0.25,"), "{one}");
    }
}
